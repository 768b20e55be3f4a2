#!/usr/bin/env python3
"""Links of beam elements (&FLEX of ssics) against closed forms, other methods, statics, and the continuous form of &VIBR.

usage: test/law/beam_elements.py PROGRAM_DIRECTORY

Frequencies: pinned and stretched uniform beams, a cantilever with a mass at its end by its transcendental equation, a tapered one by
Ritz's method with polynomials. Statics: the flexibility of an arc by Castigliano's theorem, moments at a clamped end and at the corner
of a bell crank by equilibrium, the forces of the motion from positions differenced here. Motion: multipliers, stresses, least stiffness
of a straight link against &VIBR, a mass on a bracket against a stiff bar. Last line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import brentq

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
E, RHO = 207e9, 7850.0
TURN = 2 * math.pi
FOUR_BAR = """FOUR-BAR
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=0.06,0.30,0.14,0.32, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=15 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=%g &END
 &MASSES NMASS=1, MLINK=3, MLOOP=1, MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3, GRAVY=-9.81 &END
"""
COUPLER = " &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=7850.0, XDEPTH=0.010, XWIDTH=0.008, XZETA=0.02%s &END\n"
VIBR = " &VIBR VLINK=2, VLOOP=1, VMOD=207E9, VRHO=7850.0, VDEPTH=0.010, VWIDTH=0.008, VZETA=0.02, NMODE=%d, ISTRSS=1 &END\n"
SKETCH = """FOUR-BAR, SKETCH
 &CHAIN JNT='A','B','C','D', JX=0.0,0.06,%.15g,0.32, JY=0.0,0.0,%.15g,0.0, LNAME='frame','crank','coupler','rocker',
  LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle C D' &END
 &METHOD IKIN=15 &END
 &RATES SPEED=%g &END
"""
MASSES = " &MASSES MNAME='rocker D', MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3, GRAVY=-9.81 &END\n"
BELL = """FOUR-BAR WITH A BELL CRANK THAT DRIVES A SLIDER
 &CHAIN JNT='A','B','C','D','P','Q', JX=0.0,0.03,0.20,0.16,0.17,0.50, JY=0.0,0.02,0.12,0.0,-0.12,-0.13,
  LNAME='frame','crank','coupler','bell','rod','slider', LNK='A D','A B','B C','C D P','P Q','Q',
  SLNK='frame', SLNK2='slider', SLX=0.5, SLY=-0.13, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point Q' &END
 &METHOD IKIN=24 &END
 &RATES SPEED=%g &END
 &MASSES MNAME='slider Q', MASS=2.0 &END
