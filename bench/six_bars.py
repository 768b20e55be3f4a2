#!/usr/bin/env python3
"""Counts and times of all Watt II through nine points of a function: for doc/measured/six_bars.md and function_generators.md.

usage: bench/six_bars.py BIN all          everything: 50 problems of the first kind, 20 of the second, the functions
       bench/six_bars.py random N [BIN]   N problems whose points are drawn: ends found, real ones certified, seconds of a thread
       bench/six_bars.py known N [BIN]    N problems whose points are those of a Watt II that is drawn: it must be in the list
       bench/six_bars.py functions 0 [BIN] logarithm, square and sine by four-bar and Watt II (doc/measured/function_generators.md);
                                          errors are checked with intersections of circles at 2001 inputs
       BIN                                where psalm is; default: build/local/bin
The start set is taken from the user's cache, or made first. Draws depend on the number of the problem alone."""
import cmath
import math
import os
import random
import re
import resource
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
POINTS = 9
# of the numbers: the outputs of a drawn linkage are rounded to 1e-15 radians, and in problem 18 they hardly depend on one combination
# of the numbers (least singular value 1e-10)
FOUND_WITHIN = 1e-5


def solve(folder, phis, psis):
    """Listing, seconds of the processor and rows of device 9: all Watt II through a table, radians."""
    degrees = [",\n  ".join(",".join("%.17g" % math.degrees(v) for v in angles[i:i + 4]) for i in range(0, len(angles), 4))
               for angles in (phis, psis)]
    path = os.path.join(folder, "case.nml")
    with open(path, "w", encoding="utf-8") as file:
        file.write("TABLE\n &EXACT KIND='FUNCTION', SIXBAR='WATT', PHI=%s,\n  PSI=%s,\n"
                   "  TRMIN=0.0, RLONG=1000000.0, NBEST=1000, CERTIFY=1 &END\n" % tuple(degrees))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([os.path.join(BIN, "psalm"), "--threads", "1", path], capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode == 2:
        sys.exit(done.stderr)
    return (done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
            rows_in(os.path.join(folder, "case.dev9")))


def counts(listing):
    """Distinct ends, real ones, and how many of these are certified."""
    ends = re.search(r"(\d+) of 26370 ends (distinct|missing)", listing)
    found = 0 if not ends else int(ends[1]) if ends[2] == "distinct" else 26370 - int(ends[1])
    real = re.search(r"(\d+) real;", listing)
    proven = re.search(r"certified: of \d+ real ones \d+ exist, \d+ apart from all others, (\d+) are real", listing)
    return found, int(real[1]) if real else 0, int(proven[1]) if proven else 0


def drawn_points(number):
    """Rising inputs and rising or falling outputs: equal steps, moved by up to three tenths of a step."""
    draw = random.Random(number)
    angles = []
    for _ in range(2):
        turn = math.radians(draw.uniform(60.0, 120.0))
        angles.append([turn*(k + draw.uniform(-0.3, 0.3))/(POINTS - 1) for k in range(POINTS)])
    if draw.random() < 0.5:
        angles[1] = [-v for v in angles[1]]
    return angles


def circles(a, ra, b, rb, side):
    """The point at ra from a and rb from b, on a side of the line from a to b; None if there is none."""
    d = abs(b - a)
    x = (d*d + ra*ra - rb*rb)/(2*d)
    return a + (b - a)/d*complex(x, side*math.sqrt(ra*ra - x*x)) if ra > abs(x) else None


def drawn_linkage(number):
    """Inputs, outputs and the numbers p q r s of a Watt II that moves over all of them: frame from 0 to 1, third pivot at 2."""
    draw = random.Random(1000 + number)
    while True:
        lengths = [draw.uniform(0.3, 2.0) for _ in range(6)]
        sides = [draw.choice((-1, 1)) for _ in range(2)]
        start, angle = draw.uniform(0.0, 2*math.pi), draw.uniform(0.0, 2*math.pi)
        turn = math.radians(draw.uniform(50.0, 90.0))
        phis = [turn*(k + draw.uniform(-0.3, 0.3))/(POINTS - 1) for k in range(POINTS)]
        fine = [phis[0] + (phis[-1] - phis[0])*k/720 for k in range(721)]
        joints = {}
        for phi in fine + phis:
            c = lengths[0]*cmath.exp(1j*(start + phi))
            d = circles(c, lengths[1], 1 + 0j, lengths[2], sides[0])
            if d is None:
                break
            g = 1 + lengths[3]/lengths[2]*(d - 1)*cmath.exp(1j*angle)
            h = circles(g, lengths[4], 2 + 0j, lengths[5], sides[1])
            if h is None:
                break
            joints[phi] = d, g, h
        else:
            first = joints[phis[0]]
            numbers = [lengths[0]*cmath.exp(1j*start), 1 - first[0], first[1] - 1, 2 - first[2]]
            psis, last = [], first[2] - 2
            for phi in phis:
                psis.append((psis[-1] if psis else 0.0) + cmath.phase((joints[phi][2] - 2)/last))
                last = joints[phi][2] - 2
            if max(psis) - min(psis) > 0.2:
                return phis, psis, numbers


FUNCTIONS = [("log10 x, 1 to 10", "LOG10", 1.0, 10.0, 60.0, math.log10), ("x^2, 0 to 1", "POWER", 0.0, 1.0, 90.0, lambda x: x*x),
             ("sin x, 0 to 90 degrees", "SIN", 0.0, 90.0, 90.0, lambda x: math.sin(math.radians(x)))]
LOOKS = 2001


def turns_of(joints, degrees):
    """Output turns in degrees of a Watt II at LOOKS inputs, from its joints C, D, E, G, H at the first one."""
    c, d, e, g, h = joints
    side_d = 1 if ((1 - c).conjugate()*(d - c)).imag > 0 else -1
    side_h = 1 if ((e - g).conjugate()*(h - g)).imag > 0 else -1
    turns = []
    for i in range(LOOKS):
        pin = c*cmath.exp(1j*math.radians(degrees*i/(LOOKS - 1)))
        other = circles(pin, abs(d - c), 1 + 0j, abs(d - 1), side_d)
        third = 1 + (g - 1)*(other - 1)/(d - 1)
        output = circles(third, abs(h - g), e, abs(h - e), side_h)
        turns.append(math.degrees(cmath.phase((output - e)/(h - e))))
    return turns


def functions():
    """Three functions by four-bar and by Watt II, exact and with the least largest error."""
    print("| function | turns | four-bar, largest error | Watt II through nine points, largest error | transmission angle | "
          "Watt II, largest error made least | transmission angle | alternates |\n" + "| --- "*8 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for words, name, low, high, turn, function in FUNCTIONS:
            group = "FUNC='%s', FXLOW=%s, FXHIGH=%s, DPHI=%s, DPSI=%s" % (name, low, high, turn, turn)
            least = rows_of(folder, group + ", MINIMAX=1")[0]["error"]
            exact = rows_of(folder, group + ", SIXBAR='WATT', NPOINT=9")[0]
            best = rows_of(folder, group + ", SIXBAR='WATT', MINIMAX=1")[0]
            joints = [complex(best[j + "x"], best[j + "y"]) for j in "cdegh"]
            first, last = function(low), function(high)
            errors = [t - turn*(function(low + (high - low)*i/(LOOKS - 1)) - first)/(last - first)
                      for i, t in enumerate(turns_of(joints, turn))]
            seen = 0.5*(max(errors) - min(errors))    # the zero line of the output is free
            if abs(seen - best["error"]) > 2e-3*best["error"]:
                sys.exit("%s: circles see an error of %g, the listing has %g" % (words, seen, best["error"]))
            print("| %s | %.0f, %.0f | %.3g | %.3g | %.0f | %.3g | %.0f | %s |" % (
                words, turn, turn, least, exact["error"], exact["transmission"], best["error"], best["transmission"],
                "yes" if best["alternates"] else "no"), flush=True)


def rows_of(folder, items):
    """Rows of device 9 of a function."""
    path = os.path.join(folder, "function.nml")
    with open(path, "w", encoding="utf-8") as file:
        file.write("FUNCTION\n &EXACT KIND='FUNCTION', %s,\n  RLONG=20.0%s &END\n" % (
            items, ", TRMIN=20.0" if "SIXBAR" in items else ""))
    done = subprocess.run([os.path.join(BIN, "psalm"), "--threads", "1", path], capture_output=True, text=True, check=False)
    if done.returncode == 2:
        sys.exit(done.stderr)
    return rows_in(os.path.join(folder, "function.dev9"))


def rows_in(path):
    """Rows of the block exact by column."""
    rows, names = [], None
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith("# rank "):
                names = line[1:].split()
            elif names and line.strip() and not line.startswith("#"):
                rows.append(dict(zip(names, map(float, line.split()))))
    return rows


def problems(task, n):
    """Counts and times of n problems."""
    seconds, complete, certified, real_ones, found = [], 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        solve(folder, *drawn_points(0))     # the start set is there from now on
        for number in range(1, n + 1):
            numbers = None
            if task == "random":
                phis, psis = drawn_points(number)
            else:
                phis, psis, numbers = drawn_linkage(number)
            listing, used, rows = solve(folder, phis, psis)
            ends, real, proven = counts(listing)
            seconds.append(used)
            complete += ends == 26370
            certified += proven
            real_ones += real
            line = "%3d: %d ends, %d real, %d certified, %.1f s" % (number, ends, real, proven, used)
            if numbers:
                away = min((max(abs(complex(row["number_%sx" % k], row["number_%sy" % k]) - own) for k, own in zip("pqrs", numbers))
                            for row in rows), default=math.inf)
                found += away < FOUND_WITHIN
                line += ", the linkage drawn is %.1e off" % away
            print(line, flush=True)
    print("%d of %d complete, %d of %d real ones certified, mean %.1f s, most %.1f s" % (
        complete, n, certified, real_ones, sum(seconds)/n, max(seconds)) + (", %d linkages found" % found if task == "known" else ""))


def main():
    """One task, or all."""
    for task, n in [("random", 50), ("known", 20), ("functions", 0)] if sys.argv[2] == "all" else [(sys.argv[1], int(sys.argv[2]))]:
        if task == "functions":
            functions()
        else:
            problems(task, n)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4) or not (sys.argv[2] == "all" or sys.argv[1] in ("random", "known", "functions")):
        sys.exit(__doc__)
    BIN = sys.argv[1] if sys.argv[2] == "all" else sys.argv[3] if len(sys.argv) == 4 else os.path.join(TOP, "build", "local", "bin")
    main()
