#!/usr/bin/env python3
"""No listing, message, device, picture or page of a sketch speaks of loops and arcs by number: groups have their joints, lines their ends.
No number of a listing or message of a sketch is as Fortran writes it by itself.

usage: words.py DIRECTORY    of the programs
"""
import glob
import os
import re
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(TOP, "test", "tools"))
from tally import check, report  # noqa: E402
WORDS = re.compile(r"\b(loops?|arcs?)\s+\d+", re.I)
RAW = re.compile(r"(?<![\d.])0?\.\d+[ED][-+]?\d+")   # as Fortran writes a number, 0.1000000D-01: fixed or engineering notation instead
SLOW = {"door_five_poses", "dwell", "line6"}   # searches that take long
ALWAYS = ("psalm", "kalm", "balm")
WHERE = {"ssics": r"&(VIBR|ESTIM|FLEX|DRIVEL|HILL)\b", "bridge": r"&CLEAR\b", "muscle": r"&BALANC\b", "calm": r"&CAM\b"}


def without_program(page):
    """A page without its program and styles; its data stay."""
    return re.sub(r"<(script|style)>.*?</\1>", "", page, flags=re.S)


def look(program, case):
    """All that a program writes about a case."""
    for name in os.listdir("."):
        os.remove(name)
    done = subprocess.run([program, "--output-dir", ".", case], capture_output=True, text=True, check=False)
    texts = {"listing": done.stdout, "messages": done.stderr}
    for name in os.listdir("."):
        with open(name, encoding="utf-8", errors="replace") as file:
            texts[name] = file.read()
    found = []
    for name, text in texts.items():
        text = without_program(text) if name.endswith(".html") else text
        found += ["%s: ...%s..." % (name, text[max(0, m.start() - 40):m.end() + 20].replace("\n", " ")) for m in WORDS.finditer(text)]
        if name in ("listing", "messages") or name.endswith(".dev1"):
            found += ["%s: %s" % (name, m.group()) for m in RAW.finditer(text)]
    return found


def main(directory):
    directory = os.path.abspath(directory)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        sketches = 0
        for case in sorted(glob.glob(os.path.join(TOP, "data", "*.nml")) + glob.glob(os.path.join(TOP, "data", "time", "*.nml"))):
            with open(case, encoding="utf-8") as file:
                text = file.read()
            stem = os.path.basename(case)[:-4]
            if "&CHAIN" not in text or "&LINKS" in text or stem in SLOW:
                continue
            sketches += 1
            for program in ALWAYS + tuple(p for p, group in WHERE.items() if re.search(group, text)):
                found = look(os.path.join(directory, program), case)
                check("%s of %s: no loop and no arc by number, no raw number" % (program, stem), not found, "; ".join(found[:3]))
        # what is said where something is wrong: an open group, a dead point, a limit that is not kept, all lines, a search
        for name, (group, words) in WRONG.items():
            with open("wrong.nml", "w", encoding="ascii") as file:
                file.write("A SKETCH\n" + SKETCH + group)
            with open("wrong.nml", encoding="ascii") as file:
                kept = file.read()
            for program in ("psalm", "kalm", "balm"):
                case = os.path.join(work, "..", os.path.basename(work) + ".nml")
                with open(case, "w", encoding="ascii") as file:
                    file.write(kept)
                found = look(os.path.join(directory, program), case)
                if program == "psalm":
                    said = subprocess.run([os.path.join(directory, program), "--output-dir", ".", case], capture_output=True, text=True, check=False)
                    check("%s: %s" % (name, words), words in said.stdout + said.stderr, said.stdout + said.stderr)
                check("%s, %s: no loop and no arc by number" % (name, program), not found, "; ".join(found[:3]))
                os.remove(case)
        check("there are sketches", sketches > 15)
        os.chdir("/")
    return report()


SKETCH = """ &CHAIN JNT='A','B','C','D','P', JX=0.0,30.0,110.0,120.0,60.0, JY=0.0,0.0,80.0,0.0,60.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
"""
WRONG = {
    "a limit": (" &METHOD IKIN=15 &END\n &LIMITS TANGLE=1.0, KTHETA=1 &END\n", "JOINTS B, C, D, DYAD OF TYPE 1 (LINKS coupler AND rocker)"),
    "tolerances": (" &METHOD IKIN=30 &END\n &TOLER TOLLEN=30.0, NTRIAL=50 &END\n", "JOINTS B, C, D"),
    "regions": (" &METHOD IKIN=15 &END\n &CONSTR IRANGE=2, NREGN=1, RKIND=3, RJNT='C', RPLACE=1000.0,0.0,10.0,0.0 &END\n", "joints B, C, D"),
}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
