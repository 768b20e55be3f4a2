#!/usr/bin/env python3
"""The workbench: who is refused, what is bounded, and a newcomer's way from an empty board to a linkage and its forces, in chromium.

usage: test/web/workbench.py PROGRAM_DIRECTORY [SCREENSHOT_DIRECTORY]. Last line: N passed, N failed.
Forces and positions are compared with those that kalm and psalm write for the file that the board saves.
"""
import asyncio
import concurrent.futures
import contextlib
import csv
import fcntl
import http.client
import json
import math
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

import ezdxf
from playwright.sync_api import sync_playwright

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import picture_tools
from board_in_browser import BOARD, Board
from picture_tools import DATA, FLAGS, TOP, check, read, run, write

QUICK = 16.0          # milliseconds of a frame while a ten-bar is dragged; asked of a machine that does nothing else
BUSY = 6.0            # times as long beside other tests
PATIENCE = 60.0       # seconds
FOUR_BAR = os.path.join(DATA, "sketch_four_bar.nml")


def library():
    """libpsalm.so of this checkout, built if it is older than the programs."""
    place = os.path.join(TOP, "build", "lib", "libpsalm.so")
    with open(os.path.join(TOP, "build", "lib.lock"), "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not os.path.exists(place) or os.path.getmtime(place) < os.path.getmtime(os.path.join(picture_tools.programs, "psalm")):
            subprocess.run([os.path.join(TOP, "scripts", "build_library")], check=True, capture_output=True)
    return place


class Server:
    """The workbench as a user starts it."""

    def __init__(self, *arguments):
        environment = {**os.environ, "PYTHONPATH": os.path.join(TOP, "python"), "PSALM_LIBRARY": library()}
        self.process = subprocess.Popen([sys.executable, "-m", "psalm.workbench", "--no-browser", *arguments], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True, env=environment)
        self.url = re.search(r"http://\S+", self.process.stdout.readline())[0]
        self.port, self.token = int(re.search(r":(\d+)/", self.url)[1]), self.url.partition("token=")[2]

    def ask(self, path, body=None, method=None, **headers):
        """Status and answer; headers by name, None leaves one out that is sent otherwise."""
        given = {"Host": "127.0.0.1:%d" % self.port, "X-Psalm-Token": self.token}
        given.update({name.replace("_", "-"): value for name, value in headers.items()})
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        try:
            connection.request(method or ("GET" if body is None else "POST"), path, body, {n: v for n, v in given.items() if v is not None})
            answer = connection.getresponse()
            return answer.status, answer.read().decode(), dict(answer.getheaders())
        except (ConnectionError, http.client.HTTPException) as error:
            return 0, repr(error), {}
        finally:
            connection.close()

    def look(self, case):
        status, answer, _ = self.ask("/look", case.encode())
        return status, json.loads(answer)

    def studies(self):
        """Processes that work or wait."""
        listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(self.process.pid)], capture_output=True, text=True, check=False).stdout
        return [int(one) for one in listed.split()]

    def end(self):
        children = self.studies()
        self.process.send_signal(signal.SIGINT)
        _, errors = self.process.communicate(timeout=PATIENCE)
        check("Ctrl-C ends it in good order", self.process.returncode == 0 and not errors, "%d %s" % (self.process.returncode, errors[-300:]))
        return children


# ---- who is refused -----------------------------------------------------------------------------------------------------

def test_refusals(server):
    case = read(FOUR_BAR)
    check("server: with the token it answers", server.look(case)[0] == 200)
    status, page, headers = server.ask("/?token=" + server.token, X_Psalm_Token=None)
    check("server: the page with its token", status == 200 and server.token in page and "board" in page, status)
    check("server: no script but those of the page", "script-src 'sha256-" in headers["content-security-policy"] and
          "unsafe" not in headers["content-security-policy"].split("style-src")[0] and "default-src 'none'" in headers["content-security-policy"], headers)
    check("server: it is on this machine alone", listening(server.port) == {"127.0.0.1"}, str(listening(server.port)))
    for law, path, headers in (
            ("without a token", "/look", {"X_Psalm_Token": None}), ("with a wrong token", "/look", {"X_Psalm_Token": "x" * 32}),
            ("the page without a token", "/", {"X_Psalm_Token": None}), ("the page with a wrong token", "/?token=abc", {}),
            ("from another origin", "/look", {"Origin": "http://example.org"}), ("from no origin", "/look", {"Origin": "null"}),
            ("from another port", "/look", {"Origin": "http://127.0.0.1:1"}), ("to another host", "/look", {"Host": "example.org"}),
            ("to another name of this machine", "/look", {"Host": "psalm.example.org:%d" % server.port}),
            ("from a page of another site", "/look", {"Sec_Fetch_Site": "cross-site"})):
        status, answer, _ = server.ask(path, None if path.startswith("/?") or path == "/" else case.encode(), **headers)
        check("refused: " + law, status == 403 and "error" in answer and "motion" not in answer, "%d %s" % (status, answer[:200]))
    status, answer, headers = server.ask("/look", method="OPTIONS", Origin="http://example.org", X_Psalm_Token=None)
    check("refused: what a browser asks before it sends", status == 403 and not any(n.startswith("access-control") for n in headers), "%d %s" % (status, headers))
    for path in ("/../etc/passwd", "/etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/search/..%2f..%2fetc%2fpasswd", "//etc/passwd", "/look/../../etc/passwd"):
        status, answer, _ = server.ask(path)
        check("refused: the path " + path, status == 404 and "root:" not in answer, "%d %s" % (status, answer[:100]))


def listening(port):
    """Addresses on which something listens at a port."""
    found = set()
    for name in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in read(name).split("\n")[1:]:
            words = line.split()
            if len(words) > 3 and words[3] == "0A" and int(words[1].split(":")[1], 16) == port:
                address = words[1].split(":")[0]
                found.add(".".join(str(b) for b in reversed(bytes.fromhex(address))) if len(address) == 8 else address)
    return found


def test_bounds(server):
    case = read(FOUR_BAR)
    status, answer, _ = server.ask("/look", None, method="POST", Content_Length=str(100 << 20))
    check("bounded: 100 MB announced", status == 413, "%d %s" % (status, answer[:100]))

    def chunks():
        for _ in range(100):
            yield b"A" * (1 << 20)

    status, answer, _ = server.ask("/look", chunks(), Transfer_Encoding="chunked")
    check("bounded: 100 MB that were not announced", status in (0, 413), "%d %s" % (status, answer[:100]))
    with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as raw:
        raw.sendall(b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * (200 << 10) + b"\r\n\r\n")
        with contextlib.suppress(ConnectionError):
            raw.settimeout(PATIENCE)
            first = raw.recv(100)
            check("bounded: a header of 200 kB", first[:12] == b"HTTP/1.1 400" or not first, first)
    check("the server still answers", server.look(case)[0] == 200)
    for law, text in (("&CURVE with a path", "T\n &CURVE FILE='/etc/passwd' &END\n &KINDS &END\n &SEARCH MAXTIME=1 &END\n"),
                      ("&CURVE after others in its line", case + " $curve file='/etc/passwd' &END\n"),
                      ("&CURVE behind a text", case.replace("&LIMITS", "&METHOD IKIN=5 &END &CURVE FILE='/etc/hosts' &END &LIMITS"))):
        status, answer = server.look(text)
        check("refused: " + law, status == 200 and "motion" not in answer and any("CURVE" in one["text"] for one in answer["findings"]) and
              "root" not in json.dumps(answer), str(answer)[:300])
    status, answer = server.look(case.replace("'P'", "'<b>&\"'").replace("B C P", "B C <b>&\"").replace("point P", "point <b>&\""))
    check("hostile names come back as they are", status == 200 and '<b>&"' in answer["motion"]["joints"], str(answer)[:300])
    for law, body, words in (("no JSON", b"{", "JSON"), ("no object", b"[]", "object"), ("nested deeply", b"[" * 100000, "JSON"),
                             ("no curve", b'{"kinds": ["pins4"]}', "points"), ("numbers without end", json.dumps({"points": [[0, 1e999]] * 5, "kinds": ["pins4"]}).encode(), "numbers"),
                             ("too many points", json.dumps({"points": [[k, k] for k in range(500)], "kinds": ["pins4"]}).encode(), "400"),
                             ("a kind that is none", json.dumps({"points": [[0, 0], [1, 0], [0, 1]], "kinds": ["x' &END"]}).encode(), "kinds"),
                             ("hours", json.dumps({"points": [[0, 0], [1, 0], [0, 1]], "kinds": ["pins4"], "seconds": 1e5}).encode(), "seconds")):
        status, answer, _ = server.ask("/search", body)
        check("refused: a search with " + law, status == 400 and words in answer, "%d %s" % (status, answer[:200]))
    status, answer, _ = server.ask("/look", b"T\xff\n")
    check("refused: bytes that are no text", status == 400, answer)


