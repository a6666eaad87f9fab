"""Motors of a payoff study: given, from the robot's own file, or assumed from a gait without springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from spear_pin.errors import BadValue
from spear_pin.model.catalogue import motor, scale_motor, size_motor
from spear_pin.model.motor import Drive, Gearbox, Motor
from spear_pin.model.robot import Robot
from spear_pin.model.variants import MASS, motor_size, parameters_of, vary
from spear_pin.studies.design import joints_of
from spear_pin.studies.hardware import Rig

KIND = "antigravity_4004_300kv"  # that is scaled
RATIO, EFFICIENCY = 9.0, 0.9  # of legged robots with such motors; its efficiency is assumed
SPARE = 1.5  # by which torque and speed of an assumed motor exceed what the gait takes
PARTS = ("knee", "hip")
SOURCE = "spear_ii"  # the robot whose motors the package knows


@dataclass(frozen=True)
class Motors:
    """Drives of the knees and the hips.

    Attributes:
        knee: drive of each knee.
        hip: drive of each hip.
        said: origin of each part's drive, in words.
        own: parts whose rotors the robot's file has already.
        replaced: parts whose given rotors stand in the place of those in the robot's file.
    """

    knee: Drive
    hip: Drive
    said: Mapping[str, str] = field(default_factory=dict)
    own: tuple[str, ...] = ()
    replaced: tuple[str, ...] = ()


def of_file(robot: Robot, part: str, bus: float | None = None) -> Drive | None:
    """Returns the drive of a part from the robot's TOML file, where it knows the motors of all legs and they are alike.

    Args:
        robot: a robot in the plane.
        part: "knee" or "hip".
        bus: voltage of the supply, in V; by default the motor's nominal voltage.
    """
    found = []
    for joint in joints_of(robot, part):
        own = robot.settings.motors.get(joint)
        if own is None:
            return None
        gearbox = Gearbox(ratio_of(robot, part) or 1.0, robot.settings.efficiencies.get(joint, 1.0))
        found.append(Drive(own, gearbox, supply_voltage(own, bus)))
    if found.count(found[0]) != len(found):
        raise BadValue(f"motors of the {part}s", [drive.motor.name for drive in found], "the same in all legs")
    found[0].motor.check_known()
    return found[0]


def supply_voltage(own: Motor, bus: float | None) -> float:
    """Returns the voltage of a motor's supply, in V: the one that is given, or the motor's nominal one.

    Raises:
        BadValue: none is given, and the nominal one is not known.
    """
    if bus is None and own.nominal_voltage is None:
        raise BadValue("bus", None, f"the voltage of the supply, in V: the nominal one of {own.name} is not known")
    return own.known("nominal_voltage") if bus is None else bus


def known(robot: Robot, part: str, bus: float | None = None) -> tuple[Drive, str] | None:
    """Returns the robot's own drive of a part, and its origin in words: its TOML file, or the source for SPEAR-II."""
    drive = of_file(robot, part, bus)
    if drive is not None:
        return drive, f"by {robot.settings.path}"
    if robot.cut is not None or robot.source != SOURCE:
        return None
    rig = Rig()
    gearbox = Gearbox(robot.gear_ratio(part), getattr(rig, f"{part}_efficiency"))
    return Drive(getattr(rig, part), gearbox, rig.battery.voltage if bus is None else bus), "SPEAR-II's"


def assume_motor(robot: Robot, part: str, torque: float, rate: float, bus: float | None = None) -> Drive:
    """Returns a catalogue motor scaled so that its continuous torque is `SPARE` times the rms torque of a gait.

    Gears and rotors of the robot's own file stay. The supply is the motor's, or as much as `SPARE` times the gait's
    speed needs.

    Args:
        robot: a robot in the plane.
        part: "knee" or "hip".
        torque: largest rms torque of one motor in a gait without springs, in N·m.
        rate: largest speed of the joints in that gait, in rad/s.
        bus: voltage of the supply, in V, if it is known.
    """
    like = motor(KIND)
    ratio = ratio_of(robot, part) if _has_rotor(robot, part) else None
    one = Drive(like, Gearbox(ratio or RATIO, EFFICIENCY), like.known("nominal_voltage"))
    power = like.known("rated_power") * SPARE * torque / one.continuous_torque
    needed = SPARE * rate * one.constant
    return Drive(scale_motor(like, float(f"{power:.3g}")), one.gearbox, bus or max(one.bus, float(f"{needed:.3g}")))


def fit_motors(robot: Robot, motors: Motors) -> Robot:
    """Returns the robot with the motors' gears and rotors but for its file's; given motors bring their mass."""
    values: dict[str, float] = {}
    for part in PARTS:
        drive: Drive = getattr(motors, part)
        if part not in motors.own:
            rotor = drive.motor.known("rotor_inertia") + drive.gearbox.inertia
            values |= {f"{part}_ratio": drive.gearbox.ratio, f"{part}_rotor": rotor}
            weighed = drive.motor.mass is not None and motors.said.get(part) != "assumed"
            if weighed and f"{part}_{MASS}" in parameters_of(robot):
                values[f"{part}_{MASS}"] = drive.motor.known("mass")
    return vary(robot, **values)


def make_geared(motors: Motors, robot: Robot) -> dict[str, Drive]:
    """Returns the drive of each part, of a motor of size 1, behind the robot's gears."""
    drives = {part: getattr(motors, part) for part in PARTS}
    return {
        part: replace(drive, gearbox=replace(drive.gearbox, ratio=robot.gear_ratio(joints_of(robot, part)[0])))
        for part, drive in drives.items()
    }


def as_built(motors: Motors, robot: Robot) -> Motors:
    """Returns motors behind the robot's gears, of the size that they have in it."""

    def of(part: str, drive: Drive) -> Drive:
        size = motor_size(robot, joints_of(robot, part)[0])
        return drive if size == 1.0 else replace(drive, motor=size_motor(drive.motor, size))

    drives = {part: of(part, drive) for part, drive in make_geared(motors, robot).items()}
    return replace(motors, knee=drives["knee"], hip=drives["hip"])


def own_rotors(robot: Robot) -> tuple[str, ...]:
    """Returns the parts whose rotors the robot's file has."""
    return tuple(part for part in PARTS if _has_rotor(robot, part))


def _has_rotor(robot: Robot, part: str) -> bool:
    """Tells whether the robot's file has the rotors of a part."""
    return all(robot.model.armature[robot.index(joint)] > 0.0 for joint in joints_of(robot, part))


def ratio_of(robot: Robot, part: str) -> float | None:
    """Returns the gear ratio of a part in the robot's file, 1 for a direct drive; None where it has none.

    Raises:
        BadValue: legs differ in it.
    """
    ratios = {float(robot.model.rotorGearRatio[robot.index(joint)]) for joint in joints_of(robot, part)}
    if len(ratios) > 1:
        raise BadValue(f"gear ratios of the {part}s", sorted(ratios), "the same in all legs")
    return ratios.pop() or None
