"""Functions that are not of this package: what a mistake in one of them is, and how it is told.

A mistake comes out as `BadFunction`, with the exception as its cause. Numerical failure is none: where a number
overflows or a matrix is singular there is no value, and the run ends with a reason.
"""

from __future__ import annotations

import inspect
import sysconfig
from collections.abc import Callable, Mapping, Sequence, Set
from functools import partial
from numbers import Real
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from spear_pin.errors import BadFunction, NotSymbolic, brief

PACKAGE = __name__.partition(".")[0]
HERE = str(Path(__file__).parents[1])
INSTALLED = tuple({sysconfig.get_path(kind) for kind in ("stdlib", "purelib", "platlib")})
NUMERICAL = (OverflowError, FloatingPointError, np.linalg.LinAlgError)
FOR_SYMBOLS = TypeError, ValueError, AttributeError  # what functions raise for symbols that are right with numbers
OUTSIDE = "math domain error", "expected a "  # how what `math` raises begins where a function has no value
FAR = 1e9  # of a state: that a function has no value beyond it is no mistake


def is_own(function: Any) -> bool:
    """Whether a function, or the class of an object, is not of this package."""
    return str(getattr(function, "__module__", "")).partition(".")[0] != PACKAGE


def is_numerical(error: Exception) -> bool:
    """Whether an exception says that a number is too large, or a matrix singular."""
    return isinstance(error, NUMERICAL)


def has_no_value(error: BaseException | None) -> bool:
    """Whether an exception says that a function of `math` has no value there."""
    return isinstance(error, ValueError) and str(error).startswith(OUTSIDE)


def refuse_in_law(name: str) -> None:
    """Refuse a law's question for a force that its own torques cause.

    Raises:
        TypeError: always.
    """
    raise TypeError(f"dyn.{name}() follows from the law's torques: only guards may ask; see dyn.normal_force(toe, u)")


def mistake(what: str, function: Any, problem: Exception | str) -> BadFunction:
    """What to raise for a mistake.

    Args:
        what: the function is, such as "law of domain 'stance'".
        function: the function, or an object that is called.
        problem: what it raises, or what is wrong with its answer.
    """
    while isinstance(function, partial):
        function = function.func
    own = inspect.unwrap(getattr(function, "__func__", function))
    if not hasattr(own, "__code__") and not isinstance(own, type):  # an object that is called
        own = inspect.unwrap(type(own).__call__) if callable(own) else own
    code = getattr(own, "__code__", None)
    file, line = ("", 0) if code is None else (code.co_filename, code.co_firstlineno)
    if isinstance(problem, Exception):
        file, line = _raised_at(problem.__traceback__) or (file, line)
        problem = f"{type(problem).__name__}: {problem}" if str(problem) else type(problem).__name__
    name = getattr(function, "__qualname__", type(function).__name__)
    return BadFunction(what, name, file, line, problem)


def not_symbolic(what: str, function: Any, error: Exception) -> NotSymbolic:
    """What to raise where a function that is right with numbers does not take symbols, or arrays of lanes."""
    place = mistake(what, function, error)
    hint = "elementary functions come from ops, and nothing branches on a value"
    where = f" ({place.file}:{place.line})" if place.file else ""
    return NotSymbolic(f"{what} does not take symbols ({error}): {hint}{where}")


def torques(what: str, function: Any, answer: Any, joints: Sequence[str]) -> list[Any]:
    """The answer of a law as torques, of whatever scalars.

    Raises:
        BadFunction: it is not one scalar for each joint.
    """
    expected = f"a torque for each of {', '.join(joints)}"
    try:
        found = [] if isinstance(answer, (str, bytes, Mapping, Set)) else list(answer)
    except TypeError:
        found = []
    if len(found) != len(joints):
        raise mistake(what, function, f"it gives {brief(answer)}; expected {expected}")
    return [scalar(what, function, torque, f"torque of {joint!r}") for joint, torque in zip(joints, found, strict=True)]


def scalar(what: str, function: Any, answer: Any, of: str = "") -> Any:
    """An answer as a scalar: a float of a number, anything else that may be one as it is.

    Raises:
        BadFunction: it is none.
    """
    if type(answer) is float:
        return answer
    if isinstance(answer, (Real, np.bool_)):
        return float(answer)
    if not _is_scalar(answer):
        named = f" as the {of}" if of else ""
        raise mistake(what, function, f"it gives {brief(answer)}{named}; expected a number")
    return answer


def _is_scalar(answer: Any) -> bool:
    """Whether an answer may be a number, of whatever kind."""
    return answer is not None and not isinstance(answer, (complex, str, bytes, Sequence, Mapping, Set))


def number(what: str, function: Any, answer: Any, of: str = "") -> float:
    """An answer as a number, which need not be finite.

    Raises:
        BadFunction: it is none.
    """
    found = scalar(what, function, answer, of)
    if isinstance(found, np.ndarray) and found.ndim == 0 and found.dtype.kind in "fiub":
        return float(found)
    if type(found) is not float:
        named = f" as the {of}" if of else ""
        raise mistake(what, function, f"it gives {brief(answer)}{named}; expected a number")
    return found


def held(what: str, function: Any, answer: Any) -> Mapping[str, Any]:
    """The answer of a latch as what is held.

    Raises:
        BadFunction: it is no mapping from names, or a number in it is none.
    """
    if not isinstance(answer, Mapping) or not all(isinstance(name, str) for name in answer):
        expected = 'what is held by name, such as {"rest": q[2]}'
        raise mistake(what, function, f"it gives {brief(answer)}; expected {expected}")
    for name, value in answer.items():
        for each in _flat(value):
            if isinstance(each, np.ndarray) or each != each or not _is_scalar(each):
                expected = "a number, or a tuple of them"
                raise mistake(what, function, f"it holds {brief(value)} as {name!r}; expected {expected}")
    return answer


def _flat(value: Any) -> list[Any]:
    """The entries of tuples in tuples, or what is none alone."""
    return [each for part in value for each in _flat(part)] if isinstance(value, tuple) else [value]


def asked(what: str, function: Any, call: Callable[[], Any]) -> Any:
    """Answer of a function to numbers.

    Args:
        what: it is.
        function: the function.
        call: calls it.

    Raises:
        BadFunction: there is a mistake in it; `has_no_value` of its cause says that it may have a value elsewhere.
        ArithmeticError: there is no value, for numbers are too large.
        numpy.linalg.LinAlgError: there is no value, for a matrix is singular.
    """
    try:
        return call()
    except BadFunction:
        raise
    except Exception as error:
        if is_numerical(error):
            raise
        raise mistake(what, function, error) from error


def _raised_at(trace: TracebackType | None) -> tuple[str, int] | None:
    """File and line of the last call in a traceback that is not in this package, nor in a library."""
    found = None
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if not file.startswith((HERE, *INSTALLED)):
            found = file, trace.tb_lineno
        trace = trace.tb_next
    return found
