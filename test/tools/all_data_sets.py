#!/usr/bin/env python3
"""Runs every data set of data/ through every program that takes it, and puts listings, messages and files into a directory.

usage: all_data_sets.py PROGRAM_DIRECTORY OUT [--jobs J] [--quick]     --quick leaves searches out that take many seconds
       all_data_sets.py --compare OUT OTHER                            are all files the same, byte by byte?

Data sets with a limit of time (MAXTIME) are left out: where a search stops then is no property of the program. The last line of a
comparison is N passed, N failed.
"""
import argparse
import concurrent.futures
import filecmp
import glob
import os
import re
import subprocess
import sys

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LONG = re.compile(r"data/(dwell|line6|needle_wide|door_five_poses|exact/three_bends|paths/|types/)")
SECONDS = 1800     # a run that takes longer is a fault
OWN = {"muscle": ("BALANC", "SPRNGS"), "calm": ("CAM",), "ssics": ("VIBR", "ESTIM", "FLEX", "DRIVEL", "HILL"), "bridge": ("CLEAR",)}


def runs(quick):
    """Pairs of a program and a data set."""
    for path in sorted(glob.glob(os.path.join(TOP, "data", "**", "*.nml"), recursive=True)):
        name = os.path.relpath(path, TOP)
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if "MAXTIME" in text or (quick and LONG.match(name)):
            continue
        groups = set(re.findall(r"[&$](\w+)", text))
        for program in ["psalm", "kalm", "balm"] + [p for p, needed in OWN.items() if groups & set(needed)]:
            yield program, name


def run(programs, out, program, name):
    folder = os.path.join(out, program, os.path.dirname(name))
    stem = os.path.join(folder, os.path.basename(name)[:-4])
    os.makedirs(folder, exist_ok=True)
    with open(stem + ".listing", "wb") as listing, open(stem + ".messages", "wb") as messages:
        # a path from the top of the checkout: what a run says must not depend on where the files go
        status = subprocess.run([os.path.join(programs, program), "--quiet", "--output-dir", folder, name], cwd=TOP, stdout=listing,
                                stderr=messages, stdin=subprocess.DEVNULL, timeout=SECONDS, check=False).returncode
    with open(stem + ".status", "w", encoding="ascii") as file:
        file.write("%d\n" % status)
    return status


def files_of(top):
    return {os.path.relpath(os.path.join(folder, name), top) for folder, _, names in os.walk(top) for name in names}


def compare(one, other):
    names = sorted(files_of(one) | files_of(other))
    differ = [name for name in names if not all(os.path.exists(os.path.join(top, name)) for top in (one, other)) or
              not filecmp.cmp(os.path.join(one, name), os.path.join(other, name), shallow=False)]
    for name in differ:
        print("FAILED: %s differs" % name)
    print("%d passed, %d failed" % (len(names) - len(differ), len(differ)))
    return bool(differ) or not names


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("one")
    parser.add_argument("other")
    parser.add_argument("--compare", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.compare:
        return compare(options.one, options.other)
    programs, out = os.path.abspath(options.one), os.path.abspath(options.other)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        done = list(pool.map(lambda pair: run(programs, out, *pair), runs(options.quick)))
    strange = sum(status not in (0, 1, 2) for status in done)
    print("%d runs, %d with an exit status other than 0, 1 or 2" % (len(done), strange))
    return strange > 0


if __name__ == "__main__":
    sys.exit(main())
