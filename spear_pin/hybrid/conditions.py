"""Conditions on which a switch engages or releases its spring in stance: values that fall through zero there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from spear_pin.hybrid.domain import ENGAGES, RELEASES, Edge, Guard, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.pull import Pull
from spear_pin.model.clutch import LIFT_OFF, LOADED, TOUCHDOWN, UNLOADED, Clutch

Condition = Callable[[Pull, Any], Any]
"""Returns what falls through zero, from what the spring does, and from the force of the ground on its toe, in N."""

CONDITIONS: Mapping[str, Condition] = {
    LOADED: lambda pull, force: _clutch(pull).on_force - force,
    UNLOADED: lambda pull, force: force - _clutch(pull).off_force,
}


def meeting(mount: Mount, clutch: Clutch, toe: str) -> tuple[Guard, ...]:
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
    name, on, acts_on = mount.name, str(mount.on), float(kind == RELEASES)

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        watched = acts_on * held[on] + (1.0 - acts_on) * (1.0 - held[on])
        return watched * condition(dyn.pull(name), dyn.force(toe)[-1]) + (1.0 - watched)

    return Guard(f"switch:{name}", value, Reset(edges=(Edge(kind, mount),)))


def _clutch(pull: Pull) -> Clutch:
    assert pull.spring.clutch is not None
    return pull.spring.clutch
