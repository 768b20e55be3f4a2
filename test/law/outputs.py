#!/usr/bin/env python3
"""All outputs of a sketch, and the zero of its input.

usage: test/law/outputs.py PROGRAM_DIRECTORY

Every output of a four-bar and of a larger group has its values at every degree (IPLOT), its condition number (ICOND) and its part of the
Monte Carlo sample (NTRIAL), whatever its place among the outputs; table, listing and device 9 count the input from the drawing. Held
against each other and against laws: a uniform deviation has its variance, a change of the input its effect. Last line: N passed, N failed.
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

FOUR_BAR = """FOUR-BAR, ALL OUTPUTS
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END
"""
SIX_BAR = """SIX-BAR WITH A GROUP OF FOUR LINKS
 &CHAIN JNT='A','B','C','D','E','F','G','P', JX=0.0,0.0,40.0,80.0,45.0,85.0,100.0,70.0, JY=0.0,2.0,60.0,55.0,30.0,20.0,0.0,45.0,
  LNAME='frame','crank','left','top','right','tie', LNK='A G','A B','B C E','C D','D F G','E F P' &END
 &DRIVES DRIVE='A' &END
"""
GRIPPER = """GRIPPER WITH A CYLINDER
 &CHAIN JNT='a','b','c','f','a2','b2','c2','f2',
  JX=0.0,30.0,60.0,140.0,0.0,30.0,60.0,140.0, JY=10.0,25.0,15.0,20.0,-10.0,-25.0,-15.0,-20.0,
  LNAME='body','rod','linkU','fingerU','linkL','fingerL',
  LNK='b b2','a a2','a c','b c f','a2 c2','b2 c2 f2', SLNK='body', SLNK2='rod', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='S1' &END
"""
POSES = """FOUR-BAR THROUGH FOUR POSES
 &CHAIN JNT='A','B','C','D','P','Q', JX=0,-10,60,80,40,50, JY=0,45,70,0,110,110,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P Q','C D',
  VARY='A B','B C','C D','B P','angle B C B P','place D','place A','input' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='%s' &END
 &METHOD NDES=4, DELT=0,-15,-30,-45, DESX=%s, DESY=%s, DESANG=%s &END
 &SEARCH SOLVER='LSQ', NSTART=20, NBEST=2 &END
"""
PLACE = """FOUR-BAR WHOSE PIVOT MOVES
 &CHAIN JNT='A','B','C','D','P','Q', JX=20,10,80,100,60,70, JY=5,50,75,5,115,135,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P Q','C D', VARY='place A','B Q','angle B P B Q' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P','angle P Q', DES1=45,113,63,115,80,112,95,105, DES2=60,50,40,30 &END
 &METHOD NDES=4, VAR=0.99, DELT=0,-15,-30,-45 &END
 &SEARCH SOLVER='LSQ', NSTART=1, FIRST=%d &END
 &LIMITS TANGLE=90.0, LAST=1 &END
