"""Linear algebra of many lanes at once. A lane's numbers depend on that lane alone, to the last digit."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array


def null_spaces(rows: Array) -> Array:
    """Orthonormal bases of the null spaces of matrices, (n, r, m), of one rank, as columns, (n, m, m - rank)."""
    _, sizes, right = np.linalg.svd(rows, full_matrices=True)
    small = np.finfo(float).eps * max(rows.shape[1:]) * sizes.max(axis=1, initial=0.0, keepdims=True)
    rank = int((sizes > small).sum(axis=1).min(initial=sizes.shape[1]))
    return np.ascontiguousarray(np.swapaxes(right[:, rank:], 1, 2))


def applied(matrices: Any, vectors: Any) -> Array:
    """Each matrix times its vector, summed in the same order whatever the number of lanes."""
    return np.asarray((matrices * np.asarray(vectors)[:, None, :]).sum(axis=2))
