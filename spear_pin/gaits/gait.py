"""A periodic gait: its system with the solved parameters in it, its fixed point, its multipliers."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadFile, BadValue, SpearError, UnknownName, require
from spear_pin.files import check_keys, parse_json, read_bytes, write_text
from spear_pin.gaits import library
from spear_pin.gaits.bounding import bounding
from spear_pin.gaits.bounding_law import BoundingLaw
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.round_hopping import RoundHoppingLaw, round_hopping
from spear_pin.gaits.series_hopping import SeriesHoppingLaw, series_hopping
from spear_pin.gaits.spatial.bounding import bounding_in_space
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.pronking import pronking
from spear_pin.gaits.spatial.trot_law import TrotLaw
from spear_pin.gaits.spatial.trotting import pacing, trotting
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.brakes import Braking
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.dry_friction import DryFriction, has_dry_friction
from spear_pin.hybrid.event_feedback import EventFeedback, feedback_of, with_feedback
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.parameters import LIMITS, Fitted, find_replaced, limits, parameter, rebuilt
from spear_pin.hybrid.result import State
from spear_pin.kinds import typed
from spear_pin.model.clutch import Clutch
from spear_pin.model.motor import NO_MOTORS, Drive, Motor
from spear_pin.model.origin import check_origin, origin, robot_of, unsaid
from spear_pin.model.path_data import path_of, spring_data
from spear_pin.model.spring import Spring
from spear_pin.printable import printable
from spear_pin.showing import Shown

if TYPE_CHECKING:
    from spear_pin.gaits.sensitivity.sensitivity import Sensitivity

FORMAT = "spear_pin gait 1"
KNEE = "knee"  # name of a spring that is given without one
DEEPEST = 10  # lists in lists of a number of a law
KINDS: dict[str, tuple[Callable[..., HybridSystem], type]] = {
    "hopping": (hopping, HoppingLaw),
    "round_hopping": (round_hopping, RoundHoppingLaw),
    "series_hopping": (series_hopping, SeriesHoppingLaw),
    "bounding": (bounding, BoundingLaw),
    "bounding_in_space": (bounding_in_space, SpatialLaw),
    "trotting": (trotting, TrotLaw),
    "pacing": (pacing, TrotLaw),
    "pronking": (pronking, SpatialLaw),
}


@dataclass(frozen=True, repr=False)
class Gait(Shown):
    """A fixed point of the return map.

    Attributes:
        system: the system with the solved parameters.
        state: (q, v) on the section.
        parameters: the parameters that were solved for.
        residual: ‖P(x) - x‖∞.
        multipliers: Floquet multipliers, by decreasing modulus.
        durations: duration of each phase in s.

    Example:
        >>> from spear_pin import Gait
        >>> Gait.load("long_stride")
        Gait(bounding of 'q_spear': period 0.3502 s, largest multiplier 1.067, unstable)
    """

    system: HybridSystem
    state: State
    parameters: Mapping[str, float]
    residual: float
    multipliers: NDArray[np.complex128]
    durations: Mapping[str, float]

    def __repr__(self) -> str:
        largest = np.abs(self.multipliers).max()
        parts = f"period {self.period:.4g} s", f"largest multiplier {largest:.4g}", "stable" * self.stable or "unstable"
        return f"Gait({self.system.kind} of {printable(repr(self.system.robot.name))}: {', '.join(parts)})"

    @property
    def stable(self) -> bool:
        """Whether every multiplier lies inside the unit circle."""
        return bool(np.abs(self.multipliers).max() < 1.0)

    @property
    def period(self) -> float:
        """Duration of one cycle in s."""
        return float(sum(self.durations.values()))

    def with_law(self, **values: object) -> Gait:
        """Returns the gait with other values in its law that keep its orbit; multipliers stay."""
        system = self.system
        for name in values:
            if name not in vars(system.law):
                raise UnknownName("parameter of the law", name, vars(system.law))
        law = replace(system.law, **values)
        return replace(self, system=rebuilt(system, law=law))

    def sensitivity(
        self,
        over: Sequence[str],
        vary: Sequence[str] = (),
        keep: Sequence[str] = (),
        motors: Mapping[str, Motor | Drive] = NO_MOTORS,
    ) -> Sensitivity:
        """Returns exact derivatives of the gait's state, measures and multipliers with respect to parameters.

        Args:
            over: parameters, by the names of numbers of law, springs, ground or robot, such as "stiffness" or
                "knee_ratio".
            vary: parameters that are solved for, so that the measures in `keep` keep their values.
            keep: as many measures as there are names in `vary`.
            motors: by the name of each joint, a motor or a drive. Motors give the measures `heat_JOINT`, in J a cycle,
                and `energy`, the net work of all motors and this heat, behind gears that lose nothing. Drives give
                `electricity_JOINT`, in J a cycle, `electricity` where all joints have one, and `reserve_JOINT`, in N·m.
                Both give `heating_JOINT`, rms over continuous torque. Gear ratios and motor sizes are the robot's.

        Raises:
            UnknownName: there is no parameter, measure or joint with a motor that has such a name.
            BadValue: a name is given twice, `keep` and `vary` differ in length, a parameter is zero and with it part
                of the equations, a motor's resistance or torque constant is not known, the gait has hardware, or in
                space a number tells left from right or is built into the law.
            NotDifferentiable: the cycle has no derivative; the text says why.
        """
        from spear_pin.gaits.sensitivity.sensitivity import sensitivity  # a late import: it compiles

        return sensitivity(self.system, self.state, over, vary, keep, motors)

    @typed
    def save(self, path: str | Path) -> Path:
        """Writes the gait as JSON.

        Raises:
            BadValue: the file could not describe the system, because it has hardware, dry friction of joints, a rotary
                boom, a robot whose model is not that of its file or that cannot be cut from one again in the same way,
                another change, a builder of its own under the name of another, or a limit that is not finite.
            BadFile: the file cannot be written.
        """
        if left_out := _unsaid(self.system):
            raise BadValue(
                "gait.system", f"one with {' and '.join(left_out)}", "one without: a file cannot describe it"
            )
        for name, limit in limits(self.system).items():
            require(name, limit, lambda value: value >= 0, "a finite number >= 0, in s, to be kept in a file")
        feedback = feedback_of(self.system)
        data = {
            "format": FORMAT,
            "kind": self.system.kind,
            "robot": origin(self.system.robot),
            "law": asdict(self.system.law),
            **springs_data(self.system),
            "contact": asdict(self.system.contact),
            "limits": {name: float(limit) for name, limit in limits(self.system).items()},
            "state": {"q": self.state[0].tolist(), "v": self.state[1].tolist()},
            "parameters": dict(self.parameters),
            **({} if feedback is None else {"feedback": asdict(feedback)}),
            "residual": self.residual,
            "multipliers": [[value.real, value.imag] for value in self.multipliers],
            "durations": dict(self.durations),
        }
        return write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")

    @classmethod
    @typed
    def load(cls, path: str | Path, like: HybridSystem | None = None) -> Gait:
        """Reads a shipped gait by its name, or a file that `save` wrote by its path, and rebuilds the system.

        Args:
            path: a name, or a path.
            like: for an automaton that is not the package's, any system with that automaton.

        Raises:
            UnknownName: no shipped gait has that name, and it is not a path (it has no suffix or separator).
            BadFile: the file cannot be read, or is not a gait: a field is missing, unknown, or of another kind, or a
                number is not finite or not valid.
        """
        if str(path) in library.all_names() or not ({"/", "\\", "."} & set(str(path))):
            path = library.path(str(path))
        text = read_bytes(path)
        if Path(path).suffix == ".npz":
            raise BadFile(path, "is a trajectory; expected a saved gait, a .json file")
        try:
            data = parse_json(text.decode())
            _check(data)
            kinds = KINDS if like is None else {like.kind: (like.build, type(like.law))}
            if data["kind"] not in kinds:
                valid = " or ".join(map(repr, kinds))
                own = "; for a system of your own, Gait.load(path, like=SYSTEM)" if like is None else ""
                raise BadValue("kind", data["kind"], valid + own)
            build, law = kinds[data["kind"]]
            robot = robot_of(data["robot"])
            contact = Ground if data["contact"].keys() & {"slope", "height"} else Contact
            system = build(robot, part_of(law, data["law"]), springs_of(data), part_of(contact, data["contact"]))
            if "feedback" in data:
                system = with_feedback(system, part_of(EventFeedback, data["feedback"]))
            system = replace(system, **data.get("limits", {}))
            state = _numbers("state.q", data["state"]["q"], robot.nq), _numbers("state.v", data["state"]["v"], robot.nv)
            for name in data["parameters"]:
                parameter(system, name)
            check_keys("phase", data["durations"], (), system.phases)
            multipliers = np.array([complex(*_numbers("a multiplier", pair, 2)) for pair in data["multipliers"]])
            return cls(system, state, data["parameters"], float(data["residual"]), multipliers, data["durations"])
        except (TypeError, ValueError, SpearError) as error:
            raise BadFile(path, f"is not a saved gait ({error}); expected a file that Gait.save wrote") from None


def _unsaid(system: HybridSystem) -> list[str]:
    """Lists properties of a system that a file does not describe, in words."""
    builder, _ = KINDS.get(system.kind, (system.made["builder"], None))  # known by the kind's name
    has = {
        "hardware": system.hardware is not None,
        "brakes": bool(system.brakes),
        "dry friction of joints": has_dry_friction(system),
        "ground that is no plane": type(system.contact) not in (Contact, Ground),
        **dict.fromkeys(unsaid(system.robot), True),
        "another builder than others of its kind": system.made["builder"] is not builder,
        "a change of its own": any(
            not isinstance(change, (Braking, DryFriction, EventFeedback, Fitted)) for change in system.changes
        ),
    }
    others = {f"another {name}": True for name in find_replaced(system) if name not in (*LIMITS, "hardware")}
    return [name for name, there in (has | others).items() if there]


def _check(data: Any) -> None:
    """Refuses data in which a part of a gait is missing or of another kind; the system is checked as it is built."""
    if not isinstance(data, dict):
        raise ValueError("it is no JSON object")
    springs = "springs" if "springs" in data else "spring"
    objects = ("robot", "law", springs, "contact", "state", "parameters", "durations")
    check_keys("field", data, ("format", "kind", *objects, "residual", "multipliers"), ("limits", "feedback"))
    if data["format"] != FORMAT:
        raise BadValue("format", data["format"], repr(FORMAT))
    data = {"limits": {}, "feedback": {}, **data}  # older files have no limits
    for name in (*objects, "limits", "feedback"):
        if not isinstance(data[name], dict):
            raise BadValue(name, data[name], "a JSON object")
    check_origin(data["robot"])
    check_keys("field of state", data["state"], ("q", "v"))
    check_keys("limit", data["limits"], (), LIMITS)
    if not isinstance(data["kind"], str):
        raise BadValue("kind", data["kind"], "a name")
    _numbers("parameters", [*data["parameters"].values()])
    seconds = {name: [*data[name].values()] for name in ("durations", "limits")}
    for name, values in {"residual": [data["residual"]], **seconds}.items():
        if (_numbers(name, values) < 0).any():
            raise BadValue(name, data[name], ">= 0")
    if not isinstance(data["multipliers"], list) or not data["multipliers"]:
        raise BadValue("multipliers", data["multipliers"], "a list of pairs of numbers")


def _numbers(name: str, values: Any, count: int | None = None) -> NDArray[np.float64]:
    """Reads `count` numbers from a JSON list."""
    right = isinstance(values, list) and all(type(value) in (int, float) for value in values)
    if not right or count not in (None, len(values)):
        raise BadValue(name, values, "numbers" if count is None else f"{count} numbers")
    return np.array(values, dtype=float)


def springs_data(system: HybridSystem) -> dict[str, Any]:
    """Returns a system's springs, as a file has them."""
    springs = {name: spring_data(spring) for name, spring in system.springs.items()}
    alone = [*springs] == [KNEE] or (springs and not system.sprung)
    return {"spring": next(iter(springs.values()))} if alone else {"springs": springs}


