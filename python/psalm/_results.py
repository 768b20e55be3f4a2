"""What a study gives: tables of named columns, as NumPy arrays."""
import ctypes
import functools
import html
import typing

import numpy

from . import _library
from ._library import library


class Finding(typing.NamedTuple):
    """An error, a warning or a remark: level, line (0: none), text with its place."""
    level: str
    line: int
    text: str


class Error(Exception):
    """A case has errors, a file cannot be read, or a call is wrong. `findings` says what, each with its line."""

    def __init__(self, status: int, findings: typing.Sequence[Finding] = (), words: str = ""):
        if not isinstance(status, int):
            raise TypeError("a status is expected, not %r" % (status,))
        self.status, self.findings = status, list(findings)
        super().__init__("\n".join(f.text for f in self.findings) or words or library.psalm_status_text(ctypes.c_int(status)).decode())

    def __reduce__(self):
        return Error, (self.status, self.findings, str(self))


class _Owner:
    """The result in the library, which lives as long as a result, a table or a column of it: none of these refers to one that refers back,
    so that its memory is free as soon as the last is gone."""
    __slots__ = ("handle",)

    def __init__(self, made: ctypes.c_void_p):
        # a number would be taken for an address
        if not isinstance(made, ctypes.c_void_p) or not made.value:
            raise TypeError("a result is made by a study, as case.analyse()")
        self.handle = made.value

    def __del__(self):
        if library and hasattr(self, "handle"):
            library.psalm_result_free(self.handle)

    def __reduce__(self):
        raise TypeError("a result of psalm is not copied or pickled: take its tables, as result.to_dict()")


class _Layout:
    """The columns of a table: names, and by name the number, kind and unit; of several of one name the first. `groups`: what stands
    before a point of a name."""

    def __init__(self, lines: bytes):
        fields = [line.split("\t") for line in lines.decode(errors="replace").split("\n")[:-1]]
        self.names = [name for kind, unit, name in fields]
        self.found = {name: (number, int(kind), unit) for number, (kind, unit, name) in reversed(list(enumerate(fields, 1)))}
        self.groups = {name[:at] for name in self.names for at in range(len(name)) if name[at] == "."}


# studies of one kind give tables of the same columns again and again
_layout = functools.lru_cache(maxsize=256)(_Layout)


class Column(numpy.ndarray):
    """A column of a table: an array of the shape (rows,) with its `unit`; further columns of the same name are its attributes:
    `rocker.v` is the column `rocker.v`."""
    _of = _name = None      # owner and number of its table, name: of a whole column
    unit: str = ""

    def __array_finalize__(self, other):
        if isinstance(other, Column):
            self.unit = other.unit

    def __array_wrap__(self, array, context=None, return_scalar=False):
        # what is computed from a column has another unit
        return array[()] if array.ndim == 0 else numpy.asarray(array)

    def __getattr__(self, name):
        if self._of is not None and not name.startswith("_"):
            column = Table(*self._of)._column("%s.%s" % (self._name, name))
            if column is not None:
                return column
        raise AttributeError("there is no column %s.%s" % (self._name, name) if self._name else name)

    def __reduce__(self):
        return numpy.asarray(self).__reduce__()


class Group:
    """Columns of one name: `motion["P"].x` is the column `P.x`. `xy` is an array of the shape (rows, 2)."""

    def __init__(self, table: "Table", name: str):
        if not isinstance(table, Table):
            raise TypeError("columns are those of a table, as motion['P']")
        self._table, self._name = table, name

    def __getattr__(self, name: str) -> Column:
        if not name.startswith("_"):
            column = self._table._column("%s.%s" % (self._name, name))
            if column is not None:
                return column
        raise AttributeError("there is no column %s.%s; there are %s" % (self._name, name, ", ".join(dir(self))))

    # a look-up that need not fail first
    x = property(lambda self: self.__getattr__("x"), doc="(rows,): horizontal coordinate")
    y = property(lambda self: self.__getattr__("y"), doc="(rows,): vertical coordinate")

    def __dir__(self):
        return [n[len(self._name) + 1:] for n in self._table.columns if n.startswith(self._name + ".")]

    @property
    def xy(self) -> numpy.ndarray:
        """(rows, 2): x and y."""
        return numpy.column_stack([self.x, self.y])

    def __repr__(self):
        return "<psalm columns %s>" % ", ".join("%s.%s" % (self._name, n) for n in dir(self))


