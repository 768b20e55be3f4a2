"""Tables of what bench/dynamics measured. usage: dynamics.py DIRECTORY"""
import os
import sys

with open(os.path.join(sys.argv[1], "chart"), encoding="utf-8") as file:
    seconds, points, error, integrated, beside, wrong = file.read().split("|")
print("""# Cost of the studies of dynamics

Measured by `bench/dynamics`, one thread; of charts the processor time.

## Chart of stability

The rig of Oldham's chapter 14 (`data/rig_coupler.nml`), e from 0.02 to 4, frequency/speed from 0.04 to 8: boundaries from eigenvalues, and every point classified by them. For comparison some of the points are integrated over a turn.

| | |
| --- | --- |
| points | %d |
| seconds of the chart | %.2f |
| largest error of a boundary, as told | %.1e |
| points integrated for comparison | %d |
| seconds of their integration | %.2f |
| points where both disagree | %d |""" % (int(points), float(seconds), float(error), int(integrated), float(beside), int(wrong)))
