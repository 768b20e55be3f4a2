#!/usr/bin/env python3
"""Laws that relate one run of the programs to another, from outside.

usage: test/law/laws.py PROGRAM_DIRECTORY. Last line: N passed, N failed.
"""
import csv
import math
import os
import random
import re
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import picture_tools
from picture_tools import DATA, changed, check, psalm, read, run, write

SAMPLES = ["dyad1_crank_rocker", "dyad2_oscillating_cylinder", "dyad3_quick_return", "dyad4_slider_crank", "dyad5_turning_block",
           "dyad6_scotch_yoke", "dyad7_oldham_coupling", "actuator_rapson_slide", "needle", "textile"]


def case(name):
    return read(os.path.join(DATA, name + ".nml"))


def kalm(*arguments):
    return run(os.path.join(picture_tools.programs, "kalm"), *arguments)


def rows(device, block=0):
    """Rows of a block of positions of device 9, as dictionaries of strings."""
    blocks, positions = [], False
    for line in read(device).splitlines():
        if line.startswith("# input"):
            blocks.append((line.split()[1:], []))
            positions = True
        elif line.startswith("# block "):
            positions = False
        elif positions and line.strip() and not line.startswith("#"):
            blocks[-1][1].append(dict(zip(blocks[-1][0], line.split())))
    return blocks[block][1]


def with_items(text, group, items):
    """Items added to a group; items given twice take the last value."""
    return changed(text, "&" + group + " ", "&%s %s, " % (group, items))


def without(text, item):
    """The text without an item and its values, if it has them."""
    return re.sub(r"\b%s *=[^=]*?(?=,?\s*(\b[A-Z]\w*(\(\S*\))? *=|&END))" % item, "", text).replace(", ,", ",")


def block(device, name):
    """Columns of a named block of device 9; words stay words."""
    text = read(device).split("# block %s\n" % name)[1].split("\n\n")[0].splitlines()
    names = text[0].split()[1:]
    values = [[float(word) if re.fullmatch(r"[-+]?\d*\.?\d+\.?(E[-+]?\d+)?|NaN", word) else word for word in line.split()] for line in text[1:] if line.strip()]
    return {n: [row[i] for row in values] for i, n in enumerate(names)}


def test_family():
    """Each curve of a family is the analysis with that dimension; of a sketch that of the same linkage with that exact length."""
    rocker = case("dyad1_crank_rocker")
    write("family.nml", rocker + " &SWEEP SWLINK=3, SWLOOP=1, SWLOW=78.0, SWHIGH=90.0, NSWEEP=4 &END\n")
    check("family: exit status", psalm("--quiet", "family.nml")[0] == 0)
    family = block("family.dev9", "sweep")
    alone = []
    for length in (78.0, 82.0, 86.0, 90.0):
        write("alone.nml", changed(rocker, "120.0,80.0", "120.0,%.1f" % length))
        psalm("--quiet", "alone.nml")
        alone += [float(row["actual"]) for row in rows("alone.dev9")]
    check("family: each curve is an analysis", len(alone) == 96 and all(
        abs((a - b + 180) % 360 - 180) < 1e-9 for a, b in zip(family["OUTPUT"], alone)))
    check("family: settings", sorted(set(family["setting"])) == [78.0, 82.0, 86.0, 90.0])
    sketch = case("adjustable_stroke")
    write("family.nml", sketch)
    code, listing, errors = psalm("--quiet", "family.nml")
    check("family of a sketch: exit status", code == 0, errors)
    family = block("family.dev9", "sweep")
    # the pin E at 70 along the line from D, in the drawing itself; the rod keeps its length
    length = math.dist((95.5, 80.36), (120.0, 0.0))
    moved = [120.0 + 70.0 * (95.5 - 120.0) / length, 70.0 * 80.36 / length]
    write("alone.nml", changed(changed(changed(sketch, "95.5,230.0", "%r,230.0" % moved[0]), "80.36,95.0", "%r,95.0" % moved[1]), "LNK='A D'",
                                "LENP='E F', LENV=%r, LNK='A D'" % math.dist((95.5, 80.36), (230.0, 95.0))))
    psalm("--quiet", "alone.nml")
    theirs = [float(row["actual"]) for row in rows("alone.dev9")]
    ours = [v for v, setting in zip(family["slide_S1"], family["setting"]) if setting == 70.0]
    # a slide's length counts from where its foot was drawn
    check("family of a sketch: each curve is the analysis of a drawing with that length", len(ours) == len(theirs) == 24 and
          all(abs((a - ours[0]) - (b - theirs[0])) < 1e-9 for a, b in zip(ours, theirs)), str(list(zip(ours, theirs))[:3]))
    check("family: the listing has the strokes", re.search(r"^ STROKE +\d", listing, re.M))
    # the angle of the bent rocker, in the drawing itself: E turns about D, which moves no other joint
    write("family.nml", changed(changed(sketch, "SWJNT='D E'", "SWJNT='angle C D D E'"), "SWLOW=60.0, SWHIGH=100.0", "SWLOW=170.0, SWHIGH=190.0"))
    code, listing, errors = psalm("family.nml")
    check("family of an angle: runs", code == 0 and "SETTINGS OF ANGLE C D D E" in listing, errors)
    family = block("family.dev9", "sweep")
    place = {"C": (95.0, 82.0), "D": (120.0, 0.0), "E": (95.5, 80.36), "F": (230.0, 95.0)}
    for setting in (170.0, 190.0):
        along = math.atan2(*[b - a for a, b in zip(place["C"], place["D"])][::-1]) + math.radians(setting)
        length, (x, y) = math.dist(place["D"], place["E"]), place["D"]
        moved = [x + length*math.cos(along), y + length*math.sin(along)]
        write("alone.nml", changed(changed(changed(sketch, "95.5,230.0", "%r,230.0" % moved[0]), "80.36,95.0", "%r,95.0" % moved[1]), "LNK='A D'",
                                    "LENP='E F', LENV=%r, LNK='A D'" % math.dist(place["E"], place["F"])))
        psalm("--quiet", "alone.nml")
        theirs = [float(row["actual"]) for row in rows("alone.dev9")]
        ours = [v for v, s in zip(family["slide_S1"], family["setting"]) if s == setting]
        check("family of an angle: each curve is the analysis of a drawing with that angle", len(ours) == len(theirs) == 24 and all(
            abs((a - ours[0]) - (b - theirs[0])) < 1e-9 for a, b in zip(ours, theirs)), str(list(zip(ours, theirs))[:3]))
    for old, new, words in (("SWJNT='D E'", "SWJNT='place A'", "a length or an angle is swept"), ("SWJNT='D E'", "SWJNT='angle C D E D'", "is between two lines that both move with joint D"),
                            ("SWJNT='D E'", "SWJNT='D A'", "would move joint A, from which the line of a slide is counted: name that joint first"),
                            ("SWJNT='D E'", "SWJNT='A E'", "no link has all these joints"), ("SWJNT='D E'", "SWJNT='D G'", "no joint is called 'G'"),
                            ("SWHIGH=100.0", "SWHIGH=50.0", "must be above SWLOW"), ("SWJNT='D E'", "SWLINK=3", "of a sketch a length or an angle is swept"),
                            ("NSWEEP=5", "NSWEEP=1", "must be from 2 to 99"), ("SWLOW=60.0, ", "", "the lowest setting")):
        write("wrong.nml", changed(sketch, old, new))
        code, _, errors = psalm("--quiet", "wrong.nml")
        check("family: %s is refused" % (new or "no SWLOW"), code == 2 and words in errors and "wrong.nml:14" in errors, errors)


