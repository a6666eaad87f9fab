"""Numbers as people write them."""

import math

import pytest

from spear_pin.words import number, significant, whole


@pytest.mark.parametrize(
    ("word", "value"),
    [("5", 5.0), ("-.5", -0.5), ("+5.", 5.0), ("1e-3", 1e-3), ("1.5E+2", 150.0), (" 2 ", 2.0), ("-inf", -math.inf)],
)
def test_numbers(word, value):
    assert number(word) == value


def test_whole_numbers():
    assert (whole("12"), whole("-3"), whole("+0")) == (12, -3, 0)
    assert math.isnan(number("NaN"))


@pytest.mark.parametrize("word", ["", " ", "5_0", "٥٠", "0x5", "1e", "e5", ".", "1,5", "\u00a05", "5\n", "infinit"])
def test_what_is_none(word):
    for read in (number, whole):
        with pytest.raises(ValueError, match="not a"):
            read(word)


@pytest.mark.parametrize("word", ["5.0", "1e3", "9" * 301, "inf"])
def test_what_is_not_whole(word):
    with pytest.raises(ValueError, match="not a whole number"):
        whole(word)


@pytest.mark.parametrize(
    ("value", "digits", "written"),
    [(11.3456, 3, "11.3"), (0.0286479, 3, "0.0286"), (5.7e-5, 2, "0.000057"), (-4.0, 4, "-4.000"), (0.0, 3, "0.00")],
)
def test_digits_that_count(value, digits, written):
    assert significant(value, digits) == written
