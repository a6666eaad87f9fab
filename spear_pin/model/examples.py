"""Robots of the package example-robot-data, where that is installed (extra `robots`), by name; nothing is fetched."""

from __future__ import annotations

from collections import Counter
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import NamedTuple

from spear_pin.model.elements import number, parse

PACKAGE = "example-robot-data"
FOLDER = "cmeel.prefix/share/example-robot-data/robots"
FREEDOM = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6}
SUFFIXES = ("_description", "_data")  # suffixes of a robot's folder that are not part of its name


class Outline(NamedTuple):
    """Summary of a URDF: its base as the file has it, the mass in kg."""

    links: int
    degrees_of_freedom: int
    mass: float


@cache
def example_robots() -> dict[str, Path]:
    """Returns the URDFs of the package by the names of their robots; none if it is not installed.

    A robot has the name of its file; if several files have the same name, that of the robot's folder.
    """
    try:
        folder = Path(str(distribution(PACKAGE).locate_file(FOLDER)))
    except PackageNotFoundError:
        return {}
    paths = sorted(folder.glob("*/*/*.urdf"))
    count = Counter(path.stem for path in paths)
    return {path.stem if count[path.stem] == 1 else _of_folder(path): path for path in paths}


def find_beginning_with(name: str) -> list[str]:
    """Returns the robots whose names begin with this, up to an underscore: "anymal_b" matches "anymal_b_simple"."""
    return [each for each in example_robots() if each.startswith(f"{name}_")]


def source_of_examples() -> str:
    """Returns the package and its release."""
    return f"{PACKAGE} {distribution(PACKAGE).version}"


def outline(path: Path) -> Outline:
    """Summarizes a URDF in a hundredth of the time that loading takes."""
    _, root = parse(path)
    masses = [number(path, mass, "value") for mass in root.iterfind("link/inertial/mass")]
    freedom = [FREEDOM.get(joint.get("type"), 0) for joint in root.iterfind("joint")]
    return Outline(len(root.findall("link")), sum(freedom), sum(masses))


def _of_folder(path: Path) -> str:
    name = path.parents[1].name
    for suffix in SUFFIXES:
        name = name.removesuffix(suffix)
    return name
