"""Linear algebra of scalars of any kind, without pivoting; entries that are the number zero are left out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from spear_pin.model.mechanism import Terms
from spear_pin.model.scalars import dot, negate, plus, times, vanishes

Matrix = list[list[Any]]


def factorize(matrix: Matrix) -> tuple[Matrix, list[Any]]:
    """Factorizes a symmetric matrix into Lᵀ diag(d) L, and returns L and d.

    It begins with the last row, which keeps zeros in the mass matrix of a tree: a joint comes after those that carry
    it. The matrix is positive definite, or that of `responses`, for which no pivot vanishes either.
    """
    n = len(matrix)
    lower: Matrix = [[0.0] * n for _ in range(n)]
    diagonal: list[Any] = [0.0] * n
    for j in reversed(range(n)):
        columns = [[lower[k][i] for k in range(j + 1, n)] for i in range(j + 1)]
        scaled = [times(value, d) for value, d in zip(columns[j], diagonal[j + 1 :], strict=True)]
        diagonal[j] = matrix[j][j] - dot(scaled, columns[j])
        for i in range(j):
            value = plus(matrix[i][j], negate(dot(scaled, columns[i])))
            lower[j][i] = 0.0 if vanishes(value) else value / diagonal[j]
    return lower, diagonal


def substitute(factors: tuple[Matrix, list[Any]], right: Sequence[Any]) -> list[Any]:
    """Solves Lᵀ diag(d) L x = right."""
    lower, diagonal = factors
    n, x = len(diagonal), list(right)
    for i in reversed(range(n)):
        x[i] = plus(x[i], negate(dot([lower[k][i] for k in range(i + 1, n)], x[i + 1 :])))
    x = [0.0 if vanishes(value) else value / d for value, d in zip(x, diagonal, strict=True)]
    for i in range(n):
        x[i] = plus(x[i], negate(dot(lower[i][:i], x[:i])))
    return x


def eliminate(matrix: Matrix, rights: Matrix) -> Matrix:
    """Solves linear systems of one symmetric matrix, as `factorize` takes it."""
    factors = factorize(matrix)
    return [substitute(factors, right) for right in rights]


def responses(
    terms: Terms, rows: Matrix, solved: Callable[[Matrix, Matrix], Matrix] = eliminate, grips: Matrix | None = None
) -> Matrix:
    """Returns the change of velocity for a unit impulse along each row, D⁻¹ Jᵀ.

    With closed loops and joints that brakes hold, whose rows are A, it solves D r + Aᵀ μ = Jᵀ, A r = 0 instead.
    """
    loops = [*terms.loop_rows, *(grips or [])]
    if not loops:
        return solved(terms.mass_matrix, rows)
    none = [0.0] * len(loops)
    border = [[*none, *row] for row in loops]
    border += [[*column, *own] for own, *column in zip(terms.mass_matrix, *loops, strict=True)]
    return [found[len(loops) :] for found in solved(border, [[*none, *row] for row in rows])]


def determinant(matrix: Sequence[Sequence[Any]]) -> Any:
    """Returns the determinant of a small matrix, by its first row."""
    if not matrix:
        return 1.0
    total: Any = 0.0
    for j, value in enumerate(matrix[0]):
        if not vanishes(value):
            rest = times(value, determinant([[*row[:j], *row[j + 1 :]] for row in matrix[1:]]))
            total = plus(total, negate(rest) if j % 2 else rest)
    return total


def solve(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any]:
    """Solves a small linear system, by elimination in the given order as far as it has pivots."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    n = len(rows)
    for j in range(n):
        # the diagonal, unless it is the number zero
        pivot = next((i for i in range(j, n) if not vanishes(rows[i][j])), j)
        rows[j], rows[pivot] = rows[pivot], rows[j]
        for i in range(j + 1, n):
            if vanishes(rows[i][j]):
                continue
            factor = rows[i][j] / rows[j][j]
            rows[i] = [0.0] * (j + 1) + [a - times(factor, b) for a, b in zip(rows[i], rows[j], strict=True)][j + 1 :]
    x: list[Any] = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - dot(rows[i][i + 1 : n], x[i + 1 :])) / rows[i][i]
    return x


def solve_sparse(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any]:
    """Solves a linear system by first eliminating entries that are the number 1 or -1, then calling `solve`.

    It first takes the entry whose row and column have the fewest other entries, which keeps zeros.
    """
    rows = [{j: value for j, value in enumerate(row) if not vanishes(value)} for row in matrix]
    right, left, pivots = list(right), list(range(len(rows))), []
    while chosen := _unit(rows, left):
        *_, i, j = chosen
        left.remove(i)
        pivots.append((i, j))
        for k in left:
            right[k] = _less(right[k], times(_eliminate(rows[k], rows[i], j), right[i]))
    taken = {j for _, j in pivots}
    columns = [j for j in range(len(rows)) if j not in taken]
    dense = solve([[rows[i].get(j, 0.0) for j in columns] for i in left], [right[i] for i in left])
    x = dict(zip(columns, dense, strict=True))
    for i, j in reversed(pivots):
        others = [k for k in rows[i] if k != j]
        x[j] = times(rows[i][j], _less(right[i], dot([rows[i][k] for k in others], [x[k] for k in others])))
    return [x[j] for j in range(len(rows))]


def _eliminate(row: dict[int, Any], pivot: Mapping[int, Any], j: int) -> Any:
    """Eliminates a row's entry j by a multiple of another row, whose entry j is 1 or -1; returns the factor."""
    factor = times(row.pop(j, 0.0), pivot[j])  # 1 and -1 are their own inverses
    if not vanishes(factor):
        for other, value in pivot.items():
            if other != j:
                row[other] = _less(row.get(other, 0.0), times(factor, value))
    return factor


def _unit(rows: Sequence[dict[int, Any]], left: Sequence[int]) -> tuple[bool, int, int, int] | None:
    """Finds the remaining entry 1 or -1 that is cheapest to eliminate; returns the cost, its row and its column."""
    counts: dict[int, int] = {}
    for i in left:
        for j in rows[i]:
            counts[j] = counts.get(j, 0) + 1
    units = [(i, j) for i in left for j, value in rows[i].items() if isinstance(value, float) and abs(value) == 1.0]
    return min(((i != j, (len(rows[i]) - 1) * (counts[j] - 1), i, j) for i, j in units), default=None)


def _less(a: Any, b: Any) -> Any:
    if vanishes(b):
        return a
    return -b if vanishes(a) else a - b
