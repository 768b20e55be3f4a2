#!/usr/bin/env python3
"""Random input for psalm, kalm and balm: whatever they are given, they must end in good order.

usage: fuzz.py PROGRAM_DIRECTORY [--count N | --minutes M] [--seed S] [--timeout SECONDS] [--keep DIRECTORY]
       fuzz.py PROGRAM_DIRECTORY --again FILE.nml PROGRAM

Inputs grow from data/*.nml by changes that know the notation (groups, items, subscripts, values, repeat counts; the names
are those of doc/manual.md) and by changes of bytes. Input k of seed S is always the same. Of every run is asked:
  exit status 0 to 3, no signal, an end within the time limit; no words of the run-time, a sanitizer's or the thread library;
  with status 0 no NaN, infinity or stars in listing and devices; with status 2 or 3 a message, with 2 no other file (but
  the pictures of balm, which tell it);
  no file but the promised ones, at most 64 MiB in all; SVG is XML, the page's data are JSON.
An input that fails is made smaller while it fails in the same way, and kept (build/fuzz). The last line is N passed, N failed.
"""
import argparse
import glob
import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree

TOP = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAMS = ["psalm"]*6 + ["kalm"]*2 + ["balm"]*2
MOST_BYTES = 64*2**20
MOST_MEMORY = 4*2**30            # bytes of address space; an input that wants more gets the message for it
ALIEN_WORDS = re.compile(rb"Fortran runtime|At line \d+ of file|[Bb]acktrace|Error termination|Program received signal|"
                         rb"libgomp:|runtime error:|AddressSanitizer|LeakSanitizer|terminate called|Segmentation|Aborted|"
                         rb"IEEE_[A-Z]|\bSTOP\b")
NO_NUMBER = re.compile(rb"(?<![\w.])[-+]?(?:NaN|Inf|Infinity)(?![\w.])|\*{4,}")
PROMISED = re.compile(r"case(\.kalm)?\.(dev[12789]|csv)|case(\.\d+)?\.(svg|html|(?:flat\.)?dxf)|case\.nml")
# items that say how much is to be done: a valid large value would be a long run, no fault
WORK = {"NITER", "NSTART", "NTRIAL", "NBEST", "MAXEVAL", "FIRST", "MAXTIME"}
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
TITLES = ["", " ", "&LINKS", "T"*80, "T\u00e4\u00df", "\x1b[31m", "</script><b>", "]]>", "'", '"', "!", "/", "a\tb", "-->"]
BYTES = [b"\x00", b"\r", b"\n", b"\t", b"&", b"'", b"=", b",", b"*", b"(", b"\xff\xfe", b"\xef\xbb\xbf"]


