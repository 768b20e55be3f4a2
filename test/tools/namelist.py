"""A reader of NAMELIST of the tests' own."""
import re

TOKEN = re.compile(r"""\s+|![^\n]*|(?P<name>[A-Za-z_]\w*)\s*(?:\((?P<places>[\d\s,]+)\))?\s*=|(?P<times>\d+)\*
    |(?P<quoted>'(?:[^']|'')*'|"(?:[^"]|"")*")|(?P<end>&END|\$END|\$|/)|(?P<comma>,)|(?P<plain>[^\s,!/]+)""", re.X | re.I)

OF_1976 = ("LINKS", "METHOD", "LIMITS")       # groups whose arrays had a size


def read_namelist(text):
    """Cases of a text: [title, {group: {item: [(places, values)]}}]; a value is None, a number as text, or ('text', string)."""
    cases, at, lines = [], 0, text.replace("\r\n", "\n")
    while True:
        blank = re.compile(r"(?:[ \t]*(?:![^\n]*)?\n)*").match(lines, at)
        at = blank.end()
        if not lines[at:].strip():
            return cases
        end = lines.find("\n", at)
        case = [lines[at:end].rstrip(), {}]
        cases.append(case)
        at = end
        while True:
            start = re.compile(r"(?:\s|![^\n]*)*[&$](\w+)").match(lines, at)
            if not start:
                break
            name = start.group(1).upper()
            at = read_group(lines, start.end(), case[1].setdefault(name, {}), name in OF_1976)
        last = case[1].get("LIMITS", {}).pop("LAST", None)
        if not last or float(last[0][1][0]) != 0.0:
            return cases


def read_group(text, at, group, fills):
    values, times, void = None, 1, True
    while True:
        token = TOKEN.match(text, at)
        at = token.end()
        kind = token.lastgroup
        if kind in ("name", "places"):
            places = [int(p) for p in (token.group("places") or "").split(",") if p.strip()]
            values = []
            group.setdefault(token.group("name").upper(), []).append((places, values))
            times, void = 1, True
        elif kind == "times":
            times = int(token.group("times"))
            void = False
            if re.match(r"[\s,/&]", text[at:at + 1] or " "):
                values += [None] * times
                times = 1
        elif kind in ("quoted", "plain"):
            word = token.group()
            value = ("text", word[1:-1].replace(word[0] * 2, word[0])) if kind == "quoted" else word
            # what fills an array up to the size of the original program's is no part of the case
            values += [value] * (0 if fills and values and times > 1 and len(values) + times > 60 else times)
            times, void = 1, False
        elif kind == "comma":
            if void:
                values.append(None)
            void = True
        elif kind == "end":
            return at
