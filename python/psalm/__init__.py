"""PSALM: analysis and synthesis of planar linkages.

A `Case` is one linkage and what is asked of it: drawn by joints and links (`from_joints`, `Linkage`), read from a file or text in the
notation of the manual, or made loop by loop. Every study is a method; results are tables whose columns are NumPy arrays with
names and units. Lengths are in one unit of your choice, angles in degrees, rates of angles in radians. Whatever is counted is counted
from 1.

    >>> import psalm
    >>> four_bar = psalm.from_joints({"A": (0, 0), "B": (0, 31), "C": (33, 82), "D": (90, 5), "P": (20, 95)},
    ...                              links=["A B", "B C P", "C D"], fixed="AD", drive="A", output="point P", step=10)
    >>> motion = four_bar.analyse()
    >>> motion["P"].x.shape
    (36,)

Errors of a case raise `psalm.Error`, which has the findings; what is only violated is a warning in the findings of the result.
Different cases may be used by different threads at the same time, one case by one thread only. A forked child goes on with its cases
and may use threads again, if no other thread was in a study when it was forked (multiprocessing: the start method "spawn" is always safe).
"""
from ._cases import Case, Linkage
from ._library import verbs, version
from ._results import Column, Error, Finding, Group, Motion, Result, Search, Table

__version__ = version
from_joints = Case.from_joints
from_file = Case.from_file
from_text = Case.from_text

__all__ = ["Case", "Column", "Error", "Finding", "Group", "Linkage", "Motion", "Result", "Search", "Table", "from_file",
           "from_joints", "from_text", "verbs", "version"]
