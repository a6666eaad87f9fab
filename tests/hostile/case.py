"""A hostile file, who reads it, and the rule that the answer is judged by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from spear_pin.printable import is_printable
from tests.wrong_calls.case import Answer, Command, Function

MEMORY = 10**9  # bytes that reading one may take, with all that Python has loaded
LINES, WIDEST = 8, 2500  # of what is complained about a file, in characters


@dataclass(frozen=True)
class Hostile(Command):
    """A file that a command reads, in the harness's process: it does its work, or refuses in a line.

    Attributes:
        what: the file is.
    """

    what: str = ""

    @property
    def name(self) -> str:
        return f"{self.what} ({super().name})"

    def verdict(self, answer: Answer) -> str:
        return withstood(answer, (0, 1, 2))


@dataclass(frozen=True)
class Drawn(Function):
    """A robot's file, or a mesh of it, that is read to be drawn, in the harness's process."""

    def verdict(self, answer: Answer) -> str:
        return withstood(answer, (None, 2))


def withstood(answer: Answer, statuses: tuple[int | None, ...]) -> str:
    """What is wrong with an answer, or nothing."""
    said = answer.out + answer.err
    if answer.status not in statuses:
        return f"status {answer.status}"
    if "Traceback" in said:
        return "a traceback"
    if answer.err.count("\n") > (1 if answer.status == 2 else LINES):
        return f"{answer.err.count(chr(10))} lines of complaint"
    if max(map(len, answer.err.split("\n"))) > WIDEST:
        return "a line that has no end"
    raw = {char for char in said if char not in "\n\t" and not is_printable(char)} | ({"\ufffd"} & set(said))
    if raw:
        return f"raw on the terminal: {', '.join(map(ascii, sorted(raw)))}"
    return f"refused, and left: {', '.join(answer.files)}" if answer.status == 2 and answer.files else ""


def put(name: str, content: Callable[[], bytes | str]) -> Callable[[Path], None]:
    """What writes a file of that name into a folder."""

    def write(folder: Path) -> None:
        data = content()
        (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode("utf-8", "surrogatepass"))

    return write


def sparse(name: str, first: bytes, size: int = 10**11) -> Callable[[Path], None]:
    """What writes a file of that name whose size is far beyond any memory, though it takes no room on the disk."""

    def write(folder: Path) -> None:
        with (folder / name).open("wb") as file:
            file.write(first)
            file.truncate(size)

    return write
