#!/usr/bin/env python3
"""The messages that the book shows are those of the program.

usage: test/program/manual.py PROGRAM_DIRECTORY. doc/reference/messages.md has a case in a fenced block and a table: what
stands in the case, what is written instead, the message. Each change is made and the message compared.
Last line: N passed, N failed.
"""
import os
import re
import subprocess
import sys
import tempfile

top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


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
    print(f"{passed} passed, {failed} failed")
    return failed > 0


sys.exit(main())
