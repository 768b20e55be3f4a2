#!/usr/bin/env python3
"""Wheels in gear on a chain of dyads, held against the law of their teeth.

usage: test/law/wheels.py PROGRAM_DIRECTORY

A wheel on a fixed centre or on a link that moves, in gear with a link of a ten-bar: seen from the carrier both turn by angles whose
ratio is that of their teeth, counted from the drawing over many turns. Angles are found here from the joints of CASE.csv. Positions far
apart, close together and in whatever number must give the same: the program takes them in blocks, and blocks in pieces. A group of four
links behind a wheel must be followed to every position that closes in a finer run. Last line: N passed, N failed.
"""
import csv
import math
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

programs = os.path.abspath(sys.argv[1])
NEAR = 1e-9         # degrees, and units of length

JOINTS = "'A','B','C','D','E','F','G','H','I','K'"
X, Y = "0,0,80,100,160,180,240,260,320,340", "0,20,60,-10,70,-10,70,-10,70,-10"
LINKS = "'A B','B C','C D','C E','E F','E G','G H','G I'"
NAMES = "'frame','crank','r1','s1','r2','s2','r3','s3','r4','s4','wheel'"
# x and y of the centre and of a joint on the rim, frame, s4, link that it is in gear with, carrier
FIXED = ("380,380", "-10,20", "'A D F H K W'", "'I K'", "s4", "frame")
PLANET = ("350,380", "40,50", "'A D F H K'", "'I K W'", "r4", "s4")


def ten_bar(place, teeth, inputs):
    x, y, frame, last, gear, carrier = place
    return ("TEN-BAR WITH A WHEEL\n &CHAIN JNT=%s,'W','V', JX=%s,%s, JY=%s,%s,\n  LNAME=%s, LNK=%s,%s,%s,'W V',\n"
            "  GEARA='%s', GEARB='wheel', GCARR='%s', GTA=%r, GTB=%r &END\n &DRIVES DRIVE='A' &END\n &OUTPUTS OUTPUT='point V' &END\n"
            " &METHOD NDES=%d, DELT=%s &END\n"
            % (JOINTS, X, x, Y, y, NAMES, frame, LINKS, last, gear, carrier, *teeth, len(inputs), listed(inputs)))


def six_bar(teeth, inputs):
    """A wheel on a rocker that drives a Stephenson II, whose other links are one group."""
    return ("WHEEL AND SIX-BAR\n &CHAIN JNT='A','B','C','D','P','Q','R','S','T','U','V',\n"
            "  JX=0,0,80,100,300,300,340,380,345,385,400, JY=0,8,60,-10,0,30,60,55,30,20,0,\n"
            "  LNAME='frame','crank','r1','s1','wheel','left','top','right','tie',\n"
            "  LNK='A D P V','A B','B C','C D','P Q','Q R T','R S','S U V','T U',\n"
            "  GEARA='s1', GEARB='wheel', GCARR='frame', GTA=%r, GTB=%r &END\n &DRIVES DRIVE='A' &END\n &OUTPUTS OUTPUT='point S' &END\n"
            " &METHOD NDES=%d, DELT=%s &END\n" % (*teeth, len(inputs), listed(inputs)))


def listed(inputs):
    return ",\n  ".join("%.10g" % i for i in inputs)


