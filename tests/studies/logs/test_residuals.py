"""Residuals of a log: their Jacobian beside differences, their parts, and from where on arcs are shot."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import hopping, load, simulate
from spear_pin.studies.logs.arcs import find_arcs
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import find_measured
from spear_pin.studies.logs.played import make_played
from spear_pin.studies.logs.residuals import Residuals
from tests.studies.logs.crank_leg import two_joints

pytestmark = pytest.mark.extra("heyoka")
SENSORS = {"crank_zero": 0.01, "lag": 0.001, "boom_z_zero": 0.02, "boom_z_lag": 0.002}


@pytest.fixture(scope="module")
def hop(plain_log):
    """One hop, with a height that is there at every other sample."""
    log, run = plain_log
    kept = log.t < 0.4
    height = np.interp(log.t, run.t, run.q[:, 0])
    height[1::2] = np.nan
    values = {**log.values, "boom_z": height}
    return Log("a hop", log.t[kept], {name: each[kept] for name, each in values.items()})


@pytest.fixture(scope="module")
def problem(bare, hop):
    joints = find_measured(bare.robot, hop)
    arcs, _ = find_arcs(bare, joints, hop, 0.012, beside=("boom_z",))
    own = ("torque_scale", "crank_armature")
    return Residuals(bare, make_played(bare), joints, tuple(arcs), (*own, *SENSORS), own, SENSORS, ("boom_z",))


def test_the_jacobian_is_that_of_differences(problem):
    """Along a direction of all unknowns: numbers of the leg, sensors, and where arcs set out."""
    x = problem.first()
    step = 1e-5 * np.random.default_rng(0).standard_normal(len(x)) * np.maximum(abs(x), 0.01)
    ends = [problem.joined(x + each)[0] for each in (step, -step)]
    difference = 0.5 * (ends[0] - ends[1])
    assert problem.joined(x)[1] @ step == pytest.approx(difference, abs=1e-4 * abs(difference).max())


@pytest.mark.parametrize(("name", "value"), [("torque_scale", 1e12), ("crank_armature", -1.0)])
def test_what_cannot_be_integrated_has_large_residuals_without_slope(problem, name, value):
    """A search that steps there goes back."""
    x = problem.first()
    residual, jacobian = problem.joined(x)
    x[problem.over.index(name)] = value
    lost, flat = problem.joined(x)
    assert lost.shape == residual.shape and flat.shape == jacobian.shape
    assert np.isfinite(lost).all() and np.isfinite(flat).all()
    assert lost @ lost > 1e6 * (residual @ residual) and not flat.any()


def test_a_part_is_a_quarter_of_all_stances_or_of_all_flights(problem):
    parts = problem.parts
    assert len(parts) == len(problem.joined(problem.first())[0])
    assert np.unique(parts).tolist() == [*range(4), *range(4, 8)]
    stance, flight = (np.isfinite(arc.seen).sum() for arc in problem.arcs)
    counts = np.array([(parts == part).sum() for part in range(8)])
    assert abs(counts[:4] - stance / 4).max() <= 2 and abs(counts[4:] - flight / 4).max() <= 2


def test_what_is_beside_is_weighted_by_its_own_noise(problem):
    x = problem.first()
    after = problem.balanced(x)
    for found in (after, after.balanced(x)):
        residual = found.weights * np.vstack([each for _, each, _ in found.shots(x)])
        assert np.diff(np.sqrt(np.nanmean(residual**2, axis=0))) == pytest.approx(0.0, abs=1e-9)


def test_arcs_begin_after_the_bounce_and_flights_with_the_rate_of_a_fall(bare, plain_log):
    log, run = plain_log
    joints = find_measured(bare.robot, log)
    for settle in (0.012, 0.03):
        for arc in find_arcs(bare, joints, log, settle)[0]:
            after = settle if arc.phase.name == "stance" else 0.002
            assert 0.0 <= arc.t[0] - arc.phase.begin - after < 1.1e-3
            assert arc.base is None or arc.base == pytest.approx([np.interp(arc.t[0], run.t, run.v[:, 0])], abs=0.05)


def test_a_position_that_is_missing_leaves_the_height_alone(bare, hop):
    joints = find_measured(bare.robot, hop)
    holed = replace(hop, values={**hop.values, "crank": np.where(hop.t == hop.t[60], np.nan, hop["crank"])})
    arcs = [find_arcs(bare, joints, each, 0.012, beside=("boom_z",))[0][0] for each in (hop, holed)]
    assert [len(arc.t) for arc in arcs] == [len(arcs[0].t), len(arcs[0].t) - 1]
    assert not np.isnan(arcs[1].positions).any() and np.isnan(arcs[1].beside).any()


def test_a_spring_is_latched_where_the_joint_is_and_not_where_its_sensor_shows_it():
    """A sensor that is turned, with its zero known, makes no difference: SPEAR-II in stance."""
    system = hopping(load("spear_ii", locked=["boom_x"]))
    run = simulate(system, system.guess(), 1, samples=200, progress=False)
    plain = two_joints(run)
    turned = replace(plain, values={**plain.values, "knee": plain["knee"] + 0.02})
    joints, found = find_measured(system.robot, plain), []
    for log, zero in ((plain, 0.0), (turned, 0.02)):
        arcs = [arc for arc in find_arcs(system, joints, log, 0.012)[0] if arc.phase.name == "stance"]
        sensors = {"hip_zero": 0.0, "knee_zero": zero, "lag": 0.0}
        found.append(
            Residuals(system, make_played(system), joints, tuple(arcs), ("stiffness",), ("stiffness",), sensors)
        )
    x = found[0].first()
    plain_ones, turned_ones = (each.joined(x)[0] for each in found)
    assert turned_ones == pytest.approx(plain_ones, abs=1e-9)
