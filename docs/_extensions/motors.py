"""The catalogue of motors as a page: a section for each motor and gearbox, with the source of each number."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from reference import Made, code, inline, table
from sphinx.application import Sphinx

from spear_pin.model import catalogue


def entries() -> dict[str, catalogue.Entry]:
    """Return the numbers of each motor and gearbox by its name."""
    return {**catalogue.MOTORS, **catalogue.GEARBOXES}


def cells(name: str, number: catalogue.Quantity) -> tuple[list[nodes.Node], ...]:
    """Return the cells of a number: quantity, value, unit, source and verification."""
    return code(name), *map(inline, (f"{number.value:.4g}", number.unit, number.source, number.verification))


class Motors(Made):
    """The motors and gearboxes of the catalogue, with a table for each."""

    def run(self) -> list[nodes.Node]:
        """Make the sections."""
        self.note(catalogue)
        return [self.entry(name, entry) for name, entry in entries().items()]

    def entry(self, name: str, entry: catalogue.Entry) -> nodes.section:
        """Make the section of a motor or gearbox."""
        made = self.section(code(name), name)
        heads = ("Quantity", "Value", "Unit", "Source", "Verification")
        made += table(heads, (cells(*each) for each in entry.items()), (20, 12, 10, 40, 18))
        return made


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive."""
    app.add_directive("motors", Motors)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
