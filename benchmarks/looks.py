"""How large pages of other people's robots are with their own meshes: `python -m benchmarks.looks`.

It takes quadrupeds of example-robot-data (extra `robots`), or those that are named, by name or path. Of each it records
ten seconds of a made motion, of one leg and of the sagittal plane, and prints the faces that are drawn, the size of the
page and of the mesh files behind it, and the seconds until the meshes are ready.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from spear_pin import Robot, SpearError, load, monopod, sagittal
from spear_pin.model.document import describe
from spear_pin.model.legs import find_legs
from spear_pin.viz.playback.appearance import Undrawn
from spear_pin.viz.playback.looks import Looks, read_looks
from spear_pin.viz.playback.meshes import find_mesh
from spear_pin.viz.playback.visuals import visuals_of
from spear_pin.viz.player import page

ROBOTS = ("solo12", "anymal_b_simple", "a1", "go1", "go2", "hyq_no_sensors")
SECONDS, RATE = 10.0, 120
HEAD = f"{'':18}{'mesh files':>12}{'':>10}{'faces':>8}{'page':>10}{'meshes in':>12}"


def cuts(source: str) -> dict[str, Robot]:
    """A leg of a robot, and its plane."""
    robot = load(source, base="fixed", motors="all", repair=True)
    legs = find_legs(robot)
    legs = legs if legs[0].side else find_legs(robot, sides=1)
    return {"one leg": monopod(robot, legs[0]), "plane": sagittal(robot)}


def motion(robot: Robot) -> SimpleNamespace:
    """Every coordinate to and fro, the springs always engaged."""
    t = np.linspace(0.0, SECONDS, int(RATE * SECONDS))
    phases = np.arange(robot.nq)
    knees = tuple(name for name in robot.coordinates if name.endswith("knee"))
    return SimpleNamespace(
        t=t,
        q=0.5 + 0.3 * np.sin(6.0 * t[:, None] + phases),
        domain=["stance"] * len(t),
        force=np.full((len(t), len(robot.toes), 2), robot.mass),
        events=(),
        spring_joints=knees,
        engaged=np.ones((len(t), len(knees)), dtype=bool),
    )


def files(robot: Robot) -> int:
    """Bytes of the mesh files that a robot's file shows."""
    description = describe(robot)
    paths: set[Path] = set()
    for visual in visuals_of(description, robot.model)[0]:
        try:
            paths.add(find_mesh(visual.shown.mesh, description.path))
        except Undrawn:
            continue
    return sum(path.stat().st_size for path in paths)


def faces(looks: Looks) -> int:
    """Faces of all meshes that are drawn."""
    return sum(len(shape.mesh.faces) for shape in looks.shapes if shape.mesh is not None)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", default=ROBOTS, help="names or paths")
    print(HEAD)
    for source in parser.parse_args(arguments).robots:
        name = Path(source).stem
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = cuts(source)
        except SpearError as error:
            print(f"{name:18}{error}")
            continue
        for kind, robot in found.items():
            begin = time.perf_counter()
            looks = read_looks(robot)
            took = time.perf_counter() - begin
            size = len(page(robot, motion(robot)).encode())
            said = (
                f"{files(robot.cut.robot) / 1e6:9.1f} MB{kind:>10}{faces(looks):8d}{size / 1e6:7.2f} MB{took:10.1f} s"
            )
            print(f"{name:18}{said}", *looks.notes, sep="  ")


if __name__ == "__main__":
    main()
