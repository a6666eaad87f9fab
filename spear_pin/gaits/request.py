"""Request for a bounding gait, and the objectives that may be minimised."""

from __future__ import annotations

from dataclasses import dataclass

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.gaits.bounding_law import STIFFNESS, BoundingLaw
from spear_pin.kinds import typed
from spear_pin.model.motor import Drive
from spear_pin.model.spring import Spring

OBJECTIVES: dict[str, tuple[str, str]] = {
    "effort": ("N²m²s/m", "integral of the squared torques of the pairs, per metre"),
    "hip": ("N²m²s/m", "the same, the hips' counted ten times"),
    "cot": ("1", "mechanical cost of transport: integral of |motor power| over weight and distance"),
    "peak": ("N·m", "largest torque of a pair"),
    "electrical": ("1", "cost of transport of the power that the knee motors draw and the hips' positive power"),
    "violation": ("N·m", "most that a knee motor's envelope is exceeded by"),
}
"""Objectives that can be minimised: name -> unit, meaning."""

LONGEST_STRIDE = 1.0  # s: what the search considers, as in the next lines
FASTEST, FARTHEST = 30.0, 4.0  # m/s, m
HIGHEST = 0.9  # m: of the torso
SHORTEST_FLIGHT, LONGEST_PHASE = 0.02, 0.4  # s
FLEXED = 2.4  # rad: of a knee
STEEPEST = 1.2  # rad: of a leg


@typed
@dataclass(frozen=True)
class Request:
    """Request for a bounding gait. Torques and forces are those of a pair of legs.

    Attributes:
        speed: mean forward speed, in m/s (source: 2.5).
        objective: a key of `OBJECTIVES`.
        lift_off: "knee" or "force", see `BoundingLaw`.
        friction: coefficient of friction that forces and impulses may use.
        minimum_force: least normal force in stance, in N; with lift-off by force the force is only kept from pulling.
        clearance: least height of the other toe during a stance, in m.
        minimum_stride: least duration of a stride, in s.
        minimum_stance: least duration of a stance, in s.
        minimum_knee_torque: least |ū| of (5.5)-(5.6), in N·m.
        hip_torque: largest hip torque, in N·m; None means no bound.
        stiffness: of the physical knee springs, in N·m/rad; None leaves it free.
        virtual_stiffness: k of (5.5)-(5.6), in N·m/rad.
        knee_touchdown: knee angle at touchdown, by magnitude, in rad; None leaves it free.
        leg_touchdown: bounds on the leg angle at touchdown, in rad.
        knee_drive: motor, gearbox and bus of each knee, two a pair; None means no bound.
        hip_drive: those of each hip.
        hardening: of the physical knee springs, in N·m/rad³.
        preload: of them, in N·m.
        table: of them, as of `Spring`, in the place of a stiffness.
    """

    speed: float = 2.5
    objective: str = "effort"
    lift_off: str = "knee"
    friction: float = 0.6
    minimum_force: float = 20.0
    clearance: float = 0.03
    minimum_stride: float = 0.0
    minimum_stance: float = 0.05
    minimum_knee_torque: float = 10.0
    hip_torque: float | None = None
    stiffness: float | None = STIFFNESS
    virtual_stiffness: float = BoundingLaw.virtual_stiffness
    knee_touchdown: float | None = BoundingLaw.knee_touchdown
    leg_touchdown: tuple[float, float] = (-0.3, 0.7)
    knee_drive: Drive | None = None
    hip_drive: Drive | None = None
    hardening: float = 0.0
    preload: float = 0.0
    table: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        """Check the fields."""
        if self.objective not in OBJECTIVES:
            raise UnknownName("objective", self.objective, OBJECTIVES)
        if self.objective in ("electrical", "violation") and self.knee_drive is None:
            raise BadValue("knee_drive", None, f"a drive, for the objective {self.objective!r}")
        if self.lift_off not in ("knee", "force"):
            raise UnknownName("rule of lift-off", self.lift_off, ("knee", "force"))
        require("speed", self.speed, lambda v: 0 < v <= FASTEST, f"a number > 0, at most {FASTEST:g}, in m/s")
        require("friction", self.friction, lambda mu: mu > 0, "a number > 0")
        for name, unit in (("minimum_force", "N"), ("minimum_knee_torque", "N·m"), ("virtual_stiffness", "N·m/rad")):
            require(name, getattr(self, name), lambda number: number >= 0, f"a number >= 0, in {unit}")
        require("clearance", self.clearance, lambda z: 0 <= z < HIGHEST, f"a number >= 0, below {HIGHEST:g}, in m")
        for name, unit in (("stiffness", "N·m/rad"), ("hip_torque", "N·m")):
            if getattr(self, name) is not None:
                require(name, getattr(self, name), lambda number: number >= 0, f"a number >= 0, in {unit}, or None")
        self.spring(STIFFNESS if self.stiffness is None else self.stiffness)  # it says what is valid
        self._check_durations()
        self._check_angles()

    def spring(self, stiffness: float) -> Spring:
        """The physical knee springs, of a pair of legs, with a stiffness in N·m/rad."""
        return Spring(stiffness, damping=0.0, hardening=self.hardening, preload=self.preload, table=self.table)

    def _check_durations(self) -> None:
        """Whether a stride can be as long, and the phases as short, as is asked."""
        within = f"a number >= 0, at most {LONGEST_STRIDE:g}, in s"
        require("minimum_stride", self.minimum_stride, lambda t: 0 <= t <= LONGEST_STRIDE, within)
        within = f"between 0 and {LONGEST_PHASE:g} s"
        require("minimum_stance", self.minimum_stance, lambda t: 0 < t < LONGEST_PHASE, within)
        shortest = max(self.minimum_stride, 2.0 * (self.minimum_stance + SHORTEST_FLIGHT))
        if self.speed * shortest > FARTHEST:
            expected = f"at most {FARTHEST / shortest:.3g} m/s, for a stride of at least {shortest:g} s has to end"
            raise BadValue("speed", self.speed, f"{expected} within {FARTHEST:g} m")

    def _check_angles(self) -> None:
        if self.knee_touchdown is not None:
            within = f"a number > 0, at most {FLEXED:g}, in rad, or None"
            require("knee_touchdown", self.knee_touchdown, lambda a: 0 < a <= FLEXED, within)
        expected = f"two angles in rad, the lower one first, within ±{STEEPEST:g}"
        try:
            least, most = self.leg_touchdown
        except (TypeError, ValueError):
            raise BadValue("leg_touchdown", self.leg_touchdown, expected) from None
        for bound in (least, most):
            require("leg_touchdown", bound, lambda angle: abs(angle) <= STEEPEST, expected)
        if least > most:
            raise BadValue("leg_touchdown", self.leg_touchdown, expected)
