#!/usr/bin/env python3
"""Laws that relate one run of the programs to another, from outside.

usage: test/laws.py PROGRAM_DIRECTORY. Last line: N passed, N failed.
"""
import math
import os
import re
import sys
import tempfile

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
    """Columns of a named block of device 9."""
    text = read(device).split("# block %s\n" % name)[1].split("\n\n")[0].splitlines()
    names = text[0].split()[1:]
    values = [list(map(float, line.split())) for line in text[1:] if line.strip()]
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
    for old, new, words in (("SWJNT='D E'", "SWJNT='A E'", "belong to no link together"), ("SWJNT='D E'", "SWJNT='D G'", "no joint is called 'G'"),
                            ("SWHIGH=100.0", "SWHIGH=50.0", "must be above SWLOW"), ("SWJNT='D E'", "SWLINK=3", "of a sketch a length is swept"),
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
    """A number as Fortran writes it, with three digits of exponent and no letter."""
    return float(re.sub(r"(?<=\d)([-+]\d{3})$", r"E\1", word))


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
        os.chdir("/")
    print("%d passed, %d failed" % (picture_tools.passed, picture_tools.failed))
    return picture_tools.failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
