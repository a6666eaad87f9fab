"""From a collocated trot or pace to an orbit of the event-exact simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.footfalls.course import CollocatedGait, Swing
from spear_pin.gaits.footfalls.limbs import legs_of
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.law import is_angle
from spear_pin.gaits.spatial.trot_law import TROT_INPUTS, TrotLaw
from spear_pin.gaits.spatial.trotting import halfway, pacing, trotting
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import State
from spear_pin.hybrid.symmetry import headed, mirror_of
from spear_pin.kinds import typed
from spear_pin.model.scale import scale_in_space

SPEED_BY, LANDS_AT = "posterior_hip_torque", "anterior_leg_touchdown"
APART = (0.0, 0.004, -0.004)  # rad: by how much fore legs may land more ahead, so that a pair does not land at once


@typed
def trot_beside(gait: CollocatedGait, *, apart: Sequence[float] = APART) -> Gait:
    """The trot, or pace, of the event-exact simulation beside a collocated one, at the speed that was asked for.

    Where both feet of a pair land at once the return map has a kink, in which of them is first. Where Newton's method
    stalls there, the angle at which the fore legs land is changed.

    Args:
        gait: a mirrored trot or pace with a law on the ground and in the air.
        apart: changes of that angle to try in turn, in rad.

    Raises:
        BadValue: it is another, or there is no change to try.
        NoGait: there is none beside it.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.footfalls.collocate import collocated
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
        >>> from spear_pin.gaits.footfalls.trots import trot_beside
        >>> robot, asked = load("q_spear_full", base="chain"), FootfallRequest(law=StanceLaw(), swing=SwingLaw())
        >>> trot = trot_beside(collocated(robot, asked))  # half a minute  # doctest: +SKIP
    """
    mirror, last = mirror_of(gait.robot), gait.stretches[-1]
    law = law_of_trot(gait)
    build = trotting if gait.request.footfalls.phases == FOOTFALLS["trot"].phases else pacing
    system = build(gait.robot, law, gait.request.spring)
    start = headed(mirror(last.q[-1]), mirror(last.v[-1]))
    on_section = chart(system, start).state(np.zeros(2 * gait.robot.nv - 4))
    failures: list[NoGait] = []
    for change in apart:
        changed = with_parameters(system, {LANDS_AT: parameter(system, LANDS_AT) + change})
        try:
            found = gait_beside(changed, _settled(changed, on_section), (SPEED_BY,), {"mean_speed": gait.request.speed})
        except NoGait as failure:
            failures.append(failure)
            continue
        q, v = found.state
        return found.with_law(nominal=(*q.tolist(), *v.tolist()))
    if not failures:
        raise BadValue("apart", apart, "at least one angle, in rad")
    raise min(failures, key=lambda failure: failure.residual)


def _settled(system: HybridSystem, state: State) -> State:
    """The state half a stride later, legs in the air on their polynomials; seen in the mirror, on the section.

    Raises:
        NoGait: it does not get there.
    """
    cycle = return_map(system, state)
    if not cycle.cycles:
        raise NoGait(f"the stride of the collocated gait does not close: {cycle.message}", np.inf)
    return chart(system, halfway(system, cycle)).state(np.zeros(2 * system.robot.nv - 4))


def law_of_trot(gait: CollocatedGait) -> TrotLaw:
    """The law of a collocated trot or pace.

    Raises:
        BadValue: it is no mirrored one with a law on the ground and in the air.
    """
    request = gait.request
    law, swing, footfalls = request.law, request.swing, request.footfalls
    known = footfalls.phases in (FOOTFALLS["trot"].phases, FOOTFALLS["pace"].phases) and footfalls.mirrored
    if law is None or swing is None or not known:
        expected = "a mirrored trot or pace with law=StanceLaw(...), swing=SwingLaw(...)"
        raise BadValue("gait", request.footfalls.phases, expected)
    (stance, flight), torque = gait.stretches, scale_in_space(gait.robot).torque
    numbers: dict[str, Any] = {}
    for name, leg in legs_of(gait.robot).items():
        end = leg.end
        if name in stance.bearing:
            hip, knee, upright = gait.constants[name]
            trailing = flight.evolutions[name]
            numbers |= {
                f"{end}_hip_torque": leg.signs[1] * hip,
                f"{end}_knee_torque": knee,
                f"{end}_squeeze": -leg.lateral * leg.signs[0] * upright,
                f"{end}_trailing": _shape(trailing),
            }
            continue
        landing = flight.evolutions[name]
        numbers |= {
            f"{end}_swing": _shape(stance.evolutions[name]),
            f"{end}_landing": tuple(landing.alpha[:, 2].tolist()),
            f"{end}_leg_touchdown": float(landing.alpha[0, -1]),
            f"{end}_spread": leg.lateral * leg.signs[0] * landing.adduction,
            "stance_span": stance.evolutions[name].span,
            "flight_span": landing.span,
        }
    return TrotLaw(
        leg_stiffness=law.stiffness,
        knee_rest=law.knee_rest,
        knee_touchdown=law.knee_rest,
        adduction_stiffness=law.adduction_stiffness,
        adduction_damping=law.adduction_damping,
        adduction_epsilon=swing.adduction_epsilon,
        epsilon=swing.epsilon,
        feedback_limits=tuple(
            limit * (1.0 if is_angle(name) else torque)
            for name, limit in zip(TROT_INPUTS, TrotLaw.feedback_limits, strict=True)
        ),
        **numbers,
    )


def _shape(swing: Swing) -> tuple[tuple[float, ...], ...]:
    """Coefficients from the third on."""
    return tuple(tuple(row) for row in swing.alpha[:, 2:].tolist())
