"""Statements of the source by chapter, from the TOML files beside this module; their fields are those of `Statement`.

A study is a `Formula`. A criterion is named with what it takes.
"""

from __future__ import annotations

from typing import Any

from spear_pin.errors import BadValue
from spear_pin.studies.audit.statements import averages
from spear_pin.studies.audit.statements.criteria import named
from spear_pin.studies.audit.statements.formula import Formula
from spear_pin.studies.audit.statements.statement import Statement
from spear_pin.studies.prose import read


def chapter(name: str) -> tuple[Statement, ...]:
    """Returns the statements of a file, in their order."""
    return tuple(statement_of(id, said) for id, said in read(__package__, f"{name}.toml").items())


def statement_of(id: str, said: dict[str, Any]) -> Statement:
    """Makes a statement from its table in a file.

    Raises:
        BadValue: the table has another field, a study with another name, or a criterion that there is not.
    """
    fields = dict(said)
    try:
        if "study" in fields:
            fields["study"] = Formula(fields["study"])
        if "criterion" in fields:
            fields["criterion"] = named(fields["criterion"], fields.get("printed"))
        return Statement(id, **fields)
    except (KeyError, AttributeError, NameError, SyntaxError, TypeError, ValueError) as error:
        raise BadValue(f"statement {id!r}", said, "fields of Statement, a formula as study, one criterion") from error


CHAPTERS: dict[int, tuple[Statement, ...]] = {
    2: chapter("chapter2"),
    3: chapter("chapter3"),
    4: (*averages.STATEMENTS, *chapter("chapter4_tables"), *chapter("chapter4_push"), *chapter("chapter4_hop")),
    5: (*chapter("chapter5"), *chapter("chapter5_motors")),
    6: chapter("chapter6"),
}
STATEMENTS: tuple[Statement, ...] = tuple(statement for statements in CHAPTERS.values() for statement in statements)
