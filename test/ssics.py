#!/usr/bin/env python3
"""ssics from outside: Hill's equation against an independent integrator (SciPy), the published rig, bad input.

usage: ssics.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import cmath
import os
import random
import subprocess
import sys
import tempfile

import numpy
from scipy.integrate import solve_ivp

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BIN = os.path.abspath(sys.argv[1])
passed = failed = 0


def check(right, law, got=""):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: %s%s" % (law, "; got %s" % got if got != "" else ""))


def run(text, place):
    """Exit status, listing, standard error, blocks of device 9."""
    name = os.path.join(place, "case.nml")
    with open(name, "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "ssics"), "case.nml"], cwd=place, capture_output=True, text=True, timeout=300)
    blocks, rows = {}, None
    device = os.path.join(place, "case.ssics.dev9")
    if os.path.exists(device):
        for line in open(device, encoding="utf-8"):
            if line.startswith("# block "):
                rows = blocks.setdefault(line.split()[2], [])
            elif line.strip() and not line.startswith("#"):
                rows.append([float(word) for word in line.split()])
        os.remove(device)
    return done.returncode, done.stdout, done.stderr, blocks


def data(name, *changes):
    text = open(os.path.join(TOP, "data", name), encoding="utf-8").read()
    for old, new in changes:
        assert text.count(old) == 1, "%s: %r is there %d times" % (name, old, text.count(old))
        text = text.replace(old, new)
    return text


def values(name, row):
    return " %s=%s" % (name, ",\n  ".join(",".join("%.17g" % v for v in row[i:i + 4]) for i in range(0, len(row), 4)))


def random_hill(seed, place):
    """Multipliers and steady state of a random equation, stable or not, against DOP853."""
    draw = random.Random(seed)
    points = 32
    x = 2*numpy.pi*numpy.arange(points)/points

    def series(mean, size):
        terms = [(k, draw.uniform(-size, size)/k, draw.uniform(-size, size)/k) for k in range(1, 5)]
        return lambda t: mean + sum(a*numpy.cos(k*t) + b*numpy.sin(k*t) for k, a, b in terms)

    c1 = series(draw.choice([0.0, 0.05, 0.2]), 0.1)
    c0 = series(draw.uniform(0.1, 30.0), draw.uniform(0.1, 6.0))
    p = series(draw.uniform(-1.0, 1.0), 1.0)
    code, _, error, blocks = run("RANDOM\n &HILL NHILL=%d, HTOL=1E-12,\n%s,\n%s,\n%s &END\n" % (
        points, values("HC1", c1(x)), values("HC0", c0(x)), values("HP", p(x))), place)

    def flow(start, forced):
        done = solve_ivp(lambda t, y: [y[1], forced*p(t) - c1(t)*y[1] - c0(t)*y[0]], [0.0, 2*numpy.pi], start, method="DOP853",
                         rtol=1e-12, atol=1e-13)
        return done.y[:, -1]

    period = numpy.column_stack([flow([1.0, 0.0], 0.0), flow([0.0, 1.0], 0.0)])
    want = sorted(numpy.linalg.eigvals(period), key=lambda m: (-abs(m), -m.imag))
    got = [complex(*row) for row in blocks["hill_multipliers"]]
    scale = max(1.0, numpy.abs(period).max())
    check(all(min(abs(g - w) for w in want) <= 1e-8*scale for g in got), "multipliers against DOP853, seed %d" % seed, got)
    start = numpy.linalg.solve(numpy.eye(2) - period, flow([0.0, 0.0], 1.0))
    row = blocks["hill_response"][0]
    check(abs(row[1] - start[0]) + abs(row[2] - start[1]) <= 1e-7*max(1.0, abs(start).max()), "steady state, seed %d" % seed, row)
    unstable = max(abs(w) for w in want) > 1.0 + 1e-6
    check(code == (1 if unstable else 0), "exit status of a %s equation, seed %d" % ("growing" if unstable else "bounded", seed), code)
    check(("unstable" in error) == unstable, "an unstable equation is told, seed %d" % seed, error)
    return unstable


def rig(place):
    code, listing, error, blocks = run(data("rig_coupler.nml"), place)
    check(code == 0, "the rig at a stable speed", error)
    ratio = {(int(m), int(p)): (cmath.sqrt(low), cmath.sqrt(high)) for m, p, low, high in blocks["boundaries"]}
    for p, want in ((3, (1.197983, 2.157100)), (4, (2.184880, 2.536476)), (8, (4.032150, 4.034855))):
        check(max(abs(a - b) for a, b in zip(ratio[1, p], want)) < 1.5e-6, "boundary of the rig, p = %d" % p, ratio[1, p])
    first = {round(row[0], 6): row for row in blocks["chart"] if row[1] == 3}
    check(abs(first[0.5][3] - 1.790064) < 1.5e-6, "chart of the rig", first[0.5])
    stable = {row[0]: row[2] for row in blocks["speeds"]}
    check(all(stable[w] == 0 for w in range(50, 58)) and all(stable[w] == 1 for w in range(15, 44)), "unstable speeds of the rig")
    check("LOOK CLOSER" in listing, "estimate of the rig")
    product = 1.0
    for mode, re, im in blocks["multipliers"]:
        product *= abs(complex(re, im)) if mode == 0 else 1.0
    zeta, w = 0.015, 5.417309
    check(abs(product - cmath.exp(-4*cmath.pi*zeta*w*(1 + 4)).real) < 1e-8, "product of all multipliers is that of the damping", product)
    # heavier: weight bends the link, but it does not change what is exact
    code, _, error, _ = run(data("rig_coupler.nml", ("SPEED=23.07", "SPEED=52.0")), place)
    check(code == 1 and "unstable" in error, "the rig between two boundaries", error)


def drives(place):
    """Haines's case study: the centres as tabulated, and with the offsets dropped as he did."""
    def figure(listing, words, place_of):
        line = next(line for line in listing.split("\n") if words in line)
        return float(line.replace(",", " ").replace("D-", "E-").replace("D+", "E+").split()[place_of])

    code, listing, error, blocks = run(data("drive_haines.nml"), place)
    check(code == 0, "the case study", error)
    check(abs(figure(listing, "MEAN INERTIA", 5)/0.0015095 - 1) < 5e-4, "mean inertia, tabulated centres")
    check(abs(figure(listing, "STIFFNESS", 3)/8.6910 - 1) < 5e-4, "D for a mean ratio of 10, tabulated centres")
    code, listing, error, _ = run(data("drive_haines.nml", ("DMEAN=10.0", "DOFFS=0, DMEAN=10.0")), place)
    check(abs(figure(listing, "MEAN INERTIA", 5)/0.001583 - 1) < 5e-4, "mean inertia, offsets dropped")
    check("OFFSETS" in listing, "dropped offsets are told")
    code, _, error, _ = run(data("drive_haines.nml", ("DMEAN=10.0", "DMEAN=0.2")), place)
    check(code == 1, "a mean ratio that no stiffness gives", error)
    mean = numpy.mean([row[1] for row in blocks["drive_inertia"]])
    check(abs(mean/0.0015095 - 1) < 5e-4, "inertia on device 9", mean)


