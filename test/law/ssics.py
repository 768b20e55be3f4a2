#!/usr/bin/env python3
"""ssics from outside: Hill's equation against an independent integrator (SciPy), the published rig, bad input.

usage: ssics.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import cmath
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile

import numpy
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import curve_plots

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.abspath(sys.argv[1])
passed = failed = 0


def check(right, law, got=""):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: %s%s" % (law, "; got %s" % got if got != "" else ""))


def run(text, place, *options):
    """Exit status, listing, standard error, blocks of device 9."""
    name = os.path.join(place, "case.nml")
    with open(name, "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "ssics"), *options, "case.nml"], cwd=place, capture_output=True, text=True, timeout=300)
    blocks, rows = {}, None
    device = os.path.join(place, "case.ssics.dev9")
    if os.path.exists(device):
        for line in open(device, encoding="utf-8"):
            if line.startswith("# block "):
                rows = blocks.setdefault(line.split()[2], [])
            elif line.strip() and not line.startswith("#"):
                # Fortran leaves out the E of an exponent of three digits
                rows.append([float(re.sub(r"(\d)([+-]\d{3})$", r"\1E\2", word)) for word in line.split()])
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
    for stiffness, known in ((5.0, False), (50.0, True)):
        code, listing, error, _ = run(data("drive_haines.nml", ("DMEAN=10.0", "DSTIF=%g" % stiffness)), place, "--json")
        with open(os.path.join(place, "case.ssics.json"), encoding="utf-8") as file:
            ratio = json.load(file)["cases"][0]["blocks"]["drive"]["columns"]["frequency_per_speed"]
        check((ratio[0] is not None) == ("SPEED IS NOT REAL" not in listing) == known, "a ratio that is not real is none", "%s at %g" % (ratio[0], stiffness))
    mean = numpy.mean([row[1] for row in blocks["drive_inertia"]])
    check(abs(mean/0.0015095 - 1) < 5e-4, "inertia on device 9", mean)


def harmonics_of(listing):
    """Rows of the drive's harmonics: n, swing, acceleration, output's acceleration, the same of a rigid drive."""
    rows = []
    for line in listing.split(" HARMONICS OF THE CRANK")[1].split("\n")[1:]:
        words = line.replace("*", "").split()
        if not words or not words[0].isdigit():
            break
        rows.append([float(word.replace("D", "E")) for word in words])
    return numpy.array(rows)


def case_study(place):
    """Haines's figures of his case study (offsets dropped), and the right ones."""
    def listed(listing, words, at):
        line = next(line for line in listing.split("\n") if words in line)
        return float(line.replace(",", " ").replace("D-", "E-").replace("D+", "E+").split()[at])

    code, listing, error, _ = run(data("drive_haines.nml"), place)
    for at, want in ((5, 0.0015095), (12, 0.9519), (16, 1.2975)):
        check(abs(listed(listing, "MEAN INERTIA", at)/want - 1) < 5e-4, "inertia with the centres as tabulated", want)
    code, listing, error, _ = run(data("drive_haines.nml", ("DMEAN=10.0", "DOFFS=0, DMEAN=10.0")), place)
    for at, want in ((5, 0.001583), (12, 0.4755), (16, 0.6479)):
        check(abs(listed(listing, "MEAN INERTIA", at)/want - 1) < 5e-4, "inertia with the offsets dropped", want)
    check(abs(listed(listing, "WITH THE OFFSETS", 8)/0.0015095 - 1) < 5e-4, "the right inertia is listed beside")
    mean, speed = listed(listing, "MEAN INERTIA", 5), 20*numpy.pi

    def at_ratio(d, *changes):
        return run(data("drive_haines.nml", ("DMEAN=10.0", "DOFFS=0, DSTIF=%.12g" % (mean*(d*speed)**2)),
                        ("NDSPED=51", "NDSPED=0"), *changes), place)

    code, listing, error, blocks = at_ratio(9.7386)
    rows = harmonics_of(listing)
    want = [.2074, .08425, .02871, .01250, .00691, .00481, .00355, .00881, .01708, .00729, .01117]
    check(numpy.abs(rows[1:12, 3] - want).max() < 1e-4, "harmonics of the rocker", rows[1:12, 3])
    check(numpy.abs(rows[1:7, 4] - [.207376, .083158, .025899, .00739, .00196, .000502]).max() < 2e-6,
          "harmonics of the rocker with a rigid drive", rows[1:7, 4])
    check("ERROR OF ITS MATRIX" in listing, "accuracy of the turn is told")
    ratios = numpy.array([9.715, 9.735, 9.755])
    sizes = [harmonics_of(at_ratio(d)[1])[9, 3] for d in ratios]
    peak = -numpy.polyfit(ratios, sizes, 2)[1]/(2*numpy.polyfit(ratios, sizes, 2)[0])
    check(abs(peak/9.7348 - 1) < 2e-3, "stiffness at which harmonic 9 of the rocker is largest", peak)
    code, listing, error, _ = at_ratio(9.741, ("0.02,0.00016", "0.02,0.00032"))
    check(abs(listed(listing, "MEAN RATIO OF", 8)/9.4885 - 1) < 5e-4, "mean ratio with twice the inertia of the crank",
          listed(listing, "MEAN RATIO OF", 8))
    # his other form: J0 (1 + f sin 2 phi), multipliers of half a turn
    text = data("drive_haines.nml", ("DMEAN=10.0, DDAMP=0.02", "DRIPPL=0.7, DEXTRA=0.01, DMEAN=10.0, DDAMP=0.02"))
    code, listing, error, blocks = run(text, place)
    check(abs(listed(listing, "STIFFNESS", 3) - 4.41665) < 1e-5, "D of the form with 2 phi", error)
    rows = harmonics_of(listing)
    check(abs(rows[2, 2] - 2*0.018964) < 1e-6 and abs(rows[14 if len(rows) > 14 else 12, 2] - 2*0.022989) < 1e-6 and rows[3, 2] == 0,
          "harmonics of the form with 2 phi", rows[:, 2])
    check(rows[12, 2] > 0.001 and "*" in listing.split(" HARMONICS OF THE CRANK")[1].split("\n")[13], "a harmonic that matters is marked")