def test_adjustment():
    """What an adjustable member leaves, from differences of analyses and normal equations of one unknown."""
    rocker, lengths, tol, h = case("dyad1_crank_rocker"), [40.0, 120.0, 80.0, 130.0], 0.1, 1e-4
    write("adjust.nml", rocker + " &TOLER TOLARC=4*0.1, ADJUST=1, OUTTOL=0.05 &END\n")
    _, listing, _ = psalm("--quiet", "adjust.nml")
    found = block("adjust.dev9", "adjustment")

    def outputs(values):
        write("alone.nml", changed(rocker, "ARCL=40.0,120.0,80.0,130.0", "ARCL=" + ",".join(map(repr, values))))
        psalm("--quiet", "alone.nml")
        return [float(row["actual"]) for row in rows("alone.dev9")]

    effect = []
    for i in range(4):
        above, below = (outputs([v + (h * side if k == i else 0.0) for k, v in enumerate(lengths)]) for side in (1, -1))
        effect.append([tol * (((a - b + 180) % 360) - 180) / (2 * h) for a, b in zip(above, below)])
    for k, arc in enumerate(found["arc"]):
        v = int(arc) - 1
        unit = [e / tol for e in effect[v]]
        square, worst, travel = [0.0] * len(unit), [0.0] * len(unit), [tol]
        for i in range(4):
            if i == v:
                continue
            setting = sum(a * b for a, b in zip(unit, effect[i])) / sum(a * a for a in unit)
            rest = [e - setting * u for e, u in zip(effect[i], unit)]
            square, worst = [s + r * r for s, r in zip(square, rest)], [w + abs(r) for w, r in zip(worst, rest)]
            travel.append(abs(setting))
        ours = (max(square) ** 0.5, max(worst), sum(t * t for t in travel) ** 0.5, sum(travel))
        theirs = [found[n][k] for n in ("left_root_sum_square", "left_worst_case", "travel_root_sum_square", "travel_worst_case")]
        check("adjustment: arc %d by differences" % arc, all(abs(a - b) < 1e-5 * max(abs(b), 0.01) for a, b in zip(ours, theirs)), "%s %s" % (ours, theirs))
    check("adjustment: the best comes first, all four are there", sorted(found["arc"]) == [1, 2, 3, 4] and
          found["left_root_sum_square"] == sorted(found["left_root_sum_square"]))
    words = [line.split()[-1] for line in listing.split("ONE MEMBER ADJUSTED")[1].splitlines()[4:9]]
    right = ["ALWAYS" if worst <= 0.05 else "RSS" if left <= 0.05 else "NO" for left, worst in zip(found["left_root_sum_square"], found["left_worst_case"])]
    check("adjustment: whether the output's tolerance is kept", words[1:] == right, "%s %s" % (words, right))


def test_desired():
    """What a linkage does, desired of it: no error anywhere, and a total of practically nothing."""
    for name in SAMPLES:
        text = case(name)
        write("own.nml", text)
        psalm("--quiet", "own.nml")
        first = rows("own.dev9")
        inputs = [float(row["input"]) for row in first]
        names = {"actual": "DESANG"} if "actual" in first[0] else {"actual_x": "DESX", "actual_y": "DESY"}
        wanted = ["%s=%s" % (item, ",".join(row[key] for row in first)) for key, item in names.items()]
        start = float((re.search(r"CRNKI *= *([-0-9.]+)", text) or ["", "0"])[1])
        for item in ("IKIN", "NDES", "DELT", "DESANG", "DESX", "DESY", "XADD", "YADD", "IVA", "IVG", "ILKOUT", "INGOUT", "ICRK", "IORIG"):
            text = without(text, item)
        text = with_items(text, "METHOD", "NDES=%d, DELT=%s, %s" % (
            len(inputs), ",".join(repr(v - start) for v in inputs), ", ".join(wanted)))
        write("desired.nml", text)
        code, out, errors = psalm("--quiet", "desired.nml")
        total = re.search(r"TOTAL ERROR\s+(\S+)", out)
        again = rows("desired.dev9")
        scale = max(abs(float(row[key])) for row in first for key in names)
        check(name + ": its own outputs are met", code == 0 and total and float(total[1].replace("D", "E")) < 1e-20*scale**2*len(inputs),
              "%d %s %s" % (code, total and total[1], errors))
        check(name + ": desired columns are what was asked for", len(again) == len(first) and all(
            b[key.replace("actual", "desired")] == a[key] for a, b in zip(first, again) for key in names))


def test_repair():
    """The amount by which a linkage does not close is what it takes to close it, no less."""
    opened = [("dyad1_crank_rocker", "40.0,120.0,80.0,130.0", "40.0,%s,60.0,130.0", 30.0, +1, "BOTH LINKS ARE TOO SHORT"),
              ("dyad1_crank_rocker", "40.0,120.0,80.0,130.0", "40.0,%s,90.0,130.0", 300.0, -1, "THE DIFFERENCE OF THE LINKS IS TOO GREAT"),
              ("dyad2_oscillating_cylinder", "30.0,0.0,15.0,120.0", "30.0,0.0,%s,120.0", 110.0, -1, "GUIDE 3 IS TOO LONG"),
              ("dyad3_quick_return", None, None, 0.0, -1, "GUIDE 2 IS TOO LONG"),
              ("dyad4_slider_crank", "40.0,140.0,0.0,10.0", "40.0,%s,0.0,10.0", 35.0, +1, "LINK 2 IS TOO SHORT"),
              ("dyad5_turning_block", "10.0,0.0,60.0,25.0", "10.0,0.0,%s,25.0", 20.0, +1, "LINK 3 IS TOO SHORT")]
    for name, old, new, length, way, words in opened:
        text = case(name)
        if old is None:
            arcs = re.search(r"ARCL=([^A-Z]*)", text)[1].rstrip(", \n").split(",")
            old, length = ",".join(arcs), 2.0*max(map(float, arcs))
            new = ",".join([arcs[0], "%s"] + arcs[2:])
        law = "%s, %s: " % (name, words.lower())

        def amount(value):
            write("open.nml", changed(text, old, new % repr(value)))
            _, _, errors = psalm("open.nml")
            told = re.findall(words + r" BY ([-0-9.D+]+)", errors)
            return max([float(v.replace("D", "E")) for v in told], default=0.0), "does not close" in errors

        by, is_open = amount(length)
        check(law + "it says so", by > 0 and is_open, str(by))
        check(law + "the amount closes it", amount(length + way*by*(1 + 1e-5)) == (0.0, False))
        check(law + "less does not", amount(length + way*by*(1 - 1e-5))[1])


def test_backwards():
    """A sliding input that goes back: the even steps go back too."""
    text = case("actuator_rapson_slide")
    places = re.search(r"DELT=([-0-9.,]+)", text)[1].rstrip(",").split(",")
    write("forth.nml", text)
    write("back.nml", changed(text, ",".join(places), ",".join(reversed(places))))
    for name in ("forth", "back"):
        psalm("--quiet", name + ".nml")
    forth, back = (rows(name + ".dev9", 1) for name in ("forth", "back"))
    check("361 even steps", len(forth) == len(back) == 361)
    check("they go back", all(abs(float(a["input"]) - float(b["input"])) <= 1e-12*350 and
                              abs(float(a["actual"]) - float(b["actual"])) <= 1e-11 for a, b in zip(forth, reversed(back))))


def test_time():
    """Derivatives by time are those by the input with its speed and acceleration: the chain rule, kalm."""
    speed, accel = 2.5, -0.75
    for name in ("needle", "textile", "dyad4_slider_crank"):
        write("time.nml", case(name).rstrip() + "\n &RATES SPEED=%r, ACCEL=%r, UNITS='RAD/S' &END\n" % (speed, accel))
        kalm("--quiet", "time.nml")
        device, largest = rows("time.kalm.dev9"), 0.0
        for by_input in [key for key in device[0] if key.endswith("_per_rad")]:
            head = by_input[:-len("_per_rad")]
            worst, size = [0.0]*3, [0.0]*3
            for row in device:
                d1, d2, d3 = (float(row[by_input + power]) for power in ("", "2", "3"))
                wanted = (d1*speed, d2*speed**2 + d1*accel, d3*speed**3 + 3*d2*speed*accel)
                for k, value in enumerate(wanted):
                    got = float(row[head + "_per_s" + ("", "2", "3")[k]])
                    worst[k], size[k] = max(worst[k], abs(got - value)), max(size[k], abs(value))
            check("%s: %s by time" % (name, head), all(w <= 1e-13*s for w, s in zip(worst, size)), (worst, size))
            largest = max(largest, min(size))
        check(name + ": there are derivatives", largest > 0)


