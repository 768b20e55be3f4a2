#!/usr/bin/env python3
"""What balm --animate writes: an SVG that moves, against the table that psalm writes for the same sketch, and in a browser.

usage: test/web/animation.py PROGRAM_DIRECTORY. With IKIN=5 every frame of a full turn is a position of CASE.csv, so each joint must be
where the table has it. Last line: N passed, N failed.
"""
import csv
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

from playwright.sync_api import sync_playwright

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from picture_tools import FLAGS
from tally import check, report

SVG = "{http://www.w3.org/2000/svg}"
PIXEL = 0.0501                      # places are rounded to the tenth
FOUR_BAR = """FOUR-BAR
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=5 &END
"""
ROCKER = FOUR_BAR.replace("DRIVE='A', DBASE='frame', DLINK='crank'", "DRIVE='D', DBASE='frame', DLINK='rocker'")
SLIDER = """SLIDER-CRANK
 &CHAIN JNT='A','B','C', JX=0.0,3.0,11.0, JY=0.0,2.0,0.0, LNAME='frame','crank','rod','piston', LNK='A','A B','B C','C',
  SLNK='frame', SLNK2='piston', SLX=11.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD IKIN=5 &END
"""


def run(programs, program, *arguments):
    return subprocess.run([os.path.join(programs, program), *arguments], capture_output=True, text=True)


def frames(element):
    """The values of the animation of an element, as lists of numbers; one if it stands still."""
    animation = [e for e in element if e.tag in (SVG + "animate", SVG + "animateTransform")]
    texts = animation[0].get("values").split(";") if animation else [element.get("d") or element.get("transform")]
    return [[float(word) for word in re.findall(r"-?\d+\.?\d*", text)] for text in texts]


def moved(programs, name, text, table=True):
    """The moving picture of a case, its scale and the table of its positions."""
    with open(name + ".nml", "w", encoding="utf-8") as file:
        file.write(text)
    done = run(programs, "balm", "--quiet", "--animate", name + ".nml")
    check(name + ": balm --animate ends well", done.returncode == (0 if table else 1), done.stderr[-300:])
    root = ElementTree.parse(name + ".move.svg").getroot()
    matrix = [e for e in root.iter(SVG + "g") if (e.get("transform") or "").startswith("matrix")][0]
    k, _, _, _, ox, oy = [float(word) for word in re.findall(r"-?[\d.]+", matrix.get("transform"))]
    run(programs, "psalm", "--quiet", name + ".nml")
    with open(name + ".csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return root, k, ox, oy, rows


def joints_as_in_the_table(programs, name, text, joints):
    root, k, ox, oy, rows = moved(programs, name, text)
    drawn = [frames(e) for e in root.iter(SVG + "g") if e.get("class") == "joint"]
    check(name + ": a mark for each joint", len(drawn) >= len(joints), len(drawn))
    for joint in joints:
        path = [(ox + k*float(row[joint + ".x"]), oy - k*float(row[joint + ".y"])) for row in rows]
        path.append(path[0])
        gaps = [max(math.dist(path[i], places[i if len(places) > 1 else 0][:2]) for i in range(len(path)))
                for places in drawn if len(places) in (1, len(path))]
        check("%s: %s is where the table has it" % (name, joint), gaps and min(gaps) < math.sqrt(2.0)*PIXEL, gaps)
    bars = [frames(e) for e in root.iter(SVG + "path") if (e.get("class") or "").startswith("bar c")]
    for number, bar in enumerate(bars):
        lengths = [math.dist(line[:2], line[2:4]) for line in bar]
        check("%s: bar %d keeps its length" % (name, number), max(lengths) - min(lengths) < 4.0*PIXEL, (min(lengths), max(lengths)))
    check(name + ": it ends as it begins", all(bar[0] == bar[-1] for bar in bars))
    return bars


def the_browser_moves_it(name):
    """SMIL is played: at each time the star stands at the value of that frame; and it is quiet about errors."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page()
        errors = []
        page.on("console", lambda message: errors.append(message.text))
        page.goto("file://" + os.path.abspath(name + ".move.svg"))
        found = page.evaluate("""() => {
            const svg = document.documentElement, star = document.querySelector('use.actual').parentElement
            const animation = star.querySelector('animateTransform'), values = animation.getAttribute('values').split(';')
            const span = parseFloat(animation.getAttribute('dur'))
            svg.pauseAnimations()
            return [0, 7, 30, 61].map(i => {
                svg.setCurrentTime(span*i/(values.length - 1))
                const at = star.transform.animVal.getItem(0).matrix, [x, y] = values[i].split(' ').map(Number)
                return Math.hypot(at.e - x, at.f - y)
            })
        }""")
        check("the browser plays the frames", max(found) < 0.1, found)
        check("the browser has nothing to say", not errors, errors)
        browser.close()


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        joints_as_in_the_table(programs, "four_bar", FOUR_BAR, "ABCDP")
        joints_as_in_the_table(programs, "slider", SLIDER, "ABC")
        the_browser_moves_it("four_bar")
        root, *_ = moved(programs, "rocker", ROCKER, table=False)
        bars = [frames(e) for e in root.iter(SVG + "path") if (e.get("class") or "").startswith("bar c")]
        check("a rocker that is driven goes forth and back", bars and all(bar == bar[::-1] for bar in bars) and len(bars[0]) > 20)
        lengths = [math.dist(line[:2], line[2:4]) for bar in bars for line in bar if bar is bars[0]]
        check("and keeps its length", max(lengths) - min(lengths) < 4.0*PIXEL)
        root, *_ = moved(programs, "part", FOUR_BAR.replace("IKIN=5", "NDES=3, DELT=-20.0,0.0,25.0"))
        crank = [frames(e) for e in root.iter(SVG + "path") if (e.get("class") or "").startswith("bar c")][0]
        angles = [math.degrees(math.atan2(line[1] - line[3], line[2] - line[0])) for line in crank]
        check("it moves between the positions of the case", abs(max(angles) - min(angles) - 45.0) < 0.3, (min(angles), max(angles)))
        plain = run(programs, "balm", "--quiet", "--output-dir", "plain", "four_bar.nml")
        check("without --animate there is none", plain.returncode == 0 and not os.path.exists("plain/four_bar.move.svg"))
        both = run(programs, "balm", "--edit", "--animate", "four_bar.nml")
        check("not with --edit", both.returncode == 2 and "--animate" in both.stderr, both.stderr)
        other = run(programs, "psalm", "--animate", "four_bar.nml")
        check("no option of psalm", other.returncode == 2 and "'--animate' is an option of balm" in other.stderr, other.stderr)
        os.chdir("/")
    return report()


if __name__ == "__main__":
    sys.exit(main())
