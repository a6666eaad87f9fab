"""The equations of motion of a robot in space for arrays of dual numbers, compiled where heyoka is installed.

A domain in space is differentiated by arrays: it would take longer to compile than many cycles do. Most of that work
are the equations of motion, which all domains and impacts of a robot share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import chain
from typing import Any, Self

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.dual import Dual, derivative_of, operations, value_of
from spear_pin.hybrid.engines import taylor
from spear_pin.model.mechanism import Feet, Mechanism, Terms
from spear_pin.model.path import Point
from spear_pin.model.round_feet import ANYWHERE, Parts


class ArrayMechanism(Mechanism):
    """A mechanism whose `terms` take arrays of dual numbers, and are compiled.

    Args:
        mechanism: the mechanism.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self._plain, self._code = mechanism, _shared(_Code(mechanism.shape, mechanism))
        self.coordinates, self.nv = mechanism.coordinates, mechanism.nv
        self.bodies, self.frames, self.toes = mechanism.bodies, mechanism.frames, mechanism.toes
        self.axes, self.lift, self.circle = mechanism.axes, mechanism.lift, mechanism.circle
        self.loops, self.guided = mechanism.loops, mechanism.guided
        self.radii, self.arcs = mechanism.radii, mechanism.arcs
        self.marks = mechanism.marks
        self._numbers: list[Any] = [number for number in mechanism.numbers if number != 0.0]

    def with_numbers(self, numbers: Sequence[Any]) -> Self:
        """Returns this mechanism with other numbers; zeros stay zero."""
        other = copy(self)
        other._plain = self._plain.with_numbers(numbers)
        named = zip(self._plain.numbers, numbers, strict=True)
        other._numbers = [number for own, number in named if own != 0.0]
        return other

    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any, ends: Parts = ANYWHERE) -> Terms:
        """Returns the equations of motion at (q, v), (3.16); of a robot in space, whose toes are points."""
        found = self._code([*q, *v, *self._numbers])
        frames = found.pop("frames")
        return Terms(**found, position=lambda frame: frames.get(frame) or self.position(frame, q, ops))

    def feet(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Feet:
        """Returns the kinematics of the toes alone."""
        return self._plain.feet(q, v, ops)

    def points(self, q: Sequence[Any], ops: Any) -> Callable[[str, Sequence[Any]], Point]:
        """Returns a function that gives a point by its frame and by its place in the frame's axes."""
        return self._plain.points(q, ops)

    def position(self, frame: str, q: Sequence[Any], ops: Any) -> tuple[Any, ...]:
        """Returns the position of any frame of the robot's model, in m."""
        return self._plain.position(frame, q, ops)


@dataclass(frozen=True)
class _Code:
    """The equations of motion of all mechanisms of one shape, with their derivatives."""

    shape: Any
    mechanism: Mechanism = field(compare=False)

    def __call__(self, scalars: Sequence[Any]) -> dict[str, Any]:
        """Returns the parts of `Terms`, of dual numbers or arrays of them."""
        parts = [(value_of(each), derivative_of(each)) for each in scalars]
        shape = np.broadcast_shapes(*(np.shape(part) for pair in parts for part in pair))
        inputs = np.empty((2, len(parts), *shape))
        for i, (x, d) in enumerate(parts):
            inputs[0, i], inputs[1, i] = x, d
        outputs, function = self._compiled
        found: Array = function(inputs.reshape(2 * len(parts), -1)).reshape(2, -1, *shape)
        values = found[0, ..., :1].tolist() if len(shape) == 1 else found[0, ..., :1]
        duals = iter([Dual(x[0] if len(shape) == 1 else x, d) for x, d in zip(values, found[1], strict=True)])
        terms: dict[str, Any] = _mapped(lambda each: next(duals) if isinstance(each, Dual) else each, outputs)
        return terms

    @cached_property
    def _compiled(self) -> tuple[dict[str, Any], Any]:
        """Compiles the function, and returns its outputs with it; outputs that are no dual numbers never change."""
        hy, nv, own = taylor.require(), self.mechanism.nv, self.mechanism.numbers
        count = 2 * nv + sum(number != 0.0 for number in own)
        variables = hy.make_vars(*[f"{kind}{i}" for kind in "xd" for i in range(count)])
        duals = [Dual(x, d) for x, d in zip(variables[:count], variables[count:], strict=True)]
        left, ops = iter(duals[2 * nv :]), operations(taylor.operations([]), hy.relup)
        mechanism = self.mechanism.with_numbers([next(left) if number != 0.0 else 0.0 for number in own])
        terms = mechanism.terms(duals[:nv], duals[nv : 2 * nv], ops)
        names = ("mass_matrix", "bias", "positions", "jacobians", "drifts", "loop_gaps", "loop_rows", "loop_drifts")
        outputs = {name: getattr(terms, name) for name in names}
        outputs["frames"] = {frame: terms.position(frame) for frame in mechanism.frames}
        found: list[Dual] = []
        _mapped(lambda each: found.append(each) if isinstance(each, Dual) else None, outputs)
        rows = [hy.expression(0.0) + part for part in chain((each.x for each in found), (each.d for each in found))]
        return outputs, hy.cfunc(rows, variables, compact_mode=True, opt_level=0)


def _mapped(function: Any, nested: Any) -> Any:
    """Applies a function to all scalars in nested mappings, lists and tuples, in their order."""
    if isinstance(nested, dict):
        return {name: _mapped(function, each) for name, each in nested.items()}
    if isinstance(nested, (list, tuple)):
        return type(nested)(_mapped(function, each) for each in nested)
    return function(nested)


@lru_cache(taylor.MOST)
def _shared(code: _Code) -> _Code:
    """Returns the code of this shape that was made first."""
    return code