"""
OUTPUTS = ("point P", "x P", "angle C D", "distance B D", "between A B C D")
NUMBERS = ("point_P.x", "point_P.y", "x_P", "angle_C_D", "distance_B_D", "between_A_B_C_D")


class Run:
    """A case and its files."""

    def __init__(self, programs, work, text, program="psalm"):
        path = os.path.join(work, "case.nml")
        with open(path, "w", encoding="ascii") as file:
            file.write(text)
        done = subprocess.run([os.path.join(programs, program), path], capture_output=True, text=True, check=False)
        self.status, self.listing, self.messages = done.returncode, done.stdout, done.stderr
        ending = "" if program == "psalm" else "." + program
        with open(os.path.join(work, "case%s.dev9" % ending), encoding="ascii") as file:
            self.parts = [part.strip("\n").split("\n") for part in file.read().split("\n\n\n")]
        with open(os.path.join(work, "case%s.csv" % ending), encoding="ascii", newline="") as file:
            self.table = list(csv.DictReader(file))

    def block(self, name):
        """Columns of a block of device 9."""
        for part in self.parts:
            if part[0] == "# block " + name:
                names = part[1][2:].split()
                rows = [[float(word) for word in line.split()] for line in part if line[0] != "#"]
                return {n: [row[i] for row in rows] for i, n in enumerate(names)}
        return {}

    def rows(self, which):
        """Rows of the first blocks, which have no names: the positions and every degree."""
        return [[float(word) for word in line.split()] for line in self.parts[which] if line[0] != "#"]


def case(head, outputs, *groups):
    wanted = " &OUTPUTS OUTPUT=" + ",".join("'%s'" % name for name in outputs) + " &END\n"
    return head + wanted + "".join(" %s &END\n" % group for group in groups)


def far(one, other):
    return max(abs(a - b) for a, b in zip(one, other))


def zero(run):
    """Listing, device 9, table: one input; the crank's angle beside it."""
    rows, table = run.rows(0), run.table
    check("device 9 and table have the same inputs", [row[0] for row in rows] == [float(row["input"]) for row in table], rows[:2])
    lines = run.listing.split("          INPUT ", 1)[1].split("\n")[1:len(table) + 1]
    check("the listing has them, too", all(abs(float(line.split()[0]) - float(row["input"])) < 1e-4 for line, row in zip(lines, table)), lines[:2])
    for line, row, nine in zip(lines, table, rows):
        angle = math.degrees(math.atan2(float(row["B.y"]), float(row["B.x"]))) % 360.0
        check("the crank's angle", abs(angle - float(row["crank_angle"])) < 1e-9 and abs(angle - nine[-1]) < 1e-9 and
              abs(angle - float(line.split()[-1])) < 1e-3, (angle, row["crank_angle"], nine[-1], line))
    check("summary and listing say from where", "count from the drawing, where the crank is at " in run.messages and
          "INPUTS COUNT FROM THE DRAWING, WHERE THE CRANK IS AT " in run.listing, run.messages)


def every_degree(run, numbers, step):
    """All outputs at every degree: the first as the sweep has it, all as the table at its positions."""
    swept, first = run.block("swept_outputs"), run.rows(1)
    check("360 steps", len(first) == 360 and all(len(swept.get(name, [])) == 360 for name in numbers), list(swept))
    check("the first output as in the sweep", far(swept["point_P.x"], [row[2] for row in first]) < 1e-10 and
          far(swept["point_P.y"], [row[3] for row in first]) < 1e-10)
    for name in numbers:
        there = [float(row[name]) for row in run.table]
        here = swept[name][::step]
        turns = 360.0 if name.startswith(("angle", "between")) else 1e300
        check("%s at every degree" % name, max(abs(math.remainder(a - b, turns)) for a, b in zip(here, there)) < 1e-10, (here[:2], there[:2]))


def sample(run, numbers):
    """Small uniform deviations: three times the variance is the square of the root-sum-square; none leaves the worst case."""
    bands = run.block("output_tolerances")
    for name in numbers:
        of = {what: bands.get("%s.%s" % (name, what), []) for what in ("worst_case", "root_sum_square", "lowest", "highest", "std_deviation")}
        check("%s: has its bands and its sample" % name, all(len(values) == len(run.table) for values in of.values()), list(bands)[:8])
        for worst, square, low, high, deviation in zip(*of.values()):
            check("%s: the deviation of the sample" % name, abs(deviation*math.sqrt(3.0) - square) < 0.03*square, (deviation, square))
            check("%s: the sample lies in the worst case" % name, -1.02*worst < low < 0.0 < high < 1.02*worst, (worst, low, high))


def conditions(run, rates, numbers):
    """At least the effect of the input's own rounding: its rate, relative to the output, angles to a radian."""
    block = run.block("outputs")
    main = [row[4] for row in run.rows(0)]
    own = block["point_P.condition"]
    check("point P as the output of the loops", all(0.5 < a/b < 2.0 for a, b in zip(own, main)), (own[:3], main[:3]))
    check("x P as point P", block["x_P.condition"] == own)
    for name in numbers:
        column = name.split(".")[0] + ".condition"
        for k, row in enumerate(rates.table):
            rate = float(row[name + ".v"])
            size = 1.0
            if name.startswith(("point", "x_")):
                size, rate = math.hypot(float(row["P.x"]), float(row["P.y"])), rate
            elif name.startswith("distance"):
                size = float(row[name])
            check("%s is no better than its rate" % column, 1.0 <= abs(rate)/size + 1.0 <= block[column][k] + 1.0 < 1e16,
                  (rate, size, block[column][k]))


