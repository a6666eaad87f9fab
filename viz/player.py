"""Recording of a trajectory as one HTML page that plays from disk, and playing in a live viewer."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.errors import BadValue, list_names
from spear_pin.files import atomic
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.viz.bench.samples import packed, samples_of, thinned
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.cables import LEAST_COLOR, MOST_COLOR, SLACK_COLOR
from spear_pin.viz.playback.following import base_joint
from spear_pin.viz.playback.footfalls import footfalls
from spear_pin.viz.playback.frames import Frames, resample
from spear_pin.viz.playback.overlays import ARROW_COLOR, COIL_COLOR, TRAIL_COLOR
from spear_pin.viz.playback.scene import GHOST, ROBOT, Scene, moving, still
from spear_pin.viz.playback.stage import HORIZON, WORLD
from spear_pin.viz.playback.tracks import WAY_COLOR
from spear_pin.viz.playback.trajectory import Part, TrajectoryLike, last, read_times
from spear_pin.viz.template import css, environment

MOST_BYTES, IN_SPACE = 2_000_000, 2  # so many times as much in space, where a robot has twice the joints
# frames per second; more frames than this never fit
BEST_RATE, WORST_RATE, MOST_FRAMES = 120.0, 10.0, 10_000
PART_RATE = 30.0  # of what is cut out of a longer trajectory
SHORTEST = 0.5  # s of it
SPEEDS = (1.0, 0.25, 0.1)
CABLES = {"spring, largest pull": MOST_COLOR, "spring, small pull": LEAST_COLOR, "spring slack": SLACK_COLOR}


@typed
def record(
    robot: Robot,
    trajectory: TrajectoryLike,
    path: str | Path,
    *,
    title: str = "",
    ghost: TrajectoryLike | None = None,
    notes: Sequence[str] = (),
) -> Path:
    """Writes one HTML file that plays a trajectory in any browser, without server or network.

    Next to the robot it plots the trajectory's columns; the key `?` shows the page's keys. The file is written whole or
    not at all. With `#t=0.12` added to its address it opens paused at that time, in s.

    Args:
        robot: the robot that moves.
        trajectory: motion of the robot, see `TrajectoryLike`.
        path: the file to write; its folder must exist.
        title: title of the page; by default the robot's name.
        ghost: another trajectory of the robot, drawn translucent; both begin at the same instant.
        notes: sentences that the page shows below its legend.

    Returns:
        The path of the file.

    Raises:
        BadValue: the trajectory or the ghost cannot be played or is too long for a file of 2 MB, in space of 4 MB (see
            `shortened`), or the folder does not exist.
        BadFile: the file cannot be written.
        UnknownName: a spring's joint is not one of the robot's.
    """
    path = Path(path)
    if path.is_dir() or not path.parent.is_dir():
        raise BadValue("path", str(path), "a file in an existing folder")
    text = page(robot, trajectory, title=title, ghost=ghost, notes=notes).encode()
    with atomic(path) as temporary:
        temporary.write_bytes(text)
    return path


@typed
def page(
    robot: Robot,
    trajectory: TrajectoryLike,
    *,
    title: str = "",
    ghost: TrajectoryLike | None = None,
    notes: Sequence[str] = (),
) -> str:
    """Returns the text of the page that `record` writes, with as many frames as it may hold."""
    rate = _first_rate(trajectory)
    while rate >= WORST_RATE:
        text, share = _attempt(robot, trajectory, rate, title or robot.name, ghost, notes)
        if share >= 1.0:
            return text
        if rate == WORST_RATE:
            break
        rate = max(WORST_RATE, rate * min(0.95 * share, 0.95))
    problem = f"{np.ptp(read_times(trajectory)):.4g} s long"
    expected = f"a shorter piece, that fits into a page of {_most_bytes(robot)} bytes: `shortened` makes one"
    raise BadValue("trajectory", problem, expected)


def shortened(
    robot: Robot, trajectory: TrajectoryLike, piece: Callable[[TrajectoryLike, float], Part] = last
) -> TrajectoryLike:
    """Returns the trajectory, or a part that a page can show with some `PART_RATE` frames a second.

    Args:
        robot: the robot that moves.
        trajectory: motion of the robot.
        piece: function that cuts the number of seconds from it, `trajectory.first` or `trajectory.last`.

    Raises:
        BadValue: the trajectory cannot be played.
        UnknownName: a spring's joint is not one of the robot's.
    """
    if _first_rate(trajectory) >= WORST_RATE and _attempt(robot, trajectory, WORST_RATE, robot.name)[1] >= 1.0:
        return trajectory
    seconds = min(float(np.ptp(read_times(trajectory))), MOST_FRAMES / PART_RATE)
    part = piece(trajectory, seconds)
    while seconds > SHORTEST and _attempt(robot, part, PART_RATE, robot.name)[1] < 1.0:
        seconds /= 1.25
        part = piece(trajectory, seconds)
    return part


def _attempt(
    robot: Robot,
    trajectory: TrajectoryLike,
    rate: float,
    title: str,
    ghost: TrajectoryLike | None = None,
    said: Sequence[str] = (),
) -> tuple[str, float]:
    """Returns a page with a frame rate, and the room for its animation over what it needs: below 1 is too little."""
    frames = resample(robot, trajectory, rate)
    scene = moving(robot, frames, None if ghost is None else resample(robot, ghost, rate, "ghost"))
    animation = encoded(c.set_animation(scene.clips, frames.duration))
    feet = footfalls(robot.toes, read_times(trajectory), np.asarray(trajectory.force, dtype=np.float64))
    notes = [*said, *([f"shown: {trajectory.said}"] if isinstance(trajectory, Part) else [])]
    data = as_data(frames, replace(scene, notes=(*notes, *scene.notes)), animation, title) | {
        "rate": rate,
        "samples": packed(thinned(samples_of(robot, trajectory))),
        "ghost": None if ghost is None else {"of": ROBOT, "path": GHOST},
        "footfalls": [[each.label, each.color, _since(each.spans, frames.start)] for each in feet],
        "prints": scene.prints,
    }
    text = environment().get_template("player.html").render(title=title, data=data)
    return text, (_most_bytes(robot) - (len(text.encode()) - len(animation))) / len(animation)


def _since(spans: Sequence[tuple[float, float]], start: float) -> list[list[float]]:
    return [[round(time - start, 6) for time in span] for span in spans]


def _most_bytes(robot: Robot) -> int:
    return MOST_BYTES * (1 if base_joint(robot.model) is None else IN_SPACE)


def live(robot: Robot, trajectory: TrajectoryLike, *, speed: float = 1.0) -> Any:
    """Plays a trajectory over and over in a meshcat viewer, in real time or slower.

    Args:
        robot: the robot that moves.
        trajectory: motion of the robot, see `TrajectoryLike`.
        speed: 1 for real time, less for slower.

    Returns:
        The `meshcat.Visualizer`: `.open()` opens a browser, `.url()` is its address. Its server is a
        child process that stays until this process ends, or `.window.server_proc.terminate()`.

    Raises:
        BadValue: the trajectory cannot be played, or the speed is not positive.
    """
    if not (np.isfinite(speed) and speed > 0):
        raise BadValue("speed", speed, "a positive number")
    frames = resample(robot, trajectory, _first_rate(trajectory))
    scene = moving(robot, frames)
    return _show([*scene.commands, c.set_animation(scene.clips, frames.duration, speed)])


def viewer(robot: Robot, q: ArrayLike) -> Any:
    """Shows a robot in a configuration, (nq,), in a meshcat viewer; returns the viewer as `live` does."""
    configuration = np.asarray(q, dtype=np.float64)
    if configuration.shape != (robot.nq,) or not np.isfinite(configuration).all():
        raise BadValue("q", q, f"{robot.nq} finite numbers ({list_names(robot.coordinates, 8)})")
    return _show(list(still(robot, configuration).commands))


def _first_rate(trajectory: TrajectoryLike) -> float:
    """Returns the number of frames per second to try first."""
    duration = float(np.ptp(read_times(trajectory)))
    return min(BEST_RATE, MOST_FRAMES / duration)


def as_data(frames: Frames, scene: Scene, animation: str, title: str) -> dict[str, Any]:
    """Returns a scene and its frames in the form for the scripts of pages; `encoded` gives the animation."""
    force = (
        "ground force"
        + " on each foot" * scene.paired
        + f", arrows up to {scene.peak_force:.0f} N" * (scene.peak_force > 0)
    )
    legend = [[force, css(ARROW_COLOR)]]
    legend = [*springs_legend(frames), *legend]
    legend.append(["toe path", css(TRAIL_COLOR)])
    if scene.tracks:
        legend.append(["way of the torso", css(WAY_COLOR)])
    return {
        "title": title,
        "start": frames.start,
        "duration": frames.duration,
        "spans": [[in_words(span.name), span.begin, span.end] for span in frames.spans],
        "events": [[in_words(name), time] for name, time in frames.events],
        "speeds": SPEEDS,
        "legend": legend,
        "notes": scene.notes,
        "aspect": scene.view.aspect,
        "distance": scene.view.distance,
        "horizon": css(HORIZON),
        "world": WORLD,
        "follows": scene.follows,
        "turns": scene.turns,
        "tracks": scene.tracks,
        "arrows": scene.arrows,
        "newtons": scene.newtons,
        "trails": scene.trails,
        "joints": [[name, path] for name, path in scene.joints.items()],
        "commands": [*map(encoded, scene.commands), animation],
    }


def springs_legend(frames: Frames) -> list[list[str]]:
    """Returns texts and colours of springs: coils, and cables by their pull."""
    coils = [["spring engaged", css(COIL_COLOR)]] if frames.springs else []
    colors = CABLES if frames.cables else {}
    return [*coils, *([text, css(color)] for text, color in colors.items())]


def in_words(name: str) -> str:
    """Returns a domain or event in words: "double_1 anterior slip+" is "double stance 1, anterior slipping"."""
    head, *rest = re.split(r" (?=slip[+-]|\w+ slip[+-])", name)
    words = re.sub(r"^double\b", "double stance", head.replace("_", " "))
    legs = " and ".join(word for word in rest if not word.startswith("slip"))
    return f"{words}, {legs} slipping".replace("  ", " ") if rest else words


def encoded(command: c.Command) -> str:
    """Returns a command of meshcat in the form in which pages hold it."""
    return base64.b64encode(c.pack(command)).decode()


class _Raw:
    """A finished command, in the form meshcat's window sends."""

    def __init__(self, command: c.Command) -> None:
        self._command = command

    def lower(self) -> c.Command:
        return self._command


def _show(commands: list[c.Command]) -> Any:
    import meshcat

    visualizer = meshcat.Visualizer()
    for command in commands:
        visualizer.window.send(_Raw(command))
    return visualizer
