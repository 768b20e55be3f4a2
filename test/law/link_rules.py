#!/usr/bin/env python3
"""Rules of &ESTIM (ssics) for steps of the end load and impact in the pins: by forces and masses of positions differenced here.

usage: test/law/link_rules.py PROGRAM_DIRECTORY

A four-bar whose coupler is estimated: its end load follows from momentum, the relative acceleration of a pin that is taken apart from
the two bars that hang on its parts, the errors from free vibrations that a step joins each turn, added up. Last line: N passed, N failed.
"""

import cmath
import math
import os
import sys
import tempfile

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "tools"))
from tally import check, report
from beam_elements import FOUR_BAR, joints, near, run, table

E, RHO, LENGTH, ARM, DEPTH, WIDTH, INERTIA, ZETA, CLEARANCE = 207e9, 7850.0, 0.30, 0.14, 0.006, 0.012, 0.01, 0.01, 4e-5
TEXT = (FOUR_BAR % 60.0).split(" &MASSES")[0].replace("SPEED=60", "SPEED=%.15g") + " &MASSES MLINK=3, MLOOP=1, MASS=1E-9, MINERT=0.01 &END\n" + \
    " &ESTIM ELINK=2, ELOOP=1, EMOD=207E9, ERHO=7850.0, EDEPTH=0.006, EWIDTH=0.012, EZETA=0.01%s &END\n"
POINTS = 256


def differenced(values, h):
    """Second derivative."""
    return (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (12 * h ** 2)


def turn():
    """At unit speed and each position: mean pull of the coupler's ends; relative accelerations of both pins, set free."""
    mass, h = RHO * DEPTH * WIDTH * LENGTH, 1e-3
    pulls, free = [], []
    for n in range(POINTS):
        near_by = [joints(2 * math.pi * n / POINTS + k * h) for k in (-2, -1, 0, 1, 2)]
        b, c = near_by[2]
        t, ray = (c - b) / LENGTH, (c - 0.32) / ARM
        ab, ac = (differenced([pair[k] for pair in near_by], h) for k in (0, 1))
        turning = differenced(list(numpy.unwrap([cmath.phase(pair[1] - 0.32) for pair in near_by])), h)
        # on the coupler at C: across it by moments about B, along it by those of the rocker about its pivot; at B by momentum
        across = mass * ((ab / t).imag / 2 + ((ac - ab) / t).imag / 3)
        arm = (c - 0.32) / t
        along = (arm.real * across + INERTIA * turning) / arm.imag
        at_c = complex(along, across) * t
        at_b = mass * (ab + ac) / 2 - at_c
        pulls.append((along - (at_b / t).real) / 2)
        # C apart: the coupler turns about B, the rocker about D
        ends = []
        for way, inertia in ((1j * t, mass / 3), (1j * ray, INERTIA / ARM ** 2)):
            ends.append(way * (at_c / way).real / inertia)
        # B apart: rocker and coupler hang on D, the coupler's freedom is its angle
        ways = [1j * ray * ARM, -1j * t * LENGTH]                       # of B by both angles
        middle = [1j * ray * ARM, -1j * t * LENGTH / 2]
        inertia = numpy.array([[mass * (one / other).real * abs(other) ** 2 for other in middle] for one in middle])
        inertia += numpy.diag([INERTIA, mass * LENGTH ** 2 / 12])
        loads = [(at_b / way).real * abs(way) ** 2 for way in ways]
        free.append((sum(ends), numpy.dot(numpy.linalg.solve(inertia, loads), ways)))
    return numpy.array(pulls), numpy.array(free).T


def steps(jump, ratio):
    """Amplitude right after a step once a turn: of the place or of the velocity over the frequency, by adding up the turns."""
    root = ratio * complex(-ZETA, 1.0)
    total = 0.0
    for n in range(4000):
        total += cmath.exp(2 * math.pi * n * root)
    return abs(total) * jump


def main():
    pulls, free = turn()
    euler = math.pi ** 2 * E * WIDTH * DEPTH ** 3 / 12 / LENGTH ** 2
    first = (math.pi / LENGTH) ** 2 * DEPTH / math.sqrt(12) * math.sqrt(E / RHO)
    with tempfile.TemporaryDirectory() as place:
        for ratio in (4.0, 6.3, 10.0):
            speed = first / ratio
            status, words, said = run(place, "rules", TEXT % (speed, ", ECLEAR=%g" % CLEARANCE))
            check("the coupler is estimated at a ratio of %g" % ratio, status in (0, 1), words + said)
            row = table(place, "rules", "estimates")[0]
            rules = {one["rule"]: one for one in table(place, "rules", "estimate_rules")}
            pull = speed ** 2 * pulls / euler
            j = int(row["resonant_harmonic"])
            # with the mean end load
            held = ratio * math.sqrt(1 + numpy.mean(pull) - numpy.mean(turning_part(pull, ratio)))
            harmonic = 2 * abs(numpy.fft.fft(pull)[j]) / POINTS
            wanted = steps(math.pi * j * harmonic / (1 + min(pull)), held)
            found = rules["error by steps of end load/deflection"]
            near("steps of the end load at a ratio of %g" % ratio, found["value"], wanted, 2e-2)
            rate = max(numpy.abs(numpy.fft.ifft(1j * numpy.fft.fftfreq(POINTS, 1 / POINTS) * numpy.fft.fft(one))).max() for one in free)
            jerk = rate * speed ** 3
            near("relative acceleration of a free pin grows", row["impact_jerk"], jerk, 1e-4)
            near("time of the impact", row["impact_time"], (12 * CLEARANCE / 2 / jerk) ** (1 / 3), 1e-4)
            near("its speed", row["impact_speed"], jerk * row["impact_time"] ** 2 / 2, 1e-6)
            # Haines's number: 0.5255 (2 e)**(2/3) jerk**(1/3) w
            near("its level in each harmonic", row["impact_level"], 0.5255 * CLEARANCE ** (2 / 3) * jerk ** (1 / 3) * speed, 1e-3)
            found = rules["error by impact in a pin/deflection"]
            near("its error at a ratio of %g" % ratio, found["value"] * row["deflection"],
                 steps(4 / math.pi * row["impact_speed"] / (speed * held), held), 2e-2)
            check("their limit", found["limit"] == 0.1, found)
            line = next(line for line in words.split("\n") if "ERROR BY IMPACT" in line)
            check("the rule is judged", ("KEPT" in line) == (found["value"] <= 0.1), line)
            check("the impact is listed", "IMPACT ACROSS THE CLEARANCE" in words, words)
        run(place, "none", TEXT % (60.0, ""))
        check("without a clearance there is no impact", all("impact" not in one["rule"] for one in table(place, "none", "estimate_rules")))
        status, _, said = run(place, "none", TEXT % (60.0, ", ECLEAR=-1E-5"))
        check("a clearance is not negative", status == 2 and "ECLEAR" in said, said)
    return report()


def turning_part(pull, ratio):
    """What turning of the link takes from the squared frequency of mode 1, over that: its squared speed."""
    h, speeds = 1e-3, []
    for n in range(POINTS):
        angles = numpy.unwrap([cmath.phase(c - b) for b, c in (joints(2 * math.pi * n / POINTS + k * h) for k in (-1, 0, 1))])
        speeds.append((angles[2] - angles[0]) / (2 * h))
    return numpy.array(speeds) ** 2 / ratio ** 2


if __name__ == "__main__":
    sys.exit(main())
