"""Clearances of joints in the cheapest tolerances against a linkage whose joints have gaps.

usage: clearances.py PROGRAM_DIRECTORY. The gaps are put into the joints of a model of its own: unknown poses of all links, an equation for every
pin, slide, wheel pair and drive, solved by Newton's method. The differences of the outputs by the gap must be the effects that psalm finds
by virtual work; under a load the gap lies where the forces of this model press it, which it finds by the differences of the point that is
loaded. Costs and bands are compared with sums and samples made here. Last line: N passed, N failed.
"""
import csv
import os
import re
import subprocess
import sys
import tempfile

import numpy
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import tally

NEAR = 2e-6              # of the largest effect: differences by gaps of STEP lose so much
STEP = 1e-4              # of a length unit
TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


class Linkage:
    """Links, joints, slides and wheels as the sketch has them; `links` are lists of joints, the frame first."""

    def __init__(self, joints, links, drives, slides=(), gears=()):
        self.joints = {name: complex(*place) for name, place in joints.items()}
        self.links, self.drives, self.slides, self.gears = links, drives, slides, gears
        self.pins = [(joint, holders[0], other) for joint in self.joints
                     for holders in [[i for i, link in enumerate(links) if joint in link]] for other in holders[1:]]

    def place(self, pose, link, at):
        """A point of the drawing that moves with a link."""
        if link == 0:
            return at
        x, y, turn = pose[3*link - 3:3*link]
        return complex(x, y) + at*numpy.exp(1j*turn)

    def turn(self, pose, link):
        return 0.0 if link == 0 else pose[3*link - 1]

    def equations(self, pose, inputs, gaps):
        left = []
        for joint, first, second in self.pins:
            gap = gaps.get((joint, second), 0) - gaps.get((joint, first), 0)
            miss = self.place(pose, second, self.joints[joint]) - self.place(pose, first, self.joints[joint]) - gap
            left += [miss.real, miss.imag]
        for number, (first, second, at, angle) in enumerate(self.slides):
            normal = 1j*numpy.exp(1j*(numpy.radians(angle) + self.turn(pose, first)))
            away = self.place(pose, second, at) - self.place(pose, first, at)
            left += [(away*normal.conjugate()).real - gaps.get("S%d" % (number + 1), 0), self.turn(pose, second) - self.turn(pose, first)]
        for first, second, carrier, ratio in self.gears:
            left.append((self.turn(pose, first) - self.turn(pose, carrier))*ratio - (self.turn(pose, second) - self.turn(pose, carrier)))
        for (kind, base, link), value in zip(self.drives, inputs):
            if kind == "turn":
                left.append(self.turn(pose, link) - self.turn(pose, base) - numpy.radians(value))
            else:
                first, second, at, angle = self.slides[kind]
                along = numpy.exp(1j*(numpy.radians(angle) + self.turn(pose, first)))
                left.append(((self.place(pose, second, at) - self.place(pose, first, at))*along.conjugate()).real - value)
        return numpy.array(left)

    def solve(self, inputs, gaps, pose):
        for _ in range(40):
            left = self.equations(pose, inputs, gaps)
            slopes = numpy.empty((left.size, pose.size))
            for k in range(pose.size):
                aside = numpy.zeros(pose.size)
                aside[k] = 1e-6
                slopes[:, k] = (self.equations(pose + aside, inputs, gaps) - self.equations(pose - aside, inputs, gaps))/2e-6
            move = numpy.linalg.solve(slopes, left)
            pose = pose - move
            if abs(move).max() < 1e-12*(1 + abs(pose).max()):
                return pose
        raise ArithmeticError("no convergence")

    def follow(self, rows):
        """Poses at every row of inputs, from the drawing by small steps."""
        found, pose, before = [], numpy.zeros(3*len(self.links) - 3), numpy.zeros(len(self.drives))
        for row in rows:
            steps = max(1, int(numpy.ceil(abs(numpy.array(row) - before).max()/3)))
            for k in range(1, steps + 1):
                pose = self.solve(before + (numpy.array(row) - before)*k/steps, {}, pose)
            found.append(pose)
            before = numpy.array(row, float)
        return found

    def effects(self, rows, poses, gap, outputs):
        """Differences of all outputs by a gap along x and along y: shape (positions, numbers, 2)."""
        result = []
        for row, pose in zip(rows, poses):
            of_row = []
            for direction in ((1, 1j) if isinstance(gap, tuple) else (1,)):
                ends = [numpy.array(outputs(self, self.solve(row, {gap: sign*STEP*direction}, pose))) for sign in (1, -1)]
                of_row.append((ends[0] - ends[1])/(2*STEP))
            result.append(numpy.stack(of_row + [0*of_row[0]]*(2 - len(of_row)), axis=-1))
        return numpy.array(result)


