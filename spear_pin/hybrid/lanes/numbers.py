"""The numbers in which lanes may differ, and results that depend on them: compiled domains, latched values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid import own
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.brake import Brakes, brakes_with
from spear_pin.hybrid.clutch import Clock, from_now_on
from spear_pin.hybrid.domain import Domain, Reset
from spear_pin.hybrid.engines import structure
from spear_pin.hybrid.engines.taylor import Code, Point, Ready
from spear_pin.hybrid.fields import flatten, map_nested, with_fields
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.lanes.compilation import compilation
from spear_pin.hybrid.lanes.groups import Group, Indices, join_held, spread_held, take
from spear_pin.hybrid.rules.entry import ahead
from spear_pin.hybrid.rules.jumping import apply_jump
from spear_pin.hybrid.rules.latching import latch_values, standing
from spear_pin.hybrid.springs import springs_with
from spear_pin.model.springs import Springs


class Numbers:
    """The numbers of a system in every lane.

    Args:
        system: the system.
        given: numbers that differ from lane to lane, (n,) each, named as fields of law, spring or contact.
        code: how the system's domains are compiled.
    """

    def __init__(self, system: HybridSystem, given: Mapping[str, Array], code: Code) -> None:
        self.system, self.nv, self._given = system, system.robot.nv, given
        self.compilation = compilation(system, code)
        self.mechanism = self.compilation.mechanism
        self._others = {name: given.get(name, value) for name, value in structure.others(system).items()}

    def of_lane(self, lane: int) -> dict[str, float]:
        """Returns the values of a lane for the numbers in which lanes differ."""
        return {name: float(values[lane]) for name, values in self._given.items()}

    def law_of(self, lane: int) -> Any:
        """Returns the parameters of the law in one lane."""
        return with_fields(self.system.law, self.of_lane(lane))

    def constants(self, lane: int) -> list[float]:
        """Returns a lane's run-time parameters, which come before the held values."""
        law, others = self.law_of(lane), [float(take(value, lane)) for value in self._others.values()]
        return flatten((law, *others, *self.compilation.robot))

    def law(self, lanes: Indices) -> Any:
        """Returns the parameters of the law in some lanes."""
        return with_fields(self.system.law, {name: values[lanes] for name, values in self._given.items()})

    def springs(self, lanes: Any) -> Springs:
        """Returns the springs in some lanes, or in one."""
        return springs_with(self.system.springs, {name: take(value, lanes) for name, value in self._others.items()})

    def brakes(self, lanes: Any) -> Brakes:
        """Returns the brakes in some lanes, or in one."""
        return brakes_with(self.system.brakes, {name: take(value, lanes) for name, value in self._others.items()})

    def ground(self, lanes: Indices) -> Ground:
        """Returns the ground under some lanes; its numbers are arrays where lanes may differ in them."""
        return with_fields(self.system.ground, {name: take(value, lanes) for name, value in self._others.items()})

    def parameters(self, group: Group) -> Array:
        """Returns the run-time parameters of a group, (p, n)."""
        others = [take(value, group.lanes) for value in self._others.values()]
        return structure.parameters(self.law(group.lanes), others, self.compilation.robot, group.held, len(group))

    def compiled(self, domain: Domain, group: Group) -> Ready:
        """Returns the domain compiled for the held values of a group.

        Raises:
            TypeError: the domain cannot be compiled, since a latch branches on a value.
        """
        return self.compilation.domain(domain, group.held)

    def at(self, ready: Ready, group: Group) -> Point:
        """Evaluates a domain at the states of a group."""
        return ready.compiled.at(group.t, group.y, self.parameters(group))

    def ahead(self, ready: Ready, group: Group, h: float) -> Group:
        """Returns the group after one Runge-Kutta step of h seconds."""
        parameters = self.parameters(group)

        def slope(t: Array, y: Array) -> Array:
            return ready.compiled.at(t, y, parameters).slopes

        return replace(group, t=group.t + h, y=ahead(slope, group.t, group.y, h))

    def jump(self, group: Group, reset: Reset) -> tuple[Group, Group]:
        """Returns the group after an event's jump, lane by lane, and the lanes in which the jump has no value."""
        after = group.y.copy()
        for i, lane in enumerate(group.lanes.tolist()):
            y, held = group.y[:, i].tolist(), {name: take(value, i) for name, value in group.held.items()}
            try:
                parts = apply_jump(reset, y[: self.nv], y[self.nv :], held, self.law_of(lane), self.system.place_of)
                after[:, i] = np.concatenate(parts)
            except ArithmeticError:
                after[:, i] = math.nan
        there = np.isfinite(after).all(axis=0)
        return replace(group, y=after).take(there), group.take(~there)

    def latch(self, group: Group, reset: Reset, *, begins: bool) -> Group:
        """Returns the group after an event's latch; see `latch_values`.

        A latch that is plain arithmetic is called once for all lanes, any other lane by lane.

        Raises:
            BadFunction: there is a mistake in the latch.
        """
        if not reset.holds or not len(group):
            if reset.phase is None:
                return group
            parts = standing(self.system.robot, [*group.y[: self.nv]], [*group.y[self.nv :]])
            return replace(group, held={**from_now_on(group.held, group.t), **parts})
        n, q, v = len(group), group.y[: self.nv], group.y[self.nv :]
        try:
            if n == 1:  # NumPy may take an array of one for a number, or not
                raise TypeError
            clock = self._clock(group.t, group.lanes)
            held = latch_values(
                group.held, [reset], list(q), list(v), self.law(group.lanes), begins=begins, clock=clock
            )
            return replace(group, held=spread_held(held, n))
        except Exception as error:
            if not (
                (reset.latch and own.is_own(reset.latch)) or isinstance(error, (TypeError, ValueError, ArithmeticError))
            ):
                raise
            found = [self._latch_alone(group, reset, i, begins) for i in range(n)]
            pattern = next((one for one in found if one is not None), {"undefined": 0.0})
            undefined = {name: map_nested(lambda number: math.nan, value) for name, value in pattern.items()}
            new = join_held([undefined if one is None else one for one in found])
            return replace(group, held={**group.held, **new})

    def _clock(self, t: Any, lanes: Any) -> Clock:
        return Clock(t, self.springs(lanes), self.system, self.brakes(lanes))

    def _latch_alone(self, group: Group, reset: Reset, i: int, begins: bool) -> Mapping[str, Any] | None:
        """Returns the values held after an event in the i-th lane of a group, None where one is undefined."""
        held = {name: take(value, i) for name, value in group.held.items()}
        q, v = group.y[: self.nv, i].tolist(), group.y[self.nv :, i].tolist()
        try:
            law = self.law_of(int(group.lanes[i]))
            clock = self._clock(float(group.t[i]), int(group.lanes[i]))
            return latch_values(held, [reset], q, v, law, self.system.place_of, begins=begins, clock=clock)
        except ArithmeticError:
            return None
