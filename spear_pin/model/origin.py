"""The origin of a robot as a JSON object in files, from which the same robot is made again, bit for bit."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

from spear_pin.errors import BadValue, RobotWarning, SpearError
from spear_pin.files import check_keys
from spear_pin.model.cut import Cut
from spear_pin.model.draft import MODEL
from spear_pin.model.loading import load
from spear_pin.model.named_legs import NamedLeg, leg_of, names_of
from spear_pin.model.recut import LIKE, recut
from spear_pin.model.robot import Robot
from spear_pin.model.variants import vary

NAMED = ("toes", "locked")
OPTIONS = ("base", "motors", "repair")
LEGS = {"monopod": "leg", "sagittal": "pairs"}
PAIRS = "two pairs of legs"


def origin(robot: Robot) -> dict[str, Any]:
    """Returns the origin from which `robot_of` makes the robot again, unless `unsaid` names an obstacle."""
    said: dict[str, Any] = {
        "source": robot.source,
        "toes": list(robot.toes),
        "locked": list(robot.locked),
        "varied": dict(robot.varied),
    }
    if robot.options:
        said["options"] = {name: list(x) if isinstance(x, tuple) else x for name, x in robot.options.items()}
    return said if robot.cut is None else said | {"cut": _of_cut(robot.cut)}


def unsaid(robot: Robot) -> tuple[str, ...]:
    """Returns the properties of a robot that its origin cannot describe, in words."""
    first = robot
    while first.cut is not None:
        first = first.cut.robot
    has = {"a robot that was no file": first.source == MODEL, "a robot with added inertia": robot.added is not None}
    if not any(has.values()):
        again = "another model than its file" if robot.cut is None else "a robot that cannot be cut again as it was"
        has[again] = not _again(robot)
    return tuple(name for name, there in has.items() if there)


def robot_of(said: Mapping[str, Any]) -> Robot:
    """Makes the robot of an origin.

    Raises:
        ValueError: `said` is no origin, see `check_origin`.
        SpearError: there is no such robot, or the origin contradicts itself.
    """
    check_origin(said)
    if "cut" not in said:
        robot = load(said["source"], toes=said["toes"], locked=said["locked"], **said.get("options", {}))
        return vary(robot, **said.get("varied", {}))
    cut = said["cut"]
    whole, kind = robot_of(cut["of"]), cut["kind"]
    groups = [[cut["leg"]]] if kind == "monopod" else cut["pairs"]
    legs = [[leg_of(whole.model, NamedLeg(**leg)) for leg in group] for group in groups]
    robot = vary(recut(kind, whole, legs, cut.get("body"), said["locked"]), **said.get("varied", {}))
    for name, value in origin(robot).items():
        if name != "cut" and said.get(name, {}) != value:
            raise BadValue(f"robot.{name}", said.get(name), f"{value!r}, which its cut has")
    return robot


def move_origin(said: Mapping[str, Any], source: str | None) -> Mapping[str, Any]:
    """Returns an origin with another source for its file, or for the robot from which it was cut.

    Args:
        said: an origin, see `origin`.
        source: name of the robot, or path of its file; None to keep the source.
    """
    if source is None:
        return said
    if "cut" not in said:
        return {**said, "source": source}
    whole = said["cut"]["of"]
    elsewhere = move_origin(whole, source)
    name = str(said["source"]).replace(repr(whole["source"]), repr(elsewhere["source"]))
    return {**said, "source": name, "cut": {**said["cut"], "of": elsewhere}}


def check_origin(said: Any, name: str = "robot") -> None:
    """Raises `ValueError` or `BadValue` unless `said` has every part of an origin, each of its kind."""
    if not isinstance(said, dict):
        raise BadValue(name, said, "a JSON object")
    check_keys(f"field of {name}", said, ("source", *NAMED), ("varied", "options", "cut"))
    texts = {f"{name}.source": said["source"]}
    for list_of in NAMED:
        if not isinstance(said[list_of], list):
            raise BadValue(f"{name}.{list_of}", said[list_of], "a list of names")
        texts |= {f"{name}.{list_of}[{i}]": item for i, item in enumerate(said[list_of])}
    for where, text in texts.items():
        if not isinstance(text, str):
            raise BadValue(where, text, "a name")
    for part in ("varied", "options"):
        if not isinstance(said.get(part, {}), dict):
            raise BadValue(f"{name}.{part}", said[part], "a JSON object")
    check_keys(f"option of {name}", said.get("options", {}), (), () if "cut" in said else OPTIONS)
    if "cut" in said:
        _check_cut(said["cut"], f"{name}.cut")


def _check_cut(cut: Any, name: str) -> None:
    if not isinstance(cut, dict) or cut.get("kind") not in LIKE:
        raise BadValue(name, cut, f"a JSON object, its kind one of {', '.join(LIKE)}")
    legs = LEGS[cut["kind"]]
    check_keys(f"field of {name}", cut, ("kind", "of", legs, *(["body"] if legs == "leg" else [])))
    check_origin(cut["of"], f"{name}.of")
    groups = [[cut["leg"]]] if legs == "leg" else cut["pairs"]
    if not isinstance(groups, list) or not all(isinstance(group, list) for group in groups):
        raise BadValue(f"{name}.pairs", groups, PAIRS)
    for leg in (leg for group in groups for leg in group):
        if not isinstance(leg, dict):
            raise BadValue(f"{name}.{legs}", leg, "a leg, a JSON object")
        check_keys(f"field of a leg of {name}", leg, NamedLeg._fields)
        for part, value in leg.items():
            if not isinstance(value, int if part == "side" else str) and not (part == "abduction" and value is None):
                raise BadValue(f"{part} of a leg of {name}", value, "+1, -1 or 0" if part == "side" else "a name")


def _of_cut(cut: Cut) -> dict[str, Any]:
    groups = [[names_of(leg)._asdict() for leg in group] for group in cut.legs]
    if cut.kind == "monopod":
        return {"kind": cut.kind, "leg": groups[0][0], "body": cut.body, "of": origin(cut.robot)}
    return {"kind": cut.kind, "pairs": groups, "of": origin(cut.robot)}


def _again(robot: Robot) -> bool:
    """Tells whether the origin of a robot gives exactly this robot."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RobotWarning)
            again = robot_of(origin(robot))
    except SpearError:
        return robot.cut is None  # a file that is gone may come back
    return again.model == robot.model and again.cut == robot.cut
