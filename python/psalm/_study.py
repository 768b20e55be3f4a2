"""One study for the workbench, in a process of its own, which the workbench ends when it is stopped or takes too long.

The process reads one request, a line of JSON, from standard input and answers in lines of JSON on standard output. The line `stop`
ends a search early; the end of standard input ends the process. Before it reads the request it gives up opening files: a case that
names one finds nothing, whatever the name is.
"""
import base64
import contextlib
import io
import json
import math
import os
import re
import resource
import sys
import threading
import time

import numpy

import psalm
from psalm import imports

MEMORY = 4 << 30        # bytes of address space
SAYS = ("motion", "summary")    # studies whose errors are reported: the others are asked of whatever is drawn
FINE = 5                # degrees between the positions of which velocities are shown
PREFIX = re.compile(r"^case in memory(?::\d+: (?:error|warning|remark))?: ")
CURVE_FILE = re.compile(r"^[^!'\"]*[&$]\s*CURVE\b", re.I)
CONDITION = ".condition"  # ends the name of a column
WARM = "WARM\n &CHAIN JNT='A','B','C','D', JX=0.,0.,60.,100., JY=0.,30.,80.,0., LNK='A D','A B','B C','C D' &END\n" \
    " &DRIVES DRIVE='A' &END\n &METHOD IKIN=30 &END\n"
# what a search goes through in each round: links, slides, gear pairs
KINDS = {"pins4": (4, 0, 0), "slide4": (4, 1, 0), "pins6": (6, 0, 0), "geared5": (5, 0, 1)}
OWN = "mine"            # the linkage that is drawn, with other dimensions
OWN_LOW, OWN_HIGH = 0.02, 5.0           # its lengths, parts of the curve's size, as of other kinds
OWN_STARTS = 100000
TURNS = 720.0           # degrees to either side: no bound of an angle
FIRST_SECONDS, MOST_SECONDS = 0.5, 16.0     # of a kind in the first round; doubled from round to round
ASSEMBLIES = 24         # that are shown
REPORTED = 0.3          # seconds between two reports of progress
LISTING = 200000        # characters of a listing that are shown
EMPTY_DXF = b"  0\nSECTION\n  2\nENTITIES\n  0\nENDSEC\n  0\nEOF\n"
FOUND = 24              # linkages found that are shown
SHOWN = 60              # points of a path on the contact sheet


def confine(seconds, threads):
    """No file is opened from here on; memory and time of the processor are limited."""
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    used = int(sum(resource.getrusage(resource.RUSAGE_SELF)[:2]))
    limit = used + 2 + int(math.ceil(seconds))*max(1, threads)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))


def plain(value):
    """Numbers for JSON: what is not known is null."""
    if isinstance(value, numpy.ndarray):
        return [plain(v) for v in value.tolist()]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def findings_of(findings):
    return [{"level": f.level, "line": f.line, "text": PREFIX.sub("", f.text)} for f in findings]


def files_named(text):
    """A finding for each line that asks for a file."""
    return [{"level": "error", "line": number, "text": "&CURVE: the workbench opens no file; draw the wanted curve, or open the file under "
             "Search"} for number, line in enumerate(text.split("\n"), 1) if CURVE_FILE.match(line)]


def files(request):
    """Pictures of a case for other programs: ending of the name to content."""
    refused = files_named(request["case"])
    if refused:
        return {"findings": refused}
    try:
        return {"files": psalm.Case.from_text(request["case"]).study("picture", listing=False).files}
    except psalm.Error as error:
        return {"findings": findings_of(error.findings)}


def import_file(request):
    """A case from a file of another program, whose bytes are in the request, or from a link; the kind is that of its ending."""
    name = request["name"]
    source = name if name.startswith("http") else imports.InMemory(name, base64.b64decode(request["content"]))
    try:
        return {"text": imports.read(source, fixed=request["fixed"], drive=request["drive"]).text()}
    except imports.ImportFailed as error:
        return {"error": str(error)}


# ---- one look at a case -------------------------------------------------------------------------------------------------