def degrees(z):
    return numpy.degrees(numpy.angle(z))


def point(link, joint):
    return lambda m, p: [m.place(p, link, m.joints[joint]).real, m.place(p, link, m.joints[joint]).imag]


def angle(link):
    return lambda m, p: [numpy.degrees(m.turn(p, link))]


def distance(one, other):
    return lambda m, p: [abs(m.place(p, one[0], m.joints[one[1]]) - (m.place(p, other[0], m.joints[other[1]]) if other else 0))]


def travel(number):
    def value(m, p):
        first, second, at, turned = m.slides[number]
        along = numpy.exp(1j*(numpy.radians(turned) + m.turn(p, first)))
        return [((m.place(p, second, at) - m.place(p, first, at))*along.conjugate()).real]
    return value


def together(*outputs):
    return lambda m, p: numpy.concatenate([f(m, p) for f in outputs])


def sketch(m, names, drives, outputs, more=""):
    lines = ["A LINKAGE", " &CHAIN JNT=%s, JX=%s, JY=%s," % (",".join("'%s'" % j for j in m.joints), ",".join(repr(z.real) for z in m.joints.values()),
                                                          ",".join(repr(z.imag) for z in m.joints.values()))]
    lines.append("  LNAME=%s, LNK=%s" % (",".join("'%s'" % n for n in names), ",".join("'%s'" % " ".join(link) for link in m.links)))
    if m.slides:
        lines[-1] += ", SLNK=%s, SLNK2=%s, SLX=%s, SLY=%s, SLANG=%s" % (
            ",".join("'%s'" % names[s[0]] for s in m.slides), ",".join("'%s'" % names[s[1]] for s in m.slides),
            ",".join(repr(s[2].real) for s in m.slides), ",".join(repr(s[2].imag) for s in m.slides), ",".join(repr(s[3]) for s in m.slides))
    if m.gears:
        lines[-1] += ", GEARA=%s, GEARB=%s, GCARR=%s, GTA=%s, GTB=%s" % (
            *(",".join("'%s'" % names[g[k]] for g in m.gears) for k in range(3)),
            ",".join("%d" % (20*abs(g[3])) for g in m.gears), ",".join("20" for g in m.gears))
    lines[-1] += " &END"
    return "\n".join(lines + [" &DRIVES %s &END" % drives, " &OUTPUTS OUTPUT=%s &END" % outputs, " &LIMITS IPROOF=0 &END"]) + "\n" + more


def run(program, folder, text, *arguments):
    path = os.path.join(folder, "case.nml")
    for name in os.listdir(folder):
        if name.startswith("case."):
            os.remove(os.path.join(folder, name))
    with open(path, "w", encoding="utf-8") as f:
        f.write(text)
    done = subprocess.run([program, "--quiet", "--json", "--output-dir", folder, *arguments, path], capture_output=True, text=True, check=False)
    tables = {}
    for name in ("allocation", "allocation_bands", "clearances", "clearance_effects"):
        if os.path.exists(os.path.join(folder, "case.%s.csv" % name)):
            with open(os.path.join(folder, "case.%s.csv" % name), encoding="utf-8") as f:
                tables[name] = list(csv.DictReader(f))
    return done, tables


ANGLES = (0.0, 25.0, 70.0, 110.0)
METHOD = " &METHOD NDES=4, DELT=0.0,25.0,70.0,110.0 &END\n"


