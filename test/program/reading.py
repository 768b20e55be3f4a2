#!/usr/bin/env python3
"""What doc/reference/tables.md shows: each program there reads the results of data/jansen.nml, and results keep to the schema.
The JSON of every data set (but long searches) is read by a parser that knows no NaN, as JSON knows none.

usage: reading.py BIN   (directory with the programs). Languages that are not installed are skipped. The last line is N passed,
N failed.
"""
import concurrent.futures
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from all_data_sets import runs
from results import no_number
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
REFERENCE = os.path.join(TOP, "doc", "reference")
# how a program in a language is run, and which packages of it the first line needs
RUN = {"python": ([sys.executable], "py"), "r": (["Rscript"], "R"), "matlab": (["octave", "--no-gui", "--quiet"], "m"), "julia": (["julia"], "jl")}
CASES = (("psalm", "jansen.nml"), ("kalm", "engine.nml"), ("muscle", "muscle/lamp.nml"), ("ssics", "ssics/hill.nml"),
         ("calm", "calm/translating_roller.nml"), ("bridge", "bridge/four_bar_haines.nml"))
LONGEST = ("haines_springs", "five_bar_cams")   # a quarter of the time that all data sets take
TYPES = {"object": dict, "array": list, "string": str, "number": (int, float), "null": type(None)}


def faults(value, schema, root, place="results"):
    """Where a value breaks a schema; the words of JSON Schema that ours uses, none other."""
    unknown = set(schema) - {"$schema", "$defs", "$ref", "title", "description", "type", "enum", "pattern", "required", "properties",
                             "patternProperties", "additionalProperties", "items"}
    if unknown:
        yield "the schema has %s" % unknown
    if "$ref" in schema:
        yield from faults(value, root["$defs"][schema["$ref"].rsplit("/", 1)[1]], root, place)
        return
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(isinstance(value, TYPES[kind]) and not isinstance(value, bool) for kind in kinds):
        yield "%s is no %s" % (place, kinds)
        return
    if "enum" in schema and value not in schema["enum"] or "pattern" in schema and not re.search(schema["pattern"], value):
        yield "%s is %r" % (place, value)
    if isinstance(value, dict):
        for name in set(schema.get("required", ())) - set(value):
            yield "%s has no %s" % (place, name)
        for name, one in value.items():
            by_pattern = [rule for pattern, rule in schema.get("patternProperties", {}).items() if re.search(pattern, name)]
            rule = schema.get("properties", {}).get(name, (by_pattern + [schema.get("additionalProperties", {})])[0])
            if rule is False:
                yield "%s has %s" % (place, name)
            else:
                yield from faults(one, rule, root, place + "/" + name)
    elif isinstance(value, list):
        for one in value:
            yield from faults(one, schema.get("items", {}), root, place)


def strict(text):
    """What a text in JSON says; an error where it has NaN or Infinity."""
    return json.loads(text, parse_constant=no_number)


def results_of(program, case):
    """The JSON of a data set, or None where the program refuses it."""
    with tempfile.TemporaryDirectory() as work:
        done = subprocess.run([program, "--quiet", "--json", "--output-dir", work, os.path.join(TOP, case)], capture_output=True,
                              text=True, check=False)
        if done.returncode == 2:
            return None
        name, = (n for n in os.listdir(work) if n.endswith(".json"))
        with open(os.path.join(work, name), encoding="utf-8") as file:
            return file.read()


def has_rates(case):
    with open(os.path.join(TOP, case), encoding="utf-8") as file:
        return re.search("[&$](RATES|MASSES|LOADS|SPRING|MOTOR|FRICTN)", file.read()) is not None


