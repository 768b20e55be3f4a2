#!/usr/bin/env python3
"""Random input for all seven programs: whatever they are given, they must end in good order.

usage: fuzz.py PROGRAM_DIRECTORY [--count N | --minutes M] [--jobs J] [--seed S] [--timeout SECONDS] [--keep DIRECTORY]
       fuzz.py PROGRAM_DIRECTORY --again FILE.nml 'PROGRAM OPTIONS'

Inputs grow from data/**/*.nml by changes that know the notation (groups, items, subscripts, values, repeat counts; the names
are those of tools/editors/psalm.schema.json) and by changes of bytes; a tenth is turned into JSON. Input k of seed S is always the same,
whatever the number of jobs. Of every run is asked:
  exit status 0 to 3, no signal, an end within the time limit; no words of the run-time, a sanitizer's or the thread library;
  with status 0 no NaN, infinity or stars in listing and devices; with status 2 or 3 a message, with 2 no other file (but
  the pictures of balm, which tell it);
  no file but the promised ones, at most 64 MiB in all; SVG is XML, JSON is JSON, in the pages too.
An input that fails is made smaller while it fails in the same way, and kept (build/fuzz). The last line is N passed, N failed.

A program is loaded once for each way of calling it and forks a child for every input (tools/testing/fork_server.c, compiled by gcc);
files are in memory (/dev/shm). So a million inputs are a matter of hours, not of days.
"""
import argparse
import glob
import json
import multiprocessing
import os
import queue
import random
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# ways of calling the programs; how often, of 24 inputs
CALLS = {"psalm": 6, "psalm --json": 1, "psalm --assemblies": 1, "psalm --links": 1, "kalm": 3, "kalm --json": 1, "ssics --json": 1, "bridge --json": 1, "calm --json": 1, "balm": 3,
         "balm --assemblies": 1, "balm --edit": 1, "muscle": 1, "muscle --json": 1, "ssics": 1, "bridge": 1, "calm": 2}
OWN_SEEDS = {"muscle": "muscle", "calm": "calm", "ssics": "ssics", "bridge": "bridge"}   # folders of data/
JSON_INPUTS = 0.1                # part of the inputs that is JSON
CHUNK = 200                      # inputs that a job takes at a time
SERVER = os.path.join(TOP, "tools", "testing", "fork_server.c")
REQUESTS, ANSWERS = 198, 199     # descriptors, as in fork_server.c
MOST_BYTES = 64*2**20
MOST_MEMORY = 4*2**30            # bytes of address space; an input that wants more gets the message for it
ALIEN_WORDS = re.compile(rb"Fortran runtime|At line \d+ of file|[Bb]acktrace|Error termination|Program received signal|"
                         rb"libgomp:|runtime error:|AddressSanitizer|LeakSanitizer|terminate called|Segmentation|Aborted|"
                         rb"IEEE_[A-Z]|^(?:ERROR )?STOP\b")     # asked of a line
NO_NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:NaN|Inf|Infinity)(?![\w.])|\*{4,}")
# words one of which stands in whatever these find: asked first, because that takes a tenth of the time
ALIEN_SIGNS = (b"untime", b"At line", b"acktrace", b"Error term", b"Program rec", b"libgomp", b"Sanitizer", b"terminate", b"Segment",
               b"Aborted", b"IEEE_", b"STOP")
NO_NUMBER_SIGNS = (b"NaN", b"Inf", b"****")
PROMISED = re.compile(r"case(\.(kalm|muscle|ssics|bridge|calm))?\.(dev[12789]|json)|case(\.(kalm|muscle|ssics|bridge|calm))?(-\d+)?(\.[a-z_]+\d*)?\.csv|case\.(nml|edit\.html)|"
                      r"case(\.(ssics|bridge|calm|tolerances|phase))?([-.]\d+)?\.(svg|html|nc|(?:flat\.)?dxf)|case([-.]\d+)?\.mode-\d+-\d+\.svg")
