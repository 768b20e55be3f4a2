"""Cases: linkages and what is asked of them."""
import ctypes
import os
import re
import sys
import threading
import time
import typing

import numpy

from . import _library
from ._library import library
from ._results import Error, Finding, Motion, Result, Search, frame_of

if typing.TYPE_CHECKING:
    import matplotlib.axes

Numbers = typing.Union[typing.Sequence[float], numpy.ndarray]
Progress = typing.Union[None, bool, typing.Callable[[int, int, float], typing.Any]]
_AT_ONCE = ("analysis", "rates", "forces", "summary")   # studies so short that no thread is made for them,
_SHORT = 50000   # of a case that is at most so long, characters: some thousand positions
_SHOWN = 12      # joints that a repr names
_KINDS = {"analysis": Motion, "rates": Motion, "forces": Motion, "machine": Motion, "synthesis": Search, "exact": Search, "kinds": Search}


def _reals(values):
    array = numpy.ascontiguousarray(values, dtype=numpy.float64)
    return array, array.ctypes.data


def _integers(values):
    array = numpy.ascontiguousarray(values)
    if array.dtype.kind not in "iu" or (array.size and max(abs(int(array.min())), abs(int(array.max()))) > 2**31 - 1):
        raise TypeError("integers of 32 bits are expected")
    array = array.astype(numpy.intc)
    return array, array.ctypes.data


def _text(word):
    """A text for the library."""
    if not isinstance(word, str):
        raise TypeError("a text is expected, not %r" % (word,))
    if "\0" in word:
        raise ValueError("a text must not have the character 0")
    return word.encode()


def _optional(word):
    return None if word is None else _text(word)


def _whole(number):
    if isinstance(number, bool) or not isinstance(number, (int, numpy.integer)):
        raise TypeError("an integer is expected, not %r" % (number,))
    if abs(int(number)) > 2**31 - 1:
        raise TypeError("integers of 32 bits are expected")
    return int(number)


def _names(joints):
    return _text(joints) if isinstance(joints, str) else _text(" ".join(joints))


