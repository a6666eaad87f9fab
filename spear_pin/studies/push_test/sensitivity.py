"""Derivatives of a release by its parameters: the linearised equation of motion along the release.

    J δ̈ = (∂τ/∂θ - G' - ½ J'' θ̇² - J' θ̈) δ + (∂τ/∂θ̇ - J' θ̇) δ̇ + ∂τ/∂p,      δ = ∂θ/∂p

with -θ̈ in the place of ∂τ/∂p for the rotor's share of J. On each step of the integration that found the motion it is
solved by collocation at Gauss's nodes: linear equations, of all steps at once. Where dry friction changes its sign the
knee stands still; its acceleration jumps, and with it δ̇, in the same ratio, for the time of the turn depends on p.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from spear_pin.arrays import Array
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.push_test.passive_knee import PassiveKnee

# what a motion can be derived by: the numbers of the passive knee, the reflected rotor inertia, the start
PARAMETERS = ("stiffness", "damping", "coulomb", "zero", "rotor", "initial_angle")
STAGES = 8  # of the collocation: its error is far below that of the motion
NODES = 0.5 * (np.polynomial.legendre.leggauss(STAGES)[0] + 1.0)
POWERS = np.arange(1, STAGES + 1)
POLYNOMIALS = np.linalg.inv(np.vander(NODES, increasing=True))  # those that are 1 at one node and 0 at the others


@dataclass(frozen=True)
class Step:
    """One step of the motion, in which the torque law of the knee is smooth.

    Attributes:
        begin: beginning, in s.
        end: end, in s.
        motion: θ and θ̇ at times, (2, n).
        pulls: 1 where the spring acts, 0 where it is slack.
        brakes: 1 where the motor brakes, else 0.
        direction: direction of the motion for dry friction, -1, 0 or 1.
    """

    begin: float
    end: float
    motion: Callable[[Array], Array]
    pulls: float
    brakes: float
    direction: float


def derivatives(leg: PinnedLeg, knee: PassiveKnee, steps: Sequence[Step], wrt: Sequence[str], times: Array) -> Array:
    """Returns ∂θ/∂p at increasing times, (n, parameters); after the last step they stay constant.

    Args:
        leg: the leg with its rotor.
        knee: torque law of the knee.
        steps: steps of the motion, one after the other from rest.
        wrt: the parameters, of `PARAMETERS`.
        times: times, (n,), in s.
    """
    angle = np.array([float(name == "initial_angle") for name in wrt])
    if not steps or not wrt:
        return np.tile(angle, (times.size, 1))
    begin, ends = np.array([step.begin for step in steps]), np.array([step.end for step in steps])
    h, rate, jumps = ends - begin, np.zeros(len(wrt)), _jumps(leg, knee, steps)
    responses = _responses(leg, knee, steps, wrt, h[:, None])
    starts, bends = np.empty((len(steps), 2, len(wrt))), np.empty((len(steps), STAGES, len(wrt)))
    (once,), (twice,) = _integrals(np.ones(1))
    for n, response in enumerate(responses):
        rate = rate * jumps[n]
        starts[n] = angle, rate
        bends[n] = response[:, :2] @ starts[n] + response[:, 2:]
        angle = angle + h[n] * rate + h[n] ** 2 * (twice @ bends[n])
        rate = rate + h[n] * (once @ bends[n])
    at = np.minimum(np.searchsorted(ends, times), len(steps) - 1)
    since = np.minimum(times, ends[-1]) - begin[at]
    weights = h[at, None] ** 2 * _integrals(since / h[at])[1]
    found = starts[at, 0] + since[:, None] * starts[at, 1] + np.einsum("ns,nsp->np", weights, bends[at])
    found[times > ends[-1]] = angle
    return np.asarray(found)


def _integrals(place: Array) -> tuple[Array, Array]:
    """Returns integrals of the polynomials from 0 to a place on a unit step, and integrals of these, (n, STAGES)."""
    powers = place[:, None] ** POWERS / POWERS
    return powers @ POLYNOMIALS, (powers * place[:, None] / (POWERS + 1)) @ POLYNOMIALS


def _responses(leg: PinnedLeg, knee: PassiveKnee, steps: Sequence[Step], wrt: Sequence[str], h: Array) -> Array:
    """Returns δ̈ at each step's nodes per initial δ and δ̇, and for none of them: (steps, STAGES, 2 + wrt)."""
    theta, v = np.stack([s.motion(s.begin + NODES * (s.end - s.begin)) for s in steps], axis=1)
    pulls, brakes, direction = (
        np.array([[getattr(step, name)] for step in steps]) for name in ("pulls", "brakes", "direction")
    )
    terms = leg.motion_with_slopes(theta.ravel()).reshape(-1, *theta.shape)
    inertia, centrifugal, gravity, inertia_slope, centrifugal_slope, gravity_slope, drag, drag_slope = terms
    torque = knee.torque(theta, v, pulls, direction)
    acceleration = (torque - (drag + centrifugal * v) * v - gravity) / inertia
    by_angle = -knee.stiffness * pulls - gravity_slope - (drag_slope + centrifugal_slope * v) * v
    by_angle = (by_angle - acceleration * inertia_slope) / inertia
    by_rate = (-knee.damping - drag - knee.braking * brakes - 2.0 * centrifugal * v) / inertia
    forcing = {
        "stiffness": -pulls * (theta - knee.zero),
        "damping": -v,
        "coulomb": -direction,
        "zero": pulls * knee.stiffness,
        "rotor": -acceleration,
        "initial_angle": 0.0,
    }
    right = [by_angle, by_rate + by_angle * h * NODES, *(forcing[name] / inertia for name in wrt)]
    once, twice = _integrals(NODES)
    matrix = np.eye(STAGES) - (h**2 * by_angle)[..., None] * twice - (h * by_rate)[..., None] * once
    return np.linalg.solve(matrix, np.stack(np.broadcast_arrays(*right), axis=-1))


def _jumps(leg: PinnedLeg, knee: PassiveKnee, steps: Sequence[Step]) -> list[float]:
    """Returns the ratio of δ̇ after the beginning of each step to that before."""
    jumps = [1.0]
    for before, after in pairwise(steps):
        if before.direction == after.direction:
            jumps.append(1.0)
            continue
        angle = after.motion(np.array([after.begin]))[0, 0]
        torques = (float(knee.torque(angle, 0.0, step.pulls, step.direction)) for step in (before, after))
        one, other = (torque - float(leg.gravity(angle)) for torque in torques)
        jumps.append(other / one)
    return jumps
