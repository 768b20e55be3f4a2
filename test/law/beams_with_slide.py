#!/usr/bin/env python3
"""Links of beam elements with a slide (&FLEX of ssics) against Ritz's method, statics, and products of matrix exponentials.

usage: test/law/beams_with_slide.py PROGRAM_DIRECTORY

A slotted lever, whose block moves along it: frequencies as a beam with a support between its ends at each position, deflection and
stress of an overhanging beam; multipliers by exponentials of
matrices from polynomials whose support moves. Last line: N passed, N failed.
"""

import cmath
import math
import os
import sys
import tempfile

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")                      # small matrices
import numpy
from scipy.linalg import eigh, expm, null_space

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "tools"))
from tally import check, report
from beam_elements import near, run, table

E, RHO = 207e9, 7850.0
CRANK, PIVOT, LENGTH = 0.05, 0.12, 0.25
LEVER = """SLOTTED LEVER
 &CHAIN JNT='A','B','D','E', JX=0.0,0.05,0.0,%.15g, JY=0.0,0.0,-0.12,%.15g, LNAME='frame','crank','block','lever',
  LNK='A D','A B','B','D E', SLNK='lever', SLNK2='block', SLX=0.05, SLY=0.0, SLANG=%.15g &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle D E' &END
 &METHOD IKIN=15 &END
""" % (LENGTH * 5 / 13, -0.12 + LENGTH * 12 / 13, math.degrees(math.atan2(0.12, 0.05))) + " &RATES SPEED=%g &END\n"
FLEX = " &FLEX XNAME='lever D', YNAME='lever E', XMOD=207E9, XRHO=7850.0, XDEPTH=%g, XWIDTH=0.012, %s &END\n"
SHAPER = LEVER.replace("JNT='A','B','D','E', JX=0.0,0.05,0.0,%.15g" % (LENGTH * 5 / 13), "JNT='A','B','D','E','F', JX=0.0,0.05,0.0,%.15g,%.15g" % (
    LENGTH * 5 / 13, LENGTH * 5 / 13 + math.sqrt(0.2 ** 2 - (0.13 + 0.12 - LENGTH * 12 / 13) ** 2))) \
    .replace("JY=0.0,0.0,-0.12,%.15g" % (-0.12 + LENGTH * 12 / 13), "JY=0.0,0.0,-0.12,%.15g,0.13" % (-0.12 + LENGTH * 12 / 13)) \
    .replace("'lever',", "'lever','rod','ram',", 1).replace("'D E', SLNK='lever', SLNK2='block', SLX=0.05, SLY=0.0,", "'D E','E F','F', SLNK='lever','frame', "
             "SLNK2='block','ram', SLX=0.05,0.3, SLY=0.0,0.13,").replace(" &END\n &DRIVES", ",0.0 &END\n &DRIVES") + " &MASSES MNAME='ram F', MASS=0.5 &END\n"
ROD = """ROD IN A GUIDE OF THE FRAME
 &CHAIN JNT='A','B','Q','E', JX=0.0,0.04,0.16,0.46, JY=4*0.0, LNAME='frame','crank','con-rod','rod', LNK='A','A B','B Q','Q E',
  SLNK='rod', SLNK2='frame', SLX=0.30, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point Q' &END
 &METHOD IKIN=15 &END
 &RATES SPEED=5.0 &END
 &FLEX XNAME='rod Q', YNAME='rod E', XMOD=207E9, XRHO=7850.0, XDEPTH=0.012, XWIDTH=0.012 &END
"""
LOOPS = """DRIVER WITH A SLOT
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,-1,0,1, ARCL=0.01,0.0,0.06,0.025, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=15 &END
 &RATES SPEED=5.0 &END
 &FLEX XLINK=-1, XLOOP=1, YLINK=-1, YLOOP=1, YDIST=0.1, XMOD=207E9, XRHO=7850.0, XDEPTH=0.012, XWIDTH=0.012 &END
"""


def lever(turn):
    """Distance of the block from the pivot, and angle of the lever."""
    b = CRANK * cmath.exp(1j * turn) + 1j * PIVOT
    return abs(b), cmath.phase(b)