class Table(typing.Mapping):
    """A table of a result: names of its columns to arrays of the shape (rows,). What is not known is NaN.

    `table["P.x"]` is a column, `table["P"].x` the same, `table["P"].xy` both coordinates. `units` has the unit of every column.
    """

    def __init__(self, owner: _Owner, number: int):
        if not isinstance(owner, _Owner):
            raise TypeError("a table is one of a result, as case.analyse().table")
        self._owner, self._handle, self._number, self._read = owner, owner.handle, number, {}
        lines = library.psalm_columns(self._handle, number)
        if lines is None:
            raise KeyError("this result has no table")
        self._layout = _layout(lines)
        self.rows: int = library.psalm_row_count(self._handle, number)

    @property
    def name(self) -> str:
        return library.psalm_table_name(self._handle, self._number).decode()

    @property
    def about(self) -> str:
        """What a row is."""
        return library.psalm_table_about(self._handle, self._number).decode()

    @property
    def columns(self) -> typing.List[str]:
        """Names of the columns."""
        return list(self._layout.names)

    @property
    def units(self) -> typing.Dict[str, str]:
        """Unit of every column; empty for pure numbers and words."""
        return {name: self._layout.found[name][2] for name in self._layout.names}

    def __contains__(self, name):
        return name in self._layout.found

    def __iter__(self):
        return iter(self._layout.names)

    def __len__(self):
        return len(self._layout.names)

    def __getitem__(self, name: str):
        if not isinstance(name, str):
            raise KeyError(name)
        if name in self._layout.found:
            return self._column(name)
        if name in self._layout.groups:
            return Group(self, name)
        raise KeyError("%s; there are %s" % (name, ", ".join(self.columns)))

    def _column(self, name):
        """A column; None if there is none of that name."""
        if name in self._read:
            return self._read[name]
        if name not in self._layout.found:
            return None
        handle, number = self._handle, self._number
        place, kind, unit = self._layout.found[name]
        if kind == _library.WORD:
            values = numpy.array([library.psalm_word(handle, number, place, r).decode() for r in range(1, self.rows + 1)], dtype=object)
        else:
            room = (ctypes.c_double*self.rows)()    # of ctypes: to ask an array of NumPy for its address takes longer than to copy it
            if library.psalm_column(handle, number, place, self.rows, room) != _library.DONE:
                raise Error(_library.MISUSE)
            values = numpy.ndarray.__new__(Column, self.rows, float, room)
            if kind == _library.FLAG and not numpy.isnan(values).any():
                values = (values > 0.5).view(Column)
            elif kind == _library.WHOLE and not numpy.isnan(values).any():
                values = values.astype(int)
            values.unit, values._of, values._name = unit, (self._owner, number), name
        self._read[name] = values
        return values

    def to_dict(self) -> typing.Dict[str, numpy.ndarray]:
        """Plain arrays by name."""
        return {name: numpy.asarray(self[name]) for name in self.columns}

    def to_dataframe(self):
        """A pandas.DataFrame, a row for each row; `attrs["units"]` has the units."""
        import pandas
        frame = pandas.DataFrame(self.to_dict())
        frame.attrs["units"], frame.attrs["about"] = self.units, self.about
        return frame

    def to_xarray(self):
        """An xarray.Dataset over the dimension `row`, or `input`, if the table has that column; every variable has its unit."""
        import xarray
        units = self.units
        over = "input" if "input" in units else "row"
        data = xarray.Dataset({n: (over, v, {"units": units[n]}) for n, v in self.to_dict().items() if n != over},
                              attrs={"about": self.about})
        return data.assign_coords(input=("input", self.to_dict()["input"], {"units": units["input"]})) if over == "input" else data

    def __repr__(self):
        return "<psalm.Table %s: %d rows of %s>" % (self.name, self.rows, ", ".join(self.columns))

    def _repr_html_(self, most=20):
        units = self.units
        head = "".join("<th>%s%s</th>" % (html.escape(n), "<br><small>%s</small>" % html.escape(units[n]) if units[n] else "")
                       for n in self.columns)
        data = list(self.to_dict().values())
        rows = "".join("<tr>%s</tr>" % "".join("<td>%s</td>" % (html.escape(v[r]) if isinstance(v[r], str) else "%.6g" % v[r])
                                               for v in data) for r in range(min(most, self.rows)))
        more = "" if self.rows <= most else "<p>%d rows more</p>" % (self.rows - most)
        return "<table><caption>%s</caption><tr>%s</tr>%s</table>%s" % (html.escape(self.about), head, rows, more)


