"""What pip calls to build the Python package: compiles the shared library from the checkout and puts it beside the module.

Needs gfortran and NLopt (scripts/setup installs them); fpm comes from pip. The wheel is for machines like this one.
"""
import base64
import hashlib
import os
import re
import subprocess
import sysconfig
import tempfile
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))


def _project(key):
    with open(os.path.join(HERE, "pyproject.toml"), encoding="utf-8") as file:
        return re.search(r'^%s = "(.*)"$' % key, file.read(), re.M)[1]


def _metadata():
    return "Metadata-Version: 2.1\nName: psalm\nVersion: %s\nSummary: %s\nRequires-Python: %s\nRequires-Dist: numpy>=1.24\n" % (
        _project("version"), _project("description"), _project("requires-python"))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    script = os.path.join(HERE, "..", "scripts", "build_library")
    if not os.path.exists(script):
        raise RuntimeError("the package is built in a checkout of the repository: pip install ./python")
    tag = "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    name = "psalm-%s" % _project("version")
    info = name + ".dist-info/"
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([script, out], check=True)
        files = {"psalm/__init__.py": os.path.join(HERE, "psalm", "__init__.py"), "psalm/libpsalm.so": os.path.join(out, "libpsalm.so")}
        content = {}
        for place, path in files.items():
            with open(path, "rb") as file:
                content[place] = file.read()
    content[info + "METADATA"] = _metadata().encode()
    content[info + "WHEEL"] = ("Wheel-Version: 1.0\nGenerator: psalm\nRoot-Is-Purelib: false\nTag: %s\n" % tag).encode()
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
    raise RuntimeError("there is no source distribution: the package is built in a checkout of the repository")
