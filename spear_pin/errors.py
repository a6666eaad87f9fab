"""Errors that the package raises, each kind carrying the offending value and the valid ones; and its warning."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from numbers import Real
from pathlib import Path
from reprlib import Repr
from typing import Any

from spear_pin.printable import printable

_BRIEF = Repr()
_BRIEF.maxother, _BRIEF.maxstring, _BRIEF.maxlist, _BRIEF.maxtuple = 80, 120, 8, 8
LONGEST = 2000  # characters of an error's text; what it names may be of any length
ALL = "help"  # a name in whose place all valid ones are listed
NEAREST, LISTED = 3, 160  # names that are shown where all take more than so many characters


class SpearError(Exception):
    """Base class of every error this package raises on purpose; its text is one line.

    Example:
        >>> from spear_pin import SpearError, load
        >>> try:
        ...     load("spear_iii")
        ... except SpearError as error:
        ...     print(error)
        unknown robot 'spear_iii'; ...
    """

    def __init__(self, text: str, most: int = LONGEST) -> None:
        super().__init__(one_line(text, most))

    def __reduce__(self) -> tuple[object, ...]:
        return _remake, (type(self), self.args, self.__dict__)


class RobotWarning(UserWarning):
    """A robot is not quite what its file says, or perhaps not what was meant; the text is one line.

    `spear_pin.load` warns of what it leaves out or mends, of a trunk that stays fixed and of a robot without motors.
    `warnings.simplefilter("ignore", RobotWarning)` silences it.

    Example:
        >>> import warnings
        >>> from spear_pin import RobotWarning, load
        >>> with warnings.catch_warnings():
        ...     warnings.simplefilter("ignore", RobotWarning)
        ...     robot = load("spear_ii")
    """

    def __init__(self, text: str) -> None:
        super().__init__(one_line(text))


class UnknownName(SpearError):
    """A name that is not among the valid ones; says them, of many the nearest three. For `help` it lists all.

    Args:
        kind: what it is a name of.
        value: what was given.
        valid: the valid names.
        also: what else may be given, in words.
    """

    def __init__(self, kind: str, value: object, valid: Iterable[str], also: str = "") -> None:
        self.kind, self.value, self.valid, self.also = kind, value, tuple(valid), also
        choices = ", ".join(self.valid) if self.valid else "none"
        other = f", or {also}" if also else ""
        if value == ALL:
            super().__init__(f"each valid {kind}: {choices}{other}", most=len(choices) + LONGEST)
        elif len(choices) <= LISTED:
            super().__init__(f"unknown {kind} {brief(value)}; valid: {choices}{other}")
        else:
            some = f"nearest of {len(self.valid)}: {', '.join(nearest(str(value), self.valid))}{other}"
            super().__init__(f"unknown {kind} {brief(value)}; {some}; {ALL!r} in its place lists all")


class BadValue(SpearError):
    """A value outside what is valid, with the name of the argument or field it was given for."""

    def __init__(self, name: str, value: object, expected: str) -> None:
        self.name, self.value, self.expected = name, value, expected
        super().__init__(f"{name} is {brief(value)}; expected {expected}")


class NotSymbolic(SpearError, TypeError):
    """A law or a guard that symbols cannot be put into, so that it cannot be compiled for lanes."""


class BadFunction(SpearError):
    """A mistake in a law, guard, latch, spring, ground or measure of one's own; what it raised is the cause."""

    def __init__(self, what: str, function: str, file: str, line: int, problem: str) -> None:
        self.what, self.function, self.file, self.line, self.problem = what, function, file, line, problem
        where = f", {file}:{line}" if file else ""
        super().__init__(f"{what} ({function}{where}): {problem}")


class BadFile(SpearError):
    """A file that cannot be read as what it should be: a URDF, a gait, a trajectory."""

    def __init__(self, path: str | Path, problem: str, line: int | None = None) -> None:
        self.path, self.problem, self.line = str(path), problem, line
        where = self.path if self.path.strip() else repr(self.path)
        where = where if line is None else f"{where}:{line}"
        super().__init__(f"{where}: {problem}")


