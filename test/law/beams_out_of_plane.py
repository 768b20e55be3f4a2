#!/usr/bin/env python3
"""Links of beam elements out of the plane (&FLEX of ssics) against closed forms and other methods.

usage: test/law/beams_out_of_plane.py PROGRAM_DIRECTORY

Frequencies: beams of known ends in bending and twist; torsion constants by Saint-Venant's series as Timoshenko has it in tables; a
bent link by Ritz's method with polynomials in each arm. Buckling: Euler's and Prandtl's cantilevers, a beam with a load at its middle
and a cantilever with a spring by Ritz's method; a frame with a corner by a chain of rigid rods with exact rotations, whose energy is
differenced. Stability: the multipliers of a coupler whose forces follow from positions differenced here, by SciPy's integrator.
Last line: N passed, N failed.
"""

import math
import os
import sys
import tempfile

import numpy
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, null_space
from scipy.optimize import brentq

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "tools"))
from data_sets import data
from tally import check, report
from beam_elements import FOUR_BAR, SKETCH, joints, near, run, table

E, RHO, G = 207e9, 7850.0, 207e9 / 2.6
SLOW = (FOUR_BAR % 1e-3).split(" &MASSES")[0]
# the crank, with an arm of 0.2 beyond its pin
ARM = " &FLEX XLINK=-1,1, XLOOP=1,1, YLINK=1,1, YLOOP=1,1, YDIST=0.0,0.2, XMOD=207E9, XRHO=7850.0, XDEPTH=%g, XWIDTH=%g, XPINS=1, NXELEM=12, NXPNT=64%s &END\n"
LOAD = " &LOADS LLINK=1, LLOOP=1, LDIST=0.2, LFX=%.15g, LFY=%.15g, LTURN=1 &END\n"
TWO_ONE, SQUARE = 0.228682, 0.140577                                    # of depth*width**3, Timoshenko and Goodier, table 10.1


def out_of_plane(place, name):
    return table(place, name, "flexible_out_of_plane")[0], table(place, name, "flexible_modes_out_of_plane")


