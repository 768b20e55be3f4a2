"""The workbench: the drawing board in a browser, with the engine behind it.

`psalm-workbench [CASE.nml]`, or `python -m psalm.workbench`, serves the board of `balm --edit` on this machine alone and opens it in
the browser. Needs Starlette and uvicorn: `pip install psalm[workbench]`.

Whatever asks for something must have the token of the address that is printed, be this machine under the name of the address, and be the
page itself. Every study is a process of its own (`psalm._study`), which opens no file and ends when it is stopped, takes too long or
wants too much memory.
"""
import argparse
import asyncio
import base64
import contextlib
import hashlib
import hmac
import json
import logging
import math
import os
import re
import secrets
import socket
import sys
import webbrowser

try:
    import uvicorn
    from starlette.applications import Starlette
    from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse
    from starlette.routing import Route
except ImportError as missing:
    raise SystemExit("psalm-workbench needs Starlette and uvicorn: pip install 'psalm[workbench]' (%s)" % missing) from None

import psalm
from psalm._study import KINDS, OWN, files_named

HOST = "127.0.0.1"
PORT = 7756                 # the same each time: the browser keeps drafts by address
LARGEST = 1 << 20           # bytes of a request
LARGEST_FILE = 8 << 20      # bytes of a request that brings a file of another program
MOST_NAME = 1000            # characters of its name, of the joints that are fixed, of a link of PMKS+
LARGEST_ANSWER = 16 << 20   # bytes of a line that a study prints
PATIENCE = 10.0             # seconds for the body of a request
LOOK_SECONDS = 10.0         # a look at a case is over by then, unless another time is given
SEARCH_SECONDS = 600.0      # so is a search, without another request of the page
FORGOTTEN = 150.0           # seconds without a question after which a search ends; a page that is not seen asks once a minute
END_SECONDS = 3.0           # a search that is asked for its end
LOOKS, SEARCHES = 2, 2      # studies at once
WAITING = 16                # looks that wait for a place
CONNECTIONS = 64            # at once
KEPT = 8                    # searches that have ended, results of which are still there
POINTS = 3, 400             # of a wanted curve
FAR = 1e9                   # its largest coordinate
MOST_VARY = 200             # dimensions that a search varies
VERBS = tuple(verb for verb in psalm.verbs if verb not in ("analysis", "summary", "picture", "board", "assemblies", "kinds"))
EMPTY = "PAGE\n &CHAIN JNT='A','B','C','D', JX=0.,0.,60.,100., JY=0.,30.,80.,0., LNK='A D','A B','B C','C D' &END\n" \
    " &DRIVES DRIVE='A' &END\n &METHOD IKIN=30 &END\n"
DATA = re.compile(r'<script type="application/json" id="data">.*?</script>', re.S)
SCRIPT = re.compile(r"<script>(.*?)</script>", re.S)
HEADERS = ((b"cache-control", b"no-store"), (b"x-content-type-options", b"nosniff"), (b"referrer-policy", b"no-referrer"),
           (b"cross-origin-resource-policy", b"same-origin"), (b"cross-origin-opener-policy", b"same-origin"),
           (b"x-frame-options", b"DENY"))


class Refused(Exception):
    """A request that is not answered: status and why."""

    def __init__(self, status, words):
        super().__init__(words)
        self.status, self.words = status, words


# ---- the page -----------------------------------------------------------------------------------------------------------

def page_of(token, case="", file=""):
    """The drawing board as the library has it, with the case on it, and what tells it that it is served; and its policy."""
    page = psalm.Case.from_text(EMPTY).board()
    data = {"file": file, "lines": case.removesuffix("\n").split("\n")} if case else {}
    inside = json.dumps(data).replace("<", "\\u003c")
    page = DATA.sub(lambda found: '<script type="application/json" id="data">%s</script>' % inside, page, count=1)
    page = re.sub(r"<title>.*?</title>", '<title>Workbench</title>\n<meta name="psalm-workbench" content="%s">' % token, page, count=1)
    scripts = " ".join("'sha256-%s'" % base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in SCRIPT.findall(page))
    policy = ("default-src 'none'; script-src %s; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'; "
              "base-uri 'none'; form-action 'none'; frame-ancestors 'none'" % scripts)
    return page, policy


