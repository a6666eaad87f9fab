"""The catalogue of motors as a page: a section for each motor and gearbox, with the source of each number."""

from __future__ import annotations

from itertools import groupby
from operator import attrgetter
from typing import Any

from docutils import nodes
from reference import Made, code, inline, table
from sphinx.application import Sphinx

from spear_pin.model import catalogue


def entries() -> dict[str, list[catalogue.Row]]:
    """Return the numbers of each motor and gearbox by its name."""
    return {name: [*rows] for name, rows in groupby(catalogue.rows(), attrgetter("name"))}


def cells(row: catalogue.Row) -> tuple[list[nodes.Node], ...]:
    """Return the cells of a number: quantity, value, unit, source and verification."""
    return code(row.quantity), *map(inline, (f"{row.value:.4g}", row.unit, row.source, row.verification))


class Motors(Made):
    """The motors and gearboxes of the catalogue, with a table for each."""

    def run(self) -> list[nodes.Node]:
        """Make the sections."""
        self.note(catalogue)
        return [self.entry(name, rows) for name, rows in entries().items()]

    def entry(self, name: str, rows: list[catalogue.Row]) -> nodes.section:
        """Make the section of a motor or gearbox."""
        made = self.section(code(name), name)
        heads = ("Quantity", "Value", "Unit", "Source", "Verification")
        made += table(heads, map(cells, rows), (20, 12, 10, 40, 18))
        return made


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive."""
    app.add_directive("motors", Motors)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
