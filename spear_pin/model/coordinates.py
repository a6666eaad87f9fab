"""Names of the coordinates of a model, vectors given for them, and whether they move it in a plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, list_names
from spear_pin.model.directions import WORLD_ALIGNED
from spear_pin.model.elements import MAX_NUMBER

# what Pinocchio stores for a joint, by how many numbers it has in q and v; others are numbered
CONFIGURATION = {2: ("cos", "sin"), 7: ("x", "y", "z", "qx", "qy", "qz", "qw")}
VELOCITY = {6: ("vx", "vy", "vz", "wx", "wy", "wz")}
OUT_OF_PLANE = 1e-5  # rad or m per unit of a coordinate: a URDF's "1.5708" is a right angle


def vector_of(name: str, value: ArrayLike, length: int, coordinates: Sequence[str]) -> Array:
    """Returns numbers that are given for coordinates, (length,), as float64.

    Raises:
        BadValue: they are of another shape, no numbers, not finite, or far too large.
    """
    expected = f"{length} numbers ({list_names(coordinates, 8)})"
    try:
        given = np.asarray(value)
    except (TypeError, ValueError):
        raise BadValue(name, value, expected) from None
    if given.dtype.kind not in "fiu":
        raise BadValue(name, value, expected)
    if given.shape != (length,):
        raise BadValue(name, value, f"{expected}, not the shape {given.shape}")
    vector = given.astype(np.float64)
    valid = np.abs(vector) <= MAX_NUMBER  # what follows from it is finite, too
    if not valid.all():
        index = int(np.flatnonzero(~valid)[0])
        limited = "a finite number" + (f" within ±{MAX_NUMBER:g}" if np.isfinite(vector[index]) else "")
        raise BadValue(f"{name}[{index}]", float(vector[index]), limited)
    return vector


def parts_of(name: str, count: int, parts: Mapping[int, Sequence[str]]) -> list[str]:
    """Returns the names of the numbers of a joint."""
    return [name] if count == 1 else [f"{name}_{part}" for part in parts.get(count, range(count))]


def is_planar(model: pin.Model, data: pin.Data) -> bool:
    """Tells whether no joint can move any body out of the x-z plane, in any configuration."""
    if model.nv == 0:
        return False
    rng = np.random.default_rng(0)
    for _ in range(3):
        q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
        pin.computeJointJacobians(model, data, q)
        for joint in range(1, model.njoints):
            jacobian = pin.getJointJacobian(model, data, joint, WORLD_ALIGNED)
            if np.abs(jacobian[[1, 3, 5]]).max() > OUT_OF_PLANE:
                return False
    return True
