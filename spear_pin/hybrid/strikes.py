"""Computes the effect of an event's impact on a robot's state."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import KELLER, HybridSystem
from spear_pin.hybrid.contact import PINNED, SLOW, STICK
from spear_pin.hybrid.domain import Domain, Reset
from spear_pin.hybrid.per_lane import null_spaces
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.rules.guards import ON_GROUND, rise
from spear_pin.hybrid.rules.guards import struck as told
from spear_pin.hybrid.rules.impact import (
    JointImpact,
    caught,
    find_struck_toes,
    joint_impact,
    land_toes,
    plastic_impact,
)
from spear_pin.hybrid.rules.sliding_impact import sliding_impact
from spear_pin.hybrid.rules.spatial_impact import spatial_impact
from spear_pin.model.feet import find_leading
from spear_pin.model.path import Joints
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import row_along


class Strike(NamedTuple):
    """Effect of an impact.

    Attributes:
        v: velocity after the impact, (nv,).
        impulse: impulse on each toe, along the ground and normal to it, (ntoes, 2) or (ntoes, 3), in N·s.
        work: work done on the mechanism, in J, never positive.
        rises: speeds at which an impact of several toes, or of a brake, lifts toes off, in m/s, and in space whether
            toes took part, by name in `held`.
    """

    v: Array
    impulse: Array
    work: float
    rises: Mapping[str, float]


@dataclass
class Overlap:
    """Impacts that may not be over: each lasts for a while, and overlapping impacts count as one.

    Attributes:
        window: duration of an impact, in s.
        nothing: impulse of a toe that was not struck, (3,), or with derivatives along c directions, (3, 1 + c), as all
            impulses then are.
        recent: time at which each toe was struck, in s, and its impulse since, (3,).
    """

    window: float
    nothing: Array = field(default_factory=lambda: np.zeros(3))
    recent: dict[str, tuple[float, Array]] = field(default_factory=dict)

    def received(self, toes: Sequence[str], now: float) -> Array:
        """Returns the impulses that toes have received in impacts that are not over, (m, 3), in N·s."""
        for toe, (time, _) in list(self.recent.items()):
            if now - time > self.window:
                del self.recent[toe]
        return np.array([self.recent[toe][1] if toe in self.recent else self.nothing for toe in toes])

    def add(self, toes: Sequence[str], striking: Container[str], impulse: Array, now: float) -> None:
        """Records an impact.

        Args:
            toes: toes that took part.
            striking: toes among them that were in the air.
            impulse: impulse on each, (m, 3), in N·s.
            now: time of the impact, in s.
        """
        for toe, own in zip(toes, impulse, strict=True):
            if toe in self.recent:
                time, before = self.recent[toe]
                self.recent[toe] = time, before + own
            elif toe in striking:
                self.recent[toe] = now, own


def strike_toes(
    system: HybridSystem, domain: Domain, reset: Reset, q: Array, v: Array, overlap: Overlap, now: float
) -> Strike | None:
    """Computes the effect of an event on the velocity, in the plane or in space; returns None if it has none.

    Args:
        system: the system.
        domain: the domain that the event ends.
        reset: reset of the event.
        q: configuration.
        v: velocity before.
        overlap: earlier impacts, to which this one is added.
        now: time of the event, in s.
    """
    if reset.stop:
        return stop_toes(system, domain, reset, q, v)
    if not (reset.impact or reset.grips):
        return None
    if pins(system, domain, reset):
        return pin_toes(system, find_struck_toes(system, domain, reset), q, v)
    if system.robot.dimension == 3:
        return strike_in_space(system, domain, reset, q, v, overlap, now)
    return strike_by_rule(system, find_struck_toes(system, domain, reset), reset, q, v)


def pins(system: HybridSystem, domain: Domain, reset: Reset) -> bool:
    """Tells whether toes that strike in an event are pinned where they do."""
    return PINNED in system.of_phase(reset.phase or domain.phase)[0].contacts


class Yielding(NamedTuple):
    """A robot as an impact finds it, in velocities along which its loops stay closed.

    Attributes:
        basis: orthonormal directions of these velocities, (nv, n); all coordinates without loops.
        mass_matrix: D along them, (n, n).
        v: the velocity before, (n,).
    """

    basis: Array
    mass_matrix: Array
    v: Array


def make_yielding(robot: Robot, q: Array, v: Array, grips: Sequence[Joints] = ()) -> Yielding:
    """Returns a robot as an impact finds it, with paths that brakes have brought to rest.

    No impulse can open a loop, or move such a path; those on the pins of loops do no work.
    """
    loops = np.empty((0, robot.nv)) if robot.closure is None else robot.loop_jacobian(q)
    rows = np.concatenate([loops, *(row_along(path, robot)[None] for path in grips)])
    basis = null_spaces(rows[None])[0] if len(rows) else np.eye(robot.nv)
    mass_matrix = robot.mass_matrix(q)
    own = basis.T @ mass_matrix @ basis
    return Yielding(basis, own, np.linalg.solve(own, basis.T @ mass_matrix @ v) if grips else basis.T @ v)


def pin_toes(system: HybridSystem, toes: Sequence[str], q: Array, v: Array) -> Strike:
    """Computes the effect of an impact that pins toes, all that are on the ground afterwards, by `caught`."""
    robot = system.robot
    own = make_yielding(robot, q, v)
    jacobian = np.concatenate([system.ground.foot(robot, q, toe)[1] for toe in toes]) @ own.basis
    impact = caught(own.mass_matrix, jacobian, own.v)
    impulse = np.zeros((len(robot.toes), robot.dimension))
    impulse[[robot.toes.index(toe) for toe in toes]] = impact.impulse.reshape(len(toes), -1)
    return Strike(own.basis @ impact.v, impulse, -impact.loss, {})


def strike_in_space(
    system: HybridSystem, domain: Domain, reset: Reset, q: Array, v: Array, overlap: Overlap, now: float
) -> Strike:
    """Computes the effect of an impact in space on the toes that touch the ground in that instant, by the system's law.

    By Keller's law an impact of one toe is separate, whatever impulse the toe has received before. For the arguments
    see `strike_toes`.
    """
    robot = system.robot
    feet = {toe: system.ground.foot(robot, q, toe) for toe in robot.toes}
    normal = {toe: (height, float(jacobian[-1] @ v)) for toe, (height, jacobian) in feet.items()}
    toes, striking = find_struck_toes_in_space(system, domain, reset, normal)
    jacobian = np.concatenate([feet[toe][1] for toe in toes])
    mass_matrix, earlier = robot.mass_matrix(q), v
    v, stopping = land_toes(mass_matrix, jacobian, v, [toe in reset.impact for toe in toes])
    if system.impact_law == KELLER and len(toes) == 1:
        impact = sliding_impact(mass_matrix, jacobian, v, system.contact.friction)
    else:
        impact = spatial_impact(mass_matrix, jacobian, v, system.contact.friction, overlap.received(toes, now))
    overlap.add(toes, striking, impact.impulse, now)
    own, impulse = [robot.toes.index(toe) for toe in toes], np.zeros((len(robot.toes), 3))
    impulse[own] = impact.impulse
    impulse[own, 2] += stopping
    work = 0.5 * float(stopping @ (jacobian @ (earlier + v))[2::3]) - impact.loss
    speeds = np.where(impact.leaves, (jacobian @ impact.v)[2::3], 0.0).tolist()
    noted = dict(zip(map(rise, toes), speeds, strict=True))
    noted |= {told(toe): float(toe in striking and toe not in reset.impact) for toe in toes}
    return Strike(impact.v, impulse, work, noted)


def find_struck_toes_in_space(
    system: HybridSystem, domain: Domain, reset: Reset, normal: Mapping[str, tuple[float, float]]
) -> tuple[list[str], set[str]]:
    """Returns the toes that take part in an impact in space, and those among them that were in the air.

    Args:
        system: the system.
        domain: the domain that the impact ends.
        reset: reset of the event.
        normal: height above the ground, in m, and normal velocity, in m/s, of each toe.
    """
    grounded = {toe for toe, _ in closed_toes(system.robot.toes, domain)}
    falling = {toe for toe, (height, speed) in normal.items() if height <= ON_GROUND and speed < 0.0}
    striking = ({*reset.impact} | falling) - grounded
    return [toe for toe in system.robot.toes if toe in grounded | striking], striking


def stop_toes(system: HybridSystem, domain: Domain, reset: Reset, q: Array, v: Array) -> Strike:
    """Computes the effect of stopping toes in space whose sliding has almost ended; it reports no impulse.

    Other toes that slide as slowly stop with them, and sticking toes keep sticking.
    """
    robot, rows = system.robot, []
    for toe, _ in closed_toes(robot.toes, domain):
        jacobian = system.ground.foot(robot, q, toe)[1]
        rows.append(jacobian if comes_to_rest(robot, domain, reset, toe, jacobian @ v) else jacobian[-1:])
    jacobians = np.concatenate(rows)
    response = np.linalg.solve(robot.mass_matrix(q), jacobians.T)
    impulse = -np.linalg.lstsq(jacobians @ response, jacobians @ v, rcond=None)[0]
    after = v + response @ impulse
    work = 0.5 * float(impulse @ (jacobians @ (v + after)))
    return Strike(after, np.zeros((len(robot.toes), robot.dimension)), work, {})


def comes_to_rest(robot: Robot, domain: Domain, reset: Reset, toe: str, speed: Array) -> bool:
    """Tells whether a toe in space, with a velocity of (3,) in m/s, rests after the end of sliding."""
    sticks = domain.contacts[robot.toes.index(toe)] == STICK
    return toe in reset.stop or sticks or math.hypot(*speed[:2]) <= 2.0 * SLOW


def strike_by_rule(system: HybridSystem, struck: Sequence[str], reset: Reset, q: Array, v: Array) -> Strike:
    """Computes the effect of an impact in the plane on all toes that take part, by `plastic_impact` or `joint_impact`.

    Brakes grip together with the toes; the ground does not pull at a toe that they lift. For the other arguments see
    `strike_toes`.
    """
    robot, impulse, rises = system.robot, np.zeros((len(system.robot.toes), 2)), dict[str, float]()
    basis, mass_matrix, after = make_yielding(robot, q, v)
    toes = [robot.toes.index(toe) for toe in struck]
    jacobian = np.concatenate([np.empty((0, robot.nv)), *(system.ground.foot(robot, q, toe)[1] for toe in struck)])
    if struck:
        lands = [toe in reset.impact for toe in struck]
        after, impulse[toes, 1] = land_toes(mass_matrix, jacobian @ basis, after, lands)
    if reset.grips:
        basis, mass_matrix, after = make_yielding(robot, q, basis @ after, reset.grips)
    if struck:
        found = mass_matrix, jacobian @ basis, after, system.contact.friction
        alone = len(struck) == 1 and not reset.grips
        impact = plastic_impact(*found) if alone else joint_impact(*found, find_leading(robot.feet, struck))
        after, impulse[toes] = impact.v, impulse[toes] + impact.impulse
        if isinstance(impact, JointImpact) or system.brakes:
            leaves = impact.leaves if isinstance(impact, JointImpact) else False
            rises = dict(zip(map(rise, struck), np.where(leaves, (found[1] @ after)[1::2], 0.0).tolist(), strict=True))
    after = basis @ after
    pushed = robot.mass_matrix(q) @ (after - v) if reset.grips else jacobian.T @ impulse[toes].ravel()
    return Strike(after, impulse, 0.5 * float(pushed @ (v + after)), rises)
