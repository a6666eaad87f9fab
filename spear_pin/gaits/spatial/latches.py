"""What events latch, leg by leg: as one begins to bear, to trail, to swing while the other pair bears, and to land.

A leg in the air has an evolution of its own. It trails after its lift-off until the other pair is down, swings while
that bears, and lands after that has lifted off. Its contact and its evolution are two things.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from spear_pin.gaits.bounding_guards import SHORTEST_SPAN
from spear_pin.gaits.spatial.legs import YAW, Leg, Pair
from spear_pin.gaits.spatial.torques import LegLaw
from spear_pin.gaits.virtual_constraints import begun, value
from spear_pin.hybrid.domain import Held

Numbers = Sequence[float]


def mean_angle(pair: Pair, q: Numbers) -> float:
    """Mean leg angle γ of a pair, whichever of its legs is on the ground."""
    left, right = (value(leg.angle, q) for leg in pair)
    return float(0.5 * (left + right))


def bears(leg: Leg, pair: Pair, q: Numbers, v: Numbers, held: Held, p: LegLaw, anew: bool) -> dict[str, Any]:
    """A leg begins to bear.

    Args:
        leg: the leg.
        pair: its own.
        q: configuration.
        v: velocity.
        held: what is held.
        p: the law.
        anew: whether it is the first of its pair, and not just back.
    """
    ahead = math.cos(q[YAW]) * v[0] + math.sin(q[YAW]) * v[1]
    adduction, hip, knee = p.torques(leg, held, ahead)
    latched: dict[str, Any] = {
        "rest": q[leg.knee],
        "taut": 1.0,
        "flexed": 0.0,
        "hip_torque": leg.signs[1] * hip,
        "knee_torque": knee,
        "adduction": q[leg.adduction],
        "adduction_torque": leg.signs[0] * adduction,
    }
    of_pair = {f"{pair.name}_leg": mean_angle(pair, q)} if anew else {}
    return {f"{leg.name}_{name}": each for name, each in latched.items()} | of_pair


def trails(leg: Leg, own: Pair, others: Pair, q: Numbers, v: Numbers, held: Held, p: LegLaw) -> dict[str, Any]:
    """A leg trails, over the travel along the heading that it has now."""
    return _begins(leg, others, _along(q), p.trailing(leg), q, v, p.span_of_flight(own), held, p, 0.0)


def swings(leg: Leg, others: Pair, q: Numbers, v: Numbers, held: Held, p: LegLaw) -> dict[str, Any]:
    """A leg swings while the other pair bears, over the mean leg angle of that."""
    whole = p.span_of_stance(others)
    angle = mean_angle(others, q)
    left = 1.0 - (angle - held.get(f"{others.name}_leg", angle)) / whole
    span = whole * np.maximum(left, SHORTEST_SPAN)
    return _begins(leg, others, (0.0, 0.0, 0.5), p.swing(leg), q, v, span, held, p, 1.0)


def lands(leg: Leg, others: Pair, q: Numbers, v: Numbers, held: Held, p: LegLaw) -> dict[str, Any]:
    """A leg is brought to its touchdown angles after the other pair has lifted off."""
    return _begins(leg, others, _along(q), p.landing(leg, held), q, v, p.span_of_flight(others), held, p, 1.0)


def waits(leg: Leg, others: Pair, q: Numbers, p: LegLaw) -> dict[str, Any]:
    """A leg about to land stays as it is, so that all that it will do depends on the state alone."""
    weights = _along(q)
    outputs = leg.outputs(others, weights)
    stays = tuple(5 * (float(value(row, q)),) for row in outputs.rows)
    origin, span = float(value(outputs.phase, q)), p.span_of_flight(others)
    return _named(leg, weights, stays, origin, span, 1.0) | {f"{leg.name}_lands_at": q[leg.adduction]}


def landing(legs: Iterable[Leg], held: Held) -> list[Leg]:
    """The legs that have not been on the ground since they swung."""
    return [leg for leg in legs if held.get(f"{leg.name}_forward", 1.0) > 0.5]


def _along(q: Numbers) -> tuple[float, float, float]:
    return math.cos(q[YAW]), math.sin(q[YAW]), 0.0


def _begins(
    leg: Leg,
    others: Pair,
    weights: tuple[float, float, float],
    shapes: Sequence[Sequence[float]],
    q: Numbers,
    v: Numbers,
    span: float,
    held: Held,
    p: LegLaw,
    forward: float,
) -> dict[str, Any]:
    evolution = begun(leg.outputs(others, weights), shapes, q, v, span)
    named = _named(leg, weights, evolution.alpha, evolution.origin, evolution.span, forward)
    return named | {f"{leg.name}_lands_at": leg.signs[0] * p.adduction_touchdown(leg, held)}


def _named(
    leg: Leg, weights: tuple[float, float, float], alpha: Any, origin: float, span: float, forward: float
) -> dict[str, Any]:
    latched = {"weights": weights, "alpha": alpha, "origin": origin, "span": span, "past": 0.0, "forward": forward}
    return {f"{leg.name}_{name}": each for name, each in latched.items()}
