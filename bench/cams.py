"""Tables of what bench/cams measured, and what the programs themselves say. usage: cams.py DIRECTORY DIRECTORY_OF_PROGRAMS"""
import os
import subprocess
import sys

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
OUT, BIN = map(os.path.abspath, sys.argv[1:3])
COSTS = {"translating_roller": "roller on a slide, law of the input", "swinging_roller": "roller on an arm, law of the input",
         "needle_cam": "ten-bar needle linkage, law of the output", "five_bar_cams": "five-bar with two cams, laws of the outputs"}
CUT = ["translating_roller", "swinging_roller", "flat_translating", "flat_swinging", "needle_cam", "five_bar_cams"]
# the published motion of the needle bar
TABLE = """ &CAM NTAB=20,
 TABANG=0.,15.,30.,45.,60.,90.,120.,135.,150.,165.,195.,210.,225.,231.,240.,255.,270.,285.,300.,330.,
 TABOUT=149.99,150.7,150.96,150.56,149.35,146.46,145.58,3*145.55,145.27,144.85,144.33,144.23,144.4,144.68,145.85,146.17,146.23,147.2,
 TABTOL=0.2, NPOINT=3600, NFOLLK=-1, FOLLK=60.0, FOLANG=150.0, RROLL=2.0, XCAM=100.0, YCAM=60.0, ALFMAX=89.0 &END
"""


def read(name):
    with open(name, encoding="utf-8") as file:
        return file.read()


def run(program, text):
    """Device 9 of a case."""
    name = os.path.join(OUT, "case.nml")
    with open(name, "w", encoding="utf-8") as file:
        file.write(text)
    subprocess.run([os.path.join(BIN, program), "--quiet", name], stdout=subprocess.DEVNULL, check=False)
    return read(os.path.join(OUT, "case.calm.dev9" if program == "calm" else "case.dev9")).split("\n")


def rows_of(lines):
    """Numbers of the first block."""
    end = next((i for i, line in enumerate(lines) if line.startswith("# block")), len(lines))
    return [[float(word) for word in line.split()] for line in lines[:end] if line and line[0] != "#"]


def data(name):
    return read(os.path.join(TOP, "data", "calm", name + ".nml"))


def needle_error():
    """Output of psalm at the inputs that calm found, against the law, over its range."""
    law = data("needle_cam").split(" &CAM")[0].replace("CRNKI=115.0", "CRNKI=230.0")
    table = rows_of(run("calm", law + TABLE))
    inputs = ",\n".join("%.17g" % (row[5] - 230.0) for row in table)
    forward = rows_of(run("psalm", law.replace("NDES=1, DELT=0.0", "NDES=3600, DELT=" + inputs)))
    wanted = [row[1] for row in table]
    worst = max(abs(row[2] - y) for row, y in zip(forward, wanted))
    return len(table), worst/(max(wanted) - min(wanted))


def cutting(name):
    lines = run("calm", data(name).replace("&CAM ", "&CAM TOLCUT=0.001, ").replace("&CAM2 ", "&CAM2 TOLCUT=0.001, "))
    extremes = dict(line.split()[:2] for line in lines[lines.index("# block extremes"):] if line.startswith("cutter_"))
    return [float(extremes[key]) for key in ("cutter_deviation", "cutter_arcs", "cutter_chords")]


def main():
    print("""# Cost and accuracy of cams

Measured by `bench/cams`, one thread, processor time.

## 3600 cam angles

Milliseconds for the motion (law, linkage solved backwards, follower with three derivatives) and then for the shape (pitch curve,
profile, cutter centre, curvature, pressure angle).

| cam | motion | shape |
| --- | --- | --- |""")
    for name, words in COSTS.items():
        motion, shape = (1e3*float(value) for value in read(os.path.join(OUT, name)).split("|"))
        print("| %s (`data/calm/%s.nml`) | %.2f | %.3f |" % (words, name, motion, shape))
    profile, bend = (float(value) for value in read(os.path.join(OUT, "disc")).split("|"))
    angles, error = needle_error()
    print("""
## Accuracy

| | |
| --- | --- |
| eccentric disc, the crank-rocker of `data/dyad1_crank_rocker.nml`, 3600 angles: profile against the circle, over its radius | %.1e |
| its curvature, relative | %.1e |
| needle linkage driven through the published needle motion, %d angles: output of psalm against the law, over its range | %.1e |

## Cutter path

TOLCUT = 0.001: largest measured deviation, arcs, and chords of a polyline with the same deviation.

| cam | deviation | arcs | chords | arcs a chord |
| --- | --- | --- | --- | --- |""" % (profile, bend, angles, error))
    for name in CUT:
        deviation, arcs, chords = cutting(name)
        print("| `%s` | %.6f | %d | %.1f | %.3f |" % (name, deviation, arcs, chords, arcs/chords))


if __name__ == "__main__":
    main()
