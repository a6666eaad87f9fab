"""Which phase and which contact modes fit a state: stick, slip or flight."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import OPEN, STICK, Held, HybridSystem
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.phases import AT_REST, ON_GROUND, SIGN, UNLOADED
from spear_pin.hybrid.record import Moment
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]
STARTS_TO_SLIDE = 1e-3  # m/s²: on the cone's edge a sliding toe begins with no acceleration


def choose(system: HybridSystem, phase: str, held: Held, t: float, y: Array) -> Flow:
    """The flow of the domain of a phase whose contact modes are consistent with the state.

    Where no mode holds, it is the domain whose guard then says why: lift-off where the toe would be
    pulled, Painlevé's paradox where it can neither stick nor slide.
    """
    fitting: list[Flow] = []
    for domain in system.of_phase(phase):
        flow = Flow(system, domain, held)
        flow(t, y)
        motion, force = _consistent(system, flow)
        if motion and force:
            return flow
        if motion:
            fitting.append(flow)
    pulled = [flow for flow in fitting if _pulled(system, flow)]
    ill_posed = [flow for flow in fitting if flow.ill_posed]
    return (pulled[:1] + ill_posed + fitting)[0]


def starting_phase(system: HybridSystem, state: Any) -> tuple[str, Held]:
    """The phase in which a state lies, and what is held there as if the phase had just begun.

    A toe on the ground and not moving vertically is in the phase that follows the section; else
    the robot is in the air, in the flight before the section.

    Raises:
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
    """
    robot = system.robot
    if not (isinstance(state, (tuple, list)) and len(state) == 2):
        raise BadValue("state", state, "a pair (q, v)")
    heights = _heights(robot, *state)
    q, v = np.asarray(state[0], dtype=float), np.asarray(state[1], dtype=float)
    stance = system.section_phase
    closed = [toe for toe, mode in zip(robot.toes, system.of_phase(stance)[0].contacts, strict=True) if mode != OPEN]
    rests = all(heights[toe] <= ON_GROUND and abs(robot.toe_jacobian(q, toe)[1] @ v) <= 10 * AT_REST for toe in closed)
    held: Held = {}
    flight, lands = system.landing
    for latch in (system.reset_into(flight).latch, lands.latch if rests else None):
        if latch is not None:
            try:
                held = {**held, **latch(q.tolist(), v.tolist(), held, system.law)}
            except ArithmeticError:
                raise BadValue("state", state, "one from which the control law has a value") from None
    return (stance if rests else flight), held


def resuming_phase(system: HybridSystem, moment: Moment) -> tuple[str, Held]:
    """The phase of a moment and what is held there.

    Raises:
        UnknownName: there is no such phase.
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
    """
    if moment.phase not in system.phases:
        raise UnknownName("phase", moment.phase, system.phases)
    _heights(system.robot, moment.q, moment.v)
    return moment.phase, moment.held


def _heights(robot: Robot, q: Any, v: Any) -> dict[str, float]:
    robot.bias(q, v)  # checks both
    heights = {toe: float(robot.toe_position(q, toe)[1]) for toe in robot.toes}
    for toe, height in heights.items():
        if height < -ON_GROUND:
            raise BadValue(f"height of {toe}", height, "at or above the ground, at 0 m")
    return heights


def _consistent(system: HybridSystem, flow: Flow) -> tuple[bool, bool]:
    """Whether a domain's contact modes fit the toes' sliding, and whether its forces keep them there."""
    motion, force = True, True
    friction = system.contact.friction
    for toe, mode in zip(system.robot.toes, flow.domain.contacts, strict=True):
        if mode == OPEN:
            continue
        sliding = flow.toe_velocity(toe)[0]
        tangential, normal = flow.force(toe)
        force = force and normal > 0.0 and not flow.ill_posed
        if mode == STICK:
            motion = motion and abs(sliding) <= AT_REST
            # on the cone's edge, within the slip guard's tolerance, it is about to slide
            force = force and abs(tangential) < friction * normal - UNLOADED
        elif abs(sliding) > AT_REST:
            motion = motion and sliding * SIGN[mode] > 0.0
        else:
            force = force and flow.toe_acceleration(toe)[0] * SIGN[mode] > -STARTS_TO_SLIDE
    return motion, force


def _pulled(system: HybridSystem, flow: Flow) -> bool:
    """Whether some toe on the ground would have to be held down."""
    closed = [toe for toe, mode in zip(system.robot.toes, flow.domain.contacts, strict=True) if mode != OPEN]
    return not flow.ill_posed and any(flow.force(toe)[1] <= 0.0 for toe in closed)
