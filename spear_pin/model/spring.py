"""The switchable parallel spring (Sw-PEA): latched at touchdown, released at lift-off."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.branches import join_branches
from spear_pin.model.clutch import Clutch
from spear_pin.model.curve import Curve, through
from spear_pin.model.path import Path
from spear_pin.model.robot import Robot
from spear_pin.model.scalars import vanishes
from spear_pin.model.scale import scale_of

STIFFEST = 1e6  # N·m/rad: at a knee as good as rigid
MOST_POINTS = 30  # of a table: integration begins anew at each, and with more it is slow to compile
PAIR_STIFFNESS = 2 * 56.0  # N·m/rad: of the knee springs of a pair of Q-SPEAR's legs (source: Table 5.1)
UNITS = {
    "stiffness": "N·m/rad",
    "damping": "N·m·s/rad",
    "hardening": "N·m/rad³",
    "preload": "N·m",
    "hysteresis": "N·m",
}
ALONG = {"stiffness": "N/m", "damping": "N·s/m", "hardening": "N/m³", "preload": "N", "hysteresis": "N"}  # along m
STIFFEST_ALONG = 1e9  # N/m


@typed
@dataclass(frozen=True)
class Spring:
    """A spring and damper in parallel with a joint, or along a path, in action while its switch is engaged.

    The torque on the joint is -(τ₀ + k δ + k₃ δ³) - b θ̇, where δ = θ - θ_td is counted from the angle latched at
    touchdown and positive in flexion: with τ₀ = k₃ = 0 the corrected (3.24)-(3.25). A table takes the place of k δ. The
    physical spring is a chain in tension: it pulls only beyond θ_td. Along a path δ is how much longer the path is than
    at touchdown, a force takes the torque's place, and m takes that of rad in all units.

    Attributes:
        stiffness: k_rot, in N·m/rad (source: Table 4.2, with motor).
        damping: b, in N·m·s/rad, acting in stance only (source: Table 4.2, with motor).
        unilateral: whether it pulls only beyond the latched angle; False is the linear idealisation.
        rest: the angle of a spring that is never switched (a fixed parallel spring), in rad; None for a spring that is
            latched at touchdown and released at lift-off. The damper of both acts in stance only.
        hardening: k₃, in N·m/rad³.
        preload: τ₀, the torque with which the spring begins to pull, in N·m. A stop holds the spring stretched that
            far, so that the torque jumps at the latched angle; the energy stored at the stop is not counted. A joint
            that comes to rest on the stop knocks at it ever faster, as the chain does not yield. For a chain that
            yields use a table that begins steeply. Only a unilateral spring has a preload.
        table: points (δ, τ) with the torque τ against flexion, in rad and N·m, in place of k δ, so that the stiffness
            is 0. Between them is a smooth curve that rises and falls as they do, see `curve.through`; beyond them it
            is straight. They begin with (0, 0), or are on both sides of it if the spring is not unilateral. Where the
            torque falls, as beyond the best lever of a linkage, it may not change its sign.
        path: the path along which it acts; None for the joint that a gait gives it, such as the knee.
        clutch: its switch; None for one that acts in the instant of touchdown and lift-off.
        hysteresis: half the width of its loop, in N·m: how much more it pulls while it is stretched, and how much less
            while it is let go, than the mean, which the numbers above give. A unilateral spring never pushes. If the
            spring can hold the robot still within the loop, the run ends (`zeno`).

    Example:
        >>> from spear_pin import Spring, hopping, load
        >>> system = hopping(load("spear_ii"), spring=Spring(stiffness=55.0))
        >>> float(system.spring.torque(0.2))  # at 0.2 rad, in N·m: it extends
        -11.0
    """

    stiffness: float = 48.84
    damping: float = 1.3
    unilateral: bool = True
    rest: float | None = None
    hardening: float = 0.0
    preload: float = 0.0
    table: tuple[tuple[float, float], ...] = ()
    path: Path | None = None
    clutch: Clutch | None = None
    hysteresis: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        most = STIFFEST if self.turns else STIFFEST_ALONG
        for name, unit in self.units.items():
            within = f"a number from 0 to {most:g}, in {unit}"
            require(f"Spring.{name}", getattr(self, name), lambda number: (number >= 0) & (number <= most), within)
        if not self.unilateral:
            require("Spring.preload", self.preload, lambda torque: torque == 0, "0 for a spring that is not unilateral")
        object.__setattr__(self, "table", _checked(self.table, self.unilateral))
        if self.table:
            require("Spring.stiffness", self.stiffness, lambda k: k == 0, "0 with a table, which takes its place")
        if self.clutch is not None:
            _check_with(self, self.clutch)
        if self.rest is not None:
            most, within = (math.pi, "within ±π rad, or None") if self.turns else (math.inf, "a length in m, or None")
            require("Spring.rest", self.rest, lambda length: abs(length) < most, within)
            if self.clutch is not None:
                raise BadValue("Spring.clutch", self.clutch, "None for a spring with a rest, which is never switched")

    @classmethod
    @typed
    def scaled(cls, robot: Robot) -> Spring:
        """Scales SPEAR-II's or Q-SPEAR's spring to a robot of another size.

        Its stiffness scales with m g l, its damping with m g l √(l/g). Two legs count as pairs, which have Q-SPEAR's
        spring of 2 · 56 N·m/rad, without damping (the source gives none for the quadruped).

        Args:
            robot: a robot with one leg, as `spear_pin.monopod` cuts it, or two pairs, as `spear_pin.sagittal` does.

        Raises:
            BadValue: the robot has no legs of hip and knee in the plane.
        """
        spring, scale = cls() if len(robot.legs) == 1 else cls(PAIR_STIFFNESS, damping=0.0), scale_of(robot)
        stiffness, damping = spring.stiffness * scale.torque, spring.damping * scale.torque * scale.time
        return replace(spring, stiffness=stiffness, damping=damping)

    @classmethod
    def from_branches(cls, loading: Any, unloading: Any, **others: Any) -> Spring:
        """Makes a spring from its measured pull while it is stretched, and while it is let go.

        Its table is their mean, and its hysteresis is half the width of a loop that takes the same energy. A warning
        (`RobotWarning`) says by how much the width differs along the way, and that one branch goes further than the
        other.

        Args:
            loading: up to 30 points (δ, τ) as of `table`, measured while δ rises, from (0, 0) on.
            unloading: points measured while δ falls, in the same order; between them the pull is straight.
            **others: other fields, such as `damping` or `path`.

        Raises:
            BadValue: a branch does not begin with (0, 0), its δ do not rise, or the branches are those of no spring; or
                others have a table or a hysteresis.

        Example:
            >>> from spear_pin import Spring
            >>> spring = Spring.from_branches([(0, 0), (0.1, 6), (0.2, 11)], [(0, 0), (0.1, 4), (0.2, 9)])
            >>> spring.table, spring.hysteresis
            (((0.0, 0.0), (0.1, 5.0), (0.2, 10.0)), 0.75)
        """
        for name in ("table", "hysteresis"):
            if name in others:
                raise BadValue(name, others[name], "to be left out: it follows from the branches")
        table, hysteresis = join_branches(loading, unloading)
        return cls(**{"stiffness": 0.0, **others, "table": table, "hysteresis": hysteresis})

    @property
    def turns(self) -> bool:
        """Tells whether its stretch is an angle."""
        return self.path is None or self.path.turns

    @property
    def units(self) -> Mapping[str, str]:
        """The units of its numbers by name."""
        return UNITS if self.turns else ALONG

    @property
    def pulls(self) -> bool:
        """Tells whether there is a spring at all: it has a stiffness, or another law in its place."""
        return bool(self.stiffness or self.hardening or self.preload or self.table)

    # its law, for scalars of any kind in fields and arguments

    @property
    def chained(self) -> bool:
        """Tells whether a second spring is in series with it while its switch is open."""
        return self.clutch is not None and not vanishes(self.clutch.second)

    @property
    def in_series(self) -> Any:
        """The stiffness k k₂/(k + k₂) of it and the second spring of its switch."""
        second = 0.0 if self.clutch is None else self.clutch.second
        return self.stiffness * second / (self.stiffness + second)

    @property
    def at_slip(self) -> Any:
        """How far it is stretched while its clutch slips, in rad or m."""
        return (0.0 if self.clutch is None else self.clutch.slip) / self.stiffness

    def torque(self, deflection: Any, ops: Any = np) -> Any:
        """Returns the torque toward flexion while the spring pulls, without the damper's, in N·m, (3.24).

        Args:
            deflection: how far the joint is flexed beyond the angle at which it rests, in rad.
            ops: has `maximum` for such scalars, which a table needs.
        """
        pull = self.preload + deflection * (self.stiffness + self.hardening * deflection * deflection)
        return -(pull + self._curve(deflection, ops)) if self.table else -pull

    def drag(self, rate: Any) -> Any:
        """Returns the damper's torque on a joint that turns at a rate in rad/s, in N·m, (3.25)."""
        return -self.damping * rate

    def energy(self, deflection: Any, ops: Any = np) -> Any:
        """Returns the energy that the spring stores while it pulls, in J: the integral of minus its `torque`."""
        square = deflection * deflection
        energy = self.preload * deflection + square * (0.5 * self.stiffness + 0.25 * self.hardening * square)
        return energy + self._integral(deflection, ops) if self.table else energy

    @property
    def knots(self) -> tuple[float, ...]:
        """Returns the deflections at which the law has no second derivative, in rad."""
        return self._curve.starts[1:] if self.table else ()

    @cached_property
    def _curve(self) -> Curve:
        return through(self.table)

    @cached_property
    def _integral(self) -> Curve:
        return self._curve.integral()


