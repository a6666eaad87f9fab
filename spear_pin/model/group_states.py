"""Postures of the SRDF file that goes with a URDF: of a knee that can bend both ways they tell to which it does."""

from __future__ import annotations

from pathlib import Path

import pinocchio as pin

from spear_pin.errors import BadFile
from spear_pin.model.elements import parse, parse_number


def srdf_of(urdf: Path) -> Path | None:
    """The SRDF beside a URDF, or in the folder "srdf" beside its folder: of its name, or the only one there."""
    folder = urdf.resolve().parent.parent / "srdf"
    named = [urdf.with_suffix(".srdf"), folder / f"{urdf.stem}.srdf"]
    others = sorted(folder.glob("*.srdf")) if folder.is_dir() else []
    return next((path for path in [*named, *(others if len(others) == 1 else [])] if path.is_file()), None)


def add_postures(model: pin.Model, urdf: Path) -> list[str]:
    """Take the SRDF's postures into `model.referenceConfigurations`: joints that the model has, of one coordinate each.

    Args:
        model: of the URDF.
        urdf: its path.

    Returns:
        what is wrong with the SRDF, a line; nothing is taken then.
    """
    path = srdf_of(urdf)
    if path is None:
        return []
    postures = {}
    try:
        path, root = parse(path)
        for state in root.iterfind("group_state"):
            q = pin.neutral(model)
            for each in state.iterfind("joint"):
                joint = (
                    model.joints[model.getJointId(name)] if model.existJointName(name := each.get("name", "")) else None
                )
                if joint is not None and joint.nq == 1:
                    q[joint.idx_q] = parse_number(path, each, each.get("value"))
            postures[state.get("name", "")] = q
    except BadFile as error:
        return [f"its SRDF is left out: {error}"]
    for name, q in postures.items():
        model.referenceConfigurations[name] = q
    return []
