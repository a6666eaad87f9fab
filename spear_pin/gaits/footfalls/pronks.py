"""From a collocated pronk to an orbit of the event-exact simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from spear_pin.gaits.bounding_law import LEGS, PAIR, BoundingLaw
from spear_pin.gaits.footfalls.beside import APART, laws_of, orbit_beside
from spear_pin.gaits.footfalls.course import CollocatedGait
from spear_pin.gaits.footfalls.limbs import legs_of
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import FLIGHTS
from spear_pin.gaits.spatial.pronking import pronking
from spear_pin.hybrid.symmetry import headed
from spear_pin.kinds import typed

NOTHING = ((0.0,) * 4,) * 2  # coefficients of motions that no leg of a pronk makes
NO_SPAN = -0.4  # rad: span of a stance, over which no leg swings


@typed
def pronk_beside(gait: CollocatedGait, *, apart: Sequence[float] = APART) -> Gait:
    """Finds the pronk of the event-exact simulation near a collocated one, at the requested speed.

    Args:
        gait: a pronk with a law on the ground and in the air.
        apart: changes, in rad, of the angle at which the fore legs land; they are tried in turn.

    Raises:
        BadValue: the gait is not such a pronk, or `apart` is empty.
        NoGait: there is no fixed point nearby.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.footfalls.collocate import collocated
        >>> from spear_pin.gaits.footfalls.pronks import pronk_beside
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
        >>> from spear_pin.gaits.footfalls.sequence import FOOTFALLS
        >>> robot = load("q_spear_full", base="chain")
        >>> asked = FootfallRequest(footfalls=FOOTFALLS["pronk"], law=StanceLaw(), swing=SwingLaw())
        >>> pronk = pronk_beside(collocated(robot, asked))  # some minutes  # doctest: +SKIP
    """
    last = gait.stretches[-1]
    system = pronking(gait.robot, law_of_pronk(gait), gait.request.spring)
    start = headed(last.q[-1], last.v[-1])
    return orbit_beside(system, start, gait.request.speed, apart, lambda system, cycle: cycle.state)


def law_of_pronk(gait: CollocatedGait) -> SpatialLaw:
    """Returns the law of a collocated pronk: that of its left legs, from which the right legs hardly differ.

    Raises:
        BadValue: the gait is not a pronk with a law on the ground and in the air.
    """
    law, swing = laws_of(gait, (FOOTFALLS["pronk"],), "pronk")
    _, flight = gait.stretches
    plane: dict[str, Any] = {
        **{f"{each}_trailing": NOTHING for each in FLIGHTS},
        **{f"{end}_stance_swing": NOTHING for end in LEGS},
        **{f"{end}_stance_span": NO_SPAN for end in LEGS},
    }
    across: dict[str, Any] = {}
    landings = dict(zip(LEGS, FLIGHTS[::-1], strict=True))  # a bound's, before the touchdown of each pair
    for name, leg in legs_of(gait.robot).items():
        if leg.lateral < 0:
            continue
        hip, knee, upright = gait.constants[name]
        landing = flight.evolutions[name]
        plane |= {
            f"{leg.end}_hip_torque": PAIR * leg.signs[1] * hip,
            f"{leg.end}_knee_torque": PAIR * knee,
            f"{leg.end}_leg_touchdown": float(landing.alpha[0, -1]),
            f"{landings[leg.end]}_landing": tuple(landing.alpha[:, 2].tolist()),
            **{f"{each}_span": landing.span for each in FLIGHTS},
        }
        across |= {
            f"{leg.end}_spread": leg.signs[0] * landing.adduction,
            f"{leg.end}_squeeze": -leg.signs[0] * upright,
        }
    return SpatialLaw(
        BoundingLaw(
            **plane,
            virtual_stiffness=PAIR * law.stiffness,
            knee_rest=law.knee_rest,
            knee_touchdown=law.knee_rest,
            epsilon=swing.epsilon,
        ),
        **across,
        adduction_stiffness=law.adduction_stiffness,
        adduction_damping=law.adduction_damping,
        adduction_epsilon=swing.adduction_epsilon,
    )