def bad_input(place):
    for changes, status, words in (
            ([("VLINK=2", "VLINK=4")], 2, "is on the frame"),
            ([("VLINK=2", "VLINK=7")], 2, "there is no arc 7"),
            ([("VMOD=207E9", "VMOD=-1")], 2, "&VIBR VMOD: entry 1: must be above 0"),
            ([("VRHO=7850.0, ", "")], 2, "&VIBR VRHO: missing"),
            ([("VDEPTH=0.00124, VWIDTH=0.00635", "VAREA=1E-5")], 2, "&VIBR VGYR: missing"),
            ([("VDEPTH=0.00124, ", "VAREA=1E-5, ")], 2, "not by both"),
            ([(" &RATES SPEED=23.07, UNITS='RAD/S' &END\n", "")], 2, "ssics needs the SPEED"),
            ([("SPEED=23.07", "SPEED=0.0")], 2, "a speed other than 0"),
            ([("SPEED=23.07", "SPEED=23.07, ACCEL=1.0")], 2, "constant speed"),
            ([("NMASS=1, MLINK=3", "NMASS=1, MLINK=2")], 2, "&MASSES has a mass on this link"),
            ([("VZETA=0.015", "VZETA=1.5")], 2, "must lie between 0 and 1"),
            ([("NMODE=2", "NMODES=2")], 2, "did you mean NMODE?"),
            ([("76.2,381.0,152.4,381.0", "160.0,381.0,152.4,381.0")], 1, "cannot make a full turn"),
            ([("VDEPTH=0.00124", "VDEPTH=0.0002")], 1, "buckles")):
        code, _, error, _ = run(data("rig_coupler.nml", *changes), place)
        check(code == status and words in error, "told: %s" % words, "%d %s" % (code, error))
    code, _, error, _ = run("EMPTY\n &HILL NHILL=4, HC0=1.0 &END\n", place)
    check(code == 2 and "4 values are announced by NHILL, but only 1 given" in error, "a short table", error)
    for text in ("TYPING ERROR\n &HILL NHIL=2, HC0=1.0,2.0 &END\n", data("rig_coupler.nml", ("NMASS=1", "NMAS=1"))):
        code, _, error, _ = run(text, place)
        check(code == 2 and error.count("error:") == 1 and "did you mean N" in error, "a misspelt count is told once", error)
    code, _, error, _ = run("TOO STEEP\n &HILL NHILL=1, HC0=-1E6 &END\n", place)
    check(code == 1 and "grows too much" in error, "growth that cannot be followed", error)
    code, _, error, _ = run("RESONANCE\n &HILL NHILL=1, HC0=4.0 &END\n", place)
    check(code == 1 and "no unique periodic solution" in error, "a multiplier of 1", error)
    code, _, error, _ = run(data("dyad1_crank_rocker.nml"), place)
    check(code == 2 and "asks for nothing" in error, "a case without a group of ssics", error)


def main():
    with tempfile.TemporaryDirectory() as place:
        kinds = [random_hill(seed, place) for seed in range(10)]
        check(any(kinds) and not all(kinds), "stable and unstable ones among them", kinds)
        rig(place)
        drives(place)
        bad_input(place)
    print("%d passed, %d failed" % (passed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
