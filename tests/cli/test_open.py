"""`--open`: every command that writes a page or a picture has it, and shows what it wrote once that is there."""

import argparse

import pytest

from spear_pin.cli import _parser
from tests.cli.calls import printed, refused

# robots are listed, gaits are files of numbers, and what a shell reads is no page
WITHOUT = {"robots", "measures", "dynamics", "search", "references", "doctor", "completion"}


def commands():
    (group,) = (each for each in _parser()._actions if isinstance(each, argparse._SubParsersAction))
    return group.choices


def test_commands_that_have_it():
    having = {name for name, command in commands().items() if "--open" in command._option_string_actions}
    assert having == set(commands()) - WITHOUT


@pytest.fixture
def opened(monkeypatch):
    pages = []
    monkeypatch.setattr("webbrowser.open", pages.append)
    return pages


@pytest.mark.slow
def test_an_identification(capsys, tmp_path, opened):
    printed(capsys, "push-test", "--write-csv", "lab", "--repeats", "1", "--out", tmp_path)
    asked = "identify", tmp_path / "lab.csv", "--volts-per-rad", "1.06", "--offset", "0.4", "--out", tmp_path
    printed(capsys, *asked)
    assert opened == []
    printed(capsys, *asked, "--open")
    assert opened == [(tmp_path / "identify.svg").as_uri()]


@pytest.mark.extra("heyoka", "joblib", "xarray", "zarr")
def test_a_map(capsys, tmp_path, opened):
    out = tmp_path / "map.zarr"
    printed(capsys, "sweep", "hop", "--over", "stiffness=48,49", "--flight-time", "0.2", "--out", out, "--open")
    assert opened == [(tmp_path / "map.svg").as_uri()]


def test_a_part_of_the_report(capsys, tmp_path, opened):
    printed(capsys, "report", "--only", "table-2.4*", "--no-cache", "--out", tmp_path, "--open")
    assert opened == [(tmp_path / "report.html").as_uri()]


def test_of_an_export_without_a_picture(capsys, tmp_path, opened):
    text = refused(capsys, "export", "spear_ii", "--mjcf", "--open", "--out", tmp_path)
    assert "--open is True" in text and "--png or --mp4" in text
    assert list(tmp_path.iterdir()) == [] and opened == []
