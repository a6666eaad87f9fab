"""Springs by name over the samples of a motion: how long each path is, and how its spring pulls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held, Mount
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.pull import Pull
from spear_pin.model.path import Joints, Path
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import RobotPosture, find_spanned

MEASURED = ("length", "stretch", "pull")


@dataclass(frozen=True)
class PathSprings:
    """What springs do along their paths, at each sample.

    Attributes:
        names: names of the springs, (m,).
        paths: path of each, (m,); None for one of another kind than the package's in a file.
        units: unit of each length, "rad" or "m", (m,).
        length: length of each path, in rad or m, (n, m).
        stretch: how much longer each path is than at rest, (n, m); 0 while its spring is not engaged.
        pull: force of each spring along its path, without the damper's, in N·m or N, (n, m); positive as it pulls.
        acts: whether each spring is engaged, (n, m).
    """

    names: tuple[str, ...]
    paths: tuple[Path | None, ...]
    units: tuple[str, ...]
    length: Array
    stretch: Array
    pull: Array
    acts: NDArray[np.bool_]

    def part(self, rows: Any) -> PathSprings:
        """Returns some of the samples."""
        arrays = {name: getattr(self, name)[rows] for name in (*MEASURED, "acts")}
        return replace(self, **arrays)


def unit_along(path: Path, robot: Robot) -> str:
    """Returns the unit of a path's length on a robot, "rad" or "m"."""
    return (
        "rad" if path.turns and "rad" in {robot.units[robot.index(name)] for name in find_spanned(path, robot)} else "m"
    )


def mounts_by_path(system: HybridSystem) -> tuple[Mount, ...]:
    """Returns the mounts of all springs; none if each acts on a joint of its own, whose torque tells all."""
    mounts = {mount.name: mount for domain in system.domains for mount in domain.mounts if mount.spring.pulls}
    joints = [name for mount in mounts.values() for name in find_spanned(mount.along, system.robot)]
    plain = all(isinstance(mount.along, Joints) and mount.along.turns for mount in mounts.values())
    return () if plain and len({*joints}) == len(joints) == len(mounts) else tuple(mounts.values())


def engaged_in(domain: Domain, held: Held) -> list[Mount]:
    """Returns the mounts of a domain whose springs are engaged."""
    mounts = [mount for mount in domain.mounts if mount.on is None or held[mount.on] == 1.0]
    return [mount for mount in mounts if mount.spring.pulls]


class PathSampler:
    """Takes what the springs of a system do at one sample after the other.

    Args:
        system: the system.
    """

    def __init__(self, system: HybridSystem) -> None:
        self._robot, self._mounts = system.robot, mounts_by_path(system)
        self._posture = RobotPosture(system.robot, FLOATS) if self._mounts else None
        self._rows: list[list[tuple[float, float, float, bool]]] = []

    def add(self, domain: Domain, held: Held, q: Array, pulls: Sequence[Pull]) -> None:
        """Takes a configuration, and what the springs of its domain do there."""
        if self._posture is None:
            return
        there, acting = {pull.name: pull for pull in pulls}, {mount.name for mount in engaged_in(domain, held)}
        posture, row = self._posture.at(q), []
        for mount in self._mounts:
            pull, acts = there.get(mount.name), mount.name in acting
            stretch, force = (0.0, 0.0) if pull is None else (float(pull.stretch), float(pull.force))
            row.append((float(mount.along.length(posture)), stretch if acts else 0.0, 0.0 - force, acts))
        self._rows.append(row)

    def springs(self) -> PathSprings | None:
        """Returns all samples; None if columns of joints tell all."""
        if not self._mounts:
            return None
        table = np.array(self._rows)
        return PathSprings(
            tuple(mount.name for mount in self._mounts),
            tuple(mount.along for mount in self._mounts),
            tuple(unit_along(mount.along, self._robot) for mount in self._mounts),
            length=table[:, :, 0],
            stretch=table[:, :, 1],
            pull=table[:, :, 2],
            acts=table[:, :, 3].astype(bool),
        )
