"""Designs event feedback: numbers of the law adjusted once a cycle, or at each touchdown, to stabilise a gait."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.inputs import inputs_of, list_inputs
from spear_pin.gaits.linear import SYMMETRIC, Linear, between, linear, linearize, separable
from spear_pin.gaits.parity import Multipliers, merge_multipliers, split_multipliers
from spear_pin.gaits.spatial.trotting import halfway
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.event_feedback import EventFeedback, feedback_of, with_feedback
from spear_pin.hybrid.fields import names_of, value_in, with_fields
from spear_pin.hybrid.parameters import numbers_of_law, rebuilt
from spear_pin.hybrid.periodic import chart, eigenvalues, multipliers, return_map
from spear_pin.hybrid.symmetry import asymmetry
from spear_pin.kinds import typed

UPRIGHT = ("posterior_adduction",)  # enough to keep a symmetric gait in space from falling sideways
MIXED = 1e-6  # share of an input's effect on motion of the other parity that is not rounding
GAINS, GAIN_STEP = (-150.0, 150.0), 20.0  # N·s: range of the search, and step between simulated gains


@dataclass(frozen=True)
class Regulated:
    """A gait with feedback, and all multipliers of its section without and with feedback.

    Attributes:
        gait: the gait with feedback.
        without: multipliers of the gait without feedback; the heading's is left out, because nothing depends on it.
        held: multipliers with feedback. The heading's is among them where it is regulated and the gait is exactly
            symmetric; it is left out if the gait is only nearly symmetric.
    """

    gait: Gait
    without: Multipliers
    held: Multipliers


@typed
def add_feedback(
    gait: Gait,
    inputs: Sequence[str] | None = None,
    *,
    heading: float = 0.0,
    weight: float = 0.2,
    rtol: float = 1e-10,
) -> Gait:
    """Adds linear-quadratic feedback of the section state to numbers of the law, once a cycle; see `regulate`.

    Returns:
        the gait with feedback; its multipliers are all of the section's, whether feedback acts on them or not.
    """
    return regulate(gait, inputs, heading=heading, weight=weight, rtol=rtol).gait


@typed
def regulate(
    gait: Gait,
    inputs: Sequence[str] | None = None,
    *,
    heading: float = 0.0,
    weight: float = 0.2,
    rtol: float = 1e-10,
) -> Regulated:
    """Designs linear-quadratic feedback of the section state to numbers of the law, once a cycle.

    At the section w = K ξ is added to the inputs until the next cycle begins; in a trot or a pace twice a stride. K
    minimises Σ ξᵀQ ξ + weight Σ (w / one)², with Q = 1 but for the yaw, and what counts as one of each input; see
    `spear_pin.gaits.inputs`. In a gait in space that is symmetric, or nearly, lateral and symmetric motion are
    regulated separately, each by the inputs that act on it.

    Args:
        gait: a gait without event feedback, of any system whose section has (q, v) alone as its state.
        inputs: names of numbers of the law. The default is all that the law lists in `inputs`; for a symmetric gait in
            space it is "posterior_adduction", which is enough to stay upright.
        heading: weight of the yaw, to regulate the heading of a symmetric gait in space too. With 0 the robot keeps any
            heading to which it is pushed.
        weight: weight of the inputs; a larger weight gives gentler feedback.
        rtol: relative tolerance of the integrator.

    Raises:
        UnknownName: an input is no number of the law.
        BadValue: the gait has feedback already, a weight is not valid, `inputs` is empty or names one twice, an input
            changes nothing, or motion that grows is not reached by them.
        NoGait: a perturbed cycle does not close.
    """
    _check_without(gait)
    require("weight", weight, lambda w: w > 0, "a number > 0")
    require("heading", heading, lambda w: w >= 0, "a number >= 0")
    system, apart = gait.system, separable(gait)
    if heading and not apart:
        raise BadValue("heading", heading, "0 for a gait that is not symmetric in space, and for a trot")
    inputs = _checked(gait, inputs, apart)
    local, one, turns = chart(system, gait.state), inputs_of(system, inputs), heading > 0
    A, B = linearize(gait, inputs, rtol)
    for name, column in zip(inputs, B.T, strict=True):
        if not column.any():
            raise BadValue("inputs", name, "numbers on which the next state depends")
    parts = {
        lateral: linear(gait, inputs, lateral=lateral, heading=turns and bool(lateral), whole=(A, B))
        for lateral in ((True, False) if apart else (None,))
    }
    free, held = {}, {}
    rows, gains = dict[str, Any](), np.zeros((len(inputs), local.dimension))
    for lateral, part in parts.items():
        acting = [i for i, name in enumerate(inputs) if len(parts) == 1 or _acts_most(name, lateral, parts)]
        own, moving = part.of([inputs[i] for i in acting]), part.A[: len(part.own), : len(part.own)]
        held[lateral] = free[lateral] = eigenvalues(moving)
        if acting:
            Q = np.eye(len(own.A))
            Q[-1, -1] = heading if turns and lateral else 1.0
            try:
                K = quadratic_gains(own.A, own.B, [one[i].one for i in acting], weight, Q)
            except np.linalg.LinAlgError:
                raise BadValue("inputs", own.inputs, "inputs that act on all motion that grows: add others") from None
            held[lateral] = eigenvalues(own.A - own.B @ K)
            gains[np.array(acting)[:, None], own.own] = K[:, : len(own.own)]
            rows |= dict(zip(own.inputs, map(_row, -K @ own.coordinates), strict=True))
    at_nominal = np.concatenate(local.state(np.zeros(local.dimension)))
    event = between(system)
    seen = np.concatenate(halfway(system, return_map(system, gait.state, rtol))) if event else ()
    feedback = EventFeedback(
        tuple(inputs),
        tuple(rows[name] for name in inputs),
        _row(at_nominal),
        tuple(each.most for each in one),
        between=event,
        halfway=_row(seen),
    )
    closed = with_feedback(system, feedback)
    d = local.dimension
    if event:  # whole strides, of which feedback acts on halves
        without, found = (merge_multipliers({None: multipliers(each, gait.state, rtol)}) for each in (system, closed))
    elif not apart or (asymmetry(system.robot, gait.state) <= SYMMETRIC and not _mixed(B[:d], local.even)):
        without, found = merge_multipliers(free), merge_multipliers(held)
    else:  # left and right act on each other
        without, found = (split_multipliers(each[:d], local.even) for each in (A, A - B @ gains))
    return Regulated(replace(gait, system=closed, multipliers=found.values), without, found)


def _checked(gait: Gait, inputs: Sequence[str] | None, apart: bool) -> Sequence[str]:
    """Returns the inputs, or the default.

    Raises:
        UnknownName: an input is no number of the law.
        BadValue: there is none, or one twice.
    """
    valid = numbers_of_law(gait.system)
    if inputs is None:
        known = tuple(name for name in list_inputs(gait.system.law) if name in valid)
        inputs = UPRIGHT if apart and {*UPRIGHT} <= {*known} else known
    for name in inputs:
        if name not in valid:
            raise UnknownName("input", name, valid)
    if not inputs or len(set(inputs)) < len(inputs):
        raise BadValue("inputs", inputs, "at least one number of the law, each once: name them")
    return inputs


def _acts_most(name: str, lateral: bool | None, parts: Mapping[bool | None, Linear]) -> bool:
    """Tells whether an input acts most on one of the parts."""
    sizes = {each: np.abs(part.B[: len(part.own), part.inputs.index(name)]).max() for each, part in parts.items()}
    return max(sizes, key=lambda each: float(sizes[each])) == lateral


def _mixed(B: Array, even: NDArray[np.bool_]) -> bool:
    """Tells whether some input acts on symmetric and on antisymmetric motion."""
    sizes = np.array([np.abs(B[even]).max(axis=0), np.abs(B[~even]).max(axis=0)])
    return bool((sizes.min(axis=0) > MIXED * sizes.max(axis=0)).any())


def _row(values: Any) -> tuple[float, ...]:
    return tuple(map(float, values))


def quadratic_gains(A: Array, B: Array, scales: Sequence[float], weight: float, Q: Array | None = None) -> Array:
    """Returns the gains K of w = -K ξ that minimise Σ ξᵀQ ξ + weight Σ (w / scale)², (k, n).

    Args:
        A: derivatives of ξ⁺ by ξ, (n, n).
        B: derivatives of ξ⁺ by the inputs w, (n, k).
        scales: change of each input that counts as one, in its unit.
        weight: weight of the inputs.
        Q: weights of the coordinates, (n, n); 1 by default.

    Raises:
        LinAlgError: no gains make the motion stable.
    """
    R = weight * np.diag([scale**-2 for scale in scales])
    P = scipy.linalg.solve_discrete_are(A, B, np.eye(len(A)) if Q is None else Q, R)
    return np.asarray(np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A), np.float64)


@typed
def speed_regulated(gait: Gait, gain: float | tuple[float, float] | None = None, rtol: float = 1e-9) -> Gait:
    """Returns the gait with β += K (ẋ - ẋ*) at each touchdown, with one gain for both stances.

    Args:
        gait: a bounding gait without event feedback.
        gain: K, in N·s, or one for posterior and one for anterior touchdown; None takes the single gain with the least
            spectral radius, to 1 N·s.
        rtol: relative tolerance of the integrator in the search for that gain.

    Raises:
        BadValue: the gait has feedback already.
        NoGait: a perturbed cycle does not close.
    """
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, "a bounding gait")
    _check_without(gait)
    cycle = return_map(gait.system, gait.state)
    speeds = float(gait.state[1][0]), float(cycle.event("anterior_touchdown").v[0])

    def trial(k: float | tuple[float, float]) -> Gait:
        return gait.with_law(speed_gain=k if isinstance(k, tuple) else (k, k), speed_nominal=speeds)

    found = trial(_best_gain(trial, rtol) if gain is None else gain)
    return replace(found, multipliers=eigenvalues(linearize(found, ())[0]))


def _best_gain(trial: Callable[[float], Gait], rtol: float) -> float:
    """Returns the gain with the least spectral radius.

    A stride's Jacobian is the product of the Jacobians of its two halves, each linear in the gain. So three Jacobians
    give all.
    """
    less, none, more = (linearize(trial(k), (), rtol)[0] for k in (-GAIN_STEP, 0.0, GAIN_STEP))
    slope, curvature = (more - less) / (2.0 * GAIN_STEP), (more + less - 2.0 * none) / (2.0 * GAIN_STEP**2)

    def radius(k: float) -> float:
        return float(np.abs(np.linalg.eigvals(none + k * (slope + k * curvature))).max())

    return float(scipy.optimize.minimize_scalar(radius, bounds=GAINS, method="bounded", options={"xatol": 1.0}).x)


@typed
def without_feedback(gait: Gait) -> Gait:
    """Returns a gait without event feedback of either kind, with the multipliers that it then has."""
    system = gait.system
    if not _has_feedback(system):
        return gait
    if "speed_gain" in names_of(system.law):
        system = rebuilt(system, law=with_fields(system.law, {"speed_gain": (0.0, 0.0)}))
    system = with_feedback(system, None)
    return replace(gait, system=system, multipliers=multipliers(system, gait.state))


def _has_feedback(system: HybridSystem) -> bool:
    gains = value_in(system.law, "speed_gain") if "speed_gain" in names_of(system.law) else ()
    return feedback_of(system) is not None or any(gains)


def _check_without(gait: Gait) -> None:
    if _has_feedback(gait.system):
        raise BadValue("gait", "one with event feedback", "one without: without_feedback(gait)")
