#!/usr/bin/env python3
"""Mutation run: one token of the sources is changed at a time; do the tests notice?

usage: mutate.py [--count N] [--seed S] [--source REGEX] [--seconds S] [--only REGEX] [--again | --report]

Changes are drawn at random over the sources of src/ and app/ whose path matches REGEX (a change of a number a quarter as often as
another); the same seed gives the same changes of the same sources. One build, optimised little, holds them all: each changed
statement stands there twice, in the branches of an IF that asks for the number of the change in the environment (TRIAL_CHANGE).
Changes of declarations cannot be switched so and are built one by one, at the end. What does not compile is drawn again.

A part of the tests (a stage: test/tools/workshop.py makes them of scripts/test) is run on the sound sources first and notes which
changes it passes (TRIAL_REACHED); it is asked about those only. Whatever promises most for its seconds is asked next, until every
change is noticed, no stage is left, or --seconds are over. A change that leaves the machine code as it was is no change: it is
named apart and does not count; a tenth more than N is drawn for that.

build/mutate/seed-S.json has the results as they come; a run that was stopped goes on there. --again asks all stages anew about what
was missed, for tests that have changed since. --only REGEX asks the stages that match only. The work tree is not touched.
The last line is N noticed, N missed; the exit status is 1 if fewer than 90 per cent are noticed.
"""
import argparse
import collections
import glob
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import workshop

PLACE = os.path.join(workshop.TOP, "build", "mutate")
LEAST = 90.0          # per cent to be noticed
NUMBERS = 0.25        # weight of a changed number, of which there are many
SPARE = 1.1           # changes drawn for one that is to count
SLACK, PATIENCE = 10.0, 6.0  # a stage may take PATIENCE times as long as it does on the sound sources, and SLACK seconds
SINGLE = 90.0         # seconds of tests for a change that is built by itself
# seconds that a stage takes, before one knows
GUESSES = ((r"listing: .*", 0.3), (r"test_\w+", 2.0), (r"pictures: .*", 3.0), (r"", 10.0))

TOKEN = re.compile(r"""(?P<text>'[^']*'|"[^"]*")|(?P<note>!.*)|(?P<dot>\.\w+\.)
                       |(?P<number>(?<![\w.])\d+(?:\.\d*)?(?:[ed][-+]?\d+)?(?:_\w+)?)
                       |(?P<word>[a-z]\w*)|(?P<sign>\*\*|//|==|/=|<=|>=|=>|::|\(/|/\)|[-+*/<>=%(),:])""", re.I | re.X)
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "<": ["<=", ">"], "<=": "<", ">": [">=", "<"], ">=": ">", "==": "/=",
         "/=": "==", ".and.": ".or.", ".or.": ".and.", ".true.": ".false.", ".false.": ".true.", "exit": "cycle",
         "cycle": "exit", "min": "max", "max": "min", "minval": "maxval", "maxval": "minval", "any": "all", "all": "any",
         "sin": "cos", "cos": "sin",
         "minloc": "maxloc", "maxloc": "minloc", ".not.": ""}
NOT_CODE = re.compile(r"\s*((use|implicit|import|include|end|endif|enddo|module|submodule|contains|interface|abstract|private|public|"
                      r"procedure|enum)\b|type\b[^(]|type,|#)", re.I)
HEADING = re.compile(r"^[^'\"!]*\b(subroutine|function)\s+\w+\s*\(", re.I)
# the first line of a construct, after its name if it has one, without what is in brackets
OPENS = re.compile(r"\s*(?:\w+\s*:\s*)?(?:if\s*\(\)\s*then|do|do\s+\w.*|select\s*(?:case|type|rank)\b.*|(?:where|forall)\s*\(\)|"
                   r"associate\s*\(\)|block|critical)\s*", re.I)
MIDDLE = re.compile(r"\s*(?:else|else\s*if\s*\(\)\s*then|elsewhere(?:\s*\(\))?|(?:case|rank)\s*(?:\(\)|default)|"
                    r"(?:class|type)\s+(?:is\s*\(\)|default))\s*\w*\s*", re.I)
