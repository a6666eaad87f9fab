"""The measures of a cycle: one table of names, units, sentences and formulas, for samples and derivatives alike.

Torques are those of one motor: in the sagittal plane a joint stands for two legs, and two motors share its torque.
Work, energies and the effort are those of all motors of the robot. Forces act on a toe of the model; in the sagittal
plane that is on both feet of a pair. Without its joint or toe a name stands for the largest value over all of them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, NamedTuple

from spear_pin.errors import BadValue, SpearError, UnknownName
from spear_pin.gaits.measures.signals import Signals, transport
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.column_names import lengths, motors_at
from spear_pin.hybrid.dual import value_of
from spear_pin.hybrid.own import is_own, mistake, number
from spear_pin.hybrid.path_springs import unit_along
from spear_pin.model.robot import Robot


class Measure(NamedTuple):
    """A measure, or measures of one kind for joints, toes, phases or events.

    Attributes:
        pattern: pattern of the names.
        unit: unit of the measure, "1" without one.
        text: meaning of the measure, in a sentence.
        of: returns the measure of a cycle's `Signals`, given the joint, toe, phase or event if the pattern has one;
            None where there is none. Without it, other data than the cycle's are needed.
        sampled: whether samples give it.
        driven: whether it needs the motors' drives, so that only those who give them ask for it.
        shown: whether commands, pages and comparisons show it behind their own figures.
    """

    pattern: str
    unit: str
    text: str
    of: Callable[..., Any] | None = None
    sampled: bool = True
    driven: bool = False
    shown: bool = False

    @property
    def kind(self) -> str:
        """The name without the joint or toe behind it."""
        return self.pattern.removesuffix("_JOINT").removesuffix("_TOE")

    @property
    def wanted(self) -> bool:
        """Whether the robot's motion alone gives it, so that a search may ask for it."""
        return self.of is not None and not self.driven

    def values(self, cycle: Signals) -> dict[str, Any]:
        """Returns all measures of this kind that a cycle has, by name.

        Raises:
            BadFunction: there is a mistake in a function of one's own.
        """
        if self.of is None:
            return {}
        pattern = self.pattern.replace("SECTION", cycle.section)
        word = next((each for each in PLACED if each in pattern), "")
        if word:
            found = {pattern.replace(word, place): self._of(cycle, place) for place in PLACED[word](cycle)}
        else:
            found = {pattern: self._of(cycle)}
        return {name: value for name, value in found.items() if value is not None}

    def _of(self, *given: Any) -> Any:
        """Returns what its function gives for a cycle, and a place where its pattern has one: a scalar, or None."""
        assert self.of is not None
        if not is_own(self.of):
            return self.of(*given)
        what = f"measure {self.pattern!r}"
        try:
            answer = self.of(*given)
        except SpearError:
            raise
        except Exception as error:
            raise mistake(what, self.of, error) from error
        if answer is None:
            return None
        number(what, self.of, value_of(answer))
        return answer


PLACED: dict[str, Callable[[Signals], Any]] = {
    "PHASE": lambda cycle: cycle.durations,
    "EVENT": lambda cycle: cycle.observed,
    "JOINT": lambda cycle: dict.fromkeys([*cycle.torques, *cycle.released]),
    "TOE": lambda cycle: cycle.robot.toes,
}
"""Words of patterns, and the names that stand in their places."""


def _effort(cycle: Signals) -> Any:
    return sum(square * float(motors_at(joint)) for joint, square in cycle.squares.items())


def _absolute(cycle: Signals) -> Any:
    return 2.0 * cycle.positive_work - cycle.net_work


def _per_distance(of: Callable[[Signals], Any]) -> Callable[[Signals], Any]:
    return lambda cycle: None if cycle.distance is None else of(cycle) / cycle.distance


