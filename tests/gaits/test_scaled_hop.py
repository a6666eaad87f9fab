"""The hop's numbers for robots of other sizes."""

from dataclasses import asdict

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load, monopod
from spear_pin.errors import BadValue
from spear_pin.model.scale import scale_of
from tests.gaits.similar import similar
from tests.model.legged import quadruped
from tests.model.queries import refusal

LONGER, HEAVIER = 0.4, 0.1
TORQUE, TIME = LONGER * HEAVIER, LONGER**0.5


def scaled_hop(robot):
    """The hop of a leg with SPEAR-II's numbers, a little longer in the air, and the leg's scale."""
    leg = monopod(robot, "FL", locked=["boom_x"])
    scale, system = scale_of(leg), hopping(leg, HoppingLaw.scaled(leg, damping_ratio=0.6), Spring.scaled(leg))
    return find_gait(system, ["stance_torque"], {"flight_time": 0.22 * scale.time}), scale


def plain(gait, scale):
    """Torque, durations, state and multipliers without units."""
    q, v = gait.state
    lengths = np.array([scale.length, 1.0, 1.0])
    times = np.array(list(gait.durations.values())) / scale.time
    torque = gait.parameters["stance_torque"] / scale.torque
    return torque, times, q / lengths, v / lengths * scale.time, np.sort(np.abs(gait.multipliers))


@pytest.fixture(scope="module")
def four(tmp_path_factory):
    """A quadruped, its toes before its shanks."""
    path = tmp_path_factory.mktemp("four") / "made.urdf"
    path.write_text(quadruped(ahead=0.03))
    return load(path)


@pytest.fixture(scope="module")
def own(four):
    """The hop of its leg, and the leg's scale."""
    return scaled_hop(similar(four, 1.0))


@pytest.fixture(scope="module")
def small():
    """SPEAR-II on its test-bed, all lengths shorter and all masses smaller."""
    return similar(load("spear_ii", locked=["boom_x"]), LONGER, HEAVIER)


class TestNumbers:
    @pytest.mark.parametrize("locked", [(), ("boom_x",)])
    def test_those_of_spear_ii_are_its_own(self, locked):
        robot = load("spear_ii", locked=locked)
        for own, scaled in ((HoppingLaw(), HoppingLaw.scaled(robot)), (Spring(), Spring.scaled(robot))):
            expected = asdict(own) | ({"hip_touchdown": 0.5} if isinstance(own, HoppingLaw) else {})
            numbers = {name: value for name, value in expected.items() if isinstance(value, float)}
            assert asdict(scaled) == expected | {name: pytest.approx(numbers[name], rel=1e-14) for name in numbers}

    def test_of_a_similar_robot(self, small):
        law, spring, own = HoppingLaw.scaled(small), Spring.scaled(small), HoppingLaw()
        assert spring.stiffness == pytest.approx(TORQUE * 48.84)
        assert spring.damping == pytest.approx(TORQUE * TIME * 1.3)
        assert law.stance_torque == pytest.approx(TORQUE * own.stance_torque)
        assert law.frequency == pytest.approx(own.frequency / TIME)
        for joint in ("hip", "knee"):
            assert getattr(law, f"{joint}_gain") == pytest.approx(TORQUE * getattr(own, f"{joint}_gain"))
            assert getattr(law, f"{joint}_damping") == pytest.approx(TORQUE * TIME * getattr(own, f"{joint}_damping"))

    def test_damping_ratio(self, small):
        law = HoppingLaw.scaled(small, damping_ratio=0.6)
        inertia = np.diag(small.mass_matrix([0.0, 0.5, 1.0]))[1:]
        gains, dampings = np.array([law.hip_gain, law.knee_gain]), np.array([law.hip_damping, law.knee_damping])
        np.testing.assert_allclose(dampings / (2 * np.sqrt(gains * inertia)), 0.6, rtol=1e-12)
        assert gains == pytest.approx([HoppingLaw.scaled(small).hip_gain, HoppingLaw.scaled(small).knee_gain])

    def test_toe_lands_below_the_hip(self, four):
        leg = monopod(four, "HR")
        law = HoppingLaw.scaled(leg)
        toe = leg.toe_position([0.0, 0.0, law.hip_touchdown, law.knee_touchdown], "toe")
        assert toe[0] == pytest.approx(0.0, abs=1e-15) and law.hip_touchdown != pytest.approx(0.5, abs=1e-3)


class TestHop:
    @pytest.mark.slow
    def test_of_a_similar_robot_is_similar(self, small, hop):
        """To SPEAR-II's, of whose numbers the scaled ones are its own."""
        system = hopping(small, HoppingLaw.scaled(small), Spring.scaled(small))
        scaled = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2 * TIME})
        assert scaled.parameters["stance_torque"] == pytest.approx(TORQUE * hop.parameters["stance_torque"], rel=1e-6)
        assert scaled.durations["stance"] == pytest.approx(TIME * hop.durations["stance"], rel=1e-6)
        np.testing.assert_allclose(np.abs(scaled.multipliers), np.abs(hop.multipliers), atol=1e-5)

    @pytest.mark.slow
    @pytest.mark.parametrize("longer", [0.3, 3.0])
    def test_of_a_quadrupeds_leg_of_another_size(self, four, own, longer):
        """Cut out of a robot of the same materials, the hop is the same but for its units."""
        hops, scales = zip(own, scaled_hop(similar(four, longer)), strict=True)
        assert scales[1].length / scales[0].length == pytest.approx(longer, rel=1e-12)
        for figure, other in zip(*map(plain, hops, scales), strict=True):
            np.testing.assert_allclose(other, figure, rtol=0, atol=1e-6)

    @pytest.mark.slow
    def test_of_a_quadrupeds_leg(self, four):
        leg = monopod(four, "FL", locked=["boom_x"])
        system = hopping(leg, HoppingLaw.scaled(leg, damping_ratio=0.6), Spring.scaled(leg))
        gait = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.175})
        assert gait.stable and gait.residual < 1e-9
        assert gait.durations["flight"] == pytest.approx(0.175, abs=1e-9)
        assert 0.0 < gait.parameters["stance_torque"] < leg.model.upperEffortLimit[leg.index("knee")]


class TestRefused:
    @pytest.mark.parametrize("name", ["q_spear", "q_spear_full", "biped", "spear_ii_series"])
    def test_other_robots(self, name):
        refusal(BadValue, lambda: HoppingLaw.scaled(load(name)))

    def test_springs_of_a_robot_in_space(self):
        refusal(BadValue, lambda: Spring.scaled(load("q_spear_full")))

    @pytest.mark.parametrize("ratio", [-0.1, np.nan, np.inf, "0.6", True])
    def test_damping_ratio(self, ratio):
        refusal(BadValue, lambda: HoppingLaw.scaled(load("spear_ii"), damping_ratio=ratio))

    def test_no_robot(self):
        refusal(BadValue, lambda: HoppingLaw.scaled("spear_ii"))
        refusal(BadValue, lambda: Spring.scaled(None))
