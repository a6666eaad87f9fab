"""The actuators of an MJCF file that are motors of joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

from spear_pin.model.elements import name_element, parse_limit
from spear_pin.model.mjcf_sections import section
from spear_pin.model.mjcf_writing import Writing

LIMITED = {  # attributes that say whether a range limits
    **{"range": "limited", "actuatorfrcrange": "actuatorfrclimited"},
    **{"forcerange": "forcelimited", "ctrlrange": "ctrllimited"},
}
MOVABLE = ("hinge", "slide")
ACTED_ON = ("joint", "jointinparent", "tendon", "site", "slidersite", "body", "cranksite")
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
        motors: actuators that are motors of joints.
        unread: data that are not used, in words, with the names of joints or actuators.
        elements: elements of the actuators that are no motors, and of those that are more than a torque.
    """

    motors: tuple[DrivenJoint, ...]
    unread: tuple[tuple[str, str], ...]
    elements: tuple[Any, ...]


def read_drives(writing: Writing) -> Drives:
    """Reads the actuators.

    Args:
        writing: state, with the robot's joints, to which armature and damping are added, times the square of the gear.

    Raises:
        BadFile: an actuator acts on a joint that is not there, or its numbers are too many or too few, or negative.
    """
    found: dict[str, DrivenJoint] = {}
    laws, uneven, others, damped, elements = [], [], [], [], []
    for element in section(writing.root, "actuator"):
        said = writing.defaults.of(element)
        joint = said.get("joint", said.get("jointinparent"))
        if joint is not None and joint not in writing.jointed:
            problem = f"<{element.tag}> acts on the joint {joint!r}, which is not there"
            raise writing.fault(element, f"{problem}; valid: {', '.join(writing.joints) or 'none'}")
        gear = writing.values(element, said["gear"])[0] if "gear" in said else None
        square = 1.0 if gear is None else gear * gear
        movable = writing.joints.get(joint or "") in MOVABLE
        if joint is not None and movable:
            own = writing.read_rubbing(element, said, name_element(element))
            writing.rubbing[joint] = writing.rubbing[joint].joined(own, square)
            if any(writing.values(element, said.get("damping", "0"))[1:]):
                damped.append(("damping that is not viscous", joint))
        if not movable or joint in found or gear == 0.0:
            name = element.get("name") or _described(element, said)
            others.append(("actuators other than one for each joint", name))
            elements.append(element)
        else:
            largest, told = _largest(writing, element, said)
            uneven += [(what, str(joint)) for what in told]
            found[str(joint)] = DrivenJoint(str(joint), gear, (1.0 if gear is None else abs(gear)) * largest)
            if element.tag not in TORQUES:
                laws.append((f"the control law of <{element.tag}>", str(joint)))
                elements.append(element)
    return Drives(tuple(found.values()), (*laws, *uneven, *others, *damped), tuple(elements))


def is_limited(writing: Writing, element: Any, said: Mapping[str, str], name: str) -> bool:
    """Tells whether a range limits.

    Args:
        writing: state.
        element: element that has the range.
        said: attributes of the element, with those of its class.
        name: name of the range, a key of `LIMITED`.

    Raises:
        BadFile: there is a range and nothing says whether it limits, which MuJoCo refuses.
    """
    limited, text = said.get(LIMITED[name], "auto"), said.get(name, "")
    silent = limited == "auto" and not writing.autolimits
    if silent and any(parse_limit(writing.path, element, part) for part in text.split()):
        problem = f'{name_element(element)} has the {name} {text!r}, and no {LIMITED[name]} beside autolimits="false"'
        raise writing.fault(element, f'{problem}; expected {LIMITED[name]}="true" or "false"')
    return name in said and not silent and limited in ("true", "auto")


def ends_of(writing: Writing, element: Any, said: Mapping[str, str], name: str) -> tuple[float, float]:
    """Returns the ends of a range, infinite where they mean that there is no limit."""
    ends = [parse_limit(writing.path, element, part) for part in said[name].split()]
    if len(ends) != 2:
        raise writing.fault(element, f"{name} of {name_element(element)} is {said[name]!r}; expected 2 numbers")
    return ends[0], ends[1]


def either_way(ends: Sequence[float]) -> tuple[float, str | None]:
    """Returns the force that a range allows in both directions, and in words the unused part of the range.

    A range that allows no force in one direction is taken as if it allowed the larger one in both.
    """
    low, high = ends
    smaller, larger = sorted((abs(low), abs(high)))
    if low < 0 < high:
        return smaller, None if smaller == larger else "the larger side"
    return larger, "the sign" if larger else None


def _described(element: Any, said: Mapping[str, str]) -> str:
    """Describes an actuator without a name by the element on which it acts."""
    return f"{element.tag} of {next((said[each] for each in ACTED_ON if each in said), 'nothing')}"


def _largest(writing: Writing, element: Any, said: Mapping[str, str]) -> tuple[float, list[str]]:
    """Returns an actuator's largest force in either direction, before its gear, and the unused parts of its ranges."""
    gain = _gain(writing, element, said)
    limits, uneven = [inf], []
    for name, factor in (("forcerange", 1.0), ("ctrlrange", gain)):
        if is_limited(writing, element, said, name) and factor is not None:
            force, told = either_way(ends_of(writing, element, said, name))
            limits.append(factor * force)
            uneven += [f"{told} of {name}"] if told else []
    return min(limits), uneven


def _gain(writing: Writing, element: Any, said: Mapping[str, str]) -> float | None:
    """Returns the force for each unit of the control; None if the control is no force."""
    if element.tag == "motor":
        return 1.0
    plain = {said.get("gaintype", "fixed"), said.get("biastype", "none"), said.get("dyntype", "none")} == {
        "fixed",
        "none",
    }
    if element.tag == "general" and plain:
        return abs(writing.values(element, said.get("gainprm", "1"))[0])
    return None
