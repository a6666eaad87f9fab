"""Many runs at once: the Taylor engine integrates lanes, which differ in state and parameters, side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from itertools import chain
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.dry_friction import has_dry_friction
from spear_pin.hybrid.engines import structure, taylor
from spear_pin.hybrid.engines.taylor import available as available
from spear_pin.hybrid.engines.taylor import require as require
from spear_pin.hybrid.fields import names_of
from spear_pin.hybrid.lanes.runner import FEW as FEW
from spear_pin.hybrid.lanes.runner import Lanes
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.parameters import left_out_at_zero, parameter, with_parameters
from spear_pin.hybrid.result import Options
from spear_pin.kinds import typed
from spear_pin.model.springs import places_of
from spear_pin.showing import Shown

TIMES_FINER = 1000.0  # the Taylor engine's tolerance is finer than `rtol` by this factor, which costs little
CHUNK = 16384  # lanes that run at a time; this bounds memory
LOCK = Lock()  # all threads share a compiled integrator, which has one state


@dataclass(frozen=True, repr=False)
class Batch(Shown):
    """Outcomes of the lanes.

    Attributes:
        q: final configurations, (n, nq). A lane that did not end "complete" has the one at its last section.
        v: final velocities, (n, nv).
        cycles: number of whole cycles that each lane ran, (n,).
        reason: why each lane ended, (n,), one of the reasons of `Trajectory`.
        message: the reason of each lane in a sentence.
        durations: time that each phase of the last whole cycle took, in s, (n,) each.
        observed: states (q, v), (n, nq + nv), at the last event of each name that is only recorded, such as the apex;
            empty unless `observe` was given.
        repeated: whether the reference engine had to run the lane, (n,).
        orders: (domain, event) of each event of the last whole cycle, in order, (n,); empty where more than `FEW`
            lanes ran together.
    """

    q: Array
    v: Array
    cycles: NDArray[np.int64]
    reason: NDArray[np.str_]
    message: tuple[str, ...]
    durations: Mapping[str, Array]
    observed: Mapping[str, Array]
    repeated: NDArray[np.bool_]
    orders: tuple[Order, ...] = ()

    def __len__(self) -> int:
        """Returns the number of lanes."""
        return len(self.reason)

    def __repr__(self) -> str:
        ends = zip(*np.unique(self.reason, return_counts=True), strict=True)
        return f"Batch({len(self)} lanes: {', '.join(f'{count} {reason}' for reason, count in ends)})"


@typed
def simulate_many(
    system: HybridSystem,
    q: ArrayLike,
    v: ArrayLike,
    cycles: int = 1,
    rtol: float = 1e-9,
    *,
    parameters: Mapping[str, ArrayLike] | None = None,
    observe: bool = False,
    unroll: bool | None = None,
    max_step: float | None = None,
    on_lanes: Callable[[int], object] = lambda n: None,
) -> Batch:
    """Runs whole cycles from many states, on the section or in the air before the first touchdown.

    In space a domain is compiled when it has been entered some times; until then the reference engine follows it. Only
    the flight in which lanes begin is compiled at once.

    Args:
        system: robot, law and ground.
        q: configurations, (n, nq).
        v: velocities, (n, nv).
        cycles: number of whole cycles.
        rtol: relative tolerance; the Taylor engine integrates a thousand times finer.
        parameters: numbers that differ from lane to lane, (n,) each, named as fields of law, spring or contact.
        observe: whether to record the states at events that change nothing.
        unroll: whether to compile code that runs two to three times as fast, but takes ten times as long to compile.
            The bound's four domains then take 40 s, once for each tolerance. By default robots with at most four
            coordinates are unrolled.
        max_step: longest step of the integrator, in s; None leaves it to the integrator.
        on_lanes: called with the number of lanes done since the last call.

    Raises:
        MissingExtra: heyoka is not installed.
        BadValue: shapes do not fit, a number is not finite, lanes cannot differ in a parameter (a spring's fixed rest
            angle), or the system has hardware, dry friction of joints, a pinned toe or a post.
        UnknownName: no part has a numeric field of a name in `parameters`.

    Example:
        >>> import numpy as np
        >>> from spear_pin import hopping, load, simulate_many
        >>> system = hopping(load("spear_ii", locked=["boom_x"]))
        >>> q, v = (np.tile(part, (3, 1)) for part in system.guess())
        >>> simulate_many(system, q, v, cycles=2, parameters={"stiffness": [45.0, 50.0, 55.0]})
        Batch(3 lanes: 3 complete)
    """
    q, v = np.array(q, dtype=float), np.array(v, dtype=float)
    given = {name: np.array(values, dtype=float) for name, values in (parameters or {}).items()}
    _check(system, q, v, given, cycles)
    system = _varying(system, given)
    require()
    code = taylor.Code(rtol / TIMES_FINER, observe, is_unrolled(system) if unroll is None else unroll)
    options, parts = Options(rtol, max_step=max_step), []
    for first in range(0, max(len(q), 1), CHUNK):
        chunk = slice(first, first + CHUNK)
        own = {name: values[chunk] for name, values in given.items()}
        lanes = Lanes(system, q[chunk], v[chunk], cycles, options, own, code)
        with LOCK:
            lanes.go()
        parts.append(_result(lanes))
        on_lanes(len(q[chunk]))
    return _joined(parts)


def check_equations(system: HybridSystem) -> None:
    """Checks that a system has equations of motion for scalars of any kind, of which derivatives are made.

    Raises:
        BadValue: it has hardware, or dry friction of joints other than that of brakes, or a boom that adds inertia to
            its robot.
    """
    if system.hardware is not None or has_dry_friction(system):
        raise BadValue("system", system.kind, "one without hardware and dry friction of joints, brakes apart")
    if system.robot.added is not None:
        raise BadValue("robot", system.robot.name, "one without a rotary boom")


def is_unrolled(system: HybridSystem) -> bool:
    """Tells whether cycles of a system run unrolled by default, which compiles for longer and then is fast."""
    return system.robot.nv <= taylor.UNROLLED


def may_differ(system: HybridSystem, name: str) -> bool:
    """Tells whether `name` may take a different value in each lane.

    The numbers of the law, of the springs and of the ground may, except for a spring's fixed rest angle.
    """
    return name in structure.all_others(system) or name in names_of(system.law)


def has_lanes(system: HybridSystem, names: Iterable[str]) -> bool:
    """Tells whether gaits of a system are found in lanes that differ in the named numbers; False without heyoka.

    In space compiling takes longer than the reference engine does.
    """
    return system.robot.planar and not system.pins and taylor.available() and may_vary(system, names)


def may_vary(system: HybridSystem, names: Iterable[str]) -> bool:
    """Tells whether the named numbers may vary where cycles of a system are differentiated."""
    try:
        check_equations(system)
    except BadValue:
        return False
    return all(may_differ(system, name) for name in names)


def _check(system: HybridSystem, q: Array, v: Array, given: Mapping[str, Array], cycles: int) -> None:
    robot = system.robot
    for name, array, width in (("q", q, robot.nq), ("v", v, robot.nv)):
        if array.ndim != 2 or array.shape[1] != width or not np.isfinite(array).all():
            raise BadValue(name, array, f"finite numbers of the shape (n, {width})")
    if len(q) != len(v):
        raise BadValue("v", len(v), f"as many lanes as q has, {len(q)}")
    if not cycles >= 1 or cycles % 1:
        raise BadValue("cycles", cycles, "a whole number, at least 1")
    check_equations(system)
    if system.pins or robot.post is not None:
        raise BadValue("system", system.kind, "one without pinned toes, and not round a post; run it one at a time")
    for name, values in given.items():
        parameter(system, name)  # its error lists the parameters
        if not may_differ(system, name):
            friction, *others = structure.all_others(system)
            raise BadValue("parameters", name, f"fields of the law, {', '.join(others)} or {friction}")
        place = places_of(system.springs).get(name)
        if place is not None and place.field == "slip" and not values.all() and values.any():
            raise BadValue(f"parameters[{name!r}]", values, "0 in all lanes or in none, as a clutch slips or does not")
        if values.shape != (len(q),) or not np.isfinite(values).all():
            raise BadValue(f"parameters[{name!r}]", values, f"{len(q)} finite numbers")
        for value in {values.min(initial=np.inf), values.max(initial=-np.inf)} if len(q) else ():
            with_parameters(system, {name: float(value)})  # its error says which values are valid


def _varying(system: HybridSystem, given: Mapping[str, Array]) -> HybridSystem:
    """Returns the system without zeros among the numbers that lanes differ in: numbers that are zero are left out."""
    most = {name: float(max(given[name], key=abs, default=0.0)) for name in given if left_out_at_zero(name)}
    zero = {name: value for name, value in most.items() if value != 0.0 and parameter(system, name) == 0.0}
    return with_parameters(system, zero)


def _result(lanes: Lanes) -> Batch:
    nq = lanes.system.robot.nq
    message = tuple(lanes.message.tolist())
    return Batch(
        lanes.end[:nq].T,
        lanes.end[nq:].T,
        lanes.cycles,
        lanes.reason.astype(str),
        message,
        lanes.durations,
        {name: states.T for name, states in lanes.observed.items()},
        lanes.repeated,
        tuple(lanes.orders),
    )


def _joined(parts: list[Batch]) -> Batch:
    def joined(values: list[Any]) -> Any:
        if isinstance(values[0], dict):
            return {name: joined([value[name] for value in values]) for name in values[0]}
        return np.concatenate(values) if isinstance(values[0], np.ndarray) else tuple(chain.from_iterable(values))

    return Batch(*(joined([getattr(part, field.name) for part in parts]) for field in fields(Batch)))