def frequencies(place):
    length = 0.30
    text = FOUR_BAR % 80.0 + " &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=7850.0, NXMODE=8, NXELEM=24%s &END\n"
    for depth, width, factor in ((0.010, 0.010, SQUARE), (0.016, 0.008, TWO_ONE), (0.008, 0.016, TWO_ONE)):
        torsion = factor * max(depth, width) * min(depth, width) ** 3
        bend = width / math.sqrt(12) * math.sqrt(E / RHO)
        wave = math.sqrt(G * torsion / (RHO * depth * width * (depth ** 2 + width ** 2) / 12))
        for pins, roots, twist in ((0, (math.pi, 2 * math.pi), math.pi / 2), (1, (4.730040745, 7.853204624), math.pi)):
            status, words, said = run(place, "beam", text % (", XDEPTH=%g, XWIDTH=%g, XPINS=%d, XZETA=0.01" % (depth, width, pins)))
            check("a coupler out of the plane, XPINS=%d" % pins, status == 0 and "OUT OF THE PLANE" in words, words + said)
            row, modes = out_of_plane(place, "beam")
            bending = [mode["frequency"] for mode in modes if mode["twist"] < 0.5]
            for root, found in zip(roots, bending):
                near("bending, %g by %g, XPINS=%d" % (depth, width, pins), found, (root / length) ** 2 * bend, 2e-5)
            turning = [mode["frequency"] for mode in modes if mode["twist"] > 0.999999]
            near("twist, %g by %g, XPINS=%d" % (depth, width, pins), turning[0], twist / length * wave, 8e-4)
            check("it stays in the plane", row["steady"] in (1, "true", "T"), row)
    # any other section: a tube, a solid one, and what is left out
    tube = ", XAREA=1E-4, XGYR=0.005, XGYRO=%g, XTORS=%g, XPOIS=0.25, XZETA=0.01"
    run(place, "tube", text % (tube % (0.004, 3e-9)))
    modes = out_of_plane(place, "tube")[1]
    near("bending of a tube", modes[0]["frequency"], (math.pi / length) ** 2 * 0.004 * math.sqrt(E / RHO), 2e-5)
    turning = [mode["frequency"] for mode in modes if mode["twist"] > 0.999999]
    near("twist of a tube", turning[0], math.pi / 2 / length * math.sqrt(E / 2.5 * 3e-9 / (RHO * 1e-4 * (0.004 ** 2 + 0.005 ** 2))), 3e-4)
    radius = 0.006
    run(place, "round", text % (", XAREA=%.15g, XGYR=%.15g, XZETA=0.01" % (math.pi * radius ** 2, radius / 2)))
    modes = out_of_plane(place, "round")[1]
    near("a round link bends alike", modes[0]["frequency"], (math.pi / length) ** 2 * radius / 2 * math.sqrt(E / RHO), 2e-5)
    turning = [mode["frequency"] for mode in modes if mode["twist"] > 0.999999]
    near("its twist, by Saint-Venant's estimate", turning[0], math.pi / 2 / length * math.sqrt(G / RHO), 8e-3)
    # an arm without mass and a disc at its end: 3 E I/length**3 with the disc's turning, and twist
    arm, inertia, mass = 0.2, 2e-4, 0.3
    disc = SLOW.replace("SPEED=0.001", "SPEED=5.0") + " &MASSES MLINK=1, MLOOP=1, MASS=%g, MDIST=0.2, MINERT=%g &END\n" % (mass, inertia)
    run(place, "disc", disc + (ARM % (0.012, 0.006, ", NXMODE=3")).replace("XRHO=7850.0", "XRHO=1E-3"))
    second, torsion = 0.012 * 0.006 ** 3 / 12, TWO_ONE * 0.012 * 0.006 ** 3
    k = E * second * numpy.array([[12 / arm ** 3, -6 / arm ** 2], [-6 / arm ** 2, 4 / arm]])
    wanted = list(numpy.sqrt(eigh(k, numpy.diag([mass, inertia / 2]))[0])) + [math.sqrt(G * torsion / arm / (inertia / 2))]
    for found, value in zip(out_of_plane(place, "disc")[1], sorted(wanted)):
        near("arm with a disc, mode %g" % found["mode"], found["frequency"], value, 2e-4)
    # a quarter of a circle without mass and a mass at its end: radius**3 (pi/4/(E I) + (3 pi/4 - 2)/(G J)), Castigliano
    chord = arm
    radius, rise = chord / math.sqrt(2), chord * (math.sqrt(2) - 1) / 2
    text = SLOW.replace("SPEED=0.001", "SPEED=5.0") + " &MASSES MLINK=1, MLOOP=1, MASS=%g, MDIST=0.2 &END\n" % mass
    run(place, "quarter", text + (ARM % (0.012, 0.006, ", NXMODE=1, XRISE=0.0,%.15g" % rise)).replace("XRHO=7850.0", "XRHO=1E-3")
        .replace("NXELEM=12", "NXELEM=40"))
    give = radius ** 3 * (math.pi / 4 / (E * second) + (3 * math.pi / 4 - 2) / (G * torsion))
    near("a mass on a quarter of a circle", out_of_plane(place, "quarter")[1][0]["frequency"], math.sqrt(1 / (give * mass)), 1e-3)
    # tapered arm, clamped: Ritz
    run(place, "taper", SLOW + ARM % (0.012, 0.006, ", YDEPTH=0.012,0.006, YWIDTH=0.006,0.002"))
    for found, value in zip(out_of_plane(place, "taper")[1], cantilever(0.2, lambda s: (0.012 - 0.006 * s, 0.006 - 0.004 * s))[:3]):
        near("tapered arm, mode %g" % found["mode"], found["frequency"], value, 1e-3)


def constants(depth, width):
    """Area, second moment out of the plane, polar second moment and torsion constant."""
    long, short = max(depth, width), min(depth, width)
    series = sum(math.tanh(n * math.pi * long / (2 * short)) / n ** 5 for n in range(1, 60, 2))
    torsion = long * short ** 3 / 3 * (1 - 192 * short / (math.pi ** 5 * long) * series)
    area = depth * width
    return area, area * width ** 2 / 12, area * (depth ** 2 + width ** 2) / 12, torsion


