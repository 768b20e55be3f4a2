"""PSALM: analysis and synthesis of planar linkages.

A `Case` is one linkage and what is asked of it, in the notation of doc/reference/input_file.md. It is read from a file or from text, or made loop by
loop; it is studied; results are NumPy arrays. Lengths are in one unit of your choice, angles in degrees, rates of angles in radians.
Loops, arcs and cases are counted from 1.

    >>> import psalm
    >>> case = psalm.Case.from_file("data/dyad4_slider_crank.nml")
    >>> case.analyse().actual[0, 0]
    179.64240...

Errors of a case raise `psalm.Error`, which has the findings; what is only violated is a warning in the findings of the result.
Different cases may be used by different threads at the same time, one case by one thread only. A case cannot be copied or pickled:
make another one from its file or text. After a study by two or more threads a forked child must not start such a study again
(multiprocessing: take the start method "spawn").
"""
import ctypes
import dataclasses
import os
import threading
import typing

import numpy

__all__ = ["Analysis", "Case", "Error", "Finding", "Rates", "Tolerances", "version"]

_DONE, _VIOLATION, _BAD_INPUT, _FILE_TROUBLE, _MISUSE = range(5)
_INPUT, _CLOSED, _ACTUAL, _DEVIATION, _OBJECTIVE = range(1, 6)
_VELOCITY, _ACCELERATION, _JERK, _RATE, _RATE2, _RATE3, _WORST_CASE, _RSS = range(6, 14)
_LEVELS = {1: "warning", 2: "error"}


def _load():
    """The shared library: PSALM_LIBRARY, else beside this module, else where scripts/build_library puts it in a checkout."""
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.environ.get("PSALM_LIBRARY"), os.path.join(here, "libpsalm.so"),
              os.path.join(here, "..", "..", "build", "lib", "libpsalm.so")]
    for place in places:
        if place and os.path.exists(place):
            library = ctypes.CDLL(place)
            break
    else:
        raise ImportError("libpsalm.so is not there: run scripts/build_library, or pip install ./python, or set PSALM_LIBRARY")
    case, text, whole, real = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_double
    integers, reals = ctypes.POINTER(whole), ctypes.POINTER(real)
    made = ctypes.POINTER(case)
    for name, result, arguments in (
            ("version", text, []), ("status_text", text, [whole]),
            ("read_file", whole, [text, whole, made]), ("read_text", whole, [text, whole, made]), ("new", whole, [text, made]),
            ("free", None, [case]), ("add_loop", whole, [case, whole, integers, integers, reals, reals]),
            ("set_integers", whole, [case, text, text, whole, integers]), ("set_reals", whole, [case, text, text, whole, reals]),
            ("set_word", whole, [case, text, text, text]),
            ("set_length", whole, [case, whole, whole, real]), ("set_angle", whole, [case, whole, whole, real]),
            ("get_length", whole, [case, whole, whole, reals]), ("get_angle", whole, [case, whole, whole, reals]),
            ("analyse", whole, [case]), ("rates", whole, [case]), ("tolerances", whole, [case, whole]),
            ("synthesise", whole, [case, whole]), ("found", whole, [case, whole, made]),
            ("positions", whole, [case]), ("components", whole, [case]), ("values", whole, [case, whole, whole, reals]),
            ("cancel", whole, [case]), ("progress", whole, [case, ctypes.POINTER(whole), ctypes.POINTER(whole), reals]),
            ("listing", text, [case]), ("findings", whole, [case]), ("finding_level", whole, [case, whole]),
            ("finding_line", whole, [case, whole]), ("finding_text", text, [case, whole])):
        function = getattr(library, "psalm_" + name)
        function.restype, function.argtypes = result, arguments
    return library


_library = _load()
version = _library.psalm_version().decode()


class Finding(typing.NamedTuple):
    """An error or a warning: level, line (0: none), text with its place."""
    level: str
    line: int
    text: str


class Error(Exception):
    """A case has errors, a file cannot be read, or a call is wrong. `findings` says what."""

    def __init__(self, status, findings):
        self.status, self.findings = status, findings
        super().__init__("\n".join(f.text for f in findings) or _library.psalm_status_text(status).decode())


@dataclasses.dataclass
class _Motion:
    input: numpy.ndarray        #: (positions,) degrees, or length of a sliding input
    closed: numpy.ndarray       #: (positions,) of bool: every loop that matters closes
    actual: numpy.ndarray       #: (positions, components): output; NaN where the linkage does not close
    findings: list              #: warnings
    violated: bool              #: closure or a limit is violated


