"""Tables 2.2, 2.4 and 5.1 of the source, as printed, and the same numbers from shipped robots and the catalogue."""

from __future__ import annotations

from dataclasses import dataclass, fields

from spear_pin.errors import UnknownName
from spear_pin.model import catalogue
from spear_pin.model.loading import load


@dataclass(frozen=True)
class LegDesign:
    """A column of Table 2.4.

    Attributes:
        leg_mass: mass of the leg, in kg.
        thigh_mass: mass of the thigh, in kg.
        shank_mass: mass of the shank, in kg.
        thigh_inertia: "thigh link inertia", in kg·m².
        shank_inertia: "shank link inertia", in kg·m².
        hip_inertia: "hip motor inertia", in kg·m²; N² J.
        knee_inertia: "knee motor inertia", in kg·m²; N² J.
        thigh_com: distance of the centre of mass from the hip, in m.
        shank_com: distance of the centre of mass from the knee, in m.
        hip_ratio: N of the hip's gears.
        knee_ratio: N of the knee's gears.
        thigh_width: width of the thigh, in m.
    """

    leg_mass: float
    thigh_mass: float
    shank_mass: float
    thigh_inertia: float
    shank_inertia: float
    hip_inertia: float
    knee_inertia: float
    thigh_com: float
    shank_com: float
    hip_ratio: float
    knee_ratio: float
    thigh_width: float


@dataclass(frozen=True)
class QuadrupedDesign:
    """Numbers of Table 5.1.

    Attributes:
        torso_mass: mass of the torso, in kg.
        thigh_mass: mass of the thigh of one leg, in kg.
        shank_mass: mass of the shank of one leg, in kg.
        total_mass: total mass, in kg.
        torso_inertia: inertia of the torso, in kg·m² (printed: kg/m²).
        thigh_inertia: "link only", in kg·m².
        shank_inertia: "link only", in kg·m².
        hip_inertia: effective rotor inertia, in kg·m².
        knee_inertia: effective rotor inertia, in kg·m².
        knee_ratio: N of the knee's gears.
        hip_ratio: N of the hip's gears.
        thigh_length: length of the thigh, in m.
        shank_length: length of the shank, in m.
        thigh_com: distance of the centre of mass from the hip, in m.
        shank_com: distance of the centre of mass from the knee, in m.
        stiffness: k_rot of one leg, in N·m/rad.
        speed: nominal speed, in m/s.
    """

    torso_mass: float
    thigh_mass: float
    shank_mass: float
    total_mass: float
    torso_inertia: float
    thigh_inertia: float
    shank_inertia: float
    hip_inertia: float
    knee_inertia: float
    knee_ratio: float
    hip_ratio: float
    thigh_length: float
    shank_length: float
    thigh_com: float
    shank_com: float
    stiffness: float
    speed: float


SPEAR_I = LegDesign(4.55, 3.6, 0.95, 0.039, 0.02, 0.047, 0.008, 0.092, 0.097, 60.0, 25.0, 0.081)
SPEAR_II = LegDesign(2.2, 1.72, 0.48, 0.014, 0.014, 0.047, 0.027, 0.008, 0.14, 60.0, 15.0, 0.057)
Q_SPEAR = QuadrupedDesign(
    *(35.0, 1.72, 0.47, 43.76, 2.1, 0.014, 0.005, 0.047, 0.027),
    *(15.0, 60.0, 0.318, 0.318, 0.008, 0.144, 56.0, 2.5),
)
DESIGNS = {"SPEAR-I": SPEAR_I, "SPEAR-II": SPEAR_II}
LEGS = 4  # of the quadruped
BOOM_MASS = 4.6  # kg, Section 5.3
ROTORS = {  # the catalogue's motor that stands for the source's
    ("SPEAR-I", "hip"): "faulhaber_3863h024cr",
    ("SPEAR-I", "knee"): "faulhaber_3863h024cr",
    ("SPEAR-II", "hip"): "faulhaber_3863h024cr",
    ("SPEAR-II", "knee"): "ec_60_flat_100w_48v",
}


def links_mass(robot: str) -> float:
    """Returns the mass of thigh and shank of Table 2.4 together, in kg."""
    column = _column(robot)
    return column.thigh_mass + column.shank_mass


def improvement(quantity: str) -> float:
    """Returns a quantity of Table 2.4 for SPEAR-II over that for SPEAR-I."""
    return float(getattr(SPEAR_II, quantity) / getattr(SPEAR_I, quantity))


def imbalance(robot: str) -> float:
    """Returns the first moment of the thigh about the hip, m d, in kg·m."""
    column = _column(robot)
    return column.thigh_mass * column.thigh_com