def margins_of(text):
    """Constraint and numbers of every line of the list of margins."""
    write("margins.nml", text)
    out = psalm("--quiet", "margins.nml")[1]
    part = out[out.index(" MARGINS OF THE CONSTRAINTS"):].split(" LIMITS OF MOTION")[0].splitlines()[2:]
    return [(line[:46].strip(), line[46:].split()) for line in part if line.strip()]


def test_margins():
    """Margins and the places of the output grow with the lengths, and a box is the same whichever corners it is given by."""
    places = "10.0{0},20.0{0},60.0{0},50.0{0}, 0.0,-40.0{0},10.0,0.0, 0.0,0.0,300.0{0},0.0"
    group = " &CONSTR NREGN=3, RKIND=1,2,-3, RLINK=2,2,0, RLOOP=1,1,0, RPLACE=%s &END\n"
    text = case("dyad1_crank_rocker").rstrip() + "\n"
    plain = margins_of(text + group % places.format(""))
    check("margins: an angle and three regions", [line[:8] for line, _ in plain[:4]] == ["TRANSMIS", "REGION 1", "REGION 2", "REGION 3"], plain)
    search = "DESANG=3*90.0, NDES=3, DELT=0.0,10.0,20.0, IVA=1, ISTART=19, NITER=9"
    bounds = margins_of(changed(changed(text, "IKIN=15", search), "TANGLE=70.0,", "TANGLE=70.0, LIMVAL=1, OPLOW=39.0, OPHIGH=43.0,") +
                        " &CONSTR IRANGE=0 &END\n")
    check("margins: an input where there is one", [(name.split(",")[0], len(values)) for name, values in bounds] ==
          [("TRANSMISSION ANGLE", 2), ("BOUND", 1), ("LENGTH", 1)], bounds)
    for corners in ("60.0,50.0,10.0,20.0", "10.0,50.0,60.0,20.0", "60.0,20.0,10.0,50.0"):
        other = margins_of(text + group % places.format("").replace("10.0,20.0,60.0,50.0", corners))
        check("a box by its corners " + corners, other == plain, other)
    edge = " &CONSTR NREGN=1, RKIND=%d, RLINK=2, RLOOP=1, RPLACE=%s &END\n"
    for box, half_plane in (("-9E3,-9E3,9E3,-300.0", "0.0,-300.0,180.0,0.0"), ("-9E3,300.0,9E3,9E3", "0.0,300.0,0.0,0.0"),
                            ("-9E3,-9E3,-300.0,9E3", "-300.0,0.0,90.0,0.0"), ("300.0,-9E3,9E3,9E3", "300.0,0.0,270.0,0.0")):
        both = margins_of(text + edge % (1, box)), margins_of(text + edge % (2, half_plane))
        check("an edge of a box is that of a half-plane " + half_plane, both[0] == both[1] and len(both[0]) > 1, both)
    samples = [("dyad1_crank_rocker", "40.0{0},120.0{0},80.0{0},130.0{0}", group % places, 4),
               ("dyad4_slider_crank", "40.0{0},140.0{0},0.0,10.0{0}", " &CONSTR IRANGE=0 &END\n", 1),
               ("dyad2_oscillating_cylinder", "30.0{0},0.0,15.0{0},120.0{0}", " &CONSTR IRANGE=0 &END\n", 1)]
    for name, lengths, constraints, count in samples:
        text = case(name).rstrip() + "\n"
        plain = margins_of(text + constraints.format(""))
        check(name + ": margins", len(plain) >= count, plain)
        for power, factor in (("E160", 1e160), ("E-160", 1e-160)):
            large = margins_of(changed(text, lengths.format(""), lengths.format(power)) + constraints.format(power))
            check("%s: margins of lengths times 1%s" % (name, power), len(large) == len(plain) and all(
                a[0] == b[0] and a[1][1:] == b[1][1:] and
                abs(number(b[1][0]) - number(a[1][0])*(factor if a[0].startswith(("REGION", "GUIDE", "OFFSET")) else 1.0)) <=
                1e-6*abs(number(b[1][0])) for a, b in zip(plain, large)), large)


def number(word):
    """A number as Fortran writes it, with three digits of exponent and no letter, or with D."""
    return float(re.sub(r"(?<=\d)([-+]\d{3})$", r"E\1", word.replace("D", "E")))


def test_open_rates():
    """kalm where a linkage does not close: told, counted, no number there, and the same numbers elsewhere."""
    write("sound.nml", case("dyad4_slider_crank"))
    write("open.nml", with_items(changed(case("dyad4_slider_crank"), "140.0,0.0,10.0", "35.0,0.0,10.0"), "LIMITS", "KTHETA=1"))
    code, out, errors = kalm("open.nml")
    device = rows("open.kalm.dev9")
    gone = [row for row in device if row["closed"] == "0"]
    check("rates of an open linkage: status", code == 1)
    check("rates of an open linkage: counted", "does not close at %d of %d positions" % (len(gone), len(device)) in errors, errors)
    check("rates of an open linkage: by how much", "LINK 2 IS TOO SHORT BY 15.00000" in errors, errors)
    check("rates of an open linkage: the listing says where", out.count("DOES NOT CLOSE") == len(gone) > 0)
    check("rates of an open linkage: so does device 8", read("open.kalm.dev8").count("DOES NOT CLOSE") == len(gone))
    check("rates of an open linkage: no number", all(set(list(row.values())[2:]) == {"NaN"} for row in gone))
    check("rates of an open linkage: numbers elsewhere", all("NaN" not in row.values() for row in device if row not in gone))
    psalm("--quiet", "open.nml")
    check("arcs of an open linkage: the loop is named", read("open.dev8").count("LOOP 1 DOES NOT CLOSE") == len(gone))


SKETCH = """A SKETCH
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-10.0,60.0,80.0,40.0, JY=0.0,25.0,70.0,0.0,110.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=5 &END
"""


def test_least_angle():
    """TRMIN is 90 less TANGLE, in &LIMITS or &CONSTR, of loops and of sketches; a sketch that is analysed has no limit of its own."""
    write("plain.nml", SKETCH)
    code, out, errors = psalm("plain.nml")
    least = float(re.search(r"Transmission angle +at least ([0-9.]+)", errors).group(1))
    check("a sketch has no limit unless it is asked for", code == 0 and "OUTSIDE" not in out and least < 40.0, (code, least))
    group_of = {"sketch": "JOINTS B, C, D", "loops": "LOOP 1"}
    for text, name in ((SKETCH, "sketch"), (without(case("dyad1_crank_rocker"), "TANGLE"), "loops")):
        if name == "loops":
            write("plain.nml", case("dyad1_crank_rocker"))
            least = float(re.search(r"Transmission angle +at least ([0-9.]+)", psalm("plain.nml")[2]).group(1))
        for asked in (math.floor(least), math.ceil(least)):
            seen = []
            for group, item in (("LIMITS", "TANGLE=%d" % (90 - asked)), ("LIMITS", "TRMIN=%d" % asked), ("CONSTR", "TRMIN=%d" % asked)):
                if "&" + group in text:
                    write("asked.nml", with_items(text, group, item))
                else:
                    write("asked.nml", text.rstrip() + "\n &%s %s &END\n" % (group, item))
                code, out, errors = psalm("asked.nml")
                seen.append((code, out.count("OUTSIDE") > 0))
                if item[:2] == "TR":
                    check(name + ": the margin names TRMIN", "TRANSMISSION ANGLE (TRMIN), %s, DEGREES" % group_of[name] in out, out)
                    check(name + ": the summary names it", "(TRMIN: %d)" % asked in errors, errors)
                    check(name + ": so does a violation", code == 0 or "OUTSIDE TRMIN %d" % asked in out, out)
                    margin = number(re.search(r"ANGLE \(TRMIN\).*DEGREES +(\S+)", out).group(1))
                    check(name + ": margin, least angle", abs(margin - (least - asked)) < 0.3, (margin, least, asked))
                    again = [line for line in read("asked.dev7").splitlines() if "TRMIN" in line]
                    check(name + ": device 7 has it once", len(again) == 1, again)
            check("%s: TRMIN=%d is TANGLE=%d" % (name, asked, 90 - asked), len(set(seen)) == 1, seen)
            check("%s: %d degrees" % (name, asked), seen[0][0] == (asked > least), (seen, least))
    search = changed(changed(SKETCH, "'C D' &END", "'C D', VARY='A B','B C','C D','B P' &END"), "IKIN=5",
                     "NDES=3, DELT=0,30,60, DESX=40,25,10, DESY=110,104,95") + " &SEARCH SOLVER='LSQ', NSTART=20 &END\n"
    for group, held in ((" &CONSTR TRMIN=40.0 &END\n", False), (" &CONSTR TRMIN=40.0, IRANGE=2 &END\n", True)):
        write("search.nml", search + group)
        code, out, errors = psalm("search.nml")
        least = float(re.search(r"Transmission angle +at least ([0-9.]+)", errors).group(1))
        check("TRMIN in a search: where it holds is said", ("holds at the prescribed positions only" in errors) != held, errors)
        check("TRMIN in a search: it holds", code == 0 and (least >= 39.999 or not held), (code, least))
        if held:
            check("TRMIN in a search: proven", "ANGLE (TRMIN), %s" % group_of["sketch"] in out.split("AT LEAST")[1] and "KEPT" in out, out)


