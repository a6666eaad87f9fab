"""From a collocated trot or pace to an orbit of the event-exact simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from spear_pin.gaits.footfalls.beside import APART, laws_of, nearby, orbit_beside, shape
from spear_pin.gaits.footfalls.course import CollocatedGait
from spear_pin.gaits.footfalls.limbs import legs_of
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.spatial.trot_law import TrotLaw
from spear_pin.gaits.spatial.trotting import ALIKE, halfway, pacing, trotting
from spear_pin.hybrid.symmetry import evened, headed, lopsided, mirror_of
from spear_pin.kinds import typed


@typed
def trot_beside(gait: CollocatedGait, *, apart: Sequence[float] = APART) -> Gait:
    """Finds the trot, or pace, of the event-exact simulation near a collocated one, at the requested speed.

    Where both feet of a pair land at once, the return map has a kink, because either foot may be first. If Newton's
    method stalls there, the function changes the angle at which the fore legs land. For a robot whose left and right
    differ, it first finds the gait of a robot with mean inertias, which is half a stride long, and starts from there.

    Args:
        gait: a mirrored trot or pace with a law on the ground and in the air.
        apart: changes of that angle, in rad, which are tried in turn.

    Raises:
        BadValue: the gait is not such a trot or pace, or `apart` is empty.
        NoGait: there is no fixed point nearby.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.footfalls.collocate import collocated
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
        >>> from spear_pin.gaits.footfalls.trots import trot_beside
        >>> robot, asked = load("q_spear_full", base="chain"), FootfallRequest(law=StanceLaw(), swing=SwingLaw())
        >>> trot = trot_beside(collocated(robot, asked))  # half a minute  # doctest: +SKIP
    """
    robot, mirror, last = gait.robot, mirror_of(gait.robot), gait.stretches[-1]
    law, uneven = law_of_trot(gait), lopsided(robot) > ALIKE
    build = trotting if gait.request.footfalls.phases == FOOTFALLS["trot"].phases else pacing
    system = build(evened(robot) if uneven else robot, law, gait.request.spring)
    start = headed(mirror(last.q[-1]), mirror(last.v[-1]))
    found = orbit_beside(system, start, gait.request.speed, apart, halfway)
    if not uneven:
        return found
    return nearby(build(robot, found.system.law, found.system.spring), found.state, gait.request.speed)


def law_of_trot(gait: CollocatedGait) -> TrotLaw:
    """Returns the law of a collocated trot or pace.

    Raises:
        BadValue: the gait is not a mirrored trot or pace with a law on the ground and in the air.
    """
    law, swing = laws_of(gait, (FOOTFALLS["trot"], FOOTFALLS["pace"]), "mirrored trot or pace")
    stance, flight = gait.stretches
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
                f"{end}_trailing": shape(trailing),
            }
            continue
        landing = flight.evolutions[name]
        numbers |= {
            f"{end}_swing": shape(stance.evolutions[name]),
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
        **numbers,
    )
