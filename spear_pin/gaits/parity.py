"""Multipliers of a whole section in space, each with its kind: along or lateral.

In a symmetric gait the symmetric motion (along) and the antisymmetric motion (lateral) are separate systems. In a
nearly symmetric gait a multiplier has the kind that makes up most of its eigenvector.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.periodic import by_modulus

ALONG, LATERAL = "along", "lateral"


@dataclass(frozen=True)
class Multipliers:
    """Multipliers of a section, by decreasing modulus.

    Attributes:
        values: all multipliers, (n,).
        kinds: kind of each, "along" or "lateral"; None where the gait does not separate the two, as in a trot.
    """

    values: NDArray[np.complex128]
    kinds: tuple[str | None, ...]


def merge_multipliers(parts: Mapping[bool | None, NDArray[np.complex128]]) -> Multipliers:
    """Merges the multipliers of parts.

    Args:
        parts: by whether the part is lateral; None for a part that is both.
    """
    names = {True: LATERAL, False: ALONG, None: None}
    values = np.concatenate([*parts.values()])
    kinds = [names[lateral] for lateral, part in parts.items() for _ in part]
    order = by_modulus(values)
    return Multipliers(values[order], tuple(kinds[i] for i in order))


def split_multipliers(A: Array, symmetric: NDArray[np.bool_]) -> Multipliers:
    """Finds the multipliers of first-order motion, and the kind that makes up most of each.

    A kind's share is its participation factor, the product of the mode's left and right eigenvectors over its
    coordinates. A right eigenvector alone would mislead where one kind drives the other much: in a triangular A,
    participation is 1 for the block that a multiplier comes from.

    Args:
        A: matrix of a⁺ = A a, (n, n).
        symmetric: whether each coordinate is symmetric, (n,).
    """
    values, vectors = np.linalg.eig(A)
    order = by_modulus(values)
    shares = (np.linalg.pinv(vectors).T * vectors)[~symmetric].sum(axis=0).real
    return Multipliers(values[order].astype(np.complex128), tuple(LATERAL if shares[i] > 0.5 else ALONG for i in order))
