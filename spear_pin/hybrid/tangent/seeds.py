"""The numbers of a system on which a cycle depends, and their derivatives with respect to named parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.engines import structure
from spear_pin.hybrid.engines.identity import Reader
from spear_pin.hybrid.fields import flatten, names_of
from spear_pin.hybrid.parameters import number, numbers_of_robot, with_numbers
from spear_pin.model.equations import mechanism_of
from spear_pin.model.numbers import body_numbers
from spear_pin.model.variants import CURVED

# relative to a parameter: most numbers are polynomials of degree two at most in it, so that no step is too long
STEP = 2.0**-8
ROUNDING = 1e-9  # size of a derivative that may result from rounding when a body's frame turns back and forth


def numbers(system: HybridSystem) -> Array:
    """Returns the run-time parameters of a system without the held values, in the order of `structure.parameters`."""
    return _everything(system)[_kept(system)]


class Seeds(NamedTuple):
    """Derivatives with respect to parameters.

    Attributes:
        numbers: of `numbers`, (p, m).
        weight: of the robot's weight, in N, (m,).
    """

    numbers: Array
    weight: Array


def seeds(system: HybridSystem, names: Sequence[str]) -> Seeds:
    """Differentiates `numbers`, and the robot's weight, with respect to parameters.

    Raises:
        UnknownName: there is no parameter of a name.
        BadValue: a parameter is zero, so that part of the equations vanishes, or is none of the numbers.
    """
    *rows, weight = changes(system, names, lambda other: np.append(_everything(other), other.robot.weight))
    whole, kept = np.array(rows), _kept(system)
    of_robot = numbers_of_robot(system.robot)
    for name, column in zip(names, whole[~kept].T, strict=True):
        if (np.abs(column) > ROUNDING).any():
            expected = "a parameter that changes no number that is zero now, as the equations leave zeros out"
            raise BadValue(name, number(system, name), f"{expected}; set that number slightly above zero first")
    found = whole[kept]
    for name, column in zip(names, found.T, strict=True):
        if not column.any() and name not in of_robot:  # a gear ratio without a rotor is a number of motors alone
            raise BadValue(name, number(system, name), "a number of the equations: this one is built into the events")
    return Seeds(found, weight)


def _everything(system: HybridSystem) -> Array:
    """Returns all numbers of a system, including zeros, in the order of `numbers`."""
    structure.check_law(system.law)
    robot = structure.all_robot_numbers(system, mechanism_of(system.robot))
    return np.array(flatten((system.law, *structure.all_others(system).values(), *robot)), dtype=float)


def _kept(system: HybridSystem) -> NDArray[np.bool_]:
    """Tells which of all numbers of a system `numbers` returns."""
    kept: NDArray[np.bool_] = _everything(system) != 0.0
    kept[: len(flatten((system.law,)))] = True
    return kept


def changes(system: HybridSystem, names: Sequence[str], of: Callable[[HybridSystem], Array]) -> Array:
    """Differentiates numbers of a system with respect to parameters, (p, m).

    Args:
        system: the system.
        names: names of the parameters.
        of: returns the numbers, (p,), which are polynomials of degree two at most in each parameter, except those of
            `variants.CURVED`.

    Raises:
        UnknownName: there is no parameter of a name.
        BadValue: a parameter is zero, so that part of the equations vanishes, or can have no other value.
    """
    found = [_change(system, name, of) for name in names]
    return np.array(found).T.reshape(-1, len(names)) if names else np.empty((len(of(system)), 0))


def _change(system: HybridSystem, name: str, of: Callable[[HybridSystem], Array]) -> Array:
    value = number(system, name)
    if value == 0.0 and name not in names_of(system.law) - {"friction"}:
        raise BadValue(name, value, "a number other than zero: at zero its terms are not in the equations")
    h = STEP * 2.0 ** round(math.log2(abs(value) if value else 1.0))
    change = _difference(system, name, value, h, of)
    if name.endswith(CURVED):  # the error of a difference goes with h², that of this combination with h⁴
        change = (4.0 * _difference(system, name, value, 0.5 * h, of) - change) / 3.0
    return change


def _difference(system: HybridSystem, name: str, value: float, h: float, of: Callable[[HybridSystem], Array]) -> Array:
    ends = []
    for step in (h, -h):
        try:
            changed = with_numbers(system, {name: value + step})
            _check_same(system, changed, name, value)
            ends.append((step, of(changed)))
        except BadValue as error:
            refusal = error
    if not ends:
        raise BadValue(name, value, f"a parameter that may change; here it has to be {refusal.expected}") from refusal
    if len(ends) < 2:  # the value is at the end of its range, where numbers are linear in it
        ends.append((0.0, of(system)))
    (one, more), (other, less) = ends
    change: Array = (more - less) / (one - other)
    return change


def _check_same(system: HybridSystem, other: HybridSystem, name: str, value: float) -> None:
    """Checks that a system with another number has the same laws, and halves of a stride if it had them.

    Raises:
        BadValue: it has not, so that derivatives by the numbers alone would be wrong.
    """
    if other is system:
        return
    if other.mirrored_toes != system.mirrored_toes:
        raise BadValue(name, value, "a number that keeps left and right alike: a half stride mirrors the other")
    if name in body_numbers(system.robot):
        pairs = ((system.domains[i].law, other.domains[i].law) for i in (0, -1))  # of legs that stand, and that swing
        if not all(Reader().identity(own) == Reader().identity(its) for own, its in pairs):
            raise BadValue(name, value, "a number that is not built into the law: compare gaits found with both")
