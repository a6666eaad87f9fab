"""The equations of a gait: alike by either engine, on ground that varies, and why there is no value in some places."""

import numpy as np
import pytest

from spear_pin import HoppingLaw, find_gait, hopping
from spear_pin.gaits.lane_cycles import LaneCycles
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.newton import CONVERGED
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import displacement, one_by_one, return_map
from spear_pin.hybrid.section import section
from spear_pin.hybrid.shooting import NOT_FINITE, SHORT_CYCLE, SHORTEST_CYCLE, Cycles, Shooting
from tests.hybrid.lanes import compiles

VARY = ("stance_torque", "stiffness")
WANTED = np.array([[0.2, 0.56], [0.19, 0.5], [0.21, 0.55]])


def charts_of(gait, n):
    whole = section(gait.system)
    q, v = (np.repeat(part[None], n, axis=0) for part in gait.state)
    return whole.charts(q, v, whole.sliding(q, v)[0])


def by_reference(system, vary=VARY, measures=("flight_time", "period")):
    """Cycles by the reference engine, and the states and values of which there was one."""
    asked = []

    def cycle(state, values):
        asked.append((state, values))
        return return_map(with_parameters(system, dict(zip(vary, values.tolist(), strict=True))), state)

    return one_by_one(system, cycle, [lambda run, _, name=name: system.measures[name](run) for name in measures]), asked


def invented(measured, seconds):
    """Cycles that reach the states where they begin."""

    def cycle(lanes, q, v, values):
        n = len(lanes)
        return Cycles(
            q, v, np.full((n, 1), measured), {"flight": np.full(n, seconds)}, np.full(n, "", object), n * [True]
        )

    return cycle


@compiles
def test_either_engine_gives_the_same_residuals(hop):
    charts, system = charts_of(hop, 3), hop.system
    lanes, rng = np.array([2, 0, 1, 1]), np.random.default_rng(0)
    unknowns = np.column_stack([1e-2 * rng.normal(size=(4, 3)), 7.5 + rng.normal(size=4), 48.0 + rng.normal(size=4)])
    measures = ["flight_time", "period"]
    cycles = LaneCycles(system, {"damping": np.full(3, system.spring.damping)}, VARY, measures, 1e-9)
    values, why = Shooting(charts, cycles, VARY, WANTED).residuals(lanes, unknowns)
    own, words = Shooting(charts, by_reference(system)[0], VARY, WANTED).residuals(lanes, unknowns)
    assert not why.any() and not words.any() and values.shape == (4, 5)
    np.testing.assert_allclose(values, own, rtol=0, atol=1e-7)


def test_residuals_are_displacements_and_what_targets_are_missed_by(hop):
    charts, system = charts_of(hop, 3), hop.system
    shooting = Shooting(charts, by_reference(system)[0], VARY, WANTED)
    unknowns = np.array([[0.0, 0.0, 0.0, system.law.stance_torque, system.spring.stiffness]] * 3)
    unknowns[1, :3] = 0.01, 0.02, 0.03
    values, _ = shooting.residuals(np.arange(3), unknowns)
    assert np.abs(values[0, :4]).max() < 1e-9  # the gait, with the flight that it was found for
    begun = charts.take(np.array([1])).states(unknowns[1:2, :3])
    before = begun[0][0], begun[1][0]
    result = return_map(system, before)
    moved = displacement(system, before, result.state)
    assert np.linalg.norm(values[1, :3]) == pytest.approx(np.linalg.norm(moved), rel=0.05)
    expected = [result.durations["flight"] - 0.19, sum(result.durations.values()) - 0.5]
    np.testing.assert_allclose(values[1, 3:], expected, rtol=0, atol=1e-12)


def test_of_a_lane_nothing_is_run_after_a_cycle_that_does_not_close(hop):
    cycles, asked = by_reference(hop.system)
    shooting = Shooting(charts_of(hop, 3), cycles, VARY, WANTED)
    unknowns = np.array([[0.0, 0.0, 0.0, 7.8, 48.84]] * 4)
    unknowns[0, 3], unknowns[3, 0] = 0.0, np.nan
    values, why = shooting.residuals(np.array([1, 1, 0, 2]), unknowns)
    assert why.tolist() == ["no_event", "no_event", "", NOT_FINITE] and len(asked) == 2
    np.testing.assert_array_equal(np.isfinite(values).all(axis=1), why == "")
    assert np.isnan(values[why != ""]).all()


@pytest.mark.parametrize(
    ("measured", "seconds", "why"),
    [(0.3, 2.0 * SHORTEST_CYCLE, ""), (0.3, 0.5 * SHORTEST_CYCLE, SHORT_CYCLE), (np.inf, 1.0, NOT_FINITE)],
)
def test_what_is_no_cycle(hop, measured, seconds, why):
    shooting = Shooting(charts_of(hop, 1), invented(measured, seconds), ("stance_torque",), np.array([[0.2]]))
    values, words = shooting.residuals(np.zeros(1, dtype=int), np.array([[0.0, 0.0, 0.0, 7.0]]))
    assert words.tolist() == [why] and np.isfinite(values).all() == (why == "")


@pytest.mark.slow
def test_the_ground_may_vary(free_robot):
    """The states are on it, and a search for a slope finds the one on which the gait was."""
    law, target = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0), {"mean_speed": 0.0}
    gait = find_gait(hopping(free_robot, law, ground=Ground(slope=0.02, height=0.1)), ["hip_touchdown"], target)
    shooting = Shooting(
        charts_of(gait, 1), by_reference(gait.system, ("slope",), ("mean_speed",))[0], ("slope",), np.zeros((1, 1))
    )
    q, v = shooting.states(np.zeros(1, dtype=int), np.array([[0.0, 0.0, 0.0, 0.0, 0.03]]))
    height, jacobian = with_parameters(gait.system, {"slope": 0.03}).ground.foot(free_robot, q[0], "toe")
    assert abs(height) < 1e-14 and np.abs(jacobian @ v[0]).max() < 1e-13
    roots = shooting.solve(np.array([[0.021]]), 1e-9)
    assert roots.end.tolist() == [CONVERGED] and roots.x[0, -1] == pytest.approx(0.02, abs=1e-7)
