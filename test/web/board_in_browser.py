"""The drawing board in chromium without a screen: linkages drawn with mouse, fingers and keys, saved, and run by psalm.

Called by pictures.py in a directory of its own. The board finds places by a solver of its own; psalm's are the other route.
"""
import csv
import glob
import math
import os
import re
import shutil
import sys
import time
import urllib.parse

from playwright.sync_api import sync_playwright

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from page_in_browser import Page
from picture_tools import DATA, FLAGS, PATIENCE, TOP, balm, check, psalm, read, write

SAME = 1e-12   # part of the size of a drawing
# three exact lengths along one line hold the joint between only to the root of the rounding across it
ROUGH = {"chebyshev": 1e-5}
QUICK = 10     # seconds; much of it is the start of the browser on a busy machine
BOARD = os.path.join(TOP, "web", "board.html")


def test_board(shots):
    """All tests; screenshots go into the directory `shots`, if any."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        test_files(browser)
        test_four_bar(browser, shots)
        test_slider_crank(browser)
        test_cylinder_and_keys(browser)
        test_words(browser)
        test_data_sets(browser, shots)
        test_fingers(browser, shots)
        test_exact_places(browser)
        test_names_elsewhere(browser)
        test_large_files(browser)
        test_address_and_help(browser)
        browser.close()


class Board(Page):
    """A drawing board, used as people use it."""

    def at(self, x, y):
        # a view that is fitted in the next frame would move what is aimed at
        self.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return self.ask("board.view.screen(%r, %r)" % (x, y))

    def tool(self, name):
        self.page.click("#tools [data-tool=%s]" % name)

    def click(self, x, y):
        self.page.mouse.click(*self.at(x, y))

    def pull(self, start, end):
        (x, y), (u, v) = self.at(*start), self.at(*end)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move((x + u) / 2, (y + v) / 2)
        self.page.mouse.move(u, v)
        self.page.mouse.up()

    def fill(self, label, value):
        self.page.fill('#panel [aria-label="%s"]' % label, str(value))
        self.page.press('#panel [aria-label="%s"]' % label, "Enter")

    def chip(self):
        return self.page.text_content("#chip")

    def save(self, name):
        with self.page.expect_download() as download:
            self.page.click("#save")
        download.value.save_as(name)
        return read(name)

    def sketch(self):
        return self.ask("board.state.sketch")


def compare(law, board, name):
    """What the board shows at all positions is what psalm finds for the file; gives the largest difference."""
    code, _, errors = psalm("--quiet", name)
    if not check(law + ": psalm runs the file", code in (0, 1), errors):
        return
    with open(name[:-4] + ".csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    mine = board.ask("board.table()")
    check(law + ": as many positions, the same close", [str(one["closed"]) for one in mine] == [row["closed"] for row in rows],
          "%d %d" % (len(mine), len(rows)))
    size = board.ask("board.state.motion.mech.size")
    worst, outputs = 0.0, set()
    for one, row in zip(mine, rows):
        for key, value in one.items():
            if key == "closed" or value is None or row["closed"] == "0":
                continue
            outputs.add(key)
            joint = key.endswith((".x", ".y"))
            away = value - float(row[key])
            if not joint and "angle" in key or "between" in key:
                away = math.remainder(away, 360) / 360
            worst = max(worst, abs(away) / (size if joint or "angle" not in key else 1.0))
    check(law + ": the same joints and outputs", worst <= ROUGH.get(law, SAME) and len(outputs) > 4, "%.1e %s" % (worst, sorted(outputs)))
    print("drawing board, %s: largest difference from psalm %.1e of the size" % (law, worst))


def test_files(browser):
    balm("--quiet", "--edit")
    one = Board(browser, "sketch.edit.html")
    check("board: loads without complaint", not one.complaints, str(one.complaints))
    check("board: asks for nothing but itself", all(u.startswith(("file:", "data:")) for u in one.requests), str(one.requests))
    check("board: begins empty and says how", "The board is empty" in one.chip())
    check("board: every control has a name", one.ask("""[...document.querySelectorAll('button,select,input,textarea')].every(
        (e) => e.getAttribute('aria-label') || e.closest('label')?.textContent.trim() || e.textContent.trim())"""))
    one.context.close()
    code, _, errors = balm("--edit", os.path.join(DATA, "needle.nml"), "--output-dir", ".")
    check("board: loops are refused", code == 2 and "takes sketches (&CHAIN)" in errors and not os.path.exists("needle.edit.html"), errors)
    code, _, errors = balm("--edit", "--curves")
    check("board: no pictures beside it", code == 2 and "--edit makes the drawing board" in errors, errors)
    code, _, errors = psalm("--edit", "a.nml")
    check("board: an option of balm", code == 2 and "'--edit' is an option of balm" in errors, errors)
    code, _, errors = balm("--edit", "missing.nml")
    check("board: a file that is not there", code == 3, errors)


def test_address_and_help(browser):
    """A case in the address is on the board; help opens the page of the book for what is being done."""
    board = Board(browser, BOARD)
    case = read(os.path.join(DATA, "sketch_four_bar.nml"))
    board.page.goto("about:blank")
    board.page.goto("file://" + BOARD + "#book=./&file=four.nml&case=" + urllib.parse.quote(case))
    board.page.wait_for_timeout(150)
    check("board: the case of the address is on it", board.ask("board.state.sketch.joints.length") == len(re.search(r"JX=([\d.,-]+),", case)[1].split(","))
          and board.ask("board.state.file") == "four.nml", board.chip())
    check("board: it is drawn without complaint", not board.complaints and "it moves" in board.chip(), board.chip())
    board.page.evaluate("window.open = (to) => { window.opened = to; }")
    guide = os.path.join(TOP, "doc", "guide")
    for tool, page in (("select", "./guide/board.html"), ("drive", "./guide/sketch.html#drives"), ("slider", "./guide/sketch.html#chain"),
                       ("output", "./guide/sketch.html#outputs-optional")):
        board.tool(tool)
        board.page.click("#help")
        check("board: help with the tool %s" % tool, board.ask("window.opened") == page, board.ask("window.opened"))
        name, _, anchor = page.removeprefix("./guide/").partition(".html#")
        headings = re.findall(r"^#+ (.*)$", read(os.path.join(guide, name.removesuffix(".html") + ".md")), re.M)
        slugs = [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings]
        check("board: the page has the place %s" % anchor, not anchor or anchor in slugs, str(slugs))
    board.context.close()
    board = Board(browser, BOARD)
    board.page.goto("about:blank")
    board.page.goto("file://" + BOARD + "#book=javascript:alert(1)//")
    board.page.wait_for_timeout(150)
    board.page.click("#help")
    check("board: only a path is taken for the book", board.ask("board.state.book") == "" and not board.dialogs, board.ask("board.state.book"))
    check("board: without the book help names the page", "guide/board" in board.page.text_content("#hint"))
    board.context.close()


def test_four_bar(browser, shots):
    board = Board(browser, BOARD)
    page = board.page
    board.pull((0, 0), (0, 30))
    check("four-bar: what is wrong is told", "Nothing joins link link2 to the frame" in board.chip(), board.chip())
    board.pull((0, 30), (60, 80))
    board.pull((60, 80), (100, 0))
    board.tool("pivot")
    board.click(0, 0)
    board.click(100, 0)
    check("four-bar: it asks for a drive", "Freedom 1 and no drive" in board.chip(), board.chip())
    board.tool("drive")
    board.click(0, 0)
    check("four-bar: it moves", board.chip() == "Freedom 1, one drive: it moves", board.chip())
    board.tool("link")
    board.click(30, 55)
    check("four-bar: a click on a link adds a joint of it", board.sketch()["links"][2]["joints"] == ["B", "C", "E"] and
          board.sketch()["joints"][4] == {"name": "E", "x": 30, "y": 55}, str(board.sketch()))
    board.tool("select")
    board.pull((30, 55), (20, 90))
    check("four-bar: pulled off the line, on the grid", board.sketch()["joints"][4] == {"name": "E", "x": 20, "y": 90}, str(board.sketch()["joints"]))
    board.tool("output")
    board.click(20, 90)
    check("four-bar: its path is wanted", board.sketch()["outputs"] == [{"kind": "point", "of": ["E"], "name": ""}])
    drawn = board.pixels("board")
    page.click("#play")
    page.wait_for_function("board.state.t > 5")
    check("four-bar: it plays", board.ask("board.state.playing") and board.pixels("board") != drawn)
    if shots:
        page.screenshot(path=os.path.join(shots, "board.png"))
    page.click("#play")
    still = board.pixels("board")
    page.wait_for_timeout(100)
    check("four-bar: it stops", board.pixels("board") == still)
    check("four-bar: a whole turn", board.ask("board.state.motion.sweep.ring") and len(board.ask("board.state.motion.sweep.states")) == 360)
    page.fill("#title", "DRAWN BY MOUSE")
    page.press("#title", "Enter")
    text = board.save("drawn.nml")
    check("four-bar: saved as a sketch", text.startswith("DRAWN BY MOUSE\n &CHAIN JNT='A','B','C','D','E',") and "LNK='A D','A B','B C E','C D'" in text, text)
    compare("four-bar", board, "drawn.nml")
    # undo to the empty board, and all the way back
    whole = board.sketch()
    for _ in range(20):
        page.keyboard.press("Control+z")
    check("undo: back to the empty board", not board.sketch()["joints"] and page.is_disabled("#undo"))
    for _ in range(20):
        page.keyboard.press("Control+y")
    check("redo: all of it", board.sketch() == whole and page.is_disabled("#redo"))
    # a length typed in is exact, and stays so while a joint is dragged
    board.tool("select")
    board.click(80, 40)
    board.fill("length C D", "sqrt")
    check("a length that is no number is not taken", board.sketch()["lengths"] == [] and "bad" in page.get_attribute('#panel [aria-label="length C D"]', "class"))
    board.fill("length C D", "170/2")
    length = lambda a, b: board.ask("(([p, q]) => Math.hypot(p[0] - q[0], p[1] - q[1]))(['%s', '%s'].map((n) => board.places().get(n)))" % (a, b))
    check("a length typed in is kept", board.sketch()["lengths"] == [{"joints": ["C", "D"], "value": 85}] and abs(length("C", "D") - 85) < 1e-12)
    x, y = board.ask("board.places().get('C')")
    board.pull((x, y), (40, 90))
    check("dragged: the exact length stays", abs(length("C", "D") - 85) < 1e-12 and math.dist(board.ask("board.places().get('C')"), (x, y)) > 3)
    board.save("exact.nml")
    check("an exact length is saved", "LENP='C D', LENV=85.0" in read("exact.nml"), read("exact.nml"))
    compare("four-bar with an exact length", board, "exact.nml")
    check("four-bar: no complaint", not board.complaints, str(board.complaints))
    board.context.close()


def test_exact_places(browser):
    """What is pinned stays where it was drawn, to the last bit; places that are equal are one joint."""
    board = Board(browser, BOARD)
    board.pull((10, 20), (0, 50))
    board.pull((0, 50), (60, 80))
    board.pull((60, 80), (110, 20))
    board.tool("pivot")
    board.click(10, 20)
    board.click(110, 20)
    board.tool("drive")
    board.click(10, 20)
    board.tool("select")
    board.click(5, 35)
    board.fill("length A B", "31.4159")
    board.click(30, 65)
    board.fill("length B C", "70.7")
    text = board.save("pinned.nml")
    joints = {j["name"]: (j["x"], j["y"]) for j in board.sketch()["joints"]}
    check("pinned joints stay to the bit", joints["A"] == (10, 20) and joints["D"] == (110, 20) and "JX=10.0," in text, str(joints))
    check("the lengths typed in hold", abs(math.dist(joints["A"], joints["B"]) - 31.4159) < 1e-11 and
          abs(math.dist(joints["B"], joints["C"]) - 70.7) < 1e-11, str(joints))
    board.fill("length B C", "1000")
    joints = {j["name"]: (j["x"], j["y"]) for j in board.sketch()["joints"]}
    check("a length that moves others far leaves them too", joints["A"] == (10, 20) and joints["D"] == (110, 20), str(joints))
    # beside a joint, but on its place of the grid
    board = Board(browser, BOARD)
    board.pull((0, 0), (0, 40))
    x, y = board.at(0, 40)
    step = abs(board.at(board.ask("board.view.gridStep()"), 0)[0] - board.at(0, 0)[0])
    board.page.mouse.move(x + 0.45*step, y)
    board.page.mouse.down()
    board.page.mouse.move(*board.at(60, 60))
    board.page.mouse.up()
    check("joints at one place are one joint", len(board.sketch()["joints"]) == 3 and len(board.sketch()["links"]) == 3,
          str(board.sketch()["joints"]))
    board.tool("pivot")
    board.page.mouse.click(x - 0.45*step, y)
    sketch = board.sketch()
    check("a joint beside the pointer is pinned", len(sketch["joints"]) == 3 and len(sketch["links"][0]["joints"]) == 1, str(sketch))
    board.fill("new joint at x y", "0 0")
    board.fill("new joint at x y", "0 0")
    sketch = board.sketch()
    check("places typed in where joints are", len(sketch["joints"]) == 3 and len(sketch["links"][0]["joints"]) == 2, str(sketch))
    board.context.close()


def test_names_elsewhere(browser):
    """A joint that is renamed is renamed in groups that the board does not edit."""
    write("renamed.nml", """FOUR-BAR
 &CHAIN JNT='A','B','C','D','P', JX=0.,0.,60.,100.,20., JY=0.,30.,80.,0.,90., LNAME='frame','crank','rod','rocker',
  LNK='A D','A B','B C P','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD IKIN=30 &END
 &MASSES NMASS=2, MNAME='crank B','rod P', MASS=1.0,2.0 &END
 &LOADS NLOAD=1, LNAME='rod P', LFX=5.0 &END
 &SPRING NSPRNG=1, ANAME='frame A', BNAME='rod P', STIFF=10.0 &END
