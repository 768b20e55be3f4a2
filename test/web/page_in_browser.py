"""The page of balm in chromium without a screen: it plays, drags, switches cases, explains what does not close.

Called by pictures.py in a directory that holds the pages.
"""
import csv
import math
import os
import shutil
import sys
from xml.etree import ElementTree

from playwright.sync_api import sync_playwright

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import picture_tools
from picture_tools import DATA, FLAGS, PATIENCE, TOP, balm, check, page_data, run


def test_pages(shots):
    """All tests; screenshots go into the directory `shots`, if any."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        test_sources(browser)
        test_browser(browser, shots)
        test_browser_forces(browser, shots)
        test_saving(browser, shots)
        test_letters(browser)
        test_wrong_input(browser)
        browser.close()


class Page:
    """A page in the browser; everything it complains of or asks for is kept."""

    def __init__(self, browser, name, width=1280, height=900, scheme="light"):
        self.complaints, self.requests, self.dialogs = [], [], []
        self.context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
        self.context.set_default_timeout(PATIENCE)
        self.page = self.context.new_page()
        self.page.on("console", lambda m: m.type in ("error", "warning") and self.complaints.append(m.text))
        self.page.on("pageerror", lambda e: self.complaints.append(str(e)))
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.page.on("dialog", lambda d: (self.dialogs.append(d.message), d.dismiss()))
        self.show(name)

    def show(self, name):
        """Another page in the same window; complaints are those about it."""
        self.complaints.clear()
        self.page.goto("file://" + os.path.abspath(name))
        self.page.wait_for_timeout(150)

    def ask(self, script):
        return self.page.evaluate(script)

    def pixels(self, canvas="linkage"):
        return self.ask("document.getElementById('%s').toDataURL()" % canvas)


def test_sources(browser):
    """The files of web/ open as they are and pass their own tests."""
    units = Page(browser, os.path.join(TOP, "web", "test.html"))
    results = units.ask("globalThis.results || []")
    check("web/test.html: runs to its end", len(results) > 30 and not units.complaints and
          units.page.text_content("#results").endswith(" failed"), "%d %s" % (len(results), units.complaints))
    for law, good, detail in results:
        check("web/test.html: " + law, good, detail)
    units.context.close()
    live = Page(browser, os.path.join(TOP, "web", "index.html"))
    check("web/index.html: opens as it is, with its sample", not live.complaints and live.ask("balm.cases.length") == 2 and
          live.page.text_content("#title") == live.ask("balm.cases[0].title"), str(live.complaints))
    drawn = live.pixels()
    live.ask("balm.go(100)")
    check("web/index.html: moves", live.pixels() != drawn)
    check("web/index.html: asks for its own files only", all(u.startswith(("file:", "data:")) for u in live.requests))
    live.context.close()


def test_browser(browser, shots):
    one = Page(browser, "needle.html")
    page = one.page
    check("page: loads without complaint", not one.complaints, str(one.complaints))
    check("page: asks for nothing but itself", all(u.startswith(("file:", "data:")) for u in one.requests), str(one.requests))
    check("page: title", page.text_content("#title") == "TEN-BAR NEEDLE LINKAGE")
    case = page_data("needle.html")[0]
    check("page: stands at the reference position", abs(one.ask("balm.position")) < 1e-9)
    check("page: draws the joints where they are", all(
        math.dist(one.ask("balm.joint(%d)" % j), (case["prescribed"]["x"][j][0], case["prescribed"]["y"][j][0])) < 1e-5
        for j in range(len(case["joints"]))))
    if shots:
        page.screenshot(path=os.path.join(shots, "needle.png"))
    before, drawn = one.ask("balm.position"), one.pixels()
    page.click("#play")
    page.wait_for_function("before => balm.position !== before", arg=before)
    check("play moves", one.ask("balm.playing"))
    check("play draws", one.pixels() != drawn and page.get_attribute("#play", "aria-label") == "pause")
    page.keyboard.press("Escape")
    page.click("#play")
    stopped = one.ask("balm.position")
    page.wait_for_timeout(150)
    check("pause stops", one.ask("balm.position") == stopped and not one.ask("balm.playing"))
    page.focus("#linkage")
    page.keyboard.press("Home")
    check("Home", one.ask("balm.position") == 0)
    page.keyboard.press("ArrowRight")
    check("right steps", one.ask("balm.position") == 1)
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.press("ArrowLeft")
    check("left steps", one.ask("balm.position") == 10)
    page.keyboard.press("]")
    check("] goes to the next prescribed position", one.ask("balm.position") == 15 and "position 2" in page.text_content("#facts"))
    page.keyboard.press("End")
    check("End", one.ask("balm.position") == 359)
    speed = one.ask("balm.speed")
    page.keyboard.press("+")
    check("+ is faster", one.ask("balm.speed") > speed)
    page.keyboard.press("-")
    check("- is slower", one.ask("balm.speed") == speed)
    page.keyboard.press(" ")
    check("space plays", one.ask("balm.playing"))
    page.keyboard.press(" ")
    check("space pauses", not one.ask("balm.playing"))

    # the crank follows the mouse by the angle about its pivot
    page.keyboard.press("Home")
    x, y = one.ask("balm.screen(0)")
    page.mouse.move(x + 60, y)
    page.mouse.down()
    for degrees in range(5, 45, 5):
        page.mouse.move(x + 60 * math.cos(math.radians(degrees)), y + 60 * math.sin(math.radians(degrees)))
    page.mouse.up()
    check("drag: 40 degrees clockwise turn the crank by 40", abs(one.ask("balm.position") - 40) < 1, str(one.ask("balm.position")))
    box = page.locator("#curves").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 100)
    check("the cursor of the curves moves the linkage", 120 < one.ask("balm.position") < 200)
    a, b = one.ask("balm.screen(0)"), one.ask("balm.screen(1)")
    bars = {(bar["loop"], bar["arc"]): bar for bar in case["bars"]}
    coupler = bars[(1, 2)]
    a, b = one.ask("balm.screen(%d)" % coupler["from"]), one.ask("balm.screen(%d)" % coupler["to"])
    page.mouse.move(0.55 * a[0] + 0.45 * b[0], 0.55 * a[1] + 0.45 * b[1])
    tip = page.text_content("#tip")
    check("hover names the arc", page.is_visible("#tip") and "loop 1, arc 2: length 95, angle " in tip, tip)
    page.mouse.move(0.5 * a[0], 2)
    drawn = one.pixels()
    page.check("#other")
    check("other assemblies are drawn", one.pixels() != drawn)
    drawn = one.pixels()
    page.uncheck("#letters")
    check("letters go", one.pixels() != drawn)
    check("every control has a name", one.ask("""[...document.querySelectorAll('button,select,input')].every(
        (e) => e.getAttribute('aria-label') || e.closest('label')?.textContent.trim() || e.textContent.trim())"""))
    check("page: no complaint after all", not [c for c in one.complaints if "willReadFrequently" not in c], str(one.complaints))
    one.context.close()

    shutil.copy(os.path.join(DATA, "hard", "chain64.nml"), "chain64.nml")
    balm("--quiet", "chain64.nml")
    large = Page(browser, "chain64.html")
    large.ask("balm.frameTime(20)")
    check("64 loops, 360 positions: the page has them all", large.ask("balm.cases[0].sweep.n") == 360 and not large.complaints,
          str(large.complaints))
    large.context.close()
    test_browser_cases(browser, shots)
    for name in ("extreme_lengths", "parallel_slides"):
        balm("--quiet", "--output-dir", ".", os.path.join(DATA, "hard", name + ".nml"))
    every = Page(browser, "needle.html")
    for name in sorted(f for f in os.listdir(".") if f.endswith(".html")):
        every.show(name)
        every.ask("balm.cases.forEach((c, i) => { balm.choose(i); balm.frameTime(20); })")
        every.page.check("#other") if every.page.is_visible("#other") else None
        check(name + ": every case is drawn without complaint", not every.complaints, str(every.complaints))
    every.context.close()


def test_browser_forces(browser, shots):
    """Centres of mass, loads, polar diagram of a bearing, curves of drive and frame."""
    engine = Page(browser, "engine.html")
    page = engine.page
    check("forces: loads without complaint", not engine.complaints, str(engine.complaints))
    check("forces: their choices are shown", page.is_visible("#forcebox") and page.is_visible("#bearingbox"))
    names = engine.ask("balm.cases[0].forces.joints.map((joint) => joint.name)")
    check("forces: every joint may be chosen", names == ["IN", "S1", "M1", "E1"] and
          page.locator("#bearing option").all_text_contents()[-4:] == names, str(names))
    check("forces: the arrow's scale is that of the gas force", engine.ask("balm.cases[0].forces.largest") == 1500.0)
    drawn = engine.pixels()
    page.uncheck("#forces")
    check("forces: masses and loads go", engine.pixels() != drawn)
    page.check("#forces")
    check("forces: and come again", engine.pixels() == drawn)
    pictures = [drawn]
    for name in names:
        page.select_option("#bearing", label=name)
        pictures.append(engine.pixels())
    check("forces: each bearing has its polar diagram", len(set(pictures[1:])) == len(names), str(len(set(pictures))))
    curves = engine.pixels("curves")
    engine.ask("balm.go(77)")
    check("forces: the cursor of the curves moves", engine.pixels("curves") != curves)
    # kinetic energy is the same after a turn: the mean torque does the work of weight and gas alone
    worst = engine.ask("""(() => { const f = balm.cases[0].forces, n = f.drive.length;
        let most = 0; for (let i = 0; i < n; i++) most = Math.max(most, Math.abs(f.drive[i] - f.drive[(i + 1) % n]));
        return most / Math.max(...f.drive.map(Math.abs)); })()""")
    check("forces: the torque of the drive is a smooth ring", worst < 0.1, str(worst))
    if shots:
        page.screenshot(path=os.path.join(shots, "forces.png"))
    check("forces: no complaint", not [c for c in engine.complaints if "willReadFrequently" not in c], str(engine.complaints))
    engine.context.close()
    test_clearance(browser, shots)
    plain = Page(browser, "needle.html")
    check("forces: a case without them has no choice of them", not plain.page.is_visible("#forcebox") and
          not plain.page.is_visible("#bearingbox"))
    plain.context.close()


def test_saving(browser, shots):
    """Curves to choose from, paths of joints, and what leaves the page: a frame, the table, a film."""
    rated = Page(browser, "rated.html")
    page = rated.page
    check("curves: their groups are offered", page.locator("#group option").all_text_contents() == ["all", "output", "tolerances", "velocity, acceleration"],
          str(page.locator("#group option").all_text_contents()))
    pictures = [rated.pixels("curves")]
    for group in ("position", "tolerance", "rates"):
        page.select_option("#group", group)
        pictures.append(rated.pixels("curves"))
    check("curves: each group is drawn by itself", len(set(pictures)) == 4)
    if shots:
        page.select_option("#group", "all")
        page.screenshot(path=os.path.join(shots, "rates.png"))
    drawn = rated.pixels()
    page.click("#pathbox summary")
    page.click("[data-path]")
    check("paths: that of a joint is drawn", rated.pixels() != drawn)
    page.click("[data-path]")
    check("paths: and goes", rated.pixels() == drawn)
    page.click("[data-path]")
    page.click("#savebox summary")
    rated.ask("balm.go(33)")
    svg, csv_text = rated.ask("balm.save.svg()"), rated.ask("balm.save.table()")
    root = ElementTree.fromstring(svg)
    at = [rated.ask("[balm.cases[0].px[%d], balm.cases[0].py[%d]]" % (j, j)) for j in range(rated.ask("balm.cases[0].joints.length"))]
    numbers = svg.replace("M", " ").replace("L", " ").replace("A", " ")
    check("saved frame: SVG with the joints where they are", root.tag.endswith("svg") and all(
        "%.3f" % (x + 4.6) in numbers or ("%.3f" % (x + 4.6)).rstrip("0").rstrip(".") in numbers for x, _ in at[:2]) and
        "crank 33" in root[0].text, root[0].text)
    rows = list(csv.reader(csv_text.splitlines()))
    data = page_data("rated.html")[0]
    check("saved table: a row for each position of the sweep, with rates and joints", len(rows) == 361 and all(len(row) == len(rows[0]) for row in rows) and
          float(rows[34][rows[0].index("B.x")]) == data["sweep"]["x"][[joint["name"] for joint in data["joints"]].index("B")][33] and
          "worst deviation" in rows[0] and all(float(rows[8][rows[0].index(panel["name"])]) == panel["lines"][0]["values"][7] for panel in data["panels"]))
    for button, ending, head in (("#savesvg", ".frame.svg", b"<svg "), ("#savepng", ".frame.png", b"\x89PNG"), ("#savetable", ".sweep.csv", b"input,closed")):
        with page.expect_download() as download:
            page.click(button)
        check("saved: " + ending, download.value.suggested_filename == "rated" + ending)
        with open(download.value.path(), "rb") as file:
            check("saved: content of " + ending, file.read().startswith(head))
    film = rated.ask("""balm.save.film(0.6).then(async (blob) => [blob.type, blob.size,
        [...new Uint8Array(await blob.slice(0, 4).arrayBuffer())]])""")
    check("saved: a film", film[0] == "video/webm" and film[1] > 5000 and film[2] == [0x1a, 0x45, 0xdf, 0xa3], str(film))
    check("saving: no complaint, nothing asked for", not rated.complaints and all(u.startswith(("file:", "data:", "blob:")) for u in rated.requests),
          str(rated.complaints) + str(rated.requests))
    rated.context.close()


def test_clearance(browser, shots):
    """The pin in its hole: it moves, goes with its box, and its data are those of bridge."""
    os.makedirs("pins")
    balm("--quiet", "--output-dir", "pins", os.path.join(DATA, "bridge", "four_bar_haines.nml"))
    pin = Page(browser, "pins/four_bar_haines.html")
    check("pin: loads without complaint", not pin.complaints, str(pin.complaints))
    check("pin: its box is shown", pin.page.is_visible("#pinbox"))
    drawn = pin.pixels()
    pin.page.uncheck("#pin")
    check("pin: goes", pin.pixels() != drawn)
    pin.page.check("#pin")
    check("pin: and comes again", pin.pixels() == drawn)
    data = page_data("pins/four_bar_haines.html")[0]["clearance"]
    sizes = [math.hypot(x, y) for x, y in zip(data["px"], data["py"])]
    check("pin: always on the wall", len(sizes) == 360 and all(abs(size - 1) < 1e-6 for size in sizes))
    load = [math.hypot(x, y) for x, y in zip(data["fx"], data["fy"])]
    check("pin: where the load is largest it follows", abs(data["force"][45] / load[45] - 1) < 0.01 and
          abs(data["px"][45] - data["fx"][45] / load[45]) < 0.01, "%s %s" % (data["force"][45], load[45]))
    check("pin: the least load is that of bridge", abs(load[356] - 0.8131) < 0.005, str(load[356]))
    if shots:
        pin.page.screenshot(path=os.path.join(shots, "pin.png"))
    pin.context.close()


# every text that a page writes on its canvases, with its box in pixels of the canvas, from its last painting
WATCH = """(() => {
  globalThis.written = {};
  const proto = CanvasRenderingContext2D.prototype, fill = proto.fillText, clear = proto.clearRect;
  const key = (pen) => pen.canvas.id || pen.canvas.keep || (pen.canvas.keep = 'copy ' + Math.random());
  proto.clearRect = function (...box) { written[key(this)] = []; return clear.apply(this, box); };
  proto.fillText = function (text, x, y) {
    const m = this.measureText(text);
    (written[key(this)] ||= []).push([text, x - m.actualBoundingBoxLeft, x + m.actualBoundingBoxRight,
      y - m.actualBoundingBoxAscent, y + m.actualBoundingBoxDescent, this.canvas.width / devicePixelRatio]);
    return fill.apply(this, arguments);
  };
})()"""


def collisions(page):
    """Texts of a canvas that lie on each other or beyond its edges."""
    found = []
    for texts in page.evaluate("written").values():
        for i, (text, left, right, top, bottom, room) in enumerate(texts):
            if left < -1 or right > room + 1:
                found.append(text)
            found += ["%s | %s" % (text, other) for other, a, b, c, d, _ in texts[:i] if left < b and a < right and top < d and c < bottom]
    return found


def test_wrong_input(browser):
    """The page of a wrong input has its messages; keys and controls do nothing there, and nothing is complained of."""
    with open("no_joint.nml", "w", encoding="utf-8") as file:
        file.write("<b>NO JOINT &amp; NO LINKAGE</b>\n &CHAIN JNT='A','B', JX=0,1, JY=0,1, LNK='A','A Z' &END\n &DRIVES DRIVE='A' &END\n"
                   " &METHOD IKIN=30 &END\n")
    code, _, errors = balm("no_joint.nml")
    check("wrong input: refused", code == 2 and "no joint is called 'Z'" in errors, errors)
    one = Page(browser, "no_joint.html")
    for key in ("ArrowRight", "ArrowLeft", "Space", "Home", "End", "PageDown", "1", "t"):
        one.page.keyboard.press(key)
    one.ask("document.querySelectorAll('button, input, select').forEach(e => { e.click(); e.dispatchEvent(new Event('change')) })")
    one.page.wait_for_timeout(100)
    words = one.page.inner_text("body")
    check("wrong input: the page says what is wrong", "The input is wrong" in words and "no joint is called 'Z'" in words, words[:300])
    check("wrong input: nothing is complained of", not one.complaints, str(one.complaints))
    one.context.close()


def test_letters(browser):
    """Nothing that is written lies on other words, on a phone, a desk and a large screen; messages stand beside the picture."""
    os.makedirs("letters")
    cases = ["engine", "rig_coupler", "jansen", "needle_masses", "excavator_envelope", "umbrella", "stephenson3_rod_driven",
             os.path.join("bridge", "four_bar_haines"), os.path.join("time", "crane"), os.path.join("muscle", "haines_limits")]
    cams = ["conjugate_cams", "five_bar_cams", "knuckle_press", "wedge_cam"]
    for case in cases:
        balm("--quiet", "--output-dir", "letters", os.path.join(DATA, case + ".nml"))
    for case in cams:
        run(os.path.join(picture_tools.programs, "calm"), "--quiet", "--output-dir", "letters", os.path.join(DATA, "calm", case + ".nml"))
    for width, height in ((390, 844), (1280, 800), (1920, 1080)):
        one = Page(browser, "needle.html", width, height)
        for name in [os.path.basename(case) + ".html" for case in cases] + [case + ".calm.html" for case in cams]:
            law = "%s, %d pixels: " % (name, width)
            one.page.set_viewport_size({"width": width, "height": height})
            one.show(os.path.join("letters", name))
            one.ask(WATCH)
            one.page.set_viewport_size({"width": width - 2, "height": height})
            one.page.wait_for_timeout(120)
            found = collisions(one.page)
            for place in range(0, 360, 30):
                one.ask("calm.turnTo(%d)" % place if "calm" in name else "balm.go(%d)" % place)
                found += collisions(one.page)
            if "calm" in name:
                check(law + "every extreme has its unit", one.ask("[...document.querySelectorAll('#extremes tbody tr')].every((row) => "
                                                                  "/, length$/.test(row.cells[1].textContent) || /\u00b0$/.test(row.cells[2].textContent))"))
            check(law + "no words lie on others", not found, str(found[:4]))
            check(law + "nothing is wider than the screen", one.ask("document.documentElement.scrollWidth <= innerWidth"))
            beside = "(id) => { const e = document.getElementById(id); if (!e || e.hidden) return true;" \
                     " return e.getBoundingClientRect().top >= document.querySelector('canvas').getBoundingClientRect().bottom - 1; }"
            check(law + "words stand below the picture", all(one.ask("(%s)('%s')" % (beside, id_)) for id_ in ("alert", "captions")))
            if width == 390:
                tops = [one.ask("document.getElementById('%s').getBoundingClientRect().top" % id_) for id_ in ("controls", "curves")]
                check(law + "the controls stand between picture and curves", tops[0] < tops[1], str(tops))
        one.context.close()


def test_browser_cases(browser, shots):
    three = Page(browser, "needle_lsq.html")
    page = three.page
    check("three cases: chooser", page.is_visible("#case") and page.locator("#case option").count() == 3)
    drawn = three.pixels()
    page.select_option("#case", "2")
    check("three cases: switch", three.ask("balm.current") == 2 and three.pixels() != drawn)
    check("three cases: the case shown is not laid over itself", page.is_disabled('[data-overlay="2"]') and page.is_enabled('[data-overlay="0"]'))
    drawn = three.pixels()
    page.check('[data-overlay="0"]')
    check("three cases: overlay", three.ask("balm.overlays") == [0] and three.pixels() != drawn)
    check("three cases: no complaint", not three.complaints, str(three.complaints))
    if shots:
        page.screenshot(path=os.path.join(shots, "overlay.png"))
    three.context.close()
    narrow = Page(browser, "needle_lsq.html", 390, 844)
    names = narrow.ask("[...document.getElementById('case').options].map((o) => [o.textContent, o.title])")
    check("phone: long titles in the list keep their ends, and whole ones as tips", all(
        n.endswith(t[-6:]) and len(n) < len(t) for n, t in names) and len({n for n, _ in names}) == 3, str(names))
    narrow.context.close()

    slide = Page(browser, "actuator_davis_steering.html")
    x, y = slide.ask("balm.screen(1)")
    before = slide.ask("balm.input")
    slide.page.mouse.move(x, y)
    slide.page.mouse.down()
    slide.page.mouse.move(x + 12, y, steps=4)
    slide.page.mouse.up()
    check("a sliding input follows the mouse", slide.ask("balm.input") != before, "%s %s" % (before, slide.ask("balm.input")))
    slide.page.click("#play")
    slide.page.wait_for_timeout(200)
    check("a sliding input plays", not slide.complaints and slide.ask("balm.playing"))
    slide.context.close()

    gap = Page(browser, "open.html")
    gap.ask("balm.go(270)")
    check("open: explained below the picture", gap.page.is_visible("#alert") and "link 2 is too short" in gap.page.text_content("#alert"))
    check("open: by how much here", gap.page.text_content("#alert").endswith("; here by 15"), gap.page.text_content("#alert"))
    gap.ask("balm.go(20)")
    check("open: nothing to explain where it closes", not gap.page.is_visible("#alert"))
    gap.page.click("#messages .go")
    check("open: a message leads to its position", gap.page.is_visible("#alert"))
    check("open: no complaint", not gap.complaints, str(gap.complaints))
    if shots:
        gap.page.screenshot(path=os.path.join(shots, "open.png"))
    gap.context.close()
    nowhere = Page(browser, "nowhere.html")
    check("closes nowhere: page says why", "too short" in nowhere.page.text_content("#alert") and not nowhere.complaints)
    nowhere.context.close()
    for name in ["sign", "typo"]:
        wrong = Page(browser, name + ".html")
        check(name + ": the page shows the errors", "error:" in wrong.page.text_content("#messages") and not wrong.complaints and
              not wrong.page.is_visible("#stage"))
        wrong.ask("""for (const key of [' ', 'ArrowLeft', 'ArrowRight', 'Home', 'End', '[', ']', '+', '-'])
            document.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
            for (const part of document.querySelectorAll('button')) part.click();
            for (const part of document.querySelectorAll('input,select')) {
              part.dispatchEvent(new Event('input')); part.dispatchEvent(new Event('change'));
            }
            for (const part of document.querySelectorAll('canvas')) for (const kind of ['pointerdown', 'pointermove', 'pointerup'])
              part.dispatchEvent(new PointerEvent(kind, { clientX: 50, clientY: 50 }));
            for (const way of [-1, 1]) balm.go(way);""")
        wrong.page.wait_for_timeout(50)
        check(name + ": keys and controls do no harm", not wrong.complaints, str(wrong.complaints))
        wrong.context.close()
    nasty = Page(browser, "nasty.html")
    check("a nasty title: nothing runs, nothing breaks", not nasty.dialogs and not nasty.complaints and
          nasty.page.text_content("#title").startswith("</script><script>alert(1)</script> & \"q\""), str(nasty.complaints))
    nasty.context.close()
    for scheme in ["light", "dark"]:
        phone = Page(browser, "textile.html", 390, 844, scheme)
        check("phone, %s: no sideways scrolling" % scheme, phone.ask("document.documentElement.scrollWidth") <= 390)
        paper = phone.ask("getComputedStyle(document.body).backgroundColor")
        check("phone, %s: colour of the paper" % scheme, (paper == "rgb(255, 255, 255)") == (scheme == "light"), paper)
        if shots:
            phone.page.screenshot(path=os.path.join(shots, "phone_%s.png" % scheme), full_page=True)
        phone.context.close()
    for width, across in ((390, 390), (1280, 960)):
        picture = Page(browser, "needle.svg", width, 700)
        box = picture.ask("(({width, height}) => [width, height])(document.documentElement.getBoundingClientRect())")
        shape = picture.ask("document.documentElement.viewBox.baseVal.height/document.documentElement.viewBox.baseVal.width")
        check("SVG: fits a window of %d pixels" % width, abs(box[0] - across) < 1 and abs(box[1] - across * shape) < 1, str(box))
        picture.context.close()
    touch = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True)
    touch.set_default_timeout(PATIENCE)
    page = touch.new_page()
    page.goto("file://" + os.path.abspath("needle.html"))
    page.wait_for_timeout(150)
    x, y = page.evaluate("balm.screen(0)")
    client = touch.new_cdp_session(page)
    client.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x + 60, "y": y}]})
    for degrees in (10, 20, 30):
        client.send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": [
            {"x": x + 60 * math.cos(math.radians(degrees)), "y": y + 60 * math.sin(math.radians(degrees))}]})
    client.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    check("drag by touch", 15 < page.evaluate("balm.position") < 45, str(page.evaluate("balm.position")))
    coupler = next(b for b in page_data("needle.html")[0]["bars"] if (b["loop"], b["arc"]) == (1, 2))
    ends = [page.evaluate("balm.screen(%d)" % coupler[k]) for k in ("from", "to")]
    page.touchscreen.tap(0.4 * ends[0][0] + 0.6 * ends[1][0], 0.4 * ends[0][1] + 0.6 * ends[1][1])
    check("a tap names the arc", page.is_visible("#tip") and "loop 1, arc 2: length 95" in page.text_content("#tip"), page.text_content("#tip"))
    touch.close()
    large = Page(browser, "needle.html", 1920, 1080, "dark")
    check("a large screen is used", large.ask("document.getElementById('linkage').clientHeight") > 800 and
          large.page.locator("#controls").bounding_box()["y"] < 1000)
    paper = "getComputedStyle(document.body).backgroundColor"
    dark = large.ask(paper)
    large.ask("dispatchEvent(new Event('beforeprint'))")
    check("printed from a dark screen the page is light", large.ask(paper) == "rgb(255, 255, 255)" != dark)
    large.ask("dispatchEvent(new Event('afterprint'))")
    check("after printing it is dark again", large.ask(paper) == dark)
    large.context.close()
    slider = Page(browser, "dyad4_slider_crank.html")
    joint = next(j for j, v in enumerate(page_data("dyad4_slider_crank.html")[0]["joints"]) if v["slides"])
    before = slider.ask("balm.screen(%d)" % joint)
    slider.page.check("#other")
    check("other assemblies widen the view", slider.ask("balm.screen(%d)" % joint) != before)
    slider.context.close()