# data sets that take more than 0.1 s in one of the programs, and how often they are drawn, of once
COSTLY = {"five_bar_cams", "needle_cam", "conjugate_cams", "knuckle_press", "measured_table", "swinging_roller", "yoke", "wedge_cam",
          "stephenson3_rod_driven", "rig_coupler", "link_loads", "drive_loads", "chain64", "pruned64", "carried_slides",
          "haines_springs", "four_bar_haines"}
RARELY = 0.1
# items that say how much is to be done: a valid large value would be a long run, no fault
WORK = {"NITER", "NVERT", "NSTART", "NTRIAL", "NBEST", "MAXEVAL", "FIRST", "MAXTIME", "NSWEEP", "NGRID", "NSUB", "NTURN", "NWSTRT",
        "NSSTRT", "NPHASE", "NBUDGT", "NFRONT", "NVCHRT", "NVPNT", "NVSPED", "NDPNT", "NDSPED", "NCPNT", "NCSPED", "NCRAD", "NCANG",
        "THREADS"}
INTEGERS = ["0", "1", "-1", "2", "3", "-2", "7", "12", "99", "100", "1000", "-1000", "32768", "65536", "2147483647", "2147483648",
            "-2147483648", "1073741825", "99999999999999999999"]
REALS = ["0.0", "1.0", "-1.0", "0.5", "1E-5", "1E-150", "4.9E-324", "1E-300", "257.0", "90.0", "180.0", "-180.0", "360.0",
         "1E5", "1E15", "1E30", "1E300", "-1E300", "1.7976931348623157E308", "1E309", ".5", "5.", "1D3", "1.5E+02", "0.1E",
         "1E1E1", "NaN", "Inf", "-Infinity"]
TEXTS = ["'SIMPLEX'", "'LSQ'", "'LD_SLSQP'", "'LN_COBYLA'", "'GN_CRS2_LM'", "'LN_BOBYQA'", "'GD_STOGO'", "'RAD/S'", "'DEG/S'",
         "'REV/MIN'", "'LENGTH/S'", "''"]
ODDITIES = TEXTS + [
    "'", '"', "'A''B'", "LSQ", "T", ".TRUE.", "*", "3*", "*3", "0*1", "2*", "1000000*1.0", "999999999999*1", ",", ";", "=", "&",
    "$", "/", "(", ")", "!", "1 2", "1;2", "<b>&amp;", "]]>", "\\", "\x00", "\x7f", "\u00e9", "\u2028"]
SUBSCRIPTS = ["(1)", "(2)", "(0)", "(-1)", "(1,1)", "(2,1)", "(2,3)", "(1,2,3)", "(1073741825,1)", "(99999999999)", "(2 7)",
              "(2:)", "(:)", "(", "()", "(1.5)", "(A)", " (1)"]
TITLES = ["", " ", "STOP", "&LINKS", "T"*80, "T\u00e4\u00df", "\x1b[31m", "</script><b>", "]]>", "'", '"', "!", "/", "a\tb", "-->"]
BYTES = [b"\x00", b"\r", b"\n", b"\t", b"&", b"'", b"=", b",", b"*", b"(", b"\xff\xfe", b"\xef\xbb\xbf"]


def read_names():
    """Items of every group, from the schema that the programs write."""
    with open(os.path.join(TOP, "tools", "editors", "psalm.schema.json"), encoding="utf-8") as file:
        groups = json.load(file)["$defs"]["case"]["properties"]
    names = {}
    for name, group in groups.items():
        numbered = [pattern[1:pattern.index("[")] + n for pattern in group.get("patternProperties", {}) for n in "12"]
        if "properties" in group:
            names[name] = sorted([*group["properties"], *numbered])
    return names, sorted(set().union(*names.values()))


class Item:
    def __init__(self, name, subscript, values):
        self.name, self.subscript, self.values = name, subscript, values


