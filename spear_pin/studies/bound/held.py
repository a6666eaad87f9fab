"""Bounds of a request that are active at a gait found by a search."""

from __future__ import annotations

from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.request import SHORTEST_FLIGHT, Request
from spear_pin.kinds import typed
from spear_pin.model.scale import scale_of

AT = 0.02  # of a bound: a gait that near is held by it


@typed
def list_active_bounds(gait: Gait, request: Request, friction: float) -> tuple[str, ...]:
    """Lists the bounds of a request, in words, that are active at a gait: without them a better gait would exist.

    Args:
        gait: gait that the search found.
        request: request of the search.
        friction: largest ratio of tangential to normal force in the gait.
    """
    found = []
    for leg in LEGS:
        if gait.durations[f"{leg}_stance"] <= (1.0 + AT) * request.minimum_stance:
            found.append(f"the {leg} stance is as short as it may be")
        if getattr(gait.system.law, f"{leg}_knee_torque") <= (1.0 + AT) * request.minimum_knee_torque:
            found.append(f"the {leg} knee's torque at rest is the least allowed")
    shortest = (1.0 + AT) * SHORTEST_FLIGHT * scale_of(gait.system.robot).time
    found += [f"flight {i} is as short as it may be" for i in (1, 2) if gait.durations[f"flight_{i}"] <= shortest]
    if friction >= (1.0 - 2 * AT) * request.friction:
        found.append("friction is used up")
    return tuple(found)
