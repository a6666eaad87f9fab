"""Statements of the source by chapter, from the TOML files beside this module; their fields are those of `Statement`.

A study is named by its module and function, with `given` arguments. A criterion is named with what it takes.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.studies import published_costs
from spear_pin.studies.audit import knees, printed_designs, printed_equations, printed_estimates, switch
from spear_pin.studies.audit.prose import joined, read
from spear_pin.studies.audit.statements import averages, bound_numbers, hop_numbers, push_numbers, turn_numbers
from spear_pin.studies.audit.statements.criteria import named
from spear_pin.studies.audit.statements.statement import Statement

MODULES = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        *(knees, printed_designs, printed_equations, printed_estimates, published_costs, switch),
        *(bound_numbers, hop_numbers, push_numbers, turn_numbers),
    )
}


def chapter(name: str) -> tuple[Statement, ...]:
    """Returns the statements of a file, in their order."""
    return tuple(statement_of(id, said) for id, said in read(f"statements/{name}.toml").items())


def statement_of(id: str, said: dict[str, Any]) -> Statement:
    """Makes a statement from its table in a file.

    Raises:
        BadValue: the table has another field, or a study or a criterion that there is not.
    """
    fields: dict[str, Any] = {name: _fixed(each) for name, each in said.items()}
    given = fields.pop("given", ())
    try:
        if "study" in fields or given:
            module, _, name = fields["study"].partition(".")
            function = getattr(MODULES[module], name)
            fields["study"] = partial(function, *given) if given else function
        if "criterion" in fields:
            fields["criterion"] = named(fields["criterion"], fields.get("printed"))
        return Statement(id, **fields)
    except (KeyError, AttributeError, TypeError, ValueError) as error:
        raise BadValue(f"statement {id!r}", said, "fields of Statement, a study of MODULES, one criterion") from error


def _fixed(each: Any) -> Any:
    """Returns tuples for the lists of TOML, also in a table, and prose with a line for each paragraph."""
    if isinstance(each, dict):
        return {name: _fixed(part) for name, part in each.items()}
    if isinstance(each, list):
        return tuple(map(_fixed, each))
    return joined(each) if isinstance(each, str) else each


CHAPTERS: dict[int, tuple[Statement, ...]] = {
    2: chapter("chapter2"),
    3: chapter("chapter3"),
    4: (*averages.STATEMENTS, *chapter("chapter4_tables"), *chapter("chapter4_push"), *chapter("chapter4_hop")),
    5: (*chapter("chapter5"), *chapter("chapter5_motors")),
    6: chapter("chapter6"),
}
STATEMENTS: tuple[Statement, ...] = tuple(statement for statements in CHAPTERS.values() for statement in statements)
