"""Linear algebra of scalars of any kind, without pivoting; entries that are the number zero are left out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Matrix = list[list[Any]]


def factorize(matrix: Matrix) -> tuple[Matrix, list[Any]]:
    """L and d of a symmetric positive definite matrix L diag(d) Lᵀ."""
    n = len(matrix)
    lower: Matrix = [[0.0] * n for _ in range(n)]
    diagonal: list[Any] = []
    for j in range(n):
        scaled = [times(lower[j][k], diagonal[k]) for k in range(j)]
        diagonal.append(matrix[j][j] - dot(scaled, lower[j][:j]))
        for i in range(j + 1, n):
            value = matrix[i][j] - dot(scaled, lower[i][:j])
            lower[i][j] = 0.0 if _zero(value) else value / diagonal[j]
    return lower, diagonal


def substitute(factors: tuple[Matrix, list[Any]], right: Sequence[Any]) -> list[Any]:
    """The solution of L diag(d) Lᵀ x = right."""
    lower, diagonal = factors
    n = len(diagonal)
    x: list[Any] = []
    for i in range(n):
        x.append(right[i] - dot(lower[i][:i], x))
    x = [0.0 if _zero(value) else value / d for value, d in zip(x, diagonal, strict=True)]
    for i in reversed(range(n)):
        x[i] = x[i] - dot([lower[j][i] for j in range(i + 1, n)], x[i + 1 :])
    return x


def solve(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any]:
    """The solution of a small linear system, by elimination in the given order."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    n = len(rows)
    for j in range(n):
        for i in range(j + 1, n):
            if _zero(rows[i][j]):
                continue
            factor = rows[i][j] / rows[j][j]
            rows[i] = [0.0] * (j + 1) + [a - times(factor, b) for a, b in zip(rows[i], rows[j], strict=True)][j + 1 :]
    x: list[Any] = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - dot(rows[i][i + 1 : n], x[i + 1 :])) / rows[i][i]
    return x


def _zero(value: Any) -> bool:
    return isinstance(value, float) and value == 0.0


def times(a: Any, b: Any) -> Any:
    """The product, zero if a factor is."""
    return 0.0 if _zero(a) or _zero(b) else a * b


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Σ a b, leaving out what is zero."""
    total: Any = 0.0
    for x, y in zip(a, b, strict=True):
        product = times(x, y)
        if not _zero(product):
            total = product if _zero(total) else total + product
    return total


def negated(value: Any) -> Any:
    """The negative, zero of zero."""
    return 0.0 if _zero(value) else -value
