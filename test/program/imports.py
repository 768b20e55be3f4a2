#!/usr/bin/env python3
"""Linkages from other programs: what `psalm-import` makes of DXF, FreeCAD, pylinkage and PMKS+ is analysed and compared with the same
linkage as it is drawn here.

usage: imports.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import csv
import importlib.util
import json
import math
import os
import subprocess
import sys
import tempfile
import zipfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

import ezdxf

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SOURCE = os.path.join(TOP, "python", "psalm", "imports.py")
spec = importlib.util.spec_from_file_location("imports", SOURCE)
imports = importlib.util.module_from_spec(spec)
sys.modules["imports"] = imports
spec.loader.exec_module(imports)

BIN = os.path.abspath(sys.argv[1])
PLACE = tempfile.mkdtemp()
AT = {"A": (0.0, 0.0), "B": (0.0, 31.0), "C": (33.0, 82.0), "P": (20.0, 95.0), "D": (90.0, 5.0)}
COUPLER = [("B", "C"), ("C", "P"), ("P", "B")]


def path(name):
    return os.path.join(PLACE, name)


def positions(text, name="case"):
    """The columns of the analysis."""
    with open(path(name + ".nml"), "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([os.path.join(BIN, "psalm"), "--json", path(name + ".nml")], capture_output=True, text=True, timeout=60)
    check("the case is analysed: " + name, done.returncode == 0, done.stderr[-300:] + text)
    with open(path(name + ".csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {key: [float(row[key]) for row in rows] for key in rows[0]} if rows else {}


def own():
    """The four-bar as it is drawn here."""
    return positions("""OWN
 &CHAIN JNT='A','B','C','D','P', JX=0.0,0.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=5 &END
""", "own")


def same(what, drawing, part=1e-9):
    """The path of its coupler point is that of the four-bar, in the same unit of length."""
    check(what + ": output", drawing.output().startswith("point "), drawing.output())
    found = positions(drawing.text())
    point = drawing.output().split()[1]
    for axis in ("x", "y"):
        a, b = OWN["P." + axis], found.get(point + "." + axis, [])
        check(what + ": motion", len(a) == len(b) and all(abs(u - v) <= part * 100.0 for u, v in zip(a, b)), "%r %r" % (a[:3], b[:3]))


def refuses(what, words, source, *arguments, **more):
    try:
        imports.read(source, *arguments, **more)
    except imports.ImportFailed as reason:
        check(what, words in str(reason), str(reason))
    else:
        check(what, False, "not refused")


def dxf(name, lines=(), circles=(), polylines=(), texts=()):
    document = ezdxf.new()
    space = document.modelspace()
    for layer, a, b in lines:
        space.add_line(a, b, dxfattribs={"layer": layer})
    for layer, centre, radius in circles:
        space.add_circle(centre, radius, dxfattribs={"layer": layer})
    for layer, points in polylines:
        space.add_lwpolyline(points, format="xyb", close=True, dxfattribs={"layer": layer})
    for word, place in texts:
        space.add_text(word, height=3).set_placement(place)
    document.saveas(path(name))
    return path(name)


def stadium(a, b, r):
    """A bar with round ends, as a closed polyline with bulges."""
    length = math.dist(a, b)
    nx, ny = (b[1] - a[1]) / length * r, (a[0] - b[0]) / length * r
    return [(a[0] + nx, a[1] + ny, 0), (b[0] + nx, b[1] + ny, 1), (b[0] - nx, b[1] - ny, 0), (a[0] - nx, a[1] - ny, 1)]


def drawings():
    bars = [("0", AT[a], AT[b]) for a, b in [("A", "B"), *COUPLER, ("C", "D")]]
    frame = [("FRAME", AT["A"], AT["D"])]
    same("single lines", imports.read(dxf("lines.dxf", bars + frame)))
    same("single lines, frame by names", imports.read(dxf("plain.dxf", bars), fixed="A E", drive="A"))
    same("a layer for each link", imports.read(dxf("layers.dxf", frame + [("crank", AT["A"], AT["B"]), ("coupler", AT["B"], AT["C"]),
                                                                         ("coupler", AT["C"], AT["P"]), ("rocker", AT["C"], AT["D"])])))
    named = imports.read(dxf("named.dxf", bars + frame, texts=[(name, (x + 1.5, y + 1.0)) for name, (x, y) in AT.items()]))
    check("texts name the joints", {name: named.joints.get(name) for name in AT} == AT, str(named.joints))
    plates = [("0", stadium(AT["A"], AT["B"], 8)), ("0", stadium(AT["C"], AT["D"], 8)),
              ("0", [(-8, 20, 0), (45, 80, 0), (20, 110, 0)])]
    holes = [("0", AT[name], 3) for name in AT]
    same("plates with holes", imports.read(dxf("plates.dxf", (), holes, plates), fixed="A E", drive="A"))
    # what balm draws
    with open(path("out.nml"), "w", encoding="utf-8") as file:
        file.write("""OUT
 &CHAIN JNT='A','B','C','D','P', JX=0.0,0.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=90 &END
