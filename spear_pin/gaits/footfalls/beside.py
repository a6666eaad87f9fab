"""From a collocated gait's law and state to the orbit of the event-exact simulation beside it."""

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
APART = (0.0, 0.004, -0.004)  # rad: by how much fore legs may land more ahead, so that a group does not land at once


def laws_of(gait: CollocatedGait, among: Sequence[Footfalls], called: str) -> tuple[StanceLaw, SwingLaw]:
    """The laws on the ground and in the air of a gait of some footfalls, on any mesh.

    Raises:
        BadValue: it has other footfalls, or no such laws.
    """
    law, swing, own = gait.request.law, gait.request.swing, gait.request.footfalls
    known = any((each.phases, each.mirrored) == (own.phases, own.mirrored) for each in among)
    if law is None or swing is None or not known:
        raise BadValue("gait", own.phases, f"a {called} with law=StanceLaw(...), swing=SwingLaw(...)")
    return law, swing


def shape(swing: Swing) -> tuple[tuple[float, ...], ...]:
    """Coefficients from the third on."""
    return tuple(tuple(row) for row in swing.alpha[:, 2:].tolist())


def orbit_beside(
    system: HybridSystem,
    state: State,
    speed: float,
    apart: Sequence[float],
    after: Callable[[HybridSystem, Run], State],
) -> Gait:
    """The fixed point beside a state, at a speed, after a cycle that puts legs in the air on their polynomials.

    Where feet of a group land at once the return map has a kink, in which of them is first. Where Newton's method
    stalls there, the angle at which the fore legs land is changed.

    Args:
        system: with the law of the collocated gait.
        state: headed, before its touchdown.
        speed: wanted, in m/s.
        apart: changes of that angle to try in turn, in rad.
        after: the state after a cycle that Newton's method begins at.

    Raises:
        BadValue: there is no change to try.
        NoGait: there is none beside it.
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
    """The fixed point by Newton's method from a state that all but is one, at a speed; feedback compares with it.

    Args:
        system: as of `orbit_beside`.
        state: on its section.
        speed: wanted, in m/s.

    Raises:
        NoGait: Newton's method does not end in one.
    """
    found = gait_beside(system, state, (SPEED_BY,), {"mean_speed": speed})
    q, v = found.state
    nominal: Any = (*q.tolist(), *v.tolist())
    return found.with_law(nominal=nominal)
