#!/usr/bin/env python3
"""What scripts/install puts below a prefix, used from outside: programs, library by pkg-config and CMake, manual pages, completion,
data sets; and the checkout as a dependency of fpm.

usage: installation.py PREFIX, where it is installed first. Last line: N passed, N failed."""
import os
import shutil
import subprocess
import sys

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = ("psalm", "kalm", "balm", "muscle", "ssics", "calm", "bridge")
prefix = os.path.abspath(sys.argv[1])
passed = failed = skipped = 0


def check(law, right, words=""):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: installation: %s %s" % (law, words))


def run(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, cwd=prefix, **more)


def skip(law):
    global skipped
    skipped += 1
    print("SKIPPED: installation: " + law)


def there(command):
    return shutil.which(command) is not None


check("it installs", subprocess.run([os.path.join(TOP, "scripts", "install"), "--prefix", prefix]).returncode == 0)
for program in PROGRAMS:
    done = run("bin/" + program, "--version")
    check("%s runs" % program, done.returncode == 0 and done.stdout.startswith(program + " "), done.stderr)
    page = os.path.join("share/man/man1", program + ".1")
    if there("man"):
        shown = run("man", "--warnings", "-l", page, env=dict(os.environ, LC_ALL="C", MANROFFSEQ="", MANPAGER="cat"))
        check("the page of %s" % program, "EXIT STATUS" in shown.stdout and "&METHOD" in shown.stdout and not shown.stderr, shown.stderr[:200])
    elif program == "psalm":
        skip("manual pages, for there is no man")
check("a data set", run("bin/psalm", "--output-dir", ".", "share/psalm/data/textile.nml").returncode == 0)
if there("pkg-config"):
    flags = run("pkg-config", "--cflags", "--libs", "psalm", env=dict(os.environ, PKG_CONFIG_PATH=os.path.join(prefix, "lib/pkgconfig")))
    check("pkg-config finds it", flags.returncode == 0, flags.stderr)
    options = flags.stdout.split() + ["-Wl,-rpath," + os.path.join(prefix, "lib")]
    built = run("cc", os.path.join(TOP, "c/slider_crank.c"), "-o", "slider", *options)
    check("a program in C by pkg-config", built.returncode == 0 and "179.6424" in run("./slider").stdout, built.stderr)
    built = run("gfortran", os.path.join(TOP, "example/analyse.f90"), "-o", "analyse", *options)
    check("a program in Fortran by pkg-config", built.returncode == 0 and "179.6424" in run("./analyse").stdout, built.stderr)
else:
    skip("programs in C and Fortran by pkg-config")
commit = subprocess.run(["git", "-C", TOP, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True).stdout.strip()
told = run("bin/psalm", "--version").stdout
check("--version tells the commit", told.splitlines()[1].startswith("commit %s" % (commit or "not known")), told)
def by_cmake(language, source):
    """A program of one source that finds the library by find_package."""
    place = os.path.join(prefix, "consumer_" + language)
    os.makedirs(place, exist_ok=True)
    with open(os.path.join(place, "CMakeLists.txt"), "w", encoding="utf-8") as file:
        file.write("cmake_minimum_required(VERSION 3.13)\nproject(consumer %s)\nfind_package(psalm 1.0 REQUIRED)\n"
                   "add_executable(consumer %s)\ntarget_link_libraries(consumer psalm::psalm)\n" % (language, source))
    built = run("sh", "-c", "cd %s && cmake -S . -B build -DCMAKE_PREFIX_PATH=.. && cmake --build build" % place)
    check("a program in %s by CMake" % language, built.returncode == 0 and "179.6424" in run(place + "/build/consumer").stdout, built.stderr)


def by_fpm(name, source):
    """A package that depends on this checkout, with its program: the objects that scripts/setup has compiled are taken."""
    installed = os.path.join(TOP, "build", "local")
    place = os.path.join(prefix, "package_" + name)
    os.makedirs(os.path.join(place, "app"), exist_ok=True)
    shutil.copy(os.path.join(TOP, "example", "analyse.f90"), os.path.join(place, "app", "main.f90"))
    with open(os.path.join(place, "fpm.toml"), "w", encoding="utf-8") as file:
        file.write('name = "package_%s"\n[dependencies]\nopenmp = "*"\npsalm.%s\n' % (name, source))
    fpm = os.path.join(TOP, ".venv", "bin", "fpm")
    ran = run("sh", "-c", "cd %s && %s run --profile debug --flag '-std=f2018 -O0'" % (place, fpm),
              env=dict(os.environ, INSTALLED=installed, FPM_FC=os.path.join(TOP, "test", "tools", "installed", "gfortran")))
    check("a package by fpm, dependency by " + name, ran.returncode == 0 and "179.6424" in ran.stdout, ran.stderr[-2000:])


if there("cmake"):
    by_cmake("C", os.path.join(TOP, "c", "slider_crank.c"))
    if there("c++"):
        with open(os.path.join(prefix, "consumer.cpp"), "w", encoding="utf-8") as file:
            file.write("""#include <iostream>
#include <psalm.h>
int main() {
  psalm_case *linkage = nullptr;
  psalm_result *motion = nullptr;
  double slide[24];
  if (psalm_read_file("share/psalm/data/dyad4_slider_crank.nml", 1, &linkage) != PSALM_DONE) return 1;
  if (psalm_study(linkage, "analysis", PSALM_BRIEF, 0, &motion) != PSALM_DONE) return 1;
  if (psalm_column(motion, 1, psalm_find_column(motion, 1, "output"), 24, slide) != PSALM_DONE) return 1;
  std::cout << std::fixed;
  std::cout.precision(4);
  std::cout << slide[0] << std::endl;
  psalm_result_free(motion);
  psalm_free(linkage);
}
""")
        by_cmake("CXX", os.path.join(prefix, "consumer.cpp"))
    else:
        skip("a program in C++ by CMake")
else:
    skip("programs in C and C++ by CMake")
if os.path.exists(os.path.join(TOP, "build", "local", "lib", "libpsalm.a")):
    by_fpm("path", 'path = "%s"' % os.path.relpath(TOP, os.path.join(prefix, "package_path")))
    if os.path.exists(os.path.join(TOP, ".git")):
        by_fpm("git", 'git = "file://%s"' % TOP)
    else:
        skip("a package by fpm, dependency by git")
else:
    skip("packages by fpm (scripts/setup builds what they take)")
done = run("bash", "-c", ". share/bash-completion/completions/psalm; COMP_WORDS=(psalm --items SEA); COMP_CWORD=2; _psalm; echo ${COMPREPLY[*]}")
check("completion", done.stdout.strip() == "SEARCH", done.stdout + done.stderr)
print("%d passed, %d failed" % (passed, failed) + (", %d skipped" % skipped if skipped else ""))
sys.exit(failed > 0)