def bare_rotor(robot: str, joint: str) -> float:
    """Returns a "motor inertia" of Table 2.4 over the square of its gear ratio, in kg·m²."""
    column = _column(robot)
    return float(getattr(column, f"{joint}_inertia") / getattr(column, f"{joint}_ratio") ** 2)


def reflected_rotor(robot: str, joint: str) -> float:
    """Returns N² J of the catalogue's motor for the source's motor, in kg·m², without the gears' own inertia."""
    rotor = catalogue.motor(ROTORS[robot, joint]).known("rotor_inertia")
    return float(getattr(_column(robot), f"{joint}_ratio") ** 2 * rotor)


def flat_over_cylindrical() -> float:
    """Returns the rotor inertia of SPEAR-II's flat knee motor over that of SPEAR-I's cylindrical one, by Table 2.4."""
    return bare_rotor("SPEAR-II", "knee") / bare_rotor("SPEAR-I", "knee")


def knee_by_hip_rotor() -> float:
    """Returns the joint inertia of SPEAR-I's knee motor if it is SPEAR-II's hip motor, by Table 2.4, in kg·m²."""
    return SPEAR_I.knee_ratio**2 * bare_rotor("SPEAR-II", "hip")


def printed(robot: str, quantity: str) -> float:
    """Returns a quantity of a column of Table 2.4 as printed."""
    return float(getattr(_column(robot), quantity))


def shank_about_com_by_table_2_4() -> float:
    """Returns Table 2.4's shank inertia less m d², in kg·m²: about the centre of mass if printed about the knee."""
    return SPEAR_II.shank_inertia - SPEAR_II.shank_mass * SPEAR_II.shank_com**2


def shipped_leg() -> LegDesign:
    """Returns Table 2.4's column by SPEAR-II's URDF: thigh about the hip, shank about the knee; without width."""
    robot = load("spear_ii")
    hip, knee = (robot.model.getJointId(joint) for joint in ("hip", "knee"))
    links = [robot.model.inertias[index] for index in (hip, knee)]
    (thigh, shank), depths = links, [float(abs(link.lever[2])) for link in links]
    about = [float(link.inertia[1, 1] + link.mass * depth**2) for link, depth in zip(links, depths, strict=True)]
    hip_rotor, knee_rotor = (float(robot.model.armature[robot.index(joint)]) for joint in ("hip", "knee"))
    return LegDesign(
        leg_mass=thigh.mass + shank.mass,
        thigh_mass=thigh.mass,
        shank_mass=shank.mass,
        thigh_inertia=about[0],
        shank_inertia=about[1],
        hip_inertia=hip_rotor,
        knee_inertia=knee_rotor,
        thigh_com=depths[0],
        shank_com=depths[1],
        hip_ratio=robot.gear_ratio("hip"),
        knee_ratio=robot.gear_ratio("knee"),
        thigh_width=float("nan"),
    )


def shipped(quantity: str) -> float:
    """Returns a quantity of Table 2.4 by SPEAR-II's URDF, see `shipped_leg`."""
    return float(getattr(shipped_leg(), quantity))


def shank_about_com() -> float:
    """Returns the inertia of SPEAR-II's shank about its centre of mass, in kg·m²."""
    robot = load("spear_ii")
    return float(robot.model.inertias[robot.model.getJointId("knee")].inertia[1, 1])


def quadruped_mass() -> float:
    """Returns the mass of the shipped Q-SPEAR, in kg."""
    return float(load("q_spear").mass)


def biped_over_monopod() -> float:
    """Returns the mass of the shipped biped, which one leg carries at a time, over that of SPEAR-II and its boom."""
    return float(load("biped").mass / load("spear_ii").mass)


def torso_share() -> float:
    """Returns the mass of the torso that each leg of the standing quadruped carries, in kg."""
    return Q_SPEAR.torso_mass / LEGS


def straight_leg_inertia() -> float:
    """Returns the inertia of Table 5.1's straight leg about the hip, without rotors, in kg·m²."""
    table = Q_SPEAR
    reach = table.thigh_length + table.shank_com
    return (
        table.thigh_inertia + table.thigh_mass * table.thigh_com**2 + table.shank_inertia + table.shank_mass * reach**2
    )


def hip_against_leg(ratio: float) -> tuple[float, float]:
    """Returns the hip rotor's inertia reflected by a gear ratio, and the straight leg's about the hip, in kg·m²."""
    return ratio**2 * Q_SPEAR.hip_inertia / Q_SPEAR.hip_ratio**2, straight_leg_inertia()


def quantities() -> tuple[str, ...]:
    """Returns the names of the rows of Table 2.4."""
    return tuple(field.name for field in fields(LegDesign))


def _column(robot: str) -> LegDesign:
    if robot not in DESIGNS:
        raise UnknownName("column of Table 2.4", robot, DESIGNS)
    return DESIGNS[robot]
