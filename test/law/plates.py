#!/usr/bin/env python3
"""Links cut from plate: their masses against integrals over the outlines that the script for FreeCAD makes, against the same masses
entered by hand, in sketches and in loops, and in the model for MuJoCo.

usage: plates.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import csv
import math
import os
import random
import re
import subprocess
import sys
import tempfile
import types

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
FOLDER = tempfile.mkdtemp()
STEEL = 7850.0


def run(program, text, *options, name="case"):
    """Exit status, what was said, and the rows of the tables that --json writes."""
    path = os.path.join(FOLDER, name + ".nml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([os.path.join(BIN, program), *options, path], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


def table(program, block="", name="case"):
    path = os.path.join(FOLDER, "%s.%s%s.csv" % (name, program, "." + block if block else ""))
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def forces(text, name="case"):
    status, said = run("kalm", text, "--json", name=name)
    check("the case runs", status == 0, said[-300:])
    return [{key: float(value) for key, value in row.items() if value} for row in table("kalm", name=name)]


def content(ending, name="case"):
    with open(os.path.join(FOLDER, name + ending), encoding="utf-8") as file:
        return file.read()


class Vector:
    def __init__(self, x=0.0, y=0.0, z=0.0):
        self.x, self.y, self.z = x, y, z

    def __add__(self, other):
        return Vector(self.x + other.x, self.y + other.y, self.z + other.z)

    def __mul__(self, factor):
        return Vector(self.x * factor, self.y * factor, self.z * factor)


class Edge:
    """What a stand-in for Part makes: a list of points on the edge, so fine as asked."""

    def __init__(self, points_of):
        self.points_of = points_of

    def toShape(self):
        return self


def line(start, end):
    return Edge(lambda n: [(start.x, start.y)])


def arc(start, middle, end):
    """Through three points, as FreeCAD has it: from the circle about where the two perpendicular bisectors meet."""
    ax, ay, bx, by = middle.x - start.x, middle.y - start.y, end.x - start.x, end.y - start.y
    twice = 2 * (ax * by - ay * bx)
    cx = start.x + (by * (ax * ax + ay * ay) - ay * (bx * bx + by * by)) / twice
    cy = start.y + (ax * (bx * bx + by * by) - bx * (ax * ax + ay * ay)) / twice
    from_angle = math.atan2(start.y - cy, start.x - cx)
    turn = (math.atan2(end.y - cy, end.x - cx) - from_angle) % (2 * math.pi)
    radius = math.hypot(start.x - cx, start.y - cy)
    return Edge(lambda n: [(cx + radius * math.cos(from_angle + turn * k / n), cy + radius * math.sin(from_angle + turn * k / n))
                           for k in range(n)])


def circle(centre, normal, radius):
    return Edge(lambda n: [(centre.x + radius * math.cos(2 * math.pi * k / n), centre.y + radius * math.sin(2 * math.pi * k / n))
                           for k in range(n)])


def solids(script):
    """The links that the script makes in a stand-in for FreeCAD: name -> (wires, thickness, place)."""
    made = {}

    class Face:
        def __init__(self, wires):
            self.wires = wires

        def extrude(self, way):
            return self.wires, way.z

    class Part:
        pass

    class Document:
        def addObject(self, kind, name):
            self.last = Part()
            made[len(made)] = self.last
            return self.last

        def recompute(self):
            pass

        def saveAs(self, path):
            check("the document has the name of the case", path.endswith("case.FCStd"), path)

    freecad = types.ModuleType("FreeCAD")
    freecad.Vector, freecad.newDocument = Vector, lambda name: Document()
    freecad.Placement, freecad.Rotation = lambda place, turn: place, lambda: None
    part = types.ModuleType("Part")
    part.LineSegment, part.Arc, part.Circle = line, arc, circle
    part.Wire, part.makeFace = lambda edges: edges, lambda wires, kind: Face(wires)
    part.export = lambda parts, path: check("the STEP file has the name of the case", path.endswith("case.step"), path)
    sys.modules["FreeCAD"], sys.modules["Part"] = freecad, part
    exec(compile(script, "script", "exec"), {"__file__": os.path.join(FOLDER, "case.freecad.py"), "__name__": "__main__"})
    return {one.Label: (*one.Shape, one.Placement) for one in made.values()}


def polygon(points):
    """Area, first moments and polar second moment about the origin."""
    sums = [0.0] * 4
    for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1]):
        cross = ax * by - ay * bx
        sums[0] += cross / 2
        sums[1] += cross * (ax + bx) / 6
        sums[2] += cross * (ay + by) / 6
        sums[3] += cross * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by) / 12
    return sums


def integrals(wires, n=64):
    """Of the outer wire less the holes; inscribed polygons with n, 2n, 4n sides an arc, extrapolated: errors go with n^2, n^4."""
    rows = []
    for sides in (n, 2 * n, 4 * n, 8 * n):
        total = [0.0] * 4
        for k, wire in enumerate(wires):
            values = polygon([point for edge in wire for point in edge.points_of(sides)])
            sign = 1 if k == 0 else -1
            total = [a + sign * b for a, b in zip(total, values)]
        rows.append(total)
    power = 4
    while len(rows) > 1:
        rows = [[(power * fine - coarse) / (power - 1) for coarse, fine in zip(a, b)] for a, b in zip(rows, rows[1:])]
        power *= 4
    return rows[0]


def sketch(draw, extra=0):
    """A crank-rocker with a coupler of 2 + extra points, and its plates."""
    points = {"A": (0.0, 0.0), "B": (0.0, 30.0), "C": (60.0 + 20 * draw.random(), 70 + 20 * draw.random()), "D": (90.0, -10 * draw.random())}
    for k in range(extra):
        points["P%d" % k] = (80 * draw.random() - 10, 60 + 60 * draw.random())
    coupler = ["B", "C"] + ["P%d" % k for k in range(extra)]
    draw.shuffle(coupler)
    names = list(points)
    return points, coupler, """PLATES
 &CHAIN JNT=%s, JX=%s, JY=%s,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','%s','C D' &END
 &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END
 &OUTPUTS OUTPUT='angle rocker' &END
 &METHOD IKIN=30 &END
 &RATES SPEED=20.0, ACCEL=3.0 &END
