"""Event feedback: parameters of the law adjusted once a stride, or at each touchdown, to stabilise a gait."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, UnknownName, require
from spear_pin.gaits.bounding_law import INPUTS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.tangent_cycles import tangent_cycles
from spear_pin.hybrid.batch import may_vary
from spear_pin.hybrid.newton import Lanes, Words, jacobian
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, eigenvalues, one_by_one, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.symmetry import YAW
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.hybrid.tangent.section import exact_map
from spear_pin.hybrid.tangent.seeds import seeds
from spear_pin.kinds import typed

SCALES = {name: 0.05 if name.endswith("touchdown") else 50.0 for name in INPUTS}  # rad and N·m: what counts as one
GAINS, GAIN_STEP = (-150.0, 150.0), 20.0  # N·s: range of the search, and step between simulated gains


@typed
def linearized(
    gait: Gait,
    inputs: Sequence[str],
    rtol: float = 1e-10,
    *,
    scales: Mapping[str, float] = SCALES,
    end: Callable[[Run], State] | None = None,
) -> tuple[Array, Array]:
    """Returns A and B of ξ⁺ = A ξ + B w: the return map's derivatives by section coordinates and by parameters.

    In the plane they are exact where the fast engine runs the gait and no events meet in it, because each side of a
    meeting has its own derivatives. In space they are exact for every cycle that has derivatives. Else they are central
    differences of the reference engine's cycles. Where two feet may land in either order they are the mean of both
    sides. In space A and B have a last row, for the change of heading.

    Args:
        gait: the gait.
        inputs: names of parameters, each constant through a stride.
        rtol: relative tolerance of the integrator.
        scales: change of each parameter that counts as one, by name; 1 for others.
        end: returns the state after a cycle, if it is not the cycle's last one; then there are differences alone.

    Raises:
        NoGait: a perturbed cycle does not close.
    """
    system = gait.system
    local = chart(system, gait.state)
    nominal, n = np.array([parameter(system, name) for name in inputs]), local.dimension

    def cycle(begun: State, values: Array) -> tuple[Run, Array]:
        trial = with_parameters(system, dict(zip(inputs, values.tolist(), strict=True)))
        run = return_map(trial, begun, rtol)
        turn = run.state[0][YAW : YAW + 1] - begun[0][YAW : YAW + 1] if system.section_toes else np.empty(0)
        if end is not None and run.cycles:
            run.state = end(run)
        return run, turn

    if system.section_toes and end is None and may_vary(system, ()):
        try:
            found = exact_map(system, gait.state, seeds(system, inputs).numbers)
            return found[:, :n], found[:, n:]
        except REFUSALS:
            pass
    exact = None if system.section_toes else tangent_cycles(system, inputs, ())
    slopes = None if exact is None else exact.slopes
    cycles = one_by_one(cycle, int(bool(system.section_toes)))
    shooting = Shooting(local.lane, cycles, tuple(inputs), slopes=slopes)
    if exact is not None and not exact.borders(*gait.state, nominal):
        here = np.concatenate([np.zeros(n), nominal])
        found = shooting.jacobians(np.zeros(1, dtype=np.int64), here[None])[0]
        if np.isfinite(found).all():
            return found[:, :n] + np.eye(n), found[:, n:]
    sizes = np.array([*np.ones(n), *(scales.get(name, 1.0) for name in inputs)])
    centre = np.concatenate([np.zeros(n), nominal])

    def mapped(lanes: Lanes, z: Array) -> tuple[Array, Words]:
        unknowns = centre + sizes * z
        after = cycles(lanes, *shooting.states(lanes, unknowns), unknowns[:, n:])
        return np.concatenate([local.lane.take(lanes).coordinates(after.q, after.v), after.measured], 1), after.reason

    found, why = jacobian(mapped, np.zeros(len(centre)))
    if why:
        raise NoGait("a perturbed cycle does not close", gait.residual)
    return found[:, :n], found[:, n:] / sizes[n:]


@typed
def regulated(gait: Gait, inputs: Sequence[str] = INPUTS, weight: float = 0.2, rtol: float = 1e-10) -> Gait:
    """Returns the gait with discrete linear-quadratic feedback of its section state to parameters of the law.

    Once a stride, just after posterior touchdown, w = -K ξ is added to the `inputs`. K minimises Σ ξᵀξ + weight Σ (w /
    scale)²; the scales are 50 N·m and 0.05 rad.

    Args:
        gait: a bounding gait without such feedback.
        inputs: names among `INPUTS` that it may use.
        weight: weight of the inputs; a larger weight gives gentler feedback.
        rtol: relative tolerance of the integrator.

    Raises:
        UnknownName: an input is not among `INPUTS`.
        BadValue: the gait has feedback already, or the weight is not positive.
        NoGait: a perturbed cycle does not close.
    """
    _without_feedback(gait)
    for name in inputs:
        if name not in INPUTS:
            raise UnknownName("input of event feedback", name, INPUTS)
    if not inputs:
        raise BadValue("inputs", inputs, f"at least one of {', '.join(INPUTS)}")
    require("weight", weight, lambda w: w > 0, "a number > 0")
    system = gait.system
    A, B = linearized(gait, inputs, rtol)
    K = quadratic_gains(A, B, [SCALES[name] for name in inputs], weight)
    local = chart(system, gait.state)
    q, v = gait.state
    # ξ of a state less the fixed point's: the cyclic torso_x has no part in it
    to_chart = np.zeros((local.dimension, len(q) - 1 + len(v)))
    dq = local.q_basis.shape[1]
    to_chart[:dq, : len(q) - 1], to_chart[dq:, len(q) - 1 :] = local.q_basis[1:].T, local.v_basis.T
    rows = dict(zip(inputs, (-K @ to_chart).tolist(), strict=True))
    zero = [0.0] * to_chart.shape[1]
    feedback = tuple(tuple(rows.get(name, zero)) for name in INPUTS)
    closed = gait.with_law(feedback=feedback, nominal=(*q[1:].tolist(), *v.tolist()))
    return replace(closed, multipliers=eigenvalues(A - B @ K))


def quadratic_gains(A: Array, B: Array, scales: Sequence[float], weight: float, Q: Array | None = None) -> Array:
    """Returns the gains K of w = -K ξ that minimise Σ ξᵀQ ξ + weight Σ (w / scale)², (k, n).

    Args:
        A: derivatives of ξ⁺ by ξ, (n, n).
        B: derivatives of ξ⁺ by the inputs w, (n, k).
        scales: change of each input that counts as one, in its unit.
        weight: weight of the inputs.
        Q: weights of the coordinates, (n, n); 1 by default.
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
    _without_feedback(gait)
    cycle = return_map(gait.system, gait.state)
    speeds = float(gait.state[1][0]), float(cycle.event("anterior_touchdown").v[0])

    def trial(k: float | tuple[float, float]) -> Gait:
        return gait.with_law(speed_gain=k if isinstance(k, tuple) else (k, k), speed_nominal=speeds)

    return _multiplied(trial(_best_gain(trial, rtol) if gain is None else gain), 1e-10)