def cantilever(length, sizes, along=0.0, across=0.0, held=0.0, powers=10):
    """Frequencies of an arm that is clamped, under a force at its free end, by Ritz; `held`: stiffness there. Negative: of a square."""
    s, weights = numpy.polynomial.legendre.leggauss(40)
    s, weights = (s + 1) / 2, weights / 2 * length
    area, second, polar, torsion = numpy.array([constants(*sizes(x)) for x in s]).T
    w = numpy.array([s ** n for n in range(2, powers)] + [0 * s] * (powers - 1))
    slope = numpy.array([n * s ** (n - 1) for n in range(2, powers)] + [0 * s] * (powers - 1)) / length
    bend = numpy.array([n * (n - 1) * s ** (n - 2) for n in range(2, powers)] + [0 * s] * (powers - 1)) / length ** 2
    phi = numpy.array([0 * s] * (powers - 2) + [s ** n for n in range(1, powers)])
    twist = numpy.array([0 * s] * (powers - 2) + [n * s ** (n - 1) for n in range(1, powers)]) / length
    at_end = numpy.array([1.0] * (powers - 2) + [0.0] * (powers - 1))
    moment = across * length * (1 - s)
    mixed = (phi * (weights * moment)) @ bend.T
    k = (bend * (weights * E * second)) @ bend.T + (twist * (weights * (G * torsion + along * polar / area))) @ twist.T \
        + (slope * (weights * along)) @ slope.T + mixed + mixed.T + held * numpy.outer(at_end, at_end)
    m = (w * (weights * RHO * area)) @ w.T + (phi * (weights * RHO * polar)) @ phi.T
    squares = eigh(k, m)[0]
    return numpy.sign(squares) * numpy.sqrt(abs(squares))


def bent_link(place):
    """A coupler with a corner, its ends held by pins, by Ritz's method with polynomials in both arms."""
    b, c = joints(0.0)[0], joints(0.0)[1]
    corner = 0.13 * (c - b) / abs(c - b) * complex(math.cos(0.5), math.sin(0.5))
    depth, width = 0.012, 0.008
    area, second, polar, torsion = constants(depth, width)
    for pins in (0, 1):
        angle = math.degrees(0.5)
        text = SKETCH % (c.real, c.imag, 60.0) + (
            " &FLEX XNAME='coupler B','coupler B', YNAME='coupler B','coupler C', XDIST=0.0,0.13, XANG=0.0,%.15g, YDIST=0.13,0.0, "
            "YANG=%.15g,0.0, XMOD=207E9, XRHO=7850.0, XDEPTH=0.012, XWIDTH=0.008, XPINS=%d, NXELEM=20, XZETA=0.01 &END\n" % (angle, angle, pins))
        status, words, said = run(place, "bent", text)
        check("a bent coupler, XPINS=%d" % pins, status == 0, words + said)
        arms = [(corner - 0, 0), (c - b - corner, 1)]
        many = 10
        s, weights = numpy.polynomial.legendre.leggauss(30)
        s, weights = (s + 1) / 2, weights / 2
        size = 4 * many                                                 # w and twist in each arm
        k, m = numpy.zeros((size, size)), numpy.zeros((size, size))
        ends = []
        for arm, number in arms:
            length = abs(arm)
            values = numpy.array([s ** n for n in range(many)])
            first = numpy.array([n * s ** max(n - 1, 0) for n in range(many)]) / length
            twice = numpy.array([n * (n - 1) * s ** max(n - 2, 0) for n in range(many)]) / length ** 2
            w, phi = slice(2 * many * number, 2 * many * number + many), slice(2 * many * number + many, 2 * many * number + 2 * many)
            k[w, w] = (twice * weights * length * E * second) @ twice.T
            k[phi, phi] = (first * weights * length * G * torsion) @ first.T
            m[w, w] = (values * weights * length * RHO * area) @ values.T
            m[phi, phi] = (values * weights * length * RHO * polar) @ values.T
            for x in (0.0, 1.0):
                rows = numpy.zeros((3, size))                           # w, and turning about x and y
                rows[0, w] = [x ** n for n in range(many)]
                slope = numpy.zeros(size)
                slope[w] = [(n * x ** (n - 1) if n else 0.0) / length for n in range(many)]
                twist = numpy.zeros(size)
                twist[phi] = [x ** n for n in range(many)]
                t = arm / length
                # turning: twist along t, minus the slope along z x t
                rows[1] = twist * t.real + slope * t.imag
                rows[2] = twist * t.imag - slope * t.real
                ends.append(rows)
        line = (c - b) / abs(c - b)
        conditions = [ends[1] - ends[2], ends[0][:1], ends[3][:1]]
        if pins == 1:
            conditions += [ends[0][1:], ends[3][1:]]
        else:
            conditions += [(line.real * ends[0][1] + line.imag * ends[0][2]).reshape(1, -1)]
        free = null_space(numpy.vstack(conditions))
        wanted = numpy.sqrt(eigh(free.T @ k @ free, free.T @ m @ free)[0])
        for found, value in list(zip(out_of_plane(place, "bent")[1], wanted))[:5]:
            near("bent coupler, XPINS=%d, mode %g" % (pins, found["mode"]), found["frequency"], value, 1e-3)


