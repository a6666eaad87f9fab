"""Event feedback: at the section it adds to numbers of the law what the deviation from a gait's state asks for.

The numbers stay changed until the next cycle begins. On the gait itself nothing is added, so its orbit is the same.
Other numbers move the gait, but not the state with which feedback compares: take it off first, and design it again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held, Reset
from spear_pin.hybrid.fields import ADDED
from spear_pin.hybrid.parameters import change_system, find_replaced, numbers_of_law
from spear_pin.hybrid.symmetry import YAW, Mirror, mirror_of
from spear_pin.model.scalars import dot, turn

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class EventFeedback:
    """The change of a system that adds w = K (x - x*) to numbers of the law, for the cycle that begins at a state x.

    Of a robot in space x is headed: x = y = 0, the velocity along the heading and across it.

    Attributes:
        inputs: names of the k numbers.
        gains: K, a row for each input with a column for each of the 2 nv numbers of a state (q, v).
        nominal: x*, the 2 nv numbers of the gait's state (q, v).
        limits: largest |w| of each input, (k,).
        heading: yaw to which feedback steers a robot in space, in rad.
        between: name of the event between the halves of a stride at which a state seen in the mirror counts too, if a
            cycle is no half; "" for none.
        halfway: x* there, seen in the mirror.
    """

    inputs: tuple[str, ...]
    gains: tuple[Numbers, ...]
    nominal: Numbers
    limits: Numbers
    heading: float = 0.0
    between: str = ""
    halfway: Numbers = ()

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with feedback.

        Raises:
            UnknownName: an input is no number of the law.
            BadValue: there is feedback already, a shape does not fit, a limit is negative, or the ground is not
                level at height zero, as x holds heights above it.
        """
        self._check(system)
        made: dict[int, Reset] = {}  # domains share resets, and go on sharing them
        return replace(system, domains=tuple(self._domain(system, each, made) for each in system.domains))

    def _check(self, system: HybridSystem) -> None:
        valid, columns = numbers_of_law(system), 2 * system.robot.nv
        for name in self.inputs:
            if name not in valid:
                raise UnknownName("input", name, valid)
        if feedback_of(system) is not None:
            raise BadValue("system", system.kind, "one without event feedback")
        if len({*self.inputs}) < len(self.inputs):
            raise BadValue("EventFeedback.inputs", self.inputs, "each number once")
        events = {guard.name for domain in system.domains for guard in domain.guards}
        if self.between and self.between not in events:
            raise UnknownName("event", self.between, events)
        if self.halfway and not self.between:
            raise BadValue("EventFeedback.halfway", self.halfway, "() without an event `between`")
        halfway = {"EventFeedback.halfway": self.halfway} if self.between else {}
        for name, row in {"EventFeedback.nominal": self.nominal, **halfway}.items():
            _fits(name, row, columns)
        if not len(self.gains) == len(self.limits) == len(self.inputs):
            raise BadValue("EventFeedback.gains", self.gains, f"a row, and a limit, for each of {self.inputs}")
        for row in self.gains:
            _fits("a row of EventFeedback.gains", row, columns)
        for limit in self.limits:
            require("a limit of EventFeedback.limits", limit, lambda value: value >= 0, "a number >= 0")
        require("EventFeedback.heading", self.heading, math.isfinite, "a finite number, in rad")
        if not system.ground.plain:
            expected = "level ground at height zero: feedback compares the height of the robot"
            raise BadValue("ground", system.contact, expected)

    def _domain(self, system: HybridSystem, domain: Domain, made: dict[int, Reset]) -> Domain:
        """Returns a domain whose guards adjust the law where a cycle, or the second half of a stride, begins."""
        guards = []
        for guard in domain.guards:
            reset = guard.reset
            if reset is not None and guard.name in (system.section, self.between):
                if id(reset) not in made:
                    made[id(reset)] = self._adjusting(system, guard.name, reset, reset.phase or domain.phase)
                guard = replace(guard, reset=made[id(reset)])
            guards.append(guard)
        return replace(domain, guards=tuple(guards))

    def _adjusting(self, system: HybridSystem, event: str, reset: Reset, phase: str) -> Reset:
        headed, second = bool(system.section_toes), bool(system.mirrored_toes) and phase != system.section_phase
        if event != system.section:
            adjust = partial(self._added, self.halfway, headed, mirror_of(system.robot))
        else:
            adjust = partial(self._added, self.nominal, headed, mirror_of(system.robot) if second else None)
        return replace(reset, adjust=adjust, latch=reset.latch or _nothing)

    def _added(
        self,
        nominal: Numbers,
        headed: bool,
        mirror: Mirror | None,
        q: Sequence[Any],
        v: Sequence[Any],
        held: Held,
        p: Any,
    ) -> Held:
        """Returns what is added to each input at a state of any scalars, within its limits."""
        if mirror is not None:
            q, v = _seen(mirror, q), _seen(mirror, v)
        state = [*q, *v]
        if headed:
            (c, s), n = turn(q[YAW]), len(q)
            state[:2], state[YAW] = (0.0, 0.0), q[YAW] - self.heading
            state[n : n + 2] = c * v[0] + s * v[1], c * v[1] - s * v[0]
        off = [value - wanted for value, wanted in zip(state, nominal, strict=True)]
        rows = zip(self.inputs, self.gains, self.limits, strict=True)
        return {ADDED + name: _within(limit, dot(row, off)) for name, row, limit in rows}


def feedback_of(system: HybridSystem) -> EventFeedback | None:
    """Returns the event feedback of a system, None if it has none."""
    return next((change for change in system.changes if isinstance(change, EventFeedback)), None)


def with_feedback(system: HybridSystem, feedback: EventFeedback | None) -> HybridSystem:
    """Returns the system with event feedback in the place of its own, or without any; other changes are kept.

    Raises:
        UnknownName: an input is no number of the law.
        BadValue: the feedback does not fit the system; see `EventFeedback`.
    """
    if feedback_of(system) is not None:
        kept = [change for change in system.changes if not isinstance(change, EventFeedback)]
        others, system = find_replaced(system), system.made["builder"](system.robot, *system.parts.values())
        for change in kept:
            system = change_system(system, change)
        system = replace(system, **others) if others else system
    return system if feedback is None else change_system(system, feedback)


def _fits(name: str, row: Numbers, count: int) -> None:
    if np.shape(row) != (count,) or not np.isfinite(row).all():
        raise BadValue(name, row, f"{count} finite numbers, those of a state (q, v)")


def _seen(mirror: Mirror, values: Sequence[Any]) -> list[Any]:
    """Returns a configuration or a velocity, of any scalars, in the mirror."""
    return [sign * values[i] for i, sign in zip(mirror.of, mirror.signs, strict=True)]


def _within(limit: float, value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return np.clip(value, -limit, limit)
    return limit if value > limit else -limit if value < -limit else value


def _nothing(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
    return {}
