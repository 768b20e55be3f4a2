"""Positions of a four-bar and of the ten-bar needle linkage by psalm and by other packages: a section in Markdown.

usage: packages.py POSITIONS LIMIT [--short] [--skipped FILE]    (programs of bench/; LIMIT may be -)
       packages.py one METHOD LINKAGE POSITIONS RUNS         a row: version | ns per dyad and position | positions measured | error
FILE: a line for each package that could not be installed, and why. Packages that are not there have a row that says so.

The linkages are those of yardstick/limit.c: the crank A turns about O, its pin drives one dyad (four-bar, with a point P of the coupler) or
four (ten-bar). Every method finds all joints at every input, a full turn in equal steps. Time is that of the processor, the least of several
runs of the solution alone: cases and models are made before, compilers have run. Errors are the largest distance from joints that are found
here in numbers of 64 bits of mantissa, divided by the crank's length.
"""
import math
import os
import re
import subprocess
import sys
import tempfile
import time

import numpy as np

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CRANK = 19.0
RAD = math.pi/180.0


def polar(length, degrees):
    return length*math.cos(degrees*RAD), length*math.sin(degrees*RAD)


GROUND = {"O1": polar(112.468, 238.359), "O2": polar(110.064, 238.359 + 33.593), "O4": polar(352.715, 238.359 + 20.443)}
# joint: from, to, their links' lengths, side of the joint seen from the first to the second
DYADS = {"B1": ("A", "O1", 95.0, 104.5, -1), "B2": ("A", "O2", 105.0, 31.0, -1), "C3": ("B2", "E", 61.0, 12.5, 1),
         "D4": ("C3", "O4", 245.5, 85.0, 1)}
# point of a link: from, to, part of the vector between them and of the vector at right angles
POINTS = {"E": ("O1", "B1", 24.0/104.5*math.cos(47.384*RAD), 24.0/104.5*math.sin(47.384*RAD)), "P": ("A", "B1", 47.5/95.0, 20.0/95.0)}
ORDER = {"four-bar": ["B1", "P"], "ten-bar": ["B1", "B2", "E", "C3", "D4"]}
LINKS = {"four-bar": ["O A", "A B1 P", "B1 O1"],
         "ten-bar": ["O A", "A B1", "B1 O1 E", "A B2", "B2 O2", "B2 C3", "E C3", "C3 D4", "D4 O4"]}
SIZES = (180, 1000000)
MOST_STEPS = {"pylinkage": 20000, "one by one": 2000}   # positions of slower methods: the first of as many steps
LEAST_TIMED = 0.02      # seconds of one timing


def dyads_of(linkage):
    return sum(name in DYADS for name in ORDER[linkage])


def grounds_of(linkage):
    return ["O1"] if linkage == "four-bar" else list(GROUND)


# ---- closed form, in any kind of number

def closed_form(linkage, angle, real=np.float64):
    """Joints by their names, (2, positions); the frame's, (2, 1)."""
    at = {name: np.array([[real(x)], [real(y)]]) for name, (x, y) in GROUND.items()}
    at["A"] = real(CRANK)*np.array([np.cos(angle), np.sin(angle)])
    for name in ORDER[linkage]:
        if name in POINTS:
            a, b, along, across = POINTS[name]
            dx, dy = at[b] - at[a]
            at[name] = np.array([at[a][0] + along*dx - across*dy, at[a][1] + along*dy + across*dx])
        else:
            a, b, r1, r2, side = DYADS[name]
            dx, dy = at[b] - at[a]
            square = dx*dx + dy*dy
            half = 0.5/square
            along = (square + (r1*r1 - r2*r2))*half
            across = side*half*np.sqrt(((r1 + r2)**2 - square)*(square - (r1 - r2)**2))
            at[name] = np.array([at[a][0] + along*dx - across*dy, at[a][1] + along*dy + across*dx])
    return at


def angles_of(n, real=np.float64):
    turn = real(2)*np.arctan2(real(0), real(-1))
    return turn*np.arange(n, dtype=real)/real(n)


# ---- methods: each makes a function that solves everything and gives joints by their names, (2, positions), and how many there are

def numpy_closed_form(linkage, n):
    angle = angles_of(n)
    return lambda: closed_form(linkage, angle), n