def critical(place, what, load, wanted, error, sizes, even):
    """The load at which the least stiffness is 0: it falls with the load, or with its square."""
    power = 2 if even else 1
    rows = []
    for part in (0.97, 1.03):
        status, words, said = run(place, "load", SLOW + LOAD % load(part * wanted) + ARM % sizes)
        check(what + (" buckles" if part > 1 else " stands"), (status == 1) == (part > 1) == ("BUCKLED OUT OF THE PLANE" in words), words + said)
        check("and it is said", (part > 1) == ("buckles out of the plane" in said), said)
        rows.append((part ** power, out_of_plane(place, "load")[0]["least_stiffness"]))
    (x, y), (u, v) = rows
    near(what, (x - y * (u - x) / (v - y)) ** (1 / power), 1.0, error)


def buckling(place):
    depth, width, length = 0.020, 0.002, 0.2
    area, second, polar, torsion = constants(depth, width)
    stiff = math.sqrt(E * second * G * torsion)
    critical(place, "Euler's strut", lambda p: (-p, 0.0), math.pi ** 2 * E * second / (4 * length ** 2), 2e-4, (depth, width, ""), False)
    # with all modes but the first from statics, too
    for modes in ("", ", NXMODE=1"):
        critical(place, "Prandtl's cantilever" + modes, lambda p: (0.0, p), 4.0126 * stiff / length ** 2, 2e-3,
                 (depth, width, modes), True)
    # a force at an angle, the frequency by Ritz
    along, across = -0.4 * math.pi ** 2 * E * second / (4 * length ** 2), 0.5 * 4.0126 * stiff / length ** 2
    run(place, "both", SLOW + LOAD % (along, across) + (ARM % (depth, width, "")).replace("NXELEM=12", "NXELEM=28"))
    first, under = cantilever(length, lambda s: (depth, width))[0], cantilever(length, lambda s: (depth, width), along, across)[0]
    near("under both", out_of_plane(place, "both")[0]["least_stiffness"], (under / first) ** 2, 2e-3)
    # a spring to the ground, whose pull turns against the arm
    anchor, stiffness, free = 0.4 + 0.1j, 500.0, 0.05
    spring = " &SPRING ALINK=1, ALOOP=1, ADIST=0.2, BLINK=-4, BLOOP=1, BDIST=%.15g, BANG=%.15g, STIFF=%g, SFREE=%g &END\n"
    # arc 4 leads back from its end at 0.32 along the frame
    b = anchor - 0.32
    run(place, "spring", SLOW + spring % (abs(b), math.degrees(math.atan2(b.imag, b.real)) - 180.0, stiffness, free) + ARM % (depth, width, ""))
    row = out_of_plane(place, "spring")[0]
    least = []
    for n in range(0, 64):
        t = complex(math.cos(2 * math.pi * n / 64), math.sin(2 * math.pi * n / 64))
        gap = anchor - 0.26 * t
        pull = stiffness * (abs(gap) - free)
        force = pull * gap / abs(gap) / t
        least.append(cantilever(length, lambda s: (depth, width), force.real, force.imag, pull / abs(gap), 8)[0])
    n = least.index(min(least))
    near("with a spring", row["least_stiffness"], (min(least) / first) * abs(min(least) / first), 3e-3)
    near("there it is", row["least_stiffness_at"], 360.0 * n / 64, 1e-6)
    # a coupler under a load across its middle, by Ritz with sines; twist held at one pin, or at both with the slopes
    text = SLOW + " &LOADS LLINK=-2, LLOOP=1, LDIST=0.15, LFY=%g, LTURN=1 &END\n" + \
        " &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=7850.0, XDEPTH=0.02, XWIDTH=0.002, XPINS=%d, NXELEM=32, NXPNT=64 &END\n"
    for pins, force in ((0, 120.0), (1, 700.0)):
        run(place, "middle", text % (force, pins))
        row = out_of_plane(place, "middle")[0]
        along = pulls_of_load(force)
        found = [middle(pins, force, n) for n in along]
        near("load at the middle, XPINS=%d" % pins, row["least_stiffness"], min(found) / middle(pins, 0.0, 0.0), 3e-3)


