#!/usr/bin/env python3
"""Tables for other programs: what CSV, JSON and device 9 of all programs say is the same, digit by digit; JSON keeps to its schema.

usage: test/program/tables.py PROGRAM_DIRECTORY. Last line: N passed, N failed."""
import csv
import glob
import json
import math
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NUMBER = re.compile(r"-?\d\.\d{16}E[-+]\d\d+")
MAIN = ("positions", "cam")       # blocks whose CSV file is called by the case alone


def rows_of(name):
    """Names and rows of a CSV file."""
    with open(name, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def device9(name):
    """Blocks of device 9: names of columns (behind the first #, or behind # block NAME), rows. A block without a name is called ''."""
    found = []
    with open(name, encoding="utf-8") as file:
        for block in file.read().split("\n\n\n"):
            lines = block.splitlines()
            named = lines[0].startswith("# block ")
            heads = [line for line in lines if line.startswith("#") and not line.startswith("# run ")]
            columns = heads[1 if named else 0][1:].split("   ")[0].split()
            found.append((lines[0][8:] if named else "", columns, [line.split() for line in lines if line and not line.startswith("#")]))
    return found


def run(program, case, *options):
    """JSON of a case, after a look at what it promises."""
    law = "%s, %s: " % (os.path.basename(program), os.path.basename(case))
    done = subprocess.run([program, "--quiet", "--json", *options, "--output-dir", ".", case], capture_output=True, text=True, check=False)
    name = os.path.basename(program)
    stem = os.path.basename(case)[:-4] + ("" if name == "psalm" else "." + name)
    check(law + "runs", done.returncode in (0, 1), done.stderr)
    if done.returncode not in (0, 1):
        return law, stem, None
    with open(stem + ".json", encoding="utf-8") as file:
        whole = json.load(file, parse_float=str)
    check(law + "named", whole["program"] == name and re.fullmatch("[0-9A-F]{16}", whole["run"]), str(whole)[:80])
    return law, stem, whole


def as_csv(value):
    return "" if value is None else str(value)


def on_device9(values):
    """A column as device 9 has it: words without blanks; what there is not is `none` among words, `NaN` among numbers."""
    words = all(v is None or not NUMBER.fullmatch(str(v)) for v in values)
    return ["none" if v is None and words else "NaN" if v is None else str(v).replace(" ", "-") for v in values]


def compare(program, case, *options):
    """CSV, JSON and device 9 of a case say the same; the tables of its first case."""
    law, stem, whole = run(program, case, *options)
    if whole is None:
        return {}
    for k, one in enumerate(whole["cases"]):
        for name, block in one["blocks"].items():
            number = "-%d" % (k + 1) if k else ""
            names, rows = rows_of(stem + number + ("" if name in MAIN else "." + name) + ".csv")
            columns = block["columns"]
            check(law + name + ": the same columns", list(columns) == names and list(block["units"]) == names, str(names))
            check(law + name + ": names are different", len(set(names)) == len(names), str(names))
            check(law + name + ": the same figures", all([as_csv(v) for v in columns[n]] == [row[i] for row in rows] for i, n in enumerate(names)))
            check(law + name + ": 17 digits", all(not isinstance(v, str) or NUMBER.fullmatch(v)
                                                 for n, values in columns.items() if block["units"][n] for v in values))
            if "closed" in columns:
                check(law + name + ": what does not close is empty", all(
                    v is None for n, values in columns.items()
                    if not n.startswith(("input", "closed", "desired", "setting", "position", "crank_angle")) and not n.endswith(".desired")
                    for closed, v in zip(columns["closed"], values) if closed == 0))
    if os.path.exists(stem + ".dev9"):
        blocks = [(name, block) for one in whole["cases"] for name, block in one["blocks"].items()]
        for name, heads, rows in device9(stem + ".dev9"):
            if not name or name == "outputs":
                continue
            # words have no blanks there
            if not any(n == name and list(zip(*(on_device9(v) for v in b["columns"].values()))) == list(map(tuple, rows)) for n, b in blocks):
                check(law + "block %s of device 9 is that of JSON" % name, all(
                    not re.fullmatch(r"[-+.\dE]+", v) for row in rows[:1] for v in row) and any(n == name for n, _ in blocks), str(rows[:1]))
    return whole["cases"][0]["blocks"]


def forces(kalm, case):
    """The columns of forces are those of device 9."""
    columns = compare(kalm, case)["positions"]["columns"]
    _, heads, rows = device9(os.path.basename(case)[:-4] + ".kalm.dev9")[0]
    first = heads.index("drive")
    check(case + ": columns of forces", all(n in columns for n in heads[first:]), str(heads))
    check(case + ": figures of forces", all(
        [v or "NaN" for v in map(as_csv, columns[n])] == [row[first + k] for row in rows] for k, n in enumerate(heads[first:])))


def listing(program, case):
    """Listing and standard error of a case."""
    done = subprocess.run([program, "--output-dir", ".", case], capture_output=True, text=True, check=False)
    return done.stdout, done.stderr


def plain(text):
    """The numbers of a text."""
    return [float(word.replace("D", "E")) for word in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:[DE][-+]\d+)?(?!\w|\.\d)", text)]


def near(value, told, relative=6e-5):
    """True if a value is a number that was told with five digits."""
    return value is not None and abs(float(value) - told) <= max(relative * abs(told), 6e-6)


def summaries(psalm, kalm, data):
    """Tables of the summary say what its words say; KTHETA gives all arcs."""
    for name in ("needle_masses", "suspension", "engine"):
        case = os.path.join(data, name + ".nml")
        words = listing(psalm, case)[1]
        blocks = compare(psalm, case)
        row = {n: v[0] for n, v in blocks["summary"]["columns"].items()}
        line = dict(re.findall(r"^  (\S[^\n]{17})\s+(.*)$", words, re.M))
        line = {label.strip(): text for label, text in line.items()}
        check(name + ": transmission angle", near(row["transmission_angle"], plain(line["Transmission angle"])[0]), str(row))
        output = next(text for label, text in line.items() if label.startswith("Output"))
        check(name + ": range of the output", near(row["output_least"], plain(output)[0]) and near(row["output_most"], plain(output)[1]), output)
        check(name + ": closes over the full turn", (row["closes_everywhere"] == 1) == ("full turn" in line["Closes"]), line["Closes"])
        ranges = [float(v) for pair in zip(*blocks["closing"]["columns"].values()) for v in pair]
        if "from input" in line["Closes"]:
            check(name + ": ranges", all(near(v, told) for v, told in zip(ranges, plain(line["Closes"]))), line["Closes"])
        turns = blocks["reversals"]["columns"]["input"]
        check(name + ": dead points", len(turns) == len(plain(line["Dead points"])) and all(
            near(v, told) for v, told in zip(turns, plain(line["Dead points"]))), line["Dead points"])
        if "Error" in line:
            check(name + ": errors", all(near(row[n], told) for n, told in zip(("error_rms", "error_largest"), plain(line["Error"]))), line["Error"])
        check(name + ": kinds", all(kind in line["Kind"] for kind in blocks["loop_kinds"]["columns"]["kind"]), line["Kind"])
    words = listing(psalm, os.path.join(data, "hoecken.nml"))[1]
    check("a point does not reverse: nothing is told of dead points", "Closes" in words and "Dead points" not in words, words)
    case = os.path.join(data, "needle_masses.nml")
    arcs = compare(psalm, case)["arcs"]["columns"]
    with open("needle_masses.dev8", encoding="utf-8") as file:
        listed = file.read().split("LENGTHS AND ANGLES OF ALL ARCS")[1]
    first = plain(listed.split(" INPUT")[1].split("NUMBER")[1].split("JOINT OF")[0])[1:]
    loops = [[(float(n), float(a)) for o, p, n, a in zip(arcs["loop"], arcs["position"], arcs["length"], arcs["angle"]) if o == loop and p == 1]
             for loop in sorted(set(arcs["loop"]))]
    wanted = [v for loop in loops for column in zip(*loop) for v in column]
    check("all arcs: lengths and angles of device 8", all(abs(a - b) < 1e-6 * max(1.0, abs(b)) for a, b in zip(wanted, first)) and len(first) >= len(
        wanted) > 10, "%s %s" % (wanted[:8], first[:8]))
    columns = compare(kalm, case)["arcs"]["columns"]
    check("kalm: the same arcs", all(abs(float(a) - float(b)) < 1e-9 * max(1.0, abs(float(b))) for a, b in zip(columns["length"], arcs["length"])) and all(
        abs((float(a) - float(b) + 180.0) % 360.0 - 180.0) < 1e-9 for a, b in zip(columns["angle"], arcs["angle"])))
    with open("gap.nml", "w", encoding="utf-8") as file:
        file.write("A LINKAGE THAT DOES NOT CLOSE EVERYWHERE\n &CHAIN JNT='A','B','C','D', JX=0.,0.,40.,70., JY=0.,60.,50.,0., LNK='A D','A B','B C','C D'"
                   " &END\n &DRIVES DRIVE='A' &END\n &METHOD IKIN=12 &END\n &LIMITS TRMIN=40., LAST=1 &END\n")
    text, _ = listing(psalm, "gap.nml")
    violations = compare(psalm, "gap.nml")["violations"]["columns"]
    told = re.findall(r"^ JOINTS B, C, D, DYAD[^:]*, POSITIONS? (\d+)", text, re.M)
    check("violations: those of the listing", list(map(str, violations["first"])) == told and set(violations["loop"]) == {1}
          and len(told) > 1, "%s %s" % (violations, told))


def one_numbers(directory, data):
    """What was a number of the listing alone: vibration, drive, Hill's equation, the search for a cam."""
    ssics, calm = os.path.join(directory, "ssics"), os.path.join(directory, "calm")
    hill = compare(ssics, os.path.join(data, "ssics", "hill.nml"))
    row = {n: v[0] for n, v in hill["hill"]["columns"].items()}
    a, b, c, d = (float(row[n]) for n in ("y_from_y", "y1_from_y", "y_from_y1", "y1_from_y1"))
    roots = [complex(float(re_), float(im)) for re_, im in zip(*hill["hill_multipliers"]["columns"].values())]
    check("hill: multipliers have trace and determinant of the period", abs(sum(roots) - (a + d)) < 1e-9 and abs(
        roots[0] * roots[1] - (a * d - b * c)) < 1e-9, "%s %s" % (roots, row))
    start = float(row["start_y"]), float(row["start_y1"])
    after = a * start[0] + c * start[1] + float(row["y_from_rest"]), b * start[0] + d * start[1] + float(row["y1_from_rest"])
    check("hill: the steady state returns after a period", all(abs(p - q) < 1e-9 for p, q in zip(start, after)), "%s %s" % (start, after))
    case = os.path.join(data, "ssics", "link_loads.nml")
    text, _ = listing(ssics, case)
    blocks = compare(ssics, case)
    row = {n: float(v[0]) for n, v in blocks["vibration"]["columns"].items() if v[0] is not None}
    told = plain(re.search(r"FIRST FREQUENCY AT REST(.*)", text)[1].replace(",", " "))
    check("vibration: frequency and ratio", near(row["frequency"], told[0], 1e-6) and near(row["frequency_per_speed"], told[1], 1e-6), str(told))
    told = [plain(line)[0] for line in re.findall(r"^ GREATEST(.*)", text, re.M)]
    modes = blocks["modes"]["columns"]
    check("vibration: greatest deflection of each mode", len(told) == len(modes["mode"]) and all(near(v, t, 1e-6) for v, t in zip(modes["greatest"], told)))
    check("estimates: rules kept are those of the listing", blocks["estimate_rules"]["columns"]["kept"] == [
        int(word == "KEPT") for word in re.findall(r"AT (?:LEAST|MOST) [\d.]+ +(KEPT|BROKEN)", text)])
    drive = {n: v[0] for n, v in compare(ssics, os.path.join(data, "ssics", "drive_loads.nml"))["drive"]["columns"].items()}
    with open(os.path.join(data, "ssics", "drive_loads.nml"), encoding="utf-8") as file:
        speed = float(re.search(r"SPEED *= *([-\d.]+), UNITS='REV/MIN'", file.read())[1]) * math.pi / 30.0
    check("drive: its stiffness gives d", abs((float(drive["stiffness"]) / float(drive["inertia_mean"])) ** 0.5 / speed - float(drive["d"])) < 1e-9, str(drive))
    with open(os.path.join(data, "calm", "translating_roller.nml"), encoding="utf-8") as file:
        cam = file.read()
    with open("best.nml", "w", encoding="utf-8") as file:
        file.write(cam.replace("RROLL=8.0", "ALFMAX=35.0, VARY='ORIGLK', VARLOW=30.0, VARHI=90.0, GOAL='BASE', RROLL=8.0"))
    text, errors = listing(calm, "best.nml")
    blocks = compare(calm, "best.nml")
    check("calm: there is a search", {"search", "search_values"} <= set(blocks), errors)
    search, values = blocks["search"]["columns"], blocks["search_values"]["columns"]
    base = dict(zip(blocks["extremes"]["columns"]["what"], blocks["extremes"]["columns"]["value"]))
    check("calm: the least base radius is that of the cam", search["least"] == ["base"] and near(search["after"][0], float(next(
        v for n, v in base.items() if n in ("base_radius", "least_height"))), 1e-4), "%s %s" % (search, base))
    check("calm: what varied", values["item"] == ["ORIGLK"] and 30.0 <= float(values["after"][0]) <= 90.0 and float(values["before"][0]) == 48.0, str(values))
    check("calm: no fault where it keeps its limits", blocks["assessment"]["columns"]["fails"] == [int("exceeds" in errors or "undercut" in errors)], errors)


SKETCH = """A SKETCH
 &CHAIN JNT='A','B','C','D','P', JX=0.0,30.0,110.0,120.0,60.0, JY=0.0,0.0,80.0,0.0,60.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
"""
DESIRED = """ &METHOD NDES=3, DELT=0.0,10.0,20.0, DESX=60.0,58.0,55.0, DESY=60.0,62.0,64.0, YMULT=1.0,0.0,1.0 &END
"""


def numbers(block):
    """The columns of a block as numbers."""
    return {name: [float(v) if v is not None else math.nan for v in values] for name, values in block["columns"].items()}


def desired(psalm):
    """Desired values of a sketch, whether it has outputs or not: all of them, and errors in the unit of what is desired."""
    for name, outputs, point in (("no outputs", "", "P"), ("a point", " &OUTPUTS OUTPUT='point P', ONAME='tip' &END\n", "tip")):
        with open("desired.nml", "w", encoding="ascii") as file:
            file.write(SKETCH + outputs + DESIRED)
        blocks = compare(psalm, os.path.abspath("desired.nml"))
        columns = numbers(blocks["positions"])
        check("desired, %s: every value" % name, [columns["%s.%s.desired" % (point, c)] for c in "xy"] == [[60.0, 58.0, 55.0], [60.0, 62.0, 64.0]], str(columns))
        gaps = [math.hypot(*(columns["P." + c][k] - columns["%s.%s.desired" % (point, c)][k] for c in "xy")) for k in range(3)]
        row = {n: v[0] for n, v in blocks["summary"]["columns"].items()}
        check("desired, %s: errors" % name, near(row["error_largest"], max(gaps)) and int(row["error_largest_position"]) == 1 + gaps.index(max(gaps)), str(row))
    with open("desired.nml", "w", encoding="ascii") as file:
        file.write(SKETCH + """ &OUTPUTS OUTPUT='point P','angle rocker', ONAME='tip','swing', DES2=270.0,275.0 &END
 &METHOD NDES=2, DELT=0.0,10.0 &END
 &LIMITS TANGLE=1.0 &END
""")
    blocks = compare(psalm, os.path.abspath("desired.nml"))
    columns = numbers(blocks["positions"])
    check("desired angle: unit", blocks["summary"]["units"]["error_rms"] == "deg", str(blocks["summary"]["units"]))
    check("desired angle: error", near(blocks["summary"]["columns"]["error_largest"][0], max(
        abs((a - b + 180.0) % 360.0 - 180.0) for a, b in zip(columns["swing"], columns["swing.desired"]))), str(blocks["summary"]["columns"]))
    check("violation: the group by its joints", set(blocks["violations"]["columns"]["group"]) == {"joints B, C, D"}, str(blocks["violations"]))
    with open("all.nml", "w", encoding="ascii") as file:
        file.write(SKETCH + " &OUTPUTS OUTPUT='point P' &END\n &METHOD IKIN=45 &END\n &LIMITS TANGLE=90.0, KTHETA=1 &END\n")
    joints, places = ({name: numbers(block) if name == "positions" else block["columns"] for name, block in compare(
        os.path.join(os.path.dirname(psalm), "kalm"), os.path.abspath("all.nml")).items()}[name] for name in ("arc_joints", "positions"))
    for k, (joint, at) in enumerate(zip(joints["joint"], joints["position"])):
        check("all joints: %s is where it is" % joint, all(near(joints[v][k], places["%s.%s" % (joint, v)][int(at) - 1]) for v in (
            "x", "y", "vx", "vy", "ax", "ay")), str({v: joints[v][k] for v in ("x", "y", "vx", "vy")}))
    with open("angle.nml", "w", encoding="ascii") as file:
        file.write(SKETCH + " &OUTPUTS OUTPUT='angle B P' &END\n &METHOD IKIN=3 &END\n")
    dimensions = listing(psalm, "angle.nml")[0].split("ANGLES, DEGREES")[1].split("THE REFERENCE")[0]
    found = re.search(r"^  B C B P +([-.0-9D+]+)$", dimensions, re.M)
    turned = math.degrees(math.atan2(60.0, 30.0) - math.atan2(80.0, 80.0))
    check("the angle of an output line is a dimension", found is not None and near(found.group(1).replace("D", "E"), turned), dimensions)


def main(directory):
    directory = os.path.abspath(directory)
    psalm, kalm = os.path.join(directory, "psalm"), os.path.join(directory, "kalm")
    data = os.path.join(TOP, "data")
    sketches = [name for name in sorted(glob.glob(os.path.join(data, "*.nml"))) if "&CHAIN" in open(name, encoding="utf-8").read()]
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        check("there are sketches", len(sketches) > 15)
        desired(psalm)
        for case in sketches:
            stem = os.path.basename(case)[:-4]
            names = list(compare(psalm, case)["positions"]["columns"])
            joints = [name[:-2] for name in names if name.endswith(".x")]
            with open(case, encoding="utf-8") as file:
                own = re.findall(r"'([^']+)'", re.search(r"JNT=(.*?)\bJX", file.read(), re.S)[1])
            check(stem + ": every joint", set(own) <= set(joints), str(joints))
            with_rates = compare(kalm, case)["positions"]["columns"]
            check(stem + ": rates of every joint", all(j + "." + v in with_rates for j in own for v in ("vx", "vy", "ax", "ay")))
            check(stem + ": rates of every output", all(n + v in with_rates for n in names[:names.index(own[0] + ".x")]
                                                       if not n.startswith(("input", "closed")) and not n.endswith((".condition", ".desired", ".first", ".second")) for v in (".v", ".a")))
        # the needle and the steering turn, the piston slides, the textile linkage moves a point
        for name, unit in (("needle", "deg"), ("engine", "length"), ("textile", "length"), ("door_five_poses", None),
                           ("actuator_davis_steering", "deg")):
            case = os.path.join(data, name + ".nml")
            blocks = compare(psalm, case)
            columns = blocks["positions"]["columns"]
            check(name + ": unit of the output", unit in (None, blocks["summary"]["units"]["output_least"]), str(blocks["summary"]["units"]))
            _, heads, rows = device9(name + ".dev9")[0]
            for k, (head, column) in enumerate(zip(heads, ("input", "closed"))):
                check(name + ": %s as on device 9" % head, [as_csv(v) for v in columns[column]] == [row[k] for row in rows])
            for head in (h for h in heads if h.startswith(("actual", "desired"))):
                column = re.sub("^actual", "output", head).replace("_", ".")
                check(name + ": %s as on device 9" % head, [as_csv(v) or "NaN" for v in columns[column]] == [row[heads.index(head)] for row in rows])
            columns = compare(kalm, case)["positions"]["columns"]
            check(name + ": rates of the output", all(any(n.endswith(e) for n in columns) for e in (".v", ".a", ".j", ".first", ".third")), str(list(columns)))
        with open(os.path.join(data, "excavator.nml"), encoding="utf-8") as file:
            digger = file.read() + " &RATES SPEED=0.2 &END\n &MASSES NMASS=1, MNAME='bucket T', MASS=100.0, GRAVY=-9.81 &END\n"
        with open("digger.nml", "w", encoding="utf-8") as file:
            file.write(digger)
        for case in (os.path.join(data, "engine.nml"), "digger.nml"):
            forces(kalm, case)
        for program, case, blocks in (
                ("kalm", "engine.nml", {"positions", "powers", "sizing", "harmonics", "shares", "machine", "machine_cycle", "summary", "closing", "reversals",
                                       "loop_kinds", "dimensions", "violations", "arcs", "arc_joints"}),
                ("kalm", "stephenson3_rod_driven.nml", {"positions", "powers", "limits"}),
                ("psalm", "stephenson3_rod_driven.nml", {"positions", "tolerances", "output_tolerances", "dimension_effects"}),
                ("psalm", "links_apart.nml", {"positions", "constraints"}),
                ("psalm", "brake_reaction_lsq.nml", {"positions", "search", "ranking", "ranked_dimensions"}),
                ("muscle", "muscle/needle_balance.nml", {"balance", "links", "outcomes", "weights", "loads", "designs", "budgets"}),
                ("muscle", "muscle/haines_spring.nml", {"springs", "spring_result", "spring_load", "spring_phases"}),
                ("ssics", "ssics/link_loads.nml", {"vibration", "modes", "boundaries", "boundary_series", "multipliers", "response", "estimates",
                                                  "estimate_rules", "speeds", "unstable_speeds"}),
                ("ssics", "ssics/drive_loads.nml", {"drive", "drive_inertia", "drive_torque", "drive_multipliers", "drive_harmonics"}),
                ("ssics", "ssics/hill.nml", {"hill", "hill_multipliers", "hill_harmonics", "hill_response"}),
                ("bridge", "bridge/four_bar_haines.nml", {"clearance", "minima", "losses", "following", "least_forces", "speeds", "flight", "cycle"}),
                ("calm", "calm/knuckle_press.nml", {"cam", "segments", "law", "law_joints", "assessment", "extremes"}),
                ("psalm", "exact/five_poses.nml", {"exact"}),
                ("psalm", "cheapest_tolerances.nml", {"positions", "tolerances", "allocation", "allocation_bands"}),
                ("psalm", "adjustable_stroke.nml", {"positions", "sweep"})):
            found = compare(os.path.join(directory, program), os.path.join(data, case))
            check("%s, %s: blocks" % (program, case), blocks <= set(found), str(list(found)))
            if "estimates" in blocks:
                with open(os.path.join(data, "reference", case[:-4] + ".lst"), encoding="utf-8") as file:
                    told = re.search(r"THAT STRENGTH ALLOWS +(\S+), OF A TIE ROD +(\S+)", file.read())
                row = found["estimates"]["columns"]
                check(case + ": what strength allows", all(near(row["least_frequency_per_speed" + n][0], float(v)) for n, v in zip(
                    ("", "_of_tie_rod"), told.groups())), str(row))
        summaries(psalm, kalm, data)
        one_numbers(directory, data)
        two = "TWO DESIRED OUTPUTS\n &CHAIN JNT='A','B','C','D','P', JX=0.,0.,40.,70.,25., JY=0.,30.,60.,0.,70., LNK='A D','A B','B C P','C D' &END\n" \
              " &DRIVES DRIVE='A' &END\n &OUTPUTS OUTPUT='point P','angle D C', DES2=116.0,117.0,118.0 &END\n" \
              " &METHOD NDES=3, DELT=0.0,1.0,2.0 &END\n &LIMITS LAST=1 &END\n"
        with open("two.nml", "w", encoding="utf-8") as file:
            file.write(two)
        targets = compare(psalm, "two.nml").get("desired_values", {"columns": {"position": []}})["columns"]
        check("desired values of a further output: a row for each", targets["position"] == [1, 2, 3] and all(
            abs(float(d) - float(a) - float(e)) < 1e-9 for d, a, e in zip(targets["desired"], targets["actual"], targets["error"])), str(targets))
        done = subprocess.run([os.path.join(directory, "balm"), "--json", sketches[0]], capture_output=True, text=True, check=False)
        check("--json is no option of balm", done.returncode == 2 and "--json is an option of the programs that compute: psalm" in done.stderr, done.stderr)
        bare = "A CASE WITHOUT OUTPUTS\n &CHAIN JNT='A','B','C','D', JX=0.,0.,40.,70., JY=0.,30.,60.,0., LNK='A D','A B','B C','C D' &END\n" \
               " &DRIVES DRIVE='A' &END\n &METHOD IKIN=30 &END\n &LIMITS TANGLE=85., LAST=%d &END\n"
        with open("bare.nml", "w", encoding="utf-8") as file:
            file.write(bare % 0 + bare % 1)
        names = list(compare(psalm, "bare.nml")["positions"]["columns"])
        check("without outputs: all joints", names == ["input", "closed"] + [j + c for j in "ABCD" for c in (".x", ".y")] + ["crank_angle"], str(names))
        check("a second case has a file of its own", rows_of("bare-2.csv") == rows_of("bare.csv"))
        names = list(compare(kalm, "bare.nml")["positions"]["columns"])
        check("without outputs: rates of all joints", names == ["input", "closed"] + [
            j + c for j in "ABCD" for c in (".x", ".y", ".vx", ".vy", ".ax", ".ay")] + ["crank_angle"], str(names))
        os.chdir("/")
    return report()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
