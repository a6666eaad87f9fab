"""Signals of joints and toes along the arcs of a cycle, with derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from spear_pin.gaits.sensitivity.signals import Pieces
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import SLIPS
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.symmetry import partner
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Stretch
from spear_pin.model.robot import Robot


def with_partner(system: HybridSystem, name: str) -> list[tuple[str, float]]:
    """Returns a joint or toe with its sign 1; if a cycle is half a stride also the one that does the same in the other.

    In the other half of the stride a joint moves as its partner does in this one, up to the partner's sign.
    """
    return [(name, 1.0), *([partner(system.robot, name)] if system.mirrored_toes else [])]


def find_powered(stretches: Sequence[Stretch], robot: Robot, joint: str) -> tuple[list[Pieces], list[Pieces]]:
    """Returns the torque of a joint's motors, and the speed of the joint."""
    j, there = robot.actuated.index(joint), select_lasting(stretches)
    torque = [Pieces(each, each.said.u[j], each.dsaid.u[j], each.rates.u[j]) for each in there]
    return torque, coordinate(stretches, robot.nv + robot.index(joint))


def coordinate(stretches: Sequence[Stretch], i: int) -> list[Pieces]:
    """Returns a number of the state along all arcs."""
    return [along(each, i) for each in select_lasting(stretches)]


def along(stretch: Stretch, i: int) -> Pieces:
    """Returns a number of the state along an arc."""
    return Pieces(stretch, stretch.y[i], stretch.dy[i], stretch.said.slopes[i, [BEGIN, END]])


def evaluate_guard(stretch: Stretch, g: int) -> Pieces:
    """Returns the value of a guard along an arc."""
    return Pieces(stretch, stretch.said.guards[g], stretch.dsaid.guards[g], stretch.rates.guards[g])


def forces(stretches: Sequence[Stretch], toe: str, toes: Sequence[str]) -> Iterator[tuple[Pieces, Pieces]]:
    """Returns the force on a toe along the ground and normal to it, for the arcs on which the toe is on the ground."""
    for each in select_lasting(stretches):
        closed = find_closed_toes(each, toes)
        if toe in closed:
            parts = each.said.forces, each.dsaid.forces, each.rates.forces
            axes = len(parts[0]) // len(closed)
            first = axes * closed.index(toe)
            *tangential, normal = (Pieces(each, *(part[first + i] for part in parts)) for i in range(axes))
            pushed = tangential[0] if axes == 2 else length(*tangential)
            slides = each.arc.domain.contacts[toes.index(toe)] in SLIPS
            yield _of(normal, pushed) if slides else pushed, normal


def _of(normal: Pieces, along: Pieces) -> Pieces:
    """Returns the force along the ground of a sliding toe: a share of the normal force that is the same everywhere.

    It is taken halfway, as the slopes of both forces have no value where a toe in space begins to slide.
    """
    i = (len(normal.values) - 2) // 2
    share = along.values[i] / normal.values[i]
    return normal.times(float(share), (along.derivatives[i] - share * normal.derivatives[i]) / normal.values[i])


def length(x: Pieces, y: Pieces) -> Pieces:
    """Returns the modulus of a vector along the ground; where it vanishes it has no derivative, 0 here."""
    values = np.hypot(x.values, y.values)
    to_x, to_y = (each.values / np.where(values > 0.0, values, 1.0) for each in (x, y))
    changes = to_x[:, None] * x.derivatives + to_y[:, None] * y.derivatives
    ends = [BEGIN, END]
    return Pieces(x.stretch, values, changes, to_x[ends] * x.rates + to_y[ends] * y.rates)


def find_closed_toes(stretch: Stretch, toes: Sequence[str]) -> list[str]:
    """Returns the toes that are on the ground along an arc."""
    return [name for name, _ in closed_toes(tuple(toes), stretch.arc.domain)]


def long(stretches: Sequence[Stretch]) -> list[Stretch]:
    """Returns the arcs that have a duration in this cycle."""
    return [each for each in stretches if not each.at_once]


def select_lasting(stretches: Sequence[Stretch]) -> list[Stretch]:
    """Returns the arcs that have a duration in this cycle, or in cycles to one side of it."""
    return [each for each in stretches if not each.at_once or each.late]
