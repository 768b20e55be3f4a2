#!/usr/bin/env python3
"""Every study of a six-bar whose coupler, rockers and rod are one group of four links, against a solver in coordinates.

usage: larger_groups.py BIN   (directory with the programs). The last line is N passed, N failed.

The linkage is data/stephenson3_rod_driven.nml. Here its four loops' angles follow from Newton's method along the turn of the crank;
what the programs say about tolerances, settings, forces, counterweights, springs, a vibrating rod, a clearance, dead points and
proven limits is computed again from positions and differences of them.
"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import results
from data_sets import without
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CASE = open(os.path.join(TOP, "data", "stephenson3_rod_driven.nml"), encoding="utf-8").read()
JOINTS = dict(A=0j, B=-25 + 45j, C=35 + 55j, D=75 + 0j, P=10 + 80j, E=120 + 70j, F=127 + 74j)
SPEED = 10.0*math.pi                  # rad/s
MM = 1e-3
GRAVITY = -9.81j


class SixBar:
    """Lengths from the drawing, or others; `deviations` of FE, EP, PB, BA, BC, CD."""

    def __init__(self, joints=None, deviations=(0.0,)*6):
        j = self.joints = joints or JOINTS
        names = ("FE", "EP", "PB", "BA", "BC", "CD")
        self.length = {n: abs(j[n[1]] - j[n[0]]) + d for n, d in zip(names, deviations)}
        self.bend = np.angle((j["C"] - j["B"])/(j["P"] - j["B"]))
        self.drawn = np.angle(j["E"] - j["F"])
        self.start = np.array([np.angle(j[b] - j[a]) for a, b in ("AB", "BP", "DC", "EP")])

    def places(self, crank, x):
        """Joints from the angles of left, coupler (B to P), rocker and rod (E to P)."""
        q, turn = self.length, np.exp(1j*np.asarray(x))
        b = self.joints["A"] + q["BA"]*turn[0]
        e = self.joints["F"] + q["FE"]*np.exp(1j*crank)
        return dict(A=self.joints["A"], D=self.joints["D"], F=self.joints["F"], B=b, E=e, P=e + q["EP"]*turn[3],
                    C=self.joints["D"] + q["CD"]*turn[2], p=b + q["PB"]*turn[1],
                    c=b + q["BC"]*turn[1]*np.exp(1j*self.bend))

    def gaps(self, crank, x):
        at = self.places(crank, x)
        return np.array([f(at[a] - at[b]) for a, b in ("Pp", "Cc") for f in (np.real, np.imag)])

    def solve(self, crank, x):
        """Newton's method from x; None where it goes far away or nowhere."""
        start = x
        for _ in range(30):
            gap, h = self.gaps(crank, x), 1e-6
            jacobian = np.column_stack([(self.gaps(crank, x + h*u) - self.gaps(crank, x - h*u))/(2.0*h) for u in np.eye(4)])
            step = np.linalg.solve(jacobian, gap)
            x = x - step
            if max(abs(x - start)) > 0.5:
                return None
            if max(abs(step)) < 1e-13:
                return x
        return x if max(abs(step)) < 1e-10 else None

    def turn(self, increments):
        """Places at increments from the drawing, in degrees, the first near it."""
        x, result = self.start, []
        for d in increments:
            x = self.solve(self.drawn + math.radians(d), x)
            result.append(self.places(self.drawn + math.radians(d), x))
        return result


def run(program, text, work, name="case", options=()):
    with open(os.path.join(work, name + ".nml"), "w", encoding="utf-8") as f:
        f.write(text)
    done = subprocess.run([os.path.join(BIN, program), *options, "--output-dir", work, name + ".nml"], cwd=work, capture_output=True, text=True)
    return done


def read(work, name):
    with open(os.path.join(work, name), encoding="utf-8") as f:
        return f.read()


def rows_of(work, name="case.csv"):
    with open(os.path.join(work, name), encoding="utf-8") as f:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(f)]


def block(text, name):
    """Rows of words of a block of device 9."""
    part = text.split("# block " + name + "\n", 1)[1].split("\n\n", 1)[0]
    return [line.split() for line in part.splitlines() if line and not line.startswith("#")]


def replaced(text, old, new):
    assert old in text, old
    return text.replace(old, new)


