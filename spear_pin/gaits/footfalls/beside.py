"""From a collocated gait's law and state to the nearby orbit of the event-exact simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.footfalls.course import CollocatedGait, Swing
from spear_pin.gaits.footfalls.request import StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import Footfalls
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import Run, State

SPEED_BY, LANDS_AT = "posterior_hip_torque", "anterior_leg_touchdown"
APART = (0.0, 0.004, -0.004)  # rad: changes of the fore legs' landing angle, against kinks


def laws_of(gait: CollocatedGait, among: Sequence[Footfalls], called: str) -> tuple[StanceLaw, SwingLaw]:
    """Returns the laws on the ground and in the air of a gait with one of some footfalls, on any mesh.

    Raises:
        BadValue: the gait has other footfalls, or no such laws.
    """
    law, swing, own = gait.request.law, gait.request.swing, gait.request.footfalls
    known = any((each.phases, each.mirrored) == (own.phases, own.mirrored) for each in among)
    if law is None or swing is None or not known:
        raise BadValue("gait", own.phases, f"a {called} whose request has law=StanceLaw(...) and swing=SwingLaw(...)")
    return law, swing


def shape(swing: Swing) -> tuple[tuple[float, ...], ...]:
    """Returns a leg's Bézier coefficients from the third on."""
    return tuple(tuple(row) for row in swing.alpha[:, 2:].tolist())


def orbit_beside(
    system: HybridSystem,
    state: State,
    speed: float,
    apart: Sequence[float],
    after: Callable[[HybridSystem, Run], State],
) -> Gait:
    """Finds the fixed point near a state, at a speed, after a cycle that puts legs in the air on their polynomials.

    Where feet of a group land at once, the return map has a kink, because either foot may be first. If Newton's method
    stalls there, the function changes the angle at which the fore legs land.

    Args:
        system: a system with the law of the collocated gait.
        state: headed state just before the touchdown.
        speed: wanted speed, in m/s.
        apart: changes of that angle, in rad, which are tried in turn.
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
            return nearby(changed, settled, speed)
        except NoGait as failure:
            failures.append(failure)
    if not failures:
        raise BadValue("apart", apart, "at least one angle, in rad")
    raise min(failures, key=lambda failure: failure.residual)


def nearby(system: HybridSystem, state: State, speed: float) -> Gait:
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
