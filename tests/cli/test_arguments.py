"""What commands refuse before they work."""

import tempfile
from pathlib import Path

import pytest

from tests.cli.calls import refused, words


@pytest.mark.parametrize(
    "command",
    [
        *(("hop",), ("bound",), ("push-test",), ("identify", "lab.csv"), ("search",), ("report",)),
        *(("export", "spear_ii", "--mjcf"), ("sweep", "hop", "--over", "stiffness=47,48")),
    ],
    ids=words,
)
def test_a_folder_that_takes_no_files(capsys, tmp_path, monkeypatch, command):
    """Whoever runs this may be allowed everything, so that it is the system that says no."""

    def full(*_, dir, **__):
        raise PermissionError(13, "Permission denied", str(dir))

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    out = tmp_path / "a.zarr" if command[0] == "sweep" else tmp_path
    text = refused(capsys, *command, "--out", out)
    assert f"--out is '{out}'" in text and "in which files can be written" in text
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("out", "said"),
    [
        ("k45", "`mkdir k45` makes it"),
        ("my runs", "`mkdir 'my runs'` makes it"),
        ("-1", "`mkdir -- -1` makes it"),
        ("runs/k45", "`mkdir -p runs/k45` makes it"),
        ("a_file", "expected an existing folder\n"),
        ("k" * 100, "expected an existing folder\n"),
    ],
)
def test_how_to_make_a_folder_is_said(capsys, tmp_path, monkeypatch, out, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a_file").touch()
    assert said in f"{refused(capsys, 'report', '--out', out)}\n"


def test_how_to_make_the_folder_of_a_sweep_is_said(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = refused(capsys, "sweep", "hop", "--over", "stiffness=47,48", "--out", "runs/a.zarr")
    assert "`mkdir runs` makes it" in text


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no /proc here")
def test_of_the_system(capsys):
    """Permissions alone would not tell."""
    assert "--out is '/proc'" in refused(capsys, "report", "--out", "/proc")


@pytest.mark.parametrize("number", ["5_0", "٥٠", "0x20", "1e", "5O", "- 5", "²"])
@pytest.mark.parametrize(
    "option", [("hop", "--stiffness"), ("hop", "--cycles"), ("search", "--stiffness-per-leg"), ("push-test", "--ratio")]
)
def test_numbers_are_written_in_plain_digits(capsys, option, number):
    assert repr(number) in refused(capsys, *option[:1], f"{option[1]}={number}")


def test_a_mistake_repeats_little_of_what_was_typed(capsys):
    for arguments in (["hop", "x" * 60_000], ["hop", "--cycles", "9" * 60_000], ["bound", "--gait", "x" * 60_000]):
        assert len(refused(capsys, *arguments)) < 2500
