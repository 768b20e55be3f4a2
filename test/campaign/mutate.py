#!/usr/bin/env python3
"""Mutation run: one token of the sources is changed at a time; do the tests notice?

usage: mutate.py [--count N] [--seed S] [--folder FOLDER,...] [--report | --again] [--quick [--near]]

Each change is drawn at random over src/ and app/ (a change of a number a quarter as often as another), built, and put
through the tests until one fails, first those that noticed most in the least time. Tests that never run the line (build/coverage/lines.json, made by
coverage.py) are left out. A change that does not compile, or leaves the optimised code as it was, is drawn again. The same
seed gives the same changes; --again puts those that were missed through the tests of today. Results go to
build/mutate/seed-S.jsonl as they come, and a run that was stopped goes on there, on the same sources. The sources themselves are
not touched. --quick builds once, less optimised and without the checks of the run-time library, and leaves out the parts of the tests
that take longest: what it misses goes through --again. With --near a change is asked only of the tests that concern its source
(CONCERNS), the quickest first. The last line is N noticed, N missed; the exit status is 1 if fewer than 90 per cent are noticed.
"""
import argparse
import glob
import json
import os
import random
import re
import shutil
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import workshop

PLACE = os.path.join(workshop.TOP, "build", "mutate")
LEAST = 90.0          # per cent to be noticed
NUMBERS = 0.25        # weight of a changed number, of which there are many
SLACK, PATIENCE = 15.0, 6.0  # a stage may take PATIENCE times as long as it does on the sound sources, and SLACK seconds

MOST_PICTURES = "pictures: most"
NEAR = {    # stages that --quick asks about changes of these sources only: they run many other lines and seldom notice
    MOST_PICTURES: ("src/picture/", "src/report/", "src/study/", "app/"),
    "files: ": ("src/base/", "src/report/", "src/study/", "app/"),
    "programs: interruption": ("src/base/", "src/synthesis/psalm_search", "src/study/", "app/"),
    "summary: ": ("src/synthesis/psalm_summary", "src/report/psalm_summary", "src/study/"),
    "narrow places": ("src/assur/", "src/synthesis/"),
}

# Sources, and the stages that concern them, whole names; a source may have several. The references concern all.
CONCERNS = [(re.compile(sources), re.compile(stages)) for sources, stages in (
    (r"src/cam/|_cam|app/calm", r"test_cam|calm"),
    (r"src/proof/|_proof|taylor", r"test_proof.*|test_clearance|proofs|laws|narrow places"),
    (r"src/exact/|_exact|six_bar|app/psalm", r"test_exact|exact|six bars"),
    (r"src/picture/|app/balm", MOST_PICTURES),
    (r"_chain", r"test_chain.*|test_sketch.*|test_higher_groups|test_redraw|sketches|larger groups|outputs|sketch campaign|kinds"),
    (r"src/report/|_report|_list|_summary", r"tables|programs: .*|summary: .*|manual|mistakes|next step|reading|test_library|test_summary|Python"),
    (r"", r"references"))]

TOKEN = re.compile(r"""(?P<text>'[^']*'|"[^"]*")|(?P<note>!.*)|(?P<dot>\.\w+\.)
                       |(?P<number>(?<![\w.])\d+(?:\.\d*)?(?:[ed][-+]?\d+)?(?:_\w+)?)
                       |(?P<word>[a-z]\w*)|(?P<sign>\*\*|//|==|/=|<=|>=|=>|::|\(/|/\)|[-+*/<>=%(),:])""", re.I | re.X)
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "<": ["<=", ">"], "<=": "<", ">": [">=", "<"], ">=": ">", "==": "/=",
         "/=": "==", ".and.": ".or.", ".or.": ".and.", ".true.": ".false.", ".false.": ".true.", "exit": "cycle",
         "cycle": "exit", "min": "max", "max": "min", "minval": "maxval", "maxval": "minval", "any": "all", "all": "any",
         "sin": "cos", "cos": "sin",
         "minloc": "maxloc", "maxloc": "minloc", ".not.": ""}