""")
    subprocess.run([os.path.join(BIN, "balm"), path("out.nml")], capture_output=True, timeout=60)
    same("a drawing of balm", imports.read(path("out.dxf"), fixed="A D", drive="A"))
    slider = imports.read(dxf("slider.dxf", [("0", (0, 0), (30, 20)), ("0", (30, 20), (100, 0)), ("RAIL", (60, 0), (150, 0))],
                              [("GROUND", (0, 0), 2)]))
    moved = positions(slider.text(), "slider")
    crank, rod = math.hypot(30, 20), math.hypot(70, 20)
    start = math.atan2(20, 30)
    travel = moved["slide_S1"]
    wanted = [crank * math.cos(start + math.radians(5 * k)) + math.sqrt(rod**2 - (crank * math.sin(start + math.radians(5 * k)))**2) - 100
              for k in range(len(travel))]
    check("a slider-crank against its closed form", all(abs(a - b) < 1e-9 for a, b in zip(travel, wanted)), "%r %r" % (travel[:3], wanted[:3]))
    unusual(bars, frame)
    refuses("no frame", "no joint is fixed", dxf("floating.dxf", bars))
    refuses("a joint that is not there", "there is no joint 'Q'", path("plain.dxf"), fixed="A Q")
    refuses("nothing drawn", "no lines", dxf("empty.dxf"))
    with open(path("broken.dxf"), "w", encoding="utf-8") as file:
        file.write("0\nSECTION\n  nonsense")
    refuses("a broken file", "broken.dxf", path("broken.dxf"))
    refuses("an unknown ending", "what is it", path("plain.xyz"))
    refuses("an unknown kind", "there is no kind", path("plain.dxf"), "step")


def unusual(bars, frame):
    """Mirrored entities, layers that are off, blocks, units, joints that nearly meet, lines out of the plane, too many lines."""
    document = ezdxf.new()
    space = document.modelspace()
    for layer, a, b in bars:
        space.add_line(a, b, dxfattribs={"layer": layer})
    for name in "AD":      # seen from behind: x counts the other way
        space.add_circle((-AT[name][0], AT[name][1]), 2, dxfattribs={"layer": "FRAME", "extrusion": (0, 0, -1)})
    document.layers.add("dimensions").off()
    space.add_line((0, 0), (100, 100), dxfattribs={"layer": "DIMENSIONS"})
    document.blocks.new("SCREW").add_line((0, 0), (1, 0))
    space.add_blockref("SCREW", (5, 5))
    document.header["$INSUNITS"] = 1
    document.saveas(path("unusual.dxf"))
    drawing = imports.read(path("unusual.dxf"))
    same("mirrored circles, a layer that is off, a block", drawing)
    notes = "\n".join(drawing.notes)
    check("what is left out is said", all(words in notes for words in ("1 INSERT; explode", "off or frozen is left out: 1", "inches")), notes)
    lines = [("0", AT["A"], AT["B"]), ("0", (0.0, 31.01), AT["C"]), ("0", AT["C"], AT["D"])] + frame
    notes = "\n".join(imports.read(dxf("gap.dxf", lines)).notes)
    check("joints that nearly meet are named", "joints B and C are 0.01 apart" in notes, notes)
    notes = "\n".join(imports.read(dxf("risen.dxf", bars[:-1] + [("0", (*AT["C"], 9.0), AT["D"])] + frame)).notes)
    check("lines out of the plane are named", "rise out of the plane" in notes, notes)
    refuses("lines of a whole machine", "a linkage has at most", dxf("many.dxf", [("0", (k, k % 2), (k + 1, (k + 1) % 2)) for k in range(2100)]))
    refuses("nothing but blocks", "1 INSERT; explode", blocks_only())
    # two links with three joints in common are one; a third that has one of these turns on it
    links = imports.merged([(None, {0, 1, 2}), (None, {0, 1, 2, 3}), (None, {0, 4})])
    check("a link on one joint of a rigid pair", sorted(map(sorted, (joints for _, joints in links))) == [[0, 1, 2, 3], [0, 4]], str(links))


def blocks_only():
    document = ezdxf.new()
    document.blocks.new("LINKS").add_line((0, 0), (1, 0))
    document.modelspace().add_blockref("LINKS", (5, 5))
    document.modelspace().add_circle((0, 0), 1)
    document.modelspace().add_circle((9, 0), 1)
    document.saveas(path("blocks.dxf"))
    return path("blocks.dxf")


def freecad(name, sketches, places=()):
    """A document as FreeCAD 0.20 packs it, with what is read of it alone. places: of the sketches, origin and quaternion."""
    def geometry(kind, a, b, construction):
        flags = "0" * 30 + ("1" if construction else "0") + "0"
        mark = '<GeoExtensions count="1"><GeoExtension type="Sketcher::SketchGeometryExtension" geometryModeFlags="%s"/></GeoExtensions>' % flags
        if kind == "circle":
            return '<Geometry type="Part::GeomCircle">%s<Circle CenterX="%r" CenterY="%r" CenterZ="0" Radius="3"/></Geometry>' % (mark, *a)
        return '<Geometry type="Part::GeomLineSegment">%s<LineSegment StartX="%r" StartY="%r" StartZ="0" EndX="%r" EndY="%r" EndZ="0"/></Geometry>' % (mark, *a, *b)
    objects = "".join('<Object type="Sketcher::SketchObject" name="Sketch%d"/>' % k for k in range(len(sketches)))
    put = ['<Property name="Placement"><PropertyPlacement Px="%r" Py="%r" Pz="%r" Q0="%r" Q1="%r" Q2="%r" Q3="%r"/></Property>' % place for place in places]
    data = "".join('<Object name="Sketch%d"><Properties><Property name="Geometry"><GeometryList>%s</GeometryList></Property><Property name="Label"><String value="%s"/></Property>%s</Properties></Object>'
                   % (k, "".join(geometry(*shape) for shape in shapes), label, put[k] if put else "") for k, (label, shapes) in enumerate(sketches))
    with zipfile.ZipFile(path(name), "w") as packed:
        packed.writestr("Document.xml", "<?xml version='1.0'?><Document><Objects>%s</Objects><ObjectData>%s</ObjectData></Document>" % (objects, data))
    return path(name)


def sketches():
    bars = [("line", AT[a], AT[b], False) for a, b in [("A", "B"), *COUPLER, ("C", "D")]]
    single = freecad("one.FCStd", [("Sketch", bars + [("line", AT["A"], AT["D"], True), ("circle", AT["C"], None, False)])])
    same("a sketch of FreeCAD", imports.read(single, fixed="A E", drive="A"))
    same("a sketch for each link", imports.read(freecad("four.FCStd", [
        ("crank", bars[:1]), ("coupler", bars[1:3]), ("rocker", bars[4:]), ("frame", [("line", AT["A"], AT["D"], False)])])))
    # sketches that lie elsewhere in space: the first in the plane XZ, the others turned in it, above it or seen from behind
    half = math.sqrt(0.5)
    across = lambda x, y: (x, -y)
    turned = lambda x, y: (y - 4.0, 3.0 - x)     # of a sketch whose x axis is the y of the first, and its origin at 3, 4
    lines = lambda change, *ends: [("line", change(*AT[a]), change(*AT[b]), False) for a, b in ends]
    whole = [("frame", lines(lambda x, y: (x, y), ("A", "D"))), ("crank", lines(lambda x, y: (x, y), ("A", "B"))),
             ("coupler", lines(turned, ("B", "C"), ("C", "P"))), ("rocker", lines(across, ("C", "D")))]
    places = [(1.0, 2.0, 3.0, half, 0.0, 0.0, half), (1.0, -7.0, 3.0, half, 0.0, 0.0, half), (4.0, 2.0, 7.0, .5, -.5, .5, .5), (1.0, 2.0, 3.0, -half, 0.0, 0.0, half)]
    same("sketches with places", imports.read(freecad("placed.FCStd", whole, places)), 1e-8)
    places[3] = (1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0)
    refuses("planes that cross", "parallel planes", freecad("crossing.FCStd", whole, places))
    with zipfile.ZipFile(single) as packed:
        text = packed.read("Document.xml").decode()
    for what, new in (("no number", 'StartX="a"'), ("no coordinate", ""), ("an infinite coordinate", 'StartX="inf"')):
        with zipfile.ZipFile(path("bad.FCStd"), "w") as packed:
            packed.writestr("Document.xml", text.replace('StartX="0.0"', new))
        refuses("a sketch with " + what, "", path("bad.FCStd"))
    with open(path("no.FCStd"), "w", encoding="utf-8") as file:
        file.write("no archive")
    refuses("no document", "is no document of FreeCAD", path("no.FCStd"))
    refuses("no sketch", "has no sketch", freecad("none.FCStd", []))


def saved(name, data):
    with open(path(name), "w", encoding="utf-8") as file:
        json.dump(data, file)
    return path(name)


def pylinkage():
    ref = lambda name: {"ref": name}
    old = {"name": "old", "joints": [
        {"type": "Static", "name": "A", "x": 0.0, "y": 0.0},
        {"type": "Crank", "name": "B", "x": None, "y": None, "joint0": ref("A"), "distance": 31.0, "angle": math.pi / 2},
        {"type": "Revolute", "name": "C", "x": 33.0, "y": 82.0, "joint0": ref("B"),
         "joint1": {"inline": True, "type": "Static", "name": "D", "x": 90.0, "y": 5.0}},
        {"type": "Fixed", "name": "P", "x": None, "y": None, "joint0": ref("B"), "joint1": ref("C"), "distance": math.hypot(20, 64),
         "angle": math.atan2(64, 20) - math.atan2(51, 33)}]}
    same("a linkage of pylinkage", imports.read(saved("old.json", old)))
    new = {"name": "new", "joints": [{"id": "g.A", "type": "ground", "position": AT["A"]}, {"id": "g.D", "type": "ground", "position": AT["D"]},
                                     {"id": "b", "type": "revolute", "position": AT["B"]}, {"id": "c", "type": "revolute", "position": AT["C"]},
                                     {"id": "p", "type": "tracker", "position": AT["P"], "ref_joint1_id": "b", "ref_joint2_id": "c",
                                      "distance": 1.0, "angle": 0.0}],
           "links": [{"id": "ground", "type": "ground", "joints": ["g.A", "g.D"]}, {"id": "crank", "type": "driver", "joints": ["g.A", "b"], "motor_joint": "g.A"},
                     {"id": "coupler", "type": "link", "joints": ["b", "c"]}, {"id": "rocker", "type": "link", "joints": ["c", "g.D"]}], "ground": "ground"}
    same("a mechanism of pylinkage 1", imports.read(saved("new.json", new)))
    slide = {"name": "slide", "joints": [{"id": "o", "type": "ground", "position": [0.0, 0.0]}, {"id": "t", "type": "revolute", "position": [1.0, 0.0]},
                                         {"id": "s", "type": "prismatic", "position": [4.0, 0.0], "axis": [1.0, 0.0], "line_point": [0.0, 0.0]}],
             "links": [{"id": "crank", "type": "driver", "joints": ["o", "t"], "motor_joint": "o"}, {"id": "rod", "type": "link", "joints": ["t", "s"]}]}
    moved = positions(imports.read(saved("slide.json", slide)).text(), "slide")
    travel = moved["slide_S1"]
    wanted = [math.cos(math.radians(5 * k)) + math.sqrt(9 - math.sin(math.radians(5 * k))**2) - 4 for k in range(len(travel))]
    check("its slide", all(abs(a - b) < 1e-9 for a, b in zip(travel, wanted)), "%r %r" % (travel[:3], wanted[:3]))
    refuses("no JSON", "is no linkage of pylinkage", saved("list.json", [1, 2]))
    refuses("JSON without joints", "no linkage of pylinkage: it has no joints", saved("empty.json", {"name": "nothing"}))
    refuses("a mechanism without joints", "a joint or link of it is not complete", saved("links.json", {"links": [{}], "joints": [{}]}))
    broken = dict(old, joints=[{"type": "Revolute", "name": "C", "x": 1.0, "y": 2.0, "joint0": ref("B"), "joint1": ref("A")}])
    refuses("a joint that hangs on nothing", "does not come before it", saved("broken.json", broken))
    refuses("a joint of an unknown type", "are not known", saved("gear.json", dict(old, joints=old["joints"][:2] + [{"type": "Gear", "name": "G", "joint0": ref("A")}])))
    for where, value in (("position", [1e200, 0.0]), ("position", ["x", 0.0]), ("position", [10**400, 0.0]), ("position", [1.0]), ("position", 7), ("id", None)):
        spoilt = json.loads(json.dumps(new))
        spoilt["joints"][3][where] = value
        refuses("a joint with %s %.20r" % (where, value), "", saved("spoilt.json", spoilt))
    for k in range(len(new["joints"])):
        for value in (3, "x", None, [], [1]):
            spoilt = json.loads(json.dumps(new))
            spoilt["joints"][k] = value
            refuses("a joint that is %r" % value, "", saved("spoilt.json", spoilt))
    with open(path("deep.json"), "w", encoding="utf-8") as file:
        file.write('{"joints":' * 100000)
    refuses("a file without end", "", path("deep.json"))
    long = json.loads(json.dumps(slide).replace('"s"', '"%s"' % ("s" * 60)))
    check("a long name", all(len(name) <= 31 for name, _ in imports.read(saved("long.json", long)).links))
    refuses("an infinite place", "no joint", saved("four.json", new), fixed="Q")


def pmks():
    # the link that the developers of PMKS+ verify their program with: a six-bar
    link = ("https://app.pmksplus.com/?0P.SS.K,0.101.MA,A,0wS,0bg,0.GB,B,0gW,EE,0.GC,C,Oi,6k,0.GD,D,03m,_g,0.GE,E,1FO,1I_,0.GF,F,1-C,qM,0."
            "KG,G,1oO,0ss,0..YRAB,AB,Fe,Fe,0oU,0Bk,c5cae9,A,B,,.YRBCD,BCD,Fe,Fe,07C,Rt,303e9f,B,C,D,,.YRDE,DE,Fe,Fe,bq,18q,0d125a,D,E,,."
            "YREF,EF,Fe,Fe,1dI,13g,B2DFDB,E,F,,.YRFCG,FCG,Fe,Fe,1Om,1Q,26A69A,F,C,G,,...JGp")
    six = imports.read(link)
    check("joints of PMKS+", six.joints["D"] == (-.24, 4.01) and six.joints["G"] == (7.32, -3.51) and len(six.joints) == 7, str(six.joints))
    check("links of PMKS+", [joints for _, joints in six.links] == [["A", "B"], ["B", "C", "D"], ["D", "E"], ["E", "F"], ["F", "C", "G"]], str(six.links))
    check("frame and drive of PMKS+", six.fixed == ["A", "G"] and six.drive == "A")
    done = positions(six.text().replace("IKIN=5", "NDES=1, DELT=0.0"), "six")
    check("it is analysed", len(done) > 0)
    with open(path("six.pmks"), "w", encoding="utf-8") as file:
        file.write(link.split("?")[1])
    check("a file with it", imports.read(path("six.pmks")).joints == six.joints)
    # a slider-crank: a piston with a revolute joint and a prismatic one on the frame at the same place, 3, 0
    digits = imports.PMKS_DIGITS
    number = lambda value: ("0" if value < 0 else "") + "".join(digits[abs(round(value * 1000)) // 64**k % 64] for k in (2, 1, 0)).lstrip("0") if value else "0"
    joint = lambda flags, name, x, y: "%s%s,%s,%s,%s,0" % (digits[flags], name, name, number(x), number(y))
    body = lambda kind, name, *joints: "Y%s%s,%s,0,0,0,0,aaa,%s,," % (kind, name, name, ",".join(joints))
    slider = ".".join(["0", "0", "0,0", "000", joint(6, "A", 0, 0), joint(0, "B", 1, 0), joint(0, "C", 4, 0), joint(5, "D", 4, 0), "",
                       body("R", "AB", "A", "B"), body("R", "BC", "B", "C"), body("P", "CD", "C", "D"), "", "", "N"])
    moved = positions(imports.read("https://x.example/?" + slider).text(), "piston")
    travel = moved["slide_S1"]
    wanted = [math.cos(math.radians(5 * k)) + math.sqrt(9 - math.sin(math.radians(5 * k))**2) - 4 for k in range(len(travel))]
    check("a piston of PMKS+", all(abs(a - b) < 1e-9 for a, b in zip(travel, wanted)), "%r %r" % (travel[:3], wanted[:3]))
    refuses("no link of PMKS+", "no link of PMKS+", "https://app.pmksplus.com/?abc")
    whole = 0
    for text in [link[:k] for k in range(25, len(link))] + [link[:k] + link[k + 1:] for k in range(25, len(link))]:
        try:
            whole += bool(imports.read(text).text())
        except imports.ImportFailed:
            pass
    check("damaged links are refused or whole", 0 < whole < 2 * len(link), whole)


def pins_of_three():
    """Two cranks on one driven pin: which of them the drive turns is said, in the case and in the notes."""
    places = {"A": (0, 0), "B": (0, 31), "C": (33, 82), "D": (90, 5), "E": (30, -20), "F": (60, -60), "G": (100, -30)}
    bars = [("AB", "A", "B"), ("BC", "B", "C"), ("CD", "C", "D"), ("AE", "A", "E"), ("EF", "E", "F"), ("FG", "F", "G")]
    drawing = imports.read(dxf("three.dxf", [(name, places[a], places[b]) for name, a, b in bars] + [("FRAME", places[a], places[b]) for a, b in ("AD", "DG")],
                               texts=[(name, (x + 1.5, y + 1.0)) for name, (x, y) in places.items()]), drive="A")
    check("the drive of a pin of three links is between two of them", "DBASE='frame', DLINK='AB'" in drawing.text() and
          any("several links turn at A" in note for note in drawing.notes), drawing.text())
    done = subprocess.run([os.path.join(BIN, "psalm"), "-"], input=drawing.text(), capture_output=True, text=True, timeout=60)
    check("and psalm takes it as far as its freedom goes", "DBASE" not in done.stderr and "DLINK" not in done.stderr, done.stderr[-400:])


def in_memory():
    """Files in memory are read as those on disk."""
    for name, more in (("lines.dxf", {}), ("layers.dxf", {}), ("one.FCStd", {"fixed": "A E", "drive": "A"}), ("old.json", {}), ("new.json", {}),
                       ("six.pmks", {})):
        with open(path(name), "rb") as file:
            content = file.read()
        found, wanted = (imports.read(source, **more).text() for source in (imports.InMemory(name, content), path(name)))
        check("in memory: " + name, found == wanted, found[:300] + wanted[:300])
    for name, content in (("a.dxf", b"nothing"), ("a.dxf", b""), ("a.FCStd", b"PK"), ("a.json", b"{"), ("a.pmks", b"\x00"), ("a.json", b"[[[[")):
        refuses("in memory: %s of %d bytes" % (name, len(content)), "", imports.InMemory(name, content))


def command():
    """The command: output, remarks, exit status, files that are there."""
    def call(*arguments):
        return subprocess.run([sys.executable, SOURCE, *arguments], capture_output=True, text=True, timeout=60)
    done = call(path("lines.dxf"))
    check("the command writes the case", done.returncode == 0 and done.stdout.count("&END") == 4 and "the drive is taken" in done.stderr, done.stderr)
    check("an output file", call(path("lines.dxf"), "--output", path("made.nml")).returncode == 0 and os.path.getsize(path("made.nml")) > 100)
    done = call(path("lines.dxf"), "--output", path("made.nml"))
    check("a file that is there is kept", done.returncode == 3 and "exists" in done.stderr, done.stderr)
    check("a missing file", call(path("nothing.dxf")).returncode == 3)
    check("a file that is no linkage", call(path("floating.dxf")).returncode == 2)


OWN = own()
drawings()
sketches()
pylinkage()
pmks()
pins_of_three()
in_memory()
command()
sys.exit(report())
