"""Assumptions of this package, where the source prints nothing; each statement names the assumptions it uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Other:
    """An alternative to an assumption.

    Attributes:
        label: label in words.
        given: arguments, as (keyword, value), with which it calls a statement's study.
    """

    label: str
    given: tuple[str, Any]


@dataclass(frozen=True)
class Assumption:
    """A number, or a reading of the text, that the source leaves open.

    An assumption with neither `others` nor `settled` replaces an unknown. A statement that uses it neither agrees nor
    differs.

    Attributes:
        id: name in the code.
        what: what the source leaves open.
        here: the number or reading that replaces it.
        others: alternatives with which a statement that uses it is checked, too.
        settled: why a statement that uses it may be judged all the same.
    """

    id: str
    what: str
    here: str
    others: tuple[Other, ...] = ()
    settled: str = ""

    @property
    def stands_in(self) -> bool:
        """Whether a statement that uses this assumption cannot be judged."""
        return not (self.others or self.settled)


ASSUMPTIONS = (
    Assumption("soft-spring", "Stiffness K₂ of the soft spring of Fig. 2.1", "1 % of K₁; the source has K₂ ≪ K₁"),
    Assumption(
        "touchdown",
        "Touchdown angles of the hop",
        "commanded knee 1.0 rad, hip half of it",
        others=(Other("knee commanded to 0.9 rad", ("knee", 0.9)), Other("knee commanded to 1.1 rad", ("knee", 1.1))),
    ),
    Assumption(
        "stance-torque",
        "Stance torque τ̄ of the hop",
        "solved for so that the flight lasts the 0.2 s of Section 4.2.2; the flight time is then no finding",
        settled="it follows from the source's flight time, for any touchdown angles",
    ),
    Assumption(
        "friction",
        "Coefficient of friction",
        "0.8, of which a bounding gait may use 0.6 in its search",
        others=(Other("friction of 0.6", ("friction", 0.6)),),
    ),
    Assumption(
        "rest-angle",
        "What RA of Table 4.1 is",
        "the spring's zero, not the angle at which the leg stands",
        others=(Other("RA as the angle at rest", ("static_rest", True)),),
    ),
    Assumption(
        "knee-motor",
        "Resistance, inductance and continuous torque of the knee motor",
        "those of an EC 60 flat in its 48 V winding, mostly from memory, behind gears of an efficiency of 0.83; the "
        "source gives type, K_v, power and gear ratio",
    ),
    Assumption(
        "hip-motor",
        "Type of the hip motor",
        "Faulhaber 3863 H 024 CR, whose rotor fits the reflected inertia; gears of an efficiency of 0.75 in the hop, "
        "without loss where its limits are asked; the source gives the maker",
    ),
    Assumption(
        "supply",
        "Battery and bridge",
        "SPEAR-II's 24 V without resistance, for the quadruped's hips and its 100 W motors, too; diodes of 0.7 V; "
        "current limits of 8 and 10 A",
    ),
    Assumption(
        "disturbances",
        "Noise, lost commands and current loop of the experiment",
        "5 mrad, 0.2 rad/s, 5 losses a second",
    ),
    Assumption(
        "records",
        "The records of the push test",
        "synthetic ones, of the tables' own parameters with white noise of 5 mrad; nothing here is measured",
    ),
    Assumption(
        "bound",
        "Torques, touchdown angles and polynomials of the bounding gait",
        "a gait of this package, long_stride: the source's masses, springs and speed, the rest found by optimisation; "
        "friction of 0.8, of which it uses less than 0.6, so that any coefficient from there on has the same motion",
        others=tuple(Other(f"gait {name}", ("gait", name)) for name in ("least_effort", "force_lift_off")),
    ),
    Assumption(
        "torso-length",
        "Distance of the quadruped's hips",
        "0.70 m",
        settled="it is part of the gait, which is varied; from 0.55 to 0.85 m peak torques change by a quarter at most "
        "(docs/results/design.md)",
    ),
    Assumption(
        "virtual-stiffness",
        "Virtual stiffness k_p, k_a of (5.5) and (5.6)",
        "200 N·m/rad a motor, which Fig. 5.6 implies by its flat line; that the line is flat there is then no finding",
        settled="it follows from the flat line of Fig. 5.6",
    ),
    Assumption(
        "decay",
        "Gains K_P, K_V and ε of (5.16)",
        "critically damped, ε = 0.015 s",
        others=(Other("ε of 0.01 s", ("epsilon", 0.01)), Other("ε of 0.02 s", ("epsilon", 0.02))),
    ),
    Assumption(
        "prospective-motors",
        "Which motors of 260 W and 600 W are meant",
        "an EC 90 flat by a secondary source, on 48 V behind 15:1, and the same scaled to 600 W, which is no real "
        "motor",
    ),
    Assumption(
        "turn",
        "Gaits that turn, friction, roll inertia and distance of left and right hips",
        "gaits of our own with adductions free on the ground, and the robot's file",
    ),
    Assumption("biped", "Torso and gait of the biped", "a torso of 4.6 kg, as much as the boom; no gait"),
    Assumption(
        "costs", "The points of Fig. 2.4", "published numbers of other robots, each with how far it is verified"
    ),
)
