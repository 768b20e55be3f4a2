"""Output files, signals, memory and threads of the programs, from outside.

usage: test/program/files.py PROGRAM_DIRECTORY [PART]. Last line: N passed, N failed. With STOP_AT_FIRST=1 the first failure ends it.
"""
import os
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time

BIN = os.path.abspath(sys.argv[1])
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DATA = os.path.join(TOP, "data")
NOBODY = 65534
passed = failed = 0


def check(law, good, detail=""):
    global passed, failed
    if good:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {law} {str(detail)[:600]}")
        if os.environ.get("STOP_AT_FIRST"):
            sys.exit(1)


def run(program, *arguments, limits=(), env=None, user=None, **options):
    """Run a program; `limits` are pairs of a resource and its limit."""
    def prepare():
        for which, most in limits:
            resource.setrlimit(which, (most, most))
        if user is not None:
            os.setgroups([])
            os.setgid(user)
            os.setuid(user)
    options.setdefault("stdout", subprocess.PIPE)
    options.setdefault("stderr", subprocess.PIPE)
    # what is in the environment is on the stack, too: it is not the programs' part of a small one
    small = any(which == resource.RLIMIT_STACK for which, _ in limits)
    inherited = {n: v for n, v in os.environ.items() if not small or n in ("HOME", "PATH", "LANG", "XDG_CACHE_HOME")}
    return subprocess.run([os.path.join(BIN, program), *arguments], text=True, preexec_fn=prepare, timeout=120,
                          env={**inherited, **(env or {})}, **options)


def read(name):
    with open(name, newline="") as file:
        return file.read()


def write(name, text):
    with open(name, "w") as file:
        file.write(text)


def edited(name, *changes):
    """Text of a data set with changes, each of which must change something."""
    text = read(os.path.join(DATA, name))
    for old, new in changes:
        assert old in text, (name, old)
        text = text.replace(old, new)
    return text


def files():
    """Everything below the working directory: content, or what else it is."""
    found = {}
    for directory, _, names in os.walk("."):
        for name in names:
            path = os.path.join(directory, name)
            kind = os.lstat(path).st_mode
            found[path] = stat.S_IFMT(kind)
            if stat.S_ISREG(kind):
                with open(path, "rb") as file:
                    found[path] = file.read()
    return found


def left_beside():
    return [os.path.join(d, n) for d, ds, ns in os.walk(".") for n in ns + ds if n.endswith(".part")]


def fresh():
    """An empty directory to work in."""
    os.chdir(tempfile.mkdtemp(dir=ROOT))
    shutil.copy(os.path.join(DATA, "textile.nml"), "textile.nml")
    shutil.copy(os.path.join(DATA, "needle.nml"), "needle.nml")


def refused(law, want, words, program, *arguments, **options):
    """The run ends with a status and words, and no file is changed."""
    before = files()
    result = run(program, *arguments, **options)
    check(f"{law}: exit status", result.returncode == want, (result.returncode, result.stderr))
    check(f"{law}: message", words in result.stderr, result.stderr)
    check(f"{law}: files untouched", files() == before, set(files()) ^ set(before))


