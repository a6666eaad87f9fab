"""Hops with switches that act on conditions of stance, against numbers of a second program and gaits found again."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Spring, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.conditions import CONDITIONS
from spear_pin.hybrid.parameters import unit, with_numbers
from spear_pin.model.clutch import CONDITIONS as NAMES
from spear_pin.model.clutch import Clutch
from spear_pin.model.path import Joints
from spear_pin.model.springs import describe_spring
from tests.gaits import found_again

LEG = load("spear_ii", locked=["boom_x"])
LAW = HoppingLaw(stance_torque=7.8261879, hold_extension=True)
FORCES = Clutch(engage="loaded", release="unloaded", on_force=5.0, off_force=0.5, damper="joint")
START = np.array([0.56349008, 0.50685044, 0.96311709]), np.array([-0.80510327, 2.76839068, 5.46453907])


def found(spring, vary=(), **options):
    target = {"flight_time": 0.2} if vary else {}
    return find_gait(hopping(LEG, LAW, spring), [*vary], target, guess=START, rtol=1e-12, **options)


def beside(stiffness, damping=0.0, **clutch):
    """The knee's spring, which touchdown engages, and another at the knee with a switch of its own."""
    aid = Spring(stiffness, damping=damping, path=Joints({"knee": 1.0}), clutch=Clutch(**clutch))
    return {"knee": Spring(), "aid": aid}


def agree_in_lanes(gait, name, values):
    """Runs lanes that differ in a number by both engines; returns the runs of the reference engine."""
    q, v = (np.repeat(part[None], len(values), axis=0) for part in gait.state)
    lanes, runs = simulate_many(gait.system, q, v, rtol=1e-12, parameters={name: np.array(values)}), []
    for i, value in enumerate(values):
        runs.append(simulate(with_numbers(gait.system, {name: value}), gait.state, cycles=1, rtol=1e-12))
        last = runs[i].named("touchdown")[-1]
        np.testing.assert_allclose(lanes.q[i], last.q, atol=1e-9)
        np.testing.assert_allclose(lanes.v[i], last.v, atol=1e-9)
    return runs


def check_derivative(spring, over):
    exact, expected = found_again.hops(found(spring, ["stance_torque"]), over, 2e-2)
    assert np.abs(exact).max() > 1e-5
    np.testing.assert_allclose(exact, expected, atol=1e-8)


class TestForce:
    """Of a switch that closes as the toe is loaded, and opens just before it would leave the ground."""

    @pytest.fixture(scope="class")
    @classmethod
    def gait(cls):
        return found(Spring(clutch=FORCES))

    def test_hop_is_that_of_another_program(self, gait):
        q, v = gait.state
        assert (q[1], q[2], v[2]) == pytest.approx((0.5068499, 0.9631581, 5.4639826), abs=1e-7)
        np.testing.assert_allclose(gait.multipliers[:2], (-0.406075, 0.178604 + 0.151576j), atol=1e-6)

    def test_a_force_that_is_there_already_engages_at_once_and_what_release_unloads_lifts_off(self, gait):
        run = simulate(gait.system, gait.state, cycles=1, rtol=1e-12)
        on, off = run.named("switch:knee")
        (leaves,) = run.named("lift_off")
        assert on.time == 0.0 and off.time == leaves.time
        assert run.force[0, 0, -1] > 5.0
        assert abs(run.ledger.residual[0]) < 1e-10
        assert run.ledger["released"][0] == off.work["released"] < 0.0

    @pytest.mark.extra("heyoka")
    def test_both_engines_agree(self, gait):
        runs = agree_in_lanes(gait, "off_force", [0.2, 0.5, 1.0])
        assert len({run.named("switch:knee")[1].time for run in runs}) == 3

    @pytest.mark.slow
    def test_derivative_is_that_of_hops_found_again(self):
        check_derivative(Spring(clutch=FORCES), "off_force")

    def test_a_force_above_what_stance_begins_with_is_reached_late(self):
        """Flexion holds the force down; 30 ms after touchdown the key engages, and the hop dies."""
        system = hopping(LEG, LAW, Spring(clutch=replace(FORCES, on_force=10.0)))
        assert simulate(system, START, cycles=1).named("switch:knee")[0].time == pytest.approx(0.030, abs=5e-4)


