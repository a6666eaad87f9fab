"""Feet that roll: kinematics, a hop and a rimless wheel's impact against numbers of another program, and refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, Ground, HoppingLaw, find_gait, hopping, monopod, simulate, vary
from spear_pin.errors import BadFile, BadValue
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.parameters import change_system, with_numbers, with_parameters
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues
from spear_pin.hybrid.rules.impact import plastic_impact
from spear_pin.model.numbers import Number, body_numbers
from tests.hybrid.test_symbolic import HOP, compare
from tests.model.round_feet import SPREAD, round_spear, spokes

FOOT = "[feet.toe]\nradius = 0.02\n"
STEP = 1e-6


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    return round_spear(tmp_path_factory.mktemp("round"), FOOT)


class TestKinematics:
    Q, V = np.array([0.6, 0.5, 1.1]), np.array([0.3, -1.0, 2.0])

    def test_touches_below_its_centre(self, leg, tmp_path):
        point = round_spear(tmp_path, "")
        np.testing.assert_allclose(
            leg.toe_position(self.Q, "toe"), point.toe_position(self.Q, "toe") - [0.0, 0.02], atol=1e-15
        )

    def test_normal_row_is_the_slope_of_the_height(self, leg):
        steps = STEP * np.eye(3)
        slopes = [
            (leg.toe_position(self.Q + step, "toe")[1] - leg.toe_position(self.Q - step, "toe")[1]) / (2 * STEP)
            for step in steps
        ]
        np.testing.assert_allclose(leg.toe_jacobian(self.Q, "toe")[1], slopes, atol=1e-9)

    def test_a_foot_that_rolls_goes_as_far_as_its_arc_turns(self, leg):
        """Where nothing slides, the centre moves by the radius times the foot's turn."""
        row = leg.toe_jacobian(self.Q, "toe")[0]
        centre = (leg.toe_position(self.Q + STEP * self.V, "toe") - leg.toe_position(self.Q - STEP * self.V, "toe"))[0]
        turning = -self.V[1] + self.V[2]  # about +y: the hip turns about -y, the knee about +y
        assert row @ self.V == pytest.approx(centre / (2 * STEP) - 0.02 * turning, abs=1e-9)

    def test_drift_is_the_slope_of_the_jacobian(self, leg):
        ahead, behind = (leg.toe_jacobian(self.Q + s * STEP * self.V, "toe") for s in (1, -1))
        expected = (ahead - behind) @ self.V / (2 * STEP)
        np.testing.assert_allclose(leg.toe_drift(self.Q, self.V, "toe"), expected, atol=1e-8)


def test_both_engines_accelerate_alike(leg):
    system, rng = hopping(leg, HoppingLaw(minimum_force=10.0)), np.random.default_rng(1)
    for domain in system.domains:
        for _ in range(4):
            compare(system, domain, HOP, rng.uniform(0.2, 1.0, 3), rng.uniform(-1, 1, 3))


@pytest.fixture(scope="module")
def gait(leg):
    system = hopping(leg, HoppingLaw(stance_torque=7.84, hold_extension=True))
    return find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2})


class TestHop:
    def test_is_that_of_another_program(self, gait):
        q, v = gait.state
        assert gait.parameters["stance_torque"] == pytest.approx(7.843819, abs=1e-6)
        assert (q[1], q[2], v[2]) == pytest.approx((0.5077934, 0.9626915, 5.4401435), abs=1e-7)
        assert gait.durations["stance"] == pytest.approx(0.365438, abs=5e-7)
        run = simulate(gait.system, gait.state, cycles=1)
        assert run.ledger["impact"][0] == pytest.approx(-0.581257, abs=5e-7)
        np.testing.assert_allclose(run.named("touchdown")[-1].impulse[0], (0.233164, 1.497590), atol=1e-6)
        assert np.abs(run.ledger.residual).max() < 1e-8
        expected = np.array([-0.404790, 0.177651 - 0.157538j, 0.177651 + 0.157538j])
        np.testing.assert_allclose(np.sort_complex(gait.multipliers), np.sort_complex(expected), atol=1e-6)

    @pytest.mark.extra("heyoka")
    def test_lanes_and_derivatives_are_those_of_the_reference_engine(self, gait):
        lanes = simulate_many(gait.system, *(part[None] for part in gait.state), cycles=2)
        last = simulate(gait.system, gait.state, cycles=2).named("touchdown")[-1]
        np.testing.assert_allclose(lanes.q[0], last.q, atol=1e-9)
        own = with_parameters(gait.system, gait.parameters)
        found = eigenvalues(differentiate_return_map(own, gait.state))
        np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(gait.multipliers), atol=1e-6)


def test_a_guard_of_ones_own_sees_where_it_touches(gait):
    """Whose value is enclosed along each step, as such a guard may vary quickly."""
    low = Guard("low", lambda t, q, v, held, p, dyn, ops: dyn.height("toe") - 0.03)

    def watched(system):
        domains = (replace(each, guards=(*each.guards, low)) for each in system.domains)
        return replace(system, domains=tuple(domains))

    event = simulate(change_system(gait.system, watched), gait.state, cycles=1).named("low")[-1]
    assert gait.system.robot.toe_position(event.q, "toe")[1] == pytest.approx(0.03, abs=1e-10)


