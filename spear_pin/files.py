"""Write files whole or not at all, and JSON; read what is a file alone, and JSON that is what it seems."""

from __future__ import annotations

import errno
import json
import math
import os
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

from spear_pin.errors import BadFile

LARGEST = 20_000_000  # bytes of a text that is read whole


class Together:
    """Files that get their names together, once all of them are written."""

    def __init__(self) -> None:
        self._process, self._written = os.getpid(), dict[Path, Path]()

    def takes(self) -> bool:
        """Whether this process began them, and none that it has forked."""
        return self._process == os.getpid()

    def add(self, temporary: Path, target: Path) -> None:
        """Let a written file wait for the others."""
        target = target.absolute()
        if (before := self._written.pop(target, None)) is not None:
            before.unlink(missing_ok=True)
        self._written[target] = temporary

    def place(self) -> None:
        """Give all that wait their names; where one cannot have it, all is as before.

        Raises:
            BadFile: a file cannot have its name.
        """
        placed: list[tuple[Path, Path | None]] = []
        try:
            for target, temporary in self._written.items():
                before = _kept(target, temporary.with_suffix(".old"))
                placed.append((target, before))
                _rename(temporary, target)
        except BaseException:
            for target, before in placed:
                with suppress(OSError):
                    target.unlink() if before is None else os.replace(before, target)
            raise
        finally:
            for _, before in placed:
                if before is not None:
                    before.unlink(missing_ok=True)
            self.drop()

    def drop(self) -> None:
        """Remove what waits."""
        for temporary in self._written.values():
            with suppress(OSError):
                temporary.unlink()
        self._written.clear()


def _kept(target: Path, beside: Path) -> Path | None:
    """Keep a file beside itself, as a link or, where the folder takes none, as a copy; None where there is none."""
    if not target.is_symlink() and not target.exists():
        return None
    beside.unlink(missing_ok=True)
    try:
        os.link(target, beside, follow_symlinks=False)
    except OSError:
        try:
            shutil.copy2(target, beside, follow_symlinks=False)
        except OSError as error:
            raise BadFile(target, f"cannot be replaced: {error.strerror or error}") from None
    return beside


_together: Together | None = None
_numbers = count()


@contextmanager
def together() -> Iterator[Together]:
    """Files that this process writes in the block get their names at its end, or with `place`.

    Where one of them cannot be written, none does. Where the block ends otherwise, as by an interruption, those do
    that are whole.
    """
    global _together
    outer, files = _together, Together()
    _together = files
    try:
        yield files
    except (BadFile, OSError):
        raise
    except BaseException:
        files.place()
        raise
    else:
        files.place()
    finally:
        _together = outer
        files.drop()


@contextmanager
def atomic(path: str | Path, at_once: bool = False) -> Iterator[Path]:
    """A temporary path beside `path`, renamed to it when the block ends well and removed otherwise.

    In a block of `together` it waits for the others, unless it is to have its name at once.

    Raises:
        BadFile: the file cannot be written.
    """
    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.{next(_numbers)}.tmp")
    others = _together if _together is not None and _together.takes() and not at_once else None
    waits = False
    try:
        check_target(target)
        yield temporary
        if others is None:
            _rename(temporary, target)
        else:
            others.add(temporary, target)
            waits = True
    except OSError as error:
        raise BadFile(target, f"cannot be written: {error.strerror or error}") from None
    except UnicodeEncodeError as error:
        raise BadFile(
            target, f"cannot be written: remove {error.object[error.start : error.end]!a}, which UTF-8 cannot encode"
        ) from None
    finally:
        if not waits:
            with suppress(OSError):  # it may be gone, or its folder may be none
                temporary.unlink()


@contextmanager
def scratch() -> Iterator[Path]:
    """Give a folder for files that are read again and then removed; in it they have their names at once."""
    global _together
    outer, _together = _together, None
    try:
        with tempfile.TemporaryDirectory() as folder:
            yield Path(folder)
    finally:
        _together = outer


