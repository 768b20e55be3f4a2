#!/usr/bin/env python3
"""Points of a path with tangents and curvatures, met exactly: TANP, CURVP of &EXACT.

usage: test/law/path_derivatives.py PROGRAM_DIRECTORY [--all]

Paths are made of linkages drawn here; tangent and curvature of the coupler's curve follow from the first and second derivative of the
loop's closure. The linkage must be found again, with its cognates where these are solutions. Of every linkage that is listed the
place at each point is found by circles, and slope and curvature there by the same derivatives: they must be those that were wanted.
Inputs that cannot be are refused. Last line: N passed, N failed.
"""

import cmath
import math
import os
import random
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from exact_case import holds, run
from tally import report


def dot(u, v):
    return (u.conjugate() * v).real


class Linkage:
    """A four-bar, or with `guide` a slider-crank, with its joints where the coupler point is p."""

    def __init__(self, a, b, c, d, p, guide=None):
        self.a, self.b, self.c, self.d, self.p, self.guide = a, b, c, d, p, guide

    def at(self, c, turn):
        """The same with the crank's pin at c and the coupler turned."""
        return Linkage(self.a, self.b, c, c + turn * (self.d - self.c), c + turn * (self.p - self.c), self.guide)

    def misses(self, of):
        """How far the far pin is from where it must be."""
        if self.guide is not None:
            return abs((self.guide.conjugate() * (self.d - of.d)).imag)
        return abs(abs(self.d - self.b) - abs(of.d - of.b))

    def places(self, p):
        """Places where the coupler point may be p, by circles about the pivot and about p."""
        crank, arm, line = abs(self.c - self.a), abs(self.p - self.c), p - self.a
        along = (abs(line) ** 2 + crank**2 - arm**2) / (2.0 * abs(line))
        across = math.sqrt(max(crank**2 - along**2, 0.0))
        for side in (1.0, -1.0):
            c = self.a + line / abs(line) * complex(along, side * across)
            turn = (p - c) / (self.p - self.c)
            yield self.at(c, turn / abs(turn))

    def turned(self, crank):
        """Places where the crank has turned by an angle."""
        c = self.a + (self.c - self.a) * cmath.exp(1j * crank)
        arm = self.d - self.c
        if self.guide is not None:
            # c + e in the direction of the arm's length from the guide
            offset = (self.guide.conjugate() * (self.d - c)).imag
            root = math.sqrt(abs(arm) ** 2 - offset**2)
            pins = [c + self.guide * complex(sign * root, offset) for sign in (1, -1)]
        else:
            line = self.b - c
            along = (abs(line) ** 2 + abs(arm) ** 2 - abs(self.d - self.b) ** 2) / (2.0 * abs(line))
            root = math.sqrt(abs(arm) ** 2 - along**2)
            pins = [c + line / abs(line) * complex(along, sign * root) for sign in (1, -1)]
        return [self.at(c, (pin - c) / arm) for pin in pins]

    def slope_and_curvature(self):
        """Direction of the coupler's curve, modulo a half turn, and its curvature to the left of it."""
        crank, arm, point = self.c - self.a, self.d - self.c, self.p - self.c
        normal = self.d - self.b if self.guide is None else 1j * self.guide
        velocity = 1j * crank
        rate = -dot(normal, velocity) / dot(normal, 1j * arm)
        far = velocity + 1j * rate * arm
        growth = abs(far) ** 2 if self.guide is None else 0.0
        # of the square of the follower's length, or of the distance from the guide: second derivative
        second = -(growth + dot(normal, -crank - rate**2 * arm)) / dot(normal, 1j * arm)
        first = velocity + 1j * rate * point
        bend = -crank + (1j * second - rate**2) * point
        return cmath.phase(first), (first.conjugate() * bend).imag / abs(first) ** 3


