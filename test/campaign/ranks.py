"""Jobs of MPI ranks, one of which is killed (kill -9) at a random moment, and what goes on from their files.

usage: test/campaign/ranks.py PROGRAM_DIRECTORY [RUNS [MPI]]   (50 runs, openmpi; scripts/cluster --measure builds what it needs)

Every run is a search from many starts on 2 to 4 ranks, which write their files each second. What is left is resumed, in turn by ranks
of an MPI job, 1 to 4 of them, and by one process that records which items it makes. Counts files that are damaged, items of the files
that were made again, and files that are not, byte for byte, those of one run. Exit status 1 if there is one. No part of the tests.
"""
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PSALM = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
RUNS = int(sys.argv[2]) if len(sys.argv) > 2 else 50
MPI = sys.argv[3] if len(sys.argv) > 3 else "openmpi"
RANKS = os.path.join(TOP, "build", "cluster", MPI, "bin", "psalm-mpi")
TIMED = os.path.join(TOP, "build", "cluster", "timed", "bin", "psalm-timed")
SET = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "OMPI_MCA_mpi_yield_when_idle": "1"}
with open(os.path.join(TOP, "data", "slopes.nml"), encoding="utf-8") as source:
    CASE = source.read().replace("&SEARCH", "&TOLER TOLLEN=0.001, NTRIAL=20000 &END\n &SEARCH", 1).replace("NSTART=60", "NSTART=2500")


def place_of_case():
    place = tempfile.mkdtemp()
    with open(os.path.join(place, "c.nml"), "w", encoding="utf-8") as file:
        file.write(CASE)
    return place


def finish(place, *command):
    """Exit status, and the files of a run that ends, with its listing."""
    done = subprocess.run([*command, "--quiet", "c.nml"], cwd=place, env=SET, capture_output=True)
    found = {"listing": done.stdout}
    for name in os.listdir(place):
        if name != "work.times":
            with open(os.path.join(place, name), "rb") as file:
                found[name] = file.read()
    return done.returncode, found


def items_of_files(place):
    """The items of all files of parts, as (case, batch, item), and whether every file is whole."""
    items, whole, batch = set(), True, None
    for name in os.listdir(place):
        if re.fullmatch(r"c\.part\d+", name):
            with open(os.path.join(place, name), encoding="ascii") as file:
                lines = file.read().splitlines()
            whole = whole and lines[0] == "PSALM parts 1" and lines[-1] == "end"
            for line in lines[3:-1]:
                words = line.split()
                if words[0] == "batch":
                    batch = (int(words[1]), int(words[2]))
                else:
                    items.add((*batch, int(words[0])))
    return items, whole


def items_made(place):
    """How many items a resumed run has made."""
    with open(os.path.join(place, "work.times"), encoding="ascii") as file:
        return sum(line.startswith("item ") for line in file)


def ranks_in(place):
    found = []
    for name in os.listdir("/proc"):
        try:
            if name.isdigit() and os.readlink("/proc/%s/cwd" % name) == place and \
                    os.readlink("/proc/%s/exe" % name).endswith("/psalm-mpi"):
                found.append(int(name))
        except OSError:
            pass  # it has ended, or belongs to another user
    return found


def main():
    random.seed(1)
    tempfile.tempdir = os.path.realpath(tempfile.mkdtemp())
    expected = finish(place_of_case(), PSALM)
    place = place_of_case()
    finish(place, TIMED)
    items = items_made(place)
    begun = time.time()
    finish(place_of_case(), "mpiexec." + MPI, "-n", "3", RANKS)
    length = time.time() - begun
    count = dict.fromkeys(("killed on the way", "before the first file", "items in files", "damaged files", "items made again",
                           "resumed with other bytes"), 0)
    for k in range(RUNS):
        place = place_of_case()
        job = subprocess.Popen(["mpiexec." + MPI, "-n", str(2 + k % 3), RANKS, "--quiet", "--checkpoint", "1", "c.nml"], cwd=place,
                               env=SET, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0.0, 1.1*length))
        ranks = ranks_in(place)
        if ranks:
            try:
                os.kill(random.choice(ranks), 9)
            except ProcessLookupError:
                pass  # it has ended
        count["killed on the way"] += job.wait() not in (0, 1)
        while ranks_in(place):
            time.sleep(0.01)
        kept, whole = items_of_files(place)
        count["damaged files"] += not whole
        count["items in files"] += len(kept)
        count["before the first file"] += not any(name.startswith("c.part") for name in os.listdir(place))
        resume = ["--resume"] if any(name.startswith("c.part") for name in os.listdir(place)) else []
        if k % 2 == 0:
            found = finish(place, "mpiexec." + MPI, "-n", str(random.randint(1, 4)), RANKS, *resume)
        else:
            found = finish(place, TIMED, *resume)
            count["items made again"] += abs(items_made(place) + len(kept) - items)
        count["resumed with other bytes"] += found != expected
        shutil.rmtree(place)
    print("%s, %d runs of %d items, %.1f s each: " % (MPI, RUNS, items, length) + ", ".join("%d %s" % (v, k) for k, v in count.items()))
    shutil.rmtree(tempfile.tempdir)
    return int(any(count[k] for k in ("damaged files", "items made again", "resumed with other bytes")))


if __name__ == "__main__":
    sys.exit(main())
