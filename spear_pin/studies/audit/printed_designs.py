"""Tables 2.2, 2.4 and 5.1 of the source, as printed, and the same numbers from shipped robots and the catalogue."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from spear_pin.gaits.bounding_law import PAIR
from spear_pin.model import catalogue
from spear_pin.model.loading import load


@dataclass(frozen=True)
class Design:
    """Numbers of a leg, or of a quadruped with such legs, SI units; NaN where there is none.

    The first twelve are the rows of Table 2.4. Inertias of thigh and shank are the "link inertia" of Table 2.4, or
    "link only" of Table 5.1; those of hip and knee are the motors', N² J. A `com` is the distance of a centre of mass
    from the hip, or from the knee. The stiffness is k_rot of one leg.
    """

    leg_mass: float = math.nan
    thigh_mass: float = math.nan
    shank_mass: float = math.nan
    thigh_inertia: float = math.nan
    shank_inertia: float = math.nan
    hip_inertia: float = math.nan
    knee_inertia: float = math.nan
    thigh_com: float = math.nan
    shank_com: float = math.nan
    hip_ratio: float = math.nan
    knee_ratio: float = math.nan
    thigh_width: float = math.nan
    torso_mass: float = math.nan
    total_mass: float = math.nan
    torso_inertia: float = math.nan
    thigh_length: float = math.nan
    shank_length: float = math.nan
    stiffness: float = math.nan
    speed: float = math.nan

    def bare_rotor(self, joint: str) -> float:
        """Returns the inertia of a joint's motor over the square of its gear ratio, in kg·m²."""
        return float(getattr(self, f"{joint}_inertia") / getattr(self, f"{joint}_ratio") ** 2)


TABLE_2_4 = tuple(field.name for field in fields(Design))[:12]
SPEAR_I = Design(4.55, 3.6, 0.95, 0.039, 0.02, 0.047, 0.008, 0.092, 0.097, 60.0, 25.0, 0.081)
SPEAR_II = Design(2.2, 1.72, 0.48, 0.014, 0.014, 0.047, 0.027, 0.008, 0.14, 60.0, 15.0, 0.057)
TABLE_5_1 = {
    **{"torso_mass": 35.0, "thigh_mass": 1.72, "shank_mass": 0.47, "total_mass": 43.76},
    **{"torso_inertia": 2.1, "thigh_inertia": 0.014, "shank_inertia": 0.005},
    **{"hip_inertia": 0.047, "knee_inertia": 0.027, "knee_ratio": 15.0, "hip_ratio": 60.0},
    **{"thigh_length": 0.318, "shank_length": 0.318, "thigh_com": 0.008, "shank_com": 0.144},
    **{"stiffness": 56.0, "speed": 2.5},
}
Q_SPEAR = Design(**TABLE_5_1)
DESIGNS = {"SPEAR-I": SPEAR_I, "SPEAR-II": SPEAR_II}
ROTORS = {  # the catalogue's motor that stands for the source's
    ("SPEAR-I", "hip"): "faulhaber_3863h024cr",
    ("SPEAR-I", "knee"): "faulhaber_3863h024cr",
    ("SPEAR-II", "hip"): "faulhaber_3863h024cr",
    ("SPEAR-II", "knee"): "ec_60_flat_100w_48v",
}


def improvement(quantity: str) -> float:
    """Returns a quantity of Table 2.4 for SPEAR-II over that for SPEAR-I."""
    return float(getattr(SPEAR_II, quantity) / getattr(SPEAR_I, quantity))


def reflected_rotor(robot: str, joint: str) -> float:
    """Returns N² J of the catalogue's motor for the source's motor, in kg·m², without the gears' own inertia."""
    rotor = catalogue.motor(ROTORS[robot, joint]).known("rotor_inertia")
    return float(getattr(DESIGNS[robot], f"{joint}_ratio") ** 2 * rotor)


def by_urdf(name: str) -> Design:
    """Returns the numbers of a robot's URDF, of one leg, links about their centres of mass; the boom is the torso.

    Args:
        name: "spear_ii" or "q_spear".
    """
    base, leg, legs = {"spear_ii": ("boom_z", "", 1), "q_spear": ("pitch", "posterior_", PAIR)}[name]
    robot = load(name)
    torso, thigh, shank = (
        robot.model.inertias[robot.model.getJointId(joint)] for joint in (base, f"{leg}hip", f"{leg}knee")
    )
    hip, knee = (float(robot.model.armature[robot.index(f"{leg}{joint}")]) / legs for joint in ("hip", "knee"))
    top, middle, toe = (robot.frame_position(np.zeros(robot.nq), leg + part) for part in ("thigh", "shank", "toe"))
    return Design(
        leg_mass=(thigh.mass + shank.mass) / legs,
        thigh_mass=thigh.mass / legs,
        shank_mass=shank.mass / legs,
        thigh_inertia=float(thigh.inertia[1, 1]) / legs,
        shank_inertia=float(shank.inertia[1, 1]) / legs,
        hip_inertia=hip,
        knee_inertia=knee,
        thigh_com=float(abs(thigh.lever[2])),
        shank_com=float(abs(shank.lever[2])),
        hip_ratio=robot.gear_ratio(f"{leg}hip"),
        knee_ratio=robot.gear_ratio(f"{leg}knee"),
        torso_mass=torso.mass,
        total_mass=robot.mass,
        torso_inertia=float(torso.inertia[1, 1]),
        thigh_length=float(np.linalg.norm(middle - top)),
        shank_length=float(np.linalg.norm(toe - middle)),
    )


def shipped(quantity: str) -> float:
    """Returns a quantity of Table 2.4 by SPEAR-II's URDF: inertias of the thigh about the hip, shank about the knee."""
    leg = by_urdf("spear_ii")
    thigh, shank = leg.thigh_mass * leg.thigh_com**2, leg.shank_mass * leg.shank_com**2
    about = replace(leg, thigh_inertia=leg.thigh_inertia + thigh, shank_inertia=leg.shank_inertia + shank)
    return float(getattr(about, quantity))


def straight_leg_inertia() -> float:
    """Returns the inertia of Table 5.1's straight leg about the hip, without rotors, in kg·m²."""
    table = Q_SPEAR
    reach = table.thigh_length + table.shank_com
    return (
        table.thigh_inertia + table.thigh_mass * table.thigh_com**2 + table.shank_inertia + table.shank_mass * reach**2
    )
