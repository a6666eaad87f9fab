"""Leads a solution along a way: steps double while there is a solution, and halve where none is found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from spear_pin.errors import NoGait

T = TypeVar("T")


@dataclass(frozen=True)
class Way(Generic[T]):
    """How far a way led.

    Attributes:
        done: share of the way.
        end: the solution there.
        failure: why it leads no farther; None at its end.
    """

    done: float
    end: T
    failure: NoGait | None = None


def lead_along(
    solve: Callable[[float, T], T],
    begun: T,
    *,
    first: float,
    shortest: float,
    longest: float = 1.0,
    enough: Callable[[], bool] = lambda: False,
) -> Way[T]:
    """Leads a solution along a way.

    Args:
        solve: finds the solution at a share of the way from the last one, or raises `NoGait`.
        begun: the solution at the beginning.
        first: first step, as a share of the way.
        shortest: the way ends where a shorter step would be needed.
        longest: longest step.
        enough: tells after a failure whether to give up.
    """
    way, step, growth = Way(0.0, begun), min(first, longest), 2.0
    while way.done < 1.0:
        reach = min(1.0, way.done + step)
        try:
            way, step, growth = Way(reach, solve(reach, way.end)), min(growth * step, longest), 2.0
        except NoGait as failure:
            step, growth = 0.5 * (reach - way.done), 1.0
            if step < shortest or enough():
                return Way(way.done, way.end, failure)
    return way
