"""Start of a run from a state alone: in which phase it lies, and what is held there."""

from __future__ import annotations

from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.rules.footing import AT_REST
from spear_pin.hybrid.rules.guards import NEAR_GROUND, ON_GROUND

FALLING = 1e-5  # m/s: above what integration leaves of a toe's rest on the ground, below what it strikes with
STATE_AT_REST = 10.0 * AT_REST  # m/s: of a state that is given
PLACED = 1e-15  # m: what rounding leaves of the height of a toe that is put on the ground


def placed(height: Any) -> Any:
    """Whether a toe at a distance from the ground, in m, is on it as exactly as one can be put there."""
    return abs(height) < PLACED


def below_ground(height: Any) -> Any:
    """Whether a toe at a distance from the ground, in m, is below it."""
    return height < -ON_GROUND


def aloft(height: Any, rising: Any) -> Any:
    """Whether a toe that bounces is off the ground, leaves it, or is about to strike it.

    Args:
        height: of the toe above the ground, in m.
        rising: its speed along the ground's normal, in m/s.
    """
    return (height > NEAR_GROUND) | (rising > AT_REST) | (rising < -FALLING)


def rests(height: Any, rising: Any, at_rest: float = AT_REST) -> Any:
    """Whether a toe is on the ground and moves neither from nor into it.

    Args:
        height: of the toe above the ground, in m.
        rising: its speed along the ground's normal, in m/s.
        at_rest: up to which speed it is at rest, in m/s.
    """
    return (height <= ON_GROUND) & (abs(rising) <= at_rest)


def start(system: HybridSystem, standing: bool) -> tuple[str, tuple[Reset, ...]]:
    """The phase in which a run begins, and the resets whose latches say what is held there.

    It is as if the phase had just begun: that which follows the section if the state is on it, else flight before it.

    Args:
        system: the system.
        standing: whether the state is on the section: all toes that are on the ground after it rest there by
            `STATE_AT_REST`, or where it lies before the impact a toe of it touches the ground.
    """
    flight, lands = system.landing
    into_flight = system.reset_into(flight)
    return (system.section_phase, (into_flight, lands)) if standing else (flight, (into_flight,))
