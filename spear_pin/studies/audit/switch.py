"""The switchable parallel spring of Fig. 2.1 alone: the torque at the joint with the key engaged and without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import require
from spear_pin.model.spring import Spring
from spear_pin.studies.push_test import PassiveKnee

SOFTNESS = 0.01  # K2 / K1: an assumption, the source says K2 ≪ K1


def off_stiffness(softness: float = SOFTNESS) -> float:
    """Returns the stiffness of S1 and S2 in series over that of S2, for K2 = `softness` K1."""
    require("softness", softness, lambda ratio: ratio > 0, "a number > 0")
    return 1.0 / (1.0 + softness)


def switched_stiffness(step: float = 1e-4) -> float:
    """Returns -dτ/dθ of the shipped spring just beyond its zero over its stiffness."""
    knee = PassiveKnee(stiffness=Spring().stiffness, zero=0.0, unilateral=Spring().unilateral)
    slope = float(knee.spring_torque(2 * step) - knee.spring_torque(step)) / step
    return -slope / Spring().stiffness


def torques(angles: ArrayLike, latched: float = 0.0, softness: float = SOFTNESS) -> tuple[NDArray[np.float64], ...]:
    """Returns the torque that resists flexion with the key engaged at an angle, and without it, in N·m.

    Args:
        angles: angles of the knee, in rad.
        latched: angle at which the key engages, in rad; S2 is slack at zero.
        softness: K2 / K1.
    """
    spring, theta = Spring(), np.asarray(angles, dtype=float)
    series = replace(spring, stiffness=softness * spring.stiffness * off_stiffness(softness))
    return -spring.torque(np.maximum(theta - latched, 0.0)), -series.torque(theta)