def positions(work):
    bar = SixBar()
    done = run("psalm", CASE, work)
    check("psalm runs", done.returncode == 0, done.stderr)
    check("summary: it turns fully", "over the full turn of the crank" in done.stderr, done.stderr)
    margin = re.search(r"DEAD POINT OF ITS GROUP \(1 IS BEST\) +(\S+) +(\S+)", done.stdout).groups()
    told = re.search(r"Larger group +in the group of joints .+ at least (\S+) from a dead point \(1 is best\), at input (\S+)", done.stderr).groups()
    check("summary and margins agree how near a dead point is", all(abs(float(a) - float(b)) < 1e-3*float(b) for a, b in zip(told, margin)),
          (told, margin))
    own = bar.turn(range(0, 360, 15))
    for i, row in enumerate(rows_of(work)):
        for joint in "ABCDEFP":
            gap = abs(complex(row[joint + ".x"], row[joint + ".y"]) - own[i][joint])
            check("place of %s at position %d" % (joint, i + 1), gap < 1e-9, gap)
        angle = math.degrees(np.angle(own[i]["C"] - own[i]["D"])) - row["angle_D_C"]
        check("angle of the rocker at position %d" % (i + 1), abs((angle + 180.0) % 360.0 - 180.0) < 1e-9, angle)
    return done.stdout, own


def tolerances(listing, work):
    """Linear effects of six lengths against linkages that are a little longer."""
    lengths, step = ("E F", "E P", "B P", "A B", "B C", "C D"), 1e-4
    effects = {m[1]: float(m[2].replace("D", "E"))
               for m in re.finditer(r" LENGTH (\w \w) +\S+ +(\S+) +\d+\n", listing.split("BANDS OF")[0])}
    for k, name in enumerate(lengths):
        both = [SixBar(deviations=[s*step*(i == k) for i in range(6)]).turn(range(0, 360, 15)) for s in (1, -1)]
        change = [(a["P"] - b["P"])/(2.0*step)*0.05 for a, b in zip(*both)]
        largest = max(max(abs(c.real), abs(c.imag)) for c in change)
        found = effects.get(name, 0.0)
        check("largest effect of the length %s" % name, any(abs(abs(found) - v) < 1e-5 for v in (largest, max(map(abs, change)))),
              (found, largest))
    nine = read(work, "case.dev9")
    part = nine.split("# tolerances: linear bands", 1)[1].split("\n\n", 1)[0]
    for line in part.splitlines()[1:]:
        v = [float(x) for x in line.split()]
        check("the sample's deviation is that of the linear band", abs(v[8]*math.sqrt(3.0)/v[4] - 1.0) < 0.1, v[:9])


def settings(work):
    """Lengths of the rod from 108 to 112."""
    rows = block(read(work, "case.dev9"), "sweep")
    check("five settings of a turn", len(rows) == 5*24, len(rows))
    rod = SixBar().length["EP"]
    for k in range(5):
        bar = SixBar(deviations=(0.0, 108.0 + k - rod, 0.0, 0.0, 0.0, 0.0))
        x = bar.start
        for part in np.linspace(0.0, 1.0, 11):        # the drawing with another rod, step by step
            bar.length["EP"] = rod + part*(108.0 + k - rod)
            x = bar.solve(bar.drawn, x)
        bar.start = x
        for own, row in zip(bar.turn(range(0, 360, 15)), rows[24*k:24*k + 24]):
            gap = abs(complex(float(row[3]), float(row[4])) - own["P"])
            check("setting %d" % (k + 1), row[2] == "1" and gap < 1e-9, gap)


def proven(work):
    """Proven ranges of the outputs against every tenth of a degree."""
    fine = SixBar().turn(np.arange(0.0, 360.0, 0.1))
    for name, value in (("point_P.x", lambda at: at["P"].real), ("point_P.y", lambda at: at["P"].imag),
                        ("angle_D_C", lambda at: math.degrees(np.angle(at["C"] - at["D"])))):
        row = next(r for r in block(read(work, "case.dev9"), "extremes") if r[0] == name)
        v = [float(x) for x in row[3:]]
        own = [value(at) for at in fine]
        check("%s is nowhere below its bound" % name, v[0] <= min(own) and min(own) - v[0] < 1e-4, (v, min(own)))
        check("%s is nowhere above its bound" % name, v[4] >= max(own) and v[4] - max(own) < 1e-4, (v, max(own)))
        for at, extreme in ((v[2], min(own)), (v[5], max(own))):
            crank = math.radians(at)
            nearest = min(range(len(fine)), key=lambda i: abs(np.angle(np.exp(1j*(crank - math.radians(0.1*i))))))
            check("%s is extreme where it is said, inputs from the drawing" % name, abs(own[nearest] - extreme) < 1e-3, (at, extreme))


