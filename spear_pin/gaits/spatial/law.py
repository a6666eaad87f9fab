"""The bounding controller in space: the plane's for each leg, and what the adduction joints do."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, require
from spear_pin.gaits.bounding_law import INPUTS as SAGITTAL
from spear_pin.gaits.bounding_law import PAIR, BoundingLaw, Shape
from spear_pin.gaits.spatial.legs import YAW, Leg, Pair
from spear_pin.gaits.virtual_constraints import demanded
from spear_pin.hybrid.domain import Law
from spear_pin.hybrid.dynamics import Dynamics, Operations, Row
from spear_pin.hybrid.symmetry import headed
from spear_pin.kinds import typed

ANTISYMMETRIC = ("hip_difference", "knee_difference", "leg_difference", "adduction", "adduction_torque")
SYMMETRIC = ("spread", "squeeze")
ACROSS = tuple(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ANTISYMMETRIC)
"""Parameters that are zero in symmetric motion, and change sign in the mirror: what turns and what balances."""
INPUTS = (*ACROSS, *SAGITTAL)
"""Parameters that event feedback adjusts once a stride: these, and the plane's."""
ADJUSTED = "adjusted"  # name in what is held


@typed
@dataclass(frozen=True)
class SpatialLaw:
    """Parameters of the bounding controller in space. None of them but the plane's is the source's.

    In stance an adduction joint is held by torque about the angle that it has at touchdown, never locked: with two toes
    on the ground its torque only presses them together. In the air it is an output. Differences are of the left leg
    from the pair's mean, so that the right leg has as much less.

    Attributes:
        plane: the sagittal controller; torques in it are those of a pair, of which each leg has half.
        adduction_stiffness: in stance, in N·m/rad.
        adduction_damping: in stance, in N·m·s/rad.
        adduction_epsilon: ε of the adduction as an output in the air, in s.
        posterior_hip_difference: in N·m.
        posterior_knee_difference: in N·m, extending.
        posterior_leg_difference: of the leg angle γ at touchdown, in rad.
        posterior_adduction: angle at touchdown, both legs to the left, in rad.
        posterior_adduction_torque: in stance, on both legs to the left, in N·m.
        posterior_spread: angle at touchdown, both legs outward, in rad.
        posterior_squeeze: torque in stance, on both legs inward, in N·m.
        anterior_hip_difference: as of the posterior pair, as all that follow.
        anterior_knee_difference: in N·m.
        anterior_leg_difference: in rad.
        anterior_adduction: in rad.
        anterior_adduction_torque: in N·m.
        anterior_spread: in rad.
        anterior_squeeze: in N·m.
        heading: to which feedback of the yaw steers, in rad.
        nominal: section state (q, v) of the gait, x = y = yaw = 0; what feedback compares with.
        feedback: event feedback, one row for each of `INPUTS`, one column for each of `nominal`.
        feedback_limits: largest adjustment of each of `INPUTS`, in N·m and rad.

    Example:
        >>> from spear_pin import Gait, SpatialLaw
        >>> law = SpatialLaw(Gait.load("long_stride").system.law, posterior_adduction=0.02)
        >>> law.adduction_stiffness  # N·m/rad
        300.0
    """

    plane: BoundingLaw
    adduction_stiffness: float = 300.0
    adduction_damping: float = 10.0
    adduction_epsilon: float = 0.04
    posterior_hip_difference: float = 0.0
    posterior_knee_difference: float = 0.0
    posterior_leg_difference: float = 0.0
    posterior_adduction: float = 0.0
    posterior_adduction_torque: float = 0.0
    posterior_spread: float = 0.0
    posterior_squeeze: float = 0.0
    anterior_hip_difference: float = 0.0
    anterior_knee_difference: float = 0.0
    anterior_leg_difference: float = 0.0
    anterior_adduction: float = 0.0
    anterior_adduction_torque: float = 0.0
    anterior_spread: float = 0.0
    anterior_squeeze: float = 0.0
    heading: float = 0.0
    nominal: tuple[float, ...] = ()
    feedback: Shape = ()
    feedback_limits: tuple[float, ...] = (*2 * (100.0, 100.0, 0.2, 0.3, 30.0), *4 * (100.0,), *2 * (0.2,))

    def __post_init__(self) -> None:
        """Check the fields."""
        valid: dict[str, tuple[Callable[[float], bool], str]] = {
            "adduction_stiffness": (lambda k: k >= 0, "a number >= 0, in N·m/rad"),
            "adduction_damping": (lambda b: b >= 0, "a number >= 0, in N·m·s/rad"),
            "adduction_epsilon": (lambda e: e > 0, "a number > 0, in s"),
        }
        for field in fields(self)[1:]:
            if isinstance(getattr(self, field.name), tuple):
                continue
            test, expected = valid.get(field.name, (math.isfinite, "a finite number"))
            require(f"SpatialLaw.{field.name}", getattr(self, field.name), test, expected)
        if self.feedback and np.shape(self.feedback) != (len(INPUTS), len(self.nominal)):
            expected = f"{len(INPUTS)} x {len(self.nominal)} numbers, as many columns as `nominal` has, or ()"
            raise BadValue("SpatialLaw.feedback", self.feedback, expected)
        if len(self.feedback_limits) != len(INPUTS) or min(self.feedback_limits) < 0:
            raise BadValue("SpatialLaw.feedback_limits", self.feedback_limits, f"{len(INPUTS)} numbers >= 0")

    @property
    def knee_rest(self) -> float:
        """θ̄ of (5.5)-(5.6), that of the plane's law, in rad."""
        return self.plane.knee_rest

    def of(self, leg: Leg, name: str, held: Mapping[str, Any]) -> float:
        """One of `ANTISYMMETRIC` for a leg, as adjusted: a difference with its sign, the others of both legs alike."""
        value = self._adjusted(self, f"{leg.pair}_{name}", held)
        return leg.lateral * value if name.endswith("difference") else value

    def of_pair(self, leg: Leg, name: str, held: Mapping[str, Any]) -> float:
        """A number of the plane's law for a leg's pair, as adjusted."""
        return self._adjusted(self.plane, f"{leg.pair}_{name}", held)

    def _adjusted(self, owner: Any, name: str, held: Mapping[str, Any]) -> float:
        value = float(getattr(owner, name))
        return value + held[ADJUSTED][INPUTS.index(name)] if self.feedback and ADJUSTED in held else value

    def adduction_touchdown(self, leg: Leg, held: Mapping[str, Any]) -> float:
        """Angle of a leg's adduction at touchdown, in rad."""
        return self.of(leg, "adduction", held) + leg.lateral * float(getattr(self, f"{leg.pair}_spread"))

    def adjustment(self, q: Sequence[float], v: Sequence[float]) -> tuple[float, ...]:
        """Adjustment of `INPUTS` for a stride by event feedback, within its limits, from a state on the section."""
        if not self.feedback:
            return ()
        at, moving = headed(np.array(q, dtype=float), np.array(v, dtype=float))
        at[YAW] = q[YAW] - self.heading
        wanted = np.array(self.feedback) @ (np.concatenate([at, moving]) - self.nominal)
        limits = np.array(self.feedback_limits)
        return tuple(np.clip(wanted, -limits, limits).tolist())