def linkages():
    """Name, model, rows of inputs, text of the sketch, gaps with their names, outputs."""
    bar = BAR
    yield ("four-bar", bar, [(a,) for a in ANGLES],
           sketch(bar, "fabc", "DRIVE='A'", "'point P','angle C D','distance B D','distance P','pose P B C','between A B B C','x P','y C'", METHOD),
           BAR_GAPS,
           together(point(2, "P"), angle(3), distance((1, "B"), (0, "D")), distance((2, "P"), None), point(2, "P"), angle(2),
                    lambda m, p: [degrees(numpy.exp(1j*(m.turn(p, 2) - m.turn(p, 1))))], lambda m, p: point(2, "P")(m, p)[:1],
                    lambda m, p: point(2, "C")(m, p)[1:]))
    press = Linkage({"A": (0, 0), "B": (0, 30), "C": (95, 82), "D": (120, 0), "E": (95.5, 80.36), "F": (230, 95)},
                    [["A", "D"], ["A", "B"], ["B", "C"], ["C", "D", "E"], ["E", "F"], ["F"]], [("turn", 0, 1)], [(0, 5, 230 + 95j, 10.0)])
    yield ("slider drive", press, [(a,) for a in ANGLES],
           sketch(press, ("f", "a", "b", "c", "d", "e"), "DRIVE='A'", "'slide S1','point E','angle E F'", METHOD),
           {"A": ("A", 1), "B": ("B", 2), "C": ("C", 3), "D": ("D", 3), "E": ("E", 4), "F": ("F", 5), "S1": "S1"},
           together(travel(0), point(3, "E"), angle(4)))
    # a group of a ternary link with three legs
    wide = Linkage({"A": (0, 0), "B": (10, 20), "C": (40, 45), "D": (95, 60), "E": (70, 85), "G": (120, 5), "H": (60, 140)},
                   [["A", "G", "H"], ["A", "B"], ["B", "C"], ["C", "D", "E"], ["D", "G"], ["E", "H"]], [("turn", 0, 1)])
    rows = [(a,) for a in (0.0, 5.0, -8.0)]
    yield ("larger group", wide, rows, sketch(wide, "fabcde", "DRIVE='A'", "'point E','angle C D'", " &METHOD NDES=3, DELT=0.0,5.0,-8.0 &END\n"),
           {"B": ("B", 2), "C": ("C", 3), "D": ("D", 4), "E": ("E", 5), "G": ("G", 4), "H": ("H", 5)}, together(point(3, "E"), angle(3)))
    # three links on one pin, a slide on a link that moves
    pins = Linkage({"A": (0, 0), "B": (20, 30), "C": (90, 60), "D": (110, 0), "E": (40, 120), "F": (70, 150)},
                   [["A", "D"], ["A", "B"], ["B", "C"], ["C", "D"], ["C", "E"], ["E", "F"]], [("turn", 0, 1)], [(3, 5, 70 + 150j, 80.0)])
    yield ("pin of three links", pins, [(a,) for a in (0.0, 10.0, 20.0)],
           sketch(pins, ("f", "a", "b", "c", "d", "e"), "DRIVE='A'", "'point F','angle C E','slide S1'", " &METHOD NDES=3, DELT=0.0,10.0,20.0 &END\n"),
           {"B": ("B", 2), "C c": ("C", 3), "C d": ("C", 4), "E": ("E", 5), "S1": "S1"},
           together(point(5, "F"), lambda m, p: [numpy.degrees(m.turn(p, 4))], travel(0)))
    # two drives, one of them along a slide
    five = Linkage({"A": (0, 0), "B": (3, 50), "C": (40, 90), "G": (85, 49)}, [["A"], ["A", "B"], ["B", "C"], ["C", "G"], ["G"]],
                   [("turn", 0, 1), (0, 0, 4)], [(0, 4, 85 + 49j, 0.0)])
    yield ("two drives", five, [(0.0, 0.0), (10.0, 4.0), (20.0, -5.0)],
           sketch(five, "fabcd", "DRIVE='A','S1', DELT2=0.0,4.0,-5.0", "'point C'", " &METHOD NDES=3, DELT=0.0,10.0,20.0 &END\n"),
           {"A": ("A", 1), "B": ("B", 2), "C": ("C", 3), "G": ("G", 4), "S1": "S1"}, point(2, "C"))
    geared = Linkage({"A": (0, 0), "B": (5, 30), "C": (50, 70), "E": (80, 0), "G": (85, 35)}, [["A", "E"], ["A", "B"], ["B", "C"], ["C", "G"], ["G", "E"]],
                     [("turn", 0, 1)], gears=[(1, 4, 0, -1.0)])
    yield ("wheels", geared, [(a,) for a in (0.0, 8.0, 16.0)],
           sketch(geared, "fabcd", "DRIVE='A'", "'point C'", " &METHOD NDES=3, DELT=0.0,8.0,16.0 &END\n"),
           {"B": ("B", 2), "C": ("C", 3), "G": ("G", 4)}, point(2, "C"))


