"""Errors: one base class, one line, and what a caller needs to act on them."""

import math
import pickle
import time

import numpy as np
import pytest
import sympy as sp

import spear_pin
from spear_pin.errors import BadFile, BadValue, NoGait, SpearError, UnknownName, require

ERRORS = [
    UnknownName("robot", "spear_iii", ["spear_ii", "q_spear"]),
    UnknownName("toe", "foot", []),
    BadValue("rtol", 1.0, "a number from 1e-13 to 1e-2"),
    BadFile("a/b.urdf", "not well-formed", 12),
    BadFile("a/b.urdf", "cannot be read"),
    NoGait("Newton's method makes no progress", 0.123),
]

each_error = pytest.mark.parametrize("error", ERRORS, ids=str)


@each_error
def test_one_base_class_and_one_line(error):
    assert isinstance(error, SpearError) and isinstance(error, spear_pin.SpearError)
    assert str(error) and "\n" not in str(error)


def test_say_what_was_wrong_and_what_would_be_right():
    unknown, none, value, at_line, file, gait = ERRORS
    assert str(unknown) == "unknown robot 'spear_iii'; valid: spear_ii, q_spear"
    assert (unknown.kind, unknown.value, unknown.valid) == ("robot", "spear_iii", ("spear_ii", "q_spear"))
    assert str(none).endswith("valid: none")
    assert str(value) == "rtol is 1.0; expected a number from 1e-13 to 1e-2"
    assert (value.name, value.value) == ("rtol", 1.0)
    assert str(at_line) == "a/b.urdf:12: not well-formed" and at_line.line == 12
    assert str(file) == "a/b.urdf: cannot be read" and file.line is None
    assert "0.123" in str(gait) and gait.residual == 0.123 and gait.reason in str(gait)


def test_of_many_names_the_nearest_three_and_how_to_list_all():
    names = [f"robot_{n}" for n in range(40)] + ["Spear_II", "q_spear"]
    error = UnknownName("robot", "spear_i", names, "the path of a file")
    assert str(error) == (
        "unknown robot 'spear_i'; nearest of 42: Spear_II, q_spear, robot_0, or the path of a file;"
        " 'help' in its place lists all"
    )
    assert error.valid == tuple(names)
    listed = UnknownName("robot", "help", 100 * names, "the path of a file")
    assert str(listed).startswith("each valid robot: robot_0, ") and "Spear_II, q_spear, robot_0" in str(listed)
    assert " ... " not in str(listed) and str(listed).endswith(", or the path of a file")


@pytest.mark.parametrize("value", ["", "x" * 10**6, "\u2603", None, 5, ["a"], "\udcff"])
@pytest.mark.parametrize("names", [[], ["a"], ["a" * 10**5, "b"], [f"name_{n}" for n in range(5000)]], ids=len)
def test_it_takes_little_whatever_is_asked(value, names):
    begun = time.process_time()
    text = str(UnknownName("name", value, names))
    assert len(text) < 2500 and text.isprintable() or value == "\udcff"
    assert time.process_time() - begun < 0.5


def test_what_is_of_any_length_is_shown_in_part():
    for error in (UnknownName("toe", "x" * 60_000, ["toe"]), BadValue("x", "x" * 60_000, "less")):
        assert "xxx..." in str(error) and len(str(error)) < 300
    file = BadFile("a/" + "x" * 60_000 + "/b", "cannot be read")
    assert str(file).startswith("a/x") and str(file).endswith("/b: cannot be read") and len(str(file)) < 2500


@each_error
def test_survive_pickling(error):
    """So that they can be raised in another process."""
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error) and vars(again) == vars(error)


class TestRequire:
    def test_passes(self):
        require("x", 1.0, lambda x: x > 0, "a number > 0")
        require("x", sp.Symbol("x"), lambda x: x > 0, "a number > 0")

    @pytest.mark.parametrize(
        "value", [-1, -1.0, np.float64(-1.0), np.int64(-1)], ids=lambda value: type(value).__name__
    )
    def test_refuses(self, value):
        with pytest.raises(BadValue, match="x is .*-1.*; expected a number > 0"):
            require("x", value, lambda x: x > 0, "a number > 0")

    @pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, np.float64(math.nan)])
    def test_refuses_what_is_not_finite(self, value):
        with pytest.raises(BadValue):
            require("x", value, lambda x: True, "anything")

    @pytest.mark.parametrize("value", ["1", None, [1.0], True, np.ones(2)], ids=repr)
    def test_refuses_what_is_no_number(self, value):
        with pytest.raises(BadValue):
            require("x", value, lambda x: x > 0, "a number > 0")