NOT_CODE = re.compile(r"\s*(use|implicit|import|end|module|contains|interface|private|public|procedure|type\b[^(]|type,|!|#)", re.I)
HEADING = re.compile(r"^[^'\"!]*\b(subroutine|function)\s+\w+\s*\(", re.I)


def sites(source, text):
    """Every change of one token: (line number, column, old, new, weight)."""
    found = []
    for number, line in enumerate(text.split("\n"), 1):
        if NOT_CODE.match(line) or HEADING.match(line):
            continue
        declaration = "::" in line.split("!")[0]
        for token in TOKEN.finditer(line):
            old = token.group()
            after = line[token.end():].lstrip()[:1]
            if token.lastgroup in ("text", "note"):
                continue
            if token.lastgroup == "number":
                if not re.fullmatch(r"\d+(\.\d*)?(_\w+)?", old) or (declaration and "parameter" not in line):
                    continue
                value = re.match(r"\d+", old).group()
                found.append((number, token.start(), old, str(int(value) + 1) + old[len(value):], NUMBERS))
                continue
            if declaration and token.lastgroup != "dot":
                continue
            if token.lastgroup == "word" and old.lower() not in ("exit", "cycle") and after != "(":
                continue
            swap = SWAPS.get(old.lower(), [])
            for new in [swap] if isinstance(swap, str) else swap:
                found.append((number, token.start(), old, new, 1.0))
    return found


def machine_code(build, source):
    return open(build.object_of(source), "rb").read()


def is_far(stage, source):
    return any(stage.startswith(name) and not source.startswith(near) for name, near in NEAR.items())


def concerns(stage, source):
    return any(sources.search(source) and stages.fullmatch(stage) for sources, stages in CONCERNS)


def first_failure(output):
    lines = output.strip().split("\n")
    return next((line for line in lines if line.startswith("FAILED")), lines[-1])[:200]


