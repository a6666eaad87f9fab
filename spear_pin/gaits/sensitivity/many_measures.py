"""Measures of many cycles with different numbers, by the names of `measures`, without derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.measures.catalogue import LEAST_STRIDE, PRESSED
from spear_pin.gaits.sensitivity.heat import ENERGY, HEAT, WORK, heating
from spear_pin.gaits.sensitivity.measures import DEFLECTION, HEIGHT
from spear_pin.gaits.sensitivity.panels import Panels
from spear_pin.hybrid.arc import Arc, Record
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.fields import flattened
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.tangent.collocation import POINTS
from spear_pin.hybrid.tangent.heights import Heights
from spear_pin.hybrid.tangent.points import points
from spear_pin.hybrid.tangent.record import Numbers, Recorder, many
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.motor import NO_MOTORS, Motor

CHUNK = 256  # cycles at a time, which bounds memory


@dataclass(frozen=True)
class Measured:
    """Measures of the cycles, NaN where a cycle does not close or has no derivative.

    Attributes:
        values: by name, (n,) each.
        orders: order of the events, (n,); empty where a cycle does not close or has no derivative.
    """

    values: Mapping[str, Array]
    orders: tuple[Order, ...]


def measured(
    system: HybridSystem,
    given: Mapping[str, Array],
    q: Array,
    v: Array,
    motors: Mapping[str, Motor] = NO_MOTORS,
    on_lanes: Callable[[int], object] = lambda n: None,
) -> Measured:
    """Measures one cycle of each lane.

    Args:
        system: the system.
        given: numbers that differ between lanes, (n,) each, among those that `simulate_many` takes.
        q: configurations on the section, (n, nq).
        v: velocities there, (n, nv).
        motors: motors whose heat is measured, by the names of their joints; none by default.
        on_lanes: called with the number of lanes done since the last call.
    """
    n = len(q)
    numbers = many(system, given)
    recorder = _Recorders(system, numbers)
    found: dict[str, Array] = {}
    orders: list[Order] = [()] * n
    for first in range(0, n, CHUNK):
        lanes = range(first, min(first + CHUNK, n))
        chunk = _Chunk(numbers, motors, lanes)
        for i in lanes:
            laid = recorder(i, np.concatenate([q[i], v[i]]))
            if laid is not None:
                orders[i] = laid.lap.order
                chunk.add(i - first, np.concatenate([q[i], v[i]]), laid)
        for name, values in chunk.measures().items():
            found.setdefault(name, np.full(n, np.nan))[lanes.start : lanes.stop] = values
        on_lanes(len(lanes))
    return Measured(found, tuple(orders))


@dataclass(frozen=True)
class _Part:
    """An arc at its points, with the field, the domain and the inputs by which it is evaluated."""

    field: Any
    domain: Any
    t: Array
    lengths: Array
    y: Array
    numbers: Array


@dataclass(frozen=True)
class _Laid:
    """A cycle with the points of its arcs."""

    lap: Record
    parts: list[_Part]


class _Recorders:
    """Runs the lanes' cycles."""

    def __init__(self, system: HybridSystem, numbers: Numbers) -> None:
        self._system, self._numbers = system, numbers
        self._fields = Recorder(system, self._numbers, 0)  # all lanes share the fields

    def __call__(self, lane: int, y: Array) -> _Laid | None:
        recorder = Recorder(self._system, self._numbers, lane)
        try:
            lap = recorder.lap(y)
            return _Laid(lap, [self._part(recorder, arc) for arc in lap.arcs if arc.end > arc.t])
        except NotDifferentiable:
            return None

    def _part(self, recorder: Recorder, arc: Arc) -> _Part:
        t, lengths, y = points(arc)
        numbers = np.concatenate([recorder.numbers, np.array(flattened(arc.held.values()), dtype=float)])
        return _Part(self._fields.field(arc.domain, arc.held), arc.domain, t, lengths, y, numbers)


