"""Pages of modules stand outside the table of contents.

The sidebar of each page would list each of them, and to write hundreds of pages took minutes. A module's page links to
the package that holds it and to the modules that it holds.
"""

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.ext.autosummary import autosummary_toc


def take_out(app: Sphinx, document: nodes.document) -> None:
    """Drop the entries that autosummary adds to the table of contents beside its tables."""
    for entry in list(document.findall(autosummary_toc)):
        entry.parent.remove(entry)


def stand_alone(app: Sphinx, document: nodes.document) -> None:
    """Let the page of a module stand outside all tables of contents."""
    if app.env.docname.startswith("api/"):
        app.env.metadata[app.env.docname]["orphan"] = True


def setup(app: Sphinx) -> dict[str, Any]:
    """Listen to pages that were read, before and after their table of contents is collected."""
    app.connect("doctree-read", take_out, priority=100)
    app.connect("doctree-read", stand_alone, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