def inputs_are_safe():
    fresh()
    run("psalm", "-q", "needle.nml")
    refused("device 7 is the input", 2, "would be overwritten: choose another place with --output-dir DIR, or copy", "psalm",
            "needle.dev7")
    refused("device 7 is the input, from its directory named anew", 2, "would be overwritten", "psalm", "--output-dir", ".",
            "./needle.dev7")
    shutil.copy("needle.dev7", "again.nml")
    check("a copy is read", run("psalm", "-q", "again.nml").returncode == 0)
    check("another directory is written", run("psalm", "-q", "--output-dir", "out", "needle.dev7").returncode == 0
          and os.path.exists("out/needle.dev7"))
    os.link("again.nml", "hard.dev9")
    os.rename("again.nml", "hard.nml")
    refused("a device is a hard link of the input", 2, "'hard.dev9' is in use", "psalm", "hard.nml")
    os.mkdir("deep")
    os.symlink("../needle.nml", "deep/name.nml")
    os.link("needle.nml", "deep/name.dev8")
    refused("a device is the input behind a symbolic link", 2, "'deep/name.dev8' is in use", "psalm", "deep/name.nml")
    for ending in ("svg", "html", "dxf", "curves.svg"):
        shutil.copy("textile.nml", f"p.{ending}")
        refused(f"a picture is the input, {ending}", 2, "would be overwritten", "balm", "--curves", f"p.{ending}")
    os.link("textile.nml", "textile.kalm.dev9")
    refused("kalm", 2, "would be overwritten", "kalm", "textile.nml")
    os.unlink("textile.kalm.dev9")
    two = edited("needle_search.nml", ("NITER=2000", "NITER=5, NGUESS=17"))
    write("s.nml", two)
    shutil.copy("needle.dev7", "s.dev4")
    os.link("s.dev4", "s.dev9")
    refused("a device is device 4", 2, "'s.dev9' is in use", "psalm", "s.nml")
    os.unlink("s.dev9")
    os.link("needle.dev7", "s.dev7")
    refused("a device is the file of --device4", 2, "'s.dev7' is in use", "psalm", "--device4", "needle.dev7", "s.nml")
    refused("another case on the line is an output", 2, "needle.dev7' is in use", "psalm", "--output-dir", ".", "needle.nml",
            "s.dev7")
    with open("psalm.dev7", "w") as file:
        file.write(read("textile.nml"))
    with open("psalm.dev7") as file:
        refused("standard input is an output", 2, "'psalm.dev7' is in use", "psalm", stdin=file)
    with open("textile.dev9", "w") as file:
        refused("standard output goes to a device", 2, "'textile.dev9' is in use", "psalm", "textile.nml", stdout=file)
    os.mkdir("other")
    refused("one case by two names", 2, "would write the same files", "psalm", "textile.nml", "other/../textile.nml")
    case = edited("textile.nml")
    write("many.nml", re.sub(r"&LIMITS", "&LIMITS LAST=0,", case, count=1) + case)
    assert read("many.nml").count("LAST=0") == 1
    os.link("many.nml", "many.2.svg")
    refused("a picture of a further case is the input", 2, "'many.2.svg' is in use", "balm", "many.nml")


def targets():
    fresh()
    run("psalm", "-q", "textile.nml")
    os.chmod("textile.dev9", 0o444)
    refused("a read-only device", 3, "'textile.dev9': it is read-only or belongs to another user; make it writable", "psalm", "textile.nml")
    os.chmod("textile.dev9", 0o640)
    os.utime("textile.dev9", (1, 1))
    check("the mode of a file is kept", run("psalm", "-q", "textile.nml").returncode == 0
          and stat.S_IMODE(os.stat("textile.dev9").st_mode) == 0o640 and os.stat("textile.dev9").st_mtime > 1)
    os.umask(0o027)
    run("psalm", "-q", "--output-dir", "masked", "textile.nml")
    os.umask(0o022)
    check("a new file has the mode that the mask leaves", stat.S_IMODE(os.stat("masked/textile.dev9").st_mode) == 0o640)
    os.unlink("textile.dev9")
    write("victim", "keep\n")
    os.symlink("victim", "textile.dev9")
    refused("a symbolic link", 3, "'textile.dev9': it is a symbolic link", "psalm", "textile.nml")
    os.unlink("textile.dev9")
    os.symlink("nowhere", "textile.dev9")
    refused("a symbolic link to nothing", 3, "it is a symbolic link", "psalm", "textile.nml")
    os.unlink("textile.dev9")
    os.mkfifo("textile.dev9")
    refused("a pipe", 3, "'textile.dev9': it is not a regular file", "psalm", "textile.nml")
    os.unlink("textile.dev9")
    os.mkdir("textile.dev9")
    refused("a directory", 3, "'textile.dev9': it is a directory", "psalm", "textile.nml")
    os.rmdir("textile.dev9")
    for name in ("textile.dev9.part", "textile.svg.part"):
        os.symlink("victim", name)
    check("no link is written through", run("psalm", "-q", "textile.nml").returncode == 0
          and run("balm", "-q", "textile.nml").returncode == 0 and read("victim") == "keep\n")
    os.unlink("textile.dev9.part")
    os.unlink("textile.svg.part")
    check("directories are made", run("psalm", "-q", "--output-dir", "a/b//c/", "textile.nml").returncode == 0
          and os.path.exists("a/b/c/textile.dev7"))
    write("file", "")
    result = run("psalm", "--quiet", "--output-dir", "file/deep", "textile.nml", "needle.nml")
    check("a directory that cannot be made is told once", result.returncode == 3 and result.stderr ==
          "psalm: cannot make the directory 'file/deep': Not a directory\n", result.stderr)
    check("input that is wrong makes no directory", run("psalm", "--output-dir", "none", "file").returncode == 2
          and not os.path.exists("none"))
    if os.geteuid() == 0:
        os.chmod(".", 0o755)
        os.chmod(ROOT, 0o755)
        os.mkdir("closed", 0o755)
        result = run("psalm", "--quiet", "--output-dir", "closed", "textile.nml", user=NOBODY)
        check("a directory of others", result.returncode == 3 and "closed/textile.dev7': Permission denied" in result.stderr,
              result.stderr)
    check("nothing is left beside", not left_beside(), left_beside())


