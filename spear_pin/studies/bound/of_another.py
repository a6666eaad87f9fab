"""A first bound of a user's quadruped: as fast as Q-SPEAR's for its size, or slower."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from spear_pin.errors import Infeasible, NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.settings import refuse_special
from spear_pin.studies.joint_limits import list_exceeded

SLOWER = (1.0, 0.9, 0.8, 0.65)  # of the speed that is scaled from Q-SPEAR's, in turn: joints may not turn as fast


@typed
def bound_of(
    robot: Robot,
    speed: float | None = None,
    *,
    on_attempt: Callable[[float, str], object] = lambda speed, why: None,
    **wishes: object,
) -> Gait:
    """Finds a bounding gait of least effort within the limits of the robot's joints.

    Args:
        robot: a robot in the plane, as `spear_pin.sagittal` cuts it, with its own springs if a TOML file gives them.
        speed: mean forward speed, in m/s; None: that of `Request.scaled`, or the first slower one with a gait within
            the limits of the joints; if there is none, the slowest speed with a gait.
        on_attempt: called with a speed that gives way to a slower one, and the reason.
        **wishes: other fields of a `Request`.

    Raises:
        Infeasible, NoGait: no speed has one; says why not at the last that was tried.
        BadValue, UnknownName: a wish is not valid.
        MissingExtra: CasADi is not installed.
    """
    request = Request.scaled(robot, **(springs_of(robot) | wishes))
    speeds = [speed] if speed is not None else [share * request.speed for share in SLOWER]
    found = None
    for wanted in speeds:
        last = wanted == speeds[-1]
        try:
            gait = search(robot, replace(request, speed=wanted))[0]
        except (Infeasible, NoGait) as error:
            if last and found is None:
                raise
            why = str(error)
        else:
            over = list_exceeded(gait) if request.within_limits else ""
            if not over:
                return gait
            found, why = gait, over
        if not last:
            on_attempt(wanted, why)
    assert found is not None
    return found


def springs_of(robot: Robot) -> dict[str, object]:
    """Returns what the robot's own file says about its springs, where both pairs have the same."""
    springs = robot.settings.springs
    refuse_special(robot, "a search for bounds takes")
    own, *others = springs.values() if len(springs) == 2 else [None]
    if own is None or others != [own]:
        return {}
    return {name: getattr(own, name) for name in ("stiffness", "hardening", "preload", "table", "rest")}