def supported(place_of, depth, width=0.012, many=9):
    """Frequencies of a beam with a pin at its start and a support at a place, by polynomials on both parts."""
    second, area = width * depth ** 3 / 12, width * depth
    s, weights = numpy.polynomial.legendre.leggauss(20)
    s, weights = (s + 1) / 2, weights / 2
    k, m, ends = numpy.zeros((2 * many, 2 * many)), numpy.zeros((2 * many, 2 * many)), []
    for part, length in enumerate((place_of, LENGTH - place_of)):
        of = slice(part * many, (part + 1) * many)
        values = numpy.array([s ** n for n in range(many)])
        bends = numpy.array([n * (n - 1) * s ** max(n - 2, 0) for n in range(many)]) / length ** 2
        k[of, of] = (bends * weights * length * E * second) @ bends.T
        m[of, of] = (values * weights * length * RHO * area) @ values.T
        for x in (0.0, 1.0):
            rows = numpy.zeros((2, 2 * many))
            rows[0, of] = [x ** n for n in range(many)]
            rows[1, of] = [(n * x ** (n - 1) if n else 0.0) / length for n in range(many)]
            ends.append(rows)
    free = null_space(numpy.vstack([ends[0][:1], ends[1][:1], ends[2][:1], (ends[1] - ends[2])[1:]]))
    return numpy.sqrt(eigh(free.T @ k @ free, free.T @ m @ free)[0][:3])


def frequencies(place):
    status, words, said = run(place, "lever", LEVER % 20.0 + FLEX % (0.010, "XZETA=0.02, NXELEM=16, NXPNT=64"))
    check("a slotted lever", status == 0 and "HELD BY PIN D AND SLIDE" in words, words + said)
    rows = table(place, "lever", "flexible_frequencies")
    check("a row for each position", len(rows) == 64, len(rows))
    for row in rows[::9]:
        wanted = supported(lever(math.radians(row["input"]))[0], 0.010)
        for name, value, error in zip(("first", "second", "third"), wanted, (2e-4, 1e-3, 3e-3)):
            near("%s frequency at %g degrees" % (name, row["input"]), row[name], value, error)
    links = table(place, "lever", "flexible_links")[0]
    check("no force along the slide", links["unbalanced"] < 1e-12, links)


def statics(place):
    force, depth = 30.0, 0.010
    second = 0.012 * depth ** 3 / 12
    load = " &LOADS LNAME='lever E', LFY=%g, LTURN=1 &END\n" % force
    status, words, said = run(place, "bent", LEVER % 0.1 + load + FLEX % (depth, "XZETA=0.02, NXELEM=12, NXPNT=64"))
    check("a lever under a load", status == 0, words + said)
    far = LENGTH - (PIVOT - CRANK)                                      # overhang where the block is nearest
    row = table(place, "bent", "flexible_segments")[0]
    near("moment at the block", row["bending"], force * far * depth / 2 / second, 1e-4)
    near("where that is", row["bending_part"], 1 - far / LENGTH, 1e-4)
    near("when", row["bending_at"], 270.0, 1e-6)
    near("the end moves", row["deflection"], force * far ** 2 * LENGTH / (3 * E * second), 1e-3)
    for now in table(place, "bent", "flexible_stresses")[::7]:
        over = LENGTH - lever(math.radians(now["input"]))[0]
        near("moment at %g degrees" % now["input"], now["bending"], force * over * depth / 2 / second, 1e-3)


def shaper(place):
    """A ram that the lever drives by its end: a spring with a mass that changes; and two choices of axes."""
    light = (SHAPER % 20.0) + (FLEX % (0.010, "XZETA=0.02, NXELEM=12")).replace("XRHO=7850.0", "XRHO=1E-3")
    status, words, said = run(place, "light", light)
    check("a lever that drives a ram", status == 0 and "WITH THE MASSES" in words, words + said)
    second, found = 0.012 * 0.010 ** 3 / 12, []
    for n in range(256):
        s, angle = lever(2 * math.pi * n / 256)
        e = LENGTH * cmath.exp(1j * angle) - 1j * PIVOT
        across = 1j * cmath.exp(1j * angle)
        rod = math.sqrt(0.2 ** 2 - (0.13 - e.imag) ** 2) + 1j * (0.13 - e.imag)
        moved = (across.conjugate() * rod).real / rod.real              # of the ram, by the end across the lever
        found.append(math.sqrt(3 * E * second / (LENGTH - s) ** 2 / LENGTH / 0.5) / abs(moved))
    row = table(place, "light", "flexible_links")[0]
    near("least frequency with the ram", row["driven_from"], min(found), 3e-3)
    near("greatest frequency with the ram", row["driven_to"], max(found), 3e-3)
    heavy = (SHAPER % 30.0) + FLEX % (0.012, "XZETA=0.02, NXELEM=12, NXMODE=8%s")
    rows = []
    for name, held in (("pins", ""), ("slide", ", XHNAME='lever D'")):
        run(place, name, heavy % held)
        rows.append((table(place, name, "flexible_links")[0], table(place, name, "flexible_segments")[0]))
    (links, segments), (others, those) = rows
    for one, other, key, error in ((links, others, "driven_from", 1e-3), (links, others, "driven_to", 1e-3), (segments, those, "bending", 3e-3),
                                   (segments, those, "along", 1e-2), (segments, those, "deflection", 5e-3), (links, others, "multiplier", 2e-2)):
        near("axes by two pins, or by pin and slide: " + key, other[key], one[key], error)


