"""Legs by the names of their joints, as files give them, and the corresponding legs of a model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

from spear_pin.errors import BadValue
from spear_pin.model.frames import frame_id, joint_id
from spear_pin.model.legs import Leg, leg_along, side_of
from spear_pin.model.tree import Tree


class NamedLeg(NamedTuple):
    """A leg by the names of its joints and its toe, see `Leg`, and its side, 0 to find it; the rest is the model's."""

    name: str
    hip: str
    knee: str
    toe: str
    abduction: str | None = None
    side: int = 0


def names_of(leg: Leg) -> NamedLeg:
    """Returns the names by which `leg_of` finds a leg again."""
    return NamedLeg(*(getattr(leg, field) for field in NamedLeg._fields))


def leg_of(model: Any, names: NamedLeg) -> Leg:
    """Returns the leg that some joints of a `pinocchio.Model` make.

    Raises:
        UnknownName: there is no such joint or frame.
        BadValue: the joints do not follow each other to the toe, or hip or knee do not turn in the sagittal plane; or
            the side is invalid.
    """
    if isinstance(names.side, bool) or names.side not in (-1, 0, 1):
        raise BadValue(f"side of {names.name}", names.side, "+1 or -1")
    tree = Tree(model)
    given = [name for name in (names.abduction, names.hip, names.knee) if name is not None]
    ids = [joint_id(model, name) for name in given]
    chain = tree.chain(int(model.frames[frame_id(model, names.toe)].parentJoint))
    if [joint for joint in chain if joint in ids] != ids or len(set(ids)) < len(ids):
        above = ", ".join(str(model.names[joint]) for joint in chain)
        expected = f"joints that follow each other to {names.toe!r}, below {above or 'none'}"
        raise BadValue(f"joints of {names.name}", ", ".join(given), expected)
    hip, knee = ids[-2:]
    for joint in (hip, knee):
        if not tree.pitches(joint):
            expected = "joints that turn about the y axis with every joint at zero"
            raise BadValue(f"hip and knee of {names.name}", str(model.names[joint]), expected)
    found = leg_along(tree, names.toe, [*ids[:-2], *chain[chain.index(hip) :]], hip, knee)
    if found is None:
        raise BadValue(f"toe of {names.name}", names.toe, "a frame apart from the knee, which is apart from the hip")
    return replace(found, name=names.name, side=names.side or side_of(tree, found))
