#!/usr/bin/env python3
"""The site that scripts/book makes, in chromium without a screen; scripts/book --check calls it.

usage: .venv/bin/python test/web/book_in_browser.py SITE_DIRECTORY

Every page is opened on a phone and on a desk, light and dark: nothing is wider than the screen, text stands out from its ground, pictures
load, scripts run without an error. The search leads the words of each question of a newcomer to a page that answers it, and the list of
contents names that page. The gallery has forty mechanisms or more, all those of the field, each with a picture that moves; a click opens
each sketch on the drawing board. Last line: N passed, N failed.
"""
import glob
import os
import re
import shutil
import sys

from playwright.sync_api import sync_playwright

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from picture_tools import FLAGS
from tally import check, report

SCREENS = [(390, 844), (1280, 800)]
CONTRAST = 4.5                       # of WCAG 2, level AA, for text
FIRST = 3                            # results within which the page must be: what a screen of a phone shows
# What someone new asked (the words that one types), and the page with the answer.
QUESTIONS = [("crank range only", "guide/questions"), ("transmission angle whole turn", "guide/questions"), ("dimensions of rank 3", "guide/questions"),
             ("velocity of a joint as CSV", "guide/questions"), ("free timing", "guide/questions"), ("TABIN", "guide/questions"),
             ("unit of CAMWID", "guide/questions"), ("film", "guide/questions"), ("STEP STL", "guide/questions"), ("place of a pivot", "guide/questions")]
NAMES = ["Chebyshev", "Watt", "Peaucellier", "Hoecken", "Klann", "Jansen", "Stephenson I", "Stephenson II", "Stephenson III", "Whitworth",
         "Toggle press", "Horst", "Excavator", "Umbrella", "Bed hinge", "Gripper", "Sewing machine", "Andrews's squeezer"]
MECHANISMS = 40

WIDE = """() => [...document.querySelectorAll('article *')].filter(one => one.getBoundingClientRect().right > innerWidth + 1 &&
    !one.closest('.table-wrapper, pre, .highlight, svg')).map(one => one.tagName + ' ' + one.textContent.slice(0, 40))"""
GROUND = """() => { const shades = text => text.match(/[\\d.]+/g).slice(0, 3).map(one => one/255).map(
        one => one <= 0.04045 ? one/12.92 : ((one + 0.055)/1.055)**2.4).reduce((sum, one, i) => sum + one*[0.2126, 0.7152, 0.0722][i], 0);
    const two = [shades(getComputedStyle(document.querySelector('article p, article li, article td')).color),
                 shades(getComputedStyle(document.body).backgroundColor)].sort((a, b) => b - a);
    return [(two[0] + 0.05)/(two[1] + 0.05), two[1] === shades(getComputedStyle(document.body).backgroundColor)]; }"""


def test_pages(page, site, errors):
    names = sorted(os.path.relpath(path, site) for path in glob.glob(os.path.join(site, "**", "*.html"), recursive=True))
    for name in names:
        if name in ("board.html", "genindex.html", "search.html") or name.startswith("_"):
            continue
        errors.clear()
        page.goto("file://" + os.path.join(site, name))
        for width, height in SCREENS:
            for scheme in ("light", "dark"):
                page.emulate_media(color_scheme=scheme)
                page.set_viewport_size({"width": width, "height": height})
                where = "%s, %d pixels, %s:" % (name, width, scheme)
                spare = page.evaluate("document.documentElement.scrollWidth - innerWidth")
                check(where + " no wider than the screen", spare <= 0 and not page.evaluate(WIDE), "%s %s" % (spare, page.evaluate(WIDE)[:3]))
                contrast, dark = page.evaluate(GROUND)
                check(where + " text stands out", contrast >= CONTRAST and dark == (scheme == "dark"), "%.1f" % contrast)
        missing = page.evaluate("[...document.images].filter(one => one.complete && !one.naturalWidth).map(one => one.src)")
        check(name + ": pictures", not missing, str(missing))
        check(name + ": scripts", not errors, str(errors))


def test_search(page, site):
    page.goto("file://" + os.path.join(site, "index.html"))
    contents = page.eval_on_selector_all(".sidebar-tree a", "all => all.map(one => one.getAttribute('href'))")
    for words, wanted in QUESTIONS:
        page.goto("file://" + os.path.join(site, "search.html") + "?q=" + words.replace(" ", "+"))
        page.wait_for_selector("#search-results .search-summary, #search-results li a")
        page.wait_for_function("document.querySelector('#search-progress') === null || /finished|found/i.test(document.querySelector('#search-results').textContent)")
        found = page.eval_on_selector_all("#search-results li > a", "all => all.map(one => one.getAttribute('href'))")
        check("search: " + words, any(wanted in link for link in found[:FIRST]), str(found[:FIRST + 3]))
        check("contents: " + wanted, any(wanted in link for link in contents))


def test_gallery(browser, page, site, errors):
    page.goto("file://" + os.path.join(site, "gallery.html"))
    titles = [title.rstrip("¶#").replace("’", "'") for title in page.eval_on_selector_all("article h3", "all => all.map(one => one.textContent)")]
    check("gallery: forty mechanisms", len(titles) >= MECHANISMS, str(len(titles)))
    for name in NAMES:
        check("gallery: " + name, any(re.match(re.escape(name) + r"\b(?! I)", title) or name == title for title in titles), str(titles))
    moving = page.eval_on_selector_all("article img", "all => all.map(one => one.getAttribute('src'))")
    check("gallery: a moving picture for each", len(moving) == len(titles) and all(link.endswith(".move.svg") for link in moving))
    for link in moving:
        with open(os.path.join(site, link), encoding="utf-8") as file:
            check("gallery: %s moves" % link, "<animate" in file.read())
    links = page.eval_on_selector_all("article a[href*='board.html#']", "all => all.map(one => one.href)")
    cases = page.eval_on_selector_all("article pre", "all => all.map(one => one.textContent)")
    check("gallery: the case under each", len(cases) == len(titles))
    check("gallery: every sketch opens on the board", len(links) == sum("&CHAIN" in case for case in cases), str(len(links)))
    for k in range(len(links)):
        errors.clear()
        page.goto("file://" + os.path.join(site, "gallery.html"))
        page.locator("article a[href*='board.html#']").nth(k).click()
        page.wait_for_function("typeof board === 'object' && board.state && board.state.sketch.joints.length > 2")
        chip = page.text_content("#chip")
        check("board: it moves, %s" % links[k].split("&case")[0][-40:], "it moves" in chip and not errors, "%s %s" % (chip, errors))


def main():
    site, errors = os.path.abspath(sys.argv[1]), []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        test_pages(page, site, errors)
        test_search(page, site)
        test_gallery(browser, page, site, errors)
        browser.close()
    return report()


if __name__ == "__main__":
    sys.exit(main())
