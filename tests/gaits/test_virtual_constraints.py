"""Virtual constraints: Bézier polynomials against SciPy's, and what the torques do to the outputs of Q-SPEAR."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import BPoly

from spear_pin import Contact, HoppingLaw, load
from spear_pin.gaits.virtual_constraints import (
    Evolution,
    Leaning,
    Outputs,
    bezier,
    demand_accelerations,
    errors,
    evaluate_desired,
    progress,
    resume,
    value,
)
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.engines.pinocchio import Flow

ROBOT = load("q_spear")
POSTERIOR, ANTERIOR = (((2, 1.0), (3, 1.0), (4, -0.5)), ((4, 1.0),)), (((2, 1.0), (5, 1.0), (6, -0.5)), ((6, 1.0),))
FLIGHT = Outputs((*POSTERIOR, *ANTERIOR), ((0, 1.0),), (0, 1, 2, 3))
STANCE = Outputs(ANTERIOR, POSTERIOR[0], (2, 3))  # the posterior leg bears, the anterior one swings
LEANING = tuple(Leaning(((2, 1.0), (hip, 1.0)), hip + 1, 0.35, 0.25) for hip in (3, 5))  # of a thigh and a shank
OUTPUTS = {
    "flight": FLIGHT,
    "stance": STANCE,
    "leaning flight": replace(FLIGHT, rows=(LEANING[0], POSTERIOR[1], LEANING[1], ANTERIOR[1])),
    "leaning stance": Outputs((LEANING[1], ANTERIOR[1]), LEANING[0], (2, 3)),
}
PUSH = [(0, -60.0), (1, -35.0)]  # of the bearing leg
EPSILON = 0.02

often = settings(max_examples=60, derandomize=True, deadline=None)
numbers = st.floats(-5.0, 5.0)
coefficients = st.lists(numbers, min_size=2, max_size=8)
each_phase = pytest.mark.parametrize("phase", OUTPUTS)
each_linear_phase = pytest.mark.parametrize("phase", ["flight", "stance"])


def given_torques(phase):
    return PUSH if "stance" in phase else []


def drawn(seed, phase):
    """A state with bent legs, and an evolution through other places than where the outputs are."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-0.3, 0.3, 7) + [0.0, 0.6, 0.0, 0.4, 0.9, 0.2, -0.9]
    v = rng.uniform(-1.0, 1.0, 7) * [2.0, 1.0, 3.0, 6.0, 6.0, 6.0, 6.0]
    outputs = OUTPUTS[phase]
    if "stance" in phase:
        J = ROBOT.toe_jacobian(q, "posterior_toe")
        v = v - np.linalg.pinv(J) @ J @ v
    alpha = tuple(tuple(rng.uniform(-1.0, 1.0, 6).tolist()) for _ in outputs.rows)
    span = -0.5 if "stance" in phase else 0.3
    origin = float(value(outputs.phase, q)) - span * rng.uniform(0.1, 0.6)
    return q, v, Evolution(alpha, origin, span)


def torques_of(outputs, evolution, q, v, epsilon, others, dyn):
    return dyn.imposing(*demand_accelerations(outputs, evolution, q, v, epsilon), outputs.motors, others)


def flow_of(phase, evolution):
    """Q-SPEAR with the law under test, the rest of its automaton left out."""

    def law(t, q, v, held, p, dyn, ops):
        others = given_torques(phase)
        torques = torques_of(OUTPUTS[phase], evolution, q, v, EPSILON, others, dyn)
        chosen = dict([*others, *zip(OUTPUTS[phase].motors, torques, strict=True)])
        return [chosen[column] for column in range(4)]

    domain = Domain(phase, phase, (STICK if "stance" in phase else OPEN, OPEN), law)
    system = HybridSystem("none", ROBOT, HoppingLaw(), {}, Contact(), (domain,), "", (), build=None, guess=lambda: None)
    return Flow(system, domain, {})


def followed(flow, state, times):
    y = np.concatenate([*state, np.zeros(7)])
    result = solve_ivp(flow, (0.0, times[-1]), y, t_eval=times, method="DOP853", rtol=1e-12, atol=1e-13)
    assert result.success
    return [(column[:7], column[7:14]) for column in result.y.T]


