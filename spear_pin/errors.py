"""What the package raises: one base class, each kind carrying the offending value and the valid ones."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from reprlib import Repr

_BRIEF = Repr()
_BRIEF.maxother, _BRIEF.maxstring, _BRIEF.maxlist, _BRIEF.maxtuple = 80, 120, 8, 8


class SpearError(Exception):
    """Base class of every error this package raises on purpose; its text is one line."""

    def __init__(self, text: str) -> None:
        super().__init__(" ".join(text.split()))

    def __reduce__(self) -> tuple[object, ...]:
        return _remake, (type(self), self.args, self.__dict__)


class UnknownName(SpearError):
    """A name that is not among the valid ones."""

    def __init__(self, kind: str, value: object, valid: Iterable[str]) -> None:
        self.kind, self.value, self.valid = kind, value, tuple(valid)
        choices = ", ".join(self.valid) if self.valid else "none"
        super().__init__(f"unknown {kind} {value!r}; valid: {choices}")


class BadValue(SpearError):
    """A value outside what is valid, with the name of the argument or field it was given for."""

    def __init__(self, name: str, value: object, expected: str) -> None:
        self.name, self.value, self.expected = name, value, expected
        super().__init__(f"{name} is {_BRIEF.repr(value)}; expected {expected}")


class BadFile(SpearError):
    """A file that cannot be read as what it should be: a URDF, a gait, a trajectory."""

    def __init__(self, path: str | Path, problem: str, line: int | None = None) -> None:
        self.path, self.problem, self.line = str(path), problem, line
        where = self.path if line is None else f"{self.path}:{line}"
        super().__init__(f"{where}: {problem}")


class NoGait(SpearError):
    """No periodic gait was found; carries the reason and the best residual reached."""

    def __init__(self, reason: str, residual: float) -> None:
        self.reason, self.residual = reason, residual
        super().__init__(f"no gait found: {reason} (best residual {residual:.3g})")


def require(name: str, value: object, valid: object, expected: str) -> None:
    """Raise `BadValue` unless `valid`; a comparison of symbols is neither true nor false and passes."""
    if valid is False or (isinstance(value, float) and not math.isfinite(value)):
        raise BadValue(name, value, expected)


def _remake(kind: type[SpearError], args: tuple[object, ...], attributes: dict[str, object]) -> SpearError:
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(attributes)
    return error