""")
    code, before, errors = psalm("--quiet", "renamed.nml")
    check("renamed: the file runs", code in (0, 1), errors)
    board = Board(browser, BOARD)
    board.ask("board.load(%r, 'renamed.nml')" % read("renamed.nml"))
    board.ask("board.rename('joint', 'P', 'TIP'); board.rename('link', 'rod', 'plate'); board.rename('joint', 'B', 'Q')")
    text = board.save("renamed.nml")
    check("renamed: groups that are kept follow", "MNAME='crank Q','plate TIP'" in text and "LNAME='plate TIP'" in text and
          "BNAME='plate TIP'" in text, text)
    code, _, errors = psalm("--quiet", "renamed.nml")
    check("renamed: psalm runs the file", code in (0, 1), errors)
    board.context.close()


def test_large_files(browser):
    """Files without measure are read or refused at once."""
    case = read(os.path.join(DATA, "sketch_four_bar.nml"))
    body = case[case.index(" &CHAIN"):]
    for law, text in (("a title of 2 MB", "T" * 2000000 + "\n" + body), ("300 000 &", "TITLE\n" + body + "&" * 300000),
                      ("300 000 =", "TITLE\n" + body + "=" * 300000), ("3 MB of blanks", "TITLE\n" + " " * 3000000 + body),
                      ("3 MB of blanks in a group", "TITLE\n" + body.replace("&END", " " * 3000000 + "&END", 1)),
                      ("a number that is repeated endlessly", "TITLE\n" + body.replace("&END", "XYZ=999999999*1 &END", 1))):
        write("large.nml", text)
        balm("--quiet", "--edit", "large.nml")
        began = time.monotonic()
        board = Board(browser, "large.edit.html")
        board.tool("link")
        took = time.monotonic() - began
        check("board, %s: opens in seconds" % law, took < QUICK and not board.complaints, "%.1f s %s" % (took, board.complaints))
        board.context.close()


def test_slider_crank(browser):
    board = Board(browser, BOARD)
    board.click(0, 0)
    board.click(20, 30)      # both ends clicked
    board.pull((20, 30), (110, 10))
    board.tool("pivot")
    board.click(0, 0)
    board.tool("slider")
    board.pull((110, 10), (150, 12))
    sketch = board.sketch()
    check("slider-crank: a block on a line of the frame", [(s["links"], s["x"], s["y"], s["angle"]) for s in sketch["slides"]] ==
          [(["frame", "block2"], 110, 10, 0)] and sketch["links"][-1] == {"name": "block2", "joints": ["C"]}, str(sketch))
    board.tool("drive")
    board.click(0, 0)
    check("slider-crank: it moves", "it moves" in board.chip(), board.chip())
    board.tool("output")
    board.click(110, 10)
    board.save("crank.nml")
    compare("slider-crank", board, "crank.nml")
    board.tool("drive")
    board.click(0, 0)        # no longer the crank
    board.click(110, 10)     # but the block
    check("slider-crank: the slide is driven", [d["kind"] for d in board.sketch()["drives"]] == ["slide"] and board.sketch()["ikin"] == 0 and
          "it moves" in board.chip(), str(board.sketch()["drives"]))
    board.save("piston.nml")
    compare("slider-crank driven by its piston", board, "piston.nml")
    check("slider-crank: no complaint", not board.complaints, str(board.complaints))
    board.context.close()


def test_cylinder_and_keys(browser):
    """A boom and its cylinder, placed by typing; two drives; the keyboard."""
    board = Board(browser, BOARD)
    page = board.page
    for place in ("0 0", "30,5 -10", "100 20"):
        board.fill("new joint at x y", place)
    check("typed places", [(j["x"], j["y"]) for j in board.sketch()["joints"]] == [(0, 0), (30.5, -10), (100, 20)], str(board.sketch()["joints"]))
    page.click('#panel [aria-label="pinned to the frame"]')
    check("a joint of no link goes", [j["name"] for j in board.sketch()["joints"]] == ["A", "B"])
    board.fill("new joint at x y", "100 20")
    board.fill("new joint at x y", "60 40")
    board.fill("new link of joints", "A C D")
    for name in "CD":
        page.click('#panel [aria-label="joint %s"]' % name)
        page.click('#panel [aria-label="pinned to the frame"]')
    check("typed links", board.sketch()["links"] == [{"name": "frame", "joints": ["A", "B"]}, {"name": "link2", "joints": ["A", "C", "D"]}], str(board.sketch()["links"]))
    board.tool("drive")
    board.pull((30.5, -10), (60, 40))
    check("a cylinder is pulled from joint to joint", board.sketch()["drives"][0]["kind"] == "cylinder" and "it moves" in board.chip(), board.chip())
    board.tool("output")
    board.click(100, 20)
    board.save("boom.nml")
    compare("boom with a cylinder", board, "boom.nml")
    # a stick with a second cylinder
    board.tool("link")
    board.pull((100, 20), (130, -20))
    board.tool("drive")
    board.click(100, 20)
    check("two drives", "Freedom 2, 2 drives: it moves" == board.chip() and len(board.sketch()["drives"][1]["delt"]) == 7, board.chip())
    board.fill("positions of C, from the drawing", "0 -5 -10 -15 -10 -5 0")
    board.save("stick.nml")
    check("values of the second drive are saved", "DELT2=0.0,-5.0,-10.0,-15.0,-10.0,-5.0,0.0" in read("stick.nml"), read("stick.nml"))
    compare("boom and stick", board, "stick.nml")
    before = board.ask("board.places().get('E')")
    page.focus('#drives [aria-label="drive C"]')
    page.keyboard.press("ArrowRight")
    check("each drive has its slider", board.ask("board.places().get('E')") != before)
    page.click('#panel [aria-label="joint E"]')
    page.focus("#board")
    step = board.ask("board.view.gridStep()")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Shift+ArrowLeft")
    check("arrows move what is chosen", board.sketch()["joints"][4] == {"name": "E", "x": 130 - 5 * step, "y": -20 + step}, str(board.sketch()["joints"][4]))
    page.keyboard.press("Delete")
    check("Delete takes it away, and what cannot be without it", [l["name"] for l in board.sketch()["links"]] == ["frame", "link2"] and
          len(board.sketch()["drives"]) == 1, str(board.sketch()["drives"]))
    page.keyboard.press("l")
    check("letters choose tools", board.ask("board.state.tool") == "link")
    page.keyboard.press("Escape")
    check("Escape gives up", board.ask("board.state.tool") == "select")
    page.click('#panel [aria-label="link link2"]')
    board.fill("name of the link", "boom")
    check("renamed everywhere", board.sketch()["links"][1]["name"] == "boom" and "it moves" in board.chip())
    page.click('#panel [aria-label="joint A"]')
    board.fill("name of the joint", "B")
    check("a name that is taken is not", board.ask("board.inFrame('A')") and "bad" in page.get_attribute('#panel [aria-label="name of the joint"]', "class"))
    check("typed: no complaint", not board.complaints, str(board.complaints))
    board.context.close()


def test_words(browser):
    """Sketches that are no mechanism: what is wrong, by name, as psalm finds too."""
    board = Board(browser, BOARD)
    four = "A CASE\n &CHAIN JNT='A','B','C','D', JX=0.,0.,40.,70., JY=0.,30.,60.,0., LNK=%s &END\n &DRIVES DRIVE=%s &END\n &METHOD IKIN=30 &END\n &LIMITS TANGLE=85. &END\n"
    cases = [("underconstrained", "'A','A B','B C','C D'", "'A'", "Underconstrained: links 3 and 4 can still move with A held"),
             ("overconstrained", "'A D','A B','B C','C D','A C'", "'A'", "moves nothing"),
             ("overconstrained twice", "'A D','A B','B C','C D','A C','B D'", "'A'", "moves nothing"),
             ("apart", "'A','A B','C D'", "'A'", "Nothing joins link 3 to the frame"),
             ("driven twice", "'A D','A B','B C','C D'", "'A','D', RATIO=0.,1.", "Drive D moves nothing")]
    for name, links, drive, words in cases:
        text = four % (links, drive)
        board.ask("board.load(%r)" % text)
        write("wrong.nml", text)
        code, _, errors = psalm("--quiet", "wrong.nml")
        check("words, %s: told on the board" % name, words in board.chip() and not board.ask("Boolean(board.state.motion.sweep)"), board.chip())
        check("words, %s: psalm refuses it too" % name, code == 2, errors)
    board.page.click("#tab-text")
    board.page.fill("#source", "A CASE\n &CHAIN JNT='A','B', JX=0.,1., JY=0.,x &END\n")
    board.page.wait_for_function("document.querySelector('#faults .error')")
    check("words: a mistake in the text has its line", "line 2: &CHAIN JY: a number is expected; found 'x'" in board.page.text_content("#faults") and
          board.ask("document.querySelector('.mark.error').style.top") == "17px", board.page.text_content("#text"))
    board.page.fill("#source", four % ("'A D','A B','B C','C D'", "'A'"))
    board.page.wait_for_function("board.state.messages.length === 0")
    check("words: a right text is on the board", "it moves" in board.chip(), board.chip())
    check("words: no complaint", not board.complaints, str(board.complaints))
    board.context.close()


def test_data_sets(browser, shots):
    """Every sketch of data/: opened and saved it is the same; written anew it is the same to psalm; the board moves it as psalm does."""
    board = Board(browser, BOARD)
    names = [name for name in sorted(glob.glob(os.path.join(DATA, "*.nml"))) if "&CHAIN" in read(name)]
    check("there are sketches", len(names) > 15)
    for name in names:
        stem = os.path.basename(name)[:-4]
        board.page.set_input_files("#file", name)
        board.page.wait_for_function("board.state.file === %r" % os.path.basename(name))
        check(stem + ": saved as it was opened", board.save("same.nml") == read(name))
        check(stem + ": it moves", "it moves" in board.chip(), board.chip())
        # written anew from what was understood, with the groups that the board does not edit
        text = board.ask("""(() => { const s = board.state.sketch, source = board.state.source, groups = board.text.groups(s);
            return s.title + '\\n' + Object.values(groups).filter(Boolean).join('\\n') + '\\n'; })()""")
        write("anew.nml", text + "".join(" &LIMITS%s&END\n" % part.split("&END")[0] for part in read(name).split("&LIMITS")[1:]))
        psalm("--quiet", "--output-dir", ".", name)
        code, _, errors = psalm("--quiet", "anew.nml")
        check(stem + ": written anew it is the same to psalm", code in (0, 1) and read("anew.csv") == read(stem + ".csv"), errors)
        if "NGRID" not in text:
            shutil.copy(name, stem + ".copy.nml")
            compare(stem, board, stem + ".copy.nml")
        if shots and stem in ("excavator", "jansen", "scissors_lift"):
            board.page.screenshot(path=os.path.join(shots, "board_%s.png" % stem))
    check("data sets: no complaint", not board.complaints, str(board.complaints))
    board.context.close()
    balm("--quiet", "--edit", "--output-dir", ".", os.path.join(DATA, "jansen.nml"))
    own = Board(browser, "jansen.edit.html")
    check("balm --edit CASE: the sketch is on the board", own.ask("board.write()") == read(os.path.join(DATA, "jansen.nml")) and "it moves" in own.chip())
    own.context.close()


def test_fingers(browser, shots):
    """A phone: taps and strokes draw, two fingers enlarge, nothing is wider than the screen."""
    for scheme in ("light", "dark"):
        phone = Board(browser, BOARD, 390, 844, scheme)
        check("phone, %s: no sideways scrolling" % scheme, phone.ask("document.documentElement.scrollWidth") <= 390)
        if shots:
            phone.ask("board.load(board.examples[0].text)")
            phone.page.screenshot(path=os.path.join(shots, "board_phone_%s.png" % scheme))
        phone.context.close()
    touch = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True)
    touch.set_default_timeout(PATIENCE)
    page = touch.new_page()
    page.goto("file://" + BOARD)
    page.wait_for_timeout(150)
    client = touch.new_cdp_session(page)

    def stroke(*fingers):
        """Fingers that go from place to place at the same time, pixels of the screen."""
        for k in range(5):
            points = [{"x": a[0] + k / 4 * (b[0] - a[0]), "y": a[1] + k / 4 * (b[1] - a[1]), "id": i} for i, (a, b) in enumerate(fingers)]
            client.send("Input.dispatchTouchEvent", {"type": "touchMove" if k else "touchStart", "touchPoints": points})
        client.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    at = lambda x, y: page.evaluate("board.view.screen(%r, %r)" % (x, y))
    stroke((at(20, 20), at(40, 60)))
    check("a finger draws a link", [(j["x"], j["y"]) for j in page.evaluate("board.state.sketch.joints")] == [(20, 20), (40, 60)],
          str(page.evaluate("board.state.sketch.joints")))
    scale = page.evaluate("board.view.eye.k")
    (x, y) = at(40, 20)
    stroke(((x - 20, y), (x - 60, y)), ((x + 20, y), (x + 60, y)))
    check("two fingers enlarge", 2 < page.evaluate("board.view.eye.k") / scale < 4 and len(page.evaluate("board.state.sketch.joints")) == 2)
    touch.close()