"""


def run(place, name, text):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "ssics"), "--json", name + ".nml"], cwd=place, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def table(place, name, which):
    with open(os.path.join(place, "%s.ssics.%s.csv" % (name, which)), encoding="utf-8") as file:
        return [{key: float(value) if value.strip().lstrip("-")[:1].isdigit() else value for key, value in row.items()}
                for row in csv.DictReader(file)]


def near(what, found, wanted, error):
    check(what, abs(found - wanted) <= error * abs(wanted), (found, wanted))


def joints(turn, crank=0.06, coupler=0.30, rocker=0.14, frame=0.32):
    b = crank * cmath.exp(1j * turn)
    length = abs(frame - b)
    return b, b + coupler * (frame - b) / length * cmath.exp(-1j * math.acos((length ** 2 + coupler ** 2 - rocker ** 2) / (2 * length * coupler)))


def bell_places(turn):
    """Where the bell crank and the slider have the ends of the rod."""
    crank, coupler, rocker, pivot = abs(0.03 + 0.02j), abs(0.17 + 0.10j), abs(0.04 + 0.12j), 0.16
    b = crank * cmath.exp(1j * (turn + math.atan2(0.02, 0.03)))
    gap = pivot - b
    c = b + coupler * gap / abs(gap) * cmath.exp(1j * math.acos((abs(gap) ** 2 + coupler ** 2 - rocker ** 2) / (2 * abs(gap) * coupler)))
    p = pivot + (c - pivot) / (0.04 + 0.12j) * (0.01 - 0.12j)
    rod = abs(0.33 - 0.01j)
    q = p.real + math.sqrt(rod ** 2 - (-0.13 - p.imag) ** 2) - 0.13j
    return p, q


def frequencies(place):
    """Frequencies at rest against closed forms and Ritz's method."""
    run(place, "uniform", FOUR_BAR % 80.0 + COUPLER % ", NXMODE=8, NXELEM=16, XALPHA=30.0, XBETA=2E-6")
    rows = table(place, "uniform", "flexible_modes")
    bending = [(j * math.pi / 0.3) ** 2 * 0.010 / math.sqrt(12) * math.sqrt(E / RHO) for j in range(1, 6)]
    found = [row["frequency"] for row in rows]
    for wanted in bending:
        near("pinned beam %g" % wanted, min(found, key=lambda f, w=wanted: abs(f - w)), wanted, 1e-3)
    stretch = math.pi / 2 / 0.3 * math.sqrt(E / RHO)
    near("stretching, one end held along", min(found, key=lambda f: abs(f - stretch)), stretch, 5e-4)
    for row in rows:
        near("Rayleigh's damping", row["damping"], 0.02 + 30.0 / (2 * row["frequency"]) + 2e-6 * row["frequency"] / 2, 1e-12)
    # the crank, clamped, with a mass at its end: 1 + cos b cosh b + m b (cos b sinh b - sin b cosh b) = 0
    depth, width, length, mass = 0.002, 0.008, 0.06, 0.02
    own = RHO * depth * width * length
    b = brentq(lambda b: 1 + math.cos(b) * math.cosh(b) + mass / own * b * (math.cos(b) * math.sinh(b) - math.sin(b) * math.cosh(b)), 0.2, 1.8)
    text = (FOUR_BAR % 5.0).replace("NMASS=1, MLINK=3, MLOOP=1, MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3", "MLINK=1, MLOOP=1, MASS=0.02")
    crank = " &FLEX XLINK=-1, XLOOP=1, YLINK=1, YLOOP=1, XMOD=207E9, XRHO=7850.0, XDEPTH=0.002, XWIDTH=0.008, XZETA=0.02%s &END\n"
    status, words, _ = run(place, "cantilever", text + crank % "")
    check("the crank is clamped", status == 0 and "CLAMPED AT IN" in words, words)
    near("cantilever with a mass at its end", table(place, "cantilever", "flexible_modes")[0]["frequency"],
         b ** 2 / length ** 2 * depth / math.sqrt(12) * math.sqrt(E / RHO), 1e-5)
    # tapered in depth and width, by Ritz
    run(place, "taper", text.replace("MASS=0.02", "MASS=1E-12") + crank % ", YDEPTH=0.0008, YWIDTH=0.004, NXELEM=16")
    x, w = numpy.polynomial.legendre.leggauss(40)
    x, w = (x + 1) / 2, w / 2
    depths, widths = 0.002 - 0.0012 * x, 0.008 - 0.004 * x
    powers = range(2, 12)
    shapes, bends = numpy.array([x ** n for n in powers]), numpy.array([n * (n - 1) * x ** (n - 2) for n in powers])
    k = (bends * (w * E * widths * depths ** 3 / 12)) @ bends.T / length ** 3
    m = (shapes * (w * RHO * widths * depths)) @ shapes.T * length
    wanted = numpy.sqrt(numpy.sort(numpy.linalg.eigvals(numpy.linalg.solve(m, k)).real)[:3])
    for row, value in zip(table(place, "taper", "flexible_modes"), wanted):
        near("tapered cantilever, mode %g" % row["mode"], row["frequency"], value, 2e-4)


