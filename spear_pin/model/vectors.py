"""Vectors of three scalars of any kind, and matrices as rows of them; entries that are the number zero are left out."""

from __future__ import annotations

from typing import Any

from spear_pin.model.scalars import dot, negate, plus, times

Vector = tuple[Any, ...]
Rows = tuple[Vector, ...]
ZERO: Vector = (0.0, 0.0, 0.0)
UPRIGHT: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def rotation(axis: Vector, cosine: Any, sine: Any) -> Rows:
    """Returns the matrix of a rotation about a unit vector of numbers."""
    x, y, z = axis
    skew = (0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)

    def entry(i: int, j: int) -> Any:
        along = axis[i] * axis[j]
        if i == j:
            return 1.0 if along == 1.0 else along + (1.0 - along) * cosine
        return plus(times(along, 1.0 - cosine), times(skew[i][j], sine))

    return tuple(tuple(entry(i, j) for j in range(3)) for i in range(3))


def add(a: Vector, b: Vector) -> Vector:
    """Returns the sum of two vectors."""
    return plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2])


def subtract(a: Vector, b: Vector) -> Vector:
    """Returns the difference of two vectors."""
    return add(a, scale(-1.0, b))


def scale(factor: Any, vector: Vector) -> Vector:
    """Returns a multiple of a vector."""
    return times(factor, vector[0]), times(factor, vector[1]), times(factor, vector[2])


def cross(a: Vector, b: Vector) -> Vector:
    """Returns the cross product."""
    return tuple(plus(times(a[i], b[j]), negate(times(a[j], b[i]))) for i, j in ((1, 2), (2, 0), (0, 1)))


def rotate(rows: Rows, vector: Vector) -> Vector:
    """Returns R v, for the rows of R."""
    return dot(rows[0], vector), dot(rows[1], vector), dot(rows[2], vector)


def rotate_back(rows: Rows, vector: Vector) -> Vector:
    """Returns Rᵀ v, for the rows of R."""
    return rotate(transpose(rows), vector)


def multiply(a: Rows, b: Rows) -> Rows:
    """Returns the product of two matrices."""
    columns = transpose(b)
    return tuple(rotate(columns, row) for row in a)


def transpose(rows: Rows) -> Rows:
    """Returns the transpose of a matrix."""
    return tuple(zip(*rows, strict=True))


def floats_of(values: Any) -> Vector:
    """Returns a vector of three numbers, such as an array."""
    return tuple(map(float, values))


def matrix_of(matrix: Any) -> Rows:
    """Returns the rows of a matrix of numbers."""
    return tuple(map(floats_of, matrix))