class Loops:
    """Loop equations with the angles of both links of every dyad as unknowns, loop after loop, any number of positions at once."""

    def __init__(self, linkage):
        self.order = ORDER[linkage]

    def newton(self, crank, unknown, tolerance=1e-13):
        """Joints as complex numbers; `unknown`, (2, positions) of every dyad, is improved in place."""
        at = {name: complex(x, y) for name, (x, y) in GROUND.items()}
        at["A"] = CRANK*np.exp(1j*crank)
        for name in self.order:
            if name in POINTS:
                a, b, along, across = POINTS[name]
                at[name] = at[a] + complex(along, across)*(at[b] - at[a])
                continue
            a, b, r1, r2, _ = DYADS[name]
            first, second = unknown[name]
            base = at[a] - at[b]
            for _ in range(30):
                u, v = r1*np.exp(1j*first), r2*np.exp(1j*second)
                miss = base + u - v
                determinant = (np.conj(u)*v).imag
                by_first, by_second = -(np.conj(v)*miss).real/determinant, -(np.conj(u)*miss).real/determinant
                first += by_first
                second += by_second
                if max(np.max(np.abs(by_first)), np.max(np.abs(by_second))) < tolerance:
                    break
            at[name] = at[a] + r1*np.exp(1j*first)
        return at

    def start(self):
        at = closed_form("ten-bar", np.zeros(1))
        return {name: np.array([np.arctan2(*(at[name] - at[end])[::-1]) for end in DYADS[name][:2]])
                for name in self.order if name in DYADS}


def as_pairs(at, order):
    return {name: np.array([at[name].real, at[name].imag]) for name in order}


def numpy_newton(linkage, n):
    """From interpolation between positions that are solved one after another."""
    loops, angle = Loops(linkage), angles_of(n)
    coarse = np.linspace(0.0, 2.0*math.pi, 73)
    first = loops.start()

    def solve():
        unknown = {name: values.copy() for name, values in first.items()}
        table = {name: np.empty((2, coarse.size)) for name in unknown}
        for i, crank in enumerate(coarse):
            loops.newton(np.array([crank]), unknown)
            for name in unknown:
                table[name][:, i] = unknown[name][:, 0]
        guess = {name: np.array([np.interp(angle, coarse, row) for row in table[name]]) for name in table}
        return as_pairs(loops.newton(angle, guess), loops.order)

    return solve, n


def scipy_one_by_one(linkage, n, solver):
    """All loop equations at once with their Jacobian, from the previous position."""
    from scipy import optimize
    few = min(n, MOST_STEPS["one by one"])
    loops, angle = Loops(linkage), angles_of(n)[:few]
    names = [name for name in loops.order if name in DYADS]
    place = {name: 2*i for i, name in enumerate(names)}
    ground = {name: complex(x, y) for name, (x, y) in GROUND.items()}

    def equations(x, crank, give=0):
        at, by = dict(ground), {}
        at["A"] = CRANK*complex(math.cos(crank), math.sin(crank))
        miss, slopes = np.empty(x.size), np.zeros((x.size, x.size))
        zero = np.zeros(x.size, complex)
        for name in loops.order:
            if name in POINTS:
                a, b, along, across = POINTS[name]
                factor = complex(along, across)
                at[name] = at[a] + factor*(at[b] - at[a])
                by[name] = (1.0 - factor)*by.get(a, zero) + factor*by.get(b, zero)
                continue
            a, b, r1, r2, _ = DYADS[name]
            k = place[name]
            u = r1*complex(math.cos(x[k]), math.sin(x[k]))
            v = r2*complex(math.cos(x[k + 1]), math.sin(x[k + 1]))
            at[name] = at[a] + u
            gap = at[name] - at[b] - v
            miss[k], miss[k + 1] = gap.real, gap.imag
            mine = by.get(a, zero).copy()
            mine[k] += 1j*u
            by[name] = mine
            row = mine - by.get(b, zero)
            row[k + 1] -= 1j*v
            slopes[k], slopes[k + 1] = row.real, row.imag
        return at if give == 2 else slopes if give == 1 else miss

    def by_fsolve(x, crank):
        return optimize.fsolve(equations, x, (crank,), fprime=lambda x, crank: equations(x, crank, 1), xtol=1e-13)

    def by_root(x, crank):
        return optimize.root(lambda x: (equations(x, crank), equations(x, crank, 1)), x, jac=True, method="hybr", tol=1e-13).x

    step = by_fsolve if solver == "fsolve" else by_root
    start = np.array([loops.start()[name][:, 0] for name in names]).ravel()

    def solve():
        x, found = start, {name: np.empty((2, few)) for name in loops.order}
        for i, crank in enumerate(angle):
            x = step(x, crank)
            at = equations(x, crank, 2)
            for name in loops.order:
                found[name][:, i] = at[name].real, at[name].imag
        return found

    return solve, few