def drawn_whole(programs, work, head):
    """Every point of every link is on the pictures, whatever is asked first."""
    seen = []
    for output in OUTPUTS:
        path = os.path.join(work, "drawn.nml")
        with open(path, "w", encoding="ascii") as file:
            file.write(case(head, (output,), "&METHOD IKIN=30", "&LIMITS TANGLE=89.0"))
        subprocess.run([os.path.join(programs, "balm"), "--quiet", path], capture_output=True, text=True, check=False)
        with open(os.path.join(work, "drawn.svg"), encoding="utf-8") as file:
            svg = file.read()
        letters = set(re.findall(r'data-joint="([^"]+)"', svg))
        check("%s first: it is the output that is named" % output, "output: %s;" % output.replace(" ", "_") in svg
              or "output: %s;" % output in svg, re.findall("output: [^;<]*", svg))
        star = re.search(r'id="star"[^>]*translate\(([^)]+)\)', svg)
        at = dict(re.findall(r'data-joint="([^"]+)" transform="translate\(([^)]+)\)', svg))
        own = [word for word in output.split() if word in at]
        check("%s first: its joints have places" % output, own, at)
        if not output.startswith("angle"):
            check("%s first: it is drawn at a joint of its own" % output,
                  star is not None and star[1] in [at[word] for word in own], (star and star[1], at))
        with open(os.path.join(work, "drawn.dxf"), encoding="ascii") as file:
            seen.append((letters, set(re.findall(r"^LINK_.*", file.read(), re.M))))
        names = set(re.findall("'([^']+)'", re.search(r"JNT=(.*?), JX", head)[1]))
        check("%s first: all joints are drawn" % output, letters == names, (sorted(letters), sorted(names)))
    check("the same links, whatever is asked", all(one == seen[0] for one in seen), seen)


def desired_poses(programs, work):
    """Errors in ranking, summary and kalm are those of the desired poses: the objective is the sum of their squares."""
    wanted = ((40.0, 110.0, 0.0), (60.0, 112.0, -10.0), (80.0, 108.0, -20.0), (95.0, 98.0, -35.0))
    for output, name in (("pose P coupler", "pose_P_coupler"), ("pose P P Q", "pose_P_P_Q")):
        text = POSES % (output, *(",".join("%g" % pose[c] for pose in wanted) for c in range(3)))
        search = Run(programs, work, text)
        with open(os.path.join(work, "case.dev7"), encoding="ascii") as file:
            rates = Run(programs, work, file.read(), "kalm")
        points = [math.hypot(float(row[name + ".x"]) - x, float(row[name + ".y"]) - y) for row, (x, y, _) in zip(rates.table, wanted)]
        angles = [math.remainder(float(row[name + ".angle"]) - a, 360.0) for row, (_, _, a) in zip(rates.table, wanted)]
        both = [math.sqrt(sum(e*e for e in errors)/len(errors)) for errors in (points, angles)]
        check("%s: a linkage was found" % name, search.status == 0 and len(rates.table) == 4, search.messages)
        objective = float(re.search(r"best objective\s+(\S+)", search.messages)[1])
        check("%s: the objective is the sum of the squares" % name, abs(4.0*sum(e*e for e in both) - objective) < 1e-6*objective,
              (both, objective))
        for c, part in enumerate(("x", "y", "angle")):
            column = "%s.%s" % (name, part)
            check("%s: table, listing and device 9 of the search have it" % column, all(
                abs(float(row[column]) - float(again[column])) < 1e-9 and float(row[column + ".desired"]) == pose[c]
                for row, again, pose in zip(search.table, rates.table, wanted)) and
                far(search.block("outputs")[column], [float(row[column]) for row in search.table]) < 1e-12 and
                column[:14] in search.listing.split(" ALL OUTPUTS", 1)[1].split("\n")[1], list(search.table[0]))
        ranked = re.search(r"RMS ERROR.*\n\s+1\s+(\S+)\s+(\S+)", search.listing)
        check("%s: the ranking has their errors" % name, abs(float(ranked[1]) - both[0]) < 1e-6*both[0] and
              abs(float(ranked[2]) - max(points)) < 1e-6*max(points) and "ERRORS ARE THOSE OF " + name in search.listing, ranked[0])
        for run in (search, rates):
            told = re.findall(r"Error +%s(?:\.angle)? RMS (\S+), largest (\S+) (length units|degrees)" % name, run.messages)
            check("%s: the summary has both" % name, len(told) == 2 and [line[2] for line in told] == ["length units", "degrees"] and
                  run.messages.count("  Error  ") == 2, run.messages)
            for (rms, largest, _), one, errors in zip(told, both, (points, angles)):
                check("%s: figures of the summary" % name, abs(float(rms) - one) < 1e-4*one and
                      abs(float(largest) - max(map(abs, errors))) < 1e-4*max(map(abs, errors)), (rms, one, largest, errors))