def by_differences(program, folder):
    for name, model, rows, text, gaps, outputs in linkages():
        done, tables = run(program, folder, text + " &ALLOC ALBAND=1.0, ALOUT=@, PNAME=%s &END\n".replace("ALOUT=@, ", "") %
                           ",".join("'%s'" % g for g in gaps))
        numbers = []
        for row in tables.get("clearance_effects", []):
            if row["number"] not in numbers:
                numbers.append(row["number"])
        tally.check("%s: effects are listed" % name, done.returncode == 0 and numbers, (done.stdout, done.stderr))
        if not numbers:
            continue
        # all numbers of all outputs, not of the first alone
        everything = [n for n in re.findall(r"'([^']*)'", re.search("OUTPUT=(.*) &END", text).group(1))]
        done, tables = run(program, folder, text + " &ALLOC ALBAND=1.0, ALOUT=%s, PNAME=%s &END\n" %
                           (",".join("'%s'" % c for c in columns(everything)), ",".join("'%s'" % g for g in gaps)))
        tally.check("%s: effects on all outputs are listed" % name, done.returncode == 0 and "clearance_effects" in tables, (done.stdout, done.stderr))
        if "clearance_effects" not in tables:
            continue
        poses = model.follow(rows)
        for gap, at in gaps.items():
            expected = model.effects(rows, poses, at, outputs)
            found = numpy.array([[[float(r["by_x"]), float(r["by_y"])] for r in tables["clearance_effects"]
                                  if r["dimension"] == "play " + gap and r["number"] == c] for c in columns(everything)]).transpose(1, 0, 2)
            if found.shape != expected.shape:
                tally.check("%s: %s" % (name, gap), False, (found.shape, expected.shape))
                continue
            # the sense of a gap, second link against first or the other way, and of a line, is the listing's
            sense = numpy.sign((found*expected).sum()) or 1.0
            worst = abs(sense*found - expected).max(axis=(0, 2))/numpy.maximum(abs(expected).max(axis=(0, 2)), 1e-9*abs(expected).max() + 1e-30)
            tally.check("%s: effects of a gap in %s" % (name, gap), abs(sense*found - expected).max() <= NEAR*max(abs(expected).max(), 1e-3), worst)


BAR = Linkage({"A": (0, 0), "B": (18, 22), "C": (88, 71), "D": (95, -4), "P": (60, 80)}, [["A", "D"], ["A", "B"], ["B", "C", "P"], ["C", "D"]],
              [("turn", 0, 1)])
BAR_GAPS = {"A": ("A", 1), "B": ("B", 2), "C": ("C", 3), "D": ("D", 3)}
LOAD = numpy.array((100.0, 20.0))
LOADED = " &LOADS LNAME='b P', LFX=100.0, LFY=20.0 &END\n"


