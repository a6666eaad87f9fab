"""Numbers of a robot that a study may change, each by its name: assumed ones, the torso's and gears'.

Shipped robots have them, and robots that were cut out of others, for those have the joints of shipped ones.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Set
from dataclasses import dataclass
from math import copysign
from numbers import Real
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue, RobotWarning, UnknownName, list_names
from spear_pin.kinds import typed
from spear_pin.model.catalogue import mass_law, motor
from spear_pin.model.chain import CHAIN
from spear_pin.model.elements import MAX_NUMBER
from spear_pin.model.fitting import hold
from spear_pin.model.motor import Motor
from spear_pin.model.numbers import body_numbers, change_bodies
from spear_pin.model.recut import LIKE, recut
from spear_pin.model.robot import Robot
from spear_pin.model.scale import load_shipped

FULL = ("q_spear_full",)
QUADRUPEDS = ("q_spear", *FULL)
MONOPODS = ("spear_ii", "spear_ii_series")
ALL = (*MONOPODS, *QUADRUPEDS, "biped")
TABLE, TABLES, ASSUMPTION = "source Table 5.1", "source Tables 2.4 and 5.1", "assumption"
COMPUTED = f"computed from {TABLES}"
MASS, SIZE = "motor_mass", "motor_size"
AXIS = {"hip_distance": 0, "hip_spacing": 1}
CURVED = (MASS, SIZE)
"""Ends of names of parameters of which the equations' numbers are no polynomials."""
OWN = {"hip": motor("faulhaber_3863h024cr").known("mass"), "knee": motor("spear_ii_knee").known("mass")}
"""Mass of the motor that a shipped robot has at each joint of a kind, in kg."""


@dataclass(frozen=True)
class Parameter:
    """A number that shipped robots have besides those of their bodies.

    Attributes:
        default: its value in the URDF of a shipped robot.
        unit: unit of the value; a ratio has the unit 1.
        provenance: the place in the source, or that it is an assumption.
        summary: description of the number.
        robots: names of the shipped robots that have it.
    """

    default: float
    unit: str
    provenance: str
    summary: str
    robots: tuple[str, ...] = QUADRUPEDS


PARAMETERS: Mapping[str, Parameter] = MappingProxyType(
    {
        "hip_distance": Parameter(0.7, "m", ASSUMPTION, "from the posterior to the anterior hips, the torso midway"),
        "hip_spacing": Parameter(0.32, "m", ASSUMPTION, "from the left to the right hips", FULL),
        "torso_mass": Parameter(35.0, "kg", TABLE, "mass of the torso"),
        "torso_inertia": Parameter(2.1, "kg·m²", TABLE, "of the torso in pitch; in roll and yaw in proportion"),
        "hip_ratio": Parameter(60.0, "1", TABLES, "turns of a hip's rotor per turn of the hip", ALL),
        "knee_ratio": Parameter(15.0, "1", TABLES, "turns of a knee's rotor per turn of the knee", ALL),
        "hip_rotor": Parameter(0.047 / 60**2, "kg·m²", COMPUTED, "inertia of a hip's rotor, not reflected", ALL),
        "knee_rotor": Parameter(0.027 / 15**2, "kg·m²", COMPUTED, "inertia of a knee's rotor, not reflected", ALL),
        "hip_motor_mass": Parameter(OWN["hip"], "kg", ASSUMPTION, "mass of a hip's motor of size 1", ALL),
        "knee_motor_mass": Parameter(OWN["knee"], "kg", ASSUMPTION, "mass of a knee's motor of size 1", ALL),
        "hip_motor_size": Parameter(1.0, "1", ASSUMPTION, "continuous torque of a hip's motor over its own's", ALL),
        "knee_motor_size": Parameter(1.0, "1", ASSUMPTION, "continuous torque of a knee's motor over its own's", ALL),
        "boom_damping": Parameter(0.0, "N·s/m", ASSUMPTION, "viscous friction of the slider", MONOPODS),
        "adduction_ratio": Parameter(60.0, "1", ASSUMPTION, "turns of an adduction rotor per turn of its joint", FULL),
    }
)


