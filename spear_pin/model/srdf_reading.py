"""Reads the SRDF file that goes with a URDF: postures, which reveal where knees bend to, and rotors."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadFile
from spear_pin.model.elements import number, parse
from spear_pin.model.gears import Gear
from spear_pin.model.grammars import SRDF
from spear_pin.model.unread import Unread, find_unread

FLOATING = "root_joint"  # what Pinocchio calls the joint of a floating base


@dataclass(frozen=True)
class Srdf:
    """Contents of an SRDF about a robot.

    Attributes:
        postures: configurations, (nq,), by name.
        gears: rotors of joints, by joint.
        notes: errors and omissions, a line each.
    """

    postures: dict[str, Array]
    gears: dict[str, Gear]
    notes: tuple[str, ...] = ()


def srdf_of(urdf: Path) -> Path | None:
    """Finds the SRDF in a URDF's folder or in a sibling folder "srdf": the one of its name, or the only one."""
    folder = urdf.resolve().parent.parent / "srdf"
    named = [urdf.with_suffix(".srdf"), folder / f"{urdf.stem}.srdf"]
    others = sorted(folder.glob("*.srdf")) if folder.is_dir() else []
    return next((path for path in [*named, *(others if len(others) == 1 else [])] if path.is_file()), None)


def read_srdf(model: pin.Model, urdf: Path) -> Srdf:
    """Reads the SRDF's data on joints of the model with one coordinate; returns no data if the file is wrong.

    Args:
        model: model of the URDF.
        urdf: path of the URDF.
    """
    path = srdf_of(urdf)
    if path is None:
        return Srdf({}, {})
    unread = Unread()
    try:
        path, root = parse(path)
        virtual = {each.get("name") for each in root.iterfind("virtual_joint")} | {FLOATING}
        for each in [each for each in root.iterfind("group_state/joint") if each.get("name") in virtual]:
            each.getparent().remove(each)  # of the base, which stands elsewhere
        postures = {
            state.get("name", ""): _posture(path, model, state, unread) for state in root.iterfind("group_state")
        }
        said: dict[str, set[Gear]] = {}
        for joint in root.iterfind("rotor_params/joint"):
            said.setdefault(joint.get("name", ""), set()).add(_gear(path, joint))
    except BadFile as error:
        return Srdf({}, {}, (f"its SRDF is left out: {error}",))
    find_unread(root, SRDF, unread)
    gears = {}
    for name, (gear, *others) in said.items():
        if others:
            unread.lose("<rotor_params> that disagree", name)
        elif _joint(model, name) is None:
            unread.lose("<rotor_params> of what is no joint of one degree of freedom", name)
        elif gear.ratio == 0 or (gear.rotor or 0.0) < 0:
            unread.lose("<rotor_params> with a ratio of 0 or an inertia below 0", name)
        else:
            gears[name] = gear
    return Srdf(postures, gears, () if unread.line is None else (f"its SRDF {path.name!r}: {unread.line}",))


def _posture(path: Path, model: pin.Model, state: Any, unread: Unread) -> Array:
    q = np.array(pin.neutral(model))
    for each in state.iterfind("joint"):
        joint = _joint(model, each.get("name", ""))
        if joint is None:
            unread.lose("no joint of one degree of freedom:", "", "<group_state>", each.get("name") or "nameless")
            continue
        angle = number(path, each, "value")
        q[joint.idx_q : joint.idx_q + joint.nq] = angle if joint.nq == 1 else (np.cos(angle), np.sin(angle))
    return q


def _gear(path: Path, joint: Any) -> Gear:
    """Returns ratio and rotor of a joint; the format calls the rotor's inertia its mass."""
    ratio, rotor = (
        number(path, joint, name) if joint.get(name) is not None else None for name in ("gear_ratio", "mass")
    )
    return Gear(ratio, rotor)


def _joint(model: pin.Model, name: str) -> Any | None:
    """Returns a joint of one degree of freedom, None if there is no such joint."""
    joint = model.joints[model.getJointId(name)] if model.existJointName(name) else None
    return joint if joint is not None and joint.nv == 1 else None