def test_both_limits():
    """The limit of the angle binds twice a turn in `data/paths/yu20a_angle.nml`: every seed finds the best linkage known, 1.4555."""
    text = read(os.path.join(DATA, "paths", "yu20a_angle.nml"))
    for seed in (1, 3, 5, 7):
        write("both.nml", changed(text, "VAR=0.0", "VAR=0.0, ISTART=%d" % seed))
        code, out, errors = psalm("--quiet", "both.nml")
        found = number(re.search(r"RANK      OBJECTIVE.*\n +1 +(\S+)", out).group(1))
        check("both limits, seed %d" % seed, code == 0 and abs(found/1.4555 - 1.0) < 0.01, (code, found))


def test_one_linkage():
    """One linkage is listed once: with its pivot at a negative distance, and with CRNKI beside free timing."""
    text = """A PATH OF TEN POINTS
 &CHAIN JNT='A','B','C','D','P', JX=0,-10,60,80,40, JY=0,25,70,0,110,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D',
  VARY='A B','B C','C D','B P','angle B C B P','place D','place A','input' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=10, DELT=0,36,72,108,144,180,216,252,288,324,
  DESX=20,35,50,60,62,55,42,28,18,15, DESY=100,98,99,104,112,120,124,122,116,108 &END
 &SEARCH SOLVER='LSQ', NSTART=%d, NBEST=5 &END
 &CONSTR IRANGE=2, NREGN=2, RKIND=-1,-1, RJNT='A','D', RPLACE=-40,-20,120,60, -40,-20,120,60 &END
 &LIMITS TANGLE=50 &END
"""
    write("ten.nml", text % 100)
    psalm("--quiet", "ten.nml")
    titles = read("ten.dev7").split("\n &CHAIN")[1:]
    drawn = []
    for one in titles:
        numbers = [[float(v) for v in re.split(r"[,\s]+", re.search(item + r"=([-+0-9.E,\s]+)", one).group(1).strip(", \n"))]
                   for item in ("JX", "JY")]
        drawn.append(list(zip(*numbers)))
    check("ranked linkages", len(drawn) > 1, len(drawn))
    for i, a in enumerate(drawn):
        for b in drawn[:i]:
            apart = max(math.dist(p, q) for p, q in zip(a, b))
            check("ranked linkages have their joints at other places", apart > 0.01, (i, apart))


def test_one_verdict():
    """The summary says that a mechanism closes only where every loop does; CSV has it position by position."""
    two = changed(changed(changed(SKETCH, "40.0, JY", "40.0,60.0,75.0, JY"), "'P', JX", "'P','Q','F', JX"), "0.0,110.0", "0.0,110.0,120.0,90.0")
    two = changed(changed(two, "'frame','crank','coupler','rocker'", "'frame','crank','coupler','rocker','link','out'"),
                  "'A D','A B','B C P','C D'", "'A D F','A B','B C P','C D','P Q','Q F'")
    two = changed(two, "'point P'", "'angle rocker','angle out'")
    write("two.nml", two)
    code, out, errors = psalm("--json", "two.nml")
    closed = [row.split(",") for row in read("two.csv").splitlines()]
    column = closed[0].index("closed")
    opens = any(row[column] == "0" for row in closed[1:])
    said = re.search(r"  Closes +(.*)", errors).group(1)
    check("one verdict: a loop opens", opens)
    check("one verdict: the summary says so", "only" in said, said)
    psalm("--links", "two.nml")
    write("loops.nml", read("two.dev7"))
    code, out, errors = psalm("loops.nml")
    by_loops = re.search(r"  Closes +(.*)", errors).group(1)
    check("one verdict: as loops, of which the output needs one", "only" in by_loops and "close everywhere" in by_loops, by_loops)
    one = changed(two, "'angle rocker','angle out'", "'angle rocker'")
    write("one.nml", one)
    said = re.search(r"  Closes +(.*)", psalm("one.nml")[2]).group(1)
    check("one verdict: though it is not asked for", "only" in said, said)


def test_idle_items():
    """Items without effect are named, and the result is that without them."""
    samples = [(SKETCH, "IKIN=5", "IKIN=5, NDES=2, DELT=0.0,10.0", "NDES: has no effect (nor DELT): IKIN asks for"),
               (case("dyad1_crank_rocker"), "IKIN=15", "IKIN=15, DELT=0.0,10.0", "DELT: has no effect: IKIN asks for"),
               (SKETCH, "IKIN=5", "NDES=2, DELT=0.0,10.0, DESANG=1.0,2.0", "DESANG: has no effect: the output is a point"),
               (changed(SKETCH, "point P", "angle rocker"), "IKIN=5", "NDES=2, DELT=0.0,10.0, DESX=1.0,2.0",
                "DESX: has no effect: the output is an angle"),
               (SKETCH, " &METHOD", " &SEARCH SOLVER='LSQ', ORDER=2 &END\n &METHOD", "ORDER: has no effect: it is for free timing")]
    for text, old, new, said in samples:
        write("idle.nml", changed(text, old, new))
        code, out, errors = psalm("idle.nml")
        check("no effect: " + said, said in errors and code < 2, (code, errors))
    write("plain.nml", SKETCH)
    write("idle.nml", changed(SKETCH, "IKIN=5", "IKIN=5, NDES=2, DELT=0.0,10.0"))
    check("no effect: the same listing", psalm("--quiet", "plain.nml")[1] == psalm("--quiet", "idle.nml")[1])


def test_remedy():
    """Where a length ends at a bound that holds by default, the remedy is that of sketches or of loops, and the ratio is told."""
    desired = ",".join("%.4f" % (100.0 + 60.0*(n/10.0)**2) for n in range(11))
    places = ",".join("%.1f" % (6.0*n) for n in range(11))
    sketch = changed(changed(SKETCH, "'point P'", "'angle rocker'"), "IKIN=5", "NDES=11, DELT=%s, DESANG=%s" % (places, desired))
    sketch = changed(sketch, "'C D' &END", "'C D', VARY='A B','B C','C D','input' &END")
    for text, right, wrong in ((sketch, "set VLOW and VHIGH", "LIMVAL"), (None, "set LIMVAL, OPLOW and OPHIGH", "VLOW")):
        if text is None:
            text = changed(changed(case("dyad1_crank_rocker"), "IKIN=15", "NDES=11, DELT=%s, DESANG=%s, IVA=3*1, ICRK=1" % (
                places, desired)), "TANGLE=70.0", "TANGLE=90.0")
        write("bound.nml", text.rstrip() + "\n &SEARCH SOLVER='LSQ', NSTART=50 &END\n")
        errors = psalm("bound.nml")[2]
        told = [line for line in errors.splitlines() if "at the bound that holds where none is given" in line]
        check("remedy: a length at a bound", len(told) == 1, errors)
        check("remedy: " + right, right in errors and wrong not in errors, errors)
        found = re.search(r"\(([0-9.]+)(?:, the longest (length|arc) is ([0-9.]+) times as long)?\); set", errors)
        listing = psalm("--quiet", "bound.nml")[1]
        if right == "set VLOW and VHIGH":
            lengths = [number(v) for v in re.findall(r"^  .* ([-+.\dD]+)$", listing.split("LENGTHS BETWEEN JOINTS")[1].split(" ANGLES")[0], re.M)]
        else:
            lengths = [number(v) for v in re.search(r"ARRAY OF ARC LENGTHS.*\n.*\n +(.*)", listing).group(1).split()]
        ratio = max(lengths)/float(found.group(1)) if found else 0.0
        check("remedy: the ratio", found is not None and (found.group(2) is None and abs(ratio - 1.0) < 1e-4 or found.group(2) is not None and abs(
            ratio/float(found.group(3)) - 1.0) < 1e-3 and (found.group(2) == "length") == (right == "set VLOW and VHIGH")), (errors, lengths))


