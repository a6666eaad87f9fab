"""Sides of a comparison: each has a label, a robot and, if possible, a motion, whatever it was given as."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from spear_pin.errors import BadFile, BadValue, NoGait, SpearError, UnknownName, require
from spear_pin.gaits import library
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import hopping
from spear_pin.gaits.proportions import FLIGHT_TIME, usual_flight
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.result import State
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.hybrid.trajectory_parts import gaps
from spear_pin.kinds import typed
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.studies.hop_of_another import hop_of, scaled_hopping
from spear_pin.words import number, show_unit

MOST = 6  # sides
CYCLES, MOST_CYCLES = 4, 50  # of a gait that are simulated; of a motion that is shown
NUMBERS = ("stiffness", "damping", "hardening", "preload", "hysteresis", "rest")  # of a spring, that words say
Item = Gait | Trajectory | Robot | Spring | str | Path


@dataclass(frozen=True)
class Side:
    """One side of a comparison.

    Attributes:
        label: label of the side.
        kind: "gait", "motion" or "robot".
        robot: the robot that moves, or stands.
        run: the motion; None for a robot.
        gait: the gait of the motion; None for a motion alone, or a robot.
        notes: how the given item was changed.
    """

    label: str
    kind: str
    robot: Robot
    run: Trajectory | None = None
    gait: Gait | None = None
    notes: tuple[str, ...] = ()


@typed
def sides_of(
    items: Sequence[Item], names: Sequence[str] = (), *, cycles: int = CYCLES, of: Gait | None = None
) -> tuple[Side, ...]:
    """Returns the sides for given items, in their order; the first is the reference for the others.

    Args:
        items: two to `MOST` items; see `read` for words.
        names: labels, one per item; by default the names of the items.
        cycles: number of cycles of each gait to simulate.
        of: gait that springs are put into; None: SPEAR-II's hop in place, with 0.2 s of flight.

    Raises:
        BadValue: there are too few or too many, or a number is not valid.
        SpearError: an item cannot be read, or there is no gait with a spring.
    """
    if not 2 <= len(items) <= MOST:
        raise BadValue("what to compare", len(items), f"2 to {MOST} gaits, trajectories, robots or springs")
    if names and (len(names) != len(items) or not all(name.strip() for name in names)):
        raise BadValue("names", list(names), f"{len(items)} of them, one for each that is compared")
    require(
        "cycles", cycles, lambda n: 1 <= n <= MOST_CYCLES and n == int(n), f"a whole number from 1 to {MOST_CYCLES}"
    )
    read_items = [read(item, of) for item in items]
    labels = different(
        [str(name) for name in names] or [label_item(*pair) for pair in zip(items, read_items, strict=True)]
    )
    return tuple(_side(label, item, int(cycles), of) for label, item in zip(labels, read_items, strict=True))


def read(item: Item, of: Gait | None = None) -> Gait | Trajectory | Robot | Spring:
    """Returns what words stand for; anything else as it is.

    A file .json is a gait, and a file .npz a trajectory. A word with = is a spring, such as "stiffness=40,damping=1".
    Other words are names of gaits that ship, or whatever `load` takes.

    Args:
        item: the words, or the object itself.
        of: the gait from whose spring missing numbers are taken.
    """
    if isinstance(item, (Gait, Trajectory, Robot, Spring)):
        return item
    if not isinstance(item, (str, Path)):
        raise BadValue("what to compare", item, "a gait, a trajectory, a robot, a spring, or words that stand for one")
    words = str(item)
    suffix = Path(words).suffix.lower()
    if suffix == ".npz":
        return Trajectory.load(words)
    if suffix == ".json" or words in library.all_names():
        return Gait.load(words)
    if "=" in words and not Path(words).exists():
        return _spring(words, Spring() if of is None else of.system.spring)
    try:
        return load(words)
    except UnknownName as error:
        also = "a spring such as stiffness=40, or the path of a gait (.json), a trajectory (.npz) or a robot"
        raise UnknownName("gait or robot", words, [*library.all_names(), *error.valid], also) from error


def label_item(item: Item, read_item: Gait | Trajectory | Robot | Spring) -> str:
    """Returns the label of an item, by its name or by its words."""
    if isinstance(item, (str, Path)):
        path = Path(item)
        return path.stem if path.suffix.lower() in (".json", ".npz", ".urdf", ".xml", ".toml") else str(item)
    if isinstance(read_item, Spring):
        usual = Spring()
        own = [name for name in NUMBERS if getattr(read_item, name) != getattr(usual, name)]
        parts = [f"{name}={getattr(read_item, name):.4g}" for name in own if getattr(read_item, name) is not None]
        return ", ".join([*parts, *(["table"] if read_item.table else [])]) or f"stiffness={usual.stiffness:.4g}"
    if isinstance(read_item, Gait):
        return f"{read_item.system.kind} of {read_item.system.robot.name}"
    return read_item.name if isinstance(read_item, Robot) else f"motion of {Path(read_item.robot).stem}"


def _spring(words: str, usual: Spring) -> Spring:
    values: dict[str, Any] = {}
    for part in words.split(","):
        name, _, value = (each.strip() for each in part.partition("="))
        if name not in NUMBERS:
            raise UnknownName("number of a spring", name, NUMBERS)
        try:
            values[name] = number(value)
        except ValueError:
            raise BadValue(name, value, "a number, as in stiffness=40") from None
    return replace(usual, **values)


def _side(label: str, item: Gait | Trajectory | Robot | Spring, cycles: int, of: Gait | None) -> Side:
    if isinstance(item, Robot):
        return Side(label, "robot", item)
    if isinstance(item, Trajectory):
        return _motion(label, item)
    gait, notes = (item, ()) if isinstance(item, Gait) else _sprung(label, item, of)
    run = simulate(gait.system, gait.state, cycles, progress=False)
    ended = () if run.complete else (f"{label}: its motion ended after {run.cycles} cycles: {run.message}",)
    return Side(label, "gait", gait.system.robot, run, gait, (*notes, *ended))


def _motion(label: str, run: Trajectory) -> Side:
    if len(run) < 2:
        raise BadValue(label, f"a trajectory of {len(run)} samples", "at least two")
    if len(gaps(run)):
        raise BadValue(label, "a trajectory with gaps", "one without, such as `in_cycles` gives")
    try:
        robot = run.load_robot()
    except (SpearError, ValueError) as error:
        raise BadFile(label, f"its robot is not found: {error}") from None
    if run.cycles <= MOST_CYCLES:
        notes = () if run.cycles else (f"{label}: no whole cycle; what is measured is of all its samples",)
        return Side(label, "motion", robot, run, notes=notes)
    note = f"{label}: the last {MOST_CYCLES} of its {run.cycles} cycles"
    return Side(label, "motion", robot, run.in_cycles(run.cycles - MOST_CYCLES + 1, run.cycles), notes=(note,))


def usual_hop(leg: Robot | None = None, flight_time: float | None = None) -> Gait:
    """Finds the hop in place into which springs are put; its stance torque is solved for a flight time.

    Args:
        leg: a leg, as `spear_pin.monopod` cuts it, boom_x locked, with its own spring; None: SPEAR-II.
        flight_time: flight time in s; None: `FLIGHT_TIME`, scaled for another leg, and less where only that is within
            its limits.

    Raises:
        NoGait: there is no such hop.
        BadValue: no hop has such a flight time.
    """
    if leg is None:
        return _solved(
            hopping(load("spear_ii", locked=["boom_x"])), FLIGHT_TIME if flight_time is None else flight_time
        )
    system = scaled_hopping(leg)
    if flight_time is not None:
        return hop_of(system, flight_time)
    return hop_of(system, usual_flight(leg), within_limits=True)


def _solved(system: HybridSystem, flight: float, guess: State | None = None) -> Gait:
    return find_gait(system, vary=["stance_torque"], target={"flight_time": flight}, guess=guess)


def _sprung(label: str, spring: Spring, of: Gait | None) -> tuple[Gait, tuple[str, ...]]:
    """Returns the gait of `of` with another spring, and the number that was solved for."""
    try:
        if of is None:
            gait = _solved(hopping(load("spear_ii", locked=["boom_x"]), spring=spring), FLIGHT_TIME)
            return gait, (f"{label}: SPEAR-II's hop in place, stance torque solved for {FLIGHT_TIME:g} s in the air",)
        system = rebuilt(of.system, spring=spring)
        if of.system.kind == "hopping" and set(of.parameters) == {"stance_torque"}:
            flight = of.durations["flight"]
            try:
                gait = _solved(system, flight, of.state)
            except NoGait:
                if system.robot.cut is None:
                    raise
                gait = hop_of(system, flight)
            whose = f"hop in place of {of.system.robot.name}"
            return gait, (f"{label}: {whose}, stance torque solved for {gait.durations['flight']:.4g} s in the air",)
        return find_gait(system, guess=of.state), (f"{label}: the fixed point with the law as it is",)
    except NoGait as error:
        raise SpearError(f"{label}: {error}") from None


def different(labels: Sequence[str]) -> list[str]:
    """Returns labels that all differ: repeated ones are numbered."""
    made: list[str] = []
    for label in labels:
        count = sum(each == label for each in made) + sum(each.startswith(f"{label} (") for each in made)
        made.append(f"{label} ({count + 1})" if label in made else label)
    return made


def make_standing(robot: Robot) -> Any:
    """Returns the motion of a robot that stands still for a second, so that it can be played; see `TrajectoryLike`."""
    from spear_pin.model.postures import home

    return SimpleNamespace(
        t=np.array([0.0, 1.0]),
        q=np.array([home(robot)] * 2),
        domain=np.array(["standing"] * 2),
        force=np.zeros((2, len(robot.toes), robot.dimension)),
        events=(),
        spring_joints=(),
        engaged=np.zeros((2, 0), dtype=bool),
    )


def parameters(side: Side) -> dict[str, Any]:
    """Returns the parameters of a side by part and name: of its robot, law, spring and ground."""
    robot = side.robot
    found: dict[str, Any] = {
        "robot": robot.name,
        "robot: locked joints": ", ".join(robot.locked) or "none",
        **{f"robot: {name}": value for name, value in robot.varied.items()},
    }
    for joint, spring in robot.settings.springs.items():
        found |= {f"robot: {joint} spring: {name}": value for name, value in _of_spring(spring).items()}
    if side.gait is None:
        ground = None if side.run is None else side.run.ground
        return found | ({} if ground is None else {f"ground: {name}": x for name, x in _fields(ground).items()})
    system = side.gait.system
    found["automaton"] = system.kind
    for part, values in (
        ("law", _fields(system.law)),
        *((part, _of_spring(spring)) for part, spring in _springs(system)),
        ("ground", _fields(system.ground)),
    ):
        found |= {f"{part}: {name}": value for name, value in values.items()}
    for change in system.changes:  # dry friction, hardware
        if is_dataclass(change):
            found |= {f"{type(change).__name__}: {name}": value for name, value in _fields(change).items()}
        else:
            found[f"changed by {getattr(change, '__name__', change)}"] = True
    return found


def units(side: Side) -> dict[str, str]:
    """Returns the units of the parameters of a side's springs, by part and name."""
    found: dict[str, str] = {}
    for part, spring in [] if side.gait is None else _springs(side.gait.system):
        own = {**spring.units, "rest": "rad" if spring.turns else "m"}
        own |= {} if spring.path is None else spring.path.units
        found |= {f"{part}: {name}": show_unit(unit) for name, unit in own.items()}
    return found


def _springs(system: HybridSystem) -> list[tuple[str, Spring]]:
    springs = system.springs.items()
    return [("spring" if len(springs) == 1 else f"{name} spring", spring) for name, spring in springs]


def _of_spring(spring: Spring) -> dict[str, Any]:
    """Returns the fields of a spring, with the kind of its path and its numbers."""
    path = spring.path
    along = {} if path is None else {"path": type(path).__name__, **path.numbers}
    return _fields(spring) | along


def _fields(whole: Any) -> dict[str, Any]:
    return {field.name: getattr(whole, field.name) for field in fields(whole)}
