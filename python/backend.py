"""What pip calls to build the Python package: compiles the shared library and puts it beside the module.

A backend of its own, because the library is described by fpm.toml, which neither meson-python nor scikit-build-core knows: a second
description of some 500 Fortran modules would have to be kept equal to it. Needs gfortran, NLopt and LAPACK (scripts/setup installs
them), and fpm or make: without fpm tools/makefile reads from the sources what is compiled in which order. So nothing is fetched: a
source distribution holds all sources and is built without a network. `pip install ./python` in a checkout builds for the machine at
hand in the same way; scripts/package makes the wheel for other machines.
"""
import base64
import hashlib
import io
import os
import re
import subprocess
import sysconfig
import tarfile
import tempfile
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.dirname(HERE)
# what a source distribution holds of the checkout, below sources/
SOURCES = ("fpm.toml", "LICENSE", "src", "generated", "include", "tools/gfortran", "tools/makefile", "scripts/build_library", "scripts/setup")


def _project(key):
    with open(os.path.join(HERE, "pyproject.toml"), encoding="utf-8") as file:
        return re.search(r'^%s = "(.*)"$' % key, file.read(), re.M)[1]


def _metadata():
    with open(os.path.join(HERE, "README.md"), encoding="utf-8") as file:
        readme = file.read()
    return ("Metadata-Version: 2.1\nName: psalm\nVersion: %s\nSummary: %s\nRequires-Python: %s\nLicense: MIT\n"
            "Requires-Dist: numpy>=1.24\nProvides-Extra: frames\nRequires-Dist: pandas; extra == 'frames'\n"
            "Requires-Dist: xarray; extra == 'frames'\nProvides-Extra: plot\nRequires-Dist: matplotlib; extra == 'plot'\n"
            "Provides-Extra: dxf\nRequires-Dist: ezdxf>=1.0; extra == 'dxf'\n"
            "Provides-Extra: workbench\nRequires-Dist: starlette>=0.40; extra == 'workbench'\nRequires-Dist: uvicorn>=0.30; extra == 'workbench'\n"
            "Description-Content-Type: text/markdown\n\n%s" %
            (_project("version"), _project("description"), _project("requires-python"), readme))


def _checkout():
    """Where the sources are: around this directory, or within it, of a source distribution."""
    for place in (os.path.join(HERE, "sources"), TOP):
        if os.path.exists(os.path.join(place, "scripts", "build_library")):
            return place
    raise RuntimeError("the sources of the library are not there")


def _commit(checkout):
    """What --version of the programs tells, for a build without git."""
    if os.path.exists(os.path.join(checkout, "COMMIT")):
        with open(os.path.join(checkout, "COMMIT"), encoding="utf-8") as file:
            return file.read()
    told = subprocess.run(["git", "-C", checkout, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True, check=False)
    return told.stdout


def _modules():
    """The files of the package, relative to it."""
    folder = os.path.join(HERE, "psalm")
    return [n for n in sorted(os.listdir(folder)) if n.endswith((".py", ".typed"))]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """For the machine at hand; with PSALM_LEVELS="x86-64 x86-64-v3" for these instruction sets, each in a folder of its own."""
    script = os.path.join(_checkout(), "scripts", "build_library")
    tag = "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    name = "psalm-%s" % _project("version")
    info = name + ".dist-info/"
    levels = os.environ.get("PSALM_LEVELS", "").split()
    files = {"psalm/" + n: os.path.join(HERE, "psalm", n) for n in _modules()}
    files[info + "LICENSE"] = os.path.join(_checkout(), "LICENSE")
    with tempfile.TemporaryDirectory() as out:
        for level in levels or [""]:
            place = os.path.join(out, level)
            subprocess.run([script] + (["--level", level] if level else []) + [place], check=True)
            library = os.path.realpath(os.path.join(place, "libpsalm.so"))
            subprocess.run(["strip", "--strip-unneeded", library], check=False)
            files["psalm/%s/libpsalm.so.1" % level if level else "psalm/libpsalm.so"] = library
        content = {}
        for place, path in files.items():
            with open(path, "rb") as file:
                content[place] = file.read()
    content[info + "METADATA"] = _metadata().encode()
    content[info + "WHEEL"] = ("Wheel-Version: 1.0\nGenerator: psalm\nRoot-Is-Purelib: false\nTag: %s\n" % tag).encode()
    content[info + "entry_points.txt"] = b"[console_scripts]\npsalm-workbench = psalm.workbench:main\npsalm-import = psalm.imports:main\n"
    record = ""
    for place, data in content.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += "%s,sha256=%s,%d\n" % (place, digest, len(data))
    content[info + "RECORD"] = (record + info + "RECORD,,\n").encode()
    wheel = "%s-%s.whl" % (name, tag)
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for place, data in content.items():
            archive.writestr(place, data)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    """All sources: the package, and below sources/ what its library is built from."""
    name = "psalm-%s" % _project("version")
    checkout = _checkout()

    def plain(member):
        member.uid = member.gid = 0
        member.uname = member.gname = ""
        return None if "__pycache__" in member.name else member

    with tarfile.open(os.path.join(sdist_directory, name + ".tar.gz"), "w:gz") as archive:
        for part in ("backend.py", "pyproject.toml", "README.md"):
            archive.add(os.path.join(HERE, part), name + "/" + part, filter=plain)
        for part in _modules():
            archive.add(os.path.join(HERE, "psalm", part), name + "/psalm/" + part, filter=plain)
        for part in SOURCES:
            archive.add(os.path.join(checkout, part), name + "/sources/" + part, filter=plain)
        for place, text in (("/PKG-INFO", _metadata()), ("/sources/COMMIT", _commit(checkout))):
            member = tarfile.TarInfo(name + place)
            member.size = len(text.encode())
            archive.addfile(member, io.BytesIO(text.encode()))
    return name + ".tar.gz"
