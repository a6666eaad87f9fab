"""Linear algebra of many lanes at once. A lane's results depend exactly on that lane alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array


def null_spaces(rows: Array) -> Array:
    """Returns orthonormal bases of null spaces, as columns, (n, m, m - rank), of matrices of one rank, (n, r, m)."""
    _, sizes, right = np.linalg.svd(rows, full_matrices=True)
    small = np.finfo(float).eps * max(rows.shape[1:]) * sizes.max(axis=1, initial=0.0, keepdims=True)
    rank = int((sizes > small).sum(axis=1).min(initial=sizes.shape[1]))
    return np.ascontiguousarray(np.swapaxes(right[:, rank:], 1, 2))


def apply_matrices(matrices: Any, vectors: Any) -> Array:
    """Multiplies each matrix by its vector, and sums in the same order for any number of lanes."""
    return np.asarray((matrices * np.asarray(vectors)[:, None, :]).sum(axis=2))