class NoGait(SpearError):
    """No periodic gait was found; carries the reason, the best residual reached, the likely cause and what to try."""

    def __init__(self, reason: str, residual: float, cause: str = "", remedy: str = "") -> None:
        self.reason, self.residual, self.cause, self.remedy = reason, residual, cause, remedy
        why = f"; {cause}" if cause else ""
        super().__init__(f"no gait found: {reason} (best residual {residual:.3g}){why}{describe_remedy(remedy)}")


class Infeasible(SpearError):
    """A request cannot be met, as far as a local search tells; names what stands in the way."""

    def __init__(self, constraint: str, violation: float, unit: str, remedy: str = "") -> None:
        self.constraint, self.violation, self.unit, self.remedy = constraint, violation, unit, remedy
        super().__init__(
            f"no gait was found: with every wish relaxed, {constraint} is still missed by {violation:.3g} {unit}"
            f" (a local search: evidence, no proof){describe_remedy(remedy)}"
        )


class MissingExtra(SpearError):
    """An optional dependency is not installed; nobody holds this package's name on the index, so it says the folder."""

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        self.package, self.extra = package, extra
        super().__init__(
            f"{purpose} needs {package}, which is not installed: pip install '.[{extra}]' in the folder of this package"
        )


def import_extra(module: str, extra: str, purpose: str) -> Any:
    """Returns a module of an optional dependency.

    Args:
        module: name of the module.
        extra: the extra of this package that installs it.
        purpose: what needs it, in words.

    Raises:
        MissingExtra: it, or a package that it needs, is not installed, or does not fit the others.
    """
    try:
        return import_module(module)
    except ImportError as error:
        missing = (error.name if isinstance(error, ModuleNotFoundError) else None) or module
        package = missing.partition(".")[0].strip("_").replace("_", "-")
        raise MissingExtra(package, extra, purpose) from error


class MissingProgram(SpearError):
    """A program that is no Python package is not installed."""

    def __init__(self, program: str, purpose: str, package: str) -> None:
        self.program, self.package = program, package
        super().__init__(
            f"{purpose} need {program}, which is not installed (Debian, Ubuntu: apt-get install {package};"
            f" macOS: brew install {package})"
        )


def describe_remedy(remedy: str) -> str:
    """What an error says of a remedy, if there is one."""
    return f"; try {remedy}" if remedy else ""


def brief(value: object) -> str:
    """A value as errors show it, in some hundred characters at most."""
    return _BRIEF.repr(value)


def list_names(names: Sequence[str], most: int = 4) -> str:
    """Names as errors and warnings list them, the first few and how many there are beside."""
    rest = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + rest


def nearest(word: str, names: Iterable[str]) -> list[str]:
    """The few names that are most like a word, the nearest first; small and capital letters are alike."""
    given = word[:LISTED].lower()

    def likeness(name: str) -> float:
        return difflib.SequenceMatcher(None, given, name[:LISTED].lower()).ratio()

    return sorted(dict.fromkeys(names), key=likeness, reverse=True)[:NEAREST]


def one_line(text: str, most: int = LONGEST) -> str:
    """A text as errors and warnings have it: in one line, without its middle if it is long, fit for any terminal."""
    return shortened(printable(" ".join(text.split())), most)


def shortened(text: str, most: int = LONGEST) -> str:
    """A text without its middle where it is too long for an error."""
    half = most // 2
    return text if len(text) <= most else f"{text[:half]} ... {text[-half:]}"


def require(name: str, value: Any, valid: Callable[[Any], Any], expected: str) -> None:
    """Raise `BadValue` unless a number is finite and valid; symbols pass.

    Args:
        name: what the value was given for.
        value: the value.
        valid: tells whether it is valid.
        expected: what is valid, in words.
    """
    if isinstance(value, bool) or getattr(value, "shape", None):
        raise BadValue(name, value, expected)
    try:
        answer = valid(value)
    except TypeError:
        raise BadValue(name, value, expected) from None
    if isinstance(value, Real) and not (math.isfinite(value) and answer):
        raise BadValue(name, value, expected)


def _remake(kind: type[SpearError], args: tuple[object, ...], attributes: dict[str, object]) -> SpearError:
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(attributes)
    return error