def marks_of(case):
    """The marks in all files of a case."""
    found = {}
    for name in os.listdir("."):
        if name.startswith(case + ".") and not name.endswith((".nml", ".png", ".pdf")):
            found[name] = re.findall(r"(?i)(?<!\w)run ([0-9A-F]{16})(?!\w)", read(name))
    return found


def marks():
    fresh()
    write("s.nml", edited("needle_search.nml", ("NITER=2000", "NITER=5")))
    run("psalm", "-q", "s.nml")
    first = marks_of("s")
    check("five devices have one mark each", len(first) == 5 and all(len(m) == 1 for m in first.values()), first)
    check("they agree", len({m[0] for m in first.values()}) == 1, first)
    once = {name: read(name) for name in first}
    run("psalm", "-q", "--threads", "2", "s.nml")
    check("the same input gives the same bytes", once == {name: read(name) for name in first})
    check("device 9 still begins with its columns", read("s.dev9").startswith("# input closed actual desired\n"))
    write("s.nml", edited("needle_search.nml", ("NITER=2000", "NITER=6")))
    run("psalm", "-q", "s.nml")
    second = marks_of("s")
    check("another input, another mark", len({m[0] for m in second.values()}) == 1 and second["s.dev7"] != first["s.dev7"])
    write("s.nml", edited("needle_search.nml", ("NITER=2000", "IKIN=15")))
    run("psalm", "-q", "s.nml")
    third = marks_of("s")
    check("old devices of a search can be told from an analysis", third["s.dev1"] == third["s.dev2"] == second["s.dev1"]
          and third["s.dev7"] == third["s.dev8"] == third["s.dev9"] != second["s.dev7"], third)
    run("kalm", "-q", "textile.nml")
    run("psalm", "-q", "textile.nml")
    found = marks_of("textile")
    check("kalm has a mark of its own", found["textile.kalm.dev8"] == found["textile.kalm.dev9"] != found["textile.dev9"], found)
    fresh()
    run("balm", "-q", "--curves", "textile.nml")
    pictures = marks_of("textile")
    check("pictures have a mark", set(pictures) == {"textile." + e for e in ("svg", "html", "dxf", "curves.svg")}
          and all(len(m) == 1 for m in pictures.values()) and len({m[0] for m in pictures.values()}) == 1, pictures)
    run("balm", "-q", "--assemblies", "textile.nml")
    check("options that change the result change the mark", marks_of("textile")["textile.svg"] != pictures["textile.svg"])
    # vertices on device 4
    write("a.nml", edited("needle_search.nml", ("NITER=2000", "NITER=5")))
    run("psalm", "-q", "a.nml")
    write("g.nml", edited("needle_search.nml", ("NITER=2000", "NITER=5, NGUESS=17")))
    run("psalm", "-q", "--device4", "a.dev7", "g.nml")
    one = marks_of("g")["g.dev7"]
    write("b.dev4", read("a.dev7") + "! another text\n")
    result = run("psalm", "-q", "--device4", "b.dev4", "g.nml")
    check("device 4 is a part of the input", len(one) == 1 and marks_of("g")["g.dev7"] != one, result.stderr)


