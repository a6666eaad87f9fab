"""Result of a simulation: samples, events, the energy ledger; saved, loaded, exported."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, UnknownName
from spear_pin.files import atomic
from spear_pin.hybrid.ground import Ground
from spear_pin.kinds import typed

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """Something that happened at one instant.

    Attributes:
        name: the guard's or switch's name.
        time: in s.
        domain: name of the domain in which it happened.
        q: configuration, (nq,).
        v_before: velocity before, (nv,).
        v: velocity after, (nv,).
        impulse: of the ground on each toe, along the ground and normal to it, in N·s, (ntoes, 2).
        work: energy brought into the mechanism at this instant by flow, in J (losses negative).
    """

    name: str
    time: float
    domain: str
    q: Array
    v_before: Array
    v: Array
    impulse: Array
    work: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Ledger:
    """Energy by flow and cycle; positive is into the mechanism.

    Attributes:
        flows: names of the flows.
        work: energy of each, in J, (cycles, flows).
        change: change of the stored energy (kinetic, gravity, springs), in J, (cycles,).
    """

    flows: tuple[str, ...]
    work: Array
    change: Array

    def __getitem__(self, flow: str) -> Array:
        """Energy of one flow in each cycle, in J, (cycles,).

        Raises:
            UnknownName: there is no such flow.
        """
        if flow not in self.flows:
            raise UnknownName("flow", flow, self.flows)
        column: Array = self.work[:, self.flows.index(flow)]
        return column

    @property
    def residual(self) -> Array:
        """Imbalance of energy in each cycle, in J, (cycles,): change of the stored energy less all flows."""
        left: Array = self.change - self.work.sum(axis=1)
        return left


@dataclass(frozen=True)
class Trajectory:
    """Motion over time; at every sample D a + C v + G = B tau + friction + Σ Jᵀ F, J and F in the ground's axes.

    An event's two sides are two samples. There are at least 100 samples a phase.

    Attributes:
        robot: name or path of the robot.
        coordinates: names of the coordinates, (nv,).
        actuated: names of the joints with motors, (nu,).
        toes: names of the toes, (ntoes,).
        spring_joints: joints that carry a spring, (nsprings,).
        t: time, in s, (n,).
        q: configuration, (n, nq).
        v: velocity, (n, nv).
        a: acceleration, (n, nv).
        domain: names of the domains, (n,).
        phase: names of the phases, (n,).
        cycle: number of the cycle, 0 before the first section, (n,).
        u: motor torque, in N·m, (n, nu).
        tau: total joint torque with spring and damping, in N·m, (n, nu).
        friction: other generalised friction, (n, nv).
        force: ground force on each toe, along the ground (x) and normal to it (z), in N, (n, ntoes, 2).
        spring: torque of each spring on its joint, in N·m, (n, nsprings).
        engaged: whether each spring is engaged, (n, nsprings).
        current: of each motor, in A, (n, nu); (n, 0) without hardware.
        reference: the current that was asked for, in A, as `current`.
        events: what happened.
        ledger: the energy ledger of whole cycles.
        cycles: number of whole cycles.
        reason: why the run ended; "complete" if it reached the cycles asked for.
        message: the same in a sentence.
        evaluations: number of right-hand sides evaluated.
        electrical: the ledger of what drives the joints, None without hardware: batteries positive, heat, gears
            and motors negative (a motor's work is here what leaves), the change that of the inductances.
        ground: on which it is, along which and normal to which forces and impulses are; None if a file does not say.
        origin: of the robot, see `spear_pin.model.origin`; None if a file does not say.
    """

    robot: str
    coordinates: tuple[str, ...]
    actuated: tuple[str, ...]
    toes: tuple[str, ...]
    spring_joints: tuple[str, ...]
    t: Array
    q: Array
    v: Array
    a: Array
    domain: NDArray[np.str_]
    phase: NDArray[np.str_]
    cycle: NDArray[np.int64]
    u: Array
    tau: Array
    friction: Array
    force: Array
    spring: Array
    engaged: NDArray[np.bool_]
    current: Array
    reference: Array
    events: tuple[Event, ...]
    ledger: Ledger
    cycles: int
    reason: str
    message: str
    evaluations: int
    electrical: Ledger | None = None
    ground: Ground | None = None
    origin: Mapping[str, Any] | None = None

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.t)

    @property
    def complete(self) -> bool:
        """Whether all the cycles asked for were run."""
        return self.reason == "complete"

    def named(self, event: str) -> tuple[Event, ...]:
        """The events of one name, in order of time."""
        return tuple(e for e in self.events if e.name == event)

    @typed
    def save(self, path: str | Path) -> Path:
        """Write an npz file: arrays, and one JSON string for the rest; nothing is pickled."""
        from spear_pin.hybrid.trajectory_file import write

        return write(self, path)

    @classmethod
    @typed
    def load(cls, path: str | Path) -> Trajectory:
        """Read what `save` wrote.

        Raises:
            BadFile: it cannot be read, or is not a trajectory: an array is missing, unknown, of another kind or
                shape than its axes' names say, not finite, or out of order.
        """
        from spear_pin.hybrid.trajectory_file import read

        return read(path)

    @typed
    def export(self, path: str | Path) -> Path:
        """Write the samples as CSV or MATLAB file, by the path's suffix.

        Raises:
            BadValue: the suffix is neither .csv nor .mat.
        """
        suffix = Path(path).suffix
        if suffix == ".csv":
            columns, table = self.columns()
            with atomic(path) as temporary, temporary.open("w", encoding="utf-8") as file:
                file.write(",".join(["domain", *columns]) + "\n")
                for name, row in zip(self.domain, table, strict=True):
                    file.write(name + "," + ",".join(map(repr, row.tolist())) + "\n")
        elif suffix == ".mat":
            from scipy.io import savemat

            arrays = {name: getattr(self, name) for name in SAMPLED}
            arrays["domain"], arrays["phase"] = self.domain.astype(object), self.phase.astype(object)
            ledger = {flow: self.ledger[flow] for flow in self.ledger.flows}
            events = {"name": [e.name for e in self.events], "time": [e.time for e in self.events]}
            extra: dict[str, Any] = {"coordinates": list(self.coordinates), "ledger": ledger, "events": events}
            if self.electrical is not None:
                extra["electrical"] = {flow: self.electrical[flow] for flow in self.electrical.flows}
            with atomic(path) as temporary, temporary.open("wb") as file:
                savemat(file, arrays | extra, oned_as="column")
        else:
            raise BadValue("path", str(path), "a name ending in .csv or .mat")
        return Path(path)

    def columns(self) -> tuple[list[str], Array]:
        """Names with units, and values, of everything numeric, one row a sample."""
        names, parts = ["t [s]", "cycle"], [self.t[:, None], self.cycle[:, None].astype(float)]
        for symbol, values, labels in (
            ("q", self.q, self.coordinates),
            ("v", self.v, self.coordinates),
            ("a", self.a, self.coordinates),
            ("u", self.u, self.actuated),
            ("tau", self.tau, self.actuated),
            ("friction", self.friction, self.coordinates),
            ("spring", self.spring, self.spring_joints),
            ("current", self.current, self.actuated if self.current.size else ()),
            ("reference", self.reference, self.actuated if self.reference.size else ()),
            ("force_x", self.force[:, :, 0], self.toes),
            ("force_z", self.force[:, :, 1], self.toes),
        ):
            names += [f"{symbol}_{label}" for label in labels]
            parts.append(values)
        return names, np.hstack(parts)


_REST = ("robot", "coordinates", "actuated", "toes", "spring_joints", "cycles", "reason", "message", "evaluations")
_PARTS = ("events", "ledger", "electrical", "ground", "origin")
SAMPLED = tuple(f.name for f in fields(Trajectory) if f.name not in (*_REST, *_PARTS))
"""The arrays over samples."""
