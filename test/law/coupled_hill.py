#!/usr/bin/env python3
"""Several coupled Hill equations (&HILL NHEQN), and a flexible drive with flexible links (&DRIVEL with &FLEX), against SciPy's integrator.

usage: test/law/coupled_hill.py PROGRAM_DIRECTORY

Random equations: their multipliers and periodic solution by DOP853; two that do not depend on each other as two of one equation. Drive
and link: Lagrange's equations of a four-bar whose coupler bends in a half sine and comes shorter by it, linearised numerically about
steady turning, without joint forces, mode shapes or elements. Last line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import random
import subprocess
import sys
import tempfile

import numpy
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
TURN = 2 * math.pi


def run(place, name, text):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "ssics"), "--json", "--curves", name + ".nml"], cwd=place, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def table(place, name, which):
    with open(os.path.join(place, "%s.ssics.%s.csv" % (name, which)), encoding="utf-8") as file:
        return [{key: float(value) if value.strip().lstrip("-")[:1].isdigit() else value for key, value in row.items()}
                for row in csv.DictReader(file)]


def values(name, rows):
    rows = numpy.ravel(rows)
    return " %s=%s" % (name, ",\n  ".join(",".join("%.17g" % v for v in rows[i:i + 4]) for i in range(0, len(rows), 4)))


def multipliers(place, name, which):
    return [complex(row["re"], row["im"]) for row in table(place, name, which)]


def same_set(found, wanted, error):
    """Largest distance of each wanted number to one found, relative to the largest."""
    left, worst = list(found), 0.0
    for value in wanted:
        nearest = min(left, key=lambda z, v=value: abs(z - v))
        left.remove(nearest)
        worst = max(worst, abs(nearest - value))
    return worst <= error * max(1.0, max(map(abs, wanted))), worst


def period(c, k, p, n):
    """Matrix of a period, and the state after it from rest, of y'' + c y' + k y = p."""
    def slope(x, z):
        z = z.reshape(2 * n, 2 * n + 1)
        right = -c(x) @ z[n:] - k(x) @ z[:n]
        right[:, -1] += p(x)
        return numpy.concatenate([z[n:], right]).ravel()
    begin = numpy.hstack([numpy.eye(2 * n), numpy.zeros((2 * n, 1))])
    end = solve_ivp(slope, (0.0, TURN), begin.ravel(), method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1].reshape(2 * n, 2 * n + 1)
    return end[:, :-1], end[:, -1]


def random_equations(place, seed):
    draw = random.Random(seed)
    n, points = draw.choice((2, 3, 4)), 24
    x = TURN * numpy.arange(points) / points

    def series(mean, size):
        terms = [(h, draw.uniform(-size, size) / h, draw.uniform(-size, size) / h) for h in range(1, 4)]
        return lambda t: mean + sum(a * numpy.cos(h * t) + b * numpy.sin(h * t) for h, a, b in terms)
    c = [[series(draw.uniform(0.0, 0.2) if i == j else 0.0, 0.05) for j in range(n)] for i in range(n)]
    k = [[series(draw.uniform(0.5, 30.0) if i == j else 0.0, draw.uniform(0.1, 6.0)) for j in range(n)] for i in range(n)]
    p = [series(draw.uniform(-1.0, 1.0), 1.0) for i in range(n)]
    text = "RANDOM\n &HILL NHEQN=%d, NHILL=%d,\n%s,\n%s,\n%s &END\n" % (
        n, points, values("HMC1", [[c[i][j](x) for j in range(n)] for i in range(n)]),
        values("HMC0", [[k[i][j](x) for j in range(n)] for i in range(n)]), values("HMP", [p[i](x) for i in range(n)]))
    status, words, said = run(place, "random", text)
    free, forced = period(lambda t: numpy.array([[f(t) for f in row] for row in c]), lambda t: numpy.array([[f(t) for f in row] for row in k]),
                          lambda t: numpy.array([f(t) for f in p]), n)
    wanted = numpy.linalg.eigvals(free)
    right, worst = same_set(multipliers(place, "random", "hill_multipliers"), wanted, 1e-8)
    check("multipliers of %d equations, %d" % (n, seed), right, worst)
    stable = max(abs(wanted)) < 1.0
    check("status and verdict, %d" % seed, status == (0 if stable else 1) and (" STABLE" in words) == stable, (status, words[:300]))
    start = numpy.linalg.solve(numpy.eye(2 * n) - free, forced)
    rows = table(place, "random", "hill_equation_response")
    size = max(abs(start))
    for i in range(n):
        first = next(row for row in rows if row["equation"] == i + 1 and row["input"] == 0.0)
        check("periodic solution %d of %d" % (i + 1, seed), abs(first["y"] - start[i]) + abs(first["y1"] - start[n + i]) < 1e-7 * size,
              (first, start[i], start[n + i]))
    return stable