def look(request):
    """What the engine says of a case: findings, summary, positions, transmission angles, velocities, forces."""
    return parts_of(request, (("motion", motion_of), ("summary", summary_of), ("velocity", velocities_of), ("condition", conditions_of)))


def prove(request):
    """What may take longer, but changes nothing of the rest: what is proven, all assemblies."""
    return parts_of(request, (("proof", proof_of), ("assemblies", assemblies_of)))


def parts_of(request, parts):
    text = request["case"]
    refused = files_named(text)
    if refused:
        return {"findings": refused}
    try:
        case = psalm.Case.from_text(text)
    except psalm.Error as error:
        return {"findings": findings_of(error.findings)}
    answer = {"findings": [], "title": case.title}
    found = {}
    for part, study in parts:
        try:
            answer[part], findings = study(case)
        except psalm.Error as error:
            findings = error.findings if part in SAYS else []
        for one in findings_of(findings):
            found[(one["line"], one["text"])] = one
    answer["findings"] = sorted(found.values(), key=lambda one: one["line"])
    return answer


def motion_of(case):
    """The motion as the page of balm has it."""
    result = case.study("picture", listing=False)
    page = re.search(r'<script type="application/json" id="data">(.*?)</script>', result.files[".html"], re.S)
    scene = json.loads(page[1])["cases"][0]
    sweep = scene.get("sweep") or {}
    motion = {"input": sweep.get("input", []), "closed": sweep.get("closed", ""), "time": scene.get("time"),
              "joints": {joint["name"]: [sweep["x"][j], sweep["y"][j]] for j, joint in enumerate(scene["joints"])} if sweep else {},
              "angle": [{"name": one["name"], "values": one["values"]} for one in sweep.get("angle", [])],
              "limits": scene.get("limits"), "breaches": scene.get("breaches", []), "band": scene.get("band")}
    if "forces" in scene and sweep:
        force = scene["forces"]
        motion["forces"] = {"drive": force["drive"], "sliding": force["sliding"],
                            "joints": {one["name"]: [one["fx"], one["fy"]] for one in force["joints"]},
                            "loads": [[one["x"], one["y"], one["fx"], one["fy"]] for one in force["loads"]]}
    return motion, result.findings


def summary_of(case):
    result = case.study("summary")
    return result.listing, result.findings


def finely(case, verb):
    """The table of positions of a study, of a crank every few degrees of its turn, else at those of the case; and the inputs in it."""
    try:
        finer = case.copy()
        finer.turn(FINE)
        result = finer.study(verb, listing=False)
    except psalm.Error:
        result = case.study(verb, listing=False)
    table = result.tables["positions"]
    name = next((name for name in table.columns if name == "input" or name.startswith("input.")), None)
    return table, name and plain(table[name])


def conditions_of(case):
    """Condition numbers of the outputs: how many times relative changes of the dimensions reach them."""
    asked = case.copy()
    asked.set("LIMITS", "ICOND", 1)
    table, inputs = finely(asked, "analysis")
    return {"input": inputs, "outputs": {name[:-len(CONDITION)]: plain(table[name]) for name in table.columns if name.endswith(CONDITION)}}, []


def velocities_of(case):
    """Velocities of all joints."""
    table, inputs = finely(case, "rates")
    if inputs is None:
        return None, []
    joints = [name[:-3] for name in table.columns if name.endswith(".vx") and name[:-3] + ".vy" in table]
    return {"input": inputs, "joints": {name: [plain(table[name + ".vx"]), plain(table[name + ".vy"])] for name in joints}}, []


def proof_of(case):
    """What is proven: where it closes, extremes; of a crank alone over its whole turn."""
    result = None
    try:
        turned = case.copy()
        turned.set("METHOD", "IKIN", 0)
        turned.positions([0.0, 360.0])
        result = turned.study("proof", listing=False)
    except psalm.Error:
        result = case.study("proof", listing=False)
    tables = result.tables
    names = {"limits": ("kind", "from", "to", "group"), "extremes": ("of", "least_low", "least_high", "least_at", "greatest_low", "greatest_high", "greatest_at"),
             "dead_points": ("of", "low", "high")}
    return {table: [dict(zip(columns, row)) for row in zip(*(plain(numpy.asarray(tables[table][name])) for name in columns))]
            for table, columns in names.items() if table in tables and all(name in tables[table] for name in columns)}, []


