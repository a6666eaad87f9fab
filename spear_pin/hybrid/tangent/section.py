"""Derivatives of the return map, and of states on its section, along ξ and along numbers of the system.

In space a symmetric gait lands on two feet at once. Its return map has one derivative on either side, as either foot
may be first. In symmetric and antisymmetric coordinates both sides differ only in how one kind depends on the other,
by |h'a|; a mean of both leaves that out. So the derivative is taken on one side.
"""

from __future__ import annotations

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Chart
from spear_pin.hybrid.engines.structure import Structure
from spear_pin.hybrid.result import State
from spear_pin.hybrid.rules.guards import ON_GROUND
from spear_pin.hybrid.section import chart, velocity_rows
from spear_pin.hybrid.symmetry import YAW, Z, asymmetry, partner
from spear_pin.hybrid.tangent.collocation import ENDS, INSIDE, Fineness
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.derivative import Derivative
from spear_pin.hybrid.tangent.fields import ToeNumbers, tangent_feet
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.hybrid.tangent.seeds import numbers
from spear_pin.model.equations import mechanism_of

ALIKE = 1e-7  # in SI units: largest asymmetry of a gait that counts as symmetric
ODD, LEAST = 1e-5, 1e-3  # of the largest derivative, or of this: what is smaller is rounding of a symmetric one
APART = 10.0 * ON_GROUND  # m: height of the second foot as the first one lands, beside a symmetric gait


def on_section(system: HybridSystem, local: Chart, seeds: Array, xi: Array | None = None) -> Array:
    """Returns derivatives of a state on the section, (2 nv, c).

    Closed toes stay on the ground and move along it only where they slide, and loops stay closed. Before an impact the
    lowest toe stays on the ground.

    Args:
        system: the system.
        local: the chart about the gait's state.
        seeds: derivatives of the system's numbers, (p, c); the first d columns are the directions of ξ.
        xi: coordinates of the state, (d,); zero by default.
    """
    d = local.dimension
    q, v = local.state(np.zeros(d) if xi is None else xi)
    y, nv, split = np.concatenate([q, v]), system.robot.nv, local.q_basis.shape[1]
    dy = np.zeros((2 * nv, seeds.shape[1]))
    dy[:nv, :split] = local.q_basis
    slides, section = local.lane.slides, local.lane.section
    if not section.closed:
        dy[nv:, split:d] = local.v_basis
        feet, slopes = _feet(system, section.toes, y, dy, seeds)
        dy[Z] -= slopes.heights[feet.heights.argmin()]
        return dy
    feet, slopes = _feet(system, section.toes, y, dy * 0.0, seeds)
    up = np.concatenate([feet.rows[:, 1], feet.loops])
    dy[:nv] -= np.linalg.pinv(up) @ np.concatenate([slopes.heights, slopes.gaps])
    _, slopes = _feet(system, section.toes, y, dy, seeds)
    chosen = np.column_stack([~slides, np.ones_like(slides)]).ravel()
    turned = np.concatenate([slopes.rows.reshape(-1, nv, seeds.shape[1])[chosen], slopes.loops])
    drift = np.einsum("rnc,n->rc", turned, y[nv:])
    rows = np.concatenate([velocity_rows(feet.rows[None], slides)[0], feet.loops])
    dy[nv:] = -np.linalg.pinv(rows) @ drift
    dy[nv:, split:d] += local.v_basis
    return dy


def _feet(
    system: HybridSystem, toes: tuple[str, ...], y: Array, dy: Array, seeds: Array
) -> tuple[ToeNumbers, ToeNumbers]:
    structure = Structure(system, system.domains[0], {}, mechanism_of(system.robot))
    return tangent_feet(structure, toes).at(y, numbers(system), dy, seeds)


