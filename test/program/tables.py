#!/usr/bin/env python3
"""Tables for other programs: what CSV, JSON and device 9 of all programs say is the same, digit by digit; JSON keeps to its schema.

usage: test/program/tables.py PROGRAM_DIRECTORY. Last line: N passed, N failed."""
import csv
import glob
import json
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
                    v is None for n, values in columns.items() if not n.startswith(("input", "closed", "desired", "setting", "position"))
                    for closed, v in zip(columns["closed"], values) if closed == 0))
    if os.path.exists(stem + ".dev9"):
        blocks = [(name, block) for one in whole["cases"] for name, block in one["blocks"].items()]
        for name, heads, rows in device9(stem + ".dev9"):
            if not name or name == "outputs":
                continue
            if not any(n == name and [[as_csv(v) for v in row] for row in zip(*b["columns"].values())] == [
                    [v if v != "NaN" else "" for v in row] for row in rows] for n, b in blocks):
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


def main(directory):
    directory = os.path.abspath(directory)
    psalm, kalm = os.path.join(directory, "psalm"), os.path.join(directory, "kalm")
    data = os.path.join(TOP, "data")
    sketches = [name for name in sorted(glob.glob(os.path.join(data, "*.nml"))) if "&CHAIN" in open(name, encoding="utf-8").read()]
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        check("there are sketches", len(sketches) > 15)
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
                                                       if not n.startswith(("input", "closed")) and not n.endswith(".condition") for v in (".v", ".a")))
        for name in ("needle", "engine", "textile", "door_five_poses", "actuator_davis_steering"):
            case = os.path.join(data, name + ".nml")
            columns = compare(psalm, case)["positions"]["columns"]
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
                ("kalm", "engine.nml", {"positions", "powers", "sizing", "harmonics", "shares", "machine", "machine_cycle"}),
                ("kalm", "stephenson3_rod_driven.nml", {"positions", "powers", "limits"}),
                ("psalm", "stephenson3_rod_driven.nml", {"positions", "tolerances", "output_tolerances", "dimension_effects"}),
                ("psalm", "links_apart.nml", {"positions", "constraints"}),
                ("psalm", "brake_reaction_lsq.nml", {"positions", "ranking", "ranked_dimensions"}),
                ("muscle", "muscle/needle_balance.nml", {"balance", "links", "outcomes", "weights", "loads", "designs", "budgets"}),
                ("muscle", "muscle/haines_spring.nml", {"springs", "spring_result", "spring_load", "spring_phases"}),
                ("ssics", "ssics/link_loads.nml", {"boundaries", "multipliers", "response"}),
                ("bridge", "bridge/four_bar_haines.nml", {"minima", "following", "flight", "cycle"}),
                ("calm", "calm/knuckle_press.nml", {"cam", "extremes"}),
                ("psalm", "exact/five_poses.nml", {"exact"}),
                ("psalm", "cheapest_tolerances.nml", {"positions", "tolerances", "allocation", "allocation_bands"}),
                ("psalm", "adjustable_stroke.nml", {"positions", "sweep"})):
            found = compare(os.path.join(directory, program), os.path.join(data, case))
            check("%s, %s: blocks" % (program, case), blocks <= set(found), str(list(found)))
        two = "TWO DESIRED OUTPUTS\n &CHAIN JNT='A','B','C','D','P', JX=0.,0.,40.,70.,25., JY=0.,30.,60.,0.,70., LNK='A D','A B','B C P','C D' &END\n" \
              " &DRIVES DRIVE='A' &END\n &OUTPUTS OUTPUT='point P','angle D C', DES2=116.0,117.0,118.0 &END\n" \
              " &METHOD NDES=3, DELT=0.0,1.0,2.0 &END\n &LIMITS LAST=1 &END\n"
        with open("two.nml", "w", encoding="utf-8") as file:
            file.write(two)
        wishes = compare(psalm, "two.nml").get("wishes", {"columns": {"position": []}})["columns"]
        check("desired values of a further output: a row for each", wishes["position"] == [1, 2, 3] and all(
            abs(float(d) - float(a) - float(e)) < 1e-9 for d, a, e in zip(wishes["desired"], wishes["actual"], wishes["error"])), str(wishes))
        done = subprocess.run([os.path.join(directory, "balm"), "--json", sketches[0]], capture_output=True, text=True, check=False)
        check("--json is no option of balm", done.returncode == 2 and "--json is an option of the programs that compute" in done.stderr, done.stderr)
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
