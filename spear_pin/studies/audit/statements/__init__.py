"""Statements of the source in its chapters 2 to 6, as data, with findings on them; a new entry adds a statement."""

from __future__ import annotations

from spear_pin.studies.audit.statements import (
    chapter2,
    chapter3,
    chapter4_hop,
    chapter4_push,
    chapter4_tables,
    chapter5,
    chapter5_motors,
    chapter6,
)
from spear_pin.studies.audit.statements.assumptions import ASSUMPTIONS, Assumption
from spear_pin.studies.audit.statements.statement import (
    RULES,
    VERDICTS,
    Case,
    Finding,
    Statement,
    Verdict,
    check,
    command_of,
)

CHAPTERS: dict[int, tuple[Statement, ...]] = {
    2: chapter2.STATEMENTS,
    3: chapter3.STATEMENTS,
    4: (*chapter4_tables.STATEMENTS, *chapter4_push.STATEMENTS, *chapter4_hop.STATEMENTS),
    5: (*chapter5.STATEMENTS, *chapter5_motors.STATEMENTS),
    6: chapter6.STATEMENTS,
}
STATEMENTS: tuple[Statement, ...] = tuple(statement for chapter in CHAPTERS.values() for statement in chapter)

__all__ = [
    "ASSUMPTIONS",
    "CHAPTERS",
    "RULES",
    "STATEMENTS",
    "VERDICTS",
    "Assumption",
    "Case",
    "Finding",
    "Statement",
    "Verdict",
    "check",
    "command_of",
]