def test_many(server):
    """Very many requests, and cases that would go on for hours: few studies at once, each with an end, and the server answers on."""
    case = read(FOUR_BAR)
    began = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(40) as pool:
        codes = list(pool.map(lambda k: server.ask("/look", case.encode(), X_Psalm_Token=None)[0], range(1500)))
        busy = list(pool.map(lambda k: server.ask("/look", case.encode(), X_Psalm_Page=str(k))[0], range(60)))
    check("bounded: 1500 requests without a token", set(codes) <= {403, 503, 0}, str({c: codes.count(c) for c in set(codes)}))
    check("bounded: 60 looks at once", set(busy) <= {200, 429, 503} and 200 in busy, str({c: busy.count(c) for c in set(busy)}))
    print("workbench: 1560 requests in %.1f s" % (time.monotonic() - began))
    check("bounded: few processes", len(server.studies()) <= 5, str(server.studies()))
    endless = case.replace("IKIN=15", "NDES=100000, DELT=" + ",".join("%d*%d.0" % (1000, k % 7) for k in range(100)))
    steps = read(os.path.join(DATA, "time", "pendulum.nml")).replace("TEND=10.0", "TEND=1.0E5")     # a swing takes about a millisecond: a minute
    check("there is a long motion", "TEND=1.0E5" in steps)
    grid = re.sub(r"&METHOD.*?&END", "", read(os.path.join(DATA, "excavator_envelope.nml")))
    grid = re.sub(r"NGRID=[\d,]*\d", "NGRID=1000,1000,1000", grid)
    check("there is a grid", "NGRID=1000,1000,1000" in grid)
    for law, text in (("100 000 positions", endless), ("a motion of 10^5 s", steps), ("10^9 strokes", grid)):
        began = time.monotonic()
        status, answer = server.look(text)
        took = time.monotonic() - began
        check("bounded: %s: there is an answer in time" % law, status == 200 and took < 8.0, "%d %.1f s %s" % (status, took, str(answer)[:200]))
        if text is steps:
            check("bounded: a study that takes too long is ended", "was ended" in answer.get("error", "") and took > 2.5, "%.1f s %s" % (took, str(answer)[:200]))
    # a later look of the same page ends the one before
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        began = time.monotonic()
        late = pool.submit(server.ask, "/look", steps.encode(), X_Psalm_Page="same")
        time.sleep(0.4)
        early = server.ask("/look", case.encode(), X_Psalm_Page="same")
        took = time.monotonic() - began
        check("a later look of a page ends the one before", "motion" in early[1] and '"stale":true' in late.result()[1] and took < 2.5, "%.1f s %s" % (took, late.result()[1][:200]))
    wanted = json.dumps({"points": [[math.cos(k), math.sin(2*k)] for k in range(24)], "closed": True, "kinds": ["pins6"], "seconds": 600}).encode()
    names = [server.ask("/search", wanted) for _ in range(3)]
    check("bounded: two searches at once", [one[0] for one in names] == [200, 200, 429], str(names))
    names = [json.loads(one[1])["search"] for one in names[:2]]
    check("searches run", all('"running":true' in server.ask("/search/" + name)[1] for name in names))
    began = time.monotonic()
    for name in names:
        server.ask("/search/%s/stop" % name, b"")
    took = time.monotonic() - began
    check("searches end when they are stopped", all('"running":false' in server.ask("/search/" + name)[1] for name in names) and took < 8.0, "%.1f s" % took)
    check("a search that is not there", server.ask("/search/0123456789abcdef")[0] == 404)
    # a study that hears nothing is ended by force: stopped by the system, it cannot end by itself
    name = json.loads(server.ask("/search", wanted)[1])["search"]
    time.sleep(0.5)
    heaviest = max(server.studies(), key=processor_time)
    os.kill(heaviest, signal.SIGSTOP)
    began = time.monotonic()
    server.ask("/search/%s/stop" % name, b"")
    time.sleep(0.3)
    check("a study that hears nothing is ended", not os.path.exists("/proc/%d" % heaviest) and time.monotonic() - began < 8.0)


def test_patience():
    """Requests that never end, and searches that nobody asks about: with shorter times than a user has."""
    os.environ["PSALM_LIBRARY"] = library()
    sys.path.insert(0, os.path.join(TOP, "python"))
    from psalm import workbench
    workbench.PATIENCE, workbench.FORGOTTEN = 0.2, 1.0
    told = []

    async def slow(scope=None):
        await asyncio.sleep(0.01 if not told else 5.0)
        told.append(1)
        return {"type": "http.request", "body": b"x", "more_body": True}

    answer = []

    async def send(message):
        answer.append(message)

    async def both():
        guard = workbench.Guard(None, "secret", {"here:1"})
        await guard({"type": "http", "path": "/look", "query_string": b"", "headers": [(b"host", b"here:1"), (b"x-psalm-token", b"secret")]}, slow, send)
        studies = workbench.Studies(5.0)
        began = time.monotonic()
        name = await studies.search(workbench.request_of(json.dumps({"points": [[math.cos(k), math.sin(2*k)] for k in range(24)], "closed": True,
                                                                     "kinds": ["pins6"], "round": 4})))
        one = studies.searches[name]
        await one.task
        took = time.monotonic() - began
        await studies.close()
        return one, took

    one, took = asyncio.run(both())
    check("bounded: a body that does not end", answer[0]["status"] == 408, str(answer))
    check("bounded: a search that nobody asks about", not one.running and one.events[-1].get("late") and took < 6.0 and one.process.process.returncode is not None,
          "%.1f s %s" % (took, one.events))


def processor_time(process):
    with contextlib.suppress(OSError):
        words = read("/proc/%d/stat" % process).rpartition(")")[2].split()
        return int(words[11]) + int(words[12])
    return 0


# ---- in the browser -----------------------------------------------------------------------------------------------------

