"""Output of the commands, and what they show while they work."""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Any, TextIO

from spear_pin.errors import RobotWarning, SpearError
from spear_pin.files import plain
from spear_pin.printable import printable

if TYPE_CHECKING:
    from spear_pin.viz.playback.trajectory import TrajectoryLike

SUFFIXES = (".html", ".npz", ".svg", ".json", ".csv", ".mat", ".mcap", ".png", ".mp4")  # of what is written of a motion
IN_PYTHON = "# the same in Python:"
PAUSE = 15.0  # s between lines of progress where nobody looks at a terminal
UNREAD = 128 + 13  # status where nobody reads what is printed: that of the signal SIGPIPE


def print_result(result: dict[str, Any], as_json: bool) -> None:
    """Print what a command returns.

    Args:
        result: the figures by name, how they read under "text", and Python that does the same under "python".
        as_json: print the figures and the Python as one JSON object, not the text.

    Raises:
        SpearError: it cannot be printed.
        SystemExit: nobody reads it.
    """
    if as_json:
        result.pop("text", None)
        emit(json.dumps(plain(result), allow_nan=False).replace("\x7f", "\\u007f") + "\n")
    else:
        python = f"\n\n{IN_PYTHON}\n{result['python']}" if "python" in result else ""
        emit(f"{result['text']}{python}\n")


def emit(text: str) -> None:
    """Write to stdout.

    Raises:
        SpearError: it cannot be written.
        SystemExit: nobody reads it.
    """
    try:
        _write(sys.stdout, text)
    except BrokenPipeError:  # the reader has seen enough
        raise SystemExit(UNREAD) from None
    except OSError as error:
        raise SpearError(f"the output cannot be written to stdout: {error.strerror}") from None


def complain(text: str) -> None:
    """Write a line to stderr, if that can be written."""
    with suppress(OSError):
        _write(sys.stderr, f"{text}\n")


def tell(caught: Iterable[warnings.WarningMessage]) -> None:
    """Show warnings on stderr: of robots each once in one line, others as Python does."""
    for text in dict.fromkeys(str(each.message) for each in caught if isinstance(each.message, RobotWarning)):
        complain(f"spear: {text}")
    for each in caught:
        if not isinstance(each.message, RobotWarning):
            complain(
                warnings.formatwarning(each.message, each.category, each.filename, each.lineno, each.line).rstrip()
            )


def _write(stream: TextIO, text: str) -> None:
    """Write a text; what acts on a terminal in names from files is written out."""
    try:
        stream.write(printable(text, kept="\n\t"))
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # Python would try once more at the end
        raise


def align_lines(rows: Iterable[tuple[str, str]]) -> str:
    """Lines of a name and what it says, in two columns, of which long names widen the first."""
    told = [*rows]
    wide = max([20, *(len(name) for name, _ in told)])
    return join_lines(f"{name:<{wide}} {value}" for name, value in told)


def join_lines(lines: Iterable[str]) -> str:
    """Join lines to a text; what ends a line within one of them, as in a name from a file, is written out."""
    return "\n".join(map(printable, lines))


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """Show what is going on: in one line of a terminal, cleared at the end; elsewhere in a line now and then."""
    seen = sys.stderr.isatty()
    due = time.monotonic() + PAUSE

    def show(text: str) -> None:
        nonlocal due
        if seen:
            print(f"\r{printable(text)}\033[K", end="", file=sys.stderr, flush=True)
        elif time.monotonic() >= due:
            complain(printable(text))
            due = time.monotonic() + PAUSE

    try:
        yield show
    finally:
        if seen:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


@contextmanager
def foretold(command: str, takes: str | None) -> Iterator[None]:
    """Show how long a command will take, until it shows what is going on; None: it is soon done.

    Where stderr is no terminal, it is a line after PAUSE.
    """
    if takes is None:
        yield
        return
    text = f"{command}: takes {takes}"
    later = Timer(PAUSE, complain, [text])
    later.daemon = True
    with progress() as show:
        if sys.stderr.isatty():
            show(text)
        else:
            later.start()
        try:
            yield
        finally:
            later.cancel()


def draw(pictures: Mapping[Path, Callable[[Path], object]]) -> None:
    """Draw pictures into their files, one after the other."""
    with progress() as show:
        for path, write in pictures.items():
            show(f"drawing {path.name}")
            write(path)


def shows(played: TrajectoryLike) -> list[tuple[str, str]]:
    """Row of a command's text that says what a page shows, where that is a part only."""
    from spear_pin.viz.playback.trajectory import Part

    return [("page", f"shows {played.said}")] if isinstance(played, Part) else []


def list_rows(folder: Path, stem: str, files: Sequence[Path]) -> list[tuple[str, str]]:
    """Rows of a command's text with its files, and those called as they are that an earlier call has left there."""
    beside = (folder / f"{stem}{suffix}" for suffix in SUFFIXES)
    older = [str(path) for path in beside if path not in files and path.exists()]
    rows = [("files", ", ".join(map(str, files)))]
    return rows + [("of an earlier call", ", ".join(older))] * bool(older)


@contextmanager
def iterations() -> Iterator[Callable[[int, float], None]]:
    """Show a solver's iterations."""
    with progress() as show:
        yield lambda iteration, residual: show(f"solving: iteration {iteration}, residual {residual:.1e}")


def open_page(page: Path) -> None:
    """Open a file in the browser."""
    import webbrowser

    webbrowser.open(page.resolve().as_uri())
