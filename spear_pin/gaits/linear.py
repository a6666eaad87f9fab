"""The return map to first order: derivatives by the section's coordinates and by numbers of the law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.inputs import inputs_of
from spear_pin.gaits.spatial.trotting import HALFWAY, halfway
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import may_vary
from spear_pin.hybrid.newton import Lanes, Words, jacobian
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, one_by_one, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.symmetry import YAW, asymmetry
from spear_pin.hybrid.tangent.resets import attempt
from spear_pin.hybrid.tangent.section import exact_map
from spear_pin.hybrid.tangent.seeds import seeds
from spear_pin.kinds import typed

SYMMETRIC, NEARLY = 1e-9, 0.25  # limits of `asymmetry`: exact, and near enough for separate parities


@dataclass(frozen=True)
class Linear:
    """First-order motion a⁺ = A a + B w over coordinates of one parity or all; the heading, if included, is the last.

    Attributes:
        A: (n, n).
        B: (n, k).
        inputs: names of the k inputs.
        coordinates: rows that give the n coordinates of a state (q, v), headed, (n, 2 nv).
        own: which coordinates of the section these are, without the heading.
    """

    A: Array
    B: Array
    inputs: tuple[str, ...]
    coordinates: Array
    own: NDArray[np.int64]

    def of(self, names: Sequence[str]) -> Linear:
        """Returns the motion by some of the inputs."""
        columns = [self.inputs.index(name) for name in names]
        return Linear(self.A, self.B[:, columns], tuple(names), self.coordinates, self.own)


def linear(
    gait: Gait,
    inputs: Sequence[str],
    *,
    lateral: bool | None = None,
    heading: bool = False,
    whole: tuple[Array, Array] | None = None,
) -> Linear:
    """Returns A and B of a gait, of all motion or of one parity.

    For a trot or a pace they describe half a stride, seen in the mirror.

    Args:
        gait: the gait.
        inputs: names of numbers of its law.
        lateral: True for antisymmetric motion alone, False for symmetric motion alone, which is planar, where the gait
            is symmetric, or nearly; None for all motion.
        heading: whether the yaw is a coordinate, of antisymmetric motion; then it is the last.
        whole: what `linearize` returns, if it is known.

    Raises:
        BadValue: `lateral` is given, and the gait is not in space, not symmetric, or its cycle is half a stride.
        NoGait: a perturbed cycle does not close.
    """
    if lateral is not None and not separable(gait):
        raise BadValue(
            "gait", gait, "a gait in space whose left and right are mirror images, or nearly so, and no trot"
        )
    system, local = gait.system, chart(gait.system, gait.state)
    A, B = whole or linearize(gait, inputs)
    d = local.dimension
    own = np.arange(d) if lateral is None else np.flatnonzero(local.even != lateral)
    rows = np.append(own, [d] if heading else []).astype(np.int64)
    free = np.zeros((len(rows), len(rows)))
    free[:, : len(own)] = A[np.ix_(rows, own)]
    free[len(own) :, len(own) :] = 1.0  # nothing depends on the heading
    nv, dq = local.q_basis.shape
    coordinates = np.zeros((len(rows), 2 * nv))
    coordinates[: len(own), :nv] = np.pad(local.q_basis.T, ((0, d - dq), (0, 0)))[own]
    coordinates[: len(own), nv:] = np.pad(local.v_basis.T, ((dq, 0), (0, 0)))[own]
    coordinates[:, [system.robot.index(name) for name in system.cyclic]] = 0.0  # but for rounding they are
    coordinates[len(own) :, YAW] = 1.0
    return Linear(free, B[rows], tuple(inputs), coordinates, own)


def between(system: HybridSystem) -> str:
    """Returns the event between the halves of a stride, if a cycle is the whole of it; else ""."""
    names = {guard.name for domain in system.domains for guard in domain.guards}
    return HALFWAY if HALFWAY in names else ""


def separable(gait: Gait) -> bool:
    """Tells whether symmetric and antisymmetric motion of a gait are separate, or nearly so."""
    system, local = gait.system, chart(gait.system, gait.state)
    if local.lane.section.closed or system.mirrored_toes or between(system):  # or a stride has mirrored halves
        return False
    return asymmetry(system.robot, gait.state) <= NEARLY


@typed
def linearize(gait: Gait, inputs: Sequence[str], rtol: float = 1e-10) -> tuple[Array, Array]:
    """Returns A and B of ξ⁺ = A ξ + B w: the return map's derivatives by section coordinates and by parameters.

    They are exact for every cycle that has derivatives, else central differences of the reference engine's cycles.
    Where two feet may land in either order they are the mean of both sides. In space A and B have a last row, for the
    change of heading.

    Args:
        gait: the gait.
        inputs: names of parameters, each constant through a stride.
        rtol: relative tolerance of the integrator.

    Raises:
        NoGait: a perturbed cycle does not close.
    """
    system = gait.system
    end: Callable[[Run], State] | None = partial(halfway, system) if between(system) else None
    local = chart(system, gait.state)
    nominal, n = np.array([parameter(system, name) for name in inputs]), local.dimension

    if end is None and may_vary(system, ()):
        exact = attempt(lambda: exact_map(system, gait.state, seeds(system, inputs).numbers))
        if exact is not None:
            return exact[:, :n], exact[:, n:]

    def cycle(begun: State, values: Array) -> Run:
        run = return_map(with_parameters(system, dict(zip(inputs, values.tolist(), strict=True))), begun, rtol)
        if end is not None and run.cycles:
            run.state = end(run)
        return run

    turn = [lambda run, _: run.events[-1].q[YAW] - run.start[0][YAW]] if system.section_toes else []
    cycles = one_by_one(system, cycle, turn)
    shooting = Shooting(local.lane, cycles, tuple(inputs))
    sizes = np.array([*np.ones(n), *(each.one for each in inputs_of(system, inputs))])
    centre = np.concatenate([np.zeros(n), nominal])

    def mapped(lanes: Lanes, z: Array) -> tuple[Array, Words]:
        unknowns = centre + sizes * z
        after = cycles(lanes, *shooting.states(lanes, unknowns), unknowns[:, n:])
        return np.concatenate([local.lane.take(lanes).coordinates(after.q, after.v), after.measured], 1), after.reason

    found, why = jacobian(mapped, np.zeros(len(centre)))
    if why:
        raise NoGait("a perturbed cycle does not close", gait.residual)
    return found[:, :n], found[:, n:] / sizes[n:]
