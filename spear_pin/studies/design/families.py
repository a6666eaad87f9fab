"""Families of locally optimal gaits over a range of one number, of the request or of the robot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from spear_pin.errors import BadValue, Infeasible, NoGait, UnknownName
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.model.robot import Robot
from spear_pin.model.variants import PARAMETERS, vary


@dataclass(frozen=True)
class Member:
    """One gait of a family.

    Attributes:
        value: value of the varied number.
        gait: the gait; None where none was found.
        solution: solution of the optimiser, to start from; None where none was found.
        reason: why there is no gait.
    """

    value: float
    gait: Gait | None
    solution: Solution | None
    reason: str = ""


def family(
    robot: Robot,
    request: Request,
    name: str,
    values: Sequence[float],
    start: Solution | None = None,
    on_member: Callable[[Member], object] = lambda member: None,
) -> list[Member]:
    """Finds locally optimal gaits over a range of one number, each started from the previous one.

    Args:
        robot: Q-SPEAR in the sagittal plane.
        request: request for each gait.
        name: a numeric field of `Request`, or a parameter of the robot that `vary` knows.
        values: values of the number, in an order with small steps.
        start: a solution near the first gait; None: the first search starts from initial guesses.
        on_member: called with each gait as it is found.

    Raises:
        UnknownName: there is no such field or parameter.
    """
    asked = [field.name for field in fields(request)]
    if name not in asked and name not in PARAMETERS:
        raise UnknownName("number to vary", name, [*asked, *PARAMETERS])
    members = []
    for value in values:
        if name == "knee_ratio" and request.knee_drive is not None:
            raise BadValue(
                "name", name, "a field of the request, as the request has a knee_drive; for ratios see `codesign`"
            )
        varied = robot if name in asked else vary(robot, **{name: value})
        changes: dict[str, Any] = {name: value}
        wanted = replace(request, **changes) if name in asked else request
        try:
            gait, start = search(varied, wanted, start=start)
            member = Member(value, gait, start)
        except (Infeasible, NoGait) as error:
            member = Member(value, None, None, str(error))
        members.append(member)
        on_member(member)
    return members