def parse(text):
    """A well-formed file as [title, [[group, [Item]]]] for each case; comments are left out."""
    lines = [re.sub(r"^((?:[^'!]|'[^']*')*)!.*", r"\1", line) for line in text.split("\n")]
    cases, rest = [], "\n".join(lines).strip("\n")
    while rest.strip():
        title, _, rest = rest.partition("\n")
        groups = []
        while True:
            head = re.match(r"\s*[&$](\w+)", rest)
            if not head or head.group(1).upper() == "END":
                break
            body, _, rest = re.split(r"([&$]END\b|/(?=\s*(?:\n|$|&)))", rest[head.end():], maxsplit=1, flags=re.I)
            pieces = re.split(r"([A-Za-z]\w*)\s*(\([^)]*\))?\s*=", body)
            items = [Item(pieces[i].upper(), pieces[i + 1] or "", re.findall(r"'[^']*'|[^\s,]+", pieces[i + 2]))
                     for i in range(1, len(pieces), 3)]
            groups.append([head.group(1).upper(), items])
        if not groups:
            break
        cases.append([title, groups])
        rest = rest.strip("\n")
    return cases


def render(cases, r):
    """Text of the cases; now and then in a notation that is less usual."""
    out = []
    for title, groups in cases:
        out.append(title)
        for name, items in groups:
            end = "&END" if r.random() < 0.95 else r.choice(["/", "$END", "&end", "", "&END &END", "&EN", "/ /"])
            words = []
            for item in items:
                equal = "=" if r.random() < 0.99 else r.choice([" = ", "==", "", ":", "=,"])
                words.append(item.name + item.subscript + equal + ",".join(item.values))
            glue = ",\n  " if r.random() < 0.9 else r.choice([" ", "\n", ",, ", "\t", ", ! note\n"])
            out.append(" &%s %s %s" % (name, glue.join(words), end))
    return "\n".join(out) + ("\n" if r.random() < 0.97 else "")


def json_value(word, r):
    """One value as JSON; what NAMELIST repeats is repeated."""
    times, _, rest = word.partition("*")
    if rest and times.isdigit() and not word.startswith("'"):
        return ",".join([json_value(rest, r)]*min(int(times), 100)) or "null"
    if re.fullmatch(r"-?(0|[1-9]\d*)(\.\d+)?([eE][-+]?\d+)?", word) or r.random() < 0.02:
        return word
    if re.fullmatch(r"[-+]?(\d+\.?|\d*\.\d+)([EDed][-+]?\d+)?", word):
        return repr(float(word.replace("D", "E").replace("d", "e")))     # as 5. or .5, which JSON does not know
    return json.dumps(word.strip("'"))


def render_json(cases, r):
    """The cases as JSON; now and then in one that is none."""
    texts = []
    for title, groups in cases:
        parts = ['"title":' + json.dumps(title, ensure_ascii=r.random() < 0.5)]
        for name, items in groups:
            written = []
            for item in items:
                values = ",".join(json_value(value, r) for value in item.values)
                if len(item.values) != 1 or r.random() < 0.1:
                    values = "[%s]" % values
                rows = re.fullmatch(r"\((\d),\d\)", item.subscript)
                if rows:
                    values = "[%s[%s]]" % ("[]," * (int(rows.group(1)) - 1), values.strip("[]"))
                written.append('"%s":%s' % (item.name, values if r.random() < 0.98 else r.choice(["null", "true", "{}", "[]", "[[[1]]]", "\"\\ud800\""])))
            parts.append('"%s":{%s}' % (name, ",\n".join(written)))
        texts.append("{%s}" % ",\n ".join(parts))
    return texts[0] if len(texts) == 1 and r.random() < 0.9 else "[%s]" % ",".join(texts)


def value_for(name, r):
    """A value for an item: mostly of its kind (Fortran's rule of the first letter), now and then of none."""
    if name in ("SOLVER", "UNITS"):
        return r.choice(TEXTS)
    if name in WORK:
        return r.choice(["0", "1", "2", "5", "20", "-1", "2147483648", "x", "1.5"])
    kind = r.random()
    if kind < 0.03:
        return r.choice(ODDITIES)
    if (name[0] in "IJKLMN") == (kind < 0.9):
        return r.choice(INTEGERS) if r.random() < 0.6 else str(r.randint(-6, 12))
    return r.choice(REALS) if r.random() < 0.4 else "%.*g" % (r.randint(1, 17), r.uniform(-400, 400))


