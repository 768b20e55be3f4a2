"""The cheapest tolerances of random four-bars against SciPy, on a model of their own.

usage: allocation.py PROGRAM_DIRECTORY [--cases N] [--starts N] [--sample N] [--steps N] [--groups N] [--only PART]. The changes of the coupler point with every length are differences of positions
computed here. Of each case SLSQP has several starts; no allocation may be dearer than its best, leave a band, or lie below its bound.
Of a yield random linkages of this model are drawn. Grades and steps are compared with every choice there is. Proofs of the worst case are
compared with all corners of the box. Last line: N passed, N failed.
"""
import argparse
import csv
import itertools
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import brentq, minimize
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import tally

POSITIONS = 24
LENGTHS = ("length A B", "length B C", "length C D", "length A D", "length B P")
RULES = ("WORST", "RSS", "YIELD")
YIELD = 0.95
DRAWN = 200000          # linkages of a yield
STARTS = 4
SAMPLE = 20000          # linkages that the program itself draws
PROOFS = 6              # four-bars whose worst case is proven
CASE = """RANDOM FOUR-BAR
 &CHAIN JNT='A','B','C','D','P', JX=%s, JY=%s, LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=15 &END
 &LIMITS IPROOF=0 &END
 &ALLOC ALBAND=%r, ALRULE='%s', ALNAM=%s, ALCOST=%s, ALEXP=%s, ALMIN=%s, ALMAX=%s, ALCLAS=%s, ALPOS=%s%s &END
"""
STEPS = """RANDOM FOUR-BAR
 &CHAIN JNT='A','B','C','D','P', JX=%s, JY=%s, LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=15 &END
 &LIMITS IPROOF=0 &END
 &ALLOC %s &END
"""
IT = {30: (33, 52, 84), 50: (39, 62, 100), 80: (46, 74, 120), 120: (54, 87, 140)} # IT8 to IT10 up to these sizes in mm: ISO 286-1, micrometres
NORMAL_WIDTH = 1.959963984540054 # standard deviations to either side that hold 95 per cent


def coupler_point(lengths, crank, carried, side):
    """P for lengths of the shape (..., 5) and crank angles from the frame's line, (positions): (..., positions) complex, frame upon x."""
    r, coupler, rocker, frame, arm = (lengths[..., k, None] for k in range(5))
    b = r*numpy.exp(1j*crank)
    to_d = frame - b
    far = abs(to_d)
    cosine = (coupler**2 + far**2 - rocker**2)/(2*coupler*far)
    bc = to_d/far*(cosine + 1j*side*numpy.sqrt(1 - cosine**2))
    return b + arm*bc*carried


def random_case(random):
    """Joints of a crank-rocker whose transmission angle stays away from 0, and what it costs."""
    while True:
        r, coupler, rocker, frame = 20 + 10*random.random(), *(50 + 50*random.random(3))
        ends = [(coupler**2 + rocker**2 - d**2)/(2*coupler*rocker) for d in (frame - r, frame + r)]
        if max(map(abs, ends)) < 0.85:
            break
    start, side = 2*numpy.pi*random.random(), random.choice((-1, 1))
    arm, carried = 30 + 60*random.random(), numpy.exp(2j*numpy.pi*random.random())
    lengths = numpy.array((r, coupler, rocker, frame, arm))
    return lengths, start, side, carried


def joints_of(lengths, start, side, carried):
    """Joints at the first position: both ends of the crank, both of the rocker, the coupler point."""
    b = lengths[0]*numpy.exp(1j*start)
    p = coupler_point(lengths, numpy.array([start]), carried, side)[0]
    c = b + (p - b)/(lengths[4]*carried)*lengths[1]
    return numpy.array((0, b, c, lengths[3], p))


def cheapest(cost, power, low, high, classes, shares, order, random, starts):
    """SLSQP over the logarithms of the tolerances: the best of several starts that keeps the bands."""
    first = {k: i for i, k in reversed(list(enumerate(classes))) if k > 0}
    groups = [first.get(k, i) if k > 0 else i for i, k in enumerate(classes)]
    free = sorted(set(groups))
    at = numpy.array([free.index(g) for g in groups])
    bounds = [(numpy.log(max(low[at == c].max(), 1e-6)), numpy.log(high[at == c].min())) for c in range(len(free))]

    def total(y):
        return numpy.sum(cost*numpy.exp(-power*y[at]))

    def slopes(y):
        return numpy.bincount(at, -power*cost*numpy.exp(-power*y[at]))

    def left(y):
        return 1 - shares @ numpy.exp(order*y[at])

    def of_left(y):
        each = -order*shares*numpy.exp(order*y[at])
        return numpy.stack([each[:, at == c].sum(axis=1) for c in range(len(free))], axis=1)
    best = numpy.inf
    for _ in range(starts):
        y = numpy.log((1.0/(len(cost)*shares.max()))**(1/order)*(0.2 + 0.8*random.random(len(free))))
        y = numpy.clip(y, [b[0] for b in bounds], [b[1] for b in bounds])
        found = minimize(total, y, jac=slopes, bounds=bounds, constraints={"type": "ineq", "fun": left, "jac": of_left}, method="SLSQP",
                         options={"maxiter": 300, "ftol": 1e-12})
        if left(found.x).min() > -1e-9:
            best = min(best, found.fun)
    return best