def every_data_set(directory, schema):
    """All that the programs write as JSON is JSON that keeps to the schema: of every data set by the programs that it is for."""
    try:
        strict('{"closes": NaN}')
        check("the parser refuses NaN", False)
    except ValueError:
        check("the parser refuses NaN", True)
    pairs = [(program, case) for program, case in runs(quick=True) if os.path.basename(case)[:-4] not in LONGEST and
             (program not in ("balm", "kalm") or (program == "kalm" and has_rates(case)))]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        texts = list(pool.map(lambda pair: results_of(os.path.join(directory, pair[0]), pair[1]), pairs))
    check("nearly all data sets have results", sum(text is not None for text in texts) > 0.9*len(pairs), str(len(pairs)))
    for (program, case), text in zip(pairs, texts):
        if text is None:
            continue
        try:
            fault = list(faults(strict(text), schema, schema))[:3]
        except ValueError as error:
            fault = str(error)
        check("%s, %s: strict JSON, described by the schema" % (program, case), not fault, fault)
    blocks = schema["$defs"]["case"]["properties"]["blocks"]["properties"]
    for path in glob.glob(os.path.join(TOP, "src", "report", "*.f90")):
        with open(path, encoding="utf-8") as file:
            for name, more in re.findall(r"table_of\('(\w+)'(.*(?:&\n.*)*)", file.read()):
                check("the schema has the block " + name, name in blocks or "for_plots" in more, path)


def has_package(name):
    return subprocess.run([sys.executable, "-c", "import " + name], capture_output=True, check=False).returncode == 0


def read_in_languages(work):
    """The programs of the page, in its order."""
    with open(os.path.join(REFERENCE, "tables.md"), encoding="utf-8") as file:
        blocks = re.findall(r"^```(\w+)\n(.*?)^```", file.read(), re.S | re.M)
    check("the page has programs in four languages", {language for language, _ in blocks} == set(RUN), str([b[0] for b in blocks]))
    with open(os.path.join(work, "jansen.json"), encoding="utf-8") as file:
        values = json.load(file)["cases"][0]["blocks"]["positions"]["columns"]["G.y"]
    ends = min(values), max(values)
    skipped = []
    for n, (language, text) in enumerate(blocks):
        command, ending = RUN[language]
        needed = [name for name in re.findall(r"^import (\w+)", text, re.M) if language == "python" and not has_package(name)]
        if not shutil.which(command[0]) or needed:
            skipped.append(" ".join([language] + needed))
            continue
        name = os.path.join(work, "block%d.%s" % (n, ending))
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run(command + [name], cwd=work, capture_output=True, text=True, check=False, timeout=300)
        check("%s: block %d of the page runs and prints" % (language, n + 1), done.returncode == 0 and done.stdout.strip(), done.stderr[-400:])
        if language != "python":
            printed = [float(word) for word in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", done.stdout)]
            check("%s: what it prints are the ends of the column" % language, len(printed) == 2 and
                  all(abs(one - end) < 1e-4 * abs(end) for one, end in zip(printed, ends)), (printed, ends))
    if skipped:
        print("SKIPPED: results read in " + ", ".join(skipped))
    return len(skipped)


def main(directory):
    with open(os.path.join(REFERENCE, "results.schema.json"), encoding="utf-8") as file:
        schema = json.load(file)
    with tempfile.TemporaryDirectory() as work:
        for program, case in CASES:
            done = subprocess.run([os.path.join(os.path.abspath(directory), program), "--quiet", "--json", "--output-dir", work,
                                   os.path.join(TOP, "data", case)], capture_output=True, text=True, check=False)
            check("%s runs %s" % (program, case), done.returncode in (0, 1), done.stderr[-400:])
            stem = os.path.basename(case)[:-4] + ("" if program == "psalm" else "." + program)
            with open(os.path.join(work, stem + ".json"), encoding="utf-8") as file:
                whole = json.load(file)
            found = list(faults(whole, schema, schema))
            check("%s, %s keeps to the schema" % (program, case), not found, str(found[:3]))
            blocks = [block for one in whole["cases"] for block in one["blocks"].values()]
            check("%s, %s: units of all columns, rows of one number" % (program, case), all(
                list(b["units"]) == list(b["columns"]) and len({len(values) for values in b["columns"].values()}) == 1 for b in blocks))
            if program == "psalm":
                whole["cases"][0]["blocks"]["positions"]["columns"]["input"][0] = [1]
                check("the schema refuses what it does not know", list(faults(whole, schema, schema)))
                del whole["run"]
                check("the schema misses the mark", any("run" in fault for fault in faults(whole, schema, schema)))
        every_data_set(os.path.abspath(directory), schema)
        skipped = read_in_languages(work)
    return report(skipped)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
