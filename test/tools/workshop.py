"""A build driver for trials of the sources: one module is compiled anew without the others, flags and place are free.

fpm builds what is installed. Mutation runs build hundreds of times with one line changed, and coverage wants to know which
test ran which line: both need single objects at hand. Object files have the names that fpm gives them.
"""
import glob
import gzip
import hashlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import time

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LIBRARIES = ["-lnlopt", "-llapack"]
# what the programs alone have (scripts/build_library leaves it out of the library, too), and what it needs of the library's C
PROGRAMS_OWN = "src/base/psalm_program.c"
BORDER = "src/base/psalm_border.c"


def setup_value(name):
    """A variable of scripts/setup, so that flags have one place."""
    read = '. "$1" && printf %%s "$%s"' % name
    value = subprocess.run(["bash", "-c", read, "bash", os.path.join(TOP, "scripts", "setup")], capture_output=True, check=True).stdout
    if not value:
        raise SystemExit("scripts/setup has no " + name)
    return value.decode().split()


def release_flags():
    return setup_value("release_flags")


def quick_flags():
    # with -O1 and vectors of 512 bits, gfortran 12 stores rows of psalm_path_descent as if they were aligned, and searches of paths crash
    return ["-O1"] + [flag.replace("vector-width=512", "vector-width=256") for flag in setup_value("plain_flags")]


def quad_flags():
    return quick_flags() + ["-DREAL128"]


def check_flags():
    return ["-O0"] + [flag for flag in setup_value("check_flags") if not flag.startswith("-W")]


class BuildFailed(Exception):
    pass