def pulls_of_load(force):
    """Pull of the half of the coupler beyond its middle, of a force across it there: the rocker takes a force along itself."""
    pulls = []
    for n in range(64):
        b, c = joints(2 * math.pi * n / 64)
        t, rocker = (c - b) / 0.30, (c - 0.32) / 0.14
        # at C across the coupler half the load comes from the rocker
        push = -0.5 * force / (rocker / t).imag
        pulls.append(push * (rocker / t).real)
    return pulls


def middle(pins, force, pull):
    """Square of the first frequency of the coupler under a load across its middle; the pull is in its whole length."""
    length, depth, width = 0.30, 0.02, 0.002
    area, second, polar, torsion = constants(depth, width)
    many = 12
    x, weights = numpy.polynomial.legendre.leggauss(30)
    s = numpy.concatenate([(x + 1) / 4, (x + 3) / 4])                   # the moment has a corner
    weights = numpy.concatenate([weights, weights]) / 4 * length
    base = numpy.polynomial.Polynomial([0, 1, -1]) ** (2 if pins else 1)
    # powers of s are so nearly dependent that their masses are not positive definite to rounding
    legendre = [numpy.polynomial.Legendre.basis(n, domain=[0, 1]).convert(kind=numpy.polynomial.Polynomial, domain=[-1, 1]) for n in range(many)]
    shapes = [base * p for p in legendre]
    twists = [numpy.polynomial.Polynomial([0, 1, -1] if pins else [0, 1]) * p for p in legendre]
    w, slope, bend = (numpy.array([p.deriv(d)(s) / length ** d if d else p(s) for p in shapes]) for d in (0, 1, 2))
    phi, twist = (numpy.array([p.deriv(d)(s) / length ** d if d else p(s) for p in twists]) for d in (0, 1))
    moment = -0.5 * force * length * numpy.minimum(s, 1 - s)
    none = numpy.zeros((many, many))
    mixed = (bend * weights * moment) @ phi.T
    k = numpy.block([[(bend * weights * E * second) @ bend.T + (slope * weights * pull) @ slope.T, mixed],
                     [mixed.T, (twist * weights * (G * torsion + pull * polar / area)) @ twist.T]])
    m = numpy.block([[(w * weights * RHO * area) @ w.T, none], [none, (phi * weights * RHO * polar) @ phi.T]])
    return eigh(k, m)[0][0]


def rotation(v):
    """Matrices of rotation of vectors. Shape (n, 3)."""
    angle = numpy.linalg.norm(v, axis=1)
    angle = numpy.where(angle > 0, angle, 1.0)
    one, two = numpy.sin(angle) / angle, (1 - numpy.cos(angle)) / angle ** 2
    x, y, z = v.T
    none = 0 * x
    cross = numpy.array([[none, -z, y], [z, none, -x], [-y, x, none]]).transpose(2, 0, 1)
    return numpy.eye(3) + one[:, None, None] * cross + two[:, None, None] * (cross @ cross)


