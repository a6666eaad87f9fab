"""The report as one HTML page that loads nothing else: the data for its template."""

from __future__ import annotations

from markupsafe import Markup

from spear_pin import __version__
from spear_pin.studies.audit.errata import ERRATA
from spear_pin.studies.audit.statements import ASSUMPTIONS, RULES, command_of
from spear_pin.viz import embedding
from spear_pin.viz.report.contents import chapters
from spear_pin.viz.report.making import SVG, Report
from spear_pin.viz.report.pictures import NOTHING_TO_COMPUTE, Picture
from spear_pin.viz.report.text import blocks, number, numbers, prose, symbols
from spear_pin.viz.template import environment

MOST_BYTES = 8_000_000


def render(report: Report) -> str:
    """Returns the text of the page."""
    pages = environment(
        blocks=blocks, command=command_of, drawing=drawing, number=number, numbers=numbers, prose=prose, symbols=symbols
    )
    viewer, sides = embedding.shared(report.pages.values())
    return pages.get_template("report/page.html").render(
        version=__version__,
        report=report,
        counts={verdict: count for verdict, count in report.counts.items() if count or verdict != "failed"},
        chapters=chapters(report),
        assumptions=ASSUMPTIONS,
        errata=ERRATA,
        rules={verdict: rule for verdict, rule in RULES.items() if verdict != "failed"},
        nothing=NOTHING_TO_COMPUTE,
        data={"viewer": viewer, "pages": dict(zip(report.pages, sides, strict=True))},
    )


def drawing(picture: Picture, report: Report) -> Markup:
    """Returns a figure as an element of the page; see `embedding.drawing`."""
    return embedding.drawing(report.pictures[picture.id][SVG], picture.id, f"{picture.place}: {picture.caption}")
