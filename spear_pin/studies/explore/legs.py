"""Hops whose numbers a user changes: SPEAR-II's, and those of another robot's leg, scaled."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.proportions import FLIGHT_TIME, usual_flight
from spear_pin.gaits.search import find_gait, gait_beside
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.result import State
from spear_pin.kinds import typed
from spear_pin.model.legs import lean
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_of
from spear_pin.model.settings import refuse_special
from spear_pin.model.spring import Spring
from spear_pin.model.variants import PARAMETERS
from spear_pin.studies.explore.knobs import Knob, Knobs, Origin, Subject
from spear_pin.studies.hop_of_another import hop_of, scaled_hopping

RATIO, TORQUE, KNEE = "knee_ratio", "stance_torque", "knee_touchdown"
KNOBS: Mapping[str, Knob] = {
    "stiffness": Knob("Spring stiffness", "N·m/rad", Spring().stiffness, 20, 100, 2, "source", "Table 4.2"),
    RATIO: Knob("Knee gear ratio", "1", PARAMETERS[RATIO].default, 5, 25, 1, "source", "Tables 2.4 and 5.1"),
    TORQUE: Knob("Stance torque", "N·m", 7.8262, 0, 14, 4, "solved", "for 0.2 s of flight"),
    KNEE: Knob(
        "Knee at touchdown", "rad", HoppingLaw().knee_touchdown, 0.5, 1.4, 3, "assumption", "commanded in flight"
    ),
    "friction": Knob("Friction coefficient", "1", Contact().friction, 0.1, 1.5, 2, "assumption", "of the ground"),
    "frequency": Knob("Stance frequency", "Hz", HoppingLaw().frequency, 1.5, 4, 2, "source", "with (4.10)"),
    "damping": Knob("Knee damping", "N·m·s/rad", Spring().damping, 0, 3, 2, "source", "Table 4.2"),
}
"""Those of SPEAR-II; another leg has them all but the gear's, which its file seldom tells."""


@dataclass(frozen=True, eq=False)
class Leg(Subject):
    """The hop of a leg in place.

    Attributes:
        hop: system with the default numbers, of a robot with one leg, boom_x locked.
        knobs: knobs by name.
        title: title of the page.
        wanted: flight time, in s, for which the default stance torque is solved, and which can be kept.
        near: a state near the default hop, where that is known.
    """

    hop: HybridSystem
    knobs: Mapping[str, Knob]
    title: str
    wanted: float
    near: State | None = None
    kind = "hop"

    @property
    def keeps(self) -> str:  # type: ignore[override]
        """The measure that can be kept."""
        return f"{self.wanted:.3g} s of flight"

    def system(self, values: Mapping[str, float]) -> HybridSystem:
        """Returns the hop with these numbers."""
        hip = {} if self.hop.law.hip_touchdown is None else {"hip_touchdown": self.hop.robot.legs[0].lean(values[KNEE])}
        return with_numbers(self.hop, {**values, **hip})

    def held(self, kept: bool) -> Mapping[str, str]:
        """Returns that the stance torque keeps the flight time, if it is kept."""
        return {TORQUE: "flight_time"} if kept else {}

    def moved(self, name: str, values: Mapping[str, float]) -> Mapping[str, float]:
        """Returns the parameters that a knob changes; the hip follows the knee where the toe stays below it."""
        if name != KNEE or self.hop.law.hip_touchdown is None:
            return {name: 1.0}
        leg = self.hop.robot.legs[0]
        _, slope, _ = lean(leg.thigh, leg.shank, values[KNEE], math)
        return {KNEE: 1.0, "hip_touchdown": float(slope)}

    @cached_property
    def start(self) -> State:
        """State just after touchdown of the periodic hop with the default numbers."""
        system = self.at().system
        if self.near is None:
            return find_gait(system).state
        try:
            return gait_beside(system, self.near, [], {}).state
        except NoGait:
            return find_gait(system, guess=self.near).state

    @property
    def thorough(self) -> Sequence[Knobs]:
        """Numbers for hops with a straight and with a bent knee."""
        return tuple(self.at(knee_touchdown=angle) for angle in (1.15, 0.5))


@cache
def spear_ii_hop() -> Leg:
    """Returns SPEAR-II's hop, boom_x locked."""
    return Leg(hopping(load("spear_ii", locked=["boom_x"])), KNOBS, "SPEAR-II hopping", FLIGHT_TIME)


@typed
def hop_of_leg(robot: Robot, title: str) -> Leg:
    """Returns the hop of another robot's leg; ranges are SPEAR-II's, scaled, with the leg's own numbers within them.

    Args:
        robot: a leg, as `spear_pin.monopod` cuts it, boom_x locked.
        title: title of the page.

    Raises:
        NoGait: the leg has no hop to begin with.
    """
    if "boom_x" in robot.coordinates:
        raise BadValue("robot", robot, 'a leg that hops in place: monopod(..., locked=["boom_x"])')
    refuse_special(robot, "knobs move")
    scale = scale_of(robot)
    usual = scaled_hopping(robot)
    own = "knee" in robot.settings.springs
    by_file: tuple[Origin, str] = ("own", "of its file") if own else ("scaled", "from SPEAR-II's")
    given = {
        "stiffness": _scaled(KNOBS["stiffness"], usual.spring.stiffness, scale.torque, *by_file),
        "frequency": _scaled(KNOBS["frequency"], usual.law.frequency, 1.0 / scale.time, "scaled", "from SPEAR-II's"),
        "damping": _scaled(KNOBS["damping"], usual.spring.damping, scale.torque * scale.time, *by_file),
    }
    knee = KNOBS[KNEE].default
    leant, frequency = robot.legs[0].lean(knee), given["frequency"].default
    law = replace(usual.law, knee_touchdown=knee, hip_touchdown=leant, frequency=frequency)
    spring = replace(usual.spring, stiffness=given["stiffness"].default, damping=given["damping"].default)
    gait = hop_of(usual.build(robot, law, spring, usual.ground), usual_flight(robot), within_limits=True)
    flight, torque = gait.durations["flight"], gait.system.law.stance_torque
    note = f"for {flight:.3g} s of flight"
    given[TORQUE] = _scaled(KNOBS[TORQUE], torque, scale.torque, "solved", note)
    knobs = {name: given.get(name, knob) for name, knob in KNOBS.items() if name != RATIO}
    return Leg(gait.system, knobs, title, flight, gait.state)


def _scaled(knob: Knob, default: float, factor: float, origin: Origin, note: str) -> Knob:
    """Returns a knob of another robot: its own default in a scaled range, which is widened where needed."""
    digits = max(0, knob.digits - round(math.log10(factor)))
    low, high = min(knob.low * factor, 0.5 * default), max(knob.high * factor, 2.0 * default)
    coarse = max(0, digits - 1)
    return replace(
        knob,
        default=round(default, digits),
        low=round(low, coarse),
        high=round(high, coarse),
        digits=digits,
        origin=origin,
        note=note,
    )
