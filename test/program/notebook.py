#!/usr/bin/env python3
"""The notebooks and examples of the Python package, run as a new user would: cell by cell, in one name space, without Jupyter.

usage: notebook.py, with the module psalm on the path. doc/tutorial/notebook.md shows cells of the first notebook, and lines that they print.
Last line: N passed, N failed."""
import glob
import io
import json
import os
import re
import sys
import tempfile
import traceback
from contextlib import redirect_stdout

HERE = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python", "example"))
PAGE = os.path.join(HERE, "..", "..", "doc", "tutorial", "notebook.md")
passed = failed = 0
place = tempfile.TemporaryDirectory()     # for files that a notebook writes
os.chdir(place.name)


def check(law, right, words=""):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: notebook: %s\n%s" % (law, words))


def check_page(cells, printed):
    """The page shows every cell of the notebook, in their order, and of each block of lines below what is printed."""
    with open(PAGE, encoding="utf-8") as file:
        page = re.sub(r"<!-- file: .*?```\n.*?^```$", "", file.read(), flags=re.M | re.S)
    blocks = re.findall(r"^```(\w*)\n(.*?)^```$", page, re.M | re.S)
    shown = [block for kind, block in blocks if kind == "python"]
    check("the tutorial shows the cells of the notebook", shown == ["".join(cell["source"]) + "\n" for cell in cells if cell["cell_type"] == "code"])
    lines = [line.strip() for line in printed.splitlines()]
    for line in (line for kind, block in blocks if not kind for line in block.splitlines()):
        check("the tutorial shows what is printed", line.strip() in lines, line)


for path in sorted(glob.glob(os.path.join(HERE, "*.ipynb"))):
    with open(path, encoding="utf-8") as file:
        cells = json.load(file)["cells"]
    names = {"__name__": "__main__"}
    shown = io.StringIO()
    for number, cell in enumerate(cells, 1):
        if cell["cell_type"] != "code":
            continue
        lines = "".join(cell["source"]).splitlines()
        # what a cell ends with is shown
        last = lines.pop() if lines[-1].isidentifier() else None
        try:
            with redirect_stdout(shown):
                exec(compile("\n".join(lines), "%s, cell %d" % (os.path.basename(path), number), "exec"), names)
                if last:
                    check("cell %d shows a page" % number, "<iframe" in names[last]._repr_html_())
            check("cell %d" % number, True)
        except Exception:
            check("%s, cell %d" % (os.path.basename(path), number), False, traceback.format_exc())
            break
    if os.path.basename(path) == "four_bar.ipynb":
        check_page(cells, shown.getvalue())
        for name, has in (("four_bar.dxf", "ENTITIES"), ("four_bar.html", "<script")):
            with open(name, encoding="utf-8") as file:
                check("the notebook writes " + name, has in file.read())
    check("%s says something" % os.path.basename(path), len(shown.getvalue()) > 500)
print("%d passed, %d failed" % (passed, failed))
sys.exit(failed > 0)
