"""Orientations as MJCF writes them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array

NOTATIONS = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}
"""How many numbers each has."""


def angle_unit(compiler: Mapping[str, str]) -> float:
    """Returns a file's unit of angles, in rad."""
    return 1.0 if compiler.get("angle") == "radian" else math.pi / 180


def rotation(notation: str, values: Sequence[float], compiler: Mapping[str, str]) -> Array:
    """Returns the rotation, (3, 3), that one of `NOTATIONS` means.

    Args:
        notation: name of the attribute.
        values: its numbers.
        compiler: settings of the file: unit and order of angles.

    Raises:
        ValueError: they mean none; the text says why.
    """
    if notation == "euler":
        return _euler(values, compiler.get("eulerseq", "xyz"), angle_unit(compiler))
    vector = np.array(values, dtype=np.float64)
    if notation == "quat":
        w, x, y, z = _unit(notation, vector)
        return np.array(pin.Quaternion(w, x, y, z).matrix())
    if notation == "axisangle":
        return np.array(pin.AngleAxis(values[3] * angle_unit(compiler), _unit(notation, vector[:3])).matrix())
    if notation == "zaxis":
        return np.array(pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), _unit(notation, vector)).matrix())
    x = _unit(notation, vector[:3])
    y = _unit(notation, vector[3:] - (x @ vector[3:]) * x)
    return np.column_stack((x, y, np.cross(x, y)))


def _euler(values: Sequence[float], sequence: str, unit: float) -> Array:
    if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
        raise ValueError(f"has the eulerseq {sequence!r}; expected three of x, y, z, X, Y and Z")
    turned = np.eye(3)
    for letter, angle in zip(sequence, values, strict=True):
        turn = pin.utils.rotate(letter.lower(), angle * unit)
        turned = turned @ turn if letter.islower() else turn @ turned  # capitals: about axes that stay
    return turned


def _unit(notation: str, vector: Array) -> Array:
    if not vector.any():
        raise ValueError(f"{notation} has no axis" if notation != "quat" else "quat is zero")
    return np.asarray(vector / np.linalg.norm(vector))