@dataclasses.dataclass
class Analysis(_Motion):
    """What a linkage does at its input positions."""
    deviation: numpy.ndarray    #: (positions, components): desired minus actual
    objective: float            #: weighted sum of the squared deviations
    listing: str                #: as psalm prints it


@dataclasses.dataclass
class Rates(_Motion):
    """Velocities, accelerations and jerks, (positions, components) each; NaN at a dead point."""
    velocity: numpy.ndarray     #: by time
    acceleration: numpy.ndarray
    jerk: numpy.ndarray
    rate: numpy.ndarray         #: by the input: per radian, or per length of a sliding input
    rate2: numpy.ndarray
    rate3: numpy.ndarray
    listing: str                #: as kalm prints it


@dataclasses.dataclass
class Tolerances(_Motion):
    """What the tolerances of the group TOLER do to the output, (positions, components) each; NaN at a dead point."""
    worst_case: numpy.ndarray
    rss: numpy.ndarray          #: root-sum-square


def _reals(values):
    array = numpy.ascontiguousarray(values, dtype=numpy.float64)
    return array, array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def _integers(values):
    array = numpy.ascontiguousarray(values)
    if array.dtype.kind not in "iu" or (array.size and numpy.abs(array).max() > 2**31 - 1):
        raise TypeError("integers of 32 bits are expected")
    array = array.astype(numpy.intc)
    return array, array.ctypes.data_as(ctypes.POINTER(ctypes.c_int))