def apart(place):
    """Two equations without coupling are two of one equation."""
    x = TURN * numpy.arange(16) / 16
    first, second = (9.3 + 2.0 * numpy.cos(x), 0.1 + 0.0 * x, numpy.sin(x)), (30.0 - 5.0 * numpy.sin(2 * x), 0.3 + 0.1 * numpy.cos(x), 1.0 + numpy.cos(3 * x))
    zero = 0.0 * x
    run(place, "two", "TWO\n &HILL NHEQN=2, NHILL=16,\n%s,\n%s,\n%s &END\n" % (
        values("HMC1", [first[1], zero, zero, second[1]]), values("HMC0", [first[0], zero, zero, second[0]]), values("HMP", [first[2], second[2]])))
    single = []
    for number, (k, c, p) in enumerate((first, second)):
        run(place, "one", "ONE\n &HILL NHILL=16,\n%s,\n%s,\n%s &END\n" % (values("HC1", c), values("HC0", k), values("HP", p)))
        single += multipliers(place, "one", "hill_multipliers")
        both = [row["amplitude"] for row in table(place, "two", "hill_equation_harmonics") if row["equation"] == number + 1]
        alone = [row["amplitude"] for row in table(place, "one", "hill_harmonics")]
        check("harmonics of equation %d" % (number + 1), max(abs(a - b) for a, b in zip(both, alone)) < 1e-9 * max(alone), (both, alone))
    check("multipliers of both", *same_set(multipliers(place, "two", "hill_multipliers"), single, 1e-9))
    for text, words in (("NHEQN=2, NHILL=2, HC0=1.0,2.0", "is for one equation; of several give HMC0"), ("NHILL=2, HMC0=1.0,2.0", "give NHEQN"),
                        ("NHEQN=2, NHILL=2, HMC0=4*1.0", "8 values are expected"), ("NHEQN=2, HMC0=4*1.0", "NHILL: missing"),
                        ("NHEQN=11, NHILL=1", "NHEQN")):
        status, _, said = run(place, "no", "NO\n &HILL %s &END\n" % text)
        check("refused: " + text, status == 2 and words in said, said)


# ---- a drive and a coupler ---------------------------------------------------------------------------------------------------------

CRANK, COUPLER, ROCKER, FRAME = 0.06, 0.30, 0.14, 0.32
E, RHO, DEPTH, WIDTH = 207e9, 7850.0, 0.004, 0.008
MASS, INERTIA, CENTRE = 0.3, 8e-4, 0.06          # of the rocker
EXTRA, ZETA, DAMPING, GRAVITY = 2e-3, 0.02, 0.05, -9.81
MU = RHO * DEPTH * WIDTH
SHAPE = math.sqrt(2.0 / (MU * COUPLER))          # a half sine of unit mass
OMEGA = (math.pi / COUPLER) ** 2 * math.sqrt(E * DEPTH ** 2 / 12 / RHO)
GAUSS = numpy.polynomial.legendre.leggauss(12)
PLACES, WEIGHTS = (GAUSS[0] + 1) / 2 * COUPLER, GAUSS[1] / 2 * COUPLER * MU


def points(phi, eta):
    """Places of all masses, and the rocker's angle times the root of its inertia about its centre, as one vector."""
    bend = (SHAPE * eta) ** 2 * (math.pi / COUPLER) ** 2
    # half the integral of the squared slope up to s
    short = bend * (PLACES / 4 + COUPLER / (8 * math.pi) * numpy.sin(2 * math.pi * PLACES / COUPLER))
    length = COUPLER - bend * COUPLER / 4
    b = CRANK * cmath.exp(1j * phi)
    gap = FRAME - b
    far = abs(gap)
    c = b + length * gap / far * cmath.exp(-1j * cmath.acos((far ** 2 + length ** 2 - ROCKER ** 2) / (2 * far * length)).real * 1.0)
    e = (c - b) / length
    along = b + (PLACES - short) * e + SHAPE * eta * numpy.sin(math.pi * PLACES / COUPLER) * 1j * e
    arm = (c - FRAME) / ROCKER
    return along, FRAME + CENTRE * arm, cmath.phase(-arm)