def no_other_joint(programs, work):
    """A first output that no arc tells is what listing, summary and device 9 have; no joint is there in its stead."""
    for head, outputs, numbers, most in (
            (FOUR_BAR, ("y P",), {"y_P": lambda row: float(row["P.y"])}, "crank_angle"),
            (FOUR_BAR, ("distance B D", "angle C D"), {
                "distance_B_D": lambda row: math.hypot(float(row["B.x"]) - float(row["D.x"]), float(row["B.y"]) - float(row["D.y"]))}, "crank_angle"),
            (GRIPPER, ("distance f f2",), {
                "distance_f_f2": lambda row: math.hypot(float(row["f.x"]) - float(row["f2.x"]), float(row["f.y"]) - float(row["f2.y"]))}, "closed")):
        positions = "&METHOD IKIN=30" if head == FOUR_BAR else "&METHOD NDES=5, DELT=-2.0,-1.0,0.0,1.0,2.0"
        groups = (positions, "&LIMITS TANGLE=89.0, IPLOT=1, ICOND=1", "&TOLER TOLLEN=0.002, TOLANG=0.002, NTRIAL=50")
        for program, more in (("psalm", ()), ("kalm", ("&RATES SPEED=1.0",))):
            run = Run(programs, work, case(head, outputs, *groups, *more), program)
            law = "%s %s: " % (program, outputs[0])
            check(law + "has a result", run.status < 2 and len(run.table) > 4, run.messages)
            for part in run.parts[:2] if program == "psalm" else run.parts[:1]:
                heads = part[0].split()[1:]
                check(law + "device 9 begins without another output", heads == ["input", "closed", "crank_angle"][:2 + (most == "crank_angle")], heads)
            check(law + "none in the listing", not re.search("ACTUAL X|SPEED$|EFFECT OF TOLERANCES|BANDS OF X|HERE ARE", run.listing, re.M), run.listing)
            check(law + "none in the summary", "Output point" not in run.messages and "not shown" not in run.messages, run.messages)
            block, listed = run.block("outputs"), run.listing.split(" ALL OUTPUTS, INPUTS", 1)[1].split("\n")[2:]
            for name, of in numbers.items():
                values = [of(row) for row in run.table if row["closed"] == "1"]
                check(law + "%s in the table" % name, far([float(row[name]) for row in run.table if row["closed"] == "1"], values) < 1e-10)
                check(law + "%s on device 9" % name, far([v for v in block[name] if v == v], values) < 1e-10)
                check(law + "%s in the listing" % name, far([float(line.split()[2]) for line, row in zip(listed, run.table) if row["closed"] == "1"],
                                                            values) < 1e-3, listed[:2])
                told = re.search(r"Output +%s (\S+) to (\S+)" % name, run.messages)
                check(law + "%s in the summary" % name, told and far([float(told[1]), float(told[2])], [min(values), max(values)]) < 1e-3, run.messages)
            if program == "psalm":
                check(law + "bands of all outputs", "BANDS OF ALL OUTPUTS" in run.listing and "LINKAGES OF THE SAMPLE 50" in run.listing and
                      numbers.keys() <= {key.split(".")[0] for key in run.block("output_tolerances")}, run.listing)
    text = case(FOUR_BAR, ("y P",), "&METHOD IKIN=30", "&TOLER TOLLEN=0.002, ADJUST=1")
    path = os.path.join(work, "adjust.nml")
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    done = subprocess.run([os.path.join(programs, "psalm"), path], capture_output=True, text=True, check=False)
    check("no dimension is adjusted for another output", done.returncode == 2 and "ADJUST restores the first output, which y_P cannot be here" in
          done.stderr, done.stderr)


