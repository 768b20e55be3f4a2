"""What the tests of the pictures share: counting, running programs, reading files."""
import json
import os
import re
import subprocess

from results import no_number

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DATA = os.path.join(TOP, "data")
# Each context has a window, and in chromium 156 two processes for the menu of its address bar, which took more than twice the time
# of a page; nobody sees it here. A switch counts as it is given last: what Playwright switches off is named again. All pages share
# one process, since a process takes longer to begin than most pages to be drawn.
WITHOUT = ("WebUIOmniboxPopup", "WebUIOmniboxAimPopup", "WebUIOmniboxFullPopup", "AimEnabled",
           "AvoidUnnecessaryBeforeUnloadCheckSync", "DestroyProfileOnBrowserClose", "HttpsFirstBalancedModeAutoEnable", "HttpsUpgrades",
           "LensOverlay", "MediaRouter", "NetworkTimeServiceQuerying", "OptimizationHints", "PaintHolding", "PreconnectToSearch",
           "ThirdPartyStoragePartitioning")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--renderer-process-limit=1", "--disable-features=" + ",".join(WITHOUT)]
PATIENCE = 180e3   # milliseconds for a page to load: other work may be going on
passed = failed = 0
programs = ""  # directory of psalm and balm


def check(law, good, detail=""):
    global passed, failed
    if good:
        passed += 1
    else:
        failed += 1
        print("FAILED: %s %s" % (law, detail), flush=True)
        if os.environ.get("STOP_AT_FIRST"):
            os._exit(1)
    return good


def psalm(*arguments, **more):
    return run(os.path.join(programs, "psalm"), *arguments, **more)


def balm(*arguments, **more):
    return run(os.path.join(programs, "balm"), *arguments, **more)


def run(*arguments, stdin=None, env=None, cwd=None):
    done = subprocess.run(arguments, capture_output=True, input=stdin, env=env, cwd=cwd, check=False)
    return done.returncode, done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")


def read(name):
    with open(name, encoding="utf-8") as text:
        return text.read()


def write(name, text):
    with open(name, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode("utf-8"))


def changed(text, old, new):
    """The text with every `old` made `new`; a failure if there is none."""
    check("there is '%s' to be changed" % old, old in text)
    return text.replace(old, new)


def page_data(name):
    text = read(name)
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S).group(1)
    return json.loads(data, parse_constant=no_number)["cases"]
