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
    seconds = "".join(f'"tests/{folder}" = {10 * n}\n' for n, folder in enumerate("abcde", 1))
    path.write_text(f'[quick]\nfirst = ["tests/b/test_b.py"]\n[quick.seconds]\n{seconds}', encoding="utf-8")
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
@pytest.mark.parametrize(
    ("seconds", "over"),
    [
        ({"a": 49.0}, []),
        ({"a": 57.0}, ["a"]),
        ({"a": 69.0, "b": 40.0, "c": 60.0, "d": 80.0, "e": 51.0}, []),  # the machine is twice as slow
        ({"a": 71.0, "b": 40.0, "c": 60.0, "d": 80.0, "e": 49.0}, ["a"]),
        ({"a": 89.0, "b": 149.0, "c": 211.0, "d": 240.0, "e": 300.0}, ["c"]),  # slower than any may be
        ({"f": 0.1}, ["f"]),
    ],
)
def test_a_folder_beyond_its_budget_fails_the_run(seconds, over):
    taken = {"a": 10.0, "b": 20.0, "c": 30.0, "d": 40.0, "e": 50.0} | seconds
    plugin = told(Durations(None, "quick"), *((f"tests/{a}/test.py::test", "call", s) for a, s in taken.items()))
    session = SimpleNamespace(exitstatus=pytest.ExitCode.OK, config=SimpleNamespace())
    plugin.pytest_sessionfinish(session)
    assert (session.exitstatus == pytest.ExitCode.TESTS_FAILED) == bool(over)
    assert [each.split(" took")[0] for each in plugin.exceeded()] == [f"tests/{folder}" for folder in over]


@pytest.mark.usefixtures("budgets")
def test_files_that_take_longest_begin():
    items = [SimpleNamespace(nodeid=f"tests/{name}::test") for name in ("a/test_a.py", "b/test_b.py", "c/test_c.py")]
    Durations(None, "quick").pytest_collection_modifyitems(items)
    assert [item.nodeid for item in items][0] == "tests/b/test_b.py::test"


def test_budgets_name_what_there_is():
    for budget in tomllib.loads(durations.BUDGETS.read_text(encoding="utf-8")).values():
        assert all((ROOT / name).exists() for name in (*budget["first"], *budget["seconds"]))
