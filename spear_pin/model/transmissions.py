"""The motors that a URDF declares, by `<transmission>` or by `<ros2_control>`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spear_pin.errors import BadFile
from spear_pin.model.elements import number, optional, parse_number

COMMANDS = ("effort", "position", "velocity", "acceleration")  # interfaces of ros2_control that move a joint


@dataclass(frozen=True)
class Transmission:
    """One motor on one joint.

    Attributes:
        joint: name of the driven joint.
        gear_ratio: rotor turns per joint turn, N.
        rotor_inertia: inertia of the rotor at the rotor, J, in kg·m².
    """

    joint: str
    gear_ratio: float = 1.0
    rotor_inertia: float = 0.0

    @property
    def reflected_inertia(self) -> float:
        """N² J at the joint, in kg·m² (what (3.12)-(3.13) add to the kinetic energy)."""
        return self.gear_ratio**2 * self.rotor_inertia


def read_transmissions(path: Path, root: Any) -> tuple[tuple[Transmission, ...], tuple[str, ...]]:
    """The motors of a URDF, and a line about each that is left out.

    A transmission is left out if it is none from one motor to one joint that moves, or its reduction is no number. A
    joint that `<ros2_control>` commands has a motor; its gear is that of the transmission there.

    Raises:
        BadFile: a gear ratio is zero, or one number contradicts another, or a rotor's inertia is negative.
    """
    kinds = {joint.get("name"): joint.get("type") for joint in root.findall("joint")}
    found: dict[str, Transmission] = {}
    notes: list[str] = []
    controls = root.findall("ros2_control")
    plain = root.findall("transmission")
    for element in (*plain, *(element for each in controls for element in each.findall("transmission"))):
        problem = _misfit(element, kinds) or _no_number(element)
        joint = element.find("joint").get("name") if problem is None else None
        if joint in found and element in plain:
            problem = f"joint {joint!r} has two, and the first is taken"
        if problem is not None:
            notes.append(f"transmission {element.get('name')!r} is left out: {problem}")
        elif joint not in found:
            found[str(joint)] = _transmission(path, element, str(joint))
    for joint in (joint for each in controls for joint in _commanded(each)):
        if kinds.get(joint, "fixed") == "fixed":
            notes.append(f"<ros2_control> commands {joint!r}, which is no joint that moves: it is left out")
        else:
            found.setdefault(joint, Transmission(joint))
    return tuple(found.values()), tuple(dict.fromkeys(notes))


def _misfit(element: Any, kinds: Mapping[str, str]) -> str | None:
    """Why a transmission is none from one motor to one joint."""
    for tag in ("joint", "actuator"):
        if len(element.findall(tag)) != 1:
            return f"it has {len(element.findall(tag)) or 'no'} <{tag}>, and one is supported"
    joint = element.find("joint").get("name")
    if kinds.get(joint, "fixed") == "fixed":
        movable = ", ".join(name for name, kind in kinds.items() if kind != "fixed")
        state = "is fixed" if joint in kinds else "is not there"
        return f"it drives the joint {joint!r}, which {state}; valid: {movable or 'none'}"
    return None


def _reduction(element: Any) -> Any | None:
    """The element that says a transmission's ratio: of ROS 1 the actuator has it, of ros2_control first the joint."""
    later = element.getparent().tag == "ros2_control"
    for place in ("joint", "actuator") if later else ("actuator",):
        for tag in ("mechanical_reduction", "mechanicalReduction") if later else ("mechanicalReduction",):
            found = element.find(f"{place}/{{*}}{tag}")
            if found is not None:
                return found
    return None


def _no_number(element: Any) -> str | None:
    reduction = _reduction(element)
    if reduction is None:
        return None
    try:
        float(reduction.text or "")
    except ValueError:
        return f"its <{reduction.tag}> is {reduction.text or ''!r}, not a number"
    return None


def _transmission(path: Path, element: Any, joint: str) -> Transmission:
    actuator = element.find("actuator")
    found = _reduction(element)
    reduction = None if found is None else parse_number(path, found, found.text)
    ratio = optional(actuator, "gear_ratio", lambda e: number(path, e, "value"))
    rotor = optional(actuator, "rotor_inertia", lambda e: number(path, e, "value"))
    if ratio is not None and reduction is not None and ratio != reduction:
        problem = f"joint {joint!r}: mechanicalReduction {reduction:g} disagrees with gear_ratio {ratio:g}"
        raise BadFile(path, problem, element.sourceline)
    gear = ratio if ratio is not None else reduction if reduction is not None else 1.0
    if gear == 0 or (rotor is not None and rotor < 0):
        problem = f"joint {joint!r}: gear ratio {gear:g}, rotor inertia {rotor}; expected nonzero and >= 0"
        raise BadFile(path, problem, element.sourceline)
    return Transmission(joint, gear, rotor or 0.0)


def _commanded(control: Any) -> list[str]:
    """Names of the joints that a `<ros2_control>` moves."""
    return [
        joint.get("name", "")
        for joint in control.findall("joint")
        if any(interface.get("name") in COMMANDS for interface in joint.findall("command_interface"))
    ]
