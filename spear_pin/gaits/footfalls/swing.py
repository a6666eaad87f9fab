"""Legs in the air in the form of the law: leg angles and knees follow Bézier polynomials, adductions an angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Programme, casadi
from spear_pin.gaits.footfalls.nodes import Node
from spear_pin.gaits.footfalls.request import SwingLaw
from spear_pin.gaits.spatial.legs import Leg
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
from spear_pin.model.scale import Scale

END = {
    True: 0.98,
    False: 1.02,
}  # s at the end of a phase with legs on the ground, where it is not to run out, and of a flight
FREE, SAMPLES = 4, 13  # coefficients from the third on; points that their guess is fitted to
STEEPEST, FLEXED = 1.3, 2.4  # rad: limits of the coefficients of leg angles and knees
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
    """

    label: str
    bearing: tuple[str, ...]
    landing: tuple[str, ...]
    nodes: Sequence[Node]


class Swings:
    """Writer of the law for legs in the air."""

    def __init__(
        self, programme: Programme, limbs: Mapping[str, Leg], law: SwingLaw, scale: Scale, knee: float
    ) -> None:
        self.programme, self.limbs, self.law, self.scale, self.knee = programme, limbs, law, scale, knee

    def follow(self, air: Air, guess: Callable[[float], Array], adductions: Mapping[str, Any]) -> dict[str, Evolution]:
        """Makes the legs in the air follow evolutions that begin in their own state; returns the coefficients.

        Args:
            air: the phase.
            guess: guess of the configuration, by the fraction of the phase that has passed.
            adductions: target angle of each leg's adduction, in rad.
        """
        ca, programme, time = casadi(), self.programme, self.scale.time
        bears = bool(air.bearing)
        share = 1.0 / max(len(air.bearing), 1)
        phase: Variable = Sum(tuple((share, self.limbs[leg].angle) for leg in air.bearing)) if bears else ((X, 1.0),)
        first, last = air.nodes[0], air.nodes[-1]
        span = (value(phase, last.q, ca) - value(phase, first.q, ca)) / END[bears]
        if bears:
            programme.require(f"sweep of the legs in {air.label}", span, *SWEEP)
            for node in air.nodes:
                rate = jet(phase, node.q, node.v, ca).rate
                programme.require(f"sweep of the legs in {air.label}", rate, -FASTEST, -SLOWEST, unit=1.0 / time)
        found = {}
        for name, limb in self.limbs.items():
            if name in air.bearing:
                continue
            outputs = Outputs(limb.controlled, phase, ())
            shapes = self._shapes(air, limb, guess)
            found[name] = begun = resume(outputs, shapes, first.q, first.v, span, ca)
            for node in air.nodes:
                past = 0.0 if bears or node is not last else 1.0
                self._follow(air.label, outputs, replace(begun, past=past), node)
                self._bring(air.label, limb, node, adductions[name])
        return found

    def _follow(self, label: str, outputs: Outputs, begun: Evolution, node: Node) -> None:
        """Requires ÿ = 0."""
        unit = 1.0 / self.scale.time**2
        for missed in accelerations(outputs, begun, node.q, node.v, node.a, casadi()):
            self.programme.require(f"law in {label}", missed, 0.0, 0.0, scale=50.0, unit=unit)

    def _bring(self, label: str, limb: Leg, node: Node, angle: Any) -> None:
        """Requires that the adduction comes to an angle."""
        i, epsilon = limb.adduction, self.law.adduction_epsilon
        wanted = -((node.q[i] - angle) / epsilon + 2.0 * node.v[i]) / epsilon
        self.programme.require(
            f"law in {label}", node.a[i] - wanted, 0.0, 0.0, scale=50.0, unit=1.0 / self.scale.time**2
        )

    def _shapes(self, air: Air, limb: Leg, guess: Callable[[float], Array]) -> tuple[tuple[Any, ...], ...]:
        """Returns coefficients from the third on; the last three of a leg that lands are its angles at touchdown."""
        lands, name = limb.name in air.landing, f"{air.label}, {limb.name}"
        gone = np.linspace(0.0, 1.0, SAMPLES)
        rough = [guess(s).tolist() for s in gone]
        angles, knees = (_fitted(gone, [float(value(variable, q)) for q in rough]) for variable in limb.controlled)
        flexed = sorted((-0.2 * limb.bends, FLEXED * limb.bends))
        count = 1 if lands else FREE
        angle = [self.programme.variable(f"{name} angle {i}", angles[i], -STEEPEST, STEEPEST) for i in range(count)]
        knee = [self.programme.variable(f"{name} knee {i}", knees[i], *flexed) for i in range(count)]
        if lands:
            angle += 3 * [self.programme.variable(f"{name} lands at", angles[-1], -STEEPEST, STEEPEST)]
            knee += 3 * [limb.bends * self.knee]
        return tuple(angle), tuple(knee)


def _fitted(s: Array, values: Sequence[float]) -> Array:
    """Fits a polynomial to values; returns its Bézier coefficients from the third on."""
    count = FREE + 2
    basis = np.transpose([bezier(unit, s)[0] for unit in np.eye(count).tolist()])
    found: Array = np.linalg.lstsq(basis, np.array(values), rcond=None)[0][2:]
    return found
