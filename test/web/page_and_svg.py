#!/usr/bin/env python3
"""Whatever a page shows is in an SVG, too, and every axis has its unit.

usage: test/web/page_and_svg.py PROGRAM_DIRECTORY. Last line: N passed, N failed.

Pages are opened in a browser without a screen; every word that their canvases draw must stand in the SVG of the same case. The rows of
the table of doc/guide/pictures.md name what is drawn: each must have its elements in the SVG of a data set that has it, and none in
that of one that has not.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

from playwright.sync_api import sync_playwright

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from picture_tools import FLAGS, PATIENCE
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SVG = "{http://www.w3.org/2000/svg}"
# data sets of each kind: program with its options -> cases
RUNS = {("balm", "--curves", "--assemblies", "--animate"): (
            "needle", "rig_coupler", "bridge/four_bar_haines", "excavator_envelope", "geared_five_bar", "cheapest_tolerances",
            "adjustable_stroke", "stephenson3_rod_driven", "links_apart", "engine", "jansen"),
        ("ssics", "--curves"): ("rig_coupler", "stephenson3_rod_driven"),
        ("calm",): ("calm/five_bar_cams", "calm/swinging_roller", "calm/wedge_cam", "calm/knuckle_press"),
        ("bridge",): ("bridge/four_bar_haines",)}
PAGES = tuple((case, ".html", (".svg", ".curves.svg", ".tolerances.svg", ".ssics.curves.svg")) for case in RUNS[("balm", "--curves", "--assemblies", "--animate")]) \
    + tuple((case, ".calm.html", (".calm.svg",)) for case in RUNS[("calm",)])
# row of the manual's table, as it begins -> SVG that has it, what to look for, SVG that has not
ROWS = {
    "links, plates, slides": (("needle.svg", ("bar", "plate", "joint", "desired")), ("jansen.svg", ("path",)), ("jansen.move.svg", ("path",)), ("engine.svg", ("desired",))),
    "cylinders, gear wheels, work envelope": (("excavator_envelope.svg", ("barrel", "outline")), ("gears.svg", ("wheel",)), ("needle.svg", ("barrel", "wheel", "outline"))),
    "other assemblies": (("needle.svg", ("ghost",)), None),
    "regions of &CONSTR": (("links_apart.svg", ("region",)), ("needle.svg", ("region",))),
    "gap of a dyad": (("nowhere.svg", ("broken",)), ("needle.svg", ("broken",))),
    "widths of links": (("stephenson3_rod_driven.svg", ("wide", "near")), ("links_apart.svg", ("proof",)), ("needle.svg", ("wide", "near", "proof"))),
    "centres of mass, loads": (("stephenson3_rod_driven.svg", ("mass", "load", "spring", "polar")),
                               ("needle.svg", ("mass", "spring", "polar", "load"))),
    "bent link of &VIBR": (("rig_coupler.svg", ("straight",)), ("four_bar_haines.svg", ("hole", "pin", "bearing")), ("needle.svg", ("straight", "hole"))),
    "curves of outputs": (("needle.curves.svg", ("plot",)), None),
    "bands of tolerance, forces": (("cheapest_tolerances.curves.svg", ("area",)), ("needle.curves.svg", ("area",))),
    "tolerances of &ALLOC": (("cheapest_tolerances.tolerances.svg", ("dimension", "cost", "share", "area")), None),
    "inputs at which": (("apart.curves.svg", ("span",)), ("beyond.curves.svg", ("mild",)), ("geared_five_bar.curves.svg", ("span", "mild"))),
    "deflection over speeds": (("rig_coupler.ssics.curves.svg", ("area", "span")), None),
    "cams, pitch curve": (("five_bar_cams.calm.svg", ("profile", "pitch", "cutter", "follower", "push", "bar", "joint", "ground")),
                          ("knuckle_press.calm.svg", ("rail",)), None),
    "output, derivatives": (("swinging_roller.calm.svg", ("curve", "limit")), None),
}
HOOK = """window.words = new Set(); const fill = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) { window.words.add(text); return fill.call(this, text, ...rest); }"""
# axes and headings without a unit: numbers without one, or each line has its own
NO_UNIT = re.compile(r"position$|frequency/speed|e, factor|objective$|iteration$|start$|.*, ratio$|.*\brotations?$")
UNIT = re.compile(r".*[, (](degrees|degrees from the drawing|length|length from the drawing|rad|m|N|N m|N s|1/length|(length|rad|degrees|m)/(rad|s|length|degree)(\^\d)?)$")


def plain(words):
    """Words without what explains them, and without the range of a curve."""
    return re.sub(r": \S+ to \S+$", "", re.sub(r" \([^()]*\)(?=$|:)", "", words.strip()))


def words_of_svg(name):
    return {plain("".join(e.itertext())) for e in ElementTree.parse(name).getroot().iter(SVG + "text")}


def words_of_page(browser, name):
    """All that the canvases of a page write, all groups of curves shown; one cam after the other."""
    context = browser.new_context(viewport={"width": 1920, "height": 1400})
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.add_init_script(HOOK)
    page.goto("file://" + os.path.abspath(name))
    page.wait_for_function("window.words.size > 0")
    for chooser in ("group", "which"):
        box = page.locator("#" + chooser)
        if box.count() and box.is_visible():
            for value in box.evaluate("(e) => [...e.options].map((o) => o.value)"):
                box.select_option(value)
                page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    words = page.evaluate("() => [...window.words]")
    context.close()
    return {plain(word) for word in words if not re.fullmatch(r"[-+\d.eE\u2013 ]*", word)}


def without_unit(words):
    return words.rsplit(", ", 1)[0]


def every_word(browser):
    for case, ending, pictures in PAGES:
        stem = os.path.basename(case)
        drawn, others = set(), set()
        for picture in pictures:
            if os.path.exists(stem + picture):
                # ssics has its curves in metres, the page in the length of the case
                (others if "ssics" in picture else drawn).update(words_of_svg(stem + picture))
        others = {without_unit(words) for words in others}
        drawn |= {words.removeprefix("second cam, ") for words in drawn}
        words = words_of_page(browser, stem + ending)
        check("%s: the page was read" % stem, len(words) > 4, sorted(words))
        missing = [one for one in sorted(words) if one not in drawn and without_unit(one) not in others]
        check("%s: all that the page says is in the SVG" % stem, not missing, missing)


def every_unit():
    for name in sorted(os.listdir(".")):
        if not name.endswith(("curves.svg", "tolerances.svg")):
            continue
        for group in ElementTree.parse(name).getroot().iter(SVG + "g"):
            if group.get("class") != "plot":
                continue
            texts = [plain("".join(e.itertext())) for e in group.iter(SVG + "text")]
            heads = [plain(group.get("data-name")), next(t for t, e in zip(reversed(texts), reversed(list(group.iter(SVG + "text"))))
                                                         if "middle" in e.get("class", "") and not re.fullmatch(r"[-+\d.eE]+", t))]
            for head in heads:
                check("%s: '%s' has its unit" % (name, head), UNIT.match(head) or NO_UNIT.match(head))


def every_row():
    with open(os.path.join(TOP, "doc", "guide", "pictures.md"), encoding="utf-8") as file:
        table = file.read().split("| shown | on the page | in SVG |\n| --- | --- | --- |\n")[1].split("\n\n")[0]
    rows = [line.split("|")[1].strip() for line in table.splitlines()]
    check("each row of the manual is looked at, and none else", len(rows) == len(ROWS) and
          all(sum(row.startswith(begin) for row in rows) == 1 for begin in ROWS), rows)
    for begin, looked in ROWS.items():
        for name, classes in [one for one in looked[:-1] if one]:
            for one in classes:
                check("%s: %s in %s" % (begin, one, name), one in classes_of(name))
        if looked[-1]:
            name, classes = looked[-1]
            for one in classes:
                check("%s: no %s in %s" % (begin, one, name), one not in classes_of(name))


def classes_of(name):
    return {word for e in ElementTree.parse(name).getroot().iter() for word in e.get("class", "").split()}


def write_changed(case, before, after, name):
    with open(os.path.join(TOP, "data", case + ".nml"), encoding="utf-8") as file:
        text = file.read()
    check("there is '%s' in %s" % (before, case), text.count(before) == 1)
    with open(name + ".nml", "w", encoding="utf-8") as file:
        file.write(text.replace(before, after))


def main():
    programs = os.path.realpath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        # a slider-crank whose rod is too short to go round, and one that exceeds the limit of its transmission angle
        write_changed("dyad4_slider_crank", "140.0,0.0,10.0", "45.0,0.0,10.0", "apart")
        write_changed("dyad4_slider_crank", "140.0,0.0,10.0", "5.0,0.0,60.0", "nowhere")
        write_changed("dyad1_crank_rocker", "TANGLE=70.0", "TANGLE=30.0", "beyond")
        write_changed("geared_five_bar", "RATIO=0.0,0.5", "RATIO=0.0,-1.0", "gears")
        runs = [(command, os.path.join(TOP, "data", case + ".nml")) for command, cases in RUNS.items() for case in cases]
        runs += [(("balm", "--curves"), "apart.nml"), (("balm", "--curves"), "beyond.nml"), (("balm",), "gears.nml"), (("balm",), "nowhere.nml")]
        for (program, *options), path in runs:
            done = subprocess.run([os.path.join(programs, program), "--quiet", "--output-dir", ".", *options, path],
                                  capture_output=True, text=True, check=False)
            check("%s %s" % (program, os.path.basename(path)), done.returncode in (0, 1), done.stderr[-300:])
        with sync_playwright() as browsers:
            browser = browsers.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            every_word(browser)
            browser.close()
        every_unit()
        every_row()
    return report()


if __name__ == "__main__":
    sys.exit(main())