def statics(place):
    """An arc under a load at its end, and the corner of a bell crank."""
    chord, force, depth, width = 0.06, 0.5, 0.004, 0.008
    area, second = depth * width, width * depth ** 3 / 12
    rise = chord * (math.sqrt(2) - 1) / 2                               # a quarter of a circle
    radius = chord / math.sqrt(2)
    text = (FOUR_BAR % 1e-3).split(" &MASSES")[0] + " &LOADS LLINK=1, LLOOP=1, LFX=%g &END\n" % force
    arc = " &FLEX XLINK=-1, XLOOP=1, YLINK=1, YLOOP=1, XMOD=207E9, XRHO=1E-6, XDEPTH=0.004, XWIDTH=0.008, XRISE=%.15g, NXELEM=48, XZETA=0.02 &END\n"
    status, words, said = run(place, "arc", text + arc % rise)
    check("an arc is solved", status == 0, words + said)
    # Castigliano: from the end, at the angle a back along the arc, unit loads along the tangent and the normal there
    a = (numpy.arange(2000) + 0.5) / 2000 * math.pi / 2
    moments = numpy.array([radius * (1 - numpy.cos(a)), radius * numpy.sin(a)])
    pulls = numpy.array([numpy.cos(a), numpy.sin(a)])
    step = radius * math.pi / 2 / 2000
    flexibility = (moments @ moments.T / (E * second) + pulls @ pulls.T / (E * area)) * step
    # the signs of the two loads' moments and pulls against each other
    flexibility[0, 1] = flexibility[1, 0] = abs((moments[0] @ moments[1]) / (E * second) - (pulls[0] @ pulls[1]) / (E * area)) * step
    worst = force * numpy.linalg.eigvalsh(flexibility)[-1]
    moved = max(row["moved"] for row in table(place, "arc", "flexible_joints"))
    near("the end of an arc moves", moved, worst, 2e-3)
    bending = table(place, "arc", "flexible_segments")[0]
    near("moment where it is clamped", bending["bending"], force * chord * depth / 2 / second, 2e-4)
    check("there it is", bending["bending_part"] == 0.0, bending)
    # the bell crank: at low speed the moment at its corner is the rod's force about it
    speed = 1.0
    names = " &FLEX XNAME='bell C','bell D', YNAME='bell D','bell P', XMOD=207E9, XRHO=1E-3, XDEPTH=0.012, XWIDTH=0.010, XZETA=0.02," + \
            " XHNAME='bell D','bell C' &END\n"
    status, words, said = run(place, "bell", BELL % speed + names)
    check("a bell crank is solved", status == 0, words + said)
    worst, step = 0.0, 2e-3
    for n in range(256):
        turn = 2 * math.pi * n / 256
        q = [bell_places(turn + k * step)[1].real for k in (-2, -1, 0, 1, 2)]
        push = 2.0 * speed ** 2 * (-q[0] + 16 * q[1] - 30 * q[2] + 16 * q[3] - q[4]) / (12 * step ** 2)
        p, end = bell_places(turn)
        rod = (end - p) / abs(end - p)
        pull = -push / rod.real * rod                                   # of the rod on the bell crank
        worst = max(worst, abs(((p - 0.16).conjugate() * pull).imag))
    for row, part in zip(table(place, "bell", "flexible_segments"), (1.0, 0.0)):
        near("moment at the corner, segment %g" % row["segment"], row["bending"], worst * 0.006 / (0.010 * 0.012 ** 3 / 12), 2e-4)
        check("there it is", row["bending_part"] == part, row)
    links = table(place, "bell", "flexible_links")
    check("forces on the link balance", links[0]["unbalanced"] < 1e-12, links)
    # its mass is that of its segments; kalm's joint forces with it balance too
    run(place, "heavy", BELL % 30.0 + names.replace("XRHO=1E-3", "XRHO=7850.0"))
    row = table(place, "heavy", "flexible_links")[0]
    near("mass of the segments", row["mass"], RHO * 0.012 * 0.010 * (abs(0.04 + 0.12j) + abs(0.01 - 0.12j)), 1e-12)
    check("they balance with mass", row["unbalanced"] < 1e-12, row)


