"""What a leg of a bound has in the plane and in space alike: its spring, its lift-off by the knee, and overload."""

from __future__ import annotations

from typing import Any, Protocol

from spear_pin.hybrid.domain import Guard, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.model.spring import Spring

OVERLOAD = 1e4  # N·m: a hundred times what Q-SPEAR's gaits take
BEYOND = 1e-3  # rad: a knee that flexed so far beyond θ̄ has something to come back from
SHORTEST_SPAN = 0.2  # of a stance's span: what is left of it when a swing begins late


class Kneed(Protocol):
    """A leg, as far as its knee goes: the name of the leg and of the knee, and where and how far it flexes."""

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def joint(self) -> str: ...  # noqa: D102
    @property
    def side(self) -> float: ...  # noqa: D102
    def flexion(self, q: Any) -> Any: ...  # noqa: D102


def mount(leg: Kneed, spring: Spring) -> Mount:
    """The leg's spring, by what is latched of it."""
    return Mount(leg.joint, spring, rest=f"{leg.name}_rest", taut=f"{leg.name}_taut", side=leg.side)


def knee_back(leg: Kneed, reset: Reset) -> tuple[Guard, Guard]:
    """The knee passes θ̄ of (5.5)-(5.6), the law's `knee_rest`, as it flexes, and comes back to it."""
    name = f"{leg.name}_flexed"

    def flexes(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return held[name] + (1.0 - held[name]) * (p.knee_rest + BEYOND - leg.flexion(q))

    def returns(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return held[name] * (leg.flexion(q) - p.knee_rest) + (1.0 - held[name])

    flexed = Reset(latch=lambda q, v, held, p: {name: 1.0})
    return Guard(name, flexes, flexed), Guard(f"{leg.name}_lift_off", returns, reset)


def overload(most: float = OVERLOAD) -> Guard:
    """The decoupling matrix is all but singular, and the torques grow without bound, beyond `most` in N·m."""

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return most**2 - sum(torque * torque for torque in dyn.u)

    return Guard("overload", value, ends="overload")
