"""A mistake in a function of one's own comes out as itself: what it is in, where, and the exception as the cause."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import find_gait, simulate, simulate_many
from spear_pin.errors import BadFunction, NotSymbolic, SpearError
from spear_pin.hybrid import own
from tests.hybrid import mistaken
from tests.hybrid.mistaken import MISTAKES, guard, jump, latch, law, plain

START = plain().guess()
TWO = tuple(np.tile(part, (2, 1)) for part in START)


def check(error, case):
    assert isinstance(error, SpearError) and "\n" not in str(error)
    assert case.what in str(error) and case.says in str(error)
    assert error.file == mistaken.__file__ and f"{mistaken.__file__}:{error.line}" in str(error)
    if case.cause is not None:
        assert type(error.__cause__) is case.cause
    if case.cause is NameError:  # the very line, not the one where the function begins
        with open(mistaken.__file__) as lines:
            assert "undefined_name" in lines.read().splitlines()[error.line - 1]


class TestMistakes:
    @pytest.mark.parametrize("name", MISTAKES)
    def test_come_out_of_a_run(self, name):
        case = MISTAKES[name]
        with pytest.raises(BadFunction) as raised:
            simulate(case.system(), START, progress=False)
        check(raised.value, case)

    @pytest.mark.extra("heyoka")
    @pytest.mark.parametrize("name", [name for name, case in MISTAKES.items() if case.symbolic])
    def test_come_out_of_lanes(self, name):
        case = MISTAKES[name]
        with pytest.raises(BadFunction) as raised:
            simulate_many(case.system(), *TWO)
        check(raised.value, case)

    @pytest.mark.extra("heyoka")
    @pytest.mark.parametrize("name", ["1/0 after lift-off", "a torque too many", "1/0 in a latch", "1/0 in a jump"])
    def test_come_out_of_twenty_lanes(self, name):
        case = MISTAKES[name]
        with pytest.raises(BadFunction) as raised:
            simulate_many(case.system(), *(np.tile(part, (20, 1)) for part in START))
        check(raised.value, case)

    @pytest.mark.extra("heyoka")
    @pytest.mark.parametrize("name", [name for name, case in MISTAKES.items() if not case.symbolic])
    def test_that_branch_are_not_for_symbols(self, name):
        with pytest.raises(NotSymbolic, match=r"does not take symbols .*mistaken.py:\d+\)"):
            simulate_many(MISTAKES[name].system(), *TWO)

    def test_come_out_of_a_search(self):
        with pytest.raises(BadFunction, match="'stance_torqe'"):
            find_gait(MISTAKES["a misspelt parameter"].system())


class TestNoMistakes:
    """What is as it should be, or no mistake of a function."""

    @pytest.mark.parametrize(
        "torques",
        [
            lambda *_: (0, 5),
            lambda *_: [0.0, 5.0],
            lambda *_: np.array([0.0, 5.0]),
            lambda *_: (np.float64(0.0), np.int64(5)),
            lambda *_: (each for each in (0.0, 5.0)),
        ],
    )
    @pytest.mark.parametrize("engine", ["reference", pytest.param("lanes", marks=pytest.mark.extra("heyoka"))])
    def test_constant_torques_of_any_kind(self, torques, engine):
        system = law(torques, "flight")()
        if engine == "reference":
            q = simulate(law(lambda *_: (0.0, 5.0), "flight")(), START, progress=False).q[-1]
            np.testing.assert_array_equal(simulate(system, START, progress=False).q[-1], q)
        else:
            found = [simulate_many(each, *TWO).q for each in (system, law(lambda *_: (0.0, 5.0), "flight")())]
            np.testing.assert_array_equal(*found)

    @pytest.mark.parametrize(
        "system",
        [
            law(lambda t, *_: (0.0, math.exp(1e5) if t > 0.05 else 0.0)),
            law(lambda t, *_: (0.0, np.linalg.solve(np.zeros((2, 2)), np.ones(2))[0])),
            latch(lambda q, v, held, p: {"x": math.exp(1e5 * ("taut" in held))}),
            jump(lambda q, v, held, p, ops: (q, [*v[:2], math.exp(1e5)])),
        ],
    )
    def test_numbers_that_are_too_large_and_singular_matrices_end_the_run(self, system):
        assert simulate(system(), START, progress=False).reason in ("not_finite", "step_size")

    def test_a_guard_without_a_value_beyond_an_event(self):
        """Where the motion does not come to."""
        beyond = guard(lambda t, q, v, held, p, dyn, ops: 1.0 + math.sqrt(dyn.height("toe") + 1e-7))
        assert simulate(beyond(), START, progress=False).reason == "complete"


def test_an_error_survives_pickling():
    error = own.mistake("law of domain 'stance'", law, "it gives None")
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is BadFunction and str(again) == str(error) and again.line == error.line
    assert str(replace(MISTAKES["1/0"], says=str(error)).says).startswith("law of domain 'stance' (law, /")