def read_names():
    """Items of every group, from the tables of the manual."""
    names, group = {}, None
    for line in open(os.path.join(TOP, "doc", "manual.md"), encoding="utf-8"):
        mentioned = re.findall(r"&([A-Z]{4,})", line)
        if mentioned and not line.startswith("|"):
            group = mentioned[-1]
        cells = [c.strip() for c in line.split("|")]
        if group and line.startswith("|") and len(cells) == 5 and re.fullmatch(r"[A-Z]\w*(, [A-Z]\w*)*", cells[1]):
            names.setdefault(group, []).extend(cells[1].split(", "))
    for needed in ("LINKS", "METHOD", "LIMITS", "SEARCH", "CONSTR", "TOLER", "RATES"):
        if len(names.get(needed, [])) < 3:
            raise SystemExit("the manual's table of &%s is not understood" % needed)
    return names


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
        self.names = read_names()
        files = sorted(glob.glob(os.path.join(TOP, "data", "*.nml")) + glob.glob(os.path.join(TOP, "data", "hard", "*.nml")))
        self.seeds = [c for c in (parse(open(f, encoding="utf-8").read()) for f in files) if c]
        if len(self.seeds) < len(files) - 2:
            raise SystemExit("seeds of data/ are not understood")

    def make(self, seed, k):
        """Program and input number k of a seed."""
        r = random.Random("%d/%d" % (seed, k))
        program = r.choice(PROGRAMS)
        cases = [[title, [[g, [Item(i.name, i.subscript, list(i.values)) for i in items]] for g, items in groups]]
                 for title, groups in r.choice(self.seeds)]
        self.shorten(cases, r)
        for _ in range(r.choice([0, 1, 1, 2, 3, 5, 8])):
            self.change(cases, r)
        data = render(cases, r).encode("utf-8", "surrogatepass")
        if r.random() < 0.25:
            data = self.change_bytes(data, r)
        return program, data

    @staticmethod
    def shorten(cases, r):
        """Little work to do: what is looked for does not need a long search."""
        small = {"NITER": 60, "NSTART": 3, "NTRIAL": 50, "NBEST": 3}
        for _, groups in cases:
            for name, items in groups:
                for item in items:
                    if item.name in small and item.values and item.values[0].isdigit():
                        item.values = [str(min(int(item.values[0]), small[item.name]))]
                if name == "SEARCH":
                    items.append(Item("MAXTIME", "", ["0.2"]))

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
            known = self.names.get(group[0]) or r.choice(list(self.names.values()))
            name = r.choice(known) if r.random() < 0.97 else r.choice(known)[:-1] + r.choice("XS0_")
            values = [value_for(name, r) for _ in range(r.choice([1, 1, 1, 2, 4, 8]))]
            items.insert(r.randint(0, len(items)), Item(name, r.choice(SUBSCRIPTS) if r.random() < 0.15 else "", values))
        elif kind < 0.68 and item:
            r.choice([lambda: items.remove(item), lambda: items.append(item), lambda: item.values.clear(),
                      lambda: item.values.append(value_for(item.name, r)), lambda: item.values.extend(item.values*r.choice([1, 3, 40])),
                      lambda: item.values and item.values.pop(r.randrange(len(item.values))),
                      lambda: r.shuffle(item.values)])()
        elif kind < 0.72 and item:
            item.subscript = r.choice(SUBSCRIPTS)
        elif kind < 0.84:
            name = r.choice(["SEARCH", "CONSTR", "TOLER", "RATES", "LIMITS", "USER", "EXTRA"])
            known = self.names.get(name, ["A", "B"])
            groups.insert(r.randint(0, len(groups)), [name, [Item(n, "", [value_for(n, r) for _ in range(r.choice([1, 1, 4]))])
                                                             for n in r.sample(known, r.randint(1, min(4, len(known))))]])
            if name == "SEARCH":
                groups[-1][1].append(Item("MAXTIME", "", ["0.2"]))
        elif kind < 0.88:
            r.choice([lambda: groups.remove(group), lambda: groups.append(group), lambda: r.shuffle(groups)])()
        elif kind < 0.94:
            other = r.choice(r.choice(self.seeds))[1]
            name, its = r.choice(other)
            groups[groups.index(group)] = [name, [Item(i.name, i.subscript, list(i.values)) for i in its]]
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
    """Device 9 without its desired columns (between prescribed positions nothing is desired) and without the rows that do not
    close (between them the linkage need not): NaN stands there."""
    keep, out = None, []
    for line in text.split(b"\n"):
        words = line.split()
        if line.startswith(b"# input"):
            keep = [k for k, name in enumerate(words[1:]) if not name.startswith(b"desired")]
        elif words[1:2] == [b"0"] and not line.startswith(b"#"):
            continue
        elif words and keep and not line.startswith(b"#"):
            out += [words[k] for k in keep if k < len(words)]
    return b" ".join(out)