def parameters_of(robot: Robot) -> tuple[str, ...]:
    """Returns the names of the parameters that a robot has; a cut has those of the shipped robot that it is like.

    A cut has parameters of gears for its joints with motors; the masses of its motors are not known.
    """
    source = robot.source if robot.cut is None else LIKE[robot.cut.kind]
    names = [name for name, parameter in PARAMETERS.items() if source in parameter.robots]
    if robot.cut is None:
        return tuple(names)
    names = [name for name in names if not name.endswith(CURVED)]
    return tuple(name for name in names if _kind(name) is None or any(_is(joint, name) for joint in robot.actuated))


def motor_mass(robot: Robot, kind: str) -> float:
    """Returns the mass of each motor of a shipped robot's joints of a kind, "hip" or "knee", in kg."""
    return _mass(robot.varied, kind)


def _mass(varied: Mapping[str, float], kind: str) -> float:
    one, size = varied.get(f"{kind}_{MASS}", OWN[kind]), varied.get(f"{kind}_{SIZE}", 1.0)
    return float(one * size ** mass_law().exponent)


def motor_size(robot: Robot, joint: str) -> float:
    """Returns the size of a joint's motor relative to the robot's own, which is 1 if `vary` has not changed it."""
    return next((x for name, x in robot.varied.items() if name.endswith(SIZE) and _is(joint, name)), 1.0)


def value_of(robot: Robot, name: str) -> float:
    """Returns the value of a robot's parameter, in its unit; an unvaried parameter of a cut comes from its model.

    If a number of a body was set that is the same under another name, as "roll_mass" may be, the value is that.

    Raises:
        BadValue: the joints that share the parameter have different values.
    """
    kind = _kind(name)
    if name in robot.varied or robot.cut is None:
        value = float(robot.varied.get(name, PARAMETERS[name].default))
        if kind is not None or robot.varied.keys() <= PARAMETERS.keys():  # no number of a body was set
            return value
        return value + (_read(robot.model, name) - _read(robot.base, name))
    model, found = robot.model, set[float]()
    if kind is None:
        return _read(model, name)
    for joint in robot.actuated:
        if _is(joint, name):
            row = robot.index(joint)
            ratio = float(model.rotorGearRatio[row]) or 1.0
            rotors = float(model.rotorInertia[row]) or float(model.armature[row]) / ratio**2
            found.add(ratio if name.endswith("_ratio") else rotors / len(robot.cut.angles[joint]))
    if len(found) > 1:
        listed = " and ".join(f"{value:g}" for value in sorted(found))
        raise BadValue(
            name, None, f"one number for all its joints, which have {listed}: first set vary(robot, {name}=...)"
        )
    return found.pop()


@typed
def vary(robot: Robot, **values: float) -> Robot:
    """Returns a robot with other numbers; the given one is left unchanged.

    A rotor keeps its own inertia J unless that is changed, so with another ratio N the joint's reflected
    inertia is N² J. Another size of a motor multiplies its rotor's inertia and its mass as `catalogue.sized` does. A
    motor is a point on the hip's axis (assumption): the knee's moves with the thigh, the hip's with the torso or the
    slider. The masses of gears stay.
    A body keeps the shape of its inertia unless a moment about one axis is given, a length its direction.
    Shapes that are drawn keep their size.

    Args:
        robot: any robot, as it is or varied already. `PARAMETERS` are of shipped robots and of those that `monopod` or
            `sagittal` cut out of others, where a rotor's inertia is that of one motor, of which a pair of legs has two.
        **values: new values by names of `PARAMETERS` or `numbers.body_numbers`, in their units. Earlier variations are
            kept. Numbers of bodies are set after the others.

    Raises:
        UnknownName: the robot has no number of that name; the text lists those that it has.
        BadValue: a value is not a finite number > 0 (>= 0 for a rotor or friction; any for a centre of mass), the
            robot's model was changed by other means, or a parameter changes a number of a body that was set before.

    Example:
        >>> from spear_pin import load, vary
        >>> vary(load("spear_ii"), knee_ratio=20.0).gear_ratio("knee")
        20.0
    """
    valid = parameters_of(robot)
    own = {name: value for name, value in values.items() if name in valid}
    for name, value in values.items():
        if name not in own and name not in body_numbers(robot):
            raise UnknownName("parameter", name, (*valid, *body_numbers(robot)))
        unit = PARAMETERS[name].unit if name in own else body_numbers(robot)[name].unit
        sign = "" if name[:-1].endswith("_com_") else " >= 0" if name.endswith(("_rotor", "_damping")) else " > 0"
        number = isinstance(value, Real) and not isinstance(value, bool) and abs(value) <= MAX_NUMBER
        if not number or (value < 0 and sign) or (value == 0 and sign == " > 0"):
            raise BadValue(name, value, f"a finite number{sign}" + ("" if unit == "1" else f", in {unit}"))
    if not values:
        return robot
    varied = {**robot.varied, **{name: float(value) for name, value in values.items()}}
    bodies = {name: value for name, value in varied.items() if name not in valid}
    base = _with_parameters(robot, own, bodies.keys() - values) if own else robot.base
    found = change_bodies(robot.with_model(base), bodies) if bodies else robot
    return found.with_model(found.model if bodies else base, varied=varied, base=base)


