"""Texts of the data sets, as tests change them."""
import os
import re

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def data(name):
    """A data set by its name."""
    with open(os.path.join(TOP, "data", name + ".nml"), encoding="utf-8") as file:
        return file.read()


def without(text, *groups):
    """The case without some of its groups, each of which it has once."""
    for group in groups:
        text, n = re.subn(r" *&%s\b.*?&END\n?" % group, "", text, flags=re.S)
        assert n == 1, group
    return text
