"""Derivatives of a release by its parameters: the linearised equation of motion along the release.

    J δ̈ = (∂τ/∂θ - G' - ½ J'' θ̇² - J' θ̈) δ + (∂τ/∂θ̇ - J' θ̇) δ̇ + ∂τ/∂p,      δ = ∂θ/∂p

with -θ̈ in the place of ∂τ/∂p for the rotor's share of J. On each step of the integration that found the motion it is
solved by collocation at Gauss's nodes. Where dry friction changes its sign the knee stands still; its acceleration
jumps, and with it δ̇, in the same ratio, for the time of the turn depends on p.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import legendre

from spear_pin.arrays import Array
from spear_pin.hybrid.tangent.collocation import carry_along, rule
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.push_test.passive_knee import PassiveKnee

# what a motion can be derived by: the numbers of the passive knee, the reflected rotor inertia, the start
PARAMETERS = ("stiffness", "damping", "coulomb", "zero", "rotor", "initial_angle")
STAGES = 8  # of the collocation: its error is far below that of the motion


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
    start = np.array([[float(name == "initial_angle") for name in wrt], np.zeros(len(wrt))])
    if not steps or not wrt:
        return np.tile(start[0], (times.size, 1))
    begin, ends = np.array([step.begin for step in steps]), np.array([step.end for step in steps])
    h, slopes, parts = ends - begin, _slopes(leg, knee, steps, wrt), []
    turns = [n for n in range(1, len(steps)) if steps[n - 1].direction != steps[n].direction]
    for first, last in pairwise([0, *turns, len(steps)]):
        if first:
            start = start * [[1.0], [_jump(leg, knee, steps[first - 1], steps[first])]]
        parts.append(carry_along(slopes[first:last], h[first:last], start))
        start = parts[-1].end
    starts = np.concatenate([part.begins[:-1] for part in parts])
    bends = rule(STAGES).legendre @ np.concatenate([part.K[:, 0] for part in parts])  # δ̈ h as Legendre series
    twice = legendre.legint(bends.swapaxes(0, 1), 2, lbnd=-1.0)
    at = np.minimum(np.searchsorted(ends, times), len(steps) - 1)
    since = np.minimum(times, ends[-1]) - begin[at]
    place = (2.0 * since / h[at] - 1.0)[:, None]
    found = starts[at, 0] + since[:, None] * starts[at, 1]
    found += 0.25 * h[at, None] * legendre.legval(place, twice[:, at], tensor=False)
    found[times > ends[-1]] = start[0]
    return np.asarray(found)


def _slopes(leg: PinnedLeg, knee: PassiveKnee, steps: Sequence[Step], wrt: Sequence[str]) -> Array:
    """Returns δ̈ at each step's nodes per δ and δ̇, and for none of them: (steps, STAGES, 1, 2 + wrt)."""
    nodes = rule(STAGES).nodes
    theta, v = np.stack([s.motion(s.begin + nodes * (s.end - s.begin)) for s in steps], axis=1)
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
    parts = [by_angle, by_rate, *(forcing[name] / inertia for name in wrt)]
    return np.stack(np.broadcast_arrays(*parts), axis=-1)[:, :, None]


def _jump(leg: PinnedLeg, knee: PassiveKnee, before: Step, after: Step) -> float:
    """Returns the ratio of δ̇ after the beginning of a step to that before."""
    angle = after.motion(np.array([after.begin]))[0, 0]
    torques = (float(knee.torque(angle, 0.0, step.pulls, step.direction)) for step in (before, after))
    one, other = (torque - float(leg.gravity(angle)) for torque in torques)
    return other / one
