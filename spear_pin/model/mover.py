"""Loads the robot of a saved motion again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from spear_pin.errors import BadValue, list_names
from spear_pin.model.loading import load
from spear_pin.model.origin import move_origin, robot_of
from spear_pin.model.robot import Robot


def mover(
    said: Mapping[str, Any] | None,
    source: str,
    coordinates: Iterable[str],
    toes: Iterable[str],
    elsewhere: str | None = None,
    name: str = "source",
) -> Robot:
    """Returns the robot that moved; joints that the motion does not have are locked in it.

    Args:
        said: its origin, see `spear_pin.model.origin`; None if a file has none.
        source: its name, or the path of its file.
        coordinates: names of the coordinates that moved.
        toes: frame names of its toes.
        elsewhere: name or path, if its own is not found; if it was cut out of a robot, that robot's.
        name: name of the argument by which `elsewhere` was given.

    Raises:
        SpearError: there is no such robot, or it does not have the coordinates.
        ValueError: `said` is no origin.
    """
    if said is not None and (elsewhere is None or "cut" in said):
        return robot_of(move_origin(said, elsewhere))
    whole, wanted = load(source if elsewhere is None else elsewhere), tuple(coordinates)
    if not set(wanted) <= set(whole.coordinates):
        raise BadValue(name, whole.source, f"a robot with {list_names(wanted)}, as the trajectory has")
    joints = list(zip(whole.model.names, whole.model.joints, strict=True))[1:]
    locked = [joint for joint, kind in joints if whole.coordinates[kind.idx_v] not in wanted]
    return load(whole.source, toes=tuple(toes), locked=locked)