STRAYED = """SIX-BAR WITH A DWELL OF 60 DEGREES
 &CHAIN JNT='A','B','C','D','P','Q','F', JX=0,-10,60,80,40,120,160, JY=0,25,70,0,110,120,20,
  LNK='A D F','A B','B C P','C D','P Q','Q F', VARY='A B','B C','C D','B P','angle B C B P','P Q','Q F','place F' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle F Q' &END
 &METHOD NDES=8, DELT=0,10,20,30,40,50,60,200, DESANG=7*110,140 &END
 &SEARCH SOLVER='LSQ', FIRST=%d, NSTART=%d, NBEST=2 &END
 &CONSTR IRANGE=2 &END
 &LIMITS TRMIN=30 &END
"""


def test_strayed():
    """Start 6 leads to links of practically no length, beyond the bounds that hold where none are given, start 7 to a linkage within them:
    the first is listed only if it is alone, and called what it is."""
    for first, starts, within in ((6, 1, False), (6, 2, True)):
        write("strayed.nml", STRAYED % (first, starts))
        code, out, errors = psalm("strayed.nml")
        lengths = dict(re.findall(r"^  (\w \w) +([\d.]+)$", out.split("LENGTHS BETWEEN JOINTS")[1].split(" ANGLES")[0], re.M))
        bounds = re.findall(r"^  LENGTH (\w \w): (\S+) TO (\S+)$", out, re.M)
        law = "strayed: starts from %d, %d: " % (first, starts)
        check(law + "found", code == 0 and len(bounds) == 7, errors)
        kept = all(0.9999*float(low) <= float(lengths[name]) <= 1.0001*float(high) for name, low, high in bounds)
        check(law + "lengths within the bounds", kept == within, (lengths, bounds))
        check(law + "what is said", ("beyond the bounds that hold where none are given" in errors) != within and
              ("at the bound that holds where none is given" in errors) == within, errors)


def test_change_of_zero():
    """LARGEST CHANGE: of a variable that was zero, as the place of a pivot at the origin, the change relative to the longest length."""
    text = changed(changed(SKETCH, "'C D' &END", "'C D', VARY='A B','B C','C D','B P','place A' &END"), "IKIN=5",
                   "NDES=4, DELT=0,36,72,108, DESX=20,35,50,60, DESY=100,98,99,104")
    write("zero.nml", text.rstrip() + "\n &SEARCH SOLVER='LSQ', NSTART=5, NBEST=2 &END\n")
    code, out, errors = psalm("zero.nml")
    lengths = dict(re.findall(r"^  (\w \w) +([\d.]+)$", out.split("LENGTHS BETWEEN JOINTS")[1].split(" ANGLES")[0], re.M))
    place = [number(v) for v in re.search(r"ITS PIVOT.*\n +(\S+) +(\S+)", out).groups()]
    given = {"A B": math.hypot(10, 25), "B C": math.hypot(70, 45), "C D": math.hypot(20, 70), "B P": math.hypot(50, 85)}
    changes = [abs(float(lengths[name])/length - 1.0) for name, length in given.items()]
    changes.append(math.hypot(*place)/max(given.values()))
    listed = number(re.search(r"^ +1 .*$", out.split("LARGEST CHANGE")[1], re.M).group(0).split()[5])
    angle = abs(math.atan2(place[1], place[0]))
    check("largest change", code == 0 and any(abs(listed - v) < 1e-3*v for v in (max(changes), max(changes + [angle]))), (listed, changes, angle))


# a pin and two slides turn with the crank: no loop has the pin J2 as a joint; and two loops begin at one pin of the frame, so that L3's
# J5 has no way of arcs to its J2
SLIDING = {
    "a pin and two slides": (""" &CHAIN JNT='J3','J4','J1','J2', JX=-34.077,-51.478,-31.06,-46.004, JY=40.387,-54.86,-54.161,-92.507,
  LNAME='frame','L7','L4','L3','L5','L6','L2','L1', LNK='J2 J1','J4','J3','J2','J3','J4','','J1',
  SNAME='S3','S2','S5','S6','S1','S4', SLNK='L4','L3','frame','L7','L2','L3', SLNK2='L1','L2','L6','L1','L1','L5',
  SLX=-34.56,-77.357,-35.575,-64.706,34.943,16.696, SLY=-50.751,3.416,20.593,2.045,-32.293,75.099,
  SLANG=50.795,-177.478,-87.042,97.054,55.762,-37.994 &END
""", "L7 J4,L4 J3,L3 J2,L5 J3,L6 J4"),
    "a pin of the frame for two": (""" &CHAIN JNT='J3','J5','J2','J6','J1','J7', JX=-43.72,-65.597,-84.013,72.8,49.933,21.725,
  JY=41.404,-63.928,-10.351,-73.21,-10.592,92.52,
  LNAME='frame','L1','L2','L3','L4','L5','L8','L9', LNK='J1','J1','J1 J2','J5 J2','J3','J3 J7','J5 J6','J7 J6',
  SNAME='S1','S2','S3', SLNK='L3','L3','L1', SLNK2='L1','L4','L5', SLX=75.938,-90.08,57.515, SLY=-3.876,2.88,-77.385,
  SLANG=55.901,90.267,17.784 &END
""", "L2 J2,L3 J2 J5,L3 J5 J2,L4 J3,L5 J3 J7,L5 J7 J3,L8 J5 J6,L8 J6 J5,L9 J7 J6,L9 J6 J7")}


def test_forces_on_slides():
    """A load at a joint: the drive's torque by virtual work. A mass there: its energy by the joint's speed."""
    for name, (chain, places) in SLIDING.items():
        for place in places.split(","):
            write("slide.nml", "FORCES\n" + chain + " &DRIVES DRIVE='J1', DBASE='frame', DLINK='L1' &END\n &METHOD NDES=3, DELT=-1.0,0.0,1.0 &END\n"
                  " &RATES SPEED=2.0 &END\n &MASSES NMASS=1, MNAME='%s', MASS=3.0, UNITL=0.001 &END\n" % place)
            code, _, errors = kalm("--quiet", "slide.nml")
            moving = joints_of("slide.kalm.csv", place.split()[1])
            check("%s, mass at %s: energy" % (name, place), code == 0 and all(
                abs(row["kinetic"] - 1.5e-6*(vx*vx + vy*vy)) <= 1e-12*row["kinetic"] + 1e-15 for row, vx, vy in moving), errors)
            write("slide.nml", changed(read("slide.nml"), " &MASSES NMASS=1, MNAME='%s', MASS=3.0, UNITL=0.001" % place,
                                       " &LOADS NLOAD=1, LNAME='%s', LFX=7.0, LFY=-3.0" % place))
            code, _, errors = kalm("--quiet", "slide.nml")
            moving = joints_of("slide.kalm.csv", place.split()[1])
            check("%s, load at %s: torque" % (name, place), code == 0 and all(
                abs(row["drive"] + (7.0*vx - 3.0*vy)/2.0) <= 1e-11*(abs(vx) + abs(vy)) + 1e-9 for row, vx, vy in moving), errors)


