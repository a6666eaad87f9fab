"""Files that were made to do harm; `python -m tests.hostile` gives all of them to who reads them."""

import pytest

from tests.hostile.case import MEMORY, withstood
from tests.hostile.run import everything
from tests.wrong_calls.case import Answer, judged
from tests.wrong_calls.run import answered_badly

PART = 12  # of as many
QUICK = (  # one of each kind, or two
    *(
        "URDF: a billion laughs (",
        "URDF: 100,000 attributes",
        "MJCF: that includes itself (",
        "TOML: a key of 100,000 parts",
    ),
    *("SRDF: states with escapes", "a.urdf of 100 GB", "a.json of 100 GB", "trajectory: a robot with escapes"),
    *("trajectory: a coordinate with C1", "trajectory: forces of 1e308, drawn", "trajectory: a bomb beside"),
    *("gait: a law with marks of direction", "log: a unit with escapes", "mesh: nodes that put nodes"),
    *("mesh: 100,000 materials", "mesh elsewhere: a device (", "mesh elsewhere: the network"),
    *("a robot's file with ends of lines, exported", "a robot, a link and a joint with dashes (spear export"),
    "a trajectory's file that is no UTF-8",
)
CASES = everything()


def test_they_are_many_and_all_different():
    assert len(CASES) >= 200 and len({case.name for _, case in CASES}) == len(CASES)


@pytest.mark.parametrize("begins", QUICK)
def test_some(begins):
    case = next(case for _, case in CASES if f"{case.name} (".startswith(begins))
    problem, _ = judged(case)
    assert not problem


@pytest.mark.slow
@pytest.mark.parametrize(
    "begins", ["a page that plays, with names of the end of a script", "a page that plays, with names of a template"]
)
def test_no_script_runs(begins):
    case = next(case for _, case in CASES if case.name == begins)
    assert not judged(case)[0]


@pytest.mark.slow
def test_a_part_of_all():
    """In a process of its own, where memory is measured."""
    chosen = [i for i in range(len(CASES)) if i % PART == 0]
    problems = answered_badly(chosen, everything, MEMORY)
    assert not problems, "\n".join(f"{CASES[i][1].name}: {problem}" for i, problem in problems.items())


@pytest.mark.parametrize(
    ("answer", "problem"),
    [
        (Answer(0, "all is well\n", "", ("a.csv",)), ""),
        (Answer(2, "", "spear: no\n", ()), ""),
        (Answer(1, "", "spear: no\n", ()), "status 1"),
        (Answer(2, "", "Traceback\n", ()), "a traceback"),
        (Answer(2, "", "spear: no\nnor that\n", ()), "2 lines of complaint"),
        (Answer(0, "", "spear: a\n" * 9, ()), "9 lines of complaint"),
        (Answer(2, "", f"spear: {'x' * 3000}\n", ()), "a line that has no end"),
        (Answer(0, "a\x9b31m", "", ()), r"raw on the terminal: '\x9b'"),
        (Answer(0, "", "a\u202eb", ()), r"raw on the terminal: '\u202e'"),
        (Answer(2, "", "spear: no\n", ("a.csv",)), "refused, and left: a.csv"),
    ],
)
def test_what_is_withstood(answer, problem):
    assert withstood(answer, (0, 2)) == problem