def change_value(name, value, r):
    if name in WORK or r.random() < 0.3:
        return value_for(name, r)
    try:
        if re.fullmatch(r"[-+]?\d+", value):
            return str(int(value) + r.choice([-2, -1, 1, 2])) if r.random() < 0.7 else str(-int(value))
        number = float(value.replace("D", "E"))
        return repr(number*r.choice([-1.0, 0.0, 0.5, 0.9, 1.1, 2.0, 1e-8, 1e8, r.uniform(0, 2)]))
    except ValueError:
        return value_for(name, r)


class Generator:
    def __init__(self):
        files = sorted(glob.glob(os.path.join(TOP, "data", "**", "*.nml"), recursive=True))
        self.seeds = [(c, os.path.basename(os.path.dirname(f)), RARELY if os.path.basename(f)[:-4] in COSTLY else 1.0)
                      for f, c in ((f, parse(open(f, encoding="utf-8").read())) for f in files) if c]
        if len(self.seeds) < len(files) - 2:
            raise SystemExit("seeds of data/ are not understood")
        self.names, self.everything = read_names()
        self.groups = sorted(self.names)
        self.values = {}
        for cases, _, _ in self.seeds:
            for _, groups in cases:
                for _, items in groups:
                    for item in items:
                        self.values.setdefault(item.name, []).append(item.values)
        self.calls = [call for call, times in CALLS.items() for _ in range(times)]

    def make(self, seed, k):
        """Call of a program and input number k of a seed."""
        r = random.Random("%d/%d" % (seed, k))
        call = r.choice(self.calls)
        own = OWN_SEEDS.get(call.split()[0])
        seeds = [seed for seed in self.seeds if seed[1] == own] if own and r.random() < 0.8 else self.seeds
        cases = [[title, [[g, [Item(i.name, i.subscript, list(i.values)) for i in items]] for g, items in groups]]
                 for title, groups in r.choices(seeds, [seed[2] for seed in seeds])[0][0]]
        self.shorten(cases, r)
        gentle = r.random() < 0.3       # numbers alone: most of these inputs are run to their end
        for _ in range(r.choice([1, 1, 2, 4] if gentle else [0, 1, 1, 1, 2, 3, 5, 8])):
            if gentle:
                self.change_number(cases, r)
            else:
                self.change(cases, r)
        way = render_json if r.random() < JSON_INPUTS else render
        data = way(cases, random.Random(1) if gentle else r).encode("utf-8", "surrogatepass")
        if not gentle and r.random() < 0.25:
            data = self.change_bytes(data, r)
        return call, data

    @staticmethod
    def change_number(cases, r):
        """One number by a part of itself, or to its negative, to zero or to an extreme."""
        items = [item for _, groups in cases for _, its in groups for item in its if item.name not in WORK]
        places = [(item, i) for item in items for i, value in enumerate(item.values)
                  if "." in value and re.fullmatch(r"[-+]?[\d.]+([ED][-+]?\d+)?", value)]
        if not places:
            return
        item, i = r.choice(places)
        try:
            number = float(item.values[i].replace("D", "E"))
        except ValueError:
            return
        factor = r.choice([1.001, 0.999, 1.01, 1.1, 0.9, 0.5, 2.0, -1.0, 0.0, 1e-6, 1e6, r.uniform(0.0, 2.0)])
        number = number*factor if number != 0.0 else r.uniform(-1.0, 1.0)
        item.values[i] = r.choice(REALS[:18]) if r.random() < 0.1 else repr(number)

    def values_for(self, name, r):
        """Values of an item: those of a data set, or new ones."""
        if name in self.values and r.random() < 0.5:
            return list(r.choice(self.values[name]))
        return [value_for(name, r) for _ in range(r.choice([1, 1, 1, 2, 4, 8]))]

    @staticmethod
    def shorten(cases, r):
        """Little work to do: what is looked for does not need a long search."""
        small = {"NITER": 60, "NVERT": 40, "NSTART": 3, "NTRIAL": 50, "NBEST": 3, "NSWEEP": 5, "NGRID": 5, "NSUB": 5, "NTURN": 5, "NWSTRT": 2,
                 "NSSTRT": 2, "NPHASE": 2, "NBUDGT": 3, "NFRONT": 3, "NVCHRT": 5, "NVPNT": 20, "NVSPED": 5, "NDPNT": 20,
                 "NDSPED": 5, "NCPNT": 50, "NCSPED": 5, "NCRAD": 5, "NCANG": 5}
        for _, groups in cases:
            for name, items in groups:
                for item in items:
                    if item.name in small and item.values and item.values[0].isdigit():
                        item.values = [str(min(int(item.values[0]), small[item.name]))]
                for item, value in {"SEARCH": [("MAXTIME", "0.1")], "EXACT": [("MAXTIME", "0.1")], "SPRNGS": [("NSSTRT", "1")],
                                    "BALANC": [("NWSTRT", "1")]}.get(name, []):
                    if item not in [other.name for other in items]:
                        items.append(Item(item, "", [value]))

    def change(self, cases, r):
        case = r.choice(cases)
        groups = case[1]
        if not groups:
            return
        group = r.choice(groups)
        items = group[1]
        item = r.choice(items) if items else None
        kind = r.random()
        if kind < 0.45 and item and item.values:
            place = r.randrange(len(item.values))
            item.values[place] = change_value(item.name, item.values[place], r)
        elif kind < 0.60:
            known = self.names.get(group[0]) or self.everything
            name = r.choice(known) if r.random() < 0.97 else r.choice(known)[:-1] + r.choice("XS0_")
            if r.random() < 0.05:
                name = r.choice(self.everything)
            place = r.choice(SUBSCRIPTS) if r.random() < 0.15 else ""
            items.insert(r.randint(0, len(items)), Item(name, place, self.values_for(name, r)))
        elif kind < 0.68 and item:
            r.choice([lambda: items.remove(item), lambda: items.append(item), lambda: item.values.clear(),
                      lambda: item.values.append(value_for(item.name, r)),
                      lambda: item.values.extend(item.values*r.choice([1, 3, 40])),
                      lambda: item.values and item.values.pop(r.randrange(len(item.values))),
                      lambda: r.shuffle(item.values)])()
        elif kind < 0.72 and item:
            item.subscript = r.choice(SUBSCRIPTS)
        elif kind < 0.84:
            name = r.choice(self.groups + ["USER"])
            known = self.names.get(name, ["A", "B"])
            new = [name, [Item(n, "", self.values_for(n, r)) for n in r.sample(known, r.randint(1, min(4, len(known))))]]
            groups.insert(r.randint(0, len(groups)), new)
            self.shorten(cases, r)
        elif kind < 0.88:
            r.choice([lambda: groups.remove(group), lambda: groups.append(group), lambda: r.shuffle(groups)])()
        elif kind < 0.94:
            other = r.choice(r.choice(self.seeds)[0])[1]
            name, its = r.choice(other)
            new = [name, [Item(i.name, i.subscript, list(i.values)) for i in its]]
            if r.random() < 0.5:
                groups[groups.index(group)] = new
            else:
                groups.append(new)
            self.shorten(cases, r)
        elif kind < 0.97:
            items.append(Item("LAST", "", ["0"]))
            cases.append([r.choice(["", "SECOND", "x"*100, "<&'\">"]), [[g, list(its)] for g, its in groups]])
        else:
            case[0] = r.choice(TITLES)

    @staticmethod
    def change_bytes(data, r):
        data = bytearray(data)
        for _ in range(r.choice([1, 1, 2, 4, 16])):
            at = r.randrange(len(data) + 1)
            to = min(len(data), at + r.choice([1, 1, 2, 8, 64]))
            r.choice([lambda: data.__delitem__(slice(at, to)),
                      lambda: data.__setitem__(slice(at, to), bytes(r.randrange(256) for _ in range(to - at))),
                      lambda: data.__setitem__(slice(at, at), bytes(data[at:to])*r.choice([1, 2, 50])),
                      lambda: data.__setitem__(slice(at, at), r.choice(BYTES)),
                      lambda: data.__delitem__(slice(at, len(data))) if r.random() < 0.3 else None])()
        if r.random() < 0.1:
            data = bytearray(bytes(data).replace(b"\n", r.choice([b"\r\n", b"\r", b" ", b"\n\n"])))
        return bytes(data)