def rig_functions(e):
    """The stiffness e g + h of the rig's coupler by closed forms (14.13): independent of the program."""
    def f(phi):
        diagonal = numpy.hypot(5 - numpy.cos(phi), numpy.sin(phi))
        th2 = numpy.arctan2(-numpy.sin(phi), 5 - numpy.cos(phi)) + numpy.arccos((25 + diagonal**2 - 4)/(10*diagonal))
        th3 = numpy.arctan2(numpy.sin(phi) + 5*numpy.sin(th2), numpy.cos(phi) + 5*numpy.cos(th2) - 5)
        w2 = -numpy.sin(phi - th3)/(5*numpy.sin(th2 - th3))
        w3 = numpy.sin(phi - th2)/(2*numpy.sin(th3 - th2))
        a3 = (numpy.cos(phi - th2) + 5*w2**2 - 2*w3**2*numpy.cos(th3 - th2))/(2*numpy.sin(th3 - th2))
        cosec = 1/numpy.sin(th3 - th2)
        h1 = numpy.pi**2*(2*a3*cosec/15 + numpy.sin(th3 - phi)*cosec/30)
        return e*numpy.pi**2*cosec*a3 + h1 - 1.25*w2**2
    return f


def chart(place):
    """The chart of stability against the integration of 2000 points over a turn by SciPy; boundaries and multipliers to 1e-9."""
    code, _, error, blocks = run(data("rig_coupler.nml", ("NVSPED=46", "NVSPED=0, VPMAX=20"), ("NVCHRT=41", "NVCHRT=20"),
                                      ("VEMAX=4.0", "VEMAX=3.8")), place)
    rows = {}
    for e, p, low, high in blocks["chart"]:
        rows.setdefault(e, []).append((low*abs(low), high*abs(high)))
    values = sorted(rows)
    ratios = numpy.linspace(0.05, 7.95, 100)
    stiffness = [rig_functions(e) for e in values]
    squares = ratios**2

    def slope(phi, y):
        y = y.reshape(len(values), 4, len(ratios))
        k = numpy.array([f(phi) for f in stiffness])[:, None] + squares[None, :]
        return numpy.stack([y[:, 1], -k*y[:, 0], y[:, 3], -k*y[:, 2]], axis=1).ravel()

    start = numpy.zeros((len(values), 4, len(ratios)))
    start[:, 0] = start[:, 3] = 1
    done = solve_ivp(slope, [0, 2*numpy.pi], start.ravel(), method="DOP853", rtol=1e-9, atol=1e-12)
    end = done.y[:, -1].reshape(start.shape)
    trace = end[:, 0] + end[:, 3]
    checked = wrong = 0
    for i, e in enumerate(values):
        for k, w in enumerate(squares):
            inside = w < rows[e][0][0] or any(low < w < high for low, high in rows[e])
            near = min(abs(w - edge) for pair in rows[e] for edge in pair)
            if near < 1e-6:
                continue
            checked += 1
            wrong += inside != (abs(trace[i, k]) > 2)
    check(checked >= 1990 and wrong == 0, "chart against 2000 integrated points", "%d of %d differ" % (wrong, checked))

    def turn(f, w, damping):
        done = solve_ivp(lambda x, y: [y[1], -(f(x) + w)*y[0] - damping*y[1], y[3], -(f(x) + w)*y[2] - damping*y[3]],
                         [0, 2*numpy.pi], [1, 0, 0, 1], method="DOP853", rtol=3e-14, atol=1e-15)
        return numpy.array([[done.y[0, -1], done.y[2, -1]], [done.y[1, -1], done.y[3, -1]]])

    f = rig_functions(0.001955401856/(7850.0*0.00124*0.00635*0.381**2*0.1524))
    boundaries = {(int(m), int(p)): (low, high) for m, p, low, high in blocks["boundaries"]}
    for p in (3, 4, 5):
        for edge in boundaries[1, p]:
            step = 1e-4
            below, above = (numpy.trace(turn(f, edge + d, 0.0)) for d in (-step, step))
            root = edge - (numpy.trace(turn(f, edge, 0.0)) - 2*(-1)**p)*2*step/(above - below)
            check(abs(root - edge) < 1e-9*max(1, abs(edge)), "boundary %d against the integration" % p, root - edge)
    code, listing, error, blocks = run(data("rig_coupler.nml", ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"),
                                            ("NMODE=2", "NMODE=1")), place)
    ratio = (numpy.pi/0.381)**2*0.00124/numpy.sqrt(12)*numpy.sqrt(207e9/7850)/23.07
    got = [complex(re, im) for mode, re, im in blocks["multipliers"] if mode == 1]
    check(len(got) == 2 and abs(got[0]*got[1] - numpy.exp(-4*numpy.pi*0.015*ratio)) < 1e-9, "determinant of the damping", got)
    want = numpy.linalg.eigvals(turn(f, ratio**2, 0.03*ratio))
    check(max(min(abs(g - w) for w in want) for g in got) < 1e-9, "multipliers of the rig", got)
    errors = [float(line.split("EXP(-INTEGRAL C1)")[1].split(",")[0].replace("D", "E")) for line in listing.split("\n") if "EXP(-INTEGRAL C1)" in line]
    check(len(errors) == 1 and errors[0] < 1e-11, "error of the determinant is told", errors)


def con_rod(place):
    """Connecting rod of a slider-crank: the boundaries of theory, e the slider's mass over the rod's."""
    text = data("dyad4_slider_crank.nml")
    area, density = 1e-4, 7850.0
    rod = 0.0
    for line in text.split("\n"):
        if "ARCL=" in line:
            rod = float(line.split("ARCL=")[1].split(",")[1])*0.001
    assert rod > 0
    text += (" &RATES SPEED=600.0, UNITS='REV/MIN' &END\n &MASSES NMASS=1, MLINK=-3, MLOOP=1, MASS=%.17g, UNITL=0.001 &END\n"
             " &VIBR VLINK=2, VLOOP=1, VMOD=2E11, VRHO=%g, VAREA=%g, VGYR=0.002, VEMAX=1.0, NVCHRT=3 &END\n"
             % (density*area*rod, density, area))
    code, listing, error, blocks = run(text, place)
    check("chart" in blocks, "the connecting rod", error)
    rows = {(e, int(p)): (low, high) for e, p, low, high in blocks.get("chart", [])}
    for key, want in (((1.0, 2), (.138179, 1.571266)), ((1.0, 3), (1.636650, 1.897789)), ((1.0, 4), (2.145179, 2.172208)),
                      ((.5, 2), (.805903, 1.451941)), ((.5, 3), (1.620378, 1.708352))):
        got = rows.get(key, (0, 0))
        check(max(abs(a - b) for a, b in zip(got, want)) < 1.5e-6, "boundary of the connecting rod", "%s %s" % (key, got))


