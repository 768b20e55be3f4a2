#!/usr/bin/env python3
"""Searches with desired points of any place, size and direction (ISIM=1).

usage: similar_points.py PROGRAM_DIRECTORY. A four-bar between two fixed pivots is modelled here once more; points that it passes are turned,
enlarged and moved, and it is to be found again: as a sketch, by its loops, in the poses of its links, with prescribed and free timing.
With points that no such four-bar passes the objective listed is that of the best similarity, found here by least squares, all ways come to
one result, and no change of the variables lowers it, by a minimiser that has this model alone. Last line: N passed, N failed.
"""
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import minimize
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import tally

COUNT = 24
DELT = numpy.arange(COUNT)*15.0
TRUE = numpy.array((30.0, 90.0, 80.0, 55.0, 40.0, 20.0))   # crank, coupler, rocker, coupler point along and across, first crank angle
FRAME = 100.0
SIZE, TURN, SHIFT = 2.5, 40.0, 300 - 50j
SKETCH = """%s
 &CHAIN JNT='A','B','C','D','P', JX=0.0,25.0,90.0,100.0,60.0, JY=0.0,15.0,70.0,0.0,75.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D', VARY=%s &END
 &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END
 &OUTPUTS OUTPUT='point P' &END
"""
LOOPS = """%s
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=29.15,85.0,70.7,100.0, GAMA=3*0.0,180.0,
  NOUTLK=-2, NOUTLP=1, OUTLK=69.5, OUTANG=20.0 &END
"""
SEARCH = " &SEARCH SOLVER='LSQ', NSTART=%d &END\n"


def places(x, delt=DELT):
    crank, coupler, rocker, along, across, first = x
    b = crank*numpy.exp(1j*numpy.radians(first + delt))
    far = abs(FRAME - b)
    foot = (coupler**2 - rocker**2 + far**2)/(2*far)
    line = (FRAME - b)/far*(foot + 1j*numpy.sqrt(coupler**2 - foot**2))/coupler
    return b + line*(along + 1j*across)


def misfit(actual, desired):
    """Least sum of squares of u*actual + s - desired, by linear least squares in real numbers."""
    columns = numpy.stack([actual, 1j*actual, numpy.ones(COUNT), 1j*numpy.ones(COUNT)], axis=1)
    real = numpy.concatenate([columns.real, columns.imag])
    right = numpy.concatenate([desired.real, desired.imag])
    return numpy.sum((real @ numpy.linalg.lstsq(real, right, rcond=None)[0] - right)**2)


def method(desired, free, more=""):
    text = " &METHOD NDES=%d, DELT=%s,\n" % (COUNT, ",".join("%.1f" % d for d in DELT))
    for name, values in (("DESX", desired.real), ("DESY", desired.imag)):
        text += "  %s=" % name + ",\n   ".join(",".join("%.12f" % v for v in values[k:k + 8]) for k in range(0, COUNT, 8)) + ",\n"
    return text + "  ISIM=1, IFREE=%d%s &END\n" % (free, more)


def case(way, desired, free, starts):
    if way == "loops":
        return LOOPS % way + method(desired, free, ", MOTION=0, CRNKI=31.0, IVA=3*1,0, ILKOUT=1, INGOUT=1, ICRK=%d" % (1 - free)) + SEARCH % starts
    vary = "'A B','B C','C D'," + ("'C P','angle C B C P'" if way == "poses" else "'B P','angle B C B P'")
    return SKETCH % (way, vary if free else vary + ",'input'") + method(desired, free) + SEARCH % starts


def run(psalm, folder, name, text):
    with open(os.path.join(folder, name + ".nml"), "w", encoding="utf-8") as file:
        file.write(text)
    return subprocess.run([psalm, "--threads", "1", name + ".nml"], cwd=folder, capture_output=True, text=True, check=False)


def found(psalm, folder, way, desired, free, starts):
    """What the best linkage comes to: objective, actual points and, from its case, desired ones, total error, case, messages."""
    name = "%s%d" % (way, free)
    done = run(psalm, folder, name, case(way, desired, free, starts))
    tally.check("%s: done" % name, done.returncode == 0, done.stderr)
    rows = [[float(v.replace("D", "E")) for v in row.split()] for row in done.stdout.split("TOTAL ERROR")[0].split("\n")
            if re.fullmatch(r"( +-?\d[\d.]*(?:[ED][+-]\d+)?){7,8} *", row)]
    objective = float(re.search(r"best objective (\S+)", done.stderr).group(1).rstrip(";").replace("D", "E"))
    actual = numpy.array([complex(*row[3:5]) for row in rows[-COUNT:]])
    total = float(re.search(r"TOTAL ERROR\s+(\S+)", done.stdout).group(1).replace("D", "E"))
    with open(os.path.join(folder, name + ".dev7"), encoding="utf-8") as file:
        text = "".join(row for row in file if not row.startswith("!"))
    wanted = [numpy.array([float(v) for v in re.search(item + r"=([^A-Z]*(?:E[+-]\d+[^A-Z]*)*)", text).group(1).replace("\n", "").split(",")
                           if v.strip()]) for item in ("DESX", "DESY")]
    return objective, actual, wanted[0] + 1j*wanted[1], total, text, done.stderr


