"""Multipliers of a whole section in space, each along or lateral.

Of a symmetric gait what is symmetric, the motion along, and what is antisymmetric, the lateral motion, are systems of
their own. In one that is nearly symmetric a multiplier is of that kind which has the greater part of its eigenvector.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array

ALONG, LATERAL = "along", "lateral"


@dataclass(frozen=True)
class Multipliers:
    """Multipliers of a section, by decreasing modulus.

    Attributes:
        values: all of them, (n,).
        kinds: of each "along" or "lateral"; None where the gait does not tell these apart, as a trot does not.
    """

    values: NDArray[np.complex128]
    kinds: tuple[str | None, ...]


def merged(parts: Mapping[bool | None, NDArray[np.complex128]]) -> Multipliers:
    """Put multipliers of parts together.

    Args:
        parts: by whether the part is lateral; None: it is both.
    """
    names = {True: LATERAL, False: ALONG, None: None}
    values = np.concatenate([*parts.values()])
    kinds = [names[lateral] for lateral, part in parts.items() for _ in part]
    order = _order(values)
    return Multipliers(values[order], tuple(kinds[i] for i in order))


def parted(A: Array, symmetric: NDArray[np.bool_]) -> Multipliers:
    """Find the multipliers of first-order motion, and what each is for the greater part.

    Args:
        A: of a⁺ = A a, (n, n).
        symmetric: whether each coordinate is symmetric, (n,).
    """
    values, vectors = np.linalg.eig(A)
    order = _order(values)
    shares = (np.abs(vectors[~symmetric]) ** 2).sum(axis=0) / (np.abs(vectors) ** 2).sum(axis=0)
    return Multipliers(values[order].astype(np.complex128), tuple(LATERAL if shares[i] > 0.5 else ALONG for i in order))


def _order(values: NDArray[np.complex128]) -> NDArray[np.int64]:
    """By decreasing modulus; of a pair the one above the real axis first."""
    return np.asarray(np.lexsort((-values.imag, -np.round(np.abs(values), 9))))