def without_desired(text):
    """Device 9 without its desired columns (between prescribed positions nothing is desired), without the rows that do not close
    (between them the linkage need not), which blocks of a sweep have without another number, and without the amplitude of what
    is not stable: NaN stands there."""
    keep, out, block = None, [], b""
    for line in text.split(b"\n"):
        words = line.split()
        if line.startswith(b"# block"):
            block = words[2] if len(words) > 2 else b""
        if block.startswith(b"swept_") and set(words[1:]) == {b"NaN"} or block == b"drive_speeds" and words[2:] == [b"0"]:
            continue
        if line.startswith(b"# input"):
            keep = [k for k, name in enumerate(words[1:]) if not name.startswith(b"desired")]
        elif words[1:2] == [b"0"] and not line.startswith(b"#"):
            continue
        elif words and keep and not line.startswith(b"#"):
            out += [words[k] for k in keep if k < len(words)]
    return b" ".join(out)


def sought(pattern, signs, text):
    """What the pattern finds in a text; `signs`: nothing, if none of these is there."""
    return pattern.search(text) if any(sign in text for sign in signs) else None


def alien_words(text, data):
    """Words of a library in a listing or in messages; lines that stand in the input, as its titles, are the user's."""
    if any(sign in text for sign in ALIEN_SIGNS):
        for line in text.split(b"\n"):
            found = ALIEN_WORDS.search(line)
            if found and line.strip() not in data:
                return found.group().decode("ascii", "replace")
    return ""


