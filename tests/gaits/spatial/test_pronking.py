"""A pronk: the automaton and the law of the bound with all four legs as one group."""

from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import Gait, pronking
from spear_pin.errors import BadValue
from spear_pin.hybrid.periodic import chart, displacement, residual, return_map
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import asymmetry, mirror_of
from tests.solve.gaits import pronk_steady


@cache
def pronk():
    return Gait.load("pronk")


@cache
def stride():
    return return_map(pronk().system, pronk().state, 1e-11)


class TestOrbit:
    @pytest.mark.slow
    def test_residual_and_speed(self):
        assert residual(pronk().system, pronk().state) <= 1e-9
        assert pronk().system.measures["mean_speed"](stride()) == pytest.approx(2.0, abs=1e-6)
        assert abs(stride().change[0] - stride().work[0].sum()) <= 1e-9
        assert asymmetry(pronk().system.robot, pronk().state) <= 1e-9

    def test_all_four_land_and_lift_off_together(self):
        times = {event.name: event.time for event in stride().events}
        touchdowns = [time for name, time in times.items() if name.endswith("_touchdown")]
        lift_offs = [time for name, time in times.items() if name.endswith("_lift_off")]
        assert len(touchdowns) == len(lift_offs) == 4
        assert max(touchdowns) < 0.01 < 0.08 < min(lift_offs) and max(lift_offs) - min(lift_offs) < 0.001
        assert stride().durations["all_stance"] == pytest.approx(0.083, abs=1e-3)
        assert stride().durations["flight_1"] == pytest.approx(0.204, abs=1e-3)
        assert "slip" not in times

    def test_flies_as_a_stone_does(self):
        """The centre of mass falls by g from the last lift-off to the touchdown."""
        model = pronk().system.robot.model
        data = model.createData()

        def rate(q, v):
            pin.centerOfMass(model, data, q, v)
            return data.vcom[0].copy()

        last = max((event for event in stride().events if event.name.endswith("_lift_off")), key=lambda each: each.time)
        gained = rate(*stride().state) - rate(last.q, last.v_before)
        fallen = -model.gravity.linear[2] * (stride().events[-1].time - last.time)
        np.testing.assert_allclose(gained, [0.0, 0.0, -fallen], rtol=0, atol=1e-7)

    @pytest.mark.slow
    def test_seen_in_the_mirror(self):
        """P(M x) = M P(x) beside it."""
        system, mirror = pronk().system, mirror_of(pronk().system.robot)
        state = chart(system, pronk().state).state(1e-3 * np.random.default_rng(3).normal(size=32))
        ends = [return_map(system, each, 1e-11).state for each in (state, tuple(mirror(part) for part in state))]
        other = tuple(mirror(part) for part in ends[1])
        np.testing.assert_allclose(displacement(system, ends[0], other), 0.0, rtol=0, atol=1e-7)

    def test_its_system_is_built_from_its_parts(self):
        system = pronking(pronk().system.robot, pronk().system.law, pronk().system.spring)
        assert system.kind == "pronking" and system.section == "touchdown"
        assert system.phases == pronk().system.phases and "all_stance" in system.phases
        np.testing.assert_allclose(system.guess()[0][3:], pronk().state[0][3:], rtol=0, atol=1e-12)

    @pytest.mark.slow
    def test_what_no_leg_of_it_does_has_no_effect(self):
        law = pronk().system.law
        plane = replace(law.plane, flight_2_span=1.0, posterior_stance_span=-2.0, flight_1_trailing=((1.0,) * 4,) * 2)
        other = pronking(pronk().system.robot, replace(law, plane=plane), pronk().system.spring)
        np.testing.assert_array_equal(return_map(other, pronk().state, 1e-11).state, stride().state)


def test_kept(tmp_path):
    again = Gait.load(pronk().save(tmp_path / "pronk.json"))
    assert again.system.law == pronk().system.law and again.system.kind == "pronking"


def test_refused():
    law = pronk().system.law
    with pytest.raises(BadValue, match="nominal"):
        pronking(pronk().system.robot, replace(law, nominal=())).guess()


def test_multipliers():
    assert np.abs(pronk().multipliers[0]) == pytest.approx(5.93, abs=0.02)


@pytest.mark.slow
def test_balanced():
    """By feedback once a stride; pushed to the side it goes on."""
    steady = pronk_steady()
    assert abs(steady.multipliers[0]) <= 0.6
    local = chart(steady.system, steady.state)
    q, v = (part.copy() for part in steady.state)
    v[1] += 0.2
    pushed = run(steady.system, (q, v), 15, Options(rtol=1e-9))
    assert pushed.cycles == 15
    assert abs(local.coordinates(pushed.state)).max() <= 1e-3 * abs(local.coordinates((q, v))).max()
