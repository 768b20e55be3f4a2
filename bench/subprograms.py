#!/usr/bin/env python3
"""Table 7.1 of the thesis anew: where the time of a run goes, by its subprograms.

usage: bench/subprograms.py PROGRAM_DIRECTORY [--runs N] [--page]

The thesis looked now and then which subprogram was at work (TIMETALLY), in an analysis of a six-bar linkage at 180 positions and in the
search of the needle linkage, 357 iterations. Here perf does, over N runs of each. A procedure counts for the subprogram that its module
has taken the place of (doc/history/thesis_map.md). With --page the table goes to doc/measured/subprograms.md. Needs Linux and perf.
"""
import argparse
import glob
import os
import re
import subprocess
import sys
import tempfile
import time

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SUBPROGRAMS = ["MAIN", "SETUP", "START", "SIMPLX", "CONSTR", "ERROR", "FINALE", "elementary functions, text, files", "(System)"]
PUBLISHED = {"MAIN": (8.22, 0.34), "SETUP": (0.0, 0.02), "START": (0.0, 0.01), "SIMPLX": (0.0, 2.81), "CONSTR": (0.0, 0.21),
             "ERROR": (46.28, 81.74), "FINALE": (23.14, 3.60), "(System)": (22.36, 11.27)}
MODULES = {"psalm_start": "START", "psalm_random": "START", "psalm_simplx": "SIMPLX", "psalm_constr": "CONSTR"}
FOLDERS = {"app": "MAIN", "input": "MAIN", "structure": "SETUP", "model": "SETUP", "motion": "ERROR", "assur": "ERROR", "synthesis": "FINALE",
           "study": "FINALE", "report": "FINALE", "base": SUBPROGRAMS[7], "optimise": "SIMPLX"}
SAMPLES = 10000          # of perf, a second
TITLES = ("analysis of a six-bar linkage, 180 positions", "search of the ten-bar needle linkage, 357 iterations")


def cases():
    """Both data sets: without the proof and the listings that the thesis does not have."""
    with open(os.path.join(TOP, "data", "dwell.nml"), encoding="utf-8") as file:
        six_bar = file.read()
    links = re.search(r" &LINKS.*?&END", six_bar, re.S).group()
    analysis = "SIX-BAR LINKAGE\n" + links + "\n &METHOD MOTION=1, IKIN=2 &END\n &LIMITS TANGLE=90.0 &END\n"
    with open(os.path.join(TOP, "data", "needle_search.nml"), encoding="utf-8") as file:
        search = file.read().replace("NITER=2000", "NITER=357, FMIN=0.0, SMALL=0.0").replace("FMIN=0.1, ", "").replace("IPLOT=1", "IPROOF=0")
    return analysis, search


def folders():
    """Module -> folder of its source."""
    found = {}
    for path in glob.glob(os.path.join(TOP, "src", "*", "*.f90")) + glob.glob(os.path.join(TOP, "app", "*.f90")):
        found[os.path.basename(path)[:-4].lower()] = os.path.basename(os.path.dirname(path))
    return found


def subprogram(dso, symbol, where):
    if "psalm" not in dso:
        return "(System)"
    match = re.match(r"__(\w+?)_MOD_", symbol)
    if not match:
        return "MAIN" if symbol.startswith("MAIN") else SUBPROGRAMS[7]
    module = match.group(1)
    folder = where.get(module, where.get(module + "_body", ""))
    return MODULES.get(module, FOLDERS.get(folder, SUBPROGRAMS[7]))


def profile(program, text, runs, where):
    """Shares of the subprograms, per cent, and seconds a run."""
    with tempfile.TemporaryDirectory() as place:
        with open(os.path.join(place, "case.nml"), "w", encoding="utf-8") as out:
            out.write(text)
        loop = "for i in $(seq %d); do '%s' --quiet case.nml >/dev/null 2>&1; done; true" % (runs, program)
        begun = time.perf_counter()
        subprocess.run(["perf", "record", "-q", "-e", "cpu-clock", "-F", str(SAMPLES), "-o", "data", "--", "bash", "-c", loop], cwd=place, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        seconds = (time.perf_counter() - begun) / runs
        listed = subprocess.run(["perf", "report", "-i", "data", "--comm", "psalm", "--sort", "dso,symbol", "--stdio", "--field-separator", "|",
                                 "--percent-limit", "0"], cwd=place, capture_output=True, text=True, check=True).stdout
    shares = dict.fromkeys(SUBPROGRAMS, 0.0)
    for line in listed.splitlines():
        words = [word.strip() for word in line.split("|")]
        if line.startswith("#") or len(words) < 3:
            continue
        shares[subprogram(words[1], words[2].split("]")[-1].strip(), where)] += float(words[0].rstrip("%"))
    total = sum(shares.values())
    return {name: 100 * share / total for name, share in shares.items()}, seconds


def share(shares, name):
    """Of the whole run, and without the system."""
    if name == "(System)":
        return "%.1f" % shares[name]
    return "%.1f (%.1f)" % (shares[name], 100 * shares[name] / (100 - shares["(System)"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--page", action="store_true")
    options = parser.parse_args()
    program, where = os.path.join(os.path.abspath(options.programs), "psalm"), folders()
    found = [profile(program, text, options.runs, where) for text in cases()]
    lines = ["| subprogram | %s: thesis | here (of psalm's own) | %s: thesis | here (of psalm's own) |" % TITLES, "| --- | --- | --- | --- | --- |"]
    for name in SUBPROGRAMS:
        old = ["%.2f" % value for value in PUBLISHED[name]] if name in PUBLISHED else ["-", "-"]
        here = [share(shares, name) for shares, _ in found]
        lines.append("| %s | %s | %s | %s | %s |" % (name, old[0], here[0], old[1], here[1]))
    lines.append("| total, s (here by the clock) | 0.523 | %.4f | 37.625 | %.4f |" % (found[0][1], found[1][1]))
    table = "\n".join(lines)
    print(table)
    if options.page:
        with open("/proc/cpuinfo", encoding="utf-8") as text:
            machine = next(line.split(":", 1)[1].strip() for line in text if line.startswith("model name"))
        version = subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=TOP, capture_output=True, text=True, check=True).stdout.strip()
        with open(os.path.join(TOP, "doc", "measured", "subprograms.md"), "w", encoding="utf-8") as out:
            out.write("""# Time in each subprogram

Table 7.1 of Oldham's thesis (7.2.5) anew, in per cent of the time of the processor. The thesis had an analysis of a six-bar linkage and the
search of the needle linkage on an IBM 360, input and output included. `bench/subprograms.py PROGRAM_DIRECTORY --page` repeats it with
the sampling of perf: %d runs of each, %d samples a second, %s, commit %s. The subprograms' places are taken by the modules that
[the map](../history/thesis_map.md) names: MAIN is reading, SETUP `src/structure` and `src/model`, ERROR `src/motion` and
`src/assur`, FINALE what studies and lists the result. The runs are so short that starting the program, which (System) has in it, takes most
of their time; in brackets are the shares without it.

%s
""" % (options.runs, SAMPLES, machine, version, table))
    return 0


if __name__ == "__main__":
    sys.exit(main())