def no_number(name):
    raise ValueError(name + " is no JSON")


class Server:
    """A program, called in one way, that is loaded once."""

    def __init__(self, call, runner):
        words = call.split()
        ask, requests = os.pipe()
        answers, reply = os.pipe()

        def start():
            os.dup2(ask, REQUESTS)
            os.dup2(reply, ANSWERS)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_FSIZE, (4*MOST_BYTES, 4*MOST_BYTES))
            if runner.memory:
                resource.setrlimit(resource.RLIMIT_AS, (runner.memory, runner.memory))

        environment = dict(os.environ, LD_PRELOAD=runner.preload, FORK_SERVER_SECONDS=str(max(1, round(runner.timeout))))
        environment["ASAN_OPTIONS"] = "verify_asan_link_order=0:detect_leaks=0:" + environment.get("ASAN_OPTIONS", "")
        self.process = subprocess.Popen([os.path.join(runner.programs, words[0]), *words[1:], "case.nml"], cwd=runner.folder,
                                        env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, preexec_fn=start, close_fds=False)
        os.close(ask)
        os.close(reply)
        self.requests, self.answers = requests, answers

    def run(self):
        """Exit status of a run, negative for a signal, None if the time limit ended it."""
        os.write(self.requests, b"r")
        answer = os.read(self.answers, 4)
        if len(answer) != 4:
            raise SystemExit("fork_server.c does not answer: is %s a program of the suite?" % self.process.args[0])
        status = struct.unpack("i", answer)[0]
        return None if status == -1 else os.waitstatus_to_exitcode(status)

    def close(self):
        os.close(self.requests)
        os.close(self.answers)
        self.process.wait()


