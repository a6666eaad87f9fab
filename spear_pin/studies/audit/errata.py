"""Corrections of the source, with reasons; `python -m docs.make_errata` writes them to `docs/explanation/errata.md`."""

from __future__ import annotations

from dataclasses import dataclass

from spear_pin.studies.prose import read


@dataclass(frozen=True)
class Erratum:
    """A correction of the source.

    Attributes:
        title: what is corrected.
        text: what is printed, what is right, and why; Markdown, paragraphs and tables with an empty line between.
        shown_by: ids of the statements whose numbers show it.
    """

    title: str
    text: str
    shown_by: tuple[str, ...] = ()


ERRATA: dict[str, tuple[Erratum, ...]] = {
    group: tuple(Erratum(**each) for each in errata) for group, errata in read(__package__, "errata.toml").items()
}
