"""One mistake: which text of which file, and the tests that have to notice."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Mutation:
    """One mistake.

    Attributes:
        name: what is wrong.
        file: where.
        old: the text that is replaced; it occurs once.
        new: the text that replaces it.
        tests: test files, in the order in which they are run.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


def mistakes_in(file: str, tests: Iterable[str], texts: Mapping[str, tuple[str, str]]) -> list[Mutation]:
    """Mutations of one file, by name."""
    files = tuple(f"tests/{test}.py" for test in tests)
    return [Mutation(name, f"spear_pin/{file}.py", old, new, files) for name, (old, new) in texts.items()]
