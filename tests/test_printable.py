"""What is shown has no character that acts on a terminal, or cannot be seen, wherever it came from."""

import io
import json
import sys
import warnings

import numpy as np
import pytest

from spear_pin import RobotWarning, SpearError, Trajectory, load
from spear_pin.cli import main
from spear_pin.cli.output import align_lines, complain, emit, join_lines, print_result, progress, tell
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.files import write_text
from spear_pin.printable import is_printable, printable
from tests.wrong_calls.files import trajectory

HARMFUL = {
    "escape": "\x1b]0;title\x07",
    "bell": "\x07",
    "backspace": "\x08",
    "delete": "\x7f",
    "return": "\rb",
    "line feed": "\nb",
    "C1": "\x9b31m",
    "all of C1": "".join(map(chr, range(0x80, 0xA0))),
    "overrides of direction": "\u202a\u202b\u202c\u202d\u202e",
    "isolates": "\u2066\u2067\u2068\u2069",
    "marks of direction": "\u200e\u200f\u061c",
    "no width": "\u200b\u200c\u200d\u2060\ufeff\u00ad\u034f",
    "fillers": "\u115f\u1160\u3164\uffa0",
    "separators of lines": "\u2028\u2029",
    "lone surrogates": "\udfff\ud800",
    "tags": "\U000e0041",
}
HARMLESS = ("knee", "knee joint", "Fußgänger", "大腿 関節", "θ₀ ± 1", "a:b/c,d", "é", "ẋ", "人\u3000物", "🐎")
each = pytest.mark.parametrize("text", HARMFUL.values(), ids=HARMFUL)


def raw(text):
    """Characters in it that a terminal would heed, or nobody would see."""
    return [char for char in text if char not in "\n\t" and not is_printable(char)]


@each
def test_written_out(text):
    assert not is_printable(text)
    shown = printable(f"knee{text}")
    assert is_printable(shown) and "\\" in shown and shown.startswith("knee") and not raw(shown)


@pytest.mark.parametrize("text", HARMLESS)
def test_left(text):
    assert printable(text) == text and is_printable(text)


def test_kept():
    assert printable("a\nb\x1b", kept="\n") == "a\nb\\x1b"


@each
@pytest.mark.parametrize(
    "kind",
    [
        SpearError,
        RobotWarning,
        lambda text: UnknownName("joint", text, [text]),
        lambda text: BadValue(text, text, text),
        lambda text: BadFile(text, text),
    ],
)
def test_errors_and_warnings(kind, text):
    shown = str(kind(f"the knee{text} is bent"))
    assert is_printable(shown) and "knee" in shown


class TestStreams:
    @each
    def test_everything_that_is_printed(self, text, capsys):
        emit(f"{text}\n")
        complain(text)
        tell([warnings.WarningMessage(UserWarning(text), UserWarning, "a.py", 1, line="x")])
        print_result({"name": text, "text": align_lines([("name", text)])}, as_json=False)
        streams = capsys.readouterr()
        assert not raw(streams.out + streams.err)

    @each
    def test_json(self, text, capsys):
        print_result({"name": text, text: 1.0}, as_json=True)
        printed = capsys.readouterr().out
        assert json.loads(printed) == {"name": text, text: 1.0} and printed.isascii() and not raw(printed)

    @each
    def test_progress(self, text, monkeypatch):
        stream = io.StringIO()
        stream.isatty = lambda: True
        monkeypatch.setattr(sys, "stderr", stream)
        with progress() as show:
            show(f"drawing {text}")
        assert stream.getvalue() == f"\rdrawing {printable(text)}\033[K\r\033[K"

    @each
    def test_a_row_stays_a_row(self, text):
        assert align_lines([("name", text), ("other", "b")]).count("\n") == 1
        assert join_lines([text, text]).count("\n") == 1

    @each
    def test_words_of_the_command_line(self, text, capsys):
        with pytest.raises(SystemExit):
            main(["hop", f"--cycles={text}"])
        main(["dynamics", f"{text}.urdf"])
        streams = capsys.readouterr()
        assert streams.err.count("\n") == 2 and not raw(streams.err)


class TestFiles:
    """Names that cannot be seen are refused, the robot's of a trajectory, which may be a path, is written out."""

    XML = [text for name, text in HARMFUL.items() if name not in ("escape", "bell", "backspace", "lone surrogates")]

    @pytest.mark.parametrize("text", XML)
    @pytest.mark.parametrize(("tag", "name"), [("robot", "leg"), ("link", "foot"), ("joint", "hip")])
    def test_robots(self, tmp_path, tag, name, text):
        escaped = "".join(f"&#{ord(char)};" for char in text)
        path = tmp_path / "a.urdf"
        path.write_text(
            '<robot name="leg"><link name="base"/><link name="foot"/><joint name="hip" type="fixed">'
            '<parent link="base"/><child link="foot"/></joint></robot>'.replace(f'"{name}"', f'"{name}{escaped}"', 1)
        )
        with pytest.raises(
            BadFile, match=f"a.urdf:1: the name '{name}.*of <{tag}> has a character that cannot be seen"
        ):
            load(path)

    @each
    @pytest.mark.parametrize("where", ["coordinates", "toes", "actuated", "flows", "events", "phase"])
    def test_trajectories(self, tmp_path, where, text):
        path, meta, arrays = unpacked(tmp_path)
        if where == "phase":
            arrays["phase"] = np.array([f"{each}{text}" for each in arrays["phase"]])
        elif where == "events":
            meta["events"][0]["name"] += text
        else:
            meta[where][0] += text
            if where == "actuated":
                meta["coordinates"] = [*meta["coordinates"][:-2], *meta["actuated"]]
        with pytest.raises(BadFile, match="a.npz: is not a saved trajectory") as caught:
            Trajectory.load(packed(path, meta, arrays))
        assert not raw(str(caught.value))

    @each
    def test_the_robot_of_a_trajectory(self, tmp_path, monkeypatch, capsys, text):
        path, meta, arrays = unpacked(tmp_path)
        meta["robot"], meta["message"], meta["origin"] = f"leg{text}", text, None
        packed(path, {name: value for name, value in meta.items() if name != "origin"}, arrays)
        monkeypatch.chdir(tmp_path)
        assert main(["export", "a.npz", "--csv"]) == 0
        out = capsys.readouterr().out
        assert out.startswith("robot                leg\\") and out.count("\n") == 3 and not raw(out)
        read = Trajectory.load(path)
        assert not raw(repr(read)) and not raw(read.message)

    def test_lone_surrogates_in_a_text_file(self, tmp_path):
        assert write_text(tmp_path / "a.html", "a\udcff").read_text() == "a\\udcff"


def unpacked(folder):
    """A trajectory's path, its meta and its arrays."""
    path = trajectory(folder / "a.npz")
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    return path, json.loads(str(arrays.pop("meta"))), arrays


def packed(path, meta, arrays):
    """A trajectory's file, of these."""
    np.savez(path, meta=np.array(json.dumps(meta)), **arrays)
    return path
