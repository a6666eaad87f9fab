"""Pictures and films of a trajectory: the frame shown is of the time asked, and nothing is left behind."""

from __future__ import annotations

import base64
import io
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from spear_pin.errors import BadValue, MissingProgram, SpearError
from spear_pin.model.loading import load
from spear_pin.viz import chromium, player, video
from tests.viz import samples
from tests.viz.chromium import Browser, pixels

HOP = samples.hop(start=3.0)
SPEAR = load("spear_ii")
SIZE = (480, 270)
FLIGHT = 3.36  # s

needs_chromium = pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")
needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg here")


def probe(path: Path, entry: str) -> str:
    command = ["ffprobe", "-v", "error", "-show_entries", f"stream={entry}", "-of", "csv=p=0", str(path)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def frames(path: Path) -> list[NDArray[np.uint8]]:
    """The pictures of a film."""
    command = ["ffmpeg", "-loglevel", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return list(np.frombuffer(raw, np.uint8).reshape(-1, SIZE[1], SIZE[0], 3))


def played(picture: NDArray[np.uint8]) -> float:
    """How far the thumb of the time bar is, 0 to 1; it is the darkest thing at the bottom."""
    dark = np.flatnonzero(picture[-36:-12].astype(int).sum(axis=(0, 2)) < 24 * 3 * 130)
    left, right = 30, SIZE[0] - 30  # of the bar, see player.css
    return float((dark.mean() - left) / (right - left))


@pytest.mark.browser
@needs_chromium
class TestStill:
    @pytest.mark.slow
    def test_two_times_differ_and_neither_is_blank(self, tmp_path: Path) -> None:
        stance = pixels(video.still(SPEAR, HOP, tmp_path / "a.png", time=3.11, size=SIZE).read_bytes())
        flight = pixels(video.still(SPEAR, HOP, tmp_path / "b.png", time=FLIGHT, size=SIZE).read_bytes())
        assert stance.shape == flight.shape == (SIZE[1], SIZE[0], 3)
        assert min(stance.std(), flight.std()) > 15
        assert (abs(stance.astype(int) - flight).max(axis=2) > 60).sum() > 1000
        orange = [((p[..., 0] > 190) & (p[..., 2] < 90) & (p[..., 1] < 200))[80:, 120:].sum() for p in (stance, flight)]
        assert orange[0] > 50 and orange[1] == 0, "the coil shows in stance only"

    @pytest.mark.slow
    def test_every_picture_is_of_its_own_time(self, tmp_path: Path) -> None:
        """In any order, the scene is to the pixel what the page draws when nobody waits for a browser to show it."""
        times = np.random.default_rng(2).permutation(np.linspace(0.0, 1.0, 8))
        bare = "header, aside, footer { display: none !important } #scene::after { display: none }"
        file = tmp_path / "page.html"
        file.write_text(player.page(SPEAR, HOP).replace("</head>", f"<style>{bare}</style></head>", 1))
        drawn = "(player.seek({!r}), player.viewer.render(), player.viewer.renderer.domElement.toDataURL('image/png'))"
        with Browser(*SIZE) as browser:
            browser.open(file, "#t=3.0")
            for at in times:
                browser.run(video.SHOW.replace("TIME", repr(float(at))))
                shown = browser.screenshot()
                address = browser.run(drawn.format(float(at)))
                truth = np.asarray(Image.open(io.BytesIO(base64.b64decode(address.partition(",")[2]))).convert("RGB"))
                assert abs(shown.astype(int) - truth).max() <= 1

    @pytest.mark.slow
    def test_nothing_but_files_is_asked_for(self, tmp_path: Path) -> None:
        file = player.record(SPEAR, HOP, tmp_path / "page.html")
        with Browser(*SIZE) as browser:
            browser.open(file)
            assert browser.requests and browser.errors == []
            assert {address.split(":")[0] for address in browser.requests} <= {"file", "data", "blob", "about"}


@pytest.mark.browser
@needs_chromium
@needs_ffmpeg
class TestFilm:
    @pytest.mark.slow
    def test_frames_and_duration(self, tmp_path: Path) -> None:
        told: list[tuple[int, int]] = []
        done = lambda *each: told.append(each)  # noqa: E731
        path = video.film(SPEAR, HOP, tmp_path / "a.mp4", fps=12, speed=0.5, size=SIZE, on_frame=done)
        length = float(HOP.t[-1] - HOP.t[0])
        count = round(length / 0.5 * 12)
        assert told == [(i + 1, count) for i in range(count)]
        assert float(probe(path, "duration")) == pytest.approx(2 * length, abs=1 / 12)
        assert probe(path, "codec_name,width,height,r_frame_rate").split(",") == ["h264", "480", "270", "12/1"]
        pictures = frames(path)
        assert len(pictures) == count
        for number in (0, 3, count // 2, count - 1):
            assert played(pictures[number]) == pytest.approx(number * 0.5 / 12 / length, abs=0.01)
        assert os.listdir(tmp_path) == ["a.mp4"]


class TestRefusals:
    @pytest.mark.parametrize(
        ("wishes", "part"),
        [
            ({"fps": 0.0}, "fps is 0.0"),
            ({"speed": float("nan")}, "speed is nan"),
            ({"speed": 1e-9}, "at most 100000 frames"),
            ({"size": (481, 270)}, "even"),
        ],
    )
    def test_films(self, tmp_path: Path, wishes: dict[str, float], part: str) -> None:
        with pytest.raises(BadValue, match=part):
            video.film(SPEAR, HOP, tmp_path / "a.mp4", **wishes)
        assert os.listdir(tmp_path) == []

    def test_a_time_outside(self, tmp_path: Path) -> None:
        with pytest.raises(BadValue, match="time is 2.9; expected a time of the trajectory, 3 to 4"):
            video.still(SPEAR, HOP, tmp_path / "a.png", time=2.9)

    @pytest.mark.parametrize("size", [(8, 8), (100_000, 100)])
    def test_a_size_that_is_none(self, tmp_path: Path, size: tuple[int, int]) -> None:
        with pytest.raises(BadValue, match="64 to 4096 pixels"):
            video.still(SPEAR, HOP, tmp_path / "a.png", time=3.1, size=size)

    def test_what_is_not_installed_is_named(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("PATH", str(tmp_path))
        with pytest.raises(MissingProgram, match="need chromium, .*apt-get install chromium"):
            video.still(SPEAR, HOP, tmp_path / "a.png", time=3.1)
        with pytest.raises(MissingProgram, match="need ffmpeg, .*apt-get install ffmpeg"):
            video.film(SPEAR, HOP, tmp_path / "a.mp4")


@pytest.mark.browser
@needs_chromium
@needs_ffmpeg
class TestNothingIsLeft:
    @pytest.fixture
    def temporary(self, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
        """Temporary files of this test, all in one place; its path is short, for the browser's socket."""
        with tempfile.TemporaryDirectory() as folder:
            monkeypatch.setenv("TMPDIR", folder)
            monkeypatch.setattr(tempfile, "tempdir", None)
            yield Path(folder)

    @pytest.mark.slow
    def test_when_a_frame_fails(self, tmp_path: Path, temporary: Path) -> None:
        def fail(done: int, total: int) -> None:
            raise SpearError("enough")

        with pytest.raises(SpearError, match="enough"):
            video.film(SPEAR, HOP, tmp_path / "a.mp4", size=SIZE, on_frame=fail)
        assert os.listdir(tmp_path) == os.listdir(temporary) == []
        assert processes_with(str(temporary)) == []

    @pytest.mark.slow
    def test_when_it_is_interrupted(self, tmp_path: Path, temporary: Path) -> None:
        code = (
            "from tests.viz import samples; from spear_pin import load; from spear_pin.viz.video import film;"
            f"film(load('spear_ii'), samples.hop(), {str(tmp_path / 'a.mp4')!r}, size={SIZE}, speed=0.01,"
            " on_frame=lambda done, total: print(done, flush=True))"
        )
        root = Path(__file__).parents[2]
        command = [sys.executable, "-c", code]
        with subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=root,
            start_new_session=True,
            # what a shell starts in the background ignores interrupts, and so does what that starts
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        ) as process:
            assert process.stdout is not None and process.stdout.readline() == b"1\n"
            assert processes_with(str(temporary)) != []
            os.killpg(process.pid, signal.SIGINT)  # as a terminal does
            process.stdout.read()
        assert process.returncode != 0
        assert os.listdir(tmp_path) == os.listdir(temporary) == []
        assert processes_with(str(temporary)) == []


def processes_with(text: str) -> list[str]:
    """Command lines with a text in them, once those that are ending have ended."""
    for _ in range(50):
        found = []
        for path in Path("/proc").glob("[0-9]*/cmdline"):
            try:
                line = path.read_bytes().replace(b"\0", b" ").decode(errors="replace")
            except OSError:
                continue
            if text in line and "pytest" not in line:
                found.append(line)
        if not found:
            break
        time.sleep(0.02)
    return found
