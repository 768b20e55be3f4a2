#!/usr/bin/env python3
"""Do other compilers take the sources? Their front ends alone read them all: a minute or two, where a build takes many.

usage: front_ends.py COMPILER ... (gfortran-11, flang-19, flang-new-19 ...). A compiler that is not installed is skipped by name. What a
compiler refuses is printed, each source with the first lines of what it says; sources that use a refused one follow it.
Last line: N passed, N failed (sources)."""
import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import workshop

WORDS = 600     # characters of a refusal that are shown


def options(compiler, modules):
    """Read only, and write modules there."""
    common = ["-fsyntax-only", "-std=f2018", "-fopenmp", "-cpp", "-Iinclude", "-I" + modules]
    if "flang" in os.path.basename(compiler):
        return common + ["-module-dir", modules]
    return common + ["-ffree-form", "-J" + modules]


def main():
    passed = failed = 0
    for compiler in sys.argv[1:]:
        if not shutil.which(compiler):
            print("SKIPPED: %s is not installed here" % compiler)
            continue
        with tempfile.TemporaryDirectory() as place:
            build = workshop.Build(workshop.TOP, place, [])
            refused = 0
            for source in build.order:
                if source.endswith(".c"):
                    continue
                done = subprocess.run([compiler] + options(compiler, os.path.join(place, "mod")) + [source], cwd=workshop.TOP,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
                passed += done.returncode == 0
                if done.returncode:
                    refused += 1
                    print("FAILED: %s, %s\n%s" % (compiler, source, done.stdout.decode("utf-8", "replace")[:WORDS]), flush=True)
        print("%s refuses %d of %d sources" % (compiler, refused, len(build.order)), flush=True)
        failed += refused
    print("%d passed, %d failed" % (passed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