def test_driven_slide():
    """The loops of a sketch driven along a slide move as its poses do, whichever link of the slide is named first."""
    for first, second in (("frame", "ram"), ("ram", "frame")):
        write("driven.nml", "DRIVEN\n &CHAIN JNT='B','C','D', JX=0.0,60.0,90.0, JY=10.0,50.0,0.0, LNAME='frame','ram','rod','rocker',\n"
              "  LNK='D','B','B C','C D', SLNK='%s', SLNK2='%s', SLX=0.0, SLY=10.0, SLANG=20.0 &END\n &OUTPUTS OUTPUT='point C' &END\n"
              " &DRIVES DRIVE='S1', DBASE='frame', DLINK='ram' &END\n &METHOD NDES=3, DELT=-6.0,0.0,9.0 &END\n" % (first, second))
        code, _, errors = psalm("--quiet", "driven.nml")
        lines = read("driven.csv").split()
        table = [dict(zip(lines[0].split(","), map(float, line.split(",")))) for line in lines[1:]]
        ours = [(float(row["actual_x"]), float(row["actual_y"])) for row in rows("driven.dev9")]
        check("driven slide of %s and %s: it closes" % (first, second), code == 0 and len(table) == len(ours) == 3, errors)
        for row, (x, y) in zip(table, ours):
            along = row["input"]
            check("driven slide of %s and %s: the ram at %g" % (first, second, along),
                  abs(row["B.x"] - along*math.cos(math.radians(20.0))) + abs(row["B.y"] - 10.0 - along*math.sin(math.radians(20.0))) < 1e-12)
            check("driven slide of %s and %s: loops and poses at %g" % (first, second, along),
                  abs(x - row["C.x"]) + abs(y - row["C.y"]) < 1e-11, "%g %g, %g %g" % (x, y, row["C.x"], row["C.y"]))


def joints_of(table, joint):
    """Rows of a table with the velocity of a joint, if one is named."""
    lines = read(table).split()
    found = [dict(zip(lines[0].split(","), map(float, line.split(",")))) for line in lines[1:]]
    return [(row, row[joint + ".vx"], row[joint + ".vy"]) if joint else (row, 0.0, 0.0) for row in found]


SHOES = {  # links, slides and drive of a sketch; {0} and {1} are the two links of the slide
    "slider-crank": ("JNT='A','B','C','Q','R', JX=0.0,0.0,136.0,-50.0,-30.0, JY=0.0,40.0,10.0,0.0,0.0, LNAME='frame','crank','rod','piston'{idle},"
                     "\n  LNK='A{q}','A B','B C','C'{qr}, SLNK='{0}', SLNK2='{1}', SLX=151.0, SLY=14.0, SLANG=8.0",
                     ("frame", "piston"), "A", "crank"),
    "slider-crank, rod drawn last": (
        "JNT='A','B','C','Q','R', JX=0.0,0.0,136.0,-50.0,-30.0, JY=0.0,40.0,10.0,0.0,0.0, LNAME='frame','crank','piston','rod'{idle},"
        "\n  LNK='A{q}','A B','C','B C'{qr}, SLNK='{0}', SLNK2='{1}', SLX=120.0, SLY=10.0, SLANG=180.0", ("frame", "piston"), "A", "crank"),
    "quick return": ("JNT='A','B','D','C','Q','R', JX=0.0,20.0,0.0,40.0,-50.0,-30.0, JY=0.0,35.0,-90.0,70.0,0.0,0.0,"
                     "\n  LNAME='frame','crank','block','lever'{idle}, LNK='A D{q}','A B','B','D C'{qr},"
                     " SLNK='{0}', SLNK2='{1}', SLX=26.0, SLY=40.0, SLANG=81.0", ("lever", "block"), "A", "crank"),
    "slide of a rod": ("JNT='A','B','D','C','Q','R', JX=0.0,20.0,90.0,130.0,-50.0,-30.0, JY=0.0,35.0,0.0,-10.0,0.0,0.0,"
                       "\n  LNAME='frame','crank','rod','pendulum'{idle}, LNK='A D{q}','A B','B C','D'{qr},"
                       " SLNK='{0}', SLNK2='{1}', SLX=60.0, SLY=30.0, SLANG=-25.0", ("rod", "pendulum"), "A", "crank"),
    "driven ram": ("JNT='B','C','D','Q','R', JX=0.0,60.0,90.0,-50.0,-30.0, JY=10.0,50.0,0.0,0.0,0.0, LNAME='frame','ram','rod','rocker'{idle},"
                   "\n  LNK='D{q}','B','B C','C D'{qr}, SLNK='{0}', SLNK2='{1}', SLX=-12.0, SLY=6.0, SLANG=20.0", ("frame", "ram"), "S1", "ram"),
}


def shoe_case(name, order, radius, idle):
    """Loads of a sketch with friction in its shoe, solved dyad by dyad, or in its poses for the sake of an idle link driven elsewhere."""
    chain, links, joint, driven = SHOES[name]
    links = links[::order]
    chain = chain.format(*links, idle=",'idle'" if idle else "", q=" Q" if idle else "", qr=",'Q R'" if idle else "")
    if not idle:
        chain = chain.replace(",'Q','R'", "").replace(",-50.0,-30.0", "").replace(",0.0,0.0, LNAME", ", LNAME").replace(",0.0,0.0,\n", ",\n")
    steps = "-9.0,0.0,7.0,16.0" if joint == "S1" else "-10.0,0.0,20.0,55.0,80.0"
    drives = "DRIVE='%s'%s, DBASE='frame'%s, DLINK='%s'%s" % (joint, ",'Q'" if idle else "", ",'frame'" if idle else "", driven,
                                                              ",'idle'" if idle else "")
    if idle:
        drives += ", DELT2=%s, DSPEED=0.0,1.0" % ",".join("0.0" for _ in steps.split(","))
    write("shoe.nml", "SHOE\n &CHAIN %s &END\n &DRIVES %s &END\n &OUTPUTS OUTPUT='point C' &END\n &METHOD NDES=%d, DELT=%s &END\n"
          " &RATES SPEED=2.0 &END\n &LOADS NLOAD=1, LNAME='%s', LFX=-70.0, LFY=-30.0, LMOM=0.4 &END\n"
          " &MASSES NMASS=1, MNAME='%s', MASS=3.0, MINERT=2.0E-3, UNITL=0.001 &END\n"
          " &FRICTN NFRIC=1, FNAME='S1', FMU=0.1, FRAD=%g &END\n"
          % (chain, drives, steps.count(",") + 1, steps, SHOES[name][1][1], SHOES[name][1][1], radius))
    code, _, errors = kalm("--quiet", "shoe.nml")
    found = [row for row, _, _ in joints_of("shoe.kalm.csv", None)] if code == 0 else []
    return found, errors


def test_shoes():
    """An idle link driven elsewhere changes no load: with one drive and with two the shoe is where it is drawn."""
    for name in SHOES:
        for order in (1, -1):
            for radius in (0.0, 20.0):
                what = "%s, %s link first, shoe of %g" % (name, ("guiding", "sliding")[order < 0], radius)
                loops, errors = shoe_case(name, order, radius, False)
                check(what + ": by loops", bool(loops) and "&CHAIN" in read("shoe.kalm.dev8"), errors)
                more, errors = shoe_case(name, order, radius, True)
                check(what + ": with an idle drive", len(more) == len(loops), errors)
                for ours, theirs in zip(loops, more):
                    same = [key for key in ours if key in theirs and (key in ("drive", "frame_fx", "frame_fy", "frame_m") or
                                                                      key.endswith(("_fx", "_fy", "_n", "_m")))]
                    largest = max(abs(theirs[key]) for key in same)
                    worst = max(same, key=lambda key: abs(ours[key] - theirs[key]))
                    check(what + ": the same loads", len(same) == 12 and abs(ours[worst] - theirs[worst]) <= 1e-9*largest,
                          "%s: %.12g, %.12g" % (worst, ours[worst], theirs[worst]))


STILL = """RATIO TO WHAT STANDS
 &CHAIN JNT='A','B','C','D','E', JX=0,0,60,70,-40, JY=0,30,40,0,20, LNAME='frame','crank','rod','rocker','arm',
 LNK='A D','A B','B C','C D','A E' &END
 &DRIVES DRIVE='A','A', DBASE='frame','crank', DLINK='crank','arm', DELT2=0.0,5.0,10.0, DSPEED=0.0,1.0 &END
 &OUTPUTS OUTPUT='angle rocker','distance B C','ratio turn bar','ratio bar turn', ONAME='turn','bar','R','Q' &END
 &METHOD NDES=3, DELT=0.0,10.0,20.0 &END
 &RATES SPEED=2.0 &END
"""


