#!/usr/bin/env python3
"""A run studies nothing twice: how often programs analyse a linkage, locate the joints of a sketch, set a mechanism up.

usage: test/program/studies.py PROGRAM_DIRECTORY. Where calls cannot be counted the runs are skipped. Last line: N passed,
N failed[, N skipped].
"""
import os
import shutil
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from calls import count_calls, symbols_of, why_not
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
COUNTED = {"analysed": "__psalm_error_MOD_analyse", "located": "__psalm_joint_location_MOD_locate_sketch",
           "set up": "__psalm_setup_MOD_set_up"}
# A run analyses its positions and, where it has one, the sweep between and beyond them. A sketch is set up once more where its
# loops are checked against the drawing, which is no position of the run
EXPECTED = {
    ("psalm", "jansen"): {"analysed": 2, "located": 1, "set up": 2},    # IPLOT asks for the sweep
    ("balm", "jansen"): {"analysed": 2, "located": 1, "set up": 2},
    ("kalm", "jansen"): {"analysed": 1, "located": 1, "set up": 2},
    ("psalm", "cheapest_tolerances"): {"analysed": 1, "located": 4, "set up": 2},   # with dimensions that deviate
    ("psalm", "engine"): {"analysed": 2, "located": 0, "set up": 1},
    ("balm", "engine"): {"analysed": 2, "located": 0, "set up": 1},
    ("kalm", "four_bar_haines"): {"analysed": 1, "located": 0, "set up": 1},    # forces
    ("psalm", "excavator"): {"analysed": 1, "located": 1, "set up": 2},
    ("balm", "excavator"): {"analysed": 2, "located": 1, "set up": 2},
    ("kalm", "excavator"): {"analysed": 1, "located": 1, "set up": 2},
}


def run(programs, program, case, expected):
    path = os.path.join(programs, program)
    symbols = symbols_of(path)
    addresses = {what: symbols[name] for what, name in COUNTED.items() if name in symbols}
    check("%s has the procedures that are counted" % program, len(addresses) == len(COUNTED), sorted(addresses))
    shutil.copy(os.path.join(TOP, "data", case + ".nml"), ".")
    calls, status = count_calls([path, case + ".nml"], addresses)
    check("%s %s ends well" % (program, case), status == 0, status)
    check("%s %s: each study once" % (program, case), calls == expected, calls)


def main():
    reason = why_not()
    if reason:
        print("SKIPPED: " + reason)
        return report(len(EXPECTED))
    with tempfile.TemporaryDirectory() as folder:
        programs = os.path.realpath(sys.argv[1])
        os.chdir(folder)
        for (program, case), expected in EXPECTED.items():
            run(programs, program, case, expected)
    return report()


if __name__ == "__main__":
    sys.exit(main())
