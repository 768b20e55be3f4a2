"""A report of a case: one page of HTML with drawing, curves, tables and verdicts, to read, print or send.

    >>> from psalm import report
    >>> page = report.report(psalm.from_file("press.nml"))

On the command line: `psalm-report CASE.nml` writes CASE.report.html; `psalm-report --help`.
"""
import argparse
import base64
import contextlib
import html
import math
import os
import re
import sys
import tempfile
import typing

from . import Case, Error, version

MOST_ROWS = 25        # of a table: a longer one is thinned to so many
DIGITS = 6            # of a number in a table
MOST_COLUMNS = 7      # of a table beside its first: a wider one is continued below
LEAST_POINTS, MOST_CHARTS = 8, 12   # of a curve, of a study
CHART = (230, 110)    # width and height of a curve, pixels
OF_JOINTS = re.compile(r"^(?!point_|pose_)[^.]+\.(x|y)$")              # places of joints,
RATES_OF_JOINTS = re.compile(r"^(?!point_|pose_)[^.]+\.(vx|vy|ax|ay)$")  # and their rates
QUIET = {"summary", "closing", "reversals", "loop_kinds", "output_ranges"}  # tables that the summary says in words
OF_POSITIONS = {"positions", "powers", "sizing", "drives"}  # of a motion in time: of the drawing alone
STYLE = """
:root { color-scheme: light; }
body { font: 11pt/1.45 system-ui, sans-serif; color: #1b1f24; max-width: 52rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin: 0; } h2 { font-size: 1.2rem; margin: 2rem 0 .4rem; border-bottom: 1px solid #c9ced6; }
.made { color: #5b6470; margin: .2rem 0 1rem; }
.verdict { padding: .5rem .8rem; border-left: .35rem solid #2e7d32; background: #eef6ee; }
.verdict.bad { border-color: #b3261e; background: #fbeeee; }
figure { margin: 1rem 0; break-inside: avoid; } figure img { max-width: 100%; max-height: 24cm; }
figcaption, caption { color: #5b6470; font-size: .9rem; text-align: left; margin-bottom: .2rem; }
.wide { overflow-x: auto; }
.charts { display: flex; flex-wrap: wrap; gap: .4rem 1rem; } .charts svg { break-inside: avoid; }
.charts path { fill: none; stroke: #1f5fa8; stroke-width: 1.5; } .charts rect { fill: none; stroke: #c9ced6; }
.charts text { font-size: 9px; fill: #3d444d; }
.charts line { stroke: #e3e6ea; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; margin: .6rem 0; }
th, td { padding: .12rem .55rem; text-align: right; border-bottom: 1px solid #e3e6ea; white-space: nowrap; }
th { font-weight: 600; vertical-align: bottom; } th small { font-weight: 400; color: #5b6470; } td.word, th.word { text-align: left; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .5rem 0; } dt { color: #5b6470; } dd { margin: 0; }
li.error, li.warning { color: #8a1c14; } pre { font-size: .8rem; white-space: pre-wrap; background: #f5f6f8; padding: .6rem; }
@page { margin: 16mm; }
@media print { body { max-width: none; margin: 0; font-size: 9.5pt; } .wide { overflow: visible; } table { font-size: 7.5pt; } }
"""

# study, heading, groups that ask for it; of those in a row that ask for one another's place the first counts
STUDIES = (("rates", "Velocities and accelerations", "RATES"), ("forces", "Forces", "MASSES PLATES LOADS SPRING FRICTN"),
           ("machine", "Motion from torque", "MOTOR"), ("time", "Motion in time", "TIME STOPS"), ("tolerances", "Tolerances", "TOLER"),
           ("allocation", "Cheapest tolerances", "ALLOC"), ("sweep", "Family of linkages", "SWEEP"), ("balance", "Counterweights", "BALANC"),
           ("springs", "Springs", "SPRNGS"), ("vibration", "Vibration and stability", "ESTIM VIBR FLEX DRIVEL HILL"), ("cams", "Cams", "CAM CAM2"),
           ("clearance", "Clearance", "CLEAR"), ("proof", "What is proven", ""))
SEARCHES = ("SEARCH", "KINDS", "EXACT")
PREFIX = re.compile(r"^case in memory(?::\d+: (?:error|warning|remark))?: ")


def groups_of(text: str) -> typing.Set[str]:
    """Groups that a case has."""
    return {name.upper() for name in re.findall(r"^\s*&([A-Za-z]\w*)", re.sub(r"!.*", "", text), re.M)}


def cell(value) -> str:
    """A value in a table."""
    if isinstance(value, str):
        return '<td class="word">%s</td>' % html.escape(value)
    number = float(value)
    return "<td>%s</td>" % ("" if math.isnan(number) else "%.*g" % (DIGITS, number))


