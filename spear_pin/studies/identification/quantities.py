"""Quantities that can be estimated from releases, of the knee and of each trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

SLACK = 1e-6  # N·m/rad: the least stiffness, which the static rest is divided by


@dataclass(frozen=True)
class Quantity:
    """A parameter that can be estimated.

    Attributes:
        symbol: symbol in the source.
        unit: unit of the value.
        derivative: derivative of `move` that it takes; None for the time of release.
        bounds: least and largest value.
    """

    symbol: str
    unit: str
    derivative: str | None
    bounds: tuple[float, float]


QUANTITIES: Mapping[str, Quantity] = MappingProxyType(
    {
        "stiffness": Quantity("k_rot", "N·m/rad", "stiffness", (SLACK, 1e5)),
        "damping": Quantity("b", "N·m·s/rad", "damping", (0.0, 1e3)),
        "coulomb": Quantity("τ_c", "N·m", "coulomb", (0.0, 1e3)),
        "rest_angle": Quantity("RA", "rad", "zero", (-np.pi, np.pi)),
        "rotor_inertia": Quantity("N²J", "kg·m²", "rotor", (0.0, 100.0)),
        "initial_angle": Quantity("θ₀", "rad", "initial_angle", (-np.pi, np.pi)),
        "release_time": Quantity("t₀", "s", None, (-np.inf, np.inf)),
    }
)
NUISANCES = ("initial_angle", "release_time")  # of each trial
KNEE = tuple(name for name in QUANTITIES if name not in NUISANCES)
