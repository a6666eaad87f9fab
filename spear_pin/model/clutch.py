"""The switch of a spring as it is: late, toothed, with play, and slipping."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed

SPRING, JOINT = "spring", "joint"
DELAYS = "on_delay", "off_delay"
TIMES = (*DELAYS, "hold")
OF_CLUTCHES = (*TIMES, "play", "pitch", "tooth", "second", "slack", "slip")  # its numbers
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
        if self.hold and (self.on_delay or self.off_delay):
            raise BadValue("Clutch.hold", self.hold, "0 with delays: it engages in the instant of touchdown")
        if self.damper not in (SPRING, JOINT):
            raise BadValue("Clutch.damper", self.damper, f"{SPRING!r} or {JOINT!r}")
