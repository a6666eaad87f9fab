"""The report as one HTML page that asks for nothing: what its template is given."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

from spear_pin import __version__
from spear_pin.studies.audit.errata import ERRATA
from spear_pin.studies.audit.statements import ASSUMPTIONS, RULES, command_of
from spear_pin.viz.report.contents import chapters
from spear_pin.viz.report.making import SVG, Report
from spear_pin.viz.report.pictures import NOTHING_TO_COMPUTE, Picture
from spear_pin.viz.report.playbacks import shared
from spear_pin.viz.report.text import blocks, number, numbers, prose, symbols
from spear_pin.viz.template import environment

MOST_BYTES = 8_000_000
ENLARGED = 1.3  # figures on a screen beside those on paper


def render(report: Report) -> str:
    """The text of the page."""
    pages = environment(
        blocks=blocks, command=command_of, drawing=drawing, number=number, numbers=numbers, prose=prose, symbols=symbols
    )
    viewer, sides = shared(report.pages.values())
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
    """A figure as an element of the page; of its ids those that it refers to, made its own."""
    source = report.pictures[picture.id][SVG].decode()
    source = source[source.index("<svg") :]
    source = re.sub(r"<metadata>.*?</metadata>", "", source, flags=re.S)
    used = set(re.findall(r'(?:href="|url\()#([^")]+)', source))
    source = re.sub(r' id="([^"]*)"', lambda m: f' id="{picture.id}-{m[1]}"' if m[1] in used else "", source)
    source = re.sub(r'(href="|url\()#', rf"\g<1>#{picture.id}-", source)
    size = re.search(r'width="([\d.]+)pt" height="[\d.]+pt"', source)
    assert size is not None  # matplotlib's own
    source = source.replace(size[0], f'style="--width:{ENLARGED * float(size[1]):.0f}pt"', 1)
    label = escape(f"{picture.place}: {picture.caption}")
    return Markup(source.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1))