def tell_feet_apart(system: HybridSystem, local: Chart) -> Array | None:
    """Returns coordinates ξ, (d,), of a state beside a symmetric gait, where one foot lands first; None for others.

    Raises:
        NotDifferentiable: two feet land at once in a gait that is not symmetric.
    """
    if local.lane.section.closed:
        return None
    state = local.state(np.zeros(local.dimension))
    feet = {toe: system.ground.foot(system.robot, state[0], toe) for toe in local.lane.section.toes}
    first = min(feet, key=lambda toe: feet[toe][0])
    down = [toe for toe, (height, _) in feet.items() if toe != first and height - feet[first][0] <= ON_GROUND]
    if not down:
        return None
    other = partner(system.robot, first)[0]
    if other not in down or asymmetry(system.robot, state) > ALIKE:
        raise NotDifferentiable(f"{first} and {down[0]} land at once, in a gait that is not symmetric")
    xi, split = np.zeros(local.dimension), local.q_basis.shape[1]
    change = np.where(local.even[:split], 0.0, (feet[other][1][-1] - feet[first][1][-1]) @ local.q_basis)
    xi[:split] = APART * change / (change @ change)
    return xi


def cycle_on_section(
    system: HybridSystem, local: Chart, seeds: Array, fineness: Fineness = INSIDE, xi: Array | None = None
) -> Derivative:
    """Runs a cycle from a state on the section, and differentiates it along ξ and along numbers of the system.

    See `on_section` for the arguments and `differentiated` for what is raised.
    """
    y = np.concatenate(local.state(np.zeros(local.dimension) if xi is None else xi))
    return differentiate_cycle(system, Recorder(system), y, on_section(system, local, seeds, xi), seeds, fineness)


def columns(system: HybridSystem, local: Chart, cycle: Derivative) -> Array:
    """Returns derivatives of ξ after a cycle from a gait's state, (d, c); the first d columns are the Jacobian.

    Raises:
        NotDifferentiable: feet of a symmetric gait land at once even if others did not, or a number tells left from
            right in such a gait.
    """
    found, d, xi = local.changes(cycle.y, cycle.dy), local.dimension, tell_feet_apart(system, local)
    if xi is not None:
        even, still = local.even, np.zeros((len(cycle.numbers), d))
        if (np.abs(found[~even, d:]) > ODD * np.abs(found[:, d:]).max(axis=0, initial=LEAST)).any():
            raise NotDifferentiable("two feet land at once, and a parameter would tell left from right: leave it out")
        other = _one_foot_first(system, local, still, xi)
        own = found[:, :d] * np.outer(even, even)
        found[:, :d] = np.where(np.outer(~even, ~even), local.changes(other.y, other.dy), own)
    return found


def _one_foot_first(system: HybridSystem, local: Chart, seeds: Array, xi: Array | None) -> Derivative:
    """Differentiates a cycle in which no feet land at once; see `cycle_on_section` for the arguments."""
    found = cycle_on_section(system, local, seeds, ENDS, xi)
    if found.together:
        raise NotDifferentiable("feet land at once, whichever foot lands first at the section")
    return found


def exact_jacobian(system: HybridSystem, state: State) -> Array:
    """Returns the return map's Jacobian at a periodic orbit, in the section's chart, (d, d).

    Raises:
        NotDifferentiable: the cycle has no derivative; the text says why.
    """
    local = chart(system, state)
    still = np.zeros((len(numbers(system)), local.dimension))
    return columns(system, local, cycle_on_section(system, local, still, ENDS))


def exact_map(system: HybridSystem, state: State, seeds: Array) -> Array:
    """Returns the derivatives of ξ after a cycle by ξ and by numbers, (d, d + m), and in space of the heading as well.

    Beside a symmetric gait, where either foot may land first, it is the mean of the derivatives on both sides.

    Args:
        system: the system.
        state: the state of a gait.
        seeds: derivatives of the system's numbers by those of which the derivatives are asked for, (p, m).

    Raises:
        NotDifferentiable: the cycle has no derivative; the text says why.
    """
    local = chart(system, state)
    whole = np.concatenate([np.zeros((len(seeds), local.dimension)), seeds], axis=1)
    xi = tell_feet_apart(system, local)
    found = []
    for start in (None,) if xi is None else (xi, -xi):
        cycle = _one_foot_first(system, local, whole, start)
        turn = cycle.dy[YAW : YAW + 1] if system.section_toes else cycle.dy[:0]
        found.append(np.concatenate([local.changes(cycle.y, cycle.dy), turn]))
    return np.asarray(np.mean(found, axis=0), np.float64)
