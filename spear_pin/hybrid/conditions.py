"""Conditions on which a switch engages or releases its spring in stance: values that fall through zero there."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from spear_pin.hybrid.domain import ENGAGES, RELEASES, Edge, Guard, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.pull import Pull
from spear_pin.model.clutch import LIFT_OFF, LOADED, LONGEST_PATH, SHORTEST_PATH, TOUCHDOWN, UNLOADED, Clutch


class Condition(NamedTuple):
    """When a switch acts.

    Attributes:
        value: returns what falls through zero then, from what the spring does, and from the force of the ground on its
            toe, in N.
        turns: whether it is met as the value falls only; else also while it is below zero.
    """

    value: Callable[[Pull, Any], Any]
    turns: bool


CONDITIONS: Mapping[str, Condition] = {
    LOADED: Condition(lambda pull, force: _clutch(pull).on_force - force, turns=False),
    UNLOADED: Condition(lambda pull, force: force - _clutch(pull).off_force, turns=False),
    LONGEST_PATH: Condition(lambda pull, force: pull.rate, turns=True),
    SHORTEST_PATH: Condition(lambda pull, force: -pull.rate, turns=True),
}


def make_condition_events(mount: Mount, clutch: Clutch, toe: str) -> tuple[Guard, ...]:
    """Returns the events at which a switch meets its conditions.

    Args:
        mount: its spring.
        clutch: the switch.
        toe: the toe whose force it may feel.
    """
    found = []
    if clutch.engage != TOUCHDOWN:
        found.append(_guard(mount, CONDITIONS[clutch.engage], toe, ENGAGES))
    if clutch.release != LIFT_OFF:
        found.append(_guard(mount, CONDITIONS[clutch.release], toe, RELEASES))
    return tuple(found)


def _guard(mount: Mount, condition: Condition, toe: str, kind: str) -> Guard:
    name, on, acts_on, met = mount.name, str(mount.on), float(kind == RELEASES), condition.value

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        watched = acts_on * held[on] + (1.0 - acts_on) * (1.0 - held[on])
        return watched * met(dyn.pull(name), dyn.force(toe)[-1]) + (1.0 - watched)

    patience = math.inf if condition.turns else 0.0
    return Guard(f"switch:{name}", value, Reset(edges=(Edge(kind, mount),)), patience=patience)


def _clutch(pull: Pull) -> Clutch:
    assert pull.spring.clutch is not None
    return pull.spring.clutch
