"""Numbers of any robot's bodies, each by its name: masses, centres of mass, inertias, lengths, friction.

Names begin with the joint that moves the body. `variants` has more names, for a robot's gears, torso and rotors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from math import hypot
from types import MappingProxyType
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue
from spear_pin.model.equations import REMEMBERED, mechanism_of
from spear_pin.model.robot import Robot

UNITS: Mapping[str, str] = {
    "mass": "kg",
    "com_x": "m",
    "com_y": "m",
    "com_z": "m",
    "inertia": "kg·m²",
    "inertia_xx": "kg·m²",
    "inertia_yy": "kg·m²",
    "inertia_zz": "kg·m²",
    "armature": "kg·m²",
    "viscous": "N·m·s/rad",
}
"""What is said of each joint, with its unit: mass, centre of mass in the joint's frame parallel to the world at q = 0,
inertia about it in the plane or, in space, about its axes, reflected inertia of the rotor, viscous friction."""
AXES, RADIUS = "xyz", "_radius"
ROUNDING = 1e-9


@dataclass(frozen=True)
class Number:
    """A number of a robot.

    Attributes:
        value: value in its unit.
        unit: the unit.
    """

    value: float
    unit: str


@lru_cache(maxsize=REMEMBERED)
def body_numbers(robot: Robot) -> Mapping[str, Number]:
    """Returns the nonzero numbers of a robot's bodies, by name.

    "knee_mass" is the mass of the body that the knee moves, "hip_to_knee", "knee_to_toe" and, to an end of the loop
    "pin", "rod_to_pin_a" are lengths, "toe_radius" that of a round foot. In space
    "roll_inertia_xx" is the inertia of what turns with the joint "roll", the torso, about its x axis.

    Raises:
        BadValue: the robot has a joint of several coordinates.

    Example:
        >>> from spear_pin import body_numbers, load
        >>> body_numbers(load("spear_ii"))["hip_to_knee"]
        Number(value=0.318, unit='m')
    """
    mechanism, turns, found = mechanism_of(robot), _turns(robot.model), dict[str, Number]()
    for i, (joint, body) in enumerate(zip(robot.coordinates, mechanism.bodies, strict=True)):
        values = _of_body(robot.model.inertias[i + 1], turns[i + 1], robot.planar)
        values |= {"armature": body.armature, "viscous": robot.model.damping[i]}
        for what, value in values.items():
            found[f"{joint}_{what}"] = Number(float(value), _unit(what, body.turns))
        if body.parent >= 0:
            found[f"{robot.coordinates[body.parent]}_to_{joint}"] = Number(hypot(*body.placement), "m")
    for mark, (i, offset) in mechanism.marks.items():
        if i >= 0:
            found[f"{robot.coordinates[i]}_to_{mark}"] = Number(hypot(*offset), "m")
    found |= {f"{toe}{RADIUS}": Number(radius, "m") for toe, radius in robot.radii.items()}
    return MappingProxyType({name: number for name, number in found.items() if number.value != 0.0})


def _of_body(body: pin.Inertia, turn: Any, planar: bool) -> dict[str, float]:
    """Returns mass, centre of mass and inertia of a body whose joint's frame is turned at q = 0."""
    lever, tensor = turn @ body.lever, turn @ body.inertia @ turn.T
    if planar:
        return {"mass": body.mass, "com_x": lever[0], "com_z": lever[2], "inertia": tensor[1, 1]}
    values = {"mass": body.mass, **{f"com_{axis}": x for axis, x in zip(AXES, lever, strict=True)}}
    return values | {f"inertia_{axis}{axis}": tensor[k, k] for k, axis in enumerate(AXES)}


def change_bodies(robot: Robot, values: Mapping[str, float]) -> Robot:
    """Returns a robot with other numbers of its bodies, which `variants.vary` has checked.

    Raises:
        BadValue: a body cannot have an inertia, or a number is zero in the robot's equations.
    """
    known = body_numbers(robot)
    model: pin.Model = robot.model.copy()
    radii = dict(robot.radii)
    for name, value in values.items():
        if name not in known:
            raise BadValue(name, value, "a number that is not zero with the robot's other numbers")
        joint, what = _parts(robot, name)
        if (toe := name.removesuffix(RADIUS)) in radii:
            radii[toe] = value
        elif what.startswith("inertia_"):
            _set_inertia(model, int(model.getJointId(joint)), what, name, value)
        elif what:
            _set(model, int(model.getJointId(joint)), what, value, known[name].value)
        else:
            _stretch(robot, model, name, value / known[name].value)
    return robot.with_model(model, settings=replace(robot.settings, radii=radii))


def _unit(what: str, turns: bool) -> str:
    """Returns the unit of a number of a joint, which is another where the joint slides."""
    unit = UNITS[what]
    return unit if turns or what not in ("armature", "viscous") else unit.replace("·m²", "").replace("·rad", "")


def _parts(robot: Robot, name: str) -> tuple[str, str]:
    """Splits a name into joint and quantity, which are empty for a length."""
    for joint in robot.coordinates:
        what = name.removeprefix(f"{joint}_")
        if what in UNITS and what != name:
            return joint, what
    return "", ""


def _set(model: pin.Model, joint: int, what: str, value: float, before: float) -> None:
    row, body = model.joints[joint].idx_v, model.inertias[joint]
    if what == "mass":
        model.inertias[joint] = pin.Inertia(value, body.lever, body.inertia)
    elif what == "inertia":
        model.inertias[joint] = pin.Inertia(body.mass, body.lever, body.inertia * (value / before))
    elif what.startswith("com"):
        turn = _turns(model)[joint]
        lever = turn @ body.lever
        lever[AXES.index(what[-1])] = value
        model.inertias[joint] = pin.Inertia(body.mass, turn.T @ lever, body.inertia)
    else:
        numbers = model.armature if what == "armature" else model.damping
        numbers[row] = value


def _set_inertia(model: pin.Model, joint: int, what: str, name: str, value: float) -> None:
    body, turn, i = model.inertias[joint], _turns(model)[joint], AXES.index(what[-1])
    tensor = turn @ body.inertia @ turn.T
    tensor[i, i] = value
    least, middle, most = np.linalg.eigvalsh(tensor)
    if not least > 0.0 or most > (least + middle) * (1.0 + ROUNDING):
        raise BadValue(name, value, "one that a body can have: no principal moment exceeds the sum of the others")
    model.inertias[joint] = pin.Inertia(body.mass, body.lever, turn.T @ tensor @ turn)


def _turns(model: pin.Model) -> list[Any]:
    """Returns the rotation of each joint's frame at q = 0."""
    data = pin.Data(model)
    pin.forwardKinematics(model, data, pin.neutral(model))
    return [place.rotation for place in data.oMi]


def _stretch(robot: Robot, model: pin.Model, name: str, factor: float) -> None:
    """Scales the distance of a joint, a toe or an end of a loop from the joint on which it hangs."""
    end = next(end for end in (*robot.coordinates, *mechanism_of(robot).marks) if name.endswith(f"_to_{end}"))
    if end in robot.coordinates:
        place = model.jointPlacements[int(model.getJointId(end))]
        place.translation = place.translation * factor
    else:
        frame: Any = model.frames[int(model.getFrameId(end))]
        frame.placement = pin.SE3(frame.placement.rotation, frame.placement.translation * factor)
