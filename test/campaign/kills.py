"""What is left when runs are killed (kill -9) or write the same files at the same time.

usage: test/campaign/kills.py PROGRAM_DIRECTORY [ROUNDS] [PAIRS]. Counts torn files (neither the old nor the new one), mixed sets (by the marks
of the runs) and temporaries left. No part of the tests: a kill between two of the five renames leaves a mixed set, which the marks tell.
"""
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

PSALM = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
ROUNDS, PAIRS = (int(sys.argv[k]) if len(sys.argv) > k else n for k, n in ((2, 150), (3, 75)))
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEVICES = [f"x.dev{n}" for n in (1, 2, 7, 8, 9)]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def start(which):
    return subprocess.Popen([PSALM, "--quiet", "--output-dir", "out", f"{which}/x.nml"], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def look(known, count):
    """Take stock of the directory of the outputs."""
    present = [n for n in DEVICES if os.path.exists("out/" + n)]
    texts = {n: read("out/" + n) for n in present}
    count["torn files"] += sum(text not in known[n] for n, text in texts.items())
    count["mixed sets"] += len({re.search(rb"(?i)run ([0-9A-F]{16})", text)[1] for text in texts.values()}) > 1
    count["temporaries left"] += sum(name.endswith(".part") for name in os.listdir("out"))


work = tempfile.mkdtemp()
os.chdir(work)
case = open(os.path.join(TOP, "data", "needle_search.nml")).read()
known = {n: [] for n in DEVICES}
for which, iterations in (("a", 40), ("b", 41)):
    text = case.replace("NITER=2000", f"NITER={iterations}")
    assert text != case
    os.mkdir(which)
    with open(which + "/x.nml", "w") as file:
        file.write(text)
    begun = time.time()
    start(which).wait()
    length = time.time() - begun
    for n in DEVICES:
        known[n].append(read("out/" + n))
assert all(one != other for one, other in known.values())

random.seed(1)
count = dict.fromkeys(("killed on the way", "torn files", "mixed sets", "temporaries left",
                       "of these after the next run"), 0)
for k in range(ROUNDS):
    start("ab"[k % 2]).wait()
    count["of these after the next run"] += any(name.endswith(".part") for name in os.listdir("out"))
    process = start("ab"[(k + 1) % 2])
    time.sleep(random.uniform(0.0, 1.3*length))
    process.kill()
    count["killed on the way"] += process.wait() < 0
    look(known, count)
print(f"kill -9, {ROUNDS} rounds of {1e3*length:.0f} ms: " + ", ".join(f"{v} {k}" for k, v in count.items()))
count = dict.fromkeys(("runs failed", "torn files", "mixed sets", "temporaries left"), 0)
for k in range(PAIRS):
    count["runs failed"] += sum(process.wait() not in (0, 1) for process in [start("a"), start("b")])
    look(known, count)
print(f"two runs at once, {PAIRS} pairs: " + ", ".join(f"{v} {k}" for k, v in count.items()))
shutil.rmtree(work)
