"""Settings of Sphinx for the book; scripts/book calls it. The navigation comes from the lists of links of doc/index.md and of the
index of items, so that the pages stay plain Markdown."""
import os
import re

project = "PSALM"
author = "The PSALM team"
release = os.environ.get("PSALM_VERSION", "")
extensions = ["myst_parser"]
root_doc = "index"
source_suffix = {".md": "markdown"}
myst_heading_anchors = 4            # anchors as code hosts make them
nitpicky = True
html_theme = "furo"
html_title = "PSALM " + release
html_show_sourcelink = False
html_show_copyright = False
html_copy_source = False
HERE = os.path.dirname(os.path.abspath(__file__))
html_static_path = ["site"]
html_css_files = ["book.css"]
html_search_scorer = os.path.join(HERE, "site", "search.js")
highlight_language = "none"           # cases are no language that Pygments knows
# the drawing board that the gallery opens (tools/book_pages)
html_extra_path = [folder for folder in ["extra"] if os.path.isdir(os.path.join(HERE, folder))]
pygments_style = "default"
pygments_dark_style = "monokai"


def contents(text, folder):
    """Hidden tables of contents: one for each heading of the second level, of all pages that are linked below it."""
    found = []
    for part in re.split(r"^## ", text, flags=re.M)[1:]:
        caption = part.split("\n")[0]
        pages = ["%s <%s>" % (words, page) for words, page in dict.fromkeys(re.findall(r"\[([^]]*)\]\(([\w/]+)\.md\)", part))
                 if os.path.exists(os.path.join(folder, page + ".md"))]
        if pages:
            found.append("```{toctree}\n:hidden:\n:caption: %s\n\n%s\n```\n" % (caption, "\n".join(pages)))
    return found


def add_contents(app, name, source):
    folder = os.path.dirname(app.env.doc2path(name))
    if name == root_doc:
        source[0] += "\n" + "\n".join(contents(source[0], folder))
    elif name == "reference/items":
        source[0] += "\n" + "\n".join(contents(source[0], folder))


def setup(app):
    app.connect("source-read", add_contents)