# ---- who may ask --------------------------------------------------------------------------------------------------------

class Guard:
    """What comes before everything else: host, origin, token, size and time of a request."""

    def __init__(self, app, token, hosts):
        self.app, self.token, self.hosts = app, token, hosts

    async def __call__(self, scope, receive, send):
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":
            raise Refused(403, "this is no web socket")

        async def with_headers(message):
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *HEADERS]
            await send(message)

        try:
            self.look_at(scope)
            body = await asyncio.wait_for(self.body_of(scope, receive), PATIENCE)
        except Refused as refused:
            await JSONResponse({"error": refused.words}, refused.status)(scope, receive, with_headers)
            return
        except asyncio.TimeoutError:
            await JSONResponse({"error": "the request was too slow"}, 408)(scope, receive, with_headers)
            return
        given = [{"type": "http.request", "body": body, "more_body": False}]

        async def receive_again():
            return given.pop() if given else await receive()

        await self.app(scope, receive_again, with_headers)

    def look_at(self, scope):
        headers = {}
        for name, value in scope["headers"]:
            if name in headers and name in (b"host", b"origin", b"x-psalm-token", b"content-length"):
                raise Refused(400, "a header is there twice")
            headers[name] = value.decode("latin-1")
        host, origin = headers.get(b"host", ""), headers.get(b"origin")
        if host not in self.hosts:
            raise Refused(403, "this is not the name of this server")
        if origin is not None and origin != "http://" + host:
            raise Refused(403, "pages of other servers may not ask")
        if headers.get(b"sec-fetch-site", "none") not in ("same-origin", "none"):
            raise Refused(403, "pages of other servers may not ask")
        given = headers.get(b"x-psalm-token", "")
        if scope["path"] == "/":
            given = dict(part.partition("=")[::2] for part in scope["query_string"].decode("latin-1").split("&")).get("token", "")
        if not hmac.compare_digest(given.encode("latin-1", "replace"), self.token.encode()):
            raise Refused(403, "the token is missing or wrong: open the address that psalm-workbench printed")
        length, largest = headers.get(b"content-length", "0"), self.largest(scope)
        if not re.fullmatch("[0-9]{1,18}", length) or int(length) > largest:
            raise Refused(413, "a request has at most %d bytes" % largest)

    @staticmethod
    def largest(scope):
        return LARGEST_FILE if scope["path"] == "/import" else LARGEST

    async def body_of(self, scope, receive):
        parts, size = [], 0
        while True:
            message = await receive()
            if message["type"] == "http.disconnect":
                raise Refused(400, "the request was not finished")
            parts.append(message.get("body", b""))
            size += len(parts[-1])
            if size > self.largest(scope):
                raise Refused(413, "a request has at most %d bytes" % self.largest(scope))
            if not message.get("more_body"):
                return b"".join(parts)


# ---- studies ------------------------------------------------------------------------------------------------------------