def springs_of(data: Mapping[str, Any]) -> Spring | dict[str, Spring]:
    """Returns what `springs_data` wrote.

    Raises:
        BadValue, UnknownName: a spring is not valid.
    """
    if "spring" in data:
        return _spring(data["spring"])
    return {name: _spring(values) for name, values in data["springs"].items()}


def _spring(values: Any) -> Spring:
    if not isinstance(values, dict):
        raise BadValue("springs", values, "a JSON object for each")
    path, others = path_of(values)
    clutch = others.pop("clutch", None)
    if clutch is not None and not isinstance(clutch, dict):
        raise BadValue("clutch", clutch, "a JSON object")
    spring: Spring = part_of(Spring, others)
    return replace(spring, path=path, clutch=None if clutch is None else part_of(Clutch, clutch))


def part_of(kind: type, values: Mapping[str, Any]) -> Any:
    """Returns a system's part from its fields; fields that an older file lacks have their defaults."""
    truths = {field.name for field in fields(kind) if field.type in ("bool", bool)}
    parts = {name: hint for name, hint in get_type_hints(kind).items() if is_dataclass(hint)}
    for name, value in values.items():
        if isinstance(value, bool) != (name in truths):
            raise BadValue(name, value, "true or false" if name in truths else "a number or a name, not true or false")
    return kind(**{name: _field(parts.get(name), value) for name, value in values.items()})


def _field(kind: Any, value: Any) -> Any:
    """Returns a field's value; a part of its own, such as the plane's law in that of space, is read from its fields."""
    return _tuples(value) if kind is None or not isinstance(value, dict) else part_of(kind, value)


def _tuples(value: Any, deep: int = 1) -> Any:
    """Turns JSON's lists into the tuples that they were; refuses truth values, and lists that are too deep."""
    if not isinstance(value, list):
        return value
    if deep > DEEPEST:
        raise BadValue("a list", value, f"lists at most {DEEPEST} deep")
    if any(isinstance(item, bool) for item in value):
        raise BadValue("a list", value, "numbers or names, not true or false")
    return tuple(_tuples(item, deep + 1) for item in value)
