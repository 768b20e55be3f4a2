"""Runs of kalm with &TIME, for tests: cases in, tables out."""
import os
import subprocess
import tempfile

import numpy as np
from tally import check

TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


class Kalm:
    """kalm of a directory of programs, in a folder of its own."""

    def __init__(self, programs):
        self.program = os.path.join(os.path.abspath(programs), "kalm")
        self.folder = tempfile.mkdtemp()

    def tables(self, text, want=0):
        """All blocks of device 9 of a case by their names, column by column, and all that kalm said."""
        path = os.path.join(self.folder, "case.nml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run([self.program, "--output-dir", self.folder, path], capture_output=True, text=True, check=False,
                              timeout=60)
        if done.returncode != want:
            check(f"exit status {want}; got {done.returncode}: {done.stderr[:300]}", False)
        if done.returncode not in (0, 1):
            return {}, done.stderr
        with open(os.path.join(self.folder, "case.kalm.dev9"), encoding="utf-8") as file:
            parts = file.read().split("# block ")[1:]
        tables = {}
        for part in parts:
            lines = part.splitlines()
            names = lines[1].split()[1:]
            rows = [line.split() for line in lines[2:] if line and not line.startswith("#")]
            if any(len(row) != len(names) for row in rows):
                continue                                # words of more than one part
            columns = list(zip(*rows)) or [()]*len(names)
            tables[lines[0]] = {name: values_of(column) for name, column in zip(names, columns)}
        return tables, done.stdout + done.stderr

    def time(self, text, want=0):
        """The table `time` of a case, None if there is none, and all that kalm said."""
        tables, said = self.tables(text, want)
        return tables.get("time"), said


def values_of(column):
    try:
        return np.array([float(word) for word in column])
    except ValueError:
        return list(column)


def data(name, *changes):
    """A case of data/time, with some of its words changed."""
    with open(os.path.join(TOP, "data", "time", name + ".nml"), encoding="utf-8") as file:
        text = file.read()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def near(got, want, tolerance, law):
    check(f"{law}: {got!r} instead of {want!r}", abs(got - want) <= tolerance*max(1.0, abs(want)))
