"""Reads back what a recorded page holds."""

from __future__ import annotations

import base64
import json
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import umsgpack
from numpy.typing import NDArray

TYPES = {0x14: "<u2", 0x16: "<u4", 0x17: "<f4"}


@dataclass(frozen=True)
class Recording:
    """The data of a page, its commands decoded."""

    data: dict[str, Any]
    commands: tuple[dict[str, Any], ...]

    @property
    def paths(self) -> list[str]:
        """Paths that have an object."""
        return [command["path"] for command in self.commands if command["type"] == "set_object"]

    def color(self, path: str) -> int:
        """Colour of the object at a path."""
        found = next(c for c in self.commands if c["type"] == "set_object" and c["path"] == path)
        return int(found["object"]["materials"][0]["color"])

    def matrix(self, path: str) -> NDArray[np.float64]:
        """The transform a path is given before it is animated."""
        found = [c["matrix"] for c in self.commands if c["type"] == "set_transform" and c["path"] == path]
        return np.array(found[-1] if found else np.eye(4).ravel()).reshape(4, 4).T

    def track(self, path: str, name: str) -> tuple[NDArray[np.float64], NDArray[Any]] | None:
        """Times and values of a property."""
        for animation in self.commands[-1]["animations"]:
            for track in animation["clip"]["tracks"]:
                if animation["path"] == path and track["name"] == f".{name}":
                    times = _typed(track["times"])
                    values = track["values"]
                    flat = np.array(values) if isinstance(values, list) else _typed(values)
                    return times, flat.reshape(len(times), -1)
        return None

    def value(self, path: str, name: str, time: float) -> NDArray[Any]:
        """Value of a property at a time: vectors interpolated, yes and no held."""
        track = self.track(path, name)
        assert track is not None, (path, name)
        times, values = track
        if values.dtype == bool:
            return np.asarray(values[np.searchsorted(times, time, side="right") - 1])
        return np.array([np.interp(time, times, column) for column in values.T])

    def pose(self, path: str, time: float) -> NDArray[np.float64]:
        """Pose of a path in the world at a time."""
        total = np.eye(4)
        names = path.strip("/").split("/")
        for depth in range(1, len(names) + 1):
            here = "/" + "/".join(names[:depth])
            local = self.matrix(here)
            if self.track(here, "position") is not None:
                local[:3, 3] = self.value(here, "position", time)
            if self.track(here, "quaternion") is not None:
                local[:3, :3] = _rotation(self.value(here, "quaternion", time))
            total = total @ local
        return total


def read(text: str) -> Recording:
    """What a page holds."""
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    data = json.loads(found[1])
    return Recording(data, tuple(umsgpack.unpackb(base64.b64decode(command)) for command in data["commands"]))


def _typed(value: umsgpack.Ext) -> NDArray[np.float64]:
    return np.frombuffer(value.data, TYPES[value.type]).astype(float)


def _rotation(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
