"""The programs' listings against the references of data/reference, and the script that compares them.

usage: references.py PROGRAM_DIRECTORY. Last line: N passed, N failed.
"""
import os
import shutil
import subprocess
import sys
import tempfile
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import tally

top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
bin_directory = os.path.abspath(sys.argv[1])
references = os.path.join(top, "data", "reference")
beyond = " *** BEYOND THE PUBLISHED LISTING ***"


def compare(*arguments):
    return subprocess.run([os.path.join(top, "scripts", "compare"), "--bin", bin_directory, *arguments], capture_output=True, text=True)


def lines_of(*path):
    with open(os.path.join(*path), encoding="utf-8") as f:
        return f.read().splitlines()


def words_of(lines):
    return [line.split() for line in lines if line.strip()]


def write(path, lines):
    with open(path, "w", encoding="utf-8") as f:
        f.write("".join(line + "\n" for line in lines))


def published_listing(work):
    """The needle linkage: character by character, up to the line that says what is new."""
    needle = os.path.join(top, "data", "needle.nml")
    done = subprocess.run([os.path.join(bin_directory, "psalm"), "--quiet", "--output-dir", work, needle], capture_output=True, text=True)
    listing = done.stdout.splitlines()
    tally.check("the line of what is new is there once", listing.count(beyond) == 1)
    published = listing[:listing.index(beyond)] if beyond in listing else []
    tally.check("the published listing, character by character", published == lines_of(references, "needle.lst"))
    tally.check("it ends with the total error", published[-2:] == [" TOTAL ERROR", "       5.698467"], published[-2:])
    scanned = words_of(lines_of(references, "needle-results.lst"))
    tally.check("the reference has the words and numbers of the scan", words_of(lines_of(references, "needle.lst")) == scanned)
    dev8 = words_of(lines_of(references, "needle.dev8"))[1:]
    scanned = words_of(lines_of(references, "needle-input.lst") + lines_of(references, "needle-setup.lst"))[1:]
    tally.check("device 8 begins with those of the scan", dev8[:len(scanned)] == scanned)
    for case, item in (("needle", "IPROOF=0"), ("textile", "KTHETA=0")):
        with open(os.path.join(top, "data", case + ".nml"), encoding="utf-8") as f:
            text = f.read()
        changed = os.path.join(work, "plain.nml")
        with open(changed, "w", encoding="utf-8") as f:
            f.write(text.replace("&LIMITS", "&LIMITS " + item + ","))
        done = subprocess.run([os.path.join(bin_directory, "psalm"), "--quiet", changed], capture_output=True, text=True)
        tally.check("%s: nothing is new, and there is no line of it" % case, done.returncode < 2 and beyond not in done.stdout)
    with open(needle, encoding="utf-8") as f:
        write(os.path.join(work, "open.nml"), f.read().replace("95.,104.5", "15.,104.5").splitlines())
    done = subprocess.run([os.path.join(bin_directory, "psalm"), "--quiet", os.path.join(work, "open.nml")], capture_output=True, text=True)
    listing = done.stdout.splitlines()
    tally.check("violations are new", beyond in listing and " CONSTRAINTS VIOLATED" in listing
                and listing.index(beyond) < listing.index(" CONSTRAINTS VIOLATED"))


def the_demo(work):
    """scripts/demo without its build: it ends well and shows each of its steps."""
    with open(os.path.join(top, "scripts", "demo"), encoding="utf-8") as f:
        text = f.read()
    build, here = '"$here/setup"\n', 'here=$(dirname "${BASH_SOURCE[0]}")'
    tally.check("the demo builds first", text.count(build) == 2 and text.count(here) == 1)
    path = os.path.join(work, "demo")
    with open(path, "w", encoding="utf-8") as f:
        f.write(text.replace(build, "", 1).replace(here, "here='%s'" % os.path.join(top, "scripts")))
    done = subprocess.run(["bash", path], capture_output=True, text=True)
    said = done.stdout + done.stderr
    tally.check("the demo ends well", done.returncode == 0, said[-600:])
    for words in ("       5.698467", "needle: equal to its reference", "CLOSES FOR EVERY INPUT OF THE RANGE", "STEADY CYCLE", "needle_lsq.html",
                  "doc/index.md"):
        tally.check("the demo shows " + words.strip(), words in said)
    tally.check("nothing in it is cut short", "NITER" not in said and "interrupted" not in said)


