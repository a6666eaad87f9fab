"""Systems of one's own equations: coordinates, vector fields, guards and jumps, without a robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.ground import Ground
from spear_pin.model.robot import Robot
from spear_pin.model.unit_masses import unit_masses


def own_dynamics(
    kind: str,
    units: Mapping[str, str],
    law: Any,
    domains: Sequence[Domain],
    *,
    section: str = "",
    cyclic: Sequence[str] = (),
    guess: Callable[[Any], tuple[Any, Any]],
) -> HybridSystem:
    """Makes a system in which the law of each domain returns the accelerations of the coordinates, v̇.

    Args:
        kind: name of the system.
        units: unit of each coordinate, "m" or "rad", by its name, in the order of q.
        law: the numbers of the system, a frozen dataclass, which laws, guards and jumps get as `p`.
        domains: the domains, without contacts; resets change the state by `jump`.
        section: name of the event that closes a cycle, whose reset begins a phase; none without cycles.
        cyclic: coordinates on which nothing depends.
        guess: function of `p` that returns a state (q, v) just after the section.

    Raises:
        BadValue: there is no coordinate, a unit is neither "m" nor "rad", or a domain has contacts.
        UnknownName: the section, a phase or a cyclic coordinate does not exist.

    Example:
        >>> from dataclasses import make_dataclass
        >>> from spear_pin import find_gait
        >>> from spear_pin.hybrid.automaton import Domain, Guard, Reset
        >>> from spear_pin.hybrid.own_dynamics import own_dynamics
        >>> Ball = make_dataclass("Ball", [("gravity", float, 9.81), ("kick", float, 2.0)], frozen=True)
        >>> bounce = Reset(jump=lambda q, v, held, p, ops: (q, [p.kick - 0.5 * v[0]]), phase="flight")
        >>> lands = Guard("lands", lambda t, q, v, held, p, dyn, ops: q[0], bounce)
        >>> flight = Domain("flight", "flight", (), lambda t, q, v, held, p, dyn, ops: [-p.gravity], guards=(lands,))
        >>> ball = own_dynamics("ball", {"z": "m"}, Ball(), [flight], section="lands", guess=lambda p: ([0.0], [3.0]))
        >>> find_gait(ball)  # kick / (1 - 0.5) = 4 m/s
        Gait(ball of 'unit_masses': period 0.8155 s, largest multiplier 0.5, stable)
    """
    masses, first = unit_masses(**units), law

    def build(
        robot: Robot | None = None, law: Any = None, spring: object = None, contact: Contact | Ground | None = None
    ) -> HybridSystem:
        numbers = first if law is None else law

        def state() -> tuple[Any, Any]:
            q, v = guess(numbers)
            return np.array(q, dtype=float), np.array(v, dtype=float)

        return HybridSystem(
            kind=kind,
            robot=robot or masses,
            law=numbers,
            springs={},
            contact=contact or Contact(),
            domains=tuple(domains),
            section=section,
            cyclic=tuple(cyclic),
            build=build,
            guess=state,
        )

    return build()
