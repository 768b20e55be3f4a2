#!/usr/bin/env python3
"""What is fast and what is slow, as ratios in one run; with another build, this one against that.

usage: speed.py PROGRAMS BENCH [PROGRAMS BENCH] [--short]
PROGRAMS: directory of the programs, BENCH: the benchmark made from bench/ with the library of the same build; the second pair is the
build that the first is held against ("before"). --short: everything once, to see that it runs. bench/speed builds and calls it.

Builds take turns, so that a machine whose speed drifts does not favour one. Seconds are those of the processor. A table in Markdown.
"""
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
DATA = os.path.join(TOP, "data")
SHORT = "--short" in sys.argv
words = [os.path.abspath(w) for w in sys.argv[1:] if not w.startswith("--")]
builds = list(zip(words[::2], words[1::2]))
ROUNDS = 1 if SHORT else 5
POSITIONS = 200 if SHORT else 20000
PROVEN = "geared_five_bar" if SHORT else "stephenson3_rod_driven"

FOUR_BAR = """FOUR-BAR
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=%d, DELT=%s &END
"""
TWO_LEGS = """TWO LEGS OF JANSEN ON ONE CRANK
 &CHAIN JNT='O','A','B','C','D','E','F','G','H','I','K','L','M','N',
  JX=0.0,15.0,-38.0,-24.0,-75.0,-27.0,-59.0,-43.0,38.0,24.0,75.0,27.0,59.0,43.0,
  JY=0.0,0.0,-7.8,31.0,8.0,-45.0,-28.0,-92.0,-7.8,31.0,8.0,-45.0,-28.0,-92.0,
  LNAME='frame','crank','j1','upper1','k1','c1','f1','foot1','j2','upper2','k2','c2','f2','foot2',
  LNK='O B H','O A','A C','C B D','A E','E B','D F','F E G','A I','I H K','A L','L H','K M','M L N' &END
 &DRIVES DRIVE='O' &END
 &OUTPUTS OUTPUT='point G','point N' &END
 &METHOD IKIN=1 &END
"""


def seconds(command, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          env=dict(os.environ, OMP_NUM_THREADS="1"))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        sys.exit("%s: exit status %d\n%s" % (" ".join(command), done.returncode, done.stderr[-500:]))
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measured(program, *task):
    """Lines of the benchmark by their first field, as numbers."""
    done = subprocess.run([program, *task], cwd=os.path.join(TOP, "bench"), capture_output=True, text=True, check=True,
                          env=dict(os.environ, OMP_NUM_THREADS="1"))
    rows = {}
    for line in done.stdout.splitlines():
        name, *numbers = line.split("|")
        rows[name.strip()] = [float(n) for n in numbers]
    return rows


def kernels(program):
    """Nanoseconds, by title: what the benchmark measures within one process."""
    found = {}
    for name, numbers in measured(program, "groups", DATA, *(["short"] if SHORT else [])).items():
        found[name + ", ns a position"] = numbers[-1]
    forces = measured(program, "forces", "short")
    found["motion with rates of the ten-bar, ns a dyad and position"] = forces["ten-bar (needle)"][2]
    found["forces after it, ns a dyad and position"] = forces["ten-bar (needle)"][3]
    if SHORT:
        return found
    found["objective of the needle at 20 positions, ns"] = measured(program, "objective")["20"][0]*1000.0
    found["Jacobian of the needle, 16 variables, 20 positions, ns"] = measured(program, "derivatives")["needle"][-1]*1000.0
    return found


def runs(programs, work):
    """Seconds of the processor of whole runs, by title."""
    psalm = [os.path.join(programs, "psalm"), "--quiet"]
    found = {}
    for title, name in (("all positions of the excavator, whole run, s", os.path.join(DATA, "excavator.nml")),
                        ("two legs of Jansen at 360 positions, whole run, s", "legs.nml"),
                        ("proof of %s, whole run, s" % PROVEN, os.path.join(DATA, PROVEN + ".nml")),
                        ("sketch of a four-bar at %d positions, with its CSV, s" % POSITIONS, "sketch.nml")):
        found[title] = seconds([*psalm, "--output-dir", "out", name], work)
    found["the same as loops with --json, s"] = seconds([*psalm, "--json", "--output-dir", "out", "loops.nml"], work)
    return found


def prepare(programs, work):
    """The cases that are no data sets; loops as the program writes them."""
    inputs = ",\n  ".join("%.6f" % (360.0*i/POSITIONS) for i in range(POSITIONS))
    os.mkdir(os.path.join(work, "out"))
    for name, text in (("legs.nml", TWO_LEGS), ("sketch.nml", FOUR_BAR % (POSITIONS, inputs)), ("few.nml", FOUR_BAR % (2, "0.0,1.0"))):
        with open(os.path.join(work, name), "w", encoding="utf-8") as file:
            file.write(text)
    seconds([os.path.join(programs, "psalm"), "--quiet", "--links", "--output-dir", "out", "few.nml"], work)
    with open(os.path.join(work, "out", "few.dev7"), encoding="utf-8") as file:
        text = "".join(line for line in file if not line.startswith("!"))
    text = re.sub(r"NDES=2,\s*DELT=0\.0,[^,]*,", "NDES=%d,\n  DELT=%s," % (POSITIONS, inputs), text)
    with open(os.path.join(work, "loops.nml"), "w", encoding="utf-8") as file:
        file.write(text)


def main():
    if len(words) not in (2, 4):
        sys.exit(__doc__)
    results = [{} for _ in builds]
    with tempfile.TemporaryDirectory() as work:
        prepare(builds[0][0], work)
        for _ in range(ROUNDS):
            for k, (programs, bench) in enumerate(builds):
                for title, value in {**kernels(bench), **runs(programs, work)}.items():
                    results[k].setdefault(title, []).append(value)
    now = results[0]
    middle = {title: statistics.median(values) for title, values in now.items()}
    print("| what | median of %d |%s" % (ROUNDS, " of the time before, median | least of either, ratio |" if len(builds) > 1 else ""))
    print("| --- | --- |" + (" --- | --- |" if len(builds) > 1 else ""))
    for title, values in now.items():
        line = "| %s | %.4g |" % (title, middle[title])
        if len(builds) > 1:
            old = results[1].get(title)
            line += " %.3f | %.3f |" % (statistics.median(a/b for a, b in zip(values, old)), min(values)/min(old)) if old else " - | - |"
        print(line)

    def ratio(title, over):
        pairs = list(zip(now[title], now[over]))
        print("| %s / %s | %.3f |%s" % (title.rsplit(",", 1)[0], over.rsplit(",", 1)[0], statistics.median(a/b for a, b in pairs),
                                        " | |" if len(builds) > 1 else ""))

    ten_bar, with_output = "ten-bar, a sketch, ns a position", "ten-bar, and the angle of its last link, ns a position"
    for teeth in ("10", "30"):
        ratio("the same with a wheel in gear, 20 to %s teeth, ns a position" % teeth, ten_bar)
        ratio("with a wheel, 20 to %s teeth, and the angle of the wheel, ns a position" % teeth, with_output)
    ratio("sketch of a four-bar at %d positions, with its CSV, s" % POSITIONS, "the same as loops with --json, s")


main()
