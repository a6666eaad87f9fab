"""Chooses the phase and the contact modes that fit a state: stick, slip or flight."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeVar

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, list_names
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.contact import OPEN, PINNED, SLIPS
from spear_pin.hybrid.domain import Domain, Held
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.result import Moment
from spear_pin.hybrid.rules.footing import (
    STARTS_TO_SLIDE,
    UNFIT,
    UNLOADED,
    closed_toes,
    fitness,
    is_torn_off,
    make_footing,
    make_rubbing,
    rate_along,
    rate_fits,
    still,
)
from spear_pin.hybrid.rules.guards import ON_GROUND
from spear_pin.hybrid.rules.latching import latch_values, standing
from spear_pin.hybrid.rules.start import STATE_AT_REST, below_ground, is_aloft, rests, start
from spear_pin.model.robot_posture import lever_along
from spear_pin.model.round_feet import parts_of

F = TypeVar("F", bound=Flow)


def choose(system: HybridSystem, phase: str, held: Held, t: float, y: Array) -> Flow:
    """Returns the flow of a phase's domain whose modes of contact and dry friction are consistent with the state.

    If no mode is consistent, it chooses the domain whose guard then gives the cause: lift-off if the toe would be
    pulled, Painlevé's paradox if it can neither stick nor slide.
    """
    domains = (domain for domain in system.of_phase(phase) if domain.suits(held) and in_place(system, domain, y))
    flows = (Flow(system, domain, held) for domain in domains)
    return find_fitting(system, flows, t, y)


def in_place(system: HybridSystem, domain: Domain, y: Array) -> bool:
    """Tells whether a domain has those bouncing toes open that are in the air."""
    nq, nv = system.robot.nq, system.robot.nv
    q, v = y[:nq], y[nq : nq + nv]
    for toe, _ in closed_toes(system.robot.toes, domain):
        if toe in domain.bouncing:
            height, jacobian = system.ground.foot(system.robot, q, toe)
            if is_aloft(height, float(jacobian[-1] @ v)):
                return False
    return True


def find_suiting(toes: Sequence[str], domains: Iterable[Domain], heights: Array, velocities: Array) -> Iterator[Domain]:
    """Yields the domains that suit the motion of the toes, in order; the forces may not suit them.

    Bouncing toes in the air are open in them. Of toes on the ground, those that move along it slip, others rest.
    Domains in which a bouncing toe on the ground is open suit, too; they come last.

    Args:
        toes: names of the toes.
        domains: the domains.
        heights: distances of the toes from the ground, in m, (toes,).
        velocities: their velocities along the ground and normal to it, in m/s, (toes, 2 or 3).
    """
    up = [is_aloft(height, rate) for height, rate in zip(heights.tolist(), velocities[:, -1].tolist(), strict=True)]
    moving = [not still(math.hypot(*along)) for along in velocities[:, :-1].tolist()]
    for domain in domains:
        modes = zip(toes, domain.contacts, up, moving, strict=True)
        if all(
            mode == OPEN or (not (toe in domain.bouncing and above) and (mode == PINNED or moves == (mode in SLIPS)))
            for toe, mode, above, moves in modes
        ):
            yield domain


def find_fitting(system: HybridSystem, flows: Iterable[F], t: float, y: Array) -> F:
    """Returns the flow that fits best, by `rules.footing.fitness`."""
    best, found, nq, nv = None, -math.inf, system.robot.nq, system.robot.nv
    for flow in flows:
        rubs, fits = flow.domain.rubs, UNFIT
        if all(
            rate_fits(rub, float(rate_along(lever_along(rub.along, system.robot), y[nq : nq + nv]))) for rub in rubs
        ):
            flow(t, y)
            closed = closed_toes(system.robot.toes, flow.domain)
            feet = [
                (mode, make_footing(flow, toe, mode)) for toe, mode in closed if mode != PINNED
            ]  # a pin bears any force
            fits = fitness(feet, [(rub, make_rubbing(flow, rub)) for rub in rubs])
            if not all(_stays(flow, toe) for toe in flow.domain.bouncing):
                fits = UNFIT
        if fits == math.inf:
            return flow
        if best is None or fits > found:
            best, found = flow, fits
    assert best is not None
    return best


def _stays(flow: Flow, toe: str) -> bool:
    """Tells whether a bouncing toe stays on the ground, or does not fall back to the ground that it just left."""
    mode = flow.domain.contacts[flow.system.robot.toes.index(toe)]
    if mode != OPEN:
        return flow.force(toe)[-1] * (flow.pivot(toe) if mode in SLIPS else 1.0) > UNLOADED
    if is_aloft(flow.height(toe), flow.toe_velocity(toe)[-1]):
        return True
    return flow.toe_acceleration(toe)[-1] >= -STARTS_TO_SLIDE


def find_torn(before: Flow, after: Flow, t: float, y: Array) -> list[str]:
    """Returns toes that stuck and bore, and have to leave the ground, by `rules.footing.torn_off`.

    Args:
        before: motion in which the toes stick.
        after: motion that was chosen.
        t: time since the phase began.
        y: the state.
    """
    before(t, y), after(t, y)
    modes = zip(before.system.robot.toes, before.domain.contacts, after.domain.contacts, strict=True)
    return [toe for toe, one, other in modes if is_torn_off(one, before.force(toe)[-1], other, after.force(toe)[-1])]


def starting_phase(system: HybridSystem, state: Any) -> tuple[str, Held]:
    """Finds the phase in which a state lies, and the values held as if the phase had just begun.

    If a toe is on the ground and moves neither from nor into it, the state is in the phase that follows the section.
    Else the robot is in the flight before the section. In space the section lies before the impact, so that a state
    with a toe of the section on the ground is on it.

    Raises:
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
    """
    if not (isinstance(state, (tuple, list)) and len(state) == 2):
        raise BadValue("state", state, "a pair (q, v)")
    feet = _feet(system, *state)
    q, v = np.asarray(state[0], dtype=float), np.asarray(state[1], dtype=float)
    if system.section_toes:
        standing = any(feet[toe][0] <= ON_GROUND for toe in system.section_toes)
    else:
        closed = [feet[toe] for toe, _ in closed_toes(system.robot.toes, system.of_phase(system.section_phase)[0])]
        standing = all(rests(height, float(jacobian[-1] @ v), STATE_AT_REST) for height, jacobian in closed)
    phase, resets = start(system, standing)
    try:
        clock = Clock(0.0, system.springs, system)
        held = latch_values(
            {}, resets, q.tolist(), v.tolist(), system.law, system.place_of, begins=standing, clock=clock
        )
        return phase, held
    except ArithmeticError:
        raise BadValue("state", state, "one at which the control law gives numbers") from None


def resuming_phase(system: HybridSystem, moment: Moment) -> tuple[str, Held]:
    """Returns the phase of a moment and the values held at it.

    Raises:
        UnknownName: there is no such phase.
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground, or a round foot on the
            ground does not stand on the part of its arc that is held.
    """
    if moment.phase not in system.phases:
        raise UnknownName("phase", moment.phase, system.phases)
    _feet(system, moment.q, moment.v)
    robot, q = system.robot, [*moment.q]
    own = standing(robot, q, [*moment.v])
    for toe, _ in closed_toes(robot.toes, system.of_phase(moment.phase)[0]):
        name = parts_of(toe)
        if name in own and robot.arcs[toe].contradicts(moment.held.get(name, own[name]), q):
            pitch = f"as the foot's pitch is {robot.arcs[toe].pitch(q):.4g} rad"
            raise BadValue(f"held[{name!r}]", moment.held[name], f"({own[name][0]:g}, {own[name][1]:g}), {pitch}")
    return moment.phase, {**own, **moment.held}


def _feet(system: HybridSystem, q: Any, v: Any) -> dict[str, tuple[float, Array]]:
    """Returns the distance of each toe from the ground, in m, and its Jacobian."""
    system.robot.bias(q, v)  # checks both
    feet = {toe: system.ground.foot(system.robot, q, toe) for toe in system.robot.toes}
    for toe, (height, _) in feet.items():
        if below_ground(height):
            raise BadValue(f"height of {toe}", height, "at or above the ground")
    closure, names = system.robot.closure, list_names([loop.name for loop in system.robot.loops])
    held = (True, True) if closure is None else closure.holds(np.asarray(q, float), np.asarray(v, float))
    for name, value, holds in zip("qv", (q, v), held, strict=True):
        if not holds:
            how = "robot.closed(q)" if name == "q" else "robot.reduced(q, rates).v"
            raise BadValue(name, value, f"one that keeps {names} closed, as {how} does")
    return feet
