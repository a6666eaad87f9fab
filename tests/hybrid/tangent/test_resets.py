"""Derivatives of joint impacts against differences of the reference rule, and which of them are refused."""

from collections import Counter

import numpy as np
import pytest

from spear_pin import Gait, load
from spear_pin.hybrid.dual import derivative_of, value_of
from spear_pin.hybrid.rules.footing import LIFTS
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import joint_impact, plastic_impact
from spear_pin.hybrid.tangent.fields import ToeNumbers
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable, differentiate_strike

TOES = ("first", "second")
STEP = 1e-3
CASES = 120


class Line:
    """D, J, v and friction that change smoothly with one number s."""

    def __init__(self, seed, toes=2):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2 * toes, 2 * toes + 4))
        rotation, _ = np.linalg.qr(rng.normal(size=(n, n)))
        D, turn = rotation @ np.diag(rng.uniform(0.1, 3.0, n)) @ rotation.T, rng.normal(size=(n, n))
        self.D = 0.5 * (D + D.T), 0.1 * (turn + turn.T)
        self.J, self.v = rng.normal(size=(2, 2 * toes, n)), rng.normal(size=(2, n))
        u = rng.uniform(-2.0, 2.0, 2 * toes)
        u[1::2] = -np.abs(u[1::2])
        self.v[0] += np.linalg.pinv(self.J[0]) @ (u - self.J[0] @ self.v[0])
        self.friction = float(rng.choice([0.1, 0.5, 0.8, 1.5])), rng.uniform(-0.2, 0.2)

    def at(self, s):
        return tuple(first + s * change for first, change in (self.D, self.J, self.v, self.friction))

    @property
    def dual(self):
        """ToeNumbers, and their derivatives by s."""
        D, J, v, friction = self.at(0.0)
        responses = np.linalg.solve(D, J.T)
        turned = np.linalg.solve(D, self.J[1].T - self.D[1] @ responses)
        rows = (-1, 2, len(v))
        here = ToeNumbers(
            friction, np.zeros(len(J) // 2), J.reshape(rows), responses.T.reshape(rows), J @ responses, J @ v
        )
        inertia, speeds = self.J[1] @ responses + J @ turned, self.J[1] @ v + J @ self.v[1]
        parts = (self.friction[1], here.heights, self.J[1].reshape(rows), turned.T.reshape(rows), inertia, speeds)
        return here, ToeNumbers(*(np.asarray(part)[..., None] for part in parts))

    def struck(self, toes):
        """Velocity after the impact and what is held, and derivatives of them by s."""
        change, slope, held = differentiate_strike(*self.dual, toes, toes, range(len(toes)))
        speeds = [held[rise(toe)] for toe in toes if len(toes) > 1]
        slopes = [*(self.v[1] + slope[:, 0]), *(float(np.sum(derivative_of(x))) for x in speeds)]
        return np.array([*(self.v[0] + change), *map(value_of, speeds)]), np.array(slopes)


def outcome(line, s):
    """Velocity after the impact, speeds of lifted toes, and what each toe does."""
    D, J, v, friction = line.at(s)
    impact = joint_impact(D, J, v, friction)
    slides = tuple(np.sign((J @ impact.v)[::2]) * impact.slides)
    return np.concatenate([impact.v, (J @ impact.v)[1::2] * impact.leaves]), (impact.leaves, slides)


def richardson(function, step=STEP, levels=4):
    table = [(function(h) - function(-h)) / (2.0 * h) for h in step / 2.0 ** np.arange(levels)]
    for power in range(1, levels):
        table = [(4.0**power * b - a) / (4.0**power - 1.0) for a, b in zip(table, table[1:], strict=False)]
    return table[0]


def test_random_joint_impacts():
    seen = Counter()
    for seed in range(CASES):
        line = Line(seed)
        here, what = outcome(line, 0.0)
        step = next((h for h in (STEP, 1e-4) if outcome(line, h)[1] == outcome(line, -h)[1] == what), None)
        if step is None:
            continue
        expected = richardson(lambda s, line=line: outcome(line, s)[0], step)
        found, slopes = line.struck(TOES)
        np.testing.assert_allclose(found, here, rtol=0, atol=1e-10)
        np.testing.assert_allclose(slopes, expected, rtol=0, atol=1e-8 * max(1.0, np.abs(expected).max()))
        kinds = ["leaves" if leaves else "slides" if side else "sticks" for leaves, side in zip(*what, strict=True)]
        seen[tuple(sorted(kinds))] += 1
    every = ["leaves slides", "leaves sticks", "slides slides", "slides sticks", "sticks sticks"]
    assert sorted(" ".join(kinds) for kinds in seen) == every
    assert sum(seen.values()) > 0.9 * CASES and min(seen.values()) >= 3


def test_impacts_with_which_bounces_end():
    """Random ones, as slow as that: a toe that would rise stays, beside one that sticks or slides."""
    seen = Counter()
    for seed in range(CASES):
        line = Line(seed)
        rises = outcome(line, 0.0)[0][-2:].max()
        if not rises:
            continue
        line.v = 0.5 * LIFTS / rises * line.v
        if outcome(line, STEP)[1] != outcome(line, -STEP)[1]:
            continue
        D, J, v, friction = line.at(0.0)
        impact = joint_impact(D, J, v, friction)
        assert not any(impact.leaves) and impact.loss > 0.0
        np.testing.assert_allclose((J @ impact.v)[1::2], 0.0, atol=1e-18)
        expected = richardson(lambda s, line=line: outcome(line, s)[0])
        found, slopes = line.struck(TOES)
        np.testing.assert_allclose(found[:-2], impact.v, rtol=0, atol=1e-16)
        np.testing.assert_allclose(slopes, expected, rtol=0, atol=1e-7 * np.abs(expected).max())
        seen[any(impact.slides)] += 1
    assert min(seen[True], seen[False]) > 3


def test_random_impacts_of_one_toe():
    kinds = Counter()
    for seed in range(CASES):
        line = Line(seed, toes=1)

        def after(s, line=line):
            return plastic_impact(*line.at(s)).v

        here = plastic_impact(*line.at(0.0))
        found, slopes = line.struck(TOES[:1])
        np.testing.assert_allclose(found, here.v, rtol=0, atol=1e-10)
        errors = []
        for step in (1e-4, 1e-5):  # the second where a border is near
            expected = richardson(after, step)
            errors.append(np.abs(slopes - expected).max() / max(1.0, np.abs(expected).max()))
        assert min(errors) < 1e-8
        kinds[here.slides] += 1
    assert min(kinds[True], kinds[False]) > 20


@pytest.mark.extra("heyoka")
def test_q_spear_lands_on_both_toes():
    """Numbers of the toes, by the compiled dynamics, and the rule together; differences are of Pinocchio's numbers."""
    system, robot = Gait.load("long_stride").system, load("q_spear")
    recorder, toes = Recorder(system), tuple(robot.toes)
    for seed in range(20):
        rng = np.random.default_rng(seed)
        knees = rng.uniform(0.4, 1.4, 2)
        hips = 0.5 * knees + rng.uniform(-0.3, 0.3, 2)
        q = np.array([0.0, 0.5, rng.uniform(-0.2, 0.2), hips[0], knees[0], hips[1], knees[1]])
        v, direction = rng.normal(size=7) - 2.0 * np.eye(7)[1], rng.normal(size=14)

        def outcome(s, q=q, v=v, direction=direction):
            there = q + s * direction[:7]
            J = np.concatenate([robot.toe_jacobian(there, toe) for toe in toes])
            impact = joint_impact(robot.mass_matrix(there), J, v + s * direction[7:], system.contact.friction)
            return impact.v, (impact.slides, impact.leaves)

        assert outcome(1e-3)[1] == outcome(-1e-3)[1], seed
        state = np.concatenate([q, v])
        seeds = np.zeros((len(recorder.numbers), 1))
        feet, changes = recorder.feet(toes).at(state, recorder.numbers, direction[:, None], seeds)
        _, slope, _ = differentiate_strike(feet, changes, toes, toes, range(len(toes)))
        expected = richardson(lambda s, outcome=outcome: outcome(s)[0])
        np.testing.assert_allclose(slope[:, 0] + direction[7:], expected, rtol=0, atol=1e-8 * np.abs(expected).max())


class TestRefused:
    def line(self, which):
        """A line whose toes both do something, and what they receive."""
        for seed in range(CASES):
            line = Line(seed)
            D, J, v, friction = line.at(0.0)
            impact = joint_impact(D, J, v, friction)
            if which == "sticks" and not any(impact.slides) and not any(impact.leaves):
                return line, impact
            if which == "slides" and all(impact.slides):
                return line, impact
        raise AssertionError

    def test_on_the_edge_of_the_cone(self):
        line, impact = self.line("sticks")
        line.friction = float(np.max(np.abs(impact.impulse[:, 0]) / impact.impulse[:, 1])), 0.0
        with pytest.raises(NotDifferentiable, match="on the border between two outcomes"):
            line.struck(TOES)

    def test_a_toe_that_is_hardly_lifted(self):
        """Toes that the impact leaves at rest, without any force, may be lifted or not."""
        line, _ = self.line("sticks")
        D, J, v, _ = line.at(0.0)
        gone = np.linalg.solve(D, J.T)[:, :2]
        u = J @ v
        u[2:] = (J @ gone)[2:] @ np.linalg.solve((J @ gone)[:2], u[:2])  # what the first receives stops the second
        line.v[0] = v + np.linalg.pinv(J) @ (u - J @ v)
        line.friction = 100.0, 0.0
        with pytest.raises(NotDifferentiable, match="on the border between two outcomes"):
            line.struck(TOES)

    @pytest.mark.parametrize("share", [0.0, 1.0])
    def test_toes_that_only_touch(self, share):
        line, _ = self.line("sticks")
        _, J, v, _ = line.at(0.0)
        line.v[0] = share * (v - np.linalg.pinv(J) @ (J @ v))
        with pytest.raises(NotDifferentiable, match="on the border between two outcomes"):
            line.struck(TOES)

    def test_toes_that_depend_on_each_other(self):
        line, _ = self.line("sticks")
        line.J[0][2] = line.J[0][0]  # along the ground both move alike
        with pytest.raises(NotDifferentiable, match="cannot move independently"):
            line.struck(TOES)
