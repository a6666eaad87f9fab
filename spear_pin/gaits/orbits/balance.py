"""Balance: feedback once a stride that keeps a symmetric gait in space upright, on its speed and on its heading.

By mirror symmetry, a symmetric gait's return map is block diagonal to first order. Symmetric motion, which is planar,
and antisymmetric motion, with the heading, are two systems with inputs of their own. A trot's half stride seen in the
mirror is one system. A gait that is not symmetric is one system, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.gaits.feedback import linearized, quadratic_gains
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.orbits.parity import Multipliers, merged, parted
from spear_pin.gaits.spatial.law import ACROSS, INPUTS, is_angle
from spear_pin.gaits.spatial.trot_law import TROT_INPUTS, TrotLaw
from spear_pin.gaits.spatial.trotting import halfway
from spear_pin.hybrid.charts import Chart
from spear_pin.hybrid.periodic import chart, eigenvalues, multipliers, return_map
from spear_pin.hybrid.symmetry import YAW, asymmetry
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space

SCALES = {
    "adduction_torque": 10.0,
    "hip_difference": 25.0,
    "knee_difference": 25.0,
    "leg_difference": 0.05,
    "adduction": 0.05,
    "torque": 50.0,
    "squeeze": 10.0,
    "touchdown": 0.05,
    "spread": 0.05,
}
"""What counts as one of an input of Q-SPEAR, by how its name ends, in N·m and rad; of a pair's torque twice a leg's."""
SYMMETRIC, NEARLY = 1e-9, 0.25  # limits of `asymmetry`: exact, and near enough for separate parities


@dataclass(frozen=True)
class Linear:
    """First-order motion a⁺ = A a + B w over coordinates of one parity or all; the heading, if included, is the last.

    Attributes:
        A: (n, n).
        B: (n, k).
        inputs: names of the k inputs.
        coordinates: rows that give the n coordinates of a state (q, v), headed, (n, 2 nv).
        scales: unit of each input, (k,).
    """

    A: Array
    B: Array
    inputs: tuple[str, ...]
    scales: tuple[float, ...]
    coordinates: Array


@dataclass(frozen=True)
class Balance:
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
def across(gait: Gait, inputs: Sequence[str] = ACROSS, *, heading: bool = False, rtol: float = 1e-10) -> Linear:
    """Returns A and B of antisymmetric motion, exact where the gait has derivatives, else by central differences.

    Args:
        gait: a symmetric gait in space, or a nearly symmetric one.
        inputs: names among `spear_pin.gaits.spatial.law.ACROSS`.
        heading: whether the yaw is a coordinate.
        rtol: relative tolerance of the integrator.

    Raises:
        UnknownName: an input is not among those names.
        BadValue: the gait is not in space, or not symmetric.
        NoGait: a perturbed stride does not close.
    """
    return _linear(gait, inputs, ACROSS, False, rtol, heading)


@typed
def along(gait: Gait, inputs: Sequence[str] = INPUTS[len(ACROSS) :], *, rtol: float = 1e-10) -> Linear:
    """Returns A and B of symmetric motion, which is planar; see `across` for the arguments."""
    return _linear(gait, inputs, INPUTS[len(ACROSS) :], True, rtol)


@typed
def entire(gait: Gait, inputs: Sequence[str], *, rtol: float = 1e-10) -> Linear:
    """Returns A and B of all motion without the heading; see `across` for the arguments.

    For a trot they describe half a stride, seen in the mirror, and inputs are among `TROT_INPUTS`. For other gaits
    inputs are among `spear_pin.gaits.spatial.law.INPUTS`.
    """
    return _linear(gait, inputs, _inputs_of(gait), None, rtol)


@typed
def balanced(
    gait: Gait,
    inputs: Sequence[str] | None = None,
    *,
    heading: float = 0.0,
    weight: float = 0.2,
    rtol: float = 1e-10,
) -> Gait:
    """Adds linear-quadratic feedback of the section state to a gait, once a stride, or twice for a trot.

    Lateral and symmetric motion are regulated separately, each by the inputs that act on it. At the section w = -K a is
    added to the inputs for the stride. K minimises Σ aᵀQ a + weight Σ (w / scale)²; the scales are `SCALES`, and Q is 1
    except for the yaw. A gait that is only nearly symmetric, because its robot is, gets the same feedback. In a gait
    that is not symmetric, such as a gallop, all motion is regulated at once.

    Args:
        gait: a gait in space without such feedback.
        inputs: names among `spear_pin.gaits.spatial.law.INPUTS`. For a bound one lateral input is enough to stay
            upright, by default "posterior_adduction". For a gait that is not symmetric the default is all inputs, for a
            trot `TROT_INPUTS`.
        heading: weight of the yaw, to regulate the heading too; with 0 the robot keeps any heading to which it is
            pushed. A trot, or another gait that is not symmetric, always does.
        weight: weight of the inputs; a larger weight gives gentler feedback.
        rtol: relative tolerance of the integrator.

    Returns:
        the gait with feedback; its multipliers are all of the section's, along and lateral, whether feedback acts on
        them or not. The heading's is among them if it is kept and the gait is exactly symmetric, not nearly.

    Raises:
        BadValue: the gait has feedback already or is not in space, a weight is not valid, or `inputs` is empty or names
            one twice.
        UnknownName: an input is not among the valid names.
        NoGait: a perturbed stride does not close.
    """
    return balance(gait, inputs, heading=heading, weight=weight, rtol=rtol).gait


@typed
def balance(
    gait: Gait,
    inputs: Sequence[str] | None = None,
    *,
    heading: float = 0.0,
    weight: float = 0.2,
    rtol: float = 1e-10,
) -> Balance:
    """Adds feedback as `balanced` does, and returns multipliers without it too; see `balanced` for the arguments."""
    if gait.system.law.feedback:
        raise BadValue("gait", "one with event feedback", "one without: gait.with_law(feedback=())")
    require("weight", weight, lambda w: w > 0, "a number > 0")
    require("heading", heading, lambda w: w >= 0, "a number >= 0")
    trots, valid, local = isinstance(gait.system.law, TrotLaw), _inputs_of(gait), _chart(gait)[0]
    off = asymmetry(gait.system.robot, gait.state)
    at_once = trots or off > NEARLY
    if inputs is None:
        inputs = valid if at_once else ("posterior_adduction",)
    if at_once and heading:
        raise BadValue("heading", heading, "0 for a trot, and for a gait that is not symmetric")
    for name in inputs:
        if name not in valid:
            raise UnknownName("input", name, valid)
    if not inputs or len(set(inputs)) < len(inputs):
        raise BadValue("inputs", inputs, "at least one name, each once")
    exact = not at_once and off <= SYMMETRIC
    turns = heading > 0  # then the heading, on which nothing depends, is the last lateral coordinate
    linears: dict[bool | None, Linear] = {}  # by whether it is lateral; None: all at once
    if at_once:
        linears[None] = entire(gait, inputs, rtol=rtol)
    for side, find in ((True, partial(across, heading=turns)), (False, along)):
        own = [name for name in inputs if (name in ACROSS) == side]
        if not at_once and (own or exact):
            linears[side] = find(gait, own, rtol=rtol)
    free = {
        lateral: eigenvalues(each.A[:-1, :-1] if lateral and turns else each.A) for lateral, each in linears.items()
    }
    held, rows = dict(free), dict[str, list[float]]()
    for lateral, linear in linears.items():
        if linear.inputs:
            Q = np.eye(len(linear.A))
            Q[-1, -1] = heading if lateral and turns else 1.0
            gains = quadratic_gains(linear.A, linear.B, linear.scales, weight, Q)
            held[lateral] = eigenvalues(linear.A - linear.B @ gains)
            rows |= dict(zip(linear.inputs, (-gains @ linear.coordinates).tolist(), strict=True))
    nominal = np.concatenate(local.state(np.zeros(local.dimension)))
    zero = [0.0] * len(nominal)
    feedback = tuple(tuple(rows.get(name, zero)) for name in valid)
    closed = gait.with_law(feedback=feedback, nominal=tuple(nominal.tolist()))
    if trots and not gait.system.mirrored_toes:  # whole strides, of which feedback acts on halves
        between = np.concatenate(halfway(gait.system, return_map(gait.system, gait.state, rtol)))
        closed = closed.with_law(halfway=tuple(between.tolist()))
        without = merged({None: multipliers(gait.system, gait.state, rtol)})
        found = merged({None: multipliers(closed.system, closed.state, rtol)})
    elif at_once or exact:
        without, found = merged(free), merged(held)
    else:  # left and right act on each other a little
        without, found = (_all_of(each, rtol) for each in (gait, closed))
    return Balance(replace(closed, multipliers=found.values), without, found)


def _all_of(gait: Gait, rtol: float) -> Multipliers:
    """Returns the multipliers of all motion, each along or lateral by the motion that it changes most."""
    return parted(entire(gait, (), rtol=rtol).A, _chart(gait)[1])


def _chart(gait: Gait) -> tuple[Chart, NDArray[np.bool_]]:
    """Returns the chart of the section about a gait's state, and which of its coordinates are symmetric.

    Raises:
        BadValue: the gait is not in space.
    """
    local = chart(gait.system, gait.state)
    if local.lane.section.closed:
        raise BadValue("gait", gait, "a gait in space, as in_space(...) makes it")
    return local, local.even


def _inputs_of(gait: Gait) -> tuple[str, ...]:
    return TROT_INPUTS if isinstance(gait.system.law, TrotLaw) else INPUTS


def unit_of(name: str, robot: Robot) -> float:
    """Returns the unit in which an input is counted, in N·m or rad; torques scale with m g l."""
    one = next(scale for end, scale in SCALES.items() if name.endswith(end))
    return one if is_angle(name) else one * scale_in_space(robot).torque


def _linear(
    gait: Gait, inputs: Sequence[str], valid: Sequence[str], even: bool | None, rtol: float, heading: bool = False
) -> Linear:
    """Returns A and B over coordinates of one parity, with the heading if wanted; None: over all, without it."""
    for name in inputs:
        if name not in valid:
            raise UnknownName("input", name, valid)
    local, symmetric = _chart(gait)
    robot = gait.system.robot
    trots = isinstance(gait.system.law, TrotLaw)
    if trots and even is not None:
        raise BadValue("gait", gait, "a bound or a gallop: strides of a trot consist of two mirrored halves")
    if even is not None and asymmetry(robot, local.state(np.zeros(local.dimension))) > NEARLY:
        raise BadValue("gait", gait, "a gait whose left and right are mirror images, or nearly so")
    scales = {name: unit_of(name, robot) for name in inputs}
    end = partial(halfway, gait.system) if trots and not gait.system.mirrored_toes else None
    A, B = linearized(gait, inputs, rtol, scales=scales, end=end)
    d = local.dimension
    own = np.arange(d) if even is None else np.flatnonzero(symmetric == even)
    rows = np.append(own, [d] if heading else []).astype(np.int64)
    free = np.zeros((len(rows), len(rows)))
    free[:, : len(own)] = A[np.ix_(rows, own)]
    free[len(own) :, len(own) :] = 1.0  # nothing depends on the heading
    return Linear(free, B[rows], tuple(inputs), tuple(scales.values()), _rows(local, own, len(rows)))


def _rows(local: Chart, own: NDArray[np.int64], size: int) -> Array:
    """Returns rows that give chart coordinates of a state (q, v), (size, 2 nv); the heading's is last if included."""
    nv, dq = len(local.q_basis), local.q_basis.shape[1]
    rows = np.zeros((size, 2 * nv))
    for row, i in enumerate(own):
        if i < dq:
            rows[row, :nv] = local.q_basis[:, i]
        else:
            rows[row, nv:] = local.v_basis[:, i - dq]
    rows[len(own) :, YAW] = 1.0
    return rows
