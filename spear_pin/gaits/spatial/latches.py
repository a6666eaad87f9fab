"""Values that events latch, leg by leg: as a leg lands, trails, swings while the other group stands, and reaches down.

A leg in the air has an evolution of its own. It trails after its lift-off until the other group is down, swings while
that group is on the ground, and moves to its touchdown angles after that group has lifted off. If there is no other
group, it does so at once. A leg's contact and its evolution are separate.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from spear_pin.gaits.bounding_guards import SHORTEST_SPAN
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.spatial.legs import YAW, Group
from spear_pin.gaits.spatial.torques import LegLaw
from spear_pin.gaits.virtual_constraints import Evolution, begin_evolution, value
from spear_pin.hybrid.domain import Held
from spear_pin.model.scalars import turn

Numbers = Sequence[Any]
Legs = Sequence[Leg]


def mean_angle(group: Group, q: Numbers) -> Any:
    """Returns the mean leg angle γ of a group, whichever of its legs are on the ground."""
    return sum(value(leg.angle, q) for leg in group) / len(group.legs)


def bears(leg: Leg, own: Group, q: Numbers, v: Numbers, p: LegLaw, anew: bool) -> dict[str, Any]:
    """Starts a leg's stance.

    Args:
        leg: the leg.
        own: group of the leg.
        q: configuration.
        v: velocity.
        p: the law.
        anew: whether it is the first leg of its group to land, and is not just back.
    """
    c, s = turn(q[YAW])
    ahead = c * v[0] + s * v[1]
    adduction, hip, knee = p.torques(leg, ahead)
    latched: dict[str, Any] = {
        "flexed": 0.0,
        "hip_torque": leg.signs[1] * hip,
        "knee_torque": knee,
        "adduction": q[leg.rows[0]],
        "adduction_torque": leg.signs[0] * adduction,
    }
    of_group = {f"{own.name}_leg": mean_angle(own, q)} if anew else {}
    return {f"{leg.name}_{name}": each for name, each in latched.items()} | of_group


def flies(leg: Leg, last: Group, others: Legs, q: Numbers, v: Numbers, p: LegLaw, *, lands: bool) -> dict[str, Any]:
    """Starts a leg's motion in a flight, over the travel along its present heading.

    It trails, or moves to its touchdown angles after the group that was last on the ground has lifted off.
    """
    shapes = p.landing(leg) if lands else p.trailing(leg)
    return _begins(leg, others, _along(q), shapes, q, v, p.span_of_flight(last), p, float(lands))


def swings(leg: Leg, bearing: Group, q: Numbers, v: Numbers, held: Held, p: LegLaw) -> dict[str, Any]:
    """Starts a leg's swing while the other group is on the ground, over that group's mean leg angle."""
    whole = p.span_of_stance(bearing)
    angle = mean_angle(bearing, q)
    left = 1.0 - (angle - held.get(f"{bearing.name}_leg", angle)) / whole
    span = whole * np.maximum(left, SHORTEST_SPAN)
    return _begins(leg, bearing.legs, (0.0, 0.0, 1.0 / len(bearing.legs)), p.swing(leg), q, v, span, p, 1.0)


def waits(leg: Leg, last: Group, others: Legs, q: Numbers, p: LegLaw) -> dict[str, Any]:
    """Holds a leg that is about to land, so that its further motion depends on the state alone."""
    weights = _along(q)
    outputs = leg.outputs(others, weights)
    stays = tuple(5 * (value(row, q),) for row in outputs.rows)
    held = Evolution(stays, value(outputs.phase, q), p.span_of_flight(last))
    return _latched(leg, weights, held, 1.0, q[leg.rows[0]])


def find_landing_legs(legs: Iterable[Leg], held: Held) -> list[Leg]:
    """Returns the legs that have not been on the ground since they swung."""
    return [leg for leg in legs if held.get(f"{leg.name}_forward", 1.0) > 0.5]


def _along(q: Numbers) -> tuple[Any, Any, float]:
    return *turn(q[YAW]), 0.0


def _begins(
    leg: Leg,
    others: Legs,
    weights: tuple[Any, Any, float],
    shapes: Sequence[Sequence[float]],
    q: Numbers,
    v: Numbers,
    span: Any,
    p: LegLaw,
    forward: float,
) -> dict[str, Any]:
    evolution = begin_evolution(leg.outputs(others, weights), shapes, q, v, span)
    return _latched(leg, weights, evolution, forward, leg.signs[0] * p.adduction_touchdown(leg))


def _latched(
    leg: Leg, weights: tuple[Any, Any, float], evolution: Evolution, forward: float, lands_at: Any
) -> dict[str, Any]:
    latched = {"weights": weights, **vars(evolution), "forward": forward, "lands_at": lands_at}
    return {f"{leg.name}_{name}": each for name, each in latched.items()}
