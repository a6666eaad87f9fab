"""Named measures of a cycle, with their derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.sensitivity.signals import Pieces, integral, largest_ratio, peak, positive, where_it_falls
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.tangent.derivative import Derivative, Stretch
from spear_pin.hybrid.tangent.heights import dual_heights

Array = NDArray[np.float64]
CLEARANCE = "clearance_"
PRESSED = 0.02  # of a robot's weight: friction counts under forces above this
LEAST_STRIDE = 1e-3  # m: over a shorter one nothing is transported


@dataclass(frozen=True)
class Measure:
    """A measure of a cycle.

    Attributes:
        value: in its unit.
        derivative: along each direction, (c,).
        unit: the unit.
    """

    value: float
    derivative: Array
    unit: str


def measures(cycle: Derivative, start: Array, weight: Measure) -> dict[str, Measure]:
    """All named measures of a cycle.

    Durations of phases and the period; state at events that are observed, such as the height at the apex; where the
    robot moves on, its stride and its speed; work that the motors do on the joints on balance and where they drive, and
    of what moves on the cost of transport by it; of each joint the root mean square and the peak of its motor's torque;
    of each toe the peak of the normal force, the friction it uses, |F_x| / F_z, and its clearance: the greatest height
    above the ground, along its normal, between its lift-off and its touchdown, of several such ways in a cycle that of
    the highest.

    Args:
        cycle: the cycle.
        start: derivatives of the state in which it begins, (2 nv, c).
        weight: of the robot.
    """
    return {name: each for group in GROUPS for name, each in group(cycle, start, weight).items()}


def measure(cycle: Derivative, start: Array, weight: Measure, name: str) -> Measure | None:
    """One of the measures, at the cost of those alone that are found with it; None where there is none of that name."""
    return next((found[name] for group in GROUPS if name in (found := group(cycle, start, weight))), None)


def _times(cycle: Derivative, start: Array, weight: Measure) -> dict[str, Measure]:
    found = {name: Measure(float(each.x), np.asarray(each.d), "s") for name, each in cycle.durations.items()}
    period = sum(each.value for each in found.values()), np.sum([each.derivative for each in found.values()], axis=0)
    return {**{f"{phase}_time": each for phase, each in found.items()}, "period": Measure(*period, "s")}


def _efforts(cycle: Derivative, start: Array, weight: Measure) -> dict[str, Measure]:
    system = cycle.system
    robot, found = system.robot, dict[str, Measure]()
    period = _times(cycle, start, weight)["period"]
    powers = [_power(cycle.stretches, j, robot.index(joint)) for j, joint in enumerate(robot.actuated)]
    found["work"] = _sum([integral(each) for each in powers], "J")
    found["positive_work"] = worked = _sum([positive(each) for each in powers], "J")
    for j, joint in enumerate(robot.actuated):
        square, change = integral([_squared(each) for each in _torque(cycle.stretches, j)])
        rms = float(np.sqrt(square / period.value))
        of_rms = 0.5 / max(rms, 1e-300) * (change / period.value - square / period.value**2 * period.derivative)
        found[f"rms_torque_{joint}"] = Measure(rms, of_rms, "N·m")
        found[f"peak_torque_{joint}"] = Measure(*_largest(_torque(cycle.stretches, j)), "N·m")
    pressed = PRESSED * weight.value, PRESSED * weight.derivative
    for toe in robot.toes:
        forces = list(_forces(cycle.stretches, toe, robot.toes))
        if forces:
            found[f"peak_force_{toe}"] = Measure(*peak([up for _, up in forces]), "N")
            found[f"friction_used_{toe}"] = Measure(*largest_ratio(forces, *pressed), "1")
    stride = _advance(cycle, start, weight).get("stride")
    if stride is not None and abs(stride.value) > LEAST_STRIDE:
        lifted = weight.value * stride.value
        of_lifted = weight.derivative * stride.value + weight.value * stride.derivative
        cost = worked.value / lifted
        found["cost_of_transport"] = Measure(cost, (worked.derivative - cost * of_lifted) / lifted, "1")
    return found


def _at_events(cycle: Derivative, start: Array, weight: Measure) -> dict[str, Measure]:
    """Heights at events that are only observed, and the joints where the cycle closes."""
    robot, found = cycle.system.robot, dict[str, Measure]()
    for stretch in _long(cycle.stretches):
        for g, guard in enumerate(stretch.arc.domain.guards):
            if guard.observes and "boom_z" in robot.coordinates:
                i = robot.index("boom_z")
                height = Pieces(stretch, stretch.y[i], stretch.dy[i])
                fallen = where_it_falls(
                    Pieces(stretch, stretch.values.guards[g], stretch.derivatives.guards[g]), height
                )
                if fallen is not None:
                    found.setdefault(f"{guard.name}_height", Measure(*fallen, "m"))
    last = cycle.stretches[-1]
    dy = last.dstate + last.end.slopes[:, None] * last.tau
    for joint in robot.actuated:
        i = robot.index(joint)
        name = cycle.system.section
        found[f"{joint}_at_{name}"] = Measure(float(last.state[i]), dy[i], "rad")
        found[f"{joint}_rate_at_{name}"] = Measure(float(last.state[robot.nv + i]), dy[robot.nv + i], "rad/s")
    return found


def _advance(cycle: Derivative, start: Array, weight: Measure) -> dict[str, Measure]:
    if not cycle.system.cyclic:
        return {}
    i = cycle.system.robot.index(cycle.system.cyclic[0])
    period = _times(cycle, start, weight)["period"]
    stride, change = float(cycle.y[i]) - float(cycle.stretches[0].arc.y[i]), cycle.dy[i] - start[i]
    speed = stride / period.value
    return {
        "stride": Measure(stride, change, "m"),
        "mean_speed": Measure(speed, (change - speed * period.derivative) / period.value, "m/s"),
    }


def _clearances(cycle: Derivative, start: Array, weight: Measure) -> dict[str, Measure]:
    toes, nv = cycle.system.robot.toes, cycle.system.robot.nv
    heights, found = dual_heights(cycle.system, cycle.numbers, cycle.dnumbers), dict[str, Measure]()
    for toe in toes:
        aloft = [each for each in _long(cycle.stretches) if toe not in _closed(each, toes)]
        if aloft:
            pieces = [Pieces(each, *heights.along(toe, each.y[:nv], each.dy[:nv])) for each in aloft]
            found[CLEARANCE + toe] = Measure(*peak(pieces), "m")
    return found


GROUPS = (_times, _at_events, _advance, _efforts, _clearances)  # those first that searches ask for, the soonest found


def _sum(parts: Sequence[tuple[float, Array]], unit: str) -> Measure:
    return Measure(float(sum(value for value, _ in parts)), np.sum([change for _, change in parts], axis=0), unit)


def _torque(stretches: Sequence[Stretch], j: int) -> list[Pieces]:
    return [
        Pieces(each, each.values.u[j], each.derivatives.u[j], float(each.rate.u[j])) for each in _lasting(stretches)
    ]


def _power(stretches: Sequence[Stretch], j: int, i: int) -> list[Pieces]:
    found = []
    for each in _lasting(stretches):
        rate, drate = each.y[len(each.y) // 2 + i], each.dy[len(each.dy) // 2 + i]
        u, du = each.values.u[j], each.derivatives.u[j]
        found.append(Pieces(each, u * rate, du * rate[:, None] + u[:, None] * drate))
    return found


def _forces(stretches: Sequence[Stretch], toe: str, toes: Sequence[str]) -> Iterator[tuple[Pieces, Pieces]]:
    for each in _lasting(stretches):
        closed = _closed(each, toes)
        if toe in closed:
            k = 2 * closed.index(toe)
            values, changes, rates = each.values.forces, each.derivatives.forces, each.rate.forces
            along, up = (Pieces(each, values[n], changes[n], float(rates[n])) for n in (k, k + 1))
            yield along, up


def _closed(stretch: Stretch, toes: Sequence[str]) -> list[str]:
    """Toes that are on the ground."""
    return [name for name, _ in closed_toes(tuple(toes), stretch.arc.domain)]


def _long(stretches: Sequence[Stretch]) -> list[Stretch]:
    return [each for each in stretches if not each.at_once]


def _lasting(stretches: Sequence[Stretch]) -> list[Stretch]:
    """Those that last in this cycle, or on one side beside it."""
    return [each for each in stretches if not each.at_once or each.late]


def _squared(piece: Pieces) -> Pieces:
    return Pieces(piece.stretch, piece.values**2, 2.0 * piece.values[:, None] * piece.derivatives)


def _largest(pieces: Sequence[Pieces]) -> tuple[float, Array]:
    """The largest modulus."""
    up = peak(pieces)
    down = peak([Pieces(each.stretch, -each.values, -each.derivatives, -each.rate) for each in pieces])
    return max(up, down, key=lambda each: each[0])
