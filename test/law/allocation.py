"""The cheapest tolerances of random four-bars against SciPy, on a model of their own.

usage: allocation.py PROGRAM_DIRECTORY [--cases N] [--starts N] [--sample N] [--only PART]. The changes of the coupler point with every length are differences of positions
computed here. Of each case SLSQP has several starts; no allocation may be dearer than its best, leave a band, or lie below its bound.
Of a yield random linkages of this model are drawn. Proofs of the worst case are compared with all corners of the box. Last line: N passed, N failed.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import minimize
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
    b = lengths[0]*numpy.exp(1j*start)
    p = coupler_point(lengths, crank[:1], carried, side)[0]
    c = b + (p - b)/(lengths[4]*carried)*lengths[1]
    turned = numpy.exp(1j*random.random()*6)
    joints = numpy.array((0, b, c, lengths[3], p))*turned
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


def proofs(program, folder, random):
    """The worst case proven: no corner of the box leaves the enclosure, and the worst one nearly fills it."""
    verdicts = set()
    for number in range(PROOFS):
        lengths, start, side, carried = random_case(random)
        crank = start + numpy.radians(15)*numpy.arange(POSITIONS)
        b = lengths[0]*numpy.exp(1j*start)
        p = coupler_point(lengths, crank[:1], carried, side)[0]
        c = b + (p - b)/(lengths[4]*carried)*lengths[1]
        joints = numpy.array((0, b, c, lengths[3], p))
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
    tally.check("proofs: some bands are violated, some certified", {"certified", "violated"} <= verdicts, verdicts)


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
    options = parser.parse_args()
    failed = []
    random = numpy.random.default_rng(41)
    program = os.path.join(os.path.abspath(options.programs), "psalm")
    with tempfile.TemporaryDirectory() as folder:
        if options.only is None:
            by_loops(program, folder)
            edges(program, folder)
            proofs(program, folder, numpy.random.default_rng(42))
        if options.only != "cases":
            sampled(program, folder, options.sample)
        for number in range(0 if options.only == "sample" else options.cases):
            one(program, folder, number, random, options.starts, failed)
        tally.check("SLSQP keeps the bands from some start in 98 of 100 cases", len(failed) <= 0.02*options.cases, failed)
    return tally.report()


sys.exit(main())
