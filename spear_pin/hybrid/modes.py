"""Which phase and which contact modes fit a state: stick, slip or flight."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import Held, HybridSystem, Rub
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.phases import AT_REST, LET_GO, ON_GROUND, SIGN, UNLOADED
from spear_pin.hybrid.record import Moment
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]
F = TypeVar("F", bound=Flow)
BORE = 1e-3  # N: well above what is left of a force that fades to nothing
STARTS_TO_SLIDE = 1e-3  # m/s²: on the cone's edge a sliding toe begins with no acceleration


def choose(system: HybridSystem, phase: str, held: Held, t: float, y: Array) -> Flow:
    """The flow of the domain of a phase whose modes of contact and dry friction are consistent with the state.

    Where no mode holds, it is the domain whose guard then says why: lift-off where the toe would be
    pulled, Painlevé's paradox where it can neither stick nor slide.
    """
    flows = (Flow(system, domain, held) for domain in system.of_phase(phase))
    return fitting(system, flows, t, y)


def fitting(system: HybridSystem, flows: Iterable[F], t: float, y: Array) -> F:
    """The first of some flows whose modes are consistent, or the one whose guard says why none is.

    Where toes begin to slide from rest within what is tolerated, it is the one that pushes them off best: with next
    to no force on a toe both ways may pass.
    """
    fits: list[tuple[float, F]] = []
    moving: list[tuple[F, list[str]]] = []
    turning: list[F] = []
    for flow in flows:
        rates = [float(y[system.robot.nq + system.robot.index(rub.joint)]) for rub in flow.domain.rubs]
        if not all(_turns(rub, rate) for rub, rate in zip(flow.domain.rubs, rates, strict=True)):
            continue
        flow(t, y)
        closed = [
            (toe, mode) for toe, mode in zip(system.robot.toes, flow.domain.contacts, strict=True) if mode != OPEN
        ]
        if all(_moves(flow, toe, mode) for toe, mode in closed):
            failing = [toe for toe, mode in closed if not _keeps(system, flow, toe, mode)]
            if not all(_rubs_on(flow, rub, rate) for rub, rate in zip(flow.domain.rubs, rates, strict=True)):
                turning.append(flow)
                continue
            if not failing:
                push = min((_push(flow, toe, mode) for toe, mode in closed), default=math.inf)
                if push == math.inf:
                    return flow
                fits.append((push, flow))
            moving.append((flow, failing))
    if fits:
        return max(fits, key=lambda pair: pair[0])[1]
    # where a toe has to be held down, the others had better be in their right modes: it leaves, not they
    only = [flow for flow, failing in moving if all(_pulled(flow, toe) for toe in failing)]
    pulled = [flow for flow, failing in moving if any(_pulled(flow, toe) for toe in failing)]
    ill_posed = [flow for flow, _ in moving if flow.ill_posed]
    return (only + pulled[:1] + ill_posed + [flow for flow, _ in moving] + turning)[0]


def torn_off(before: Flow, after: Flow, t: float, y: Array) -> list[str]:
    """Toes that stuck and bore, and have to leave because the slip that would begin is a Painlevé paradox.

    On the cone's edge, the force that lets the toe stick is the one of slip to that side as well. Where that has no
    positive pivot, the force only grows with the toe's acceleration into the ground: beyond the edge such slip would
    turn back at once. Slip to the other side would pull at the toe. Lifting off is all that is consistent: without
    force the toe accelerates upward.

    Args:
        before: motion in which they stick.
        after: motion that was chosen.
        t: time since the phase began.
        y: the state.
    """
    before(t, y), after(t, y)
    modes = zip(before.system.robot.toes, before.domain.contacts, after.domain.contacts, strict=True)
    return [
        toe
        for toe, one, other in modes
        if one == STICK and other in SIGN and before.force(toe)[1] > BORE and after.force(toe)[1] <= 0.0
    ]


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


def _moves(flow: Flow, toe: str, mode: str) -> bool:
    """Whether a toe's sliding fits its mode."""
    sliding = flow.toe_velocity(toe)[0]
    return abs(sliding) <= AT_REST or (mode != STICK and sliding * SIGN[mode] > 0.0)


def _keeps(system: HybridSystem, flow: Flow, toe: str, mode: str) -> bool:
    """Whether the forces keep a toe in its mode."""
    tangential, normal = flow.force(toe)
    if flow.ill_posed or not normal > 0.0:
        return False
    if mode == STICK:  # on the cone's edge, within the slip guard's tolerance, it is about to slide
        return abs(tangential) < system.contact.friction * normal - UNLOADED
    return _push(flow, toe, mode) > -STARTS_TO_SLIDE


def _push(flow: Flow, toe: str, mode: str) -> float:
    """Acceleration along its mode of a toe that begins to slide, in m/s²; infinite if it does not begin."""
    if mode == STICK or abs(flow.toe_velocity(toe)[0]) > AT_REST:
        return math.inf
    return flow.toe_acceleration(toe)[0] * SIGN[mode]


def _turns(rub: Rub, rate: float) -> bool:
    """Whether a joint's rate fits the mode of its dry friction."""
    return abs(rate) <= AT_REST if rub.sign == 0 else not rub.sign * rate < -AT_REST


def _rubs_on(flow: Flow, rub: Rub, rate: float) -> bool:
    """Whether the forces keep a joint at rest, or moving as it does."""
    if rub.sign == 0:
        return abs(flow.holding(rub.joint)) < rub.force - LET_GO
    acceleration = float(flow.a[flow.system.robot.index(rub.joint)])
    return abs(rate) > AT_REST or rub.sign * acceleration > -STARTS_TO_SLIDE


def _pulled(flow: Flow, toe: str) -> bool:
    """Whether a toe on the ground would have to be held down."""
    return not flow.ill_posed and flow.force(toe)[1] <= 0.0