CLOSES = re.compile(r"\s*end\s*(?:if|do|select|where|forall|associate|block|critical)\b.*", re.I)
MASK = re.compile(r"\s*(?:\w+\s*:\s*)?(?:where|forall)\b", re.I)

USE = "   use psalm_trial_changes, only: trial_change"
MODULE = """!> Switches of a mutation run.
module psalm_trial_changes
   use, intrinsic :: iso_c_binding, only: c_bool, c_int
   implicit none (type, external)
   private
   public :: trial_change

   interface
      !> Is it the change of this number that is tried?
      pure function trial_change(number) result(tried) bind(c)
         import :: c_bool, c_int
         integer(c_int), value :: number
         logical(c_bool) :: tried
      end function trial_change
   end interface
end module psalm_trial_changes
"""
SWITCH = r"""/* Switches of a mutation run: which change is tried, and, where a file is asked for, which were passed. */
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static int tried = -1;
static const char *reached;
static char passed[100000];

__attribute__((constructor)) static void look(void)
{
    const char *number = getenv("TRIAL_CHANGE");
    if (number)
        tried = atoi(number);
    reached = getenv("TRIAL_REACHED");
}

bool trial_change(int number)
{
    if (reached && !passed[number]) {
        char line[16];
        int file = open(reached, O_WRONLY | O_APPEND | O_CREAT, 0666);
        passed[number] = 1;
        if (file >= 0) {
            if (write(file, line, snprintf(line, sizeof line, "%d\n", number)) < 0)
                passed[number] = 0;
            close(file);
        }
    }
    return number == tried;
}
"""


def without_strings(line):
    """The line with strings and comments blanked, column by column."""
    return TOKEN.sub(lambda t: t.group() if t.lastgroup not in ("text", "note") else
                     "'" + " "*(len(t.group()) - 2) + "'" if t.lastgroup == "text" else " "*len(t.group()), line)


def statements(lines):
    """Every statement: (first line, last line, code without strings and comments); lines are counted from 0."""
    first, code = None, ""
    for number, line in enumerate(lines):
        bare = without_strings(line).rstrip()
        if not bare.strip():
            continue
        if first is None:
            first, code = number, ""
        elif bare.lstrip().startswith("&"):
            bare = bare.lstrip()[1:]
        goes_on = bare.endswith("&")
        code += bare[:-1] if goes_on else bare
        if not goes_on:
            yield first, number, code
            first = None


def depth_zero(code):
    """The code outside of brackets."""
    depth, out = 0, ""
    for c in code:
        depth -= c in ")]"
        out += c if depth == 0 else ""
        depth += c in "(["
    return out


def sites(lines):
    """Every change of one token: line, column, old, new, weight, and first and last line of what is to stand twice, None of a declaration."""
    found, open_constructs, waiting = [], [], []
    for first, last, code in statements(lines):
        if CLOSES.fullmatch(code):
            opened = open_constructs.pop()
            for site in opened["sites"]:
                site["last"] = last
            continue
        bare = depth_zero(code)
        opening, middle = OPENS.fullmatch(bare), MIDDLE.fullmatch(bare)
        if opening:
            open_constructs.append({"first": first, "sites": [], "mask": MASK.match(code) is not None})
        if NOT_CODE.match(code) or HEADING.match(code):
            continue
        declaration = "::" in bare
        around = next((c for c in open_constructs if c["mask"]), open_constructs[-1] if opening or middle else None)
        for number in range(first, last + 1):
            for column, old, new, weight in changes_of(lines[number], declaration, "parameter" in code):
                site = {"line": number + 1, "column": column, "old": old, "new": new, "weight": weight, "first": first, "last": last}
                if declaration:
                    site["first"] = site["last"] = None
                elif around:
                    site["first"] = around["first"]
                    around["sites"].append(site)
                found.append(site)
    return found


