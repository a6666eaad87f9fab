"""Playback of a release of the push test: the leg held for a moment, let go, and where its pinned toe would pull."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.push_test import PassiveKnee, Release
from spear_pin.viz.playback.trajectory import TrajectoryLike, first
from spear_pin.viz.player import record, shortened

HELD = 0.5  # s that are shown before the release


@dataclass(frozen=True)
class _Event:
    name: str
    time: float


@dataclass(frozen=True)
class _Played:
    """A release in the form for the player."""

    t: Array
    q: Array
    domain: list[str]
    force: Array
    events: tuple[_Event, ...]
    spring_joints: tuple[str, ...]
    engaged: NDArray[np.bool_]


def record_release(leg: PinnedLeg, knee: PassiveKnee, release: Release, path: str | Path, *, title: str = "") -> Path:
    """Writes one HTML file that plays a release, see `spear_pin.viz.player.record`; of a long one the beginning.

    Args:
        leg: the leg that was released.
        knee: torque law of the knee.
        release: the motion.
        path: path of the file.
        title: title of the page.

    Raises:
        BadValue: there is no such folder.
    """
    return record(leg.robot, playback(leg, knee, release), path, title=title)


def playback(leg: PinnedLeg, knee: PassiveKnee, release: Release) -> TrajectoryLike:
    """Returns the playback of a release: the hand's hold, and as much of the motion as a page holds."""
    q = leg.configuration(release.angle).T
    held = float(release.angle[0])
    sinking = float(leg.configuration.derivative().at(held)[0])  # of the hip, in m/rad
    hand = (float(knee.spring_torque(held)) - float(leg.gravity(held))) / sinking  # what holds it down, in N
    standing = leg.ground_force(held, 0.0, 0.0) + np.array([0.0, hand])
    before = np.array([-HELD, 0.0])
    force = np.vstack([[standing, standing], release.force])
    events = [_Event("release", 0.0)]
    if release.lift_off is not None:
        events.append(_Event("the pinned toe begins to pull", release.lift_off))
    played = _Played(
        t=np.concatenate([before, release.t]),
        q=np.vstack([q[:1], q[:1], q]),
        domain=["held"] * 2 + ["pulls" if pulls else "pinned" for pulls in release.force[:, 1] < 0],
        force=force[:, None, :],
        events=tuple(events),
        spring_joints=(leg.joint,),
        engaged=np.ones((release.t.size + 2, 1), dtype=bool),
    )
    return shortened(leg.robot, played, first)