def numba_closed_form(linkage, n):
    """The closed form in a loop that Numba compiles; dyads and points as data."""
    import numba
    order = grounds_of(linkage) + ["A"] + ORDER[linkage]
    index = {name: i for i, name in enumerate(order)}
    first = len(grounds_of(linkage)) + 1
    rows, is_point = [], []
    for name in ORDER[linkage]:
        is_point.append(name in POINTS)
        if name in POINTS:
            a, b, p, q = POINTS[name]
            rows.append([index[a], index[b], p, q, 0.0, 0.0])
        else:
            a, b, r1, r2, side = DYADS[name]
            rows.append([index[a], index[b], r1*r1 - r2*r2, (r1 + r2)**2, (r1 - r2)**2, side])
    ends, numbers, is_point = np.array([r[:2] for r in rows], int), np.array([r[2:] for r in rows]), np.array(is_point)
    fixed = np.array([GROUND[name] for name in grounds_of(linkage)])
    angle = angles_of(n)

    @numba.njit(fastmath=True)
    def run(angle, fixed, ends, numbers, is_point, first, out):
        for k in range(fixed.shape[0]):
            for i in range(angle.size):
                out[k, 0, i], out[k, 1, i] = fixed[k, 0], fixed[k, 1]
        for i in range(angle.size):
            out[first - 1, 0, i], out[first - 1, 1, i] = CRANK*np.cos(angle[i]), CRANK*np.sin(angle[i])
        for k in range(ends.shape[0]):
            a, b = out[ends[k, 0]], out[ends[k, 1]]
            to = out[first + k]
            p, q, s, side = numbers[k]
            for i in range(angle.size):
                dx, dy = b[0, i] - a[0, i], b[1, i] - a[1, i]
                along, across = p, q
                if not is_point[k]:
                    square = dx*dx + dy*dy
                    half = 0.5/square
                    along = (square + p)*half
                    across = side*half*np.sqrt((q - square)*(square - s))
                to[0, i] = a[0, i] + along*dx - across*dy
                to[1, i] = a[1, i] + along*dy + across*dx

    def solve():
        out = np.empty((len(order), 2, n))
        run(angle, fixed, ends, numbers, is_point, first, out)
        return {name: out[index[name]] for name in ORDER[linkage]}

    return solve, n


def by_pylinkage(linkage, n, fast):
    import pylinkage
    from pylinkage import Crank, FixedDyad, Ground, Linkage, RRRDyad
    few = n if fast else min(n, MOST_STEPS["pylinkage"])
    step = 2.0*math.pi/n
    # the crank turns before each position
    begin = closed_form(linkage, np.array([-step]))

    def make():
        made = {name: Ground(*GROUND[name], name=name) for name in grounds_of(linkage)}
        origin = Ground(0.0, 0.0, name="O")
        made["A"] = Crank(anchor=origin, radius=CRANK, angular_velocity=step, initial_angle=-step)

        def end(name):
            return made[name].output if name == "A" else made[name]

        for name in ORDER[linkage]:
            if name in POINTS:
                a, b, along, across = POINTS[name]
                dx, dy = (begin[b] - begin[a])[:, 0]
                made[name] = FixedDyad(end(a), end(b), math.hypot(along, across)*math.hypot(dx, dy), math.atan2(across, along))
            else:
                a, b, r1, r2, _ = DYADS[name]
                made[name] = RRRDyad(end(a), end(b), r1, r2, x=float(begin[name][0, 0]), y=float(begin[name][1, 0]))
        parts = [origin, *made.values()]
        return Linkage(parts, order=parts), [parts.index(made[name]) for name in ORDER[linkage]]

    def solve():
        model.set_coords(coordinates)
        track = model.step_fast(iterations=few) if fast else np.array(list(model.step(iterations=few)))
        return {name: track[:, place, :].T for name, place in zip(ORDER[linkage], places)}

    model, places = make()
    coordinates = model.get_coords()
    if fast:
        model.compile()
    solve.version = getattr(pylinkage, "__version__", "")
    return solve, few


