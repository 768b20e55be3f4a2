"""Linkages from other programs as cases: drawings (DXF), sketches of FreeCAD, linkages of pylinkage, links of PMKS+.

    >>> from psalm import imports
    >>> drawing = imports.read("press.dxf", fixed="A D", drive="A")
    >>> print(drawing.text())           # a case in the notation of the manual
    >>> case = drawing.case()           # the same for the studies

On the command line: `psalm-import FILE > CASE.nml`; `psalm-import --help`. What a file says and a case cannot have is in `notes`.
"""
import argparse
import dataclasses
import io
import json
import math
import os
import re
import sys
import typing
import urllib.parse
import xml.etree.ElementTree
import zipfile
import zlib

SAME = 1e-6           # part of the size: two points so near are one
NEAR_NAME = 0.06      # part of the size: a text so near to a joint is its name
LONGEST_NAME = 31     # characters of a name in a case
MOST_BYTES = 50_000_000  # of a file, and of what is packed in it
MOST_SHAPES = 2000    # lines, polylines and circles: a drawing with more is no sketch of a linkage
MOST_NEARLY = 5       # notes of such joints
NEARLY = 1e-3         # part of the size: two joints so near were perhaps meant to be one
LARGEST = 1e100       # a coordinate; psalm refuses numbers whose squares overflow
FRAME_LAYERS = re.compile(r"^(frame|ground|fixed|base)\b", re.I)
RAIL_LAYERS = re.compile(r"^(slides?|rails?|guides?)\b", re.I)
DXF_UNITS = {1: "inches", 2: "feet", 4: "millimetres", 5: "centimetres", 6: "metres"}  # $INSUNITS
PMKS_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
PMKS_PARTS = 1000.0   # PMKS+ keeps thousandths
READING_FAILED = (AttributeError, ArithmeticError, EOFError, LookupError, NotImplementedError, RecursionError, TypeError, ValueError, zlib.error)
LONGEST_SOURCE = 100  # characters of a file's name, or a link, in a message


class InMemory(str):
    """The name of a file whose bytes are in memory: what `read` takes in place of a path."""
    content: bytes

    def __new__(cls, name: str, content: bytes) -> "InMemory":
        source = super().__new__(cls, name)
        source.content = content
        return source


def opened(source):
    """A file, on disk or in memory, to read bytes from."""
    return io.BytesIO(source.content) if isinstance(source, InMemory) else open(source, "rb")


def size_of(source):
    return len(source.content) if isinstance(source, InMemory) else os.path.getsize(source)


class ImportFailed(ValueError):
    """A file that cannot be read as a linkage, and why."""