def test_still_output():
    """A ratio to an output that stands still has no value, on no device; drives at one joint have columns of their own."""
    write("still.nml", STILL)
    code, listing, errors = kalm("still.nml")
    check("a ratio to what stands: read", code == 0, errors)
    table = [line.split(",") for line in read("still.kalm.csv").split()]
    at = [table[0].index(name) for name in ("R", "R.v", "R.a", "Q")]
    check("a ratio to what stands: table", all(row[at[0]] == row[at[1]] == row[at[2]] == "" and abs(float(row[at[3]])) < 1e-12 for row in table[1:]),
          str(table[:2]))
    check("a ratio to what stands: device 9", all(line.split().count("NaN") == 3 for line in read("still.kalm.dev9").split("# block outputs")[1].split("# block")[0].split("\n")
                                                  if line and line[0] != "#"), read("still.kalm.dev9"))
    check("a ratio to what stands: listing", [line.split().count("-") for line in listing.split("\n") if re.match(r" +[123] ", line)] == [3, 3, 3], listing)
    check("a ratio to what stands: summary", "R has no value: it is a ratio to what stands still" in errors, errors)
    check("two drives at one joint", table[0][:2] == ["input.A.frame-crank", "input.A.crank-arm"], str(table[0][:2]))


def test_moved_frame():
    """A drive that moves the frame against the crank: taken as it is written, but told."""
    text = STILL.replace(",'A', DBASE='frame','crank', DLINK='crank','arm', DELT2=0.0,5.0,10.0, DSPEED=0.0,1.0", "%s").replace(
        "'B C','C D','A E'", "'B C','C D'").replace(",'E', JX", ", JX").replace("70,-40", "70").replace("0,20, LNAME", "0, LNAME").replace(
        ",'arm'", "")
    for items, item in ((", DBASE='crank'", "DBASE"), (", DLINK='frame'", "DLINK"), (", DBASE='frame'", None)):
        write("moved.nml", text % items)
        code, _, errors = kalm("moved.nml")
        told = "&DRIVES %s: drive A moves the frame against link crank, which goes the other way" % item in errors
        check("a drive that moves the frame" + items, code == 0 and told == bool(item), errors)


def test_held_pin():
    """The link that holds a pin of several does not turn on it."""
    text = ("A PIN OF THREE LINKS\n &CHAIN JNT='A','B','C','D','E','F', JX=0,0,60,70,120,130, JY=0,30,40,0,60,0, LNAME='frame','crank','rod','rocker','tie',"
            "'lever',\n  LNK='A D F','A B','B C','C D','C E','E F' &END\n &DRIVES DRIVE='A' &END\n &METHOD NDES=1, DELT=0.0 &END\n"
            " &RATES SPEED=1.0 &END\n &MASSES NMASS=1, MNAME='lever', MASS=1.0 &END\n &FRICTN NFRIC=1, FNAME='C %s', FMU=0.1, FRAD=1.0 &END\n")
    answers = {}
    for link in ("rod", "rocker", "tie"):
        write("pin.nml", text % link)
        answers[link] = kalm("--quiet", "pin.nml")
    check("friction of links on a held pin", [answers[link][0] for link in ("rod", "rocker", "tie")] == [2, 0, 0], str(answers))
    check("the holder is named", "entry 1: the pin is held by link rod; name another that turns on it" in answers["rod"][2], answers["rod"][2])


def test_piston():
    """Force and couple of a shoe by equilibrium of a piston without mass, the torque by virtual work."""
    x, y, angle, mu = 151.0, 14.0, math.radians(8.0), 0.1
    for order in (1, -1):
        for radius in (0.0, 20.0):
            shoe_case("slider-crank", order, radius, False)
            write("shoe.nml", re.sub(r"(?m)^ &MASSES.*$", " &MASSES NMASS=0, UNITL=0.001 &END", changed(read("shoe.nml"), "LMOM=0.4", "LMOM=0.0")))
            code, _, errors = kalm("--quiet", "shoe.nml")
            moving = joints_of("shoe.kalm.csv", "C") if code == 0 else []
            check("piston: forces", len(moving) == 5, errors)
            for row, vx, vy in moving:
                fx, fy = row["C_fx"] - 70.0, row["C_fy"] - 30.0   # the rod is drawn first: its force on the piston, and the load
                across = fy*math.cos(angle) - fx*math.sin(angle)
                # the shoe is a point of the second link: of the piston, or of the frame
                at = (136.0 - x, 10.0 - y) if order > 0 else (row["C.x"] - x, row["C.y"] - y)
                couple = 1e-3*(at[0]*fy - at[1]*fx)
                check("piston: force across", abs(row["S1_n"] + order*across) < 1e-10, "%g" % (row["S1_n"] + order*across))
                check("piston: couple", abs(row["S1_m"] + order*couple) < 1e-11, "%g" % (row["S1_m"] + order*couple))
                edge = couple/(2e-3*radius) if radius else 0.0
                loss = mu*(abs(across/2.0 + edge) + abs(across/2.0 - edge))*1e-3*math.hypot(vx, vy)
                check("piston: virtual work", abs(2.0*row["drive"] - 1e-3*(70.0*vx + 30.0*vy) - loss) < 1e-10,
                      "%g" % (2.0*row["drive"] - 1e-3*(70.0*vx + 30.0*vy) - loss))


def test_small_drawing():
    """One joint, and a slide through it: the drawing has no extent."""
    for base, link, sense in (("frame", "ram", 1.0), ("ram", "frame", -1.0)):
        for x, y in ((10.0, 5.0), (0.0, 0.0)):
            write("ram.nml", "A RAM\n &CHAIN JNT='B', JX=%r, JY=%r, LNAME='frame','ram', LNK='','B', SLNK='frame', SLNK2='ram', SLX=%r, SLY=%r,\n"
                  "  SLANG=30.0 &END\n &DRIVES DRIVE='S1', DBASE='%s', DLINK='%s' &END\n &METHOD NDES=2, DELT=5.0,-8.0 &END\n"
                  % (x, y, x, y, base, link))
            code, _, errors = psalm("--quiet", "ram.nml")
            found = [line.split(",") for line in read("ram.csv").split()[1:]] if code == 0 else []
            along = (math.cos(math.radians(30.0)), math.sin(math.radians(30.0)))
            check("a ram alone at %g, %g moves along its slide" % (x, y), len(found) == 2 and all(
                abs(float(row[-2]) - x - sense*float(row[0])*along[0]) + abs(float(row[-1]) - y - sense*float(row[0])*along[1]) < 1e-13
                for row in found), errors)


BRACED = {"A": 0j, "B": 15 + 20j, "C": 95 + 20j, "D": 80 + 0j, "F": 40 - 20j, "G": 55 + 0j, "P": 70 + 45j}
BRACED_LINKS = [("frame", "A D F"), ("crank", "A B"), ("coupler", "B C G P"), ("rocker", "C D"), ("third", "F G")]


def braced_case(joints, names, links):
    write("braced.nml", "BRACED\n &CHAIN JNT=%s,\n JX=%s,\n JY=%s,\n LNAME=%s, LNK=%s, KOVER=1 &END\n &DRIVES DRIVE='A', DLINK='crank' &END\n"
          " &OUTPUTS OUTPUT='point P','angle rocker' &END\n &METHOD IKIN=1, CRNKI=%r &END\n &RATES SPEED=2.0 &END\n"
          % (",".join("'%s'" % n for n in names), ",".join(repr(joints[n].real) for n in names),
             ",".join(repr(joints[n].imag) for n in names), ",".join("'%s'" % n for n, _ in links),
             ",".join("'%s'" % n for _, n in links), -math.degrees(math.atan2(20.0, 15.0))))
    code, _, errors = kalm("--quiet", "braced.nml")
    return code, errors, list(csv.DictReader(read("braced.kalm.csv").splitlines())) if code < 2 else []