def motion(place):
    """A straight link against the continuous form, and two ways to say the same."""
    for speed, error in ((80.0, 1e-2), (330.0, 1.5e-2)):
        status, words, said = run(place, "both", FOUR_BAR % speed + COUPLER % ", NXELEM=12" + VIBR % 8)
        check("straight link at %g rad/s" % speed, status in (0, 1), words + said)
        continuous = max(abs(complex(row["re"], row["im"])) for row in table(place, "both", "multipliers") if row["mode"] == 0)
        near("largest multiplier at %g rad/s" % speed, table(place, "both", "flexible_links")[0]["multiplier"], continuous, error)
        here, there = table(place, "both", "flexible_stresses"), table(place, "both", "stresses")
        for key in ("bending", "along", "both"):
            size = max(abs(row[key]) for row in there)
            wrong = max(abs(one[key] - other[key]) for one, other in zip(here, there)) / size
            check("%s at %g rad/s" % (key, speed), wrong < 1.5e-2, wrong)
        near("least stiffness at %g rad/s" % speed, table(place, "both", "flexible_links")[0]["least_stiffness"] * (1625.61 / speed) ** 2,
             table(place, "both", "modes")[0]["least_stiffness"], 5e-3)
    # a slender coupler, whose coefficients are large: it grows, by both forms alike
    thin = (FOUR_BAR % 62.0 + (COUPLER % "").replace("0.010", "0.003").replace("XZETA=0.02", "XZETA=0.0") +
            (VIBR % 5).replace("0.010", "0.003").replace("VZETA=0.02", "VZETA=0.0"))
    growing = 0
    for speed in (62.0, 118.0, 180.0, 240.0, 260.0):
        status, words, said = run(place, "thin", thin.replace("SPEED=62", "SPEED=%g" % speed))
        continuous = max(abs(complex(row["re"], row["im"])) for row in table(place, "thin", "multipliers") if row["mode"] == 0)
        here = table(place, "thin", "flexible_links")[0]["multiplier"]
        growing += continuous > 1.01
        check("multiplier of a slender link at %g rad/s" % speed, abs(math.log(here) - math.log(continuous)) < 0.03 * (1 + math.log(continuous)),
              (here, continuous))
        check("a growing motion is reported", (status == 1) == ("grows" in said or "unstable" in said or "buckles" in said), (status, said))
    check("some of these grow", growing > 0)
    # loops and sketch, and turning backwards without damping
    c = joints(0.0)[1]
    named = "XNAME='coupler B', YNAME='coupler C'"
    sketch = SKETCH % (c.real, c.imag, 80.0) + MASSES + (COUPLER % "").replace("XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1", named)
    run(place, "loops", FOUR_BAR % 80.0 + COUPLER % "")
    run(place, "sketch", sketch)
    one, other = table(place, "loops", "flexible_segments")[0], table(place, "sketch", "flexible_segments")[0]
    for key in ("deflection", "bending", "along", "both"):
        near("sketch and loops: " + key, other[key], one[key], 1e-8)
    undamped = (FOUR_BAR % 81.0 + COUPLER % "").replace("XZETA=0.02", "XZETA=0.0")
    run(place, "ahead", undamped)
    run(place, "back", undamped.replace("SPEED=81", "SPEED=-81"))
    one, other = (table(place, name, "flexible_stresses") for name in ("ahead", "back"))
    size = max(row["both"] for row in one)
    wrong = max(abs(a["both"] - b["both"]) for a, b in zip(one[1:], other[:0:-1])) / size
    check("backwards without damping the same", wrong < 1e-6, wrong)
    # a mass on a bracket, and on a stiff bar without mass
    mass = MASSES.replace("MNAME='rocker D', MASS=0.7, MDIST=0.06, MANG=180.0, MINERT=2E-3",
                          "MNAME='rocker D','coupler B', MASS=0.7,0.05, MDIST=0.06,%.15g, MANG=180.0,%.15g, MINERT=2E-3,1E-5"
                          % (math.hypot(0.2, 0.05), math.degrees(math.atan2(0.05, 0.2))))
    bracket = sketch.replace(MASSES, mass)
    bar = bracket.replace(named, "XNAME='coupler B','coupler B', YNAME='coupler C','coupler B', XDIST=0.0,0.2, YDIST=0.0,%.15g, YANG=0.0,%.15g"
                          % (math.hypot(0.2, 0.05), math.degrees(math.atan2(0.05, 0.2)))).replace("XMOD=207E9", "XMOD=207E9,4E16") \
        .replace("XRHO=7850.0", "XRHO=7850.0,1E-3")
    run(place, "bracket", bracket)
    status, words, said = run(place, "bar", bar)
    check("a bar on a link is read", status == 0, words + said)
    for one, other in list(zip(table(place, "bracket", "flexible_modes"), table(place, "bar", "flexible_modes")))[:4]:
        near("bracket and bar, mode %g" % one["mode"], other["frequency"], one["frequency"], 1e-4)
    one, other = table(place, "bracket", "flexible_segments")[0], table(place, "bar", "flexible_segments")[0]
    near("bracket and bar: bending", other["bending"], one["bending"], 2e-3)
    # a spring to the ground in the middle
    spring = " &SPRING ALINK=-2, ALOOP=1, ADIST=0.15, BLINK=4, BLOOP=1, STIFF=20000.0, SFREE=%g &END\n"
    run(place, "spring", FOUR_BAR % 80.0 + spring % 0.10 + COUPLER % ", NXELEM=12" + VIBR % 6)
    one, other = table(place, "spring", "flexible_links")[0], table(place, "spring", "modes")[0]
    near("least stiffness with a spring", one["least_stiffness"] * (1625.61 / 80.0) ** 2, other["least_stiffness"], 2e-2)