def changes_of(line, declaration, constant):
    """Changes of one token in a line: (column, old, new, weight)."""
    found = []
    for token in TOKEN.finditer(line):
        old = token.group()
        after = line[token.end():].lstrip()[:1]
        if token.lastgroup in ("text", "note"):
            continue
        if token.lastgroup == "number":
            if not re.fullmatch(r"\d+(\.\d*)?(_\w+)?", old) or (declaration and not constant):
                continue
            value = re.match(r"\d+", old).group()
            found.append((token.start(), old, str(int(value) + 1) + old[len(value):], NUMBERS))
            continue
        if declaration and token.lastgroup != "dot":
            continue
        if token.lastgroup == "word" and old.lower() not in ("exit", "cycle") and after != "(":
            continue
        swap = SWAPS.get(old.lower(), [])
        for new in [swap] if isinstance(swap, str) else swap:
            found.append((token.start(), old, new, 1.0))
    return found


def changed_line(line, change):
    return line[:change["column"]] + change["new"] + line[change["column"] + len(change["old"]):]


def changed_lines(lines, change):
    number = change["line"] - 1
    return lines[:number] + [changed_line(lines[number], change)] + lines[number + 1:]


def with_switches(lines, changes):
    """The source with what is changed twice, and for each of its lines the change that it is of, or None."""
    before, after = {}, {}
    for change in sorted(changes, key=lambda c: (c["first"], -c["last"])):
        copy = changed_lines(lines, change)[change["first"]:change["last"] + 1]
        before.setdefault(change["first"], []).extend(
            [(line, change["number"]) for line in ["if (trial_change(%d)) then" % change["number"]] + copy + ["else"]])
        after.setdefault(change["last"], []).append(("end if", change["number"]))
    result = []
    for number, line in enumerate(lines):
        result += before.get(number, []) + [(line, None)] + after.get(number, [])
    return [line for line, _ in result], [of for _, of in result]


def with_use(lines):
    """The module with the switches at hand."""
    head = re.compile(r"\s*(module|submodule\s*\(.*\)|program)\s+\w+\s*$", re.I)
    at = next(n for n, line in enumerate(lines) if head.match(line.split("!")[0]) and not line.lower().lstrip().startswith("module procedure"))
    return lines[:at + 1] + [USE] + lines[at + 1:]


def results_of(seed):
    return os.path.join(PLACE, "seed-%d.json" % seed)


def first_failure(output):
    lines = output.strip().split("\n")
    return next((line for line in lines if line.startswith("FAILED")), lines[-1])[:200]


