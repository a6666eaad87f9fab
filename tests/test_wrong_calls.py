"""A part of the calls that are wrong; `python -m tests.wrong_calls` makes all."""

import pytest

from tests.wrong_calls.run import answered_badly, everything

PART = 96  # of as many
TURNS = 2  # in which they are made


def test_they_are_many_and_all_different():
    cases = everything()
    assert len(cases) >= 400 and len({case.name for _, case in cases}) == len(cases)


@pytest.mark.slow
@pytest.mark.parametrize("turn", range(TURNS))
def test_a_part_of_them(turn):
    """Of each kind; processes are slower than the rest."""
    found = everything()
    part = [i for i, (kind, _) in enumerate(found) if i % (PART if kind != "processes" else 2 * PART) == 0]
    chosen = part[turn::TURNS]
    problems = answered_badly(chosen)
    assert not problems, "\n".join(f"{found[i][1].name}: {problem}" for i, problem in problems.items())