def driven_masses(place):
    """Light links that move heavy masses as they bend: springs with a mass that changes over the turn."""
    light = " &FLEX XNAME='bell C','bell D', YNAME='bell D','bell P', XMOD=207E9, XRHO=1E-3, XDEPTH=0.006, XWIDTH=0.010, XZETA=0.02," + \
            " XHNAME='bell D','bell C' &END\n"
    status, words, said = run(place, "bell", BELL % 20.0 + light)
    check("a light bell crank that moves a slider", status == 0 and "WITH THE MASSES" in words, words + said)
    one, other = abs(0.04 + 0.12j), abs(0.01 - 0.12j)
    spring = 3 * E * (0.010 * 0.006 ** 3 / 12) / (other ** 2 * (one + other))    # of the overhanging arm, at its end
    moved = []
    for n in range(256):
        p, q = bell_places(TURN * n / 256)
        rod, across = q - p, 1j * (p - 0.16) / abs(p - 0.16)
        moved.append(abs((across.conjugate() * rod).real / rod.real))
    row = table(place, "bell", "flexible_links")[0]
    near("least frequency with the slider", row["driven_from"], math.sqrt(spring / 2.0) / max(moved), 1e-2)
    near("greatest frequency with the slider", row["driven_to"], math.sqrt(spring / 2.0) / min(moved), 1e-2)
    # the moment at the corner stays the force of the slider, vibration and all: both arms say the same
    run(place, "fast", BELL % 45.0 + light)
    one, other = table(place, "fast", "flexible_segments")
    near("moment at the corner of both arms", one["bending"], other["bending"], 1e-3)
    # a clamped crank bends against all that it turns: its end has the inertia that a flexible drive feels
    text = (FOUR_BAR % 20.0).replace(", GRAVY=-9.81", "") + " &FLEX XLINK=-1, XLOOP=1, YLINK=1, YLOOP=1, XMOD=207E9, XRHO=1E-3," + \
        " XDEPTH=0.004, XWIDTH=0.008, XZETA=0.02 &END\n &DRIVEL DSTIF=500.0, DDAMP=0.1 &END\n"
    run(place, "crank", text)
    inertia = max(row["inertia"] for row in table(place, "crank", "drive_inertia"))
    near("a crank with all that it turns", table(place, "crank", "flexible_links")[0]["driven_from"],
         math.sqrt(3 * E * 0.008 * 0.004 ** 3 / 12 / 0.06 / inertia), 1e-2)


def refusals(place):
    good = FOUR_BAR % 80.0 + COUPLER % ""
    for text, words in (
            (good.replace("XDEPTH=0.010", "XDEPTH=0.010, XAREA=8E-5"), "not by both"),
            (good.replace("XDEPTH=0.010, ", ""), "&FLEX XDEPTH: missing"),
            (good.replace("YLINK=2", "YLINK=3"), "begins on one link and ends on another"),
            (good.replace("YLINK=2", "YLINK=2, YDIST=0.1, YANG=90.0"), "is on none of its segments"),
            (good.replace("XZETA=0.02", "XRISE=0.16"), "at most a semicircle"),
            (good.replace("XZETA=0.02", "NXPNT=100"), "multiple of 16"),
            (good.replace("YLINK=2", "YLINK=-2"), "the segment has no length"),
            (good.replace("XZETA=0.02", "XHLINK=3, XHLOOP=1"), "no segment is on this link"),
            (good.replace("XLINK=-2, XLOOP=1, YLINK=2", "XLINK=-2,2, XLOOP=1,1, YLINK=2,2").replace("YLOOP=1", "YLOOP=1,1, XDIST=0.0,0.1, "
             "XANG=0.0,90.0, YDIST=0.0,0.2, YANG=0.0,90.0"), "do not hang together"),
            (good.replace("XZETA=0.02", "NXELEM=64").replace("XLINK=-2, XLOOP=1, YLINK=2", "XLINK=-2,-2, XLOOP=1,1, YLINK=2,2")
             .replace("YLOOP=1", "YLOOP=1,1, XRISE=0.0,0.02"), "more than 120 are not solved"),
            (good.replace("&FLEX", "&FRICTN FLINK=2, FLOOP=1, FMU=0.1, FRAD=0.01 &END\n &FLEX"), "leave &FRICTN out"),
            ((BELL % 40.0) + " &FLEX XNAME='bell C','bell D', YNAME='bell D','bell P', XMOD=207E9, XRHO=7850.0, XDEPTH=0.012, XWIDTH=0.010 &END\n",
             "the link has 3 pins: name in XHNAME"),
            ((BELL % 40.0) + " &FLEX XNAME='slider Q', YNAME='slider Q', YDIST=0.1, XMOD=207E9, XRHO=7850.0, XDEPTH=0.012, XWIDTH=0.010 &END\n",
             "holds the slope of the link"),
            (good.split(" &RATES")[0] + COUPLER % "", "ssics needs the SPEED"),
            (FOUR_BAR % 80.0 + " &FLEX &END\n", "there are no segments")):
        status, _, said = run(place, "no", text)
        check("refused: " + words, status == 2 and words in said, said)


def main():
    with tempfile.TemporaryDirectory() as place:
        frequencies(place)
        statics(place)
        motion(place)
        driven_masses(place)
        refusals(place)
    return report()


if __name__ == "__main__":
    sys.exit(main())
