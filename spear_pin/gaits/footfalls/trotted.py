"""A collocated trot under the law that it has the form of: an orbit of the event-exact simulation beside it."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.footfalls.course import CollocatedGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.legs import diagonals_of
from spear_pin.gaits.spatial.trot_law import TrotLaw
from spear_pin.gaits.spatial.trotting import trotting
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.result import State
from spear_pin.hybrid.symmetry import headed, mirror_of
from spear_pin.kinds import typed
from spear_pin.model.spring import Spring

ANGLE = "anterior_leg_touchdown"


@typed
def trotted(found: CollocatedGait, contact: Contact | None = None, *, apart: float = 3e-3, rtol: float = 1e-10) -> Gait:
    """The trot of the event-exact simulation beside a collocated one, by Newton's method; it takes a minute or two.

    Feet of a collocated trot land at once, where the return map has a kink in which of them is first, at which the
    method stalls; so they are asked to land one after the other.

    Args:
        found: a trot, flight in it, asked for with `law` and `swing`.
        contact: friction of the ground, more than the collocated gait was to use; by default 0.8 (assumption).
        apart: by how much less than in the collocated gait the anterior leg's angle at touchdown is to be, in rad.
        rtol: relative tolerance of the integrator.

    Raises:
        BadValue: it is no such gait.
        NoGait: Newton's method does not end in one.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.footfalls.collocate import collocated
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
        >>> request = FootfallRequest(law=StanceLaw(), swing=SwingLaw())
        >>> trot = trotted(collocated(load("q_spear_full", base="chain"), request))  # doctest: +SKIP
    """
    system, state = under_law(found, contact)
    touchdown = parameter(system, ANGLE)
    return gait_beside(with_parameters(system, {ANGLE: touchdown - apart}), state, (), {}, rtol)


def under_law(found: CollocatedGait, contact: Contact | None = None) -> tuple[HybridSystem, State]:
    """The system with the numbers of a collocated trot, and its state before touchdown; arguments as of `trotted`."""
    robot, request = found.robot, found.request
    landing, bearing = (pair.legs for pair in diagonals_of(robot))
    phases = [set(stretch.bearing) for stretch in found.stretches]
    if request.law is None or request.swing is None or phases != [{leg.name for leg in bearing}, set()]:
        expected = "a trot of stance and flight whose first pair has the posterior left leg, with `law` and `swing`"
        raise BadValue("gait", request.footfalls, expected)
    stance, flight = found.stretches
    values: dict[str, Any] = {}
    for leg in bearing:
        hip, knee, upright = found.constants[leg.name]
        trailing = _shapes(flight.evolutions[leg.name].alpha)
        values |= {f"{leg.end}_hip_torque": float(hip), f"{leg.end}_knee_torque": float(knee)}
        values |= {f"{leg.end}_squeeze": -leg.lateral * float(upright), f"{leg.end}_trailing": trailing}
    for leg in landing:
        swing, lands = stance.evolutions[leg.name], flight.evolutions[leg.name]
        angle, flexion = _shapes(lands.alpha)
        values |= {f"{leg.end}_swing": _shapes(swing.alpha), f"{leg.end}_landing": (angle[0], flexion[0])}
        values |= {f"{leg.end}_leg_touchdown": angle[-1], f"{leg.end}_spread": leg.lateral * float(lands.adduction)}
    law = TrotLaw(
        **values,
        stance_span=float(next(iter(stance.evolutions.values())).span),
        flight_span=float(next(iter(flight.evolutions.values())).span),
        leg_stiffness=request.law.stiffness,
        knee_rest=request.law.knee_rest,
        knee_touchdown=request.law.knee_rest,
        adduction_stiffness=request.law.adduction_stiffness,
        adduction_damping=request.law.adduction_damping,
        adduction_epsilon=request.swing.adduction_epsilon,
    )
    mirror = mirror_of(robot)
    q, v = headed(mirror(flight.q[-1]), mirror(flight.v[-1]))
    q[2] -= min(robot.toe_position(q, leg.toe)[-1] for leg in bearing)
    spring = request.spring or Spring(stiffness=0.0, damping=0.0)
    return trotting(robot, law, spring, contact), (q, v)


def _shapes(alpha: Any) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Coefficients of leg angle and knee from the third on."""
    angle, knee = (tuple(row[2:]) for row in np.asarray(alpha, dtype=float).tolist())
    return angle, knee
