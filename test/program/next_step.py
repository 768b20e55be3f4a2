#!/usr/bin/env python3
"""The next step that psalm names at the end of a run: it is there when it should be, and it leads on.

usage: test/program/next_step.py PROGRAM_DIRECTORY. Last line: N passed, N failed.
"""
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

PATH = """FOUR-BAR FOR TEN POINTS
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-10.0,60.0,80.0,40.0, JY=0.0,25.0,70.0,0.0,110.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D',
  VARY='A B','B C','C D','B P','angle B C B P','place D','place A','input'BOUNDS &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=10, DELT=0,36,72,108,144,180,216,252,288,324, FREE
  DESX=20,35,50,60,62,55,42,28,18,15, DESY=100,98,99,104,112,120,124,122,116,108 &END
 &SEARCH SOLVER='LSQ', NSTART=10, NBEST=2, ORDER=2 &END
 &CONSTR IRANGE=2 &END
"""
LOW, HIGH = "5,5,5,5,-180,5,-180,5,-180,-180", "{},400,400,400,180,400,180,400,180,180"


def run(programs, text, *options):
    """Standard output, the next step and the objective."""
    with open("case.nml", "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([os.path.join(programs, "psalm"), *options, "case.nml"], capture_output=True, text=True)
    steps = re.findall(r"^Next: (.*)$", done.stderr, re.M)
    best = re.search(r"best objective ([-+.\dED]+)", done.stderr)
    check("no more than one step, and not in the listing", len(steps) <= 1 and "Next:" not in done.stdout, steps)
    check("it is the last line", not steps or done.stderr.splitlines()[-1] == "Next: " + steps[0])
    return steps[0] if steps else "", float(best.group(1).replace("D", "E")) if best else None


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        timed = PATH.replace("FREE", "").replace("BOUNDS", "")
        step, before = run(programs, timed)
        check("prescribed timing: IFREE=1", "IFREE=1" in step, step)
        free = PATH.replace("FREE", "IFREE=1,").replace("BOUNDS", "")
        step, after = run(programs, free)
        check("which comes nearer", after < before, (before, after))
        check("then the tolerances", "&TOLER" in step, step)
        step, _ = run(programs, free.replace("&CONSTR", "&TOLER TOLLEN=0.01 &END\n &CONSTR"))
        check("with tolerances there is no further step", step == "", step)
        function = PATH.replace("FREE", "").replace("BOUNDS", "").replace("point P", "angle rocker").replace("'C D',\n  VARY", "'C D',VARY")
        function = re.sub(r"DESX=.*", "DESANG=100,110,118,120,115,105,96,90,88,92 &END", re.sub(r",'B P','angle B C B P','place D','place A'", "", function))
        step, _ = run(programs, function)
        check("a function by a four-bar: exactly", "&EXACT KIND='FUNCTION'" in step and "MINIMAX=1" in step, step)
        nine = free.replace("NDES=10", "NDES=9").replace(",324", "").replace(",15,", ",").replace(",108 &END", " &END")
        step, _ = run(programs, nine)
        check("nine points: exactly", "&EXACT KIND='PATH'" in step, step)
        narrow = PATH.replace("FREE", "IFREE=1,").replace("BOUNDS", ", VLOW=%s, VHIGH=%s" % (LOW, HIGH.format(9.0)))
        step, held = run(programs, narrow)
        check("a bound is named", "is at a bound: length A B" in step and "VHIGH" in step, step)
        wide = PATH.replace("FREE", "IFREE=1,").replace("BOUNDS", ", VLOW=%s, VHIGH=%s" % (LOW, HIGH.format(40.0)))
        _, freed = run(programs, wide)
        check("and a wider one comes nearer", freed < held, (held, freed))
        step, _ = run(programs, free, "--quiet")
        check("--quiet says nothing", step == "", step)
        rest = re.sub(r",\n *VARY='.*'BOUNDS", "", re.sub(r" &SEARCH.*\n &CONSTR.*\n", "", PATH.replace("FREE", "")))
        step, _ = run(programs, rest)
        check("desired values without a search", "VARY and &SEARCH find dimensions that come nearer" in step, step)
        plain = re.sub(r"NDES=10.*\n.*&END", "IKIN=10 &END", rest)
        step, _ = run(programs, plain)
        check("a plain analysis: nothing", step == "", step)
        step, _ = run(programs, plain.rstrip("\n") + "\n &LIMITS TRMIN=80.0 &END\n")
        check("a limit that is not kept", "keep TRMIN" in step, step)
        os.chdir("/")
    return report()


if __name__ == "__main__":
    sys.exit(main())
