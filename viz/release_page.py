"""Play a release of the push test: the leg held for a moment, let go, and where its pinned toe would pull."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.push_test import Release
from spear_pin.viz.player import record

Array = NDArray[np.float64]

HELD = 0.5  # s that are shown before the release


@dataclass(frozen=True)
class _Event:
    name: str
    time: float


@dataclass(frozen=True)
class _Played:
    """A release as the player takes it."""

    t: Array
    q: Array
    domain: list[str]
    force: Array
    events: tuple[_Event, ...]
    spring_joints: tuple[str, ...]
    engaged: NDArray[np.bool_]


def record_release(leg: PinnedLeg, release: Release, path: str | Path, *, title: str = "") -> Path:
    """Write one HTML file that plays a release, see `spear_pin.viz.player.record`.

    Raises:
        BadValue: the motion is too long for a page, or there is no such folder.
    """
    q = leg.configuration(release.angle).T
    weight = leg.ground_force(release.angle[0], 0.0, 0.0)
    before = np.array([-HELD, 0.0])
    force = np.vstack([[weight, weight], release.force])
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
    return record(leg.robot, played, path, title=title)