def refuse_unusual(spring: Spring) -> None:
    """Refuses a spring whose switch is not ideal, that has hysteresis, or that acts along a path.

    Args:
        spring: the spring.

    Raises:
        BadValue: it is one of these.
    """
    if spring.clutch is not None:
        raise BadValue("Spring.clutch", spring.clutch, "None: only `hopping` and `bounding` take one")
    if spring.hysteresis:
        raise BadValue("Spring.hysteresis", spring.hysteresis, "0: only `hopping` and `bounding` take it")
    if spring.path is not None:
        raise BadValue("Spring.path", spring.path, "None: this spring is on its joint")


def _check_with(spring: Spring, clutch: Clutch) -> None:
    """Checks that a spring is one that its switch can have."""
    others = spring.hardening + spring.preload + spring.hysteresis
    alone = spring.stiffness and not others and type(spring).torque is Spring.torque
    for name in ("second", "slip"):
        if (number := getattr(clutch, name)) and not alone:
            raise BadValue(f"Clutch.{name}", number, "0 unless the spring has a stiffness alone")
    if clutch.slip and not spring.unilateral:
        raise BadValue("Clutch.slip", clutch.slip, "0 unless the spring is unilateral: the clutch slips as it pulls")


def _checked(table: Any, unilateral: bool) -> tuple[tuple[float, float], ...]:
    """Returns the points of a table as numbers.

    Raises:
        BadValue: the points are not those of a spring.
    """
    where = "the first of them (0, 0)" if unilateral else "(0, 0) between the first and the last"
    signs = "each torque 0 or of its angle's sign"
    expected = f"up to {MOST_POINTS} points (rad, N·m) with rising angles, {signs}, and {where}"
    try:
        points = tuple((float(angle), float(torque)) for angle, torque in table)
    except (TypeError, ValueError):
        raise BadValue("Spring.table", table, expected) from None
    if not points:
        return points
    angles, torques = np.array(points).T
    steps, rises = np.diff(angles), np.diff(torques)
    rising = (steps > 0.0).all() and (abs(rises) <= STIFFEST * steps).all()  # which no NaN is
    pulling = (angles * torques >= 0.0).all()
    placed = points.index((0.0, 0.0)) if (0.0, 0.0) in points else None
    fits = placed == 0 if unilateral else placed not in (None, 0, len(points) - 1)
    if not (rising and pulling and fits and 2 <= len(points) <= MOST_POINTS and np.isfinite(points).all()):
        raise BadValue("Spring.table", table, expected)
    return points


