"""Appearance of a robot: shapes and meshes of its file, or bones; a cut robot has the appearance of its original."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from spear_pin.errors import SpearError
from spear_pin.model.document import describe
from spear_pin.model.robot import Robot
from spear_pin.viz.playback.appearance import Undrawn
from spear_pin.viz.playback.grafting import grafted
from spear_pin.viz.playback.meshes import Mesh, Use, find_mesh, light_meshes
from spear_pin.viz.playback.shapes import GREY, Shape, bones, soles
from spear_pin.viz.playback.visuals import Visual, visuals_of

FACES = 30_000  # of all meshes of a robot, so that a page stays small
FAINT = 0.22  # opacity of what is seen through
NAMED = 2  # things that are not drawn, of which more are counted


@dataclass(frozen=True)
class Looks:
    """The shapes of a robot, and one line for each kind of part that is not drawn as it is."""

    shapes: tuple[Shape, ...]
    notes: tuple[str, ...] = ()


def read_looks(robot: Robot, faces: int = FACES) -> Looks:
    """Reads shapes from the robot's file; never fails: parts that are not drawn are in the notes.

    Args:
        robot: the robot.
        faces: largest number of faces, roughly, of all meshes together.
    """
    whole = robot if robot.cut is None else robot.cut.robot
    try:
        description = describe(whole)
    except SpearError as error:
        return Looks((*bones(robot, set()), *soles(robot)), (f"drawn as bones: {error}",))
    visuals, faults = visuals_of(description, whole.model)
    if robot.cut is not None:
        visuals = grafted(robot, robot.cut, visuals)
    meshes, missing = _meshes(visuals, description.path, faces)
    faults += missing
    shapes: list[Shape] = []
    for visual in visuals:
        found = _shapes(visual, meshes)
        shapes += [replace(shape, color=(*shape.color[:3], FAINT)) for shape in found] if visual.faint else found
    notes = [_undrawn(faults)] if faults else []
    return Looks((*shapes, *bones(robot, {shape.joint for shape in shapes}), *soles(robot)), tuple(notes))


def _meshes(
    visuals: Sequence[Visual], file: Path, faces: int
) -> tuple[Mapping[str, tuple[Mesh, ...]], list[tuple[str, Undrawn]]]:
    """Returns the meshes of visuals by the names of their files, and those that are not drawn."""
    paths: dict[str, Path] = {}
    faults: list[tuple[str, Undrawn]] = []
    shown = [visual for visual in visuals if visual.shown.form == "mesh"]
    for visual in shown:
        try:
            paths[visual.shown.mesh] = find_mesh(visual.shown.mesh, file)
        except Undrawn as fault:
            faults.append((visual.body, fault))
    uses = {
        path: [float(np.abs(visual.shown.size).max()) for visual in shown if paths.get(visual.shown.mesh) == path]
        for path in sorted(set(paths.values()))
    }
    light = light_meshes(
        tuple(Use(path, path.stat().st_mtime_ns, max(scales), len(scales)) for path, scales in uses.items()), faces
    )
    read: dict[str, tuple[Mesh, ...]] = {}
    for visual in (visual for visual in shown if visual.shown.mesh in paths):
        found = light[paths[visual.shown.mesh]]
        if isinstance(found, str):
            faults.append((visual.body, Undrawn(f"mesh {visual.shown.mesh!r}", found)))
        else:
            read[visual.shown.mesh] = found
    return read, faults


def _undrawn(faults: Sequence[tuple[str, Undrawn]]) -> str:
    """Says in a line what is not drawn; of several bodies it names the first."""
    said: dict[tuple[str, str], str] = {}
    for body, fault in faults:
        said.setdefault((fault.what, fault.why), f"{fault.what} of {body!r}" + f" ({fault.why})" * bool(fault.why))
    rest = f" and {len(said) - NAMED} more" if len(said) > NAMED else ""
    return f"not drawn: {', '.join(list(said.values())[:NAMED])}{rest}"


def _shapes(visual: Visual, meshes: Mapping[str, tuple[Mesh, ...]]) -> list[Shape]:
    """Returns the shapes of a visual."""
    joint, placement, shown = visual.joint, visual.placement, visual.shown
    color, size = shown.color or GREY, shown.size
    if shown.form == "mesh":
        scaled = placement @ np.diag([*size, 1.0])
        return [
            Shape(joint, "mesh", (), scaled, mesh.color or color, mesh) for mesh in meshes.get(visual.shown.mesh, ())
        ]
    if shown.form == "ellipsoid":
        return [Shape(joint, "sphere", (1.0,), placement @ np.diag([*size, 1.0]), color)]
    if shown.form == "capsule":
        ends = [np.array(placement), np.array(placement)]
        for end, sign in zip(ends, (-1, 1), strict=True):
            end[:3, 3] += sign * size[1] / 2 * placement[:3, 2]
        round_ends = [Shape(joint, "sphere", size[:1], end, color) for end in ends]
        return [Shape(joint, "cylinder", size, placement, color), *round_ends]
    return [Shape(joint, shown.form, size, placement, color)]
