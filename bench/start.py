#!/usr/bin/env python3
"""The fixed cost of a run, and two searches: processor time and faults of pages, the least of many runs in turns, files in memory.

usage: start.py PROGRAMS [--short]    (PROGRAMS: a directory with psalm). Writes a table in Markdown.
"""
import os
import shutil
import sys
import tempfile
import time

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CASES = 1000


def run(command, folder):
    """Seconds of the processor, seconds, faults of pages."""
    began = time.perf_counter()
    child = os.posix_spawn(command[0], command, os.environ, file_actions=[(os.POSIX_SPAWN_OPEN, to, os.devnull, os.O_WRONLY, 0)
                                                                  for to in (1, 2)])
    _, status, used = os.wait4(child, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        sys.exit("failed: %s in %s" % (" ".join(command), folder))
    return used.ru_utime + used.ru_stime, time.perf_counter() - began, used.ru_minflt


def main(programs, short):
    psalm = os.path.join(os.path.abspath(programs), "psalm")
    data = os.path.join(TOP, "data")
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
        os.chdir(folder)
        for name in ("dyad4_slider_crank", "path18", "needle_lsq"):
            shutil.copy(os.path.join(data, name + ".nml"), folder)
        with open("dyad4_slider_crank.nml", encoding="utf-8") as file:
            case = file.read().replace("IPLOT=1", "IPLOT=0, LAST=0")
        with open("many.nml", "w", encoding="utf-8") as file:
            file.write(case*(CASES - 1) + case.replace(", LAST=0", ""))
        tasks = [("`psalm --version`", [psalm, "--version"], 300), ("`psalm data/dyad4_slider_crank.nml`", [psalm, "dyad4_slider_crank.nml"], 300),
                 ("%d such cases in one file, without devices" % CASES, [psalm, "many.nml"], 5),
                 ("`psalm data/path18.nml`, 200 starts", [psalm, "path18.nml"], 20), ("`psalm data/needle_lsq.nml`", [psalm, "needle_lsq.nml"], 10)]
        made = {title: [] for title, _, _ in tasks}
        for turn in range(1 if short else max(times for _, _, times in tasks)):
            for title, command, times in tasks:
                if turn < times:
                    made[title].append(run(command, folder))
    print("| run | processor, ms, least | lower quartile | elapsed, ms, least | faults of pages |\n| --- | --- | --- | --- | --- |")
    for title, values in made.items():
        used, took = sorted(v[0] for v in values), min(v[1] for v in values)
        print("| %s | %.3g | %.3g | %.3g | %d |" % (title, 1e3*used[0], 1e3*used[len(used)//4], 1e3*took, min(v[2] for v in values)))


if __name__ == "__main__":
    main(sys.argv[1], "--short" in sys.argv)
