#!/usr/bin/env python3
"""Cases in JSON and in NAMELIST are the same cases.

usage: test/program/json_cases.py PROGRAM_DIRECTORY [--quick]

A reader of NAMELIST of its own turns every data set into JSON (--quick: but those that take many seconds); psalm (kalm, muscle ...
where a group asks for them) must say the same of both, byte by byte but for the mark of the run, and write the same devices. The
schema of --items=json must accept what is turned. Mistakes in JSON are told with line and column, or with the place of the item.
Last line: N passed, N failed.
"""
import glob
import json
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from all_data_sets import LONG
from namelist import read_namelist
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# starts, speeds, points of charts, positions of a turn: what is read is compared, so a few of them do
FEWER_OF = {"NSSTRT": 1, "NCSPED": 2, "NCRAD": 6, "NDSPED": 11, "NVSPED": 10, "NVCHRT": 11}
FEWER = re.compile(r"\b(%s) *= *\d+" % "|".join(FEWER_OF))
PROGRAM_OF = {"bridge": "bridge", "calm": "calm", "muscle": "muscle", "ssics": "ssics"}


def as_json(value):
    """A value as JSON writes it, or None where it has no number like this one."""
    if value is None:
        return "null"
    if isinstance(value, tuple):
        return json.dumps(value[1])
    word = re.sub(r"[dD]", "e", value) if re.match(r"[-+.\d]", value) else value
    word = re.sub(r"^\+", "", re.sub(r"^([-+]?)\.", r"\g<1>0.", re.sub(r"\.(?=$|[eE])", ".0", word)))
    word = re.sub(r"^(-?)0+(?=\d)", r"\1", word)
    return word if re.fullmatch(r"-?\d+(\.\d+)?([eE][-+]?\d+)?", word) else json.dumps(value)


def to_json(cases, columns):
    """The text of all cases; None where one has what JSON has no way to write."""
    texts = []
    for title, groups in cases:
        parts = ['"title": ' + json.dumps(title.strip())]
        for group, items in groups.items():
            written = []
            for item, mentions in items.items():
                if len(mentions) == 1 and not mentions[0][0]:
                    values = mentions[0][1]
                elif all(len(places) == 1 for places, _ in mentions):
                    values = []
                    for (first,), new in mentions:
                        values += [None] * (first - 1 + len(new) - len(values))
                        values[first - 1:first - 1 + len(new)] = new
                else:
                    rows = {}
                    for places, new in mentions:
                        if len(places) != 2:
                            return None
                        row = rows.setdefault(places[0], [])
                        row += [None] * (places[1] - 1 + len(new) - len(row))
                        row[places[1] - 1:places[1] - 1 + len(new)] = new
                    written.append('"%s": [%s]' % (item, ", ".join(
                        "[%s]" % ", ".join(map(as_json, rows.get(r, []))) for r in range(1, max(rows) + 1))))
                    continue
                width = columns.get((group, item))
                if width and len(values) > width and len(values) % width == 0:
                    rows = [values[i:i + width] for i in range(0, len(values), width)]
                    written.append('"%s": [%s]' % (item, ", ".join("[%s]" % ", ".join(map(as_json, row)) for row in rows)))
                elif len(values) == 1:
                    written.append('"%s": %s' % (item, as_json(values[0])))
                else:
                    written.append('"%s": [%s]' % (item, ", ".join(map(as_json, values))))
            parts.append('"%s": {%s}' % (group, ",\n   ".join(written)))
        texts.append("{" + ",\n ".join(parts) + "}")
    return texts[0] + "\n" if len(texts) == 1 else "[" + ",\n".join(texts) + "]\n"


def run(program, name, text, place):
    """Everything that a run says and writes, without the mark of the run and the name of the case."""
    folder = os.path.join(place, name.replace(".", "_"))
    os.mkdir(folder)
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([program, name], cwd=folder, capture_output=True, text=True, timeout=300)
    said = {"status": str(done.returncode), "listing": done.stdout, "messages": done.stderr}
    for path in sorted(os.listdir(folder)):
        if path != name:
            with open(os.path.join(folder, path), encoding="utf-8") as file:
                said[path] = file.read()
    mask = lambda words: re.sub(r"(?i)\brun [0-9a-f]{4,}\b", "run", re.sub(r"(?m)\bcase:\d+:|^ \d+:(?= (?:warning|error))", "case:", words.replace(name, "case")))
    return {key: mask(words) for key, words in said.items()}


