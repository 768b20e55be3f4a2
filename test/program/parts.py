#!/usr/bin/env python3
"""Work in parts, checkpoints and ranks: every file is, byte for byte, that of one run on one machine.

usage: test/program/parts.py PROGRAM_DIRECTORY. The programs over MPI ranks are built and tested where an MPI is installed
(scripts/cluster), else counted as skipped. Last line: N passed, N failed[, N skipped].
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
DATA = os.path.join(TOP, "data")


def read(*path):
    with open(os.path.join(DATA, *path), encoding="utf-8") as file:
        return file.read()


# two searches from many starts, the first with a sample
SEARCH = read("slopes.nml").replace("&SEARCH", "&TOLER TOLLEN=0.001, NTRIAL=3500 &END\n &SEARCH", 1)
CHART = read("bridge", "four_bar_haines.nml").replace("&CLEAR ", "&CLEAR NCRAD=5, NCANG=8, CEPS=0.5, ")
PATHS = read("exact", "five_points_pivots.nml")
ANALYSIS = read("sketch_four_bar.nml")
SIX_BARS = read("exact", "stephenson_seven.nml")
KINDS = read("types", "kinds_for_corner.nml")
KINDS_IN_STAGES = KINDS.replace("&SEARCH ", "&SEARCH NFEW=5, ")


class Case:
    """A case in a directory of its own."""

    def __init__(self, programs, program, text):
        self.programs, self.program, self.place = programs, program, tempfile.mkdtemp()
        with open(os.path.join(self.place, "c.nml"), "w", encoding="utf-8") as file:
            file.write(text)
        if "corner.txt" in text:
            shutil.copy(os.path.join(DATA, "types", "corner.txt"), self.place)

    def run(self, *options, before=()):
        done = subprocess.run([*before, os.path.join(self.programs, self.program), *options, "c.nml"], cwd=self.place,
                              capture_output=True)
        self.listing, self.said, self.code = done.stdout, done.stderr.decode(), done.returncode
        return done.returncode

    def files(self):
        found = {"listing": self.listing}
        for name in os.listdir(self.place):
            with open(os.path.join(self.place, name), "rb") as file:
                found[name] = file.read()
        return found


def whole(programs, program, text):
    """The files of one run on one machine, and its exit status."""
    case = Case(programs, program, text)
    code = case.run("--threads", "2") if program == "psalm" else case.run()
    return case.files(), code


def parts_of(programs, program, text, name, parts, passes):
    expected, code = whole(programs, program, text)
    case = Case(programs, program, text)
    names = [("c.part%d" if program == "psalm" else "c.bridge.part%d") % k for k in range(1, parts + 1)]
    for _ in range(passes):
        for k in range(1, parts + 1):
            check(name + ": a part", case.run("--part", "%d/%d" % (k, parts)) == 0, case.said)
            check(name + ": a part has no listing and writes its file alone", case.listing == b"" and
                  set(case.files()) <= {"listing", "c.nml", *names})
    made = sum(1 for name_of in names if os.path.getsize(os.path.join(case.place, name_of)) > 80)
    check(name + ": every part has made something", made == parts, made)
    check(name + ": the exit status of one run", case.run("--merge") == code, case.said)
    check(name + ": the bytes of one run", case.files() == expected,
          [f for f in {**expected, **case.files()} if expected.get(f) != case.files().get(f)])


def refusals(programs):
    for text, words in ((ANALYSIS, "no numbered work"), (KINDS, "search over kinds"), (SIX_BARS, "not by parts")):
        case = Case(programs, "psalm", text)
        check("what cannot be divided is refused", case.run("--part", "1/2") == 2 and words in case.said, case.said)
    case = Case(programs, "psalm", SEARCH)
    for options, words in ((("--merge",), "nothing to go on from"), (("--part", "3/2"), "expects K/N"),
                           (("--checkpoint", "0"), "whole number of seconds"),
                           (("--part", "1/2", "--merge"), "one of them at a time")):
        check("refused: " + " ".join(options), case.run(*options) == 2 and words in case.said, case.said)
    case.run("--part", "1/2")
    check("a file of a part is not overlooked", case.run("--checkpoint", "9") == 2 and "--resume" in case.said, case.said)
    check("what there is so far", case.run("--so-far") == 1 and os.path.exists(os.path.join(case.place, "c.dev7")), case.said)
    with open(os.path.join(case.place, "c.part1"), "rb") as file:
        sound = file.read()
    for damage, words in ((sound[:-4], "ends early"), (sound.replace(b"run ", b"run F", 1), "another run"),
                          (sound.replace(b"PSALM", b"PSLAM"), "no file of a part"),
                          (sound.replace(b"\n1 ", b"\n1 x", 1), "damaged")):
        with open(os.path.join(case.place, "c.part1"), "wb") as file:
            file.write(damage)
        check("refused: a file that " + words, case.run("--merge") == 2 and words in case.said, case.said)


def killed(programs):
    """A run that is killed goes on from what it has written."""
    for text in (SEARCH.replace("NSTART=60", "NSTART=600"), KINDS):
        killed_once(programs, text)


def killed_once(programs, text):
    expected, code = whole(programs, "psalm", text)
    case = Case(programs, "psalm", text)
    run = subprocess.Popen([os.path.join(programs, "psalm"), "--threads", "2", "--checkpoint", "1", "c.nml"], cwd=case.place,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    file = os.path.join(case.place, "c.part1")
    while run.poll() is None and not os.path.exists(file):
        time.sleep(0.02)
    run.send_signal(signal.SIGKILL)
    if run.wait() == -signal.SIGKILL:   # else it was done before
        check("a killed run leaves a file", os.path.exists(file))
        check("resumed, it has the exit status of one run", case.run("--resume") == code, case.said)
        check("and its bytes", case.files() == expected)


def from_python(programs):
    """The examples in Python, by processes of this machine: the parts of a case, and many cases."""
    found = {**os.environ, "PATH": programs + os.pathsep + os.environ["PATH"]}
    expected, code = whole(programs, "psalm", SEARCH)
    case = Case(programs, "psalm", SEARCH)
    done = subprocess.run([os.path.join(TOP, "cluster", "parts.py"), "c.nml", "2", "2", "processes"], cwd=case.place, env=found,
                          capture_output=True)
    case.listing = done.stdout
    check("cluster/parts.py: the bytes of one run", done.returncode == code and case.files() == expected, done.stderr.decode())
    names = ["hill", "link_loads"]
    place = tempfile.mkdtemp()
    done = subprocess.run([os.path.join(TOP, "cluster", "cases.py"), "processes", "ssics", "--output-dir", place,
                           *(os.path.join(DATA, "ssics", name + ".nml") for name in names)], env=found, capture_output=True)
    codes = []
    for name in names:
        alone = Case(programs, "ssics", read("ssics", name + ".nml"))
        codes.append(alone.run())
        with open(os.path.join(place, name + ".listing"), "rb") as file:
            check("cluster/cases.py: the listing of " + name, file.read() == alone.listing)
    check("cluster/cases.py: the highest exit status", done.returncode == max(codes), done.stderr.decode())
    done = subprocess.run([os.path.join(TOP, "cluster", "cases.py"), "processes", "nosuch", "a.nml"], env=found, capture_output=True)
    check("cluster/cases.py: no program", done.returncode == 2 and b"no program" in done.stderr, done.stderr)


def over_ranks(programs, mpi):
    """The programs over ranks; how many checks cannot be made."""
    if not all(shutil.which(tool + "." + mpi) for tool in ("mpifort", "mpiexec")):
        return 1
    # other packages bring the programs of an MPI without what is needed to build with it
    with tempfile.TemporaryDirectory() as place:
        with open(os.path.join(place, "a.f90"), "w", encoding="ascii") as file:
            file.write("use mpi_f08\nend\n")
        if subprocess.run(["mpifort." + mpi, "-c", "a.f90"], cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode:
            return 1
    built = subprocess.run([os.path.join(TOP, "scripts", "cluster"), "--no-demo", mpi], capture_output=True, text=True,
                           env={**os.environ, "LIBRARY": os.path.dirname(programs)})
    check(mpi + ": it builds", built.returncode == 0, built.stderr)
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
                      OMPI_MCA_mpi_yield_when_idle="1")
    over = os.path.join(TOP, "build", "cluster", mpi, "bin")
    for program, text, counts in (("psalm", SEARCH, (1, 2, 4, 7)), ("psalm", PATHS, (2,)), ("bridge", CHART, (2,)),
                                  ("psalm", KINDS, (3,)), ("psalm", KINDS_IN_STAGES, (2,))):
        expected, code = whole(programs, program, text)
        for ranks in counts:
            case = Case(over, program + "-mpi", text)
            case.run(before=("mpiexec." + mpi, "-n", str(ranks)))
            check("%s, %d ranks: the exit status of one process" % (mpi, ranks), case.code == code, case.said)
            check("%s, %d ranks: its bytes" % (mpi, ranks), case.files() == expected,
                  [f for f in {**expected, **case.files()} if expected.get(f) != case.files().get(f)])
    six_bars(programs, over, mpi)
    case = Case(over, "psalm-mpi", SEARCH)
    case.run("--part", "1/2", before=("mpiexec." + mpi, "-n", "2"))
    check(mpi + ": a part of a job is refused", case.code == 2 and "share all parts" in case.said, case.said)
    ended(programs, over, mpi)
    return 0


def six_bars(programs, over, mpi):
    """The start set of six-bars, made and read by ranks: the bytes of one process, the set too; a job that is asked to end."""
    kept = os.environ.get("XDG_CACHE_HOME")
    found, starts = {}, {}
    for ranks, folder in ((0, programs), (2, over), (3, over)):
        case = Case(folder, "psalm-mpi" if ranks else "psalm", SIX_BARS)
        cache = tempfile.mkdtemp()
        os.environ["XDG_CACHE_HOME"] = cache
        for _ in range(2):
            case.run("--threads", "2", before=("mpiexec." + mpi, "-n", str(ranks)) if ranks else ())
            found[len(found)] = case.code, case.files()
            with open(os.path.join(cache, "psalm", *os.listdir(os.path.join(cache, "psalm"))), "rb") as file:
                starts[len(starts)] = file.read()
    check(mpi + ", six-bars: the bytes of one process, whether ranks make the start set or read it",
          all(found[k] == found[0] for k in found), [sorted(f) for _, f in found.values()])
    check(mpi + ", six-bars: and their start set", all(starts[k] == starts[0] for k in starts))
    os.environ["XDG_CACHE_HOME"] = tempfile.mkdtemp()
    case = Case(over, "psalm-mpi", SIX_BARS.replace("NPOINT=7", "NPOINT=11, START=1").replace("PIVOTS=-1.4,-0.5, CRANK=0.4,0.1, ", ""))
    job = subprocess.Popen(["mpiexec." + mpi, "-n", "2", os.path.join(over, "psalm-mpi"), "c.nml"], cwd=case.place,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    begun = time.time()
    while job.poll() is None and time.time() - begun < 20 and not os.path.isdir(os.path.join(os.environ["XDG_CACHE_HOME"], "psalm")):
        time.sleep(0.02)
    for rank in ranks_of(case.place)[-1:]:
        os.kill(rank, signal.SIGTERM)
    listing, said = job.communicate()
    check(mpi + ", six-bars, TERM to one rank: the job ends and says so", job.returncode == 1 and b"stopped" in listing + said,
          (job.returncode, said))
    if kept is None:
        del os.environ["XDG_CACHE_HOME"]
    else:
        os.environ["XDG_CACHE_HOME"] = kept


def ended(programs, over, mpi):
    """Jobs that end early: by MAXTIME, by TERM to one rank, by a rank that is killed; each goes on from its files."""
    text = SEARCH.replace("NSTART=60", "NSTART=600")
    expected, code = whole(programs, "psalm", text)
    start = ["mpiexec." + mpi, "-n", "2"]
    in_time = Case(over, "psalm-mpi", SEARCH.replace("NSTART=60", "NSTART=1000000, MAXTIME=1"))
    begun = time.time()
    in_time.run(before=start)
    check(mpi + ": MAXTIME ends all ranks", in_time.code == 1 and time.time() - begun < 20 and "MAXTIME" in in_time.said,
          in_time.said)
    check(mpi + ": what was made in time is kept", os.path.exists(os.path.join(in_time.place, "c.part2")), sorted(in_time.files()))
    for number in (signal.SIGTERM, signal.SIGKILL):
        case = Case(over, "psalm-mpi", text)
        job = subprocess.Popen([*start, os.path.join(over, "psalm-mpi"), "--checkpoint", "1", "c.nml"], cwd=case.place,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        file = os.path.join(case.place, "c.part2")
        while job.poll() is None and not os.path.exists(file):
            time.sleep(0.02)
        ranks = ranks_of(case.place)
        if ranks:
            os.kill(ranks[-1], number)
        case.listing, _ = job.communicate()
        if job.returncode == code:
            continue  # it was done before
        check("%s, signal %d to one rank: the job ends" % (mpi, number), job.returncode != 0)
        if number == signal.SIGTERM:
            check(mpi + ": and reports the best so far", os.path.exists(os.path.join(case.place, "c.dev7")), sorted(case.files()))
        so_far = case.run("--so-far", before=start)
        check("%s, signal %d: what there is so far" % (mpi, number), so_far == 1, case.said)
        case.run("--resume", before=("mpiexec." + mpi, "-n", "3"))
        check("%s, signal %d: resumed, the exit status of one run" % (mpi, number), case.code == code, case.said)
        check("%s, signal %d: and its bytes" % (mpi, number), case.files() == expected,
              [f for f in {**expected, **case.files()} if expected.get(f) != case.files().get(f)])


def ranks_of(place):
    """The processes of psalm-mpi that work in a directory."""
    found = []
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                if os.readlink("/proc/%s/cwd" % name) == place and os.readlink("/proc/%s/exe" % name).endswith("/psalm-mpi"):
                    found.append(int(name))
            except OSError:
                pass  # it has ended, or belongs to another user
    return sorted(found)


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as work:
        tempfile.tempdir = work
        parts_of(programs, "psalm", SEARCH, "starts and samples", 3, 2)
        parts_of(programs, "psalm", PATHS, "paths", 2, 1)
        parts_of(programs, "bridge", CHART, "charts", 2, 1)
        refusals(programs)
        killed(programs)
        from_python(programs)
        skipped = over_ranks(programs, "openmpi") + over_ranks(programs, "mpich")
        os.chdir("/")
    if skipped:
        print("SKIPPED: ranks of %d of two MPIs, which are not installed (scripts/setup cluster mpich)" % skipped)
    return report(skipped)


if __name__ == "__main__":
    sys.exit(main())