class TestRadius:
    def test_is_a_number_of_the_robot(self, leg):
        larger = vary(leg, toe_radius=0.03)
        assert larger.radii == {"toe": 0.03} and leg.radii == {"toe": 0.02}
        assert body_numbers(larger)["toe_radius"] == Number(0.03, "m")
        assert vary(larger, toe_radius=0.02, knee_mass=2.0).radii == leg.radii
        q = np.array([0.6, 0.5, 1.1])
        lower = [0.0, 0.01]
        np.testing.assert_allclose(larger.toe_position(q, "toe"), leg.toe_position(q, "toe") - lower, atol=1e-15)

    def test_a_gait_is_saved_with_it(self, gait, tmp_path):
        system = with_numbers(gait.system, {"toe_radius": 0.021})
        find_gait(system, guess=gait.state).save(tmp_path / "larger.json")
        assert Gait.load(tmp_path / "larger.json").system.robot.radii == {"toe": 0.021}

    @pytest.mark.slow
    @pytest.mark.parametrize("ends", ["", "from = -0.6\nto = 0.2\n"])
    def test_derivatives_are_those_of_gaits_found_again(self, tmp_path, ends):
        leg = round_spear(tmp_path, FOOT + ends)
        system = hopping(leg, HoppingLaw(stance_torque=7.84, hold_extension=True))
        gait, h = find_gait(system), 2e-5
        found = gait.sensitivity(["toe_radius"]).derivatives
        more, less = (
            find_gait(with_numbers(gait.system, {"toe_radius": 0.02 + s * h}), guess=gait.state) for s in (1, -1)
        )
        assert found["period"][0] == pytest.approx((more.period - less.period) / (2 * h), abs=1e-6)
        touchdown = (more.state[0] - less.state[0])[1:] / (2 * h)
        np.testing.assert_allclose(
            [found[f"{joint}_at_touchdown"][0] for joint in ("hip", "knee")], touchdown, atol=1e-6
        )
        slower = (abs(more.multipliers[0]) - abs(less.multipliers[0])) / (2 * h)
        assert found["multiplier_1"][0] == pytest.approx(slower, abs=1e-4)


@pytest.mark.parametrize(
    ("radius", "kept", "before", "loss"),
    [(0.0, 0.733733437, 1.537275936, 0.600019), (0.3, 0.865623852, 2.125353690, 0.604731)],
)
def test_a_rimless_wheel_keeps_as_much_of_its_rate_as_in_closed_form(tmp_path, radius, kept, before, loss):
    """It rolls over its back foot until the front foot lands, which alone bears it from then on."""
    wheel = spokes(tmp_path, radius)
    q = np.array([0.0, (1.0 - radius) * math.cos(SPREAD) + radius, 0.0])
    assert wheel.toe_position(q, "front")[1] == pytest.approx(0.0, abs=1e-15)
    back, front = (wheel.toe_jacobian(q, foot) for foot in ("back", "front"))
    v = np.array([0.0, 0.0, -before])  # forward
    v[:2] = np.linalg.solve(back[:, :2], -back[:, 2] * v[2])
    impact = plastic_impact(wheel.mass_matrix(q), front, v, 50.0)
    assert impact.v[2] / v[2] == pytest.approx(kept, abs=1e-9)
    assert impact.loss == pytest.approx(loss, abs=5e-7)
    assert (back @ impact.v)[1] > 0.0


class TestRefused:
    @pytest.mark.parametrize(
        ("feet", "said"),
        [
            ("[feet.toe]\nradius = 0.0\n", "a number > 0, in m"),
            ("[feet.toe]\nradius = -0.02\n", "a number > 0, in m"),
            ("[feet.toe]\n", "a number > 0, in m"),
            ("[feet.heel]\nradius = 0.02\n", "unknown toe 'heel'"),
            ("[feet.toe]\nsize = 0.02\n", "unknown key"),
        ],
    )
    def test_a_wrong_file(self, tmp_path, feet, said):
        with pytest.raises(BadFile) as caught:
            round_spear(tmp_path, feet)
        assert said in str(caught.value) and "\n" not in str(caught.value)

    def test_a_slope(self, leg):
        with pytest.raises(BadValue, match="slope=0 and no shape of its own, as the robot has round feet"):
            hopping(leg, ground=Ground(slope=0.1))


def test_a_leg_that_is_cut_out_keeps_its_round_foot(leg):
    cut = monopod(leg, leg.legs[0], locked=["boom_x"])
    assert cut.radii == {"toe": 0.02}
    q = [0.6, 0.5, 1.1]
    np.testing.assert_allclose(cut.toe_jacobian(q, "toe"), leg.toe_jacobian(q, "toe"), atol=1e-12)
