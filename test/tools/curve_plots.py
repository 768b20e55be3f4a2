"""Reads the curves that balm and ssics draw (CASE.curves.svg) back into numbers, for the tests: about four digits of a panel's height."""
import re
import xml.etree.ElementTree as ElementTree

SVG = "{http://www.w3.org/2000/svg}"


class Plot:
    """A panel: its name, ends of the axes, shaded parts, and lines as (label, classes, points)."""

    def __init__(self, group):
        self.name = group.get("data-name")
        self.first, self.last, self.low, self.high = (float(group.get("data-" + key)) for key in ("from", "to", "low", "high"))
        self.box = [float(v) for v in group.get("data-box").split()]
        self.words = " ".join("".join(e.itertext()) for e in group.iter(SVG + "text"))
        self.spans = [(self.across(float(e.get("x"))), self.across(float(e.get("x")) + float(e.get("width"))))
                      for e in group.iter(SVG + "rect") if e.get("class") == "span"]
        self.values = {e.get("data-name"): e.get("data-values").split() for e in group.iter(SVG + "path") if e.get("data-values")}
        self.lines = [(e.get("data-name"), e.get("class").split(), self.points(e)) for e in group.iter(SVG + "path") if e.get("data-name") is not None]

    def across(self, x):
        return self.first + (x - self.box[0]) / self.box[2] * (self.last - self.first)

    def up(self, y):
        return self.high - (y - self.box[1]) / self.box[3] * (self.high - self.low)

    def points(self, path):
        """Places of a line, steps without their corners; None before each new stroke but the first."""
        list_, ring = [], 3.5 if "a3.5" in path.get("d") else 0.0  # a ring begins at its leftmost point
        for command, x, y in re.findall(r"([ML]?)\s*(-?[\d.E+-]+) (-?[\d.E+-]+)(?=\s*(?:[MLHZah]|-?\d|$))", re.sub(r"a[^Ma]*a[^Ma]*", "", path.get("d"))):
            if command == "M" and list_ and "dots" not in path.get("class"):
                list_.append(None)
            list_.append((self.across(float(x) + ring), self.up(float(y))))
        return list_

    def line(self, label, look=""):
        return next(points for name, classes, points in self.lines if name == label and (not look or look in classes))

    def error(self):
        """What a pixel is worth upwards, at most."""
        return 0.02 * (self.high - self.low) / self.box[3]


def plots_of(name):
    return [Plot(group) for group in ElementTree.parse(name).getroot().iter(SVG + "g") if group.get("class") == "plot"]


def follows(plot, points, pairs):
    """Whether all pairs of input and value are points of the line, in this order."""
    there = [p for p in points if p]
    wide = 0.02 * (plot.last - plot.first) / plot.box[2]
    return len(there) == len(pairs) and all(abs(a[0] - b[0]) <= wide and abs(a[1] - b[1]) <= plot.error() for a, b in zip(there, pairs))
