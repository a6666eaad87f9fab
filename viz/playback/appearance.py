"""Visible parts in a robot's file: form, size, place and colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import pinocchio as pin

Form = Literal["box", "cylinder", "capsule", "sphere", "ellipsoid", "mesh"]
Color = tuple[float, float, float, float]
"""Red, green, blue and alpha, each in 0..1."""


class Undrawn(Exception):
    """Raised for a visible part of a robot that is not drawn.

    Args:
        what: name of the part.
        why: continues the sentence with a reason; may be empty.
    """

    def __init__(self, what: str, why: str = "") -> None:
        super().__init__(what, why)
        self.what, self.why = what, why


@dataclass(frozen=True)
class Shown:
    """A visible part of a body.

    Attributes:
        form: form of the part; cylinders and capsules are along their z.
        size: lengths x, y, z of a box; radius and length of a cylinder, and of a capsule without its ends; radius of a
            sphere; radii of an ellipsoid; in m; scale of a mesh.
        place: pose in the body's frame.
        color: colour; None if the file has none.
        mesh: name of a mesh's file.
    """

    form: Form
    size: tuple[float, ...]
    place: pin.SE3
    color: Color | None = None
    mesh: str = ""