class Case:
    """One linkage and what is asked of it, in the notation of the manual.

    `from_file`, `from_text` and `from_joints` make one; so do the linkages that a search found. Every study of the suite is a method.
    A case can be copied, pickled (by its text) and used by one thread at a time.
    """

    def __init__(self, title: str = "CASE"):
        """A case to be filled by `add_joint`, `add_link`, ..., or `add_loop`, and `set`."""
        self._begin()
        self._take(library.psalm_new, _text(title))

    def _begin(self):
        self._handle = None
        self._size = 0
        #: what the last search found, kept if it is ended by Ctrl-C
        self.found: typing.Optional[Search] = None

    @classmethod
    def from_file(cls, name: typing.Union[str, os.PathLike], number: int = 1) -> "Case":
        """The case of that number of a file."""
        path = os.fsencode(name)
        if b"\0" in path:
            raise ValueError("a text must not have the character 0")
        made = cls._made(library.psalm_read_file, path, _whole(number))
        made._size = os.path.getsize(path)
        return made

    @classmethod
    def from_text(cls, text: str, number: int = 1) -> "Case":
        """The case of that number of a text in the notation of the manual, or in JSON."""
        made = cls._made(library.psalm_read_text, _text(text), _whole(number))
        made._size = len(text)
        return made

    @classmethod
    def from_joints(cls, joints: typing.Mapping[str, typing.Tuple[float, float]],
                    links: typing.Union[typing.Sequence, typing.Mapping[str, typing.Any]] = (), *, fixed: typing.Iterable[str] = (),
                    drive: typing.Union[None, str, typing.Sequence[str]] = None,
                    output: typing.Union[None, str, typing.Sequence[str], typing.Mapping[str, str]] = None,
                    slides: typing.Iterable = (), gears: typing.Iterable = (), step: typing.Optional[int] = None,
                    inputs: typing.Optional[Numbers] = None, title: str = "LINKAGE",
                    **groups: typing.Mapping[str, typing.Any]) -> "Case":
        """A linkage from its drawing.

        joints: name to (x, y). links: joints of each link, "B C P" or ["B", "C", "P"], or name to joints. fixed: joints of the frame
        (else the first link is the frame). drive: joint, slide or cylinder ("B C") that is driven. output: "point P", "angle rocker"
        ..., several in a list, or name to words. slides, gears: arguments of `add_slide`, `add_gear`. step: degrees between positions
        of a full turn; or inputs: (positions,), increments from the drawing. Further keywords are groups:
        `METHOD={"IKIN": 5}, RATES={"SPEED": 10.0}`.

            >>> four_bar = psalm.from_joints({"A": (0, 0), "B": (0, 31), "C": (33, 82), "D": (90, 5), "P": (20, 95)},
            ...                              links=["A B", "B C P", "C D"], fixed="AD", drive="A", output="point P", step=10)
            >>> four_bar.analyse()["P"].x       # (36,)
        """
        self = cls(title)
        fixed = list(fixed)
        for name in fixed:
            if name not in joints:
                raise ValueError("fixed: there is no joint %r" % (name,))
        for name, (x, y) in joints.items():
            self.add_joint(name, x, y, fixed=name in fixed)
        for link in links.items() if isinstance(links, typing.Mapping) else [(None, link) for link in links]:
            self.add_link(link[1], name=link[0])
        for slide in slides:
            self.add_slide(**slide) if isinstance(slide, typing.Mapping) else self.add_slide(*slide)
        for gear in gears:
            self.add_gear(**gear) if isinstance(gear, typing.Mapping) else self.add_gear(*gear)
        for one in [drive] if isinstance(drive, str) else drive or ():
            self.add_drive(one)
        if isinstance(output, typing.Mapping):
            for name, words in output.items():
                self.add_output(words, name)
        else:
            for words in [output] if isinstance(output, str) else output or ():
                self.add_output(words)
        if step is not None:
            self.turn(step)
        if inputs is not None:
            self.positions(inputs)
        for group, items in groups.items():
            self.set(group, **items)
        return self

    @classmethod
    def _made(cls, function, *arguments):
        self = cls.__new__(cls)
        self._begin()
        self._take(function, *arguments)
        return self

    @classmethod
    def _of_result(cls, result, number):
        return cls._made(library.psalm_case_of, result, number)

    def _take(self, function, *arguments):
        """Become the case that a function of the library makes."""
        made = ctypes.c_void_p()
        status = function(*arguments, ctypes.byref(made))
        self._handle = made.value
        if status != _library.DONE:
            raise Error(status, self.findings)

    def __del__(self):
        if getattr(self, "_handle", None) and library:
            library.psalm_free(self._handle)
            self._handle = None

    # ---- the case as a whole

    @property
    def title(self) -> str:
        return library.psalm_case_title(self._handle).decode(errors="replace")

    @property
    def text(self) -> str:
        """The case in the notation of the manual: what a file would have."""
        return library.psalm_case_text(self._handle).decode(errors="replace")

    def copy(self) -> "Case":
        """The same case once more, to be changed without this one."""
        other = type(self)._made(library.psalm_copy, self._handle)
        other._size = self._size
        return other

    def __copy__(self):
        return self.copy()

    def __deepcopy__(self, memo):
        return self.copy()

    def __reduce__(self):
        text = self.text
        if not text:
            raise TypeError("this case has no text of its own (its dimensions were changed, and no loops tell its sketch)")
        return _case_from_text, (type(self), text)

    def __repr__(self):
        """Its title, joints and links of a sketch or the number of loops, and the groups that it has."""
        text, loops = self.text, library.psalm_loop_count(self._handle)
        joints, links = _words_of(text, "JNT"), _words_of(text, "LNK")
        parts = []
        if joints:
            parts.append("joints %s; %d link%s" % (" ".join(joints[:_SHOWN]) + " ..."*(len(joints) > _SHOWN), len(links), "s"[len(links) == 1:]))
        elif loops:
            parts.append("%d loop%s" % (loops, "s"[loops == 1:]))
        parts.append(" ".join(dict.fromkeys("&" + name for name in re.findall(r"^ *&(?!END\b)(\w+)", text, re.M | re.I))))
        return "<psalm.%s %r%s>" % (type(self).__name__, self.title, "".join("; " + p for p in parts if p).replace(";", ":", 1))

    def _repr_html_(self):
        """The page on which the linkage moves, in a frame that can reach nothing outside it."""
        try:
            return frame_of(self.page())
        except (Error, KeyError) as error:
            return "<pre>%s\n%s</pre>" % (repr(self).replace("<", "&lt;"), str(error).replace("&", "&amp;").replace("<", "&lt;"))

    @property
    def findings(self) -> typing.List[Finding]:
        """Findings of the last call."""
        return [Finding(_library.LEVELS[library.psalm_finding_level(self._handle, i)], library.psalm_finding_line(self._handle, i),
                        library.psalm_finding_text(self._handle, i).decode(errors="replace"))
                for i in range(1, library.psalm_findings(self._handle) + 1)]

    def _check(self, status):
        """True if something is violated; an exception if the call failed."""
        if status not in (_library.DONE, _library.VIOLATION):
            raise Error(status, self.findings)
        return status == _library.VIOLATION

    # ---- making a case

    def add_joint(self, name: str, x: float, y: float, fixed: bool = False) -> None:
        """Add a joint where it is drawn, or move it there."""
        self._check(library.psalm_add_joint(self._handle, _text(name), float(x), float(y), int(bool(fixed))))

    def add_link(self, joints: typing.Union[str, typing.Iterable[str]], name: typing.Optional[str] = None) -> None:
        """Add a link by its joints: "B C P" or ["B", "C", "P"]. Its name is that of its joints, if none is given."""
        self._check(library.psalm_add_link(self._handle, _names(joints), _optional(name)))

    def add_slide(self, link: str, along: str, x: float, y: float, angle: float, name: typing.Optional[str] = None) -> None:
        """Add a slide (prismatic pair) between two links: a point of its line, its direction in degrees."""
        self._check(library.psalm_add_slide(self._handle, _text(link), _text(along), float(x), float(y), float(angle),
                                            _optional(name)))

    def add_gear(self, first: str, second: str, carrier: str, teeth: typing.Tuple[float, float]) -> None:
        """Add a pair of gears: two links, the link that both centres are on, their teeth (of an internal pair one is negative)."""
        one, other = teeth
        self._check(library.psalm_add_gear(self._handle, _text(first), _text(second), _text(carrier), float(one), float(other)))

    def add_drive(self, what: str, base: typing.Optional[str] = None, link: typing.Optional[str] = None) -> None:
        """Drive a joint, a slide or a cylinder ("B C"); base and link: between which links, where there are more than two."""
        self._check(library.psalm_add_drive(self._handle, _text(what), _optional(base), _optional(link)))

    def add_output(self, what: str, name: typing.Optional[str] = None) -> None:
        """Ask for an output: "point P", "angle rocker", "distance A B" ..., as OUTPUT of the manual."""
        self._check(library.psalm_add_output(self._handle, _text(what), _optional(name)))

    def vary(self, *what: str) -> None:
        """Let dimensions of a sketch vary in a search: "A B" a length, "angle B C B P", "place D", "input", as VARY of the manual."""
        for one in what:
            self._check(library.psalm_vary(self._handle, _text(one)))

    def add_loop(self, ilink: typing.Sequence[int], iloop: typing.Sequence[int], length: typing.Optional[Numbers] = None,
                 angle: typing.Optional[Numbers] = None) -> None:
        """Add a loop: ILINK, ILOOP, ARCL and GAMA of its arcs, (arcs,) each."""
        links, links_at = _integers(ilink)
        loops, loops_at = _integers(iloop)
        lengths, lengths_at = (None, None) if length is None else _reals(length)
        angles, angles_at = (None, None) if angle is None else _reals(angle)
        if links.ndim != 1 or any(a is not None and a.shape != links.shape for a in (loops, lengths, angles)):
            raise ValueError("ilink, iloop, length and angle must have as many values")
        self._check(library.psalm_add_loop(self._handle, len(links), links_at, loops_at, lengths_at, angles_at))

    def vary_arc(self, loop: int, arc: int, length: bool = True, angle: bool = False) -> None:
        """Let an arc vary in a search."""
        self._check(library.psalm_vary_arc(self._handle, _whole(loop), _whole(arc), int(bool(length)), int(bool(angle))))

    def set(self, group: str, item: typing.Optional[str] = None, values: typing.Any = None, **items: typing.Any) -> None:
        """Give items of a group their values: `set("RATES", SPEED=10.0, UNITS="RAD/S")` or `set("METHOD", "DELT(2)", 7.0)`.

        A value is a word, an integer, a number, or a sequence of either. Any item of the manual, of any case.
        """
        if item is not None:
            self._set(group, item, values)
        for name, given in items.items():
            self._set(group, name, given)

    def _set(self, group, item, values):
        names = _text(group), _text(item)
        if isinstance(values, str):
            self._check(library.psalm_set_word(self._handle, *names, _text(values)))
            return
        array = numpy.atleast_1d(numpy.asarray(values))
        if array.dtype.kind in "UO" and array.size and all(isinstance(v, str) for v in array.flat):
            words = (ctypes.c_char_p*array.size)(*[_text(v) for v in array.flat])
            self._check(library.psalm_set_words(self._handle, *names, array.size, ctypes.cast(words, ctypes.c_void_p)))
            return
        if array.dtype.kind == "b":
            array = array.astype(numpy.intc)
        if array.dtype.kind in "iu":
            array, at = _integers(array)
            function = library.psalm_set_integers
        elif array.dtype.kind == "f":
            array, at = _reals(array)
            function = library.psalm_set_reals
            self._size = max(self._size, array.nbytes)
        else:
            raise TypeError("a word, a number or a sequence of either is expected, not %r" % (values,))
        self._check(function(self._handle, *names, array.size, at))

    def turn(self, step: int) -> None:
        """Ask for a full turn of the crank in steps of whole degrees; negative: clockwise."""
        self._set("METHOD", "IKIN", _whole(step))

    def positions(self, increments: Numbers, reference: typing.Optional[float] = None) -> None:
        """Ask for input positions: (positions,), from the reference position, degrees or length."""
        increments = numpy.atleast_1d(numpy.asarray(increments, dtype=float))
        self._set("METHOD", "NDES", int(increments.size))
        self._set("METHOD", "DELT", increments)
        if reference is not None:
            self._set("METHOD", "CRNKI", float(reference))

    def desire(self, x: typing.Optional[Numbers] = None, y: typing.Optional[Numbers] = None,
               value: typing.Optional[Numbers] = None) -> None:
        """Say what the first output is to be at the positions, (positions,) each: x and y of a point, or the value."""
        for item, values in (("DESX", x), ("DESY", y), ("DESANG", value)):
            if values is not None:
                self._set("METHOD", item, numpy.asarray(values, dtype=float))

    # ---- dimensions of loops

    def set_length(self, loop: int, arc: int, value: float) -> None:
        """Change the length of an arc."""
        self._check(library.psalm_set_length(self._handle, _whole(loop), _whole(arc), float(value)))

    def set_angle(self, loop: int, arc: int, value: float) -> None:
        """Change the angle of an arc, degrees."""
        self._check(library.psalm_set_angle(self._handle, _whole(loop), _whole(arc), float(value)))

    def length(self, loop: int, arc: int) -> float:
        """Length of an arc."""
        value = ctypes.c_double()
        self._check(library.psalm_get_length(self._handle, _whole(loop), _whole(arc), ctypes.byref(value)))
        return value.value

    def angle(self, loop: int, arc: int) -> float:
        """Angle of an arc, degrees."""
        value = ctypes.c_double()
        self._check(library.psalm_get_angle(self._handle, _whole(loop), _whole(arc), ctypes.byref(value)))
        return value.value

    # ---- studies

    def study(self, verb: str, *, threads: int = 0, progress: Progress = None, listing: bool = True) -> Result:
        """Any study by its name (`psalm.verbs`).

        `progress(made, most, best)` is called some twenty times a second with the starts, iterations, paths, turns or rows made, how
        many there will be at most, and the best objective; if it returns something true the study ends, and what it found so far is
        returned.
        `progress=True` shows a bar. Ctrl-C ends a study, too: as KeyboardInterrupt, whose `result` is what was found so far. Other
        threads run meanwhile. Without `listing` analysis, rates and forces are several times as fast.
        """
        if not (progress is None or isinstance(progress, bool) or callable(progress)):
            raise TypeError("progress must be a function, True or None, not %r" % (progress,))
        arguments = self._handle, _text(verb), 0 if listing else _library.BRIEF, _whole(threads)
        made = ctypes.c_void_p()
        if verb in _AT_ONCE and self._size <= _SHORT:
            return self._result(library.psalm_study(*arguments, ctypes.byref(made)), made, verb)
        # an event, not the thread, is asked for the end: Python 3.11 takes a thread for ended whose join was interrupted
        status, ended = [], threading.Event()

        def work():
            try:
                status.append(library.psalm_study(*arguments, ctypes.byref(made)))
            finally:
                ended.set()

        bar = _Bar() if progress is True else progress or None
        threading.Thread(target=work, daemon=True).start()
        try:
            while not ended.wait(0.05):
                if bar is not None and self._tell(bar):
                    library.psalm_cancel(self._handle)
        except BaseException as error:
            while not ended.is_set():    # a study that has not begun yet does not hear the first
                library.psalm_cancel(self._handle)
                ended.wait(0.01)
            if status and made.value:
                error.result = self._result(status[0], made, verb)
            raise
        finally:
            if isinstance(bar, _Bar):
                bar.end()
        return self._result(status[0], made, verb)

    def _tell(self, progress):
        made, most, best = ctypes.c_int(), ctypes.c_int(), ctypes.c_double()
        library.psalm_progress(self._handle, ctypes.byref(made), ctypes.byref(most), ctypes.byref(best))
        return made.value > 0 and progress(made.value, most.value, best.value)

    def _result(self, status, made, verb):
        violated = self._check(status)
        findings = self.findings if library.psalm_findings(self._handle) else []
        result = _KINDS.get(verb, Result)(made, findings, violated, verb)
        if isinstance(result, Search):
            self.found = result
        return result

    def analyse(self, *, listing: bool = False) -> Motion:
        """What the linkage does at its input positions: a row for each, `["input"]`, `["closed"]`, outputs, of a sketch all joints
        (`["P"].x`, length)."""
        return self.study("analysis", listing=listing)

    def rates(self, *, listing: bool = False) -> Motion:
        """Velocities, accelerations and jerks of outputs and joints, a row for each position: `["P"].vx`, length/s, angles rad/s."""
        return self.study("rates", listing=listing)

    def forces(self, *, listing: bool = False) -> Motion:
        """Forces of drive, joints and frame, a row for each position. Needs &MASSES, &LOADS or &SPRING."""
        return self.study("forces", listing=listing)

    def machine(self, progress: Progress = None) -> Motion:
        """Motion from torque: steady cycle, run-up, flywheel. Needs &MOTOR."""
        return self.study("machine", progress=progress)

    def time(self, progress: Progress = None) -> Result:
        """Motion in time: `tables["time"]` has a row for each time, inputs, outputs, forces, energies; `tables["events"]` what happens at
        stops, `tables["equilibria"]` positions of rest. Needs &TIME."""
        return self.study("time", progress=progress)

    def tolerances(self, threads: int = 0, progress: Progress = None) -> Result:
        """What the tolerances of &TOLER do to the output: bands for each position. `Error` if the linkage does not close."""
        result = self.study("tolerances", threads=threads, progress=progress)
        if library.psalm_table_count(result._handle) == 0:
            raise Error(_library.VIOLATION, result.findings)
        return result

    def allocation(self, threads: int = 0, progress: Progress = None) -> Result:
        """The cheapest tolerances within the bands of &ALLOC: a row for each dimension, clearances of joints the last; what gaps do is in
        `tables["clearances"]` and `tables["clearance_effects"]`. `Error` if the linkage does not close."""
        result = self.study("allocation", threads=threads, progress=progress)
        if library.psalm_table_count(result._handle) == 0:
            raise Error(_library.VIOLATION, result.findings)
        return result

    def sweep(self, progress: Progress = None) -> Result:
        """The output for the settings of an adjustable dimension, &SWEEP."""
        return self.study("sweep", progress=progress)

    def synthesise(self, threads: int = 0, progress: Progress = None) -> Search:
        """Search for better dimensions. Returns the linkages found, best first; `[0]` is a case without variables."""
        return self.study("synthesis", threads=threads, progress=progress)

    def exact(self, progress: Progress = None, threads: int = 0) -> Search:
        """All linkages that &EXACT asks for: exactly through points, poses or pairs of a function. Threads share the paths of six-bars."""
        return self.study("exact", threads=threads, progress=progress)

    def kinds(self, threads: int = 0, progress: Progress = None) -> Search:
        """Which kind of linkage does what is wanted, &KINDS: the best linkages of all kinds, best first; `tables["kinds"]` has what was
        found of each kind."""
        return self.study("kinds", threads=threads, progress=progress)

    def prove(self) -> Result:
        """What can be proven of the motion over the range of the input (IPROOF)."""
        return self.study("proof")

    def assemblies(self, progress: Progress = None) -> Result:
        """Every way in which the links of a sketch can be put together: a row for each."""
        return self.study("assemblies", progress=progress)

    def balance(self) -> Result:
        """Counterweights, &BALANC. `cases[0]` is the linkage with its weights."""
        return self.study("balance")

    def springs(self, progress: Progress = None) -> Result:
        """Springs, &SPRNGS. `cases[0]` is the linkage with its springs."""
        return self.study("springs", progress=progress)

    def vibration(self, progress: Progress = None) -> Result:
        """Vibration and stability of links and drives: &ESTIM, &VIBR, &FLEX, &DRIVEL, &HILL."""
        return self.study("vibration", progress=progress)

    def cams(self) -> Result:
        """The cam that makes the output follow a law, &CAM: profile, cutter path; `files` has .dxf, .svg, .html, .nc."""
        return self.study("cams")

    def clearance(self) -> Result:
        """A joint with clearance, &CLEAR: loss of contact, flight, impact."""
        return self.study("clearance")

    def summary(self) -> str:
        """What the linkage does over the whole range of its input, in words."""
        return self.study("summary").listing

    def draw(self) -> typing.Dict[str, str]:
        """Pictures of the linkage as given: ".svg", ".dxf", ".html" to content."""
        return self.study("picture").files

    def page(self) -> str:
        """The page on which the linkage moves."""
        return self.draw()[".html"]

    def svg(self) -> str:
        """The linkage with the paths of its joints, as SVG."""
        return self.draw()[".svg"]

    def dxf(self) -> str:
        """The linkage for CAD, as DXF."""
        return self.draw()[".dxf"]

    def board(self) -> str:
        """The drawing board with this sketch: a page on which it is changed and saved."""
        return self.study("board").files[".edit.html"]

    def plot(self, axes: "typing.Optional[matplotlib.axes.Axes]" = None) -> "matplotlib.axes.Axes":
        """Paths of all joints and points, by matplotlib; returns its axes."""
        import matplotlib.pyplot as pyplot
        axes = axes or pyplot.gca()
        table = self.analyse().table
        for name in [n[:-2] for n in table if n.endswith(".x") and n[:-2] + ".y" in table and n != "desired.x"]:
            group = table[name]
            still = numpy.ptp(group.xy[~numpy.isnan(group.xy).any(axis=1)], axis=0).max(initial=0.0) == 0
            axes.plot(group.x[:1] if still else group.x, group.y[:1] if still else group.y, "o" if still else "-", label=name)
        axes.set_aspect("equal")
        axes.set_title(self.title)
        axes.legend()
        return axes