def _with_parameters(robot: Robot, values: Mapping[str, float], keep: Set[str]) -> pin.Model:
    """Returns the model before numbers of bodies are set, with other parameters, which leave some of these numbers."""
    if robot.base != _model(robot, robot.varied):
        raise BadValue("robot", robot, "one whose model only `vary` has changed since it was loaded")
    base = _model(robot, {**robot.varied, **values})
    old, new = (body_numbers(robot.with_model(model)) for model in (robot.base, base)) if keep else ({}, {})
    for name in sorted(keep):
        if old[name] != new.get(name):
            raise BadValue(name, robot.varied[name], f"a value given again, as {list_names([*values])} sets it, too")
    return base


def with_knee_motor(robot: Robot, other: Motor, **gears: float) -> Robot:
    """Returns a robot whose knees have another motor, with its mass.

    The robot's mass stays, and a `RobotWarning` says so, if the mass of the motor or of the robot's own is not known.

    Args:
        robot: a robot that `vary` takes.
        other: the motor.
        **gears: knee_ratio and knee_rotor, as for `vary`.
    """
    unknown = other.name if other.mass is None else f"the own knee motor of {robot.name}"
    if other.mass is not None and f"knee_{MASS}" in parameters_of(robot):
        return vary(robot, **gears, **{f"knee_{MASS}": other.mass})
    warnings.warn(RobotWarning(f"the robot's mass stays: that of {unknown} is not known"), stacklevel=3)
    return vary(robot, **gears)


def _model(robot: Robot, varied: Mapping[str, float]) -> pin.Model:
    """Returns the robot's original model with changes made before its joints are locked, which merges links."""
    cut = robot.cut
    base: Literal["chain"] | None = "chain" if robot.coordinates[: len(CHAIN)] == CHAIN else None
    if cut is None:
        model = load_shipped(str(robot.source), base).model.copy()
    else:
        model = recut(cut.kind, cut.robot, cut.legs, cut.body).model
    motors = None if cut is None else {joint: len(turns) for joint, turns in cut.angles.items()}
    for name, value in ((name, varied[name]) for name in parameters_of(robot) if name in varied):
        if _kind(name) is None:
            _change(model, name, value)
        elif not name.endswith(CURVED):
            _set_gears(model, name, value, motors)
    if any(name.endswith(CURVED) for name in varied):  # of which sizes multiply what the others set
        for kind, own in OWN.items():
            size = varied.get(f"{kind}_{SIZE}", 1.0)
            pair = 2.0 if robot.source == "q_spear" else 1.0
            _set_motors(model, f"{kind}_{SIZE}", size, pair * (_mass(varied, kind) - own))
    return hold(model, robot.locked)


def _change(model: pin.Model, name: str, value: float) -> None:
    if name == "boom_damping":
        model.damping[_slider(model)] = value
        return
    torso = _torso(model)
    body = model.inertias[torso]
    if name == "torso_mass":
        model.inertias[torso] = pin.Inertia(value, body.lever, body.inertia)
    elif name == "torso_inertia":
        model.inertias[torso] = pin.Inertia(body.mass, body.lever, body.inertia * (value / body.inertia[1, 1]))
    else:
        _move_hips(model, torso, AXIS[name], value)


