"""Start of a run from a state alone: finds the phase of the state, and the values held in it."""

from __future__ import annotations

from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.rules.footing import AT_REST
from spear_pin.hybrid.rules.guards import NEAR_GROUND, ON_GROUND

FALLING = 1e-5  # m/s: above the integration's error for a resting toe, below a toe's speed when it strikes
STATE_AT_REST = 10.0 * AT_REST  # m/s: for a state given by the user
PLACED = 1e-15  # m: rounding error of the height of a toe that is placed on the ground


def is_placed(height: Any) -> Any:
    """Tells whether a toe at this distance from the ground, in m, is on it up to rounding."""
    return abs(height) < PLACED


def below_ground(height: Any) -> Any:
    """Tells whether a toe at this distance from the ground, in m, is below it."""
    return height < -ON_GROUND


def is_aloft(height: Any, rising: Any) -> Any:
    """Tells whether a bouncing toe is off the ground, leaves it, or is about to strike it.

    Args:
        height: height of the toe above the ground, in m.
        rising: speed of the toe along the ground's normal, in m/s.
    """
    return (height > NEAR_GROUND) | (rising > AT_REST) | (rising < -FALLING)


def rests(height: Any, rising: Any, at_rest: float = AT_REST) -> Any:
    """Tells whether a toe is on the ground and moves neither from nor into it.

    Args:
        height: height of the toe above the ground, in m.
        rising: speed of the toe along the ground's normal, in m/s.
        at_rest: largest speed that counts as rest, in m/s.
    """
    return (height <= ON_GROUND) & (abs(rising) <= at_rest)


def start(system: HybridSystem, standing: bool) -> tuple[str, tuple[Reset, ...]]:
    """Returns the phase in which a run begins, and the resets that latch the values held in it.

    The phase is treated as if it had just begun. It is the phase after the section if the state is on the section, else
    the flight before it.

    Args:
        system: the system.
        standing: whether the state is on the section: all toes on the ground after it are at rest by `STATE_AT_REST`
            or, if the section lies before the impact, one of its toes touches the ground.
    """
    flight, lands = system.landing
    into_flight = system.reset_into(flight)
    return (system.section_phase, (into_flight, lands)) if standing else (flight, (into_flight,))
