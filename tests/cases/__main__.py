"""`python -m tests.cases`, with words that kinds and names of some cases contain, or without for all."""

from __future__ import annotations

import sys

import numpy as np

from tests.cases.case import all_cases, outcome

WIDTHS = (34, 34, 30)


def main(words: list[str]) -> int:
    """Print a line a case; 1 if one is not right, or there is none."""
    cases = [case for case in all_cases() if all(word in f"{case.kind} {case.name}" for word in words)]
    wrong = 0
    for case in cases:
        found = outcome(case)
        wrong += not found.right
        cells = (f"{case.kind}", case.name, _brief(case.right))
        row = "  ".join(cell[:width].ljust(width) for cell, width in zip(cells, WIDTHS, strict=True))
        print(f"{'yes' if found.right else 'NO '}  {row}  {_brief(found.value) if not found.right else case.found}")
    print(f"{len(cases)} cases, {wrong} not right")
    return 1 if wrong or not cases else 0


def _brief(value: object) -> str:
    return value if isinstance(value, str) else np.array2string(np.asarray(value, dtype=float), precision=5)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
