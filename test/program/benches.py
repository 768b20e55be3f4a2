"""Everything under bench/ compiles, in all kinds of reals, and every benchmark runs; what makes start values compiles, too.

The Fortran programs are built with the release library, warnings are errors; in real32 the syntax is checked, of them and of the
modules that they use. Each benchmark runs on its smallest task, once: that it runs is tested, not what it measures.
With --real128 their syntax is checked in real128, and nothing else; MODULES are those of a library in real128 (`build_kind` of
scripts/setup). Modules that it has not are checked, too.

usage: benches.py PROGRAM_DIRECTORY | benches.py --real128 MODULES. Last line: N passed, N failed, N skipped.
"""
import concurrent.futures
import glob
import os
import py_compile
import re
import subprocess
import sys
import tempfile
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import tally

top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
bench = os.path.join(top, "bench")
in_real128 = sys.argv[1] == "--real128"
prefix = os.path.dirname(os.path.abspath(sys.argv[1]))
library = os.path.join(prefix, "lib", "libpsalm.a")
warnings = ["-std=f2018", "-Wall", "-Wextra", "-Wimplicit-interface", "-Wconversion", "-Werror", "-Wno-compare-reals",
            "-Wno-maybe-uninitialized", "-Wno-uninitialized"]
skipped = 0


def run(command, **options):
    return subprocess.run(command, capture_output=True, text=True, **options)


def skip(what):
    global skipped
    skipped += 1
    print("SKIPPED: %s" % what, flush=True)


def modules_of(paths):
    """By module: its file and the modules that it uses."""
    found = {}
    for path in paths:
        with open(path, encoding="utf-8") as f:
            text = f.read()
        name = re.search(r"^module (\w+)", text, re.M)
        found[name[1] if name else os.path.basename(path)] = (path, set(re.findall(r"^ *use (\w+)", text, re.M)))
    return found


def in_order(modules, wanted):
    """The modules that the wanted ones use, and these, each after those that it uses."""
    order, met = [], set()

    def visit(name):
        if name in met or name not in modules:
            return
        met.add(name)
        for other in sorted(modules[name][1]):
            visit(other)
        order.append(name)

    for name in sorted(wanted):
        visit(name)
    return order


def check_in_kind(kind, work, there=()):
    """Syntax and kinds of the benchmark in a kind of reals; the modules of src/ and generated/ that it uses come before it.

    `there`: directories in which modules are that need not be checked.
    """
    sources = [p for folder in ("src", "generated") for p in glob.glob(os.path.join(top, folder, "**", "*.[fF]90"), recursive=True)]
    own = modules_of(glob.glob(os.path.join(bench, "src", "*.f90")) + glob.glob(os.path.join(bench, "app", "*.f90")))
    modules = modules_of(sources)
    modules.update(own)
    made = {n for n in modules if any(os.path.exists(os.path.join(d, n + ".mod")) for d in there)}
    waiting = [n for n in in_order(modules, own) if n not in made]
    bad = set()

    def check(name):
        path = modules[name][0]
        return name, run(["gfortran", "-cpp", "-D" + kind.upper(), "-fsyntax-only", "-fopenmp", *(warnings if name in own else ["-w"]),
                          "-J", work, "-I", os.path.dirname(path), *("-I" + d for d in there), path])

    # every module as soon as those that it uses are there
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        running = set()
        while waiting or running:
            ready = [n for n in waiting if not (modules[n][1] & set(modules)) - made]
            waiting = [n for n in waiting if n not in ready]
            running |= {pool.submit(check, n) for n in ready}
            done, running = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
            for name, result in (d.result() for d in done):
                made.add(name)
                if result.returncode != 0:
                    bad.add(name)
                if name in own:
                    tally.check("%s: %s" % (kind, name), result.returncode == 0, result.stderr[:600])
    tally.check("%s: every module that the benchmarks use" % kind, not bad - set(own), sorted(bad))


