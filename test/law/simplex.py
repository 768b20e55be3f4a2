#!/usr/bin/env python3
"""The simplex of the thesis: more vertices than one for each variable and one, several simplexes, linkages on their way, violations.

usage: test/law/simplex.py PROGRAM_DIRECTORY

A simplex written here anew (Oldham 6.4, with the random numbers of RANDU) for a four-bar whose closure is solved by complex numbers
goes the same way as psalm's, vertex by vertex. Several simplexes are those that each random integer gives alone; what is listed on
their way are the vertices of searches that end there; cases of device 7 have the objectives listed. The violations listed (NVIOL) are
those of the linkages that the simplex tried. Last line: N passed, N failed.
"""

import cmath
import math
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
CRANK, FRAME = 40.0, 130.0
INPUTS = [20.0 * k for k in range(18)]
CASE = """FOUR-BAR WITH A WANTED ANGLE
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=40.0,%.17g,%.17g,130.0, GAMA=3*0.0,180.0,
  NOUTLK=3, NOUTLP=1, OUTLK=0.0, OUTANG=180.0 &END
 &METHOD MOTION=1, NDES=18, DELT=%s, DESANG=%s, IVA=0,1,1,0, %s &END
 %s
 &LIMITS TANGLE=%g, %s &END
"""


def rocker(p, q, turn):
    """Direction of the rocker, degrees; None where the loop does not close."""
    crank = CRANK * cmath.exp(1j * math.radians(turn))
    diagonal = FRAME - crank
    length = abs(diagonal)
    cosine = (length ** 2 + p ** 2 - q ** 2) / (2 * length * p)
    if abs(cosine) > 1:
        return None
    joint = crank + p * diagonal / length * cmath.exp(-1j * math.acos(cosine))
    return math.degrees(cmath.phase(joint - FRAME))


def objective(values, wanted):
    return sum(((want - rocker(*values, turn) + 180) % 360 - 180) ** 2 for turn, want in zip(INPUTS, wanted))


class Randu:
    def __init__(self, state):
        self.state = state

    def next(self):
        self.state = self.state * 65539 % 2 ** 31
        return self.state / 2 ** 31


class Simplex:
    """Oldham's, equations 6.17 to 6.24, where every vertex closes: bounds alone are kept."""

    def __init__(self, first, function, seed, vertices, low, high, step=0.001, bounce=3.0, expand=2.0, snake=0.5, small=0.25, shrink=0.5):
        self.function, self.low, self.high, self.step = function, low, high, step
        self.bounce, self.expand, self.snake, self.reduce, self.shrunk = bounce, expand, snake, small, shrink
        random = Randu(seed)
        self.v = [list(first)]
        for _ in range(vertices - 1):
            self.v.append([0.9 * a + random.next() * 0.2 * a for a in first])
        self.f = [self.settle(v) for v in self.v]
        self.drawn = [list(v) for v in self.v]

    def settle(self, v):
        for i, a in enumerate(v):
            if a < self.low[i]:
                v[i] = min(self.low[i] + self.step, 0.5 * (self.low[i] + self.high[i]))
            if a > self.high[i]:
                v[i] = max(self.high[i] - self.step, 0.5 * (self.low[i] + self.high[i]))
        return self.function(v)

    def iterate(self):
        v, f = self.v, self.f
        worst, best = f.index(max(f)), f.index(min(f))
        second = max(a for i, a in enumerate(f) if i != worst)
        centre = [sum(w[k] for i, w in enumerate(v) if i != worst) / (len(v) - 1) for k in range(2)]

        def mix(a, one, other):
            return [a * s + (1 - a) * t for s, t in zip(one, other)]

        trial = mix(self.bounce, centre, v[worst])
        value = self.settle(trial)
        if value < f[best]:
            lowest, least = trial, value
            while True:
                trial = mix(self.expand, lowest, centre)
                value = self.settle(trial)
                if value >= least:
                    break
                lowest, least = trial, value
            if least > self.snake * f[best]:
                v[worst], f[worst] = lowest, least
            else:
                move = [a - b for a, b in zip(lowest, v[worst])]
                for k, w in enumerate(v):
                    if k != worst:
                        v[k] = [a + b for a, b in zip(w, move)]
                        f[k] = self.settle(v[k])
                v[worst], f[worst] = lowest, least
        elif value < second:
            v[worst], f[worst] = trial, value
        else:
            trial = mix(1 - self.reduce, centre, trial if value < f[worst] else v[worst])
            value = self.settle(trial)
            if value < f[worst]:
                v[worst], f[worst] = trial, value
            else:
                for k, w in enumerate(v):
                    if k != best:
                        v[k] = mix(self.shrunk, w, v[best])
                        f[k] = self.settle(v[k])


