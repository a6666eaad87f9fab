"""Files are written whole or not at all; JSON is read as what it is."""

import json
import os

import numpy as np
import pytest

from spear_pin import Gait, Trajectory
from spear_pin.errors import BadFile
from spear_pin.files import atomic, parse_json, plain, regular, write_text
from spear_pin.model.loading import load
from spear_pin.studies.identification.columns import read_columns


def test_writes(tmp_path):
    assert write_text(tmp_path / "new.txt", "Länge\n") == tmp_path / "new.txt"
    assert [file.name for file in tmp_path.iterdir()] == ["new.txt"]
    assert (tmp_path / "new.txt").read_bytes() == b"L\xc3\xa4nge\n"


def test_replaces(tmp_path):
    path = tmp_path / "old.txt"
    path.write_text("old")
    write_text(str(path), "new")
    assert path.read_text() == "new"


def test_nothing_is_at_the_path_before_the_block_ends(tmp_path):
    with atomic(tmp_path / "new.txt") as temporary:
        temporary.write_text("text")
        assert temporary.parent == tmp_path
        assert not (tmp_path / "new.txt").exists()


@pytest.mark.parametrize("problem", [ValueError, KeyboardInterrupt, OSError])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, problem):
    path = tmp_path / "old.txt"
    path.write_text("old")
    with pytest.raises(BadFile if problem is OSError else problem), atomic(path) as temporary:
        temporary.write_text("half of the ne")
        raise problem
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["old.txt"]


def test_a_failure_leaves_nothing_where_nothing_was(tmp_path):
    with pytest.raises(ValueError, match="halfway"), atomic(tmp_path / "new.txt") as temporary:
        temporary.write_text("half")
        raise ValueError("halfway")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("place", ["missing/new.txt", "folder", "file/new.txt"])
def test_where_nothing_can_be_written(tmp_path, place):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "inside").touch()
    (tmp_path / "file").touch()
    with pytest.raises(BadFile, match="cannot be written") as error:
        write_text(tmp_path / place, "text")
    assert place.split("/")[-1] in str(error.value) and "\n" not in str(error.value)
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]
    assert os.listdir(tmp_path / "folder") == ["inside"]


class TestJson:
    def test_reads_what_is_written(self):
        value = {"a": [1, -2, 0.5, 1e-300, -1e300, True, None, "NaN"], "b": {"c": {}}, "é": ""}
        again = parse_json(json.dumps(value))
        assert again == value and [type(item) for item in again["a"]] == [type(item) for item in value["a"]]

    @pytest.mark.parametrize(
        ("text", "part"),
        [
            ("", "Expecting value"),
            ("{", "Expecting"),
            ("[NaN]", "NaN is no finite number"),
            ("[-Infinity]", "-Infinity is no finite number"),
            ("[1e400]", "1e400 is no finite number"),
            ("-" + "9" * 5000, "is no finite number"),
            ('{"a": {"b": 1, "c": 2, "b": 1}}', "the key 'b' is there twice"),
            ("[" * 100_000, "nested too deep"),
            ('{"a":' * 100_000, "nested too deep"),
        ],
        ids=lambda value: value[:10],
    )
    def test_refuses(self, text, part):
        with pytest.raises(ValueError, match=part) as error:
            parse_json(text)
        assert len(str(error.value)) < 100


READERS = [regular, load, Gait.load, Trajectory.load, lambda path: read_columns(path, lambda names: names)]


@pytest.mark.parametrize("reader", READERS)
class TestOnlyFilesAreRead:
    """Nobody writes to the pipe: to open it would wait for ever."""

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
    @pytest.mark.parametrize("suffix", [".json", ".urdf", ".npz", ".csv", ".mat"])
    def test_no_pipe(self, tmp_path, reader, suffix):
        path = tmp_path / f"pipe{suffix}"
        os.mkfifo(path)
        with pytest.raises(BadFile, match=f"pipe{suffix}: is not a regular file"):
            reader(path)

    def test_no_directory(self, tmp_path, reader):
        with pytest.raises(BadFile, match="cannot be read: Is a directory"):
            reader(tmp_path / ".." / tmp_path.name)

    def test_no_device(self, reader):
        with pytest.raises(BadFile, match="/dev/zero: is not a regular file"):
            reader("/dev/zero")

    def test_nothing(self, tmp_path, reader):
        for path in (tmp_path / "none.csv", "a\0b.csv"):
            with pytest.raises(BadFile, match="cannot be read"):
                reader(path)


def test_what_json_has():
    found = plain({"a": np.array([1.0, np.nan]), "b": (1, 2j, None), "c": [{"d": -np.inf}], "e": np.int64(3), "f": "g"})
    assert found == {"a": [1.0, None], "b": [1, [0.0, 2.0], None], "c": [{"d": None}], "e": 3, "f": "g"}
    assert json.loads(json.dumps(found, allow_nan=False)) == found