# masses as the data set has them: link, anchor, next joint, distance, angle, mass, inertia
MASSES = (("A", "B", 20.0, 0.0, 0.4, 1e-4), ("B", "C", 40.0, 20.0, 1.2, 5e-4), ("C", "D", 25.0, 0.0, 0.6, 2e-4),
          ("F", "E", 2.0, 180.0, 0.7, 1e-4))


def centre(at, mass):
    a, b, distance, angle = mass[:4]
    return at[a] + distance*np.exp(1j*math.radians(angle))*(at[b] - at[a])/abs(at[b] - at[a])


def forces(work):
    """Torque of the drive from the balance of power, force on the frame from that of momentum."""
    text = without(CASE, "LIMITS", "TOLER", "SWEEP", "CONSTR")
    done = run("kalm", text, work)
    check("kalm runs", done.returncode == 0, done.stderr)
    rows, bar, h = rows_of(work, "case.kalm.csv"), SixBar(), 0.02     # degrees
    for i, row in enumerate(rows):
        around = bar.turn(np.concatenate([np.arange(0, 15*i, 5.0), 15*i + h*np.array([-2, -1, 0, 1, 2])]))[-5:]
        dt = math.radians(h)/SPEED

        def rate(f):
            v = [f(a) for a in around]
            return (8.0*(v[3] - v[1]) - (v[4] - v[0]))/(12.0*dt)

        def second(f):
            v = [f(a) for a in around]
            return (16.0*(v[3] + v[1]) - (v[4] + v[0]) - 30.0*v[2])/(12.0*dt*dt)

        torque, momentum = 0.0, 0j
        for mass in MASSES:
            g = lambda a: centre(a, mass)*MM
            spin = lambda a: np.angle((a[mass[1]] - a[mass[0]])/(around[2][mass[1]] - around[2][mass[0]]))
            torque += mass[4]*(rate(g).conjugate()*(second(g) - GRAVITY)).real + mass[5]*rate(spin)*second(spin)
            momentum += mass[4]*(second(g) - GRAVITY)
        load = 30.0 - 10.0j
        torque -= (rate(lambda a: a["C"]*MM)*load.conjugate()).real
        spring = lambda a: 0.5*200.0*((abs(a["P"] - a["A"]) - 40.0)*MM)**2
        torque += rate(spring)
        check("torque of the drive from powers at position %d" % (i + 1), abs(torque/SPEED - row["drive"]) < 1e-5*0.2,
              (torque/SPEED, row["drive"]))
        # the spring pulls the frame as it pulls the coupler: what the frame bears is the rest of the outer forces
        frame = load - momentum
        gap = abs(complex(row["frame_fx"], row["frame_fy"]) - frame)
        check("force on the frame from momentum at position %d" % (i + 1), gap < 1e-3, (row["frame_fx"], row["frame_fy"], frame))
    return rows


def counterweights(work):
    """With the weights found the common centre of mass stands still; kalm on device 7 has the forces that muscle has."""
    done = run("muscle", without(CASE, "SPRNGS"), work, options=["--json"])
    check("counterweights are found", done.returncode == 0, done.stderr)
    found = results.counterweights(results.cases_of(os.path.join(work, "case.muscle.json"))[0])["designs"][0]
    weights = {w["link"]: [w["mass"], w["distance"], w["angle"]] for w in found["weights"]}
    anchor = dict(left="AB", rocker="DC", crank="FE")
    check("weights on three links", set(weights) == set(anchor), weights)
    added = [(anchor[k][0], anchor[k][1], v[1], v[2] + turn_of(k), v[0], 0.0) for k, v in weights.items()]
    middle = [sum(m[4]*centre(at, m) for m in MASSES + tuple(added)) for at in SixBar().turn(range(0, 360, 15))]
    check("with the counterweights the centre of mass stands still", max(abs(m - middle[0]) for m in middle) < 2e-9,
          max(abs(m - middle[0]) for m in middle))


def turn_of(link):
    """Angles are counted from the line of the link's first two joints: of rocker and crank the other way."""
    return 180.0 if link in ("rocker", "crank") else 0.0


