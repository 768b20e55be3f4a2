#!/usr/bin/env python3
"""Moments out of the plane of masses at heights above it: kalm and muscle against a balance of momentum in space.

usage: test/law/out_of_plane.py PROGRAM_DIRECTORY

The angular momentum of every mass about the machine origin, with its height, is differentiated numerically: places come from closed
forms of a four-bar and a slider-crank, written here anew. What the frame takes is minus its rate, plus the moment of weight. With the
weights that muscle finds the same balance gives the moments it lists, and no other choice of weights found by SciPy has less. Last
line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import minimize

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
STEP = 2e-3             # s/1000, of differences
SPEED = 30.0            # rad/s
GRAVITY = numpy.array([0.3, -9.81, 0.0])
FOUR_BAR = """FOUR-BAR
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=40.0,120.0,80.0,130.0, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=10 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=30.0 &END
 &MASSES NMASS=4, MLINK=-1,-2,-2,3, MLOOP=4*1, MASS=0.5,1.5,0.2,0.9, MDIST=10.0,60.0,90.0,40.0, MANG=0.0,20.0,-100.0,180.0,
  MZ=-12.0,%s30.0,25.0, MINERT=1E-4,2E-3,0.0,5E-4, UNITL=0.001, GRAVX=0.3, GRAVY=-9.81 &END
"""
SKETCH = """FOUR-BAR AS A SKETCH
 &CHAIN JNT='A','B','C','D', JX=0.0,40.0,%.15g,130.0, JY=0.0,0.0,%.15g,0.0, LNAME='frame','crank','coupler','rocker',
  LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle C D' &END
 &METHOD IKIN=10 &END
 &RATES SPEED=30.0 &END
 &MASSES NMASS=4, MNAME='crank A','coupler B','coupler B','rocker C', MASS=0.5,1.5,0.2,0.9, MDIST=10.0,60.0,90.0,40.0,
  MANG=0.0,20.0,-100.0,0.0, MZ=-12.0,8.0,30.0,25.0, MINERT=1E-4,2E-3,0.0,5E-4, UNITL=0.001, GRAVX=0.3, GRAVY=-9.81 &END
"""


def joints(turn):
    crank = 40.0 * cmath.exp(1j * turn)
    diagonal = 130.0 - crank
    length = abs(diagonal)
    return crank, crank + 120.0 * diagonal / length * cmath.exp(-1j * math.acos((length ** 2 + 120.0 ** 2 - 80.0 ** 2) / (2 * length * 120.0)))


def masses(turn, added=()):
    """Mass and place in space, metres, of every mass; `added`: link, mass, x, y, z, from A, B, D along the link's line."""
    b, c = joints(turn)
    axes = {"crank": (0.0, b / abs(b)), "coupler": (b, (c - b) / abs(c - b)), "rocker": (130.0, (c - 130.0) / abs(c - 130.0))}
    found = []
    for link, mass, x, y, z in (("crank", 0.5, 10.0, 0.0, -12.0), ("coupler", 1.5, 60.0 * math.cos(math.radians(20)), 60.0 * math.sin(math.radians(20)), 8.0),
                                ("coupler", 0.2, 90.0 * math.cos(math.radians(-100)), 90.0 * math.sin(math.radians(-100)), 30.0),
                                ("rocker", 0.9, 40.0, 0.0, 25.0), *added):
        place = axes[link][0] + complex(x, y) * axes[link][1]
        found.append((mass, 0.001 * numpy.array([place.real, place.imag, z])))
    return found


def moments(turn, weight, added=()):
    """What the frame takes about x, y: minus the rate of the angular momentum, and the moment of weight."""
    h = STEP * 1e-3

    def momentum(t):
        before, after = masses(SPEED * (t - h), added), masses(SPEED * (t + h), added)
        return sum(m * numpy.cross((r + s) / 2, (s - r) / (2 * h)) for (m, r), (_, s) in zip(before, after))

    now = turn / SPEED
    rate = (momentum(now + 20 * h) - momentum(now - 20 * h)) * 8 / (12 * 20 * h) - (momentum(now + 40 * h) - momentum(now - 40 * h)) / (12 * 20 * h)
    static = sum(m * numpy.cross(r, GRAVITY) for m, r in masses(turn, added)) if weight else 0.0
    return (static - rate)[:2]