def run(command, **more):
    """Standard output of a command that must succeed."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, **more)
    if done.returncode != 0:
        raise BuildFailed("%s\n%s" % (" ".join(command), done.stdout.decode("utf-8", "replace")))
    return done.stdout


class Build:
    """Objects, a shared library, programs, examples and test programs of the tree at `top`, in `place`."""

    def __init__(self, top, place, flags, tests=True, compiler="gfortran"):
        self.top, self.place, self.flags, self.compiler = top, place, flags, compiler
        self.bin = os.path.join(place, "bin")
        self.tests = os.path.join(place, "tests")
        self.examples = os.path.join(place, "examples")
        self.library = os.path.join(place, "libpsalm_trial.so")
        self.units = {}       # source -> (module it defines or None, modules it uses, program or not)
        patterns = ["generated/src/*.f90", "src/**/*.[fF]90", "app/*.[fF]90", "src/**/*.c"] + (["test/unit/**/*.[fF]90", "example/*.f90"] if tests else [])
        for pattern in patterns:
            for name in sorted(glob.glob(os.path.join(top, pattern), recursive=True)):
                self.units[os.path.relpath(name, top)] = self.look(name)
        self.maker = {unit[0]: source for source, unit in self.units.items() if unit[0]}
        self.order = []
        for source in self.units:
            self.visit(source)
        for folder in (place, self.bin, self.tests, self.examples, os.path.join(place, "mod")):
            os.makedirs(folder, exist_ok=True)

    @staticmethod
    def look(name):
        text = open(name, encoding="utf-8").read()
        module = re.search(r"^\s*module\s+(\w+)\s*$", text, re.M | re.I)
        uses = set(re.findall(r"^\s*use\s*(?:,\s*non_intrinsic\s*)?(?:::)?\s*(\w+)", text, re.M | re.I))
        # a submodule comes after its module
        uses |= set(re.findall(r"^\s*submodule\s*\(\s*(\w+)", text, re.M | re.I))
        program = re.search(r"^\s*program\s+(\w+)\s*$", text, re.M | re.I) is not None
        return module and module.group(1).lower(), {u.lower() for u in uses}, program

    def visit(self, source):
        if source in self.order:
            return
        for module in sorted(self.units[source][1]):
            if module in self.maker and self.maker[module] != source:
                self.visit(self.maker[module])
        self.order.append(source)

    def object_of(self, source):
        return os.path.join(self.place, source.replace("/", "_") + ".o")

    def module_file(self, source):
        return os.path.join(self.place, "mod", (self.units[source][0] or "") + ".mod")

    def interface(self, source):
        """What users of a module see of it; None for what is no module."""
        name = self.module_file(source)
        if not self.units[source][0] or not os.path.exists(name):
            return None
        data = open(name, "rb").read()
        return gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data

    def compile(self, source):
        if source.endswith(".c"):
            command = ["gcc", "-O1", "-fPIC"] + [f for f in self.flags if f.startswith(("--coverage", "-fsanitize"))]
        else:
            command = [self.compiler, "-fPIC", "-fopenmp", "-ffree-form", "-J" + os.path.join(self.place, "mod")] + self.flags
            if source.startswith("test/"):
                command.append("-O0")     # a test counts allocations that an optimiser would leave out
        run(command + ["-c", source, "-o", self.object_of(source)], cwd=self.top)

    def users(self, module):
        return [s for s in self.order if module in self.units[s][1]]

    def update(self, *sources):
        """Compile sources anew, and their users as far as what they see of them has changed. Returns what was compiled."""
        waiting, done = list(sources), []
        while waiting:
            waiting.sort(key=self.order.index)
            one = waiting.pop(0)
            before = self.interface(one)
            self.compile(one)
            done.append(one)
            if self.interface(one) != before:
                waiting += [u for u in self.users(self.units[one][0]) if u not in waiting and u not in done]
        self.link(done)
        return done

    def link(self, changed=None):
        """The library, then every program that is made of a changed object (None: all)."""
        everything = changed is None
        changed = set(self.order if everything else changed)
        programs = [s for s in self.order if self.units[s][2]]
        helpers = [s for s in self.order if s.startswith("test/") and not self.units[s][2]]
        front = [s for s in self.order if s.startswith("app/") and not self.units[s][2]]
        parts = [s for s in self.order if not self.units[s][2] and s not in helpers + front and s != PROGRAMS_OWN]
        basic = [self.compiler, "-fopenmp"] + [f for f in self.flags if f.startswith(("--coverage", "-fsanitize", "-O"))]
        if changed & set(parts):
            run(basic + ["-shared", "-o", self.library] + [self.object_of(s) for s in parts] + LIBRARIES)
        for source in programs:
            kind = source.split("/")[0]
            test = kind == "test"
            own = helpers if test else front + [PROGRAMS_OWN, BORDER] if kind == "app" else []
            if not everything and not changed & {source, *own}:
                continue
            name = os.path.splitext(os.path.basename(source))[0]
            folder = {"test": self.tests, "example": self.examples}.get(kind, self.bin)
            run(basic + ["-o", os.path.join(folder, name), self.object_of(source)] +
                [self.object_of(s) for s in own] +
                [self.library, "-Wl,-rpath," + self.place] + LIBRARIES)

    def stamp(self):
        """Changes with the flags and with every source."""
        made_of = hashlib.sha256(repr([self.compiler] + self.flags).encode())
        included = sorted(os.path.relpath(name, self.top) for name in glob.glob(os.path.join(self.top, "src", "*", "*.inc")))
        for source in self.order + included:
            made_of.update(source.encode() + open(os.path.join(self.top, source), "rb").read())
        return made_of.hexdigest()

    def all(self):
        for source in self.order:
            self.compile(source)
        self.link()

    def test_programs(self):
        return sorted(os.path.splitext(os.path.basename(s))[0] for s in self.order if self.units[s][2] and s.startswith("test/"))


def copy_tree(target):
    """The files of the work tree that git knows or would take, without what was built."""
    names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=TOP, capture_output=True, check=True)
    for name in os.listdir(target) if os.path.isdir(target) else []:
        if name != "build":
            path = os.path.join(target, name)
            shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)
    for name in names.stdout.decode().splitlines():
        if os.path.isfile(os.path.join(TOP, name)):
            os.makedirs(os.path.dirname(os.path.join(target, name)), exist_ok=True)
            shutil.copy2(os.path.join(TOP, name), os.path.join(target, name))


# seconds each, not one
SLOW = ("programs: datasets", "programs: device7", "programs: solvers", "hard cases", "pictures: pages", "summary: against_device_9",
        "fuzz", "processor", "slide pairs")


def end_all(mark):
    """Kill whatever has the mark in its environment: some tests start programs in sessions of their own."""
    for name in glob.glob("/proc/[0-9]*/environ"):
        try:
            if b"TRIAL=" + mark.encode() in open(name, "rb").read().split(b"\0"):
                os.kill(int(name.split("/")[2]), signal.SIGKILL)
        except OSError:
            pass    # it has ended, or is not ours


class Stage:
    """A part of the tests: a command that fails when it notices something."""

    def __init__(self, name, command, needs=("release",)):
        self.name, self.command, self.needs = name, command, needs

    def run(self, top, limit, **environment):
        """True if all is well. A run past `limit` seconds is stopped with all that it started, and is not well."""
        mark = "%d-%f" % (os.getpid(), time.monotonic())
        process = subprocess.Popen(self.command, cwd=top, env=dict(os.environ, STOP_AT_FIRST="1", TRIAL=mark, **environment),
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   start_new_session=True)
        try:
            output, _ = process.communicate(timeout=limit)
            self.output = output.decode("utf-8", "replace")
        except subprocess.TimeoutExpired:
            end_all(mark)
            process.communicate()
            self.output = "FAILED: no end within %.0f seconds" % limit
            return False
        return process.returncode == 0


# Parts of scripts/test that are no stages: they look at sources, build by themselves, or measure times.
ELSEWHERE = {"style", "layers", "page", "library", "quadruple", "units", "outside", "benches", "workbench", "sizes"}
# Parts that are taken apart, because each of theirs runs other lines: where their names are, and the option before a name.
DIVIDED = {"programs": (r"^if part (\w+); then", []), "files": (r"\b(?:for test in \()([\w,\s]+)\)", []),
           "summary": (r"\b(?:for part in \()([\w,\s]+)\)", []), "pictures": (r'^    "(\w+)": ', ["--only"])}


def parts_of_the_tests(top, release):
    """Name and command of each part of scripts/test, in its order, with the programs of the build `release`."""
    script = open(os.path.join(top, "scripts", "test"), encoding="utf-8").read().replace("\\\n", " ")
    python = os.path.join(TOP, ".venv", "bin", "python")
    values = {"top": top, "prefix/bin": release.bin, "python": python}
    for name, command in re.findall(r'^(?:! wanted \w+ \|\| |\[.*\] \|\| )?part (\w+) "[^"]*" (.*)$', script, re.M):
        command = re.sub(r"\$(prefix/bin|top|python)", lambda found: values[found.group(1)], command.split(" #")[0])
        words = shlex.split(command)
        yield name, [python if word == "python3" else word for word in words]


def listings(top, release):
    """The comparison of each data set's listing with its reference."""
    reference = os.path.join(top, "data", "reference")
    for name in sorted(glob.glob(os.path.join(reference, "**", "*.lst"), recursive=True)):
        name = os.path.relpath(name, reference)[:-4]
        if os.path.exists(os.path.join(top, "data", name + ".nml")):
            yield Stage("listing: " + name, [os.path.join(top, "scripts", "compare"), "--bin", release.bin, name])


