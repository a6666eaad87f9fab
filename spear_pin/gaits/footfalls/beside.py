"""From a collocated trot, pace or pronk to the nearby orbit of the event-exact simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.bounding_law import LEGS, PAIR, BoundingLaw
from spear_pin.gaits.footfalls.course import CollocatedGait
from spear_pin.gaits.footfalls.limbs import legs_of
from spear_pin.gaits.footfalls.request import StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import FLIGHTS
from spear_pin.gaits.spatial.pronking import pronking
from spear_pin.gaits.spatial.trot_law import TrotLaw
from spear_pin.gaits.spatial.trotting import ALIKE, halfway, pacing, trotting
from spear_pin.gaits.virtual_constraints import Evolution
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.symmetry import even_out, head_state, measure_asymmetry, mirror_of
from spear_pin.kinds import typed

SPEED_BY, LANDS_AT = "posterior_hip_torque", "anterior_leg_touchdown"
APART = (0.0, 0.004, -0.004)  # rad: changes of the fore legs' landing angle, against kinks
NOTHING = ((0.0,) * 4,) * 2  # coefficients of motions that no leg of a pronk makes
NO_SPAN = -0.4  # rad: span of a stance, over which no leg swings


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
        >>> from spear_pin.gaits.footfalls.beside import trot_beside
        >>> from spear_pin.gaits.footfalls.collocate import collocate
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
        >>> robot, asked = load("q_spear_full", base="chain"), FootfallRequest(law=StanceLaw(), swing=SwingLaw())
        >>> trot = trot_beside(collocate(robot, asked))  # half a minute  # doctest: +SKIP
    """
    robot, mirror, last = gait.robot, mirror_of(gait.robot), gait.stretches[-1]
    law, uneven = law_of_trot(gait), measure_asymmetry(robot) > ALIKE
    build = trotting if gait.request.footfalls.phases == FOOTFALLS["trot"].phases else pacing
    system = build(even_out(robot) if uneven else robot, law, gait.request.spring)
    start = head_state(mirror(last.q[-1]), mirror(last.v[-1]))
    found = _orbit_beside(system, start, gait.request.speed, apart, halfway)
    if not uneven:
        return found
    return _nearby(build(robot, found.system.law, found.system.springs), found.state, gait.request.speed)


@typed
def pronk_beside(gait: CollocatedGait, *, apart: Sequence[float] = APART) -> Gait:
    """Finds the pronk of the event-exact simulation near a collocated one; see `trot_beside` for the arguments.

    Raises:
        BadValue: the gait is not such a pronk, or `apart` is empty.
        NoGait: there is no fixed point nearby.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.footfalls.beside import pronk_beside
        >>> from spear_pin.gaits.footfalls.collocate import collocate
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
        >>> from spear_pin.gaits.footfalls.sequence import FOOTFALLS
        >>> robot = load("q_spear_full", base="chain")
        >>> asked = FootfallRequest(footfalls=FOOTFALLS["pronk"], law=StanceLaw(), swing=SwingLaw())
        >>> pronk = pronk_beside(collocate(robot, asked))  # some minutes  # doctest: +SKIP
    """
    last = gait.stretches[-1]
    system = pronking(gait.robot, law_of_pronk(gait), gait.request.spring)
    start = head_state(last.q[-1], last.v[-1])
    return _orbit_beside(system, start, gait.request.speed, apart, lambda system, cycle: cycle.state)


def law_of_trot(gait: CollocatedGait) -> TrotLaw:
    """Returns the law of a collocated trot or pace.

    Raises:
        BadValue: the gait is not a mirrored trot or pace with a law on the ground and in the air.
    """
    law, swing = _laws_of(gait, ("trot", "pace"), "mirrored trot or pace")
    stance, flight = gait.stretches
    numbers: dict[str, Any] = {}
    for name, leg in legs_of(gait.robot).items():
        last = flight.evolutions[name]
        if name in stance.bearing:
            numbers |= {**_on_ground(gait, leg), f"{leg.end}_trailing": tuple(row[2:] for row in last.alpha)}
            continue
        numbers |= {
            **_landing(gait, leg, last),
            f"{leg.end}_swing": tuple(row[2:] for row in stance.evolutions[name].alpha),
            f"{leg.end}_landing": tuple(row[2] for row in last.alpha),
            "stance_span": stance.evolutions[name].span,
            "flight_span": last.span,
        }
    plane, across = _shared(law, swing)
    return TrotLaw(leg_stiffness=law.stiffness, **plane, **across, **numbers)