class Runner:
    def __init__(self, programs, timeout):
        self.programs, self.timeout = os.path.abspath(programs), timeout
        self.statuses, self.servers = {}, {}
        sanitized = subprocess.run(["nm", "-D", os.path.join(self.programs, "psalm")], capture_output=True, check=False).stdout
        self.memory = None if b"__asan" in sanitized else MOST_MEMORY
        memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        self.top = tempfile.mkdtemp(prefix="fuzz-", dir=memory)
        self.folder = os.path.join(self.top, "run")
        os.mkdir(self.folder)
        self.preload = os.path.join(self.top, "fork_server.so")
        subprocess.run(["gcc", "-O1", "-shared", "-fPIC", "-o", self.preload, SERVER, "-ldl"], check=True)

    def close(self):
        for server in self.servers.values():
            server.close()
        shutil.rmtree(self.top, ignore_errors=True)

    def fault(self, call, data, count=False):
        """What is wrong with a run, in a few words; empty if nothing."""
        if call not in self.servers:
            self.servers[call] = Server(call, self)
        with open(os.path.join(self.folder, "case.nml"), "wb") as out:
            out.write(data)
        status = self.servers[call].run()
        content = {}
        for name in sorted(os.listdir(self.folder)):
            path = os.path.join(self.folder, name)
            with open(path, "rb") as file:
                content[name] = file.read()
            os.unlink(path)
        if status is None:
            return "no end within %.0f seconds of processor time" % self.timeout
        program = call.split()[0]
        if count:
            self.statuses[program, status] = self.statuses.get((program, status), 0) + 1
        return self.look(content, program, status)

    @staticmethod
    def look(content, program, status):
        listing, errors = content.pop(".listing"), content.pop(".errors")
        if status < 0:
            return "killed by signal %d" % -status
        if status > 3:
            return "exit status %d" % status
        alien = alien_words(errors, content["case.nml"]) or alien_words(listing, content["case.nml"])
        if alien:
            return "words of a library: " + alien
        if status >= 2 and not errors.strip():
            return "status %d without a message" % status
        for name in content:
            if not PROMISED.fullmatch(name):
                return "a file left behind: " + re.sub(r"\d+", "N", name)
        if sum(map(len, content.values())) + len(listing) > MOST_BYTES:
            return "more than 64 MiB written"
        made = {name: text for name, text in content.items() if name != "case.nml"}
        if status == 2:
            if program != "balm" and (made or listing):
                return "something written though the input is wrong"
        if status == 0:
            for name, text in list(made.items()) + [("listing", listing)]:
                if name.endswith((".html", ".dev8")):
                    continue
                if name.endswith(".dev7"):
                    text = re.sub(rb"&(?!LINKS|METHOD|LIMITS|SEARCH).*?&END", b"", text, flags=re.S)    # kept as they were written
                if name.endswith(".dev9") and b"NaN" in text:
                    text = without_desired(text)
                # the first line of a table has names, the user's among them; JSON has them in quotes, and is read below
                if name.endswith((".csv", ".dev9")):
                    text = re.sub(rb"(?m)^(input,|#).*$", b"", text)
                elif name.endswith(".json"):
                    text = re.sub(rb'"[^"]*"', b"", text)
                found = sought(NO_NUMBER, NO_NUMBER_SIGNS, text)
                if found and re.search(rb"NAME[^=&]*=[^&=]*" + re.escape(found.group()), content.get("case.nml", b"")):
                    found = None                        # a name of the user's
                if found:
                    return "status 0, but %s in %s" % (found.group().decode(), name)
        for name, text in made.items():
            try:
                if name.endswith(".svg"):
                    ElementTree.fromstring(text)
                elif name.endswith(".json"):
                    json.loads(text, parse_constant=no_number)
                elif name.endswith(".html"):
                    data = re.search(rb'<script type="application/json" id="data">(.*?)</script>', text, re.S)
                    json.loads(data.group(1), parse_constant=no_number)
            except (ElementTree.ParseError, ValueError, AttributeError) as error:
                return "%s is not well-formed: %s" % (name.split(".")[-1], type(error).__name__)
        return ""

    def smaller(self, program, data, fault, tries=400):
        """The input with parts left out, as long as it fails in the same way."""
        separators = [b"\n", b",", b" "]
        for separator in separators:
            parts = data.split(separator)
            length = max(1, len(parts)//2)
            while length >= 1 and tries > 0:
                at = 0
                while at < len(parts) and tries > 0:
                    shorter = separator.join(parts[:at] + parts[at + length:])
                    tries -= 1
                    if shorter != data and self.fault(program, shorter) == fault:
                        parts, data = parts[:at] + parts[at + length:], shorter
                    else:
                        at += length
                length //= 2
        return data


def job(number, options, end, results):
    """One of several jobs, with its share of the chunks: number, statuses and faults of each go into the queue, None ends it."""
    os.nice(5)
    generator, runner = Generator(), Runner(options.programs, options.timeout)
    first = number*CHUNK
    while time.monotonic() < end if end else first < options.count:
        runner.statuses, faults, done = {}, [], 0
        for k in range(first, first + CHUNK if end else min(first + CHUNK, options.count)):
            if end and time.monotonic() > end:
                break
            call, data = generator.make(options.seed, k)
            fault = runner.fault(call, data, count=True)
            done += 1
            if fault:
                faults.append((call, k, fault))
        results.put((done, runner.statuses, faults))
        first += options.jobs*CHUNK
    runner.close()
    results.put(None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=600)
    parser.add_argument("--minutes", type=float)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=30.0, help="seconds of processor time for a run")
    parser.add_argument("--keep", default=os.path.join(TOP, "build", "fuzz"))
    parser.add_argument("--again", nargs=2, metavar=("FILE", "CALL"))
    options = parser.parse_args()
    runner = Runner(options.programs, options.timeout)
    try:
        if options.again:
            fault = runner.fault(options.again[1], open(options.again[0], "rb").read())
            print(fault or "nothing wrong")
            return fault != ""
        return campaign(options, runner)
    finally:
        runner.close()


