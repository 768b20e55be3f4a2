#!/usr/bin/env python3
"""A run studies nothing twice: how often programs analyse a linkage, locate the joints of a sketch, set a mechanism up.

usage: test/program/studies.py PROGRAM_DIRECTORY. Where calls cannot be counted the runs are skipped. Last line: N passed,
N failed[, N skipped].
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from calls import count_calls, symbols_of, why_not
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
COUNTED = {"analysed": "__psalm_error_MOD_analyse", "located": "__psalm_joint_location_MOD_locate_sketch",
           "set up": "__psalm_setup_MOD_set_up", "posed": "__psalm_chain_study_MOD_study_chain",
           "clearance": "__psalm_clearance_study_MOD_find_clearance", "cam": "__psalm_cam_study_MOD_find_cam"}
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
    # pictures in poses of the links: positions and sweep; a turn that cannot be one is not tried
    ("balm", "excavator_envelope"): {"posed": 2, "analysed": 2},
    ("balm", "geared_five_bar"): {"posed": 2, "analysed": 2, "located": 1},      # the second crank is elsewhere after a turn
    ("balm", "geared_apart"): {"posed": 2, "analysed": 2},                       # it does not go all round
    ("balm", "geared_round"): {"posed": 2, "analysed": 2},                       # it does
    # a wheel that rolls on a fixed one while its arm goes round: one position tells whether it is back after a turn
    ("balm", "planet_apart"): {"posed": 3, "analysed": 3},
    ("balm", "planet_back"): {"posed": 3, "analysed": 3},
    # the links laid flat, of a sketch that is drawn from its loops: positions, sweep, the position chosen
    ("balm", "laser_cut_lift"): {"analysed": 3, "set up": 2},
    # pictures that a program writes beside its listing
    ("bridge", "bridge/four_bar_haines"): {"clearance": 1},
    ("calm", "calm/translating_roller"): {"cam": 1},
    ("calm", "calm/knuckle_press"): {"cam": 1},
}
# Data sets that are others with a change
CHANGED = {"geared_apart": ("geared_five_bar", "RATIO=0.0,0.5", "RATIO=0.0,-1.0"),
           "geared_round": ("geared_five_bar", "RATIO=0.0,0.5", "RATIO=0.0,1.0")}
PLANET = """A WHEEL ON THE FOLLOWER OF A DRAG LINK
 &CHAIN JNT='A','B','C','D','V', JX=0.0,0.0,28.0,10.0,38.0, JY=0.0,30.0,30.0,0.0,30.0,
  LNAME='frame','crank','coupler','follower','planet', LNK='A D','A B','B C','C D','C V',
  GEARA='frame', GEARB='planet', GCARR='follower', GTA=%s, GTB=%s &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point V' &END
 &METHOD NDES=3, DELT=0.0,100.0,200.0 &END
"""
# Sketches of their own
MADE = {"planet_apart": PLANET % ("30.0", "40.0"), "planet_back": PLANET % ("40.0", "20.0")}


def run(programs, program, case, expected):
    path = os.path.join(programs, program)
    symbols = symbols_of(path)
    addresses = {what: symbols[COUNTED[what]] for what in expected if COUNTED[what] in symbols}
    check("%s has the procedures that are counted" % program, len(addresses) == len(expected), sorted(addresses))
    source, before, after = CHANGED.get(case, (case, "", ""))
    if case in MADE:
        text = MADE[case]
    else:
        with open(os.path.join(TOP, "data", source + ".nml"), encoding="utf-8") as file:
            text = file.read()
    check("%s is changed as it says" % case, text.count(before) == 1 or not before)
    case = os.path.basename(case)
    with open(case + ".nml", "w", encoding="utf-8") as file:
        file.write(text.replace(before, after) if before else text)
    calls, status = count_calls([path, case + ".nml"], addresses)
    check("%s %s ends well" % (program, case), status in (0, 1), status)
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