def support(leg: Leg, q: Any, v: Any, held: Mapping[str, Any], p: SpatialLaw, dyn: Dynamics) -> list[tuple[int, Any]]:
    """Motor torques of a supporting leg as (column, torque): half of a pair's, (5.4)-(5.6), and the adduction's."""
    adduction, hip, knee = leg.motors
    flexed = leg.side * q[leg.knee] - p.knee_rest
    total = -leg.side * (held[f"{leg.name}_knee_torque"] + p.plane.virtual_stiffness / PAIR * flexed)
    off = q[leg.adduction] - held[f"{leg.name}_adduction"]
    upright = held[f"{leg.name}_adduction_torque"] - p.adduction_stiffness * off
    return [
        (adduction, upright - p.adduction_damping * v[leg.adduction]),
        (hip, held[f"{leg.name}_hip_torque"]),
        (knee, total - dyn.spring_torque(leg.joint)),
    ]


def law_of(bearing: Sequence[Leg], airborne: Sequence[tuple[Leg, Pair]]) -> Law:
    """Torques while some legs bear, and others, each with the other pair, are in the air."""
    in_the_air = [motor for leg, _ in airborne for motor in (*leg.motors[1:], leg.motors[0])]

    def law(t: Any, q: Any, v: Any, held: Any, p: SpatialLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        torques = [torque for leg in bearing for torque in support(leg, q, v, held, p, dyn)]
        rows: list[Row] = []
        wanted: list[Any] = []
        for leg, others in airborne:
            outputs = leg.outputs(others, held[f"{leg.name}_weights"])
            demand = demanded(outputs, leg.evolution(held), q, v, p.plane.epsilon, ops)
            off, rate = q[leg.adduction] - held[f"{leg.name}_lands_at"], v[leg.adduction]
            rows += [*demand[0], ((leg.adduction, 1.0),)]
            wanted += [*demand[1], -(off / p.adduction_epsilon + 2.0 * rate) / p.adduction_epsilon]
        swing = dyn.imposing(rows, wanted, in_the_air, torques)
        return [torque for _, torque in sorted([*torques, *zip(in_the_air, swing, strict=True)])]

    return law
