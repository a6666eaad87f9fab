"""Checks the `<inertial>` of a link, repairs it on request, and copies it in one notation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, list_names
from spear_pin.model.elements import child, number
from spear_pin.model.origins import copy_origin

ROUNDING = 1e-15  # kg·m²: an error of a principal moment up to this is ignored
# relative to the largest principal moment: how far the least may be below zero, and it above the sum of the others
BELOW, ABOVE = 1e-9, 1e-6
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True)
class Fault:
    """A property of an inertia that no body can have.

    Attributes:
        problem: the problem, in words that follow "an inertia".
        by: size of the violation, in words.
        possible: whether a mass matrix can be computed from it all the same.
    """

    problem: str
    by: str
    possible: bool


def fault_of(matrix: Array) -> Fault | None:
    """Returns the fault of an inertia, (3, 3), in kg·m²; None if a body can have it, up to rounding."""
    least, middle, most = map(float, np.linalg.eigvalsh(matrix))
    if least < -max(ROUNDING, BELOW * most):
        by = f"by a principal moment of {least:.3g} kg·m²"
        return Fault("that is not positive semidefinite", by, possible=False)
    if most - least - middle > max(ROUNDING, ABOVE * most):
        by = f"{most:.3g} > {max(least + middle, 0.0):.3g} kg·m²"
        return Fault("of which one principal moment exceeds the sum of the others", by, possible=True)
    return None


def nearest(matrix: Array) -> Array:
    """Returns the nearest inertia, (3, 3), that a body can have: no second moment, ½ tr(I) - I, is negative."""
    values, axes = np.linalg.eigh(matrix)
    second = np.maximum(0.5 * values.sum() - values, 0.0)
    return np.asarray((axes * (second.sum() - second)) @ axes.T)


def copy_inertial(path: Path, inertial: Any, link: Any, repair: bool) -> Fault | None:
    """Copies an `<inertial>` into a link that this package writes.

    Args:
        path: path of the file.
        inertial: the element.
        link: the element that gets the copy.
        repair: whether to repair an inertia that no body can have.

    Returns:
        the fault of the inertia, repaired or not.

    Raises:
        BadFile: the mass is negative, or the inertia is not positive semidefinite and `repair` is not set.
    """
    name = link.get("name")
    mass = number(path, child(path, inertial, "mass"), "value")
    if mass < 0:
        raise BadFile(path, f"link {name!r} has the negative mass {mass}", inertial.sourceline)
    element = child(path, inertial, "inertia")
    moments = {each: number(path, element, each) for each in MOMENTS}
    xx, xy, xz, yy, yz, zz = moments.values()
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    fault = fault_of(matrix)
    if fault is not None and repair:
        moments = dict(zip(MOMENTS, nearest(matrix)[np.triu_indices(3)].tolist(), strict=True))
    elif fault is not None and not fault.possible:
        problem = f"link {name!r} has an inertia {fault.problem}, {fault.by} (repair=True mends it)"
        raise BadFile(path, problem, element.sourceline)
    part = etree.SubElement(link, "inertial")
    copy_origin(path, inertial, part)
    etree.SubElement(part, "mass", value=repr(mass))
    etree.SubElement(part, "inertia", {each: repr(value) for each, value in moments.items()})
    return fault


def notes_on(faults: Mapping[str, Fault], what: str, repair: bool) -> list[str]:
    """Returns notes on faulty inertias: a line for each repaired one, one line for all that are not repaired.

    Args:
        faults: the faults, by the name of the link or body.
        what: "link" or "body".
        repair: whether they are repaired.
    """
    if repair:
        return [
            f"{what} {name!r} has an inertia {fault.problem}, {fault.by}: mended to the nearest that a body can have"
            for name, fault in faults.items()
        ]
    if not faults:
        return []
    (name, fault), *others = faults.items()
    rest = f", and so have {list_names([repr(each) for each, _ in others])}" if others else ""
    return [f"{what} {name!r} has an inertia {fault.problem}, {fault.by}{rest} (repair=True mends it)"]