def by_exudyn(linkage, n):
    """Links as rigid bodies in the plane, joints as constraints, the crank's angle prescribed: static steps."""
    import exudyn as exu
    from exudyn.itemInterface import (CoordinateConstraint, MarkerBodyRigid, MarkerNodeCoordinate, NodePointGround, NodeRigidBody2D,
                                      ObjectGround, ObjectJointRevolute2D, ObjectRigidBody2D, SensorBody)
    few = min(n, MOST_STEPS["one by one"])
    at = {name: places[:, 0] for name, places in closed_form(linkage, np.zeros(1)).items()}
    at["O"] = np.zeros(2)
    container = exu.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(ObjectGround())
    bodies, nodes = {}, {}

    def body(a, b):
        angle = math.atan2(*(at[b] - at[a])[::-1])
        nodes[a, b] = system.AddNode(NodeRigidBody2D(referenceCoordinates=[*at[a], angle]))
        bodies[a, b] = system.AddObject(ObjectRigidBody2D(mass=1.0, inertia=1.0, nodeNumber=nodes[a, b])), at[a], angle

    def local(key, point):
        _, origin, angle = bodies[key]
        away = at[point] - origin
        c, s = math.cos(angle), math.sin(angle)
        return [c*away[0] + s*away[1], -s*away[0] + c*away[1], 0.0]

    def marker(key, point):
        if key is None:
            return system.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=[*at[point], 0.0]))
        return system.AddMarker(MarkerBodyRigid(bodyNumber=bodies[key][0], localPosition=local(key, point)))

    def pin(one, other, point):
        system.AddObject(ObjectJointRevolute2D(markerNumbers=[marker(one, point), marker(other, point)]))

    body("O", "A")
    pin(None, ("O", "A"), "O")
    owner = {"A": ("O", "A"), **{name: None for name in grounds_of(linkage)}}
    sensors = {}
    for name in ORDER[linkage]:
        if name in POINTS:
            a, b = POINTS[name][:2]
            owner[name] = (a, b) if (a, b) in bodies else (b, a) if (b, a) in bodies else (a, b)
        else:
            a, b = DYADS[name][:2]
            body(a, name)
            body(b, name)
            pin(owner[a], (a, name), a)
            pin(owner[b], (b, name), b)
            pin((a, name), (b, name), name)
            owner[name] = (a, name)
        key = owner[name]
        sensors[name] = system.AddSensor(SensorBody(bodyNumber=bodies[key][0], localPosition=local(key, name), storeInternal=True,
                                                    outputVariableType=exu.OutputVariableType.Position))
    step = 2.0*math.pi/n
    still = system.AddMarker(MarkerNodeCoordinate(nodeNumber=system.AddNode(NodePointGround()), coordinate=0))
    turned = system.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes["O", "A"], coordinate=2))
    system.AddObject(CoordinateConstraint(markerNumbers=[still, turned], offsetUserFunction=lambda mbs, t, number, offset: t*step))
    system.Assemble()
    settings = exu.SimulationSettings()
    static = settings.staticSolver
    static.numberOfLoadSteps, static.loadStepDuration = few, float(few)
    static.adaptiveStep = False
    static.newton.relativeTolerance, static.newton.absoluteTolerance = 1e-10, 1e-12
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 0.0
    settings.show.statistics = False

    def solve():
        if not system.SolveStatic(settings, updateInitialValues=False):
            raise RuntimeError("Exudyn found no solution")
        tracks = {name: np.array(system.GetSensorStoredData(sensor)) for name, sensor in sensors.items()}
        # rows: load factor, x, y, z; the first is the start, the last the position after these
        return {name: track[-few - 1:-1, 1:3].T for name, track in tracks.items()}

    solve.version = exu.__version__
    return solve, few


