"""Equations of motion of the legged robots by a symbolic Lagrangian: a second opinion, written out by hand.

Positions of the centres of mass come from trigonometry, rates by differentiating them, the equations
from Euler and Lagrange. Nothing here is shared with the package; the numbers are typed from the
source's Tables 2.4 and 5.1 and Section 5.3.

Convention: x forward, z up, u(p) = (sin p, -cos p) points along a limb at the absolute angle p. A hip
angle is positive with the knee forward, a knee angle bends the shank backward.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from spear_pin.arrays import Array


@dataclass(frozen=True)
class Leg:
    """Two limbs and two geared motors.

    Attributes:
        masses: of thigh and shank, in kg.
        coms: distance of each centre of mass from the limb's upper joint, in m.
        inertias: of each limb about its centre of mass, in kg·m².
        lengths: of each limb, in m.
        rotors: inertias of the rotors of hip and knee, reflected to the joint, in kg·m².
    """

    masses: tuple[float, float]
    coms: tuple[float, float]
    inertias: tuple[float, float]
    lengths: tuple[float, float]
    rotors: tuple[float, float]


BOOM_MASS = 4.6
SPEAR_II_LEG = Leg((1.72, 0.48), (0.008, 0.14), (0.014, 0.005), (0.318, 0.318), (0.047, 0.027))

TORSO_MASS, TORSO_INERTIA, HIP_OFFSET = 35.0, 2.1, 0.35
Q_SPEAR_PAIR = Leg((2 * 1.72, 2 * 0.47), (0.008, 0.144), (2 * 0.014, 2 * 0.005), (0.318, 0.318), (2 * 0.047, 2 * 0.027))

BIPED_TORSO, BIPED_TORSO_COM = (4.6, 0.106), 0.2  # mass and inertia; height of the centre above the hips

GRAVITY = 9.81


@dataclass(frozen=True)
class Terms:
    """The equations of motion D v̇ + C v + G = ... at one state.

    Attributes:
        mass_matrix: D.
        coriolis: C v.
        gravity: G.
        toes: position of each toe, x and z.
        jacobians: J of each toe.
        drifts: J̇ v of each toe.
        kinetic_energy: with the rotors.
        potential_energy: of gravity, zero at height zero.
    """

    mass_matrix: Array
    coriolis: Array
    gravity: Array
    toes: dict[str, Array]
    jacobians: dict[str, Array]
    drifts: dict[str, Array]
    kinetic_energy: float
    potential_energy: float


@dataclass(frozen=True)
class Lagrangian:
    """Equations of motion of one robot in its named coordinates."""

    coordinates: tuple[str, ...]
    toes: tuple[str, ...]
    evaluate: Callable[..., Sequence[list[list[float]]]]

    def terms(self, q: ArrayLike, v: ArrayLike) -> Terms:
        """Evaluate at one state."""
        values = self.evaluate(*np.asarray(q, float).tolist(), *np.asarray(v, float).tolist())
        mass_matrix, coriolis, gravity, energies, *toes = (np.asarray(value, float) for value in values)
        positions, jacobians, drifts = (
            {name: stacked[2 * i : 2 * i + 2] for i, name in enumerate(self.toes)} for stacked in toes
        )
        return Terms(
            mass_matrix=mass_matrix,
            coriolis=coriolis.ravel(),
            gravity=gravity.ravel(),
            toes={name: position.ravel() for name, position in positions.items()},
            jacobians=jacobians,
            drifts={name: drift.ravel() for name, drift in drifts.items()},
            kinetic_energy=float(energies[0, 0]),
            potential_energy=float(energies[1, 0]),
        )


class _System:
    """Collects energies and toes, in the named coordinates and their rates."""

    def __init__(self, coordinates: tuple[str, ...]) -> None:
        self.coordinates = coordinates
        self.q = sp.Matrix([sp.Symbol(f"q_{name}", real=True) for name in coordinates])
        self.v = sp.Matrix([sp.Symbol(f"v_{name}", real=True) for name in coordinates])
        self.kinetic: sp.Expr = sp.Integer(0)
        self.potential: sp.Expr = sp.Integer(0)
        self.toes: dict[str, sp.Matrix] = {}

    def coordinate(self, name: str) -> sp.Expr:
        """Symbol of a coordinate; one that is not among the coordinates is held at zero."""
        return self.q[self.coordinates.index(name)] if name in self.coordinates else sp.Integer(0)

    def rate(self, value: sp.Expr | sp.Matrix) -> sp.Matrix:
        """Time derivative of a function of q."""
        return sp.Matrix([value]).jacobian(self.q) * self.v

    def add_body(self, mass: float, inertia: float, com: sp.Matrix, angle: sp.Expr) -> None:
        """Add a body by its centre of mass and absolute angle."""
        velocity, spin = self.rate(com), self.rate(angle)[0]
        self.kinetic += _exact(mass) * velocity.dot(velocity) / 2 + _exact(inertia) * spin**2 / 2
        self.potential += _exact(mass) * _exact(GRAVITY) * com[1]

    def add_rotor(self, reflected_inertia: float, joint: sp.Expr) -> None:
        """Add a geared rotor: its energy is that of the joint's relative rate."""
        self.kinetic += _exact(reflected_inertia) * self.rate(joint)[0] ** 2 / 2

    def add_leg(self, toe: str, leg: Leg, hip: sp.Matrix, pitch: sp.Expr, bends: tuple[sp.Expr, sp.Expr]) -> None:
        """Add a leg by the position of its hip, the pitch of what carries it and its two joint angles."""
        phi = pitch + bends[0]
        psi = phi - bends[1]
        thigh, shank = (sp.Matrix([sp.sin(angle), -sp.cos(angle)]) for angle in (phi, psi))
        knee = hip + _exact(leg.lengths[0]) * thigh
        self.add_body(leg.masses[0], leg.inertias[0], hip + _exact(leg.coms[0]) * thigh, phi)
        self.add_body(leg.masses[1], leg.inertias[1], knee + _exact(leg.coms[1]) * shank, psi)
        for rotor, bend in zip(leg.rotors, bends, strict=True):
            self.add_rotor(rotor, bend)
        self.toes[toe] = knee + _exact(leg.lengths[1]) * shank

    def lagrangian(self) -> Lagrangian:
        """Euler and Lagrange: D v̇ + C v + G is the time derivative of ∂T/∂v, minus ∂(T - V)/∂q."""
        energies = sp.Matrix([self.kinetic, self.potential])
        along_q = energies.jacobian(self.q)
        momentum = energies[:1, :].jacobian(self.v).T
        toes = sp.Matrix.vstack(*self.toes.values())
        outputs = [
            momentum.jacobian(self.v),
            momentum.jacobian(self.q) * self.v - along_q[0, :].T,
            along_q[1, :].T,
            energies,
            toes,
            toes.jacobian(self.q),
            self.rate(self.rate(toes)),
        ]
        # plain lists and the math module: at one state much faster than arrays
        modules = [{"ImmutableDenseMatrix": list}, "math"]
        evaluate = sp.lambdify([*self.q, *self.v], outputs, modules=modules, cse=True)
        return Lagrangian(self.coordinates, tuple(self.toes), evaluate)