class TestBezier:
    @often
    @given(alpha=coefficients, s=st.floats(0.0, 1.0))
    def test_as_scipy(self, alpha, s):
        polynomial = BPoly(np.array(alpha)[:, None], [0.0, 1.0])
        expected = [float(polynomial(s, nu)) for nu in range(3)]
        np.testing.assert_allclose(bezier(alpha, s), expected, rtol=0, atol=1e-10 * max(1.0, max(map(abs, alpha))))

    def test_a_constant(self):
        assert bezier((3.0,), 0.2) == (3.0, 0.0, 0.0)

    @often
    @given(alpha=coefficients)
    def test_ends(self, alpha):
        n = len(alpha) - 1
        value, slope, _ = bezier(alpha, 0.0)
        assert value == alpha[0] and slope == pytest.approx(n * (alpha[1] - alpha[0]), abs=1e-12)
        value, slope, _ = bezier(alpha, 1.0)
        assert value == alpha[-1] and slope == pytest.approx(n * (alpha[-1] - alpha[-2]), abs=1e-12)

    def test_batches(self):
        s = np.linspace(0.0, 1.0, 7)
        together = np.array(bezier([0.3, -1.0, 2.0, 0.1], s))
        alone = np.array([bezier([0.3, -1.0, 2.0, 0.1], value) for value in s]).T
        np.testing.assert_allclose(together, alone, rtol=1e-14)


class TestDesired:
    """Beyond the end the polynomial goes on along its tangent."""

    def at(self, alpha, s, past):
        return evaluate_desired(Evolution((tuple(alpha),), 1.0, 2.0, past), s)[0]

    @often
    @given(alpha=coefficients, s=st.floats(1.0, 3.0))
    def test_tangent(self, alpha, s):
        value, slope, curvature = self.at(alpha, s, 1.0)
        end, end_slope, _ = bezier(alpha, 1.0)
        assert value == pytest.approx(end + end_slope * (s - 1.0), abs=1e-9)
        assert slope == pytest.approx(end_slope, abs=1e-9) and curvature == 0.0

    @often
    @given(alpha=coefficients)
    def test_joins_without_a_kink(self, alpha):
        inside, outside = self.at(alpha, 1.0, 0.0), self.at(alpha, 1.0, 1.0)
        assert inside[:2] == pytest.approx(outside[:2], abs=1e-9)
        np.testing.assert_allclose(inside, bezier(alpha, 1.0), rtol=0, atol=1e-9)

    @often
    @given(start=st.lists(numbers, min_size=1, max_size=4), end=numbers, s=st.floats(1.0, 3.0))
    def test_equal_last_coefficients_hold_the_end(self, start, end, s):
        """Three of them: the curvature goes over without a jump too."""
        alpha = (*start, end, end, end)
        assert self.at(alpha, s, 1.0) == pytest.approx((end, 0.0, 0.0), abs=1e-9)
        assert self.at(alpha, 1.0, 0.0) == pytest.approx((end, 0.0, 0.0), abs=1e-9)

    def test_before_the_beginning_it_is_the_polynomial(self):
        np.testing.assert_allclose(self.at((0.3, -1.0, 2.0), -0.2, 0.0), bezier((0.3, -1.0, 2.0), -0.2), rtol=1e-14)

    @each_linear_phase
    def test_progress(self, phase):
        q, _, evolution = drawn(1, phase)
        travelled = float(np.dot(_dense(OUTPUTS[phase].phase), q)) - evolution.origin
        assert progress(OUTPUTS[phase], evolution, q) == pytest.approx(travelled / evolution.span, rel=1e-13)


def _dense(row):
    vector = np.zeros(7)
    for index, weight in row:
        vector[index] = weight
    return vector


class TestErrors:
    @each_phase
    @pytest.mark.parametrize("past", [0.0, 1.0])
    @pytest.mark.parametrize("seed", range(5))
    def test_rates_are_those_of_the_outputs(self, phase, past, seed):
        q, v, evolution = drawn(seed, phase)
        evolution, outputs = replace(evolution, past=past), OUTPUTS[phase]
        h = 1e-4
        near, far = (
            np.array(errors(outputs, evolution, q + k * h * v, v)[0])
            - np.array(errors(outputs, evolution, q - k * h * v, v)[0])
            for k in (1, 2)
        )
        _, dy = errors(outputs, evolution, q, v)
        np.testing.assert_allclose(dy, (8 * near - far) / (12 * h), rtol=0, atol=1e-8)

    def test_by_hand(self):
        outputs = Outputs((((1, 2.0), (2, -1.0)),), ((0, 1.0),), (0,))
        evolution = Evolution(((1.0, 3.0),), 10.0, 4.0)  # 1 + 2 s
        y, dy = errors(outputs, evolution, [12.0, 5.0, 1.0], [8.0, 1.0, 0.5])
        assert (y, dy) == ([9.0 - 2.0], [1.5 - 2.0 * 2.0])


