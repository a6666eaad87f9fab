"""The keyframes of an MJCF file, as postures of the joints of one of its robots."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from spear_pin.model.elements import fault, parse_number
from spear_pin.model.mjcf_sections import Defaults, section

SIZES = {"free": 7, "ball": 4, "hinge": 1, "slide": 1}  # coordinates of a joint


class Place(NamedTuple):
    """Where the coordinates of a joint are in qpos, how many all joints have, and what a zero of the joint is there."""

    begin: int
    size: int
    total: int
    zero: float


def places_of(world: Iterable[Any], defaults: Defaults) -> dict[Any, Place]:
    """Finds the coordinates of every joint of a file, by its element.

    Args:
        world: elements in the world, in order.
        defaults: defaults of the file.
    """
    found: dict[Any, tuple[int, float]] = {}

    for body in (body for each in world for body in each.iter("body")):
        for joint in body.iterchildren("joint", "freejoint"):
            said = defaults.of(joint) if joint.tag == "joint" else {"type": "free"}
            try:
                found[joint] = SIZES.get(said.get("type", "hinge"), 1), float(said.get("ref", "0"))
            except ValueError:  # which reading the joint refuses
                found[joint] = 1, 0.0
    total, begin, places = sum(size for size, _ in found.values()), 0, {}
    for joint, (size, zero) in found.items():
        places[joint] = Place(begin, size, total, zero if size == 1 else 0.0)
        begin += size
    return places


def read_keyframes(path: Path, root: Any, places: Mapping[str, Place]) -> dict[str, dict[str, tuple[float, ...]]]:
    """Reads the postures of all keyframes that have one.

    Args:
        path: path of the file.
        root: its element.
        places: places of the robot's joints, by name.

    Returns:
        coordinates by joint, by the keyframe's name; one without a name is called "key_0" by its place.

    Raises:
        BadFile: a keyframe has too many numbers or too few.
    """
    postures = {}
    total = next((place.total for place in places.values()), 0)
    for index, key in enumerate(each for each in section(root, "keyframe") if each.tag == "key"):
        numbers = [parse_number(path, key, part) for part in key.get("qpos", "").split()]
        if numbers and places:
            if len(numbers) != total:
                problem = f"keyframe {key.get('name', index)!r} has {len(numbers)} numbers in qpos"
                raise fault(path, key, f"{problem}; expected {total}")
            postures[key.get("name") or f"key_{index}"] = {
                name: tuple(number - place.zero for number in numbers[place.begin : place.begin + place.size])
                for name, place in places.items()
            }
    return postures