def run(place, name, text, program, *options):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, program), *options, name + ".nml"], cwd=place, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def rows(place, name):
    with open(os.path.join(place, name), encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main():
    turns = [math.radians(10.0 * k) for k in range(36)]
    joint = joints(0.0)[1]
    sketch = SKETCH % (joint.real, joint.imag)
    with_weight = numpy.array([moments(t, True) for t in turns])
    shaking = numpy.array([moments(t, False) for t in turns])
    size = numpy.abs(with_weight).max()
    with tempfile.TemporaryDirectory() as place:
        for name, text in (("loops", FOUR_BAR % "8.0,"), ("sketch", sketch)):
            status, listing, words = run(place, "one", text, "kalm", "--json")
            got = numpy.array([[float(row["frame_qx"]), float(row["frame_qy"])] for row in rows(place, "one.kalm.csv")])
            check(name + ": kalm's moments out of the plane are those of momentum in space", status == 0
                  and numpy.abs(got - with_weight).max() < 1e-5 * size, numpy.abs(got - with_weight).max() / size)
            check(name + ": they are listed and sized", "FRAME QX" in listing and "FRAME QY" in listing.split("FOR SIZING")[1], listing[:200])
            anchors = ("'crank A','rocker D'" if name == "sketch" else "")
            links = "WNAME=" + anchors if anchors else "WLINK=-1,3, WLOOP=1,1"
            group = " &BALANC NWEIGH=2, %s, WREACH=60.0, WMOST=0.25, WZ=40.0,-35.0, %s &END\n"
            run(place, "two", text + group % (links, "TOLQ=1.0, WFORM='BODY'"), "muscle", "--json")
            loads = {(row["outcome"], row["load"]): row for row in rows(place, "two.muscle.loads.csv")}
            before = loads["before", "out_of_plane_moment"]
            rms = math.sqrt(numpy.mean(shaking ** 2))
            check(name + ": muscle's RMS before, of inertia alone", abs(float(before["rms"]) - rms) < 1e-5 * rms
                  and abs(float(before["peak"]) - numpy.sqrt((shaking ** 2).sum(1)).max()) < 1e-5 * size, (before, rms))
            weights = [row for row in rows(place, "two.muscle.weights.csv") if row["outcome"] == "optimum"]
            after = float(loads["optimum", "out_of_plane_moment"]["rms"])
            added = []
            for row in weights:
                link = "rocker" if float(row["height"]) < 0 else "crank"
                angle = math.radians(float(row["angle"]))
                if link == "rocker":
                    angle += math.pi           # its line runs from the coupler to the frame
                added.append((link, float(row["mass"]), float(row["distance"]) * math.cos(angle), float(row["distance"]) * math.sin(angle),
                              float(row["height"])))
            found = numpy.array([moments(t, False, added) for t in turns])
            check(name + ": the weights found give the RMS listed", len(added) == 2
                  and abs(math.sqrt(numpy.mean(found ** 2)) - after) < 1e-4 * rms, (added, math.sqrt(numpy.mean(found ** 2)), after))

            # another minimiser, over the first moments of both weights; their mass moves nothing at a fixed anchor
            unit = {}
            for link, z in (("crank", 40.0), ("rocker", -35.0)):
                for k, at in enumerate(((1.0, 0.0), (0.0, 1.0))):
                    unit[link, k] = numpy.array([moments(t, False, ((link, 1.0, *at, z),)) for t in turns]) - numpy.array(
                        [moments(t, False, ((link, 1.0, 0.0, 0.0, z),)) for t in turns])
            columns = numpy.array([unit[key].ravel() for key in unit]).T
            most = 60.0 * 0.25
            best = minimize(lambda x: numpy.mean((shaking.ravel() + columns @ x) ** 2), numpy.zeros(4), method="SLSQP", options={"ftol": 1e-15},
                            constraints=[{"type": "ineq", "fun": lambda x, k=k: most ** 2 - x[k] ** 2 - x[k + 1] ** 2} for k in (0, 2)])
            check(name + ": SciPy finds no less", after > 0.01 * rms and abs(after - math.sqrt(best.fun)) < 1e-4 * rms,
                  (after, math.sqrt(best.fun)))
            with open(os.path.join(place, "two.muscle.dev7"), encoding="utf-8") as file:
                text_again = file.read()
            run(place, "again", text_again, "kalm", "--json")
            got = numpy.array([[float(row["frame_qx"]), float(row["frame_qy"])] for row in rows(place, "again.kalm.csv")])
            expected = numpy.array([moments(t, True, added) for t in turns])
            check(name + ": kalm has the same with the weights of device 7", numpy.abs(got - expected).max() < 1e-4 * size,
                  numpy.abs(got - expected).max() / size)
            peak = float(before["peak"])
            status, listing, words = run(place, "most", text + group.replace("0.25", "2.0") % (links, "MAXQ=%g" % (0.6 * peak)), "muscle", "--json")
            limit = rows(place, "most.muscle.load_limits.csv")[0]
            check(name + ": MAXQ is kept with the least mass", status == 0 and limit["load"] == "out_of_plane_moment"
                  and abs(float(limit["peak"]) - 0.6 * peak) < 1e-4 * peak, (status, limit, words))
        in_plane = sketch.replace("MZ=-12.0,8.0,30.0,25.0, ", "")
        status, listing, _ = run(place, "no", in_plane, "kalm")
        check("without heights nothing is listed", status == 0 and "QX" not in listing)
        for item in ("TOLQ=1.0", "MAXQ=1.0"):
            status, _, words = run(place, "no", in_plane + " &BALANC NWEIGH=0, WREACH=60.0, %s &END\n" % item, "muscle")
            check(item + " without heights is refused", status == 2 and "give heights, MZ of &MASSES or WZ" in words, words)
        status, _, words = run(place, "no", sketch.replace("&RATES SPEED=30.0", "&TIME TEND=0.01 &END\n &RATES SPEED=30.0"), "kalm")
        check("a motion in time says that it does not have them", "has no effect on a motion in time" in words, (status, words[:600]))
    return report()


sys.exit(main())
