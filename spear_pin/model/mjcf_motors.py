"""The actuators of an MJCF file that are motors of joints."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from spear_pin.model.elements import fault, parse_limit, parse_number
from spear_pin.model.mjcf_sections import Defaults, section
from spear_pin.model.mjcf_writing import Rubbing

MOVABLE = ("hinge", "slide")
TORQUES = ("motor", "general")  # actuators of which the control is a torque, or told otherwise


@dataclass(frozen=True)
class DrivenJoint:
    """An actuator of one joint.

    Attributes:
        joint: name of the joint.
        gear: joint torque per torque of the actuator; None where nothing says it.
        effort: the largest torque at the joint, in N·m (N, if it slides).
    """

    joint: str
    gear: float | None = None
    effort: float = inf


@dataclass(frozen=True)
class Drives:
    """The actuators of a file.

    Attributes:
        motors: those that are motors of joints.
        rubbing: what all of them add to the joints that they act on, by joint.
        others: names of those that are no motors.
        damped: joints with damping of an actuator that is not viscous.
        laws: tags of the motors that are more than a torque, such as "position", by joint.
        elements: of the others, and of those with a law.
    """

    motors: tuple[DrivenJoint, ...]
    rubbing: Mapping[str, Rubbing]
    others: tuple[str, ...]
    damped: tuple[str, ...]
    laws: Mapping[str, str]
    elements: tuple[Any, ...]


def read_drives(
    path: Path, root: Any, defaults: Defaults, joints: Mapping[str, str], named: Collection[str], autolimits: bool
) -> Drives:
    """Read the actuators. An armature and a damping of one act at its joint times the square of its gear.

    Args:
        path: of the file.
        root: its element.
        defaults: of the file.
        joints: types of the robot's joints, by name.
        named: names of all joints of the file.
        autolimits: whether a range alone limits.

    Raises:
        BadFile: an actuator acts on a joint that is not there, or its numbers are too many or too few, or negative.
    """
    found: dict[str, DrivenJoint] = {}
    rubbing: dict[str, Rubbing] = {}
    laws: dict[str, str] = {}
    others, damped, elements = [], [], []
    for element in section(root, "actuator"):
        said = defaults.of(element)
        joint = said.get("joint", said.get("jointinparent"))
        if joint is not None and joint not in named:
            problem = f"<{element.tag}> acts on the joint {joint!r}, which is not there"
            raise fault(path, element, f"{problem}; valid: {', '.join(joints) or 'none'}")
        gear = _values(path, element, said["gear"])[0] if "gear" in said else None
        square = 1.0 if gear is None else gear * gear
        movable = joints.get(joint or "") in MOVABLE
        if joint is not None and movable:
            had, own = rubbing.get(joint, Rubbing(None, 0.0)), _rubbing(path, element, said)
            armatures = [each for each in (had.armature, own.armature and square * own.armature) if each is not None]
            rubbing[joint] = Rubbing(sum(armatures) if armatures else None, had.damping + square * own.damping)
            if any(_values(path, element, said.get("damping", "0"))[1:]):
                damped.append(joint)
        if not movable or joint in found or gear == 0.0:
            others.append(element.get("name") or f"a {element.tag}")
            elements.append(element)
        else:
            effort = (1.0 if gear is None else abs(gear)) * _largest(path, element, said, autolimits)
            found[str(joint)] = DrivenJoint(str(joint), gear, effort)
            if element.tag not in TORQUES:
                laws[str(joint)] = element.tag
                elements.append(element)
    return Drives(tuple(found.values()), rubbing, tuple(others), tuple(damped), laws, tuple(elements))


def _rubbing(path: Path, element: Any, said: Mapping[str, str]) -> Rubbing:
    """Armature and damping of an actuator, before its gear."""
    numbers = {
        name: _values(path, element, said[name])[0] if name in said else None for name in ("armature", "damping")
    }
    for name, value in numbers.items():
        if value is not None and value < 0:
            raise fault(path, element, f"<{element.tag}> has the {name} {value:g}; expected a number >= 0")
    return Rubbing(numbers["armature"], numbers["damping"] or 0.0)


def _largest(path: Path, element: Any, said: Mapping[str, str], autolimits: bool) -> float:
    """The largest force of an actuator, before its gear."""
    gain = _gain(path, element, said)
    limits = [inf]
    for limited, name, factor in (("forcelimited", "forcerange", 1.0), ("ctrllimited", "ctrlrange", gain)):
        if (
            factor is not None
            and name in said
            and said.get(limited, "auto") in ("true", "auto" if autolimits else "true")
        ):
            ends = [parse_limit(path, element, part) for part in said[name].split()]
            if len(ends) != 2:
                problem = f"{name} of <{element.tag}> is {said[name]!r}; expected 2 numbers"
                raise fault(path, element, problem)
            limits.append(factor * max(map(abs, ends)))
    return min(limits)


def _gain(path: Path, element: Any, said: Mapping[str, str]) -> float | None:
    """Force for each unit of the control; None where the control is no force."""
    if element.tag == "motor":
        return 1.0
    plain = {said.get("gaintype", "fixed"), said.get("biastype", "none"), said.get("dyntype", "none")} == {
        "fixed",
        "none",
    }
    if element.tag == "general" and plain:
        return abs(_values(path, element, said.get("gainprm", "1"))[0])
    return None


def _values(path: Path, element: Any, text: str) -> list[float]:
    return [parse_number(path, element, part) for part in text.split() or [""]]
