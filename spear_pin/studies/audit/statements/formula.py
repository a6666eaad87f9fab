"""Formulas of statements: expressions of what this package computes and of what the source prints."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy

from spear_pin.gaits import bounding_law
from spear_pin.model import catalogue, loading, spring
from spear_pin.studies import bound, design, hop, published_costs, push_test
from spear_pin.studies.audit import (
    knees,
    printed_designs,
    printed_equations,
    printed_estimates,
    runs,
    switch,
    zero_dynamics,
)
from spear_pin.studies.audit.statements import numbers

MODULES = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        *(numpy, bounding_law, catalogue, loading, spring, bound, design, hop, published_costs, push_test, numbers),
        *(knees, printed_designs, printed_equations, printed_estimates, runs, switch, zero_dynamics),
    )
}
ASSUMED: Mapping[str, Any] = {
    **{"knee": runs.KNEE, "friction": runs.FRICTION, "static_rest": False, "gait": runs.SHOWN, "epsilon": None}
}
"""What the source leaves open, as here, by the keywords of the alternatives of assumptions."""
FUNCTIONS = {function.__name__: function for function in (abs, getattr, len, max)}
"""The functions of Python's own that formulas may call."""


@dataclass(frozen=True)
class Formula:
    """An expression in Python's notation, of `MODULES`, `ASSUMED` and `FUNCTIONS`, from a file of this package.

    Attributes:
        text: the expression; its strings stand in single quotes, so that a shell takes it in double ones.

    Raises:
        SyntaxError: it is no expression.
        NameError, AttributeError: nothing has a name in it.
    """

    text: str

    def __post_init__(self) -> None:
        """Checks the names, and that modules have what is taken straight from them; what that has shows in a call."""
        own = {node.id for node in self._nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        for name in self.names:
            if name not in {*MODULES, *ASSUMED, *own, *FUNCTIONS}:
                raise NameError(name)
        for node in self._nodes:
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in MODULES:
                getattr(MODULES[node.value.id], node.attr)

    def __call__(self, **other: Any) -> Any:
        """Returns the numbers, also with other values of what is assumed.

        Raises:
            TypeError: the expression has no such name.
        """
        if unknown := other.keys() - set(self.names):
            raise TypeError(f"{self.text} does not depend on {', '.join(sorted(unknown))}")
        return eval(self.text, {"__builtins__": {}, **FUNCTIONS, **MODULES, **ASSUMED, **other})

    @cached_property
    def _nodes(self) -> list[ast.AST]:
        return [*ast.walk(ast.parse(self.text, mode="eval"))]

    @property
    def names(self) -> list[str]:
        """Names in it, each once."""
        return [*dict.fromkeys(node.id for node in self._nodes if isinstance(node, ast.Name))]

    @property
    def command(self) -> str:
        """Shell line that prints the numbers."""
        given = [f"{name} = {value!r}" for name, value in ASSUMED.items() if name in self.names]
        return f'python -c "{"; ".join([*self._imports(), *given, f"print({self.text})"])}"'

    def _imports(self) -> Iterator[str]:
        for name in self.names:
            if name in MODULES:
                package = MODULES[name].__name__.rpartition(".")[0]
                yield f"from {package} import {name}" if package else f"import {name}"