def table_of(table, shown: typing.AbstractSet[str] = frozenset()) -> str:
    """A table, thinned where it is long and continued where it is wide; without columns that were `shown`, but its first."""
    names = [name for k, name in enumerate(table.columns) if k == 0 or name not in shown and not RATES_OF_JOINTS.match(name)]
    rows = list(range(table.rows))
    note = ""
    if len(rows) > MOST_ROWS:
        step = -(-len(rows) // MOST_ROWS)
        rows = rows[::step]
        note = "; every %s row of %d" % ({2: "second", 3: "third"}.get(step, "%dth" % step), table.rows)
    units = table.units
    data = {name: table[name] for name in names}
    made = []
    for begin in range(1, max(2, len(names)), MOST_COLUMNS):
        part = names[:1] + names[begin:begin + MOST_COLUMNS]
        head = "".join('<th%s>%s%s</th>' % (' class="word"' if len(data[name]) and isinstance(data[name][0], str) else "", html.escape(name),
                                            "<br><small>%s</small>" % html.escape(units[name]) if units[name] else "") for name in part)
        body = "\n".join("<tr>%s</tr>" % "".join(cell(data[name][r]) for name in part) for r in rows)
        caption = html.escape(table.about[:1].upper() + table.about[1:] + note) if begin == 1 else "continued"
        made.append('<div class="wide"><table><caption>%s</caption><thead><tr>%s</tr></thead>\n<tbody>%s</tbody></table></div>'
                    % (caption, head, body))
    return "\n".join(made)


def charts_of(table, shown: typing.AbstractSet[str] = frozenset()) -> str:
    """Curves of a table over its first column: of what it is about, not of the places of joints and their rates."""
    first = table.columns[0]
    x = [float(value) for value in table[first]] if table.units[first] else []
    if table.units[first] == "deg":     # inputs of a crank are listed within a turn
        for k in range(1, len(x)):
            x[k] = x[k - 1] + math.remainder(x[k] - x[k - 1], 360.0)
    if len(x) < LEAST_POINTS or not (all(b > a for a, b in zip(x, x[1:])) or all(b < a for a, b in zip(x, x[1:]))):
        return ""
    made = []
    for name in table.columns[1:]:
        values = table[name]
        if name in shown or OF_JOINTS.match(name) or RATES_OF_JOINTS.match(name) or not table.units[name] or isinstance(values[0], str):
            continue
        y = [float(value) for value in values]
        known = [value for value in y if math.isfinite(value)]
        if len(known) < LEAST_POINTS or max(known) - min(known) <= 1e-9 * max(map(abs, known)):
            continue
        made.append(chart(x, y, min(known), max(known), name, table.units[name], first, table.units[first]))
        if len(made) == MOST_CHARTS:
            break
    return '<div class="charts">%s</div>' % "\n".join(made) if made else ""


def chart(x, y, low, high, name, unit, over, over_unit) -> str:
    """One curve; gaps where it is not known."""
    width, height = CHART
    left, top = 4, 16
    line, pen, begin, end = [], "M", min(x), max(x)
    for a, b in zip(x, y):
        if not math.isfinite(b):
            pen = "M"
            continue
        line.append("%s%.1f %.1f" % (pen, left + (a - begin) / (end - begin) * (width - 2 * left), top + (high - b) / (high - low) * height))
        pen = "L"
    zero = ""
    if low < 0.0 < high:
        at = top + high / (high - low) * height
        zero = '<line x1="%d" y1="%.1f" x2="%d" y2="%.1f"/>' % (left, at, width - left, at)
    words = "%s, %s: %.4g to %.4g" % (name, unit, low, high)
    below = "%s %.4g to %.4g %s" % (over, begin, end, over_unit)
    return ('<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="%s" width="%d" height="%d"><text x="%d" y="11">%s</text>'
            '<rect x="%d" y="%d" width="%d" height="%d"/>%s<path d="%s"/><text x="%d" y="%d">%s</text></svg>'
            % (html.escape(words), width, height + top + 16, left, html.escape(words), left, top, width - 2 * left, height, zero,
               " ".join(line), left, height + top + 12, html.escape(below)))


def summary_of(text: str) -> str:
    """The lines of a summary: what each is about, and what it says."""
    rows = []
    for line in text.splitlines()[1:]:
        found = re.match(r"\s+(\S.*?)\s{2,}(\S.*)", line)
        if found:
            rows.append("<dt>%s</dt><dd>%s</dd>" % (html.escape(found[1]), html.escape(found[2])))
        elif line.strip():
            rows.append("<dt></dt><dd>%s</dd>" % html.escape(line.strip()))
    return "<dl>%s</dl>" % "\n".join(rows)


def picture(svg: str, words: str) -> str:
    """A picture of its own: what it defines cannot meet what others define."""
    return '<figure><figcaption>%s</figcaption><img alt="%s" src="data:image/svg+xml;base64,%s"></figure>' % (
        html.escape(words), html.escape(words), base64.b64encode(svg.encode()).decode())


def report(case: Case) -> str:
    """The report: every study that the groups of the case ask for; searches are not made. Errors: `psalm.Error` of the case itself."""
    return _written(case)[0]


def _written(case):
    """The page, and whether something is violated or a study failed."""
    text = case.text
    asked = groups_of(text)
    findings, violated, parts = {}, False, []

    def note(found):
        for one in found:
            findings.setdefault((one.level, PREFIX.sub("", one.text)), one)

    first = case.analyse(listing=True)
    note(first.findings)
    violated = bool(first.violated)
    parts.append("<h2>Summary</h2>\n" + summary_of(case.summary()))
    drawn = case.study("picture", listing=False)
    note(drawn.findings)
    for ending, words in ((".svg", "The linkage, the path of its output and its joints over the positions"), (".tolerances.svg", "Tolerances")):
        if ending in drawn.files:
            parts.append(picture(drawn.files[ending], words))
    tables = first.tables
    for name in ("dimensions", "violations"):
        if name in tables and tables[name].rows:
            parts.append("<h2>%s</h2>\n%s" % (name.capitalize(), table_of(tables[name])))
    in_time = "TIME" in asked
    if not in_time:
        parts.append("<h2>Positions</h2>\n%s\n%s" % (charts_of(first.table), table_of(first.table)))
    seen, shown = set(first.table.columns), set()
    for verb, heading, groups in STUDIES:
        if groups and not asked & set(groups.split()) or in_time and verb in ("rates", "forces", "machine"):
            continue
        try:
            result = case.study(verb)
        except Error as error:
            if groups:
                note(error.findings)
                violated = True
                parts.append("<h2>%s</h2>\n<p>%s</p>" % (heading, html.escape("; ".join(
                    PREFIX.sub("", one.text) for one in error.findings if one.level == "error") or str(error))))
            continue
        note(result.findings)
        violated = violated or bool(result.violated)
        made, body = result.tables, []
        own = result.table.name if made else ""
        for name in sorted(made, key=lambda name: name != own):
            table = made[name]
            if not table.rows or name in QUIET | (OF_POSITIONS if in_time else set()) or name != own and (name in tables or name in shown):
                continue
            shown.add(name)
            before = seen if name == first.table.name else set()
            if any(name not in before and not RATES_OF_JOINTS.match(name) for name in table.columns):
                body.append(charts_of(table, before) + "\n" + table_of(table, before))
            if name == first.table.name:
                seen |= set(table.columns)
        if body:
            parts.append("<h2>%s</h2>\n%s" % (heading, "\n".join(body)))
    searches = [group for group in SEARCHES if group in asked]
    if searches:
        parts.append("<p>The linkage is reported as it is given: the search that &amp;%s asks for is not made.</p>" % ", &amp;".join(searches))
    told = [(level, words) for level, words in findings if level in ("error", "warning")]
    remarks = [words for level, words in findings if level not in ("error", "warning")]
    head = ['<p class="verdict%s">%s</p>' % ((" bad", "A limit is violated, or a study failed: see below.") if violated else
                                             ("", "No limit of the case is violated."))]
    if told or remarks:
        head.append("<ul>%s</ul>" % "".join('<li class="%s">%s</li>' % (level, html.escape(words)) for level, words in
                                            told + [("remark", words) for words in remarks]))
    parts.append("<h2>The case</h2>\n<pre>%s</pre>" % html.escape(text))
    title = html.escape(case.title or "Linkage")
    return ("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n"
            "<title>%s</title>\n<style>%s</style>\n</head>\n<body>\n<h1>%s</h1>\n<p class=\"made\">PSALM %s</p>\n%s\n%s\n</body>\n</html>\n"
            % (title, STYLE, title, html.escape(version), "\n".join(head), "\n".join(parts))), violated


def main(arguments: typing.Optional[typing.Sequence[str]] = None) -> int:
    """The command psalm-report. Exit status: 0 done; 1 done, but a limit is violated or a study failed; 2 the case is wrong; 3 a file
    could not be read or written."""
    parser = argparse.ArgumentParser(prog="psalm-report", description="A report of a case: CASE.report.html, one page to read or print.")
    parser.add_argument("files", nargs="+", metavar="CASE.nml")
    parser.add_argument("--output-dir", metavar="DIR", help="put the reports into DIR")
    given = parser.parse_args(arguments)
    status = 0
    for name in given.files:
        stem = re.sub(r"\.(nml|json)$", "", name)
        place = os.path.join(given.output_dir, os.path.basename(stem)) if given.output_dir else stem
        made = None
        try:
            page, violated = _written(Case.from_file(name))
            # a report that is there stays whole if writing fails
            with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=os.path.dirname(place) or ".", suffix=".tmp", delete=False) as file:
                made = file.name
                file.write(page)
            os.chmod(made, 0o666 & ~_umask())
            os.replace(made, place + ".report.html")
            print("Written: %s.report.html" % place)
            status = max(status, int(violated))
        except Error as error:
            print("psalm-report: %s: %s" % (name, error), file=sys.stderr)
            if "the case has no linkage" in str(error):
                print("psalm-report: a search makes linkages of this case; report those that psalm wrote on device 7", file=sys.stderr)
            status = max(status, 2)
        except OSError as reason:
            if made:
                with contextlib.suppress(OSError):
                    os.remove(made)
            print("psalm-report: %s.report.html: %s" % (place, reason.strerror), file=sys.stderr)
            status = 3
    return status


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


if __name__ == "__main__":
    sys.exit(main())
