"""A periodic gait: its system with the solved parameters in it, its fixed point, its multipliers."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadFile, SpearError, UnknownName
from spear_pin.files import atomic
from spear_pin.gaits import library
from spear_pin.gaits.bounding import bounding
from spear_pin.gaits.bounding_law import BoundingLaw
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.series_hopping import SeriesHoppingLaw, series_hopping
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.parameters import PARTS
from spear_pin.hybrid.record import State
from spear_pin.model.loading import load
from spear_pin.model.spring import Spring
from spear_pin.model.variants import vary

FORMAT = "spear_pin gait 1"
KINDS: dict[str, tuple[Callable[..., HybridSystem], type]] = {
    "hopping": (hopping, HoppingLaw),
    "series_hopping": (series_hopping, SeriesHoppingLaw),
    "bounding": (bounding, BoundingLaw),
}


@dataclass(frozen=True)
class Gait:
    """A fixed point of the return map.

    Attributes:
        system: the system, solved parameters in it.
        state: (q, v) on the section.
        parameters: the parameters that were solved for.
        residual: ‖P(x) - x‖∞.
        multipliers: Floquet multipliers, by decreasing modulus.
        durations: seconds in each phase.
    """

    system: HybridSystem
    state: State
    parameters: Mapping[str, float]
    residual: float
    multipliers: NDArray[np.complex128]
    durations: Mapping[str, float]

    @property
    def stable(self) -> bool:
        """Whether every multiplier lies inside the unit circle."""
        return bool(np.abs(self.multipliers).max() < 1.0)

    @property
    def period(self) -> float:
        """Seconds of one cycle."""
        return float(sum(self.durations.values()))

    def with_law(self, **values: object) -> Gait:
        """The gait with other values in its law, such as feedback, that leave its orbit alone; multipliers are kept."""
        system = self.system
        law = replace(system.law, **values)
        return replace(self, system=system.build(system.robot, law, system.spring, system.contact))

    def save(self, path: str | Path) -> Path:
        """Write as JSON."""
        robot = self.system.robot
        data = {
            "format": FORMAT,
            "kind": self.system.kind,
            "robot": {"source": robot.source, "toes": robot.toes, "locked": robot.locked, "varied": dict(robot.varied)},
            **{part: asdict(getattr(self.system, part)) for part in PARTS},
            "state": {"q": self.state[0].tolist(), "v": self.state[1].tolist()},
            "parameters": dict(self.parameters),
            "residual": self.residual,
            "multipliers": [[value.real, value.imag] for value in self.multipliers],
            "durations": dict(self.durations),
        }
        with atomic(path) as temporary:
            temporary.write_text(json.dumps(data, indent=1, allow_nan=False) + "\n", encoding="utf-8")
        return Path(path)

    @classmethod
    def load(cls, path: str | Path, like: HybridSystem | None = None) -> Gait:
        """Read a shipped gait by its name, or what `save` wrote by its path, and rebuild the system.

        Args:
            path: a name, or a path.
            like: for an automaton that is not the package's, any system of it.

        Raises:
            UnknownName: no gait of that name ships, and it is not a path (it has no suffix or separator).
            BadFile: it cannot be read, or is not a gait.
        """
        if str(path) in library.names() or not ({"/", "\\", "."} & set(str(path))):
            path = library.path(str(path))
        try:
            data = json.loads(Path(path).read_text(encoding="utf-8"))
            if data["format"] != FORMAT:
                raise KeyError("format")
            kinds = KINDS if like is None else {like.kind: (like.build, type(like.law))}
            if data["kind"] not in kinds:
                raise UnknownName("kind of gait", data["kind"], kinds)
            build, law = kinds[data["kind"]]
            robot = load(data["robot"]["source"], toes=data["robot"]["toes"], locked=data["robot"]["locked"])
            robot = vary(robot, **data["robot"].get("varied", {}))
            values = {name: _tuples(value) for name, value in data["law"].items()}
            system = build(robot, law(**values), Spring(**data["spring"]), Contact(**data["contact"]))
            state = np.array(data["state"]["q"], dtype=float), np.array(data["state"]["v"], dtype=float)
            if [part.shape for part in state] != [(robot.nq,), (robot.nv,)]:
                raise ValueError(f"the state has the shapes {[part.shape for part in state]}")
            if not all(np.isfinite(part).all() for part in state):
                raise ValueError("the state is not finite")
            multipliers = np.array([complex(*pair) for pair in data["multipliers"]])
            return cls(system, state, data["parameters"], float(data["residual"]), multipliers, data["durations"])
        except OSError as error:
            raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
        except (AttributeError, KeyError, TypeError, ValueError, SpearError) as error:
            raise BadFile(path, f"is not a saved gait ({type(error).__name__}: {error})") from None


def _tuples(value: Any) -> Any:
    """JSON's lists as the tuples that they were."""
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value