def corner(place):
    """An arm with a corner under a force at its end: a chain of rigid rods with exact rotations, of nearly no flexibility in the plane."""
    depth, width = 0.020, 0.0015
    area, second, polar, torsion = constants(depth, width)
    first, far = 0.12, 0.09                                             # arms: ahead along the crank, then across it
    force = numpy.array([-60.0, 150.0])
    text = SLOW + " &LOADS LLINK=1, LLOOP=1, LDIST=%.15g, LANG=%.15g, LFX=%g, LFY=%g, LTURN=1 &END\n" % (
        math.hypot(first, far), math.degrees(math.atan2(far, first)), force[0], force[1])
    text += (" &FLEX XLINK=-1,1,1, XLOOP=3*1, YLINK=3*1, YLOOP=3*1, XDIST=0.0,0.0,%.15g, YDIST=0.0,%.15g,%.15g, YANG=0.0,0.0,%.15g, XMOD=207E9, "
             "XRHO=7850.0, XDEPTH=%g, XWIDTH=%g, XPINS=1, NXELEM=14, NXPNT=16 &END\n" % (
                 first, first, math.hypot(first, far), math.degrees(math.atan2(far, first)), depth, width))
    status, words, said = run(place, "corner", text)
    row = out_of_plane(place, "corner")[0]
    many = 24
    steps = numpy.array([first / many] * many + [far / many] * many)
    ahead = numpy.array([[1.0, 0.0, 0.0]] * many + [[0.0, 1.0, 0.0]] * many)
    aside = numpy.cross([0.0, 0.0, 1.0], ahead)
    ends = numpy.concatenate([numpy.zeros((1, 3)), numpy.cumsum(steps[:, None] * ahead, axis=0)])
    tip = ends[-1]
    # springs: at the clamp half a rod long, between rods; at the corner half of each
    in_plane = 1e4 * E * second
    load = numpy.array([force[0], force[1], 0.0])

    def chain(scale):
        moments = numpy.array([numpy.cross(tip - x, scale * load)[2] for x in ends[:-1]])
        gaps = steps.copy()
        gaps[0] = steps[0] / 2
        gaps[many] = (steps[0] + steps[-1]) / 2
        about_z = numpy.cumsum(moments * gaps / in_plane)

        def energy(out):
            v = numpy.zeros((2 * many, 3))
            v[:, :2] = out.reshape(-1, 2)
            v[:, 2] = about_z
            r = rotation(v)
            total = -scale * load @ numpy.sum(steps[:, None] * numpy.einsum("kij,kj->ki", r, ahead), axis=0)
            before = numpy.concatenate([numpy.eye(3)[None], r[:-1]])
            q = numpy.einsum("kji,kjl->kil", before, r)
            turned = 0.5 * numpy.array([q[:, 2, 1] - q[:, 1, 2], q[:, 0, 2] - q[:, 2, 0], q[:, 1, 0] - q[:, 0, 1]]).T
            turned *= (1 + numpy.sum(turned ** 2, axis=1) / 6)[:, None]
            for k in range(2 * many):
                if k == many:                                           # half a rod before the corner, half behind: in series
                    stiffness = numpy.zeros((3, 3))
                    for j in (k - 1, k):
                        axes = numpy.array([ahead[j], aside[j], [0.0, 0.0, 1.0]])
                        stiffness += axes.T @ numpy.diag(steps[j] / 2 / numpy.array([G * torsion, E * second, in_plane])) @ axes
                    total += 0.5 * turned[k] @ numpy.linalg.solve(stiffness, turned[k])
                else:
                    axes = numpy.array([ahead[k], aside[k], [0.0, 0.0, 1.0]]) @ turned[k]
                    total += 0.5 * numpy.sum(numpy.array([G * torsion, E * second, in_plane]) * axes ** 2) / gaps[k]
            return total

        # the springs between neighbours, and the load: by differences, column by column
        size, h = 4 * many, 1e-5
        hessian = numpy.zeros((size, size))
        zero = energy(numpy.zeros(size))
        single = [energy(h * one) for one in numpy.eye(size)]
        for i in range(size):
            for j in range(i, size):
                if j == i:
                    value = (energy(-h * numpy.eye(size)[i]) - 2 * zero + single[i]) / h ** 2
                elif j > i + 3:
                    continue                                            # rods that do not touch: no spring between them
                else:
                    value = (energy(h * (numpy.eye(size)[i] + numpy.eye(size)[j])) - single[i] - single[j] + zero) / h ** 2
                hessian[i, j] = hessian[j, i] = value
        return hessian

    # mass: the middle of each rod moves by those before it, and it turns about its axis
    size = 4 * many
    moved = numpy.zeros((2 * many, size))
    for k in range(2 * many):
        for j in range(k + 1):
            part = steps[j] * (0.5 if j == k else 1.0)
            # (turning x ahead) along z
            moved[k, 2 * j:2 * j + 2] = part * numpy.array([ahead[j, 1], -ahead[j, 0]])
    mass = moved.T @ numpy.diag(RHO * area * steps) @ moved
    for j in range(2 * many):
        mass[2 * j:2 * j + 2, 2 * j:2 * j + 2] += RHO * polar * steps[j] * numpy.outer(ahead[j, :2], ahead[j, :2]) \
            + 1e-3 * RHO * polar * steps[j] * numpy.outer(aside[j, :2], aside[j, :2])
    at_rest, under = eigh(chain(0.0), mass)[0][0], eigh(chain(1.0), mass)[0][0]
    near("frequency of an arm with a corner", out_of_plane(place, "corner")[1][0]["frequency"], math.sqrt(at_rest), 3e-3)
    check("its load matters", abs(under / at_rest - 1) > 0.2, (at_rest, under))
    near("a corner under a load", 1 - row["least_stiffness"], 1 - under / at_rest, 1e-2)