class Runner:
    def __init__(self, programs, timeout):
        self.programs, self.timeout = os.path.abspath(programs), timeout
        self.statuses = {}
        sanitized = subprocess.run(["nm", "-D", os.path.join(self.programs, "psalm")], capture_output=True, check=False).stdout
        self.memory = None if b"__asan" in sanitized else MOST_MEMORY

    def start(self):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (4*MOST_BYTES, 4*MOST_BYTES))
        if self.memory:
            resource.setrlimit(resource.RLIMIT_AS, (self.memory, self.memory))

    def fault(self, program, data, count=False):
        """What is wrong with a run, in a few words; empty if nothing."""
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "case.nml"), "wb") as out:
                out.write(data)
            with open(os.path.join(folder, ".listing"), "wb") as listing, open(os.path.join(folder, ".errors"), "wb") as errors:
                process = subprocess.Popen([os.path.join(self.programs, program), "case.nml"], cwd=folder,
                                           stdin=subprocess.DEVNULL, stdout=listing, stderr=errors, preexec_fn=self.start,
                                           start_new_session=True)
                try:
                    status = process.wait(self.timeout)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
                    return "no end within %.0f seconds" % self.timeout
            if count:
                self.statuses[program, status] = self.statuses.get((program, status), 0) + 1
            return self.look(folder, program, status)

    @staticmethod
    def look(folder, program, status):
        content = {name: open(os.path.join(folder, name), "rb").read() for name in sorted(os.listdir(folder))}
        listing, errors = content.pop(".listing"), content.pop(".errors")
        if status < 0:
            return "killed by signal %d" % -status
        if status > 3:
            return "exit status %d" % status
        alien = ALIEN_WORDS.search(errors) or ALIEN_WORDS.search(listing)
        if alien:
            return "words of a library: " + alien.group().decode("ascii", "replace")
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
                if name.endswith(".dev9"):
                    text = without_desired(text)
                # the first line of a table has names, the user's among them
                found = NO_NUMBER.search(re.sub(rb"(?m)^input,.*$", b"", text) if name.endswith(".csv") else text)
                if found:
                    return "status 0, but %s in %s" % (found.group().decode(), name)
        for name, text in made.items():
            try:
                if name.endswith(".svg"):
                    ElementTree.fromstring(text)
                elif name.endswith(".html"):
                    data = re.search(rb'<script type="application/json" id="data">(.*?)</script>', text, re.S)
                    json.loads(data.group(1))
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=600)
    parser.add_argument("--minutes", type=float)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=30.0)
    parser.add_argument("--keep", default=os.path.join(TOP, "build", "fuzz"))
    parser.add_argument("--again", nargs=2, metavar=("FILE", "PROGRAM"))
    options = parser.parse_args()
    runner = Runner(options.programs, options.timeout)
    if options.again:
        fault = runner.fault(options.again[1], open(options.again[0], "rb").read())
        print(fault or "nothing wrong")
        return fault != ""
    generator = Generator()
    began, k, failed, known = time.monotonic(), 0, 0, {}
    while time.monotonic() - began < 60.0*options.minutes if options.minutes else k < options.count:
        program, data = generator.make(options.seed, k)
        fault = runner.fault(program, data, count=True)
        if fault:
            failed += 1
            known.setdefault((program, fault), []).append(k)
            if len(known[program, fault]) == 1:
                os.makedirs(options.keep, exist_ok=True)
                name = os.path.join(options.keep, "%s-%d-%d.nml" % (program, options.seed, k))
                with open(name, "wb") as out:
                    out.write(runner.smaller(program, data, fault))
                print("FAILED: %s, input %d of seed %d: %s; kept as %s" % (program, k, options.seed, fault, name), flush=True)
        k += 1
    for (program, fault), inputs in known.items():
        print("%d times: %s: %s (inputs %s)" % (len(inputs), program, fault, " ".join(map(str, inputs[:10]))))
    print("%d inputs in %.0f seconds; by exit status: %s" % (k, time.monotonic() - began, ", ".join(
        "%s %d: %d" % (program, status, n) for (program, status), n in sorted(runner.statuses.items()))))
    print("%d passed, %d failed" % (k - failed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
