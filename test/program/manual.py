#!/usr/bin/env python3
"""The messages that the book shows are those of the program.

usage: test/program/manual.py PROGRAM_DIRECTORY. doc/reference/messages.md has a case in a fenced block and a table: what
is in the case, what is written instead, the message. Each change is made and the message compared. The pages on trouble have every
message that a run gives of its results, by the sources, and no other. The guide by tasks begins with data sets that there are.
Last line: N passed, N failed.
"""
import glob
import os
import re
import subprocess
import sys
import tempfile

top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

LEAST = 14     # letters of a message that tell it from others
ANY = "\0"     # what a message has of numbers and names


def read(*path):
    with open(os.path.join(top, *path), encoding="utf-8") as file:
        return file.read()


def statements():
    """Of every statement of the sources: whether it gives a message of results, and its literals with ANY between them."""
    for path in glob.glob("src/**/*.f90", root_dir=top, recursive=True) + glob.glob("app/*.f90", root_dir=top):
        for line in re.sub(r"&[ \t]*(?:![^\n']*)?\n(?:\s*!.*\n)*\s*&?", "", read(path)).split("\n"):
            gives = re.search(r"%(?:remark|warning)\s*\(", line)
            if "'" in line and '"//' not in line and not line.lstrip().startswith("!"):
                parts = re.split(r"'((?:[^']|'')*)'", line[gives.end():] if gives else line)
                words = "".join(ANY if i % 2 == 0 and part.strip() != "//" else "" if i % 2 == 0 else part.replace("''", "'")
                                for i, part in enumerate(parts))
                yield bool(gives), words, path


def wrong_in_trouble():
    """Messages that the pages on trouble lack, and those that no program gives; the number of messages looked at."""
    pages = read("doc", "reference", "troubleshooting.md") + read("doc", "reference", "troubleshooting_machines.md")
    shown = [message for row in re.findall(r"^\| (`.*?) \|", pages, re.M) for message in re.findall(r"`(.*?)`", row)]
    parts = [part.strip() for message in shown for part in message.split("...") if len(part.strip()) >= LEAST]
    every = list(statements())
    texts = [words for _, words, _ in every]
    wrong = ["no program says '%s'" % part for part in parts if not any(part in text for text in texts)]
    given = 0
    for gives, words, path in every:
        longest = max(words.split(ANY), key=len).strip()
        if gives and len(longest) >= LEAST and " " in longest:
            given += 1
            if not any(longest in message or any(len(part.strip()) >= LEAST and part.strip() in longest for part in message.split("..."))
                       for message in shown):
                wrong.append("'%s' of %s is on no page" % (longest, path))
    return wrong, given + len(parts)


def without_data():
    names = re.findall(r"`([\w/]+)`", " ".join(re.findall(r"^\|.*?\|.*?\| (.*?) \|", read("doc", "guide", "tasks.md").split("## Which program")[0], re.M)))
    return ["data/%s.nml of doc/guide/tasks.md is not there" % name for name in names
            if not os.path.exists(os.path.join(top, "data", name + ".nml"))], len(names)


def main():
    psalm = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
    with open(os.path.join(top, "doc", "reference", "messages.md"), encoding="utf-8") as file:
        chapter = file.read()
    case = re.search(r"```\n(.*?)```", chapter, re.DOTALL).group(1)
    rows = re.findall(r"^\| `(.*?)` \| `(.*?)` \| `(.*?)` \|$", chapter, re.MULTILINE)
    passed = failed = 0
    with tempfile.TemporaryDirectory() as directory:
        name = os.path.join(directory, "case.nml")
        for before, after, message in [("A FOUR-BAR", "A FOUR-BAR", None)] + rows:
            if case.count(before) != 1:
                failed += 1
                print(f"FAILED: the case of the manual has {case.count(before)} times '{before}'")
                continue
            with open(name, "w", encoding="utf-8") as file:
                file.write(case.replace(before, after))
            run = subprocess.run([psalm, "case.nml"], cwd=directory, capture_output=True, text=True)
            # what the run tells of its results is not about the input
            said = [line for line in run.stderr.splitlines() if line.startswith("case.nml:") and line[9:10].isdigit()]
            first = said[0] if said else None
            right = first == message and run.returncode == (2 if message and " error: " in message else 0)
            if right:
                passed += 1
            else:
                failed += 1
                print(f"FAILED: '{after}' for '{before}': status {run.returncode}, '{first}' instead of '{message}'")
    if len(rows) < 10:
        failed += 1
        print(f"FAILED: only {len(rows)} messages in the table of the manual")
    for wrong, number in (wrong_in_trouble(), without_data()):
        for words in wrong:
            print("FAILED: " + words)
        passed, failed = passed + number - len(wrong), failed + len(wrong)
    print(f"{passed} passed, {failed} failed")
    return failed > 0


sys.exit(main())
