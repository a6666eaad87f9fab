"""Turns: relative periodic orbits, whose heading advances by the same angle in each stride."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from spear_pin.errors import NoGait, require
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.orbits.steering import STEERED_BY, find_steered
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.automaton import forward_speed
from spear_pin.gaits.spatial.law import INPUTS
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.event_feedback import feedback_of, with_feedback
from spear_pin.hybrid.fields import ADDED
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import displacement, multipliers, residual, return_map
from spear_pin.hybrid.result import State
from spear_pin.hybrid.symmetry import head_state
from spear_pin.kinds import typed

TURNS_BY = ("posterior_adduction", "anterior_adduction")
STEADIED_BY = tuple(name for name in INPUTS if name.endswith(("hip_torque", "knee_torque", "leg_touchdown")))
HEADING = 10.0  # weight of the yaw
RAMP, STRIDES = 20, 120  # strides of the ramp, and largest number of strides
FIRST, STEP = math.radians(4.0), math.radians(1.0)  # first turn by feedback, and largest step after that
SETTLED = 1e-5  # largest change of the state in a stride before Newton's method


@typed
def find_turn(
    gait: Gait,
    turn: float,
    *,
    rtol: float = 1e-10,
    on_stride: Callable[[int, float], object] = lambda n, change: None,
    on_turn: Callable[[float], object] = lambda angle: None,
) -> Gait:
    """Finds a turning gait from a symmetric gait: feedback steers into a small turn, and its inputs are then frozen.

    The heading to which feedback steers advances in each stride. As the motion settles, the inputs of the feedback
    become constant. With these values as parameters, and without feedback, Newton's method finds the relative periodic
    orbit; it varies the adduction of the posterior pair. For turns larger than `FIRST` the turn then grows step by
    step, at the speed of the straight gait, by the inputs of `spear_pin.gaits.orbits.steering`. The function takes some
    two minutes, and some seconds for each further degree.

    Args:
        gait: a symmetric gait in space without feedback.
        turn: change of the heading in a stride, to the left, in rad.
        rtol: relative tolerance of the integrator.
        on_stride: called with the number of each stride and the change of the state in it.
        on_turn: called with each larger turn that is reached after that, in rad.

    Raises:
        BadValue: the gait is not in space, not symmetric or has feedback, or the turn is not within ±1 rad.
        NoGait: the motion ends, or does not settle, or Newton's method does not end in a gait.
    """
    require("turn", turn, lambda angle: abs(angle) <= 1.0, "within ±1 rad a stride")
    led = add_feedback(gait, (*TURNS_BY, *STEADIED_BY), heading=HEADING, rtol=rtol)
    first = math.copysign(min(abs(turn), FIRST), turn)
    system, state = _settled(led, first, rtol, on_stride)
    if first == turn:
        return gait_beside(system, state, TURNS_BY[:1], {"turn": turn}, rtol)
    speed = forward_speed(return_map(gait.system, gait.state, rtol))
    for angle in np.linspace(first, turn, 1 + math.ceil(abs(turn - first) / STEP)).tolist():
        system, state = find_steered(system, state, angle, speed, rtol)
        on_turn(angle)
    run, solved = return_map(system, state, rtol), {name: parameter(system, name) for name in STEERED_BY}
    durations = {phase: seconds for phase, seconds in run.durations.items() if seconds > 0.0}
    return Gait(system, state, solved, residual(system, state, rtol), multipliers(system, state, rtol), durations)


def _settled(
    led: Gait, turn: float, rtol: float, on_stride: Callable[[int, float], object]
) -> tuple[HybridSystem, State]:
    """Returns the system with constant inputs and without feedback, and the state to which it has settled."""
    state, heading, change = led.state, 0.0, np.inf
    feedback = feedback_of(led.system)
    assert feedback is not None
    for n in range(1, STRIDES + 1):
        heading += turn * min(1.0, n / RAMP)
        steered = with_feedback(led.system, replace(feedback, heading=heading))
        run = return_map(steered, state, rtol)
        if not run.cycles:
            raise NoGait(f"the turn was lost in stride {n}: {run.message}", change, remedy="a smaller turn")
        change = float(np.abs(displacement(steered, state, run.state)).max())
        state = run.state
        on_stride(n, change)
        if n > RAMP and change < SETTLED:
            break
    else:
        raise NoGait(f"the turn does not settle in {STRIDES} strides", change, remedy="a smaller turn")
    values = {name: parameter(led.system, name) + run.held[ADDED + name] for name in feedback.inputs}
    frozen = with_feedback(led.with_law(nominal=()).system, None)
    return with_parameters(frozen, values), head_state(*state)