def blocks_and_curves(place):
    """Device 9 has the blocks and columns of the manual; the curves are made."""
    run(data("rig_coupler.nml"), place)
    code, _, error, _ = run(data("rig_coupler.nml"), place, "--curves")
    name = os.path.join(place, "case.ssics.curves.svg")
    check(code == 0 and os.path.exists(name), "curves of the rig", error)
    plots = curve_plots.plots_of(name)
    check([plot.name for plot in plots] == ["deflection by mode, m", "the bent link: deflection, m", "greatest deflection of mode 1, m",
                                            "frequency/speed, chart of stability"], "four panels", [plot.name for plot in plots])
    modes, bent = plots[:2]
    at = lambda mode, angle: numpy.interp(angle, *zip(*modes.line("mode %d" % mode)))
    length = 0.381
    check(len(bent.lines) == 12 and abs(bent.last - length) < 1e-12, "the bent link: from pin to pin, twelve times a turn", bent.last)
    for label, _, points in bent.lines:
        shape = [sum(at(j, float(label.split()[0]))*math.sin(j*math.pi*x/length) for j in (1, 2)) for x, _ in points]
        off = max(abs(v - w) for (_, v), w in zip(points, shape))
        check(off < 2*modes.error() + bent.error() and abs(points[-1][0] - length) < 1e-3*length and len(points) == 49,
              "the bent link: its modes together, " + label, off)
    drawn = plots[2].spans
    code, listing, error, blocks = run(data("rig_coupler.nml"), place)
    bands = [[float(word.replace("D", "E")) for word in line.split()] for line in listing.split(" MODE 1 GROWS AT SPEEDS")[1].split("\n")[1:3]]
    # undamped p = 5 lies at 424.82 to 446.71 rev/min, p = 4 at 470.73 to 546.48: damping makes them a little narrower
    inside = all(low < b[2] < b[3] < high and b[3] - b[2] > 0.9*(high - low) for b, (low, high) in
                 zip(bands, ((424.7, 446.6), (470.6, 546.3))))
    check(inside, "the bands of p = 5 and 4 of the damped rig", bands)
    told = [(b[2]*math.pi/30, b[3]*math.pi/30) for b in bands]
    check(all(any(abs(a - c) + abs(b - d) < 0.5 for c, d in drawn) for a, b in told), "unstable speeds are shaded", "%s %s" % (drawn, told))
    done = subprocess.run([os.path.join(BIN, "ssics"), "case.nml"], cwd=place, capture_output=True, text=True, timeout=100)
    lines = open(os.path.join(place, "case.ssics.dev9"), encoding="utf-8").read().split("\n")
    heads = {line.split()[2]: lines[i + 1 + (lines[i + 1].startswith("# run"))] for i, line in enumerate(lines) if line.startswith("# block ")}
    for block, columns in (("boundaries", "mode p omega2_low omega2_high"), ("multipliers", "mode re im"),
                           ("harmonics", "mode n amplitude"), ("response", "input y y1 y2"), ("speeds", "speed amplitude stable"),
                           ("chart", "e p omega_low omega_high")):
        check(heads.get(block) == "# " + columns, "columns of the block " + block, heads.get(block))
    check(done.returncode == 0, "the rig again")
    for name in ("drive_haines.nml", "ssics/hill.nml"):
        code, _, error, _ = run(data(name), place, "--curves")
        drawn = os.path.join(place, "case.ssics.curves.svg")
        check(code == 0 and curve_plots.plots_of(drawn), "curves of " + name, error)
        os.remove(drawn)