def by_loops(program, folder):
    """The four-bar by &LINKS: joints are ends of arcs."""
    text = sketch(BAR, "fabc", "DRIVE='A'", "'point P'", METHOD)
    run(program, folder, text, "--links")
    with open(os.path.join(folder, "case.dev7"), encoding="utf-8") as f:
        links = f.read()
    for loaded in ("", ", PLOAD=0,1,1,0"):
        more = LOADED if loaded else ""
        rest = " &ALLOC ALBAND=0.5, %s" + loaded + ", ALNAM='play *', ALCOST=3.0 &END\n"
        _, one = run(program, folder, text + more + rest % "PNAME='A','B','C','D'")
        load = more.replace("LNAME='b P'", "LLINK=-2, LLOOP=1, LDIST=%r, LANG=%r" % (
            abs(BAR.joints["P"] - BAR.joints["B"]), float(degrees((BAR.joints["P"] - BAR.joints["B"])/(BAR.joints["C"] - BAR.joints["B"])))))
        done, other = run(program, folder, links + load + rest % "PLINK=-1,1,2,-4, PLOOP=1,1,1,1")
        found = [[(float(r["by_x"]), float(r["by_y"]), float(r["by_clearance"])) for r in t.get("clearance_effects", [])] for t in (one, other)]
        tally.check("loops%s: names of joints" % loaded, len({r["dimension"] for r in other.get("clearances", [])}) == 4, (done.stderr, other.keys()))
        tally.check("loops%s: effects as those of the sketch" % loaded, len(found[0]) == 32 and numpy.shape(found[0]) == numpy.shape(found[1]) and
                    numpy.abs(numpy.abs(found[0]) - numpy.abs(found[1])).max() < 1e-9, (done.stderr, found))
        costs = [sum(float(r["cost"]) for r in t.get("allocation", [])) for t in (one, other)]
        plays = [[float(r["tolerance"]) for r in t.get("allocation", []) if r["dimension"].startswith("play")] for t in (one, other)]
        tally.check("loops%s: four clearances" % loaded, [len(p) for p in plays] == [4, 4] and min(costs) > 0, (plays, costs))


def pose_by_loops(program, folder):
    """A pose has three numbers, by a sketch and by &LINKS."""
    text = sketch(BAR, "fabc", "DRIVE='A'", "'pose P B C'", METHOD)
    run(program, folder, text, "--links")
    with open(os.path.join(folder, "case.dev7"), encoding="utf-8") as f:
        links = f.read().replace("MOTION=0", "MOTION=4")
    rest = " &ALLOC ALBAND=0.5, %s &END\n"
    found = [[(float(r["by_x"]), float(r["by_y"])) for r in run(program, folder, t + rest % p)[1].get("clearance_effects", [])]
             for t, p in ((text, "PNAME='B'"), (links, "PLINK=1, PLOOP=1"))]
    tally.check("pose: all numbers have bands, and the same effects", len(found[0]) == 12 and numpy.shape(found[0]) == numpy.shape(found[1]) and
                numpy.abs(numpy.abs(found[0]) - numpy.abs(found[1])).max() < 1e-9, found)


def under_load(program, folder):
    """The gap of a joint lies where the load presses it: the output moves as far as the linkage whose joint has that gap."""
    text = sketch(BAR, "fabc", "DRIVE='A'", "'point P'", METHOD) + LOADED
    rows = [(a,) for a in ANGLES]
    poses = BAR.follow(rows)
    done, tables = run(program, folder, text + " &ALLOC ALBAND=0.5, PNAME='A','B','C','D', PLOAD=1,1,1,1 &END\n")
    tally.check("under load: done", done.returncode == 0 and "clearance_effects" in tables, done.stderr)
    if "clearance_effects" not in tables:
        return
    for gap, at in BAR_GAPS.items():
        effects = BAR.effects(rows, poses, at, point(2, "P"))
        pressed = numpy.einsum("n,pnc->pc", LOAD, effects)          # the work of the load by the gap
        amount = numpy.hypot(*pressed.T)
        table = [r for r in tables["clearances"] if r["dimension"] == "play " + gap][0]
        turned = (pressed[1:]*pressed[:-1]).sum(axis=1).min() <= 0
        tally.check("load of %s" % gap, numpy.allclose((float(table["least_load"]), float(table["largest_load"])), (amount.min(), amount.max()), rtol=1e-6),
                    (table, amount))
        tally.check("load of %s presses to one side, or is listed" % gap, (table["gap"] == "anywhere") == turned and
                    turned == ("play %s: the load turns over" % gap in done.stderr), (table, turned, done.stderr))
        if turned:
            continue
        size = 0.01
        direct = []
        for row, pose, side in zip(rows, poses, pressed/amount[:, None]):
            there, nominal = (numpy.array(point(2, "P")(BAR, p)) for p in (BAR.solve(row, {at: size*complex(*side)}, pose), pose))
            direct.append((there - nominal)/size)
        found = numpy.array([[float(r["by_clearance"]) for r in tables["clearance_effects"] if r["dimension"] == "play " + gap and r["number"] == c]
                             for c in ("point_P.x", "point_P.y")]).T
        tally.check("the gap in %s moves the output as the load presses" % gap, abs(found - numpy.array(direct)).max() < 2e-3*abs(found).max(), (found, direct))


