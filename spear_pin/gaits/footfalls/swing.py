"""Legs in the air in the form of the law: leg angles and knees follow Bézier polynomials, adductions an angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Programme, casadi
from spear_pin.gaits.footfalls.nodes import Node, Room, Support
from spear_pin.gaits.request import FLEXED
from spear_pin.gaits.virtual_constraints import (
    Evolution,
    Outputs,
    Sum,
    Variable,
    accelerations,
    bezier,
    jet,
    resume,
    value,
)
from spear_pin.hybrid.symmetry import X

END = {
    True: 0.98,
    False: 1.02,
}  # s at the end of a phase with legs on the ground, where it is not to run out, and of a flight
FREE, SAMPLES = 4, 13  # coefficients from the third on; points that their guess is fitted to
WIDEST = 1.3  # rad: limit of the coefficients of leg angles
SWEEP = (-1.5, -0.05)  # rad: limits of the change of the supporting legs' mean angle in a phase
SLOWEST, FASTEST = 0.3, 30.0  # rad/s of Q-SPEAR: of it


@dataclass(frozen=True)
class Air:
    """A phase and the legs in the air in it.

    Attributes:
        label: label of the phase.
        bearing: legs on the ground.
        landing: legs that land as it ends.
        nodes: nodes of the phase.
        guess: guess of the configuration, by the fraction of the phase that has passed.
    """

    label: str
    bearing: tuple[str, ...]
    landing: tuple[str, ...]
    nodes: Sequence[Node]
    guess: Callable[[float], Array]


class Swings:
    """Writer of the law for legs in the air.

    Args:
        programme: the programme to which it is added.
        room: the robot's legs, and the bounds of their angles.
        support: the law for legs on the ground, with the flexion at touchdown.
    """

    def __init__(self, programme: Programme, room: Room, support: Support) -> None:
        self.programme, self.room, self.knee, self.epsilon = programme, room, support.knee_touchdown, support.upright[2]
        self.rate = 50.0 / room.scale.time**2

    def follow(self, air: Air, adductions: Mapping[str, Any]) -> dict[str, Evolution]:
        """Makes the legs in the air follow evolutions that begin in their own state; returns the coefficients.

        Args:
            air: the phase.
            adductions: target angle of each leg's adduction, in rad.
        """
        ca, programme, limbs = casadi(), self.programme, self.room.limbs
        bears, first, last = bool(air.bearing), air.nodes[0], air.nodes[-1]
        share = 1.0 / max(len(air.bearing), 1)
        phase: Variable = Sum(tuple((share, limbs[leg].angle) for leg in air.bearing)) if bears else ((X, 1.0),)
        span = (value(phase, last.q, ca) - value(phase, first.q, ca)) / END[bears]
        if bears:
            label = f"sweep of the legs in {air.label}"
            programme.require(label, span, *SWEEP)
            for node in air.nodes:
                rate = jet(phase, node.q, node.v, ca).rate
                programme.require(label, rate, -FASTEST, -SLOWEST, unit=1.0 / self.room.scale.time)
        found = {}
        for name, limb in limbs.items():
            if name in air.bearing:
                continue
            outputs = Outputs(limb.controlled, phase, ())
            found[name] = begun = resume(outputs, self._shapes(air, name), first.q, first.v, span, ca)
            for node in air.nodes:
                past = 0.0 if bears or node is not last else 1.0
                missed = accelerations(outputs, replace(begun, past=past), node.q, node.v, node.a, ca)
                if (i := limb.adduction) is not None:
                    off = node.q[i] - adductions[name]
                    missed = [*missed, node.a[i] + (off / self.epsilon + 2.0 * node.v[i]) / self.epsilon]
                programme.require(f"law in {air.label}", ca.vertcat(*missed), 0.0, 0.0, scale=self.rate)
        return found

    def _shapes(self, air: Air, leg: str) -> tuple[tuple[Any, ...], ...]:
        """Returns coefficients from the third on; the last three of a leg that lands are its angles at touchdown."""
        limb, lands, name = self.room.limbs[leg], leg in air.landing, f"{air.label}, {leg}"
        gone = np.linspace(0.0, 1.0, SAMPLES)
        rough = [air.guess(s).tolist() for s in gone]
        angles, knees = (_fitted(gone, [float(value(variable, q)) for q in rough]) for variable in limb.controlled)
        flexed = sorted((-0.2 * limb.bends, FLEXED * limb.bends))
        count = 1 if lands else FREE
        angle = [self.programme.variable(f"{name} angle {i}", angles[i], -WIDEST, WIDEST) for i in range(count)]
        knee = [self.programme.variable(f"{name} knee {i}", knees[i], *flexed) for i in range(count)]
        if lands:
            angle += 3 * [self.programme.variable(f"{name} lands at", angles[-1], *self.room.landing)]
            knee += 3 * [limb.bends * self.knee]
        return tuple(angle), tuple(knee)


def _fitted(s: Array, values: Sequence[float]) -> Array:
    """Fits a polynomial to values; returns its Bézier coefficients from the third on."""
    count = FREE + 2
    basis = np.transpose([bezier(unit, s)[0] for unit in np.eye(count).tolist()])
    found: Array = np.linalg.lstsq(basis, np.array(values), rcond=None)[0][2:]
    return found