def _transport(of: Callable[[Signals], Any]) -> Callable[[Signals], Any]:
    return lambda cycle: (
        None  # none without gravity either
        if cycle.distance is None or not cycle.robot.weight
        else transport(of(cycle), cycle.weight, cycle.distance)
    )


def _rms(cycle: Signals, joint: str) -> Any:
    if joint not in cycle.squares:
        return None
    square = cycle.squares[joint] / cycle.period
    return 0.0 if square <= 0.0 else square**0.5


def _at_closing(i: int) -> Callable[[Signals, str], Any]:
    return lambda cycle, joint: cycle.closing[joint][i] if joint in cycle.closing else None


def _largest(signals: str, of: str) -> Callable[[Signals, str], Any]:
    """Returns a measure by `Signals.peak` or `Signals.amount` of one of its kinds of signals, where it has one."""

    def found(cycle: Signals, place: str) -> Any:
        signal = getattr(cycle, signals).get(place)
        return None if signal is None else getattr(cycle, of)(signal)

    return found


def _taken(cycle: Signals, joint: str) -> Any:
    found = cycle.electricity(joint)
    return found and found[0]


def _all_taken(cycle: Signals) -> Any:
    parts = [_taken(cycle, joint) for joint in cycle.torques]
    return None if None in parts else sum(parts)


def _heat(cycle: Signals, joint: str) -> Any:
    heating = cycle.heating(joint)
    return None if heating is None else cycle.squares[joint] * heating


def _energy(cycle: Signals) -> Any:
    heats = [heat for joint in cycle.torques if (heat := _heat(cycle, joint)) is not None]
    return cycle.net_work + sum(heats) if heats else None


def _heating(cycle: Signals, joint: str) -> Any:
    most = cycle.continuous(joint)
    return None if most is None else _rms(cycle, joint) / most


def _normal(cycle: Signals, toe: str) -> Any:
    return cycle.peak(cycle.forces[toe][1]) if toe in cycle.forces else None


def _friction(cycle: Signals, toe: str) -> Any:
    return cycle.ratio(*cycle.forces[toe], cycle.pressed) if toe in cycle.forces else None


