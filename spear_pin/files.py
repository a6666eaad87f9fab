"""Write files whole or not at all, and JSON; read what is a file alone, and JSON that is what it seems."""

from __future__ import annotations

import json
import math
import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from spear_pin.errors import BadFile


@contextmanager
def atomic(path: str | Path) -> Iterator[Path]:
    """A temporary path beside `path`, renamed to it when the block ends well and removed otherwise.

    Raises:
        BadFile: the file cannot be written.
    """
    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        raise BadFile(target, f"cannot be written: {error.strerror or error}") from None
    except UnicodeEncodeError as error:
        raise BadFile(target, f"cannot be written: no text has {error.object[error.start : error.end]!a}") from None
    finally:
        with suppress(OSError):  # it may be gone, or its folder may be none
            temporary.unlink()


def write_text(path: str | Path, text: str) -> Path:
    """Write a text file, in UTF-8, whole or not at all; lone surrogates are written out.

    Raises:
        BadFile: the file cannot be written.
    """
    with atomic(path) as temporary:
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


def _unreadable(error: Exception) -> str:
    return f"cannot be read: {getattr(error, 'strerror', None) or error}"