def read_problem(tables):
    """Changes of the bands by tolerances of 1 cannot be read of dimensions: only clearances are allotted here."""
    plays = [r["dimension"] for r in tables["clearances"]]
    bands = [(r["number"], r["position"]) for r in tables["allocation_bands"]]
    of = {(r["dimension"], r["number"], r["position"]): float(r["by_clearance"]) for r in tables["clearance_effects"]}
    return numpy.array([[of[(p, *b)] for p in plays] for b in bands])


def allotted(program, folder):
    """Clearances alone, of fixed dimensions: the cost against SciPy, widths and shares against sums and samples."""
    from scipy.optimize import minimize
    text = sketch(BAR, "fabc", "DRIVE='A'", "'point P'", METHOD) + LOADED + " &TOLER TOLLEN=0.0, TOLANG=0.0, TOLCRK=1E-9 &END\n"
    random = numpy.random.default_rng(5)
    for rule, law in (("WORST", "UNIFORM"), ("RSS", "UNIFORM"), ("YIELD", "UNIFORM"), ("YIELD", "TRIANGLE"), ("YIELD", "NORMAL")):
        for loaded in ((0, 0, 0, 0), (0, 1, 1, 0)):
            name = "%s, %s, PLOAD %s" % (rule, law, loaded)
            more = "" if rule != "YIELD" else ", ALYLD=95.0, ALLAW='%s', ALTRY=40000" % law
            done, tables = run(program, folder, text + " &ALLOC ALBAND=0.1, ALRULE='%s'%s, PNAME='A','B','C','D', PLOAD=%d,%d,%d,%d, "
                               "ALNAM='*','play *','play C', ALCOST=1E-9,1.0,2.0, ALMAX=1E-9,10.0,10.0 &END\n" % (rule, more, *loaded))
            tally.check(name + ": done", done.returncode == 0 and "clearance_effects" in tables, done.stderr)
            if "clearance_effects" not in tables:
                continue
            change = read_problem(tables)
            plays = [r for r in tables["allocation"] if r["dimension"].startswith("play")]
            size = numpy.array([float(r["tolerance"]) for r in plays])
            cost = numpy.array([1.0, 1.0, 2.0, 1.0])
            leans = numpy.array([r["gap"] == "on the side of the load" for r in tables["clearances"]])
            used = numpy.array([float(r["used"]) for r in tables["allocation_bands"]])
            share = numpy.array([float(r["share_within"]) for r in tables["allocation_bands"]])
            tally.check(name + ": two joints lie on the side of their load", leans.sum() == sum(loaded), leans)

            def far(c):
                effect = change*c
                shift = abs((effect*leans).sum(axis=1)/2)
                rest = numpy.where(leans, effect/2, effect)
                if rule == "WORST":
                    return shift + abs(rest).sum(axis=1)
                counted = rest*numpy.where(leans, 1, 3**0.5/2)
                return shift + numpy.sqrt((counted**2).sum(axis=1))
            if rule != "YIELD":
                tally.check(name + ": widths", abs(far(size) - used).max() < 1e-6*used.max(), (far(size), used))
                best = min((found.fun for start in range(8) for found in [minimize(
                    lambda y: (cost/numpy.exp(y)).sum(), numpy.log(0.02*random.random(4) + 0.005), method="SLSQP", bounds=[(-9, numpy.log(10.0))]*4,
                    constraints={"type": "ineq", "fun": lambda y: 1 - far(numpy.exp(y))/0.1}, options={"maxiter": 400, "ftol": 1e-13})]
                    if far(numpy.exp(found.x)).max() < 0.1*(1 + 1e-8)), default=numpy.inf)
                total = (cost/size).sum()
                tally.check(name + ": SciPy finds none that cost less", total < best*(1 + 1e-6), (total, best))
                continue
            drawn = 200000
            if law == "NORMAL":
                pins = random.normal(size=(drawn, 4, 2))/2
                along = 0.5 + random.normal(size=(drawn, 4))/6
            else:
                pins = numpy.sqrt(random.random((drawn, 4, 1)))*numpy.stack([f(2*numpy.pi*random.random((drawn, 4))) for f in (numpy.cos, numpy.sin)], -1)
                along = random.random((drawn, 4)) if law == "UNIFORM" else (random.random((drawn, 4)) + random.random((drawn, 4)))/2
            within = ((abs(numpy.where(leans, along, pins[..., 0])*size @ change.T)) <= 0.1).mean(axis=0)
            error = numpy.sqrt(0.95*0.05/drawn)
            tally.check(name + ": shares of a sample", abs(within - share).max() < 4.5*error, (within - share)/error)
            tally.check(name + ": no share is below", share.min() >= 0.95 - 1e-6 and (any(loaded) or share.min() < 0.95 + 1e-6), share)