class Bench(Board):
    """The board that the workbench serves. (Its page lets nobody evaluate texts, so functions that wait do so here.)"""

    def __init__(self, browser, url, width=1280, height=800, **more):
        self.complaints, self.requests, self.dialogs = [], [], []
        self.context = browser.new_context(viewport={"width": width, "height": height}, **more)
        self.context.set_default_timeout(1000*PATIENCE)
        self.page = self.context.new_page()
        self.page.on("console", lambda m: m.type in ("error", "warning") and self.complaints.append(m.text))
        self.page.on("pageerror", lambda e: self.complaints.append(str(e)))
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.page.on("dialog", lambda d: (self.dialogs.append(d.message), d.accept()))
        self.page.goto(url)
        self.until("board.tools")

    def until(self, what, seconds=PATIENCE):
        end = time.monotonic() + seconds
        while not self.ask("Boolean(%s)" % what):
            if time.monotonic() > end:
                raise TimeoutError(what)
            time.sleep(0.02)

    def trace(self, points):
        """A curve by hand."""
        places = [self.at(*points[0])] + [self.ask("board.view.screen(%r, %r)" % tuple(p)) for p in points[1:]]
        self.page.mouse.move(*places[0])
        self.page.mouse.down()
        for place in places[1:]:
            self.page.mouse.move(*place)
        self.page.mouse.up()


def heart(k, n=40):
    t = 2*math.pi*k/n
    return (60 + 35*math.cos(t), 60 + 18*math.sin(t) + 6*math.cos(2*t))