def the_script(work):
    """What it notices."""
    listing = lines_of(references, "needle.lst")
    row = next(i for i, line in enumerate(listing) if "150.0895" in line)
    changed, same = os.path.join(work, "changed.lst"), os.path.join(work, "same.lst")
    write(same, listing)
    tally.check("two equal files", compare("--files", same, same).returncode == 0)
    write(changed, [line.replace("150.0895", "150.0898") for line in listing])
    done = compare("--files", same, changed)
    tally.check("a changed digit is noticed", done.returncode == 1 and "line %d," % (row + 1) in done.stdout, done.stdout)
    tally.check("in units of the last digit", "150.0895 -> 150.0898: 3 units of the last digit" in done.stdout, done.stdout)
    write(changed, listing[:row] + listing[row + 1:])
    done = compare("--files", same, changed)
    tally.check("a missing line is noticed", done.returncode == 1 and "line %d of the reference is missing" % (row + 1) in done.stdout,
                done.stdout)
    write(changed, [line.replace("TOTAL ERROR", "TOTAL  ERROR") for line in listing])
    done = compare("--files", same, changed)
    tally.check("a blank is noticed", done.returncode == 1 and "blanks differ" in done.stdout, done.stdout)
    write(changed, listing + [beyond, "", " ANYTHING"])
    tally.check("what follows the published listing is not compared with it", compare("--files", same, changed).returncode == 0)
    tally.check("but with a reference that has it", compare("--files", changed, same).returncode == 1)

    own = os.path.join(work, "references")
    os.makedirs(os.path.join(own, "calm"))
    for name in ("needle.lst", "slopes.lst", "calm/yoke.lst"):
        shutil.copy(os.path.join(references, name), os.path.join(own, name))
    write(os.path.join(own, "slopes.lst"), [line.replace("POSITION", "PLACE") for line in lines_of(own, "slopes.lst")][:-1])
    done = compare("--references", own, "needle", "data/slopes.nml", "yoke")
    tally.check("of three data sets one differs", done.returncode == 1 and "slopes.lst: " in done.stdout
                and "1 of 3 data sets differ" in done.stdout, done.stdout)
    done = compare("--references", own, "--update", "slopes")
    tally.check("no reference is changed without a reason", done.returncode == 2 and "--reason" in done.stderr, done.stderr)
    done = compare("--references", own, "--update", "slopes", "needle", "--reason", "a test")
    log = lines_of(own, "CHANGES.md")[-1]
    tally.check("the log has the reason and what changed", done.returncode == 0 and "a test" in log and "of slopes.lst" in log
                and "needle" not in log, log)
    tally.check("then it is equal", compare("--references", own, "slopes").returncode == 0)
    tally.check("the published listing stays what it was", lines_of(own, "needle.lst") == lines_of(references, "needle.lst"))
    for arguments, words in ((["nedle"], "did you mean needle?"), (["--references", own, "textile"], "no reference for textile"),
                             (["four_bar_heines"], "did you mean"), (["--files", same, os.path.join(work, "none")], "cannot be read"),
                             (["--bin", work, "needle"], "scripts/setup builds it"), ([changed], "lies outside data/")):
        done = compare(*arguments)
        tally.check("in words: " + words, done.returncode == 2 and words in done.stderr, done.stderr)


def main():
    done = compare()
    count = [line for line in done.stdout.splitlines() if line.startswith("all ")]
    tally.check("every data set lists what its reference has", done.returncode == 0 and count, done.stdout + done.stderr)
    stray = [os.path.join(folder, name) for folder, _, files in os.walk(references) for name in files
             if name.endswith(".lst") and name not in ("needle-results.lst", "needle-input.lst", "needle-setup.lst")
             and not os.path.isfile(os.path.join(top, "data", os.path.relpath(folder, references), name[:-4] + ".nml"))]
    tally.check("every reference has its data set", not stray, stray)
    with tempfile.TemporaryDirectory() as work:
        published_listing(work)
        the_demo(work)
        the_script(work)
    return tally.report()


sys.exit(main())
