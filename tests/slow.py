"""Parameters of a test most of which take long: a few run always, and all in the gate."""

from collections.abc import Iterable

import pytest


def slow_but(values: Iterable, *quick) -> list:
    """The values, those that are not among the quick ones marked `slow`."""
    values = list(values)
    assert all(value in values for value in quick), f"{quick} of {values}"
    return [value if value in quick else pytest.param(value, marks=pytest.mark.slow) for value in values]