def cognates(one):
    """Roberts: the three four-bars that draw the same curve."""
    shape = (one.p - one.c) / (one.d - one.c)
    third = one.a + shape * (one.b - one.a)
    left = one.a + one.p - one.c
    right = one.b + one.p - one.d
    return [one, Linkage(one.a, third, left, left + shape * (one.p - left), one.p),
            Linkage(third, one.b, one.p + shape * (right - one.p), right, one.p)]


def found(folder):
    """Linkages of device 9."""
    lines = open(os.path.join(folder, "case.dev9")).read().splitlines()
    rows = []
    names = None
    for line in lines:
        words = line.lstrip("# ").split()
        if words[:1] == ["rank"]:
            names = words
        elif names and len(words) == len(names) and words[0].isdigit():
            row = dict(zip(names, map(float, words)))
            rows.append([complex(row[k + "x"], row[k + "y"]) for k in "abcd"])
    return rows


def items(name, values):
    return "" if all(v is None for v in values) else ", %s=%s" % (name, ",".join("" if v is None else repr(v) for v in values))


def draw(rand, slides, count):
    """A linkage at several crank angles, points apart from each other."""
    while True:
        a = complex(rand.uniform(-0.2, 0.2), rand.uniform(-0.2, 0.2))
        c = a + rand.uniform(0.3, 0.6) * cmath.exp(1j * rand.uniform(-3, 3))
        b = a + complex(rand.uniform(0.8, 1.2), rand.uniform(-0.3, 0.3))
        d = b + rand.uniform(0.6, 1.0) * cmath.exp(1j * rand.uniform(-3, 3))
        p = c + complex(rand.uniform(-0.8, 0.8), rand.uniform(-0.8, 0.8))
        one = Linkage(a, b, c, d, p, cmath.exp(1j * rand.uniform(-1, 1)) if slides else None)
        angles = [0.0] + sorted(rand.uniform(0.2, 6.0) for _ in range(count - 1))
        try:
            places = [one] + [one.turned(angle)[0] for angle in angles[1:]]
            if abs(one.turned(0.0)[0].d - d) > 1e-9:
                continue
        except ValueError:
            continue
        apart = [abs(u.p - v.p) for k, u in enumerate(places) for v in places[:k]]
        if apart and min(apart) < 0.1:
            continue
        if all(abs(at.slope_and_curvature()[1]) < 8.0 for at in places):
            return one, angles, places


