#!/usr/bin/env python3
"""The pictures of balm from outside: SVG, DXF and page against device 9 of psalm, the page in a browser without a screen.

usage: test/web/pictures.py PROGRAM_DIRECTORY [SCREENSHOT_DIRECTORY | --only PART[,PART ...]]. Last line: N passed, N failed.
Readers are independent of balm: XML and JSON of Python, ezdxf, chromium.
"""
import cmath
import csv
import glob
import json
import math
import os
import re
import shutil
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import ezdxf

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import picture_tools
from curve_plots import follows, plots_of
from board_in_browser import test_board
from page_in_browser import test_pages
from picture_tools import DATA, TOP, balm, changed, check, page_data, psalm, read, run, write

SVG = "{http://www.w3.org/2000/svg}"
DYADS = ("RRR", "RPR", "RRP", "PRR", "RPP", "PPR", "PRP")


def device9(name):
    """Blocks of positions of a device 9 file: (names, rows of strings)."""
    blocks, positions = [], False
    for line in read(name).splitlines():
        if line.startswith("# input"):
            blocks.append((line[2:].split(), []))
            positions = True
        elif line.startswith("# block "):
            positions = False
        elif positions and line.strip() and not line.startswith("#"):
            blocks[-1][1].append(line.split())
    return blocks


class Picture:
    """What a test asks of an SVG."""

    def __init__(self, name):
        self.root = ElementTree.parse(name).getroot()
        self.elements = list(self.root.iter())

    def of_class(self, *names):
        return [e for e in self.elements if set(names) <= set(e.get("class", "").split())]

    def text(self):
        return " ".join("".join(e.itertext()) for e in self.root.iter(SVG + "text"))

    def joints(self):
        return {e.get("data-joint"): place(e) for e in self.of_class("joint")}


def place(element):
    """The two strings of translate(x y)."""
    return re.search(r"translate\((\S+) (\S+)\)", element.get("transform")).groups()


def numbers(element):
    return re.findall(r"[-+0-9.E]+", re.sub("[MLHVZhvz]", " ", element.get("d")))


def near(a, b, relative=1e-11, scale=0.0):
    return abs(a - b) <= relative * max(abs(a), abs(b), scale)


LETTER_RISE = 5.0  # pixels from the base line of a letter to its middle
CROWD = 40         # joints above which some letters may be left out

# ---- geometry -----------------------------------------------------------------------------------------------------------

def compare_case(name, number, blocks, case):
    """One case: device 9 blocks of psalm against SVG, page and DXF of balm."""
    stem = name if number == 1 else "%s.%d" % (name, number)
    law = "%s, case %d: " % (name, number)
    picture = Picture(stem + ".svg")
    names, rows = blocks[0]
    motion, row = case["motion"], case["prescribed"]
    check(law + "page: names of motion and dyads", motion in ("point", "angle", "distance", "slide") and
          all(p["type"] in DYADS for p in case["pairs"]), str(case["pairs"]))
    actual = ["actual_x", "actual_y"] if motion == "point" else ["actual"]
    desired = ["desired_x", "desired_y"] if motion == "point" else ["desired"]
    column = {n: [r[i] for r in rows] for i, n in enumerate(names)}
    check(law + "page: inputs", [float(v) for v in column["input"]] == row["input"])
    check(law + "page: closed", "".join(column["closed"]) == row["closed"])
    for n, key in zip(actual, ["actual", "actual_y"]):
        check(law + "page: " + n, [None if v == "NaN" else float(v) for v in column[n]] == row[key])
    if desired[0] in column:
        for n, key in zip(desired, ["desired", "desired_y"]):
            check(law + "page: " + n, [float(v) for v in column[n]] == row[key])

    # the marks of the SVG carry the very digits of device 9
    marks = {int(e.get("data-position")): e for e in picture.of_class("output", "actual") if e.get("data-position")}
    closed = [i + 1 for i, v in enumerate(column["closed"]) if v == "1"]
    check(law + "SVG: a mark for each closed position", sorted(marks) == closed)
    check(law + "SVG: values are those of device 9",
          all(marks[i].get("data-value").split() == [column[n][i - 1] for n in actual] and
              marks[i].get("data-input") == column["input"][i - 1] for i in closed))
    size = max(case["view"][2] - case["view"][0], case["view"][3] - case["view"][1])
    out, base = case["output"], case["base"]
    if motion == "point":
        check(law + "SVG: stars stand at the digits", all(place(marks[i]) == tuple(column[n][i - 1] for n in actual) for i in closed))
    elif motion == "angle":
        def direction(element):
            x1, y1, x2, y2 = map(float, numbers(element))
            return math.degrees(math.atan2(y2 - y1, x2 - x1))
        check(law + "SVG: lines have the angle",
              all(abs(math.remainder(direction(marks[i]) - float(column["actual"][i - 1]), 360)) < 1e-9 for i in closed))
    elif motion == "distance":
        check(law + "SVG: stars stand at the distance",
              all(near(math.hypot(*map(float, place(marks[i]))), float(column["actual"][i - 1])) for i in closed))
    else:
        slide = next(s for s in case["slides"] if s["block"] == out)
        check(law + "page: the block stands at the length",
              any(all(near(math.hypot(row["x"][out][i - 1] - row["x"][s["guide"]][i - 1], row["y"][out][i - 1] - row["y"][s["guide"]][i - 1]),
                           abs(float(column["actual"][i - 1])), scale=size) for i in closed)
                  for s in case["slides"] if s["block"] == out), str(slide))
    if desired[0] in column:
        targets = {int(e.get("data-position")): e for e in picture.of_class("output", "desired")}
        wanted = range(1, len(rows) + 1) if motion == "point" else closed
        check(law + "SVG: desired values", sorted(targets) == list(wanted) and
              all(targets[i].get("data-value").split() == [column[n][i - 1] for n in desired] for i in wanted))
        if motion == "point":
            check(law + "SVG: desired points", all(place(targets[i]) == tuple(column[n][i - 1] for n in desired) for i in wanted))

    # joints: SVG = page = DXF, traces at every position, every bar keeps its length
    reference = case["reference"]
    joints = picture.joints()
    for j, joint in enumerate(case["joints"]):
        if not joint["name"] or row["x"][j][reference] is None:
            continue
        if not check(law + "joint " + joint["name"] + ": SVG and page agree", joint["name"] in joints and
                     tuple(map(float, joints[joint["name"]])) == (row["x"][j][reference], row["y"][j][reference])):
            break
    for trace in picture.of_class("trace"):
        j = next(k for k, joint in enumerate(case["joints"]) if joint["name"] == trace.get("data-joint"))
        points = re.findall(r"M(\S+) (\S+)h0", trace.get("d"))
        there = [(x, y) for x, y in zip(row["x"][j], row["y"][j]) if x is not None]
        if not check(law + "trace of " + trace.get("data-joint"), [(float(x), float(y)) for x, y in points] == there):
            break
    worst = 0.0
    for bar in case["bars"]:
        if bar["slide"] >= 0:
            continue
        for i in range(row["n"]):
            ends = [row[k][bar[e]][i] for e in ("from", "to") for k in ("x", "y")]
            if None not in ends:
                worst = max(worst, abs(math.hypot(ends[2] - ends[0], ends[3] - ends[1]) - bar["length"]) / size)
    check(law + "every link keeps its length at every position", worst < 1e-12, "%.1e" % worst)
    path = picture.root.find('.//%spath[@id="path"]' % SVG)
    if path is not None:
        whole = None not in case["sweep"]["x"][out] and not case["sliding"]
        check(law + "SVG: the path of a whole turn is closed", path.get("d").strip().endswith("Z") == whole, path.get("d")[-20:])
    check(law + "SVG: a cross where a distance is measured from", ("#cross" in [e.get("href") for e in picture.of_class("axis")]) ==
          (motion == "distance"))
    for angle in row["angle"]:
        start, shared, finish = (case["pairs"][angle["loop"] - 1][k] for k in ("start", "shared", "finish"))
        for i, value in enumerate(angle["values"]):
            if value is not None:
                at = [complex(row["x"][j][i], row["y"][j][i]) for j in (start, shared, finish)]
                between = abs(math.degrees(cmath.phase((at[0] - at[1])*(at[2] - at[1]).conjugate())))
                if not check(law + "page: angle between the links of a dyad", abs(value - between) < 1e-6, "%s %s" % (value, between)):
                    break
    compare_dxf(law, stem, case, joints, blocks)
    if motion == "angle" and out != base:
        check(law + "the output point lies in the direction of the output", all(
            abs(math.remainder(math.degrees(math.atan2(row["y"][out][i - 1] - row["y"][base][i - 1],
                                                       row["x"][out][i - 1] - row["x"][base][i - 1]))
                               - row["actual"][i - 1], 360)) < 1e-9 for i in closed))

    check(law + "positions of the sweep have no numbers that a user knows", not any(
        re.search(r"\bpositions? \d", v["text"]) for v in case["sweep"]["violations"]), str(case["sweep"]["violations"]))

    # the sweep against the block of IPLOT
    if len(blocks) > 1:
        sweep = case["sweep"]
        for n, key in zip(actual, ["actual", "actual_y"]):
            k = blocks[1][0].index(n)
            ours, theirs = sweep[key], [float(r[k]) for r in blocks[1][1]]
            good = len(ours) == len(theirs)
            for a, b in zip(ours, theirs):
                good = good and (math.isnan(b) if a is None else near(a, b, 1e-7, 1e-3 * size))
            check(law + "sweep: " + n, good)


def compare_dxf(law, stem, case, joints, blocks):
    document = ezdxf.readfile(stem + ".dxf")
    check(law + "DXF: no faults", not document.audit().errors)
    space = document.modelspace()
    circles = {(c.dxf.center.x, c.dxf.center.y) for c in space.query('CIRCLE[layer=="JOINTS"]')}
    check(law + "DXF: circles are the joints", circles == {tuple(map(float, j)) for j in joints.values()})
    row, out = case["prescribed"], case["output"]
    points = [(p.dxf.location.x, p.dxf.location.y) for p in space.query('POINT[layer=="OUTPUT"]')]
    check(law + "DXF: output points", points == [(x, y) for x, y in zip(row["x"][out], row["y"][out]) if x is not None])
    bodies = {b["body"] for b in case["bars"] if b["body"] >= 0 and b["from"] != b["to"]}
    links = {layer.dxf.name for layer in document.layers if layer.dxf.name.startswith("LINK_")}
    moving = {b for b in bodies if not case["bodies"][b]["frame"]}
    check(law + "DXF: a layer for each link", len(links) >= len(moving))
    plates = space.query("POLYLINE").filter(lambda line: line.dxf.layer != "OUTPUT")
    drawn = {line.dxf.layer for line in [*space.query("LINE"), *plates] if line.dxf.layer.startswith("LINK_")}
    hulls = [b["hull"] for b in case["bodies"] if b["hull"] and not b["frame"]]
    if "0" not in row["closed"]:
        check(law + "DXF: plates are closed", all(line.is_closed for line in plates) and
              sorted(len(line) for line in plates) == sorted(map(len, hulls)), "%s %s" % ([len(p) for p in plates], hulls))
    check(law + "DXF: lines lie on layers of links", drawn <= links and (len(drawn) == len(moving) or "0" in row["closed"]))
    if case["motion"] == "point" and len(blocks) > 1:
        k = blocks[1][0].index("actual_x")
        theirs = [(float(r[k]), float(r[k + 1])) for r in blocks[1][1] if r[1] == "1"]
        ours = [(v.dxf.location.x, v.dxf.location.y) for line in space.query('POLYLINE[layer=="OUTPUT"]') for v in line.vertices]
        check(law + "DXF: the path is that of device 9", ours == theirs)