@typed
def rotational_stiffness(spring: float, spacer_radius: float, belt: float = 0.0, pulley_radius: float = 0.0) -> float:
    """Returns k_rot = 2 k_belt r_pulley² + k_S1 r_spacer², (3.5)-(3.6), in N·m/rad.

    Args:
        spring: k_S1, in N/m.
        spacer_radius: r_spacer, in m.
        belt: k_belt, in N/m.
        pulley_radius: r_pulley, in m.
    """
    return 2.0 * belt * pulley_radius**2 + spring * spacer_radius**2


@typed
def belt_stiffness(modulus: float, area: float, length: float, radius: float) -> float:
    """Returns k_rotBelt = 2 E A r² / L₀, (4.5)-(4.7), in N·m/rad, for both strands of a belt about its pulley.

    Args:
        modulus: E, in Pa. That of the rubber alone ignores the belt's cords, which are far stiffer.
        area: A of one strand, in m².
        length: L₀ of one strand, in m.
        radius: r of the pulley, in m.

    Raises:
        BadValue: a number that is not positive.
    """
    for name, value in (("modulus", modulus), ("area", area), ("length", length), ("radius", radius)):
        require(name, value, lambda number: number > 0, "a number > 0")
    return 2.0 * modulus * area * radius**2 / length
