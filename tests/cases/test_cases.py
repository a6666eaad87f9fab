"""Every case comes out right, and where its right value can be found anew, that is still right."""

from collections import Counter

import pytest

from tests.cases.__main__ import main
from tests.cases.case import Case, all_cases, outcome

ALL = all_cases()
FOUND_ANEW = [
    pytest.param(case, marks=[pytest.mark.extra(*case.needs)] if case.needs else [])
    for case in ALL
    if case.by is not None
]


def named(case):
    return f"{case.kind}: {case.name}" if isinstance(case, Case) else None


@pytest.mark.parametrize("case", ALL, ids=named)
def test_case(case):
    found = outcome(case)
    assert found.right, found.value


@pytest.mark.parametrize("case", FOUND_ANEW, ids=named)
def test_right_value(case):
    found = outcome(case, case.by)
    assert found.right, found.value


def test_names_are_unique():
    assert max(Counter(map(named, ALL)).values()) == 1


def test_table(capsys):
    kind = ALL[0].kind
    assert main([kind]) == 0
    *rows, last = capsys.readouterr().out.splitlines()
    assert all(row.startswith("yes  ") for row in rows) and last == f"{len(rows)} cases, 0 not right"
    assert main(["no such kind"]) == 1
