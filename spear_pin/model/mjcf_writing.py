"""State of the writing of one tree of MJCF bodies, which copies checked numbers and rotations into it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadFile
from spear_pin.model.elements import fault, name_element, parse_number
from spear_pin.model.inertial import Fault
from spear_pin.model.mjcf_rotations import rotation
from spear_pin.model.mjcf_sections import Defaults
from spear_pin.model.unread import Unread

TURNS = ("quat", "axisangle", "xyaxes", "zaxis", "euler")  # notations of a rotation
PLACE = ("pos", *TURNS)
# how many numbers an attribute has, where that is not free
COUNTS = {
    **{"pos": 3, "quat": 4, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "euler": 3, "axis": 3, "fromto": 6},
    **{"mass": 1, "density": 1, "diaginertia": 3, "fullinertia": 6, "range": 2, "actuatorfrcrange": 2, "ref": 1},
    **{"inertiagrouprange": 2, "group": 1, "anchor": 3},
}
SHORTEST = 1e-14  # of directions and quaternions: MuJoCo refuses shorter ones


class Rubbing(NamedTuple):
    """Armature of a joint, in kg·m², None where nothing says it, and its damping, in N·m·s/rad."""

    armature: float | None = None
    damping: float = 0.0

    def joined(self, other: Rubbing, square: float = 1.0) -> Rubbing:
        """Returns the sum of this and another, which acts through a gear whose square is given."""
        armature = self.armature
        if other.armature is not None:
            armature = (armature or 0.0) + square * other.armature
        return Rubbing(armature, self.damping + square * other.damping)


@dataclass
class Writing:
    """State of the writing of a tree of bodies.

    Attributes:
        path: path of the file that is read.
        root: its element.
        defaults: defaults of the file.
        compiler: its settings.
        repair: whether inertias that no body can have are mended.
        taken: names of bodies and sites.
        jointed: names of joints, which may be those of bodies.
        joints: types of joints that are written, by name.
        rubbing: armature and damping of joints, by name.
        elements: elements of the joints that are written, by name.
        unread: data that are not used.
        faults: faults of inertias, by the names of their bodies.
        geoms: attributes of geoms, with the names of their bodies.
        inside: names of geoms of which the middle is no end of a limb.
        bodies: number of bodies that are written.
    """

    path: Path
    root: Any
    defaults: Defaults
    compiler: Mapping[str, str]
    repair: bool
    taken: set[str]
    jointed: set[str]
    joints: dict[str, str] = field(default_factory=dict)
    rubbing: dict[str, Rubbing] = field(default_factory=dict)
    elements: dict[str, Any] = field(default_factory=dict)
    unread: Unread = field(default_factory=Unread)
    faults: dict[str, Fault] = field(default_factory=dict)
    geoms: list[tuple[str, Mapping[str, str]]] = field(default_factory=list)
    inside: set[str] = field(default_factory=set)
    bodies: int = 0

    @property
    def autolimits(self) -> bool:
        """Tells whether a range alone limits."""
        return self.compiler.get("autolimits", "auto") in ("auto", "true")

    def name(self, wanted: str, joint: bool = False) -> str:
        """Returns a name that no other body, or joint, has."""
        taken = self.jointed if joint else self.taken
        while wanted in taken:
            wanted += str(len(taken)) if wanted.endswith("__") else "_"  # of thousands alike, none gets long
        taken.add(wanted)
        return wanted

    def fault(self, element: Any, problem: str) -> BadFile:
        """Returns an error at an element."""
        return fault(self.path, element, problem)

    def copy(self, element: Any, to: Any, said: Mapping[str, str], attributes: Iterable[str]) -> None:
        """Copies attributes that are numbers, rotations as quaternions where Pinocchio reads them unlike MuJoCo.

        Args:
            element: element that has the attributes, which errors name.
            to: the element that gets them.
            said: attributes of the element, those of its class among them.
            attributes: names of those that are wanted.

        Raises:
            BadFile: numbers are too few or too many, a rotation is none, or the element has two.
        """
        turns = [each for each in TURNS if each in element.attrib]
        if len(turns) > 1:
            raise self.fault(element, f"{name_element(element)} has {' and '.join(turns)}; one of them is valid")
        for attribute in attributes:
            if attribute in said:
                numbers = self.counted(element, said, attribute)
                if attribute in TURNS:
                    self._check_turn(element, attribute, numbers)
                if attribute in ("euler", "axisangle"):
                    numbers, attribute = self._quaternion(attribute, numbers), "quat"
                to.set(attribute, " ".join(map(repr, numbers)))

    def _check_turn(self, element: Any, notation: str, numbers: Sequence[float]) -> None:
        """Refuses a rotation without a direction."""
        if notation == "euler":
            return
        two = notation == "xyaxes"
        directed = np.cross(numbers[:3], numbers[3:]) if two else numbers[: 4 if notation == "quat" else 3]
        if np.linalg.norm(directed) < SHORTEST:
            text, expected = " ".join(f"{number:g}" for number in numbers), "two directions" if two else "one"
            raise self.fault(
                element, f"{notation} of {name_element(element)} is {text!r}, no direction; expected {expected}"
            )

    def _quaternion(self, notation: str, values: Sequence[float]) -> tuple[float, ...]:
        """Returns (w, x, y, z) of a rotation; Pinocchio reads Euler sequences in capitals and long axes differently."""
        try:
            turned = rotation(notation, values, self.compiler)
        except ValueError as error:
            raise BadFile(self.path, str(error)) from None
        x, y, z, w = map(float, pin.Quaternion(turned).coeffs())
        return w, x, y, z

    def counted(self, element: Any, said: Mapping[str, str], attribute: str) -> tuple[float, ...]:
        """Returns the numbers of an attribute, as many as it has to have."""
        numbers = self.values(element, said[attribute])
        if len(numbers) != COUNTS.get(attribute, len(numbers)):
            what = f"{attribute} of {name_element(element)} is {said[attribute]!r}"
            raise self.fault(element, f"{what}; expected {COUNTS[attribute]} numbers")
        return numbers

    def read_rubbing(self, element: Any, said: Mapping[str, str], name: str) -> Rubbing:
        """Returns the armature and the damping of a joint or an actuator; for the arguments see `at_least_zero`."""
        armature, damping = (self.at_least_zero(element, said, each, name) for each in ("armature", "damping"))
        return Rubbing(armature if "armature" in said else None, damping)

    def at_least_zero(self, element: Any, said: Mapping[str, str], attribute: str, name: str) -> float:
        """Returns the first number of an attribute, zero if it is not given.

        Args:
            element: element that has the attribute.
            said: attributes of the element, those of its class among them.
            attribute: name of the attribute.
            name: name of the element in errors, such as "joint 'knee'".

        Raises:
            BadFile: the number is negative, or the text is no number.
        """
        value = self.values(element, said.get(attribute, "0"))[0]
        if value < 0:
            raise self.fault(element, f"{name} has the {attribute} {value:g}; expected a number >= 0")
        return value

    def values(self, element: Any, text: str) -> tuple[float, ...]:
        """Returns the numbers of an attribute, one at least."""
        return tuple(parse_number(self.path, element, part) for part in text.split() or [""])