def multipliers(place):
    """A light coupler that drives a heavy rocker, whose pull makes it swing out of the plane."""
    depth, width, length, rho, zeta, inertia = 0.016, 0.002, 0.30, 900.0, 0.004, 2e-4
    area, second, polar, torsion = constants(depth, width)
    text = (FOUR_BAR % 30.0).split(" &MASSES")[0] + " &MASSES MLINK=3, MLOOP=1, MASS=1E-9, MINERT=%g &END\n" % inertia + \
        " &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=%g, XDEPTH=%g, XWIDTH=%g, XZETA=%g, NXELEM=16 &END\n" % (
            rho, depth, width, zeta)
    many, twists = 3, 2                                                 # half waves, and twist from one pin on
    points, h = 128, 1e-3
    table_of = []
    s, weights = numpy.polynomial.legendre.leggauss(12)
    s, weights = (s + 1) / 2, weights / 2 * length
    unit = math.sqrt(2 / (rho * area * length))                         # shapes of unit mass
    for n in range(points):
        near_by = [joints(2 * math.pi * n / points + k * h) for k in (-2, -1, 0, 1, 2)]
        b, c = near_by[2]
        t = (c - b) / length

        def twice(values):
            return (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (12 * h ** 2)

        ab, ac = (twice([pair[k] for pair in near_by]) / t for k in (0, 1))
        angle = numpy.unwrap([numpy.angle(pair[1] - 0.32) for pair in near_by])
        turning = twice(list(angle))
        # force at C on the coupler: across it by moments about B, along it by those of the rocker about its pivot
        across = rho * area * length * (ab.imag / 2 + (ac.imag - ab.imag) / 3)
        arm = (c - 0.32) / t
        # inertia*turning = arm x (-force)
        along = (arm.real * across + inertia * turning) / arm.imag
        at = length * s
        pull = along - rho * area * (ab.real * (length - at) + (ac.real - ab.real) * (length ** 2 - at ** 2) / (2 * length))
        moment = (length - at) * across - rho * area * (ab.imag * (length - at) ** 2 / 2 + (ac.imag - ab.imag) / length * (
            length ** 3 / 3 - at * length ** 2 / 2 + at ** 3 / 6))
        slopes = numpy.array([j * math.pi / length * numpy.cos(j * math.pi * s) for j in range(1, many + 1)]) * unit
        bends = -numpy.array([(j * math.pi / length) ** 2 * numpy.sin(j * math.pi * s) for j in range(1, many + 1)]) * unit
        turned = numpy.array([numpy.sin((j - 0.5) * math.pi * s) for j in range(1, twists + 1)]) * unit * math.sqrt(area / polar)
        wound = numpy.array([(j - 0.5) * math.pi / length * numpy.cos((j - 0.5) * math.pi * s) for j in range(1, twists + 1)]) * unit
        mixed = (bends * weights * moment) @ turned.T
        table_of.append(numpy.block([[(slopes * weights * pull) @ slopes.T, mixed], [mixed.T, (wound * weights * pull) @ wound.T]]))
    harmonics = numpy.fft.fft(numpy.array(table_of), axis=0) / points
    waves = numpy.fft.fftfreq(points, 1.0 / points)
    squares = numpy.concatenate([E * second / (rho * area) * (numpy.arange(1, many + 1) * math.pi / length) ** 4,
                                 G * torsion / (rho * polar) * ((numpy.arange(1, twists + 1) - 0.5) * math.pi / length) ** 2])
    many += twists
    grows = 0
    for speed in (300.0, 450.0, 550.0, 650.0):
        def rate(x, y, speed=speed):
            k = numpy.real(numpy.tensordot(numpy.exp(1j * waves * x), harmonics, 1)) + numpy.diag(squares) / speed ** 2
            c = 2 * zeta * numpy.sqrt(squares) / speed
            y = y.reshape(2 * many, -1)
            return numpy.concatenate([y[many:], -k @ y[:many] - c[:, None] * y[many:]]).ravel()

        end = solve_ivp(rate, (0.0, 2 * math.pi), numpy.eye(2 * many).ravel(), "DOP853", rtol=1e-8, atol=1e-10).y[:, -1].reshape(2 * many, -1)
        wanted = max(abs(numpy.linalg.eigvals(end)))
        status, words, said = run(place, "swing", text.replace("SPEED=30", "SPEED=%g" % speed))
        row = out_of_plane(place, "swing")[0]
        grows += wanted > 1.02
        near("multiplier out of the plane at %g rad/s" % speed, math.log(row["multiplier"]), math.log(wanted), 1e-2)
        if wanted > 1.02:
            check("it is said", status == 1 and ", out of the plane: " in said, said)
    check("one of them grows", grows > 0)


def thin(place):
    """Strips far beyond Euler's load: pressed for a part of the turn they buckle, however hard they are pulled for the rest."""
    text = data("ssics/flat_bar")
    number = "XGYRO=7.217E-4"
    check("the data set has it", number in text)
    run(place, "strip", text)
    least = out_of_plane(place, "strip")[0]["least_stiffness"]
    places = []
    for radius in (7.217e-5, 1e-6):
        status, words, said = run(place, "strip", text.replace(number, "XGYRO=%g" % radius))
        row = out_of_plane(place, "strip")[0]
        places.append(row["least_stiffness_at"])
        # under a pull N over Euler's load the square of mode j is j**4 + j**2 N: 1 + N or less, -N**2/4 or more
        pull = (least - 1) * (7.217e-4 / radius) ** 2
        check("it buckles: %g" % radius, status == 1 and -1.02 * pull ** 2 / 4 < row["least_stiffness"] < 1 + 0.98 * pull, (row, pull))
        check("it is unstable: %g" % radius, "the link coupler, out of the plane: unstable" in said and "a multiplier is 1" not in said, said)
    check("where it is pressed most", abs(places[0] - places[1]) < 3.0, places)
    status, words, said = run(place, "growing", text.replace(number, "XGYRO=1E-7"))
    row = out_of_plane(place, "growing")[0]
    check("no multiplier of what grows too much", "grows too much" in said and row["multiplier"] == "", row)
    status, words, said = run(place, "soft", text.replace("XTORS=1.02E-10", "XTORS=1E-300"))
    check("no number that is none", status == 1 and "natural modes could not be found" in said and "NaN" not in words, said)


def refusals(place):
    good = SLOW + " &FLEX XLINK=-2, XLOOP=1, YLINK=2, YLOOP=1, XMOD=207E9, XRHO=7850.0, %s &END\n"
    for items, words in (
            ("XDEPTH=0.01, XWIDTH=0.01, XGYRO=0.003", "&FLEX XGYRO: the sections are rectangles: depth and width give it"),
            ("XDEPTH=0.01, XWIDTH=0.01, YTORS=1E-9", "&FLEX YTORS: the sections are rectangles"),
            ("XAREA=1E-4, XGYR=0.003, YGYRO=0.004", "needs XGYRO"),
            ("XAREA=1E-4, XGYR=0.003, YTORS=1E-9", "needs XTORS"),
            ("XDEPTH=0.01, XWIDTH=0.01, XPOIS=0.7", "XPOIS"),
            ("XDEPTH=0.01, XWIDTH=0.01, XPINS=2", "XPINS")):
        status, _, said = run(place, "no", good % items)
        check("refused: " + words, status == 2 and words in said, said)


def main():
    with tempfile.TemporaryDirectory() as place:
        frequencies(place)
        bent_link(place)
        buckling(place)
        corner(place)
        multipliers(place)
        thin(place)
        refusals(place)
    return report()


if __name__ == "__main__":
    sys.exit(main())