class Result:
    """What a study gives.

    `result["P"].x` is a column of the table that it is about; `result.tables` has all tables by name. `listing` is what the program
    prints, `files` are pictures by the ending of their name, `cases` the linkages found, best first. `violated` tells that closure or a
    limit is violated, or that a search stopped early; `findings` has warnings and remarks.
    """

    def __init__(self, made: ctypes.c_void_p, findings: typing.List[Finding], violated: bool, verb: str):
        self._owner, self._tables, self._cases = _Owner(made), {}, None
        self._handle = self._owner.handle
        self.findings, self.violated, self.verb = findings, violated, verb

    def _table(self, number):
        if number not in self._tables:
            self._tables[number] = Table(self._owner, number)
        return self._tables[number]

    @property
    def tables(self) -> typing.Dict[str, Table]:
        """All tables by name."""
        all_tables = [self._table(t) for t in range(1, library.psalm_table_count(self._handle) + 1)]
        return {t.name: t for t in reversed(all_tables)}

    @property
    def table(self) -> Table:
        """The table that the result is about, the first: of a search `found`, of motion in time `time`, else a row for each position or
        what the study gives."""
        return self._table(1)

    def __contains__(self, name):
        return name in self.table

    def __getitem__(self, name: str):
        """A column of the first table, or a group of them; else a table."""
        try:
            return self.table[name]
        except KeyError:
            place = library.psalm_find_table(self._handle, name.encode()) if isinstance(name, str) else 0
            if place == 0:
                raise
            return self._table(place)

    @property
    def listing(self) -> str:
        """What the program prints; empty of a brief study."""
        return library.psalm_listing(self._handle).decode(errors="replace")

    @property
    def data_set(self) -> str:
        """The linkages found, in the notation of the manual; empty if there are none."""
        return library.psalm_found_text(self._handle).decode(errors="replace")

    @property
    def cases(self) -> list:
        """The linkages found as cases, best first."""
        if self._cases is None:
            from ._cases import Case
            self._cases = [Case._of_result(self._handle, k) for k in range(1, library.psalm_case_count(self._handle) + 1)]
        return self._cases

    @property
    def files(self) -> typing.Dict[str, str]:
        """Pictures and pages: ending of the name (".svg", ".dxf", ".html" ...) to content."""
        return {library.psalm_file_ending(self._handle, k).decode(): library.psalm_file_content(self._handle, k).decode(errors="replace")
                for k in range(1, library.psalm_file_count(self._handle) + 1)}

    def to_dict(self):
        """Arrays of the first table by name."""
        return self.table.to_dict()

    def to_dataframe(self):
        """The first table as pandas.DataFrame."""
        return self.table.to_dataframe()

    def to_xarray(self):
        """The first table as xarray.Dataset."""
        return self.table.to_xarray()

    def __repr__(self):
        parts = ["%s (%d x %d)" % (t.name, t.rows, len(t)) for t in self.tables.values()]
        if library.psalm_case_count(self._handle):
            parts.append("%d linkages" % library.psalm_case_count(self._handle))
        if library.psalm_file_count(self._handle):
            parts.append(" ".join(self.files))
        return "<psalm.%s of %s%s%s>" % (type(self).__name__, self.verb, ": " if parts else "", ", ".join(parts)) + \
            (" violated" if self.violated else "")

    def _repr_html_(self):
        if ".html" in self.files:
            return frame_of(self.files[".html"])
        if library.psalm_table_count(self._handle) == 0:
            return "<pre>%s</pre>" % html.escape(self.listing)
        return self.table._repr_html_()


