#!/usr/bin/env python3
"""Torsion springs and springs along slides that muscle finds, by virtual work.

usage: test/law/found_springs.py PROGRAM_DIRECTORY

The torque that a spring asks of the crank is the change of its energy with the crank's angle: angles and distances come from closed
forms of four-bar and slider-crank, written here anew. With the torque without springs that muscle lists, the least range, RMS and
greatest amount over stiffness and free angle is found by SciPy. kalm has the same load with the springs of device 7. By loops and as a
sketch. Last line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import linprog

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
STEP = 1e-5         # degrees, of differences
FOUR_BAR_LOOPS = """FOUR-BAR
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=40.0,120.0,80.0,130.0, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=5 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=100.0, UNITS='REV/MIN' &END
 &MASSES NMASS=3, MLINK=-1,-2,3, MLOOP=3*1, MASS=0.5,1.5,0.9, MDIST=10.0,60.0,40.0, MINERT=1E-4,2E-3,5E-4, UNITL=0.001, GRAVY=-9.81,
  IMOTOR=0 &END
"""
FOUR_BAR_SKETCH = """FOUR-BAR AS A SKETCH
 &CHAIN JNT='A','B','C','D', JX=0.0,40.0,%.15g,130.0, JY=0.0,0.0,%.15g,0.0, LNAME='frame','crank','coupler','rocker',
  LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle C D' &END
 &METHOD IKIN=5 &END
 &RATES SPEED=100.0, UNITS='REV/MIN' &END
 &MASSES NMASS=3, MNAME='crank A','coupler B','rocker D', MASS=0.5,1.5,0.9, MDIST=10.0,60.0,40.0, MINERT=1E-4,2E-3,5E-4, UNITL=0.001,
  GRAVY=-9.81, IMOTOR=0 &END
"""
SLIDER_LOOPS = """OFFSET SLIDER-CRANK
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1, ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, IKIN=5 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=300.0, UNITS='REV/MIN' &END
 &MASSES NMASS=2, MLINK=-1,-3, MLOOP=2*1, MASS=0.4,1.2, MDIST=20.0,0.0, UNITL=0.001, GRAVY=-9.81, MINERT=1E-4,0.0, IMOTOR=0 &END
"""
SLIDER_SKETCH = """SLIDER-CRANK AS A SKETCH
 &CHAIN JNT='A','B','C', JX=0.0,40.0,%.15g, JY=0.0,0.0,10.0, LNAME='frame','crank','rod','piston', LNK='A','A B','B C','C',
  LENP='A B','B C', LENV=40.0,140.0, NSLIDE=1, SLNK='frame', SLNK2='piston', SLX=0.0, SLY=10.0, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD IKIN=5 &END
 &RATES SPEED=300.0, UNITS='REV/MIN' &END
 &MASSES NMASS=2, MNAME='crank A','piston C', MASS=0.4,1.2, MDIST=20.0,0.0, UNITL=0.001, GRAVY=-9.81, MINERT=1E-4,0.0, IMOTOR=0 &END
