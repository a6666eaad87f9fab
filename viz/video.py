"""A trajectory as a film or a picture: a headless Chromium shows the recorded page frame by frame."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, MissingProgram, SpearError
from spear_pin.files import atomic
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.viz.chromium import Browser
from spear_pin.viz.playback.trajectory import TrajectoryLike, read_times
from spear_pin.viz.player import page

Size = tuple[int, int]
SIZE: Size = (1280, 720)
LEAST_SIDE, MOST_SIDE, MOST_FRAMES = 64, 4096, 100_000
# nobody can press the buttons of a picture
STYLE = """
#play, #speeds, #more, #tools, #plots, aside summary { display: none !important }
#stage { grid-column: 1 / -1 }
footer { padding: 2px 30px }
"""
# the scene is drawn at once, and the browser given two frames to show it and the time beside it
SHOW = """new Promise((done) => {
  player.setPlaying(false);
  player.seek(TIME);
  player.viewer.render();
  requestAnimationFrame(() => requestAnimationFrame(() => done(player.time)));
})"""


@typed
def still(
    robot: Robot, trajectory: TrajectoryLike, path: str | Path, *, time: float, size: Size = SIZE, title: str = ""
) -> Path:
    """Writes a PNG of a trajectory at a time, as the page of `player.record` shows it.

    Args:
        robot: the robot that moves.
        trajectory: motion of the robot, see `TrajectoryLike`.
        path: the file to write.
        time: time of the trajectory, in s.
        size: width and height, in pixels.
        title: title of the picture; by default the robot's name.

    Returns:
        The path of the file.

    Raises:
        BadValue: the trajectory cannot be played, or does not have that time; or the size is not valid.
        MissingProgram: there is no Chromium.
        SpearError: Chromium fails.
    """
    t = read_times(trajectory)
    if not t[0] <= time <= t[-1]:
        raise BadValue("time", time, f"a time of the trajectory, {t[0]:.4g} to {t[-1]:.4g} s")
    with _camera(robot, trajectory, size, title) as take, atomic(path) as temporary:
        temporary.write_bytes(take(float(time - t[0])))
    return Path(path)


@typed
def film(
    robot: Robot,
    trajectory: TrajectoryLike,
    path: str | Path,
    *,
    fps: float = 30.0,
    speed: float = 1.0,
    size: Size = SIZE,
    title: str = "",
    on_frame: Callable[[int, int], None] | None = None,
) -> Path:
    """Writes an MP4 (H.264) of a trajectory, as the page of `player.record` shows it; each frame has its exact time.

    Args:
        robot: the robot that moves.
        trajectory: motion of the robot, see `TrajectoryLike`.
        path: the file to write.
        fps: frames a second of the film.
        speed: seconds of the motion a second of the film; 1 for real time, less for slower.
        size: width and height, in pixels, both even.
        title: title of the film; by default the robot's name.
        on_frame: called with the number of finished frames, and of all.

    Returns:
        The path of the file.

    Raises:
        BadValue: the trajectory cannot be played; or speed, rate or size is not valid, or gives too many frames.
        MissingProgram: there is no Chromium, or no ffmpeg.
        SpearError: Chromium or ffmpeg fails.
    """
    times = _frame_times(trajectory, fps, speed)
    if any(side % 2 for side in size):
        raise BadValue("size", size, "an even width and height, in pixels, for H.264")
    program = shutil.which("ffmpeg")
    if program is None:
        raise MissingProgram("ffmpeg", "films", "ffmpeg")
    with _camera(robot, trajectory, size, title) as take, atomic(path) as temporary:
        with _encoder(program, temporary, fps) as add:
            for done, time in enumerate(times, 1):
                add(take(float(time)))
                if on_frame is not None:
                    on_frame(done, len(times))
    return Path(path)


def _frame_times(trajectory: TrajectoryLike, fps: float, speed: float) -> NDArray[np.float64]:
    """Returns the times of the frames, in s from the start."""
    for name, value, unit in (("fps", fps, ", in frames a second"), ("speed", speed, "")):
        if not (np.isfinite(value) and value > 0):
            raise BadValue(name, value, f"a finite number > 0{unit}")
    duration = float(np.ptp(read_times(trajectory)))
    count = max(1.0, round(duration / speed * fps))
    if count > MOST_FRAMES:
        raise BadValue("speed", speed, f"a film of at most {MOST_FRAMES} frames; this one has {count:.3g}")
    times: NDArray[np.float64] = np.minimum(np.arange(int(count)) * speed / fps, duration)
    return times


@contextmanager
def _camera(robot: Robot, trajectory: TrajectoryLike, size: Size, title: str) -> Iterator[Callable[[float], bytes]]:
    """Returns a function that takes the picture, a PNG, at a time in s from the start."""
    if not all(LEAST_SIDE <= side <= MOST_SIDE for side in size):
        raise BadValue("size", size, f"width and height of {LEAST_SIDE} to {MOST_SIDE} pixels")
    text = page(robot, trajectory, title=title)
    with tempfile.TemporaryDirectory() as folder, Browser(*size) as browser:
        file = Path(folder) / "page.html"
        file.write_text(text.replace("</head>", f"<style>{STYLE}</style></head>", 1), encoding="utf-8")
        browser.open(file, "#t=0")

        def take(time: float) -> bytes:
            shown = browser.run(SHOW.replace("TIME", repr(time)))
            if abs(shown - time) > 1e-9:
                raise SpearError(f"the page shows {shown} s instead of {time} s")
            return browser.capture()

        yield take


@contextmanager
def _encoder(program: str, path: Path, fps: float) -> Iterator[Callable[[bytes], None]]:
    """Returns a function that adds a PNG to a film; ffmpeg ends with the block, killed if that fails."""
    command = [
        *(program, "-loglevel", "error", "-y", "-f", "image2pipe", "-c:v", "png", "-framerate", repr(float(fps))),
        *("-i", "-", "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart"),
        *("-f", "mp4", "-fflags", "+bitexact", str(path)),
    ]
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=log, start_new_session=True)
        pictures = process.stdin
        assert pictures is not None  # it is a pipe

        def failed() -> SpearError:
            log.seek(0)
            return SpearError(f"ffmpeg cannot make the film: {log.read().decode(errors='replace')[-400:]}")

        def add(picture: bytes) -> None:
            try:
                pictures.write(picture)
            except BrokenPipeError:
                raise failed() from None

        try:
            yield add
            pictures.close()
            if process.wait() != 0:
                raise failed()
        finally:
            process.kill()
            process.wait()
            pictures.close()
