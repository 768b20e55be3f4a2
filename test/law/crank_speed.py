#!/usr/bin/env python3
"""A crank whose speed varies over the turn (&CYCLE), through bridge and ssics, against a four-bar that is solved here.

usage: test/law/crank_speed.py PROGRAM_DIRECTORY

The law is w(theta) = 1 + 0.09 cos theta - 0.06 sin 2 theta + 0.03 cos(3 theta + 1), times a constant. Its time is integrated by
Gauss's rule, its inverse found by bisection. Positions of the four-bar come from circles, velocities and accelerations from five
point differences in time, joint forces from the equilibrium of coupler and rocker, the vibration of the coupler from (13.24) of
Oldham with SciPy's integrator, the swing of a drive from the equation that is not linear. Last line: N passed, N failed.
"""

import csv
import os
import subprocess
import sys
import tempfile

import numpy
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from data_sets import data
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
TURN = 2 * numpy.pi
MEAN = 30.0                                     # rad/s
L2, L3, L4, L1 = 0.05, 0.20, 0.275, 0.25        # crank, coupler, rocker, frame
M3, I3, C3 = 0.33235, 0.001278, 0.1             # coupler: mass, inertia about its centre, centre from A
M4, I4, C4 = 0.47445, 0.00405, 0.1375           # rocker: from C
LINKS = """CASE
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=0.05,0.20,0.275,0.25, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=5 &END
 &LIMITS TANGLE=90.0 &END
"""
ROCKER = " &MASSES NMASS=1, MLINK=3, MLOOP=1, MASS=0.47445, MDIST=0.1375, MANG=180.0, MINERT=0.00405 &END\n"
MASSES = """ &MASSES NMASS=2, MLINK=-2,3, MLOOP=2*1, MASS=0.33235,0.47445, MDIST=0.1,0.1375, MANG=0.0,180.0, MINERT=0.001278,0.00405 &END
"""


def law(theta):
    return 1 + .09 * numpy.cos(theta) - .06 * numpy.sin(2 * theta) + .03 * numpy.cos(3 * theta + 1)


def cycle(count=18, factor=1.0):
    values = factor * law(TURN * numpy.arange(count) / count)
    return " &CYCLE CYCW=%s &END\n" % (",\n  ".join("%.17g" % v for v in values))


class Crank:
    """The law at a mean speed: angle by time, in the sense of turning."""

    def __init__(self, rates, mean):
        nodes, weights = numpy.polynomial.legendre.leggauss(12)
        edges = numpy.linspace(0, TURN, 241)
        half = (edges[1] - edges[0]) / 2
        parts = [half * sum(weights / rates(a + half * (1 + nodes))) for a in edges[:-1]]
        self.edges, self.time = edges, numpy.concatenate([[0], numpy.cumsum(parts)])
        self.rates, self.nodes, self.weights = rates, nodes, weights
        self.scale = self.time[-1] / TURN * mean        # of the law, to the mean speed
        self.period = TURN / mean

    def time_of(self, theta):
        theta = numpy.asarray(theta, float)
        turns = numpy.floor(theta / TURN)
        rest = theta - turns * TURN
        k = numpy.minimum((rest / TURN * 240).astype(int), 239)
        half = (rest - self.edges[k]) / 2
        part = half * sum(w / self.rates(self.edges[k] + half * (1 + x)) for x, w in zip(self.nodes, self.weights))
        return (self.time[k] + part) / self.scale + turns * self.period

    def angle(self, time):
        time = numpy.asarray(time, float)
        low, high = TURN * (time / self.period - 1), TURN * (time / self.period + 1)
        for _ in range(60):
            middle = (low + high) / 2
            early = self.time_of(middle) < time
            low, high = numpy.where(early, middle, low), numpy.where(early, high, middle)
        return (low + high) / 2


