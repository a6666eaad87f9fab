"""A statement of the source, and the result of checking it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.studies.audit.statements.assumptions import ASSUMPTIONS, Assumption, Other
from spear_pin.studies.audit.statements.criteria import Criterion, Value
from spear_pin.studies.audit.statements.formula import Formula

Verdict = Literal["agrees", "differs", "by construction", "cannot be known", "failed"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
RULES: dict[Verdict, str] = {
    "agrees": "The numbers found meet the criterion that stands beside them; where they rest on an assumption, with "
    "each of its alternatives, too.",
    "differs": "They do not, with none of the alternatives.",
    "by construction": "They meet it, and could not do otherwise: the model, the law, the robot's file or the choice "
    "of a motor was made from the very statement. That is no evidence for it.",
    "cannot be known": "It rests on something that the source does not print and that one of ours stands in for, its "
    "records, its motors, its gaits; or the criterion is met with some alternatives and not with others; or the "
    "source gives no measure.",
    "failed": "Its numbers could not be made, or what holds by construction does not.",
}
Study: TypeAlias = Callable[..., Any]


@dataclass(frozen=True)
class Statement:
    """A statement of the source, with the way to check it.

    Attributes:
        id: name in the code.
        place: where the source states it.
        says: the statement, in words of our own.
        finds: what the numbers of `study` mean.
        study: returns the numbers, with what is assumed by keyword, such as a `Formula`; None where nothing can.
        unit: unit of these numbers.
        printed: the source's number; None where it has none.
        criterion: criterion for the numbers; None where the source gives nothing to compare with.
        unknown: why the statement cannot be checked, if so.
        built: why the numbers could not fail the criterion, if so: the statement then holds by construction.
        remark: other remarks for a reader.
        assumes: ids of the assumptions that the numbers use.
        exhibit: id of the figure or table that shows it, if one does.
    """

    id: str
    place: str
    says: str
    finds: str = ""
    study: Study | None = None
    unit: str = ""
    printed: Value | None = None
    criterion: Criterion | None = None
    unknown: str = ""
    built: str = ""
    remark: str = ""
    assumes: tuple[str, ...] = ()
    exhibit: str = ""

    @property
    def command(self) -> str:
        """Shell line that computes the numbers again; empty where there is no formula."""
        return self.study.command if isinstance(self.study, Formula) else ""

    @property
    def assumptions(self) -> tuple[Assumption, ...]:
        """Assumptions that the numbers use."""
        return tuple(assumption for assumption in ASSUMPTIONS if assumption.id in self.assumes)

    @property
    def others(self) -> tuple[Other, ...]:
        """Alternatives with which the numbers are computed, too; none where there is nothing to judge."""
        if self.unknown or self.built or self.criterion is None:
            return ()
        return tuple(other for assumption in self.assumptions for other in assumption.others)


@dataclass(frozen=True)
class Case:
    """Numbers of a statement with another assumption.

    Attributes:
        label: the other assumption.
        value: the numbers.
        holds: whether they meet the criterion.
    """

    label: str
    value: Value
    holds: bool


@dataclass(frozen=True)
class Finding:
    """Result of checking a statement.

    Attributes:
        id: id of the statement.
        value: the numbers; None where there are none.
        verdict: verdict by `RULES`.
        reason: why it failed, cannot be checked or holds by construction; else empty.
        cases: the numbers with other assumptions.
    """

    id: str
    value: Value | None
    verdict: Verdict
    reason: str = ""
    cases: tuple[Case, ...] = ()

    @classmethod
    def of(cls, data: dict[str, Any]) -> Finding:
        """Makes a finding from the data of `dataclasses.asdict` after JSON, which has lists for tuples."""
        cases = tuple(Case(**case | {"value": _value(case["value"])}) for case in data["cases"])
        return cls(**data | {"value": _value(data["value"]), "cases": cases})


def check(statement: Statement) -> Finding:
    """Computes the numbers of a statement and judges it by `RULES`; an error becomes part of the finding."""
    value: Value | None = None
    others: list[tuple[Other, Value]] = []
    if statement.study is not None:
        try:
            value = _numbers(statement.study)
            others = [(other, _numbers(partial(statement.study, **dict([other.given])))) for other in statement.others]
        except Exception as error:  # one row of a report must not take the others with it
            return Finding(statement.id, None, "failed", f"{type(error).__name__}: {error}")
    if statement.unknown or statement.criterion is None or value is None:
        return Finding(statement.id, value, "cannot be known", statement.unknown)
    met = statement.criterion.holds(value)
    if statement.built:
        if met:
            return Finding(statement.id, value, "by construction", statement.built)
        return Finding(statement.id, value, "failed", f"not so, though by construction: {statement.built}")
    if standing_in := [assumption.what for assumption in statement.assumptions if assumption.stands_in]:
        return Finding(statement.id, value, "cannot be known", f"Not in the source: {'; '.join(standing_in)}.")
    cases = tuple(Case(other.label, found, statement.criterion.holds(found)) for other, found in others)
    if {case.holds for case in cases} <= {met}:
        return Finding(statement.id, value, "agrees" if met else "differs", cases=cases)
    return Finding(
        statement.id, value, "cannot be known", "It depends on what is assumed: the criterion is met by some.", cases
    )


def _value(data: Any) -> Any:
    return tuple(data) if isinstance(data, list) else data


def _numbers(study: Callable[..., Any]) -> Value:
    """Returns the numbers of a study as plain finite ones, NumPy's too."""
    value = study()
    numbers = tuple(map(float, value)) if np.ndim(value) else float(value)
    if not np.isfinite(numbers).all():
        raise BadValue("what is found", numbers, "finite")
    return numbers


def command_of(function: Callable[..., object]) -> str:
    """Returns the shell line that calls a function of a module, or a partial of one, and prints its result."""
    whole = function if isinstance(function, partial) else partial(function)
    words = [*map(repr, whole.args), *(f"{name}={value!r}" for name, value in whole.keywords.items())]
    name = whole.func.__name__
    call = f"from {whole.func.__module__} import {name}; print({name}({', '.join(words)}))"
    return f'python -c "{call}"'
