"""Recovery from pushes in mid-flight, and a basin of attraction on a small grid."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.periodic import displacement
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.studies.basin import airborne, basin, midway, push_moment, recover


@pytest.fixture(scope="module")
def gait() -> Gait:
    return Gait.load("long_stride")


class TestMoments:
    @pytest.mark.slow
    def test_goes_on_to_where_the_gait_goes(self, gait: Gait) -> None:
        assert airborne(gait) == ("flight_1", "flight_2")
        for phase in airborne(gait):
            moment = midway(gait, phase)
            assert moment.phase == phase
            assert moment.t == pytest.approx(0.5 * gait.durations[phase], abs=1e-6)
            ahead = run(gait.system, moment, 1, Options(rtol=1e-9))
            assert ahead.reason == "complete"
            crossing = ahead.event(gait.system.section)
            assert np.abs(displacement(gait.system, gait.state, (crossing.q, crossing.v))).max() < 1e-6

    @pytest.mark.slow
    def test_fraction_of_the_phase(self, gait: Gait) -> None:
        moments = [midway(gait, "flight_1", fraction) for fraction in (0.2, 0.8)]
        assert [moment.t / gait.durations["flight_1"] for moment in moments] == pytest.approx([0.2, 0.8], abs=1e-5)
        for fraction in (0.0, 1.0, -0.5):
            with pytest.raises(BadValue, match="fraction"):
                midway(gait, "flight_1", fraction)
        with pytest.raises(UnknownName, match="flight_3"):
            midway(gait, "flight_3")

    def test_a_push_is_added(self, gait: Gait) -> None:
        moment = midway(gait, "flight_1")
        harder = push_moment(gait, moment, q={"pitch": 0.02}, v={"torso_x": 0.3, "torso_z": -0.1})
        assert np.flatnonzero(harder.q - moment.q).tolist() == [gait.system.robot.index("pitch")]
        assert harder.v - moment.v == pytest.approx([0.3, -0.1, *np.zeros(len(moment.v) - 2)])
        assert (harder.phase, harder.held, harder.t) == (moment.phase, moment.held, moment.t)
        with pytest.raises(UnknownName, match="roll"):
            push_moment(gait, moment, v={"roll": 1.0})


class TestRecovery:
    @pytest.mark.parametrize(
        ("q", "v"),
        [
            pytest.param({}, {"torso_x": 0.3}, marks=pytest.mark.slow),
            pytest.param({"pitch": -0.0349}, {}, marks=pytest.mark.slow),
            pytest.param({}, {"torso_z": -0.15}, marks=pytest.mark.slow),
        ],
        ids=str,
    )
    def test_regulated_it_comes_back(self, stabilised: Gait, q: dict[str, float], v: dict[str, float]) -> None:
        found = recover(stabilised, push_moment(stabilised, midway(stabilised, "flight_1"), q, v), 10, 1e-7)
        assert found.recovered and found.strides is not None and found.strides <= 8
        assert found.reason == "complete" and len(found.errors) == 11
        assert (found.errors[found.strides :] <= 0.01 * found.errors[0]).all()
        assert found.errors[found.strides - 1] > 0.01 * found.errors[0] > 1e-3

    @pytest.mark.slow
    def test_without_feedback_it_does_not(self, gait: Gait) -> None:
        found = recover(gait, push_moment(gait, midway(gait, "flight_1"), v={"torso_x": 0.02}), 4, 1e-7)
        assert not found.recovered
        assert found.errors[-1] > 0.5 * found.errors[0] > 0.0

    @pytest.mark.slow
    def test_a_hard_push_goes_through_other_domains_and_is_lost(self, stabilised: Gait) -> None:
        found = recover(
            stabilised, push_moment(stabilised, midway(stabilised, "flight_1"), v={"torso_z": -1.2}), 4, 1e-7
        )
        assert not found.recovered
        assert any("double" in name for name in found.domains) and any("slip" in name for name in found.domains)
        assert found.reason != "complete" and found.message

    def test_no_push_at_all_is_recovered_at_once(self, stabilised: Gait) -> None:
        found = recover(stabilised, midway(stabilised, "flight_1"), 1)
        assert found.strides == 0 and found.domains == ()


@pytest.mark.slow
class TestBasin:
    def test_a_small_one(self, stabilised: Gait) -> None:
        axes = {"torso_x": (-0.05, 0.0, 6.0), "pitch": (-0.1, 0.0, 0.1)}
        seen: list[int] = []
        strides = basin(stabilised, "flight_1", axes, 8, on_point=seen.append)
        assert strides.shape == (3, 3) and seen == list(range(1, 10))
        assert strides[1, 1] == 0
        inner = np.delete(strides[:2].ravel(), 4)
        assert ((inner >= 1) & (inner <= 8)).all()
        assert np.isnan(strides[2]).all()
        one = recover(
            stabilised, push_moment(stabilised, midway(stabilised, "flight_1"), v={"torso_x": -0.05}), 8, 1e-7
        )
        assert strides[0, 1] == one.strides

    def test_needs_two_axes(self, gait: Gait) -> None:
        with pytest.raises(BadValue, match="axes"):
            basin(gait, "flight_1", {"torso_x": (0.0,)})