def drawn(programs, folder):
    """The layer TOLERANCES of a drawing: a text for every dimension, at its place, rounded down."""
    import ezdxf
    for case in ("pin_clearances", "cheapest_tolerances"):
        path = os.path.join(TOP, "data", case + ".nml")
        done = [subprocess.run([os.path.join(programs, p), "--quiet", *options, "--output-dir", folder, path], capture_output=True, text=True, check=False)
                for p, options in (("balm", ()), ("psalm", ("--json",)))]
        tally.check("%s: drawn" % case, done[0].returncode == 0, done[0].stderr)
        with open(os.path.join(folder, case + ".allocation.csv"), encoding="utf-8") as f:
            rows = list(csv.DictReader(f))
        texts = [(e.dxf.text, complex(at.x, at.y)) for e in ezdxf.readfile(os.path.join(folder, case + ".dxf")).modelspace() if e.dxf.layer == "TOLERANCES"
                 for at in [e.dxf.align_point if e.dxf.hasattr("align_point") else e.dxf.insert]]
        tally.check("%s: a text for every dimension" % case, len(texts) == len(rows), (texts, len(rows)))
        with open(path, encoding="utf-8") as f:
            text = f.read()
        names = re.findall("'([^']*)'", re.search(r"JNT=(.*?) JX", text).group(1))
        joint = {n: complex(float(x), float(y)) for n, x, y in zip(names, *(re.search(k + "=(.*?), *[J\n]", text, re.S).group(1).split(",") for k in ("JX", "JY")))}
        left, at_joint = list(texts), {}
        for row in rows:
            words = row["dimension"].split()
            size = float(row["tolerance"])
            sign = "R " if words[0] == "play" and words[1] in joint else "%%p"
            named = [t for t in left for n in [re.search(re.escape(sign) + r"([0-9.Ee+-]+)(?:%%d)?$", t[0])]
                     if n and 0 <= size - float(n.group(1)) < 1.001*10**(numpy.floor(numpy.log10(size)) - 2)]
            tally.check("%s: %s is drawn" % (case, row["dimension"]), named, (row, left))
            if not named:
                continue
            left.remove(named[0])
            if words[0] == "play" and words[1] in joint:
                at_joint[words[1]] = [at for _, at in named]
            elif case == "cheapest_tolerances" and words[0] == "length" and all(w in joint for w in words[1:]):
                middle = (joint[words[1]] + joint[words[2]])/2
                tally.check("%s: %s is at its line" % (case, row["dimension"]), any(abs(at - middle) < 25 for _, at in named), (named, middle))
        # the drawing is at the first position: links keep the distances of their joints
        for one, other in (("B", "C"), ("E", "F")):
            if one in at_joint and other in at_joint:
                away = [abs(abs(a - b) - abs(joint[one] - joint[other])) for a in at_joint[one] for b in at_joint[other]]
                tally.check("%s: clearances are at their joints %s, %s" % (case, one, other), min(away) < 0.01, away)


