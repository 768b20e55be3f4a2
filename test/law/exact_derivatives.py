#!/usr/bin/env python3
"""Points with derivatives, and poses with poles, met exactly: SLOPE, CURV, XPOLE, YPOLE of &EXACT.

usage: test/law/exact_derivatives.py PROGRAM_DIRECTORY

Functions are made of linkages drawn here, whose output is computed by circles and differentiated by differences of sixth order. The
linkage must be found again, and every other one that is listed must have the points and the derivatives. Of poses the pole must
lie on both links, by the theorem of the instant centre. Inputs that cannot be are refused. Last line: N passed, N failed.
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

SIXTH = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))                         # first derivative
SIXTH_2 = ((0, -490.0 / 180.0), (1, 270.0 / 180.0), (2, -27.0 / 180.0), (3, 2.0 / 180.0))


def four_bar(of, phi):
    """Output angle at an input angle, radians."""
    r2, r3, r4, phi0, psi0, sign = of
    crank = r2 * cmath.exp(1j * (phi + phi0))
    line = 1.0 - crank
    cosine = (r3**2 - r4**2 - abs(line) ** 2) / (2.0 * r4 * abs(line))
    return cmath.phase(line) + sign * math.acos(cosine) - psi0


def slider(of, phi):
    r2, r3, offset, phi0, place, sign = of
    crank = r2 * cmath.exp(1j * (phi + phi0))
    return crank.real + sign * math.sqrt(r3**2 - (crank.imag - offset) ** 2) - place


def nearest(value, to):
    return value - 2.0 * math.pi * round((value - to) / (2.0 * math.pi))


def derivatives(output, phi, turns):
    """Value, first and second derivative."""
    h = 2e-3
    at = {k: output(phi + k * h) for k in range(-3, 4)}
    if turns:
        at = {k: nearest(v, at[0]) for k, v in at.items()}
    first = sum(c * (at[k] - at[-k]) for k, c in SIXTH) / h
    second = sum(c * ((at[k] + at[-k]) if k else at[0]) for k, c in SIXTH_2) / h**2
    return at[0], first, second


def found(folder):
    """Linkages of device 9: lengths, angles in radians (of a slider its place at 0 too), and the sign of the assembly, 0 where it changes."""
    rows = []
    names = []
    for line in open(os.path.join(folder, "case.dev9")):
        words = line.lstrip("# ").split()
        if words[:1] == ["rank"]:
            names = words
        elif len(words) == len(names) and words[0].isdigit():
            row = dict(zip(names, map(float, words)))
            rows.append([row[name] for name in ("r2", "r3", "r4", "phi0", "psi0", "assembly")])
    return rows


def items(name, values):
    return ", %s=%s" % (name, ",".join("" if v is None else repr(v) for v in values))


def of_functions(programs, folder):
    """How many derivatives each point has, and which zero lines are given."""
    for slides in (False, True):
        output = slider if slides else four_bar
        for orders, zero in (((1, 0, 1), ""), ((0, 1, 0, 0), ""), ((2, 1), ""), ((1, 2), ""), ((0, 2, 0), ""), ((1, 1), "PHI0"),
                             ((0, 0, 1), "PHI0"), ((2, 0), "PHI0"), ((1, 1), "PSI0"), ((2, 0), "PSI0"), ((1, 0), "BOTH"),
                             ((0, 1), "BOTH")):
            if slides and zero in ("PSI0", "BOTH"):
                continue
            rand = random.Random("%s%s%s" % (slides, orders, zero))
            while True:
                if slides:
                    one = [rand.uniform(0.5, 1.5), rand.uniform(2.5, 4.0), rand.uniform(-0.6, 0.6), rand.uniform(-3, 3),
                           rand.uniform(-1, 1), rand.choice((1, -1))]
                else:
                    one = [rand.uniform(0.3, 0.6), rand.uniform(0.9, 1.3), rand.uniform(0.6, 1.1), rand.uniform(-3, 3),
                           rand.uniform(-3, 3), rand.choice((1, -1))]
                inputs = sorted(rand.uniform(0.0, 2.2) for _ in orders)
                if min(b - a for a, b in zip(inputs, inputs[1:])) < 0.4:
                    continue
                try:
                    for k in range(60):
                        output(one, -0.1 + k * 0.04)
                    points = [derivatives(lambda f: output(one, f), f, not slides) for f in inputs]
                except ValueError:
                    continue
                if all(abs(p[1]) > 0.1 for p in points):
                    break
            unit = 1.0 if slides else 180.0 / math.pi
            values = [points[0][0]]
            for p in points[1:]:
                values.append(p[0] if slides else nearest(p[0], values[-1]))
            text = "FUNCTION\n &EXACT KIND='FUNCTION', SLIDER=%d, NBEST=20%s%s%s%s" % (
                slides, items("PHI", [math.degrees(f) for f in inputs]), items("PSI", [v * unit for v in values]),
                items("SLOPE", [p[1] if order > 0 else None for p, order in zip(points, orders)]),
                items("CURV", [p[2] if order > 1 else None for p, order in zip(points, orders)]) if max(orders) > 1 else "")
            if zero in ("PHI0", "BOTH"):
                text += ", PHI0=%r" % math.degrees(one[3])
            if zero in ("PSI0", "BOTH"):
                text += ", PSI0=%r" % math.degrees(one[4])
            status, listing, remarks = run(programs, text + (", CERTIFY=1" if not zero else "") + " &END\n", folder)
            what = "%s, derivatives %s, zero lines %s" % ("slider-crank" if slides else "four-bar", orders, zero or "free")
            holds(status == 0 and "  complete:" in listing, "%s: complete, status %d %s" % (what, status, remarks.strip()[:80]))
            if not zero:
                holds("distinct, certified" in listing, what + ": certified")
            again = 0
            worst = 0.0
            for of in found(folder):
                of[4] = -of[4] if slides else of[4]
                if of[5] == 0:
                    continue
                distance = sum(abs(a - b) for a, b in zip(of[:3], one[:3]))
                again += distance < 1e-3 and of[5] == one[5]
                for f, order, p in zip(inputs, orders, points):
                    got = derivatives(lambda x: output(of, x), f, not slides)
                    miss = [(got[0] - p[0]) if slides else nearest(got[0] - p[0], 0.0)]
                    miss += [got[k] - p[k] for k in range(1, order + 1)]
                    size = max(1.0, max(of[:3])) * (1.0 + max(abs(v) for v in got))
                    worst = max(worst, max(abs(m) for m in miss) / size**2)
            holds(again == 1, "%s: the linkage that it was made of is found (%d times)" % (what, again))
            holds(worst < 1e-7, "%s: points and derivatives are met: %.1e" % (what, worst))


def of_sliders(programs, folder):
    """Five points of slider-cranks, without derivatives: three linkages, and the list is complete."""
    rand = random.Random(7)
    for _ in range(6):
        phi = sorted(rand.uniform(0.0, 150.0) for _ in range(5))
        psi = sorted(rand.uniform(0.0, 100.0) for _ in range(5))
        status, listing, _ = run(programs, "SLIDER\n &EXACT KIND='FUNCTION', SLIDER=1%s%s &END\n" % (items("PHI", phi), items("PSI", psi)),
                                 folder)
        holds(status == 0 and "complete: 3 of 3 ends distinct" in listing and "not complete" not in listing,
              "five points of a slider-crank: %d %s" % (status, listing[60:160].strip()))


def of_poses(programs, folder):
    """Poses of the coupler of a four-bar, with the poles of some: poles are where crank and follower meet."""
    for with_poles in ((0, 2), (0, 1), (1, 2), (1,)):
        rand = random.Random(str(with_poles))
        count = 5 - len(with_poles)
        while True:
            a, b = complex(0, 0), complex(rand.uniform(60, 90), rand.uniform(-10, 10))
            c = a + rand.uniform(20, 40) * cmath.exp(1j * rand.uniform(0.5, 2.5))
            d = b + rand.uniform(40, 70) * cmath.exp(1j * rand.uniform(0.8, 2.3))
            p = c + complex(rand.uniform(-20, 60), rand.uniform(10, 60))
            poses = []
            for k in range(count):
                crank = c * cmath.exp(0.3j * k)
                line = b - crank
                base, length = abs(line), abs(d - c)
                along = (base**2 + length**2 - abs(d - b) ** 2) / (2.0 * base)
                if length <= abs(along):
                    break
                across = math.sqrt(length**2 - along**2)
                side = 1.0 if ((b - c).conjugate() * (d - c)).imag > 0.0 else -1.0
                pin = crank + line / base * complex(along, side * across)
                turn = (pin - crank) / (d - c)
                poses.append((crank + turn * (p - c), cmath.phase(turn), crank, pin))
            if len(poses) < count:
                continue
            poles = []
            for _, _, crank, pin in poses:
                # a + s (crank - a) = b + t (pin - b)
                u, v, w = crank - a, pin - b, b - a
                determinant = (u.conjugate() * v).imag
                poles.append(a + u * (w.conjugate() * v).imag / determinant if abs(determinant) > 50.0 else None)
            if all(poles[k] is not None for k in with_poles):
                break
        chosen = [poles[k] if k in with_poles else None for k in range(count)]
        text = "POSES\n &EXACT KIND='MOTION', CERTIFY=1, NBEST=20%s%s%s%s%s &END\n" % (
            items("XP", [q[0].real for q in poses]), items("YP", [q[0].imag for q in poses]),
            items("ANGP", [math.degrees(q[1]) for q in poses]), items("XPOLE", [None if q is None else q.real for q in chosen]),
            items("YPOLE", [None if q is None else q.imag for q in chosen]))
        status, listing, remarks = run(programs, text, folder)
        what = "%d poses, poles of %s" % (count, with_poles)
        holds("  complete: 4 of 4 dyads distinct, certified" in listing, "%s: complete and certified, %s" % (what, remarks[:80]))
        rows = []
        part = listing.split("A X")[-1]
        for line in part.splitlines()[1:]:
            words = line.split()
            if len(words) == 9:
                rows.append([complex(float(words[k]), float(words[k + 1])) for k in range(1, 9, 2)])
        again = 0
        worst = 0.0
        for pivot, other, first, second in rows:
            again += min(abs(pivot - a) + abs(first - c) + abs(other - b) + abs(second - d),
                         abs(pivot - b) + abs(first - d) + abs(other - a) + abs(second - c)) < 1e-2
            for centre, pin in ((pivot, first), (other, second)):
                for k in range(count):
                    turn = cmath.exp(1j * (poses[k][1] - poses[0][1]))
                    moved = poses[k][0] + turn * (pin - poses[0][0])
                    worst = max(worst, abs(abs(moved - centre) - abs(pin - centre)) / abs(pin - centre))
                    if k in with_poles:
                        link = moved - centre
                        worst = max(worst, abs((link.conjugate() * (poles[k] - centre)).imag) / abs(link) / (abs(poles[k] - centre) + 1.0))
        holds(again == 1, "%s: the four-bar that it was made of is found (%d times)" % (what, again))
        holds(len(rows) > 0 and worst < 1e-4, "%s: poses are met, poles lie on the links: %.1e" % (what, worst))


def of_mistakes(programs, folder):
    function = " &EXACT KIND='FUNCTION', PHI=0.0,45.0,90.0, PSI=0.0,30.0,70.0%s &END\n"
    motion = " &EXACT KIND='MOTION', XP=0.0,20.0,60.0, YP=0.0,15.0,10.0, ANGP=0.0,-20.0,-50.0%s &END\n"
    for form, words, needed in (
            (function, ", SLOPE=0.5,1.0,1.0", "are 6 conditions"),
            (function, ", SLOPE=0.5", "give one of both zero lines"),
            (function, ", SLOPE=0.5,,,1.0", "PHI has 3 values only"),
            (function, ", CURV=0.5,,1.0", "has a second derivative, but no first one"),
            (function, ", SLOPE=0.5,,1.0, MINIMAX=1", "without SIXBAR and MINIMAX"),
            (" &EXACT KIND='FUNCTION', FUNC='SIN', FXLOW=0.0, FXHIGH=90.0, SLOPE=1.0%s &END\n", "", "is for a table"),
            (" &EXACT KIND='FUNCTION', FUNC='SIN', FXLOW=0.0, FXHIGH=90.0, DPHI=9E7%s &END\n", "", "must be from -36000 to 36000"),
            (" &EXACT KIND='FUNCTION', PHI=0.0,1.0,2.0,3.0,4E5, PSI=0.0,1.0,2.0,3.0,4.0%s &END\n", "", "turns 100 times at most"),
            (function, ", XPOLE=1.0, YPOLE=2.0", "is for poses of a body"),
            (motion, ", XPOLE=5.0, YPOLE=-80.0", "are 3 conditions beyond the first pose; a four-bar meets four"),
            (motion, ", XPOLE=5.0,,70.0, YPOLE=-80.0", "the pole of pose 3 needs x and y"),
            (motion, ", XPOLE=5.0,,,70.0, YPOLE=-80.0,,,7.0", "XP has 3 values only"),
            (motion, ", XPOLE=5.0,,70.0, YPOLE=-80.0,,-60.0, PIVOTS=0.0,0.0", "leave SLIDER and PIVOTS out"),
            (motion, ", SLOPE=1.0", "KIND='FUNCTION'")):
        status, _, remarks = run(programs, "MISTAKE\n" + form % words, folder)
        holds(status == 2 and needed in " ".join(remarks.split()), "%s: status %d, %s" % (words, status, remarks.strip()[:160]))


def of_gaps(programs, folder):
    """A linkage that opens between its points says so: looked for by many inputs, at points of linkages some of which open."""
    rand = random.Random(5)
    counts = [0, 0]
    cases = 0
    while cases < 100:
        slides = cases % 2
        output = slider if slides else four_bar
        one = [rand.uniform(0.5, 1.5), rand.uniform(0.6, 1.6), rand.uniform(-0.6, 0.6) if slides else rand.uniform(0.5, 1.5),
               rand.uniform(-3, 3), 0.0, rand.choice((1, -1))]
        phi = sorted(rand.uniform(0.0, 170.0) for _ in range(5))
        if min(b - a for a, b in zip(phi, phi[1:])) < 5.0:
            continue
        try:
            psi = [output(one, math.radians(f)) for f in phi]
        except ValueError:
            continue
        cases += 1
        text = "GAPS\n &EXACT KIND='FUNCTION', SLIDER=%d%s%s &END\n" % (
            slides, items("PHI", phi), items("PSI", psi if slides else [math.degrees(f) for f in psi]))
        _, listing, _ = run(programs, text, folder)
        lines = [line for line in listing.splitlines() if line.strip()[:1].isdigit() and line.split()[0].isdigit() and
                 len(line.split()) > 6]
        rows = found(folder)
        holds(len(lines) == len(rows) > 0, "gaps: all rows are read: %d of %d" % (len(lines), len(rows)))
        for of, line in zip(rows, lines):
            if of[5] == 0:
                continue
            opens = False
            for k in range(2001):
                try:
                    output(of, math.radians(phi[0] + (phi[-1] - phi[0]) * k / 2000.0))
                except ValueError:
                    opens = True
            counts[opens] += 1
            holds(opens == line.endswith("opens between the points"), "gap %r: %s" % (opens, line))
    holds(min(counts) > 3, "linkages with and without a gap between the points: %s" % counts)


def of_idle_items(programs, folder):
    status, _, remarks = run(programs, "TABLE\n &EXACT KIND='FUNCTION', PHI=0.0,45.0,90.0, PSI=0.0,30.0,70.0, SLOPE=0.5,,1.1, DPSI=40.0 &END\n",
                             folder)
    holds(status == 0 and "DPSI: has no effect: it is the range of FUNC" in remarks, "DPSI beside a table is reported: %s" % remarks[:100])


def of_far_points(programs, folder):
    """A place whose square is no number: the crank angles of the linkages are numbers."""
    status, listing, remarks = run(programs, """FAR
 &EXACT KIND='MOTION', XP=0.0,30.0,70.0, YP=1E300,20.0,10.0, ANGP=0.0,-25.0,-60.0, XPOLE=10.0,70.0, YPOLE=-60.0,-60.0 &END
""", folder)
    with open(os.path.join(folder, "case.dev7"), encoding="utf-8") as file:
        written = file.read()
    holds(status == 0 and written.count("DELT=") == 6 and "NaN" not in written, "a point at 1E300: " + remarks[:200])


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        of_functions(programs, folder)
        of_sliders(programs, folder)
        of_poses(programs, folder)
        of_mistakes(programs, folder)
        of_idle_items(programs, folder)
        of_gaps(programs, folder)
        of_far_points(programs, folder)
    return report()


if __name__ == "__main__":
    sys.exit(main())