def numbers(text):
    """Words of devices 7 and 8, which keep groups as they were written: numbers by their values."""
    words = re.split(r"[\s,=]+", re.sub(r"\b(\d+)\*([^\s,]+)", lambda m: " ".join([m[2]] * int(m[1])), re.sub(r"\([\d,]+\)=", "=", text or "")))
    return [float(w.lower().replace("d", "e")) if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([ed][-+]?\d+)?", w, re.I) else w for w in words]


def all_data_sets(programs, place, schemas, quick):
    number = 0
    files = sorted(glob.glob(os.path.join(TOP, "data", "**", "*.nml"), recursive=True))
    for path in files:
        folder = os.path.relpath(os.path.dirname(path), os.path.join(TOP, "data"))
        if "reference" in folder or "hard" in folder or (quick and LONG.match(os.path.relpath(path, TOP))):
            continue
        with open(path, encoding="utf-8", errors="replace") as file:
            text = file.read()
        text = FEWER.sub(lambda item: "%s=%d" % (item[1], FEWER_OF[item[1]]), text).replace("&FLEX ", "&FLEX NXPNT=64, ")
        cases = read_namelist(text)
        program = PROGRAM_OF.get(folder.split(os.sep)[0], "psalm")
        if program == "psalm" and re.search(r"MAXTIME|NSTART *= *[1-9]\d\d|NITER *= *\d{4}|NGUESS", text):
            continue
        columns = {("LINKS", item): int(float(groups["LINKS"]["MAXARC"][0][1][0])) for _, groups in cases for item in
                   ("ILINK", "ILOOP", "ARCL", "GAMA") if "MAXARC" in groups.get("LINKS", {})} if len(cases) == 1 else {}
        turned = to_json(cases, columns)
        if turned is None:
            continue
        here = tempfile.mkdtemp(dir=place)
        parsed = json.loads(turned)
        for case in parsed if isinstance(parsed, list) else [parsed]:
            wrong = refused(case, schemas[program])
            check("%s: the schema accepts it" % os.path.relpath(path, TOP), not wrong, wrong)
        one = run(os.path.join(programs, program), "case.nml", text, here)
        other = run(os.path.join(programs, program), "case.json", turned, here)
        number += 1
        for key in sorted(set(one) | set(other)):
            if key == "messages":
                same = sorted(re.sub(r"&(\w+) (\w+)|/(?:\d+/)?(\w+)/(\w+)(?:/\d+)*", r"\1\3 \2\4", line) for line in one[key].splitlines()) == \
                    sorted(re.sub(r"&(\w+) (\w+)|/(?:\d+/)?(\w+)/(\w+)(?:/\d+)*", r"\1\3 \2\4", line) for line in other[key].splitlines())
            else:
                where = r"(?<=: )(?:&(\w+) (\w+)|/(?:\d+/)?(\w+)/(\w+)(?:/\d+)*)(?=:)"
                one[key], other[key] = (re.sub(where, r"\1\3 \2\4", which.get(key, "")) for which in (one, other))
                same = one.get(key) == other.get(key) or (key.endswith((".dev7", ".dev8")) and numbers(one.get(key)) == numbers(other.get(key)))
            check("%s: %s of JSON is that of NAMELIST" % (os.path.relpath(path, TOP), key), same,
                  "\n%.300s\n%.300s" % (one.get(key), other.get(key)) if not same else "")
    check("most data sets are turned", number > 40, number)


def refused(case, schema):
    """What of a case the schema does not know or allow; empty if nothing."""
    groups = schema["$defs"]["case"]["properties"]
    for group, items in case.items():
        if group == "title" or group.startswith("USER"):
            continue
        if group not in groups:
            return "group " + group
        known = groups[group].get("properties")
        for item, value in items.items() if known else ():
            rule = known.get(item) or next((r for p, r in groups[group].get("patternProperties", {}).items() if re.search(p, item)), None)
            if rule is None:
                return group + " " + item
            if "type" in rule and not isinstance(value, {"integer": (int, float), "number": (int, float), "string": str}[rule["type"]]):
                return "%s %s: %r" % (group, item, value)
            if "enum" in rule and (value.upper() if isinstance(value, str) else value) not in rule["enum"]:
                return "%s %s: %r" % (group, item, value)
            if isinstance(value, (int, float)) and not (rule.get("minimum", -1e99) <= value <= rule.get("maximum", 1e99)):
                return "%s %s: %r" % (group, item, value)
    return ""


FOUR_BAR = """{
  "title": "FOUR-BAR",
  "LINKS": {"NLOOP": 1, "MAXARC": 4, "ILINK": [[1, 2, 3, 4]], "ILOOP": [1, 0, 0, 1],
    "ARCL": [[40.0, 120.0, 80.0, 130.0]], "NOUTLK": 3, "NOUTLP": 1},
  "METHOD": {"MOTION": 1, "IKIN": 30}
}
"""
MISTAKES = [
    ('"MAXARC": 4', '"MAXARC": 4x', "case.json:3: error: column 35: a number, a text in quotes, true, false, null or an array of them is expected; found '4x"),
    ('"IKIN": 30}', '"IKIN": 30', "case.json:6: error: column 2: , is expected before the next group, or } after the last; found the end of the text"),
    ('{"MOTION"', '{MOTION', "case.json:5: error: column 14: a name in quotes is expected; found 'MOTION"),
    ('"FOUR-BAR"', '"FOUR-BAR', "case.json:2: error: column 12: the text in quotes does not end in this line"),
    ('"FOUR-BAR"', r'"FOUR\xBAR"', "the escape is none of"),
    ('"title": "FOUR-BAR"', '"title": 7', 'a text in quotes is expected for "title"'),
    ("[1, 0, 0, 1]", "[[[1, 0, 0, 1]]]", "rows have no further rows"),
    ('30}\n}\n', '30}\n}\n7', "case.json:7: error: column 1: nothing may follow here"),
    ("130.0]]", "-130.0]]", "case.json:4: error: /LINKS/ARCL/0/3: length of arc 4 in loop 1 is negative"),
    ("[1, 0, 0, 1]", "[1, 0, 0.5, 1]", "case.json:3: error: /LINKS/ILOOP/2: an integer is expected"),
    ('"IKIN": 30', '"IKIN": "30"', "case.json:5: error: /METHOD/IKIN: an integer is expected; found '30'"),
    ('"IKIN": 30', '"IKIN": 400', "case.json:5: error: /METHOD/IKIN: must be from -360 to 360; found 400"),
    ('"IKIN": 30', '"IKIM": 30', "case.json:5: error: /METHOD/IKIM: no such item; did you mean IKIN?"),
    ('"IKIN": 30', '"IKIN": 30, "IKIN": 40', "/METHOD/IKIN: given twice"),
    ('"METHOD"', '"METHOT"', "did you mean &METHOD?"),
    ('"NLOOP": 1, ', '', "/LINKS/NLOOP: missing; this item is required"),
    ('"IKIN": 30', '"IKIN": 30}, "LIMITS": {"LAST": 0', "/LIMITS/LAST: has no effect: in JSON several cases are an array"),
]


def mistakes(psalm, place):
    sound = subprocess.run([psalm, "-"], input=FOUR_BAR, cwd=place, capture_output=True, text=True)
    check("a case in JSON from standard input", sound.returncode == 0 and " FOUR-BAR" in sound.stdout, sound.stderr)
    for before, after, words in MISTAKES:
        with open(os.path.join(place, "case.json"), "w", encoding="utf-8") as file:
            file.write(FOUR_BAR.replace(before, after))
        check("the edit changes the case: " + after, FOUR_BAR.count(before) == 1)
        done = subprocess.run([psalm, "case.json"], cwd=place, capture_output=True, text=True)
        check("said: " + words, words in done.stderr and done.returncode == (0 if "no effect" in words else 2), done.stderr)
    example = os.path.join(TOP, "data", "four_bars.json")
    done = subprocess.run([psalm, "--output-dir", place, example], capture_output=True, text=True)
    check("the example has two cases", done.returncode == 0 and done.stdout.count(" ARRAY OF ARC LENGTHS") == done.stdout.count(" LENGTHS BETWEEN JOINTS") == 1, done.stderr)
    several = "[" + FOUR_BAR + "," + FOUR_BAR.replace("130.0]]", "-130.0]]") + "]"
    done = subprocess.run([psalm, "-"], input=several, cwd=place, capture_output=True, text=True)
    check("the case is part of the pointer", "/1/LINKS/ARCL/0/3: length" in done.stderr, done.stderr)
    for text in ("", "{", "[", "[{", "{}", '{"title":"T"', '{"title":"T","METHOD":', '{"a":{"b":[', "[[", "{\x00"):
        done = subprocess.run([psalm, "-"], input=text, cwd=place, capture_output=True, text=True)
        check("refused: %r" % text, done.returncode == 2 and "error" in done.stderr, done.stderr)


def main():
    programs = os.path.abspath(sys.argv[1])
    schemas = {name: json.loads(subprocess.run([os.path.join(programs, name), "--items=json"], capture_output=True, text=True, check=True).stdout)
               for name in ("psalm", "bridge", "calm", "muscle", "ssics")}
    with tempfile.TemporaryDirectory() as place:
        mistakes(os.path.join(programs, "psalm"), place)
        all_data_sets(programs, place, schemas, "--quick" in sys.argv)
    return report()


if __name__ == "__main__":
    sys.exit(main())