def stages(top, debug, release, quad):
    """All tests of scripts/test but those of ELSEWHERE and of two modules in quadruple precision."""
    test = os.path.join(top, "test")
    result = list(listings(top, release))
    result += [Stage(name, [os.path.join(debug.tests, name)], ("debug",)) for name in debug.test_programs()]
    # from C and Python, and the examples; that they build by themselves, and the package outside, is not asked here
    result += [Stage("C", ["sh", "-c", 'cc -std=c11 -I include c/test_psalm.c "$1" "-Wl,-rpath,$2" -lm -o "$2/test_capi" && "$2/test_capi" data',
                           "C", release.library, release.place])]
    result += [Stage("Python", ["env", "PSALM_LIBRARY=" + release.library, "PYTHONPATH=python", os.path.join(TOP, ".venv", "bin", "python"),
                                "python/test_psalm.py", "data"])]
    if any(source.startswith("example/") for source in release.order):
        result += [Stage("examples", [os.path.join(test, "program", "library.sh"), release.bin, release.examples])]
    for name, command in parts_of_the_tests(top, release):
        if name in ELSEWHERE:
            continue
        if name not in DIVIDED:
            result.append(Stage(name, command))
            continue
        pattern, option = DIVIDED[name]
        script = open(next(word for word in command if word.startswith(test)), encoding="utf-8").read()
        parts = [part.strip() for found in re.findall(pattern, script, re.M) for part in found.split(",")]
        result += [Stage("%s: %s" % (name, part), command + option + [part]) for part in parts]
    result += [Stage("processor", [os.path.join(test, "program", "processor.sh"), release.bin])]
    result += [Stage("hard cases", [os.path.join(test, "tools", "hard_cases.sh"), release.bin, quad.bin], ("release", "quad"))]
    return result