def run(text):
    """CASE.csv, by the input."""
    with tempfile.TemporaryDirectory() as work:
        with open(os.path.join(work, "c.nml"), "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run([os.path.join(programs, "psalm"), "--quiet", "c.nml"], cwd=work, capture_output=True, text=True)
        if done.returncode not in (0, 1):
            return done.returncode, {}
        with open(os.path.join(work, "c.csv"), encoding="utf-8") as file:
            return done.returncode, {float(row["input"]): row for row in csv.DictReader(file)}


def direction(row, a, b):
    return math.degrees(math.atan2(float(row[b + ".y"]) - float(row[a + ".y"]), float(row[b + ".x"]) - float(row[a + ".x"])))


def unwound(rows, inputs, a, b):
    """Turn of a direction since the first input, which is the drawing; between two inputs it is less than half a turn."""
    turns, before = [0.0], direction(rows[inputs[0]], a, b)
    for i in inputs[1:]:
        now = direction(rows[i], a, b)
        turns.append(turns[-1] + math.remainder(now - before, 360.0))
        before = now
    return turns


def follows_its_teeth(place, teeth):
    """Three turns in steps of a degree, and parts of them in other steps and numbers of positions."""
    what = "%s %g:%g" % ("planet" if place is PLANET else "wheel", *teeth)
    fine = [float(i) for i in range(1081)]
    status, rows = run(ten_bar(place, teeth, fine))
    check(what + ": it closes everywhere", status == 0 and len(rows) == len(fine), status)
    if status or len(rows) != len(fine):
        return
    wheel, last = unwound(rows, fine, "W", "V"), unwound(rows, fine, "K", "I")
    carrier, geared = ([0.0]*len(fine), last) if place is FIXED else (last, unwound(rows, fine, "G", "I"))
    off = max(abs((w - c)*teeth[1] + (g - c)*teeth[0])/abs(teeth[1]) for w, c, g in zip(wheel, carrier, geared))
    check(what + ": seen from the carrier it turns as the teeth say", off < NEAR, off)
    seen = [w - c for w, c in zip(wheel, carrier)]
    check(what + ": it is moved at all", max(seen) - min(seen) > 2.0, (min(seen), max(seen)))
    for step, first, number in ((0.5, 0, 37), (2.0, 0, 131), (9.0, 0, 64), (30.0, 360, 13), (40.0, 0, 20), (72.0, 0, 11), (0.05, 0, 517)):
        inputs = [first + step*i for i in range(number)]
        status, part = run(ten_bar(place, teeth, inputs))
        common = [i for i in inputs if i in rows]
        off = max((abs(float(part[i][c]) - float(rows[i][c])) for i in common for c in ("V.x", "V.y")), default=math.inf)
        check("%s: the same in steps of %g" % (what, step), status == 0 and off < NEAR, (status, off))


def leads_to_a_group(teeth):
    what = "six-bar behind a wheel %g:%g" % teeth
    status, fine = run(six_bar(teeth, [float(i) for i in range(361)]))
    check(what + ": steps of a degree", status in (0, 1) and len(fine) == 361, status)
    if len(fine) != 361:
        return
    for step in (15.0, 30.0, 45.0):
        _, part = run(six_bar(teeth, [step*i for i in range(int(360/step) + 1)]))
        closed = sum(row["closed"] == "1" for row in part.values())
        same = all(row["closed"] == fine[i]["closed"] for i, row in part.items())
        off = max((abs(float(row["S.x"]) - float(fine[i]["S.x"])) for i, row in part.items() if row["closed"] == "1"), default=math.inf)
        check("%s: it closes where it does in steps of a degree, steps of %g" % (what, step), same and closed > 1, closed)
        check("%s: the same positions, steps of %g" % (what, step), off < NEAR, off)


def stays_in_gear():
    """A search of lengths leaves the teeth of wheels between each other that one group finds: their lines have the angles of the drawing."""
    text = ("WHEELS OF ONE GROUP\n &CHAIN JNT='A','B','C','D','E','P', JX=0,1,4,6,5,3, JY=0,1,4,1,0,5,\n"
            "  LNAME='frame','crank','arm','wheel','rocker', LNK='A E','A B','B C P','C D','D E',\n"
            "  GEARA='crank', GEARB='wheel', GCARR='arm', GTA=%r, GTB=%r, VARY='A B','B C','C D','D E' &END\n &DRIVES DRIVE='A' &END\n"
            " &OUTPUTS OUTPUT='point P' &END\n &METHOD NDES=6, DELT=10,20,30,40,50,60, DESX=2.9,2.7,2.5,2.3,2,1.8,\n"
            "  DESY=5.1,5.2,5.3,5.4,5.4,5.3 &END\n &SEARCH SOLVER='LSQ', NSTART=2 &END\n")
    for teeth in ((20.0, 20.0), (20.0, -40.0)):
        with tempfile.TemporaryDirectory() as work:
            name = os.path.join(work, "c.nml")
            with open(name, "w", encoding="utf-8") as file:
                file.write(text % teeth)
            done = subprocess.run([os.path.join(programs, "psalm"), "--quiet", name], cwd=work, capture_output=True, text=True)
            with open(os.path.join(work, "c.dev7"), encoding="utf-8") as file:
                cases = [text % teeth, file.read().replace("E+", "e+").replace("E-", "e-")]
        given, found = (in_gear([numbers_of(case, item) for item in ("JX", "JY")], -teeth[0]/teeth[1]) for case in cases)
        # a turn of one wheel is a part of one of the other
        off = abs(math.remainder(found - given, 360.0*min(1.0, abs(teeth[0]/teeth[1]))))
        check("a search leaves wheels %g:%g in gear" % teeth, done.returncode in (0, 1) and off < NEAR, (off, done.stderr[-200:]))


def numbers_of(case, item):
    return [float(x) for x in re.search(r"\b%s=([\d.,+\-e\s]*)" % item, case).group(1).replace("\n", "").strip(" ,").split(",")]


def in_gear(joints, ratio):
    """What turns of crank, arm and wheel do not change: ratio (crank - arm) - (wheel - arm), degrees."""
    x, y = joints
    crank, arm, wheel = (math.degrees(math.atan2(y[k + 1] - y[k], x[k + 1] - x[k])) for k in range(3))
    return ratio*(crank - arm) - (wheel - arm)


NOWHERE = """A GROUP WITH WHEELS THAT RUNS AWAY
 &CHAIN JNT='A','B','C','D','E','P', JX=0.0,1.0,4.0,6.0,5.0,3.0, JY=0.0,1.0,4.0,1.0,0.0,5.0,
  LNAME='frame','crank','arm','wheel','rocker', LNK='A E','A B','B C P','C D','D E',
  GEARA='crank', GEARB='wheel', GCARR='arm', GTA=60.0, GTB=20.0, VARY='A B','B C','C D','D E' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=6, DELT=10.0,20.0,30.0,40.0,50.0,60.0, DESX=2.9,2.7,2.5,2.3,2.0,1.8, DESY=5.1,5.2,5.3,5.4,5.4,5.3 &END
 &SEARCH SOLVER='LSQ', NSTART=2 &END
"""


def takes_none_that_is_open():
    """Lengths grow without end here, and within the bounds that hold then the search finds nothing that closes."""
    with tempfile.TemporaryDirectory() as work:
        with open(os.path.join(work, "c.nml"), "w", encoding="utf-8") as file:
            file.write(NOWHERE)
        done = subprocess.run([os.path.join(programs, "psalm"), "c.nml"], cwd=work, capture_output=True, text=True)
        found = re.search(r"(\d+) led to a linkage.*best objective (\S+)", done.stderr)
        check("a linkage that a search takes closes, and has an objective", found is not None and float(found.group(2)) > 1e-6 and
              "does not close" not in done.stderr and "DOES NOT CLOSE" not in done.stdout, done.stderr[:400])


for where in (FIXED, PLANET):
    for numbers in ((20.0, 10.0), (30.0, 10.0), (50.0, 10.0), (20.0, -20.0), (20.0, 30.0), (20.0, -37.0), (90.0, 17.0), (1.0, 7.0)):
        follows_its_teeth(where, numbers)
for numbers in ((20.0, 10.0), (20.0, 20.0), (20.0, 30.0)):
    leads_to_a_group(numbers)
stays_in_gear()
takes_none_that_is_open()
sys.exit(report())