def of_paths(programs, folder, everything):
    """Orders of the derivatives at each point, how the points are given, what else is, and the number of solutions."""
    cases = [("point", (0, 0, 0, 1), "both", 28), ("point", (1, 0, 1), "both", 20), ("point", (2, 0, 0), "both", 24),
             ("point", (1, 2), "both", 16), ("pose", (0, 1), "both", 4), ("timed", (1, 0), "both", 6), ("timed", (0, 1), "both", 6),
             ("pose", (1, 0, 1, 0), "", None), ("timed", (0, 2, 0, 0), "", None), ("pose", (0, 0, 0), "crank", None),
             ("slider pose", (0, 1, 0, 0), "", 3), ("slider timed", (0, 0, 2), "", None), ("slider point", (0, 1, 2), "crank", None),
             ("slider point", (1, 0, 0, 1), "crank", 38), ("timed", (0, 1, 0), "follower", None), ("pose", (1, 1, 0), "crank", None),
             ("point", (2, 2, 2), "", 227)]
    if everything:
        cases += [("point", (0, 0, 0, 0, 0, 0, 0, 1), "", 1052), ("point", (1, 1, 1, 1, 0), "", None), ("point", (2, 2, 1, 0), "", None),
                  ("point", (1, 1, 0, 0, 0), "crank", None), ("slider point", (2, 1, 0, 0, 0), "", None)]
    for kind, orders, given, solutions in cases:
        slides = kind.startswith("slider")
        way = kind.split()[-1]
        count = len(orders)
        rand = random.Random("%s%s%s" % (kind, orders, given))
        # what is left of the conditions are points without anything
        free = (7 if slides else 8) - 2 * (given in ("crank", "both")) - 2 * (given in ("follower", "both"))
        free -= sum(orders) + (count - 1) * (1 if way == "point" else 2)
        one, angles, places = draw(rand, slides, count + free)
        orders = list(orders) + [0] * free
        along = [at.slope_and_curvature() for at in places]
        text = "PATH\n &EXACT KIND='PATH', NBEST=5000, CERTIFY=1, SLIDER=%d%s%s" % (
            slides, items("XP", [at.p.real for at in places]), items("YP", [at.p.imag for at in places]))
        # in either sense
        sense = [rand.choice((0, 1)) for _ in along]
        text += items("TANP", [math.degrees(s[0]) + 180.0 * k if order > 0 else None for s, k, order in zip(along, sense, orders)])
        text += items("CURVP", [s[1] * (1 - 2 * k) if order > 1 else None for s, k, order in zip(along, sense, orders)])
        if way == "pose":
            text += items("ANGP", [math.degrees(cmath.phase((at.d - at.c) / (one.d - one.c))) for at in places[:count]])
        if way == "timed":
            text += items("TIMP", [math.degrees(angle) for angle in angles[:count]])
        if given:
            text += items("PIVOTS", [None, None, one.b.real, one.b.imag] if given == "follower" else
                          [one.a.real, one.a.imag] + ([one.b.real, one.b.imag] if given == "both" else []))
        status, listing, remarks = run(programs, text + " &END\n", folder)
        what = "%s, derivatives %s%s" % (kind, orders, ", given: " + given if given else "")
        holds(status == 0 and "  complete:" in listing and "distinct, certified" in listing,
              "%s: complete and certified, status %d %s %s" % (what, status, listing[20:120], remarks.strip()[:200]))
        if solutions:
            holds("of %d ends" % solutions in listing, "%s: %d ends %s" % (what, solutions, listing[20:120]))
        rows = found(folder)
        holds(len(rows) > 0, what + ": some are listed")
        wanted = cognates(one) if way == "point" and not given and not slides else [one]
        for number, own in enumerate(wanted):
            again = 0
            for row in rows:
                near = abs(row[0] - own.a) + abs(row[2] - own.c)
                other = abs(row[0] - own.b) + abs(row[2] - own.d) + abs(row[1] - own.a) + abs(row[3] - own.c)
                if slides:
                    near += abs(row[3] - own.d) + abs((row[1].conjugate() * own.guide).imag)
                else:
                    near += abs(row[1] - own.b) + abs(row[3] - own.d)
                again += min(near, 9.0 if slides else other) < 1e-5
            holds(again == 1, "%s: the linkage that it was made of is found, cognate %d (%d times of %d)" % (what, number, again,
                                                                                                      len(rows)))
        worst = 0.0
        for a, b, c, d in rows:
            own = Linkage(a, b, c, d, one.p, b if slides else None)
            size = max(1.0, abs(c - a), abs(d - c), abs(d - b) if not slides else 0.0)
            for k, at in enumerate(places):
                # the coupler may pass a point in several positions: the one that fits best counts
                best = 9.0
                for place in ([own] if k == 0 else own.places(at.p)):
                    miss = place.misses(own) / size
                    if k < count and k > 0 and way == "pose":
                        miss += abs((place.d - place.c) / (own.d - own.c) - (at.d - at.c) / (one.d - one.c))
                    if k < count and k > 0 and way == "timed":
                        miss += abs((place.c - a) / (c - a) - cmath.exp(1j * angles[k]))
                    if orders[k] > 0:
                        got = place.slope_and_curvature()
                        miss += abs(math.sin(got[0] - along[k][0]))
                        if orders[k] > 1:
                            side = 1.0 if math.cos(got[0] - along[k][0]) > 0.0 else -1.0
                            miss += abs(side * got[1] - along[k][1]) / (1.0 + abs(along[k][1]))
                    best = min(best, miss)
                worst = max(worst, best / size**2)
        holds(worst < 1e-6, "%s: points, tangents and curvatures are met by all %d: %.1e" % (what, len(rows), worst))


