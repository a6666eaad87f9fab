"""Statements of the source in its chapters 2 to 6, as data, with findings on them; an entry in a TOML file adds one."""

from __future__ import annotations

from spear_pin.studies.audit.statements.assumptions import ASSUMPTIONS, Assumption
from spear_pin.studies.audit.statements.chapters import CHAPTERS, STATEMENTS
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
