"""Cells of a table that should hold a number and hold something else, and what to write there."""

from __future__ import annotations

import re

LONGEST = 100  # characters of a cell that is looked at
_FORTRAN = re.compile(r"([+-]?\d+\.?\d*|[+-]?\.\d+)[dD]([+-]?\d+)")
_WITH_UNIT = re.compile(r"([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*(?:[^\W\d_]+|°)")
_DATE = re.compile(r"\d[-/.:]\d+[-/.:]\d")


def find_remedy(cell: str) -> str:
    """Finds what to write instead of a cell that holds no number; the text is an order."""
    cell = cell.strip()
    if len(cell) > LONGEST:  # the patterns take a time that grows with its square
        return "write a number"
    if found := _FORTRAN.fullmatch(cell):
        return f"write {found[1]}E{found[2]}"
    if found := _WITH_UNIT.fullmatch(cell):
        return f"write {found[1]} alone, and the unit in the column's name, as in 'time [s]'"
    if _DATE.search(cell):
        return "write seconds, or a date with a time of day as 2024-01-31T23:59:59.5"
    return "write a number"