class Trial:
    """The copied tree with its build, the changes, and what is known of the stages."""

    def __init__(self, options):
        self.options = options
        self.tree = os.path.join(PLACE, "tree")
        self.results = results_of(options.seed)
        workshop.copy_tree(self.tree)
        self.write("src/base/psalm_trial_changes.f90", MODULE)
        self.write("src/base/psalm_trial_switch.c", SWITCH)
        self.build = workshop.Build(self.tree, os.path.join(self.tree, "build", "release"), workshop.quick_flags())
        self.sources = [s for s in self.build.order if s.endswith("90") and s.startswith(("src/", "app/"))]
        self.sources += [os.path.relpath(name, self.tree) for name in sorted(glob.glob(os.path.join(self.tree, "src", "*", "*.inc")))]
        self.texts = {s: self.read(s) for s in self.sources}
        self.includers = {}
        for source in self.sources:
            for name in re.findall(r"^\s*include\s*'([\w.]+)'", self.texts[source], re.M):
                self.includers.setdefault(os.path.join(os.path.dirname(source), name), []).append(source)
        self.stages = {stage.name: stage for stage in workshop.stages(self.tree, self.build, self.build, self.build)}
        self.made_of = hashlib.sha256(json.dumps([options.source, options.count, self.texts]).encode()).hexdigest()
        self.known = {"made_of": self.made_of, "changes": [], "reached": {}, "seconds": {}, "broken": {}, "tried": {}}
        self.cache, self.sound_cache = os.path.join(PLACE, "cache"), os.path.join(PLACE, "cache.sound")

    def read(self, source):
        with open(os.path.join(self.tree, source), encoding="utf-8") as file:
            return file.read()

    def write(self, source, text):
        with open(os.path.join(self.tree, source), "w", encoding="utf-8") as file:
            file.write(text)

    def units(self, sources):
        """What is compiled when these change."""
        return list(dict.fromkeys(unit for source in sources for unit in self.includers.get(source, [source])))

    # --- drawing and building

    def prepare(self):
        if os.path.exists(self.results):
            with open(self.results, encoding="utf-8") as file:
                self.known = json.load(file)
            if self.known["made_of"] != self.made_of:
                raise SystemExit("%s is of other sources, or another draw: remove it" % self.results)
        name, stamp = os.path.join(self.build.place, "stamp"), self.build.stamp()
        built = open(name, encoding="utf-8").read().split() if os.path.exists(name) else []
        if not self.known["changes"]:
            if built != [stamp]:
                self.build.all()
                built = [stamp]
            self.draw()
            self.save()
        switched = self.switch()
        stamps = [stamp, self.build.stamp()]
        if built == [stamp]:
            self.build.update(*self.units(switched))
        elif built != stamps:
            self.build.all()
        with open(name, "w", encoding="utf-8") as out:
            out.write("\n".join(stamps))
        print("-- built", file=sys.stderr, flush=True)

    def draw(self):
        """Changes that compile."""
        generator = random.Random(self.options.seed)
        wanted = re.compile(self.options.source)
        everything = [(source, site) for source in sorted(self.sources) if wanted.search(source)
                      for site in sites(self.texts[source].split("\n"))]
        if not everything:
            raise SystemExit("no source's path matches " + self.options.source)
        weights = [site["weight"] for _, site in everything]
        changes, taken = [], set()
        while len(changes) < round(SPARE*self.options.count):
            source, site = generator.choices(everything, weights)[0]
            key = (source, site["line"], site["column"], site["new"])
            if key in taken:
                continue
            taken.add(key)
            change = dict(site, file=source, number=len(taken), noticed="", asked=[], why="",
                          text=self.texts[source].split("\n")[site["line"] - 1].strip())
            if self.compiles(change):
                changes.append(change)
        self.known["changes"] = changes

    def compiles(self, change):
        """By itself and with its switch."""
        lines = self.texts[change["file"]].split("\n")
        texts = [changed_lines(lines, change)]
        if change["first"] is not None:
            texts.append(with_switches(lines, [change])[0])
        try:
            for text in texts:
                self.write(change["file"], "\n".join(text))
                for unit in self.units([change["file"]]):
                    if text is texts[-1] and len(texts) == 2:
                        self.write(unit, "\n".join(with_use(self.read(unit).split("\n"))))
                    if not self.is_correct(unit):
                        return False
            return True
        finally:
            for source in {change["file"], *self.units([change["file"]])}:
                self.write(source, self.texts[source])

    def is_correct(self, unit):
        with tempfile.TemporaryDirectory() as place:
            return subprocess.run([self.build.compiler, "-fsyntax-only", "-fopenmp", "-ffree-form", "-J" + place,
                                   "-I" + os.path.join(self.build.place, "mod")] + self.build.flags + [unit],
                                  cwd=self.tree, capture_output=True).returncode == 0

    def switch(self):
        """Put the switches into the tree. Returns the sources that have some."""
        by_source = {}
        for change in self.known["changes"]:
            if change["first"] is not None:
                by_source.setdefault(change["file"], []).append(change)
        for source, changes in by_source.items():
            self.write(source, "\n".join(with_switches(self.texts[source].split("\n"), changes)[0]))
        for unit in self.units(by_source):
            self.write(unit, "\n".join(with_use(self.read(unit).split("\n"))))
        self.switched = {source: self.read(source) for source in {*by_source, *self.units(by_source)}}
        return by_source

    def save(self):
        with open(self.results + ".new", "w", encoding="utf-8") as out:
            json.dump(self.known, out, indent=1)
        os.replace(self.results + ".new", self.results)

    # --- asking

    def guess(self, name):
        return self.known["seconds"].get(name) or next(s for pattern, s in GUESSES if re.match(pattern, name))

    def run_stage(self, name, **environment):
        """Whether the stage is content, and its seconds. What a changed program has put into the cache of start sets goes again."""
        limit = SLACK + PATIENCE*self.known["seconds"][name] if name in self.known["seconds"] else 600
        began = time.monotonic()
        sound = self.stages[name].run(self.tree, limit, XDG_CACHE_HOME=self.cache, **environment)
        return sound, time.monotonic() - began

    @staticmethod
    def listed(folder):
        return sorted((os.path.relpath(name, folder), os.stat(name).st_size, int(os.stat(name).st_mtime))
                      for name in glob.glob(os.path.join(folder, "**"), recursive=True) if os.path.isfile(name))

    def keep_cache(self, source, target):
        if self.listed(source) != self.listed(target):
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(source, target)

    def look(self, name):
        """Run a stage on the sound sources: which changes does it pass?"""
        with tempfile.TemporaryDirectory() as place:
            reached = os.path.join(place, "reached")
            os.chmod(place, 0o777)
            sound, seconds = self.run_stage(name, TRIAL_REACHED=reached)
            numbers = sorted({int(n) for n in open(reached, encoding="ascii").read().split()}) if os.path.exists(reached) else []
        self.known["seconds"][name] = round(seconds, 2)
        self.known["reached"][name] = numbers
        if not sound:
            self.known["broken"][name] = first_failure(self.stages[name].output)
            print("-- %s fails before anything is changed and is left out: %s" % (name, self.known["broken"][name]), file=sys.stderr, flush=True)
        else:
            os.makedirs(self.cache, exist_ok=True)
            self.keep_cache(self.cache, self.sound_cache)

    def power(self, name):
        """Changes noticed for a second of it, as far as one knows; the look before the first question takes as long as that."""
        noticed, asked = self.known["tried"].get(name, (0, 0))
        return (noticed + 1)/(asked + 2)/(self.guess(name) + 0.05)/(1 if name in self.known["reached"] else 2)

    def ask(self, name, change, environment):
        sound, seconds = self.run_stage(name, **environment)
        if os.path.isdir(self.sound_cache):
            self.keep_cache(self.sound_cache, self.cache)
        tried = self.known["tried"].setdefault(name, [0, 0])
        tried[0] += not sound
        tried[1] += 1
        change["asked"].append(name)
        if not sound:
            change["noticed"], change["why"] = name, first_failure(self.stages[name].output)
            print("-- %(file)s:%(line)d %(old)s -> %(new)s: %(noticed)s" % change + " (%.1f s)" % seconds, file=sys.stderr, flush=True)
        return not sound

    def usable(self):
        only = re.compile(self.options.only)
        return [name for name in self.stages if only.search(name) and name not in self.known["broken"]]

    def ask_switched(self, end):
        """Stage by stage, whatever promises most."""
        changes = [c for c in self.known["changes"] if c["first"] is not None]
        while time.monotonic() < end:
            missed = [c for c in changes if c["noticed"] == ""]
            questions = {}
            for name in self.usable():
                reached = self.known["reached"].get(name)
                questions[name] = [c for c in missed if name not in c["asked"] and (reached is None or c["number"] in reached)]
            names = [name for name in questions if questions[name]]
            if not names:
                break
            passed = collections.Counter(n for numbers in self.known["reached"].values() for n in numbers)

            def doubt(change):
                # what many stages pass, or passed without noticing it, is hardly the point of the next
                return (1 + len(change["asked"]))*max(1, passed[change["number"]])**0.5

            likeliest = {name: min(questions[name], key=doubt) for name in names}
            name = max(names, key=lambda n: self.power(n)/doubt(likeliest[n]))
            if name not in self.known["reached"]:
                self.look(name)
            else:
                change = likeliest[name]
                self.ask(name, change, {"TRIAL_CHANGE": str(change["number"])})
            self.save()

    def ask_singles(self, end):
        """Changes of declarations; first the stages that pass other changes of the same source."""
        for change in self.known["changes"]:
            if change["first"] is not None or change["noticed"] != "" or time.monotonic() > end:
                continue
            source = change["file"]
            beside = {c["number"] for c in self.known["changes"] if c["file"] == source}
            names = [n for n in self.usable() if n in self.known["reached"] and n not in change["asked"]]
            names.sort(key=lambda n: -self.power(n)*(10 if beside & set(self.known["reached"][n]) else 1))
            if not names:
                continue
            present = self.read(source)
            lines = present.split("\n")
            at = [n for n, line in enumerate(lines) if line.strip() == change["text"]]
            at = min(at, key=lambda n: abs(n + 1 - change["line"]))
            self.write(source, "\n".join(lines[:at] + [changed_line(lines[at], change)] + lines[at + 1:]))
            try:
                self.build.update(*self.units([source]))
                left = time.monotonic() + SINGLE
                for name in names:
                    if time.monotonic() > left or self.ask(name, change, {}):
                        break
            except workshop.BuildFailed:
                change["noticed"] = None
            finally:
                self.write(source, present)
                self.build.update(*self.units([source]))
            self.save()

    def is_no_change(self, change):
        """Is the machine code the same with and without it?"""
        code = []
        source = change["file"]
        units = self.units([source])
        lines = self.texts[source].split("\n")
        try:
            for unit in units:
                self.write(unit, self.texts[unit])
            for text in (lines, changed_lines(lines, change)):
                self.write(source, "\n".join(text))
                with tempfile.TemporaryDirectory() as place:
                    build = workshop.Build.__new__(workshop.Build)
                    build.__dict__.update(self.build.__dict__, place=place)
                    os.makedirs(os.path.join(place, "mod"))
                    build.flags = self.build.flags + ["-I" + os.path.join(self.build.place, "mod")]
                    made = []
                    for unit in units:
                        build.compile(unit)
                        made += [open(build.object_of(unit), "rb").read(), build.interface(unit)]
                    code.append(made)
        finally:
            for name in {source, *units}:
                self.write(name, self.switched.get(name, self.texts[name]))
        return code[0] == code[1]

    def run(self):
        if self.options.again:
            self.known["reached"], self.known["broken"] = {}, {}
            for change in self.known["changes"]:
                if change["noticed"] == "":
                    change["asked"] = []
        end = time.monotonic() + self.options.seconds
        self.ask_switched(end)
        self.ask_singles(end)
        for change in self.known["changes"]:
            if change["noticed"] == "" and "checked" not in change and time.monotonic() < end:
                change["checked"] = True
                if self.is_no_change(change):
                    change["noticed"] = None
        self.save()


