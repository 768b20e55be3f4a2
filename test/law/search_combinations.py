#!/usr/bin/env python3
"""What combines with what in a search: every field of the table in doc/guide/tasks.md is run.

usage: test/law/search_combinations.py BIN   (BIN: directory with the programs)

A six-bar of two dyads, as a sketch, is to pass six points beside those that it passes. A plus of the table: the search ends with a linkage and
its total error. A number is the reason below the table; which it is shows in what psalm does (REASONS). Last line: N passed, N failed.
"""
import csv
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

MANUAL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "doc", "guide", "tasks.md")
SIX_BAR = """SIX-BAR
 &CHAIN JNT='A','B','C','D','P','Q','E', JX=0.,-4.,33.,90.,20.,80.,130., JY=0.,31.,82.,5.,95.,140.,60.,
  LNAME='frame','crank','coupler','rocker','rod','second', LNK='A D E','A B','B C P','C D','P Q','Q E'%s &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point Q' &END
 &METHOD NDES=6, DELT=0.,15.,30.,45.,60.,75.%s &END
"""
VARY = ", VARY='A B','B C','C D','P Q','Q E'"
ASIDE = (0.5, -0.3)                                  # of the points desired from those passed
ROWS = {"simplex of the thesis (without `&SEARCH`)": ("SIMPLEX", ", NITER=60"), "`SOLVER='LSQ'`": ("LSQ", ""),
        "an algorithm of NLopt": ("LD_SLSQP", ""), "`SOLVER='LSQ'`, in the poses of the links": ("LSQ", ""),
        "an algorithm of NLopt, in the poses of the links": ("LD_SLSQP", "")}
IN_POSES = ",'C P'"                                  # VARY has this too: it is no dimension of the loops
SHORT = ", MAXEVAL=40"
# what a column adds to &METHOD, to &SEARCH, and as a group
COLUMNS = {"`IFREE=1`": (", IFREE=1", "", ""), "`IRANGE=1`": ("", "", " &CONSTR IRANGE=1 &END\n"), "`IRANGE=2`": ("", "", " &CONSTR IRANGE=2 &END\n"),
           "regions": ("", "", " &CONSTR RKIND=-1, RPLACE=-100.,-100.,300.,300., RJNT='Q' &END\n"),
           "widths": ("", "", " &CONSTR SJNT='A B','P Q', SWIDTH=4.,4. &END\n"),
           "derivatives": (", DVELX=6*-30., DVELY=6*1., WVELX=6*0.01", "", ""), "`NFEW`": ("", ", NFEW=3", ""), "`IDYAD=1`": ("", ", IDYAD=1", "")}
# what psalm says when it refuses, by the number of the reason; 2 and 4 are no refusals
REASONS = {"1": "needs the group &SEARCH with another SOLVER", "3": "a simplex is searched to NITER", "5": "is for SOLVER=",
           "6": "does not take the linkage apart into dyads"}
CHECKED, TIMED = "2", "4"


def table():
    """Fields of the table by row and column, and the numbers of the reasons below it."""
    with open(MANUAL, encoding="utf-8") as file:
        text = file.read().split("## What combines with what")[1].split("\n## ")[0]
    lines = [[field.strip() for field in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return lines[0][1:], {line[0]: line[1:] for line in lines[2:]}, re.findall(r"^(\d)\. ", text, re.M)


def main():
    psalm = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
    columns, rows, reasons = table()
    check("the table has these columns", columns == list(COLUMNS), str(columns))
    check("the table has these rows", list(rows) == list(ROWS), str(list(rows)))
    check("the reasons are numbered", reasons == sorted([*REASONS, CHECKED, TIMED]), str(reasons))
    check("every reason is used", set("".join(map("".join, rows.values()))) - {"+"} == set(reasons))
    with tempfile.TemporaryDirectory() as folder:
        def run(text):
            with open(os.path.join(folder, "case.nml"), "w", encoding="utf-8") as file:
                file.write(text)
            return subprocess.run([psalm, "case.nml"], cwd=folder, capture_output=True, text=True)

        run(SIX_BAR % ("", ""))
        with open(os.path.join(folder, "case.csv"), encoding="utf-8") as file:
            passed = [(float(row["Q.x"]), float(row["Q.y"])) for row in csv.DictReader(file)]
        desired = ", DESX=%s, DESY=%s" % tuple(",".join("%.4f" % (point[k] + ASIDE[k]) for point in passed) for k in (0, 1))

        def search(row, *columns):
            solver, more = ROWS[row]
            method, own, groups = (list(parts) for parts in zip(*[COLUMNS[column] for column in columns]))
            short = "" if solver == "SIMPLEX" else SHORT
            vary = VARY + IN_POSES if "poses" in row else VARY
            return run(SIX_BAR % (vary, desired + more + "".join(method)) + " &SEARCH SOLVER='%s'%s%s &END\n" % (solver, short, "".join(own))
                       + "".join(groups))

        for row, fields in rows.items():
            for column, field in zip(columns, fields):
                done, where = search(row, column), row + ", " + column
                if field in ("+", CHECKED, TIMED):
                    check(where + ": a linkage", done.returncode in (0, 1) and "TOTAL ERROR" in done.stdout, done.stderr[-300:])
                    if "poses" in row:            # those by loops say how many Jacobians they formed
                        check(where + ": made there", "evaluations" in done.stderr and "Jacobians" not in done.stderr, done.stderr[-300:])
                if field == CHECKED:
                    check(where + ": margins are listed", "MARGINS" in done.stdout, done.stdout[-300:])
                if field == TIMED:
                    timed = search(row, column, "`IFREE=1`")
                    check(where + ": with prescribed timing", timed.returncode == 2 and "needs prescribed timing" in timed.stderr, timed.stderr[-300:])
                if field in REASONS:
                    check(where + ": refused", done.returncode == 2 and REASONS[field] in done.stderr, done.stderr[-300:])
    return report()


sys.exit(main())