def multipliers(place):
    """y = sum of a_k (q_k(x) - x q_k(s)/s), q_k Legendre's polynomials less their value at the pivot: zero there and at the block."""
    depth, damping, many = 0.002, 5.0, 12
    area, second = 0.012 * depth, 0.012 * depth ** 3 / 12
    x, weights = numpy.polynomial.legendre.leggauss(20)
    x, weights = (x + 1) / 2, weights / 2 * LENGTH
    shapes = [numpy.polynomial.Legendre.basis(k, domain=[0.0, 1.0]) for k in range(2, 2 + many)]
    shapes = [one - one(0.0) for one in shapes]
    values = numpy.array([one(x) for one in shapes])
    slopes = numpy.array([one.deriv()(x) for one in shapes]) / LENGTH
    bends = numpy.array([one.deriv(2)(x) for one in shapes]) / LENGTH ** 2
    elastic = (bends * weights * E * second) @ bends.T
    h = 1e-3
    for speed, grows in ((250.0, False), (490.0, True)):
        end, steps = numpy.eye(2 * many), 1500
        for n in range(steps):                                          # exponentials of the matrix at the middle of steps
            near_by = [lever(2 * math.pi * (n + 0.5) / steps + k * h) for k in (-2, -1, 0, 1, 2)]
            s = [pair[0] / LENGTH for pair in near_by]
            angle = numpy.unwrap([pair[1] for pair in near_by])
            turning = (angle[0] - 8 * angle[1] + 8 * angle[3] - angle[4]) / (12 * h)
            line = [numpy.array([shape(one) for shape in shapes]) / one for one in s]  # part of the straight line that is taken off
            first = (line[0] - 8 * line[1] + 8 * line[3] - line[4]) / (12 * h)
            twice = (-line[0] + 16 * line[1] - 30 * line[2] + 16 * line[3] - line[4]) / (12 * h ** 2)
            psi = values - numpy.outer(line[2], x)
            slope = slopes - line[2][:, None] / LENGTH
            pull = RHO * area * turning ** 2 * LENGTH ** 2 * (1 - x ** 2) / 2
            m = (psi * weights * RHO * area) @ psi.T
            g = (psi * weights * RHO * area) @ numpy.outer(-first, x).T
            k = (psi * weights * RHO * area) @ numpy.outer(-twice, x).T + elastic / speed ** 2 + (slope * weights * pull) @ slope.T \
                - turning ** 2 * m
            both = numpy.zeros((2 * many, 2 * many))
            both[:many, many:] = numpy.eye(many)
            both[many:] = -numpy.linalg.solve(m, numpy.hstack([k, 2 * g]))
            both[many:, many:] -= damping / speed * numpy.eye(many)
            end = expm(both * 2 * math.pi / steps) @ end
        wanted = max(abs(numpy.linalg.eigvals(end)))
        status, words, said = run(place, "swing", LEVER % speed + FLEX % (depth, "XALPHA=%g, NXELEM=24, NXMODE=8" % damping))
        row = table(place, "swing", "flexible_links")[0]
        check("multiplier at %g rad/s" % speed, abs(math.log(row["multiplier"] / wanted)) < 3e-3, (row["multiplier"], wanted))
        check("the support that moves makes it grow" if grows else "it decays", (wanted > 1.02) == grows == (status == 1), (wanted, said))


def refusals(place):
    status, _, said = run(place, "rod", ROD)
    check("a guide that holds the slope is refused", status == 2 and "holds the slope of the link" in said, said)
    status, _, said = run(place, "loops", LOOPS)
    check("of loops the shoe is not known", status == 2 and "give the linkage as a sketch" in said, said)
    short = LEVER.replace("0.0,%.15g" % (LENGTH * 5 / 13), "0.0,%.15g" % (0.1 * 5 / 13)).replace("-0.12,%.15g" % (-0.12 + LENGTH * 12 / 13), "-0.12,%.15g" % (-0.12 + 0.1 * 12 / 13))
    status, words, said = run(place, "short", short % 20.0 + FLEX % (0.010, "XZETA=0.02"))
    check("a shoe that leaves the lever is reported", status == 1 and "its slide is beside its segments, by at most 0.07" in said, said)


def main():
    with tempfile.TemporaryDirectory() as place:
        frequencies(place)
        statics(place)
        shaper(place)
        multipliers(place)
        refusals(place)
    return report()


if __name__ == "__main__":
    sys.exit(main())
