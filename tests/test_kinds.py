"""Arguments of the wrong kind, refused by their annotations."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from spear_pin import Spring, find_gait, hopping, load
from spear_pin.errors import BadValue
from spear_pin.kinds import typed

if TYPE_CHECKING:
    from nowhere import Elsewhere


@typed
@dataclass(frozen=True)
class Part:
    number: float = 1.0
    count: int = 1
    flag: bool = False


@typed
def function(
    name: str = "a",
    path: str | Path = "a",
    names: Sequence[str] = (),
    items: Iterable[str] | None = None,
    numbers: Mapping[str, float] | None = None,
    array: ArrayLike = 1.0,
    pair: tuple[NDArray[np.float64], NDArray[np.float64]] = (np.ones(1), np.ones(1)),
    rows: tuple[tuple[float, ...], ...] = (),
    part: Part | None = None,
    call: Callable[[], object] = lambda: None,
    other: Elsewhere | None = None,
    anything: object = None,
) -> str:
    """Documented."""
    return "done"


@typed
def quotient(dividend: float, divisor: float | None = None) -> float:
    if divisor == 0:
        raise BadValue("divisor", divisor, "a number other than 0")
    return dividend / (divisor or 1)


NUMBERS = {
    "number": (1, 2.0, np.float64(3.0), sp.Symbol("x"), float("nan")),
    "count": (1, 2.0, np.int64(3)),
    "flag": (True, np.True_),
}
NO_NUMBERS = {
    "number": ("1", None, True, np.True_, Counter(), 1j, [1.0], np.ones(2), {}),
    "count": (1.5, "1", None, True, float("inf"), float("nan")),
    "flag": (1, "no", None),
}
RIGHT = {
    "name": ("", "b"),
    "path": ("b", Path("b")),
    "names": (["a", "b"], ("a",), {"a": 1}.keys()),
    "items": (None, ["a"], iter(["a"])),
    "numbers": (None, {}, {"a": 1}),
    "array": ([1, 2], [[1.0]], np.ones(3), (), []),
    "pair": ([[1.0], [2.0]], np.ones((2, 3))),
    "rows": (((1.0,), (2, 3)), [[1.0]], np.ones((2, 2))),
    "part": (None, Part()),
    "call": (print, Part),
    "other": (5,),
    "anything": (5, "x"),
}
WRONG = {
    "name": (5, None, b"a"),
    "path": (5, None, b"a"),
    "names": (5, None, "ab", b"ab", {"a": 1}),
    "items": (5, b"a"),
    "numbers": (5, [1], {"a": "b"}),
    "array": ("x", None, ["a"], [[1], [2, 3]], {}),
    "pair": (5, "ab", (1,), (1, 2, 3)),
    "rows": (5, (1.0, 2.0), (("a",),)),
    "part": (5, Part),
    "call": (5, "print"),
}


def cases(values):
    return [
        pytest.param(name, value, id=f"{name}-{i}") for name, each in values.items() for i, value in enumerate(each)
    ]


@pytest.mark.parametrize(("name", "value"), cases(RIGHT))
def test_what_fits(name, value):
    assert function(**{name: value}) == "done"


@pytest.mark.parametrize(("name", "value"), cases(WRONG))
def test_what_does_not(name, value):
    with pytest.raises(BadValue, match=rf"^{name} is .*; expected "):
        function(**{name: value})


@pytest.mark.parametrize(("name", "value"), cases(NUMBERS))
def test_fields_that_fit(name, value):
    assert getattr(Part(**{name: value}), name) is value


@pytest.mark.parametrize(("name", "value"), cases(NO_NUMBERS))
def test_fields_that_do_not(name, value):
    with pytest.raises(BadValue, match=rf"^Part\.{name} is "):
        Part(**{name: value})


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ((1.0, 0), "divisor is 0; expected a number other than 0"),
        ((1.0, "2"), "divisor is '2'; expected a number or None"),
        (([1.0],), "dividend is [1.0]; expected a number"),
    ],
)
def test_a_function_says_first_which_numbers_it_takes(given, text):
    with pytest.raises(BadValue) as caught:
        quotient(*given)
    assert str(caught.value) == text


def test_nothing_else_changes():
    assert function.__name__ == "function" and function.__doc__ == "Documented."
    assert pickle.loads(pickle.dumps(function)) is function and pickle.loads(pickle.dumps(Part(2.0))) == Part(2.0)
    with pytest.raises(TypeError, match="unexpected keyword"):
        function(nothing=1)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: hopping(None), "robot is None; expected a Robot"),
        (lambda: hopping(load("spear_ii"), 0), "law is 0; expected a HoppingLaw or None"),
        (lambda: find_gait(5), "system is 5; expected a HybridSystem"),
        (lambda: load("spear_ii", toes=5), "toes is 5; expected names or None"),
        (lambda: Spring(unilateral="no"), "Spring.unilateral is 'no'; expected True or False"),
    ],
)
def test_what_users_see(call, text):
    with pytest.raises(BadValue) as caught:
        call()
    assert str(caught.value) == text