def check_target(path: Path) -> None:
    """Refuse a path at which there is a folder.

    Raises:
        BadFile: no file can be written there.
    """
    if path.is_dir():
        raise BadFile(path, f"cannot be written: {os.strerror(errno.EISDIR)}")


def _rename(temporary: Path, target: Path) -> None:
    try:
        os.replace(temporary, target)
    except OSError as error:
        raise BadFile(target, f"cannot be written: {error.strerror or error}") from None


def write_text(path: str | Path, text: str, at_once: bool = False) -> Path:
    """Write a text file, in UTF-8, whole or not at all; lone surrogates are written out; `at_once` as of `atomic`.

    Raises:
        BadFile: the file cannot be written.
    """
    with atomic(path, at_once) as temporary:
        temporary.write_text(text, encoding="utf-8", errors="backslashreplace")
    return Path(path)


def plain(value: Any) -> Any:
    """What JSON has: lists of arrays, [re, im] of complex numbers, null of what is not finite."""
    if isinstance(value, dict):
        return {name: plain(each) for name, each in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, (tuple, list)):
        return [plain(each) for each in value]
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def parse_json(text: str) -> Any:
    """Value of a JSON text: its numbers finite, no key twice in an object.

    Raises:
        ValueError: it is no such text, or nested too deep to be read.
    """
    try:
        return json.loads(
            text, parse_float=_number, parse_int=_number, parse_constant=_number, object_pairs_hook=_object
        )
    except RecursionError:
        raise ValueError("the JSON is nested too deep") from None


def check_keys(kind: str, found: Iterable[str], wanted: Iterable[str], optional: Iterable[str] = ()) -> None:
    """Raise `ValueError` unless just the wanted keys are there, and of others only optional ones; names the first."""
    found, wanted = set(found), set(wanted)
    if missing := sorted(wanted - found):
        raise ValueError(f"there is no {kind} {missing[0][:60]!r}")
    if unknown := sorted(found - wanted - set(optional)):
        raise ValueError(f"there is an unknown {kind} {unknown[0][:60]!r}")


def _number(text: str) -> float | int:
    if not math.isfinite(number := float(text)):
        raise ValueError(f"{text[:20]} is no finite number")
    return int(text) if text.removeprefix("-").isdigit() else number


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(found := dict(pairs)) < len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"the key {next(key for key in keys if keys.count(key) > 1)[:60]!r} is there twice")
    return found


def regular(path: str | Path, most: int | None = None) -> Path:
    """The path, if it leads to a regular file: a pipe would be waited for, and a device may never end.

    Args:
        path: of the file.
        most: bytes that it may have.

    Raises:
        BadFile: it leads nowhere, or to something else, or has more bytes.
    """
    try:
        target = Path(path)
        found = target.stat()
    except (OSError, ValueError) as error:  # of a null in it, ValueError
        raise BadFile(repr(path) if isinstance(error, ValueError) else path, _unreadable(error)) from None
    if not stat.S_ISREG(found.st_mode):
        what = "cannot be read: Is a directory" if stat.S_ISDIR(found.st_mode) else "is not a regular file"
        raise BadFile(path, what)
    if most is not None and found.st_size > most:
        raise BadFile(path, f"has more than {most} bytes")
    return target


def read_bytes(path: str | Path, most: int = LARGEST) -> bytes:
    """What is in a regular file, if that is not too much: of a sparse file a terabyte takes no room on the disk.

    Raises:
        BadFile: it cannot be read, or has more than so many bytes.
    """
    try:
        with regular(path, most).open("rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise BadFile(path, _unreadable(error)) from None
    if len(content) > most:  # it has grown
        raise BadFile(path, f"has more than {most} bytes")
    return content


def _unreadable(error: Exception) -> str:
    return f"cannot be read: {getattr(error, 'strerror', None) or error}"