def main():
    psalm = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
    turned = SIZE*numpy.exp(1j*math.radians(TURN))*places(TRUE) + SHIFT
    k = numpy.arange(COUNT)
    rough = turned + 4*(numpy.sin(7.1*k) + 1j*numpy.cos(3.3*k))
    with tempfile.TemporaryDirectory() as folder:
        for way, free, starts in (("sketch", 0, 40), ("loops", 0, 40), ("poses", 0, 4), ("sketch", 1, 20), ("loops", 1, 20)):
            where = "%s, IFREE=%d" % (way, free)
            objective, actual, placed, total, text, said = found(psalm, folder, way, turned, free, starts)
            tally.check(where + ": passes points that lie elsewhere", objective < 1e-12, "%g" % objective)
            tally.check(where + ": with the points where they lie for it", numpy.max(abs(actual - placed)) < 1e-4 and total < 1e-12)
            tally.check(where + ": the case found has the points there, and no ISIM", "ISIM" not in text)
            if way != "poses":
                size, angle, x, y = (float(v) for v in re.search(
                    r"points are (\S+) times as large, turned by (\S+) degrees about the origin and moved by (\S+), (\S+)", said).groups())
                back = size*numpy.exp(1j*math.radians(angle))*turned + complex(x, y)
                tally.check(where + ": size, turn and place are listed", numpy.max(abs(back - placed)) < 1e-3, said)
                tally.check(where + ": which are those used here", abs(size*SIZE - 1) < 1e-6 and abs(angle + TURN) < 1e-4)
        results = {}
        for way, free, starts in (("sketch", 0, 40), ("loops", 0, 40), ("poses", 0, 8), ("sketch", 1, 20), ("loops", 1, 20), ("poses", 1, 1)):
            where = "points not passed, %s, IFREE=%d" % (way, free)
            objective, actual, placed, total, text, said = found(psalm, folder, way, rough, free, starts)
            results[way, free] = objective
            tally.check(where + ": the objective is that of the best similarity", abs(misfit(actual, rough)/objective - 1) < 1e-5,
                        "%g for %g" % (objective, misfit(actual, rough)))
            scale = numpy.linalg.norm(placed - placed.mean())/numpy.linalg.norm(rough - rough.mean())
            tally.check(where + ": that of the case found is the same in its size", abs(total/(objective*scale**2) - 1) < 1e-5, "%r, %r, %r" % (total, objective, scale))
        for free, near in ((0, 1e-8), (1, 1e-4)):
            least = min(results[way, free] for way in ("sketch", "loops", "poses"))
            for way in ("sketch", "loops", "poses"):
                tally.check("%s, IFREE=%d: one result whichever way" % (way, free), results[way, free] < least*(1 + near), str(results))
        best = min((minimize(lambda x: misfit(places(x), rough), start, method="Nelder-Mead",
                             options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 6000, "maxfev": 6000})
                    for start in (TRUE, TRUE*1.05)), key=lambda one: one.fun)
        tally.check("no other minimiser comes lower", results["sketch", 0] < best.fun*(1 + 1e-7), "%r, %r" % (results["sketch", 0], best.fun))

        # refused, each with what to do
        sketch = case("sketch", rough, 0, 2)
        for name, text, word in (("simplex", sketch.replace("SOLVER='LSQ', NSTART=2", "SOLVER='SIMPLEX'"), "needs the group &SEARCH"),
                                 ("nothing", re.sub(r", VARY=[^&]*", " ", sketch), "no dimension may vary"),
                                 ("angle", re.sub(r"DES[XY]=[^A-Z]*(?=DES|IS)", "", sketch).replace("ISIM", "DESANG=24*1.0, ISIM").replace(
                                     "point P", "angle rocker"), "no desired points"),
                                 ("weights", sketch.replace("ISIM=1", "ISIM=1, XMULT=24*2.0"), "XMULT and YMULT must be equal"),
                                 ("rates", sketch.replace("ISIM=1", "ISIM=1, DVELX=24*0.0"), "no derivatives")):
            done = run(psalm, folder, name, text)
            tally.check("refused: " + name, done.returncode == 2 and word in done.stderr, done.stderr[-300:])
        done = run(psalm, folder, "kinds", "KINDS\n" + method(turned, 1).replace("DELT=", "DELT=") + " &KINDS LINKS=4 &END\n"
                   " &SEARCH NSTART=1, MAXEVAL=5 &END\n")
        tally.check("kinds: they lie anywhere as it is", done.returncode in (0, 1) and "ISIM: linkages of all kinds" in done.stderr,
                    done.stderr[-300:])
    return tally.report()


sys.exit(main())
