"""Bounds of made quadrupeds: knees of either side, thigh and shank of unequal lengths, joints with friction."""

import warnings

import numpy as np
import pytest

from spear_pin import Spring, load, sagittal, simulate, simulate_many
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.bounding_law import PAIR, legs_of
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import SPARE, Request
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.model.scale import scale_of
from spear_pin.studies.audit.zero_dynamics import largest_output
from spear_pin.studies.bound import summarize
from spear_pin.studies.joint_limits import excesses
from tests.hybrid.lanes import assert_agree
from tests.model.legged import quadruped

MADE = {
    "knees to each other": {"ahead": 0.04},
    "knees backward": {"knee_limits": (-2.5, 0.1)},
    "knees that stay bent": {"knee_limits": (-2.5, -0.9), "ahead": 0.03},
}


def made(folder, **of_leg):
    path = folder / "made.urdf"
    path.write_text(quadruped(**of_leg))
    return sagittal(load(path))


@pytest.fixture(scope="module", params=MADE.values(), ids=MADE)
def found(request, tmp_path_factory):
    robot = made(tmp_path_factory.mktemp("made"), **request.param)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return robot, *search(robot, Request.scaled(robot))


@pytest.mark.slow
@pytest.mark.extra("casadi")
@pytest.mark.extra("heyoka")
class TestSearch:
    def test_a_fixed_point_that_keeps_its_energy(self, found):
        robot, gait, _ = found
        motion = simulate(gait.system, gait.state, 2, progress=False)
        assert gait.residual < 1e-9 and motion.reason == "complete"
        energy = robot.mass * 9.81 * sum(leg.thigh + leg.shank for leg in robot.legs) / 2
        assert np.abs(motion.ledger.residual).max() < 1e-8 * energy
        assert [str(each) for each in excesses(robot, motion)] == []

    def test_what_the_optimiser_reckoned_with_is_what_is_simulated(self, found):
        """Also where joints have friction, and legs lean as their knees bend."""
        robot, gait, solution = found
        scale = scale_of(robot)
        effort = summarize(gait, simulate(gait.system, gait.state, progress=False))["effort_per_distance"] * PAIR
        unit = scale.torque**2 * scale.time / scale.length
        assert solution.objective == pytest.approx(0.01 * effort / unit, rel=2e-3)

    def test_outputs_stay_at_zero(self, found):
        robot, gait, _ = found
        stride = run(gait.system, gait.state, 1, Options(keep=True))
        assert largest_output(robot, stride) < 1e-6

    def test_lanes(self, found):
        _, gait, _ = found
        q, v = (np.tile(part, (3, 1)) for part in gait.state)
        v[:, 0] += [0.0, 1e-3, -1e-3]
        assert_agree(gait.system, q, v, simulate_many(gait.system, q, v))


class TestScaled:
    def test_q_spear_asks_for_its_own_numbers(self):
        own, scaled = Request(), Request.scaled(load("q_spear"))
        differing = {name for name, value in vars(own).items() if getattr(scaled, name) != value}
        assert differing == {"friction", "within_limits"}

    def test_by_size(self, tmp_path):
        robot = made(tmp_path)
        scale, own, scaled = scale_of(robot), Request(), Request.scaled(robot)
        assert scaled.speed == pytest.approx(own.speed * np.sqrt(scale.length))
        assert scaled.minimum_force == pytest.approx(own.minimum_force * scale.mass)
        assert scaled.stiffness == Spring.scaled(robot).stiffness
        assert scaled.stiffness == pytest.approx(own.stiffness * scale.mass * scale.length)
        assert scaled.minimum_stance == pytest.approx(own.minimum_stance * np.sqrt(scale.length))

    def test_knees_that_stay_bent_land_bent(self, tmp_path):
        scaled = Request.scaled(made(tmp_path, knee_limits=(-2.5, -0.9)))
        assert scaled.knee_touchdown == scaled.knee_rest == pytest.approx(0.9 + SPARE)

    def test_wishes(self):
        assert Request.scaled(load("q_spear"), speed=1.5, objective="hip").speed == 1.5
        with pytest.raises(UnknownName, match="sped"):
            Request.scaled(load("q_spear"), sped=1.0)
        with pytest.raises(BadValue, match="speed"):
            Request.scaled(load("q_spear"), speed=-1.0)

    def test_a_knee_of_unknown_side(self, tmp_path):
        robot = made(tmp_path, knee_limits=(-2.5, 2.5))
        with pytest.raises(BadValue, match="where its knee flexes"):
            legs_of(robot)