class Linkage(Case):
    """A linkage drawn by its joints and links: `Linkage(joints={...}, links=[...], ...)` takes the arguments of `Case.from_joints`."""

    def __init__(self, joints: typing.Optional[typing.Mapping[str, typing.Tuple[float, float]]] = None,
                 links: typing.Union[typing.Sequence, typing.Mapping[str, typing.Any]] = (), *, fixed: typing.Iterable[str] = (),
                 drive: typing.Union[None, str, typing.Sequence[str]] = None,
                 output: typing.Union[None, str, typing.Sequence[str], typing.Mapping[str, str]] = None,
                 slides: typing.Iterable = (), gears: typing.Iterable = (), step: typing.Optional[int] = None,
                 inputs: typing.Optional[Numbers] = None, title: str = "LINKAGE", **groups: typing.Mapping[str, typing.Any]):
        """The arguments of `Case.from_joints`; without joints a case to be filled."""
        made = Case.from_joints(joints or {}, links, fixed=fixed, drive=drive, output=output, slides=slides, gears=gears, step=step,
                                inputs=inputs, title=title, **groups)
        self._begin()
        self._handle, made._handle = made._handle, None

    @classmethod
    def from_joints(cls, joints, links=(), **more) -> "Linkage":
        """`Linkage(joints, links, ...)`."""
        return cls(joints, links, **more)


class _Bar:
    """A bar on standard error."""

    def __init__(self):
        self._began, self._shown = time.monotonic(), False

    def __call__(self, made, most, best):
        part = made/max(1, most)
        best = "" if best >= sys.float_info.max else "  best %.6g" % best
        sys.stderr.write("\r[%-40s] %d of %d  %.0f s%s " % ("#"*int(40*part), made, most, time.monotonic() - self._began, best))
        sys.stderr.flush()
        self._shown = True

    def end(self):
        if self._shown:
            sys.stderr.write("\n")


def _words_of(text, item):
    """The words that an item has in the notation of the manual."""
    found = re.search(r"\b%s(?:\(1\))?\s*=\s*((?:'(?:[^']|'')*'[,\s]*)+)" % item, text, re.I)
    return [word.replace("''", "'") for word in re.findall(r"'((?:[^']|'')*)'", found[1])] if found else []


def _case_from_text(kind, text):
    return kind.from_text(text)