def masses(phi, eta):
    """Mass matrix of (phi, eta) by differences, and the potential of weight."""
    def difference(step_phi, step_eta):
        one, two = points(phi + step_phi, eta + step_eta), points(phi - step_phi, eta - step_eta)
        return (one[0] - two[0], one[1] - two[1], math.remainder(one[2] - two[2], TURN))
    steps = (1e-4, 1e-6)
    rows = [tuple(part / (2 * s) for part in difference(*pair)) for s, pair in zip(steps, ((steps[0], 0.0), (0.0, steps[1])))]
    m = numpy.empty((2, 2))
    for i in range(2):
        for j in range(2):
            m[i, j] = float(numpy.sum(WEIGHTS * (rows[i][0].conj() * rows[j][0]).real)) + MASS * (rows[i][1].conjugate() * rows[j][1]).real + \
                INERTIA * rows[i][2] * rows[j][2]
    m[0, 0] += EXTRA
    along, centre, _ = points(phi, eta)
    return m, -GRAVITY * (float(numpy.sum(WEIGHTS * along.imag)) + MASS * centre.imag)


def equations(phi, speed, push=0.0):
    """M, C, K and load of the linearised equations at a position, of drive and coupler without their own stiffness and damping; the far
    end of the shaft turns at a speed and with an acceleration."""
    h, s = 2e-3, 2e-4                            # steps of phi and eta
    at = {(i, j): masses(phi + i * h, j * s) for i in (-2, -1, 0, 1, 2) for j in (-1, 0, 1)}
    m = {key: value[0] for key, value in at.items()}
    v = {key: value[1] for key, value in at.items()}
    first = lambda f, j: (8 * (f[1, j] - f[-1, j]) - (f[2, j] - f[-2, j])) / (12 * h)
    second = lambda f, j: (16 * (f[1, j] + f[-1, j]) - 30 * f[0, j] - f[2, j] - f[-2, j]) / (12 * h * h)
    by_eta = lambda f, i: (f[i, 1] - f[i, -1]) / (2 * s)
    m_phi, m_eta = first(m, 0), by_eta(m, 0)
    m_phi_phi, m_eta_eta = second(m, 0), (m[0, 1] - 2 * m[0, 0] + m[0, -1]) / s ** 2
    m_phi_eta = (first(m, 1) - first(m, -1)) / (2 * s)
    gradient, slopes = (m_phi, m_eta), ((m_phi_phi, m_phi_eta), (m_phi_eta, m_eta_eta))
    turning, pushed = numpy.array([speed, 0.0]), numpy.array([push, 0.0])
    # R_i = sum M_ij a_j + sum dM_ij/dq_k v_k v_j - sum dM_jk/dq_i v_j v_k/2 + dV/dq_i
    load = -sum(gradient[k] @ turning * turning[k] for k in range(2)) + 0.5 * numpy.array([turning @ gradient[i] @ turning for i in range(2)])
    load -= numpy.array([first(v, 0), by_eta(v, 0)]) + m[0, 0] @ pushed
    c, k = numpy.zeros((2, 2)), numpy.zeros((2, 2))
    for q in range(2):
        unit = numpy.eye(2)[q]
        c[:, q] = gradient[q] @ turning + sum(gradient[r] @ unit * turning[r] for r in range(2)) - [unit @ gradient[i] @ turning for i in range(2)]
        k[:, q] = gradient[q] @ pushed + sum(slopes[q][r] @ turning * turning[r] for r in range(2)) - [0.5 * turning @ slopes[i][q] @ turning for i in range(2)]
    k += [[second(v, 0), (first(v, 1) - first(v, -1)) / (2 * s)], [(first(v, 1) - first(v, -1)) / (2 * s), (v[0, 1] - 2 * v[0, 0] + v[0, -1]) / s ** 2]]
    return m[0, 0], c, k, load


