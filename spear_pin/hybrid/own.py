"""User functions, which are not of this package: recognises mistakes in them, and reports them.

A mistake is raised as `BadFunction`, with the exception as its cause. Numerical failure is no mistake: if a number
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
FOR_SYMBOLS = TypeError, ValueError, AttributeError  # raised for symbols by functions that are right with numbers
OUTSIDE = "math domain error", "expected a "  # beginnings of the errors of `math` where a function has no value
FAR = 1e9  # size of a state beyond which it is no mistake that a function has no value


def is_own(function: Any) -> bool:
    """Tells whether a function, or the class of an object, is not of this package."""
    return str(getattr(function, "__module__", "")).partition(".")[0] != PACKAGE


def is_numerical(error: Exception) -> bool:
    """Tells whether an exception means that a number is too large, or a matrix singular."""
    return isinstance(error, NUMERICAL)


def has_no_value(error: BaseException | None) -> bool:
    """Tells whether an exception means that a function of `math` has no value there."""
    return isinstance(error, ValueError) and str(error).startswith(OUTSIDE)


def refuse_in_law(name: str) -> None:
    """Refuses a law's request for a force that depends on its own torques.

    Raises:
        TypeError: always.
    """
    raise TypeError(f"dyn.{name}() follows from the law's torques: only guards may ask; see dyn.normal_force(toe, u)")


def mistake(what: str, function: Any, problem: Exception | str) -> BadFunction:
    """Returns the exception to raise for a mistake.

    Args:
        what: description of the function, such as "law of domain 'stance'".
        function: the function, or an object that is called.
        problem: the exception that it raises, or the error in its answer.
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
    """Returns the exception to raise if a function that takes numbers does not take symbols, or arrays of lanes."""
    place = mistake(what, function, error)
    hint = "take elementary functions from ops, such as ops.sin, and let no `if` depend on a value"
    where = f" ({place.file}:{place.line})" if place.file else ""
    return NotSymbolic(f"{what} does not take symbols ({error}): {hint}{where}")


def torques(what: str, function: Any, answer: Any, joints: Sequence[str]) -> list[Any]:
    """Returns the answer of a law as torques, with scalars of any kind.

    Raises:
        BadFunction: the answer is not one scalar for each joint.
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
    """Returns an answer as a scalar: a float for a number, any other possible scalar unchanged.

    Raises:
        BadFunction: the answer is no scalar.
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
    """Tells whether an answer may be a scalar of any kind."""
    return answer is not None and not isinstance(answer, (complex, str, bytes, Sequence, Mapping, Set))


def number(what: str, function: Any, answer: Any) -> float:
    """Returns an answer as a number, which need not be finite.

    Raises:
        BadFunction: the answer is no number.
    """
    found = scalar(what, function, answer)
    if isinstance(found, np.ndarray) and found.ndim == 0 and found.dtype.kind in "fiub":
        return float(found)
    if type(found) is not float:
        raise mistake(what, function, f"it gives {brief(answer)}; expected a number")
    return found


def read_latched(what: str, function: Any, answer: Any) -> Mapping[str, Any]:
    """Returns the answer of a latch as held values.

    Raises:
        BadFunction: the answer is no mapping from names, or a value in it is no number.
    """
    if not isinstance(answer, Mapping) or not all(isinstance(name, str) for name in answer):
        expected = 'latched values by name, such as {"rest": q[2]}'
        raise mistake(what, function, f"it gives {brief(answer)}; expected {expected}")
    for name, value in answer.items():
        for each in _flat(value):
            if isinstance(each, np.ndarray) or each != each or not _is_scalar(each):
                expected = "a number, or a tuple of them"
                raise mistake(what, function, f"it holds {brief(value)} as {name!r}; expected {expected}")
    return answer


def state(what: str, function: Any, answer: Any, nq: int, nv: int) -> tuple[list[float], list[float]]:
    """Returns the answer of a jump as a state (q, v), (nq,) and (nv,).

    Raises:
        BadFunction: the answer is no such state.
    """
    try:
        q, v = map(list, answer)
    except (TypeError, ValueError):
        q, v = [], []
    if (len(q), len(v)) != (nq, nv):
        raise mistake(what, function, f"it gives {brief(answer)}; expected (q, v), of {nq} and {nv} numbers")
    return [number(what, function, each) for each in q], [number(what, function, each) for each in v]


def _flat(value: Any) -> list[Any]:
    """Returns the entries of nested tuples, or a list of the value itself if it is no tuple."""
    return [each for part in value for each in _flat(part)] if isinstance(value, tuple) else [value]


def call_function(what: str, function: Any, call: Callable[[], Any]) -> Any:
    """Calls a function with numbers, and returns its answer.

    Args:
        what: description of the function.
        function: the function.
        call: calls the function.

    Raises:
        BadFunction: there is a mistake in the function; `has_no_value` of its cause tells whether it may have a value
            elsewhere.
        ArithmeticError: there is no value, as numbers are too large.
        numpy.linalg.LinAlgError: there is no value, as a matrix is singular.
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
    """Returns file and line of the last call in a traceback that is neither in this package nor in a library."""
    found = None
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if not file.startswith((HERE, *INSTALLED)):
            found = file, trace.tb_lineno
        trace = trace.tb_next
    return found