def hard_cases(place):
    # the rocker turns about a pin that stands still
    code, _, error, blocks = run(data("rig_coupler.nml", ("VLINK=2", "VLINK=3"), ("NMASS=1, MLINK=3", "NMASS=1, MLINK=-1"),
                                      ("VEMAX=4.0", "VEMAX=0.0")), place)
    check(code < 2 and len(blocks["response"]) > 0, "the rocker as the vibrating link", error)
    # backwards: the same as the mirrored linkage forwards
    forward = run(data("rig_coupler.nml", ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0")), place)[3]
    backward = run(data("rig_coupler.nml", ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"), ("SPEED=23.07", "SPEED=-23.07")), place)[3]
    check(numpy.allclose(forward["boundaries"], backward["boundaries"], rtol=1e-9, atol=1e-9), "boundaries do not depend on the sense")
    check(backward["response"][1][0] < 0 < forward["response"][1][0], "a crank that turns backwards goes through negative inputs")
    near = lambda rows: max(abs(row[1]) for row in rows)
    check(near(forward["response"]) > 0 and abs(near(forward["response"]) - near(backward["response"])) > 1e-9,
          "the damped response depends on the sense")
    # undamped it is the same motion backwards
    still = [("VZETA=0.015", "VZETA=0.0"), ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0")]
    forward = run(data("rig_coupler.nml", *still), place)[3]["response"]
    backward = run(data("rig_coupler.nml", ("SPEED=23.07", "SPEED=-23.07"), *still), place)[3]["response"]
    mirrored = [forward[0][1]] + [row[1] for row in reversed(forward[1:])]
    check(numpy.abs(numpy.array(mirrored) - [row[1] for row in backward]).max() < 1e-9, "undamped, the motion runs backwards")
    code, _, error, _ = run(data("rig_coupler.nml", ("76.2,381.0,152.4,381.0", "152.4,381.0,152.4,381.0")), place)
    check(code == 1 and "loop 1 passes a dead point" in error, "a parallelogram is told with its angle", error)
    code, _, error, _ = run(data("rig_coupler.nml", ("NVCHRT=41", "NVCHRT=2, NVPNT=24")), place)
    check("do not show all of the coefficients" in error, "too few positions are told", error)
    # a stiff link at a low speed: all multipliers, and what the damping makes of them, are below the smallest number
    code, listing, error, _ = run(data("rig_coupler.nml", ("SPEED=23.07", "SPEED=0.05"), ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"),
                                       ("NMODE=2", "NMODE=4")), place)
    check(code < 2 and figure_after(listing, "THEIR PRODUCT AGAINST THAT OF THE DAMPING: ERROR") == 0.0, "multipliers that vanish: the error", error)


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
            ([("NMASS=1, MLINK=3", "NMASS=1, MLINK=2")], 2, "&MASSES or &PLATES has a mass on this link"),
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
    for damping in (1e6, 1e9):
        code, listing, error, _ = run("STIFF\n &HILL NHILL=1, HC0=1.0, HC1=%g, HP=1.0 &END\n" % damping, place)
        check(code == 1 and "too stiff" in error and "MULTIPLIERS" not in listing, "damping that cannot be followed: %g" % damping, error)
        code, listing, error, _ = run("STIFF\n &HILL NHEQN=2, NHILL=1, HMC0=1.0,0,0,2.0, HMC1=0,%g,0,0 &END\n" % damping, place)
        check(code == 1 and "too stiff" in error and "unstable" not in error, "coupling that cannot be followed: %g" % damping, error)
    code, listing, error, _ = run("DAMPED\n &HILL NHILL=1, HC0=1.0, HC1=1E5, HP=1.0 &END\n", place)
    check(code == 0 and abs(float(listing.split("STEADY STATE AT 0")[1].split()[0]) - 1.0) < 1e-6, "a strong damping: y = p/c0", error)
    code, _, error, _ = run("RESONANCE\n &HILL NHILL=1, HC0=4.0 &END\n", place)
    check(code == 1 and "no unique periodic solution" in error, "a multiplier of 1", error)
    code, _, error, _ = run(data("dyad1_crank_rocker.nml"), place)
    check(code == 2 and "asks for nothing" in error, "a case without a group of ssics", error)


def named(place):
    """A link of a sketch by its name is the arc of the loops that psalm makes of it."""
    sketch = open(os.path.join(TOP, "data", "sketch_slider_crank.nml"), encoding="utf-8").read()
    group = " &RATES SPEED=100.0 &END\n &MASSES NMASS=1, MNAME='piston', MASS=0.5, UNITL=0.001 &END\n &VIBR VNAME='%s', " \
            "VMOD=2E11, VRHO=7800, VDEPTH=0.01, VWIDTH=0.005 &END\n"
    results = []
    for name in ("rod", "rod C B"):
        code, listing, error, _ = run(sketch + group % name, place)
        check(code < 2 and "VIBRATION OF THE LINK rod" in listing, "a link of a sketch by name", error)
        results.append(listing)
    check(results[0] == results[1], "the line of a link may be named backwards")
    code, _, error, _ = run(sketch + group % "rood", place)
    check(code == 2 and "did you mean 'rod'" in error, "a link that is not there", error)
    loops = open(os.path.join(TOP, "data", "dyad4_slider_crank.nml"), encoding="utf-8").read()
    text = loops + group.replace("VNAME='%s'", "VLINK=2, VLOOP=1").replace("MNAME='piston'", "MLINK=-3, MLOOP=1")
    code, listing, error, _ = run(text, place)
    lengths = [[float(number.replace("D", "E"))
                for line in one.split("\n") if "FIRST FREQUENCY AT REST" in line or line.startswith(" LENGTH")
                for number in re.findall(r"\d+\.\d+(?:D-\d+)?", line)] for one in (listing, results[0])]
    check(code < 2 and len(lengths[0]) == 4 and lengths[0] == lengths[1], "the same link in the arrays", error + str(lengths))


# ---- loads on a link ------------------------------------------------------------------------------------------------

CRANK, STRIP, ROCKER, BASE = 0.0762, 0.381, 0.1524, 0.381   # the rig
STIFFNESS = 207e9*0.00635*0.00124**3/12                     # E I of its strip
DENSITY = 7850.0*0.00124*0.00635                            # kg/m


def pose_of_rig(phi):
    """Crank pin, direction of the strip and of the rocker from the frame, at crank angles."""
    x, y = BASE - CRANK*numpy.cos(phi), -CRANK*numpy.sin(phi)
    diagonal = numpy.hypot(x, y)
    strip = numpy.arctan2(y, x) + numpy.arccos((STRIP**2 + diagonal**2 - ROCKER**2)/(2*STRIP*diagonal))
    rocker = numpy.arctan2(STRIP*numpy.sin(strip) - y, STRIP*numpy.cos(strip) - x)
    return numpy.array([CRANK*numpy.cos(phi), CRANK*numpy.sin(phi)]), strip, rocker


def bent_chain(phi, gravity, loads, springs, parts=40):
    """The first half wave of the strip as a chain of rigid parts with springs between them, in the linkage at rest: equilibrium
    of the nonlinear chain, the rocker as a constraint. Loads: place, height, force, moment, turning; springs: place, height,
    fixed point, stiffness, free length."""
    pin, start, _ = pose_of_rig(phi)
    pivot, h = numpy.array([BASE, 0.0]), STRIP/parts

    def residual(x):
        angles, pull = x[:parts], x[parts]
        along, across = numpy.array([numpy.cos(angles), numpy.sin(angles)]), numpy.array([-numpy.sin(angles), numpy.cos(angles)])
        slope = numpy.zeros(parts)
        bend = STIFFNESS/h*numpy.diff(angles)
        slope[1:] += bend
        slope[:-1] -= bend

        def put(force, place, height):
            i = min(int(place/h), parts - 1)
            slope[:i] -= h*(force @ across[:, :i])
            slope[i] -= (place - i*h)*(force @ across[:, i]) - height*(force @ along[:, i])
            return i

        for i in range(parts):
            put(DENSITY*h*numpy.array(gravity), (i + 0.5)*h, 0.0)
        end = h*along.sum(1)
        unit = end/numpy.hypot(*end)
        for place, height, force, moment, turning in loads:
            fx, fy = force
            if turning:
                fx, fy = fx*unit[0] - fy*unit[1], fx*unit[1] + fy*unit[0]
            slope[put(numpy.array([fx, fy]), place, height)] -= moment
        for place, height, fixed, stiffness, free in springs:
            i = min(int(place/h), parts - 1)
            gap = fixed - (pin + h*along[:, :i].sum(1) + (place - i*h)*along[:, i] + height*across[:, i])
            length = numpy.hypot(*gap)
            put(stiffness*(length - free)*gap/length, place, height)
        last = pin + end - pivot
        return numpy.append(slope - pull*h*(last @ across), last @ last - ROCKER**2)

    x = numpy.append(numpy.full(parts, start), 0.0)
    for _ in range(8):
        steps = 1e-6*numpy.eye(parts + 1)
        slopes = numpy.array([(residual(x + s) - residual(x - s))/2e-6 for s in steps]).T
        change = numpy.linalg.solve(slopes, -residual(x))
        x += change
        if numpy.abs(change[:parts]).max() < 1e-10:
            break
    nodes = numpy.concatenate([numpy.zeros((2, 1)), h*numpy.cumsum([numpy.cos(x[:parts]), numpy.sin(x[:parts])], axis=1)], axis=1)
    unit = nodes[:, -1]/numpy.hypot(*nodes[:, -1])
    bent = unit[0]*nodes[1] - unit[1]*nodes[0]
    return 2*numpy.mean((bent*numpy.sin(numpy.pi*numpy.linspace(0, 1, parts + 1)))[:-1])


def rig_with(groups, gravity=0.0, speed=0.1, modes=1):
    """The rig with loads; at 0.1 rad/s its inertia bends it by 5e-8 m."""
    return data("rig_coupler.nml", ("SPEED=23.07", "SPEED=%.17g" % speed), ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"),
                ("NMODE=2", "NMODE=%d" % modes), ("UNITL=0.001", "UNITL=0.001, GRAVY=%g" % gravity)) + groups


def figure_after(listing, words):
    """The number after some words of a listing."""
    return float(listing.split(words)[1].split()[0].rstrip(",").replace("D", "E"))


def link_loads(place):
    """Weight, loads and springs between the pins bend a link: chains of rigid parts, hand figures, statics, integration."""
    mid = 20.5*STRIP/40   # amid a part of the chain
    cases = (
        ("its weight", "", (0.0, -9.81), [], []),
        ("a force", " &LOADS NLOAD=1, LLINK=-2, LLOOP=1, LDIST=127.0, LFX=-0.1, LFY=0.15 &END\n", (0, 0),
         [(0.127, 0, (-0.1, 0.15), 0, False)], []),
        ("a force on a bracket", " &LOADS NLOAD=1, LLINK=-2, LLOOP=1, LDIST=%.17g, LANG=%.17g, LFX=-0.3, LFY=0.05 &END\n" % (
            1000*numpy.hypot(mid, 0.1), numpy.degrees(numpy.arctan2(0.1, mid))), (0, 0), [(mid, 0.1, (-0.3, 0.05), 0, False)], []),
        ("a moment", " &LOADS NLOAD=1, LLINK=2, LLOOP=1, LDIST=%.17g, LMOM=0.01 &END\n" % (1000*(10.5*STRIP/40 - STRIP)), (0, 0),
         [(10.5*STRIP/40, 0, (0, 0), 0.01, False)], []),
        ("a force that turns with it", " &LOADS NLOAD=1, LLINK=-2, LLOOP=1, LDIST=100.0, LFX=-0.2, LFY=0.1, LTURN=1 &END\n", (0, 0),
         [(0.1, 0, (-0.2, 0.1), 0, True)], []),
        ("a spring", " &SPRING NSPRNG=1, ALINK=-2, ALOOP=1, ADIST=%.17g, AANG=%.17g, BLINK=4, BLOOP=1, BDIST=300.0, BANG=100.0, "
         "STIFF=20.0, SFREE=360.0 &END\n" % (1000*numpy.hypot(mid, 0.02), numpy.degrees(numpy.arctan2(0.02, mid))), (0, 0), [],
         [(mid, 0.02, -0.3*numpy.array([numpy.cos(5*numpy.pi/9), numpy.sin(5*numpy.pi/9)]), 20.0, 0.36)]))
    for name, groups, gravity, loads, springs in cases:
        code, _, error, blocks = run(rig_with(groups, gravity[1]), place)
        check(code == 0, "the strip under " + name, error)
        rows = blocks["response"]
        for part in (0.0, 0.6):
            row = rows[int(part*len(rows))]
            want = bent_chain(numpy.radians(row[0]), gravity, loads, springs)
            check(abs(row[1]/want - 1) < 4e-3, "the strip under %s against a chain of rigid parts, at %.0f degrees" % (name, row[0]),
                  "%g, chain %g" % (row[1], want))
    # by hand: 5/384 q L**4/(E I) under its weight, F L**3/(48 E I) under 5 N on the middle where the rocker is square to the strip
    code, listing, error, _ = run(rig_with("", -9.81), place)
    sag, hand = figure_after(listing, "MACHINE AT REST"), 5/384*DENSITY*9.81*STRIP**4/STIFFNESS
    check(abs(hand - 0.80e-3) < 5e-6 and abs(sag/hand - 1) < 0.03, "the strip sags by 0.80 mm", sag)
    text = rig_with(" &LOADS NLOAD=1, LLINK=-2, LLOOP=1, LDIST=190.5, LFY=5.0, LTURN=1 &END\n")
    code, listing, error, blocks = run(text, place)
    check(code == 1 and "it bends by more than 0.025 of its length" in error, "5 N on the strip: to be designed again", error)
    phi = 2*numpy.pi*numpy.arange(256)/256
    _, strip, rocker = pose_of_rig(phi)
    # the free rocker pushes along itself; about the crank pin its push balances half of the load
    tension = -2.5/numpy.sin(rocker - strip)*numpy.cos(rocker - strip)
    euler = numpy.pi**2*STIFFNESS/STRIP**2
    k = numpy.sqrt(numpy.abs(tension)/STIFFNESS)*STRIP/2
    shape = numpy.where(tension < 0, numpy.tan(k) - k, k - numpy.tanh(k))
    bent = 5*STRIP**3/(48*STIFFNESS)*3*shape/k**3
    check(abs(5*STRIP**3/(48*STIFFNESS) - 27.6e-3) < 5e-5 and bent.min() < 27.6e-3 < bent.max(), "27.6 mm by hand")
    got = figure_after(listing, "MACHINE AT REST")
    check(abs(got/bent.max() - 1) < 1e-4, "5 N on the middle: the strut's formula", "%g, by hand %g" % (got, bent.max()))
    rows = blocks["response"]
    first = [2*5*STRIP**3/(numpy.pi**4*STIFFNESS)/(1 + t/euler) for t in tension]
    step = len(rows)//256
    check(max(abs(rows[step*i][1]/first[i] - 1) for i in range(256)) < 2e-4, "5 N on the middle, mode 1 over the turn")
    # running, with its weight: (13.24) by closed forms, integrated
    speed = 20.0
    code, listing, error, blocks = run(rig_with("", -9.81, speed), place)
    ratio = (numpy.pi/STRIP)**2*0.00124/numpy.sqrt(12)*numpy.sqrt(207e9/7850)/speed
    plain = rig_functions(0.001955401856/(DENSITY*STRIP**2*ROCKER))

    def slope(x, y):
        _, strip, rocker = pose_of_rig(x)
        along, across = -9.81*numpy.sin(strip), -9.81*numpy.cos(strip)
        pull = -across/2/numpy.sin(rocker - strip)*numpy.cos(rocker - strip)       # N/kg of the strip's own weight
        f = plain(x) + numpy.pi**2*(pull + along/2)/(STRIP*speed**2)
        turning = (rig_functions_turning(x + 1e-5) - rig_functions_turning(x - 1e-5))/2e-5
        p = -4/numpy.pi*(-CRANK*numpy.sin(x - strip) - across/speed**2)/STRIP - 2/numpy.pi*turning
        return [y[1], p - 0.03*ratio*y[1] - (f + ratio**2)*y[0]]

    rows = blocks["response"]
    done = solve_ivp(slope, [0, numpy.pi], [rows[0][1]/STRIP, rows[0][2]/STRIP], method="DOP853", rtol=1e-10, atol=1e-13)
    half = rows[len(rows)//2]
    check(abs(done.y[0, -1]*STRIP - half[1]) < 1e-7*abs(half[1]) + 1e-9, "the running strip with its weight against the integration",
          "%g, integrated %g" % (half[1], done.y[0, -1]*STRIP))
    # a damper elsewhere brakes with the speed; what the model has not is refused with its reason
    damper = " &SPRING NSPRNG=1, ALINK=%s, ALOOP=1, ADIST=%s, BLINK=4, BLOOP=1, BDIST=50.0, STIFF=0.0, SDAMP=20.0 &END\n"
    peaks = [figure_after(run(rig_with(damper % ("3", "20.0"), 0.0, speed), place)[1], "GREATEST END LOAD, EULER'S LOAD") for speed in (1.0, 2.0)]
    check(1.9 < peaks[1]/peaks[0] < 2.1, "the end load of a damper grows with the speed", peaks)
    for groups, words in (
            (damper % ("-2", "100.0"), "give the damping of the modes by"),
            (" &SPRING NSPRNG=1, ALINK=-2, ALOOP=1, ADIST=50.0, BLINK=-2, BLOOP=1, BDIST=200.0, STIFF=5.0 &END\n", "joins two points"),
            (" &LOADS NLOAD=1, LLINK=-2, LLOOP=1, LDIST=400.0, LFY=1.0 &END\n", "load 1 of &LOADS acts on this link beyond its pins"),
            (" &FRICTN NFRIC=1, FLINK=2, FLOOP=1, FMU=0.1, FRAD=5.0 &END\n", "friction changes its sign with the motion")):
        code, _, error, _ = run(rig_with(groups), place)
        check(code == 2 and words in error, "refused: " + words, error)


def rig_functions_turning(x):
    """Angular speed of the strip per radian of the crank, closed form."""
    _, strip, rocker = pose_of_rig(x)
    return CRANK*numpy.sin(x - rocker)/(STRIP*numpy.sin(rocker - strip))


def estimates(place):
    """Haines's rules, and an error that is not below that of the equation."""
    text = data("rig_coupler.nml", ("ARCL=76.2", "ARCL=4.0"), ("EDEPTH=0.00124", "EDEPTH=0.0124"), ("VDEPTH=0.00124", "VDEPTH=0.0124"),
                ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"), ("SPEED=23.07", "SPEED=SPD"))
    first = (numpy.pi/STRIP)**2*0.0124/numpy.sqrt(12)*numpy.sqrt(207e9/7850)
    for ratio, verdict in ((2.2, "LOOK CLOSER"), (3.0, "LOOK CLOSER"), (4.0, "LOOK CLOSER"), (9.9, "LOOK CLOSER"), (10.1, "RIGID ENOUGH")):
        code, listing, error, blocks = run(text.replace("SPD", "%.17g" % (first/ratio)), place)
        bent = max(abs(row[1]) for row in blocks["response"])
        estimate = figure_after(listing, "BOTH TOGETHER")
        check(code == 0 and verdict in listing, "verdict at a ratio of %g" % ratio, error)
        check(0.99 < estimate/bent < 1.2, "estimate against the equation at a ratio of %g" % ratio, "%g, equation %g" % (estimate, bent))
    rules = [line for line in listing.split("\n") if "AT LEAST" in line or "AT MOST" in line]
    check(len(rules) == 6 and all("KEPT" in line for line in rules), "every rule is listed", rules)
    # along the strip, with the rocker: E A/L against its inertia over the squared arm of the pin
    code, listing, error, _ = run(rig_with("", 0.0, 23.07), place)
    _, strip, rocker = pose_of_rig(2*numpy.pi*numpy.arange(256)/256)
    mass = 0.001955401856/(ROCKER*numpy.sin(rocker - strip))**2
    want = numpy.sqrt(207e9*0.00124*0.00635/STRIP/mass.max())/23.07
    check(abs(figure_after(listing, "WITH WHAT IT MOVES")/want - 1) < 1e-6, "axial frequency", "want %g" % want)
    # two links that share a pin: frequencies apart, and each has the other's mass
    depth = 0.00124*(ROCKER/STRIP)**2*1.2
    two = data("rig_coupler.nml", ("NESTIM=1, ELINK=2, ELOOP=1, EMOD=207E9, ERHO=7850.0, EDEPTH=0.00124, EWIDTH=0.00635, EZETA=0.015, ESTRN=0.001",
                                   "NESTIM=2, ELINK=2,3, ELOOP=2*1, EMOD=2*207E9, ERHO=2*7850.0, EDEPTH=0.00124,%.17g, EWIDTH=2*0.00635" % depth),
               ("MLINK=3", "MLINK=-1"), ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"))
    code, listing, error, blocks = run(two, place)
    apart = [float(line.split()[-5].replace("D", "E")) for line in listing.split("\n") if "APART FROM" in line and "BROKEN" in line]
    ratio = figure_after(listing, "FIRST FREQUENCY/SPEED")
    check(len(apart) == 2 and max(abs(a - 0.2*ratio) for a in apart) < 1e-5, "frequencies of neighbours apart", (apart, ratio, error))
    weight = 7850*depth*0.00635*ROCKER
    one = data("rig_coupler.nml", ("MLINK=3, MLOOP=1, MASS=0.0, MINERT=0.001955401856", "MLINK=3, MLOOP=1, MASS=%.17g, MDIST=76.2, MANG=180.0, "
                                   "MINERT=%.17g" % (weight, weight*ROCKER**2/12)), ("NVSPED=46", "NVSPED=0"), ("VEMAX=4.0", "VEMAX=0.0"))
    _, single, _, alone = run(one, place)
    loads = [figure_after(text, "GREATEST END LOAD, EULER'S LOAD") for text in (listing, single)]
    check(abs(loads[0]/loads[1] - 1) < 1e-6 and loads[0] > 0, "end load with the mass of another uniform link", loads)
    check(numpy.allclose(blocks["response"], alone["response"], rtol=1e-9, atol=1e-12), "response with the mass of another uniform link")
    # the end load: a moment on the rocker pushes the strip
    moment = " &LOADS NLOAD=1, LLINK=3, LLOOP=1, LMOM=%g &END\n"
    for size, word in ((0.3, "KEPT"), (0.8, "BROKEN")):
        code, listing, error, _ = run(rig_with(moment % size, 0.0, 1.0), place)
        line = next(line for line in listing.split("\n") if "END LOAD/EULER" in line)
        _, strip, rocker = pose_of_rig(2*numpy.pi*numpy.arange(256)/256)
        push = numpy.max(-size/(ROCKER*numpy.sin(strip - rocker)))/(numpy.pi**2*STIFFNESS/STRIP**2)
        check(word in line and abs(float(line.split()[3].replace("D", "E"))/abs(push) - 1) < 0.02, "end load by a moment on the rocker",
              "%s, by hand %g" % (line, push))


# ---- loads on a drive -----------------------------------------------------------------------------------------------

def haines_pose(phi):
    """Crank pin, far end of the coupler, angles of coupler and rocker of the case study."""
    x, y = 0.25 - 0.05*numpy.cos(phi), -0.05*numpy.sin(phi)
    diagonal = numpy.hypot(x, y)
    coupler = numpy.arctan2(y, x) + numpy.arccos((0.2**2 + diagonal**2 - 0.275**2)/(0.4*diagonal))
    rocker = numpy.arctan2(0.2*numpy.sin(coupler) - y, 0.2*numpy.cos(coupler) - x)
    return coupler, rocker


def spring_of_drive(phi):
    _, rocker = haines_pose(phi)
    return numpy.hypot(0.25 + 0.2*numpy.cos(rocker), 0.2*numpy.sin(rocker) + 0.05)


def potential_of_drive(phi):
    """Weight, the resistance across the rocker, and the spring of drive_loads.nml, J."""
    coupler, rocker = haines_pose(phi)
    heights = 0.332*(0.05*numpy.sin(phi) + 0.1*numpy.sin(coupler)) + 0.474*0.1375*numpy.sin(rocker)
    return 9.81*heights + 0.5*2400*(spring_of_drive(phi) - 0.15)**2 + 40*0.1*rocker


def drive_loads(place):
    """Torque of loads on a flexible drive: the potential's differences, and the nonlinear crank by direct integration."""
    count, h = 2048, 1e-4
    x = 2*numpy.pi*numpy.arange(count + 1)/count
    torque = -(potential_of_drive(x + h) - potential_of_drive(x - h))/(2*h)
    viscous = 5.0*((spring_of_drive(x + h) - spring_of_drive(x - h))/(2*h))**2
    w2, w3 = ((a - b)/(2*h) for a, b in zip(haines_pose(x + h), haines_pose(x - h)))
    coupler, _ = haines_pose(x)
    speed2 = (-0.05*numpy.sin(x) - 0.1*w2*numpy.sin(coupler))**2 + (0.05*numpy.cos(x) + 0.1*w2*numpy.cos(coupler))**2
    inertia = 0.332*speed2 + 0.00128*w2**2 + (0.02405 + 0.474*0.1375**2)*w3**2 + 0.00016
    speed = 20*numpy.pi
    for sense in (1, -1):
        code, listing, error, blocks = run(data("ssics/drive_loads.nml", ("SPEED=600.0", "SPEED=%d" % (sense*600)),
                                                ("DMEAN=20.0", "DMEAN=40.0"), ("NDSPED=51", "NDSPED=0")), place)
        check(code == 0, "a drive with loads", error)
        # against the angle in the sense of turning
        turned = [values if sense > 0 else values[::-1] for values in (inertia, sense*torque, viscous)]
        got = numpy.array(blocks["drive_torque"])
        check(numpy.abs(got[:, 1] - turned[1][:-1:8]).max() < 1e-6*numpy.abs(torque).max(), "torque against the potential's differences")
        check(numpy.abs(got[:, 2] - turned[2][:-1:8]).max() < 1e-6*viscous.max(), "torque of the damper")
        j, q, b = (CubicSpline(x, numpy.append(values[:-1], values[0]), bc_type="periodic") for values in turned)
        steepness = j.derivative()
        shaft = figure_after(listing, " STIFFNESS")
        damping = 0.02*numpy.sqrt(shaft*inertia[:-1].mean())

        def slope(t, y):
            at, rate = (t + y[0]) % (2*numpy.pi), 1 + y[1]
            return [y[1], (q(at)/speed**2 - b(at)*rate/speed - 0.5*steepness(at)*rate**2 - shaft*y[0]/speed**2
                           - damping*y[1]/speed)/j(at)]

        rows = numpy.array(blocks["drive_response"])
        turns = 4  # the multipliers are 0.04
        done = solve_ivp(slope, [0, 2*numpy.pi*turns], [0, 0], method="DOP853", rtol=1e-8, atol=1e-11,
                         t_eval=2*numpy.pi*(turns - 1 + numpy.arange(0, len(rows), 8)/len(rows)))
        apart = numpy.abs(done.y[0] - rows[::8, 1]).max()
        check(apart < 1e-4*numpy.abs(rows[:, 1]).max(), "swing against the integration of the nonlinear crank", apart)
    bare = data("drive_haines.nml")
    plain = figure_after(run(bare, place)[1], "GREATEST SWING")
    for groups in (" &LOADS NLOAD=1, LLINK=-1, LLOOP=1, LMOM=-2.0 &END\n",
                   " &SPRING NSPRNG=1, ALINK=3, ALOOP=1, ADIST=0.2, AANG=180.0, BLINK=4, BLOOP=1, BDIST=0.05, STIFF=2400.0 &END\n"):
        swing = figure_after(run(bare + groups, place)[1], "GREATEST SWING")
        check(abs(swing/plain - 1) > 1e-3, "a load changes the swing", swing)
    # a constant moment winds the shaft up by itself over the stiffness
    still = run(data("drive_haines.nml", ("DMEAN=10.0", "DSTIF=500.0")), place)[3]["drive_response"]
    wound = run(data("drive_haines.nml", ("DMEAN=10.0", "DSTIF=500.0")) + " &LOADS NLOAD=1, LLINK=-1, LLOOP=1, LMOM=-2.0 &END\n",
                place)[3]["drive_response"]
    turn = numpy.mean([a[1] for a in wound]) - numpy.mean([a[1] for a in still])
    check(abs(turn/(-2.0/500.0) - 1) < 0.05, "a constant moment winds the shaft up", turn)
    code, _, error, _ = run(bare + " &FRICTN NFRIC=1, FLINK=2, FLOOP=1, FMU=0.1, FRAD=0.005 &END\n", place)
    check(code == 2 and "friction changes its sign" in error, "friction in a drive is refused with the reason", error)
    code, _, error, _ = run(bare + " &LOADS NLOAD=1, LLINK=-1, LLOOP=1, LMOM=-2.0, LTABLE=1, NTABLE=1, NTABIN=3, TABIN=0.0,90.0,270.0, "
                            "TABVAL=0.0,1.0,0.0 &END\n", place)
    check(code == 0 and "have corners" in error and "NDPNT" in error, "corners of a table of loads are reported", error)
    code, _, error, _ = run(data("drive_haines.nml", ("DMEAN=10.0", "DRIPPL=0.7, DEXTRA=0.01, DMEAN=10.0"), ("MINERT=0.00128", "GRAVY=-9.81, "
                                 "MINERT=0.00128")), place)
    check(code == 2 and "DRIPPL" in error and "gravity" in error, "gravity on no linkage", error)


def derivatives(place):
    """y1 and y2 of every response are derivatives by the input, backwards too; the greatest is that of the curve."""
    for text, block, words in ((data("rig_coupler.nml", ("SPEED=23.07", "SPEED=-23.07"), ("NVSPED=46", "NVSPED=0"),
                                     ("VEMAX=4.0", "VEMAX=0.0"), ("NMODE=2", "NMODE=1")), "response", "\n GREATEST "),
                               (data("drive_haines.nml", ("SPEED=600.0", "SPEED=-600.0"), ("NDSPED=51", "NDSPED=0")),
                                "drive_response", "GREATEST SWING"),
                               (data("ssics/hill.nml"), "hill_response", "GREATEST")):
        _, listing, _, blocks = run(text, place)
        rows = numpy.array(blocks[block])
        y, n = rows[:, 1], len(rows)
        step = numpy.radians(rows[1, 0] - rows[0, 0])
        waves = numpy.fft.fftfreq(n, 1/n)*numpy.sign(step)
        series = numpy.fft.fft(y)
        for order in (1, 2):
            want = numpy.fft.ifft((1j*waves)**order*series).real
            check(numpy.abs(rows[:, 1 + order] - want).max() < 1e-7*numpy.abs(want).max(), "derivative %d of %s by the input" % (order, block))
        dense = numpy.fft.ifft(numpy.concatenate([series[:n//2], numpy.zeros(63*n), series[n//2:]]))*64
        check(abs(figure_after(listing, words)/numpy.abs(dense.real).max() - 1) < 3e-7, "the greatest of " + block,
              "%s, %.9g" % (figure_after(listing, words), numpy.abs(dense.real).max()))
    # a link of high frequency at low speed is no growing equation
    code, _, error, _ = run("STIFF\n &HILL NHILL=4, HC0=4*1.0E6, HC1=4*30.0, HP=1.0,2.0,1.0,0.0 &END\n", place)
    check(code == 0, "a frequency of 1000 per turn, damped, settles", error)


def main():
    with tempfile.TemporaryDirectory() as place:
        kinds = [random_hill(seed, place) for seed in range(10)]
        check(any(kinds) and not all(kinds), "stable and unstable ones among them", kinds)
        rig(place)
        drives(place)
        case_study(place)
        chart(place)
        con_rod(place)
        blocks_and_curves(place)
        hard_cases(place)
        bad_input(place)
        named(place)
        link_loads(place)
        estimates(place)
        drive_loads(place)
        derivatives(place)
    print("%d passed, %d failed" % (passed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