def whole_sets():
    """If one file cannot be written none is exchanged."""
    fresh()
    run("psalm", "-q", "textile.nml")
    run("balm", "-q", "--curves", "textile.nml")
    write("textile.nml", edited("textile.nml", ("IKIN=30", "IKIN=10")))
    # larger than the smaller devices, smaller than the largest file
    for program in ("psalm", "balm"):
        sizes = sorted(os.path.getsize(n) for n in os.listdir(".") if n.startswith("textile.") and
                       (".dev" in n) == (program == "psalm") and not n.endswith(".nml"))
        limit = (sizes[0] + sizes[-1])//2
        before = files()
        result = run(program, "--quiet", "textile.nml", limits=[(resource.RLIMIT_FSIZE, limit)])
        check(f"{program}: a file that is too large: status", result.returncode == 3, (result.returncode, result.stderr))
        check(f"{program}: a file that is too large: message", "': File too large; no file of this run was written" in result.stderr,
              result.stderr)
        check(f"{program}: a file that is too large: the old set stays", files() == before)
        check(f"{program}: the listing is written all the same", program == "balm" or "TEXTILE" in result.stdout)
    check("nothing is left beside", not left_beside(), left_beside())


def pipes():
    fresh()
    # a reader that is gone before the listing comes
    reading, writing = os.pipe()
    os.close(reading)
    result = run("psalm", "--quiet", "textile.nml", stdout=writing)
    os.close(writing)
    check("a closed pipe: status", result.returncode == 3, result.returncode)
    check("a closed pipe: message", "cannot write the listing to standard output" in result.stderr, result.stderr)
    check("a closed pipe: the devices are written", os.path.exists("textile.dev7") and not left_beside())


