"""Marks the tests that `nightly.toml` leaves to the nightly, each with a test that guards the same in the gate."""

import re
import tomllib
from collections import defaultdict
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import pytest

FILE = Path(__file__).with_name("nightly.toml")


@cache
def guards() -> dict[str, str]:
    """Patterns of tests that are left to the nightly, and of those that guard the same."""
    groups = tomllib.loads(FILE.read_text(encoding="utf-8"))
    return {left: guard for group in groups.values() for left, guard in group.items()}


@cache
def matching(pattern: str) -> re.Pattern[str]:
    """The names of tests that a pattern stands for; `*` is anything, but in the name of the file."""
    return re.compile(".*".join(map(re.escape, pattern.split("*"))))


def left_to_the_nightly(items: Sequence[pytest.Item], whole: bool) -> None:
    """Mark tests.

    Args:
        items: the tests that were collected.
        whole: whether these are all, so that each pattern has to stand for some.

    Raises:
        UsageError: a pattern stands for no test, or each of its guards is itself left to the nightly.
    """
    names, files = {item.nodeid: item for item in items}, defaultdict[str, list[str]](list)
    for name in names:
        files[name.partition("::")[0]].append(name)

    def called(pattern: str) -> list[str]:
        return [name for name in files[pattern.partition("::")[0]] if matching(pattern).fullmatch(name)]

    left = {pattern: called(pattern) for pattern in guards()}
    for name in {name for found in left.values() for name in found}:
        names[name].add_marker(pytest.mark.nightly)
        names[name].add_marker(pytest.mark.slow)
    if not whole:
        return
    for pattern, guard in guards().items():
        kept = called(guard)
        if not left[pattern]:
            raise pytest.UsageError(f"{FILE.name}: no test is called {pattern}")
        if all(names[name].get_closest_marker("nightly") for name in kept):
            raise pytest.UsageError(f"{FILE.name}: {pattern} has no guard in the gate called {guard}")