def test_braced():
    """A parallelogram with a third link through its change points, in any order of joints and links: all follows the crank."""
    crank = BRACED["B"]
    shuffle = random.Random(7)
    for k in range(4):
        names, links = list(BRACED), BRACED_LINKS[1:]
        if k:
            shuffle.shuffle(names)
            shuffle.shuffle(links)
        code, errors, found = braced_case(BRACED, names, BRACED_LINKS[:1] + links)
        closed = code == 0 and len(found) == 360 and all(row["closed"] == "1" for row in found)
        check("braced parallelogram, order %d: closes at every degree" % k, closed, errors)
        worst = 0.0
        for row in found if closed else []:
            turn = crank*(math.cos(math.radians(float(row["input"]))) + 1j*math.sin(math.radians(float(row["input"]))))
            for joint, fixed in (("C", "D"), ("G", "F")):
                worst = max(worst, abs(complex(float(row[joint + ".x"]), float(row[joint + ".y"])) - BRACED[fixed] - turn))
            worst = max(worst, abs(complex(float(row["point_P.x"]), float(row["point_P.y"])) - BRACED["P"] + crank - turn))
            worst = max(worst, abs(complex(float(row["point_P.x.v"]), float(row["point_P.y.v"])) - 2j*turn))
        check("braced parallelogram, order %d: places and velocities are those of the crank" % k, worst < 1e-10, "%g" % worst)
    code, errors, found = braced_case(dict(BRACED, F=40 + 0j, G=55 + 20j), list(BRACED), BRACED_LINKS)
    check("three cranks in one line may fold at the change point", code == 1 and 0 < sum(row["closed"] == "1" for row in found) < 181, errors)
    code, errors, found = braced_case(dict(BRACED, F=40 - 20.0001j), list(BRACED), BRACED_LINKS)
    check("a third link that fits the drawing only", code == 1 and sum(row["closed"] == "1" for row in found) < 10, errors)


WIDE = """WIDE LINKS
 &CHAIN JNT='M','H','K','R','W','L','S', JX=0.0,-370.0,-75.0,-20.0,-430.0,20.0,-130.0, JY=40.0,5.0,345.0,330.0,20.0,300.0,190.0,
  LNAME='frame','chainstay','seatstay','rocker', LNK='M R S','M H','H K W','R K L' &END
 &DRIVES DRIVE='M' &END
 &OUTPUTS OUTPUT='angle R K','point W' &END
 &METHOD NDES=7, DELT=0.0,-2.0,-4.0,-6.0,-8.0,-10.0,-12.0 &END
 &LIMITS IPROOF=2 &END
 &CONSTR IRANGE=1, NREGN=2, RJNT='L','S', RKIND=-1,3, RPLACE=-400.0,100.0,0.0,450.0, -100.0,190.0,10.0,0.0,
  NSEG=3, SJNT='S L','M H','K W', SWIDTH=20.0,10.0,10.0 &END
"""


GROUP = """WIDE LINKS OF A LARGER GROUP
 &CHAIN JNT='A','B','C','D','E','F','G', JX=0.0,0.0,40.0,80.0,45.0,85.0,100.0, JY=0.0,30.0,60.0,55.0,30.0,20.0,0.0,
  LNAME='frame','crank','left','top','right','tie', LNK='A G','A B','B C E','C D','D F G','E F' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point D' &END
 &METHOD NDES=161, DELT=%s &END
 &CONSTR IRANGE=1, NREGN=3, RJNT='D','F', RKIND=-1,3,2, RPLACE=70.0,40.0,95.0,90.0, 60.0,0.0,8.0,0.0, 0.0,20.0,180.0,0.0,
  RSEG(3)=2, NSEG=3, SJNT='A B','C E','D F', SWIDTH=4.0,2.0,3.0 &END
"""


def test_proven_clearances():
    """Least clearances of a larger group, proven over a range: no sample of it is less, and the bracket is as narrow as it says."""
    write("group.nml", GROUP % ",".join("%g" % (-0.5*k) for k in range(161)))
    code, listing, errors = psalm("group.nml")
    check("clearances of a larger group: those less than asked are told", code == 1 and "proven to be less" in errors, errors)
    found = list(csv.DictReader(read("group.csv").splitlines()))
    check("clearances of a larger group: the range closes", len(found) == 161 and all(row["closed"] == "1" for row in found))
    places = [{name: complex(float(row[name + ".x"]), float(row[name + ".y"])) for name in "ABCDEFG"} for row in found]
    wanted = {"REGION 1, JOINT D": min(min(p["D"].real - 70, 95 - p["D"].real, p["D"].imag - 40, 90 - p["D"].imag) for p in places),
              "REGION 2, JOINT F": min(abs(p["F"] - 60) - 8 for p in places),
              "REGION 3, LINK C-E": min(min(p["C"].imag, p["E"].imag) - 21 for p in places),
              "LINKS A-B AND C-E": min(between(p, *"ABCE") - 3 for p in places),
              "LINKS A-B AND D-F": min(between(p, *"ABDF") - 3.5 for p in places),
              "LINKS C-E AND D-F": min(between(p, *"CEDF") - 2.5 for p in places)}
    proven = listing[listing.index("AT LEAST             AT            ASKED"):]
    for name, sample in wanted.items():
        lines = proven.splitlines()
        at = [k for k, line in enumerate(lines) if name in line]
        check("clearances of a larger group: %s is proven" % name, len(at) == 1, proven)
        if len(at) == 1:
            low = float(lines[at[0]].split(name)[1].split()[0])
            check("clearances of a larger group: no sample of %s is less" % name, low <= sample + 1e-6 and low > sample - 0.02, (low, sample))
            if at[0] + 1 < len(lines) and "AT MOST" in lines[at[0] + 1]:
                high = float(lines[at[0] + 1].split()[-1])
                check("clearances of a larger group: the bracket of %s is narrow" % name, low <= high <= sample + 1e-4, (low, high, sample))


def from_segment(p, a, b):
    along = ((p - a)*(b - a).conjugate()).real/abs(b - a)**2
    return abs(p - a - min(1.0, max(0.0, along))*(b - a))


def between(p, a, b, c, d):
    """Distance of two segments that do not cross."""
    return min(from_segment(p[a], p[c], p[d]), from_segment(p[b], p[c], p[d]), from_segment(p[c], p[a], p[b]), from_segment(p[d], p[a], p[b]))


def test_joints_beside():
    """Clearances of joints that are no ends of arcs: of links between them, of regions; listed, and proven."""
    write("beside.nml", WIDE)
    code, listing, errors = psalm("beside.nml")
    check("joints beside arcs: a violated region is told", code == 1 and "REGION 1, JOINT L" in errors.upper(), errors)
    found = list(csv.DictReader(read("beside.csv").splitlines()))
    places = [{name: complex(float(row[name + ".x"]), float(row[name + ".y"])) for name in "MHKRWLS"} for row in found]

    def apart(a, b, c, d, width):
        return min(between(p, a, b, c, d) - width for p in places)

    wanted = {"LINKS S-L AND M-H": apart(*"SLMH", 15.0), "LINKS S-L AND K-W": apart(*"SLKW", 15.0),
              "LINKS M-H AND K-W": apart(*"MHKW", 10.0), "REGION 1, JOINT L": min(-p["L"].real for p in places),
              "REGION 2, JOINT S": 20.0}
    for name, value in wanted.items():
        said = [float(line.split(name)[1].split()[0]) for line in listing.splitlines() if name in line and len(line.split(name)[1].split()) > 1]
        check("joints beside arcs: %s is listed and proven" % name, len(said) == 2 and all(abs(s - value) < 2e-5*max(1.0, abs(value)) for s in said), (said, value))
    code, _, errors = picture_tools.balm("beside.nml")
    check("joints beside arcs: they are drawn", code == 1 and os.path.exists("beside.svg"), errors)


def main(programs):
    picture_tools.programs = os.path.abspath(programs)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        test_desired()
        test_repair()
        test_backwards()
        test_time()
        test_margins()
        test_open_rates()
        test_family()
        test_adjustment()
        test_least_angle()
        test_both_limits()
        test_one_linkage()
        test_one_verdict()
        test_idle_items()
        test_remedy()
        test_strayed()
        test_change_of_zero()
        test_forces_on_slides()
        test_small_drawing()
        test_driven_slide()
        test_shoes()
        test_still_output()
        test_moved_frame()
        test_held_pin()
        test_piston()
        test_braced()
        test_joints_beside()
        test_proven_clearances()
        os.chdir("/")
    print("%d passed, %d failed" % (picture_tools.passed, picture_tools.failed))
    return picture_tools.failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