def started(program, *arguments, wait):
    process = subprocess.Popen([os.path.join(BIN, program), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(wait)
    return process


def interruption():
    fresh()
    sample = edited("needle.nml") + " &TOLER TOLLEN=0.05, TOLANG=0.02, NTRIAL=1000000000 &END\n"
    write("sample.nml", sample)
    for which in (signal.SIGTERM, signal.SIGINT):
        for threads in ("1", "3"):
            process = started("psalm", "--threads", threads, "sample.nml", wait=1.0)
            process.send_signal(which)
            begun = time.time()
            out, err = process.communicate(timeout=60)
            law = f"{which.name} ends a sample, {threads} threads"
            check(f"{law}: status", process.returncode == 1, (process.returncode, err))
            check(f"{law}: soon", time.time() - begun < 10.0)
            made = re.search(r"interrupted: the sample has (\d+) of 1000000000 linkages", err)
            listed = re.search(r"LINKAGES OF THE SAMPLE (\d+), OF WHICH DO NOT CLOSE", out)
            check(f"{law}: trials are told", made and listed and made[1] == listed[1] and int(made[1]) > 0, err)
            check(f"{law}: devices", os.path.exists("sample.dev9") and "LOWEST" in out)
            os.unlink("sample.dev9")
    write("late.nml", sample + " &SEARCH MAXTIME=0.3 &END\n")
    result = run("psalm", "late.nml")
    check("MAXTIME ends a sample", result.returncode == 1 and re.search(r"MAXTIME passed: the sample has [1-9]\d* of", result.stderr),
          result.stderr)
    # a signal during a search skips the sample but keeps what the search found
    text = edited("path18.nml", ("NSTART=200", "NSTART=400000"))
    write("both.nml", text + " &TOLER TOLLEN=0.0001, NTRIAL=1000000000 &END\n")
    process = started("psalm", "both.nml", wait=1.0)
    process.terminate()
    out, err = process.communicate(timeout=60)
    check("a signal during the search ends the sample too", process.returncode == 1 and "TOTAL ERROR" in out
          and "to go on, give this device 7" in err, err)
    # before there is anything to lose the signal kills, and nothing is left
    # so many that a fast machine is far from writing when the signal comes
    write("long.nml", edited("dyad1_crank_rocker.nml", ("IKIN=15", "NDES=3000000, DELT=3000000*1.5")))
    for program in ("psalm", "kalm", "balm"):
        before = files()
        process = started(program, "-q", "long.nml", wait=0.1)
        process.terminate()
        process.communicate(timeout=60)
        check(f"{program}: TERM during an analysis kills", process.returncode == -signal.SIGTERM, process.returncode)
        check(f"{program}: TERM during an analysis leaves nothing", files() == before and not left_beside())


def memory_and_threads():
    fresh()
    megabyte = 1000*1024
    write("huge.nml", edited("dyad1_crank_rocker.nml", ("IKIN=15", "NDES=10000000")))
    write("large.nml", edited("dyad1_crank_rocker.nml", ("IKIN=15", "NDES=300000, DELT=300000*1.5")))
    for case, least in (("huge.nml", 300), ("large.nml", 60)):
        for program in ("psalm", "kalm", "balm"):
            refused(f"{program}: memory for {case}", 3, "not enough memory", program, case,
                    limits=[(resource.RLIMIT_AS, least*megabyte)])
            result = run(program, case, limits=[(resource.RLIMIT_AS, least*megabyte)])
            check(f"{program}: memory for {case}: our own words only", "Backtrace" not in result.stderr
                  and "In file" not in result.stderr, result.stderr)
    # threads: the limit of processes does not bind root, that of address space does
    write("lsq.nml", edited("needle_lsq.nml"))
    with_all = run("psalm", "--quiet", "lsq.nml").stdout
    result = run("psalm", "--threads", "64", "lsq.nml", limits=[(resource.RLIMIT_AS, 300*megabyte)],
                 env={"OMP_STACKSIZE": "16M"})
    check("stacks of threads: the run is done", result.returncode == 0 and result.stdout == with_all, result.stderr)
    check("stacks of threads: told", re.search(r"cannot start 64 threads, using \d+", result.stderr), result.stderr)
    if os.geteuid() == 0:
        os.chmod(ROOT, 0o755)
        os.chmod(".", 0o777)
        try:
            result = run("psalm", "--threads", "64", "--output-dir", "own", "lsq.nml", limits=[(resource.RLIMIT_NPROC, 20)],
                         user=NOBODY)
        except (PermissionError, subprocess.SubprocessError) as reason:
            print(f"skipped: threads of a user who may have 20: {reason}")
            return
    else:
        result = run("psalm", "--threads", "64", "lsq.nml", limits=[(resource.RLIMIT_NPROC, 20)])
    check("number of threads: the run is done", result.returncode == 0 and result.stdout == with_all, result.stderr)
    check("number of threads: told", re.search(r"cannot start 64 threads, using \d+", result.stderr), result.stderr)


def endless_inputs():
    """Inputs without end, or without measure, are refused at once, in words."""
    fresh()
    with open("sparse.nml", "wb") as file:
        file.truncate(2**30)
    write("comments.nml", "! a comment\n" * 17_000_000)
    write("line.nml", "T" * 5_000_000 + "\n")
    # (arguments, standard input, exit status, words)
    cases = [(["/dev/zero"], None, 2, "a zero byte: this is no plain text"), (["-"], "/dev/urandom", 2, "a zero byte"),
             (["sparse.nml"], None, 3, "larger than 32 MB"), (["comments.nml"], None, 3, "larger than 32 MB"),
             (["line.nml"], None, 2, "the line is longer than 4 MB")]
    programs = ("psalm", "kalm", "balm", "muscle", "ssics", "bridge", "calm")
    for program in programs:
        for arguments, source, status, words in cases:
            began = time.monotonic()
            with open(source or os.devnull, "rb") as stdin:
                result = run(program, *arguments, "--output-dir", "out", stdin=stdin)
            took = time.monotonic() - began
            check(f"{program} {arguments[0]}: refused in words", result.returncode == status and words in result.stderr,
                  (result.returncode, result.stderr))
            check(f"{program} {arguments[0]}: at once", took < 5.0, took)
    endless = subprocess.Popen(["yes", "! comment"], stdout=subprocess.PIPE)
    result = run("psalm", "-", stdin=endless.stdout)
    endless.kill()
    endless.wait()
    endless.stdout.close()
    check("a pipe without end", result.returncode == 3 and "larger than 32 MB" in result.stderr, result.stderr)
    os.mkfifo("pipe")
    writer = subprocess.Popen(["cp", "textile.nml", "pipe"])
    result = run("psalm", "pipe", "--output-dir", "out")
    writer.wait()
    check("a pipe with an end is read", result.returncode in (0, 1) and "TEXTILE" in result.stdout.upper(), result.stderr)
    # little memory: our words, not those of the run-time library
    write("long.nml", edited("textile.nml", ("\n &LINKS", "\n" + "! a comment\n" * 2_000_000 + " &LINKS")))
    for megabytes in (60, 90, 120, 200):
        result = run("psalm", "-q", "long.nml", limits=[(resource.RLIMIT_AS, megabytes*2**20)])
        check(f"memory of {megabytes} MB: our own words", result.returncode in (0, 1, 3) and "Error allocating" not in result.stderr
              and "At line" not in result.stderr and (result.returncode != 3 or "memory" in result.stderr), result.stderr)


def environment():
    """Variables that the run-time libraries do not understand change nothing, and are named."""
    fresh()
    plain = run("psalm", "-q", "textile.nml")
    for name, value in (("OMP_NUM_THREADS", "abc"), ("OMP_NUM_THREADS", "-1"), ("OMP_NUM_THREADS", ""), ("OMP_SCHEDULE", "xx"),
                        ("OMP_STACKSIZE", "0"), ("OMP_STACKSIZE", "7X"), ("GOMP_SPINCOUNT", "x"), ("OMP_DYNAMIC", "maybe")):
        result = run("psalm", "-q", "textile.nml", env={name: value})
        check(f"{name}={value}: no word, the same run", (result.returncode, result.stdout, result.stderr) ==
              (plain.returncode, plain.stdout, plain.stderr), result.stderr)
        result = run("psalm", "textile.nml", env={name: value})
        check(f"{name}={value}: named in a remark", result.stderr.startswith(f"psalm: {name} in the environment: without effect"),
              result.stderr)
    for name, value in (("GFORTRAN_STDIN_UNIT", "6"), ("GFORTRAN_STDOUT_UNIT", "0"), ("GFORTRAN_UNBUFFERED_ALL", "y"),
                        ("OMP_NUM_THREADS", "2"), ("OMP_NUM_THREADS", "4,2"), ("OMP_STACKSIZE", "16M"), ("OMP_DYNAMIC", "TRUE")):
        result = run("psalm", "-q", "textile.nml", env={name: value})
        check(f"{name}={value}: the same run", (result.returncode, result.stdout, result.stderr) ==
              (plain.returncode, plain.stdout, plain.stderr), result.stderr)


def small_stack():
    fresh()
    own = {"muscle": "muscle", "calm": "calm", "ssics": "ssics", "bridge": "bridge", "psalm": "exact"}
    for program, folder in own.items():
        for name in sorted(os.listdir(os.path.join(DATA, folder))):
            result = run(program, "--quiet", "--output-dir", "out", os.path.join(DATA, folder, name),
                         limits=[(resource.RLIMIT_STACK, 64*1024)])
            check(f"{program} {name}: a stack of 64 kB", result.returncode in (0, 1), (result.returncode, result.stderr))
    for name in ("sketch_four_bar", "jansen", "excavator", "landing_gear", "scissors_lift"):
        for call in (["psalm"], ["kalm"], ["balm"], ["balm", "--edit"]):
            result = run(*call, "--quiet", "--output-dir", "out", os.path.join(DATA, name + ".nml"),
                         limits=[(resource.RLIMIT_STACK, 64*1024)])
            check(f"{call} {name}: a stack of 64 kB", result.returncode in (0, 1), (result.returncode, result.stderr))
    for name in ("needle_lsq", "path18", "needle_search"):
        shutil.copy(os.path.join(DATA, name + ".nml"), name + ".nml")
    write("sample.nml", edited("needle.nml") + " &TOLER TOLLEN=0.05, NTRIAL=2000 &END\n")
    for program in ("psalm", "kalm", "balm"):
        for case in ("needle", "textile", "needle_lsq", "path18", "needle_search", "sample"):
            result = run(program, "--quiet", case + ".nml", limits=[(resource.RLIMIT_STACK, 64*1024)])
            check(f"{program} {case}: a stack of 64 kB", result.returncode in (0, 1), (result.returncode, result.stderr))


ROOT = tempfile.mkdtemp()
try:
    for test in (inputs_are_safe, targets, marks, whole_sets, pipes, interruption, memory_and_threads, small_stack,
                 endless_inputs, environment):
        if sys.argv[2:] in ([], [test.__name__]):
            test()
finally:
    os.chdir("/")
    shutil.rmtree(ROOT)
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0)