def assemblies_of(case):
    """All ways in which the links can be put together at the position that is drawn: places of the joints."""
    table = case.study("assemblies", listing=False).table
    joints = [name[:-2] for name in table.columns if name.endswith(".x") and name[:-2] + ".y" in table]
    return [{"drawn": bool(table["drawn"][row]), "dead": bool(table["dead"][row]),
             "joints": {name: [plain(float(table[name + ".x"][row])), plain(float(table[name + ".y"][row]))] for name in joints}}
            for row in range(min(table.rows, ASSEMBLIES))], []


# ---- a search -----------------------------------------------------------------------------------------------------------

def own_case(request, seconds, seed):
    """A search that varies the linkage that is drawn, from it and from others of its kind; lengths that are locked stay."""
    case = psalm.Case.from_text(request["case"])
    count = len(request["points"])
    step = 360.0/count if request["closed"] else 180.0/(count - 1)
    case.set("METHOD", IKIN=0, ISTART=seed, IFREE=1)
    case.positions([step*k for k in range(count)])
    case.desire([p[0] for p in request["points"]], [p[1] for p in request["points"]])
    case.set("CHAIN", "VARY", request["vary"])
    size = size_of(request)
    low, high = request["low"] or OWN_LOW*size, request["high"] or OWN_HIGH*size
    far = high + max(math.hypot(*p) for p in request["points"])     # of a place from the origin, or from the input pivot
    bounds = [pair for one in request["vary"] for pair in request["ranges"].get(one) or {"angle": [(-TURNS, TURNS)], "place": [(0.0, far), (-TURNS, TURNS)]}.get(one.split(" ")[0], [(low, high)])]
    case.set("CHAIN", VLOW=[pair[0] for pair in bounds], VHIGH=[pair[1] for pair in bounds])
    case.set("SEARCH", SOLVER="LSQ", NSTART=OWN_STARTS, ORDER=2, MAXTIME=seconds, NBEST=1)
    case.set("CONSTR", IRANGE=2)
    if request["angle"]:
        case.set("LIMITS", TANGLE=90.0 - request["angle"])
    return case


def size_of(request):
    """The larger side of the box of the wanted curve."""
    return max(max(p[k] for p in request["points"]) - min(p[k] for p in request["points"]) for k in (0, 1)) or 1.0


def search_text(request, kind, seconds, seed):
    """The data set of a search for a curve among the linkages of a kind."""
    links, slides, gears = KINDS[kind]
    points, closed = request["points"], request["closed"]
    count = len(points)
    step = 360.0/count if closed else 180.0/(count - 1)

    def values(numbers):
        words = ["%.10g" % v for v in numbers]
        return ",\n  ".join(",".join(w if re.search("[.e]", w) else w + ".0" for w in words[k:k + 8]) for k in range(0, count, 8))

    angle = request["angle"]
    bounds = "".join(", %s=%.10g" % (item, value) for item, value in (("LENLOW", request["low"]), ("LENHGH", request["high"])) if value)
    return ("WANTED CURVE\n &KINDS LINKS=%d, SLIDES=%d%s, GEARS=%d%s, NKINDS=20%s &END\n"
            " &METHOD ISTART=%d, NDES=%d, DELT=%s,\n  DESX=%s,\n  DESY=%s &END\n%s &SEARCH MAXTIME=%.1f &END\n" %
            (links, slides, ",%d" % slides if slides else "", gears, ",%d" % gears if gears else "", bounds, seed, count,
             values(step*k for k in range(count)), values(p[0] for p in points), values(p[1] for p in points),
             " &LIMITS TANGLE=%.4g &END\n" % (90.0 - angle) if angle else "", seconds))