def outline_area(line):
    """Area within a closed polyline of straight pieces and arcs."""
    vertices = [(v.dxf.location.x, v.dxf.location.y, v.dxf.bulge) for v in line.vertices]
    area = 0.0
    for (x1, y1, bulge), (x2, y2, _) in zip(vertices, vertices[1:] + vertices[:1]):
        angle, chord = 4 * math.atan(bulge), math.hypot(x2 - x1, y2 - y1)
        area += (x1 * y2 - x2 * y1) / 2
        if bulge:
            radius = chord / 2 / math.sin(angle / 2)
            area += radius ** 2 / 2 * (angle - math.sin(angle))
    return area


def test_cutting():
    """The group DXF: units, pins, a position of its own, outlines of links by their width, every link laid flat."""
    source = os.path.join(DATA, "laser_cut_lift.nml")
    code, _, errors = balm("--quiet", "--output-dir", ".", source)
    check("cutting: is drawn", code == 0, errors)
    drawing, flat = ezdxf.readfile("laser_cut_lift.dxf"), ezdxf.readfile("laser_cut_lift.flat.dxf")
    check("cutting: no faults, millimetres", all(not d.audit().errors and d.header["$INSUNITS"] == 4 for d in (drawing, flat)))
    case = page_data("laser_cut_lift.html")[0]
    names = [joint["name"] for joint in case["joints"]]
    at = next(i for i, v in enumerate(case["prescribed"]["delt"]) if v == 40)
    row, space = case["prescribed"], drawing.modelspace()
    place = {name: (row["x"][j][at], row["y"][j][at]) for j, name in enumerate(names) if name}
    colours = [{layer.dxf.name: layer.color for layer in document.layers} for document in (drawing, flat)]
    check("cutting: a link laid flat keeps its colour", sum(name.startswith("LINK_") and colours[0][name] == colour for name, colour in colours[1].items()) == 3, colours)
    pins = {(c.dxf.center.x, c.dxf.center.y): c.dxf.radius for c in space.query("CIRCLE")}
    check("cutting: pins of their size at the position of INCREM", set(pins) == {v for k, v in place.items() if k != "P"} and set(pins.values()) == {3.0}, "%s %s" % (pins, place))
    far = lambda a, b: math.dist(place[a], place[b])
    bar = lambda a, b: 18 * far(a, b) + math.pi * 81
    plate = lambda a, b, c: (abs((place[b][0] - place[a][0]) * (place[c][1] - place[a][1]) - (place[b][1] - place[a][1]) * (place[c][0] - place[a][0])) / 2 +
                             9 * (far(a, b) + far(b, c) + far(c, a)) + math.pi * 81)
    areas = {"LINK_CRANK": bar("A", "B"), "LINK_ROCKER": bar("C", "D"), "LINK_COUPLER": plate("B", "C", "P"), "FRAME": bar("A", "D")}
    moving = {layer: area for layer, area in areas.items() if layer != "FRAME"}
    for law, document, wanted in (("assembled", drawing, moving), ("flat", flat, areas)):
        lines = [line for line in document.modelspace().query("POLYLINE") if line.dxf.layer in areas]
        ours = {line.dxf.layer: outline_area(line) for line in lines}
        check("cutting, %s: outlines by the user's names, with the area of a bar or plate with round ends" % law, len(lines) == len(wanted) and
              ours.keys() == wanted.keys() and all(near(ours[k], v, 1e-9) for k, v in wanted.items()), "%s %s" % (ours, wanted))
    holes = [(c.dxf.center.x, c.dxf.center.y, c.dxf.radius) for c in flat.modelspace().query('CIRCLE[layer=="HOLES"]')]
    texts = {(round(t.dxf.insert.x - 1.6 * 3, 6), round(t.dxf.insert.y - 1.6 * 3, 6)): t.dxf.text for t in flat.modelspace().query('TEXT[layer=="NAMES"]')}
    spots = [(texts[round(x, 6), round(y, 6)], x, y) for x, y, _ in holes]
    pairs = sorted((abs(y1 - y2) < 1e-9, a, b, math.hypot(x1 - x2, y1 - y2)) for i, (a, x1, y1) in enumerate(spots) for b, x2, y2 in spots[i + 1:]
                   if (a + b in ("AB", "BC", "AD", "CD", "DA", "DC", "BA", "CB")) and near(math.hypot(x1 - x2, y1 - y2), far(a, b), 1e-12))
    check("cutting, flat: holes of each link are as far apart as its joints", len(pairs) == 4 and all(r == 3.0 for *_, r in holes) and len(holes) == 8, str(spots))
    check("cutting, flat: links lie along their longest line and apart", sum(level for level, *_ in pairs) >= 3 and
          len({round(min(v.dxf.location.y for v in line.vertices), 6) for line in flat.modelspace().query("POLYLINE")}) == 4)
    write("hidden.nml", changed(read(source), "OUTPUT='point P'", "OUTPUT='angle rocker','point P'"))
    balm("--quiet", "hidden.nml")
    for name, wanted in (("hidden.dxf", moving), ("hidden.flat.dxf", areas)):
        ours = {line.dxf.layer: outline_area(line) for line in ezdxf.readfile(name).modelspace().query("POLYLINE") if line.dxf.layer in areas}
        check("cutting: parts are the same with another first output, " + name, ours.keys() == wanted.keys() and
              all(near(ours[k], v, 1e-9) for k, v in wanted.items()), "%s %s" % (ours, wanted))
    write("pinned.nml", changed(read(source), "INCREM=40.0", "POSITN=5"))
    balm("--quiet", "pinned.nml")
    check("cutting: POSITN is the number of a position", {(c.dxf.center.x, c.dxf.center.y) for c in ezdxf.readfile("pinned.dxf").modelspace().query("CIRCLE")} == set(pins))
    for old, new, words in (("'MM'", "'YARDS'", "error: &DXF UNITS: one of 'MM'"), ("PIN=6.0", "PIN=60.0", "a pin must be thinner"),
                            ("INCREM=40.0", "POSITN=8", "&DXF POSITN: must be from 0 to 7"), ("FLAT=1", "POSITN=2", "leave one out")):
        write("wrong.nml", changed(read(source), old, new))
        code, _, errors = balm("--quiet", "wrong.nml")
        check("cutting: %s is refused" % new, code == 2 and "wrong.nml:11: " in errors and words in errors, errors)


def split_blocks(blocks, cases):
    """Device 9 blocks of each case: one, or two where the second has the 360 or 361 inputs of IPLOT."""
    groups = []
    for block in blocks:
        n = len(block[1])
        if groups and len(groups[-1]) == 1 and n in (360, 361) and len(groups[-1][0][1]) not in (360, 361):
            groups[-1].append(block)
        else:
            groups.append([block])
    return groups if len(groups) == len(cases) else []


PLAIN = ["needle", "textile", "brake_reaction"] + sorted(f[:-4] for f in os.listdir(DATA) if f.startswith(("dyad", "actuator")))
FOUND = ["suspension", "chain_short", "path18", "needle_lsq"]
HARD = ["kite", "parallelogram", "copied_slide", "zero_guide", "toggle", "ratios", "many_turns"]


def prepare():
    """Cases and what the programs make of them. Returns exit status of psalm and balm, and balm's messages, by case."""
    codes = {}
    for name in PLAIN:
        shutil.copy(os.path.join(DATA, name + ".nml"), name + ".nml")
    for name in HARD:
        shutil.copy(os.path.join(DATA, "hard", name + ".nml"), name + ".nml")
    for name in FOUND + ["brake_reaction"]:
        psalm("--quiet", "--output-dir", "found", os.path.join(DATA, name + ".nml"))
        text = read("found/%s.dev7" % name)
        check(name + ": device 7 has IPLOT", re.search(r"IPLOT\s*=\s*[01]", text))
        write(name + ".nml", re.sub(r"IPLOT\s*=\s*0", "IPLOT=1", text))
    for name in PLAIN + FOUND + HARD:
        code, _, _ = psalm("--quiet", name + ".nml")
        ours, _, errors = balm("--quiet", name + ".nml")
        codes[name] = code, ours, errors
    return codes


def test_geometry(codes):
    for name, (code, ours, errors) in codes.items():
        if name != "needle":
            check(name + ": exit status as psalm's", ours == code, "%d %d %s" % (ours, code, errors))
        cases = page_data(name + ".html")
        groups = split_blocks(device9(name + ".dev9"), cases)
        if check(name + ": all cases of the file", len(groups) == len(cases) > 0):
            for i, (group, case) in enumerate(zip(groups, cases), 1):
                compare_case(name, i, group, case)
    check("needle_lsq: device 7 of three linkages gives three cases", len(page_data("needle_lsq.html")) == 3)


def test_drawing():
    """Every link, plate, symbol and letter, from the joints and bodies that the page tells."""
    for name in PLAIN + FOUND + HARD:
        picture, case = Picture(name + ".svg"), page_data(name + ".html")[0]
        row, i = case["prescribed"], case["reference"]
        at = [(x[i], y[i]) for x, y in zip(row["x"], row["y"])]
        bodies, law = case["bodies"], name + ": "
        wanted = {}
        for bar in case["bars"]:
            ends = [at[bar["from"]], at[bar["to"]]]
            if None not in ends[0] + ends[1] and bar["from"] != bar["to"]:
                wanted["%d %d" % (bar["loop"], bar["arc"])] = (ends, bar["body"])
        drawn = {e.get("data-arc"): e for e in picture.of_class("bar")}
        check(law + "a line for each link", sorted(drawn) == sorted(wanted), "%s %s" % (sorted(drawn), sorted(wanted)))
        check(law + "links end at their joints", all(
            [float(v) for v in numbers(drawn[arc])] == [*ends[0], *ends[1]] for arc, (ends, _) in wanted.items() if arc in drawn))
        colours = {}
        for arc, (_, body) in wanted.items():
            if arc in drawn and body >= 0:
                colours.setdefault(body, set()).add(drawn[arc].get("class"))
        check(law + "one colour for a body, dashes for the frame", all(len(c) == 1 for c in colours.values()) and all(
            (colours[body] == {"bar frame"}) == bodies[body]["frame"] for body in colours) and all(
            (drawn[arc].get("stroke-dasharray") is not None) == bodies[body]["frame"] for arc, (_, body) in wanted.items() if arc in drawn and body >= 0))
        moving = [tuple(c)[0] for body, c in colours.items() if not bodies[body]["frame"]]
        check(law + "colours tell bodies apart", len(moving) > 8 or len(set(moving)) == len(moving), str(moving))
        plates = [[float(v) for v in re.split("[ ,\n]+", e.get("points").strip())] for e in picture.of_class("plate")]
        hulls = [[v for j in body["hull"] for v in at[j]] for body in bodies if body["hull"] and not body["frame"]]
        check(law + "plates have their corners in the joints", sorted(plates) == sorted(h for h in hulls if None not in h))
        groups = {e.get("data-joint"): [use.get("href") for use in e] for e in picture.of_class("joint")}
        for j, joint in enumerate(case["joints"]):
            if joint["name"] and at[j][0] is not None:
                symbols = (["#ground"] if joint["turning"] and joint["fixed"] else []) + \
                    ["#prismatic"]*sum(slide["block"] == j for slide in case["slides"]) + (["#revolute"] if joint["turning"] else [])
                if not check(law + "symbols of joint " + joint["name"], groups.get(joint["name"]) == symbols, str(groups.get(joint["name"]))):
                    break
        # a sweep widens the view by a quarter of the larger side of what the positions take, no matter to which side
        ends = [(min(c), max(c)) for c in ([v for r in row[k] for v in r if v is not None] for k in "xy")]
        border = 0.25*max(b - a for a, b in ends)
        view = case["view"]
        check(law + "the view has what the sweep passes nearby", all(
            view[k] <= v <= view[k + 2] for r in zip(*(case["sweep"][c] for c in "xy")) if isinstance(r[0], list) and isinstance(r[1], list)
            for p in zip(*r) if None not in p and all(a - border < v < b + border for v, (a, b) in zip(p, ends)) for k, v in enumerate(p)))
        fixed = [j for j, joint in enumerate(case["joints"]) if joint["fixed"]]
        check(law + "a joint is fixed where it does not move", all(
            (len(set(zip(row["x"][j], row["y"][j]))) == 1) or j not in fixed for j in range(len(at))))
        letters(law, picture, case, at)
        # what is drawn ends below the head and just above the scale
        x, y, width, height = (float(picture.root.find('.//%sclipPath[@id="area"]/%srect' % (SVG, SVG)).get(k)) for k in ("x", "y", "width", "height"))
        head, scale = (float(picture.of_class("sub")[0].get("y")), float(numbers(picture.root.find('.//%sg[@id="scale"]/%spath' % (SVG, SVG)))[1]))
        page = float(picture.root.get("width"))
        check(law + "the drawing lies between head and scale", head < y < head + 20 and scale - 10 < y + height < scale and x == page - x - width > 0,
              "%s %s %s %s" % (y, height, head, scale))


