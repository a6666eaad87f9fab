"""Something that a robot's file shows, as it says it: form, size, place and colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import pinocchio as pin

Form = Literal["box", "cylinder", "capsule", "sphere", "ellipsoid", "mesh"]
Color = tuple[float, float, float, float]
"""Red, green, blue and alpha, each in 0..1."""


class Undrawn(Exception):
    """Something of a robot's look that is not drawn.

    Args:
        what: names it.
        why: goes on with a reason; may be empty.
    """

    def __init__(self, what: str, why: str = "") -> None:
        super().__init__(what, why)
        self.what, self.why = what, why


@dataclass(frozen=True)
class Shown:
    """Something that a body shows.

    Attributes:
        form: what it is; cylinders and capsules are along their z.
        size: lengths x, y, z of a box; radius and length of a cylinder, and of a capsule without its ends; radius of a
            sphere; radii of an ellipsoid; in m; scale of a mesh.
        place: in the body's frame.
        color: None if the file has none.
        mesh: name of a mesh's file.
    """

    form: Form
    size: tuple[float, ...]
    place: pin.SE3
    color: Color | None = None
    mesh: str = ""
