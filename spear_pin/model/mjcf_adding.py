"""Elements of an MJCF file that is written."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree
from numpy.typing import ArrayLike

UNTOUCHED = {"contype": "0", "conaffinity": "0", "group": "2"}


def place(placement: pin.SE3) -> dict[str, str]:
    """Returns the attributes of a place that is not that of the parent."""
    x, y, z, w = pin.Quaternion(placement.rotation).coeffs()
    found = {"pos": numbers(placement.translation)} if np.any(placement.translation) else {}
    return found | ({"quat": numbers((w, x, y, z))} if any((x, y, z)) else {})


def add(parent: Any, tag: str, **attributes: str | ArrayLike) -> Any:
    """Adds a new element, with numbers written in full."""
    texts = {name: value if isinstance(value, str) else numbers(value) for name, value in attributes.items()}
    return etree.SubElement(parent, tag, texts)


def numbers(values: ArrayLike) -> str:
    """Writes numbers in full."""
    return " ".join(repr(float(value)) for value in np.ravel(np.asarray(values)))