def letters(law, picture, case, at):
    """Each letter stands beside its own joint, off links, joints and other letters."""
    a, _, _, d, e, f = map(float, picture.root.find('.//%sg[@id="linkage"]' % SVG).get("transform")[7:-1].split())
    places = [None if x is None else (a*x + e, d*y + f) for x, y in at]
    middle = {e.text: (float(e.get("x")), float(e.get("y")) - LETTER_RISE) for e in picture.of_class("letter")}
    names = [joint["name"] for j, joint in enumerate(case["joints"]) if joint["name"] and places[j]]
    check(law + "a letter for each joint", len(names) > CROWD or sorted(middle) == sorted(names), "%s %s" % (sorted(middle), names))
    lines = [(places[bar["from"]], places[bar["to"]]) for bar in case["bars"] if places[bar["from"]] and places[bar["to"]]]
    for j, joint in enumerate(case["joints"]):
        if joint["name"] not in middle or not places[j]:
            continue
        here = middle[joint["name"]]
        own = math.dist(here, places[j])
        others = min([math.dist(here, p) for k, p in enumerate(places) if p and k != j and math.dist(p, places[j]) > 1] + [99])
        apart = min([math.dist(here, m) for name, m in middle.items() if name != joint["name"]] + [99])
        off = min([to_segment(here, *line) for line in lines] + [99])
        if not check(law + "letter %s is beside its joint and off all else" % joint["name"],
                     17 < own < 33 and others > 19 and apart > 20 and off > 10, "%.1f %.1f %.1f %.1f" % (own, others, apart, off)):
            break


def to_segment(p, a, b):
    length = math.dist(a, b)
    t = min(1, max(0, ((p[0] - a[0])*(b[0] - a[0]) + (p[1] - a[1])*(b[1] - a[1]))/length**2)) if length else 0
    return math.dist(p, (a[0] + t*(b[0] - a[0]), a[1] + t*(b[1] - a[1])))


def test_desired_marks():
    """Where the actual values are what is desired, the mark of each desired value stands on that of the actual one."""
    for name in ["dyad2_oscillating_cylinder", "dyad4_slider_crank", "dyad1_crank_rocker", "dyad5_turning_block", "textile",
                 "actuator_rapson_slide"]:
        names, values = device9(name + ".dev9")[0]
        inputs = [float(row[0]) for row in values]
        text, count = re.subn(r"(IKIN|DELT|NDES) *=[^A-Z&]*", "", read(DATA + "/" + name + ".nml"))
        check(name + ": positions taken out", count > 0)
        start = float((re.search(r"CRNKI *= *([-0-9.]+)", text) or ["", "0"])[1])
        items = {"actual": "DESANG", "actual_x": "DESX", "actual_y": "DESY"}
        wanted = ", ".join("%s=%s" % (items[n], ",".join(row[k] for row in values)) for k, n in enumerate(names) if n in items)
        given = "&METHOD NDES=%d, DELT=%s, %s, " % (len(inputs), ",".join(repr(v - start) for v in inputs), wanted)
        write("own.nml", changed(text, "&METHOD ", given))
        code, _, errors = balm("--quiet", "--curves", "own.nml")
        picture = Picture("own.svg")
        marks = [{int(e.get("data-position")): e for e in picture.of_class("output", kind) if e.get("data-position")}
                 for kind in ("actual", "desired")]
        law = name + ", its own outputs desired: "
        check(law + "a mark for each", code == 0 and sorted(marks[0]) == sorted(marks[1]) == list(range(1, len(inputs) + 1)), errors)
        size = max(abs(v) for v in page_data("own.html")[0]["view"])

        def spot(element):
            at = numbers(element) if element.get("d") else place(element)
            return [float(v) for v in at]
        check(law + "desired and actual marks coincide", all(
            all(abs(a - b) <= 1e-9*size for a, b in zip(spot(marks[0][i]), spot(marks[1][i]))) for i in marks[1] if i in marks[0]))
        plot = next(p for p in plots_of("own.curves.svg") if p.name.startswith("error"))
        errors = [p[1] for _, _, line in plot.lines for p in line if p]
        check(law + "no error in the curves", len(errors) == len(inputs)*len(plot.lines) and all(abs(e) <= 1e-3*size for e in errors))
        check(law + "the curves' axis holds every input", plot.first <= min(inputs) + 1e-9 and max(inputs) <= plot.last + 1e-9)



def test_symbols():
    picture = Picture("textile.svg")
    uses = [e.get("href") for e in picture.root.iter(SVG + "use")]
    for symbol in ["#revolute", "#ground", "#prismatic", "#star"]:
        check("textile: symbol " + symbol, symbol in uses)
    check("needle: joint letters from A on", {e.text for e in Picture("needle.svg").of_class("letter")} >= set("ABCDEFGHIJ"))
    layers = {layer.dxf.name for layer in ezdxf.readfile("needle.dxf").layers}
    check("needle: nine layers of links beside the frame", {"LINK_9", "FRAME"} <= layers and "LINK_10" not in layers)
    check("needle: ternary links are plates", len(Picture("needle.svg").of_class("plate")) >= 2)
    bar = next(e for e in Picture("needle.svg").root.iter(SVG + "text") if e.get("data-length"))
    width = float(re.search(r"v8h(\S+?)v", Picture("needle.svg").root.find('.//%sg[@id="scale"]' % SVG)[0].get("d")).group(1))
    scale = float(Picture("needle.svg").root.find('.//*[@id="linkage"]').get("transform")[7:].split()[0])
    check("needle: the scale bar is as long as it says", near(width / scale, float(bar.get("data-length")), 1e-3))
    check("needle: title", "TEN-BAR NEEDLE LINKAGE" in picture_title("needle.svg"))
    for name in ["needle", "textile"]:
        style = read(name + ".svg")
        check(name + ": dark scheme", "prefers-color-scheme:dark" in style)
    write("every.nml", changed(read("needle.nml"), "IPLOT=1", "KTHETA=1"))
    balm("--quiet", "every.nml")
    every = Picture("every.svg").of_class("every")
    check("KTHETA=1 draws every link at every position", len({e.get("data-position") for e in every}) == 19)
    many = ",\n  ".join("%.2f" % (0.36 * i) for i in range(1000))
    write("many.nml", changed(changed(read("dyad1_crank_rocker.nml"), "IKIN=15", "NDES=1000, DELT=" + many), "IPLOT=1", "KTHETA=1"))
    balm("--quiet", "many.nml")
    faint = [float(v) for v in re.findall(r'stroke-opacity="(\S+)"', read("many.svg"))]
    check("a thousand positions are no blot", len(Picture("many.svg").of_class("direction")) == 1000 and
          len(faint) == 1000 and max(faint) < 0.1, "%d" % len(faint))
    check("KTHETA=0 does not", not Picture("needle.svg").of_class("every"))
    angle = Picture("dyad4_slider_crank.svg").root.findall('.//%suse[@href="#prismatic"]' % SVG)[0].get("transform")
    check("prismatic: bases along the slide", "rotate(" in angle)
    plates = [e for name in ("needle", "path18", "brake_reaction") for e in Picture(name + ".svg").of_class("plate")]
    check("plates have an outline", plates and all(float(e.get("stroke-width")) > 0 for e in plates))
    star = {name: float(re.search(r"scale\((\S+)\)", Picture(name + ".svg").root.find('.//*[@id="star"][@transform]').get("transform")).group(1))
            * float(Picture(name + ".svg").root.find('.//%sg[@id="linkage"]' % SVG).get("transform")[7:].split()[0])
            for name in ("needle", "dyad2_oscillating_cylinder")}
    shutil.copy(os.path.join(DATA, "four_bar_haines.nml"), "four_bar_haines.nml")
    balm("--quiet", "four_bar_haines.nml")
    haines = Picture("four_bar_haines.svg")
    check("the star of a direction stands at the end of the pointer", place(haines.root.find('.//*[@id="star"][@transform]')) not in
          list(haines.joints().values()))
    check("a star on a block leaves its symbol visible", near(star["needle"], 1, 1e-3) and star["dyad2_oscillating_cylinder"] < 0.7, str(star))


def test_extreme_lengths():
    """Viewers compute in single precision: lengths beyond it are drawn in another unit."""
    shutil.copy(os.path.join(DATA, "hard", "extreme_lengths.nml"), "extreme_lengths.nml")
    balm("--quiet", "extreme_lengths.nml")
    for number, case in enumerate(page_data("extreme_lengths.html"), 1):
        law = "extreme lengths, case %d: " % number
        picture = Picture("extreme_lengths.svg" if number == 1 else "extreme_lengths.%d.svg" % number)
        group = picture.root.find('.//%sg[@id="linkage"]' % SVG)
        unit, row, reference = float(group.get("data-unit")), case["prescribed"], case["reference"]
        scale = float(group.get("transform")[7:].split()[0])
        check(law + "a scale that viewers can hold", 1e-6 < scale < 1e6 and (unit < 1e-100 or unit > 1e100), "%s %s" % (unit, scale))
        places = {name: tuple(map(float, at)) for name, at in picture.joints().items()}
        size = case["view"][2] - case["view"][0]
        check(law + "places times the unit", len(places) > 2 and all(
            near(places[joint["name"]][k] * unit, row["xy"[k]][j][reference], 1e-14, size)
            for j, joint in enumerate(case["joints"]) if joint["name"] for k in (0, 1)))
        marks = {int(e.get("data-position")): e for e in picture.of_class("output", "actual") if e.get("data-position")}
        check(law + "values keep unit and digits", all(float(e.get("data-value")) == row["actual"][i - 1] for i, e in marks.items()))
        label = next(e for e in picture.root.iter(SVG + "text") if e.get("data-length"))
        bar = float(re.search(r"v8h(\S+?)v", picture.root.find('.//%sg[@id="scale"]' % SVG)[0].get("d")).group(1))
        check(law + "scale bar", near(bar / scale * unit, float(label.get("data-length")), 1e-3) and re.fullmatch(r"[125]E-?1(49|5\d)", label.text), label.text)
    check("an ordinary linkage is drawn in its own unit", "data-unit" not in read("needle.svg"))


