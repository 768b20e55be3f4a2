"""The shared library, as ctypes sees it: include/psalm.h describes every function."""
import ctypes
import os
import platform
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
INTERFACE = 1   # PSALM_INTERFACE of the header that this module was written for
DONE, VIOLATION, BAD_INPUT, FILE_TROUBLE, MISUSE = range(5)
BRIEF = 1
REAL, WHOLE, FLAG, WORD = range(4)
LEVELS = {1: "warning", 2: "error", 3: "remark"}

# what a processor must have, in the words of Linux, for each build of the library that a wheel may hold, the fastest first
_V3 = {"cx16", "lahf_lm", "popcnt", "pni", "sse4_1", "sse4_2", "ssse3", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"}
_BUILDS = (("x86-64-v4", _V3 | {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}), ("x86-64-v3", _V3), ("x86-64", set()))


def _flags():
    """What the processor says it has."""
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            for line in file:
                if line.startswith("flags"):
                    return set(line.split(":", 1)[1].split())
    except OSError:
        pass
    return set()


def _place():
    """The library: PSALM_LIBRARY, else beside this module - built for this processor, of a wheel; for PSALM_LEVEL, if it is set -
    else where scripts/build_library puts it in a checkout, else below the prefix of this Python, else where the system has it."""
    if os.environ.get("PSALM_LIBRARY"):
        return os.environ["PSALM_LIBRARY"]
    level = os.environ.get("PSALM_LEVEL")
    flags = _flags() if platform.machine() == "x86_64" else set()
    builds = {name: (needs - flags, os.path.join(HERE, name, "libpsalm.so.1")) for name, needs in _BUILDS
              if os.path.exists(os.path.join(HERE, name, "libpsalm.so.1"))}
    if level:
        if level not in builds:
            raise ImportError("PSALM_LEVEL=%s: there is no build of the library for it, but for %s" %
                              (level, ", ".join(builds) or "one instruction set only"))
        lacking, place = builds[level]
        if lacking:
            raise ImportError("PSALM_LEVEL=%s: this processor lacks %s" % (level, ", ".join(sorted(lacking))))
        return place
    for lacking, place in builds.values():
        if not lacking:
            return place
    for place in (os.path.join(HERE, "libpsalm.so"), os.path.join(HERE, "..", "..", "build", "lib", "libpsalm.so"),
                  os.path.join(sys.prefix, "lib", "libpsalm.so.1")):
        if os.path.exists(place):
            return place
    return "libpsalm.so.1"


def _load():
    place = _place()
    try:
        library = ctypes.CDLL(place)
    except OSError as error:
        raise ImportError("libpsalm.so is not there: run scripts/build_library, or pip install ./python, or set PSALM_LIBRARY "
                          "(%s)" % error) from None
    case, text, whole, real, place = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_double, ctypes.c_void_p
    for name, result, arguments in (
            ("library_version", text, []), ("interface", whole, []), ("status_text", text, [whole]), ("verb", text, [whole]),
            ("read_file", whole, [text, whole, place]), ("read_text", whole, [text, whole, place]), ("new", whole, [text, place]),
            ("copy", whole, [case, place]), ("free", None, [case]), ("case_text", text, [case]), ("case_title", text, [case]),
            ("add_joint", whole, [case, text, real, real, whole]), ("add_link", whole, [case, text, text]),
            ("add_slide", whole, [case, text, text, real, real, real, text]),
            ("add_gear", whole, [case, text, text, text, real, real]), ("add_drive", whole, [case, text, text, text]),
            ("add_output", whole, [case, text, text]), ("vary", whole, [case, text]),
            ("add_loop", whole, [case, whole, place, place, place, place]), ("vary_arc", whole, [case, whole, whole, whole, whole]),
            ("set_integers", whole, [case, text, text, whole, place]), ("set_reals", whole, [case, text, text, whole, place]),
            ("set_word", whole, [case, text, text, text]), ("set_words", whole, [case, text, text, whole, place]),
            ("loop_count", whole, [case]), ("arc_count", whole, [case, whole]),
            ("set_length", whole, [case, whole, whole, real]), ("set_angle", whole, [case, whole, whole, real]),
            ("get_length", whole, [case, whole, whole, place]), ("get_angle", whole, [case, whole, whole, place]),
            ("study", whole, [case, text, whole, whole, place]), ("cancel", whole, [case]),
            ("progress", whole, [case, place, place, place]), ("result_free", None, [case]),
            ("table_count", whole, [case]), ("table_name", text, [case, whole]), ("table_about", text, [case, whole]),
            ("find_table", whole, [case, text]), ("row_count", whole, [case, whole]), ("column_count", whole, [case, whole]),
            ("column_name", text, [case, whole, whole]), ("column_unit", text, [case, whole, whole]),
            ("column_kind", whole, [case, whole, whole]), ("find_column", whole, [case, whole, text]),
            ("columns", text, [case, whole]), ("column", whole, [case, whole, whole, whole, place]), ("word", text, [case, whole, whole, whole]),
            ("listing", text, [case]), ("found_text", text, [case]), ("case_count", whole, [case]), ("case_of", whole, [case, whole, place]),
            ("file_count", whole, [case]), ("file_ending", text, [case, whole]), ("file_content", text, [case, whole]),
            ("findings", whole, [case]), ("finding_level", whole, [case, whole]), ("finding_line", whole, [case, whole]),
            ("finding_text", text, [case, whole])):
        function = getattr(library, "psalm_" + name)
        function.restype, function.argtypes = result, arguments
    if library.psalm_interface() != INTERFACE:
        raise ImportError("%s has interface %d; this module is for interface %d" % (place, library.psalm_interface(), INTERFACE))
    return library


library = _load()
version = library.psalm_library_version().decode()


def words(first_to_last):
    """Texts that a function of a number gives, up to the first NULL."""
    found, number = [], 1
    while True:
        text = first_to_last(number)
        if text is None:
            return found
        found.append(text.decode())
        number += 1


verbs = tuple(words(library.psalm_verb))