def of_mistakes(programs, folder):
    form = " &EXACT KIND='%s', XP=0.5,-0.83,-0.34,-0.13, YP=1.06,-0.27,0.22,0.43%s &END\n"
    pivots = ", PIVOTS=0.0,0.0,1.0,0.0"
    for kind, words, needed in (
            ("PATH", ", TANP=,,,,30.0" + pivots, "XP has 4 values only"),
            ("PATH", ", TANP=30.0, CURVP=,,1.0" + pivots, "point 3 has a curvature, but no direction (TANP)"),
            ("PATH", ", TANP=30.0, CURVP=1.0" + pivots, "the points make 5 conditions (a point 1, a pose or timed point 2, a tangent "
             "or curvature 1, the first none), but the linkage has 4 dimensions to choose: none passes; give fewer"),
            ("PATH", ", TANP=30.0", "infinitely many pass; give more"),
            ("PATH", ", TANP=3.0,4.0,5.0,6.0, CURVP=1.0,2.0,3.0", "no linkage meets more than nine: give fewer"),
            ("MOTION", ", ANGP=0.0,10.0,40.0,90.0, TANP=30.0", "is for points of a path: KIND='PATH'"),
            ("PATH", ", ANGP=0.0,10.0, TIMP=0.0,,20.0, TANP=30.0", "with orientations (ANGP) or with crank angles (TIMP), not with both"),
            ("PATH", ", TANP=30.0, MINIMAX=1" + pivots, "MINIMAX: is for linkages that generate a function"),
            ("FUNCTION", ", TANP=30.0", "is for points of a path: KIND='PATH'")):
        status, _, remarks = run(programs, "MISTAKE\n" + form % (kind, words), folder)
        holds(status == 2 and needed in " ".join(remarks.split()), "%s: status %d, %s" % (words, status, remarks.strip()[:250]))
    status, _, remarks = run(programs, "SUBSETS\n" + form % ("PATH", ", TANP=30.0, NSUB=5" + pivots), folder)
    holds("NSUB: has no effect: it is for more than 9 points" in remarks, "NSUB is not ignored: %s" % remarks[:150])
    # tangents and curvatures of one circle, at three of its points, and of one line
    for points in ([cmath.exp(1j * t) for t in (0.3, 1.4, 4.0)],):
        text = "CIRCLE\n &EXACT KIND='PATH'%s%s%s%s &END\n" % (
            items("XP", [p.real for p in points]), items("YP", [p.imag for p in points]),
            items("TANP", [math.degrees(cmath.phase(1j * p)) for p in points]), items("CURVP", [1.0] * 3))
        status, _, remarks = run(programs, text, folder)
        holds(status == 2 and "lie on one circle or line" in remarks, "a circle is refused: %d %s" % (status, remarks[:150]))
    # symmetric about the y axis: both points of a pair have one condition each, and at right angles to the axis there is none
    text = "SYMMETRIC\n &EXACT KIND='PATH', XP=-1.0,1.0,-0.6,0.6,0.0, YP=0.0,0.0,0.7,0.7,1.3, TANP=20.0,%s,50.0,130.0, MAXTIME=0.5 &END\n"
    for angle, warned in ((160.0, True), (150.0, False)):
        status, _, remarks = run(programs, text % angle, folder)
        holds(("symmetric about a line" in remarks) == warned, "symmetric tangents %s: %s" % (angle, remarks[:150]))


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        of_paths(programs, folder, "--all" in sys.argv[2:])
        of_mistakes(programs, folder)
    return report()


if __name__ == "__main__":
    sys.exit(main())