def case_of(linkage, **positions):
    """The case of psalm, whose output is the last joint."""
    sys.path.insert(0, os.path.join(TOP, "python"))
    import psalm
    at = {name: tuple(float(x) for x in places[:, 0]) for name, places in closed_form(linkage, np.zeros(1)).items()}
    joints = {"O": (0.0, 0.0), **{name: at[name] for name in [*grounds_of(linkage), "A", *ORDER[linkage]]}}
    return psalm.from_joints(joints, links=LINKS[linkage], fixed=["O", *grounds_of(linkage)], drive="O",
                             output="point " + ORDER[linkage][-1], **positions)


def by_psalm(linkage, n):
    case, order = case_of(linkage, inputs=360.0/n*np.arange(n)), ORDER[linkage]
    import psalm

    def solve():
        motion = case.analyse()
        return {name: np.array([motion[name].x, motion[name].y]) for name in order}

    solve.version = psalm.version
    return solve, n


METHODS = {"psalm": (by_psalm, ()), "numpy-closed": (numpy_closed_form, ()), "numpy-newton": (numpy_newton, ()),
           "numba": (numba_closed_form, ()), "pylinkage": (by_pylinkage, (False,)), "pylinkage-numba": (by_pylinkage, (True,)),
           "fsolve": (scipy_one_by_one, ("fsolve",)), "root": (scipy_one_by_one, ("root",)), "exudyn": (by_exudyn, ())}


def error_of(found, linkage, n):
    """Largest distance of any joint from its place, by the crank's length."""
    few = next(iter(found.values())).shape[1]
    exact = closed_form(linkage, angles_of(n, np.longdouble)[:few], np.longdouble)
    return max(float(np.max(np.hypot(*(np.asarray(found[name], np.longdouble) - exact[name])))) for name in ORDER[linkage])/CRANK


def one(method, linkage, n, runs):
    if method == "pylinkage":
        sys.modules["numba"] = None     # so that it does without
    make, more = METHODS[method]
    solve, few = make(linkage, n, *more)
    found = solve()                     # compilers run, memory is taken
    error = error_of({name: found[name] for name in ORDER[linkage]}, linkage, n)
    del found
    began = time.process_time()
    solve()
    repeats = max(1, int(LEAST_TIMED/max(time.process_time() - began, 1e-7)))
    least = math.inf
    for _ in range(runs):
        began = time.process_time()
        for _ in range(repeats):
            solve()
        least = min(least, (time.process_time() - began)/repeats)
    print("%s|%.6g|%d|%.2e" % (getattr(solve, "version", ""), least*1e9/few/dyads_of(linkage), few, error))


ROWS = (("numba", "Numba {}, the closed form in a loop", "numba"), ("numpy-closed", "NumPy {}, the closed form on whole arrays", "numpy"),
        ("psalm", "psalm {}, `analyse` by Python: table of all joints", ""),
        ("pylinkage-numba", "pylinkage {}, `step_fast` with Numba", "pylinkage"), ("numpy-newton", "NumPy {}, Newton's method on whole arrays", "numpy"),
        ("pylinkage", "pylinkage {}, `step` without Numba", "pylinkage"), ("exudyn", "Exudyn {}, static steps", "exudyn"),
        ("fsolve", "SciPy {}, `fsolve` with Jacobian", "scipy"), ("root", "SciPy {}, `root` with Jacobian", "scipy"))


def version_of(package):
    from importlib import metadata
    try:
        return metadata.version(package) if package else ""
    except metadata.PackageNotFoundError:
        return None


def by_fortran(program, linkage, n, work):
    case, out = os.path.join(work, "case.nml"), os.path.join(work, "points")
    with open(case, "w", encoding="utf-8") as file:
        file.write(case_of(linkage, step=90).text)
    done = subprocess.run([program, case, str(n), out], capture_output=True, text=True, check=True)
    exact = closed_form(linkage, angles_of(n, np.longdouble), np.longdouble)[ORDER[linkage][-1]]
    error = float(np.max(np.hypot(*(np.fromfile(out).reshape(-1, 2).T.astype(np.longdouble) - exact))))/CRANK
    return float(done.stdout.split("|")[1]), n, error


