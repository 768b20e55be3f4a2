#!/usr/bin/env python3
"""Which lines of src/ and app/ the tests run.

usage: coverage.py [--least PER_CENT] [--quick]. Names what is left, file by file; the last line is N of M lines, per cent.
The exit status is 1 below PER_CENT (97). --quick leaves out the parts that take longest. build/coverage/lines.json tells for every line which tests ran it.
"""
import argparse
import glob
import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import workshop

PLACE = os.path.join(workshop.TOP, "build", "coverage")


def lines_of(folder, build):
    """(file, line) -> whether it was run, from the counters that one stage left in `folder`."""
    seen = {}
    for notes in glob.glob(os.path.join(build.place, "*.gcno")):
        link = os.path.join(folder, os.path.basename(notes))
        if not os.path.lexists(link):
            os.symlink(notes, link)
    counters = sorted(os.path.basename(n) for n in glob.glob(os.path.join(folder, "*.gcda")))
    if not counters:
        return seen
    text = subprocess.run(["gcov", "--json-format", "--stdout"] + counters, cwd=folder, capture_output=True, check=True).stdout
    for part in text.decode().splitlines():
        for file in json.loads(part)["files"]:
            if not file["file"].startswith(("src/", "app/")):
                continue
            text = open(os.path.join(build.top, file["file"]), encoding="utf-8").read().split("\n")
            for line in file["lines"]:
                if text[line["line_number"] - 1].lower().startswith("end module"):
                    continue        # procedures that the compiler makes for types
                key = (file["file"], line["line_number"])
                seen[key] = seen.get(key, False) or line["count"] > 0
    return seen


def measure(tree, build, quick):
    """Run every stage. Returns all lines, and for each line that is run the names of the stages that ran it."""
    everything, ran = set(), {}
    for number, stage in enumerate(workshop.stages(tree, build, build, build)):
        if quick and stage.name in workshop.SLOW:
            continue
        folder = os.path.join(PLACE, "counters", str(number))
        os.makedirs(folder, exist_ok=True)
        sound = stage.run(tree, 3600, GCOV_PREFIX=folder, GCOV_PREFIX_STRIP=str(build.place.count("/")))
        print("-- %s%s" % (stage.name, "" if sound else ": FAILED\n" + stage.output[-2000:]), file=sys.stderr, flush=True)
        for key, hit in lines_of(folder, build).items():
            everything.add(key)
            if hit:
                ran.setdefault(key, []).append(stage.name)
    return everything, ran


def ranges(numbers):
    """1,2,3,7 as 1-3 7."""
    words, first = [], None
    for i, n in enumerate(numbers):
        first = n if first is None else first
        if i + 1 == len(numbers) or numbers[i + 1] != n + 1:
            words.append(str(n) if n == first else "%d-%d" % (first, n))
            first = None
    return " ".join(words)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--least", type=float, default=97.0)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    tree = os.path.join(PLACE, "tree")
    workshop.copy_tree(tree)
    subprocess.run(["rm", "-rf", os.path.join(PLACE, "counters")], check=True)
    flags = workshop.quick_flags() + ["--coverage"]
    build = workshop.Build(tree, os.path.join(tree, "build", "debug"), flags)
    build.all()
    everything, ran = measure(tree, build, options.quick)
    with open(os.path.join(PLACE, "lines.json"), "w", encoding="utf-8") as out:
        json.dump([[file, line, ran.get((file, line), [])] for file, line in sorted(everything)], out)
    for file in sorted({file for file, _ in everything}):
        lines = sorted(line for name, line in everything if name == file)
        left = [line for line in lines if (file, line) not in ran]
        if left:
            print("%5.1f %s: %s" % (100.0 * (len(lines) - len(left)) / len(lines), file, ranges(left)))
    share = 100.0 * len(ran) / len(everything)
    print("%d of %d lines, %.2f per cent" % (len(ran), len(everything), share))
    return share < options.least


if __name__ == "__main__":
    sys.exit(main())