def drawn_by_loops(programs, folder):
    """Of a linkage of loops a length stands at the middle of its arc."""
    import ezdxf
    lengths = {30.0: 15.0, 90.0: 45.0}
    with open(os.path.join(folder, "arcs.nml"), "w", encoding="ascii") as f:
        f.write("ARCS\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=30.0,80.0,70.0,90.0, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END\n"
                " &METHOD MOTION=1, NDES=3, DELT=0.0,30.0,60.0 &END\n &ALLOC ALBAND=0.5 &END\n")
    done = subprocess.run([os.path.join(programs, "balm"), "--quiet", "arcs.nml"], cwd=folder, capture_output=True, text=True, check=False)
    texts = {float(e.dxf.text.split()[0]): e.dxf.align_point if e.dxf.hasattr("align_point") else e.dxf.insert
             for e in ezdxf.readfile(os.path.join(folder, "arcs.dxf")).modelspace() if e.dxf.layer == "TOLERANCES"}
    tally.check("by loops: lengths stand at their arcs", len(texts) == 4 and all(abs(texts[v].x - x) < 1.0 and abs(texts[v].y) < 3.0 for v, x in lengths.items()),
                (texts, done.stderr))


def refused(program, folder):
    text = sketch(BAR, "fabc", "DRIVE='A'", "'point P'", METHOD)
    for items, words in (("PNAME='P'", "point of one link"), ("PNAME='X'", "no joint or slide is called 'X'"), ("PNAME='B', PLOAD=1", "the case has no forces"),
                         ("PNAME='B', ALPROF='CHECK'", "without clearances"), ("PNAME='B', ALNAM='play B', ALGRAD=8", "ISO 286"),
                         ("PNAME='B', ALNAM='play B','length A B', ALGRP=1,1", "in no group"), ("PNAME='B','B'", "already"),
                         ("PNAME='B', ALNAM='play C'", "'play B'"), ("PLINK=1, PLOOP=1", "counts arcs")):
        done, _ = run(program, folder, text + " &ALLOC ALBAND=0.5, %s &END\n" % items)
        tally.check("refused: " + items, done.returncode == 2 and words in done.stderr, (done.returncode, done.stderr))
    pins = [l for l in linkages() if l[0] == "pin of three links"][0]
    done, _ = run(program, folder, pins[3] + " &ALLOC ALBAND=0.5, PNAME='C' &END\n")
    tally.check("refused: a pin of three links by its name alone", done.returncode == 2 and "name the one that turns" in done.stderr, done.stderr)


def columns(outputs):
    """Names of the numbers of outputs as tables have them."""
    names = []
    for output in outputs:
        kind = output.split(" ")[0]
        plain = output.replace(" ", "_")
        names += [plain + "." + c for c in {"point": "xy", "pose": ("x", "y", "angle")}[kind]] if kind in ("point", "pose") else [plain]
    return names


def main():
    program = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
    with tempfile.TemporaryDirectory() as folder:
        by_differences(program, folder)
        by_loops(program, folder)
        pose_by_loops(program, folder)
        under_load(program, folder)
        allotted(program, folder)
        refused(program, folder)
        drawn(os.path.abspath(sys.argv[1]), folder)
        drawn_by_loops(os.path.abspath(sys.argv[1]), folder)
    return tally.report()


sys.exit(main())