def turning_at(x, a):
    """Angle of a crank with the slowness 1 + a cos psi at a time, and its derivatives: x = psi + a sin psi, Kepler's equation."""
    psi = x
    for _ in range(60):
        psi -= (psi + a * math.sin(psi) - x) / (1 + a * math.cos(psi))
    rate = 1 / (1 + a * math.cos(psi))
    return psi, rate, a * math.sin(psi) * rate ** 3


def drive_and_coupler(place):
    text = """DRIVE AND COUPLER
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=0.06,0.30,0.14,0.32, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=15 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=%.17g &END
 &MASSES NMASS=1, MLINK=3, MLOOP=1, MASS=%g, MDIST=%g, MANG=180.0, MINERT=%g, GRAVY=%g &END
 &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=7850.0, XDEPTH=%g, XWIDTH=%g, XZETA=%g, NXMODE=1, NXELEM=24 &END
 &DRIVEL DSTIF=%g, DDAMP=%g, DEXTRA=%g &END
"""
    for speed, stiffness, a in ((70.0, 400.0, 0), (150.0, 350.0, 0), (110.0, 1000.0, 0), (230.0, 300.0, 0), (110.0, 800.0, 0.12)):
        case = text % (speed, MASS, CENTRE, INERTIA, GRAVITY, DEPTH, WIDTH, ZETA, stiffness, DAMPING, EXTRA)
        if a:
            case += " &CYCLE" + values("CYCW", 1 / (1 + a * numpy.cos(TURN * numpy.arange(40) / 40))) + " &END\n"
        status, words, said = run(place, "drive", case)
        check("drive and coupler at %g rad/s" % speed, status in (0, 1) and "TOGETHER" in words, words + said)
        mean = table(place, "drive", "drive")[0]["inertia_mean"]
        n = 128
        turn = [turning_at(TURN * i / n, a) for i in range(n)]
        grid = [equations(psi, speed * rate, speed ** 2 * push) for psi, rate, push in turn]
        grid.append(grid[0])
        at = [TURN * i / n for i in range(n + 1)]
        c, k, p = [], [], []
        for m, damping, stiff, load in grid:
            damping = damping + numpy.diag([DAMPING * math.sqrt(stiffness * mean), 2 * ZETA * OMEGA])
            stiff = stiff + numpy.diag([stiffness, OMEGA ** 2])
            c.append(numpy.linalg.solve(m, damping) / speed)
            k.append(numpy.linalg.solve(m, stiff) / speed ** 2)
            p.append(numpy.linalg.solve(m, load) / speed ** 2)
        c, k, p = (CubicSpline(at, numpy.array(part), bc_type="periodic") for part in (c, k, p))
        free, forced = period(c, k, p, 2)
        wanted = numpy.linalg.eigvals(free)
        check("multipliers at %g rad/s" % speed, *same_set(multipliers(place, "drive", "drive_link_multipliers"), wanted, 1e-4))
        start = numpy.linalg.solve(numpy.eye(4) - free, forced)
        track = solve_ivp(lambda x, z: numpy.concatenate([z[2:], p(x) - c(x) @ z[2:] - k(x) @ z[:2]]), (0.0, TURN), start, method="DOP853",
                          rtol=1e-9, atol=1e-12, t_eval=numpy.linspace(0.0, TURN, 257)).y
        row = table(place, "drive", "drive_links")[0]
        swing, moved = max(abs(track[0])), max(abs(track[1])) * SHAPE
        check("swing at %g rad/s" % speed, abs(row["greatest_swing"] - swing) < 5e-3 * swing, (row, swing))
        mode = table(place, "drive", "drive_link_modes")[0]
        check("bending at %g rad/s" % speed, abs(mode["moved"] - moved) < 5e-3 * moved, (mode, moved))
        apart = max(abs(row["greatest_swing_of_rigid_links"] / swing - 1.0), abs(mode["moved_of_rigid_drive"] / moved - 1.0))
        check("what couples them shows at %g rad/s" % speed, apart > 1e-3, apart)


def main():
    with tempfile.TemporaryDirectory() as place:
        kinds = [random_equations(place, seed) for seed in range(6)]
        check("stable and unstable ones", any(kinds) and not all(kinds), kinds)
        apart(place)
        drive_and_coupler(place)
    return report()


sys.exit(main())