@dataclasses.dataclass
class Drawing:
    """A linkage as it is drawn."""
    title: str
    joints: typing.Dict[str, typing.Tuple[float, float]]
    links: typing.List[typing.Tuple[str, typing.List[str]]]                # name, joints; without the frame
    fixed: typing.List[str]                                                # joints of the frame
    slides: typing.List[typing.Tuple[str, str, float, float, float]]       # link, link that slides, a point of the line, degrees
    drive: str = ""
    notes: typing.List[str] = dataclasses.field(default_factory=list)      # what was assumed or left out

    def check(self):
        """Settle the drive. Errors: no frame, a joint without a link, a drive that is none."""
        if not self.links or not self.joints:
            raise ImportFailed("there are no links")
        for name, place in [*self.joints.items(), *((slide[1], slide[2:]) for slide in self.slides)]:
            if len(place) < 2 or not all(math.isfinite(value) and abs(value) < LARGEST for value in place):
                raise ImportFailed("the place of %s is no place: %s" % (name, ", ".join("%g" % value for value in place)))
        if not self.fixed and not any(slide[0] == "frame" for slide in self.slides):
            raise ImportFailed("no joint is fixed; name those of the frame (--fixed 'A D'). Joints: " + self.listed())
        for name in self.fixed + ([self.drive] if self.drive else []):
            if name not in self.joints and name not in self.slide_names():
                raise ImportFailed("there is no joint %r. Joints: %s" % (name, self.listed()))
        alone = [name for name in self.joints if name not in self.fixed and not self.links_of(name)]
        for name in alone:
            self.notes.append("joint %s at (%g, %g) is on no link and left out" % (name, *self.joints[name]))
            del self.joints[name]
        if not self.drive:
            driven = [name for name in self.fixed if len(self.links_of(name)) == 1]
            if not driven and self.slides:
                driven = ["S1"]
            if not driven:
                raise ImportFailed("no joint of the frame holds a single link; name the drive (--drive)")
            self.drive = driven[0]
            self.notes.append("the drive is taken to be %s" % self.drive)
        between = self.driven_between()
        if between:
            self.notes.append("several links turn at %s: the drive is taken to turn %s against %s (DLINK and DBASE of &DRIVES)" % (self.drive, between[1], between[0]))

    def driven_between(self):
        """The links that the drive acts between, where its joint pins more than two: the frame, else the first, and the next."""
        links = (["frame"] if self.drive in self.fixed else []) + self.links_of(self.drive)
        return (links[0], links[1]) if self.drive in self.joints and len(links) > 2 else None

    def listed(self):
        return ", ".join("%s (%g, %g)" % (name, x, y) for name, (x, y) in self.joints.items())

    def links_of(self, joint):
        return [name for name, joints in self.links if joint in joints]

    def slide_names(self):
        return ["S%d" % (k + 1) for k in range(len(self.slides))]

    def output(self):
        """A point that only one link has; else the angle of a link on the frame that is not driven; else a slide."""
        for name, joints in self.links:
            for joint in joints:
                if len(self.links_of(joint)) == 1 and joint not in self.fixed and len(joints) > 1:
                    return "point " + joint
        for name, joints in self.links:
            if any(joint in self.fixed for joint in joints) and self.drive not in joints:
                return "angle " + name
        if self.slides:
            return "slide S%d" % len(self.slides)
        return "angle " + self.links[-1][0]

    def text(self) -> str:
        """The case in the notation of the manual."""
        def quoted(words):
            return wrapped(["'%s'" % word for word in words])

        def numbers(values):
            return wrapped([repr(float(value)) for value in values])

        links = [("frame", self.fixed)] + self.links
        lines = ["! %s" % note for note in self.notes] + [self.title,
                 " &CHAIN JNT=" + quoted(self.joints),
                 "  JX=" + numbers(x for x, y in self.joints.values()),
                 "  JY=" + numbers(y for x, y in self.joints.values()),
                 "  LNAME=" + quoted(name for name, joints in links),
                 "  LNK=" + quoted(" ".join(joints) for name, joints in links)]
        if self.slides:
            lines += ["  NSLIDE=%d, SLNK=%s" % (len(self.slides), quoted(slide[0] for slide in self.slides)),
                      "  SLNK2=" + quoted(slide[1] for slide in self.slides)]
            lines += ["  %s=%s" % (item, numbers(slide[k] for slide in self.slides)) for item, k in (("SLX", 2), ("SLY", 3), ("SLANG", 4))]
        lines[-1] = lines[-1].rstrip(",") + " &END"
        turning = self.drive in self.joints
        between = self.driven_between()
        lines += [" &DRIVES DRIVE='%s'%s &END" % (self.drive, ", DBASE='%s', DLINK='%s'" % between if between else ""), " &OUTPUTS OUTPUT='%s' &END" % self.output(),
                  " &METHOD IKIN=5 &END" if turning else " &METHOD NDES=1, DELT=0.0 &END"]
        return "\n".join(lines) + "\n"

    def case(self):
        """The case for the studies of this package."""
        from . import from_text
        return from_text(self.text())


def wrapped(words):
    lines, line = [], ""
    for word in words:
        if len(line) + len(word) > 100:
            lines.append(line)
            line = "   "
        line += word + ","
    return "\n".join(lines + [line])


