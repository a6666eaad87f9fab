"""Results kept in the user's cache folder."""

import os
from pathlib import Path

import pytest

from spear_pin.viz.report import cache
from spear_pin.viz.report.cache import Cache, package_state, user_cache


def test_what_is_put_is_got_back_as_long_as_the_state_is_the_same(tmp_path):
    before = Cache(tmp_path / "new", "state")
    assert before.get("a") is None
    before.put("a", b"1")
    before.put("b", b"2")
    assert (before.get("a"), before.get("b")) == (b"1", b"2")
    assert Cache(tmp_path / "new", "other").get("a") is None


def test_it_stays_within_its_size(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "MOST_BYTES", 160)
    kept = Cache(tmp_path, "state")
    for age, name in enumerate("abc"):
        kept.put(name, b"0123456789")
        os.utime(kept._path(name), (age, age))
    kept.put("d", b"0123456789")
    assert [kept.get(name) is not None for name in "abcd"] == [False, False, True, True]
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) <= 160


@pytest.mark.parametrize("junk", [b"", b"junk", b"\xff\x00\n", b"{}\n{}", None], ids=repr)
def test_what_something_else_has_left_there_is_a_miss(tmp_path, monkeypatch, junk):
    monkeypatch.setattr(cache, "MOST_BYTES", 100)
    kept = Cache(tmp_path, "state")
    kept.put("a", b"1")
    path = kept._path("a")
    for content in (junk, path.read_bytes()[:-1], path.read_bytes() + b"2", bytes(101)):
        path.unlink()
        os.mkfifo(path) if content is None else path.write_bytes(content)
        assert kept.get("a") is None
    path.unlink()
    path.mkdir()
    kept.put("a", b"1")
    assert kept.get("a") is None


def test_a_folder_that_cannot_be_written_does_no_harm(tmp_path):
    (tmp_path / "file").write_text("")
    kept = Cache(tmp_path / "file" / "folder", "state")
    kept.put("a", b"1")
    assert kept.get("a") is None


@pytest.mark.parametrize("given", ["", "elsewhere"])
def test_folder_of_the_user(tmp_path, monkeypatch, given):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / given) if given else "")
    assert user_cache().folder == tmp_path / (given or ".cache") / "spear_pin"


def test_the_state_is_that_of_the_package_and_its_libraries(tmp_path, monkeypatch):
    package = tmp_path / "package"
    (package / "inner").mkdir(parents=True)
    (package / "inner" / "a.py").write_text("1")
    (package / "notes.txt").write_text("1")
    monkeypatch.setattr(cache, "files", lambda name: Path(package))
    first = package_state()
    (package / "notes.txt").write_text("2")
    assert package_state() == first
    (package / "inner" / "a.py").write_text("2")
    assert package_state() != first
    (package / "inner" / "a.py").write_text("1")
    assert package_state() == first
    monkeypatch.setattr(cache, "version", lambda name: "0")
    assert package_state() != first