def pose(theta):
    """A, B, angles of coupler and rocker (from C to B), by circles; smooth over a turn."""
    a = L2 * numpy.exp(1j * theta)
    d = L1 - a
    t3 = numpy.angle(d) + numpy.arccos((L3 ** 2 + abs(d) ** 2 - L4 ** 2) / (2 * L3 * abs(d)))
    b = a + L3 * numpy.exp(1j * t3)
    return a, b, t3, numpy.angle(b - L1)


def motion(angle_at, time, h=2e-4):
    """Pose at times, with first and second derivatives by time."""
    steps = [pose(angle_at(time + k * h)) for k in range(-3, 4)]
    out = []
    for c in range(4):
        v = [s[c] for s in steps]
        first = (-v[0] + 9 * v[1] - 45 * v[2] + 45 * v[4] - 9 * v[5] + v[6]) / (60 * h)
        second = (2 * v[0] - 27 * v[1] + 270 * v[2] - 490 * v[3] + 270 * v[4] - 27 * v[5] + 2 * v[6]) / (180 * h * h)
        out.append((v[3], first, second))
    return out


def force_at_b(moved, m3, i3, c3):
    """On the coupler at B, from the moments of the rocker about C and of the coupler about A."""
    a, b, t3, t4 = moved
    e3 = numpy.exp(1j * t3[0])
    centre = a[2] + c3 * e3 * (1j * t3[2] - t3[1] ** 2)
    arm3, arm4 = L3 * e3, b[0] - L1
    about_a = i3 * t3[2] + m3 * ((c3 * e3).real * centre.imag - (c3 * e3).imag * centre.real)
    about_c = -(I4 + M4 * C4 ** 2) * t4[2]
    # (arm x F) is the moment of both, F on the coupler
    fx = (about_c * arm3.real - about_a * arm4.real) / -(arm3.real * arm4.imag - arm3.imag * arm4.real)
    fy = numpy.where(abs(arm3.real) > abs(arm4.real), (about_a + arm3.imag * fx) / arm3.real, (about_c + arm4.imag * fx) / arm4.real)
    return fx + 1j * fy