def test_story(server, browser, shots, width, height):
    """An empty board, a four-bar with a coupler point, a curve drawn, a search, one chosen, its forces."""
    law = "story, %d x %d: " % (width, height)
    bench = Bench(browser, server.url, width, height)
    page = bench.page
    if width < 900:
        bench.ask("board.view.look([-40, -40, 120, 120])")
    bench.ask("document.getElementById('grid').value = '5'; document.getElementById('grid').dispatchEvent(new Event('change'))")
    for start, end in (((0, 0), (0, 30)), ((0, 30), (60, 80)), ((60, 80), (100, 0))):
        bench.pull(start, end)
    bench.tool("pivot")
    bench.click(0, 0)
    bench.click(100, 0)
    bench.tool("drive")
    bench.click(0, 0)
    bench.tool("link")
    bench.click(30, 55)
    bench.tool("select")
    bench.pull((30, 55), (20, 90))
    bench.tool("output")
    bench.click(20, 90)
    check(law + "a four-bar with a coupler point moves", "it moves" in bench.chip() and len(bench.sketch()["joints"]) == 5, bench.chip())
    page.click("#tab-engine")
    bench.until("board.engine.answer")
    joints = bench.ask("board.engine.answer.motion.joints.E")
    mine = bench.ask("board.state.motion.sweep.places.map((one) => one[4])")
    away = max(math.dist(p, (x, y)) for p, x, y in zip(mine, *joints))
    check(law + "the engine has the same path as the board", len(joints[0]) == len(mine) == 360 and away < 1e-5, "%.1e" % away)
    check(law + "the summary is there", "crank-rocker" in page.text_content("#engine") and "Transmission angle" in page.text_content("#engine"))
    check(law + "velocities are drawn", {one["kind"] for one in bench.ask("board.engine.arrows()")} == {"velocity"})
    page.fill('[aria-label="load along y, N"]', "-20")
    page.click("text=Set load")
    bench.until("board.engine.answer && board.engine.answer.motion.forces")
    check(law + "forces are drawn", {one["kind"] for one in bench.ask("board.engine.arrows()")} == {"velocity", "force", "load"})
    bench.ask("board.go(45)")
    if shots:
        page.wait_for_timeout(200)
        page.screenshot(path=os.path.join(shots, "bench_forces_%d.png" % width))
    bench.save("story_%d.nml" % width)
    compare_forces(law, bench, "story_%d.nml" % width)
    compare_conditions(law, bench, "story_%d.nml" % width)
    bench.tool("wanted")
    bench.trace([heart(k) for k in range(41)])
    wanted = bench.ask("board.state.wanted")
    check(law + "the curve is drawn, closed, evenly", wanted["closed"] and len(wanted["points"]) == 24 and
          max(min(math.dist(p, heart(k/10)) for k in range(400)) for p in wanted["points"]) < 2.5, str(wanted)[:200])
    before = bench.sketch()
    if width < 900:
        page.uncheck('[aria-label="six-bars"]')
        page.uncheck('[aria-label="with a slide"]')
    page.click("#start-search")
    bench.until("board.search.cards.length > %d" % (0 if width < 900 else 2))
    first = bench.ask("board.search.cards[0].error")
    page.click("#stop-search")
    bench.until("!board.search.running")
    page.click("#start-search")      # it goes on
    bench.until("board.search.running")
    page.click("#stop-search")
    bench.until("!board.search.running")
    check(law + "what was found stays", bench.ask("board.search.cards[0].error") <= first and not page.text_content("#search .wrong"), page.text_content("#search .wrong"))
    if shots:
        page.screenshot(path=os.path.join(shots, "bench_search_%d.png" % width))
    if width > 900:
        with page.expect_download() as download:
            page.click("text=Save as data set")
        download.value.save_as("wanted.nml")
        code, _, errors = picture_tools.psalm("--quiet", "wanted.nml")
        check(law + "psalm runs the search that was saved", code in (0, 1) and "&KINDS" in read("wanted.nml"), errors)
    card = bench.ask("board.search.cards[0]")
    page.click("#search .card")
    check(law + "the one chosen is the sketch", bench.ask("board.state.sketch.title").endswith(card["kind"]) and "it moves" in bench.chip(), bench.chip())
    path = bench.ask("board.state.motion.sweep.places.map((one) => one[board.state.sketch.joints.findIndex((j) => j.name === 'P')])")
    error = math.sqrt(sum(min(math.dist(p, q) for q in path)**2 for p in wanted["points"])/len(wanted["points"]))
    check(law + "it draws the curve as the search says", error <= card["error"]*1.2 + 0.5 and card["part"] < 0.05, "%g %g" % (error, card["error"]))
    page.click("#tab-engine")
    bench.until("board.engine.answer")
    page.select_option('[aria-label="joint that the load is at"]', "P")
    page.fill('[aria-label="load along x, N"]', "15")
    page.click("text=Set load")
    bench.until("board.engine.answer && board.engine.answer.motion.forces")
    check(law + "its forces", any(one["kind"] == "force" for one in bench.ask("board.engine.arrows()")) and "force at" in page.text_content("#engine"))
    if shots:
        page.wait_for_timeout(200)
        page.screenshot(path=os.path.join(shots, "bench_chosen_%d.png" % width))
    page.click("#undo")
    page.click("#undo")
    check(law + "undo goes back through it all", bench.sketch() == before and bench.ask("board.state.wanted.points.length") == 24, str(bench.sketch()["title"]))
    page.click("#undo")
    check(law + "and through the curve", bench.ask("board.state.wanted") is None)
    check(law + "nothing is wider than the screen", bench.ask("document.documentElement.scrollWidth") <= width)
    check(law + "every control has a name", bench.ask("""[...document.querySelectorAll('button,select,input,textarea')].every(
        (e) => e.getAttribute('aria-label') || e.closest('label')?.textContent.trim() || e.textContent.trim())"""))
    check(law + "it asks nothing but its server", all(u.startswith(("http://127.0.0.1:%d/" % server.port, "data:", "blob:")) for u in bench.requests), str(bench.requests[:5]))
    check(law + "no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()


def compare_forces(law, bench, name):
    """The forces on the page are those of kalm at its positions."""
    text = read(name)
    write(name, text)
    code, _, errors = run(os.path.join(picture_tools.programs, "kalm"), "--quiet", "--json", name, cwd=os.getcwd())
    if not check(law + "kalm runs the file", code in (0, 1), errors):
        return
    with open(name[:-4] + ".kalm.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    answer = bench.ask("board.engine.answer.motion")
    worst = largest = 0.0
    for row in rows:
        at = answer["input"].index(float(row["input"]))
        for joint, (fx, fy) in answer["forces"]["joints"].items():
            for component, values in (("_fx", fx), ("_fy", fy)):
                worst = max(worst, abs(values[at] - float(row[joint + component])))
                largest = max(largest, abs(float(row[joint + component])))
    check(law + "its forces are those of kalm", len(rows) == 24 and largest > 1.0 and worst < 1e-5*largest, "%d %.1e of %.1e" % (len(rows), worst, largest))


def compare_conditions(law, bench, name):
    """The condition number on the page is that of psalm."""
    write("icond.nml", re.sub(r"IKIN=\d+", "IKIN=5", read(name)).replace("&LIMITS", "&LIMITS ICOND=1,", 1))
    code, _, errors = run(os.path.join(picture_tools.programs, "psalm"), "--quiet", "icond.nml", cwd=os.getcwd())
    if not check(law + "psalm runs the file", code in (0, 1), errors):
        return
    with open("icond.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    answer = bench.ask("board.engine.answer.condition")
    (output, values), = answer["outputs"].items()
    worst = max(abs(value/float(row[output + ".condition"]) - 1) for value, row in zip(values, rows))
    check(law + "the condition numbers are those of psalm", len(rows) == len(values) == 72 and worst < 1e-6, "%d %d %.1e" % (len(rows), len(values), worst))
    check(law + "the one at the position shown is listed", "condition number of " + output in bench.page.text_content("#engine"))


def test_text(server, browser):
    """Text and drawing follow each other; what the engine finds stands at its line; answers that are late are dropped."""
    with_case = Bench(browser, server.url)
    page = with_case.page
    check("a case of the command line is on the board", with_case.ask("board.write()") == read(FOUR_BAR) and with_case.ask("board.state.file") == "sketch_four_bar.nml")
    page.click("#tab-text")
    check("the text is what a file would be", page.input_value("#source") == read(FOUR_BAR))
    page.fill("#source", read(FOUR_BAR).replace("JX=0.0,", "JX=-5.0,"))
    with_case.until("board.state.sketch.joints[0].x === -5")
    with_case.ask("board.edit((sketch) => { sketch.joints[0].y = 7; })")
    check("the drawing goes to the text", "JY=7.0," in page.input_value("#source") and "! A four-bar" in page.input_value("#source"), page.input_value("#source"))
    text = page.input_value("#source")
    line = next(k for k, one in enumerate(text.split("\n"), 1) if "TANGLE=80.0" in one)
    page.fill("#source", text.replace("TANGLE=80.0", "TANGLE=80.0, TRMNI=5.0"))
    with_case.until("document.querySelector('#faults .error')")
    told = page.text_content("#faults")
    check("what the engine finds stands at its line", told.startswith("line %d: " % line) and "TRMNI" in told, told)
    page.fill("#source", text.replace("'A D'", "'A Q'"))
    with_case.until("document.querySelector('#faults')?.textContent.includes('Q')")
    check("a mistake leaves the drawing", with_case.ask("board.state.sketch.links[0].joints.join()") == "A,D")
    with_case.ask("board.edit((sketch) => { sketch.joints[0].y = 8; })")
    check("the drawing goes on, and the text is kept aside", "JY=8.0," in page.input_value("#source") and page.is_visible("text=Back to my text"))
    page.click("text=Back to my text")
    check("the text is back", "'A Q'" in page.input_value("#source"))
    with_case.ask("board.undo(); board.undo(); board.undo()")
    with_case.page.reload()
    with_case.until("board.tools")
    # answers that come late
    with_case.until("board.engine.answer")
    with_case.ask("""{ const places = []; for (let k = 0; k < 30; k++) setTimeout(() => board.edit((s) => { s.joints[0].x = k / 10; }), 30 * k); }""")
    with_case.until("board.state.sketch.joints[0].x === 2.9")
    with_case.until("board.engine.answer")
    joint = with_case.ask("board.engine.answer.motion.joints.A[0]")
    check("the answer is to what is on the board", joint == 2.9 and "JX=2.9" in with_case.ask("board.engine.answer.text"), str(joint))
    # hostile names on the page
    with_case.ask("""board.load("<img src=x onerror=alert(1)>\\n &CHAIN JNT='<i>','B','C','D', JX=0.,0.,60.,100., JY=0.,30.,80.,0., LNAME='fr','<script>alert(2)</script>','c','r',"""
                  """ LNK='<i> D','<i> B','B C','C D' &END\\n &DRIVES DRIVE='<i>' &END\\n &OUTPUTS OUTPUT='point C' &END\\n &METHOD IKIN=15 &END\\n &LIMITS TANGLE=89. &END\\n")""")
    with_case.until("board.engine.answer")
    for tab in ("panel", "text", "engine", "search"):
        page.click("#tab-" + tab)
    check("hostile names are words on the page", not with_case.dialogs and not page.query_selector("main img, main i, main script"), str(with_case.dialogs))
    check("text: no complaint", not with_case.complaints, str(with_case.complaints))
    with_case.context.close()


def test_results(server, browser):
    """What is proven, assemblies, tolerances."""
    bench = Bench(browser, server.url)
    page = bench.page
    page.click("#tab-engine")
    bench.until("board.engine.answer")
    bench.until("board.engine.answer && board.engine.answer.proof")
    proof = bench.ask("board.engine.answer.proof")
    check("proven: it closes over the whole turn", [(one["kind"], one["from"], one["to"]) for one in proof["limits"]] == [("closes", 0, 360)], str(proof["limits"]))
    angle = next(one for one in proof["extremes"] if "transmission" in one["of"])
    values = bench.ask("board.engine.answer.motion.angle[0].values")
    check("proven: the least angle is that of the positions", 0 <= min(values) - angle["least_low"] < 0.01 and "Proven" in page.text_content("#engine"), str(angle))
    check("proven: it stands below the slider", len(page.query_selector_all("#drives .proven .closes")) > 0 and len(page.query_selector_all("#drives .proven .dead")) >= 4)
    ways = bench.ask("board.engine.answer.assemblies")
    check("assemblies: both of a four-bar, one of them drawn", [one["drawn"] for one in ways] == [True, False], str(ways))
    # the other one by circles: C is mirrored at the line from B to D
    (bx, by), (cx, cy), (dx, dy) = (ways[0]["joints"][name] for name in "BCD")
    u, v = (dx - bx)/math.dist((bx, by), (dx, dy)), (dy - by)/math.dist((bx, by), (dx, dy))
    along, across = (cx - bx)*u + (cy - by)*v, (cy - by)*u - (cx - bx)*v
    there = bx + along*u + across*v, by + along*v - across*u
    page.click('[aria-label="assembly 2"]')
    bench.until("board.engine.answer")
    joint = next(one for one in bench.sketch()["joints"] if one["name"] == "C")
    check("assemblies: the one chosen is drawn", math.dist(there, (joint["x"], joint["y"])) < 1e-9 and "it moves" in bench.chip(), "%s %s" % (there, joint))
    page.click("#undo")
    bench.until("board.engine.answer")
    page.fill('[aria-label="tolerance of all lengths, to either side; 0: none"]', "0.5")
    page.keyboard.press("Enter")
    bench.until("board.engine.answer && board.engine.answer.motion.band")
    write("band.nml", bench.ask("board.write()"))
    code, _, errors = picture_tools.psalm("--quiet", "--json", "band.nml")
    check("tolerances: psalm runs the file", code in (0, 1) and "TOLLEN=0.5" in read("band.nml"), errors)
    answer = bench.ask("board.engine.answer.motion")
    with open("band.tolerances.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    worst = max(abs(float(row["output.%s.%s" % (axis, column)]) - answer["band"][k][name][answer["input"].index(float(row["input"]))])
                for row in rows for k, axis in enumerate("xy") for name, column in (("worst", "worst_case"), ("square", "root_sum_square")))
    check("tolerances: the band is that of psalm", len(rows) == 24 and worst < 1e-6, "%.1e" % worst)
    check("results: no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()


def test_studies(server, browser, shots):
    """What the groups of a case ask for: counterweights as muscle finds them, and a search that is stopped."""
    bench = Bench(browser, server.url)
    page = bench.page
    name = os.path.join(DATA, "muscle", "thesis_ten_bar.nml")
    bench.ask("board.load(%s, 'ten_bar.nml')" % json.dumps(read(name)))
    page.click("#tab-engine")
    bench.until("board.engine.answer")
    page.select_option('[aria-label="Studies"]', "balance")
    page.click("#run-study")
    bench.until("!document.querySelector('.listing').hidden")
    code, listing, errors = run(os.path.join(picture_tools.programs, "muscle"), "--quiet", "--output-dir", ".", name, cwd=os.getcwd())
    shown = page.text_content(".listing")
    lines = [line for line in listing.split("\n") if line.strip()]
    check("studies: counterweights, the listing of muscle", code in (0, 1) and len(lines) > 30 and all(line.strip() in shown for line in lines), errors)
    before = bench.ask("board.write()")
    page.click(".study .card")
    check("studies: the linkage with its weights is on the board", bench.ask("board.write()") != before and "it moves" in bench.chip() and "MASSES" in bench.ask("board.write()"))
    bench.until("board.engine.answer")
    if shots:
        page.evaluate("document.querySelector('.study').scrollIntoView()")
        page.screenshot(path=os.path.join(shots, "bench_study.png"))
    search = re.sub(r"NSTART=\d+", "NSTART=1000000", read(os.path.join(DATA, "types", "similar_path.nml")))
    bench.ask("board.load(%s, 'path.nml')" % json.dumps(search))
    page.select_option('[aria-label="Studies"]', "synthesis")
    page.click("#run-study")
    bench.until("document.querySelector('.study [role=status]').textContent.includes('1000000')")
    page.click("#stop-study")
    bench.until("!board.study.running")
    check("studies: a search that is stopped has what it found", len(page.query_selector_all(".study .card")) == 1 and "best objective" in page.text_content(".listing"),
          page.text_content(".study"))
    page.select_option('[aria-label="Studies"]', "time")
    page.click("#run-study")
    bench.until("document.querySelector('.study .wrong').textContent")
    check("studies: what is missing is said", "&TIME" in page.text_content(".study .wrong"), page.text_content(".study .wrong"))
    for verb in ("board", "picture", "x", None):
        check("studies: the verb %s is refused" % verb, server.ask("/run", json.dumps({"verb": verb, "case": search}).encode())[0] == 400)
    check("studies: no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()


def test_curves(server, browser):
    """Wanted curves from files."""
    write("curve.csv", "x;y\n" + "".join("%s;%s\n" % tuple(("%.3f" % v).replace(".", ",") for v in heart(k)) for k in range(40)))
    write("curve.svg", '<svg xmlns="http://www.w3.org/2000/svg" onload="alert(1)"><g transform="translate(10 20)"><script>alert(2)</script>'
                       '<path transform="scale(2)" d="M0 0H50V30H0z"/></g></svg>')
    write("no_curve.csv", "nothing\n")
    bench = Bench(browser, server.url)
    bench.page.click("#tab-search")
    files = '[aria-label="Open a curve"]'
    bench.page.set_input_files(files, "curve.csv")
    bench.until("board.state.wanted")
    wanted = bench.ask("board.state.wanted")
    check("a curve from a table", wanted["closed"] and len(wanted["points"]) == 40 and math.dist(wanted["points"][3], heart(3)) < 1e-3, str(wanted)[:200])
    bench.page.set_input_files(files, "curve.svg")
    bench.until("board.state.wanted.points.length === 24")
    points = bench.ask("board.state.wanted.points")
    check("a curve from a picture, with its transforms, y upwards", abs(min(p[0] for p in points) - 10) < 1e-4 and abs(max(p[0] for p in points) - 110) < 1e-4 and
          abs(max(p[1] for p in points) + 20) < 1e-4 and abs(min(p[1] for p in points) + 80) < 1e-4, str(points))
    bench.page.set_input_files(files, "no_curve.csv")
    bench.until("document.querySelector('#search .wrong').textContent")
    check("a file without a curve", "no_curve.csv: no curve was found" in bench.page.text_content("#search .wrong"))
    # the linkage that is drawn, one of its lengths locked
    bench.ask("board.load(%s, 'four.nml')" % json.dumps(read(FOUR_BAR)))
    bench.page.set_input_files(files, "curve.csv")
    bench.until("board.state.wanted.points.length === 40")
    bench.ask("board.edit((sketch) => { sketch.lengths = [{ joints: ['A', 'B'], value: 21 }]; board.relax(sketch); })")
    bench.page.click("#tab-search")
    for kind in ("four-bars", "with a slide", "six-bars"):
        bench.page.uncheck('[aria-label="%s"]' % kind)
    bench.page.check('[aria-label="this linkage"]')
    bench.page.click("#start-search")
    bench.until("board.search.cards.length || document.querySelector('#search .wrong').textContent")
    bench.page.click("#stop-search")
    bench.until("!board.search.running")
    card = bench.ask("board.search.cards[0]")
    check("this linkage is varied", card and card["kind"] == "mine" and card["part"] < 0.1, bench.page.text_content("#search .wrong"))
    bench.page.click("#search .card")
    joints = {one["name"]: (one["x"], one["y"]) for one in bench.sketch()["joints"]}
    path = bench.ask("board.state.motion.sweep.places.map((one) => one[board.state.sketch.joints.findIndex((j) => j.name === 'P')])")
    error = math.sqrt(sum(min(math.dist(p, q) for q in path)**2 for p in (heart(k) for k in range(40)))/40)
    check("this linkage: what is locked stays", abs(math.dist(joints["A"], joints["B"]) - 21.0) < 1e-9, str(joints))
    check("this linkage: it draws the curve as the search says", error <= card["error"]*1.2 + 0.5, "%g %g" % (error, card["error"]))
    bench.page.click("#tab-engine")
    bench.until("board.engine.answer")
    for name, ending in (("DXF", ".dxf"), ("moving SVG", ".move.svg")):
        with bench.page.expect_download() as download:
            bench.page.click('#engine .files >> text="%s"' % name)
        download.value.save_as("four" + ending)
    drawn = ezdxf.readfile("four.dxf")
    check("files: a DXF that another program reads", len(drawn.modelspace()) > 5, len(drawn.modelspace()))
    check("files: a picture that moves", "<animate" in read("four.move.svg"))
    check("curves: no complaint, nothing run", not bench.dialogs and not [c for c in bench.complaints if "Content Security" not in c], str(bench.complaints + bench.dialogs))
    bench.context.close()


def test_several(server, browser, shots):
    """Several things chosen by a box, by Shift and by keys: moved together, taken away together, undone at once."""
    bench = Bench(browser, server.url)
    page = bench.page
    bench.until("board.state.motion.sweep")
    before = bench.sketch()

    def chosen():
        return sorted(next(iter(one.values())) for one in bench.ask("board.each()"))

    def places():
        return {joint["name"]: (joint["x"], joint["y"]) for joint in bench.sketch()["joints"]}

    start = places()
    bench.ask("document.getElementById('grid').value = '5'; document.getElementById('grid').dispatchEvent(new Event('change'))")
    names = [joint["name"] for joint in before["joints"]]
    first, second = names[0], names[1]
    bench.tool("select")
    bench.click(*start[first])
    page.keyboard.down("Shift")
    bench.click(*start[second])
    page.keyboard.up("Shift")
    check("several: Shift and a click adds one", chosen() == sorted([first, second]), str(chosen()))
    page.keyboard.down("Shift")
    bench.click(*start[second])
    page.keyboard.up("Shift")
    check("several: and takes it away again", chosen() == [first], str(chosen()))
    page.click("[data-tool=several]")
    xs, ys = [p[0] for p in start.values()], [p[1] for p in start.values()]
    edge = 0.12 * max(max(xs) - min(xs), max(ys) - min(ys))
    bench.pull((min(xs) - edge, min(ys) - edge), (max(xs) + edge, max(ys) + edge))
    check("several: a box takes all in it", chosen() == sorted(names), str(chosen()))
    if shots:
        page.screenshot(path=os.path.join(shots, "bench_several.png"))
    x, y = start[first]
    bench.pull((x, y), (x + 10, y + 5))
    moved = places()
    check("several: they move together", all(math.dist(moved[n], (start[n][0] + 10, start[n][1] + 5)) < 1e-9 for n in names), str(moved))
    bench.ask("board.view.canvas.focus()")
    page.keyboard.press("ArrowLeft")
    check("several: by keys, too", all(abs(places()[n][0] - moved[n][0] + 5) < 1e-9 for n in names), str(places()))
    page.click("#undo")
    page.click("#undo")
    check("several: one undo for each", places() == start)
    page.keyboard.press("Control+a")
    check("several: Ctrl+A", chosen() == sorted(names))
    page.fill('[aria-label="step along x"]', "2.5")
    page.click('#panel button:text-is("Move")')
    check("several: by a number", all(abs(places()[n][0] - start[n][0] - 2.5) < 1e-9 for n in names))
    page.click("#undo")
    page.click('#panel [aria-label="joint %s"]' % first)
    page.click('#panel [aria-label="joint %s"]' % second, modifiers=["Shift"])
    check("several: from the lists", chosen() == sorted([first, second]), str(chosen()))
    page.keyboard.press("Delete")
    check("several: taken away together", not {first, second} & set(places()) and len(bench.sketch()["joints"]) < len(names), str(places()))
    page.click("#undo")
    check("several: undo brings them back", bench.sketch()["joints"] == before["joints"] and bench.sketch()["links"] == before["links"])
    bench.tool("select")
    bench.click(*start[first])
    bench.pull(start[first], (start[first][0] - 10, start[first][1]))
    check("several: one alone is dragged alone", math.dist(places()[second], start[second]) < 1e-9 and places()[first] != start[first])
    check("several: no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()


def test_import(server, browser, shots):
    """Files of other programs on the board; what is missing is asked for; what cannot be is refused and bounded."""
    bench = Bench(browser, server.url)
    page = bench.page
    document = ezdxf.new()
    at = {"A": (0, 0), "B": (0, 31), "C": (33, 82), "D": (90, 5)}
    for pair in ("AB", "BC", "CD"):
        document.modelspace().add_line(at[pair[0]], at[pair[1]])
    document.saveas("bare.dxf")
    page.set_input_files("#file", "bare.dxf")
    page.wait_for_selector("#dialog[open]")
    said = page.text_content("#dialog")
    check("import: what the file does not say is asked for", "no joint is fixed" in said and "A (0, 0)" in said, said)
    if shots:
        page.screenshot(path=os.path.join(shots, "bench_import.png"))
    page.fill('[aria-label="joints of the frame"]', "A D")
    page.fill('[aria-label="driven joint"]', "A")
    page.keyboard.press("Enter")
    bench.until("board.state.sketch.title === 'BARE'")
    check("import: a drawing is a sketch that moves", "it moves" in bench.chip() and len(bench.sketch()["links"]) == 4, bench.chip())
    check("import: what was assumed stands in the text", bench.ask("board.write()").startswith("! lengths are metres"), bench.ask("board.write()")[:200])
    page.click("#undo")
    check("import: undo brings back what was there", bench.ask("board.state.sketch.title") != "BARE")
    with open("bad.json", "w", encoding="utf-8") as file:
        file.write("{}")
    page.set_input_files("#file", "bad.json")
    page.wait_for_selector("#dialog[open]")
    check("import: what is no linkage is refused with the reason", "no linkage of pylinkage" in page.text_content("#dialog"), page.text_content("#dialog"))
    page.keyboard.press("Escape")
    with open("large.dxf", "wb") as file:
        file.write(b"0\n" * (3 << 20))
    page.set_input_files("#file", "large.dxf")
    bench.until("board.state.messages.length")
    check("import: a large file is refused here", "larger than 5 MB" in bench.chip(), bench.chip())
    check("import: no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()
    for body, status in ((b"[]", 400), (b"{}", 400), (b'{"name":"a.dxf","content":"*"}', 400), (b'{"name":"","content":""}', 400), (b"x" * 9000000, 413)):
        found = server.ask("/import", body)
        check("import: bounded: %r" % body[:30], found[0] in (status, 0) if status == 413 else found[0] == status, str(found[:2]))
    status, answer, _ = server.ask("/import", json.dumps({"name": "/etc/passwd.json", "content": ""}).encode())
    check("import: a name is no file on this machine", status == 200 and "root" not in answer and "error" in json.loads(answer), answer)
    status, answer, _ = server.ask("/import", json.dumps({"name": "http://x/?abc.pmks", "content": ""}).encode())
    check("import: a link is read, not followed", status == 200 and "error" in json.loads(answer), answer)


def test_ranges(server, browser, shots):
    """Least and most of a dimension: in Properties, in the text, in the data set of a search, in what the search finds."""
    bench = Bench(browser, server.url)
    page = bench.page
    bench.until("board.state.motion.sweep")
    links = bench.sketch()["links"]
    coupler = next(link for link in links if len(link["joints"]) == 3)
    a, b, c = coupler["joints"]
    rocker = links[-1]
    page.click('#panel [aria-label="link %s"]' % rocker["name"])
    of = " ".join(rocker["joints"])
    page.fill('[aria-label="least %s"]' % of, "80")
    page.press('[aria-label="least %s"]' % of, "Enter")
    page.fill('[aria-label="most %s"]' % of, "70")
    page.press('[aria-label="most %s"]' % of, "Enter")
    check("ranges: most below least is refused", bench.ask("board.state.sketch.vary[0].high[0]") > 80)
    page.fill('[aria-label="most %s"]' % of, "95")
    page.press('[aria-label="most %s"]' % of, "Enter")
    text = bench.ask("board.write()")
    check("ranges: the text has them", "VARY='%s'" % of in text and re.search(r"VLOW=80\.0\b", text) and re.search(r"VHIGH=\s*95\.0\b", text), text)
    if shots:
        page.screenshot(path=os.path.join(shots, "bench_ranges.png"))
    page.click('#panel [aria-label="link %s"]' % coupler["name"])
    page.fill('[aria-label="most %s %s"]' % (a, b), "75")
    page.press('[aria-label="most %s %s"]' % (a, b), "Enter")
    check("ranges: of several", [one["of"] for one in bench.sketch()["vary"]] == [of, a + " " + b])
    bench.save("ranges.nml")
    code, _, errors = picture_tools.psalm("--quiet", "ranges.nml")
    check("ranges: psalm reads the file", code in (0, 1), errors)
    check("ranges: the board reads it again", bench.ask("board.text.parse(board.write()).vary") == bench.sketch()["vary"])
    # a search varies the linkage within them
    bench.tool("wanted")
    bench.trace([(x - 45, y + 5) for x, y in (heart(k) for k in range(41))])
    page.click("#tab-search")
    for kind in ("four-bars", "with a slide", "six-bars"):
        page.uncheck('[aria-label="%s"]' % kind)
    page.check('[aria-label="this linkage"]')
    page.click("#start-search")
    bench.until("board.search.cards.length")
    page.click("#stop-search")
    bench.until("!board.search.running")
    found = bench.ask("board.text.parse(board.search.cards[0].text)")
    at = {joint["name"]: (joint["x"], joint["y"]) for joint in found["joints"]}
    lengths = math.dist(*(at[name] for name in rocker["joints"])), math.dist(at[a], at[b])
    check("ranges: the search keeps within them", 80 - 1e-6 <= lengths[0] <= 95 + 1e-6 and lengths[1] <= 75 + 1e-6, str(lengths))
    page.click("#tab-panel")
    page.click('#panel [aria-label="no range of %s %s"]' % (a, b))
    check("ranges: one is taken back", [one["of"] for one in bench.sketch()["vary"]] == [of])
    bench.ask("board.rename('joint', %s, 'X9')" % json.dumps(rocker["joints"][0]))
    check("ranges: names follow", bench.sketch()["vary"][0]["of"] == " ".join(["X9", rocker["joints"][1]]), str(bench.sketch()["vary"]))
    bench.ask("board.remove({ joint: 'X9' })")
    check("ranges: and go with their joints", bench.sketch()["vary"] == [], str(bench.sketch()["vary"]))
    check("ranges: no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()
    good = {"points": [[0, 0], [1, 0], [0, 1]], "kinds": ["mine"], "vary": ["A B"], "case": "x"}
    for ranges in ([], {"A B": []}, {"A B": [[2, 1]]}, {"A B": [["1", 2]]}, {"C D": [[1, 2]]}, {"A B": [[1, 1e300]]}):
        check("ranges: refused: %s" % ranges, server.ask("/search", json.dumps({**good, "ranges": ranges}).encode())[0] == 400)


def test_proposals(server, browser, shots):
    """Counterweights, springs and a cam without their groups in the text: one is proposed, used, shown, and taken by a click."""
    bench = Bench(browser, server.url)
    page = bench.page
    bench.until("board.state.motion.sweep")
    page.click("#tab-engine")
    page.select_option('#engine [aria-label="Studies"]', "springs")
    page.click("#run-study")
    check("proposals: without masses there is none, and why", "give &MASSES" in page.text_content("#engine .study"), page.text_content("#engine .study"))
    text = bench.ask("board.write()")
    bench.ask("board.take(%s)" % json.dumps(text.rstrip("\n") + "\n &RATES SPEED=20.0 &END\n &MASSES MNAME='crank','coupler','rocker', MASS=1.0,2.0,1.0, "
                                            "MDIST=15.0,30.0,40.0, UNITL=0.001, GRAVY=-9.81 &END\n"))
    for verb, group, words in (("springs", "&SPRNGS", "SPRING"), ("balance", "&BALANC", "COUNTERWEIGHT"), ("cams", "&CAM", "BASE RADIUS")):
        page.select_option('#engine [aria-label="Studies"]', verb)
        check("proposals: nothing is left of another one", not page.query_selector("#engine [aria-label='group that is proposed']"))
        page.click("#run-study")
        bench.until("document.querySelector('#run-study').disabled === false && document.querySelector('#engine .study > pre').hidden === false")
        listing = page.text_content("#engine [aria-label='listing of the study']")
        check("proposals: %s has a result" % verb, words in listing.upper() and "error" not in page.text_content("#engine .study .wrong"), listing[:400] + page.text_content("#engine .study .wrong"))
        shown = page.text_content("#engine [aria-label='group that is proposed']")
        check("proposals: %s shows its group" % verb, group in shown and group not in bench.ask("board.write()"), shown)
        if shots and verb == "cams":
            page.evaluate("document.querySelector('#run-study').scrollIntoView()")
            page.screenshot(path=os.path.join(shots, "bench_proposal.png"))
        page.click("#engine >> text=Put it into the text")
        check("proposals: %s goes into the text" % verb, shown in bench.ask("board.write()"), bench.ask("board.write()")[-400:])
        bench.save("proposed.nml")
        program = {"springs": "muscle", "balance": "muscle", "cams": "calm"}[verb]
        code, _, errors = run(os.path.join(picture_tools.programs, program), "--quiet", "proposed.nml", cwd=os.getcwd())
        check("proposals: %s reads the file" % program, code in (0, 1), errors)
        page.click("#undo")
        check("proposals: undo takes it out", group not in bench.ask("board.write()"))
        page.click("#tab-engine")
    check("proposals: no complaint", not bench.complaints, str(bench.complaints))
    bench.context.close()


def test_phone(server, browser, shots):
    """On a phone the drawing stays in sight while results are read."""
    bench = Bench(browser, server.url, 390, 844)
    page = bench.page
    page.click("#tab-engine")
    bench.until("board.engine.answer")
    page.evaluate("window.scrollTo(0, document.documentElement.scrollHeight)")
    page.wait_for_timeout(200)
    top, bottom = bench.ask("(() => { const box = board.view.canvas.getBoundingClientRect(); return [box.top, box.bottom]; })()")
    check("phone: the drawing stays", -1 < top < 120 and 200 < bottom < 844 * 0.55, "%g %g" % (top, bottom))
    tabs = bench.ask("document.getElementById('tabs').getBoundingClientRect().top")
    check("phone: the tabs below it", bottom - 60 < tabs < 844 * 0.6, "%g %g" % (tabs, bottom))
    if shots:
        page.screenshot(path=os.path.join(shots, "bench_phone_scrolled.png"))
    check("phone: nothing is wider than the screen", bench.ask("document.documentElement.scrollWidth") <= 390)
    bench.context.close()


def test_file(browser):
    """What the board does by itself, from one file: text, links, drafts, gallery."""
    board = Board(browser, BOARD)
    board.context.set_default_timeout(1000*PATIENCE)
    page = board.page
    check("file: no results, no search without the engine", [t.text_content() for t in page.query_selector_all("#tabs button")] == ["Properties", "Text"])
    page.click("#gallery")
    names = page.eval_on_selector_all(".card", "(all) => all.map((one) => one.dataset.name)")
    check("gallery: thirty mechanisms", len(names) == len(set(names)) >= 30, len(names))
    drawn = page.eval_on_selector_all(".card", "(all) => all.map((one) => one.querySelectorAll('polygon').length > 0 && one.querySelectorAll('circle').length > 1 && !/NaN|Infinity/.test(one.innerHTML))")
    check("gallery: every one has its picture", all(drawn), str([n for n, good in zip(names, drawn) if not good]))
    page.fill('[aria-label="find in the gallery"]', "jansen")
    page.click(".card:visible")
    check("gallery: a click opens it", board.ask("board.state.file") == "jansen.nml" and "it moves" in board.chip(), board.chip())
    moving = board.ask("""board.examples.map((one) => { board.load(one.text, one.name); return board.state.messages.length ? one.name : ''; }).filter(Boolean)""")
    check("gallery: all of them move", moving == [], str(moving))
    board.ask("board.load(board.examples.find((one) => one.name === 'jansen').text, 'jansen.nml')")
    page.click("#share")
    page.wait_for_selector("dialog[open]")
    link = page.input_value('[aria-label="link to this sketch"]')
    page.click("dialog >> text=Close")
    text = board.ask("board.write()")
    check("link: it is short", len(link) < 900 and "#z=" in link, len(link))
    other = Board(browser, BOARD)
    other.page.goto("about:blank")
    other.page.goto(link)
    other.page.wait_for_function("board.state.sketch.joints.length > 0")
    check("link: the same sketch", other.ask("board.write()") == text and other.ask("board.state.file") == "jansen.nml")
    other.ask("location.hash = '#z=AAAA'")
    other.page.wait_for_function("document.getElementById('chip').className === 'wrong'")
    check("link: a broken one is told", "holds no data set" in other.chip(), other.chip())
    # 10 MB in 10 kB
    bomb = other.ask("(async () => board.store.packed('A'.repeat(1e7)))()")
    other.page.evaluate("(z) => { location.hash = '#z=' + z; }", bomb)
    other.page.wait_for_timeout(300)
    check("link: one that grows without measure", len(bomb) < 100000 and "holds no data set" in other.chip())
    other.page.evaluate("""(link) => { const data = new DataTransfer(); data.setData('text/plain', link);
        document.getElementById('board').dispatchEvent(new ClipboardEvent('paste', { clipboardData: data, bubbles: true, cancelable: true })); }""", link[link.index("#z="):])
    other.page.wait_for_function("board.state.messages.length === 0")
    check("link: pasted onto another board", other.ask("board.write()") == text)
    other.context.close()
    # a picture underneath
    write("photo.svg", '<svg xmlns="http://www.w3.org/2000/svg" width="200" height="100"><rect width="200" height="100" fill="red"/></svg>')
    write("photo.png", "no picture")
    drawn = board.pixels("board")
    page.set_input_files("#picture-file", "photo.png")
    page.wait_for_function("document.getElementById('hint').textContent.includes('photo.png')")
    check("picture: one that is none is told", "no picture" in page.text_content("#hint") and board.ask("board.picture.place") is None)
    page.set_input_files("#picture-file", "photo.svg")
    page.wait_for_function("board.picture.place")
    board.fill("width of the picture, lengths", "80")
    board.fill("x of the lower left corner of the picture", "-120")
    board.fill("how strongly the picture shows, 0 to 100", "100")
    colour = """(([x, y]) => { const c = document.getElementById('board'), b = c.getBoundingClientRect(), k = c.width / b.width, copy = document.createElement('canvas');
        [copy.width, copy.height] = [c.width, c.height];
        const pen = copy.getContext('2d', { willReadFrequently: true });
        pen.drawImage(c, 0, 0);
        return [...pen.getImageData(Math.round((x - b.left) * k), Math.round((y - b.top) * k), 1, 1).data].slice(0, 3); })(board.view.screen(%s, %s))"""
    y = board.ask("board.picture.place.y")
    inside, outside = board.ask(colour % (-117.3, y + 38.7)), board.ask(colour % (-122.7, y + 38.7))
    check("picture: it is where its properties say", inside[0] > 180 and inside[1] < 90 and outside[0] < 180, "%s %s" % (inside, outside))
    page.click("text=Take away")
    check("picture: taken away", board.pixels("board") == drawn)
    # a draft
    board.ask("board.edit((sketch) => { sketch.joints[0].x = 1.5; })")
    page.wait_for_function("localStorage.getItem('psalm.board')?.includes('1.5')")
    text = board.ask("board.write()")
    page.reload()
    page.wait_for_timeout(200)
    check("draft: there again after the page was closed", board.ask("board.write()") == text and "last time" in page.text_content("#hint"))
    page.click("#undo")
    check("draft: undo takes it away", board.ask("board.state.sketch.joints.length") == 0)
    page.click("#redo")
    page.click("#new")
    page.wait_for_timeout(400)
    page.reload()
    page.wait_for_timeout(200)
    check("draft: a new board is a new board", board.ask("board.state.sketch.joints.length") == 0)
    check("file: no complaint, nothing asked for", not board.complaints and all(u.startswith(("file:", "data:", "blob:")) for u in board.requests), str(board.complaints))
    board.context.close()


def test_frames(server, browser):
    """How long a frame takes while a joint of a ten-bar is dragged: the motion over its whole turn, found anew, and the picture."""
    drag(Board(browser, BOARD, 1280, 800), "from a file")
    board = Bench(browser, server.url)
    board.page.click("#tab-engine")
    drag(board, "with results")


def drag(board, law):
    board.ask("board.load(%s, 'ten.nml')" % json.dumps(read(os.path.join(DATA, "muscle", "thesis_ten_bar.nml"))))
    check("ten-bar: it moves", "it moves" in board.chip() and len(board.sketch()["links"]) == 10, "%s %d" % (board.chip(), len(board.sketch()["links"])))
    times = board.ask("""(() => {
        const moving = board.state.sketch.joints.find((j) => !board.inFrame(j.name)), { canvas } = board.view, times = [];
        const send = (type, x, y) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, bubbles: true, clientX: x, clientY: y }));
        document.getElementById('grid').value = '0';
        document.getElementById('grid').dispatchEvent(new Event('change'));
        const [x, y] = board.view.screen(moving.x, moving.y);
        send('pointerdown', x, y);
        for (let k = 0; k < 150; k++) {
            const began = performance.now();
            send('pointermove', x + 8 * Math.sin(k / 5), y + 8 * Math.cos(k / 7));
            times.push(performance.now() - began);
        }
        send('pointerup', x, y);
        return times.sort((a, b) => a - b);
    })()""")
    slow = times[int(0.95*len(times))]
    print("ten-bar dragged, " + law + ": 95 of 100 frames take at most %.1f ms, half of them %.1f ms" % (slow, times[len(times)//2]))
    check("ten-bar, %s: a frame is quick" % law, slow < BUSY*QUICK, "%.1f ms" % slow)
    board.context.close()


def timed(test, *arguments):
    began = time.monotonic()
    test(*arguments)
    print("%s: %.1f s" % (test.__name__, time.monotonic() - began))


def main(arguments):
    picture_tools.programs = os.path.abspath(arguments.pop(0))
    shots = os.path.abspath(arguments[0]) if arguments else None
    if shots:
        os.makedirs(shots, exist_ok=True)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        server, empty = Server(FOUR_BAR, "--seconds", "3"), Server()
        try:
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
                timed(test_story, empty, browser, shots, 1280, 800)
                timed(test_story, empty, browser, shots, 390, 844)
                timed(test_text, server, browser)
                timed(test_results, server, browser)
                timed(test_studies, server, browser, shots)
                timed(test_curves, empty, browser)
                timed(test_several, server, browser, shots)
                timed(test_import, server, browser, shots)
                timed(test_phone, server, browser, shots)
                timed(test_ranges, server, browser, shots)
                timed(test_proposals, server, browser, shots)
                timed(test_file, browser)
                timed(test_frames, server, browser)
                browser.close()
            timed(test_refusals, server)
            timed(test_bounds, server)
            timed(test_many, server)
            timed(test_patience)
        finally:
            left = server.end() + empty.end()
        time.sleep(0.3)
        check("nothing is left when it ends", not [one for one in left if os.path.exists("/proc/%d" % one)], str(left))
        os.chdir("/")
    print("%d passed, %d failed" % (picture_tools.passed, picture_tools.failed))
    return picture_tools.failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