def run(place, name, text, *options):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "psalm"), name + ".nml", *options], cwd=place, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout, done.stderr


def read(place, name):
    with open(os.path.join(place, name), encoding="utf-8") as file:
        return file.read()


def number(word):
    return float(word.replace("D", "E"))


def vertices(place, name, letter):
    return [[number(a) for a in line.split()[2:4]] for line in read(place, name).splitlines()
            if re.match(r"!%s +\d+ +-?\d*\.\d" % letter, line)]


def case(first, wanted, method="", groups="", tangle=90.0, limits=""):
    return CASE % (*first, ",".join("%g" % a for a in INPUTS), ",".join("%.17g" % a for a in wanted), method, groups, tangle, limits)


def main():
    # the optimum of these values lies beyond the bounds of both lengths
    wanted = [rocker(139.0, 86.0, turn) % 360 for turn in INPUTS]
    low, high = (105.0, 70.0), (135.0, 90.0)
    first = (118.0, 80.0)
    limits = "LIMVAL=1, OPLOW=%g,%g, OPHIGH=%g,%g," % (*low, *high)
    with tempfile.TemporaryDirectory() as place:
        for count in (3, 4, 6, 9):
            for seed, iterations in ((19, 0), (19, 1), (333, 7), (333, 12), (901, 25)):
                model = Simplex(first, lambda v: objective(v, wanted), seed, count, low, high)
                for _ in range(iterations):
                    model.iterate()
                method = "ISTART=%d, NITER=%d, NCHECK=1000, SMALL=0.0, NVERT=%d," % (seed, iterations or 1, count)
                run(place, "one", case(first, wanted, method, limits=limits), "--quiet")
                got = vertices(place, "one.dev7", "I" if iterations == 0 else "F")
                expected = model.drawn if iterations == 0 else model.v
                error = max((abs(a - b) for v, w in zip(got, expected) for a, b in zip(v, w)), default=1.0)
                check("NVERT=%d, ISTART=%d: vertices after %d iterations are those of a simplex written anew"
                      % (count, seed, iterations), len(got) == count and error < 2e-4, (len(got), error))
        status, _, words = run(place, "few", case(first, wanted, "NVERT=2,", limits=limits))
        check("too few vertices are refused", status == 2 and "needs at least 3 vertices" in words, (status, words))

        # where bounds flatten it: the least objective within the bounds lies in the middle of one
        ends = {}
        for count in (3, 6):
            method = "NITER=2000, SMALL=1e-6, NVERT=%d," % count
            run(place, "flat", case(first, wanted, method, "&SEARCH NSTART=12 &END", limits=limits), "--quiet")
            ends[count] = [number(a) for a in re.findall(r"START \d+  OBJECTIVE +(\S+)", read(place, "flat.dev1"))]
        least = min(objective((high[0], low[1] + 0.01 * k), wanted) for k in range(2001))
        reached = {count: sum(a < 1.01 * least for a in ends[count]) for count in ends}
        check("with bounds more simplexes of six vertices than of three reach the least objective", len(ends[3]) == len(ends[6]) == 12
              and reached[6] > reached[3], (least, ends))

        # several simplexes: each is the one that its random integer gives alone
        method, limits = "NITER=400, SMALL=1e-4, VAR=0.2, ", "NPRINT=3"
        first = (110.0, 75.0)
        wanted = [rocker(121.0, 83.0, turn) % 360 + (-2, 1, 2)[k % 3] for k, turn in enumerate(INPUTS)]
        status, listing, _ = run(place, "many", case(first, wanted, method, "&SEARCH NSTART=5, NBEST=5, DIFFER=1e-2 &END", limits=limits))
        check("several simplexes end well", status == 0, status)
        log = read(place, "many.dev1")
        integers = {int(a): int(b) for a, b in re.findall(r"START (\d+)  RANDOM INTEGER (\d+)", log)}
        ends = {int(a): number(b) for a, b in re.findall(r"START (\d+)  OBJECTIVE +(\S+)", log)}
        check("the first simplex begins with ISTART, the others with integers of their own",
              integers.get(1) == 19 and len(set(integers.values())) == 5, integers)
        for start, integer in integers.items():
            run(place, "alone", case(first, wanted, method + "ISTART=%d," % integer, limits=limits), "--quiet")
            alone = number(re.search(r"best objective +([^ ;]+);", read(place, "alone.dev1")).group(1))
            check("simplex %d ends where it ends alone" % start, abs(alone - ends[start]) <= 1e-6 * alone, (alone, ends[start]))
        rows = re.findall(r"^ +(\d+) +(\S+) +\S+ +\S+ +\S+ +\S+   (\d+)(?: AT ITERATION (\d+))?$", listing, re.M)
        check("as many linkages as NBEST are ranked", len(rows) == 5, listing)
        values = [number(row[1]) for row in rows]
        check("the ranked linkages stand in the order of their objectives", values == sorted(values), values)
        check("the best is the best end", abs(values[0] - min(ends.values())) <= 1e-6 * values[0], (values, ends))
        check("linkages on the way are among them", any(row[3] for row in rows), rows)
        for rank, value, start, iteration in rows:
            if not iteration:
                continue
            run(place, "alone", case(first, wanted, "NITER=%s, SMALL=0.0, NCHECK=1000, VAR=0.2, ISTART=%d," % (iteration, integers[int(start)]),
                                     limits=limits), "--quiet")
            alone = number(re.search(r"best objective +([^ ;]+);", read(place, "alone.dev1")).group(1))
            check("the linkage of rank %s is the best vertex after so many iterations" % rank,
                  abs(alone - number(value)) <= 1e-6 * alone, (alone, value))
        # cases that can be run
        os.rename(os.path.join(place, "many.dev7"), os.path.join(place, "found.nml"))
        _, again, _ = run(place, "copy", read(place, "found.nml"))
        totals = [number(a) for a in re.findall(r"TOTAL ERROR\s+(\S+)", again)]
        check("every linkage listed is a case with its objective", len(totals) == 5 and
              all(abs(a - b) <= 1e-6 * b for a, b in zip(totals, values)), (totals, values))
        lengths = [[number(a) for a in match.split(",")[1:3]] for match in re.findall(r"ARCL=([^\n]*)", read(place, "found.nml"))]
        check("objectives of the lengths in the cases, by complex numbers", len(lengths) == 5 and
              all(abs(objective(v, wanted) - a) <= 1e-6 * a for v, a in zip(lengths, values)), lengths)
        status, _, words = run(place, "rest", case(first, wanted, method, "&SEARCH NSTART=2, FIRST=4 &END", limits=limits), "--quiet")
        rest = {int(a): number(b) for a, b in re.findall(r"START (\d+)  OBJECTIVE +(\S+)", read(place, "rest.dev1"))}
        check("FIRST goes on with the simplexes that follow", rest == {a: ends[a] for a in (4, 5)}, (status, rest, words))
        status, _, words = run(place, "not", case(first, wanted, method, "&SEARCH RANKING=1 &END", limits=limits))
        check("RANKING is refused", status == 2 and "this needs another SOLVER" in words, (status, words))

        # violations: the reflected vertex does not close, and is repaired
        given = [[110.0, 75.0], [112.0, 74.0], [108.0, 100.0]]
        wanted = [rocker(110.0, 64.0, turn) % 360 for turn in INPUTS]
        values = [objective(v, wanted) for v in given]
        worst = values.index(max(values))
        centre = [sum(v[k] for i, v in enumerate(given) if i != worst) / 2 for k in range(2)]
        tried = [3 * c - 2 * w for c, w in zip(centre, given[worst])]
        missing = max((abs(FRAME - CRANK * cmath.exp(1j * math.radians(t))) - sum(tried), t) for t in INPUTS)
        with open(os.path.join(place, "viol.dev4"), "w", encoding="utf-8") as out:
            out.writelines("     " + "".join("%15.7E" % a for a in v) + "\n" for v in given)
        run(place, "viol", case(given[0], wanted, "NITER=1, NGUESS=3,", limits="NVIOL=0"), "--quiet")
        line = re.search(r"ITERATION 1  VIOLATIONS (\d+) .*\n(.*)", read(place, "viol.dev1"))
        words = line.group(2) if line else ""
        match = re.search(r"LOOP 1, DYAD OF TYPE 1 \(ARCS 2 AND 3\): BOTH LINKS ARE TOO SHORT BY (\S+) \(INPUT (\S+)\), (ONCE|\d+ TIMES)", words)
        check("the vertex tried does not close", missing[0] > 1.0, missing)
        check("NVIOL=0: which dyad, by how much, at which input", match and abs(number(match.group(1)) - missing[0]) < 2e-5 * missing[0]
              and abs(number(match.group(2)) - missing[1]) < 1e-3, (words, missing))
        run(place, "viol", case(given[0], wanted, "NITER=1, NGUESS=3,", limits="NVIOL=30"), "--quiet")
        check("fewer violations than NVIOL are not listed", "TOO SHORT" not in read(place, "viol.dev1"))
    return report()


sys.exit(main())
