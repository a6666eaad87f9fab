"""Files are written whole or not at all."""

import os

import pytest

from spear_pin.errors import BadFile
from spear_pin.files import atomic


def write(path, text):
    with atomic(path) as temporary:
        temporary.write_text(text)


def test_writes(tmp_path):
    write(tmp_path / "new.txt", "text")
    assert [file.name for file in tmp_path.iterdir()] == ["new.txt"]
    assert (tmp_path / "new.txt").read_text() == "text"


def test_replaces(tmp_path):
    path = tmp_path / "old.txt"
    path.write_text("old")
    write(str(path), "new")
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
        write(tmp_path / place, "text")
    assert place.split("/")[-1] in str(error.value) and "\n" not in str(error.value)
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]
    assert os.listdir(tmp_path / "folder") == ["inside"]