def one(program, folder, number, random, starts, failed):
    lengths, start, side, carried = random_case(random)
    crank = start + numpy.radians(15)*numpy.arange(POSITIONS)
    turned = numpy.exp(1j*random.random()*6)
    joints = joints_of(lengths, start, side, carried)*turned
    rule = RULES[number % 3]
    order = 1 if rule == "WORST" else 2
    plain = rule == "YIELD"
    cost, power = 10**(random.random(5) - 0.5), 0.4 + 1.6*random.random(5)
    band = 0.1 + 0.4*random.random()
    low, high = numpy.zeros(5), numpy.full(5, 5.0)
    classes = [0]*5
    if not plain and random.random() < 0.5:
        high[random.integers(5)] = 0.03
    if not plain and random.random() < 0.5:
        classes[random.integers(3)] = classes[3 + random.integers(2)] = 7
    factors = numpy.ones(POSITIONS)
    if not plain and random.random() < 0.5:
        factors = 0.5 + random.random(POSITIONS)
        factors[random.integers(POSITIONS)] = 0
    path = os.path.join(folder, "case.nml")

    def listed(values):
        return ",".join(repr(float(v)) for v in values)
    with open(path, "w", encoding="utf-8") as f:
        f.write(CASE % (listed(joints.real), listed(joints.imag), band, rule, ",".join("'%s'" % n for n in LENGTHS), listed(cost), listed(power),
                        listed(low), listed(high), ",".join(map(str, classes)), listed(factors), ", ALYLD=%r" % (100*YIELD) if plain else ""))
    done = subprocess.run([program, "--quiet", "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
    where = "case %d, %s" % (number, rule)
    tally.check(where + ": done", done.returncode == 0, done.stderr)
    if done.returncode != 0:
        return

    def rows(name):
        with open(os.path.join(folder, "case.%s.csv" % name), encoding="utf-8") as f:
            return list(csv.DictReader(f))
    table = {row["dimension"].lower(): row for row in rows("allocation")}
    tolerance = numpy.array([float(table[n.lower()]["tolerance"]) for n in LENGTHS])
    listing = done.stdout.split("CHEAPEST TOLERANCES")[1].split("COST")[1].replace("D", "E").split()
    bound = float(listing[3])
    total = numpy.sum(cost*tolerance**-power)
    # the change with a length is that of the place upon the drawing, whose frame stands still at A and along A D
    step = 1e-4
    moves = [(coupler_point(lengths + step*e, crank, carried, side) - coupler_point(lengths - step*e, crank, carried, side))/(2*step)*turned
             for e in numpy.eye(5)]
    changes = numpy.stack(moves, axis=1)
    keep = factors > 0
    changes = numpy.concatenate((changes.real[keep], changes.imag[keep]))
    widths = band*numpy.concatenate((factors[keep], factors[keep]))
    if plain:
        deviations = tolerance*(2*random.random((DRAWN, 5)) - 1)
        kept = numpy.mean(abs(deviations @ changes.T) <= widths, axis=0)
        error = numpy.sqrt(YIELD*(1 - YIELD)/DRAWN)
        tally.check(where + ": every band holds the yield", kept.min() > YIELD - 5*error, kept.min())
        tally.check(where + ": one holds no more", kept.min() < YIELD + 5*error or (tolerance >= 0.999*high).all(), kept.min())
        from_program = {(row["number"], int(row["position"])): float(row["share_within"]) for row in rows("allocation_bands")}
        mine = dict(zip([("point_P.x", k + 1) for k in range(POSITIONS)] + [("point_P.y", k + 1) for k in range(POSITIONS)], kept))
        worst = max(abs(from_program[k] - v) - 5*numpy.sqrt(max(v*(1 - v), 1/DRAWN)/DRAWN) for k, v in mine.items())
        tally.check(where + ": the shares are those of linkages drawn", worst < 1e-4, worst)
        return
    shares = abs(changes)**order/widths[:, None]**order
    used = shares @ tolerance**order
    tally.check(where + ": within the bands", used.max() < 1 + 1e-6, used.max())
    tally.check(where + ": within the limits", (tolerance <= high*(1 + 1e-9)).all())
    tally.check(where + ": classes are equal", len({t for t, k in zip(tolerance, classes) if k == 7}) < 2)
    best = cheapest(cost, power, low, high, classes, shares, order, random, starts)
    if not numpy.isfinite(best):
        failed.append(number)       # SLSQP keeps the bands from no start
    tally.check(where + ": not dearer than SLSQP", total <= best*(1 + 1e-6), "%r %r" % (total, best))
    tally.check(where + ": the bound is below every allocation", bound <= min(total, best)*(1 + 2e-6), "%r %r" % (bound, best))
    tally.check(where + ": the bound is near", total - bound < 2e-6*total, "%r %r" % (bound, total))


def share_of_uniform(effects, band):
    """Share of the sums of uniform deviations within +-effects, of the shape (..., n), that is within +-band: by inclusion and exclusion."""
    effects = numpy.maximum(abs(effects), 1e-3*abs(effects).max(axis=-1, keepdims=True))
    n = effects.shape[-1]
    total = 0.0
    for signs in itertools.product((-1, 1), repeat=n):
        e = effects @ numpy.array(signs)
        total = total + numpy.prod(signs)*(numpy.maximum(band + e, 0)**n - numpy.maximum(-band + e, 0)**n)
    return total/(2**n*math.factorial(n)*numpy.prod(effects, axis=-1))


def changes_of(lengths, start, side, carried, turned):
    """Changes of x and of y of the coupler point with every length, at every position: (positions, lengths) each."""
    crank = start + numpy.radians(15)*numpy.arange(POSITIONS)
    step = 1e-4
    moves = [(coupler_point(lengths + step*e, crank, carried, side) - coupler_point(lengths - step*e, crank, carried, side))/(2*step)*turned
             for e in numpy.eye(5)]
    moves = numpy.stack(moves, axis=1)
    return moves.real, moves.imag


def discrete(program, folder, number, random):
    """Steps of tables and grades against every choice: all five lengths in steps, or three and two of any size."""
    lengths, start, side, carried = random_case(random)
    turned = numpy.exp(1j*random.random()*6)
    joints = joints_of(lengths, start, side, carried)*turned
    rule = ("WORST", "RSS", "YIELD", "NORMAL")[number % 4]
    mixed = number % 5 == 4
    if mixed and rule == "YIELD":
        rule = "RSS"
    graded = number % 3 == 2
    band = 0.1 + 0.4*random.random()
    classes = [0]*5
    if random.random() < 0.5 and not mixed:
        classes[0] = classes[3] = 3
    steps, costs = [], []
    cost, power = 10**(random.random(5) - 0.5), 0.4 + 1.6*random.random(5)
    for i in range(5):
        if graded:
            widths = [IT[next(k for k in sorted(IT) if lengths[i] <= k)][g] for g in range(3)]
            steps.append(numpy.array(widths)*1e-3/2)
            costs.append(cost[i]*steps[-1]**-power[i])
        else:
            k = 3 + random.integers(2)
            steps.append(numpy.sort(0.15*random.random(k) + 0.004))
            costs.append(numpy.sort(random.random(k)*4 + 0.1)[::-1])
    if classes[0] and not graded:
        steps[3], costs[3] = steps[0], costs[0]
    any_size = [1, 2] if mixed else []
    items = ["ALBAND=%r" % band, "ALRULE='%s'" % rule.replace("NORMAL", "YIELD"), "ALNAM=" + ",".join("'%s'" % n for n in LENGTHS),
             "ALCLAS=" + ",".join(map(str, classes))]
    if rule in ("YIELD", "NORMAL"):
        items.append("ALYLD=%r" % (100*YIELD))
    if rule == "NORMAL":
        items.append("ALLAW='NORMAL'")

    def listed(values):
        return ",".join(repr(float(v)) for v in values)
    if graded:
        first = 8
        items += ["ALGRAD=" + ",".join("0" if i in any_size else str(first) for i in range(5)), "ALGRDC=5*%d" % (first + 2),
                  "ALCOST=" + listed(cost), "ALEXP=" + listed(power)]
    else:
        tables = [i for i in range(5) if i not in any_size and not (classes[0] and i == 3)]
        items += ["ALTAB=" + ",".join("0" if i in any_size else "1" if classes[0] and i == 3 else str(i + 1) for i in range(5)),
                  "ALSTEP=" + ",".join(listed(steps[i]) for i in tables), "ALSCST=" + ",".join(listed(costs[i]) for i in tables),
                  "ALSTAB=" + ",".join(str(i + 1) for i in tables for _ in steps[i])]
        if mixed:
            items += ["ALCOST=" + listed(c if i in any_size else 1.0 for i, c in enumerate(cost)),
                      "ALEXP=" + listed(c if i in any_size else 1.0 for i, c in enumerate(power))]
    path = os.path.join(folder, "case.nml")
    with open(path, "w", encoding="utf-8") as f:
        f.write(STEPS % (listed(joints.real), listed(joints.imag), ",\n  ".join(items)))
    for name in ("allocation", "allocation_bands"):
        if os.path.exists(os.path.join(folder, "case.%s.csv" % name)):
            os.remove(os.path.join(folder, "case.%s.csv" % name))
    done = subprocess.run([program, "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
    where = "steps %d, %s%s%s" % (number, rule, ", mixed" if mixed else "", ", grades" if graded else "")
    changes = numpy.concatenate(changes_of(lengths, start, side, carried, turned))
    in_steps = [i for i in range(5) if i not in any_size]
    choices = numpy.array([k for k in itertools.product(*(range(len(steps[i])) for i in in_steps))
                           if not classes[0] or k[0] == k[in_steps.index(3)]])
    tolerances = numpy.zeros((len(choices), 5))
    for column, i in enumerate(in_steps):
        tolerances[:, i] = steps[i][choices[:, column]]
    totals = sum(costs[i][choices[:, column]] for column, i in enumerate(in_steps))
    if mixed:
        order = numpy.argsort(totals)
        best = numpy.inf
        for k in order:
            if totals[k] >= best:
                break
            found = two_more(changes, tolerances[k], any_size, cost, power, band, rule, lengths)
            if found is not None:
                best = min(best, totals[k] + found)
    else:
        kept = keeps(changes, tolerances, band, rule)
        best = totals[kept].min() if kept.any() else numpy.inf
    if not numpy.isfinite(best):
        tally.check(where + ": no choice keeps the bands, and the program says so", done.returncode == 1 and "no tolerances are allotted: the least ones" in
                    done.stderr, done.stderr)
        return
    tally.check(where + ": done", done.returncode == 0, done.stderr)
    if done.returncode != 0:
        return
    with open(os.path.join(folder, "case.allocation.csv"), encoding="utf-8") as f:
        rows = {row["dimension"].lower(): row for row in csv.DictReader(f)}
    mine = sum(float(rows[n.lower()]["cost"]) for n in LENGTHS)
    tally.check(where + ": as cheap as the cheapest of all choices", abs(mine/best - 1) < (1e-5 if mixed else 1e-9), "%r %r" % (mine, best))
    chosen = numpy.array([float(rows[n.lower()]["tolerance"]) for n in LENGTHS])
    tally.check(where + ": the choice keeps the bands", keeps(changes, chosen[None], band*(1 + 1e-6), rule)[0], str(chosen))
    if number % 6 == 0:
        with open(path, encoding="utf-8") as f:
            text = f.read().replace("&ALLOC ", "&ALLOC ALNODE=1, ")
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        early = subprocess.run([program, "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
        with open(os.path.join(folder, "case.allocation.csv"), encoding="utf-8") as f:
            early_cost = sum(float(row["cost"]) for row in csv.DictReader(f))
        bound = float(early.stdout.split("LOWER BOUND")[1].split()[0].replace("D", "E")) if "LOWER BOUND" in early.stdout else best
        tally.check(where + ": one node says what it has proven", bound <= best*(1 + 1e-6) and early_cost >= best*(1 - 1e-9) and
                    early.returncode == int("ended at node 1" in early.stderr), (bound, best, early_cost, early.stderr))
    tally.check(where + ": it is one of the steps", all(min(abs(steps[i] - chosen[i])) < 1e-9 for i in in_steps), str(chosen))


def correlated(program, folder, number, random):
    """Two groups with a part in common: SLSQP on the norms of this model, and linkages drawn by its law."""
    lengths, start, side, carried = random_case(random)
    turned = numpy.exp(1j*random.random()*6)
    joints = joints_of(lengths, start, side, carried)*turned
    rule = ("WORST", "RSS", "YIELD")[number % 3]
    law = "NORMAL" if number % 2 else "UNIFORM"
    groups = numpy.array([(1, 1, 0, 2, 2), (1, 2, -1, 2, 0), (1, 1, -1, -1, 1)][int(random.integers(3))])
    correlation = numpy.array((random.random(), 1.0 if random.random() < 0.3 else random.random()))
    cost, power, band = 10**(random.random(5) - 0.5), 0.4 + 1.6*random.random(5), 0.01 + 0.04*random.random()

    def listed(values):
        return ",".join(repr(float(v)) for v in values)
    items = ["ALBAND=%r" % band, "ALRULE='%s'" % rule, "ALLAW='%s'" % law, "ALNAM=" + ",".join("'%s'" % n for n in LENGTHS),
             "ALCOST=" + listed(cost), "ALEXP=" + listed(power), "ALGRP=" + ",".join(map(str, groups)),
             "ALCORR=" + listed(correlation[:abs(groups).max()]), "ALTRY=4000"] + (["ALYLD=%r" % (100*YIELD)] if rule == "YIELD" else [])
    path = os.path.join(folder, "case.nml")
    with open(path, "w", encoding="utf-8") as f:
        f.write(STEPS % (listed(joints.real), listed(joints.imag), ",\n  ".join(items)))
    done = subprocess.run([program, "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
    where = "groups %d, %s, %s" % (number, rule, law)
    # of 48 bands one may well have more linkages beyond it than three standard errors
    tally.check(where + ": done", done.returncode == 0 or "the linear bands are not those" in done.stderr, done.stderr)
    if not os.path.exists(os.path.join(folder, "case.allocation.csv")):
        return
    with open(os.path.join(folder, "case.allocation.csv"), encoding="utf-8") as f:
        rows = {row["dimension"].lower(): row for row in csv.DictReader(f)}
    with open(os.path.join(folder, "case.allocation_bands.csv"), encoding="utf-8") as f:
        bands = list(csv.DictReader(f))
    tolerance = numpy.array([float(rows[n.lower()]["tolerance"]) for n in LENGTHS])
    worth = numpy.array([float(rows[n.lower()]["worth"]) for n in LENGTHS])
    prices = sum(float(row["price"]) for row in bands)
    tally.check(where + ": the worth of all is the price of the bands", abs(worth.sum() - prices) < 1e-4*prices, (worth, prices))
    changes = numpy.concatenate(changes_of(lengths, start, side, carried, turned))

    def sources(squares):
        """Deviations of the lengths by each independent deviation: (lengths, sources)."""
        r = numpy.where(groups != 0, correlation[abs(groups) - 1], 0.0)
        both = 1.0 if squares else numpy.sqrt(r) + numpy.sqrt(1 - r)
        common = numpy.stack([numpy.where(abs(groups) == g, numpy.sign(groups)*numpy.sqrt(r)/both, 0) for g in (1, 2)], axis=1)
        return numpy.concatenate((numpy.diag(numpy.sqrt(1 - r)/both), common), axis=1)

    def far(t):
        if rule == "WORST":
            return abs((changes*t) @ sources(False)).sum(axis=1)
        return numpy.sqrt((((changes*t) @ sources(True))**2).sum(axis=1))*(NORMAL_WIDTH/3 if rule == "YIELD" else 1.0)
    drawn = random.standard_normal((DRAWN, 7))/3 if law == "NORMAL" else 2*random.random((DRAWN, 7)) - 1
    within = numpy.mean(abs(drawn @ ((changes*tolerance) @ sources(law == "NORMAL")).T) <= band, axis=0)
    mine = numpy.array([float(row["share_within"]) for row in bands])
    error = numpy.sqrt(numpy.maximum(mine*(1 - mine), 1/DRAWN)/DRAWN)
    tally.check(where + ": shares are those of linkages drawn", (abs(within - mine)/error).max() < 5, (abs(within - mine)/error).max())
    beyond = numpy.array([float(row["sample_beyond"]) for row in bands])/4000
    error = numpy.sqrt(numpy.maximum(mine*(1 - mine), 1/4000)/4000)
    tally.check(where + ": so are those of the sample", (abs(1 - beyond - mine)/error).max() < 5, (abs(1 - beyond - mine)/error).max())
    if rule == "YIELD" and law != "NORMAL":
        tally.check(where + ": the fullest band holds the yield", abs(mine.min() - YIELD) < 1e-6, mine.min())
        return
    tally.check(where + ": within the bands", far(tolerance).max() < band*(1 + 1e-6), far(tolerance).max()/band)
    limits = [(numpy.log(1e-6), numpy.log(0.1*v)) for v in lengths]
    best = numpy.inf
    for _ in range(2):
        begin = numpy.log(0.5*band/abs(changes).max()/5*(0.2 + random.random(5)))
        found = minimize(lambda y: numpy.sum(cost*numpy.exp(-power*y)), begin, bounds=limits, method="SLSQP",
                         constraints={"type": "ineq", "fun": lambda y: 1 - far(numpy.exp(y))/band}, options={"maxiter": 200, "ftol": 1e-10})
        if far(numpy.exp(found.x)).max() < band*(1 + 1e-8):
            best = min(best, found.fun)
    total = numpy.sum(cost*tolerance**-power)
    tally.check(where + ": not dearer than SLSQP", total <= best*(1 + 1e-6), "%r %r" % (total, best))


def keeps(changes, tolerances, band, rule):
    """Which tolerances, of the shape (choices, 5), keep the band everywhere, by a rule."""
    effects = abs(changes*tolerances[:, None, :])
    if rule == "WORST":
        return effects.sum(axis=2).max(axis=1) <= band*(1 + 1e-9)
    if rule in ("RSS", "NORMAL"):
        return scale_of(rule)*numpy.sqrt((effects**2).sum(axis=2).max(axis=1)) <= band*(1 + 1e-9)
    return share_of_uniform(effects, band).min(axis=1) >= YIELD*(1 - 1e-6)


def scale_of(rule):
    return NORMAL_WIDTH/3 if rule == "NORMAL" else 1.0


def two_more(changes, tolerance, any_size, cost, power, band, rule, lengths):
    """Cheapest cost of two tolerances of any size beside those given: along the edge of the bands; none: nothing keeps them."""
    order = 1 if rule == "WORST" else 2
    effects = abs(changes*scale_of(rule))**order
    room = band**order - effects @ tolerance**order
    if room.min() <= 0:
        return None
    one, other = (effects[:, i] for i in any_size)

    def cost_of(first):
        second = ((room[:, None] - one[:, None]*first**order)/numpy.maximum(other, 1e-12)[:, None]).min(axis=0)
        ok = second > 0
        second = numpy.minimum(numpy.where(ok, second, 1.0)**(1/order), 0.1*lengths[any_size[1]])
        return numpy.where(ok, cost[any_size[0]]*first**-power[any_size[0]] + cost[any_size[1]]*second**-power[any_size[1]], numpy.inf)
    low, high = 1e-7, 0.1*lengths[any_size[0]]
    for _ in range(6):
        first = numpy.geomspace(low, high, 200)
        at = int(numpy.argmin(cost_of(first)))
        low, high = first[max(at - 1, 0)], first[min(at + 1, 199)]
    best = cost_of(first)[at]
    return best if numpy.isfinite(best) else None


def proofs(program, folder, random):
    """The worst case proven: no corner of the box leaves the enclosure, and the worst one nearly fills it."""
    verdicts = set()
    for number in range(PROOFS):
        lengths, start, side, carried = random_case(random)
        crank = start + numpy.radians(15)*numpy.arange(POSITIONS)
        joints = joints_of(lengths, start, side, carried)
        path = os.path.join(folder, "proof.nml")
        for word in ("CHECK", "SCALE"):
            with open(path, "w", encoding="utf-8") as f:
                f.write("""RANDOM FOUR-BAR
 &CHAIN JNT='A','B','C','D','P', JX=%s, JY=%s, LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P','distance A P' &END
 &METHOD IKIN=15 &END
 &LIMITS IPROOF=0 &END
 &ALLOC ALBAND=%r, ALOUT='point_P.x','point_P.y','distance_A_P', ALPROF='%s' &END
""" % (",".join(map(repr, map(float, joints.real))), ",".join(map(repr, map(float, joints.imag))), (0.01, 0.1, 1.0)[number % 3], word))
            done = subprocess.run([program, "--quiet", "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
            where = "proof %d, %s" % (number, word)
            tally.check(where + ": done", done.returncode in (0, 1), done.stderr)
            if done.returncode not in (0, 1):
                return
            with open(os.path.join(folder, "proof.allocation.csv"), encoding="utf-8") as f:
                table = {row["dimension"].lower(): float(row["tolerance"]) for row in csv.DictReader(f)}
            with open(os.path.join(folder, "proof.allocation_bands.csv"), encoding="utf-8") as f:
                bands = list(csv.DictReader(f))
            tolerance = numpy.array([table[n.lower()] for n in LENGTHS])
            corners = numpy.array(numpy.meshgrid(*[(-1, 1)]*5)).reshape(5, -1).T*tolerance
            places = coupler_point(lengths + corners, crank, carried, side)
            nominal = coupler_point(lengths, crank, carried, side)
            moved = {"point_P.x": places.real - nominal.real, "point_P.y": places.imag - nominal.imag,
                     "distance_A_P": abs(places) - abs(nominal)}
            verdicts |= {row["proof"] for row in bands}
            outside = narrow = wrong = 0
            for row in bands:
                most = moved[row["number"]][:, int(row["position"]) - 1]
                low, high, band = float(row["lowest"]), float(row["highest"]), float(row["band"])
                outside += most.min() < low - 1e-9 or most.max() > high + 1e-9
                narrow += max(most.min() - low, high - most.max()) > 0.05*(high - low)
                beyond = max(-most.min(), most.max()) > band
                wrong += row["proof"] == "certified" and beyond or row["proof"] == "violated" and not beyond
            tally.check(where + ": no corner is outside", outside == 0, outside)
            tally.check(where + ": corners nearly fill what is proven", narrow == 0, narrow)
            tally.check(where + ": verdicts are those of the corners", wrong == 0, wrong)
        tally.check(where + ": all bands are certified", done.returncode == 0 and {row["proof"] for row in bands} == {"certified"}, done.stderr)
        fullest = max(max(-float(row["lowest"]), float(row["highest"]))/float(row["band"]) for row in bands)
        tally.check(where + ": one is full", 1 - 1e-6 < fullest <= 1, fullest)
    # an output that is a line of the loops, and a joint that has no effect on it: the sketch and its loops have one factor
    factors = []
    text = STEPS.replace("'point P'", "'angle C D'") % ("0.0,18.0,88.0,95.0,60.0", "0.0,22.0,71.0,-4.0,80.0", "ALBAND=1.0, ALPROF='CHECK'")
    for options in (("--links",), ()):
        path = os.path.join(folder, "line.nml")
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        done = subprocess.run([program, *options, "--output-dir", folder, path], capture_output=True, text=True, check=False)
        factors += [float(n) for n in re.findall(r"ALL TOLERANCES TIMES +([0-9.]+)", done.stdout)]
        with open(os.path.join(folder, "line.dev7"), encoding="utf-8") as f:
            text = f.read()
    tally.check("proofs: a sketch and its loops have one factor", len(factors) == 2 and abs(factors[0] - factors[1]) < 1e-6, factors)
    tally.check("proofs: some bands are violated, some certified", {"certified", "violated"} <= verdicts, verdicts)


def stack(program, folder, random):
    """Three lengths in a line, a stack, with reciprocal costs: the closed form of Lagrange's multiplier (Chase and Greenwood 1988; with one
    exponent t_i is in proportion to B_i**(1/(K + order))), with different exponents the root of its equation."""
    names = ("length A B", "length B C", "length C D")
    for number in range(8):
        order = 1 + number % 2
        cost = 10**(random.random(3) - 0.5)
        power = numpy.full(3, 0.4 + random.random()) if number < 4 else 0.4 + random.random(3)
        band = 0.005 + 0.02*random.random()
        path = os.path.join(folder, "stack.nml")
        with open(path, "w", encoding="utf-8") as f:
            f.write("""A STACK
 &CHAIN JNT='A','B','C','D', JX=0.0,20.0,90.0,120.0, JY=4*0.0, LNAME='frame','crank','rod','slider', LNK='A','A B','B C','C D',
  SLNK='frame', SLNK2='slider', SLX=90.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='x D' &END
 &METHOD NDES=1, DELT=0.0 &END
 &LIMITS IPROOF=0 &END
 &ALLOC ALBAND=%r, ALRULE='%s', ALNAM=%s, ALCOST=%s, ALEXP=%s &END
""" % (band, RULES[order - 1], ",".join("'%s'" % n for n in names), ",".join("%r" % float(c) for c in cost), ",".join("%r" % float(p) for p in power)))
        done = subprocess.run([program, "--quiet", "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
        with open(os.path.join(folder, "stack.allocation.csv"), encoding="utf-8") as f:
            table = {row["dimension"]: float(row["tolerance"]) for row in csv.DictReader(f)}
        if number < 4:
            expected = cost**(1/(power + order))
            expected *= band/(expected**order).sum()**(1/order)
        else:
            at = lambda y: (cost*power*numpy.exp(-y))**(1/(power + order))
            expected = at(brentq(lambda y: (at(y)**order).sum() - band**order, -40, 80, xtol=1e-14, rtol=1e-14))
        found = numpy.array([table[n] for n in names])
        tally.check("stack %d: tolerances by Lagrange" % number, done.returncode == 0 and numpy.allclose(found, expected, rtol=2e-5), (found, expected))


def sampled(program, folder, count):
    """The share of the linkages within each band against those of a large sample of the linkage itself, for every law."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data", "cheapest_tolerances.nml"), encoding="utf-8") as f:
        text = f.read()
    path = os.path.join(folder, "sampled.nml")
    for law in ("UNIFORM", "TRIANGLE", "NORMAL"):
        with open(path, "w", encoding="utf-8") as f:
            # so narrow that linear bands are those of the linkage
            f.write(text.replace("ALBAND=0.2", "ALBAND=0.0002, ALLAW='%s'" % law).replace("ALTRY=10000", "ALTRY=%d" % count))
        done = subprocess.run([program, "--quiet", "--json", "--threads", "2", "--output-dir", folder, path], capture_output=True, text=True, check=False)
        tally.check("sample of %d, %s: done" % (count, law), done.returncode == 0, done.stderr)
        with open(os.path.join(folder, "sampled.allocation_bands.csv"), encoding="utf-8") as f:
            bands = list(csv.DictReader(f))
        shares = numpy.array([float(row["share_within"]) for row in bands])
        beyond = numpy.array([float(row["sample_beyond"]) for row in bands])/count
        error = numpy.sqrt(shares*(1 - shares)/count)
        off = (1 - shares - beyond)/numpy.maximum(error, 1/count)
        if count > 10**6:
            print("%s: share in the fullest band %.7f, of %d linkages %.7f, standard error %.1e; farthest of all bands %.2f of them" % (
                law, shares.min(), count, 1 - beyond[shares.argmin()], error[shares.argmin()], abs(off).max()))
        tally.check("sample of %d, %s: every share is within four standard errors" % (count, law), abs(off).max() < 4, off)


def by_loops(program, folder):
    """A linkage by &LINKS: 19 dimensions, lengths and angles, named as its listing names them."""
    data = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data", "needle.nml")
    with open(data, encoding="utf-8") as f:
        text = f.read()
    path = os.path.join(folder, "loops.nml")
    with open(path, "w", encoding="utf-8") as f:
        f.write(text.replace(" &LIMITS", " &TOLER TOLLEN=0.1, TOLANG=0.1 &END\n &ALLOC ALBAND=0.5, ALRULE='RSS' &END\n &LIMITS"))
    done = subprocess.run([program, "--json", "--output-dir", folder, path], capture_output=True, text=True, check=False)
    tally.check("loops: nothing but NITER=2 of this data set is amiss", done.returncode == 1 and "NITER=2" in done.stderr and
                not any(word in done.stderr for word in ("allotted", "linear bands", "ALLOC has")), done.stderr)
    with open(os.path.join(folder, "loops.allocation.csv"), encoding="utf-8") as f:
        names = [row["dimension"] for row in csv.DictReader(f)]
    with open(os.path.join(folder, "loops.allocation_bands.csv"), encoding="utf-8") as f:
        bands = [(float(row["used"]), float(row["band"])) for row in csv.DictReader(f)]
    tally.check("loops: 19 dimensions", len(set(names)) == 19 and "length of arc 2 in loop 1" in names, str(names))
    tally.check("loops: 20 bands, of which one is full", len(bands) == 20 and 0 <= min(b - u for u, b in bands) < 1e-6, str(bands))


def edges(program, folder):
    """What random linkages seldom have: two dimensions of which one alone fills a small share of the linkages, a pivot with a tolerance of
    its length alone, a driven slide, a normal law in the worst case, a band asked for of a ratio."""
    def run(text, *arguments):
        path = os.path.join(folder, "edge.nml")
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        for name in ("allocation", "allocation_bands"):
            if os.path.exists(os.path.join(folder, "edge.%s.csv" % name)):
                os.remove(os.path.join(folder, "edge.%s.csv" % name))
        done = subprocess.run([program, "--quiet", "--json", "--output-dir", folder, *arguments, path], capture_output=True, text=True, check=False)
        rows = {}
        for name in ("allocation", "allocation_bands"):
            table = os.path.join(folder, "edge.%s.csv" % name)
            if os.path.exists(table):
                with open(table, encoding="utf-8") as f:
                    rows[name] = list(csv.DictReader(f))
        return done, rows.get("allocation", []), rows.get("allocation_bands", [])

    def data(name):
        with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data", name), encoding="utf-8") as f:
            return f.read()
    bar = ("A BAR\n &CHAIN JNT='A','B','C','D', JX=0.0,1.0,3.0,3.0, JY=0.0,0.0,1.0,0.0, LNAME='f','a','b','c', LNK='A D','A B','B C','C D' &END\n"
           " &DRIVES DRIVE='A', DBASE='f', DLINK='a' &END\n &OUTPUTS OUTPUT='x B'%s &END\n"
           " &METHOD NDES=2, DELT=0.0,10.0 &END\n &ALLOC ALBAND=0.01%s &END\n")
    for share, cost in ((30.0, 0.1), (50.0, 0.1), (90.0, 1e-4), (99.0, 1e-2)):
        done, _, bands = run(bar % ("", ", ALRULE='YIELD', ALYLD=%r, ALNAM='A B','A D', ALCOST=1.0,%r" % (share, cost)))
        kept = all(float(b["used"]) <= float(b["band"])*(1 + 2e-6) for b in bands)
        tally.check("yield %g: within the bands, or not called done" % share, bands and done.returncode == 0 and kept or
                    done.returncode == 1 and not bands and "do not settle" in done.stderr, done.stderr + str(bands))
    done, _, _ = run(bar % ("", ", ALRULE='WORST', ALLAW='NORMAL', ALTRY=20000"))
    tally.check("worst case of normal deviations: some lie beyond, as the law has it", done.returncode == 0, done.stderr)
    done, _, _ = run(bar % (",'ratio 1 1'", ", ALOUT='x_B','x_B'"))
    tally.check("a number named twice is refused", done.returncode == 2, done.stderr)
    pivot = data("dyad1_crank_rocker.nml").replace("&METHOD", "&METHOD ORIGLK=5.0, ORIGNG=45.0,", 1)
    for tolerances in ("", " &TOLER TOLORL=0.1 &END\n", " &TOLER TOLLEN=0.1, TOLORL=0.1 &END\n"):
        done, rows, _ = run(pivot.rstrip() + "\n" + tolerances + " &ALLOC ALBAND=0.5 &END\n")
        names = [r["dimension"] for r in rows]
        tally.check("a pivot with a tolerance of its length: %s" % (tolerances.strip() or "none given"),
                    done.returncode == 0 and names and not any("angle" in n for n in names), (done.stderr, names))
    slide = data("actuator_rapson_slide.nml")
    done, rows, _ = run(slide.rstrip() + "\n &TOLER TOLLEN=0.1, TOLCRK=0.1 &END\n &ALLOC ALBAND=0.5 &END\n")
    tally.check("a driven slide has tolerances above 0 and finite costs", done.returncode in (0, 1) and rows and
                all(float(r["tolerance"]) > 0 and numpy.isfinite(float(r["cost"])) for r in rows), (done.stderr, rows))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("programs")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--starts", type=int, default=STARTS)
    parser.add_argument("--sample", type=int, default=SAMPLE)
    parser.add_argument("--only", choices=("cases", "sample"))
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--groups", type=int, default=12)
    options = parser.parse_args()
    failed = []
    random = numpy.random.default_rng(41)
    program = os.path.join(os.path.abspath(options.programs), "psalm")
    with tempfile.TemporaryDirectory() as folder:
        if options.only is None:
            by_loops(program, folder)
            edges(program, folder)
            stack(program, folder, numpy.random.default_rng(43))
            proofs(program, folder, numpy.random.default_rng(42))
        if options.only != "cases":
            sampled(program, folder, options.sample)
        for number in range(0 if options.only == "sample" else options.cases):
            one(program, folder, number, random, options.starts, failed)
        tally.check("SLSQP keeps the bands from some start in 98 of 100 cases", len(failed) <= 0.02*options.cases, failed)
    return tally.report()


sys.exit(main())
