"""Making of the report: every statement checked, every figure drawn, every table made, each once or from the cache.

This module computes nothing itself; `spear_pin.studies.audit.statements` and the plots define the contents. Failures
are part of the report, with their reasons.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path
from typing import Any

from spear_pin.errors import UnknownName
from spear_pin.files import atomic, scratch
from spear_pin.studies.audit.statements import STATEMENTS, VERDICTS, Finding, Statement, Verdict, check
from spear_pin.studies.audit.statements.tables import TABULATIONS, Rows, Tabulation
from spear_pin.viz.plots import save_figure
from spear_pin.viz.report.cache import Cache
from spear_pin.viz.report.pictures import PICTURES, Picture
from spear_pin.viz.report.playbacks import PLAYBACKS, Playback

SVG = "svg"


@dataclass(frozen=True)
class Selection:
    """Contents of a report, in the order of the source.

    Attributes:
        statements: statements of all chapters.
        pictures: pictures of all chapters.
        tabulations: tables of all chapters.
        playbacks: playbacks at the end.
    """

    statements: tuple[Statement, ...]
    pictures: tuple[Picture, ...]
    tabulations: tuple[Tabulation, ...]
    playbacks: tuple[Playback, ...]

    def __len__(self) -> int:
        return sum(map(len, (self.statements, self.pictures, self.tabulations, self.playbacks)))


@dataclass(frozen=True)
class Report:
    """Results of a report, by id.

    Attributes:
        selection: contents of the report.
        findings: findings on the statements.
        pictures: each figure by format.
        rows: rows of the tables.
        pages: pages of the playbacks.
        failures: parts that could not be made, and why.
    """

    selection: Selection
    findings: dict[str, Finding] = field(default_factory=dict)
    pictures: dict[str, dict[str, bytes]] = field(default_factory=dict)
    rows: dict[str, Rows] = field(default_factory=dict)
    pages: dict[str, str] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)

    @property
    def counts(self) -> dict[Verdict, int]:
        """Number of statements of each verdict."""
        found = Counter(finding.verdict for finding in self.findings.values())
        return {verdict: found[verdict] for verdict in VERDICTS}


def select(patterns: Sequence[str] = ()) -> Selection:
    """Returns everything, or the parts with an id that fits a pattern; statements come with their figure or table.

    Args:
        patterns: patterns such as "fig-5.*".

    Raises:
        UnknownName: a pattern fits nothing.
    """
    pictures = [picture for chapter in PICTURES.values() for picture in chapter]
    tabulations = [tabulation for chapter in TABULATIONS.values() for tabulation in chapter]
    known = [item.id for group in (STATEMENTS, pictures, tabulations, PLAYBACKS) for item in group]
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            raise UnknownName("part of the report", pattern, dict.fromkeys(known))

    def chosen(*names: str) -> bool:
        return not patterns or any(fnmatchcase(name, pattern) for name in names for pattern in patterns)

    return Selection(
        tuple(statement for statement in STATEMENTS if chosen(statement.id, statement.exhibit)),
        tuple(picture for picture in pictures if chosen(picture.id)),
        tuple(tabulation for tabulation in tabulations if chosen(tabulation.id)),
        tuple(playback for playback in PLAYBACKS if chosen(playback.id)),
    )


def make(
    selection: Selection,
    cache: Cache | None = None,
    formats: Sequence[str] = (SVG,),
    on_item: Callable[[str], object] = lambda name: None,
) -> Report:
    """Makes a report, or the parts of it that have changed.

    Args:
        selection: contents of the report.
        cache: cache of earlier runs; None makes everything again.
        formats: formats of the figures, suffixes that `save_figure` knows.
        on_item: called with the id of each item when it begins.
    """
    report = Report(selection)
    for statement in selection.statements:
        on_item(statement.id)
        report.findings[statement.id] = _finding(statement, cache)
    for picture in selection.pictures:
        on_item(picture.id)
        _try(report, picture.id, report.pictures, partial(_drawn, picture, formats, cache))
    for tabulation in selection.tabulations:
        on_item(tabulation.id)
        _try(report, tabulation.id, report.rows, tabulation.rows)
    for playback in selection.playbacks:
        on_item(playback.id)
        _try(report, playback.id, report.pages, partial(_played, playback, cache))
    return report


def write_figures(report: Report, folder: Path, suffix: str) -> list[Path]:
    """Writes the figures of a report that was made in this format into a folder, each by its id."""
    folder.mkdir(exist_ok=True)
    paths = []
    for name, drawn in report.pictures.items():
        path = folder / f"{name}.{suffix}"
        with atomic(path) as temporary:
            temporary.write_bytes(drawn[suffix])
        paths.append(path)
    return paths


def _try(report: Report, name: str, results: dict[str, Any], make_one: Callable[[], Any]) -> None:
    """Keeps the result of a part, or the reason why it failed: one part must not stop the others."""
    try:
        results[name] = make_one()
    except Exception as error:
        report.failures[name] = f"{type(error).__name__}: {error}"


def _finding(statement: Statement, cache: Cache | None) -> Finding:
    """Returns the finding on a statement by checking it; a failure is not kept."""
    kept = None if cache is None else cache.get(statement.id)
    if kept is not None:
        return Finding.of(json.loads(kept))
    finding = check(statement)
    if cache is not None and finding.verdict != "failed":
        cache.put(statement.id, json.dumps(asdict(finding)).encode())
    return finding


def _drawn(picture: Picture, formats: Sequence[str], cache: Cache | None) -> dict[str, bytes]:
    """Returns a figure in each format, drawn once for those that are missing."""
    names = {suffix: f"{picture.id}.{suffix}" for suffix in formats}
    drawn = {suffix: kept for suffix, name in names.items() if cache is not None and (kept := cache.get(name))}
    if missing := [suffix for suffix in formats if suffix not in drawn]:
        figure = picture.draw()
        with scratch() as folder:
            for suffix in missing:
                drawn[suffix] = save_figure(figure, folder / f"figure.{suffix}").read_bytes()
                if cache is not None:
                    cache.put(names[suffix], drawn[suffix])
    return drawn


def _played(playback: Playback, cache: Cache | None) -> str:
    kept = None if cache is None else cache.get(playback.id)
    if kept is not None:
        return kept.decode()
    text = playback.make()
    if cache is not None:
        cache.put(playback.id, text.encode())
    return text
