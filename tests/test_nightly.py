"""Tests that are left to the nightly are there, and have a guard in the gate."""

from types import SimpleNamespace

import pytest

from tests import nightly


def items(*names):
    made = []
    for name in names:
        marks = []
        made.append(
            SimpleNamespace(
                nodeid=name,
                marks=marks,
                add_marker=marks.append,
                get_closest_marker=lambda wanted, marks=marks: next((m for m in marks if m.name == wanted), None),
            )
        )
    return made


@pytest.fixture(autouse=True)
def one_rule(monkeypatch):
    monkeypatch.setattr(nightly, "guards", lambda: {"a.py::test_all[*-slow]": "a.py::test_all[quick]"})


def test_marks_what_is_named():
    few = items("a.py::test_all[1-slow]", "a.py::test_all[quick]", "a.py::test_all[slow]")
    nightly.left_to_the_nightly(few, whole=True)
    assert [[mark.name for mark in item.marks] for item in few] == [["nightly", "slow"], [], []]


def test_a_name_of_no_test():
    nightly.left_to_the_nightly(items("a.py::test_all[quick]"), whole=False)
    with pytest.raises(pytest.UsageError, match=r"no test is called a.py::test_all\[\*-slow\]"):
        nightly.left_to_the_nightly(items("a.py::test_all[quick]"), whole=True)


def test_a_guard_that_is_none():
    with pytest.raises(pytest.UsageError, match="has no guard in the gate called"):
        nightly.left_to_the_nightly(items("a.py::test_all[1-slow]"), whole=True)
