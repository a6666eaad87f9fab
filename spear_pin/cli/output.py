"""What the commands print, and what they show while they work."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def print_result(result: dict[str, Any], as_json: bool) -> None:
    """Print what a command returns, for as long as somebody reads.

    Args:
        result: the figures by name, and how they read under "text".
        as_json: print the figures as one JSON object, not the text.
    """
    try:
        if as_json:
            result.pop("text", None)
            print(json.dumps(_plain(result), allow_nan=False))
        else:
            print(result["text"])
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough
        sys.stderr.close()


def _plain(value: Any) -> Any:
    """Numbers, lists and objects that JSON has; complex numbers as [re, im]."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    return value


def aligned(rows: Iterable[tuple[str, str]]) -> str:
    """Lines of a name and what it says, in two columns."""
    return "\n".join(f"{name:<21}{value}" for name, value in rows)


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """Show what is going on in one line of a terminal's stderr, and clear it when that is done."""
    seen = sys.stderr.isatty()

    def show(text: str) -> None:
        if seen:
            print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        if seen:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


@contextmanager
def iterations() -> Iterator[Callable[[int, float], None]]:
    """Show a solver's iterations."""
    with progress() as show:
        yield lambda iteration, residual: show(f"solving: iteration {iteration}, residual {residual:.1e}")


def open_page(page: Path) -> None:
    """Open a file in the browser."""
    import webbrowser

    webbrowser.open(page.resolve().as_uri())