def campaign(options, runner):
    generator, known, statuses, done = Generator(), {}, {}, 0
    began = told = time.monotonic()
    end = began + 60.0*options.minutes if options.minutes else None
    results = multiprocessing.Queue()
    jobs = [multiprocessing.Process(target=job, args=(j, options, end, results), daemon=True) for j in range(options.jobs)]
    for one in jobs:
        one.start()
    left = len(jobs)
    while left:
        try:
            part = results.get(timeout=5.0)
        except queue.Empty:
            if any(one.exitcode for one in jobs):
                raise SystemExit("a job of the campaign broke off") from None
            continue
        if part is None:
            left -= 1
            continue
        done += part[0]
        for key, number in part[1].items():
            statuses[key] = statuses.get(key, 0) + number
        for call, k, fault in part[2]:
            known.setdefault((call.split()[0], fault), []).append(k)
            if len(known[call.split()[0], fault]) == 1:
                keep(options, generator, runner, k, fault)
        if time.monotonic() > told + 60.0:
            told = time.monotonic()
            print("%d inputs, %.0f a second" % (done, done/(told - began)), file=sys.stderr, flush=True)
    failed = sum(map(len, known.values()))
    for (program, fault), inputs in known.items():
        print("%d times: %s: %s (inputs %s)" % (len(inputs), program, fault, " ".join(map(str, inputs[:10]))))
    seconds = time.monotonic() - began
    print("by exit status: " + ", ".join("%s %d: %d" % (program, status, n) for (program, status), n in sorted(statuses.items())))
    print("%d inputs in %.0f seconds, %.0f a second by %d jobs" % (done, seconds, done/seconds, options.jobs))
    print("%d passed, %d failed" % (done - failed, failed))
    return failed > 0


def keep(options, generator, runner, k, fault):
    """The input, made smaller, in a file."""
    call, data = generator.make(options.seed, k)
    os.makedirs(options.keep, exist_ok=True)
    name = os.path.join(options.keep, "%s-%d-%d.nml" % (call.replace(" ", ""), options.seed, k))
    if not fault.startswith("no end"):      # each try would take the whole time
        data = runner.smaller(call, data, fault)
    with open(name, "wb") as out:
        out.write(data)
    print("FAILED: %s, input %d of seed %d: %s; kept as %s" % (call, k, options.seed, fault, name), flush=True)


if __name__ == "__main__":
    sys.exit(main())