def search(request, tell, stopped):
    """Rounds over the kinds that were chosen, each twice as long as the one before: every linkage is reported when it is found."""
    best = {}
    number, seconds = request["round"], request["seconds"]
    spent = 0.0
    while spent < seconds and not stopped():
        length = min(MOST_SECONDS, FIRST_SECONDS*2**number)
        for kind in request["kinds"]:
            if spent >= seconds or stopped():
                break
            try:
                case = own_case(request, length, 1 + number) if kind == OWN else \
                    psalm.Case.from_text(search_text(request, kind, length, 1 + number))
                tell({"doing": kind, "round": number, "text": case.text})
                result = (case.synthesise if kind == OWN else case.kinds)(progress=lambda made, most, least: stopped())
            except psalm.Error as error:
                return {"error": "; ".join(PREFIX.sub("", f.text) for f in error.findings if f.level == "error") or str(error)}
            spent += length
            table = result.tables.get("found")
            for row, found in enumerate(result.cases[:table.rows] if table is not None else []):
                name, error = (OWN, math.sqrt(float(table["objective"][row])/len(request["points"]))) if kind == OWN else \
                    (str(table["kind"][row]), float(table["rms_error"][row]))
                if not math.isfinite(error) or error >= best.get(name, math.inf)*0.999:
                    continue
                best[name] = error
                tell({"found": card_of(found, name, error, size_of(request), request["output"] if kind == OWN else "P")})
        number += 1
    return {"done": True, "round": number, "stopped": stopped()}


def card_of(case, name, error, size, output):
    """A linkage of the contact sheet: its data set and, to be drawn, its joints, links and path."""
    card = {"kind": name, "error": error, "part": error/size, "text": case.text}
    motion, _ = motion_of(case)
    step = max(1, len(motion["input"])//SHOWN)
    card["path"] = [axis[::step] for axis in motion["joints"].get(output, [[], []])]
    angles = [v for one in motion["angle"] for v in one["values"] if v is not None]
    card["angle"] = min((min(v, 180 - v) for v in angles), default=None)
    return card


# ---- any other study ----------------------------------------------------------------------------------------------------

def run(request, tell, stopped):
    """A study that a case asks for: its listing, and the linkages found."""
    last = [0.0]

    def progress(made, most, best):
        if time.monotonic() > last[0] + REPORTED:
            last[0] = time.monotonic()
            tell({"made": made, "most": most, "best": best if math.isfinite(best) and best < sys.float_info.max else None})
        return stopped()

    refused = files_named(request["case"])
    if refused:
        return {"error": refused[0]["text"]}
    try:
        result = psalm.Case.from_text(request["case"]).study(request["verb"], progress=progress)
    except psalm.Error as error:
        return {"error": "; ".join(PREFIX.sub("", f.text) for f in error.findings if f.level == "error") or str(error)}
    return {"done": True, "listing": result.listing[:LISTING], "findings": findings_of(result.findings),
            "cases": [{"title": case.title, "text": case.text} for case in result.cases[:FOUND]]}


# ---- the process --------------------------------------------------------------------------------------------------------

def main():
    os.nice(5)
    psalm.Case.from_text(WARM).study("summary")
    motion_of(psalm.Case.from_text(WARM))
    velocities_of(psalm.Case.from_text(WARM))
    proof_of(psalm.Case.from_text(WARM))
    assemblies_of(psalm.Case.from_text(WARM))
    line = sys.stdin.readline()
    if not line:
        return
    request, end = json.loads(line), threading.Event()
    if request["study"] == "import" and request["name"].lower().endswith(".dxf"):
        with contextlib.suppress(ImportError):      # later no file can be opened
            import ezdxf
            import ezdxf.path
            import ezdxf.recover
            ezdxf.recover.read(io.BytesIO(EMPTY_DXF))
    confine(request["seconds"], os.cpu_count() or 1)

    def listen():
        for word in sys.stdin:
            if word.strip() == "stop":
                end.set()
        os._exit(1)

    def tell(answer):
        sys.stdout.write(json.dumps(answer, allow_nan=False) + "\n")
        sys.stdout.flush()

    threading.Thread(target=listen, daemon=True).start()
    short = {"look": look, "prove": prove, "files": files, "import": import_file}
    tell(short[request["study"]](request) if request["study"] in short else
         {"search": search, "run": run}[request["study"]](request, tell, end.is_set))
    os._exit(0)


if __name__ == "__main__":
    main()