"""


def four_bar(turn):
    """Directions of coupler and rocker (from the frame), radians."""
    crank = 40.0 * cmath.exp(1j * math.radians(turn))
    diagonal = 130.0 - crank
    length = abs(diagonal)
    joint = crank + 120.0 * diagonal / length * cmath.exp(-1j * math.acos((length ** 2 + 120.0 ** 2 - 80.0 ** 2) / (2 * length * 120.0)))
    return cmath.phase(joint - crank), cmath.phase(joint - 130.0), joint


def piston(turn):
    """Distance of the piston from the crank pivot along the cylinder, metres."""
    x, y = 40.0 * math.cos(math.radians(turn)), 40.0 * math.sin(math.radians(turn))
    return 0.001 * (x + math.sqrt(140.0 ** 2 - (10.0 - y) ** 2))


def columns(coordinate, turns):
    """The torque by stiffness and by stiffness times free angle, from E = S (c - f)^2/2: S c dc/dt - S f dc/dt."""
    values = numpy.unwrap([coordinate(t) for t in turns])
    slope = numpy.array([(near(coordinate(t + STEP), coordinate(t - STEP))) / math.radians(2 * STEP) for t in turns])
    return values, slope


def near(a, b):
    return (a - b + math.pi) % (2 * math.pi) - math.pi


def least(criterion, bare, values, slope):
    """The least of the criterion over S >= 0 and k: bare + (S values - k) slope."""
    matrix = numpy.column_stack([values * slope, -slope])
    if criterion == "RMS":
        x = numpy.linalg.lstsq(matrix, -bare, rcond=None)[0]
        if x[0] < 0:
            x = numpy.array([0.0, numpy.linalg.lstsq(matrix[:, 1:], -bare, rcond=None)[0][0]])
        return math.sqrt(numpy.mean((bare + matrix @ x) ** 2))
    level = -numpy.ones((len(bare), 1))
    shift = level if criterion == "RANGE" else 0 * level
    rows = numpy.block([[matrix, shift, level], [-matrix, -shift, level]])
    found = linprog([0, 0, 0, 1], A_ub=rows, b_ub=numpy.concatenate([-bare, bare]), bounds=[(0, None), (None, None), (None, None), (0, None)])
    return found.fun * (2 if criterion == "RANGE" else 1)


def run(place, name, text, program="muscle", *options):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, program), *options, name + ".nml"], cwd=place, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout, done.stderr


def rows(place, name):
    with open(os.path.join(place, name), encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items() if key != "load"} for row in csv.DictReader(file)]


def main():
    joint = four_bar(0.0)[2]
    sketch = FOUR_BAR_SKETCH % (joint.real, joint.imag)
    slider = SLIDER_SKETCH % (1000 * piston(0.0))
    cases = {
        "torsion spring of the rocker": (FOUR_BAR_LOOPS, "PLINK=4, PLOOP=1, QLINK=-3, QLOOP=1, SKIND=1", lambda t: four_bar(t)[1]),
        "torsion spring between coupler and rocker": (FOUR_BAR_LOOPS, "PLINK=-2, PLOOP=1, QLINK=-3, QLOOP=1, SKIND=1",
                                                      lambda t: four_bar(t)[1] - four_bar(t)[0]),
        "torsion spring of the rocker, sketch": (sketch, "PNAME='frame A', QNAME='rocker C', SKIND=1", lambda t: four_bar(t)[1]),
        "torsion spring between coupler and rocker, sketch": (sketch, "PNAME='coupler B', QNAME='rocker C', SKIND=1",
                                                              lambda t: four_bar(t)[1] - four_bar(t)[0]),
        "spring along the cylinder": (SLIDER_LOOPS, "PLINK=4, PLOOP=1, QLINK=-3, QLOOP=1, SKIND=2", piston),
        "spring along the cylinder, sketch": (slider, "PNAME='frame A', QNAME='piston C', SKIND=2", piston)}
    with tempfile.TemporaryDirectory() as place:
        afters = {}
        for name, (text, where, coordinate) in cases.items():
            for criterion in ("RANGE", "RMS", "PEAK"):
                law = name + ", " + criterion
                status, listing, words = run(place, "one", text + " &SPRNGS %s, SCRIT='%s' &END\n" % (where, criterion), "muscle", "--json")
                check(law + ": found", status == 0, words)
                spring = rows(place, "one.muscle.springs.csv")[0]
                loads = rows(place, "one.muscle.spring_load.csv")
                turns = [5.0 * k for k in range(72)]
                before, after = (numpy.array([row[key] for row in loads]) for key in ("before", "after"))
                values, slope = columns(coordinate, turns)
                size = numpy.max(numpy.abs(before))
                unit = math.radians(1.0) if spring["kind"] == 1 else 0.001
                stretch = values - values.min() + unit * (spring["shortest"] - spring["free"])
                reach = abs(values.max() - values.min() - unit * (spring["longest"] - spring["shortest"]))
                check(law + ": least and greatest angle or length", reach < 1e-6, reach)
                work = spring["stiffness"] * stretch * slope
                error = numpy.max(numpy.abs(after - before - work)) / size
                check(law + ": the torque it asks for is the change of its energy", error < 1e-6, error)
                value = {"RANGE": after.max() - after.min(), "RMS": math.sqrt(numpy.mean(after ** 2)), "PEAK": numpy.max(numpy.abs(after))}[criterion]
                other = least(criterion, before, values, slope)
                check(law + ": SciPy finds no less", abs(value - other) < 1e-5 * size, (value, other))
                afters[name, criterion] = value
                # the springs of device 7 in kalm
                with open(os.path.join(place, "one.muscle.dev7"), encoding="utf-8") as file:
                    run(place, "again", file.read(), "kalm", "--json")
                torque = numpy.array([row["drive"] for row in rows(place, "again.kalm.csv")])
                check(law + ": kalm has the same load with the springs of device 7", numpy.max(numpy.abs(torque - after)) < 1e-8 * size,
                      numpy.max(numpy.abs(torque - after)) / size)
        for (name, criterion), value in afters.items():
            if name.endswith("sketch"):
                other = afters[name[:-len(", sketch")], criterion]
                check("%s, %s: as by loops" % (name, criterion), abs(value - other) < 1e-6 * other, (value, other))
        # limits, and what cannot be
        status, listing, _ = run(place, "limited", sketch + " &SPRNGS PNAME='frame A', QNAME='rocker C', SKIND=1, SFLOW=-100, SFHIGH=-100, "
                                 "SKMAX=0.5, SCRIT='RMS' &END\n", "muscle", "--json")
        spring = rows(place, "limited.muscle.springs.csv")[0]
        check("limits of free angle and stiffness are kept", status == 0 and abs(spring["free"] + 100) < 1e-6
              and spring["stiffness"] <= 0.5 + 1e-9, spring)
        stiffness = []
        for most in ("", ", SKMAX=1.0E30", ", SKMAX=1.0E300"):
            status, listing, _ = run(place, "high", sketch + " &SPRNGS PNAME='frame A', QNAME='rocker C', SKIND=1, SCRIT='RMS'%s &END\n" % most, "muscle",
                                     "--json")
            stiffness.append(rows(place, "high.muscle.springs.csv")[0]["stiffness"] if status == 0 else 0.0)
        check("a limit of stiffness out of reach is none", stiffness[0] > 0.0 and all(abs(k - stiffness[0]) < 1e-6 * stiffness[0] for k in stiffness[1:]),
              stiffness)
        status, listing, _ = run(place, "two", sketch + " &SPRNGS PNAME='frame A','frame A', QNAME='rocker C','coupler C', SKIND=1,0, "
                                 "PREACH=0,60, QREACH=0,60, SFHIGH=0,30, SCRIT='RMS', NSSTRT=4 &END\n", "muscle", "--json")
        both = rows(place, "two.muscle.springs.csv")
        loads = rows(place, "two.muscle.spring_load.csv")
        check("a torsion spring beside one between two points", status == 0 and [row["kind"] for row in both] == [1, 0], listing)
        with open(os.path.join(place, "two.muscle.dev7"), encoding="utf-8") as file:
            run(place, "again", file.read(), "kalm", "--json")
        torque = [row["drive"] for row in rows(place, "again.kalm.csv")]
        check("both in kalm", max(abs(a - row["after"]) for a, row in zip(torque, loads)) < 1e-8 * max(abs(row["before"]) for row in loads))
        status, listing, _ = run(place, "no", sketch + " &SPRNGS PNAME='frame A', QNAME='crank B', SKIND=1 &END\n")
        check("links that turn round have no torsion spring", status == 1 and "WOUND UP" in listing, (status, listing))
        status, listing, _ = run(place, "no", sketch + " &SPRNGS PNAME='frame A', QNAME='coupler C', SKIND=2 &END\n")
        check("a pin on a circle has no spring along a slide", status == 1 and "STRAIGHT LINE" in listing, (status, listing))
        for item, words in (("SKIND=1, PREACH=5", "has no other place than that given"), ("SKIND=2, QREACH=5", "has no other place than that given"),
                            ("SKIND=1, PDIST=5", "wherever it is mounted"), ("SKIND=1, SMETH='EXACT'", "finds a spring between two points"), ("SKIND=3", "is expected"),
                            ("SKIND=1, CWIRE=0.002, CDIAM=0.02, CTURNS=20", "a torsion spring has others"),
                            ("SKIND=0, SFLOW=-1", "a free length is not negative")):
            status, _, said = run(place, "no", sketch + " &SPRNGS PNAME='frame A', QNAME='rocker C', %s &END\n" % item)
            check(item + " is refused", status == 2 and words in said, (status, said))
        status, _, said = run(place, "no", sketch + " &SPRING ANAME='frame A', BNAME='rocker C', ADIST=5, STORS=1, STIFF=1 &END\n", "kalm")
        check("a torsional spring has no place", status == 0 and "the distance has no effect" in said, (status, said))
    return report()


sys.exit(main())
