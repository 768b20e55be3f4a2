#!/usr/bin/env python3
"""The tables for other programs: CASE.csv and CASE.json of psalm and kalm hold the same figures, those of device 9.

usage: test/tables.py PROGRAM_DIRECTORY. Last line: N passed, N failed."""
import csv
import glob
import json
import os
import re
import subprocess
import sys
import tempfile

from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
NUMBER = re.compile(r"-?\d\.\d{16}E[-+]\d\d+")


def tables(name):
    """Tables of a CSV file: names, rows of texts."""
    with open(name, encoding="utf-8", newline="") as file:
        parts = file.read().split("\n\n")
    return [(rows[0], rows[1:]) for rows in (list(csv.reader(part.strip("\n").split("\n"))) for part in parts)]


def device9(name):
    """Rows of the first block of device 9."""
    with open(name, encoding="utf-8") as file:
        block = file.read().split("\n\n\n")[0]
    return [line.split() for line in block.splitlines() if line and not line.startswith("#")]


def compare(program, case, stem):
    """CSV and JSON of a case say the same, digit by digit."""
    law = "%s, %s: " % (os.path.basename(program), os.path.basename(case))
    done = subprocess.run([program, "--quiet", "--json", "--output-dir", ".", case], capture_output=True, text=True, check=False)
    if not check_code(law, done):
        return []
    with open(stem + ".json", encoding="utf-8") as file:
        whole = json.load(file, parse_float=str)
    sheets = tables(stem + ".csv")
    check(law + "as many cases", len(sheets) == len(whole["cases"]))
    check(law + "named", whole["program"] == os.path.basename(program) and re.fullmatch("[0-9A-F]{16}", whole["run"]), str(whole)[:80])
    for (names, rows), one in zip(sheets, whole["cases"]):
        columns = one["columns"]
        check(law + "the same columns", list(columns) == names, str(names))
        check(law + "the same figures", all(
            [("" if v is None else str(v)) for v in columns[name]] == [row[k] for row in rows] for k, name in enumerate(names)))
        check(law + "17 digits", all(not field or names[k] == "closed" or NUMBER.fullmatch(field) for row in rows for k, field in enumerate(row)))
        check(law + "what does not close is empty", all(
            all(not f for f in row[names.index("closed") + 1:] if True) for row in rows if row[names.index("closed")] == "0"
            ) or any(name.startswith("desired") for name in names))
    return sheets


def forces(kalm, case):
    """The columns of forces are those of device 9, the last of the table."""
    stem = os.path.basename(case)[:-4] + ".kalm"
    names, rows = compare(kalm, case, stem)[0]
    with open(stem + ".dev9", encoding="utf-8") as file:
        first = next(line for line in file if line.startswith("# input"))
    columns = first.split()[1:]
    columns = columns[columns.index("drive"):]
    check(stem + ": columns of forces", names[-len(columns):] == columns, str(names))
    check(stem + ": figures of forces", [row[-len(columns):] for row in rows] == [row[-len(columns):] for row in device9(stem + ".dev9")])


def check_code(law, done):
    good = done.returncode in (0, 1)
    check(law + "runs", good, done.stderr)
    return good


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
            names = compare(psalm, case, stem)[0][0]
            joints = [name[:-2] for name in names if name.endswith(".x")]
            with open(case, encoding="utf-8") as file:
                own = re.findall(r"'([^']+)'", re.search(r"JNT=(.*?)\bJX", file.read(), re.S)[1])
            check(stem + ": every joint", set(own) <= set(joints), str(joints))
            with_rates = compare(kalm, case, stem + ".kalm")[0][0]
            check(stem + ": rates of every joint", all(j + "." + v in with_rates for j in own for v in ("vx", "vy", "ax", "ay")))
            check(stem + ": rates of every output", all(n + v in with_rates for n in names[:names.index(own[0] + ".x")]
                                                       if not n.startswith(("input", "closed")) for v in (".v", ".a")))
        for name in ("needle", "engine", "textile", "door_five_poses", "actuator_davis_steering"):
            case = os.path.join(data, name + ".nml")
            (names, rows), = compare(psalm, case, name)[:1]
            nine = device9(name + ".dev9")
            width = 2 + sum(1 for n in names if n.startswith("output"))
            check(name + ": output as on device 9", [[f or "NaN" for f in row[:width]] for row in rows] == [row[:width] for row in nine])
            names = compare(kalm, case, name + ".kalm")[0][0]
            check(name + ": rates of the output", any(n.endswith(".v") for n in names) and any(n.endswith(".a") for n in names), str(names))
        with open(os.path.join(data, "excavator.nml"), encoding="utf-8") as file:
            digger = file.read() + " &RATES SPEED=0.2 &END\n &MASSES NMASS=1, MNAME='bucket T', MASS=100.0, GRAVY=-9.81 &END\n"
        with open("digger.nml", "w", encoding="utf-8") as file:
            file.write(digger)
        for case in (os.path.join(data, "engine.nml"), "digger.nml"):
            forces(kalm, case)
        done = subprocess.run([os.path.join(directory, "ssics"), "--json", sketches[0]], capture_output=True, text=True, check=False)
        check("--json is no option of ssics", done.returncode == 2 and "--json is an option of psalm, kalm and muscle" in done.stderr, done.stderr)
        bare = "A CASE WITHOUT OUTPUTS\n &CHAIN JNT='A','B','C','D', JX=0.,0.,40.,70., JY=0.,30.,60.,0., LNK='A D','A B','B C','C D' &END\n" \
               " &DRIVES DRIVE='A' &END\n &METHOD IKIN=30 &END\n &LIMITS TANGLE=85. &END\n"
        with open("bare.nml", "w", encoding="utf-8") as file:
            file.write(bare)
        names = compare(psalm, "bare.nml", "bare")[0][0]
        check("without outputs: all joints", names == ["input", "closed"] + [j + c for j in "ABCD" for c in (".x", ".y")], str(names))
        names = compare(kalm, "bare.nml", "bare.kalm")[0][0]
        check("without outputs: rates of all joints", names == ["input", "closed"] + [
            j + c for j in "ABCD" for c in (".x", ".y", ".vx", ".vy", ".ax", ".ay")], str(names))
        os.chdir("/")
    return report()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