CATALOGUE: list[Measure] = [
    Measure("PHASE_time", "s", "Duration of a phase.", lambda cycle, phase: cycle.durations[phase]),
    Measure("period", "s", "Duration of a cycle.", lambda cycle: cycle.period),
    Measure(
        "EVENT_height",
        "m",
        "Height of the base at an event that is recorded but changes nothing, such as the apex.",
        lambda cycle, event: cycle.observed[event],
        sampled=False,
    ),
    Measure(
        "JOINT_rate_at_SECTION",
        "rad/s",
        "Speed of a joint just before the cycle closes.",
        _at_closing(1),
        sampled=False,
    ),
    Measure("JOINT_at_SECTION", "rad", "Angle of a joint where the cycle closes.", _at_closing(0), sampled=False),
    Measure("stride", "m", "Distance covered in a cycle.", lambda cycle: cycle.stride),
    Measure(
        "mean_speed",
        "m/s",
        "Distance covered in a cycle, divided by its period.",
        lambda cycle: None if cycle.stride is None else cycle.stride / cycle.period,
    ),
    Measure("turn", "rad", "Change of the heading in a cycle, to the left.", lambda cycle: cycle.turn, sampled=False),
    Measure(
        "work",
        "J",
        "Work of all motors on the joints in a cycle, braking counted as negative.",
        lambda cycle: cycle.net_work,
    ),
    Measure(
        "positive_work",
        "J",
        "Work of all motors in a cycle where they drive: ∫ Σ max(u ω, 0) dt.",
        lambda cycle: cycle.positive_work,
    ),
    Measure("absolute_work", "J", "Absolute work of all motors in a cycle: ∫ Σ |u ω| dt.", _absolute),
    Measure(
        "cost_of_transport",
        "1",
        "Absolute work divided by the robot's weight and the distance covered.",
        _transport(_absolute),
    ),
    Measure(
        "cost_of_transport_positive",
        "1",
        "Positive work divided by the robot's weight and the distance covered.",
        _transport(lambda cycle: cycle.positive_work),
    ),
    Measure(
        "effort",
        "N²·m²·s",
        "∫ Σ u² dt over a cycle and all motors, u the torque of one motor.",
        _effort,
    ),
    Measure("effort_per_distance", "N²·m·s", "The effort divided by the distance covered.", _per_distance(_effort)),
    Measure("rms_torque_JOINT", "N·m", "Root mean square of the torque of one motor over a cycle.", _rms),
    Measure(
        "peak_torque_JOINT",
        "N·m",
        "Largest absolute torque of one motor.",
        _largest("torques", "amount"),
    ),
    Measure("peak_speed_JOINT", "rad/s", "Largest absolute speed of a joint.", _largest("speeds", "amount")),
    Measure(
        "greatest_height_TOE",
        "m",
        "Greatest height of a toe above the ground between lift-off and touchdown.",
        _largest("heights", "peak"),
        sampled=False,
    ),
    Measure(
        "least_JOINT",
        "rad",
        "Least angle of a joint.",
        lambda cycle, joint: -cycle.peak(cycle.angles[joint] * -1.0) if joint in cycle.angles else None,
    ),
    Measure("greatest_JOINT", "rad", "Greatest angle of a joint.", _largest("angles", "peak")),
    Measure(
        "peak_force_TOE",
        "N",
        "Largest normal force on a toe; in the sagittal plane on both feet of a pair.",
        _normal,
    ),
    Measure(
        "friction_used_TOE",
        "1",
        "Largest ratio of the force along the ground to the normal force, while the toe carries at least 2 % of its"
        " even share of the weight: m g divided by the number of toes.",
        _friction,
    ),
    Measure(
        "deflection_JOINT",
        "rad",
        "Deflection of a spring when it releases, in m if its path is; if it releases several times, the smallest.",
        lambda cycle, joint: cycle.released.get(joint),
        sampled=False,
    ),
    Measure("heat_JOINT", "J", "Heat of the windings of all motors of a joint in a cycle.", _heat, driven=True),
    Measure("energy", "J", "Work and heat of all motors in a cycle.", _energy, driven=True),
    Measure(
        "electricity_JOINT",
        "J",
        "Electricity that all motors of a joint take in a cycle; none is given back.",
        _taken,
        driven=True,
    ),
    Measure(
        "electricity",
        "J",
        "Electricity that all motors take in a cycle; none is given back.",
        _all_taken,
        driven=True,
    ),
    Measure(
        "reserve_JOINT",
        "N·m",
        "Smallest torque that one motor still has in reserve, at the joint.",
        lambda cycle, joint: cycle.reserve(joint),
        driven=True,
    ),
    Measure(
        "heating_JOINT",
        "1",
        "Rms torque of one motor over its continuous torque, both behind its gears.",
        _heating,
        driven=True,
    ),
    Measure("multiplier_N", "1", "Modulus of a Floquet multiplier, by decreasing size."),
]
SHOWN = (
    *("mean_speed", "stride", "period", "peak_force", "friction_used", "peak_torque", "rms_torque", "peak_speed"),
    *("positive_work", "cost_of_transport", "effort"),
)
"""Kinds of measures that the page of any gait shows as its own figures."""
OF_A_WAY = ("stride", "mean_speed", "turn", "cost_of_transport", "cost_of_transport_positive", "effort_per_distance")
OF_ALL_JOINTS = ("effort", "effort_per_distance")
ALONG_A_RAIL = {"rad": "m", "rad/s": "m/s", "N·m": "N", "N²·m²·s": "N²·s", "N²·m·s": "N²·s/m"}
"""Units of measures of joints that slide, by those of joints that turn."""
PLACES = re.compile(r"[A-Z]{2,}|(?<=_)N$")