@cache
def monopod(coordinates: tuple[str, ...] = ("boom_x", "boom_z", "hip", "knee")) -> Lagrangian:
    """SPEAR-II at the position of its hip and two joint angles; coordinates left out are held at zero."""
    system = _System(coordinates)
    hip = sp.Matrix([system.coordinate("boom_x"), system.coordinate("boom_z")])
    system.add_body(BOOM_MASS, 0.0, hip, sp.Integer(0))
    bends = system.coordinate("hip"), system.coordinate("knee")
    system.add_leg("toe", SPEAR_II_LEG, hip, sp.Integer(0), bends)
    return system.lagrangian()


@cache
def quadruped(
    coordinates: tuple[str, ...] = (
        "torso_x",
        "torso_z",
        "pitch",
        "posterior_hip",
        "posterior_knee",
        "anterior_hip",
        "anterior_knee",
    ),
    hip_offset: float = HIP_OFFSET,
    torso: tuple[float, float] = (TORSO_MASS, TORSO_INERTIA),
    pair: Leg = Q_SPEAR_PAIR,
) -> Lagrangian:
    """Q-SPEAR at its torso's centre of mass, pitch (nose up) and joint angles, in any order."""
    system = _System(coordinates)
    middle = sp.Matrix([system.coordinate("torso_x"), system.coordinate("torso_z")])
    pitch = system.coordinate("pitch")
    axis = sp.Matrix([sp.cos(pitch), sp.sin(pitch)])
    system.add_body(*torso, middle, pitch)
    for name, offset in (("posterior", -hip_offset), ("anterior", hip_offset)):
        bends = system.coordinate(f"{name}_hip"), system.coordinate(f"{name}_knee")
        system.add_leg(f"{name}_toe", pair, middle + _exact(offset) * axis, pitch, bends)
    return system.lagrangian()


@cache
def biped(
    coordinates: tuple[str, ...] = ("torso_x", "torso_z", "pitch", "left_hip", "left_knee", "right_hip", "right_knee"),
) -> Lagrangian:
    """Two SPEAR-II legs below a torso, at the position of the hips, pitch (nose up) and joint angles."""
    system = _System(coordinates)
    hips = sp.Matrix([system.coordinate("torso_x"), system.coordinate("torso_z")])
    pitch = system.coordinate("pitch")
    upward = sp.Matrix([-sp.sin(pitch), sp.cos(pitch)])
    system.add_body(*BIPED_TORSO, hips + _exact(BIPED_TORSO_COM) * upward, pitch)
    for side in ("left", "right"):
        bends = system.coordinate(f"{side}_hip"), system.coordinate(f"{side}_knee")
        system.add_leg(f"{side}_toe", SPEAR_II_LEG, hips, pitch, bends)
    return system.lagrangian()


def _exact(number: float) -> sp.Rational:
    return sp.Rational(str(number))
