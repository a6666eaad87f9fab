"""The report as one HTML page that asks for nothing: its parts as HTML, put into the template."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable

from spear_pin import __version__
from spear_pin.studies.audit.errata import ERRATA, Erratum
from spear_pin.studies.audit.statements import CHAPTERS, Finding, Statement, Verdict, command_of
from spear_pin.studies.audit.statements.tables import TABULATIONS, Cell, Rows, Tabulation
from spear_pin.viz.report.making import SVG, Report
from spear_pin.viz.report.pictures import NOTHING_TO_COMPUTE, PICTURES, Picture
from spear_pin.viz.report.playbacks import shared
from spear_pin.viz.report.text import markdown, number, numbers, text
from spear_pin.viz.report.verdicts import MARKS, assumptions, badge, rules
from spear_pin.viz.template import asset, filled, script_json

TITLES = {
    2: "Two legs",
    3: "The model",
    4: "Push test and hop",
    5: "The quadruped",
    6: "Conclusions",
}
MOST_BYTES = 8_000_000
ENLARGED = 1.3  # figures on a screen beside those on paper


def render(report: Report) -> str:
    """The text of the page."""
    parts = {
        "style": asset("report/page.css"),
        "script": asset("report/page.js"),
        "version": html.escape(__version__),
        "summary": _summary(report),
        "contents": _contents(report),
        "chapters": "".join(_chapter(report, chapter) for chapter in CHAPTERS),
        "playbacks": _playbacks(report),
        "rules": rules(),
        "assumptions": assumptions(),
        "errata": "".join(_errata(report, group, errata) for group, errata in ERRATA.items()),
        "nothing": "".join(
            f"<tr><th>{html.escape(place)}</th><td>{html.escape(why)}</td></tr>"
            for place, why in NOTHING_TO_COMPUTE.items()
        ),
        "data": _data(report),
    }
    return filled("report/page.html", parts)


# the head of the page


def _summary(report: Report) -> str:
    counts = {verdict: count for verdict, count in report.counts.items() if count or verdict != "failed"}
    total = sum(counts.values())
    tiles = "".join(
        f'<li class="{MARKS[verdict][0]}"><strong>{count}</strong> {badge(verdict)}</li>'
        for verdict, count in counts.items()
    )
    bar = "".join(
        f'<i class="{MARKS[verdict][0]}" style="flex-grow:{count}"></i>' for verdict, count in counts.items() if count
    )
    buttons = "".join(
        f'<button type="button" value="{MARKS[verdict][0]}" aria-pressed="false">{verdict}</button>'
        for verdict in counts
    )
    return (
        f'<p class="total"><strong>{total}</strong> statements checked</p><ul class="tiles">{tiles}</ul>'
        f'<div class="bar" aria-hidden="true">{bar}</div>'
        f'<div class="filter" role="group" aria-label="Show"><span>Show</span>'
        f'<button type="button" value="" aria-pressed="true">all</button>{buttons}</div>'
    )


def _contents(report: Report) -> str:
    lines = []
    for chapter, title in TITLES.items():
        inner = "".join(
            f'<li><a href="#{name}">{html.escape(place)}</a>{_dots(report, _shown_by(report, chapter, name))}</li>'
            for name, place, _, _ in _exhibits(report, chapter)
        )
        if others := _shown_by(report, chapter, ""):
            inner += f'<li><a href="#equations-{chapter}">Equations and text</a>{_dots(report, others)}</li>'
        if inner:
            lines.append(f'<li><a href="#chapter-{chapter}">{chapter} {title}</a><ul>{inner}</ul></li>')
    if report.pages:
        lines.append('<li><a href="#playbacks">Playbacks</a></li>')
    lines += [f'<li><a href="#{name.lower()}">{name}</a></li>' for name in ("Assumptions", "Errata", "Method")]
    return f"<ol>{''.join(lines)}</ol>"


# chapters: figures and tables with the statements that they show, then the other statements


def _chapter(report: Report, chapter: int) -> str:
    cards = "".join(_card(report, chapter, *exhibit) for exhibit in _exhibits(report, chapter))
    if others := _shown_by(report, chapter, ""):
        heading = f'<article class="card" id="equations-{chapter}"><h3>Equations and text</h3>'
        cards += f"{heading}{_statements(report, others)}</article>"
    if not cards:
        return ""
    return f'<section id="chapter-{chapter}"><h2><span>Chapter {chapter}</span> {TITLES[chapter]}</h2>{cards}</section>'


def _exhibits(report: Report, chapter: int) -> list[tuple[str, str, Picture | None, Tabulation | None]]:
    """Id and place of each figure and table that the report has of a chapter; what has the same id goes together."""
    pictures = {picture.id: picture for picture in PICTURES.get(chapter, ()) if picture in report.selection.pictures}
    tables = {table.id: table for table in TABULATIONS.get(chapter, ()) if table in report.selection.tabulations}
    found = []
    for name in dict.fromkeys((*pictures, *tables)):
        picture, table = pictures.get(name), tables.get(name)
        place = picture.place if picture is not None else tables[name].place
        found.append((name, place, picture, table))
    return found


def _shown_by(report: Report, chapter: int, exhibit: str) -> list[Statement]:
    """Statements that a figure or table shows; for none, those of a chapter that nothing in the report shows."""
    if exhibit:
        return [statement for statement in report.selection.statements if statement.exhibit == exhibit]
    present = {name for number in CHAPTERS for name, *_ in _exhibits(report, number)}
    of_chapter = {statement.id for statement in CHAPTERS[chapter]}
    return [each for each in report.selection.statements if each.id in of_chapter and each.exhibit not in present]


def _card(
    report: Report, chapter: int, name: str, place: str, picture: Picture | None, table: Tabulation | None
) -> str:
    statements = _shown_by(report, chapter, name)
    parts = [f"<h3>{html.escape(place)} {_verdict(report, statements)}</h3>"]
    if picture is not None:
        parts.append(_picture(report, picture))
    if table is not None:
        parts.append(_tabulation(report, table))
    parts.append(_statements(report, statements))
    return f'<article class="card" id="{name}">{"".join(parts)}</article>'


def _picture(report: Report, picture: Picture) -> str:
    if picture.id in report.failures:
        drawing = f'<p class="reason">{badge("failed")} {html.escape(report.failures[picture.id])}</p>'
    else:
        drawing = f'<div class="drawing">{_inline_svg(report.pictures[picture.id][SVG], picture)}</div>'
    footing = _footing(picture.assumes, f"spear report --only {picture.id} --figures svg")
    return (
        f"<figure>{drawing}<figcaption><p><b>Here</b> {text(picture.caption)}</p>"
        f"<p><b>In the source</b> {text(picture.shows)}</p>{footing}</figcaption></figure>"
    )


def _inline_svg(svg: bytes, picture: Picture) -> str:
    """The figure as an element of the page; of its ids those that it refers to, made its own."""
    source = svg.decode()
    source = source[source.index("<svg") :]
    source = re.sub(r"<metadata>.*?</metadata>", "", source, flags=re.S)
    used = set(re.findall(r'(?:href="|url\()#([^")]+)', source))
    source = re.sub(r' id="([^"]*)"', lambda m: f' id="{picture.id}-{m[1]}"' if m[1] in used else "", source)
    source = re.sub(r'(href="|url\()#', rf"\g<1>#{picture.id}-", source)
    label = html.escape(f"{picture.place}: {picture.caption}", quote=True)
    size = re.search(r'width="([\d.]+)pt" height="[\d.]+pt"', source)
    assert size is not None  # matplotlib's own
    source = source.replace(size[0], f'style="--width:{ENLARGED * float(size[1]):.0f}pt"', 1)
    return source.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1)


def _tabulation(report: Report, table: Tabulation) -> str:
    if table.id in report.failures:
        body = f'<p class="reason">{badge("failed")} {html.escape(report.failures[table.id])}</p>'
    else:
        body = _grid(table.head, report.rows[table.id])
    return f"{body}<p class='caption'>{text(table.caption)}</p>{_footing(table.assumes, command_of(table.rows))}"


def _grid(head: Iterable[str], rows: Rows) -> str:
    top = "".join(f"<th>{text(cell)}</th>" for cell in head)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f'<div class="wide"><table class="data"><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def _cell(cell: Cell) -> str:
    if isinstance(cell, str):
        return f"<td>{text(cell)}</td>"
    return f'<td class="number">{"–" if cell is None else number(cell)}</td>'


# statements


def _statements(report: Report, statements: list[Statement]) -> str:
    if not statements:
        return ""
    rows = "".join(_statement(each, report.findings[each.id]) for each in statements)
    head = "<tr><th>Verdict</th><th>The source states</th><th>Found here</th></tr>"
    return f'<table class="statements"><thead>{head}</thead><tbody>{rows}</tbody></table>'


def _statement(statement: Statement, finding: Finding) -> str:
    printed = (
        "" if statement.printed is None else f'<p class="printed">{numbers(statement.printed, statement.unit)}</p>'
    )
    found = "" if finding.value is None else f'<p class="value">{numbers(finding.value, statement.unit)}</p>'
    if statement.finds:
        found += f"<p>{text(statement.finds)}</p>"
    found += "".join(
        f'<p class="case">{html.escape(case.label)}: {numbers(case.value, statement.unit)}</p>'
        for case in finding.cases
    )
    if statement.criterion is not None:
        found += f'<p class="criterion">Criterion: {html.escape(statement.criterion.text)}</p>'
    for remark in (finding.reason, statement.remark):
        if remark:
            found += f'<p class="remark">{text(remark)}</p>'
    return (
        f'<tr id="{statement.id}" data-verdict="{MARKS[finding.verdict][0]}">'
        f'<td>{badge(finding.verdict)}<p class="place">{html.escape(statement.place)}</p></td>'
        f"<td><p>{text(statement.says)}</p>{printed}</td>"
        f"<td>{found}{_footing(statement.assumes, statement.command)}</td></tr>"
    )


def _footing(assumes: Iterable[str], command: str) -> str:
    """Assumptions that something rests on, and the command that makes it again."""
    parts = ""
    if links := ", ".join(f'<a href="#assumption-{name}">{name.replace("-", " ")}</a>' for name in assumes):
        parts += f'<p class="assumes">Assumes {links}</p>'
    if command:
        parts += f"<details><summary>Command</summary><code>{html.escape(command)}</code></details>"
    return parts


def _verdict(report: Report, statements: list[Statement]) -> str:
    """Of a figure or table: it differs if anything in it does, and agrees if something does and nothing differs."""
    found = {report.findings[statement.id].verdict for statement in statements}
    worst: tuple[Verdict, ...] = ("failed", "differs", "agrees", "cannot be known", "by construction")
    return next((badge(verdict) for verdict in worst if verdict in found), "")


def _dots(report: Report, statements: list[Statement]) -> str:
    """A dot for each statement, in the colour of its verdict; the words stand in the badges."""
    kinds = (MARKS[report.findings[statement.id].verdict][0] for statement in statements)
    return f'<span class="dots" aria-hidden="true">{"".join(f"<i class={kind}></i>" for kind in kinds)}</span>'


# the end of the page


def _playbacks(report: Report) -> str:
    cards = ""
    for playback in report.selection.playbacks:
        if playback.id in report.failures:
            stage = f'<p class="reason">{badge("failed")} {html.escape(report.failures[playback.id])}</p>'
        else:
            stage = f'<div class="stage" data-play="{playback.id}"><button type="button">Play</button></div>'
        footing = _footing(playback.assumes, f"spear report --only {playback.id}")
        heading = f"<h3>{html.escape(playback.caption)}</h3>"
        cards += f'<article class="card" id="{playback.id}">{heading}{stage}{footing}</article>'
    return f'<section id="playbacks"><h2>Playbacks</h2>{cards}</section>' if cards else ""


def _errata(report: Report, group: str, errata: Iterable[Erratum]) -> str:
    rows = ""
    for erratum in errata:
        shown = [name for name in erratum.shown_by if name in report.findings]
        links = "".join(
            f'<li><a href="#{name}">{name.replace("-", " ")}</a> {badge(report.findings[name].verdict)}</li>'
            for name in shown
        )
        rows += (
            f"<tr><th>{text(erratum.title)}</th><td>{markdown(erratum.text)}"
            + (f'<ul class="shown">{links}</ul>' if links else "")
            + "</td></tr>"
        )
    return f'<h3>{html.escape(group)}</h3><table class="plain">{rows}</table>'


def _data(report: Report) -> str:
    """The viewer once, and what stands about it in each playback's page."""
    viewer, sides = shared(report.pages.values())
    return script_json({"viewer": viewer, "pages": dict(zip(report.pages, sides, strict=True))})