def limits(program, work):
    """Nanoseconds and error of the yardstick with division and without, by linkage and positions."""
    listed = subprocess.run([program, "bench"], capture_output=True, text=True, check=True).stdout
    found = {}
    for kind in ("div", "one"):
        for linkage, title, variant in (("ten-bar", "program ten-bar", ""), ("four-bar", "fused four-bar", "4")):
            for n in SIZES:
                ns = float(re.search(r"%s +%s +N=%d +cache +[\d.]+ ns/dyad-pos \(min ([\d.]+)\)" % (title, kind, n), listed)[1])
                out = os.path.join(work, "points")
                subprocess.run([program, "dump", variant + kind, str(n), out], check=True)
                rows = np.fromfile(out).reshape(10, n)
                exact = closed_form(linkage, angles_of(n, np.longdouble), np.longdouble)
                # rows: A's dyads B1, B2, E, C3, D4; of the four-bar B1's direction from O1, then P
                pairs = (("B1", 0), ("B2", 2), ("E", 4), ("C3", 6), ("D4", 8)) if linkage == "ten-bar" else (("P", 4),)
                error = max(float(np.max(np.hypot(*(rows[k:k + 2].astype(np.longdouble) - exact[name])))) for name, k in pairs)/CRANK
                found[kind, linkage, n] = ns, n, error
    return found


def main(program, limit, short, why):
    runs = 1 if short else 5
    sizes = SIZES[:1] if short else SIZES
    rows, versions = [], {}
    with tempfile.TemporaryDirectory() as work:
        if limit:
            found = limits(limit, work)
            for kind, title in (("div", "C limit, `limit.c` \"div\""), ("one", "C limit without division, \"one\"")):
                rows.append((title, {(linkage, n): found[kind, linkage, n] for linkage in ORDER for n in sizes}))
        rows.append(("psalm, Fortran: all joints in blocks, the output", {(linkage, n): by_fortran(program, linkage, n, work)
                                                                         for linkage in ORDER for n in sizes}))
    for method, title, package in ROWS:
        version = version_of(package)
        if version is None:
            rows.append((title.format("").replace("  ", " ").replace(" ,", ",") + ": skipped, not installed", {}))
            continue
        cells = {}
        for linkage in ORDER:
            for n in sizes:
                done = subprocess.run([sys.executable, os.path.abspath(__file__), "one", method, linkage, str(n), str(runs)],
                                      capture_output=True, text=True, env=dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1"))
                if done.returncode != 0:
                    print("%s, %s, %d positions: %s" % (method, linkage, n, done.stderr[-400:]), file=sys.stderr)
                    continue
                versions[method], ns, few, error = done.stdout.splitlines()[-1].split("|")
                cells[linkage, n] = float(ns), int(few), float(error)
        if not cells and package:
            title += ": skipped, does not run"
        rows.append((title.format(version or versions.get(method, "")), cells))
    print("| method | positions | four-bar, ns | / limit | error | ten-bar, ns | / limit | error |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    for n in sizes:
        for title, cells in rows:
            if not cells:
                if n == sizes[0]:
                    print("| %s | | | | | | | |" % title)
                continue
            words = [title, "%d" % n]
            for linkage in ORDER:
                cell = cells.get((linkage, n))
                base = rows[0][1].get((linkage, n)) if limit else None
                if not cell:
                    words += ["-", "-", "-"]
                    continue
                words += ["%.3g%s" % (cell[0], "" if cell[1] == n else "*"), "%.3g" % (cell[0]/base[0]) if base else "-", "%.0e" % cell[2]]
            print("| %s |" % " | ".join(words))
    if why:
        with open(why, encoding="utf-8") as file:
            for line in file:
                print("\nNot installed: %s" % line.strip())
    return 0


if __name__ == "__main__":
    if sys.argv[1] == "one":
        one(sys.argv[2], sys.argv[3], int(sys.argv[4]), int(sys.argv[5]))
    else:
        sys.exit(main(sys.argv[1], "" if sys.argv[2] == "-" else sys.argv[2], "--short" in sys.argv,
                      sys.argv[sys.argv.index("--skipped") + 1] if "--skipped" in sys.argv else ""))