class Process:
    """A study in a process of its own."""

    def __init__(self, process):
        self.process, self.over = process, False

    @classmethod
    async def begin(cls):
        here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        paths = [here] + ([os.environ["PYTHONPATH"]] if os.environ.get("PYTHONPATH") else [])
        return cls(await asyncio.create_subprocess_exec(
            sys.executable, "-m", "psalm._study", stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL, limit=LARGEST_ANSWER, start_new_session=True, cwd="/",
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OMP_WAIT_POLICY": "passive"}))

    async def ask(self, request):
        with contextlib.suppress(ConnectionError):
            self.process.stdin.write(json.dumps(request).encode() + b"\n")
            await self.process.stdin.drain()

    async def answer(self):
        """The next line of the study; None when it has ended."""
        try:
            line = await self.process.stdout.readline()
        except ValueError:
            self.kill()
            return {"error": "the results are too large"}
        return json.loads(line) if line.endswith(b"\n") else None

    async def stop(self):
        with contextlib.suppress(ConnectionError, RuntimeError):
            self.process.stdin.write(b"stop\n")
            await self.process.stdin.drain()

    def kill(self):
        self.over = True
        with contextlib.suppress(ProcessLookupError):
            self.process.kill()


class Search:
    """A search that goes on, and what it has found so far."""

    def __init__(self):
        self.events, self.running, self.asked, self.process = [], True, asyncio.get_running_loop().time(), None
        self.task = None


class Studies:
    """All studies: their places, their processes, one of them always ready."""

    def __init__(self, seconds):
        self.seconds = seconds      # of a look
        self.spare = asyncio.ensure_future(Process.begin())
        self.looks = asyncio.Semaphore(LOOKS)
        self.waiting, self.last, self.searches, self.running = 0, {}, {}, set()

    async def process(self):
        ready, self.spare = self.spare, asyncio.ensure_future(Process.begin())
        process = await ready
        if process.process.returncode is not None:
            process = await Process.begin()
        self.running.add(process)
        return process

    def end(self, process):
        process.kill()
        self.running.discard(process)

    async def look(self, page, study, given):
        """What a short study says of a case or a file; one of the same page that is still going on is ended."""
        before = self.last.pop((page, study), None)
        if before:
            before.kill()
        if self.waiting >= WAITING:
            raise Refused(429, "too many requests at once")
        self.waiting += 1
        try:
            async with self.looks:
                process = await self.process()
        finally:
            self.waiting -= 1
        self.last[page, study] = process
        async with contextlib.AsyncExitStack() as stack:
            stack.callback(self.end, process)
            await process.ask({"study": study, "seconds": self.seconds, **given})
            try:
                answer = await asyncio.wait_for(process.answer(), self.seconds)
            except asyncio.TimeoutError:
                answer = {"error": "the study took longer than %g s and was ended" % self.seconds}
            if self.last.get((page, study)) is process:
                del self.last[page, study]
        if answer is None:
            return {"stale": True} if process.over else {"error": "the study ended early: it took too long or wanted too much memory"}
        return answer

    async def search(self, request, study="search"):
        if sum(one.running for one in self.searches.values()) >= SEARCHES:
            raise Refused(429, "%d searches are running: stop one of them" % SEARCHES)
        name, one = secrets.token_hex(8), Search()
        self.searches[name] = one
        while len(self.searches) > KEPT:
            oldest = next((key for key, value in self.searches.items() if not value.running), None)
            if oldest is None:
                break
            del self.searches[oldest]
        one.process = await self.process()
        one.task = asyncio.create_task(self.follow(one, {**request, "study": study}))
        return name

    async def follow(self, one, request):
        """Take what a search finds until it ends, is forgotten, or its time is over."""
        loop = asyncio.get_running_loop()
        end = loop.time() + request["seconds"] + END_SECONDS + 20.0
        try:
            await one.process.ask(request)
            reading = asyncio.ensure_future(one.process.answer())
            while True:
                done, _ = await asyncio.wait({reading}, timeout=1.0)
                if done:
                    answer = reading.result()
                    if answer is None:
                        one.events.append({"error": "the search ended early: it took too long or wanted too much memory"})
                        return
                    one.events.append(answer)
                    if "done" in answer or "error" in answer:
                        return
                    reading = asyncio.ensure_future(one.process.answer())
                elif loop.time() > end or loop.time() > one.asked + FORGOTTEN:
                    reading.cancel()
                    one.events.append({"done": True, "stopped": True, "late": True})
                    return
        finally:
            one.running = False
            self.end(one.process)
            await one.process.process.wait()

    async def stop(self, one):
        """End a search: what it has found stays; by force if it does not end by itself."""
        if not one.running:
            return
        await one.process.stop()
        await asyncio.wait({one.task}, timeout=END_SECONDS)
        if one.running:
            one.process.kill()

    async def close(self):
        for process in [*self.running, await self.spare]:
            process.kill()
            await process.process.wait()


# ---- what is asked ------------------------------------------------------------------------------------------------------

def request_of(body):
    """A search that is asked for, every part of it checked."""
    def number(name, low, high, default):
        value = given.get(name, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
            raise Refused(400, "%s must be from %g to %g" % (name, low, high))
        return value

    try:
        given = json.loads(body)
    except (ValueError, RecursionError):
        raise Refused(400, "the request is not JSON") from None
    if not isinstance(given, dict):
        raise Refused(400, "the request is not an object of JSON")
    points, kinds = given.get("points"), given.get("kinds")
    if not isinstance(points, list) or not POINTS[0] <= len(points) <= POINTS[1]:
        raise Refused(400, "the wanted curve must have %d to %d points" % POINTS)
    for point in points:
        if not (isinstance(point, list) and len(point) == 2 and all(isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v)
                                                                    and abs(v) <= FAR for v in point)):
            raise Refused(400, "a point of the wanted curve is not two numbers")
    if not isinstance(kinds, list) or not kinds or not all(isinstance(kind, str) and (kind in KINDS or kind == OWN) for kind in kinds):
        raise Refused(400, "kinds must be some of " + " ".join([*KINDS, OWN]))
    words = {}
    for name, usual in (("case", ""), ("output", "P")):
        words[name] = given.get(name, usual)
        if not isinstance(words[name], str) or "\0" in words[name]:
            raise Refused(400, "%s must be a text" % name)
    vary = given.get("vary", ["all"])
    if not isinstance(vary, list) or not 0 < len(vary) <= MOST_VARY or not all(isinstance(one, str) and 0 < len(one) < 200 and one.isprintable() for one in vary):
        raise Refused(400, "vary must be names of dimensions")
    ranges = given.get("ranges", {})
    if not isinstance(ranges, dict) or not all(name in vary and isinstance(pairs, list) and pairs and all(
            isinstance(pair, list) and len(pair) == 2 and all(isinstance(v, (int, float)) and not isinstance(v, bool) and abs(v) <= FAR for v in pair) and
            pair[0] <= pair[1] for pair in pairs) for name, pairs in ranges.items()):
        raise Refused(400, "ranges must be pairs of numbers, least and most, of dimensions that vary")
    if OWN in kinds and files_named(words["case"]):
        raise Refused(400, "the case names a file")
    return {"points": [[float(v) for v in point] for point in points], "closed": bool(given.get("closed")), "kinds": list(dict.fromkeys(kinds)),
            "seconds": float(number("seconds", 1, SEARCH_SECONDS, SEARCH_SECONDS)), "round": int(number("round", 0, 1000, 0)),
            "angle": float(number("angle", 0, 60, 0)),
            "low": float(number("low", 0, FAR, 0)), "high": float(number("high", 0, FAR, 0)), "vary": vary, "ranges": ranges, **words}


def run_of(body):
    """A study that is asked for by its verb."""
    try:
        given = json.loads(body)
    except (ValueError, RecursionError):
        raise Refused(400, "the request is not JSON") from None
    if not isinstance(given, dict) or given.get("verb") not in VERBS or not isinstance(given.get("case"), str) or "\0" in given["case"]:
        raise Refused(400, "a study has a verb, one of %s, and a case" % " ".join(VERBS))
    return {"verb": given["verb"], "case": given["case"], "seconds": SEARCH_SECONDS}


def file_of(body):
    """A file of another program: its name, its bytes in base64, joints of the frame, the driven joint."""
    try:
        given = json.loads(body)
        fields = {name: given.get(name, "") for name in ("name", "content", "fixed", "drive")}
        base64.b64decode(fields["content"], validate=True)
    except (ValueError, RecursionError, AttributeError, TypeError):
        raise Refused(400, "the request is no file in JSON") from None
    if not all(isinstance(value, str) and value.isprintable() for value in fields.values()) or not fields["name"] or \
            any(len(value) > MOST_NAME for name, value in fields.items() if name != "content" and not value.startswith("http")):
        raise Refused(400, "a file has a name, and a content in base64")
    return fields


def application(token, port, case="", file="", seconds=LOOK_SECONDS):
    """The server as an ASGI application, and its studies."""
    page, policy = page_of(token, case, file)
    studies = None

    async def home(request):
        return HTMLResponse(page, headers={"content-security-policy": policy})

    async def answer(request, study, given):
        return JSONResponse(await studies.look(request.headers.get("x-psalm-page", "")[:32], study, given))

    async def look(request):
        return await answer(request, "look", {"case": await case_of(request)})

    async def prove(request):
        return await answer(request, "prove", {"case": await case_of(request)})

    async def files(request):
        return await answer(request, "files", {"case": await case_of(request)})

    async def import_file(request):
        return await answer(request, "import", file_of(await request.body()))

    async def case_of(request):
        try:
            text = (await request.body()).decode("utf-8")
        except UnicodeDecodeError:
            raise Refused(400, "the case is not UTF-8") from None
        if "\0" in text:
            raise Refused(400, "a case must not have the character 0")
        return text

    async def search(request):
        return JSONResponse({"search": await studies.search(request_of(await request.body()))})

    async def run(request):
        return JSONResponse({"search": await studies.search(run_of(await request.body()), "run")})

    def one_of(request):
        one = studies.searches.get(request.path_params["name"])
        if one is None:
            raise Refused(404, "there is no such search")
        one.asked = asyncio.get_running_loop().time()
        return one

    async def found(request):
        one = one_of(request)
        after = request.query_params.get("after", "0")
        if not re.fullmatch("[0-9]{1,9}", after):
            raise Refused(400, "after must be a number")
        return JSONResponse({"events": one.events[int(after):], "running": one.running})

    async def stop(request):
        one = one_of(request)
        await studies.stop(one)
        return JSONResponse({"running": one.running})

    async def refused(request, error):
        return JSONResponse({"error": error.words}, error.status)

    async def no_page(request, error):
        return PlainTextResponse("there is no such page\n", 404)

    @contextlib.asynccontextmanager
    async def alive(app):
        nonlocal studies
        studies = Studies(seconds)
        yield
        await studies.close()

    routes = [Route("/", home), Route("/look", look, methods=["POST"]), Route("/prove", prove, methods=["POST"]), Route("/files", files, methods=["POST"]),
              Route("/import", import_file, methods=["POST"]), Route("/search", search, methods=["POST"]), Route("/run", run, methods=["POST"]),
              Route("/search/{name}", found), Route("/search/{name}/stop", stop, methods=["POST"])]
    app = Starlette(routes=routes, lifespan=alive, exception_handlers={Refused: refused, 404: no_page})
    return Guard(app, token, {"%s:%d" % (name, port) for name in (HOST, "localhost")})


def listen(port):
    """A socket at that port; without one at the usual port, or at any that is free."""
    if port is None:
        with contextlib.suppress(OSError):
            return socket.create_server((HOST, PORT))
    return socket.create_server((HOST, port or 0))


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="psalm-workbench", description="The drawing board in the browser, with the engine behind it.")
    parser.add_argument("case", nargs="?", metavar="CASE.nml", help="a sketch to begin with")
    parser.add_argument("--port", type=int, default=None, help="default: %d, or one that is free" % PORT)
    parser.add_argument("--seconds", type=float, default=LOOK_SECONDS, help="the longest time that results are waited for; default: %(default)g")
    parser.add_argument("--no-browser", action="store_true", help="print the address, open nothing")
    asked = parser.parse_args(arguments)
    if not 0.1 <= asked.seconds <= 3600.0:
        parser.exit(2, "psalm-workbench: --seconds: must be from 0.1 to 3600\n")
    case = file = ""
    if asked.case:
        try:
            with open(asked.case, encoding="utf-8") as text:
                case = text.read()
        except (OSError, UnicodeDecodeError) as error:
            parser.exit(3, "psalm-workbench: %s: cannot be read: %s\n" % (asked.case, error))
        if len(case.encode()) > LARGEST:
            parser.exit(2, "psalm-workbench: %s: a case has at most %d bytes\n" % (asked.case, LARGEST))
        file = os.path.basename(asked.case)
    try:
        listening = listen(asked.port)
    except (OSError, OverflowError) as error:
        parser.exit(3, "psalm-workbench: port %s of %s: %s\n" % (asked.port, HOST, error))
    port, token = listening.getsockname()[1], secrets.token_urlsafe(24)
    address = "http://%s:%d/?token=%s" % (HOST, port, token)
    print("The workbench is at %s\nCtrl-C ends it." % address, flush=True)
    if not asked.no_browser:
        webbrowser.open(address)
    server = uvicorn.Server(uvicorn.Config(application(token, port, case, file, asked.seconds), log_level="error", access_log=False, server_header=False,
                                           limit_concurrency=CONNECTIONS, timeout_keep_alive=5, timeout_graceful_shutdown=1, ws="none",
                                           h11_max_incomplete_event_size=64 << 10, http="h11"))
    # a study that ends while it is being killed is one that asyncio warns of
    logging.getLogger("asyncio").setLevel(logging.ERROR)
    with contextlib.suppress(KeyboardInterrupt):    # which uvicorn passes on when all has ended
        server.run(sockets=[listening])


if __name__ == "__main__":
    main()