def _best_gain(trial: Callable[[float], Gait], rtol: float) -> float:
    """Returns the gain with the least spectral radius.

    A stride's Jacobian is the product of the Jacobians of its two halves, each linear in the gain. So three Jacobians
    give all.
    """
    less, none, more = (linearized(trial(k), (), rtol)[0] for k in (-GAIN_STEP, 0.0, GAIN_STEP))
    slope, curvature = (more - less) / (2.0 * GAIN_STEP), (more + less - 2.0 * none) / (2.0 * GAIN_STEP**2)

    def radius(k: float) -> float:
        return float(np.abs(np.linalg.eigvals(none + k * (slope + k * curvature))).max())

    return float(scipy.optimize.minimize_scalar(radius, bounds=GAINS, method="bounded", options={"xatol": 1.0}).x)


def _without_feedback(gait: Gait) -> None:
    law = gait.system.law
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, "a bounding gait")
    if law.feedback or any(law.speed_gain):
        raise BadValue(
            "gait", "one with event feedback", "one without: gait.with_law(feedback=(), speed_gain=(0.0, 0.0))"
        )


def _multiplied(gait: Gait, rtol: float) -> Gait:
    """Returns the gait with its multipliers computed again."""
    return replace(gait, multipliers=eigenvalues(linearized(gait, (), rtol)[0]))
