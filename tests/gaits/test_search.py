"""Gait search: several unknowns and targets, requests that make no sense, requests that cannot be met."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import HoppingLaw, find_gait, hopping, simulate
from spear_pin.errors import BadValue, NoGait, SpearError, UnknownName
from spear_pin.gaits.attempts import search_gait
from spear_pin.hybrid.periodic import residual, return_map
from spear_pin.hybrid.run import run


def apex_height(run):
    return run.event("apex").q[-3]


def assert_periodic(gait):
    assert gait.residual <= 1e-9
    assert residual(gait.system, gait.state) <= 1e-9
    assert np.isfinite(gait.multipliers).all()


class TestFinds:
    @pytest.mark.parametrize(
        ("vary", "target"),
        [
            ([], {}),
            pytest.param(
                ["stance_torque", "knee_touchdown"],
                {"flight_time": 0.19, "apex_height": 0.615},
                marks=pytest.mark.slow,
            ),
            pytest.param(["stiffness"], {"stance_time": 0.36}, marks=pytest.mark.slow),
            pytest.param(["frequency"], {"stance_time": 0.36}, marks=pytest.mark.slow),
            pytest.param(
                ["stance_torque", "stiffness"], {"flight_time": 0.195, "stance_time": 0.36}, marks=pytest.mark.slow
            ),
        ],
        ids=str,
    )
    def test_what_is_asked_for(self, hop, vary, target):
        gait = find_gait(hop.system, vary, target)
        assert_periodic(gait)
        assert list(gait.parameters) == vary
        trajectory = simulate(gait.system, gait.state)
        touchdown, lift_off = trajectory.named("touchdown")[0], trajectory.named("lift_off")[0]
        found = {
            "flight_time": touchdown.time - lift_off.time,
            "stance_time": lift_off.time,
            "period": touchdown.time,
            "apex_height": trajectory.named("apex")[0].q[0],
            "knee_at_touchdown": touchdown.q[2],
        }
        for name, wanted in target.items():
            assert found[name] == pytest.approx(wanted, abs=1e-7)
        for name, value in gait.parameters.items():
            owner = next(part for part in ("law", "spring", "contact") if hasattr(getattr(gait.system, part), name))
            assert getattr(getattr(gait.system, owner), name) == value

    @pytest.mark.slow
    def test_a_measure_of_ones_own(self, robot):
        gait = find_gait(hopping(robot), ["stance_torque"], {apex_height: 0.61})
        assert_periodic(gait)
        assert simulate(gait.system, gait.state).named("apex")[0].q[0] == pytest.approx(0.61, abs=1e-8)

    @pytest.mark.slow
    def test_the_same_from_a_guess_of_ones_own(self, hop):
        q, v = hop.state
        gait = find_gait(hop.system, guess=(q + [0.0, 0.01, 0.02], v + [0.0, 0.05, 0.1]))
        np.testing.assert_allclose(gait.state[0], q, rtol=0, atol=1e-8)
        np.testing.assert_allclose(gait.state[1], v, rtol=0, atol=1e-7)

    def test_what_it_returns_stays_periodic(self, hop):
        trajectory = simulate(hop.system, hop.state, cycles=3, rtol=1e-11)
        np.testing.assert_allclose(trajectory.events[-1].v, hop.state[1], rtol=0, atol=1e-7)
        assert hop.durations["stance"] == pytest.approx(trajectory.named("lift_off")[0].time, abs=1e-8)

    @pytest.mark.slow
    def test_begins_where_the_guess_does(self, free_robot):
        """However far the settling run went along the ground."""
        law = HoppingLaw(hip_touchdown=0.5, foot_placement=0.14, speed=0.05)
        assert find_gait(hopping(free_robot, law)).state[0][0] == pytest.approx(0.0, abs=1e-12)

    def test_tells_of_its_iterations(self, hop):
        told = []
        find_gait(hop.system, guess=hop.state, on_iteration=lambda n, norm: told.append(norm))
        assert told and told[-1] <= 1e-9

    @pytest.mark.slow
    def test_leaves_the_system_alone(self, robot):
        system = hopping(robot)
        find_gait(system, ["stance_torque"], {"flight_time": 0.2})
        assert system.law == HoppingLaw()


class TestRefuses:
    def test_an_unknown_parameter(self, robot):
        with pytest.raises(UnknownName, match="unknown parameter 'colour'; nearest of .*: "):
            find_gait(hopping(robot), ["colour"], {"flight_time": 0.2})

    def test_an_unknown_target(self, robot):
        with pytest.raises(UnknownName, match="unknown target 'beauty'; nearest of .*: "):
            find_gait(hopping(robot), ["stance_torque"], {"beauty": 1.0})

    @pytest.mark.parametrize(
        ("vary", "target"),
        [
            (["stance_torque"], {}),
            ([], {"flight_time": 0.2}),
            (["stance_torque", "stiffness"], {"flight_time": 0.2}),
            (["stance_torque"], {"flight_time": 0.2, "apex_height": 0.6}),
        ],
        ids=str,
    )
    def test_counts_that_do_not_match(self, robot, vary, target):
        with pytest.raises(BadValue, match="^target is .*; expected as many targets as parameters to vary"):
            find_gait(hopping(robot), vary, target)

    @pytest.mark.parametrize("value", [math.nan, math.inf])
    def test_a_target_that_is_no_number(self, robot, value):
        with pytest.raises(BadValue, match="target flight_time"):
            find_gait(hopping(robot), ["stance_torque"], {"flight_time": value})

    @pytest.mark.parametrize("seconds", [-0.1, 0.0, 0.03, 5.1])
    def test_a_flight_that_closes_no_cycle(self, robot, monkeypatch, seconds):
        monkeypatch.setattr("spear_pin.gaits.attempts.run", lambda *_: pytest.fail("something was simulated"))
        expected = rf"^target flight_time is {seconds}; expected a number from 0\.05 to 5, in s"
        with pytest.raises(BadValue, match=expected):
            find_gait(hopping(robot), ["stance_torque"], {"flight_time": seconds})
        with pytest.raises(BadValue, match="expected a number from 0.1 to 3, in s"):
            system = replace(hopping(robot), shortest_flight=0.1, phase_limit=3.0)
            find_gait(system, ["stance_torque"], {"flight_time": seconds})

    def test_a_parameter_without_a_value(self, robot):
        with pytest.raises(BadValue, match="hip_touchdown"):
            find_gait(hopping(robot), ["hip_touchdown"], {"flight_time": 0.2})

    @pytest.mark.parametrize("guess", [([0.5, 0.5], [0, 0, 0]), ([math.nan, 0.5, 1.0], [0, 0, 0]), (1, 2)], ids=str)
    def test_a_guess_that_is_no_state(self, robot, guess):
        with pytest.raises(BadValue):
            find_gait(hopping(robot), guess=guess)


class TestNoGait:
    @staticmethod
    def assert_one_line(error, *parts):
        text = str(error.value)
        assert text.startswith("no gait found: ") and "\n" not in text
        assert all(part in text for part in parts)

    def test_a_leg_that_does_not_push(self, robot):
        with pytest.raises(NoGait) as error:
            find_gait(hopping(robot, HoppingLaw(stance_torque=0.0)))
        self.assert_one_line(error, "does not close", "residual")

    @pytest.mark.slow
    def test_is_given_up_soon(self, robot, monkeypatch):
        """No leg of this size flies for five seconds; to tell takes no more than some hundred hops."""
        evaluations = []

        def counted(*arguments):
            result = return_map(*arguments)
            evaluations.append(result.evaluations)
            return result

        monkeypatch.setattr("spear_pin.gaits.attempts.return_map", counted)
        with pytest.raises(NoGait):
            find_gait(hopping(robot), ["stance_torque"], {"flight_time": 5.0})
        assert sum(evaluations) < 250_000

    def test_of_a_fixed_point_from_which_the_leg_falls(self, robot, monkeypatch):
        """As the reference engine finds, where Newton's method found one in lanes."""
        system = hopping(robot)
        fallen = return_map(hopping(robot, HoppingLaw(stance_torque=0.0)), system.guess())
        assert not fallen.cycles
        monkeypatch.setattr("spear_pin.gaits.attempts.return_map", lambda *_: fallen)
        monkeypatch.setattr("spear_pin.gaits.attempts.Search.roughly", lambda search, *start: start[:2])
        search = search_gait(system, ("stance_torque",), {"flight_time": 0.2}, 1e-9)
        with pytest.raises(NoGait) as error:
            search.by_continuation(system, system.guess())
        self.assert_one_line(error, "the cycle of the system as it is ends early", fallen.message)

    @pytest.mark.slow
    def test_cycles_that_take_for_ever(self, robot, monkeypatch):
        """The integrator creeps, from the system's own guess and from one that is given; some cycles tell."""
        evaluations = []

        def counted(*arguments):
            result = run(*arguments)
            evaluations.append(result.evaluations)
            return result

        monkeypatch.setattr("spear_pin.gaits.attempts.run", counted)
        monkeypatch.setattr("spear_pin.hybrid.periodic.run", counted)
        monkeypatch.setattr("spear_pin.hybrid.periodic.EVALUATIONS", 3000)
        system = hopping(robot, HoppingLaw(virtual_stiffness=1e300))
        for guess, most in ((None, 61_000), (system.guess(), 20_000)):
            evaluations.clear()
            with pytest.raises(NoGait) as error:
                find_gait(system, ["stance_torque"], {"flight_time": 0.2}, guess=guess)
            self.assert_one_line(error, "take more than")
            assert sum(evaluations) < most

    def test_a_law_that_remembers_what_was_before_the_section(self, hop):
        """Begun afresh the cycle closes, but the next one is another: (q, v) on the section is not its whole state."""
        *stances, flight = hop.system.domains

        def law(t, q, v, held, p, dyn, ops):
            hip, knee = stances[0].law(t, q, v, held, p, dyn, ops)
            return hip, knee - 0.1 * held["rate"]

        def remembering(guard):
            if guard.name != "lift_off":
                return guard
            return replace(guard, reset=replace(guard.reset, latch=lambda q, v, held, p: {"rate": v[0], "speed": 0.0}))

        changed = [replace(each, law=law, guards=tuple(map(remembering, each.guards))) for each in stances]
        system = replace(hop.system, domains=(*changed, flight))
        with pytest.raises(NoGait) as error:
            find_gait(system, guess=hop.state)
        self.assert_one_line(error, "latched before the section")

    @pytest.mark.slow
    def test_a_measure_of_an_event_that_never_happens(self, robot):
        with pytest.raises(SpearError, match="never"):
            find_gait(hopping(robot), ["stance_torque"], {lambda run: run.event("never").time: 0.2})

    @pytest.mark.slow
    def test_a_measure_that_is_no_number(self, robot):
        with pytest.raises(NoGait) as error:
            find_gait(hopping(robot), ["stance_torque"], {lambda run: math.nan: 0.2})
        self.assert_one_line(error)
