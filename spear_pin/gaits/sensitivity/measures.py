"""Named measures of a cycle, with their derivatives."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.measures.catalogue import LEAST_STRIDE, PRESSED
from spear_pin.gaits.sensitivity.along_arcs import (
    along,
    closed_in,
    coordinate,
    forces,
    guarded,
    long,
    powered,
    with_partner,
)
from spear_pin.gaits.sensitivity.measure import Group, Measure, Measures, product, ratio, total
from spear_pin.gaits.sensitivity.signals import Pieces, integral, largest_ratio, peak, positive, where_it_falls
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Derivative, Stretch
from spear_pin.hybrid.tangent.dual import derivative_of, value_of
from spear_pin.hybrid.tangent.heights import Heights, dual_heights

All = Mapping[str, Measure]
HEIGHT, DEFLECTION = "greatest_height_", "deflection_"
TIMES, ADVANCE = ".*_time|period", "stride|mean_speed|turn"


def measures(cycle: Derivative, start: Array, weight: Measure, more: Sequence[Group] = ()) -> Measures:
    """Returns all named measures of a cycle, each found when it is asked for.

    `spear_pin.gaits.measures.catalogue` lists their names, units and meanings.

    Args:
        cycle: the cycle.
        start: derivatives of the state in which it begins, (2 nv, c).
        weight: weight of the robot.
        more: other groups of measures.
    """
    return Measures([*(Group(names, partial(find, cycle, start, weight)) for names, find in GROUPS), *more])


def _times(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    found = {name: Measure(float(each.x), np.asarray(each.d), "s") for name, each in cycle.durations.items()}
    return {**{f"{phase}_time": each for phase, each in found.items()}, "period": total([*found.values()])}


def _at_events(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    """Returns heights at events that are only observed, and the joints where the cycle closes."""
    robot, found = cycle.system.robot, dict[str, Measure]()
    for stretch in long(cycle.stretches):
        for g, guard in enumerate(stretch.arc.domain.guards):
            if guard.observes and "boom_z" in robot.coordinates:
                i = robot.index("boom_z")
                fallen = where_it_falls(guarded(stretch, g), along(stretch, i))
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


def _advance(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    if not cycle.system.cyclic:
        return {}
    robot, period = cycle.system.robot, of["period"]
    turns = [robot.index(name) for name in cycle.system.cyclic if robot.arm is not None or name == "yaw"]
    along = [robot.index(name) for name in cycle.system.cyclic if robot.index(name) not in turns]
    found = dict[str, Measure]()
    for yaw in turns:
        turn = float(cycle.y[yaw]) - float(cycle.stretches[0].arc.y[yaw])
        found["turn"] = Measure(turn, cycle.dy[yaw] - start[yaw], "rad")
    if robot.arm is not None:
        stride, change = robot.arm * found["turn"].value, robot.arm * found["turn"].derivative
    else:
        way, ways = cycle.y[along] - cycle.stretches[0].arc.y[along], cycle.dy[along] - start[along]
        ahead = _ahead(cycle, way)
        stride, change = float(ahead @ way), ahead @ ways
    speed = stride / period.value
    return found | {
        "stride": Measure(stride, change, "m"),
        "mean_speed": Measure(speed, (change - speed * period.derivative) / period.value, "m/s"),
    }


def _ahead(cycle: Derivative, way: Array) -> Array:
    """Returns the unit vector along which a cycle covers distance: its way, or for half a stride its first heading."""
    if len(way) == 1:
        return np.ones(1)
    if cycle.system.mirrored_toes:
        yaw = float(cycle.stretches[0].arc.y[cycle.system.robot.index("yaw")])
        return np.array([math.cos(yaw), math.sin(yaw)])
    return way / max(float(np.linalg.norm(way)), 1e-300)


def _works(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    powers = [_products(*powered(cycle.stretches, cycle.system.robot, joint)) for joint in cycle.system.robot.actuated]
    net, drive = (total([Measure(*of(each), "J") for each in powers]) for of in (integral, positive))
    # where the motors brake as well: twice the driving work, less the net work
    amount = Measure(2.0 * drive.value - net.value, 2.0 * drive.derivative - net.derivative, "J")
    found = {"work": net, "positive_work": drive, "absolute_work": amount}
    if (distance := _distance(of)) is not None:
        lifted = product(weight, distance, "J")
        found["cost_of_transport"] = ratio(amount, lifted, "1")
        found["cost_of_transport_positive"] = ratio(drive, lifted, "1")
    return found


def _distance(of: All) -> Measure | None:
    """Returns the distance of a cycle, forward or back; None where it is too short for measures per distance."""
    stride = of.get("stride")
    if stride is None or abs(stride.value) <= LEAST_STRIDE:
        return None
    sign = math.copysign(1.0, stride.value)
    return Measure(sign * stride.value, sign * stride.derivative, stride.unit)


def _torques(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    robot, period, found = cycle.system.robot, of["period"], dict[str, Measure]()
    squares = []
    for joint in robot.actuated:
        motors = motors_at(joint)
        halves = with_partner(cycle.system, joint)
        signals = [(powered(cycle.stretches, robot, name)[0], sign / motors) for name, sign in halves]
        torque = [each.times(share) for signal, share in signals for each in signal]
        square, change = integral(_products(torque, torque))
        square, change = square / len(halves), change / len(halves)
        squares.append(Measure(motors * square, motors * change, "N²·m²·s"))
        rms = float(np.sqrt(square / period.value))
        of_rms = 0.5 / max(rms, 1e-300) * (change / period.value - square / period.value**2 * period.derivative)
        found[f"rms_torque_{joint}"] = Measure(rms, of_rms, "N·m")
        found[f"peak_torque_{joint}"] = Measure(*_largest(torque), "N·m")
    found["effort"] = total(squares)
    if (distance := _distance(of)) is not None:
        found["effort_per_distance"] = ratio(found["effort"], distance, "N²·m·s")
    return found


def _forces(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    robot, found = cycle.system.robot, dict[str, Measure]()
    share = PRESSED / len(robot.toes)
    pressed = share * weight.value, share * weight.derivative
    for toe in robot.toes:
        pairs = [
            each for own, _ in with_partner(cycle.system, toe) for each in forces(cycle.stretches, own, robot.toes)
        ]
        if pairs:
            found[f"peak_force_{toe}"] = Measure(*peak([up for _, up in pairs]), "N")
            found[f"friction_used_{toe}"] = Measure(*largest_ratio(pairs, *pressed), "1")
    return found


def _toe_heights(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    toes, found = cycle.system.robot.toes, dict[str, Measure]()
    heights = dual_heights(cycle.system, cycle.numbers, np.pad(cycle.dnumbers, ((0, 0), (0, 1))))
    for toe in toes:
        aloft = [
            _height(heights, own, each)
            for own, _ in with_partner(cycle.system, toe)
            for each in long(cycle.stretches)
            if own not in closed_in(each, toes)
        ]
        if aloft:
            found[HEIGHT + toe] = Measure(*peak(aloft), "m")
    return found


def _height(heights: Heights, toe: str, stretch: Stretch) -> Pieces:
    """Returns the height of a toe along an arc; the last direction is the motion's own."""
    nv = len(stretch.y) // 2
    values, derivatives = heights.along(
        toe, stretch.y[:nv], np.concatenate([stretch.dy[:nv], stretch.y[nv:, :, None]], axis=2)
    )
    return Pieces(stretch, values, derivatives[:, :-1], derivatives[[BEGIN, END], -1])


