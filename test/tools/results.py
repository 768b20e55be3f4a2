"""Results that the programs write as JSON (--json), read for tests."""
import json


def no_number(word):
    raise ValueError(word + " is no JSON")


def cases_of(path):
    """Cases of a file: each a dict of blocks, each a dict of columns; an error where it has NaN or Infinity, which JSON has not."""
    with open(path, encoding="utf-8") as file:
        whole = json.load(file, parse_constant=no_number)
    return [{name: block["columns"] for name, block in case["blocks"].items()} for case in whole["cases"]]


def rows_of(columns):
    """A dict for each row of a block."""
    return [dict(zip(columns, values)) for values in zip(*columns.values())]


def counterweights(blocks):
    """What muscle found, outcome by outcome: weights, links without one, loads before and after."""
    found = {}
    for row in rows_of(blocks.get("balance", {})):
        found.update(row)
        found["composite"] = {k[10:]: v for k, v in row.items() if k.startswith("composite_")}
        found["composite"].update({k: bool(row[k]) for k in ("convex", "proven") if k in row})
        found["feasible"] = bool(row["feasible"])
    if not found:
        return springs(blocks, found)
    links = rows_of(blocks["links"])
    for flag in ("adrift", "allowed", "cannot_balance"):
        found[flag] = [row["link"] for row in links if row[flag]]
    found["sets"] = [[row["link"] for row in rows_of(blocks["minimal_sets"]) if row["set"] == k + 1] for k in range(found["minimal_sets"])]

    def loads(outcome):
        own = {row["load"]: {k: v for k, v in row.items() if k not in ("outcome", "load", "unit") and v is not None}
               for row in rows_of(blocks["loads"]) if row["outcome"] == outcome}
        joints = {name.split(" ", 1)[1]: own.pop(name) for name in list(own) if name.startswith("joint ")}
        return {**own, "joints": joints}

    found["before"] = loads("before")
    found["designs"] = []
    for row in rows_of(blocks["outcomes"]):
        name = row["outcome"]
        own = {**row, "before": found["before"], "after": loads(name),
               "weights": [w for w in rows_of(blocks["weights"]) if w["outcome"] == name],
               "without": [w["link"] for w in rows_of(blocks["without_weight"]) if w["outcome"] == name]}
        if name.startswith("design "):
            found["designs"].append(own)
        else:
            found[name] = own
    found["budgets"] = rows_of(blocks.get("budgets", {}))
    found["front"] = rows_of(blocks.get("front", {}))
    return springs(blocks, found)


def springs(blocks, found):
    """What muscle found of springs, added to the rest."""
    for row in rows_of(blocks.get("spring_result", {})):
        found["spring_load"] = {**row, "name": row["load"], "convex": bool(row["convex"])}
        found["springs"] = [{**spring, "from": [spring["x1"], spring["y1"]], "to": [spring["x2"], spring["y2"]]}
                            for spring in rows_of(blocks["springs"])]
    return found
