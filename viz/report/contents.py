"""Contents of the report's page: its chapters, their figures and tables, and the statements next to each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from spear_pin.studies.audit.statements import CHAPTERS, Statement, Verdict
from spear_pin.studies.audit.statements.tables import TABULATIONS, Tabulation
from spear_pin.viz.report.making import Report
from spear_pin.viz.report.pictures import PICTURES, Picture

TITLES = {
    2: "Two legs",
    3: "The model",
    4: "Push test and hop",
    5: "The quadruped",
    6: "Conclusions",
}
WORST: tuple[Verdict, ...] = ("failed", "differs", "agrees", "cannot be known", "by construction")


@dataclass(frozen=True)
class Card:
    """Statements of a chapter that belong together.

    Attributes:
        id: id of the figure or table that shows them, or of the card alone.
        place: place in the source.
        statements: statements on the card.
        verdict: verdict on the figure or table as a whole; None where it has none.
        picture: the figure that shows them, if one does.
        table: the table that shows them, if one does.
    """

    id: str
    place: str
    statements: Sequence[Statement]
    verdict: Verdict | None = None
    picture: Picture | None = None
    table: Tabulation | None = None


@dataclass(frozen=True)
class Chapter:
    """A chapter of the source with its contents in a report.

    Attributes:
        number: number in the source.
        title: title.
        cards: figures and tables first, then the statements that none of them shows.
    """

    number: int
    title: str
    cards: tuple[Card, ...]


def chapters(report: Report) -> list[Chapter]:
    """Returns the chapters with contents in a report."""
    exhibits = {number: list(_exhibits(report, number)) for number in TITLES}
    shown = {card.id for cards in exhibits.values() for card in cards}
    found = []
    for number, title in TITLES.items():
        of_chapter = {statement.id for statement in CHAPTERS[number]}
        others = [each for each in report.selection.statements if each.id in of_chapter and each.exhibit not in shown]
        rest = [Card(f"equations-{number}", "Equations and text", others)] if others else []
        if cards := (*exhibits[number], *rest):
            found.append(Chapter(number, title, cards))
    return found


def _exhibits(report: Report, chapter: int) -> Iterator[Card]:
    """Returns figures and tables of a chapter in the report; those with the same id go together."""
    pictures = {picture.id: picture for picture in PICTURES.get(chapter, ()) if picture in report.selection.pictures}
    tables = {table.id: table for table in TABULATIONS.get(chapter, ()) if table in report.selection.tabulations}
    for name in dict.fromkeys((*pictures, *tables)):
        picture, table = pictures.get(name), tables.get(name)
        place = picture.place if picture is not None else tables[name].place
        statements = [statement for statement in report.selection.statements if statement.exhibit == name]
        yield Card(name, place, statements, _verdict(report, statements), picture, table)


def _verdict(report: Report, statements: Sequence[Statement]) -> Verdict | None:
    """Returns the verdict on a figure or table: it differs if anything differs, and else agrees if something agrees."""
    found = {report.findings[statement.id].verdict for statement in statements}
    return next((verdict for verdict in WORST if verdict in found), None)
