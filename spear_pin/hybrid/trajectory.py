"""What a simulation returns: samples, events, the energy ledger; saved, loaded, exported."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from tokenize import TokenError
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.files import atomic

Array = NDArray[np.float64]
FORMAT = "spear_pin trajectory 1"


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
        impulse: of the ground on each toe, x and z, in N·s, (ntoes, 2).
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
        """What does not close in each cycle, in J, (cycles,): change of the stored energy less all flows."""
        left: Array = self.change - self.work.sum(axis=1)
        return left


@dataclass(frozen=True)
class Trajectory:
    """Motion over time; at every sample D a + C v + G = B tau + friction + Σ Jᵀ F.

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
        force: ground force on each toe, x and z, in N, (n, ntoes, 2).
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

    @property
    def complete(self) -> bool:
        """Whether all the cycles asked for were run."""
        return self.reason == "complete"

    def named(self, event: str) -> tuple[Event, ...]:
        """The events of one name, in order of time."""
        return tuple(e for e in self.events if e.name == event)

    def save(self, path: str | Path) -> Path:
        """Write an npz file: arrays, and one JSON string for the rest; nothing is pickled."""
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _arrays()}
        arrays |= {f"event_{name}": np.array([getattr(e, name) for e in self.events]) for name in _EVENT_ARRAYS}
        arrays |= {"ledger_work": self.ledger.work, "ledger_change": self.ledger.change}
        if self.electrical is not None:
            arrays |= {"electrical_work": self.electrical.work, "electrical_change": self.electrical.change}
        meta = {name: getattr(self, name) for name in _TEXT} | {
            "format": FORMAT,
            "units": "SI, radians",
            "flows": self.ledger.flows,
            "drives": () if self.electrical is None else self.electrical.flows,
            "events": [{"name": e.name, "domain": e.domain, "work": dict(e.work)} for e in self.events],
        }
        with atomic(path) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, meta=np.array(json.dumps(meta)), **arrays)
        return Path(path)

    @classmethod
    def load(cls, path: str | Path) -> Trajectory:
        """Read what `save` wrote.

        Raises:
            BadFile: it cannot be read, or is not a trajectory.
        """
        try:
            with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as data:
                meta = json.loads(str(data["meta"]))
                if meta.pop("format") != FORMAT:
                    raise KeyError("format")
                rows = zip(meta.pop("events"), *(data[f"event_{name}"] for name in _EVENT_ARRAYS), strict=True)
                events = tuple(
                    Event(**info | dict(zip(_EVENT_ARRAYS, (float(time), *rest), strict=True)))
                    for info, time, *rest in rows
                )
                ledger = Ledger(tuple(meta.pop("flows")), data["ledger_work"], data["ledger_change"])
                drives, electrical = tuple(meta.pop("drives", ())), None
                if drives:
                    electrical = Ledger(drives, data["electrical_work"], data["electrical_change"])
                meta.pop("units")
                plain: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in meta.items()}
                older = {name: np.empty((len(data["t"]), 0)) for name in _CURRENTS if name not in data}
                arrays: dict[str, Any] = {name: data[name] for name in _arrays() if name not in older} | older
                return cls(**plain, **arrays, events=events, ledger=ledger, electrical=electrical)
        except OSError as error:
            raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
        except (
            BadZipFile,
            TokenError,
            zlib.error,
            KeyError,
            ValueError,
            TypeError,
            AttributeError,
            EOFError,
            NotImplementedError,
        ) as error:
            raise BadFile(path, f"is not a saved trajectory ({type(error).__name__}: {error})") from None

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

            arrays = {name: getattr(self, name) for name in _arrays()}
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


_CURRENTS = ("current", "reference")  # files from before there was hardware have none
_EVENT_ARRAYS = ("time", "q", "v_before", "v", "impulse")
_TEXT = ("robot", "coordinates", "actuated", "toes", "spring_joints", "cycles", "reason", "message", "evaluations")


def _arrays() -> list[str]:
    return [f.name for f in fields(Trajectory) if f.name not in (*_TEXT, "events", "ledger", "electrical")]