""" % (",".join("'%s'" % n for n in names), ",".join(repr(points[n][0]) for n in names), ",".join(repr(points[n][1]) for n in names),
       " ".join(coupler))


def near(values, others, part, what):
    for a, b in zip(values, others):
        check(what, abs(a - b) <= part * max(abs(a), abs(b), 1e-30), "%r %r" % (a, b))


def shapes():
    """Masses against integrals over outlines, forces against the same masses in &MASSES, model for MuJoCo."""
    draw = random.Random(7)
    for extra in (0, 1, 2, 3):
        points, coupler, text = sketch(draw, extra)
        thick, width = 2 + 6 * draw.random(), 6 + 10 * draw.random()
        plates = " &PLATES PTHICK=%r, PWIDTH=%r, PHOLE=%r, PDENS=2700.0 &END\n" % (thick, width, width * .4)
        with_plates = forces(text + " &MASSES UNITL=0.001, GRAVY=-9.81 &END\n" + plates)
        rows = table("kalm", "plates")
        check("all moving links are plates", [row["link"] for row in rows] == ["crank", "coupler", "rocker"], str(rows))
        run("balm", text + " &MASSES UNITL=0.001 &END\n" + plates, "--freecad", "--mjcf")
        made = solids(content(".freecad.py"))
        model = content(".mjcf.xml")
        inertial = dict(re.findall(r'<body name="(\w+)" pos="[^"]*">\s*<inertial [^>]*?mass="([^"]*)"', model))
        links = {"crank": ["A", "B"], "coupler": coupler, "rocker": ["C", "D"]}
        for row in rows:
            wires, height, place = made[row["link"]]
            area, sx, sy, polar = integrals(wires)
            mass = 2700.0 * area * height * 1e-9
            check("holes at the joints", len(wires) == 3, len(wires))
            near([float(row["mass"])], [mass], 1e-11, "mass of %s" % row["link"])
            near([float(row["inertia"])], [2700.0 * height * 1e-15 * (polar - (sx * sx + sy * sy) / area)], 1e-10, "inertia")
            near([float(inertial[row["link"]])], [mass], 1e-11, "mass in the model for MuJoCo")
            joints = links[row["link"]]
            along = math.atan2(points[joints[1]][1] - points[joints[0]][1], points[joints[1]][0] - points[joints[0]][0])
            turned = along + math.radians(float(row["angle"]))
            at = [points[joints[0]][0] + float(row["distance"]) * math.cos(turned), points[joints[0]][1] + float(row["distance"]) * math.sin(turned)]
            check("centre of mass", math.hypot(place.x + sx / area - at[0], place.y + sy / area - at[1]) <= 1e-10 * 100.0, str(at))
            check("thickness", abs(height - thick) < 1e-12 * thick)
        layers = {name: one[2].z for name, one in made.items()}
        check("links that share a joint lie in different layers", layers["crank"] != layers["coupler"] != layers["rocker"], str(layers))
        entries = " &MASSES UNITL=0.001, GRAVY=-9.81, MNAME=%s, MASS=%s, MDIST=%s, MANG=%s, MINERT=%s &END\n" % (
            ",".join("'%s'" % row["link"] for row in rows), *(",".join(row[item] for row in rows) for item in ("mass", "distance", "angle", "inertia")))
        by_hand = forces(text + entries)
        size = max(abs(row["frame_fx"]) + abs(row["frame_fy"]) for row in by_hand)
        check("forces as with masses entered by hand",
              all(abs(a[key] - b[key]) <= 1e-11 * size for a, b in zip(with_plates, by_hand) for key in ("drive", "frame_fx", "frame_fy", "C_fx", "C_fy")))


def loops():
    """The same plates by loops: arcs in place of names."""
    text = sketch(random.Random(3))[2]
    run("psalm", text, "--links")
    by_loops = content(".dev7")
    plates = " &MASSES UNITL=0.001 &END\n &PLATES %sPTHICK=4.0, PWIDTH=12.0, PHOLE=5.0 &END\n"
    drawn = forces(text + plates % "")
    of_loops = forces(by_loops + "\n" + plates % "", name="loops")
    keys = ("drive", "frame_fx", "frame_fy", "kinetic")
    size = {key: max(abs(row[key]) for row in drawn) for key in keys}
    check("loops as the sketch", all(abs(a[key] - b[key]) <= 1e-11 * size[key] for a, b in zip(drawn, of_loops) for key in keys))
    one = forces(text + plates % "PNAME='rocker', ")
    one_loop = forces(by_loops + "\n" + plates % "PLINK=3, PLOOP=1, ", name="loops")
    check("a single link", all(abs(a[key] - b[key]) <= 1e-11 * size[key] for a, b in zip(one, one_loop) for key in keys))
    check("and no more", len(table("kalm", "plates")) == 1 and len(table("kalm", "plates", "loops")) == 1)
    other = forces(text.replace("'angle rocker'", "'point C','angle rocker'") + plates % "")
    check("outputs do not change the forces", all(a[key] == b[key] for a, b in zip(drawn, other) for key in keys))
    # two plates on one link by two arcs of it, and a mass beside the plate
    status, said = run("kalm", by_loops + "\n" + plates % "PLINK=2,-2, PLOOP=1,1, ", name="loops")
    check("a link that stands twice is refused", status == 2 and "stands twice" in said, said)
    both = forces(text + " &MASSES UNITL=0.001, MNAME='rocker D', MASS=0.2 &END\n" + (plates % "").split("\n")[1] + "\n")
    check("a mass on a fixed pivot adds nothing", all(abs(a["drive"] - b["drive"]) <= 1e-11 * size["drive"] for a, b in zip(both, drawn)))


def without_mark(text):
    return re.sub(r"run [0-9A-F]{16}", "", text)


def drawing():
    """The drawing has the widths and the holes of the plates; &DXF comes first."""
    text = sketch(random.Random(5), 1)[2] + " &MASSES UNITL=0.001 &END\n &PLATES PTHICK=4.0, PWIDTH=12.0, PHOLE=5.0 &END\n"
    run("balm", text)
    plain = without_mark(content(".dxf"))
    run("balm", text.replace("&PLATES", "&DXF WIDTH=12.0, PIN=5.0 &END\n &PLATES"))
    check("widths and holes as by &DXF", plain == without_mark(content(".dxf")))
    run("balm", text.replace("&PLATES", "&DXF WIDTH=14.0 &END\n &PLATES"))
    check("&DXF comes first", plain != without_mark(content(".dxf")))
    status, said = run("balm", sketch(random.Random(5))[2], "--freecad")
    check("without plates there are no solids", status == 2 and "&PLATES" in said, said)
    check("nor words about masses", "mass" not in said and "UNITL" not in said, said)


def faults():
    """Wrong input, and programs that have no use for it."""
    text = sketch(random.Random(5), 1)[2] + " &MASSES UNITL=0.001 &END\n &PLATES %s &END\n"
    for items, words in (("PTHICK=0.0, PWIDTH=9.0", "a thickness is above 0"), ("PWIDTH=9.0", "PTHICK"), ("PTHICK=4.0", "give its width"),
                         ("PTHICK=4.0, PWIDTH=9.0, PHOLE=9.0", "smaller than the width"), ("PTHICK=4.0, PWIDTH=-1.0", "not negative"),
                         ("PNAME='frame', PTHICK=4.0, PWIDTH=9.0", "is the frame"), ("PNAME='rod', PTHICK=4.0, PWIDTH=9.0", "no link is called"),
                         ("PNAME='crank A', PTHICK=4.0, PWIDTH=9.0", "leave the joints out"),
                         ("PNAME='crank','crank', PTHICK=4.0, PWIDTH=9.0", "stands twice"), ("PLINK=2, PLOOP=1, PTHICK=4.0", "names"),
                         ("PTHICK=4.0,5.0, PWIDTH=9.0", "too many"), ("PTHICK=4.0, PWIDTH=90.0, PHOLE=40.0", "meet"),
                         ("NPLATE=2, PTHICK=4.0, PWIDTH=9.0", "need the names"), ("PTHICK=4.0, PWIDTH=1.0E200", "too small or too large"),
                         ("PTHICK=1.0E-200, PWIDTH=9.0, PDENS=1.0E-200", "too small or too large"),
                         ("PTHICK=4.0, PWIDTH=1.0E-200", "too small or too large"), ("PTHICK=1.0E26, PWIDTH=9.0", "too small or too large")):
        status, said = run("kalm", text % items)
        check("refused: " + items, status == 2 and words in said and "&PLATES" in said, said)
    alone = re.sub(" &(RATES|MASSES).*", "", text) % "PTHICK=4.0, PWIDTH=9.0"
    status, said = run("kalm", alone)
    check("a missing speed is said of the group that is there", status == 0 and "&PLATES PTHICK: there is no group &RATES" in said, said)
    good = text % "PTHICK=4.0, PWIDTH=9.0"
    for program, more in (("psalm", ""), ("muscle", " &BALANC WREACH=500.0 &END\n"), ("balm", "")):
        status, said = run(program, good + more)
        check(program + " reads it", status == 0 and "PLATES:" not in said, said)
    status, said = run("muscle", good + " &BALANC WREACH=500.0 &END\n")
    check("muscle writes the plates with the weights", "&PLATES" in content(".muscle.dev7"), said)
    status, said = run("psalm", good, "--links")
    check("plates with a point of their own stay with the sketch", "&PLATES" not in content(".dev7") and "&MASSES" in content(".dev7") and
          "without &PLATES" in said, said)
    named = sketch(random.Random(5))[2] + " &MASSES UNITL=0.001, MNAME='crank', MASS=1.0 &END\n &PLATES PTHICK=4.0, PWIDTH=9.0 &END\n &SPRING ANAME='frame A', " \
        "BNAME='rocker C', STIFF=5.0 &END\n"
    status, said = run("psalm", named, "--links")
    check("loops of a sketch leave out what names its links", all("&" + group not in content(".dev7") for group in ("PLATES", "MASSES", "SPRING")) and
          "by their names: &MASSES, &SPRING" in said and "without &PLATES" in said and "&RATES" in content(".dev7"), said)
    plain = sketch(random.Random(5))[2] + " &MASSES UNITL=0.001, GRAVY=-9.81 &END\n &PLATES PTHICK=4.0, PWIDTH=9.0, PHOLE=3.0 &END\n"
    drawn = forces(plain)
    status, said = run("psalm", plain, "--links")
    check("plates go with the loops", status == 0 and "without" not in said and "&PLATES" in content(".dev7"), said)
    of_loops = forces(content(".dev7"), name="loops")
    size = max(abs(row["frame_fx"]) for row in drawn)
    check("with the same forces", all(abs(a[key] - b[key]) <= 1e-11 * size for a, b in zip(drawn, of_loops) for key in ("frame_fx", "frame_fy", "drive")))


shapes()
loops()
drawing()
faults()
sys.exit(report())
