"""Turns: relative periodic orbits, whose heading advances by the same angle each stride."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from spear_pin.errors import NoGait, require
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.orbits.balance import balanced
from spear_pin.gaits.orbits.steering import STEERED_BY, turned
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.law import INPUTS
from spear_pin.gaits.spatial.torques import ADJUSTED
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import displacement, multipliers, residual, return_map
from spear_pin.hybrid.result import State
from spear_pin.hybrid.symmetry import headed
from spear_pin.kinds import typed

TURNS_BY = ("posterior_adduction", "anterior_adduction")
STEADIED_BY = tuple(name for name in INPUTS if name.endswith(("hip_torque", "knee_torque", "leg_touchdown")))
HEADING = 10.0  # weight of the yaw
RAMP, STRIDES = 20, 120  # strides over which the turn is taken up, and at most
FIRST, STEP = math.radians(4.0), math.radians(1.0)  # led there by feedback, and then on in steps of at most
SETTLED = 1e-5  # of the state from stride to stride: Newton's method does the rest


@typed
def turning(
    gait: Gait,
    turn: float,
    *,
    rtol: float = 1e-10,
    on_stride: Callable[[int, float], object] = lambda n, change: None,
    on_turn: Callable[[float], object] = lambda angle: None,
) -> Gait:
    """A gait that turns, from a symmetric one: led into a small turn by feedback, whose inputs are then frozen.

    The heading that feedback steers to advances each stride; as the motion settles, its inputs become constant. With
    these as parameters and without feedback Newton's method finds the relative periodic orbit, varying the adduction of
    the posterior pair. From `FIRST` on it goes on turn by turn, at the speed of the straight gait, by the inputs of
    `spear_pin.gaits.orbits.steering`. It takes some two minutes, and half a minute for each further degree.

    Args:
        gait: in space, symmetric, without feedback.
        turn: of the heading in a stride, to the left, in rad.
        rtol: relative tolerance of the integrator.
        on_stride: called with the number of each stride and the change of the state in it.
        on_turn: called with each turn that was reached after that, in rad.

    Raises:
        BadValue: the gait is not in space, not symmetric or has feedback, or the turn is not within ±1 rad.
        NoGait: the motion ends, or does not settle, or Newton's method does not end in a gait.
    """
    require("turn", turn, lambda angle: abs(angle) <= 1.0, "within ±1 rad a stride")
    led = balanced(gait, (*TURNS_BY, *STEADIED_BY), heading=HEADING, rtol=rtol)
    first = math.copysign(min(abs(turn), FIRST), turn)
    system, state = _settled(led, first, rtol, on_stride)
    if first == turn:
        return gait_beside(system, state, TURNS_BY[:1], {"turn": turn}, rtol)
    speed = gait.system.measures["mean_speed"](return_map(gait.system, gait.state, rtol))
    for angle in np.linspace(first, turn, 1 + math.ceil(abs(turn - first) / STEP)).tolist():
        system, state = turned(system, state, angle, speed, rtol)
        on_turn(angle)
    run, solved = return_map(system, state, rtol), {name: parameter(system, name) for name in STEERED_BY}
    durations = {phase: seconds for phase, seconds in run.durations.items() if seconds > 0.0}
    return Gait(system, state, solved, residual(system, state, rtol), multipliers(system, state, rtol), durations)


def _settled(
    led: Gait, turn: float, rtol: float, on_stride: Callable[[int, float], object]
) -> tuple[HybridSystem, State]:
    """The system with constant inputs, without feedback, and the state that it has come to."""
    state, heading, change = led.state, 0.0, np.inf
    for n in range(1, STRIDES + 1):
        heading += turn * min(1.0, n / RAMP)
        steered = with_parameters(led.system, {"heading": heading})
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
    adjusted = dict(zip(INPUTS, run.held[ADJUSTED], strict=True))
    used = (*TURNS_BY, *STEADIED_BY)
    values = {name: parameter(led.system, name) + adjusted[name] for name in used}
    frozen = led.with_law(feedback=(), nominal=())
    return with_parameters(frozen.system, values), headed(*state)
