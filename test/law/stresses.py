#!/usr/bin/env python3
"""Stresses of a vibrating link at low speed against statics of a beam, and along the link against its joint loads.

usage: test/law/stresses.py PROGRAM_DIRECTORY

Far below its frequency a link bends as a beam at rest under the load of its own inertia and weight, which is linear along it: its
bending moment is a cubic, and its pull that of equilibrium of the part beyond a section. The motion is that of a four-bar in closed form,
written here anew; what holds the coupler at its far end follows from the equilibrium of the rocker. Last line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
SPEED, GRAVITY = 12.0, -9.81
CRANK, COUPLER, ROCKER, FRAME = 0.06, 0.30, 0.14, 0.32
MODULUS, DENSITY, DEPTH, WIDTH = 207e9, 7850.0, 0.010, 0.008
MASS, INERTIA, CENTRE = 0.7, 2.0e-3, 0.06            # of the rocker: its centre from its pivot
CASE = """FOUR-BAR WITH A STEEL COUPLER
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=0.06,0.30,0.14,0.32, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=15 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=%g &END
 &MASSES NMASS=1, MLINK=3, MLOOP=1, MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3, GRAVY=-9.81 &END
 &VIBR VLINK=2, VLOOP=1, VMOD=207E9, VRHO=7850.0, VDEPTH=0.010, VWIDTH=0.008, VZETA=0.02, NMODE=%d, NVPNT=256, ISTRSS=1%s &END
"""
SKETCH = """FOUR-BAR WITH A STEEL COUPLER, SKETCH
 &CHAIN JNT='A','B','C','D', JX=0.0,0.06,%.15g,0.32, JY=0.0,0.0,%.15g,0.0, LNAME='frame','crank','coupler','rocker',
  LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle C D' &END
 &METHOD IKIN=15 &END
 &RATES SPEED=12.0 &END
 &MASSES NMASS=1, MNAME='rocker D', MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3, GRAVY=-9.81 &END
 &VIBR VNAME='coupler', VMOD=207E9, VRHO=7850.0, VDEPTH=0.010, VWIDTH=0.008, VZETA=0.02, NMODE=9, NVPNT=256, ISTRSS=1 &END
