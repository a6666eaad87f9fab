"""Cycles in space with their derivatives: against differences of cycles, gaits found again, and samples."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import Contact, Gait, find_gait, load, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.round_hopping import RoundHoppingLaw, round_hopping
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.contact import SLIP
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.sliding import LONGEST
from spear_pin.hybrid.flow_names import flow_names
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import FINEST
from spear_pin.hybrid.tangent import record
from spear_pin.hybrid.tangent.onset import _rate, find_setting_out
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.hybrid.tangent.section import tell_feet_apart
from tests.solve import gaits  # noqa: F401  registers the recipes
from tests.solve.kept import RECIPES, jacobian

pytestmark = pytest.mark.slow


@cache
def orbit(name: str) -> Orbit:
    gait = Gait.load(RECIPES[name].path)
    return Orbit(gait.system, gait.state, ())


@pytest.mark.parametrize("name", ["trot", "trot_steady", "turn_9", "gallop"])
def test_the_jacobian_is_that_of_differences(name):
    kept = jacobian(name)
    np.testing.assert_allclose(orbit(name).jacobian, kept, rtol=0, atol=3e-6 * np.abs(kept).max())


class TestSymmetric:
    """A bound lands on two feet at once: differences depend on whether their step tells the feet apart."""

    def test_even_and_odd_do_not_mix(self):
        found, even = orbit("long_stride_in_space").jacobian, orbit("long_stride_in_space").chart.even
        assert tell_feet_apart(orbit("long_stride_in_space").system, orbit("long_stride_in_space").chart) is not None
        assert not found[np.ix_(even, ~even)].any() and not found[np.ix_(~even, even)].any()

    def test_feet_that_land_one_after_the_other(self):
        one = orbit("long_stride_in_space")
        local, h = chart(one.system, one.state), 1e-4
        kept, odd = jacobian("long_stride_in_space"), ~local.even
        far = np.abs(one.jacobian - kept) * np.outer(odd, odd)
        j = int(far.max(axis=0).argmax())
        ends = [
            local.coordinates(return_map(one.system, local.state(sign * h * np.eye(local.dimension)[j]), 1e-12).state)
            for sign in (1.0, -1.0)
        ]
        wanted = (ends[0] - ends[1])[odd] / (2.0 * h)
        np.testing.assert_allclose(one.jacobian[odd, j], wanted, rtol=0, atol=2e-5)
        assert far.max() > 1e-2  # of a step so small that the other foot is still taken for one on the ground

    @pytest.mark.parametrize("name", ["long_stride_in_space", "pronk"])  # in a pronk four impacts overlap
    def test_along_it_is_the_differences(self, name):
        one, even, kept = orbit(name), orbit(name).chart.even, jacobian(name)
        np.testing.assert_allclose(one.jacobian[np.ix_(even, even)], kept[np.ix_(even, even)], rtol=0, atol=2e-5)


@pytest.mark.parametrize("name", ["trot", "turn_9", "gallop"])
def test_measures_are_those_of_samples(name):
    one = orbit(name)
    halves = 2 if one.system.mirrored_toes else 1
    run = simulate(one.system, one.state, halves, rtol=1e-12, progress=False)  # a jump of force in a gallop asks for it
    sampled = Sampled(one.system.robot, run, range(1, halves + 1), halves == 2).values()
    found = {each: one.measures[each].value for each in sampled}
    for each, value in sampled.items():
        assert found[each] == pytest.approx(value, rel=1e-6, abs=1e-6), each


def test_a_half_stride_with_another_roll_inertia():
    """It ends elsewhere, as its derivatives say."""
    gait, name, h = Gait.load("trot"), "roll_inertia_xx", 1e-3
    found, local = Orbit(gait.system, gait.state, (name,)).columns[:, -1], chart(gait.system, gait.state)
    value, ends = number(gait.system, name), []
    for side in (1.0, -1.0):
        other = with_numbers(gait.system, {name: value * (1.0 + side * h)})
        ends.append(local.coordinates(return_map(other, gait.state, 1e-12).state))
    wanted = (ends[0] - ends[1]) / (2.0 * h * value)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-5 * np.abs(wanted).max())


def test_a_gait_with_another_roll_inertia():
    """The whole gait moves as its derivatives say."""
    gait, name = Gait.load("trot"), "roll_inertia_xx"
    table = gait.sensitivity([name])
    value, h = number(gait.system, name), 2e-4
    ends = []
    for side in (1.0, -1.0):
        found = find_gait(with_numbers(gait.system, {name: value * (1.0 + side * h)}), guess=gait.state)
        ends.append(Orbit(found.system, found.state, ()).measures)
    for each in ("mean_speed", "period", "effort", "absolute_work", "peak_force_posterior_left_toe"):
        wanted = (ends[0][each].value - ends[1][each].value) / (2.0 * h * value)
        assert table.derivatives[each][0] == pytest.approx(wanted, rel=1e-6), each


def test_errors_of_its_numbers():
    table = Gait.load("turn_4").sensitivity(["hip_spacing", "friction"])
    found = table.uncertainty({"hip_spacing": 0.003})
    wanted = 0.003 * abs(table.derivatives["period"][0])
    assert found.deviation("period") == pytest.approx(wanted, rel=1e-9)


def test_where_a_toe_slides_and_stops():
    """It uses all friction, however singular the forces are where it begins; its guards wait below zero until it moves.

    The peak of its normal force is not checked: it grows with the logarithm of the speed at which it is stopped.
    """
    gait, toe = Gait.load("gallop"), "anterior_left_toe"
    one = Orbit(gait.system, gait.state, ("friction",))
    used = one.measures[f"friction_used_{toe}"]
    assert used.value == pytest.approx(gait.system.contact.friction, abs=1e-12)
    np.testing.assert_allclose(used.derivative, np.eye(one.dimension + 1)[-1], rtol=0, atol=1e-8)
    assert all(margin.value > -1e-9 for event, margin in one.margins.items() if event == "stick")


class TestRefused:
    def test_a_number_that_tells_the_halves_of_a_stride_apart(self):
        with pytest.raises(BadValue, match="left and right alike"):
            Gait.load("trot").sensitivity(["posterior_left_knee_mass"])

    def test_a_number_that_tells_left_from_right_in_a_symmetric_gait(self):
        one = Gait.load(RECIPES["long_stride_upright"].path)
        with pytest.raises(NotDifferentiable, match="tell left from right"):
            one.sensitivity(["posterior_adduction"])

    def test_lengths_for_which_the_law_is_made(self):
        with pytest.raises(BadValue, match="built into the law"):
            Gait.load("turn_4").sensitivity(["posterior_left_hip_to_posterior_left_knee"])

    def test_a_robot_round_a_post(self):
        hoppy = load("hoppy")
        law = replace(RoundHoppingLaw.driven(hoppy), unlimited_friction=False)
        system = round_hopping(hoppy, law, contact=Contact(friction=0.8))
        with pytest.raises(BadValue, match="a post"):
            simulate_many(system, *(part[None] for part in system.guess()))

    def test_heat_in_half_a_stride(self):
        from spear_pin.model.catalogue import motor

        gait = Gait.load("trot")
        motors = {joint: motor("assumed_600w") for joint in gait.system.robot.actuated}
        with pytest.raises(BadValue, match="half a stride"):
            gait.sensitivity(["friction"], motors=motors)


class TestOnsetOfSlip:
    """A toe sets out to slide: its velocity is turned to the direction in which it slides."""

    @staticmethod
    @cache
    def turn() -> tuple[Gait, np.ndarray]:
        """The gait, and the derivatives of its end by friction, from differences of cycles."""
        gait = Gait.load("turn_9")
        local, value, slopes = chart(gait.system, gait.state), number(gait.system, "friction"), []
        for h in (1e-3, 5e-4):
            systems = [with_numbers(gait.system, {"friction": value + step}) for step in (h, -h)]
            ends = [local.coordinates(return_map(system, gait.state, FINEST).state) for system in systems]
            slopes.append((ends[0] - ends[1]) / (2.0 * h))
        return gait, (4.0 * slopes[1] - slopes[0]) / 3.0

    @classmethod
    @cache
    def slip(cls) -> Arc:
        """The arc in which it slides."""
        gait = cls.turn()[0]
        arcs = Recorder(gait.system).lap(np.concatenate(gait.state)).arcs
        return next(arc for arc in arcs if SLIP in arc.domain.contacts)

    @pytest.mark.parametrize("cycles", [math.inf, 0], ids=["reference", "compiled"])
    def test_derivatives_by_friction(self, cycles, monkeypatch):
        """The reference engine has one arc where the compiled one has two."""
        monkeypatch.setattr(record, "CYCLES", cycles)
        gait, expected = self.turn()
        exact = Orbit(gait.system, gait.state, ("friction",)).columns[:, -1]
        assert np.abs(expected - exact).max() <= 3e-7 * np.abs(exact).max()

    def test_both_engines_give_the_same_derivatives_of_measures(self, monkeypatch):
        """Integrals count how the compiled engine's two arcs meet."""
        found = []
        for cycles in (math.inf, 0):
            monkeypatch.setattr(record, "CYCLES", cycles)
            found.append(Gait.load("turn_9").sensitivity(["friction"]).derivatives)
        for name in ("period", "effort", "work", "absolute_work"):
            assert found[1][name] == pytest.approx(found[0][name], rel=1e-7), name

    @pytest.mark.parametrize(("end", "toes"), [("y", 0), ("after", 1)])
    def test_a_toe_sets_out_if_it_gets_faster(self, end, toes):
        gait, arc = self.turn()[0], self.slip()
        assert len(find_setting_out(gait.system, arc, getattr(arc, end)[:, None])) == toes

    @pytest.mark.parametrize("place", [0, -1])
    def test_a_state_without_a_value_changes_no_step(self, place):
        gait, arc = self.turn()[0], self.slip()
        flow, y = Flow(gait.system, arc.domain, arc.held), np.pad(arc.y, (0, len(flow_names(gait.system))))
        flow(arc.t, y)
        flow.arrive(arc.t, y)
        before = flow.longest
        assert flow.sets_out and before < LONGEST
        y[place] = np.nan
        flow.arrive(arc.t, y)
        assert flow.sets_out and flow.longest == before

    def test_arcs_of_an_instant_turn_nothing(self):
        """A toe does not get faster in them."""
        assert [_rate(np.zeros(8), [0.3] * 8), _rate(np.arange(8.0), [0.3] * 8), _rate(np.zeros(1), [0.3])] == [0.0] * 3
        assert _rate(np.array([1.0, 2.0, 4.0]), [3.1, 3.1 + 0.02, 3.1 + 0.06 - math.tau]) == pytest.approx(0.02)
