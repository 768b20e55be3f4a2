"""Milliseconds of a frame on the pages of balm.

usage: frames.py BALM TOP. Prints doc/measured/frames.md.
"""
import os
import shutil
import subprocess
import sys
import tempfile

from playwright.sync_api import sync_playwright

CASES = [("needle, ten bars", "needle.nml"), ("textile, ten bars", "textile.nml"), ("64 loops, 360 positions", "hard/chain64.nml")]
TURNS = 10    # of which the best counts: others may use the machine too
FRAMES = 60   # in a turn
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu"]


def main():
    balm, top = sys.argv[1:]
    print("# Time of a frame\n\nMeasured by `bench/frames`: pages of balm in chromium without a graphics card, best of %d turns.\n" % TURNS)
    print("| page | drawing, ms | until all pixels are there, ms |\n| --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for title, name in CASES:
            subprocess.run([balm, "--quiet", "--output-dir", folder, os.path.join(top, "data", name)], check=True,
                           stdout=subprocess.DEVNULL)
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.goto("file://" + os.path.join(folder, os.path.basename(name).replace(".nml", ".html")))
            best = [min(page.evaluate("balm.frameTime(%d, %s)" % (FRAMES, raster)) for _ in range(TURNS)) for raster in ("false", "true")]
            print("| %s | %.2f | %.1f |" % (title, *best))
            page.close()
        browser.close()


main()