def _read(model: pin.Model, name: str) -> float:
    """Returns what `_change` changes; of the torso with the motors on it."""
    if name == "boom_damping":
        return float(model.damping[_slider(model)])
    body = model.inertias[_torso(model)]
    if name == "torso_mass":
        return float(body.mass)
    if name == "torso_inertia":
        return float(body.inertia[1, 1])
    along = [place[AXIS[name]] for place in _places_of_hips(model, _torso(model))]
    return float(max(along) - min(along))


def _slider(model: pin.Model) -> int:
    return int(model.joints[model.getJointId("boom_z")].idx_v)


def _torso(model: pin.Model) -> int:
    return int(model.frames[model.getFrameId("torso", pin.FrameType.BODY)].parentJoint)


def _kind(parameter: str) -> str | None:
    """Returns the kind of joints of a parameter of gears, such as "knee"; None for other parameters."""
    ends = (f"_{of}" for of in ("ratio", "rotor", *CURVED))
    return next((parameter.removesuffix(end) for end in ends if parameter.endswith(end)), None)


def _is(joint: str, parameter: str) -> bool:
    """Tells whether a parameter of gears applies to a joint."""
    return joint == _kind(parameter) or joint.endswith(f"_{_kind(parameter)}")


def _set_gears(model: pin.Model, name: str, value: float, motors: Mapping[str, int] | None) -> None:
    """Sets a parameter of gears on every joint to which it applies.

    Args:
        model: the model, which is changed.
        name: name of the parameter.
        value: a ratio, or a rotor's inertia in kg·m².
        motors: number of motors at each joint of a cut; None if the rotors of a shipped robot grow in proportion.
    """
    armature, ratios, rotors = model.armature, model.rotorGearRatio, model.rotorInertia
    for index, joint in enumerate(model.names):
        if _is(joint, name):
            row = model.joints[index].idx_v
            if not rotors[row]:  # of which a file may say the reflected inertia only
                rotors[row] = armature[row] / (ratios[row] or 1.0) ** 2
            if name.endswith("_ratio"):
                ratios[row] = value
            elif motors is None:
                rotors[row] *= value / PARAMETERS[name].default
            else:
                rotors[row] = motors[joint] * value
            armature[row] = ratios[row] ** 2 * rotors[row]


def _set_motors(model: pin.Model, name: str, size: float, more: float) -> None:
    """Multiplies the rotors of motors by their size, and adds a mass, in kg, for each where it sits."""
    added: dict[int, Any] = {}
    for index, joint in enumerate(model.names):
        if _is(joint, name):
            row, body = model.joints[index].idx_v, int(model.parents[index])
            model.rotorInertia[row] *= size
            model.armature[row] *= size
            place = model.jointPlacements[index].translation * (_kind(name) != "knee")
            while not model.inertias[body].mass:  # as an adduction has none
                body, place = int(model.parents[body]), model.jointPlacements[body].act(place)
            added[body] = added.get(body, 0.0) + more * pin.Inertia(1.0, place, np.zeros((3, 3))).toDynamicParameters()
    for body, inertia in added.items():
        if more:
            numbers = model.inertias[body].toDynamicParameters() + inertia
            model.inertias[body] = pin.Inertia.FromDynamicParameters(numbers)


def _move_hips(model: pin.Model, torso: int, axis: int, distance: float) -> None:
    """Sets the distance, in m, between the joints on the torso's two ends along an axis, keeping their midpoint."""
    places = _places_of_hips(model, torso)
    middle = 0.5 * (min(place[axis] for place in places) + max(place[axis] for place in places))
    for place in places:
        place[axis] = middle + copysign(distance / 2, place[axis] - middle)


def _places_of_hips(model: pin.Model, torso: int) -> list[Any]:
    hips = [joint for joint in range(1, model.njoints) if model.parents[joint] == torso]
    return [model.jointPlacements[joint].translation for joint in hips]