def springs(work):
    """What kalm finds with the spring is what muscle says of it."""
    done = run("muscle", without(CASE, "BALANC"), work)
    check("a spring is found", done.returncode == 0, done.stderr)
    before, after = (float(x.replace("D", "E")) for x in re.search(r"BEFORE +(\S+) +AFTER +(\S+)", done.stdout).groups())
    ranges = []
    for text in (CASE, read(work, "case.muscle.dev7")):
        run("kalm", text, work, "sprung")
        drive = [row["drive"] for row in rows_of(work, "sprung.kalm.csv")]
        ranges.append(max(drive) - min(drive))
    check("range of the drive torque before", abs(ranges[0]/before - 1.0) < 1e-6, (ranges, before))
    check("range of the drive torque after", abs(ranges[1]/after - 1.0) < 1e-6, (ranges, after))


def vibration(work):
    """The load at the rod's ends is what kalm finds with the same mass on it."""
    done = run("ssics", CASE, work)
    check("ssics runs", done.returncode == 0, done.stderr)
    most = float(re.search(r"GREATEST END LOAD, EULER'S LOAD +(\S+)", done.stdout)[1].replace("D", "E"))
    length = SixBar().length["EP"]
    mass = 7850.0*0.004*0.01*length*MM
    text = replaced(CASE, "NMASS=4", "NMASS=5")
    for item, value in (("MNAME='left'", "MNAME='rod',"), ("MASS=0.4", "MASS=%.15g," % mass), ("MDIST=20.0", "MDIST=%.15g," % (length/2)),
                        ("MANG=0.0", "MANG=0.0,"), ("MINERT=1E-4", "MINERT=%.15g," % (mass*(length*MM)**2/12.0))):
        name, first = item.split("=")
        text = replaced(text, " " + item, " " + value + first)
    text = replaced(text, "IKIN=15", "IKIN=1")
    run("kalm", text, work, "rod")
    loads = []
    for row in rows_of(work, "rod.kalm.csv"):
        along = complex(row["E.x"] - row["P.x"], row["E.y"] - row["P.y"])/length
        p, e = (complex(row[j + "_fx"], row[j + "_fy"]) for j in "PE")
        loads.append(0.5*abs((p*along.conjugate()).real) + 0.5*abs((e*along.conjugate()).real))
    check("greatest load at the rod's ends", abs(max(loads)/most - 1.0) < 1e-3, (max(loads), most))


def clearance(work):
    """The loads of the joint without clearance are those of kalm."""
    done = run("bridge", CASE, work)
    check("bridge runs", done.returncode == 0, done.stderr)
    found = re.findall(r"^ +(\d\S*) +(\S+) +\S+ +\S+ +\S+ +\S+ +\S+ +CONTACT", done.stdout, re.M)
    check("minima of the load", len(found) == 2, done.stdout)
    inputs = [float(f[0]) for f in found]
    text = replaced(without(CASE, "LIMITS", "TOLER", "SWEEP", "CONSTR"), "IKIN=15", "NDES=%d, DELT=%s" % (
        len(inputs), ",".join("%.9g" % x for x in inputs)))
    run("kalm", text, work, "clear")
    for row, (where, load) in zip(rows_of(work, "clear.kalm.csv"), found):
        own = math.hypot(row["C_fx"], row["C_fy"])
        check("load of C at %s" % where, abs(own - float(load)) < 1e-5*own, (own, load))


def pictures(work):
    done = run("balm", CASE, work)
    check("balm runs", done.returncode == 0, done.stderr)
    page = read(work, "case.html")
    marks = [json.loads(m) for m in re.findall(r'\{"kind":"extreme".*?\}(?=\n)', page)]
    check("the page has the proven extremes, the velocity ratio's, too", len(marks) == 8, marks)
    bar = SixBar()
    for mark in marks:
        increment = mark["input"] % 360.0
        at = bar.turn(np.append(np.arange(0.0, increment, 5.0), increment))[-1]["P"]
        check("the mark of an extreme is on the path", abs(complex(*mark["at"]) - at) < 1e-6, (mark, at))
    for name in ("case.svg", "case.dxf"):
        check("%s is written" % name, os.path.getsize(os.path.join(work, name)) > 1000)