def drawn_places(name):
    """Unit of the drawing, and every place and length in it that has all digits, in order."""
    group = Picture(name).root.find('.//%sg[@id="linkage"]' % SVG)
    words = " ".join(e.get(key, "") for e in group.iter() for key in ("d", "transform", "cx", "cy", "r") if e is not group)
    return float(group.get("data-unit", "1")), [float(n) for n in re.findall(r"[-+]?\d\.\d{16}E[-+]\d+", words)]


def test_other_unit():
    """A linkage ever so much larger is the same drawing in another unit: regions, the other assembly, slides, poses, output."""
    for name, regions in (("dyad1_crank_rocker", " &CONSTR NREGN=3, RKIND=1,2,-3, RPLACE=10.0,20.0,60.0,50.0, 0.0,-40.0,10.0,0.0,"
                                                 " 0.0,0.0,300.0,0.0, RLINK=2,2,0, RLOOP=1,1,0 &END\n"),
                          ("dyad4_slider_crank", ""), ("dyad2_oscillating_cylinder", ""), ("needle", "")):
        text = read(os.path.join(DATA, name + ".nml")).rstrip() + "\n" + regions
        drawings = []
        for factor in ("", "E160"):
            def scaled(found):
                return found[1] + re.sub(r"(\d+\.\d*)", r"\1" + factor, found[2])
            large = re.sub(r"((?:ARCL|OUTLK|DESX|DESY|CLEAR)=)([-+0-9.*,\s]+)", scaled, text)
            # of a half-plane the third number is a direction
            large = re.sub(r"(RPLACE=)([-+0-9.,\s]+)", scaled, large).replace("10.0E160,0.0", "10.0,0.0")
            write("unit.nml", large)
            balm("--quiet", "--assemblies", "unit.nml")
            drawings.append(drawn_places("unit.svg"))
        (unit, small), (other, large) = drawings
        size = max(map(abs, small))
        check(name + ": another unit", unit == 1 and other > 1e155 and len(small) == len(large) > 30, (other, len(small), len(large)))
        check(name + ": the same drawing in another unit",
              all(near(a, b * (other / 1e160), 1e-13, size) for a, b in zip(small, large)),
              [(a, b) for a, b in zip(small, large) if not near(a, b * (other / 1e160), 1e-13, size)][:3])


PARALLELOGRAM = """PARALLELOGRAM
 &CHAIN JNT='A','B','C','D', JX=0.0,8.0,1.0,9.0, JY=0.0,0.0,3.0,3.0, LNAME='frame','crank','coupler','rocker', LNK='A B','A C','C D','B D' &END
 &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END
 &OUTPUTS OUTPUT='angle rocker' &END
 &METHOD IKIN=30 &END
 &LIMITS IPROOF=2 &END
"""


def test_proof():
    """What is proven stands on picture and page: rings at the ends of what closes, links as wide as they are, the tightest clearance."""
    balm("--quiet", "--output-dir", ".", os.path.join(DATA, "links_apart.nml"))
    picture, case = Picture("links_apart.svg"), page_data("links_apart.html")[0]
    proof, row, reference = case["proof"], case["prescribed"], case["reference"]
    group = picture.root.find('.//%sg[@id="linkage"]' % SVG)
    wide = [e for e in group.iter() if e.get("class") == "wide"]
    check("links as segments are drawn", len(wide) == len(proof["wide"]) == 6, len(wide))
    place = lambda key, j: row[key][j][reference] if isinstance(row[key][j], list) else row[key][j]
    for element, link in zip(wide, proof["wide"]):
        ends = [float(n) for n in re.findall(r"[-+]?\d\.\d+E[-+]\d+", element.get("d"))]
        check("a link is drawn between its joints", all(near(a, b, 1e-12, 200.0) for a, b in zip(ends, (
            place("x", link["from"]), place("y", link["from"]), place("x", link["to"]), place("y", link["to"])))), ends)
        check("a link is as wide as it is", near(float(element.get("stroke-width")), link["width"], 1e-6, 10.0), element.get("stroke-width"))
    tightest = [one for one in proof["near"] if one["tightest"]]
    check("one clearance is the tightest", len(tightest) == 1, len(tightest))
    mark, way = proof["marks"][tightest[0]["mark"]], tightest[0]["way"]
    told = float(re.search(r"at least ([-\d.]+)", mark["text"])[1])
    apart = math.hypot(way[2] - way[0], way[3] - way[1]) - 0.5 * sum(link["width"] for link in tightest[0]["links"])
    check("the way between them is the clearance", mark["kind"] == "clearance" and near(apart, told, 1e-6, 1.0), (apart, told))
    check("a clearance is drawn from each of its links", all(
        len(one["links"]) == len(re.findall(r"\w-\w", proof["marks"][one["mark"]]["text"].split(":")[0])) for one in proof["near"]))
    check("every clearance has a mark", len(proof["near"]) == sum(m["kind"] == "clearance" for m in proof["marks"]) == 14, len(proof["near"]))
    balm("--quiet", "--output-dir", ".", os.path.join(DATA, "dwell_gap.nml"))
    marks = page_data("dwell_gap.html")[0]["proof"]["marks"]
    ends = [m["input"] for m in marks if m["kind"] == "opens"]
    check("the ends of the gap are marked", len(ends) == 2 and near(ends[0], 285.69600625172651, 1e-12, 360.0) and
          near(ends[1], 285.69701500315786, 1e-12, 360.0), ends)
    rings = [e for e in Picture("dwell_gap.svg").root.iter() if e.get("class") == "proof opens"]
    check("rings where it opens", len(rings) == 2, len(rings))
    # a parallelogram is in line with its frame twice a turn
    write("parallel.nml", PARALLELOGRAM)
    balm("--quiet", "parallel.nml")
    marks = [m for m in page_data("parallel.html")[0]["proof"]["marks"] if m["kind"] == "opens"]
    lines = [turn - math.degrees(math.atan2(3.0, 1.0)) for turn in (180.0, 360.0)]
    check("change points are marked", len(marks) == 2 and all(
        m["text"].startswith("undecided at") and near(m["input"], line, 1e-12, 360.0) for m, line in zip(marks, lines)), marks)
    rings = [e for e in Picture("parallel.svg").root.iter() if e.get("class") == "proof opens"]
    check("rings at change points", len(rings) == 2, len(rings))
    balm("--quiet", "--output-dir", ".", os.path.join(DATA, "wiper.nml"))
    check("nothing is told as proven unasked", "proof" not in page_data("wiper.html")[0], "")


def test_rails():
    """A slide's rail lies along the guide and reaches to its block; a closed linkage shows its output."""
    for name in PLAIN:
        balm("--quiet", "--output-dir", ".", os.path.join(DATA, name + ".nml"))
        picture = Picture(name + ".svg")
        case = page_data(name + ".html")[0]
        row, reference = case["prescribed"], case["reference"]
        check(name + ": the star of the output", len([e for e in picture.of_class("output", "actual") if e.get("id") == "star"]) ==
              int(row["closed"][reference]), row["closed"][reference])
        rails = picture.of_class("rail")
        bars = {(bar["loop"], bar["arc"]): bar for bar in case["bars"]}
        for rail in rails:
            ax, ay, bx, by = map(float, numbers(rail))
            bar = bars[tuple(map(int, rail.get("data-arc").split()))]
            long = math.hypot(bx - ax, by - ay)
            for joint in (bar["from"], bar["to"]):
                x, y = (row[k][joint][reference] - a for k, a in (("x", ax), ("y", ay)))
                along, aside = (x * (bx - ax) + y * (by - ay)) / long, (x * (by - ay) - y * (bx - ax)) / long
                check(name + ": a rail under its slide", abs(aside) < 1e-9 * long and -1e-9 * long <= along <= (1 + 1e-9) * long,
                      (along / long, aside / long))


