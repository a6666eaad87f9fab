"""Give every hostile file, or those whose names contain the words that are given, to who reads it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from tests.hostile import data, meshes, names, pages, robots
from tests.hostile.case import MEMORY
from tests.wrong_calls import run
from tests.wrong_calls.case import Case

KINDS = {"robots": robots, "data": data, "meshes": meshes, "names": names, "pages": pages}


def everything() -> list[tuple[str, Case]]:
    """All cases with what they are about; no two have the same name."""
    found: list[tuple[str, Case]] = [(kind, case) for kind, module in KINDS.items() for case in module.cases()]
    twice = Counter(case.name for _, case in found)
    assert twice.most_common(1)[0][1] == 1, twice.most_common(5)
    return found


def main(words: Sequence[str] = ()) -> int:
    """Give the files to who reads them, and say which are not withstood; 1 if one is not."""
    return run.main(words, everything, MEMORY, "hostile files")
