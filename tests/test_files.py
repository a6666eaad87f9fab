"""Files are written whole or not at all; JSON is read as what it is."""

import json
import os
import resource

import numpy as np
import pytest

from spear_pin import Gait, Trajectory
from spear_pin.errors import BadFile
from spear_pin.files import atomic, parse_json, plain, read_bytes, regular, scratch, together, write_text
from spear_pin.model.loading import load
from spear_pin.studies.tables.columns import read_columns


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


class TestTogether:
    """Files of one command get their names together."""

    def test_at_the_end_or_when_told(self, tmp_path):
        with together() as files:
            write_text(tmp_path / "a", "a")
            assert not (tmp_path / "a").exists()
            files.place()
            assert (tmp_path / "a").read_text() == "a"
            write_text(tmp_path / "b", "b")
            write_text(tmp_path / "b", "B")
            assert not (tmp_path / "b").exists()
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "a", "b": "B"}

    @pytest.mark.parametrize("problem", [BadFile("c", "cannot be written"), OSError(28, "No space left on device")])
    def test_none_where_one_cannot_be_written_for_another_reason(self, tmp_path, problem):
        (tmp_path / "a").write_text("old")
        with pytest.raises(type(problem)), together():
            write_text(tmp_path / "a", "new")
            write_text(tmp_path / "b", "new")
            raise problem
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "old"}

    @pytest.mark.parametrize("problem", [ValueError, KeyboardInterrupt, SystemExit])
    def test_those_that_are_whole_where_it_is_interrupted(self, tmp_path, problem):
        with pytest.raises(problem), together():
            write_text(tmp_path / "a", "new")
            with atomic(tmp_path / "b") as path:
                path.write_text("half")
                raise problem
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "new"}

    def test_one_file_by_two_names(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        with together():
            write_text("a", "first")
            write_text(tmp_path / "a", "second")
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "second"}

    def test_a_second_try_that_fails_leaves_the_first(self, tmp_path):
        with together():
            write_text(tmp_path / "a", "first")
            with pytest.raises(BadFile), atomic(tmp_path / "a"):
                raise OSError(28, "No space left on device")
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "first"}

    def test_none_where_one_cannot_be_written(self, tmp_path):
        (tmp_path / "b").mkdir()
        with pytest.raises(BadFile, match="b: cannot be written: Is a directory"), together():
            write_text(tmp_path / "a", "new")
            write_text(tmp_path / "b", "new")
        assert os.listdir(tmp_path) == ["b"]

    @pytest.mark.parametrize("links", [True, False])
    def test_all_is_as_before_where_one_cannot_have_its_name(self, tmp_path, monkeypatch, links):
        """Such as one that became a folder meanwhile, also in a folder that takes no links."""
        if not links:
            monkeypatch.setattr(os, "link", lambda *_, **__: os.rmdir(tmp_path / "none"))
        (tmp_path / "a").write_text("old")
        with pytest.raises(BadFile, match="c: cannot be"), together():
            for name in "abcd":
                write_text(tmp_path / name, "new")
            (tmp_path / "c").mkdir()
            (tmp_path / "c" / "inside").touch()
        assert sorted(os.listdir(tmp_path)) == ["a", "c"]
        assert (tmp_path / "a").read_text() == "old"

    def test_stores_do_not_wait(self, tmp_path):
        with pytest.raises(OSError), together():
            write_text(tmp_path / "store", "kept", at_once=True)
            raise OSError
        assert os.listdir(tmp_path) == ["store"]

    def test_what_is_read_again_does_not_wait(self, tmp_path):
        with pytest.raises(OSError), together():
            with scratch() as folder:
                assert write_text(folder / "a", "read").read_text() == "read"
            write_text(tmp_path / "b", "waits")
            assert os.listdir(tmp_path) != ["b"] and not folder.exists()
            raise OSError

    def test_a_forked_process_writes_for_itself(self, tmp_path):
        with pytest.raises(OSError), together():
            if not (child := os.fork()):
                write_text(tmp_path / "of the child", "text")
                os._exit(0)
            os.waitpid(child, 0)
            write_text(tmp_path / "of the parent", "text")
            raise OSError
        assert os.listdir(tmp_path) == ["of the child"]


class TestReading:
    def test_so_much_and_no_more(self, tmp_path):
        path = tmp_path / "a"
        path.write_bytes(b"12345")
        assert read_bytes(path, 5) == b"12345"
        with pytest.raises(BadFile, match="a: has more than 4 bytes"):
            read_bytes(path, 4)

    @pytest.mark.parametrize(
        ("name", "read"),
        [
            ("a.json", Gait.load),
            ("a.urdf", load),
            ("a.xml", load),
            ("a.toml", load),
            ("a.csv", read_columns),
            ("a.mat", read_columns),
            ("a.npz", Trajectory.load),
        ],
    )
    @pytest.mark.parametrize("size", [10**9, 2**40])
    @pytest.mark.parametrize("begun", [b"", b"time,voltage\n0,1\n", b"{", b"<robot>", b"PK\x03\x04"])
    def test_a_sparse_file_of_terabytes_is_refused_at_once(self, tmp_path, name, read, begun, size):
        path = tmp_path / name
        path.write_bytes(begun)
        os.truncate(path, size)
        used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        with pytest.raises(BadFile):
            read(path, lambda names: names) if read is read_columns else read(path)
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - used < 2**18  # kB