class TestForceOfOneOfTwo:
    """Of a second spring whose switch closes at 40 N, some time after touchdown, and opens at 5 N."""

    SPRINGS = beside(3.0, engage="loaded", release="unloaded", on_force=40.0, off_force=5.0)

    @pytest.mark.extra("heyoka")
    def test_both_engines_agree(self):
        forces = [30.0, 40.0, 50.0]
        for run, least in zip(agree_in_lanes(found(self.SPRINGS), "aid.on_force", forces), forces, strict=True):
            on, off = run.named("switch:aid")
            felt = [float(run.force[np.argmin(abs(run.t - event.time)), 0, -1]) for event in (on, off)]
            assert felt == pytest.approx([least, 5.0], abs=1e-6)

    @pytest.mark.slow
    def test_derivative_is_that_of_hops_found_again(self):
        check_derivative(self.SPRINGS, "aid.on_force")


class TestLongest:
    """Of a second, weak spring that is released where it is stretched most."""

    @pytest.fixture(scope="class")
    @classmethod
    def gait(cls):
        return found(beside(0.5, release="longest"))

    def test_is_released_as_the_knee_turns(self, gait):
        run = simulate(gait.system, gait.state, cycles=1, rtol=1e-12)
        (off,) = run.named("switch:aid")
        stance = run.q[run.phase == "stance", 2]
        assert off.v[2] == pytest.approx(0.0, abs=1e-9) and off.q[2] == pytest.approx(stance.max(), abs=1e-9)
        assert off.work["released:aid"] == pytest.approx(-0.25 * (off.q[2] - gait.state[0][2]) ** 2, rel=1e-9)
        assert abs(run.ledger.residual[0]) < 1e-10

    @pytest.mark.extra("heyoka")
    def test_both_engines_agree(self, gait):
        assert all(len(run.named("switch:aid")) == 1 for run in agree_in_lanes(gait, "aid.stiffness", [0.4, 0.5, 0.6]))

    @pytest.mark.slow
    def test_derivative_is_that_of_hops_found_again(self):
        check_derivative(beside(0.5, release="longest"), "aid.stiffness")


@pytest.mark.parametrize("engage", ["longest", "shortest"])
def test_a_spring_that_engages_as_its_path_turns_pulls_no_more(engage):
    """The path only shortens after it was longest; in stance it is never shortest."""
    run = simulate(hopping(LEG, LAW, beside(3.0, engage=engage)), START, cycles=1)
    assert [event.v[2] for event in run.named("switch:aid")] == pytest.approx([0.0] * (engage == "longest"), abs=1e-8)
    assert run.spring.min() == pytest.approx(-48.84 * (run.q[:, 2].max() - START[0][2]), rel=1e-6)


def test_every_condition_has_a_name():
    assert set(CONDITIONS) == set(NAMES)


def test_a_switch_that_undoes_itself_accumulates_events():
    """Engaging the damper loads the toe by more than lies between the forces."""
    springs = beside(0.0, 1.0, engage="unloaded", off_force=60.0, release="loaded", on_force=61.0)
    assert simulate(hopping(LEG, LAW, springs), START, cycles=1).reason == "zeno"


def test_a_switch_that_only_releases_early():
    gait = found(beside(3.0, release="unloaded", off_force=5.0))
    run = simulate(gait.system, gait.state, cycles=1, rtol=1e-12)
    (off,), (leaves,) = run.named("switch:aid"), run.named("lift_off")
    left = off.q[2] - gait.state[0][2]
    assert off.time < leaves.time and off.work["released:aid"] == pytest.approx(-0.5 * 3.0 * left**2, rel=1e-9)
    assert abs(run.ledger.residual[0]) < 1e-10


def test_numbers_have_units_and_are_kept_in_a_file(tmp_path):
    gait = found(Spring(clutch=FORCES))
    assert [unit(gait.system, name) for name in ("on_force", "off_force")] == ["N", "N"]
    assert "engages loaded at 5 N; releases unloaded at 0.5 N" in describe_spring("knee", gait.system.spring)
    assert Gait.load(gait.save(tmp_path / "loaded.json")).system.springs == gait.system.springs


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"engage": "apex"}, "'touchdown' or 'loaded'"),
        ({"release": "touchdown"}, "'lift_off' or 'loaded'"),
        ({"engage": "loaded", "on_force": -1.0}, "Clutch.on_force"),
        ({"release": "unloaded", "off_force": float("nan")}, "Clutch.off_force"),
        ({"on_force": 5.0}, "0 unless it engages or releases where the toe is 'loaded'"),
        ({"engage": "loaded", "release": "unloaded", "on_force": 5.0, "off_force": 5.0}, "less than on_force, 5 N"),
        ({"engage": "loaded", "release": "loaded"}, "where engage is .loaded."),
        ({"engage": "loaded", "on_delay": 0.01}, "Clutch.on_delay"),
        ({"release": "unloaded", "hold": 0.3}, "Clutch.hold"),
    ],
)
def test_what_is_no_condition(fields, words):
    with pytest.raises(BadValue, match=words):
        Clutch(**fields)
