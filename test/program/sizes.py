#!/usr/bin/env python3
"""Time and memory against the size of the input.

usage: test/program/sizes.py PROGRAM_DIRECTORY          the test: no input makes time grow faster than its size
       test/program/sizes.py PROGRAM_DIRECTORY --table  median seconds and largest memory at the full sizes

The test doubles each input and compares processor time, the least of several runs: linear work doubles, quadratic work
takes four times as long. A ratio below 3 passes. Last line of the test: N passed, N failed.
"""
import os
import statistics
import subprocess
import sys
import tempfile

LINKS = (" &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=40.,120.,80.,130., GAMA=3*0.,180.,"
         " NOUTLK=3, NOUTLP=1 &END\n")
METHOD = " &METHOD MOTION=1, NDES=3, DELT=0.,30.,60. &END\n"
CASE = "SIZE\n" + LINKS + METHOD


def changed(text, old, new):
    """The text with every `old` made `new`; there must be one."""
    assert old in text, old
    return text.replace(old, new)


def delt(n):
    return ",".join(repr(i * 360 / n) for i in range(n))


def one_line(n):
    """n characters in one line: values and items of a group of the user's own."""
    part = "A=1.0,2.0 B(3)='c' "
    return CASE + " &USERDATA " + part * (n // len(part)) + " &END\n"


def quotes(n):
    return CASE + " &USERDATA A=" + "'" * n + " &END\n"


def unknown_items(n):
    return "SIZE\n" + LINKS + changed(METHOD, " &END", "".join(f" Q{i}=1" for i in range(n)) + " &END")


def repeated_items(n):
    return changed(CASE, "NDES=3", "NDES=3, " + "CRNKI=1. " * n)


def opened(n):
    return CASE + " &USERDATA " + "A( " * n + " &END\n"


def long_number(n):
    return changed(CASE, "NDES=3", "NDES=3, CRNKI=1." + "3" * n)


def lines(n):
    return changed(CASE, "SIZE\n", "SIZE\n" + "\n" * n)


def cases(n):
    return (CASE + " &LIMITS LAST=0 &END\n") * n + CASE


def many_loops(n):
    return changed(CASE, "NLOOP=1", f"NLOOP={n}")


def wrong_loops(n):
    """A file whose loops are all wrong: findings of SETUP."""
    rows = ["1,2,3,4"] + ["7,9,9,9"] * (n - 1)
    return (f"SIZE\n &LINKS NLOOP={n}, MAXARC=4,\n ILINK=" + ",\n".join(rows) + f",\n ILOOP=1,0,0,1,{4 * (n - 1)}*1, ARCL="
            + ",".join(["40.,120.,80.,130."] * n) + ", NOUTLK=3, NOUTLP=1 &END\n" + METHOD)


def values(n):
    """n values: increments and desired values of n/2 positions."""
    half = n // 2
    return (f"SIZE\n{LINKS} &METHOD MOTION=1, NDES={half}, DELT={delt(half)},\n DESANG="
            + ",".join("90." for _ in range(half)) + " &END\n &LIMITS TANGLE=90. &END\n")


def columns(n):
    """One loop in arrays of n columns."""
    return changed(CASE, "MAXARC=4", f"MAXARC={n}")


def positions(n):
    """n positions of an analysis, evenly spaced."""
    return f"SIZE\n{LINKS} &METHOD MOTION=1, NDES={n}, DELT={delt(n)} &END\n &LIMITS TANGLE=90. &END\n"


# name, program, text, size of the test, size of the table, exit statuses that are right
SIZES = [
    ("characters in one line", "psalm", one_line, 1_000_000, 4_000_000, (0,)),
    ("characters in one line", "balm", one_line, 1_000_000, 4_000_000, (0, 1)),
    ("quotes", "psalm", quotes, 500_000, 4_000_000, (0,)),
    ("unknown items", "psalm", unknown_items, 50_000, 400_000, (2,)),
    ("unknown items", "balm", unknown_items, 50_000, 400_000, (2,)),
    ("mentions of one item", "psalm", repeated_items, 50_000, 400_000, (0,)),
    ("open parentheses", "psalm", opened, 200_000, 1_000_000, (2, 0)),
    ("digits of a number", "balm", long_number, 200_000, 4_000_000, (2,)),
    ("empty lines", "psalm", lines, 500_000, 4_000_000, (0,)),
    ("cases", "psalm", cases, 400, 10_000, (0,)),
    ("loops announced", "psalm", many_loops, 50_000, 100_000, (2,)),
    ("wrong loops", "psalm", wrong_loops, 20_000, 100_000, (2,)),
    ("columns", "psalm", columns, 16_000, 32_000, (0,)),
    ("values", "psalm", values, 50_000, 1_000_000, (0,)),
    ("positions", "psalm", positions, 50_000, 1_000_000, (0,)),
    ("positions", "balm", positions, 50_000, 1_000_000, (0,)),
]
LARGEST_RATIO = 3.0
MOST_TOLD = 130        # lines on standard error: the summaries of ten cases and a few messages
TOO_SHORT = 0.05  # seconds; below this a run is start-up, not work


def run(program, text, directory, statuses):
    """Processor seconds, elapsed seconds and memory (MB) of one run."""
    name = os.path.join(directory, "size.nml")
    with open(name, "w", encoding="ascii") as file:
        file.write(text)
    command = "import os,resource,subprocess,sys,time\n" \
        "t=time.monotonic()\n" \
        "c=subprocess.run(sys.argv[1:],stdout=open('out','w'),stderr=open('err','w')).returncode\n" \
        "u=resource.getrusage(resource.RUSAGE_CHILDREN)\n" \
        "print(c,u.ru_utime+u.ru_stime,time.monotonic()-t,u.ru_maxrss/1024)"
    out = subprocess.run([sys.executable, "-c", command, program, name], cwd=directory, check=True, capture_output=True,
                         text=True).stdout.split()
    if int(out[0]) not in statuses:
        with open(os.path.join(directory, "err"), encoding="utf-8", errors="replace") as file:
            raise SystemExit(f"{program}: exit status {out[0]}: {file.read(400)}")
    return float(out[1]), float(out[2]), float(out[3])


def least(program, text, directory, statuses):
    return min(run(program, text, directory, statuses)[0] for _ in range(3))


def test(programs, directory):
    passed = failed = 0
    for name, program, make, size, _, statuses in SIZES:
        path = os.path.join(programs, program)
        ratio = 0.0
        for _ in range(3):  # a busy machine may need another try
            once = least(path, make(size), directory, statuses)
            twice = least(path, make(2 * size), directory, statuses)
            ratio = twice / max(once, TOO_SHORT)
            if ratio < LARGEST_RATIO:
                break
        if ratio < LARGEST_RATIO:
            passed += 1
        else:
            failed += 1
            print(f"FAILED: {program}, {name}: {once:.2f} s for {size}, {twice:.2f} s for {2 * size}")
        with open(os.path.join(directory, "err"), encoding="utf-8", errors="replace") as file:
            told = sum(1 for _ in file)
        if told > MOST_TOLD:
            failed += 1
            print(f"FAILED: {program}, {name}: {told} messages")
        else:
            passed += 1
    print(f"{passed} passed, {failed} failed")
    return failed


def table(programs, directory):
    for name, program, make, _, size, statuses in SIZES:
        text = make(size)
        runs = [run(os.path.join(programs, program), text, directory, statuses) for _ in range(3)]
        print(f"{program:6} {size:9} {name:24} {len(text) / 1e6:6.1f} MB  {statistics.median(r[1] for r in runs):6.2f} s"
              f"  {statistics.median(r[0] for r in runs):6.2f} s processor  {max(r[2] for r in runs):7.0f} MB memory", flush=True)
    return 0


def main():
    programs = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as directory:
        sys.exit(1 if (table if "--table" in sys.argv else test)(programs, directory) else 0)


main()
