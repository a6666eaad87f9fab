"""One input that is easily read wrong: what is right, how that was found, and what comes out."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import numpy as np

import tests.cases

Find = Callable[[Path], Any]


@dataclass(frozen=True)
class Case:
    """One input.

    Attributes:
        name: of the case, unique among its kind.
        kind: what kind of input it is.
        right: numbers, or a text that has to be part of what comes out.
        found: how the right value was found, in words.
        now: what comes out, from an empty folder.
        tolerance: of numbers, absolute.
        by: finds the right numbers anew by other means, from an empty folder; None where they are found by hand.
        needs: modules that `by` needs.
    """

    name: str
    kind: str
    right: Any
    found: str
    now: Find
    tolerance: float = 1e-9
    by: Find | None = None
    needs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """What came out, and whether it is right."""

    value: Any
    right: bool


def outcome(case: Case, find: Find | None = None) -> Outcome:
    """Find a value in a folder that is empty, and hold it against the right one.

    Args:
        case: which.
        find: what finds the value; None: `case.now`.
    """
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            value = (find or case.now)(Path(folder))
        except Exception as error:  # a row of a table, whatever happens
            return Outcome(f"{type(error).__name__}: {error}".replace(folder, ""), right=False)
    return Outcome(value, _agree(value, case))


def _agree(value: Any, case: Case) -> bool:
    if isinstance(case.right, str):
        return isinstance(value, str) and case.right in value
    value, right = np.asarray(value, dtype=float), np.asarray(case.right, dtype=float)
    return value.shape == right.shape and bool(np.allclose(value, right, rtol=0.0, atol=case.tolerance, equal_nan=True))


def all_cases() -> list[Case]:
    """The cases of every module of this package."""
    modules = [
        import_module(f"tests.cases.{each.name}")
        for each in iter_modules(tests.cases.__path__)
        if each.name != "__main__"
    ]
    return [case for module in modules for case in getattr(module, "CASES", ())]