class Motion(Result):
    """Result of an analysis, of rates or forces: a row for each position.

    Of a linkage given by its loops the output has properties too: `actual`, `desired`, `deviation` of the shape (positions,
    components), and after rates `velocity`, `acceleration`, `jerk` (by time), `rate`, `rate2`, `rate3` (by the input).
    """

    @property
    def input(self) -> numpy.ndarray:
        """(positions,): degrees, or length of a sliding input; of several drives that of the first."""
        return self.table["input"] if "input" in self.table else self.table[next(n for n in self.table if n.startswith("input."))]

    @property
    def closed(self) -> numpy.ndarray:
        """(positions,) of bool: every loop that matters closes."""
        return numpy.asarray(self.table["closed"], dtype=bool)

    def _components(self, name, ending=""):
        table = self.table
        if name + ending in table:
            return numpy.asarray(table[name + ending])[:, None]
        found = [c + ending for c in (name + ".x", name + ".y", name + ".angle") if c + ending in table]
        if not found:
            raise AttributeError("there is no column %s%s; there are %s" % (name, ending, ", ".join(table.columns)))
        return numpy.column_stack([table[c] for c in found])

    actual = property(lambda self: self._components("output"), doc="(positions, components): output; NaN where it does not close")
    desired = property(lambda self: self._components("desired"), doc="(positions, components): desired output")
    deviation = property(lambda self: self._components("deviation"), doc="(positions, components): desired minus actual")
    velocity = property(lambda self: self._components("output", ".v"), doc="(positions, components): by time; NaN at a dead point")
    acceleration = property(lambda self: self._components("output", ".a"), doc="(positions, components): by time")
    jerk = property(lambda self: self._components("output", ".j"), doc="(positions, components): by time")
    rate = property(lambda self: self._components("output", ".first"), doc="(positions, components): by the input, angles in radians")
    rate2 = property(lambda self: self._components("output", ".second"), doc="(positions, components): second, by the input")
    rate3 = property(lambda self: self._components("output", ".third"), doc="(positions, components): third, by the input")

    @property
    def objective(self) -> float:
        """Weighted sum of the squared deviations."""
        return float(self.tables["totals"]["objective"][0])


class Search(Result):
    """Result of a search: a sequence of the linkages found, best first. `search[0]` is a case, `search["objective"]` a column over
    the linkages. `best_objective` is that of the first."""

    @property
    def best_objective(self) -> float:
        """Objective of the first, of a study that has objectives."""
        return float(self["objective"][0])

    def __len__(self):
        return library.psalm_case_count(self._handle)

    def __bool__(self):
        return len(self) > 0

    def __iter__(self):
        return iter(self.cases)

    def __getitem__(self, key):
        if isinstance(key, (int, slice, numpy.integer)):
            return self.cases[key]
        return super().__getitem__(key)


def frame_of(page: str, height: int = 640) -> str:
    """A page in a frame that can reach nothing outside it."""
    return '<iframe sandbox="allow-scripts" style="width:100%%;height:%dpx;border:0" srcdoc="%s"></iframe>' % (
        height, html.escape(page, quote=True))