class TestZeroing:
    @each_phase
    @pytest.mark.parametrize("past", [0.0, 1.0])
    @pytest.mark.parametrize("seed", range(6))
    def test_second_derivative(self, phase, past, seed):
        """ÿ = -y/ε² - 2ẏ/ε, with ÿ by differences of ẏ along the motion."""
        q, v, evolution = drawn(seed, phase)
        evolution, outputs = replace(evolution, past=past), OUTPUTS[phase]
        flow, h = flow_of(phase, evolution), 2e-5
        motion = followed(flow, (q, v), [k * h for k in range(5)])
        y, dy = (np.array(part) for part in zip(*(errors(outputs, evolution, *at) for at in motion), strict=True))
        expected = -y[2] / EPSILON**2 - 2.0 * dy[2] / EPSILON
        second = (8.0 * (dy[3] - dy[1]) - (dy[4] - dy[0])) / (12.0 * h)
        scale = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(second, expected, rtol=0, atol=1e-6 * scale)
        assert scale > 100.0  # there is something to zero

    @each_linear_phase
    @pytest.mark.parametrize("seed", range(6))
    def test_at_once(self, phase, seed):
        """The same from the acceleration: the outputs' gradient times v̇, plus what rates alone give."""
        q, v, evolution = drawn(10 + seed, phase)
        outputs = OUTPUTS[phase]
        flow = flow_of(phase, evolution)
        a = flow(0.0, np.concatenate([q, v, np.zeros(7)]))[7:14]
        y, dy = (np.array(part) for part in errors(outputs, evolution, q, v))
        rate, second = np.dot(_dense(outputs.phase), v) / evolution.span, np.dot(_dense(outputs.phase), a)
        shape = BPoly(np.array(evolution.alpha).T[:, None], [0.0, 1.0])
        s = progress(outputs, evolution, q)
        H = np.array([_dense(row) for row in outputs.rows])
        accelerations = H @ a - shape(s, 1) * second / evolution.span - shape(s, 2) * rate**2
        expected = -y / EPSILON**2 - 2.0 * dy / EPSILON
        np.testing.assert_allclose(accelerations, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
        if "stance" in phase:
            assert flow.force("posterior_toe") != (0.0, 0.0)
            np.testing.assert_allclose(flow.toe_acceleration("posterior_toe"), 0.0, rtol=0, atol=1e-9)

    def test_the_other_motors_are_left_alone(self):
        q, v, evolution = drawn(3, "stance")
        flow = flow_of("stance", evolution)
        flow(0.0, np.concatenate([q, v, np.zeros(7)]))
        assert [*flow.u[:2]] == [torque for _, torque in PUSH]

    @each_phase
    def test_decay(self, phase):
        """Both roots are -1/ε: y = (y₀ + (ẏ₀ + y₀/ε) t) exp(-t/ε)."""
        q, v, evolution = drawn(4, phase)
        # slowly, and along a gentle evolution: it is to stay regular for some ε
        outputs = OUTPUTS[phase]
        v = 0.1 * v
        alpha = tuple(
            tuple(0.1 * number + float(value(row, q)) for number in each)
            for row, each in zip(outputs.rows, evolution.alpha, strict=True)
        )
        evolution = Evolution(alpha, float(value(outputs.phase, q)), evolution.span)
        times = np.linspace(0.0, 5.0 * EPSILON, 11)
        motion = followed(flow_of(phase, evolution), (q, v), times)
        y = np.array([errors(outputs, evolution, *at)[0] for at in motion])
        y_0, dy_0 = (np.array(part) for part in errors(outputs, evolution, q, v))
        expected = [(y_0 + (dy_0 + y_0 / EPSILON) * t) * math.exp(-t / EPSILON) for t in times]
        np.testing.assert_allclose(y, expected, rtol=0, atol=1e-8)
        assert np.abs(y[0]).max() > 0.01 and np.abs(y[-1]).max() < 0.1 * np.abs(y[0]).max()


class TestResume:
    @each_phase
    @pytest.mark.parametrize("seed", range(20))
    def test_outputs_begin_at_zero(self, phase, seed):
        """(5.22), wherever the state is; the coefficients from the third on are the ones given."""
        rng = np.random.default_rng(seed)
        q, v, _ = drawn(seed, phase)
        outputs = OUTPUTS[phase]
        shapes = [tuple(rng.uniform(-1.0, 1.0, length).tolist()) for length in rng.integers(1, 6, len(outputs.rows))]
        span = float(rng.uniform(0.1, 1.0) * rng.choice([-1.0, 1.0]))
        begun = resume(outputs, shapes, q.tolist(), v.tolist(), span)
        y, dy = errors(outputs, begun, q, v)
        assert np.abs(y).max() < 1e-12 and np.abs(dy).max() < 1e-10
        assert [alpha[2:] for alpha in begun.alpha] == shapes
        assert progress(outputs, begun, q) == 0.0
        assert (begun.span, begun.past) == (span, 0.0)


class TestOnSymbols:
    """They are pure and never branch on a value."""

    OUTPUTS = Outputs((((1, 1.0),), ((2, 1.0), (0, 0.5))), ((0, 1.0),), (0, 2))

    @staticmethod
    def dyn(response, solve):
        """Dynamics with v̇ = a + A u of scalars of any kind."""
        free, gains = response

        def imposing(rows, wanted, motors, others):
            fixed = [a + sum(gain[j] * torque for j, torque in others) for a, gain in zip(free, gains, strict=True)]
            decoupling = [[sum(weight * gains[i][j] for i, weight in row) for j in motors] for row in rows]
            missing = [a - sum(weight * fixed[i] for i, weight in row) for a, row in zip(wanted, rows, strict=True)]
            return solve(decoupling, missing)

        return SimpleNamespace(imposing=imposing)

    def test_zeroing(self):
        q, v, free = (sp.symbols(f"{name}0:3", real=True) for name in ("q", "v", "a"))
        gains = [sp.symbols(f"A{i}_0:3", real=True) for i in range(3)]
        alpha = tuple(sp.symbols(f"alpha{i}_0:4", real=True) for i in range(2))
        origin, span, past, epsilon, push = sp.symbols("origin span past epsilon push", real=True)
        evolution = Evolution(alpha, origin, span, past)
        dyn = self.dyn((free, gains), lambda a, b: sp.Matrix(a).LUsolve(sp.Matrix(b)))
        torques = list(torques_of(self.OUTPUTS, evolution, q, v, epsilon, [(1, push)], dyn))
        assert not any(sp.sympify(torque).has(sp.Piecewise, sp.nan) for torque in torques)
        symbols = [*q, *v, *free, *(g for row in gains for g in row), *alpha[0], *alpha[1]]
        symbols += [origin, span, past, epsilon, push]
        compiled = sp.lambdify(symbols, torques, "math", cse=True)
        rng = np.random.default_rng(5)
        for trial in range(10):
            x = dict(zip(symbols, rng.uniform(0.2, 2.0, len(symbols)).tolist(), strict=True)) | {past: float(trial % 2)}

            def at(each, x=x):
                return tuple(at(one) for one in each) if isinstance(each, (tuple, list)) else x[each]

            response = at(free), at(gains)
            held = Evolution(at(alpha), x[origin], x[span], x[past])
            dyn = self.dyn(response, np.linalg.solve)
            expected = torques_of(self.OUTPUTS, held, at(q), at(v), x[epsilon], [(1, x[push])], dyn)
            np.testing.assert_allclose(compiled(*x.values()), expected, rtol=1e-9)

    def test_resume_and_errors(self):
        q, v = sp.symbols("q0:3", real=True), sp.symbols("v0:3", real=True)
        span = sp.Symbol("span", real=True)
        begun = resume(self.OUTPUTS, [sp.symbols("b0:2"), sp.symbols("c0:4")], q, v, span)
        y, dy = errors(self.OUTPUTS, begun, q, v)
        assert [sp.simplify(value) for value in (*y, *dy)] == [0, 0, 0, 0]

    @pytest.mark.extra("casadi")
    def test_casadi(self):
        import casadi

        s, alpha = casadi.SX.sym("s"), (0.3, -1.0, 2.0, 0.1)
        ((value, slope, curvature),) = evaluate_desired(Evolution((alpha,), 0.0, 1.0), s)
        for missed in (casadi.gradient(value, s) - slope, casadi.gradient(slope, s) - curvature):
            assert float(casadi.Function("f", [s], [missed])(0.3)) == pytest.approx(0.0, abs=1e-13)