class Trial:
    """The copied tree with its builds, and what each stage takes on sound sources."""

    def __init__(self, options):
        quick, self.near = options.quick, options.near
        self.tree = os.path.join(PLACE, "tree")
        workshop.copy_tree(self.tree)
        build = os.path.join(self.tree, "build")
        self.release = workshop.Build(self.tree, os.path.join(build, "release"), workshop.quick_flags() if quick else workshop.release_flags(),
                                      tests=quick)
        self.debug = self.quad = self.release
        if not quick:
            self.debug = workshop.Build(self.tree, os.path.join(build, "debug"), workshop.check_flags())
            self.quad = workshop.Build(self.tree, os.path.join(build, "quad"), workshop.quad_flags(), tests=False)
        self.stages = workshop.stages(self.tree, self.debug, self.release, self.quad)
        self.quick = quick
        if quick:
            self.stages = self.fewer_stages()
        if self.near:
            sources = [s for s in self.release.order if s.startswith(options.folders)]
            self.stages = [stage for stage in self.stages if any(concerns(stage.name, s) for s in sources)]
        self.builds = list(dict.fromkeys((self.release, self.debug, self.quad)))
        for build in self.builds:
            self.build_sound(build)
        print("-- built", file=sys.stderr, flush=True)
        memory = os.path.join(self.release.place + ".sound", "seconds.json")
        self.seconds = json.load(open(memory, encoding="utf-8")) if os.path.exists(memory) else {}
        for stage in self.stages:
            if stage.name in self.seconds:
                continue
            began = time.monotonic()
            if not stage.run(self.tree, 3600):
                raise SystemExit("the tests fail before anything is changed: %s\n%s" % (stage.name, stage.output[-2000:]))
            self.seconds[stage.name] = time.monotonic() - began
        with open(memory, "w", encoding="utf-8") as out:
            json.dump(self.seconds, out)
        self.tried = {stage.name: [1, 3] for stage in self.stages}    # how often it noticed, how often it was asked
        print("-- sound sources: %.0f seconds" % sum(self.seconds.values()), file=sys.stderr, flush=True)
        self.runs = self.read_coverage()
        for stage in self.stages:
            if stage.name == MOST_PICTURES:
                for stages in self.runs.values():
                    if any(name.startswith("pictures: ") for name in stages):
                        stages.add(MOST_PICTURES)
        self.measured = set().union(*self.runs.values()) if self.runs else set()
        self.why = ""

    def fewer_stages(self):
        """Without the slow ones; the pictures in one go, because each start of the browser takes seconds."""
        fast = [stage for stage in self.stages if stage.name not in workshop.SLOW]
        pictures = [stage for stage in fast if stage.name.startswith("pictures: ")]
        parts = ",".join(stage.command[-1] for stage in pictures)
        return [stage for stage in fast if stage not in pictures] + \
            [workshop.Stage(MOST_PICTURES, pictures[0].command[:-1] + [parts])]

    def power(self, name):
        """Changes noticed for a second of it, as far as one knows."""
        noticed, asked = self.tried[name]
        return noticed/asked/(self.seconds[name] + 0.05)

    def learn(self, name, noticed):
        self.tried[name][0] += noticed
        self.tried[name][1] += 1

    def build_sound(self, build):
        """Build, or take what an earlier run has built of the same sources."""
        kept = build.place + ".sound"
        name, stamp = os.path.join(kept, "stamp"), build.stamp()
        if os.path.exists(name) and open(name, encoding="utf-8").read() == stamp:
            self.make_sound(build)
            return
        shutil.rmtree(kept, ignore_errors=True)
        build.all()
        shutil.copytree(build.place, kept)
        with open(name, "w", encoding="utf-8") as out:
            out.write(stamp)

    @staticmethod
    def make_sound(build):
        """Put back what a change has built: faster than to build it again."""
        for folder, _, names in os.walk(build.place + ".sound"):
            for name in names:
                kept = os.path.join(folder, name)
                used = build.place + kept[len(build.place + ".sound"):]
                if not os.path.exists(used) or os.stat(used).st_mtime_ns != os.stat(kept).st_mtime_ns:
                    shutil.copy2(kept, used)

    @staticmethod
    def read_coverage():
        """(file, line) -> names of the stages that run it; empty if it was never measured."""
        name = os.path.join(workshop.TOP, "build", "coverage", "lines.json")
        if not os.path.exists(name):
            return {}
        return {(file, line): set(stages) for file, line, stages in json.load(open(name, encoding="utf-8"))}

    def try_out(self, source, text, change):
        """None if the change is none; else the name of the stage that notices it, or an empty word."""
        number, column, old, new, _ = change
        lines = text.split("\n")
        lines[number - 1] = lines[number - 1][:column] + new + lines[number - 1][column + len(old):]
        path = os.path.join(self.tree, source)
        before = machine_code(self.release, source), self.release.interface(source)
        changed, self.why = [], ""
        try:
            with open(path, "w", encoding="utf-8") as out:
                out.write("\n".join(lines))
            try:
                changed.append(self.release)
                self.release.update(source)
                if (machine_code(self.release, source), self.release.interface(source)) == before:
                    return None
                if self.debug is not self.release:
                    changed.append(self.debug)
                    self.debug.update(source)
            except workshop.BuildFailed:
                return None
            ran = self.runs.get((source, number))
            for stage in sorted(self.stages, key=lambda s: -self.power(s.name)):
                if ran is not None and stage.name in self.measured and stage.name not in ran:
                    continue
                if self.quick and is_far(stage.name, source) or self.near and not concerns(stage.name, source):
                    continue
                if "quad" in stage.needs and self.quad not in changed:
                    changed.append(self.quad)
                    self.quad.update(source)
                sound = stage.run(self.tree, SLACK + PATIENCE*self.seconds[stage.name])
                self.learn(stage.name, not sound)
                if not sound:
                    self.why = first_failure(stage.output)
                    return stage.name
            return ""
        finally:
            with open(path, "w", encoding="utf-8") as out:
                out.write(text)
            for build in changed:
                self.make_sound(build)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", default="", help="only sources whose path begins so, as src/picture; several: src/cam,src/proof")
    parser.add_argument("--report", action="store_true", help="print what the run so far has found, run nothing")
    parser.add_argument("--again", action="store_true", help="only what the run so far has missed, with the tests of today")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--near", action="store_true")
    parser.add_argument("--nice", type=int, default=10)
    options = parser.parse_args()
    options.folders = tuple(options.folder.split(","))
    for folder in options.folders if options.folder else ():
        if not folder.startswith(("src/", "app/")) or not glob.glob(os.path.join(workshop.TOP, folder + "*")):
            parser.error("no source's path begins with '%s'" % folder)
    os.nice(options.nice)
    os.makedirs(PLACE, exist_ok=True)
    results = os.path.join(PLACE, "seed-%d%s.jsonl" % (options.seed, options.folder.replace("/", "-")))
    done = []
    if os.path.exists(results):
        done = [json.loads(line) for line in open(results, encoding="utf-8")]
    if options.again:
        done = again(options, results, done)
    elif not options.report:
        done = run(options, results, done)
    for entry in done:
        if entry["noticed"] == "":
            print("missed: %(file)s:%(line)d: %(old)s -> %(new)s   %(text)s" % entry)
    real = [entry for entry in done if entry["noticed"] is not None]
    noticed = sum(entry["noticed"] != "" for entry in real)
    print("%d noticed, %d missed" % (noticed, len(real) - noticed))
    return noticed < LEAST/100.0*len(real)


