"""Bounds with late, toothed and slipping switches: against the ideal switch, by hand, in lanes and by differences."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, Spring, bounding, find_gait, simulate, simulate_many
from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.springing import springing_in_space
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues
from spear_pin.model.clutch import Clutch
from tests.gaits.bounding_gaits import LEGS, gait
from tests.gaits.test_bounding_disturbed import both_down
from tests.hybrid.lanes import assert_agree, compiles
from tests.slow import slow_but

IDEAL = gait("long_stride")
STIFFNESS, DAMPING = 112.0, 0.1
LATE = Clutch(on_delay=0.002, off_delay=0.002)
FELT = {"engage": "loaded", "release": "unloaded", "on_force": 20.0, "off_force": 2.0}
SWITCHES = {
    "late": (LATE, DAMPING),
    "late, with the joint's damper": (Clutch(0.002, 0.002, damper="joint"), DAMPING),
    "into the other stance": (Clutch(off_delay=0.2), DAMPING),
    "play": (Clutch(play=0.01), 0.0),
    "teeth": (Clutch(0.001, pitch=0.05), 0.0),
    "second spring": (Clutch(second=5.0), 0.0),
    "slip": (Clutch(slip=25.0), 0.0),
    "time": (Clutch(hold=0.09), 0.0),
    "longest": (Clutch(release="longest"), 0.0),
    "force": (Clutch(damper="joint", **FELT), DAMPING),
}
each_switch = pytest.mark.parametrize("name", slow_but(SWITCHES, "late"))


def switched(clutch, damping=0.0):
    return bounding(IDEAL.system.robot, IDEAL.system.law, Spring(STIFFNESS, damping=damping, clutch=clutch))


@cache
def found(clutch):
    return find_gait(switched(clutch, DAMPING), guess=IDEAL.state, rtol=1e-12)


def whole(clutch):
    return np.concatenate(found(clutch).state)


def times(run, name):
    return [event.time for event in run.named(name)]


class TestLate:
    """Of springs without damping: the motor of a bearing leg gives what they do not, so the motion stays the same."""

    @pytest.fixture(scope="class")
    @classmethod
    def stride(cls):
        return simulate(switched(LATE), IDEAL.state, cycles=1, rtol=1e-12)

    def test_each_leg_switches_so_long_after_its_own_toe(self, stride):
        for leg in LEGS:
            (lifts,), lands = times(stride, f"{leg}_lift_off"), times(stride, f"{leg}_touchdown")
            begins = 0.0 if leg == "posterior" else lands[0]
            assert times(stride, f"switch:{leg}_knee") == pytest.approx([begins + 0.002, lifts + 0.002], abs=1e-12)

    def test_ledger_closes(self, stride):
        assert np.abs(stride.ledger.residual).max() < 1e-10

    def test_each_spring_pulls_from_where_its_knee_was_as_it_engaged(self, stride):
        for i, (leg, (_, _, knee, side)) in enumerate(LEGS.items()):
            on, off = stride.named(f"switch:{leg}_knee")
            engaged = (stride.t > on.time + 1e-9) & (stride.t < off.time - 1e-9)
            stretch = np.maximum(side * (stride.q[:, knee] - on.q[knee]), 0.0)
            np.testing.assert_allclose(stride.spring[:, i], -side * STIFFNESS * engaged * stretch, rtol=0, atol=1e-8)
            assert np.abs(stride.spring[:, i]).max() > 10.0

    def test_motion_is_that_of_the_ideal_switch(self, stride):
        ideal = simulate(IDEAL.system, IDEAL.state, cycles=1, rtol=1e-12)
        np.testing.assert_allclose(stride.q[-1], ideal.q[-1], rtol=0, atol=1e-11)
        ours, theirs = (sum(run.ledger[f"motor_{leg}_knee"][0] for leg in LEGS) for run in (stride, ideal))
        assert abs(ours - theirs) < 1e-9  # springs that store nothing as they release take no work

    @pytest.mark.parametrize(("clutch", "after"), [(LATE, 0.002), (Clutch(hold=0.09), 0.09)])
    def test_both_switches_are_open_where_a_run_begins_in_the_air(self, clutch, after):
        q, v = IDEAL.state
        run = simulate(switched(clutch), (q + 0.05 * np.eye(7)[1], v), cycles=1)
        assert run.reason == "complete" and np.abs(run.ledger.residual).max() < 1e-8
        landing = times(run, "posterior_touchdown")[0]
        assert landing > 0.01 and not run.engaged[run.t < landing].any()
        assert times(run, "switch:posterior_knee")[0] == pytest.approx(landing + after, abs=1e-12)


def test_time_runs_on_through_the_phases_of_the_other_leg():
    """The posterior spring is released in the anterior stance, and the anterior one in the next stride."""
    run = simulate(switched(Clutch(off_delay=0.2)), IDEAL.state, cycles=2, rtol=1e-12)
    for leg in LEGS:
        first = times(run, f"{leg}_lift_off")[0]
        assert times(run, f"switch:{leg}_knee")[0] == pytest.approx(first + 0.2, abs=1e-12)
    assert [run.named(f"switch:{leg}_knee")[0].domain for leg in LEGS] == ["anterior_stance", "flight_1"]
    assert np.abs(run.ledger.residual).max() < 1e-10


def test_an_ideal_switch_is_closed_while_its_leg_is_on_the_ground():
    run = simulate(switched(Clutch()), IDEAL.state, cycles=1)
    for i, leg in enumerate(LEGS):
        landing, (leaving,) = times(run, f"{leg}_touchdown")[0], times(run, f"{leg}_lift_off")
        begin = 0.0 if leg == "posterior" else landing
        away = (abs(run.t - begin) > 1e-9) & (abs(run.t - leaving) > 1e-9) & (run.t < run.t[-1] - 1e-9)
        bears = (run.t > begin) & (run.t < leaving)
        np.testing.assert_array_equal(run.engaged[away, i], bears[away])


def test_a_spring_is_let_go_where_it_is_stretched_most():
    run = simulate(switched(Clutch(release="longest")), IDEAL.state, cycles=1, rtol=1e-12)
    for leg, (_, _, knee, _) in LEGS.items():
        (release,) = run.named(f"switch:{leg}_knee")
        rest = IDEAL.state[0] if leg == "posterior" else run.named("anterior_touchdown")[0].q
        assert release.v[knee] == pytest.approx(0.0, abs=1e-8)
        lost = 0.5 * STIFFNESS * (release.q[knee] - rest[knee]) ** 2
        assert lost > 1.0 and release.work["released"] == pytest.approx(-lost, rel=1e-8)


def test_engages_in_a_double_stance():
    """The other foot lands at once, so that both switches wait, and act, in the double stance."""
    system, state = both_down()
    late = bounding(system.robot, system.law, Spring(STIFFNESS, damping=0.0, clutch=LATE))
    run = simulate(late, state, cycles=1)
    for leg in LEGS:
        acts = run.named(f"switch:{leg}_knee")[0]
        assert acts.time == pytest.approx(0.002, abs=1e-7) and acts.domain.startswith("double_1")


@each_switch
def test_ledger_closes_with_other_switches(name):
    run = simulate(switched(*SWITCHES[name]), IDEAL.state, cycles=1, rtol=1e-12)
    assert run.reason == "complete" and np.abs(run.ledger.residual).max() < 1e-9
    assert len(run.named("slips:posterior_knee")) == (name == "slip")


@pytest.mark.slow
@compiles
@pytest.mark.parametrize("name", SWITCHES)
def test_lanes_with_other_switches(name):
    system, (q, v) = switched(*SWITCHES[name]), IDEAL.state
    lanes = simulate_many(system, q[None], v[None], 1, rtol=1e-12)
    assert_agree(system, q[None], v[None], lanes, tolerance=1e-9)
    assert not lanes.repeated.any()


@pytest.mark.slow
def test_a_switch_that_is_still_closed_in_the_next_stride_makes_no_gait():
    """Only (q, v) repeats, as motors give what springs do not."""
    with pytest.raises(NoGait, match="the switch of anterior_knee is not open at the posterior_touchdown"):
        find_gait(switched(Clutch(off_delay=0.2)), guess=IDEAL.state)
    assert find_gait(switched(Clutch(off_delay=0.02)), guess=IDEAL.state).residual < 1e-9


@pytest.mark.slow
class TestDamped:
    """Of springs whose dampers are engaged with them, so that the motion depends on the switch."""

    def test_an_ideal_switch_is_that_of_the_plain_spring(self):
        np.testing.assert_allclose(whole(Clutch()), whole(None), rtol=0, atol=1e-9)
        np.testing.assert_allclose(found(Clutch()).multipliers, found(None).multipliers, atol=1e-9)

    def test_gaits_of_smaller_and_smaller_delays_tend_to_that_of_the_ideal_switch(self):
        far, near, nearest = (whole(Clutch(delay, delay)) for delay in (2e-5, 1e-5, 5e-6))
        assert np.abs(nearest - whole(None)).max() > 1e-5
        np.testing.assert_allclose((8 * nearest - 6 * near + far) / 3, whole(None), rtol=0, atol=1e-9)

    def test_multipliers_are_those_of_differences(self):
        late = found(LATE)
        differences = eigenvalues(differentiate_return_map(late.system, late.state, 1e-12))
        np.testing.assert_allclose(late.multipliers[:4], differences[:4], atol=1e-6)
        assert abs(late.multipliers[0] - IDEAL.multipliers[0]) > 1e-2

    def test_derivative_is_that_of_gaits_found_again(self):
        exact = found(LATE).sensitivity(["on_delay"]).state[:, 0]

        def slope(h):
            return (whole(Clutch(0.002 + h, 0.002)) - whole(Clutch(0.002 - h, 0.002))) / (2 * h)

        np.testing.assert_allclose(exact, (4 * slope(1e-5) - slope(2e-5)) / 3, atol=1e-8 * np.abs(exact).max())

    @compiles
    def test_lanes_of_several_delays(self):
        late, delays = found(LATE), np.array([0.0, 0.001, 0.002, 0.003])
        q, v = (np.repeat(part[None], len(delays), axis=0) for part in late.state)
        lanes = simulate_many(late.system, q, v, rtol=1e-12, parameters={"on_delay": delays})
        for i, delay in enumerate(delays.tolist()):
            run = simulate(with_numbers(late.system, {"on_delay": delay}), late.state, cycles=1, rtol=1e-12)
            last = run.named("posterior_touchdown")[-1]
            np.testing.assert_allclose(lanes.q[i], last.q, rtol=0, atol=1e-9)
            np.testing.assert_allclose(lanes.v[i], last.v, rtol=0, atol=1e-9)

    def test_is_kept_in_a_file(self, tmp_path):
        late = found(LATE)
        again = Gait.load(late.save(tmp_path / "late.json"))
        assert again.system.springs == late.system.springs and again.residual == late.residual


def test_bounds_in_space_take_no_such_switch():
    with pytest.raises(BadValue, match="only `hopping` and `bounding` take one"):
        springing_in_space(IDEAL.system.robot, {"knee": Spring(clutch=LATE)}, None)
