"""The actuators of an MJCF file that are motors of joints."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from spear_pin.errors import listed
from spear_pin.model.elements import fault, parse_number
from spear_pin.model.mjcf_sections import Defaults, section

MOVABLE = ("hinge", "slide")


@dataclass(frozen=True)
class DrivenJoint:
    """An actuator of one joint.

    Attributes:
        joint: name of the joint.
        gear: joint torque per torque of the actuator.
        effort: the largest torque at the joint, in N·m (N, if it slides).
    """

    joint: str
    gear: float = 1.0
    effort: float = inf


def read_drives(
    path: Path, root: Any, defaults: Defaults, joints: Mapping[str, str], named: Collection[str], autolimits: bool
) -> tuple[tuple[DrivenJoint, ...], list[str]]:
    """The motors of joints, and what is said of the other actuators.

    Args:
        path: of the file.
        root: its element.
        defaults: of the file.
        joints: types of the robot's joints, by name.
        named: names of all joints of the file.
        autolimits: whether a range alone limits.

    Raises:
        BadFile: an actuator acts on a joint that is not there, or its numbers are too many or too few.
    """
    found: dict[str, DrivenJoint] = {}
    others = []
    for element in section(root, "actuator"):
        said = defaults.of(element)
        joint = said.get("joint", said.get("jointinparent"))
        if joint is not None and joint not in named:
            problem = f"<{element.tag}> acts on the joint {joint!r}, which is not there"
            raise fault(path, element, f"{problem}; valid: {', '.join(joints) or 'none'}")
        gear = _values(path, element, said.get("gear", "1"))[0]
        if joints.get(joint or "") not in MOVABLE or joint in found or gear == 0.0:
            others.append(element.get("name") or f"a {element.tag}")
        else:
            effort = abs(gear) * _largest(path, element, said, autolimits)
            found[str(joint)] = DrivenJoint(str(joint), gear, effort)
    return tuple(found.values()), [f"actuators other than one for each joint, {listed(others)}"] if others else []


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
            ends = _values(path, element, said[name])
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