"""


def joints(turn):
    b = CRANK * cmath.exp(1j * turn)
    length = abs(FRAME - b)
    c = b + COUPLER * (FRAME - b) / length * cmath.exp(-1j * math.acos((length ** 2 + COUPLER ** 2 - ROCKER ** 2) / (2 * length * COUPLER)))
    return b, c


def second(function, turn, step=2e-3):
    return SPEED ** 2 * (-function(turn + 2 * step) + 16 * function(turn + step) - 30 * function(turn) + 16 * function(turn - step)
                         - function(turn - 2 * step)) / (12 * step ** 2)


def stresses(turn):
    """Greatest bending along the coupler, pull or push of the largest amount, and both together, Pa."""
    b, c = joints(turn)
    e = (c - b) / COUPLER
    start = second(lambda t: joints(t)[0], turn) - 1j * GRAVITY       # acceleration less gravity
    finish = second(lambda t: joints(t)[1], turn) - 1j * GRAVITY
    mu = DENSITY * DEPTH * WIDTH
    # the load across the link is -mu times the acceleration across it; each end bears what moments of the whole ask for
    p, q = (-mu * (z * e.conjugate()).imag for z in (start, finish))
    left = COUPLER * (2 * p + q) / 6                                  # what the pins push back with, across
    # the rocker about its pivot: force R of the coupler on it at C
    direction = (c - FRAME) / ROCKER
    angle = second(lambda t: cmath.phase((joints(t)[1] - FRAME) / direction), turn)
    arm = direction * CENTRE
    torque = (INERTIA + MASS * CENTRE ** 2) * angle - MASS * (arm.conjugate() * 1j * GRAVITY).imag
    # R = -(across part of the pin's force on the coupler) and along part from the moment about D
    across = -(-COUPLER * (p + 2 * q) / 6)                            # on the rocker, of the force across the coupler
    lever = (ROCKER * direction).conjugate()
    along = (torque - (lever * across * 1j * e).imag) / (lever * e).imag
    pull = -along                                                     # of the rocker on the coupler's end along it
    bending, pulls, both = 0.0, 0.0, 0.0
    for k in range(101):
        x = k / 100
        # of a load from p to q the moment at x
        moment = left * COUPLER * x - COUPLER ** 2 * (p * x ** 2 / 2 + (q - p) * x ** 3 / 6)
        edge = abs(moment) * (DEPTH / 2) / (WIDTH * DEPTH ** 3 / 12)
        here = pull - sum(mu * COUPLER * 0.01 * ((start + (finish - start) * (x + (1 - x) * (i + 0.5) / 100)) * e.conjugate()).real * (1 - x) / 1.0
                          for i in range(100))
        here /= WIDTH * DEPTH
        bending, both = max(bending, edge), max(both, edge + abs(here))
        pulls = here if abs(here) > abs(pulls) else pulls
    return bending, pulls, both


def run(place, name, text):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "ssics"), "--json", name + ".nml"], cwd=place, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def main():
    with tempfile.TemporaryDirectory() as place:
        c = joints(0.0)[1]
        for name, text in (("loops", CASE % (SPEED, 9, ", VSTRN=0.001")), ("sketch", SKETCH % (c.real, c.imag))):
            status, listing, words = run(place, "one", text)
            check(name + ": stresses are listed", status == 0 and "STRESSES, PA" in listing, words)
            with open(os.path.join(place, "one.ssics.stresses.csv"), encoding="utf-8") as file:
                rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
            check(name + ": a row for each position", len(rows) == 256, len(rows))
            wanted = [stresses(2 * math.pi * k / 256) for k in range(0, 256, 8)]
            for k, key in enumerate(("bending", "along", "both")):
                size = max(abs(row[k]) for row in wanted)
                error = max(abs(row[k] - got[key]) for row, got in zip(wanted, rows[::8])) / size
                check("%s: %s against statics" % (name, key), error < 5e-3, error)
            for key, words in (("bending", " BENDING "), ("along", " ALONG THE LINK"), ("both", " BOTH TOGETHER")):
                line = next(line for line in listing.splitlines() if line.startswith(words))
                number = float(line[len(words):].split()[0].replace("D", "E"))
                check("%s: the greatest %s is listed" % (name, key), abs(abs(number) - max(abs(row[key]) for row in rows)) < 1e-5 * abs(number), line)
            if name == "loops":
                strain = float(listing.split(" STRAIN ")[1].split(",")[0].replace("D", "E"))
                check("the strain is the stress over the modulus", abs(strain * MODULUS - max(row["both"] for row in rows)) < 1e-5 * strain * MODULUS)
        # resonance: dynamics grow beyond statics
        run(place, "fast", CASE % (130.0, 3, ""))
        with open(os.path.join(place, "fast.ssics.stresses.csv"), encoding="utf-8") as file:
            check("there are stresses at any speed", len(file.readlines()) == 257)
        for item, words in ((", VSHEAR=3.0", "leave VSHEAR out"), ):
            status, _, said = run(place, "no", CASE % (SPEED, 1, item))
            check(item + " is refused", status == 2 and words in said, said)
        status, _, said = run(place, "no", (CASE % (SPEED, 1, "")).replace("VDEPTH=0.010, VWIDTH=0.008", "VAREA=8E-5, VGYR=0.003"))
        check("a section without depth is refused", status == 2 and "give VDEPTH and VWIDTH" in said, said)
        status, listing, _ = run(place, "plain", (CASE % (SPEED, 1, "")).replace(", ISTRSS=1", ""))
        check("without ISTRSS nothing is listed", "STRESSES" not in listing)
    return report()


sys.exit(main())
