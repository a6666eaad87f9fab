"""A robot for dynamics of one's own: unit masses on which the law alone acts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue
from spear_pin.model.cut import STAY
from spear_pin.model.draft import MODEL
from spear_pin.model.robot import Robot

JOINTS: Mapping[str, Callable[[], Any]] = MappingProxyType({"m": pin.JointModelPX, "rad": pin.JointModelRY})


def unit_masses(**units: str) -> Robot:
    """Makes a robot whose equations of motion are v̇ = u: its law is then a vector field of one's own.

    Each coordinate is a mass of 1 kg on a rail, or an inertia of 1 kg·m² on an axle, without gravity, friction and
    toes. A `Reset` changes its state by `jump`.

    Args:
        **units: unit of each coordinate, "m" or "rad", by its name.

    Raises:
        BadValue: a unit is neither, or there is no coordinate.

    Example:
        >>> from spear_pin.model.unit_masses import unit_masses
        >>> unit_masses(theta="rad", phi="rad")
        Robot('unit_masses', nq=2, nv=2, nu=2, toes=[])
    """
    if not units:
        raise BadValue("unit_masses", units, 'a coordinate at least, such as unit_masses(theta="rad")')
    model = pin.Model()
    model.name, model.gravity.linear = "unit_masses", np.zeros(3)
    for name, unit in units.items():
        if unit not in JOINTS:
            raise BadValue(f"unit of {name}", unit, " or ".join(map(repr, JOINTS)))
        joint = model.addJoint(0, JOINTS[unit](), STAY, name)
        inertia = np.eye(3) if unit == "rad" else np.zeros((3, 3))
        model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), inertia), STAY)
    return Robot(model, name=model.name, toes=(), actuated=tuple(units), source=MODEL)