def tell(entry):
    print("-- %(file)s:%(line)d %(old)s -> %(new)s: %(noticed)s (%(seconds).0f s)" % dict(entry, noticed={
        None: "no change", "": "MISSED"}.get(entry["noticed"], entry["noticed"])), file=sys.stderr, flush=True)


def again(options, results, done):
    """Changes that were missed, found by the text of their line; what is no longer there stays as it was."""
    trial = Trial(options)
    for entry in done:
        path = os.path.join(trial.tree, entry["file"])
        if entry["noticed"] != "" or not os.path.exists(path):
            continue
        text = open(path, encoding="utf-8").read()
        lines = text.split("\n")
        places = sorted((abs(n - entry["line"]), n) for n, line in enumerate(lines, 1) if line.strip() == entry["text"])
        if not places:
            continue
        number = places[0][1]
        column = entry["column"] + len(lines[number - 1]) - len(lines[number - 1].lstrip())
        began = time.monotonic()
        entry["noticed"] = trial.try_out(entry["file"], text, (number, column, entry["old"], entry["new"], 1.0))
        entry["seconds"], entry["why"] = round(time.monotonic() - began, 1), trial.why
        tell(entry)
        with open(results, "w", encoding="utf-8") as out:
            out.writelines(json.dumps(e) + "\n" for e in done)
    return done


def run(options, results, done):
    trial = Trial(options)
    generator = random.Random(options.seed)
    sources = [s for s in trial.release.order
               if s.endswith("90") and s.startswith(("src/", "app/")) and s.startswith(options.folders)]
    texts = {s: open(os.path.join(trial.tree, s), encoding="utf-8").read() for s in sources}
    everything = [(s, site) for s in sources for site in sites(s, texts[s])]
    weights = [site[4] for _, site in everything]
    drawn = 0
    while sum(entry["noticed"] is not None for entry in done) < options.count:
        source, change = generator.choices(everything, weights)[0]
        drawn += 1
        if drawn <= len(done):
            continue
        began = time.monotonic()
        noticed = trial.try_out(source, texts[source], change)
        line = texts[source].split("\n")[change[0] - 1]
        entry = {"file": source, "line": change[0], "column": change[1] - (len(line) - len(line.lstrip())), "old": change[2],
                 "new": change[3], "noticed": noticed, "text": line.strip(), "seconds": round(time.monotonic() - began, 1), "why": trial.why}
        done.append(entry)
        with open(results, "a", encoding="utf-8") as out:
            out.write(json.dumps(entry) + "\n")
        tell(entry)
    return done


if __name__ == "__main__":
    sys.exit(main())
