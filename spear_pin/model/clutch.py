"""The switch of a spring as it is: late, toothed, with play, and slipping."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed

SPRING, JOINT = "spring", "joint"
TOUCHDOWN, LIFT_OFF = "touchdown", "lift_off"
LOADED, UNLOADED = "loaded", "unloaded"
LONGEST_PATH, SHORTEST_PATH = "longest", "shortest"
CONDITIONS = LOADED, UNLOADED, LONGEST_PATH, SHORTEST_PATH
CHOICES = {"damper": (SPRING, JOINT), "engage": (TOUCHDOWN, *CONDITIONS), "release": (LIFT_OFF, *CONDITIONS)}
FORCES = "on_force", "off_force"
DELAYS = "on_delay", "off_delay"
TIMES = (*DELAYS, "hold")
OF_CLUTCHES = (*TIMES, "play", "pitch", "tooth", "second", "slack", "slip", *FORCES)  # its numbers
LONGEST = 1.0  # s


@typed
@dataclass(frozen=True)
class Clutch:
    """A switch that engages a spring after its toe has touched the ground, and releases it after the toe has left.

    If the toe touches again before the spring is released, or leaves again before it is engaged, nothing happens.

    Attributes:
        on_delay: time from touchdown until the spring is engaged, in s.
        off_delay: time from lift-off until it is released, in s.
        play: how far the path grows after the spring is engaged before the spring pulls, in rad or m.
        pitch: distance of the teeth in which the spring can rest, in rad or m; 0 for a switch without teeth. The next
            tooth is engaged: until the path has grown that far the spring is slack.
        tooth: length of the path at one of the teeth, in rad or m.
        damper: "spring" if the spring's damper is engaged with it, "joint" if it acts throughout stance.
        second: stiffness of a second, weak spring in series, which keeps the chain taut while the switch is open, in
            N·m/rad or N/m; 0 for none. The closed switch bridges it. Then neither engaging nor bridging costs energy;
            releasing costs what the two springs lose as they come to the same pull.
        slack: length of the path at which both springs are without pull, in rad or m.
        hold: time from touchdown after which it releases the spring by itself, in s; 0 if lift-off releases it.
        slip: pull of the spring at which the clutch slips, in N·m or N; 0 for one that holds any pull. While it slips
            the pull stays the same, until the path grows no more; then the spring rests at a greater length than
            before. The energy that the clutch takes is the ledger's `clutch`.
        engage: when it engages the spring: at "touchdown", or in stance where the path begins to shorten ("longest") or
            to grow ("shortest"), or where the toe is "loaded" or "unloaded". A toe is loaded as the ground's force
            rises through `on_force`. Just after touchdown that force must be able to rise, which takes the joint's
            damper, or a `minimum_force` of the law above `on_force`.
        release: when it releases the spring: at "lift_off", or before it on one of the same conditions.
        on_force: the force through which the ground's rises where the toe is loaded, in N.
        off_force: the force through which it falls where the toe is unloaded, in N. If it is only a little less than
            `on_force`, the spring's own force may undo the switch at once, again and again (`zeno`).

    Example:
        >>> from spear_pin import Clutch, Spring, hopping, load
        >>> late = Spring(clutch=Clutch(on_delay=0.004, off_delay=0.004, damper="joint"))
        >>> hopping(load("spear_ii"), spring=late).spring.clutch.on_delay
        0.004
    """

    on_delay: float = 0.0
    off_delay: float = 0.0
    play: float = 0.0
    pitch: float = 0.0
    tooth: float = 0.0
    damper: str = SPRING
    second: float = 0.0
    slack: float = 0.0
    hold: float = 0.0
    slip: float = 0.0
    engage: str = TOUCHDOWN
    release: str = LIFT_OFF
    on_force: float = 0.0
    off_force: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name in TIMES:
            within = f"a number from 0 to {LONGEST:g}, in s"
            require(f"Clutch.{name}", getattr(self, name), lambda delay: (delay >= 0) & (delay <= LONGEST), within)
        for name in ("play", "pitch"):
            require(f"Clutch.{name}", getattr(self, name), lambda length: length >= 0, "a number >= 0, in rad or m")
        require("Clutch.tooth", self.tooth, lambda length: abs(length) < math.inf, "a finite number, in rad or m")
        require("Clutch.second", self.second, lambda k: k >= 0, "a number >= 0, in N·m/rad or N/m")
        require("Clutch.slip", self.slip, lambda pull: (pull >= 0) & (pull < math.inf), "a number >= 0, in N·m or N")
        require("Clutch.slack", self.slack, lambda length: abs(length) < math.inf, "a finite number, in rad or m")
        if self.second and (self.pitch or self.play):
            raise BadValue("Clutch.second", self.second, "0 with teeth or play: it keeps the chain taut")
        if self.pitch and self.play:
            raise BadValue("Clutch.play", self.play, "0 with teeth, which have play of their own")
        if self.slip and (self.pitch or self.second):
            raise BadValue("Clutch.slip", self.slip, "0 with teeth or a second spring, which do not slip")
        _check_conditions(self)
        if self.hold and (self.on_delay or self.off_delay):
            raise BadValue("Clutch.hold", self.hold, "0 with delays: it engages in the instant of touchdown")


def _check_conditions(clutch: Clutch) -> None:
    """Checks when a switch engages and releases."""
    for name, valid in CHOICES.items():
        if (chosen := getattr(clutch, name)) not in valid:
            raise BadValue(f"Clutch.{name}", chosen, " or ".join(map(repr, valid)))
    if clutch.engage == clutch.release:
        others = " or ".join(repr(each) for each in CHOICES["release"] if each != clutch.engage)
        raise BadValue("Clutch.release", clutch.release, f"{others} where engage is {clutch.engage!r}")
    for name in FORCES:
        within = "a number >= 0, in N"
        require(f"Clutch.{name}", getattr(clutch, name), lambda force: (force >= 0) & (force < math.inf), within)
    for name in TIMES:
        if (time := getattr(clutch, name)) and (clutch.engage, clutch.release) != (TOUCHDOWN, LIFT_OFF):
            raise BadValue(f"Clutch.{name}", time, "0 unless it engages at touchdown and releases at lift-off")
    for name, condition in zip(FORCES, (LOADED, UNLOADED), strict=True):
        if (force := getattr(clutch, name)) and condition not in (clutch.engage, clutch.release):
            raise BadValue(f"Clutch.{name}", force, f"0 unless it engages or releases where the toe is {condition!r}")
    if {clutch.engage, clutch.release} == {LOADED, UNLOADED} and not clutch.off_force < clutch.on_force:
        raise BadValue("Clutch.off_force", clutch.off_force, f"less than on_force, {clutch.on_force:g} N")