def register(entry: Measure) -> None:
    """Adds a measure of one's own, which is then known by name, and shown, wherever measures are.

    Raises:
        BadValue: the entry has no formula, unit or sentence, its name is none or stands for several places, or the
            catalogue has such names.
    """
    if not callable(entry.of):
        raise BadValue("of", entry.of, "a function of a cycle's Signals")
    for name, text in (("unit", entry.unit), ("text", entry.text)):
        if not isinstance(text, str) or not text:
            raise BadValue(name, text, "a text" if name == "text" else 'a unit, or "1" without one')
    if not isinstance(entry.pattern, str) or not entry.pattern.isidentifier():
        raise BadValue("pattern", entry.pattern, "a name of letters, digits and _, such as impulse_TOE")
    if sum(word in entry.pattern for word in PLACED) > 1:
        raise BadValue("pattern", entry.pattern, f"a name with one of {', '.join(PLACED)} at most")
    for each in CATALOGUE:
        alike = each.kind == entry.kind or re.fullmatch(match_pattern(each), entry.pattern)
        if alike or re.fullmatch(match_pattern(entry), each.pattern):
            raise BadValue("pattern", entry.pattern, f"a name that the catalogue does not have yet, as {each.pattern}")
    CATALOGUE.append(entry._replace(shown=True))


def added() -> list[Measure]:
    """Returns the measures that commands, pages and comparisons show behind their own figures."""
    return [each for each in CATALOGUE if each.shown]


def measures(system: HybridSystem) -> dict[str, Measure]:
    """Returns all measures that cycles of a system may have, by name, without those at other events."""
    robot, moves = system.robot, bool(system.cyclic)
    mounts = [mount for domain in system.domains for mount in domain.mounts]
    springs = dict.fromkeys(mount.name for mount in mounts if mount.spring.pulls)
    places = {"PHASE": system.phases, "EVENT": (), "JOINT": robot.actuated, "TOE": robot.toes}
    found = dict[str, Measure]()
    for each in CATALOGUE:
        pattern = each.pattern.replace("SECTION", system.section)
        word = next((word for word in PLACED if word in pattern), "")
        if not each.wanted or (each.pattern in OF_A_WAY and not moves):
            continue
        there = springs if each.kind == "deflection" else places.get(word, ())
        found |= dict.fromkeys([pattern.replace(word, place) for place in there] if word else [pattern], each)
    return found


def unit_in(system: HybridSystem, entry: Measure, name: str) -> str:
    """Returns the unit of a system's measure, by its entry and name: that of a deflection is its path's."""
    if entry.kind == "deflection":
        for mount in (mount for domain in system.domains for mount in domain.mounts):
            if name == f"deflection_{mount.name}":
                return unit_along(mount.along, system.robot)
    return unit_on(system.robot, entry, name)


def unit_on(robot: Robot, entry: Measure, name: str) -> str:
    """Returns the unit of a robot's measure, by its entry and name: joints that slide have others."""
    if not ("JOINT" in entry.pattern or entry.kind in OF_ALL_JOINTS):
        return entry.unit
    measured = {lengths(robot)[joint] for joint in robot.actuated if re.fullmatch(match_pattern(entry, joint), name)}
    return ALONG_A_RAIL.get(entry.unit, entry.unit) if measured == {"m"} else entry.unit


def match_pattern(entry: Measure, joint: str = "") -> str:
    """Returns the regular expression of the names of an entry's measures, or of those of one joint."""
    return PLACES.sub(lambda word: re.escape(joint) if joint and word[0] == "JOINT" else ".+", entry.pattern)


def describe_measure(name: str) -> Measure:
    """Returns what a measure means, by its name.

    Raises:
        UnknownName: the table has no measure with that name.
    """
    for each in CATALOGUE:
        if re.fullmatch(match_pattern(each), name):
            return each
    raise UnknownName("measure", name, [each.pattern for each in CATALOGUE])
