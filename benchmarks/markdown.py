"""Tables that benchmarks print, which `python -m docs.results` puts into the pages of results."""

from __future__ import annotations

from collections.abc import Iterable


def begin(*heads: str) -> None:
    """Print the head of a table."""
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}", flush=True)


def row(*cells: object) -> None:
    """Print a row, as soon as it is known."""
    print(f"| {' | '.join(map(str, cells))} |", flush=True)


def table(heads: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Print a whole table, and an empty line."""
    begin(*heads)
    for cells in rows:
        row(*cells)
    print()
