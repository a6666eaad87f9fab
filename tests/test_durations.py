"""Durations of tests: added up by folder, held against budgets."""

import json
import tomllib
from types import SimpleNamespace

import pytest

from tests import durations
from tests.durations import ROOT, Durations


@pytest.fixture
def budgets(tmp_path, monkeypatch):
    path = tmp_path / "budgets.toml"
    path.write_text('[quick]\nfirst = ["tests/b/test_b.py"]\n[quick.seconds]\n"tests/a" = 5\n', encoding="utf-8")
    monkeypatch.setattr(durations, "BUDGETS", path)


def told(plugin: Durations, *phases: tuple[str, str, float]) -> Durations:
    for test, when, seconds in phases:
        plugin.pytest_runtest_logreport(SimpleNamespace(nodeid=test, when=when, processor_time=seconds))
    return plugin


def test_phases_are_added_up_by_folder_and_written(tmp_path):
    plugin = told(
        Durations(tmp_path / "d.json", None),
        *(("tests/a/test_a.py::test[1]", when, 1.0) for when in ("setup", "call", "teardown")),
        ("tests/a/test_b.py::test", "call", 0.25),
    )
    lines = []
    plugin.pytest_terminal_summary(SimpleNamespace(write_line=lines.append))
    assert lines == ["processor time 3 s: tests/a 3 s"]
    kept = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    assert kept["folders"] == {"tests/a": 3.25} and kept["files"]["tests/a/test_a.py"] == 3.0
    assert kept["tests"] == {"tests/a/test_a.py::test[1]": 3.0}


@pytest.mark.usefixtures("budgets")
@pytest.mark.parametrize(("folder", "seconds", "over"), [("a", 4.0, False), ("a", 6.0, True), ("c", 0.1, True)])
def test_a_folder_beyond_its_budget_fails_the_run(folder, seconds, over):
    plugin = told(Durations(None, "quick"), (f"tests/{folder}/test.py::test", "call", seconds))
    session = SimpleNamespace(exitstatus=pytest.ExitCode.OK, config=SimpleNamespace())
    plugin.pytest_sessionfinish(session)
    assert (session.exitstatus == pytest.ExitCode.TESTS_FAILED) == over
    assert bool(plugin.exceeded()) == over


@pytest.mark.usefixtures("budgets")
def test_files_that_take_longest_begin():
    items = [SimpleNamespace(nodeid=f"tests/{name}::test") for name in ("a/test_a.py", "b/test_b.py", "c/test_c.py")]
    Durations(None, "quick").pytest_collection_modifyitems(items)
    assert [item.nodeid for item in items][0] == "tests/b/test_b.py::test"


def test_budgets_name_what_there_is():

    for budget in tomllib.loads(durations.BUDGETS.read_text(encoding="utf-8")).values():
        assert all((ROOT / name).exists() for name in (*budget["first"], *budget["seconds"]))