def bands_of_the_output_arc(programs, work):
    """Length and angle of the arc that the point of the outputs lies on deviate by their own tolerances, whatever output is first: P goes
    along B P and across it."""
    for outputs in (("distance P D", "point P"), ("point P", "distance P D")):
        for items, length, angle in (("TOLNAM='B P','angle B C B P', TOLVAL=0.1,0.2", 0.1, 0.2), ("TOLNAM='B P', TOLVAL=0.1", 0.1, 0.0),
                                     ("TOLNAM='angle B C B P', TOLVAL=0.2", 0.0, 0.2)):
            run = Run(programs, work, case(FOUR_BAR, outputs, "&METHOD IKIN=30", "&TOLER " + items))
            bands = run.block("output_tolerances")
            law = "%s first, %s: " % (outputs[0], items)
            check(law + "all outputs have bands", all(name + ".worst_case" in bands for name in ("distance_P_D", "point_P.x", "point_P.y")), run.messages)
            for k, row in enumerate(run.table):
                at = {joint: complex(float(row[joint + ".x"]), float(row[joint + ".y"])) for joint in "BDP"}
                along = at["P"] - at["B"]
                moves = (length*along/abs(along), math.radians(angle)*along*1j)
                away = at["P"] - at["D"]
                for name, parts in (("distance_P_D", [(move*away.conjugate()).real/abs(away) for move in moves]),
                                    ("point_P.x", [move.real for move in moves]), ("point_P.y", [move.imag for move in moves])):
                    check(law + "worst case of " + name, abs(bands[name + ".worst_case"][k] - sum(map(abs, parts))) < 1e-12,
                          (bands[name + ".worst_case"][k], parts))
                    check(law + "root sum square of " + name, abs(bands[name + ".root_sum_square"][k] - math.hypot(*parts)) < 1e-12)


def one_linkage_one_name(programs, work):
    """A search in poses tells a linkage by positive lengths and angles within half a turn, from whatever start it comes there."""
    seen = []
    for first in (2, 3, 4, 5):
        path = os.path.join(work, "place.nml")
        with open(path, "w", encoding="ascii") as file:
            file.write(PLACE % first)
        done = subprocess.run([os.path.join(programs, "psalm"), "--quiet", path], capture_output=True, text=True, check=False)
        found = {}
        for line in done.stdout.split("  VARIABLE ", 1)[-1].split("\n\n")[0].split("\n")[1:]:
            words = line.split()
            found[" ".join(words[:-2])] = float(words[-1].replace("D", "E"))
        check("start %d: a linkage is found" % first, done.returncode < 2 and len(found) == 4, done.stderr)
        check("start %d: lengths are positive, angles within half a turn" % first, all(
            value > 0.0 if name.startswith(("length", "distance")) else abs(value) <= 180.0 for name, value in found.items()), found)
        seen.append([found.get("distance of A"), found.get("direction of A")])
    check("the pivot is told in one way", all(far(one, seen[0]) < 1e-2 for one in seen), seen)


STRETCHED = """A DYAD THAT IS STRETCHED MORE AND MORE
 &CHAIN JNT='A','B','C','D', JX=0.0,10.0,35.0,40.0, JY=0.0,0.0,20.0,0.0,
  LNK='A D','A B','B C','C D', LENP='B C','C D', LENV=30.0,20.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point C','angle B C' &END
 &METHOD NDES=6, DELT=0.0,90.0,179.9,179.999,179.99999,179.9999999 &END
 &LIMITS ICOND=1 &END
"""


