"""One toe and Coulomb's cone in space: the mode is unique outside Painlevé's paradox, and obeys the law."""

import math

import numpy as np
import pytest

from spear_pin.hybrid.rules.cone import foothold, pivot, slides

ANGLES = np.linspace(0.0, 2.0 * np.pi, 721)


def toes(seed, count):
    """A, b and μ of random toes."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        jacobian, root = rng.normal(size=(3, 6)), rng.normal(size=(6, 6))
        A = jacobian @ np.linalg.solve(root @ root.T + 0.3 * np.eye(6), jacobian.T)
        yield A, rng.normal(size=3), float(rng.uniform(0.2, 1.2))


def paradox(A, friction):
    """Whether some direction has no positive pivot."""
    return A[2, 2] <= friction * math.hypot(A[2, 0], A[2, 1])


def cross(A, b, friction, angle):
    """Cross product of d and (b + A F)_t, times the pivot, of sliding along an angle."""
    d = np.array([math.cos(angle), math.sin(angle)])
    inverse = A[2, 2] - friction * A[2, :2] @ d
    after = inverse * b[:2] - b[2] * (A[:2, 2] - friction * A[:2, :2] @ d)
    return d[0] * after[1] - d[1] * after[0]


def test_one_mode_outside_the_paradox_but_for_rare_toes_with_three_ways_to_slide():
    modes, paradoxes = {}, 0
    for A, b, friction in toes(2, 3000):
        sticking = -np.linalg.solve(A, b)
        sticks = b[2] < 0.0 and math.hypot(*sticking[:2]) <= friction * sticking[2]
        count = (b[2] >= 0.0) + sticks + len(slides(A, b, friction))
        if paradox(A, friction):
            paradoxes += 1
        else:
            modes[count] = modes.get(count, 0) + 1
    assert set(modes) <= {1, 3} and modes.get(3, 0) <= 1 and paradoxes > 100


@pytest.mark.slow
def test_slides_are_all_roots_of_a_scan():
    for A, b, friction in toes(3, 200):
        values = [cross(A, b, friction, angle) for angle in ANGLES]
        crossings = sum(one * other < 0.0 for one, other in zip(values, values[1:], strict=False))
        roots = slides(A, b, friction, -math.inf)
        if not paradox(A, friction) and b[2] < 0.0:
            assert len(roots) == crossings
        for root in roots:
            assert abs(cross(A, b, friction, math.atan2(*root.direction[::-1]))) < 1e-12 * (1.0 + abs(A).max() ** 2)


def test_law():
    for A, b, friction in toes(4, 2000):
        hold = foothold(A, b, friction)
        after, (x, y, z) = b + A @ hold.force, hold.force
        if paradox(A, friction):
            continue
        assert after[2] >= -1e-12 and z >= 0.0 and math.hypot(x, y) <= friction * z * (1.0 + 1e-9)
        if hold.mode == "stick":
            assert abs(after).max() < 1e-10
        if hold.mode == "slip":
            assert abs(after[2]) < 1e-10 and after[:2] @ (x, y) == pytest.approx(-friction * z * math.hypot(*after[:2]))


def test_straight_ahead_it_is_the_planes():
    """A toe without coupling across: the sign of the plane's slip, its pivot and its force."""
    for A, b, friction in toes(5, 500):
        A[1, [0, 2]] = A[[0, 2], 1] = b[1] = 0.0
        for way in slides(A, b, friction):
            if abs(way.direction[1]) > 1e-12:
                continue
            sign = way.direction[0]
            inverse = A[2, 2] - friction * sign * A[2, 0]
            assert pivot(A, way.direction, friction) == pytest.approx(inverse)
            assert way.normal == pytest.approx(-b[2] / inverse)
            assert way.rate == pytest.approx(sign * b[0] + way.normal * (sign * A[0, 2] - friction * A[0, 0]))


def test_on_the_edge_of_the_cone_it_slides_against_the_force_that_held_it():
    for A, _, friction in toes(6, 200):
        angle = 0.7
        force = np.array([friction * math.cos(angle), friction * math.sin(angle), 1.0])
        if paradox(A, friction):
            continue
        ways = slides(A, -A @ force, friction, -1e-6)
        assert min(math.dist(way.direction, (-math.cos(angle), -math.sin(angle))) for way in ways) < 1e-6