def run(place, program, text, name="case"):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, program), "--json", name + ".nml"], cwd=place, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def table(place, program, which, name="case"):
    with open(os.path.join(place, "%s.%s.%s.csv" % (name, program, which)), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {key: numpy.array([float(row[key]) for row in rows]) for key in rows[0]}


def near(law_of, got, wanted, error):
    worst = numpy.max(numpy.abs(numpy.asarray(got) - wanted)) / numpy.max(numpy.abs(wanted))
    check(law_of, worst < error, worst)


def joint_load(place):
    """bridge: the motion of the crank, and the load of the joint between coupler and rocker."""
    clear = " &CLEAR CLINK=2, CLOOP=1, CDIAM=0.0002 &END\n"
    crank = Crank(law, MEAN)
    rates = " &RATES SPEED=%.17g, UNITS='RAD/S' &END\n" % MEAN
    code, listing, error = run(place, "bridge", LINKS + rates + MASSES + cycle() + clear)
    check("bridge runs", code in (0, 1), error)
    t = table(place, "bridge", "crank_speed")
    near("times are equal steps of the period", t["time"], crank.period * numpy.arange(360) / 360, 1e-14)
    near("inputs", numpy.radians(t["input"]), crank.angle(t["time"]), 1e-12)
    near("speeds", t["speed"], crank.scale * law(numpy.radians(t["input"])), 1e-13)
    theta = numpy.radians(t["input"])
    slope = -.09 * numpy.sin(theta) - .12 * numpy.cos(2 * theta) - .09 * numpy.sin(3 * theta + 1)
    near("accelerations", t["acceleration"], crank.scale ** 2 * law(theta) * slope, 1e-12)
    speeds = crank.scale * law(numpy.linspace(0, TURN, 20000))
    check("range and fluctuation are listed", "FLUCTUATION%15.7f" % (2 * (max(speeds) - min(speeds)) / (max(speeds) + min(speeds))) in listing,
          listing.split("\n")[3:5])
    c = table(place, "bridge", "cycle")
    n = len(c["input"])
    times = crank.period * numpy.arange(n) / n
    near("positions at equal times", numpy.radians(c["input"]), crank.angle(times), 1e-12)
    force = force_at_b(motion(crank.angle, times), M3, I3, C3)
    sense = numpy.sign(numpy.real(force[0]) * c["fx"][0])
    near("load x of the joint", sense * c["fx"], force.real, 1e-6)
    near("load y of the joint", sense * c["fy"], force.imag, 1e-6)
    constant = force_at_b(motion(lambda x: MEAN * x, times), M3, I3, C3)
    check("which that of a constant speed is not", max(abs(force - constant)) > .1 * max(abs(force)))
    # a minimum of the load, in time
    m = table(place, "bridge", "minima")
    spline = CubicSpline(numpy.append(times, crank.period), numpy.append(force, force[0]), bc_type="periodic")
    at = crank.time_of(numpy.radians(m["input"]))
    slopes = (spline(at) * numpy.conj(spline(at, 1))).real / abs(spline(at))
    near("the load has no slope at its minima", 1 + slopes * crank.period / max(abs(force)), numpy.ones(len(at)), 1e-4)
    near("least loads", m["load"], abs(spline(at)), 1e-6)
    across = (spline(at) * numpy.conj(spline(at, 1))).imag / abs(spline(at))
    near("rates of the load across", m["rate"], abs(across), 1e-4)
    first = table(place, "bridge", "following")["input"]
    near("contact is followed at equal times", crank.time_of(numpy.radians(first)) - crank.time_of(numpy.radians(first[0])),
         crank.period * numpy.arange(n) / n, 1e-11)
    # only ratios count; equal speeds are a constant speed; the other sense
    before = listing.split("MINIMA")[1]
    check("only ratios count", run(place, "bridge", LINKS + rates + MASSES + cycle(factor=7.5) + clear)[1].split("MINIMA")[1] == before)
    check("more values of the same law change nothing", near_text(run(place, "bridge", LINKS + rates + MASSES + cycle(36) + clear)[1], listing))
    run(place, "bridge", LINKS + rates + MASSES + " &CYCLE CYCW=5*2.0 &END\n" + clear)
    even = table(place, "bridge", "cycle")
    run(place, "bridge", LINKS + rates + MASSES + clear)
    plain = table(place, "bridge", "cycle")
    for key in plain:
        near("equal speeds are a constant one: " + key, even[key], plain[key], 1e-12)
    run(place, "bridge", LINKS + rates.replace("SPEED=", "SPEED=-") + MASSES + cycle() + clear)
    t = table(place, "bridge", "crank_speed")
    near("backwards the same speed at the same input", t["speed"], crank.scale * law(numpy.radians(t["input"])), 1e-12)
    check("and inputs fall", numpy.all(numpy.diff(t["input"]) < 0))
    back = Crank(lambda x: law(-x), MEAN)
    c = table(place, "bridge", "cycle")
    force = force_at_b(motion(lambda x: -back.angle(x), times), M3, I3, C3)
    near("backwards, load x", sense * c["fx"], force.real, 1e-6)
    near("backwards, load y", sense * c["fy"], force.imag, 1e-6)


def near_text(one, other):
    """The same words, numbers within 1E-6."""
    def value(word):
        return float(word.rstrip(",").replace("D", "E"))
    a, b = one.split(), other.split()
    if len(a) != len(b):
        return False
    for x, y in zip(a, b):
        if x == y:
            continue
        try:
            if abs(value(x) - value(y)) > 1e-6 * max(abs(value(x)), 1e-3):
                return False
        except ValueError:
            return False
    return True


def motor(place):
    """The steady cycle of a machine: kinetic energy is constant without a torque; kalm's speeds with one."""
    rates = " &RATES SPEED=%.17g, UNITS='RAD/S' &END\n" % MEAN
    clear = " &CLEAR CLINK=2, CLOOP=1, CDIAM=0.0002 &END\n"
    text = LINKS + rates + MASSES + " &MOTOR FLYWHL=0.02 &END\n &CYCLE &END\n" + clear
    code, listing, error = run(place, "bridge", text)
    check("with a machine", code in (0, 1) and "STEADY CYCLE OF &MOTOR" in listing, error)
    t = table(place, "bridge", "crank_speed")
    theta = numpy.radians(t["input"])
    h = 1e-3
    parts = [pose(theta + k * h) for k in (-2, -1, 1, 2)]

    def slope(value):
        v = [value(p) for p in parts]
        return (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * h)
    centre = abs(slope(lambda p: p[0] + C3 * numpy.exp(1j * p[2])))
    inertia = .02 + M3 * centre ** 2 + I3 * slope(lambda p: p[2]) ** 2 + (I4 + M4 * C4 ** 2) * slope(lambda p: p[3]) ** 2
    near("the kinetic energy is constant", inertia * t["speed"] ** 2, inertia[0] * MEAN ** 2 * numpy.ones(360), 1e-8)
    text = text.replace("FLYWHL=0.02", "FLYWHL=0.02, MTORQ=8.0, MSPEED=40.0").replace(clear, clear + " &LOADS NLOAD=1, LLINK=3, LLOOP=1, LMOM=-3.0 &END\n")
    check("with a motor and a load", run(place, "bridge", text)[0] in (0, 1))
    t = table(place, "bridge", "crank_speed")
    run(place, "kalm", text)
    k = table(place, "kalm", "machine_cycle")
    known = CubicSpline(numpy.append(numpy.radians(k["angle"]), []), k["speed"])
    near("kalm's speeds", t["speed"], known(numpy.radians(t["input"])), 1e-6)
    check("a machine that stops has no cycle", "has no steady cycle" in run(place, "bridge", text.replace("LMOM=-3.0", "LMOM=-900.0"))[2])
    check("and none for ssics", "has no steady cycle" in run(place, "ssics", text.replace("LMOM=-3.0", "LMOM=-900.0").replace(clear, DRIVE))[2])


DRIVE = " &DRIVEL DSTIF=2000.0, DDAMP=0.1, NDPNT=512 &END\n"


def vibration(place):
    """ssics: a coupler of spring steel that vibrates, by (13.24) solved here; links of beam elements as the series of modes has it."""
    e, rho, depth, width, zeta = 207e9, 7850.0, .002, .02, .02
    mean = 60.0
    crank = Crank(law, mean)
    rates = " &RATES SPEED=%.17g, UNITS='RAD/S' &END\n" % mean
    link = " &VIBR VLINK=2, VLOOP=1, VMOD=207E9, VRHO=7850.0, VDEPTH=0.002, VWIDTH=0.02, VZETA=0.02, NMODE=3 &END\n"
    code, listing, error = run(place, "ssics", LINKS + rates + ROCKER + cycle() + link)
    check("ssics runs", code == 0, error)
    y = table(place, "ssics", "response")
    mass = rho * depth * width * L3
    n = 2048
    times = crank.period * numpy.arange(n) / n
    moved = motion(crank.angle, times, 1e-4)
    a, b, t3 = moved[:3]
    pull = (force_at_b(moved, mass, mass * L3 ** 2 / 12, L3 / 2) * numpy.exp(-1j * t3[0])).real
    start = a[2] * numpy.exp(-1j * t3[0])
    own = (numpy.pi / L3) ** 2 * depth / numpy.sqrt(12) * numpy.sqrt(e / rho)
    stiffness = own ** 2 + (numpy.pi / L3) ** 2 * pull * L3 / mass - numpy.pi ** 2 * start.real / (2 * L3) + (numpy.pi ** 2 / 3 - 1.25) * t3[1] ** 2
    load = -2 / numpy.pi * (2 * start.imag + L3 * t3[2])
    k, p = [CubicSpline(numpy.append(times, crank.period), numpy.append(v, v[0]), bc_type="periodic") for v in (stiffness, load)]

    def slopes(t, z):
        return [z[1], p(t) - k(t) * z[0] - 2 * zeta * own * z[1], z[3], -k(t) * z[2] - 2 * zeta * own * z[3],
                z[5], -k(t) * z[4] - 2 * zeta * own * z[5]]
    end = solve_ivp(slopes, (0, crank.period), [0, 0, 1, 0, 0, 1], rtol=1e-10, atol=1e-14, method="DOP853").y[:, -1]
    period = numpy.array([[end[2], end[4]], [end[3], end[5]]])
    begin = numpy.linalg.solve(numpy.eye(2) - period, end[:2])
    every = y["input"][::8]
    at = crank.time_of(numpy.radians(every))
    at[0] = 0.0
    steady = solve_ivp(lambda t, z: [z[1], p(t) - k(t) * z[0] - 2 * zeta * own * z[1]],
                       (0, crank.period), begin, t_eval=at, rtol=1e-10, atol=1e-14, method="DOP853").y
    near("the deflection of mode 1", y["y"][::8], steady[0], 2e-6)
    m = table(place, "ssics", "multipliers")
    found = (m["re"] + 1j * m["im"])[m["mode"] == 1]
    wanted = numpy.linalg.eigvals(period)
    near("its multipliers", numpy.sort_complex(found), numpy.sort_complex(wanted), 1e-6)
    run(place, "ssics", LINKS + rates + ROCKER + link, "plain")
    plain = table(place, "ssics", "response", "plain")
    check("which are not those of a constant speed", max(abs(y["y"])) > 1.02 * max(abs(plain["y"])) or max(abs(y["y"])) < .98 * max(abs(plain["y"])),
          (max(abs(y["y"])), max(abs(plain["y"]))))
    flex = " &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=7850.0, XDEPTH=0.002, XWIDTH=0.02, XZETA=0.02, NXMODE=6 &END\n"
    code, listing, error = run(place, "ssics", LINKS + rates + ROCKER + cycle() + flex, "flex")
    check("beam elements run", code == 0, error)
    f = table(place, "ssics", "flexible_stresses", "flex")
    run(place, "ssics", LINKS + rates + ROCKER + cycle() + link.replace("NMODE=3", "NMODE=8, ISTRSS=1"), "modes")
    s = table(place, "ssics", "stresses", "modes")
    near("beam elements at the same inputs", f["input"], s["input"], 1e-12)
    near("bending of beam elements", f["bending"], s["bending"], 2e-2)
    near("pull of beam elements", f["along"], s["along"], 2e-2)
    estim = link.replace("VIBR V", "ESTIM E").replace(" V", " E").replace(", NMODE=3", "")
    code, listing, error = run(place, "ssics", LINKS + rates + ROCKER + cycle() + estim, "estim")
    check("estimates run", code == 0, error)
    middle = abs(((a[2] + b[2]) / 2 * numpy.exp(-1j * t3[0])).imag)
    got = float(listing.split("ACCELERATION OF THE MIDDLE")[1].split(",")[0].replace("D", "E"))
    check("acceleration of the middle of the link", abs(got / max(middle) - 1) < 3e-4, (got, max(middle)))


def drive(place):
    """A flexible drive whose far end turns by the law, against the equation with all powers of the swing."""
    crank = Crank(law, MEAN)
    rates = " &RATES SPEED=%.17g, UNITS='RAD/S' &END\n" % MEAN
    code, listing, error = run(place, "ssics", LINKS + rates + MASSES + cycle() + DRIVE)
    check("a drive runs", code == 0, error)
    y = table(place, "ssics", "drive_response")
    grid = TURN * numpy.arange(2048) / 2048
    h = 1e-3
    parts = [pose(grid + j * h) for j in (-2, -1, 1, 2)]

    def slope(value):
        v = [value(q) for q in parts]
        return (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * h)
    inertia = M3 * abs(slope(lambda q: q[0] + C3 * numpy.exp(1j * q[2]))) ** 2 + I3 * slope(lambda q: q[2]) ** 2 \
        + (I4 + M4 * C4 ** 2) * slope(lambda q: q[3]) ** 2
    j = CubicSpline(numpy.append(grid, TURN), numpy.append(inertia, inertia[0]), bc_type="periodic")
    j1 = j.derivative()
    times = crank.period * numpy.arange(2049) / 2048
    psi = CubicSpline(times, crank.angle(times) - MEAN * times, bc_type="periodic")
    psi1 = psi.derivative()
    mean = numpy.mean(j(crank.angle(times[:-1])))
    damp = .1 * numpy.sqrt(2000.0 * mean)

    def slopes(t, z):
        there = MEAN * t + psi(t)
        return [z[1], -(.5 * j1(z[0]) * z[1] ** 2 + damp * (z[1] - MEAN - psi1(t)) + 2000.0 * (z[0] - there)) / j(z[0])]
    done = solve_ivp(slopes, (0, 3 * crank.period), [0, MEAN], t_eval=2 * crank.period + times[:-1:32], rtol=1e-10, atol=1e-13, method="DOP853")
    swing = done.y[0] - MEAN * done.t - psi(done.t)
    got = CubicSpline(numpy.append(crank.time_of(numpy.radians(y["input"])), crank.period), numpy.append(y["y"], y["y"][0]))
    near("the swing of the crank", got(times[:-1:32]), swing, 5e-4)
    check("it is small", max(abs(swing)) < 2e-3, max(abs(swing)))


def mistakes(place):
    rates = " &RATES SPEED=30.0 &END\n"
    clear = " &CLEAR CLINK=2, CLOOP=1, CDIAM=0.0002 &END\n"
    for law_of, group, words in (("two speeds", "&CYCLE CYCW=1.0,2.0 &END", "at least 3 speeds"), ("no speed", "&CYCLE &END", "says nothing of the speed"),
                                 ("a speed below 0", "&CYCLE CYCW=1.0,-2.0,1.0 &END", "must be above 0"),
                                 ("a crank that nearly stands still", "&CYCLE CYCW=1.0,1E6,1.0,1E6 &END", "differ by too large a factor"),
                                 ("a curve below 0", "&CYCLE CYCW=1.0,0.01,0.01,1.0,9.0 &END", "not above 0 everywhere")):
        code, _, error = run(place, "bridge", LINKS + rates + MASSES + " " + group + "\n" + clear)
        check(law_of, code == 2 and words in error, error)
    code, _, error = run(place, "bridge", LINKS + rates.replace("30.0", "-30.0") + MASSES + " &MOTOR FLYWHL=0.1 &END\n &CYCLE &END\n" + clear)
    check("a machine backwards", code == 2 and "turns forwards" in error, error)
    code, _, error = run(place, "muscle", data("muscle/out_of_plane") + cycle())
    check("muscle without a joint with clearance", code == 0 and "&CYCLE: has no effect" in error, error)
    check("and with it", "no effect" not in run(place, "muscle", data("muscle/haines_contact") + cycle())[2])
    code, _, error = run(place, "ssics", LINKS + rates + " &CYCLE CYCW=1.0,2.0,1.0 &END\n &DRIVEL DSTIF=100.0, DEXTRA=0.01, DRIPPL=0.4 &END\n")
    check("a ripple of half a turn", code == 2 and "half a turn" in error, error)


def few_positions(place):
    """Positions that do not show how the speed varies are remarked, also by studies without coefficients; enough of them are not."""
    fast = " &CYCLE CYCW=1.0,1000.0,1.0,1000.0 &END\n"
    rates = " &RATES SPEED=30.0 &END\n"
    # steps of the speed: 720 values have 360 harmonics, their slowness many more
    steps = " &CYCLE CYCW=360*1.0,360*1.5 &END\n"
    error = run(place, "ssics", LINKS + rates + ROCKER + steps + DRIVE, "steps")[2]
    check("steps of the speed are followed", "too large a factor" not in error and "NDPNT twice that" in error, error)
    t = table(place, "ssics", "crank_speed", "steps")
    half = numpy.interp(180.0, t["input"], t["time"])
    check("half a turn at each speed", abs(half / (TURN / 30.0) - 0.6) < 1e-3, half)
    estimate = " &ESTIM ELINK=2, ELOOP=1, EMOD=207E9, ERHO=7850.0, EDEPTH=0.02, EWIDTH=0.02 &END\n"
    for program, group, item, masses in (("bridge", " &CLEAR CLINK=2, CLOOP=1, CDIAM=0.0002 &END\n", "NCPNT", MASSES), ("ssics", estimate, "NEPNT", ROCKER),
                                         ("ssics", DRIVE, "NDPNT", MASSES)):
        words = "do not show how the speed of the crank varies; give %s twice that" % item
        check("few positions for " + item, words in run(place, program, LINKS + rates + masses + fast + group)[2])
        check("enough for " + item, "how the speed" not in run(place, program, LINKS + rates + masses + cycle() + group)[2])


def mean_of_machine(place):
    """Frequencies of beam elements are listed over the mean of the machine's cycle, in the plane and out of it, not over SPEED."""
    text = data("ssics/flat_bar") + " &MOTOR MTORQ=20.0, MSPEED=50.0, FLYWHL=0.01 &END\n &CYCLE &END\n"
    code, listing, error = run(place, "ssics", text, "mean")
    check("beam elements with a machine run", code == 0, error)
    mean = float(listing.split("MEAN OVER TIME")[1].split(",")[0])
    rows = [line.split() for line in listing.splitlines() if line.startswith("     1  ")]
    check("a first frequency in and out of the plane of both links", len(rows) == 4, rows)
    check("over the mean speed", abs(mean - 90.0) > 20.0 and all(abs(float(r[1]) / float(r[2]) / mean - 1) < 1e-3 for r in rows), (mean, rows))


def sketch_and_loops(place):
    """The same linkage as loops and as a sketch, by the machine of each."""
    case = data("bridge/four_bar_flywheel")
    code, _, error = run(place, "bridge", case, "loops")
    check("the data set runs", code in (0, 1), error)
    sketch = table(place, "bridge", "cycle", "loops")
    run(place, "bridge", LINKS + " &RATES SPEED=300.0, UNITS='REV/MIN' &END\n" + MASSES + " &CYCLE &END\n &MOTOR MTORQ=4.0, MSPEED=42.0, "
        "FLYWHL=0.01 &END\n &LOADS NLOAD=1, LLINK=1, LLOOP=1, LMOM=-1.0 &END\n &CLEAR CLINK=2, CLOOP=1, CDIAM=0.0002 &END\n", "arrays")
    loops = table(place, "bridge", "cycle", "arrays")
    for key in ("input", "fx", "fy", "m_uu"):
        near("of the sketch as of the loops: " + key, sketch[key], loops[key], 1e-6)
    check("without the cycle it has the speed of &RATES", "VARIES" not in run(place, "bridge", case.replace(" &CYCLE &END\n", ""), "plain")[1])


def main():
    with tempfile.TemporaryDirectory() as place:
        joint_load(place)
        motor(place)
        vibration(place)
        drive(place)
        mistakes(place)
        few_positions(place)
        mean_of_machine(place)
        sketch_and_loops(place)
    return report()


sys.exit(main())