def open_digits(programs, work):
    """The listing prints no digit of an output that the bound of its error leaves open; without ICOND it prints all."""
    for name, cut in (("ICOND=1", True), ("ICOND=0", False)):
        run = Run(programs, work, STRETCHED.replace("ICOND=1", name))
        lines = run.listing.split("\n")
        head = next(k for k, text in enumerate(lines) if "ACTUAL X" in text)
        rows = [text.split()[1:3] for text in lines[head + 1:head + 1 + len(run.table)]]
        decimals = [[len(word.partition(".")[2]) for word in row] for row in rows]
        check(name + ": without an error all digits", decimals[0] == decimals[1] == [5, 5], rows)
        if not cut:
            check(name + ": all digits in every row", all(row == [5, 5] for row in decimals), rows)
            continue
        for row, shown in zip(run.table, decimals):
            bound = 16*2.0**-52*float(row["point_C.condition"])*math.hypot(float(row["point_C.x"]), float(row["point_C.y"]))
            for places in shown:
                check("digits shown are known", places == 0 or 10.0**-places >= bound, (places, bound))
                check("digits known are shown", places == 5 or 10.0**-(places + 1) < bound, (places, bound))
        check("the last row has fewer digits", decimals[-1] != [5, 5], rows)


def digits_at_any_speed(programs, work):
    """How fast the input is changes no digit of the places and angles that are listed, however large the accelerations are."""
    places = []
    for speed in (1.0, 1.0e7):
        run = Run(programs, work, case(FOUR_BAR, ("x P", "angle C D"), "&METHOD NDES=2, DELT=0.0,10.0", "&RATES SPEED=%g, UNITS='RAD/S'" % speed), "kalm")
        lines = run.listing.split("\n")
        first = next((k for k, line in enumerate(lines) if line.split()[:2] == ["POSITION", "INPUT"]), len(lines))
        heads = lines[first].split() if first < len(lines) else []
        columns = [k - 1 for k, head in enumerate(heads) if head in ("x_P", "angle_C_D")]
        places.append([[line.split()[k] for k in columns] for line in lines[first + 1:first + 3]])
    check("places listed at every speed", len(places[0]) == 2 and len(places[0][0]) == 2 and places[0] == places[1], places)


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as work:
        desired_poses(programs, work)
        no_other_joint(programs, work)
        bands_of_the_output_arc(programs, work)
        one_linkage_one_name(programs, work)
        open_digits(programs, work)
        digits_at_any_speed(programs, work)
        for head in (FOUR_BAR, SIX_BAR):
            groups = ("&METHOD IKIN=30", "&LIMITS TANGLE=89.0, IPLOT=1, ICOND=1", "&TOLER TOLLEN=0.002, TOLANG=0.002, NTRIAL=20000")
            outputs, numbers = OUTPUTS, NUMBERS
            run = Run(programs, work, case(head, outputs, *groups))
            check("psalm has a result", run.status < 2 and len(run.table) == 12, run.messages)
            if head == FOUR_BAR:
                zero(run)
            closed = all(row["closed"] == "1" for row in run.table)
            check("it turns fully", closed, run.messages)
            every_degree(run, numbers, 30)
            sample(run, numbers)
            rates = Run(programs, work, case(head, outputs, *groups[:2], "&RATES SPEED=1.0"), "kalm")
            conditions(run, rates, numbers)
            drawn_whole(programs, work, head)
            # the order of the outputs changes no number
            other = Run(programs, work, case(head, outputs[::-1], *groups))
            for name in numbers:
                check("%s whatever is asked first" % name, [row[name] for row in other.table] == [row[name] for row in run.table])
                one, two = run.block("output_tolerances"), other.block("output_tolerances")
                for what in ("worst_case", "lowest", "std_deviation"):
                    a, b = one["%s.%s" % (name, what)], two["%s.%s" % (name, what)]
                    # the sample draws for the dimensions of another first output in another order
                    check("%s.%s whatever is asked first" % (name, what), far(a, b) < (1e-12 if what == "worst_case" else 0.1)*max(map(abs, a)),
                          (a[:2], b[:2]))
    return report()


if __name__ == "__main__":
    sys.exit(main())