def test_details():
    """A vibrating link is bent as ssics finds it; a pin in its hole has load and force of contact of bridge."""
    programs = picture_tools.programs
    case = os.path.join(DATA, "rig_coupler.nml")
    balm("--quiet", "--output-dir", ".", case)
    run(os.path.join(programs, "ssics"), "--quiet", "--json", "--output-dir", ".", case)
    blocks = json.loads(read("rig_coupler.ssics.json"))["cases"][0]["blocks"]
    scene = page_data("rig_coupler.html")[0]
    straight, = Picture("rig_coupler.svg").of_class("straight")
    ax, ay, bx, by = map(float, numbers(straight))
    bent, = [e for e in Picture("rig_coupler.svg").of_class("bar") if e.get("d").count("L") > 1]
    places = [float(v) for v in numbers(bent)]
    points = list(zip(places[::2], places[1::2]))
    long = math.hypot(bx - ax, by - ay)
    check("bent link: from joint to joint", {tuple(round(v, 9) for v in p) for p in (points[0], points[-1])} == {
        (round(ax, 9), round(ay, 9)), (round(bx, 9), round(by, 9))}, "%s %s" % (points[0], points[-1]))
    x, y = points[len(points) // 2]
    aside = abs((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / long
    # the second mode has a node there
    metre = blocks["vibration"]["columns"]["length"][0] / long
    wanted = scene["vibration"]["factor"] * abs(blocks["response"]["columns"]["y"][0]) / metre
    check("bent link: its middle is off the line as ssics says", abs(aside - wanted) < 1e-5 * wanted and wanted > 0.01 * long, "%s %s" % (aside, wanted))
    check("bent link: how much larger it is drawn", "bending drawn %g times larger" % scene["vibration"]["factor"] in read("rig_coupler.svg"))
    case = os.path.join(DATA, "bridge", "four_bar_haines.nml")
    balm("--quiet", "--output-dir", ".", case)
    run(os.path.join(programs, "bridge"), "--quiet", "--json", "--output-dir", ".", case)
    blocks = json.loads(read("four_bar_haines.bridge.json"))["cases"][0]["blocks"]
    pin, = [e for e in Picture("four_bar_haines.svg").root.iter(SVG + "g") if e.get("id") == "pin"]
    load = [float(v) for v in pin.get("data-load").split()]
    cycle = blocks["cycle"]["columns"]
    check("pin: its load is that of bridge", all(abs(v - cycle[n][0]) < 1e-9 * max(map(abs, cycle[n])) for v, n in zip(load, ("fx", "fy"))), str(load))
    inputs, force = (blocks["following"]["columns"][n] for n in ("input", "force"))
    k = max(i for i, v in enumerate(inputs) if v <= 360)
    between = force[k] + (360 - inputs[k]) / (inputs[k + 1] - inputs[k]) * (force[k + 1] - force[k])
    check("pin: force of contact is that of bridge", abs(float(pin.get("data-force")) - between) < 1e-6 * max(force), "%s %s" % (pin.get("data-force"), between))
    hole, disc = pin.findall(SVG + "circle")
    beside = 28.0 + 2.0*float(hole.get("r"))
    keys = [float(e.get("x")) for e in Picture("four_bar_haines.svg").root.iter(SVG + "text") if e.get("class") == "key" and e.get("x")]
    check("pin: its words stand beside the hole", min(keys[-2:]) > beside, "%s %s" % (keys, beside))
    touches(disc, hole, "pin: it touches its hole")
    # the reference position is half a degree from the positions that the cycle is known at
    write("between.nml", changed(read(case), "IKIN=5", "NDES=2, DELT=10.0,2.5"))
    balm("--quiet", "between.nml")
    pin, = [e for e in Picture("between.svg").root.iter(SVG + "g") if e.get("id") == "pin"]
    hole, disc = pin.findall(SVG + "circle")
    touches(disc, hole, "pin: between two positions of its cycle it touches its hole, too")


def touches(disc, hole, what):
    aside = math.hypot(float(disc.get("cx")), float(disc.get("cy")))
    check(what, abs(aside + float(disc.get("r")) - float(hole.get("r"))) < 0.01, aside)


def test_bodies():
    """Bars at one joint that never turn against each other are one body, others are not."""
    rigid = 0
    for name in PLAIN:
        balm("--quiet", "--output-dir", ".", os.path.join(DATA, name + ".nml"))
        case = page_data(name + ".html")[0]
        row = case["prescribed"]
        bars = [bar for bar in case["bars"] if bar["slide"] == -1 and bar["length"] > 0]

        def direction(bar, away_from, i):
            other = bar["to"] if bar["from"] == away_from else bar["from"]
            return math.atan2(row["y"][other][i] - row["y"][away_from][i], row["x"][other][i] - row["x"][away_from][i])

        places = [i for i, closed in enumerate(row["closed"]) if closed]
        for number, one in enumerate(bars):
            for two in bars[:number]:
                for joint in {one["from"], one["to"]} & {two["from"], two["to"]}:
                    turns = [direction(one, joint, i) - direction(two, joint, i) for i in places]
                    stays = max(abs(math.sin((turn - turns[0]) / 2)) for turn in turns) < 1e-9
                    rigid += stays
                    check("%s: arcs %d and %d of loops %d and %d: one body" % (name, one["arc"], two["arc"], one["loop"], two["loop"]),
                          (one["body"] == two["body"]) == stays, (stays, one, two))
    check("some links have more than two joints", rigid > 5, rigid)


def test_regions():
    group = " &CONSTR NREGN=3, RKIND=1,2,-3, RLOOP=1,1,0, RLINK=2,2,0, RPLACE=10.0,20.0,60.0,50.0, 0.0,-40.0,10.0,0.0, 0.0,0.0,300.0,0.0 &END\n"
    write("regions.nml", read("dyad1_crank_rocker.nml").rstrip() + "\n" + group)
    code, _, errors = balm("regions.nml")
    check("regions: read as psalm reads them", code == psalm("--quiet", "regions.nml")[0] != 2, errors)
    shapes = Picture("regions.svg").of_class("region")
    check("regions: what trespasses is said", code == 1 and "violated: " in errors and "violated: " in Picture("regions.svg").text() and
          page_data("regions.html")[0]["breaches"], errors)
    check("regions: box", [float(v) for v in re.findall(r"[-+0-9.E]+", shapes[0].get("d"))] == [10, 20, 60, 50, 10])
    check("regions: circle to stay inside of", shapes[2].get("r") == "3.0000000000000000E+02" and "inside" in shapes[2].get("class"))
    x1, y1, x2, y2 = [float(v) for v in re.findall(r"[-+0-9.E]+", shapes[1].get("d"))[:4]]
    check("regions: half-plane", abs(math.degrees(math.atan2(y2 - y1, x2 - x1)) - 10) < 1e-9)
    check("regions: on the page", [r["kind"] for r in page_data("regions.html")[0]["regions"]] == ["box", "half-plane", "circle"])
    write("regions.nml", changed(read("regions.nml"), "RLINK=2,", "RLINK=5,"))
    check("regions: a joint that is not there", balm("regions.nml")[0] == 2 and "RLINK" in Picture("regions.svg").text())
    write("regions.nml", changed(read("regions.nml"), "RLINK=5,", "RLINK=2,"))
    balm("--quiet", "regions.nml")


def picture_title(name):
    return Picture(name).root.find(SVG + "title").text


def test_assemblies():
    """Turning the sign of the pair in ILINK gives the assembly that is drawn in grey."""
    signs = {"dyad1_crank_rocker": ("ILINK=1,2,3,4", "ILINK=1,-2,-3,4"), "dyad2_oscillating_cylinder": None, "dyad3_quick_return": None,
             "dyad4_slider_crank": ("ILINK=1,-2,3,4", "ILINK=1,2,3,4"), "dyad5_turning_block": ("ILINK=1,2,3,4", "ILINK=1,2,-3,4")}
    for name, change in signs.items():
        text = read(name + ".nml")
        if change is None:
            a, b, c, d = re.search(r"ILINK=(-?\d),(-?\d),(-?\d),(-?\d)", text).groups()
            change = ("ILINK=%s,%s,%s,%s" % (a, b, c, d), "ILINK=%s,%d,%d,%s" % (a, -int(b), -int(c), d))
        elif change[0] not in text:
            change = (change[1], change[0])
        check(name + ": signs", change[0] in text)
        write("turned.nml", text.replace(*change))
        balm("--quiet", "--assemblies", name + ".nml")
        balm("--quiet", "turned.nml")
        ghost = Picture(name + ".svg").of_class("ghost")
        check(name + ": a grey assembly", len(ghost) == 1)
        case = page_data("turned.html")[0]
        joint, row = case["pairs"][0]["shared"], case["prescribed"]
        x, y = map(float, numbers(ghost[0])[2:4])
        size = case["view"][2] - case["view"][0]
        check(name + ": the other sign is the grey assembly", abs(x - row["x"][joint][case["reference"]]) < 1e-10 * size and
              abs(y - row["y"][joint][case["reference"]]) < 1e-10 * size)
        picture = Picture(name + ".svg")
        a, b, c, d, e, f = map(float, picture.root.find('.//%sg[@id="linkage"]' % SVG).get("transform")[7:-1].split())
        px, py = a * x + c * y + e, b * x + d * y + f
        height = float(picture.root.get("height"))
        check(name + ": the grey assembly lies in the picture", 40 < px < 920 and 60 < py < height - 40, "%g %g" % (px, py))
        balm("--quiet", name + ".nml")


# ---- messages and awkward places ------------------------------------------------------------------------------------------

def test_messages():
    slider = read("dyad4_slider_crank.nml")
    write("open.nml", changed(slider, "140.0,0.0,10.0", "35.0,0.0,10.0"))
    code, _, errors = balm("open.nml")
    check("open: exit status", code == 1)
    check("open: remark", "link 2 is too short by 15.00000" in errors)
    check("open: on the picture", "Loop 1, dyad of type 4 (arcs 2 and 3), positions 16 to 22: link 2 is too short by 15.00000" in
          Picture("open.svg").text())
    case = page_data("open.html")[0]
    check("open: on the page", any("link 2 is too short" in v["text"] for v in case["prescribed"]["violations"]))
    check("open: the gap is known at every open position of the sweep",
          {b[0] for b in case["sweep"]["broken"]} == {i for i, v in enumerate(case["sweep"]["closed"]) if v == "0"})

    write("nowhere.nml", changed(slider, "140.0,0.0,10.0", "5.0,0.0,60.0"))
    code, _, _ = balm("--quiet", "nowhere.nml")
    picture = Picture("nowhere.svg")
    check("closes nowhere: exit status", code == 1)
    check("closes nowhere: says why", "too short" in picture.text() and "positions 1 to 24" in picture.text())
    check("closes nowhere: the crank and the gap are drawn", picture.of_class("bar") and picture.of_class("broken"))
    check("closes nowhere: no output", not picture.of_class("output", "actual"))
    check("closes nowhere: curves too", balm("--quiet", "--curves", "nowhere.nml")[0] == 1 and
          all("the linkage does not close" in p.words for p in plots_of("nowhere.curves.svg")))
    check("open: curves are not drawn across the gap", balm("--quiet", "--curves", "open.nml")[0] == 1 and all(
        None in p.line("actual" if any(l[0] == "actual" for l in p.lines) else "", "line") and len(p.spans) in (1, 2) and not any(
            a + 1 < q[0] < b - 1 for q in p.line("actual" if any(l[0] == "actual" for l in p.lines) else "", "line") if q for a, b in p.spans) for p in plots_of("open.curves.svg") if "output" in p.name))
    check("closes nowhere: DXF", not ezdxf.readfile("nowhere.dxf").audit().errors)

    text, count = re.subn(r"ILINK=1,(-?)2,", lambda m: "ILINK=1,%s2," % ("" if m.group(1) else "-"),
                          read("dyad2_oscillating_cylinder.nml"))
    check("a bad sign: it was changed", count == 1)
    write("sign.nml", text)
    code, _, errors = balm("sign.nml")
    check("a bad sign: exit status", code == 2)
    check("a bad sign: picture and page show the message", "error: &LINKS ILINK" in Picture("sign.svg").text() and
          page_data("sign.html")[0]["errors"] and not page_data("sign.html")[0]["sound"], errors)
    check("a bad sign: no drawing for CAD", not os.path.exists("sign.dxf"))
    write("typo.nml", changed(slider, "NLOOP", "NLOPP"))
    code, _, errors = balm("typo.nml")
    check("a slip in a name", code == 2 and "did you mean NLOOP" in errors and "did you mean NLOOP" in Picture("typo.svg").text())
    write("both.nml", changed(read("actuator_davis_steering.nml"), "NOUTLK=4, NOUTLP=2", "NOUTLK=4, NOUTLP=7"))
    code, _, _ = balm("--quiet", "both.nml")
    cases = page_data("both.html")
    check("one of two cases is wrong: the other is drawn", code == 2 and cases[0]["sound"] and not cases[1]["sound"] and
          not cases[0]["errors"] and os.path.exists("both.dxf"))
    one = ("ONE OF TWO\n &CHAIN JNT='A','B','C','D', JX=0.0,0.0,40.0,80.0, JY=0.0,30.0,60.0,0.0, LNK='A D','A B','B C','C D' &END\n"
           " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END &LIMITS LAST=%d &END\n &METHOD NDES=1, DELT=5.0%s &END\n")
    write("last.nml", one % (0, ", CRNKI=10.0") + one % (1, ""))
    balm("--quiet", "last.nml")
    check("what is said of the last line of a case is told with it", [
        "last.nml:4: " in " ".join(case["warnings"]) for case in page_data("last.html")] == [True, False])


def test_findings():
    """A message belongs to the case it is about, on its picture and on the page; errors of two origins, and a warning."""
    sound = changed(read("dyad1_crank_rocker.nml"), "IPLOT=1", "IPLOT=1, LAST=0")
    faults = {"errors": [("SETUP", changed(sound, "NOUTLP=1", "NOUTLP=7"), "NOUTLP"), ("reading", changed(sound, "NLOOP=1", "NLOPP=1"), "NLOPP")],
              "warnings": [("title", changed(sound, "WIPER DRIVE, ", "WIPER DRIVE "*8), "title is cut")]}
    for kind, which in faults.items():
        for origin, text, words in which:
            for place in range(3):
                cases = [sound]*3
                cases[place] = text
                write("cases.nml", "".join(cases[:2]) + changed(cases[2], ", LAST=0", ""))
                code, _, errors = balm("cases.nml")
                law = "a finding of %s in case %d of three: " % (origin, place + 1)
                page = page_data("cases.html")
                pictures = [Picture("cases.svg" if k == 0 else "cases.%d.svg" % (k + 1)).text() for k in range(3)]
                check(law + "status and message", code == (2 if kind == "errors" else 0) and words in errors, errors)
                check(law + "the page has it there", [any(words in m for m in case[kind]) for case in page] == [k == place for k in range(3)])
                check(law + "so have the pictures", [words in text for text in pictures] == [k == place for k in range(3)])
                check(law + "the others are drawn", [case["sound"] for case in page] == [kind != "errors" or k != place for k in range(3)])


NASTY = b"</script><script>alert(1)</script> & \"q\" 'x' \\u0041 <!-- \xc3\xa9 \xff\xc3 \x01\x1b ]]>"
NASTY_NAMES = """A <b>&"x' TITLE
 &CHAIN JNT='A<"','B&b','C','D','P]q', JX=0.0,10.0,60.0,75.0,50.0, JY=0.0,25.0,65.0,0.0,95.0,
  LNAME='fr<ame','cr&ank','coup"ler','rock>er', LNK='A<" D','A<" B&b','B&b C P]q','C D' &END
 &DRIVES DRIVE='A<"' &END
 &OUTPUTS OUTPUT='point P]q' &END
 &METHOD IKIN=15 &END
 &LIMITS TANGLE=80.0 &END
 &CONSTR IRANGE=2, NREGN=1, RKIND=3, RJNT='C', RPLACE=1000.0,0.0,10.0,0.0 &END
"""


def test_awkward():
    write("nasty.nml", NASTY + b"\n" + read("needle.nml").split("\n", 1)[1].encode())
    code, _, errors = balm("--quiet", "--curves", "nasty.nml")
    check("a nasty title: exit status", code == 0, errors)
    title = picture_title("nasty.svg")
    check("a nasty title: SVG", title.startswith("</script><script>alert(1)</script> & \"q\" 'x' \\u0041 <!-- \u00e9 \u00ff"), title)
    check("a nasty title: page", page_data("nasty.html")[0]["title"].startswith(title[:40]))
    check("a nasty title: curves", picture_title("nasty.curves.svg") == title and plots_of("nasty.curves.svg"))

    write("names.nml", NASTY_NAMES)
    code, _, errors = balm("--quiet", "names.nml")
    check("nasty names: exit status", code == 0, errors)
    letters = [e.text for e in ElementTree.parse("names.svg").getroot().iter(SVG + "text") if e.get("class") == "letter"]
    check("nasty names: SVG", {'A<"', "B&b", "P]q"} <= set(letters), letters)
    case = page_data("names.html")[0]
    check("nasty names: page", "B&b" in json.dumps(case))
    check("margins that are proven stand on the page",
          any(m["text"].startswith("margin, transmission angle, joints B&b, C, D") for m in case["proof"]["marks"]))

    # the range of the inputs is kept where not all positions are drawn
    delt = ",\n".join("%g" % (0.01 * i) for i in range(2001)) + ",350.0"
    write("thin.nml", "RANGE\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=100.0,60.0,60.0,80.0, GAMA=3*0.0,180.0,\n"
          " NOUTLK=-3, NOUTLP=1 &END\n &METHOD MOTION=0, NDES=2002, DELT=%s &END\n &LIMITS TANGLE=90.0 &END\n &CONSTR IRANGE=1 &END\n" % delt)
    code, _, errors = balm("--quiet", "thin.nml")
    marks = page_data("thin.html")[0]["proof"]["marks"]
    check("many positions: the proof is of all of their range", any(m["kind"] == "opens" for m in marks), marks)
    write("thin_sketch.nml", "SKETCH\n &CHAIN JNT='A','B','C','D', JX=0.0,-4.0,33.0,90.0, JY=0.0,31.0,82.0,5.0, LNK='A D','A B','B C','C D' &END\n"
          " &DRIVES DRIVE='A' &END\n &OUTPUTS OUTPUT='point C','angle C D', DES2=2500*100.0 &END\n"
          " &METHOD NDES=2500, DELT=%s &END\n &LIMITS TANGLE=80.0 &END\n" % ",\n".join("%g" % (0.1 * i) for i in range(2500)))
    code, _, errors = balm("thin_sketch.nml")
    check("many positions of a sketch that has desired values of its second output",
          code == 0 and "of 2500 positions 1251 are drawn" in errors, (code, errors))

    write("empty.nml", "")
    code, _, errors = balm("empty.nml")
    check("an empty file", code == 2 and "the file is empty" in errors and not os.path.exists("empty.svg"))
    check("a missing file", balm("missing.nml")[0] == 3)
    check("a full disk", balm("--output-dir", "/dev/full", "needle.nml")[0] == 3)
    check("an unknown option", balm("--frobnicate", "needle.nml")[0] == 2)
    check("options of balm are not psalm's", psalm("--curves", "needle.nml")[0] == 2)
    code, out, _ = balm("--help")
    check("--help", code == 0 and "Exit status" in out)
    check("--version", re.match(r"balm \d+\.\d+\.\d+\n", balm("--version")[1]))
    os.makedirs("elsewhere", exist_ok=True)
    check("standard input", balm("--quiet", stdin=read("needle.nml").encode(), cwd="elsewhere")[0] == 0 and
          os.path.exists("elsewhere/psalm.svg"))
    check("from another directory", balm("--quiet", "--output-dir", "out", "../needle.nml", cwd="elsewhere")[0] == 0 and
          read_bytes("elsewhere/out/needle.svg") == read_bytes("needle.svg"))
    odd = "it's a \"case\" $(x).nml"
    shutil.copy("needle.nml", odd)
    code, _, errors = balm("--quiet", "--curves", odd)
    check("a name with quotes and blanks", code == 0 and os.path.exists(odd[:-4] + ".curves.svg") and os.path.exists(odd[:-4] + ".html"), errors)
    check("no half-written file is left", not [f for f in os.listdir(".") if f.endswith(".part")])


def read_bytes(name):
    with open(name, "rb") as file:
        return file.read()


def test_curves():
    psalm("--quiet", os.path.join(DATA, "needle_search.nml"), "--output-dir", ".")
    code, _, errors = balm("--quiet", "--curves", "--output-dir", ".", os.path.join(DATA, "needle_search.nml"))
    check("curves: exit status", code == 0, errors)
    number = lambda words: [math.log10(float(v.replace("D", "E"))) for v in words]
    best = plots_of("needle_search.curves.svg")[-1]
    told = re.findall(r"ITERATION +(\d+) +BEST +(\S+)", read("needle_search.dev1"))
    check("curves: convergence is that of device 1", best.name == "objective" and len(told) > 5 and
          follows(best, best.line("best"), list(zip((float(n) for n, _ in told), number(v for _, v in told)))))
    psalm("--quiet", "--output-dir", ".", os.path.join(DATA, "log10.nml"))
    code, _, errors = balm("--quiet", "--curves", "--output-dir", ".", os.path.join(DATA, "log10.nml"))
    plots = plots_of("log10.curves.svg")
    starts = plots[-1]
    told = re.findall(r"START +(\d+) +OBJECTIVE +(\S+)", read("log10.dev1"))
    at, each = [float(n) for n, _ in told], number(v for _, v in told)
    check("curves: objectives of the starts", follows(starts, starts.line("start"), list(zip(at, each))) and len(each) > 5)
    check("curves: best so far", follows(starts, starts.line("best"), [(n, min(each[:i + 1])) for i, n in enumerate(at)]) and "start" in starts.words)
    row = page_data("log10.html")[0]["prescribed"]
    check("curves: the axis shows what is prescribed", near(plots[0].last - plots[0].first, abs(row["delt"][-1] - row["delt"][0]), 1e-6))
    names, rows = device9("needle.dev9")[0]
    balm("--quiet", "--curves", "needle.nml")
    plots = plots_of("needle.curves.svg")
    column = lambda name: [(float(r[names.index("input")]) % 360, float(r[names.index(name)])) for r in rows]
    turned = lambda points: [(p[0] % 360, p[1]) for p in points if p]
    check("curves: actual and desired are those of device 9", follows(plots[0], turned(plots[0].line("", "dots")), column("actual")) and
          follows(plots[0], turned(plots[0].line("desired")), column("desired")))
    check("curves: their marks have all digits of device 9", plots[0].values[""] == [r[names.index("actual")] for r in rows] and
          plots[0].values["desired"] == [r[names.index("desired")] for r in rows])
    case = page_data("needle.html")[0]
    angles = next(p for p in plots if p.name.startswith("transmission"))
    check("curves: transmission angles by the law of cosines", cosine_law(case, angles) and near(angles.line("limits")[0][1], 40, 1e-3))
    engine = os.path.join(DATA, "engine.nml")
    run(os.path.join(picture_tools.programs, "kalm"), "--quiet", "--output-dir", ".", engine)
    names, rows = device9("engine.kalm.dev9")[0]
    code, _, errors = balm("--quiet", "--curves", "--output-dir", ".", engine)
    plots = {p.name: p for p in plots_of("engine.curves.svg")}
    lines = {"drive": ("torque of the drive, N m", ""), "frame_fx": ("force on the frame, N", "x"), "frame_fy": ("force on the frame, N", "y"),
             "frame_m": ("moment on the frame, N m", "")}
    check("curves: panels of the forces", code == 0 and all(name in plots for name, _ in lines.values()), errors)
    for key, (name, label) in lines.items():
        theirs = {round(float(r[0])) % 360: float(r[names.index(key)]) for r in rows if float(r[0]).is_integer()}
        ours = {round(p[0]) % 360: p[1] for p in plots[name].line(label) if p}
        check("curves: %s is that of kalm" % key, len(theirs) == len(rows) and all(abs(ours[i] - v) <= plots[name].error() for i, v in theirs.items()))


def cosine_law(case, plot):
    """The lines of the loops against the triangles of the pairs of links."""
    row, seen = case["sweep"], 0
    for number, loop in enumerate(case["pairs"], 1):
        if loop["type"] != "RRR":
            continue
        points = [p for p in plot.line("loop %d" % number) if p]
        for p, i in zip(points, (i for i in range(row["n"]) if row["closed"][i] == "1")):
            s, j, e = [(at(row, "x", loop[n], i), at(row, "y", loop[n], i)) for n in ("start", "shared", "finish")]
            a, b, c = math.dist(s, j), math.dist(j, e), math.dist(s, e)
            if abs(math.degrees(math.acos((a * a + b * b - c * c) / (2 * a * b))) - p[1]) > plot.error() + 1e-4:
                return False
            seen += 1
    return seen > 0


def at(row, axis, joint, i):
    """A coordinate of a joint in a row of the page; that of a joint which stands still is one number."""
    return row[axis][joint][i] if isinstance(row[axis][joint], list) else row[axis][joint]


def test_colours():
    """One table of colours: the SVG's is that of the pages, in light and dark."""
    source = read(os.path.join(TOP, "src", "picture", "psalm_svg_theme.f90"))
    page = read(os.path.join(TOP, "web", "colours.css"))
    light, dark = page.split("@media", 1)
    ours = re.findall(r"colour_t\('(\w+)', \['(#\w+)', '(#\w+)'\]\)", source)
    check("colours: the SVG has a table", len(ours) >= 20, ours)
    for name, on_light, on_dark in ours:
        for screen, colour in ((light, on_light), (dark, on_dark)):
            found = re.search(r"--%s: (#\w+);" % name, screen).group(1)
            found = found if len(found) == 7 else "#" + "".join(2*c for c in found[1:])
            check("colours: %s is that of the pages" % name, found == colour, (found, colour))
    pictures = sorted(glob.glob("*.svg"))
    check("colours: there are pictures", len(pictures) > 5, pictures)
    for name in pictures:
        style = "".join(re.findall(r"<style>(.*?)</style>", read(name)))
        check(name + ": every colour of its style is known", style and not re.search(r"\$|:[;}]", style), style)


def test_embedded():
    """The page of balm is put together from web/ and its scenes; the sample in web/ is what balm writes."""
    for name in ("needle", "textile", "needle_lsq", "sign", "nasty"):
        page = read(name + ".html")
        write("scenes.json", re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S).group(1))
        code, text, errors = run(os.path.join(TOP, "tools", "embed_page"), "--data", "scenes.json")
        check(name + ": the page is that of web/, then the mark of the run", code == 0 and page.startswith(text)
              and re.fullmatch("<!-- run [0-9A-F]{16} -->\n", page[len(text):]), errors)
        check(name + ": one file that asks for nothing", not re.search(
            r"""(src|href)=["']?(?!data:)[^"' ]|url\(|@import|fetch\(|XMLHttp|eval\(""", page.replace(read("scenes.json"), "")))
    check("embed_page --check", run(os.path.join(TOP, "tools", "embed_page"), "--check")[0] == 0)
    balm("--quiet", "--output-dir", ".", os.path.join(TOP, "web", "sample.nml"))
    sample = json.loads(re.search(r"String\.raw`(.*?)`;", read(os.path.join(TOP, "web", "sample.js")), re.S).group(1))
    check("web/sample.js: as balm writes it", sample["format"] == 1 and alike(sample["cases"], page_data("sample.html")))


def alike(a, b):
    """The same structure, names and texts, numbers to six digits."""
    if isinstance(a, dict):
        return isinstance(b, dict) and a.keys() == b.keys() and all(alike(a[k], b[k]) for k in a)
    if isinstance(a, list):
        return isinstance(b, list) and len(a) == len(b) and all(map(alike, a, b))
    if isinstance(a, float) and isinstance(b, (int, float)) or isinstance(b, float) and isinstance(a, int):
        return near(a, b, 1e-6, 1e-3)
    return a == b


def test_messages_are_short():
    """Pictures name the file, not the way to it, and speak in sentences."""
    os.makedirs("way/there", exist_ok=True)
    shutil.copy("textile.nml", "way/there/textile.nml")
    _, _, errors = balm("way/there/textile.nml")
    check("a warning on standard error has the name as typed", "way/there/textile.nml:3: warning" in errors, errors)
    told = page_data("way/there/textile.html")[0]["warnings"] + [Picture("way/there/textile.svg").text()]
    check("on the pictures it has the file's own", all("textile.nml:3: warning" in t and "way/there" not in t for t in told), str(told))
    check("no capitals of the listing on the page", not re.search(r"\b(LOOP|DYAD|POSITION|ARCS|DEGREES|INPUT)\b", json.dumps(
        [[c["breaches"], c["prescribed"]["violations"], c["sweep"]["violations"]] for c in
         page_data("open.html") + page_data("nowhere.html") + page_data("regions.html")])))


def test_flat_curves():
    """An axis does not magnify the rounding of a constant."""
    balm("--quiet", "--curves", "textile.nml")
    plots = plots_of("textile.curves.svg")[:2]
    size = page_data("textile.html")[0]["view"]
    size = max(size[2] - size[0], size[3] - size[1])
    check("curves: a constant lies in the middle of its axis", plots[1].name.startswith("y of") and near(plots[1].low + plots[1].high, 54, 1e-6) and
          near(plots[1].high - plots[1].low, 0.02 * size, 1e-3), str([plots[1].low, plots[1].high]))
    values = [p[1] for p in plots[0].line("", "line") if p]
    check("curves: what varies fills its axis", near(max(values) - min(values), (plots[0].high - plots[0].low)/1.1, 1e-3))


def test_rate_curves():
    """Velocities and accelerations of page and script are those of kalm, bands those of psalm; further outputs those of CASE.csv."""
    kalm = os.path.join(picture_tools.programs, "kalm")
    plain = changed(read("dyad1_crank_rocker.nml"), "IKIN=15", "IKIN=1")
    write("rated.nml", plain + " &RATES SPEED=300.0, ACCEL=20.0, UNITS='REV/MIN' &END\n &TOLER TOLLEN=0.1, TOLANG=0.05 &END\n")
    code, _, errors = balm("--quiet", "--curves", "rated.nml")
    check("rates: is drawn", code == 0 and plots_of("rated.curves.svg"), errors)
    run(kalm, "--quiet", "rated.nml")
    psalm("--quiet", "rated.nml")
    names, rows = device9("rated.kalm.dev9")[0]
    case = page_data("rated.html")[0]
    check("rates: panels of velocity and acceleration", [panel["name"].split(" of ")[0] for panel in case["panels"]] == ["velocity", "acceleration"] and
          "rad/s^2 (input 31.42 rad/s)" in case["panels"][1]["name"], str([panel["name"] for panel in case["panels"]]))
    for panel, name in zip(case["panels"], ["actual_per_s", "actual_per_s2"]):
        theirs = [float(r[names.index(name)]) for r in rows]
        size = max(map(abs, theirs))
        check("rates: " + name + " of the page", len(theirs) == 360 and all(near(a, b, 1e-7, 1e-3 * size) for a, b in zip(panel["lines"][0]["values"], theirs)))
    drawn = {p.name.split(" of ")[0]: p for p in plots_of("rated.curves.svg")}
    for key, name in (("velocity", "actual_per_s"), ("acceleration", "actual_per_s2")):
        points = [p[1] for p in drawn[key].line("")]
        check("rates: the curve of the %s, which closes" % key, len(points) == len(rows) + 1 and points[-1] == points[0] and all(abs(v - float(r[names.index(name)])) <= drawn[key].error() for v, r in zip(points, rows)))
    names, rows = next(block for block in device9("rated.dev9") if "worst_case" in block[0])
    told = {n: [float(r[names.index(n)]) for r in rows] for n in names if n in ("worst_case", "root_sum_square")}
    band = case["band"]
    check("bands: those of psalm", len(band) == 1 and all(all(near(a, b, 1e-7) for a, b in zip(band[0][ours], told[theirs]))
          for ours, theirs in (("worst", "worst_case"), ("square", "root_sum_square"))), str(names))
    deviation = next(p for p in plots_of("rated.curves.svg") if p.name.startswith("deviation"))
    check("bands: their curves", all([abs(p[1] - v) <= deviation.error() for p, v in zip(deviation.line(label), told[name])] == [True]*360
          for label, name in (("root sum square", "root_sum_square"), ("worst case", "worst_case"))))

    horst = os.path.join(DATA, "horst_suspension.nml")
    psalm("--quiet", "--output-dir", ".", horst)
    code, _, errors = balm("--quiet", "--curves", "--output-dir", ".", horst)
    case = page_data("horst_suspension.html")[0]
    with open("horst_suspension.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    panels = {panel["name"]: panel for panel in case["panels"]}
    at = [round(v) % case["sweep"]["n"] for v in case["prescribed"]["at"]]
    check("outputs of a sketch of dyads: all are on the page", code == 0 and {"rise, length", "shock, length", "leverage"} <= panels.keys() and
          any(name.startswith("acceleration of shock") for name in panels), errors + str(list(panels)))
    check("outputs of a sketch of dyads: those of CASE.csv", all(near(panels[name]["lines"][0]["values"][i], float(row[name.split(",")[0]]), 1e-7, 1.0)
          for name in ("rise, length", "shock, length", "leverage") for i, row in zip(at, rows)))
    stroke = os.path.join(DATA, "adjustable_stroke.nml")
    psalm("--quiet", "--output-dir", ".", stroke)
    code, _, errors = balm("--quiet", "--curves", "--output-dir", ".", stroke)
    scene = page_data("adjustable_stroke.html")[0]
    panel = next((panel for panel in scene["panels"] if panel["name"] == "slide_S1 by length D E, length"), {"lines": []})
    family = [line.split() for line in read("adjustable_stroke.dev9").split("# block sweep\n")[1].splitlines()[1:]]
    check("family: a line for each setting, that of psalm", code == 0 and [line["label"] for line in panel["lines"]] == ["60", "70", "80", "90", "100"] and all(
        near(line["values"][15 * i], float(family[24 * k + i][3]), 1e-7, 1.0) for k, line in enumerate(panel["lines"]) for i in range(24)), errors)
    check("links of a sketch have the user's names", {body.get("name") for body in case["bodies"]} == {"frame", "chainstay", "seatstay", "rocker"})


def beyond_reach(text):
    """Bars and cylinders of a sketch that reaches no prescribed position: lengths as in the sweep; 0 where that reaches none, too."""
    name = changed_case("between.nml", text, "DELT=0.0,0.1,0.2,-0.1,0.0", "DELT=3.0,-3.0,3.0,-3.0,3.0")
    code, _, errors = balm("--quiet", name)
    scene = page_data("between.html")[0]
    number = {joint["name"]: j for j, joint in enumerate(scene["joints"]) if joint["name"]}
    bars = {(bar["from"], bar["to"]): bar for bar in scene["bars"]}
    check("beyond reach: a link is as long as in the drawing", code == 1 and abs(bars[number["H"], number["J"]]["length"] - 0.5) < 1e-9, errors)
    check("beyond reach: cylinders have barrels", all(0 < bar["barrel"] < bar["length"] for bar in scene["bars"] if "barrel" in bar) and
          sum("barrel" in bar for bar in scene["bars"]) == 3)
    changed_case("beyond.nml", text, "DELT=0.0,0.1,0.2,-0.1,0.0", "DELT=3.0,3.1,3.2,3.3,3.4")
    code, _, errors = balm("--quiet", "beyond.nml")
    check("beyond reach: nothing has a length", code == 1 and all(bar["length"] == bar.get("barrel", 0) == 0 for bar in page_data("beyond.html")[0]["bars"]),
          errors)


CHAINS = {"excavator": "B C,D F,G J", "scissors_lift": "P Q", "geared_five_bar": "", "landing_gear": "B L",
          "excavator_envelope": "B C,D F,G J"}  # sketches without loops of dyads, and their cylinders


def larger_group():
    """A larger group is drawn by its loops: its joints are those of CASE.csv, and its links stay rigid wherever it is reached."""
    case = os.path.join(DATA, "stephenson2_six_bar.nml")
    psalm("--quiet", "--output-dir", ".", case)
    code, _, errors = balm("--quiet", "--output-dir", ".", case)
    with open("stephenson2_six_bar.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    scene = page_data("stephenson2_six_bar.html")[0]
    own, sweep = scene["prescribed"], scene["sweep"]
    number = {joint["name"]: j for j, joint in enumerate(scene["joints"]) if joint["name"]}
    place = lambda row, j, i: complex(*(row[c][j][i] if isinstance(row[c][j], list) else row[c][j] for c in "xy"))
    check("larger group: is drawn", code == 0 and set("ABCDEFG") <= set(number), (errors, list(number)))
    check("larger group: joints of the page are those of CASE.csv", all(
        abs(place(own, number[j], i) - complex(float(row[j + ".x"]), float(row[j + ".y"]))) < 1e-9 for j in "ABCDEFG" for i, row in enumerate(rows)))
    lengths = {"BC": 50.0, "BE": 45.0, "CD": abs(40.0 - 5.0j), "DG": abs(20.0 - 55.0j), "FG": 25.0, "EF": abs(40.0 - 10.0j)}
    known = [i for i in range(sweep["n"]) if all(isinstance(sweep[c][number[j]], (int, float)) or sweep[c][number[j]][i] is not None for c in "xy" for j in "ABCDEFG")]
    check("larger group: links stay rigid over the sweep", len(known) > 50 and all(
        abs(abs(place(sweep, number[pair[0]], i) - place(sweep, number[pair[1]], i)) - length) < 1e-7*length for pair, length in lengths.items() for i in known),
        len(known))


def test_chains():
    """Sketches of larger groups and several drives: pictures against CASE.csv, links that stay rigid, cylinders that follow their drives."""
    for name, cylinders in CHAINS.items():
        case = os.path.join(DATA, name + ".nml")
        psalm("--quiet", "--output-dir", ".", case)
        code, _, errors = balm("--quiet", "--curves", "--output-dir", ".", case)
        check(name + ": is drawn", code == 0, errors)
        with open(name + ".csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        scene = page_data(name + ".html")[0]
        own, sweep = scene["prescribed"], scene["sweep"]
        number = {joint["name"]: j for j, joint in enumerate(scene["joints"]) if joint["name"]}
        # a sketch with a geared drive is drawn in the poses of its links and listed by its loops
        check(name + ": joints of the page are those of CASE.csv", all(
            near(own[c][j][i], float(row[joint + "." + c]), 1e-12, 1.0) for joint, j in number.items() for c in "xy" for i, row in enumerate(rows)))
        check(name + ": outputs of the page are those of CASE.csv", all(
            near(curve["prescribed"][i], float(row[curve["name"].split(",")[0]]), 1e-12, 1.0) for curve in scene["curves"] for i, row in enumerate(rows)))
        check(name + ": drives of the page are those of CASE.csv", all(
            drive["prescribed"] == [float(row[list(row)[k]]) for row in rows] for k, drive in enumerate(scene["drives"])))
        at = lambda row, j, i: complex(*(row[c][j][i] if isinstance(row[c][j], list) else row[c][j] for c in "xy"))
        size = max(scene["view"][2] - scene["view"][0], scene["view"][3] - scene["view"][1])
        fixed = [bar for bar in scene["bars"] if bar["slide"] < 0 and "barrel" not in bar]
        check(name + ": links stay rigid over the sweep", sweep["n"] > 100 and all(abs(
            abs(at(sweep, bar["from"], i) - at(sweep, bar["to"], i)) - bar["length"]) < 1e-7 * size for bar in fixed for i in range(sweep["n"])))
        for k, pair in enumerate(filter(None, cylinders.split(","))):
            a, b = (number[joint] for joint in pair.split())
            lengths = [abs(at(sweep, a, i) - at(sweep, b, i)) - scene["drives"][k]["sweep"][i] for i in range(sweep["n"])]
            check(name + ": cylinder %s follows its drive" % pair, max(lengths) - min(lengths) < 1e-7 * size)
            check(name + ": cylinder %s is drawn as one" % pair, any(
                "barrel" in bar and {bar["from"], bar["to"]} == {a, b} and 0 < bar["barrel"] < bar["length"] for bar in scene["bars"]))
        svg = Picture(name + ".svg")
        reference = scene["reference"]
        check(name + ": joints of the SVG", {j: complex(*map(float, p)) for j, p in svg.joints().items() if j} == {
            joint: at(own, j, reference) for joint, j in number.items()})
        drawing = ezdxf.readfile(name + ".dxf")
        check(name + ": the DXF has no errors", not drawing.audit().errors and not drawing.audit().fixes)
        check(name + ": curves", len(plots_of(name + ".curves.svg")) >= len(scene["curves"]) and all(p.lines for p in plots_of(name + ".curves.svg")))
    balm("--quiet", "--output-dir", ".", os.path.join(DATA, "horst_suspension.nml"))
    scales = {panel["name"].split(",")[0]: panel["scale"] for panel in page_data("horst_suspension.html")[0]["panels"]}
    check("suspension: a ratio is drawn by itself, lengths by the size", scales["leverage"] == 1 < scales["rise"] == scales["shock"], scales)
    slides = page_data("scissors_lift.html")[0]
    check("scissors lift: blocks stay on their rails", all(abs(slides["sweep"]["uy"][k][i]) < 1e-9 for k, slide in enumerate(slides["slides"])
          if isinstance(slides["sweep"]["uy"][k], list) for i in range(slides["sweep"]["n"])) and len(slides["slides"]) == 2)
    larger_group()
    test_planetary()
    test_turn_of_wheels()
    test_envelope()


def test_planetary():
    """Gear wheels: pitch circles that touch, rims that roll on each other."""
    write("planet.nml", "A PLANET ON A CARRIER\n &CHAIN JNT='A','P','Q', JX=0.,60.,75., JY=0.,0.,0., LNAME='frame','arm','planet','sun',\n"
          "  LNK='A','A P','P Q','A', GEARA='sun', GEARB='planet', GCARR='arm', GTA=40., GTB=20. &END\n"
          " &DRIVES DRIVE='A','A', DBASE='frame','frame', DLINK='arm','sun', DELT2=3*0.0 &END\n &OUTPUTS OUTPUT='point Q' &END\n"
          " &METHOD NDES=3, DELT=0.,30.,60. &END\n &LIMITS TANGLE=85. &END\n")
    code, _, errors = balm("--quiet", "planet.nml")
    check("planet: is drawn", code == 0, errors)
    scene = page_data("planet.html")[0]
    radii = sorted(wheel["radius"] for wheel in scene["wheels"])
    check("planet: pitch circles by the teeth", near(radii[0], 20, 1e-8) and near(radii[1], 40, 1e-8), str(radii))
    place_of = lambda key, joint, i: scene["sweep"][key][joint][i] if isinstance(scene["sweep"][key][joint], list) else scene["sweep"][key][joint]
    turn = lambda wheel, i: math.degrees(math.atan2(*(place_of(c, wheel["rim"], i) - place_of(c, wheel["centre"], i) for c in "yx")))
    planet = min(scene["wheels"], key=lambda wheel: wheel["radius"])
    last, arm = scene["sweep"]["n"] - 1, 60
    # a planet on a sun that stands: (1 + 40/20) turns of the arm
    check("planet: its rim turns with it", near(math.remainder(turn(planet, last) - turn(planet, 0) - 3 * arm, 360), 0, 1e-5))


def test_turn_of_wheels():
    """Curves over a whole turn that is drawn in the poses of the links: the output is where its joint is, its velocity is its slope."""
    write("rolling.nml", "A WHEEL ON THE FOLLOWER OF A DRAG LINK\n &CHAIN JNT='A','B','C','D','V', JX=0.0,0.0,28.0,10.0,38.0,\n"
          "  JY=0.0,30.0,30.0,0.0,30.0, LNAME='frame','crank','coupler','follower','planet', LNK='A D','A B','B C','C D','C V',\n"
          "  GEARA='frame', GEARB='planet', GCARR='follower', GTA=40.0, GTB=20.0 &END\n &DRIVES DRIVE='A' &END\n"
          " &OUTPUTS OUTPUT='point V' &END\n &METHOD NDES=3, DELT=0.0,100.0,200.0 &END\n")
    code, _, errors = balm("--quiet", "rolling.nml")
    scene = page_data("rolling.html")[0]
    check("rolling wheel: is drawn over a whole turn", code == 0 and not scene["sliding"] and scene["sweep"]["n"] == 360, errors)
    joint = next(j for j, one in enumerate(scene["joints"]) if one["name"] == "V")
    for c, curve in zip("xy", scene["curves"]):
        places = scene["sweep"][c][joint]
        check("rolling wheel: curve of %s" % c, all(near(a, b, 1e-8, 1.0) for a, b in zip(curve["sweep"], places)))
        check("rolling wheel: prescribed positions lie on it", all(near(curve["sweep"][int(at)], value, 1e-8, 1.0)
              for at, value in zip(scene["prescribed"]["at"], curve["prescribed"])))
        velocity = next(one["values"] for panel in scene["panels"] if panel["name"].startswith("velocity of point_V")
                        for one in panel["lines"] if one["label"] == c)
        slopes = [(places[(i + 1) % 360] - places[i - 1]) / math.radians(2.0) for i in range(360)]
        check("rolling wheel: velocity of %s" % c, max(abs(a - b) for a, b in zip(slopes, velocity)) < 2e-3 * max(map(abs, velocity)))


def test_envelope():
    """What the excavator reaches: tips at strokes that are on no grid lie inside the meshes."""
    scene = page_data("excavator_envelope.html")[0]
    meshes = [[complex(*mesh[k:k + 2]) for k in range(0, 8, 2)] for mesh in scene["meshes"]]
    check("envelope: as many meshes as the grid has", len(meshes) == 12 * 8 * 4 + 12 * 3 * 9 + 8 * 3 * 13, str(len(meshes)))
    inside = lambda p, mesh: any(min(((b - a).conjugate() * (p - a)).imag / max(abs(b - a), 1e-12) for a, b in zip(corners, corners[1:] + corners[:1])) > -0.03
                                 for corners in (mesh, mesh[:3], mesh[2:] + mesh[:1]))
    case = read(os.path.join(DATA, "excavator_envelope.nml"))
    low, high = ([float(v) for v in re.search(item + r"=([-\d.,]+)", case)[1].split(",")[:3]] for item in ("DLOW", "DHIGH"))
    values = [[round(a + (b - a) * ((k * f) % 1), 6) for k in range(1, 25)] for a, b, f in zip(low, high, (0.618034, 0.414214, 0.732051))]
    row = lambda numbers: ",".join("%.6f" % v for v in numbers)
    text = re.sub(r"NGRID=.*?&END", "DELT2=%s,\n  DELT3=%s &END" % (row(values[1]), row(values[2])), case, flags=re.S)
    write("anywhere.nml", text.replace("&METHOD &END", "&METHOD NDES=24, DELT=%s &END" % row(values[0])))
    psalm("--quiet", "anywhere.nml")
    with open("anywhere.csv", encoding="utf-8") as file:
        tips = [complex(float(r["T.x"]), float(r["T.y"])) for r in csv.DictReader(file) if r["closed"] == "1"]
    check("envelope: tips anywhere lie in it", len(tips) == 24 and all(any(inside(p, mesh) for mesh in meshes) for p in tips))
    edges = [e for e in ezdxf.readfile("excavator_envelope.dxf").modelspace() if e.dxf.layer == "ENVELOPE"]
    check("envelope: its edges in the DXF", len(edges) == 12 and {len(e.vertices) for e in edges} == {13, 9, 4}, str(len(edges)))
    with open(os.path.join(DATA, "excavator.nml"), encoding="utf-8") as file:
        beyond_reach(file.read())
    check("envelope: on the SVG", 'id="envelope"' in read("excavator_envelope.svg") and "stroke" in read("excavator_envelope.svg"))
    code, _, errors = balm("--quiet", changed_case("grid.nml", case, "NGRID=13,9,4,", "NGRID=13,1,4,"))
    check("envelope: a grid of one value is refused", code == 2 and "NGRID: drive D F needs 2 values or more" in errors, errors)
    code, _, errors = balm("--quiet", changed_case("grid.nml", case, "&METHOD &END", "&METHOD NDES=2, DELT=0.0,0.1 &END"))
    check("envelope: positions beside a grid are refused", code == 2 and "leave NDES out" in errors, errors)


def changed_case(name, text, old, new):
    write(name, changed(text, old, new))
    return name


PARTS = {
    "geometry": test_geometry,
    "drawing": test_drawing,
    "desired_marks": test_desired_marks,
    "symbols": test_symbols,
    "extreme_lengths": test_extreme_lengths,
    "other_unit": test_other_unit,
    "assemblies": test_assemblies,
    "proof": test_proof,
    "rails": test_rails,
    "details": test_details,
    "bodies": test_bodies,
    "regions": test_regions,
    "messages": test_messages,
    "findings": test_findings,
    "awkward": test_awkward,
    "curves": test_curves,
    "colours": test_colours,
    "embedded": test_embedded,
    "short_messages": test_messages_are_short,
    "flat_curves": test_flat_curves,
    "rate_curves": test_rate_curves,
    "cutting": test_cutting,
    "chains": test_chains,
    "pages": test_pages,
    "board": test_board,
}
NEEDED = {"pages": ["messages", "rate_curves", "awkward", "curves"], "embedded": ["messages", "awkward"], "short_messages": ["messages", "regions"]}  # parts whose files another part uses


def main(arguments):
    picture_tools.programs = os.path.abspath(arguments.pop(0))
    only, shots = None, None
    if arguments[:1] == ["--only"]:
        only = arguments[1].split(",")
        only += [needed for name in only for needed in NEEDED.get(name, [])]
    elif arguments:
        shots = os.path.abspath(arguments[0])
        os.makedirs(shots, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        codes = prepare()
        for name, part in PARTS.items():
            if only is None or name in only:
                part(*{"geometry": [codes], "pages": [shots], "board": [shots]}.get(name, []))
        os.chdir("/")
    print("%d passed, %d failed" % (picture_tools.passed, picture_tools.failed))
    return picture_tools.failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