def law_of_pronk(gait: CollocatedGait) -> SpatialLaw:
    """Returns the law of a collocated pronk: that of its left legs, from which the right legs hardly differ.

    Raises:
        BadValue: the gait is not a pronk with a law on the ground and in the air.
    """
    law, swing = _laws_of(gait, ("pronk",), "pronk")
    _, flight = gait.stretches
    plane, across = _shared(law, swing)
    plane |= {
        "virtual_stiffness": PAIR * law.stiffness,
        **{f"{each}_trailing": NOTHING for each in FLIGHTS},
        **{f"{end}_stance_swing": NOTHING for end in LEGS},
        **{f"{end}_stance_span": NO_SPAN for end in LEGS},
    }
    landings = dict(zip(LEGS, FLIGHTS[::-1], strict=True))  # a bound's, before the touchdown of each pair
    for name, leg in legs_of(gait.robot).items():
        if leg.lateral < 0:
            continue
        last = flight.evolutions[name]
        for field, value in {**_on_ground(gait, leg), **_landing(gait, leg, last)}.items():
            of = across if field.endswith(("spread", "squeeze")) else plane
            of[field] = PAIR * value if field.endswith("torque") else value
        plane[f"{landings[leg.end]}_landing"] = tuple(row[2] for row in last.alpha)
        plane |= {f"{each}_span": last.span for each in FLIGHTS}
    return SpatialLaw(BoundingLaw(**plane), **across)


def _on_ground(gait: CollocatedGait, leg: Leg) -> dict[str, float]:
    """Returns the numbers of a law for a leg on the ground."""
    hip, knee, upright = gait.constants[leg.name]
    squeeze = -leg.lateral * leg.signs[0] * upright
    return {f"{leg.end}_hip_torque": leg.signs[1] * hip, f"{leg.end}_knee_torque": knee, f"{leg.end}_squeeze": squeeze}


def _landing(gait: CollocatedGait, leg: Leg, last: Evolution) -> dict[str, float]:
    """Returns the angles of a law at which a leg lands."""
    spread = leg.lateral * leg.signs[0] * gait.aims[leg.name]
    return {f"{leg.end}_leg_touchdown": last.alpha[0][-1], f"{leg.end}_spread": spread}


def _shared(law: StanceLaw, swing: SwingLaw) -> tuple[dict[str, Any], dict[str, Any]]:
    """Returns the numbers that all legs share: those of a plane's law, and those of the adductions."""
    plane = {"knee_rest": law.knee_rest, "knee_touchdown": law.knee_rest, "epsilon": swing.epsilon}
    across = {name: getattr(law, name) for name in ("adduction_stiffness", "adduction_damping")}
    return plane, {**across, "adduction_epsilon": swing.adduction_epsilon}


def _laws_of(gait: CollocatedGait, among: Sequence[str], called: str) -> tuple[StanceLaw, SwingLaw]:
    """Returns the laws on the ground and in the air of a gait with one of some footfalls, on any mesh.

    Raises:
        BadValue: the gait has other footfalls, or no such laws.
    """
    law, swing, own = gait.request.law, gait.request.swing, gait.request.footfalls
    known = any(
        (each.phases, each.mirrored) == (own.phases, own.mirrored) for each in map(FOOTFALLS.__getitem__, among)
    )
    if law is None or swing is None or not known:
        raise BadValue("gait", own.phases, f"a {called} whose request has law=StanceLaw(...) and swing=SwingLaw(...)")
    return law, swing


def _orbit_beside(
    system: HybridSystem,
    state: State,
    speed: float,
    apart: Sequence[float],
    after: Callable[[HybridSystem, Run], State],
) -> Gait:
    """Finds the fixed point near a state, at a speed, after a cycle that puts legs in the air on their polynomials.

    Args:
        system: a system with the law of the collocated gait.
        state: headed state just before the touchdown.
        speed: wanted speed, in m/s.
        apart: changes of the angle at which the fore legs land; see `trot_beside`.
        after: returns the state after a cycle, at which Newton's method begins.

    Raises:
        BadValue: `apart` is empty.
        NoGait: there is no fixed point nearby.
    """
    origin = np.zeros(2 * system.robot.nv - 4)
    on_section: State = chart(system, state).state(origin)
    failures: list[NoGait] = []
    for change in apart:
        changed = with_parameters(system, {LANDS_AT: parameter(system, LANDS_AT) + change})
        try:
            cycle = return_map(changed, on_section)
            if not cycle.cycles:
                raise NoGait(f"the stride of the collocated gait does not close: {cycle.message}", np.inf)
            settled = chart(changed, after(changed, cycle)).state(origin)
            return _nearby(changed, settled, speed)
        except NoGait as failure:
            failures.append(failure)
    if not failures:
        raise BadValue("apart", apart, "at least one angle, in rad")
    raise min(failures, key=lambda failure: failure.residual)


def _nearby(system: HybridSystem, state: State, speed: float) -> Gait:
    """Finds the fixed point by Newton's method from a nearby state, at a speed; the law keeps it.

    Args:
        system: a system with the law of the collocated gait.
        state: state on its section.
        speed: wanted speed, in m/s.

    Raises:
        NoGait: Newton's method does not converge to a fixed point.
    """
    found = gait_beside(system, state, (SPEED_BY,), {"mean_speed": speed})
    q, v = found.state
    nominal: Any = (*q.tolist(), *v.tolist())
    return found.with_law(nominal=nominal)
