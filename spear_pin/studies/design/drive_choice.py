"""Choice of the knee's drive: spring, gears and motor of least cost, and gaits that exceed an envelope least."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from spear_pin.errors import BadValue, Infeasible, NoGait
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.model.motor import Drive
from spear_pin.model.robot import Robot
from spear_pin.model.variants import with_knee_motor
from spear_pin.studies.design.envelopes import against, electrical_cost
from spear_pin.studies.design.operating_points import points


@dataclass(frozen=True)
class Design:
    """A choice of spring, gear ratio and motor, with the cost of bounding with it.

    Attributes:
        motor: name of the motor.
        ratio: ratio of the knee's gears.
        stiffness: stiffness of a leg's spring, in N·m/rad.
        knee_touchdown: knee angle at touchdown, by magnitude, in rad.
        cost: electrical cost of transport, see `electrical_cost`.
        heating: largest rms torque over the drive's continuous torque.
        margin: least distance from the envelope, in N·m.
        gait: the gait; None where none was found.
        reason: why there is no gait.
    """

    motor: str
    ratio: float
    stiffness: float
    knee_touchdown: float
    cost: float
    heating: float
    margin: float
    gait: Gait | None
    reason: str = ""


def codesign(
    robot: Robot,
    request: Request,
    drives: Mapping[str, Drive],
    ratios: Sequence[float],
    start: Solution | None = None,
) -> Iterator[Design]:
    """Finds the spring and touchdown angle of least cost for each motor and gear ratio, inside the motor's envelope.

    The robot gets the motor's own rotor, its mass and its ratio; if a mass is not known, a `RobotWarning` names it. A
    design is a local optimum: the better one of those found from `start` and from the design at the previous ratio.

    Args:
        robot: Q-SPEAR in the sagittal plane.
        request: the request; its objective, stiffness, touchdown angle and knee drive are replaced.
        drives: drives by name; their gearboxes' ratios are replaced.
        ratios: ratios of the knee's gears, in an order with small steps.
        start: a solution to start from; None: the search starts from initial guesses.
    """
    nothing = math.nan
    for name, base in drives.items():
        near = start
        for ratio in ratios:
            drive = replace(base, gearbox=replace(base.gearbox, ratio=ratio))
            fitted = with_knee_motor(
                robot, drive.motor, knee_ratio=ratio, knee_rotor=drive.reflected_inertia / ratio**2
            )
            wanted = replace(request, objective="electrical", stiffness=None, knee_touchdown=None, knee_drive=drive)
            try:
                gait, near = _cheapest(fitted, wanted, drive, [start] if near is start else [start, near])
            except (Infeasible, NoGait) as error:
                yield Design(name, ratio, nothing, nothing, nothing, nothing, nothing, None, str(error))
                continue
            use = against(points(gait), drive)
            yield Design(
                motor=name,
                ratio=ratio,
                stiffness=gait.system.spring.stiffness / PAIR,
                knee_touchdown=gait.system.law.knee_touchdown,
                cost=electrical_cost(gait, drive),
                heating=float(use.heating.max()),
                margin=float(use.worst.min()),
                gait=gait,
            )


def smallest_violation(
    robot: Robot,
    request: Request,
    drive: Drive,
    starts: int = 20,
    on_start: Callable[[int, float], object] = lambda n, t: None,
) -> tuple[Gait, float]:
    """Finds the gait that exceeds the knee drive's envelope least, from several initial guesses.

    Args:
        robot: Q-SPEAR in the sagittal plane, with the drive's rotor in it.
        request: the request; its objective and knee drive are replaced.
        drive: drive of each knee.
        starts: number of seeds.
        on_start: called with the seed and the violation found from it, in N·m (NaN if none).

    Returns:
        the gait, and by how much it exceeds the envelope, in N·m; zero or less: it fits.

    Raises:
        Infeasible, NoGait: no start led to a gait.
    """
    if starts < 1:
        raise BadValue("starts", starts, "at least 1")
    wanted = replace(request, objective="violation", knee_drive=drive)
    best: tuple[Gait, float] | None = None
    failure: Infeasible | NoGait | None = None
    for seed in range(starts):
        try:
            gait, _ = search(robot, wanted, seed=seed)
            excess = -float(against(points(gait), drive).worst.min())
        except (Infeasible, NoGait) as error:
            failure = error
            on_start(seed, float("nan"))
            continue
        on_start(seed, excess)
        if best is None or excess < best[1]:
            best = gait, excess
    if best is None:
        assert failure is not None
        raise failure
    return best


def _cheapest(robot: Robot, request: Request, drive: Drive, starts: Sequence[Solution | None]) -> tuple[Gait, Solution]:
    """Returns, of the gaits found from each start, the one of least electrical cost; else the last reason."""
    found: list[tuple[Gait, Solution]] = []
    failure: Infeasible | NoGait | None = None
    for start in starts:
        try:
            found.append(search(robot, request, start=start))
        except (Infeasible, NoGait) as error:
            failure = error
    if not found:
        assert failure is not None
        raise failure
    return min(found, key=lambda each: electrical_cost(each[0], drive))