def read(source: str, kind: typing.Optional[str] = None, *, fixed: typing.Union[str, typing.Sequence[str]] = (), drive: str = "") -> Drawing:
    """A linkage from a file, or from a link of PMKS+.

    source: a path, a link, or `InMemory`. kind: "dxf", "freecad", "pylinkage" or "pmks"; else by the ending. fixed: joints of the frame,
    where the file does not say it; drive: the joint that is driven. Errors: `ImportFailed`; OSError of the file.
    """
    if kind is None:
        ending = os.path.splitext(source)[1].lower()
        kind = {".dxf": "dxf", ".fcstd": "freecad", ".json": "pylinkage", ".pmks": "pmks"}.get(ending)
        if source.startswith(("http://", "https://")):
            kind = "pmks"
        if kind is None:
            raise ImportFailed("%s: what is it? Give the kind: dxf, freecad, pylinkage or pmks" % source)
    if kind not in KINDS:
        raise ImportFailed("there is no kind %r; there are %s" % (kind, ", ".join(KINDS)))
    if kind != "pmks" or not source.startswith("http"):
        if size_of(source) > MOST_BYTES:
            raise ImportFailed("%s is larger than %d MB" % (source, MOST_BYTES // 1_000_000))
    names = list(dict.fromkeys(fixed.split() if isinstance(fixed, str) else fixed))
    if drive and kind in ("pmks", "pylinkage"):
        raise ImportFailed("a file of this kind says itself what is driven")
    try:
        return KINDS[kind](source, names, drive)
    except ImportFailed:
        raise
    except READING_FAILED as reason:   # what a damaged file, or one of another kind, makes of the readers
        raise ImportFailed("%s cannot be read as %s (%s: %s)" % (source[:LONGEST_SOURCE], kind, type(reason).__name__, str(reason)[:200])) from None


def titled(source):
    stem = os.path.splitext(os.path.basename(source))[0].replace("_", " ").strip()
    return (re.sub(r"[^\x20-\x7e]|[&!]", " ", stem).upper().strip() or "LINKAGE")[:72]


def plain(name, taken, fallback):
    """A name that a case may have, and that is not taken; it leaves room for a number behind it and `block_` before it."""
    own = re.sub(r"[^A-Za-z0-9_]", "_", name.strip())[:LONGEST_NAME - 9].strip("_") or fallback
    if own.lower() in {word.lower() for word in taken} or re.fullmatch(r"[sS]\d+|frame", own):
        own = next("%s_%d" % (own, k) for k in range(2, 100000) if ("%s_%d" % (own, k)).lower() not in {w.lower() for w in taken})
    return own


def letters(k):
    """A, B ... Z, A1, B1 ..."""
    return chr(ord("A") + k % 26) + (str(k // 26) if k >= 26 else "")


class Points:
    """Points that are the same within a small part of the size."""

    def __init__(self, every):
        every = [(float(x), float(y)) for x, y in every]
        if not every:
            raise ImportFailed("there are no lines and no circles")
        if not all(math.isfinite(value) for point in every for value in point):
            raise ImportFailed("a coordinate is no number")
        self.size = max(max(p[k] for p in every) - min(p[k] for p in every) for k in (0, 1))
        if not self.size > 0.0:
            raise ImportFailed("everything lies at one point")
        self.at = []
        self.cells = {}     # numbers of the points in each square as wide as points are the same

    def number(self, point):
        column, row = (math.floor(value / (SAME * self.size)) for value in point)
        near = [k for i in (-1, 0, 1) for j in (-1, 0, 1) for k in self.cells.get((column + i, row + j), ())
                if math.dist(point, self.at[k]) <= SAME * self.size]
        if near:
            return min(near)
        self.cells.setdefault((column, row), []).append(len(self.at))
        self.at.append((float(point[0]), float(point[1])))
        return len(self.at) - 1

    def nearly(self, numbers):
        """Pairs of points that are near to one another, and how far apart they are."""
        order = sorted((self.at[k], k) for k in numbers)
        for i, (a, k) in enumerate(order):
            for b, other in order[i + 1:]:
                if b[0] - a[0] > NEARLY * self.size:
                    break
                if math.dist(a, b) <= NEARLY * self.size:
                    yield k, other, math.dist(a, b)


def distance_from(point, a, b):
    """From a segment; where it lies along it, 0 to 1."""
    ux, uy = b[0] - a[0], b[1] - a[1]
    along = ((point[0] - a[0]) * ux + (point[1] - a[1]) * uy) / max(ux * ux + uy * uy, sys.float_info.min)
    clipped = min(1.0, max(0.0, along))
    return math.hypot(point[0] - a[0] - clipped * ux, point[1] - a[1] - clipped * uy), along


def inside(point, ring):
    """True of a point within a closed line."""
    within = False
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
        if (ay > point[1]) != (by > point[1]) and point[0] < ax + (point[1] - ay) * (bx - ax) / (by - ay):
            within = not within
    return within


def merged(bars):
    """Links that share two joints, or close a triangle of single bars, are one rigid link. `bars`: name and set of joints."""
    links = {number: (name, set(joints)) for number, (name, joints) in enumerate(bars)}
    at = {}     # joint -> links
    for number, (_, joints) in links.items():
        for joint in joints:
            at.setdefault(joint, set()).add(number)

    def beside(number):
        return sorted({other for joint in links[number][1] for other in at[joint] if other > number})

    def rigid_with(number):
        """Links after this one that are rigid with it."""
        others = beside(number)
        own = links[number][1]
        for j in others:
            if len(own & links[j][1]) >= 2:
                return [j]
            for k in beside(j):
                pins = [own & links[j][1], links[j][1] & links[k][1], own & links[k][1]]
                if all(len(pin) == 1 for pin in pins) and len(set.union(*pins)) == 3:
                    return [j, k]
        return []

    again = True
    while again:
        again = False
        for number in sorted(links):
            while number in links:
                others = rigid_with(number)
                if not others:
                    break
                again = True
                for other in others:
                    name, joints = links.pop(other)
                    links[number] = (links[number][0] or name, links[number][1] | joints)
                    for joint in joints:
                        at[joint] = at[joint] - {other} | {number}
    return [links[number] for number in sorted(links)]


def from_geometry(title, shapes, circles, words, fixed, drive, notes):
    """A drawing of lines and circles.

    shapes: (layer, points, closed, outline, is one link with its layer); circles: (layer, centre); words: (text, place). A line is a
    link between its ends, a closed line one between its corners or, if circles lie within it, between their centres. A circle on a line is a
    joint of it. Layers that are called frame, ground, base or fixed hold the frame; slides, rails or guides the lines that blocks slide on.
    """
    if len(shapes) + len(circles) > MOST_SHAPES:
        raise ImportFailed("there are %d lines and circles; a linkage has at most %d: leave in the drawing what belongs to it"
                           % (len(shapes) + len(circles), MOST_SHAPES))
    every = [p for _, points, *_ in shapes for p in points] + [centre for _, centre in circles]
    points = Points(every)
    near = SAME * points.size
    for point in every:     # joints are named as they come
        points.number(point)
    centres = [points.number(centre) for _, centre in circles]
    bars, frame, rails = [], set(), []
    by_layer = {}
    for layer, corners, closed, ring, whole in shapes:
        if RAIL_LAYERS.match(layer):
            rails += [(corners[k], corners[k + 1]) for k in range(len(corners) - 1)]
            continue
        joints = None
        if closed and ring is not None:
            own = {points.number(centre) for other, centre in circles if other == layer} or set(centres)
            within = {k for k in own if inside(points.at[k], ring)}
            on_corners = any(math.hypot(c[0] - points.at[k][0], c[1] - points.at[k][1]) <= near for c in corners for k in centres)
            if within and not on_corners:
                joints = within
        if joints is None:
            joints = {points.number(corner) for corner in corners}
            for k in set(centres):
                pairs = list(zip(corners, corners[1:] + (corners[:1] if closed else [])))
                if any(distance_from(points.at[k], a, b)[0] <= near for a, b in pairs):
                    joints.add(k)
        if FRAME_LAYERS.match(layer):
            frame |= joints
        elif whole:
            by_layer.setdefault(layer, set()).update(joints)
        elif len(joints) > 1:
            bars.append((None, joints))
    frame |= {points.number(centre) for layer, centre in circles if FRAME_LAYERS.match(layer)}
    bars += [(layer, joints) for layer, joints in by_layer.items() if len(joints) > 1]
    if not bars:
        raise ImportFailed("; ".join(["there is no line between two joints"] + notes))
    links = merged(bars)
    used = sorted({k for _, joints in links for k in joints} | frame)
    # names: a short text beside a joint, else letters as they come
    names = {}
    for word, place in words:
        if not re.fullmatch(r"[A-Za-z]\w{0,7}", word) or re.fullmatch(r"[sS]\d+", word) or word in names.values():
            continue
        away = sorted((math.hypot(place[0] - points.at[k][0], place[1] - points.at[k][1]), k) for k in used if k not in names)
        if away and away[0][0] <= NEAR_NAME * points.size:
            names[away[0][1]] = word
    letter = 0
    for k in used:
        if k in names:
            continue
        while letters(letter) in names.values():
            letter += 1
        names[k] = letters(letter)
    notes += ["joints %s and %s are %.2g apart and two joints: draw them at one point if they are one" % (names[k], names[other], away)
              for k, other, away in points.nearly(used)][:MOST_NEARLY]
    taken, named = ["frame"], []
    for number, (layer, joints) in enumerate(sorted(links, key=lambda link: min(link[1])), 1):
        name = plain(re.sub(r"^LINK_", "", layer or "", flags=re.I), taken, "link%d" % number)
        taken.append(name)
        named.append((name, [names[k] for k in sorted(joints)]))
    slides, blocks = [], {}
    for a, b in rails:
        angle = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
        for k in used:
            away, along = distance_from(points.at[k], a, b)
            if away > near or k in frame or k in blocks:
                continue
            block = plain("block_" + names[k], taken, "block")
            taken.append(block)
            blocks[k] = block
            named.append((block, [names[k]]))
            slides.append(("frame", block, *points.at[k], angle))
    drawing = Drawing(title, {names[k]: points.at[k] for k in used}, named, fixed or [names[k] for k in sorted(frame)], slides, drive, notes)
    drawing.check()
    return drawing


def from_dxf(source, fixed, drive):
    """Lines, polylines and circles of the model space."""
    try:
        import ezdxf
        import ezdxf.path
        import ezdxf.recover
    except ImportError:
        raise ImportFailed("DXF is read by ezdxf, which is not installed (pip install ezdxf)") from None
    try:
        document = ezdxf.recover.read(opened(source))[0] if isinstance(source, InMemory) else ezdxf.readfile(source)
    except (ezdxf.DXFError, UnicodeDecodeError) as reason:
        raise ImportFailed("%s: %s" % (source, reason)) from None
    except OSError as reason:
        if reason.errno is not None:
            raise
        raise ImportFailed("%s is no DXF file" % source) from None
    shapes, circles, words, left_out = [], [], [], {}
    # where lines lie on several layers, each layer is a link
    unseen = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
    own_layers = {line.dxf.layer for line in document.modelspace().query("LINE") if line.dxf.layer.lower() not in unseen} - {"0", "Defpoints"}
    own_layers = {layer for layer in own_layers if not FRAME_LAYERS.match(layer) and not RAIL_LAYERS.match(layer)}
    if len(own_layers) < 2:
        own_layers = set()
    hidden, risen = 0, False
    for entity in document.modelspace():
        kind, layer = entity.dxftype(), entity.dxf.layer
        if layer.lower() in unseen:
            hidden += 1
            continue
        if kind == "LINE":
            risen = risen or abs(entity.dxf.start.z - entity.dxf.end.z) > SAME * entity.dxf.start.distance(entity.dxf.end)
            shapes.append((layer, [tuple(entity.dxf.start)[:2], tuple(entity.dxf.end)[:2]], False, None, layer in own_layers))
        elif kind in ("LWPOLYLINE", "POLYLINE"):
            path = ezdxf.path.make_path(entity)
            ring = [tuple(point)[:2] for point in path.flattening(1e-3 * max(path.bbox().size))]
            corners = [tuple(point)[:2] for point in (entity.vertices_in_wcs() if kind == "LWPOLYLINE" else entity.points_in_wcs())]
            closed = bool(entity.closed if kind == "LWPOLYLINE" else entity.is_closed)
            shapes.append((layer, corners, closed, ring if closed else None, False))
        elif kind == "CIRCLE":
            circles.append((layer, tuple(entity.ocs().to_wcs(entity.dxf.center))[:2]))
        elif kind in ("TEXT", "MTEXT"):
            text = entity.dxf.text if kind == "TEXT" else entity.text
            place = entity.ocs().to_wcs(entity.dxf.insert) if kind == "TEXT" else entity.dxf.insert
            words.append((text.strip(), tuple(place)[:2]))
        else:
            left_out[kind] = left_out.get(kind, 0) + 1
    notes = []
    if left_out:
        notes.append("left out of the drawing: %s%s" % (", ".join("%d %s" % (count, kind) for kind, count in sorted(left_out.items())),
                                                       "; explode the blocks to have what is in them" if "INSERT" in left_out else ""))
    if hidden:
        notes.append("what lies on layers that are off or frozen is left out: %d entities" % hidden)
    if risen:
        notes.append("lines rise out of the plane of the drawing: their plan is read")
    unit = DXF_UNITS.get(document.header.get("$INSUNITS", 0))
    if unit:
        notes.append("lengths are %s, as the drawing says" % unit)
    # what the drawings of balm have besides links
    beside = {"OUTPUT", "DESIRED", "ENVELOPE", "POINTS", "TOLERANCES", "NAMES"}
    return from_geometry(titled(source), [s for s in shapes if s[0].upper() not in beside],
                         [("0" if c[0].upper() in ("JOINTS", "HOLES") else c[0], c[1]) for c in circles if c[0].upper() not in beside],
                         words, fixed, drive, notes)


def placement(entry):
    """Origin and axes of a sketch in space; of a document without them those of the document."""
    if entry is None:
        return (0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    x, y, z, w = (float(entry.get("Q%d" % k)) for k in range(4))
    size = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / size, y / size, z / size, w / size
    return tuple(float(entry.get("P" + axis)) for axis in "xyz"), (
        (1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)), (2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
        (2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)))


def to_plane(first, other):
    """From coordinates of one sketch to those of the first, along the normal; None: the planes are not parallel."""
    (origin, axes), (away, turned) = first, other
    if abs(abs(sum(a * b for a, b in zip(axes[2], turned[2]))) - 1.0) > SAME:
        return None

    def in_plane(x, y):
        at = [away[k] - origin[k] + x * turned[0][k] + y * turned[1][k] for k in range(3)]
        return tuple(sum(a * b for a, b in zip(at, axes[k])) for k in range(2))

    return (lambda x, y: (x, y)) if first == other else in_plane


def from_freecad(source, fixed, drive):
    """Sketches of a document of FreeCAD. Of a single sketch each line is a link; of several each sketch is one."""
    try:
        with opened(source) as file, zipfile.ZipFile(file) as packed:
            if packed.getinfo("Document.xml").file_size > MOST_BYTES:
                raise ImportFailed("%s is too large" % source)
            root = xml.etree.ElementTree.fromstring(packed.read("Document.xml"))
    except (zipfile.BadZipFile, KeyError, xml.etree.ElementTree.ParseError) as reason:
        raise ImportFailed("%s is no document of FreeCAD: %s" % (source, reason)) from None
    kinds = {entry.get("name"): entry.get("type") for entry in root.iter("Object") if entry.get("type")}
    shapes, circles, notes, sketches = [], [], [], []
    for data in root.iter("ObjectData"):
        for entry in data.findall("Object"):
            if kinds.get(entry.get("name")) != "Sketcher::SketchObject":
                continue
            label = entry.get("name")
            for item in entry.iter("Property"):
                if item.get("name") == "Label" and item.find("String") is not None:
                    label = item.find("String").get("value")
            place = next((item.find("PropertyPlacement") for item in entry.iter("Property") if item.get("name") == "Placement"), None)
            sketches.append((label, place, [item for item in entry.iter("Property") if item.get("name") == "Geometry"]))
    if not sketches:
        raise ImportFailed("%s has no sketch" % source)
    several = len(sketches) > 1
    left_out = 0
    first = placement(sketches[0][1])
    for label, place, lists in sketches:
        in_plane = to_plane(first, placement(place))
        if in_plane is None:
            raise ImportFailed("%s: the sketches %s and %s do not lie in parallel planes" % (source, sketches[0][0], label))
        for shape in (shape for given in lists for shape in given.iter("Geometry")):
            # before FreeCAD 0.19 an element, then the second of the flags of a sketch's geometry
            flags = "".join(mark.get("geometryModeFlags") or "" for mark in shape.iter("GeoExtension"))
            if flags[-2:-1] == "1" or any(mark.get("value") in ("1", "true") for mark in shape.iter("Construction")):
                continue
            line, circle = shape.find("LineSegment"), shape.find("Circle")
            if line is not None:
                ends = [in_plane(float(line.get(end + "X")), float(line.get(end + "Y"))) for end in ("Start", "End")]
                shapes.append((label, ends, False, None, several))
            elif circle is not None and shape.find("ArcOfCircle") is None:
                circles.append((label if several else "0", in_plane(float(circle.get("CenterX")), float(circle.get("CenterY")))))
            else:
                left_out += 1
    if left_out:
        notes.append("%d curves of the sketches are left out: lines are links, circles are joints" % left_out)
    notes.append("lengths are millimetres")
    return from_geometry(titled(source), shapes, circles, [], fixed, drive, notes)


def from_pylinkage(source, fixed, drive):
    """A mechanism or, as before version 1, a linkage that pylinkage saved as JSON."""
    try:
        with opened(source) as file:
            data = json.loads(file.read().decode("utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as reason:
        raise ImportFailed("%s is no linkage of pylinkage: %s" % (source, reason)) from None
    if isinstance(data, dict) and "links" in data:
        try:
            return from_mechanism(source, data, fixed)
        except ImportFailed:
            raise
        except (AttributeError, IndexError, KeyError, TypeError, ValueError):
            raise ImportFailed("%s is no linkage of pylinkage: a joint or link of it is not complete" % source) from None
    given = data.get("joints") if isinstance(data, dict) else None
    if not isinstance(given, list) or not all(isinstance(joint, dict) for joint in given):
        raise ImportFailed("%s is no linkage of pylinkage: it has no joints" % source)
    places, links, frame, slides, notes, names = {}, [], [], [], [], {}
    drives = []

    def name_of(word):
        if word not in names:
            names[word] = plain(str(word), names.values(), letters(len(names)))
        return names[word]

    def joint_of(given_so, fallback):
        if given_so is None:
            raise ImportFailed("%s: joint %s does not say what it hangs on" % (source, fallback))
        if given_so.get("inline"):
            word = name_of(given_so.get("name") or "%s base" % fallback)
            places[word] = (float(given_so["x"]), float(given_so["y"]))
            if word not in frame:
                frame.append(word)
            return word
        word = names.get(given_so.get("ref"))
        if word not in places:
            raise ImportFailed("%s: joint %s hangs on %s, which does not come before it" % (source, fallback, given_so.get("ref")))
        return word

    def link_with(one, other):
        for joints in links:
            if one in joints and other in joints:
                return joints
        if one in frame and other in frame:
            return frame
        links.append([one, other])
        return links[-1]

    try:
        for joint in sorted(given, key=lambda one: one.get("type") != "Static"):
            kind, called = joint.get("type"), joint.get("name")
            if kind == "Static":
                word = name_of(called)
                places[word] = (float(joint["x"]), float(joint["y"]))
                frame.append(word)
                continue
            first = joint_of(joint.get("joint0"), called)
            word = name_of(called)
            at = (joint.get("x"), joint.get("y"))
            if kind == "Crank":
                angle, radius = float(joint.get("angle") or 0.0), joint.get("distance")
                if None in at:
                    at = (places[first][0] + radius * math.cos(angle), places[first][1] + radius * math.sin(angle))
                places[word] = (float(at[0]), float(at[1]))
                link_with(first, word)
                drives.append(first)
            elif kind == "Fixed":
                second = joint_of(joint.get("joint1"), called)
                if None in at:
                    (ax, ay), (bx, by) = places[first], places[second]
                    turned = math.atan2(by - ay, bx - ax) + float(joint["angle"])
                    at = (ax + joint["distance"] * math.cos(turned), ay + joint["distance"] * math.sin(turned))
                places[word] = (float(at[0]), float(at[1]))
                link_with(first, second).append(word)
            elif kind in ("Revolute", "Pivot"):
                second = joint_of(joint.get("joint1"), called)
                if None in at:
                    raise ImportFailed("%s: joint %s has no coordinates; save the linkage after a step" % (source, called))
                places[word] = (float(at[0]), float(at[1]))
                link_with(first, word)
                link_with(second, word)
            elif kind in ("Prismatic", "Linear"):
                ends = [joint_of(joint.get("joint1"), called), joint_of(joint.get("joint2"), called)]
                if None in at:
                    raise ImportFailed("%s: joint %s has no coordinates; save the linkage after a step" % (source, called))
                places[word] = (float(at[0]), float(at[1]))
                link_with(first, word)
                guide = link_with(*ends)
                (ax, ay), (bx, by) = (places[end] for end in ends)
                slides.append((guide, [word], ax, ay, math.degrees(math.atan2(by - ay, bx - ax))))
            else:
                raise ImportFailed("%s: joints of the type %s are not known" % (source, kind))
    except (TypeError, KeyError, ValueError) as reason:
        if isinstance(reason, ImportFailed):
            raise
        raise ImportFailed("%s: a joint lacks %s" % (source, reason)) from None
    named = [("link%d" % (k + 1), joints) for k, joints in enumerate(links)]
    own = [(next((name for name, joints in named if joints is guide), "frame"), "block_" + block[0], x, y, angle)
           for guide, block, x, y, angle in slides]
    named += [("block_" + block[0], block) for _, block, *_ in slides]
    if len(drives) > 1:
        notes.append("only the first of %d cranks is driven" % len(drives))
    drawing = Drawing(titled(data.get("name") or source), places, named, fixed or frame, own, drives[0] if drives else "", notes)
    drawing.check()
    return drawing


def from_mechanism(source, data, fixed):
    """Joints with places, and links by their joints, as `mechanism_to_json` of pylinkage writes them."""
    names, places, frame, named, slides, notes = {}, {}, [], [], [], []
    for joint in data["joints"]:
        word = plain(str(joint.get("name") or joint["id"]), names.values(), letters(len(names)))
        if None in joint["position"]:
            raise ImportFailed("%s: joint %s has no place; save the mechanism after a step" % (source, joint["id"]))
        names[joint["id"]] = word
        places[word] = tuple(float(value) for value in joint["position"])
        if joint.get("type") == "ground":
            frame.append(word)
        if joint.get("type") == "prismatic":
            axis, through = joint["axis"], joint["line_point"]
            slides.append(("frame", "block_" + word, float(through[0]), float(through[1]), math.degrees(math.atan2(axis[1], axis[0]))))
    taken, drives = ["frame"], []
    for link in data["links"]:
        joints = [names[key] for key in link["joints"]]
        if link.get("type") == "ground":
            frame += [word for word in joints if word not in frame]
            continue
        name = plain(str(link.get("name") or link["id"]), taken, "link%d" % len(taken))
        taken.append(name)
        named.append((name, joints))
        if link.get("type") in ("driver", "arc_driver"):
            drives += [names[link["motor_joint"]]] if link.get("motor_joint") else [word for word in joints if word in frame]
    for joint in data["joints"]:
        if joint.get("type") == "tracker":
            ends = {names[joint["ref_joint1_id"]], names[joint["ref_joint2_id"]]}
            whole = next((joints for _, joints in named if ends <= set(joints)), None)
            if whole is None:
                raise ImportFailed("%s: tracker %s is on no link" % (source, joint["id"]))
            if names[joint["id"]] not in whole:
                whole.append(names[joint["id"]])
    named += [(slide[1], [slide[1][len("block_"):]]) for slide in slides]
    if len(drives) > 1:
        notes.append("only the first of %d drivers is driven" % len(drives))
    drawing = Drawing(titled(data.get("name") or source), places, named, fixed or frame, slides, drives[0] if drives else "", notes)
    drawing.check()
    return drawing


def pmks_number(text):
    """An integer in the digits of PMKS+; one that begins with 0 is negative."""
    value = 0
    for digit in text:
        value = 64 * value + PMKS_DIGITS.index(digit)
    return -value if text.startswith("0") else value


def from_pmks(source, fixed, drive):
    """A link of PMKS+, or a file that holds one, or what stands after the question mark of one."""
    text = source
    if not source.startswith("http"):
        with opened(source) as file:
            text = file.read(MOST_BYTES).decode("utf-8", "replace")
    text = urllib.parse.unquote(text.strip().split("?", 1)[-1])
    # flags, numbers, integers, words; then joints, links, forces and what is chosen, each list with an empty part at its end
    parts = text.split(".")
    try:
        ends = [k for k, part in enumerate(parts) if k >= 4 and part == ""]
        joint_texts, link_texts = parts[4:ends[0]], parts[ends[0] + 1:ends[1]]
        joints, flags = {}, {}
        for part in joint_texts:
            fields = part.split(",")
            bits = PMKS_DIGITS.index(fields[0][0])
            flags[fields[0][1:]] = bits
            name, x, y, angle = fields[1:4] + ["".join(fields[4:5])]
            joints[fields[0][1:]] = (name, *(pmks_number(field) / PMKS_PARTS for field in (x, y, angle)))
        links = []
        for part in link_texts:
            fields = part.split(",")
            if fields[0][0] != "Y":
                continue      # welded to others, whose link has all joints
            own = fields[7:fields.index("", 7)] if "" in fields[7:] else fields[7:]
            links.append((fields[0][1] == "P", fields[1], [joint for joint in own if joint]))
    except (ValueError, IndexError):
        raise ImportFailed("this is no link of PMKS+, or a part of one: lists of joints and of links follow its question mark") from None
    if not joints or not links:
        raise ImportFailed("this is no link of PMKS+: it has no joints")
    notes, names, named, slides, taken = [], {}, [], [], ["frame"]
    for key, (name, *_) in joints.items():
        if not flags[key] & 1:
            names[key] = plain(name, names.values(), letters(len(names)))
    for is_block, name, own in links:
        if any(joint not in joints for joint in own):
            raise ImportFailed("link %s has a joint that is not there" % name)
        turning = [names[joint] for joint in own if joint in names]
        word = plain(name, taken, "link%d" % len(taken))
        taken.append(word)
        named.append((word, turning))
        for joint in own:
            if joint in names:
                continue
            _, x, y, angle = joints[joint]
            if not flags[joint] & 4:
                raise ImportFailed("joint %s slides on a link that moves; only slides on the frame are read" % joint)
            slides.append(("frame", word, x, y, math.degrees(angle)))
    frame = [names[key] for key in names if flags[key] & 4]
    driven = [names.get(key, "S1") for key in joints if flags[key] & 2]
    if any(flags[key] & 8 for key in joints):
        notes.append("welded joints are points of one link")
    notes.append("masses and forces of the file are left out")
    if len(driven) > 1:
        notes.append("only the first of %d drives is driven" % len(driven))
    drawing = Drawing("LINKAGE OF PMKS+" if source.startswith("http") else titled(source),
                      {names[key]: tuple(joints[key][1:3]) for key in names}, named, fixed or frame, slides, driven[0] if driven else "", notes)
    drawing.check()
    return drawing


KINDS = {"dxf": from_dxf, "freecad": from_freecad, "pylinkage": from_pylinkage, "pmks": from_pmks}


def main(arguments: typing.Optional[typing.Sequence[str]] = None) -> int:
    """The command psalm-import. Exit status: 0 done, 2 the file is no linkage, 3 it cannot be read or the case not written."""
    parser = argparse.ArgumentParser(prog="psalm-import", description="A case from a file of another program, on standard output.")
    parser.add_argument("file", help="CASE.dxf, CASE.FCStd, CASE.json of pylinkage, CASE.pmks, or a link of PMKS+")
    parser.add_argument("--kind", choices=sorted(KINDS), help="what the file is, where its ending does not say it")
    parser.add_argument("--fixed", default="", metavar="JOINTS", help="joints of the frame: 'A D'")
    parser.add_argument("--drive", default="", metavar="JOINT", help="the joint that is driven")
    parser.add_argument("--output", metavar="CASE.nml", help="write the case here; a file that is there is kept")
    given = parser.parse_args(arguments)
    try:
        drawing = read(given.file, given.kind, fixed=given.fixed, drive=given.drive)
        text = drawing.text()
        if given.output:
            with open(given.output, "x", encoding="utf-8") as file:
                file.write(text)
        else:
            sys.stdout.write(text)
            sys.stdout.flush()
    except ImportFailed as reason:
        print("psalm-import: %s" % reason, file=sys.stderr)
        return 2
    except OSError as reason:
        print("psalm-import: %s: %s" % (reason.filename or given.output or given.file, reason.strerror), file=sys.stderr)
        return 3
    for note in drawing.notes:
        print("psalm-import: %s" % note, file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
