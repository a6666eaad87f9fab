"""Computes the share of time that each law acts while toes alternate on the ground, so that none accelerates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy

from spear_pin.arrays import Array

EXACT = 1e-13  # of a share
ROUNDING = 1e-9  # largest remaining acceleration of a toe, relative to the largest acceleration
STARTS = ((0.5, 0.5), *product((0.95, 0.05), repeat=2))


class Turn(NamedTuple):
    """Situation of two alternating toes in which one law acts: which toe changed last, and whether each bears."""

    toe: int
    bears: bool
    other: bool


TURNS = tuple(Turn(*each) for each in product((1, 0), (True, False), (True, False)))
"""All of two toes; the last is that of the first toe just lifted, the other in the air."""
_TOE = np.array([turn.toe for turn in TURNS])
_BEARS, _OTHER = (np.array([turn[i] for turn in TURNS]) for i in (1, 2))


def of_one(rise: float, fall: float) -> float:
    """Returns the share of a stance that accelerates the toe by `rise`, with a flight that does so by `fall`."""
    return fall / (fall - rise)


def of_two(accelerations: Array, before: Sequence[float] = ()) -> tuple[float, ...]:
    """Returns the shares of time that two toes' switches are closed, NaN if there are none.

    Of several solutions it takes the first found between 0 and 1, or else the one least outside.

    Args:
        accelerations: vertical accelerations of both toes in each of `TURNS`, (8, 2), in m/s².
        before: the shares a moment ago, if they are known.
    """
    scale = float(np.abs(accelerations).max())
    best, least = (math.nan, math.nan), math.inf
    if not math.isfinite(scale):
        return best
    for start in (before, *STARTS) if before else STARTS:
        found = scipy.optimize.root(
            lambda shares: weights(*shares) @ accelerations / scale, start, method="hybr", tol=EXACT
        )
        outside = float(np.abs(found.x - 0.5).max()) - 0.5
        if np.abs(found.fun).max() < ROUNDING and outside < least:
            best, least = tuple(found.x.tolist()), outside
        if least <= 0.0:
            break
    return best


def weights(first: float, second: float) -> Array:
    """Returns the share of each of `TURNS`, (8,), given the shares of the toes' switches.

    The switches are independent: both are closed for the product of their shares. If a phase depends on which toe
    changed last, each toe counts as often as it changes, in proportion to α (1 - α).
    """
    closed = np.array((first, second))
    own, other = closed[_TOE], closed[1 - _TOE]
    own, other = np.where(_BEARS, own, 1.0 - own), np.where(_OTHER, other, 1.0 - other)
    return np.asarray(own * other * (1.0 - own) / (2.0 - own - other), np.float64)