def _ranges(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    """Returns how fast joints turn, and the least and largest angles."""
    robot, found = cycle.system.robot, dict[str, Measure]()
    for joint in robot.actuated:
        halves = [(robot.index(name), sign) for name, sign in with_partner(cycle.system, joint)]
        angles, speeds = (
            [each.times(sign) for i, sign in halves for each in coordinate(cycle.stretches, part + i)]
            for part in (0, robot.nv)
        )
        least, change = peak([each.times(-1.0) for each in angles])
        found[f"peak_speed_{joint}"] = Measure(*_largest(speeds), "rad/s")
        found[f"least_{joint}"] = Measure(-least, -change, "rad")
        found[f"greatest_{joint}"] = Measure(*peak(angles), "rad")
    return found


def _springs(cycle: Derivative, start: Array, weight: Measure, of: All) -> dict[str, Measure]:
    """Returns the deflection of springs as they release; of several releases the least."""
    robot, found = cycle.system.robot, dict[str, Measure]()
    for stretch in cycle.stretches:
        event = stretch.arc.event
        let_go = event.reset.release if event is not None and event.reset is not None else ()
        for mount in stretch.arc.domain.mounts:
            if mount.joint in let_go:
                i, rest = robot.index(mount.joint), stretch.held[mount.rest]
                change = stretch.dstate[i] + stretch.end.slopes[i] * stretch.tau - derivative_of(rest)
                left = mount.side * (float(stretch.state[i]) - float(value_of(rest))) + 0.0
                for name, _ in with_partner(cycle.system, mount.joint):
                    before = found.get(DEFLECTION + name)
                    if before is None or left < before.value:
                        found[DEFLECTION + name] = Measure(left, mount.side * change, "rad")
    return found


def of_ends(names: Iterable[str]) -> bool:
    """Tells whether measures depend only on times and states of events, not on the inside of arcs."""
    return all(re.fullmatch(f"{TIMES}|{ADVANCE}|.*_at_.*", name) for name in names)


Finder = Callable[[Derivative, Array, Measure, All], dict[str, Measure]]
GROUPS: tuple[tuple[str, Finder], ...] = (
    (TIMES, _times),
    (".*_height|.*_at_.*", _at_events),
    (ADVANCE, _advance),
    ("work|.*_work|cost_of_transport.*", _works),
    ("rms_torque_.*|peak_torque_.*|effort.*", _torques),
    ("peak_force_.*|friction_used_.*", _forces),
    (f"{HEIGHT}.*", _toe_heights),
    ("peak_speed_.*|least_.*|greatest_.*", _ranges),
    (f"{DEFLECTION}.*", _springs),
)


def _products(one: Sequence[Pieces], other: Sequence[Pieces]) -> list[Pieces]:
    return [a.times(b) for a, b in zip(one, other, strict=True)]


def _largest(pieces: Sequence[Pieces]) -> tuple[float, Array]:
    """Returns the largest modulus."""
    return peak([*pieces, *(each.times(-1.0) for each in pieces)])