def dead_points(work):
    """Another pivot and a longer crank: the group comes to dead points, and nothing is told of what lies beyond them."""
    other = dict(JOINTS, B=10 + 45j, C=60 + 55j, P=45 + 80j, F=128 + 66j)
    text = without(CASE, "TOLER", "SWEEP", "CONSTR", "MASSES", "LOADS", "SPRING", "BALANC", "SPRNGS", "ESTIM", "VIBR", "CLEAR")
    text = re.sub(r"JX=.*?,\s*LNAME", "JX=%s, JY=%s, LNAME" % (",".join("%g" % other[j].real for j in "ABCDPEF"),
                                                            ",".join("%g" % other[j].imag for j in "ABCDPEF")), text, flags=re.S)
    done = run("psalm", text, work, "dead")
    check("a dead point ends the motion: exit status 1", done.returncode == 1, done.stderr)
    check("the group is named", "GROUP OF LINKS rod, coupler, left, rocker" in done.stderr, done.stderr)
    low, high = (float(x) for x in re.search(r"from input (\S+) to (\S+) only", done.stderr).groups())
    bar, reached = SixBar(other), {}
    for sense in (1, -1):
        x, step, d = bar.start, 0.5, 0.0
        reached[sense] = []
        while step > 1e-7:
            new = bar.solve(bar.drawn + sense*math.radians(d + step), x)
            if new is None or max(abs(new - x)) > 0.1:
                step *= 0.5
                continue
            d, x = d + step, new
            reached[sense].append(bar.places(bar.drawn + sense*math.radians(d), x)["P"])
        end = sense*d % 360.0
        check("the end of the motion", abs(end - (high if sense > 0 else low)) < 2e-2, (end, low, high))
    path = np.array(reached[1] + reached[-1])
    x, y = re.search(r"Output point +x (\S+ to \S+), y (\S+ to \S+) ", done.stderr).groups()
    for words, own in ((x, path.real), (y, path.imag)):
        told = [float(v) for v in words.split(" to ")]
        check("ranges of the output end at the dead points", abs(told[0] - min(own)) < 0.05 and abs(told[1] - max(own)) < 0.05,
              (words, min(own), max(own)))
    for kind, start, finish, *_ in block(read(work, "dead.dev9"), "limits"):
        if kind == "closes":
            check("the proven range ends at the dead point", min(abs(float(finish) % 360.0 - v) for v in (low, high)) < 1e-2, (finish, low, high))
    balm = run("balm", text, work, "dead")
    check("balm: exit status 1", balm.returncode == 1, balm.stderr)
    for m in re.findall(r'\{"kind":"(?:opens|extreme)".*?\}(?=\n)', read(work, "dead.html")):
        at = complex(*json.loads(m)["at"])
        check("a mark at a dead point is on the path", min(abs(path - at)) < 0.2, (m, min(abs(path - at))))
    # rounded so that what is said stays true: not beyond what closes, not before what opens
    told = re.findall(r"proven: (closes from the drawing to|opens at) (-?[0-9.]+)", read(work, "dead.html"))
    rows = [(row[0], float(row[2])) for row in block(read(work, "dead.dev9"), "limits") if row[0] in ("closes", "undecided")]
    check("the words of the page are rounded the safe way", len(told) == len(rows) == 4 and all(
        words.startswith("closes") and abs(float(number)) <= abs(end) if kind == "closes" else words == "opens at" and abs(float(number)) >= abs(end)
        for (words, number), (kind, end) in zip(told, rows)), (told, rows))


PRESSED = """PRESSED TO A DEAD POINT
 &CHAIN JNT='A','B','C','D','E','F','G', JX=0.0,0.0,40.0,80.0,45.0,85.0,100.0, JY=0.0,30.0,60.0,55.0,30.0,20.0,0.0,
  LNAME='frame','crank','left','top','right','tie', LNK='A G','A B','B C E','C D','D F G','E F', VARY='C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point D' &END
 &METHOD NDES=3, DELT=0.0,-2.0,-4.0%s &END
"""


def distance_kept(work):
    """A search whose targets lie beyond a dead point comes no nearer to it than to a fiftieth of what the linkage given is away."""
    away = lambda done: float(re.search(r"Larger group +in the group of joints .+ at least (\S+) from a dead point", done.stderr).group(1))
    given = away(run("psalm", (PRESSED % "").replace(", VARY='C D'", ""), work))
    for x, y in ((150.0, 30.0), (60.0, 60.0)):
        targets = ", DESX=%r,%r,%r, DESY=%r,%r,%r &END\n &SEARCH SOLVER='LSQ'" % (x, x, x, y, y, y)
        found = away(run("psalm", PRESSED % targets, work))
        check("a search keeps its distance from a dead point, targets at %r" % x, found > 0.0199*given, (given, found))


def main():
    with tempfile.TemporaryDirectory() as work:
        listing, _ = positions(work)
        tolerances(listing, work)
        settings(work)
        proven(work)
        forces(work)
        counterweights(work)
        springs(work)
        vibration(work)
        clearance(work)
        pictures(work)
        dead_points(work)
        distance_kept(work)
    return report()


sys.exit(main())