@dataclass
class _Chunk:
    """Cycles that are measured together."""

    numbers: Numbers
    motors: Mapping[str, Motor]
    chosen: range
    laps: dict[int, tuple[Array, Record]] = field(default_factory=dict)
    groups: dict[int, list[tuple[int, _Part]]] = field(default_factory=dict)

    @property
    def system(self) -> HybridSystem:
        """The system."""
        return self.numbers.system

    @property
    def count(self) -> int:
        """Number of cycles."""
        return len(self.chosen)

    def add(self, lane: int, y: Array, laid: _Laid) -> None:
        """Adds a cycle."""
        self.laps[lane] = y, laid.lap
        for part in laid.parts:
            self.groups.setdefault(id(part.field), []).append((lane, part))

    def measures(self) -> dict[str, Array]:
        """Returns all measures of the cycles."""
        robot = self.system.robot
        found = self._of_laps()
        sums = {name: np.zeros(self.count) for name in ("work", "positive_work")}
        squares = np.zeros((robot.nu, self.count))
        tops, rates, lowest, highest = np.full((4, robot.nu, self.count), -np.inf)
        force, friction, aloft = ({toe: np.full(self.count, -np.inf) for toe in robot.toes} for _ in range(3))
        weight, motors = self.system.robot.weight, [motors_at(joint) for joint in robot.actuated]
        for parts in self.groups.values():
            panels, values, y, domain = self._evaluated(parts)
            for g, guard in enumerate(domain.guards):
                if guard.observes and "boom_z" in robot.coordinates:
                    at, height = values.guards[g], y[robot.index("boom_z")]
                    fallen = panels.where_it_falls(at.reshape(-1, POINTS), height.reshape(-1, POINTS))
                    before = found.get(f"{guard.name}_height", fallen)
                    found[f"{guard.name}_height"] = np.where(np.isfinite(before), before, fallen)
            for j, joint in enumerate(robot.actuated):
                torque = values.u[j].reshape(-1, POINTS)
                power = torque * y[robot.nv + robot.index(joint)].reshape(-1, POINTS)
                torque = torque / motors[j]
                sums["work"] += panels.integral(power)
                sums["positive_work"] += panels.positive(power)
                squares[j] += panels.integral(torque**2)
                tops[j] = np.maximum(tops[j], np.maximum(panels.peak(torque), panels.peak(-torque)))
                angle, rate = (y[i].reshape(-1, POINTS) for i in (robot.index(joint), robot.nv + robot.index(joint)))
                rates[j] = np.maximum(rates[j], np.maximum(panels.peak(rate), panels.peak(-rate)))
                lowest[j], highest[j] = (
                    np.maximum(ends[j], panels.peak(side * angle)) for ends, side in ((lowest, -1.0), (highest, 1.0))
                )
            closed = [toe for toe, _ in closed_toes(tuple(robot.toes), domain)]
            for k, toe in enumerate(closed):
                along, up = (values.forces[2 * k + i].reshape(-1, POINTS) for i in (0, 1))
                force[toe] = np.maximum(force[toe], panels.peak(up))
                friction[toe] = np.maximum(friction[toe], panels.ratio(along, up, PRESSED * weight / len(robot.toes)))
            ground = self.numbers.ground(self.chosen.start + np.repeat(panels.lanes, POINTS))
            for toe in set(robot.toes).difference(closed):
                height = Heights(self.numbers.mechanism, ground).at(toe, list(y[: robot.nv]))
                aloft[toe] = np.maximum(aloft[toe], panels.peak(height.reshape(-1, POINTS)))
        found |= {**sums, "absolute_work": 2.0 * sums["positive_work"] - sums["work"]}
        for j, joint in enumerate(robot.actuated):
            found[f"rms_torque_{joint}"] = np.sqrt(squares[j] / found["period"])
            found[f"peak_torque_{joint}"], found[f"peak_speed_{joint}"] = tops[j], rates[j]
            found[f"least_{joint}"], found[f"greatest_{joint}"] = -lowest[j], highest[j]
        found["effort"] = np.array(motors) @ squares
        for toe in robot.toes:
            found[f"peak_force_{toe}"], found[f"friction_used_{toe}"] = force[toe], friction[toe]
            found[HEIGHT + toe] = aloft[toe]
        for joint, motor in self.motors.items():
            found[HEAT + joint] = heating(self.system, joint, motor) * squares[robot.actuated.index(joint)]
        if self.motors:
            found[ENERGY] = np.sum([sums[WORK], *(found[HEAT + joint] for joint in self.motors)], axis=0)
        if self.system.cyclic:
            distance = np.abs(found["stride"])
            way = np.where(distance > LEAST_STRIDE, distance, np.nan)
            found["cost_of_transport"] = found["absolute_work"] / (weight * way)
            found["cost_of_transport_positive"] = found["positive_work"] / (weight * way)
            found["effort_per_distance"] = found["effort"] / way
        there = np.isin(np.arange(self.count), list(self.laps))
        return {name: np.where(there & np.isfinite(values), values, np.nan) for name, values in found.items()}

    def _of_laps(self) -> dict[str, Array]:
        """Returns what cycles report themselves: durations, observed events and the states at their ends."""
        robot, system = self.system.robot, self.system
        names = [f"{phase}_time" for phase in system.phases] + ["period"]
        rows: dict[int, dict[str, float]] = {}
        for lane, (y, lap) in self.laps.items():
            period = sum(lap.spent.values())
            row = {f"{phase}_time": seconds for phase, seconds in lap.spent.items()} | {"period": period}
            before = lap.arcs[-1].after
            for joint in robot.actuated:
                i = robot.index(joint)
                row[f"{joint}_at_{system.section}"] = float(before[i])
                row[f"{joint}_rate_at_{system.section}"] = float(before[robot.nv + i])
            if system.cyclic:
                i = robot.index(system.cyclic[0])
                row["stride"] = float(lap.y[i] - y[i])
                row["mean_speed"] = row["stride"] / period
            for arc in lap.arcs:
                let_go = arc.event.reset.release if arc.event is not None and arc.event.reset is not None else ()
                for mount in arc.domain.mounts:
                    if mount.joint in let_go:
                        left = mount.side * float(arc.after[robot.index(mount.joint)] - arc.held[mount.rest]) + 0.0
                        row[DEFLECTION + mount.joint] = min(left, row.get(DEFLECTION + mount.joint, left))
            rows[lane] = row
            names += [name for name in row if name not in names]
        nothing: dict[str, float] = {}
        return {
            name: np.array([rows.get(lane, nothing).get(name, np.nan) for lane in range(self.count)]) for name in names
        }

    def _evaluated(self, parts: list[tuple[int, _Part]]) -> tuple[Panels, Any, Array, Any]:
        """Evaluates arcs in one domain: returns their panels, the domain's values at their points, and the states."""
        lanes = np.concatenate([np.full(len(part.lengths), lane) for lane, part in parts])
        lengths = np.concatenate([part.lengths for _, part in parts])
        t, y = np.concatenate([part.t for _, part in parts]), np.concatenate([part.y for _, part in parts], axis=1)
        numbers = np.repeat(
            np.column_stack([part.numbers for _, part in parts]), [len(part.t) for _, part in parts], axis=1
        )
        one = parts[0][1]
        return Panels(lanes, lengths, self.count), one.field.values(t, y, numbers), y, one.domain