class Case:
    """One linkage and what is asked of it."""

    def __init__(self, title="CASE"):
        """A case to be filled by `add_loop` and `set`."""
        self._handle = None
        self._take(_library.psalm_new, title.encode())

    @classmethod
    def from_file(cls, name, number=1):
        """The case of that number of a file."""
        self = cls.__new__(cls)
        self._handle = None
        self._take(_library.psalm_read_file, os.fsencode(name), number)
        return self

    @classmethod
    def from_text(cls, text, number=1):
        """The case of that number of a text."""
        self = cls.__new__(cls)
        self._handle = None
        self._take(_library.psalm_read_text, text.encode(), number)
        return self

    def _take(self, function, *arguments):
        """Become the case that a function of the library makes."""
        made = ctypes.c_void_p()
        status = function(*arguments, ctypes.byref(made))
        self._handle = made.value
        if status != _DONE:
            raise Error(status, self.findings)

    def __del__(self):
        if getattr(self, "_handle", None) and _library:
            _library.psalm_free(self._handle)
            self._handle = None

    def _no_copy(self, *_):
        raise TypeError("a psalm.Case cannot be copied or pickled; make another one by from_file or from_text")

    __copy__ = __deepcopy__ = __reduce_ex__ = __reduce__ = _no_copy

    def _run(self, function, threads, progress=None):
        """The status of a study in a thread of its own, so that Ctrl-C and other signals are heard while it works."""
        status = []
        worker = threading.Thread(target=lambda: status.append(function(self._handle, threads)), daemon=True)
        made, most, best = ctypes.c_int(), ctypes.c_int(), ctypes.c_double()
        worker.start()
        try:
            while worker.is_alive():
                worker.join(0.05)
                if progress is None or not worker.is_alive():
                    continue
                _library.psalm_progress(self._handle, ctypes.byref(made), ctypes.byref(most), ctypes.byref(best))
                if made.value > 0 and progress(made.value, most.value, best.value):
                    _library.psalm_cancel(self._handle)
        except BaseException:
            while worker.is_alive():    # a study that has not begun yet does not hear the first
                _library.psalm_cancel(self._handle)
                worker.join(0.01)
            raise
        return status[0]

    def _check(self, status):
        """True if something is violated; an exception if the call failed."""
        if status not in (_DONE, _VIOLATION):
            raise Error(status, self.findings)
        return status == _VIOLATION

    @property
    def findings(self):
        """Findings of the last call."""
        return [Finding(_LEVELS[_library.psalm_finding_level(self._handle, i)], _library.psalm_finding_line(self._handle, i),
                        _library.psalm_finding_text(self._handle, i).decode(errors="replace"))
                for i in range(1, _library.psalm_findings(self._handle) + 1)]

    # ---- making and changing a case

    def add_loop(self, ilink, iloop, length=None, angle=None):
        """Add a loop to a case made in memory: ILINK, ILOOP, ARCL and GAMA of its arcs."""
        links, links_at = _integers(ilink)
        loops, loops_at = _integers(iloop)
        lengths, lengths_at = (None, None) if length is None else _reals(length)
        angles, angles_at = (None, None) if angle is None else _reals(angle)
        if links.ndim != 1 or any(a is not None and a.shape != links.shape for a in (loops, lengths, angles)):
            raise ValueError("ilink, iloop, length and angle must have as many values")
        self._check(_library.psalm_add_loop(self._handle, len(links), links_at, loops_at, lengths_at, angles_at))

    def set(self, group, item, values):
        """Give an item of a case made in memory its values: a word, an integer, a number, or an array of either."""
        names = group.encode(), item.encode()
        if isinstance(values, str):
            self._check(_library.psalm_set_word(self._handle, *names, values.encode()))
            return
        array = numpy.atleast_1d(values)
        if array.dtype.kind in "iu":
            array, at = _integers(array)
            function = _library.psalm_set_integers
        else:
            array, at = _reals(array)
            function = _library.psalm_set_reals
        self._check(function(self._handle, *names, array.size, at))

    def set_length(self, loop, arc, value):
        self._check(_library.psalm_set_length(self._handle, loop, arc, value))

    def set_angle(self, loop, arc, value):
        self._check(_library.psalm_set_angle(self._handle, loop, arc, value))

    def length(self, loop, arc):
        value = ctypes.c_double()
        self._check(_library.psalm_get_length(self._handle, loop, arc, ctypes.byref(value)))
        return value.value

    def angle(self, loop, arc):
        value = ctypes.c_double()
        self._check(_library.psalm_get_angle(self._handle, loop, arc, ctypes.byref(value)))
        return value.value

    # ---- studies

    def analyse(self):
        """What the linkage does at its input positions."""
        violated = self._check(_library.psalm_analyse(self._handle))
        motion = self._motion(violated)
        return Analysis(**motion, deviation=self._values(_DEVIATION), objective=float(self._values(_OBJECTIVE, (1,))[0]),
                        listing=_library.psalm_listing(self._handle).decode())

    def rates(self):
        """Velocities, accelerations and jerks of the output."""
        violated = self._check(_library.psalm_rates(self._handle))
        return Rates(**self._motion(violated), velocity=self._values(_VELOCITY), acceleration=self._values(_ACCELERATION),
                     jerk=self._values(_JERK), rate=self._values(_RATE), rate2=self._values(_RATE2), rate3=self._values(_RATE3),
                     listing=_library.psalm_listing(self._handle).decode())

    def tolerances(self, threads=0):
        """What the tolerances of the group TOLER do to the output; `Error` if the linkage does not close everywhere."""
        violated = self._check(self._run(_library.psalm_tolerances, threads))
        if not _library.psalm_positions(self._handle):
            raise Error(_VIOLATION, self.findings)
        return Tolerances(**self._motion(violated), worst_case=self._values(_WORST_CASE), rss=self._values(_RSS))

    def synthesise(self, threads=0, progress=None):
        """Search for better dimensions. Returns the linkages found, best first: cases without variables.

        `progress(made, most, best)` is called some twenty times a second with the starts or iterations made, how many there will be
        at most, and the best objective; if it returns something true the search ends, and what it found so far is returned. Ctrl-C
        ends it too, as KeyboardInterrupt.
        """
        self._check(self._run(_library.psalm_synthesise, threads, progress))
        found = []
        while True:
            case = Case.__new__(Case)
            case._handle = None
            made = ctypes.c_void_p()
            if _library.psalm_found(self._handle, len(found) + 1, ctypes.byref(made)) != _DONE:
                return found
            case._handle = made.value
            found.append(case)

    def _motion(self, violated):
        shape = (_library.psalm_positions(self._handle),)
        return {"input": self._values(_INPUT, shape), "closed": self._values(_CLOSED, shape) > 0.5, "actual": self._values(_ACTUAL),
                "findings": self.findings, "violated": violated}

    def _values(self, what, shape=None):
        if shape is None:
            shape = _library.psalm_positions(self._handle), _library.psalm_components(self._handle)
        array, at = _reals(numpy.empty(shape))
        self._check(_library.psalm_values(self._handle, what, array.size, at))
        return array
