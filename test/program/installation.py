#!/usr/bin/env python3
"""What scripts/install puts below a prefix, used from outside: programs, library by pkg-config, manual pages, completion, data sets.

usage: installation.py PREFIX, where it is installed first. Last line: N passed, N failed."""
import os
import subprocess
import sys

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = ("psalm", "kalm", "balm", "muscle", "ssics", "calm", "bridge")
prefix = os.path.abspath(sys.argv[1])
passed = failed = 0


def check(law, right, words=""):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: installation: %s %s" % (law, words))


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, cwd=prefix, **more)


check("it installs", subprocess.run([os.path.join(TOP, "scripts", "install"), "--prefix", prefix]).returncode == 0)
for program in PROGRAMS:
    done = run("bin/" + program, "--version")
    check("%s runs" % program, done.returncode == 0 and done.stdout.startswith(program + " "), done.stderr)
    page = os.path.join("share/man/man1", program + ".1")
    if run("sh", "-c", "command -v man").returncode == 0:
        shown = run("man", "--warnings", "-l", page, env=dict(os.environ, LC_ALL="C", MANROFFSEQ="", MANPAGER="cat"))
        check("the page of %s" % program, "EXIT STATUS" in shown.stdout and "&METHOD" in shown.stdout and not shown.stderr, shown.stderr[:200])
check("a data set", run("bin/psalm", "--output-dir", ".", "share/psalm/data/textile.nml").returncode == 0)
flags = run("pkg-config", "--cflags", "--libs", "psalm", env=dict(os.environ, PKG_CONFIG_PATH=os.path.join(prefix, "lib/pkgconfig")))
if flags.returncode == 0:
    options = flags.stdout.split() + ["-Wl,-rpath," + os.path.join(prefix, "lib")]
    built = run("cc", os.path.join(TOP, "c/slider_crank.c"), "-o", "slider", *options)
    check("a program in C by pkg-config", built.returncode == 0 and "179.6424" in run("./slider").stdout, built.stderr)
    built = run("gfortran", os.path.join(TOP, "example/analyse.f90"), "-o", "analyse", *options)
    check("a program in Fortran by pkg-config", built.returncode == 0 and "179.6424" in run("./analyse").stdout, built.stderr)
commit = subprocess.run(["git", "-C", TOP, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True).stdout.strip()
told = run("bin/psalm", "--version").stdout
check("--version tells the commit", told.splitlines()[1].startswith("commit %s" % (commit or "not known")), told)
if run("sh", "-c", "command -v cmake").returncode == 0:
    with open(os.path.join(prefix, "CMakeLists.txt"), "w", encoding="utf-8") as file:
        file.write("cmake_minimum_required(VERSION 3.13)\nproject(consumer C)\nfind_package(psalm 0.1 REQUIRED)\n"
                   "add_executable(consumer %s/c/slider_crank.c)\ntarget_link_libraries(consumer psalm::psalm)\n" % TOP)
    built = run("sh", "-c", "cmake -S . -B consumer -DCMAKE_PREFIX_PATH=. && cmake --build consumer")
    check("a program in C by CMake", built.returncode == 0 and "179.6424" in run("consumer/consumer").stdout, built.stderr)
done = run("bash", "-c", ". share/bash-completion/completions/psalm; COMP_WORDS=(psalm --items SEA); COMP_CWORD=2; _psalm; echo ${COMPREPLY[*]}")
check("completion", done.stdout.strip() == "SEARCH", done.stdout + done.stderr)
print("%d passed, %d failed" % (passed, failed))
sys.exit(failed > 0)