def report(known, count):
    """Name what was missed. Returns how many changes were noticed and how many missed."""
    real = []
    for change in known["changes"]:
        if change["noticed"] is None:
            print("no change: %(file)s:%(line)d: %(old)s -> %(new)s   %(text)s" % change)
        else:
            real.append(change)
    real = real[:count]
    for change in real:
        if change["noticed"] == "":
            ran = sum(change["number"] in numbers for numbers in known["reached"].values())
            print("missed (asked %d of %d stages that run it): " % (len(change["asked"]), ran) +
                  "%(file)s:%(line)d: %(old)s -> %(new)s   %(text)s" % change)
    noticed = sum(change["noticed"] != "" for change in real)
    print("%d noticed, %d missed" % (noticed, len(real) - noticed))
    return noticed, len(real) - noticed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--source", default="", help="as 'src/(cam|proof)/|_chain'")
    parser.add_argument("--seconds", type=float, default=1e9, help="no stage is begun after so many")
    parser.add_argument("--only", default="", help="stages, as 'test_cam|calm'")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--report", action="store_true", help="print what the run so far has found, run nothing")
    parser.add_argument("--nice", type=int, default=10)
    options = parser.parse_args()
    os.nice(options.nice)
    os.makedirs(PLACE, exist_ok=True)
    if not options.report:
        trial = Trial(options)
        trial.prepare()
        trial.run()
    with open(results_of(options.seed), encoding="utf-8") as file:
        noticed, missed = report(json.load(file), options.count)
    return noticed < LEAST/100.0*(noticed + missed)


if __name__ == "__main__":
    sys.exit(main())
