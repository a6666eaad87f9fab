"""Balance: what keeps a symmetric gait from falling sideways, and on its heading, by feedback once a stride.

By the mirror a symmetric gait's return map is block diagonal to first order: antisymmetric coordinates of the section
and inputs, with the heading, are a system of their own. And P(M x) = M P(x), so that one side of each difference tells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.errors import BadValue, NoGait, UnknownName, require
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.spatial.law import INPUTS
from spear_pin.hybrid.newton import STEP
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart, eigenvalues, return_map
from spear_pin.hybrid.result import State
from spear_pin.hybrid.spatial_section import SpatialCharts
from spear_pin.hybrid.symmetry import YAW, mirror_of
from spear_pin.kinds import typed

Array = NDArray[np.float64]
SCALES = {"hip_difference": 25.0, "knee_difference": 25.0, "leg_difference": 0.05, "adduction": 0.05}
TORQUE_SCALE = 10.0  # N·m: what counts as one, of torques of adductions; the others' are in `SCALES`, in N·m and rad
SYMMETRIC = 1e-9


@dataclass(frozen=True)
class Lateral:
    """First-order motion across: a⁺ = A a + B w over antisymmetric coordinates, the heading, if there is one, last.

    Attributes:
        A: (n, n).
        B: (n, k).
        inputs: names of the k inputs.
        coordinates: of the state (q, v), headed, the n coordinates, (n, 2 nv).
    """

    A: Array
    B: Array
    inputs: tuple[str, ...]
    coordinates: Array


@typed
def lateral(gait: Gait, inputs: Sequence[str] = INPUTS, *, heading: bool = False, rtol: float = 1e-10) -> Lateral:
    """A and B of motion across, by a stride for each column.

    Args:
        gait: in space, symmetric.
        inputs: among `INPUTS`.
        heading: whether the yaw is a coordinate.
        rtol: of the integrator.

    Raises:
        UnknownName: an input is not among `INPUTS`.
        BadValue: the gait is not in space, or not symmetric.
        NoGait: a perturbed stride does not close.
    """
    for name in inputs:
        if name not in INPUTS:
            raise UnknownName("input", name, INPUTS)
    system, (q, v) = gait.system, gait.state
    mirror = mirror_of(system.robot)
    local = chart(system, gait.state)
    off = max(np.abs(mirror(part) - part).max() for part in local.state(np.zeros(local.dimension)))
    if off > SYMMETRIC:
        raise BadValue("gait", gait, "a symmetric one")
    assert isinstance(local.lane, SpatialCharts)
    odd = np.flatnonzero(~local.lane.even)

    def after(state: State, values: dict[str, float]) -> Array:
        run = return_map(with_parameters(system, values), state, rtol)
        if not run.cycles:
            raise NoGait(f"a perturbed stride does not close: {run.message}", gait.residual)
        return np.append(local.coordinates(run.state)[odd], run.state[0][YAW] - state[0][YAW])

    unit = np.eye(local.dimension)
    columns = [after(local.state(STEP * unit[i]), {}) / STEP for i in odd]
    scaled = [(name, STEP * scale_of(name)) for name in inputs]
    columns += [after((q, v), {name: size}) / size for name, size in scaled]
    whole, n = np.array(columns).T, len(odd)
    A, B = np.zeros((n + 1, n + 1)), whole[:, n:]
    A[:, :n], A[n, n] = whole[:, :n], 1.0
    rows = np.zeros((n + 1, 2 * len(q)))
    dq = local.q_basis.shape[1]
    for row, i in enumerate(odd):
        basis, at = (local.q_basis, i) if i < dq else (local.v_basis, i - dq)
        part = slice(0, len(q)) if i < dq else slice(len(q), None)
        rows[row, part] = basis[:, at]
    rows[n, YAW] = 1.0
    kept = n + heading
    return Lateral(A[:kept, :kept], B[:kept], tuple(inputs), rows[:kept])


@typed
def balanced(
    gait: Gait,
    inputs: Sequence[str] = ("posterior_adduction",),
    *,
    heading: float = 0.0,
    weight: float = 0.2,
    rtol: float = 1e-10,
) -> Gait:
    """The gait with linear-quadratic feedback of what is across to some inputs, once a stride.

    At the section w = -K a is added to the inputs for the stride; K minimises Σ aᵀQ a + weight Σ (w / scale)², scales
    being 25 N·m of hips and knees, 10 N·m of adductions, and 0.05 rad; Q is 1 but for the yaw.

    Args:
        gait: in space, symmetric, without such feedback.
        inputs: among `spear_pin.gaits.spatial.law.INPUTS`; one suffices to stay upright.
        heading: weight of the yaw, to keep the heading too; 0: it goes on to wherever it was pushed.
        weight: of the inputs; the larger, the gentler.
        rtol: of the integrator.

    Returns:
        the gait with feedback; its multipliers are those across, the heading's among them if that is kept.

    Raises:
        BadValue: the gait has feedback already, is not in space or not symmetric, or a weight is not valid.
        UnknownName: an input is not among these.
        NoGait: a perturbed stride does not close.
    """
    if gait.system.law.feedback:
        raise BadValue("gait", "one with event feedback", "one without")
    require("weight", weight, lambda w: w > 0, "a number > 0")
    require("heading", heading, lambda w: w >= 0, "a number >= 0")
    across = lateral(gait, inputs, heading=heading > 0, rtol=rtol)
    Q = np.eye(len(across.A))
    if heading > 0:
        Q[-1, -1] = heading
    R = weight * np.diag([scale_of(name) ** -2 for name in inputs])
    P = scipy.linalg.solve_discrete_are(across.A, across.B, Q, R)
    K = np.linalg.solve(R + across.B.T @ P @ across.B, across.B.T @ P @ across.A)
    rows = dict(zip(inputs, (-K @ across.coordinates).tolist(), strict=True))
    zero = [0.0] * across.coordinates.shape[1]
    feedback = tuple(tuple(rows.get(name, zero)) for name in INPUTS)
    local = chart(gait.system, gait.state)
    nominal = np.concatenate(local.state(np.zeros(local.dimension)))
    closed = gait.with_law(feedback=feedback, nominal=tuple(nominal.tolist()))
    return replace(closed, multipliers=eigenvalues(across.A - across.B @ K))


def scale_of(name: str) -> float:
    """What counts as one of an input, in N·m or rad."""
    return next((scale for end, scale in SCALES.items() if name.endswith(end)), TORQUE_SCALE)