def build(work):
    """The programs of bench/app by name; None for one that cannot be built."""
    own = modules_of(glob.glob(os.path.join(bench, "src", "*.f90")))
    objects = []
    for name in in_order(own, own):
        target = os.path.join(work, name + ".o")
        done = run(["gfortran", "-O0", "-fopenmp", *warnings, "-J", work, "-I", os.path.join(prefix, "include"), "-c", own[name][0],
                    "-o", target])
        tally.check("compiles: %s" % name, done.returncode == 0, done.stderr[:600])
        objects.append(target)
    with_gsl = bool(glob.glob("/usr/lib/*/libgsl.so") + glob.glob("/usr/lib/libgsl.so"))
    if not with_gsl:
        skip("bench run: its rival of the GNU Scientific Library is not installed (scripts/setup bench)")
    gsl = ["-lgsl", "-lgslcblas"]
    if not with_gsl:
        source, stub = os.path.join(work, "no_gsl.c"), os.path.join(work, "no_gsl.o")
        with open(source, "w", encoding="utf-8") as f:
            f.write("#include <stdlib.h>\n" + "".join("void gsl_odeiv2_driver_%s(void) { abort(); }\n" % n
                                                      for n in ("alloc_y_new", "apply", "free")))
        run(["gcc", "-c", source, "-o", stub])
        gsl = [stub]
    programs = {}
    for path in sorted(glob.glob(os.path.join(bench, "app", "*.f90"))):
        name = os.path.basename(path)[:-4]
        programs[name] = os.path.join(work, name)
        done = run(["gfortran", "-O0", "-fopenmp", *warnings, "-J", work, "-I", work, "-I", os.path.join(prefix, "include"), path, *objects,
                    library, "-lnlopt", "-llapack", "-lblas", *gsl, "-lm", "-o", programs[name]])
        tally.check("builds: bench/app/%s.f90" % name, done.returncode == 0, done.stderr[:600])
    done = run(["gfortran", "-O0", "-fopenmp", *warnings, "-J", work, "-I", os.path.join(prefix, "include"),
                os.path.join(bench, "exact.f90"), library, "-lnlopt", "-llapack", "-lblas", "-o", os.path.join(work, "exact")])
    tally.check("builds: bench/exact.f90", done.returncode == 0, done.stderr[:600])
    programs["exact"] = os.path.join(work, "exact")
    for name in ("generic_start", "nine_points_start"):
        done = run(["gfortran", "-O0", "-fopenmp", *warnings, "-J", work, "-I", os.path.join(prefix, "include"),
                    os.path.join(top, "tools", name + ".f90"), library, "-lnlopt", "-llapack", "-lblas", "-o", os.path.join(work, name)])
        tally.check("builds: tools/%s.f90" % name, done.returncode == 0, done.stderr[:600])
    with open("/proc/cpuinfo", encoding="utf-8") as f:
        wide = "avx512f" in f.read()
    if wide:
        done = run(["gcc", "-O3", "-march=native", "-ffast-math", os.path.join(bench, "yardstick", "limit.c"), "-lm", "-o",
                    os.path.join(work, "limit")])
        tally.check("builds: bench/yardstick/limit.c", done.returncode == 0, done.stderr[:600])
    else:
        skip("bench/yardstick/limit.c: this processor has no AVX-512")
    done = run(["gfortran", "-O3", "-march=native", "-J", work, os.path.join(bench, "yardstick", "naive.f90"), "-o",
                os.path.join(work, "naive")])
    tally.check("builds: bench/yardstick/naive.f90", done.returncode == 0, done.stderr[:600])
    done = run(["gfortran", "-O3", "-march=native", "-ffp-contract=off", "-J", work,
                os.path.join(bench, "yardstick", "without_division.f90"), "-o", os.path.join(work, "without_division")])
    tally.check("builds: bench/yardstick/without_division.f90", done.returncode == 0, done.stderr[:600])
    return programs


def runs(work, programs):
    """Each benchmark on its smallest task: it ends well and says something with a number in it."""
    data = os.path.join(top, "data")
    dump = os.path.join(work, "dump")
    tasks = [[programs["bench"], "objective"], [programs["bench"], "lanes"], [programs["bench"], "pruning"], [programs["bench"], "forces", "short"],
             [programs["bench"], "groups", data, "short"],
             [programs["bench"], "evaluate20"], [programs["account"], "scaling", data, "short"], [programs["account"], "first", data],
             [programs["cams"], "cost", os.path.join(data, "calm", "translating_roller.nml")],
             [programs["cams"], "disc", os.path.join(data, "dyad1_crank_rocker.nml")],
             [programs["dynamics"], "chart", os.path.join(data, "rig_coupler.nml")],
             [programs["paths"], os.path.join(data, "paths", "ten10.nml")],
             [programs["rivals"], "0.1", os.path.join(data, "paths", "ten10.nml"), "1.0"],
             [os.path.join(bench, "speed.py"), os.path.abspath(sys.argv[1]), programs["bench"], "--short"],
             [os.path.join(bench, "start.py"), os.path.abspath(sys.argv[1]), "--short"],
             [programs["positions"], os.path.join(data, "sketch_four_bar.nml"), "180", dump],
             [programs["exact"], "short"], [os.path.join(work, "limit"), "dump", "auto", "180", dump],
             [os.path.join(work, "naive"), "dump", "one_loop", "180", dump], [os.path.join(work, "without_division"), "short"]]
    for task in tasks:
        words = " ".join([os.path.basename(task[0]), *(w for w in task[1:] if not w.startswith("/"))])
        if not os.path.exists(task[0]):
            continue
        try:
            done = run(task, cwd=bench, timeout=60, env=dict(os.environ, OMP_NUM_THREADS="1"))
        except subprocess.TimeoutExpired:
            tally.check("runs: %s" % words, False, "still running after a minute")
            continue
        silent = "evaluate20" in task or "dump" in task     # instructions are counted; numbers go into a file
        tally.check("runs: %s" % words, done.returncode == 0 and (silent or re.search(r"\d", done.stdout)), done.stderr[:300])


def main():
    with tempfile.TemporaryDirectory() as work:
        if in_real128:
            check_in_kind("real128", work, [os.path.abspath(sys.argv[2])])
            return tally.report(skipped)
        for path in glob.glob(os.path.join(bench, "*.py")):
            try:
                py_compile.compile(path, cfile=os.path.join(work, "compiled"), doraise=True)
                good, detail = True, ""
            except py_compile.PyCompileError as e:
                good, detail = False, str(e)
            tally.check("compiles: bench/%s" % os.path.basename(path), good, detail)
        for path in glob.glob(os.path.join(bench, "*")):
            if os.path.isfile(path) and os.access(path, os.X_OK) and not path.endswith(".py"):
                done = run(["bash", "-n", path])
                tally.check("is a script: bench/%s" % os.path.basename(path), done.returncode == 0, done.stderr)
        single, normal = os.path.join(work, "real32"), os.path.join(work, "default")
        os.mkdir(single)
        os.mkdir(normal)
        check_in_kind("real32", single)
        runs(normal, build(normal))
    return tally.report(skipped)


sys.exit(main())
