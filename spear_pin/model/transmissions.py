"""The motors that a URDF declares, by `<transmission>` or by `<ros2_control>`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from spear_pin.errors import list_names
from spear_pin.model.elements import fault, parse_number
from spear_pin.model.gears import Gear

COMMANDS = ("effort", "position", "velocity", "acceleration")  # interfaces of ros2_control that move a joint
RATIOS = ("gear_ratio", "gearRatio", "mechanicalReduction", "mechanical_reduction")
ROTORS = ("rotor_inertia", "rotorInertia", "motorInertia", "motor_inertia")


@dataclass(frozen=True)
class Motors:
    """The motors of a URDF.

    Attributes:
        gears: the gears, by joint.
        notes: omissions, a line each.
        elements: elements of the file that are read or reported here.
    """

    gears: Mapping[str, Gear]
    notes: tuple[str, ...]
    elements: tuple[Any, ...]


def read_transmissions(path: Path, root: Any) -> Motors:
    """Reads the motors of a URDF.

    A transmission is left out unless it leads from one motor to one moving joint and its reduction is a number. A joint
    that `<ros2_control>` commands has a motor, with the gear of its transmission there. Ratio and rotor may be given in
    the transmission, in its joint, in its actuator, or in the joint that it drives.

    Raises:
        BadFile: a gear ratio is zero, or one number contradicts another, or a rotor's inertia is negative.
    """
    joints = {joint.get("name"): joint for joint in root.findall("joint")}
    kinds = {name: joint.get("type") for name, joint in joints.items()}
    found: dict[str, Gear] = {}
    notes: list[str] = []
    elements: list[Any] = []
    controls = root.findall("ros2_control")
    plain = root.findall("transmission")
    for element in (*plain, *(element for each in controls for element in each.findall("transmission"))):
        problem = _misfit(element, kinds)
        joint = element.find("joint").get("name") if problem is None else None
        numbers = _numbers(element, joints[joint]) if joint is not None else []
        problem = problem or _no_number(numbers)
        gear = _gear(path, element, numbers, joint) if joint is not None and problem is None else None
        if joint in found and (element in plain or found[joint] != gear):
            problem = f"joint {joint!r} has two, and the first is taken"
        if problem is not None:
            notes.append(f"transmission {element.get('name')!r} is left out: {problem}")
            elements.append(element)
        else:
            elements += numbers
            found.setdefault(str(joint), gear or Gear())
    for joint in (joint for each in controls for joint in _commanded(each)):
        if kinds.get(joint, "fixed") == "fixed":
            notes.append(f"<ros2_control> commands {joint!r}, which is no joint that moves: it is left out")
        else:
            found.setdefault(joint, Gear())
    return Motors(found, tuple(dict.fromkeys(notes)), tuple(elements))


def _misfit(element: Any, kinds: Mapping[str, str]) -> str | None:
    """Returns why a transmission does not lead from one motor to one joint, None if it does."""
    for tag in ("joint", "actuator"):
        if len(element.findall(tag)) != 1:
            return f"it has {len(element.findall(tag)) or 'no'} <{tag}>, and one is supported"
    joint = element.find("joint").get("name")
    if kinds.get(joint, "fixed") == "fixed":
        movable = list_names([name for name, kind in kinds.items() if kind != "fixed"])
        state = "is fixed" if joint in kinds else "is not there"
        return f"it drives the joint {joint!r}, which {state}; valid: {movable or 'none'}"
    return None


def _numbers(element: Any, joint: Any) -> list[Any]:
    """Returns the elements that give ratio or rotor, for any namespace of their tags."""
    places = (element.find("joint"), element.find("actuator"), element, joint)
    return [
        each
        for place in places
        for each in place.iterchildren(etree.Element)
        if etree.QName(each).localname in (*RATIOS, *ROTORS)
    ]


def _text(element: Any) -> str | None:
    """Returns a number that is an attribute or a text, as both are in use."""
    return element.get("value") or (element.text or "").strip() or None


def _no_number(numbers: list[Any]) -> str | None:
    for element in _named(numbers, RATIOS):
        try:
            float(_text(element) or "")
        except ValueError:
            return f"its <{etree.QName(element).localname}> is {_text(element) or ''!r}, not a number"
    return None


def _named(numbers: list[Any], names: tuple[str, ...]) -> list[Any]:
    return [element for element in numbers if etree.QName(element).localname in names]


def _gear(path: Path, element: Any, numbers: list[Any], joint: str) -> Gear:
    ratio, rotor = (_agreed(path, _named(numbers, names), joint) for names in (RATIOS, ROTORS))
    if ratio == 0 or (rotor is not None and rotor < 0):
        wrong = "gear ratio 0; expected another than 0" if ratio == 0 else f"rotor inertia {rotor:g}; expected >= 0"
        raise fault(path, element, f"joint {joint!r}: {wrong}")
    return Gear(ratio, rotor)


def _agreed(path: Path, elements: list[Any], joint: str) -> float | None:
    """Returns the number that the elements agree on, None if there are no elements."""
    said = [(etree.QName(each).localname, parse_number(path, each, _text(each))) for each in elements]
    for name, value in said[1:]:
        if value != said[0][1]:
            problem = f"joint {joint!r}: {said[0][0]} {said[0][1]:g} disagrees with {name} {value:g}; make them equal"
            raise fault(path, elements[0].getparent(), problem)
    return said[0][1] if said else None


def _commanded(control: Any) -> list[str]:
    """Returns the names of the joints that a `<ros2_control>` moves."""
    return [
        joint.get("name", "")
        for joint in control.findall("joint")
        if any(interface.get("name") in COMMANDS for interface in joint.findall("command_interface"))
    ]
