"""Hops with late, toothed and slack switches, against numbers of a second program and gaits found again."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Spring, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.clutch import Clock, after_edges, from_now_on
from spear_pin.hybrid.domain import ACTS, KEEPS, LEAVES, TOUCHES, Edge
from spear_pin.hybrid.parameters import unit, with_numbers
from spear_pin.model.clutch import Clutch
from spear_pin.model.path import Joints
from tests.gaits import found_again
from tests.slow import slow_but

LEG = load("spear_ii", locked=["boom_x"])
SERIES = load("spear_ii_series", locked=["boom_x"])
LAW = HoppingLaw(stance_torque=7.86, hold_extension=True)
# delay and play: stance torque, knee at touchdown, duration of stance, work of the knee's motor, damping, multipliers
FOUND = {
    (0.0001, 0.0): (7.826356, None, None, None, None, None),
    (0.004, 0.0): (7.837957, 0.962468, 0.369718, 10.88103, -9.95594, (-0.408087, 0.171201 + 0.111494j)),
    (0.010, 0.0): (7.874212, 0.961505, 0.377831, 11.36555, -10.42013, (-0.410537, 0.216512, 0.103107)),
    (0.016, 0.0): (7.931048, 0.960536, 0.385847, 11.85277, -10.88738, (-0.412438, 0.285264, 0.011999)),
    (0.0, 0.025): (7.840657, 0.962376, 0.370552, 10.93080, -10.00320, (-0.408610, 0.178672 + 0.085234j)),
    (0.0, 0.05): (7.868835, 0.961622, 0.376880, 11.30850, -10.36528, (-0.410914, 0.273895, 0.087233)),
    (0.010, 0.025): (7.915340, 0.960773, 0.383896, 11.73334, -10.77280, (-0.412455, 0.295567, 0.026698)),
}
HELD = {  # with the next tooth so far ahead and held: multipliers
    (0.0, 0.025): (-0.411953, 0.357841, 0.0),
    (0.0, 0.05): (-0.415337, 0.380563, 0.0),
    (0.010, 0.025): (-0.419107, 0.402629, 0.0),
}


def late(delay, play=0.0, **others):
    return Spring(clutch=Clutch(delay, delay, play, damper="joint", **others))


def found(spring, law=LAW, **options):
    return find_gait(hopping(LEG, law, spring), ["stance_torque"], {"flight_time": 0.2}, **options)


def engaged_at(gait):
    run = simulate(gait.system, gait.state, cycles=1)
    acts = run.named("switch:knee")
    return acts[0].q[2] if acts and acts[0].time < 0.1 else gait.state[0][2]


@pytest.mark.parametrize("case", slow_but(FOUND, (0.004, 0.0)))
def test_a_late_switch_with_play(case):
    delay, play = case
    gait = found(late(delay, play))
    torque, knee, stance, work, damping, multipliers = FOUND[delay, play]
    assert gait.parameters["stance_torque"] == pytest.approx(torque, abs=1e-6)
    if knee is None:
        return
    run = simulate(gait.system, gait.state, cycles=1)
    assert gait.state[0][2] == pytest.approx(knee, abs=1e-6)
    assert gait.durations["stance"] == pytest.approx(stance, abs=1e-6)
    assert run.ledger["motor_knee"][0] == pytest.approx(work, abs=1e-5)
    assert run.ledger["damping"][0] == pytest.approx(damping, abs=1e-5)
    assert abs(run.ledger.residual[0]) < 1e-8
    upper = [each for each in gait.multipliers if each.imag >= 0]
    np.testing.assert_allclose(upper[: len(multipliers)], multipliers, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("delay", "play"), HELD)
def test_teeth_that_are_as_far_ahead(delay, play):
    smooth = found(late(delay, play))
    gait = found(late(delay, pitch=2 * play, tooth=engaged_at(smooth) + play - 6 * play))
    for one, other in zip(smooth.state, gait.state, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-8)
    np.testing.assert_allclose(gait.multipliers, HELD[delay, play], atol=1e-6)
    assert simulate(gait.system, gait.state, cycles=1).ledger.residual[0] == pytest.approx(0.0, abs=1e-8)


def test_fine_teeth_change_the_hop_little_and_its_multipliers_much():
    """The spring rests at the same tooth again, while that of a switch without teeth follows the knee."""
    law = replace(LAW, stance_torque=7.8261879)
    gait = find_gait(hopping(LEG, law, Spring(clutch=Clutch(pitch=0.001, damper="joint"))))
    assert gait.state[0][2] == pytest.approx(0.963117, abs=5e-5)
    np.testing.assert_allclose(gait.multipliers, (-0.408776, 0.333103, 0.0), atol=1e-6)


@pytest.mark.slow
def test_a_switch_that_only_releases_late_hardly_matters():
    gait = found(Spring(clutch=Clutch(off_delay=0.010, damper="joint")))
    assert gait.parameters["stance_torque"] == pytest.approx(7.826198, abs=1e-6)


@pytest.mark.parametrize(
    "clutch",
    [
        Clutch(0.004, 0.25, damper="joint"),
        pytest.param(Clutch(hold=0.6, damper="joint"), marks=pytest.mark.extra("heyoka")),
    ],
)
def test_a_switch_that_is_still_closed_at_the_next_touchdown(clutch):
    """Only the first hop engages it."""
    with pytest.raises(NoGait) as error:
        find_gait(hopping(LEG, LAW, Spring(clutch=clutch)))
    said = "the switch of knee is not open at the touchdown, so that the first cycle differs"
    assert error.value.reason == said and str(error.value).endswith("; try a shorter off_delay, or hold")


def test_a_switch_that_opens_just_before_the_next_touchdown():
    assert find_gait(hopping(LEG, LAW, Spring(clutch=Clutch(0.004, 0.19, damper="joint")))).residual < 1e-9


@pytest.mark.slow
def test_a_damper_that_engages_late_needs_a_law_that_keeps_the_toe_down():
    gait = found(Spring(clutch=Clutch(0.010, 0.010)), replace(LAW, minimum_force=5.0))
    assert gait.parameters["stance_torque"] == pytest.approx(7.851579, abs=1e-6)
    q, v = gait.state
    assert (q[1], q[2], v[2]) == pytest.approx((0.5044766, 0.9703452, 5.1294079), abs=1e-6)
    np.testing.assert_allclose(gait.multipliers, (-0.409487, 0.236175, 0.063771), atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("clutch", [Clutch(), Clutch(damper="joint"), Clutch(pitch=1e-7)])
def test_an_ideal_switch_is_that_of_the_plain_spring(clutch):
    plain, gait = found(Spring()), found(Spring(clutch=clutch))
    for one, other in zip(plain.state, gait.state, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9 if not clutch.pitch else 1e-5)
    if not clutch.pitch:
        np.testing.assert_allclose(gait.multipliers, plain.multipliers, atol=1e-7)


@pytest.mark.extra("heyoka")
def test_a_late_switch_of_a_hip_and_knee_spring_in_lanes():
    path = Joints({"knee": 0.03, "hip": -0.006})
    spring = Spring(48.84 / 9e-4, damping=1.3 / 9e-4, path=path, clutch=Clutch(0.004, 0.003, damper="joint"))
    gait = found(spring)
    q, v = (np.repeat(part[None], 5, axis=0) for part in gait.state)
    delays = np.array([0.002, 0.003, 0.004, 0.005, 0.006])
    lanes = simulate_many(gait.system, q, v, rtol=1e-12, parameters={"on_delay": delays})
    for i, delay in enumerate(delays):
        alone = simulate(with_numbers(gait.system, {"on_delay": delay}), gait.state, cycles=1, rtol=1e-12)
        assert alone.named("switch:knee")[0].time == pytest.approx(delay, abs=1e-12)
        last = alone.named("touchdown")[-1]
        np.testing.assert_allclose(lanes.q[i], last.q, atol=1e-9)
        np.testing.assert_allclose(lanes.v[i], last.v, atol=1e-8)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", ["on_delay", "off_delay", "tooth"])
def test_lanes_that_begin_at_zero(name):
    """What is zero is left out of the equations, so that other lanes need others."""
    clutch = (
        Clutch(0.004, 0.004, pitch=0.05, damper="joint") if name == "tooth" else Clutch(damper="joint", off_delay=0.004)
    )
    gait = found(Spring(clutch=replace(clutch, **{name: 0.0})))
    values = np.array([0.0, 0.002, 0.004])
    q, v = (np.repeat(part[None], 3, axis=0) for part in gait.state)
    lanes = simulate_many(gait.system, q, v, rtol=1e-12, parameters={name: values})
    for i, value in enumerate(values):
        last = simulate(with_numbers(gait.system, {name: value}), gait.state, cycles=1, rtol=1e-12).named("touchdown")[
            -1
        ]
        np.testing.assert_allclose(lanes.q[i], last.q, atol=1e-9)


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("clutch", [Clutch(play=0.1, damper="joint"), Clutch(0.02, 0.001, damper="joint")])
def test_both_engines_agree_while_the_toe_alternates(clutch):
    gait = found(Spring(clutch=clutch), replace(LAW, stance_torque=8.0063))
    run = simulate(gait.system, gait.state, cycles=1, rtol=1e-12)
    assert "chatter" in run.domain and "chatter" not in {event.domain for event in run.named("switch:knee")}
    lanes = simulate_many(gait.system, *(part[None] for part in gait.state), rtol=1e-12)
    np.testing.assert_allclose(lanes.q[0], run.named("touchdown")[-1].q, atol=1e-9)


def test_is_engaged_from_one_action_to_the_next():
    gait = found(late(0.004))
    run = simulate(gait.system, gait.state, cycles=1)
    on, off = (event.time for event in run.named("switch:knee"))
    engaged = run.engaged[:, run.spring_joints.index("knee")]
    inside = (run.t > on + 1e-9) & (run.t < off - 1e-9)
    assert engaged[inside].all() and not engaged[(run.t < on - 1e-9) | (run.t > off + 1e-9)].any()


OVER = ["on_delay", "play", "pitch", "tooth", "stiffness", "second", "slack", "hold", "slip"]


@pytest.mark.slow
@pytest.mark.parametrize("over", OVER)
def test_derivative_is_that_of_hops_found_again(over):
    spring = late(0.004, 0.01)
    if over in ("pitch", "tooth"):
        spring = late(0.004, pitch=0.05, tooth=0.9)
    if over in ("second", "slack"):
        spring = late(0.004, second=2.0, slack=0.1)
    if over == "hold":
        spring = Spring(clutch=Clutch(hold=0.38))
    if over == "slip":
        spring = Spring(clutch=Clutch(play=0.001, slip=35.9))
    gait = found(spring, guess=found(Spring()).state if over == "slip" else None, rtol=1e-12)
    # the path grows on as a root of what is missing
    exact, expected = found_again.hops(gait, over, 1e-4 if over == "slip" else 1e-3)
    assert np.abs(exact).max() > 1e-4
    np.testing.assert_allclose(exact, expected, atol=1e-8 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("second", "torque", "knee", "released"),
    [(0.5, 7.856148, 0.9564614, -0.000193), (2.0, 7.953588, 0.9386179, -0.015715)],
)
def test_a_second_spring_in_series(second, torque, knee, released):
    gait = found(Spring(clutch=Clutch(second=second)))
    assert gait.parameters["stance_torque"] == pytest.approx(torque, abs=1e-6)
    assert gait.state[0][2] == pytest.approx(knee, abs=1e-7)
    run = simulate(gait.system, gait.state, cycles=1)
    assert run.ledger["released"][0] == pytest.approx(released, abs=1e-6)
    assert abs(run.ledger.residual[0]) < 1e-8
    lift_off = run.named("lift_off")[0]
    k, rest = 48.84, run.q[0, 2] * (1 - second / (48.84 + second))
    lost = (k * (lift_off.q[2] - rest) - second * rest) ** 2 / (2 * (k + second))
    assert lift_off.work["released"] == pytest.approx(-lost, rel=1e-6)


def test_a_switch_that_releases_after_a_time_in_flight():
    """The time runs on where stance ends; multipliers hold only if lift-off's own derivative goes into it."""
    law = replace(LAW, stance_torque=7.826188)
    gait = find_gait(hopping(LEG, law, Spring(clutch=Clutch(hold=0.38))))
    q, v = gait.state
    assert (q[1], q[2], v[2]) == pytest.approx((0.510928, 0.973801, 5.407394), abs=1e-6)
    np.testing.assert_allclose(gait.multipliers[:2], (-0.402144, 0.119012 + 0.141165j), atol=1e-6)
    run = simulate(gait.system, gait.state, cycles=1)
    (release,) = run.named("switch:knee")
    assert (release.domain, release.time) == ("flight", pytest.approx(0.38, abs=1e-12))
    assert abs(run.ledger.residual[0]) < 1e-8


def test_a_switch_that_releases_after_a_time_is_open_where_a_run_begins_in_the_air():
    system = hopping(LEG, LAW, Spring(clutch=Clutch(hold=0.38)))
    q, v = system.guess()
    run = simulate(system, (q + 0.05 * np.eye(3)[1], 0.0 * v), cycles=1)
    landings, (release, *_) = (*run.named("touchdown"), *run.named("retouch")), run.named("switch:knee")
    assert not run.engaged[run.t < landings[0].time].any()
    assert min(abs(release.time - landing.time - 0.38) for landing in landings) < 1e-12


class TestSlip:
    """Of a clutch that slips a little below the greatest pull of the plain spring's hop, 35.944 N·m."""

    @pytest.fixture(scope="class")
    @classmethod
    def gait(cls):
        law = replace(LAW, stance_torque=7.826188)
        plain = find_gait(hopping(LEG, law, Spring()))
        return find_gait(hopping(LEG, law, Spring(clutch=Clutch(slip=35.8))), guess=plain.state, rtol=1e-12)

    def test_hop_is_that_of_another_program(self, gait):
        q, v = gait.state
        assert (q[1], q[2], v[2]) == pytest.approx((0.5058190, 0.9619703, 5.4289764), abs=5e-8)
        np.testing.assert_allclose(gait.multipliers, (-0.558991, -0.483449, 0.0), atol=5e-7)

    def test_clutch_takes_the_work_of_a_constant_pull_and_the_spring_rests_behind(self, gait):
        run = simulate(gait.system, gait.state, cycles=1, rtol=1e-12)
        (begins,), (ends,), (leaves,) = (run.named(name) for name in ("slips:knee", "grips:knee", "lift_off"))
        stretch = 35.8 / 48.84
        assert begins.q[2] - gait.state[0][2] == pytest.approx(stretch, abs=1e-9)
        assert ends.v[2] == pytest.approx(0.0, abs=1e-9)
        assert run.ledger["clutch"][0] == pytest.approx(-35.8 * (ends.q[2] - begins.q[2]), abs=1e-9)
        assert run.ledger["clutch"][0] == pytest.approx(-0.044322, abs=1e-6)
        inside = (run.t > begins.time + 1e-9) & (run.t < ends.time - 1e-9)
        np.testing.assert_allclose(run.spring[inside, run.spring_joints.index("knee")], -35.8, atol=1e-12)
        left = leaves.q[2] - (ends.q[2] - stretch)
        assert leaves.work["released"] == pytest.approx(-0.5 * 48.84 * left**2, abs=1e-9)
        assert abs(run.ledger.residual[0]) < 1e-10

    @pytest.mark.extra("heyoka")
    def test_both_engines_agree(self, gait):
        slips = np.array([35.6, 35.8, 36.5])
        q, v = (np.repeat(part[None], len(slips), axis=0) for part in gait.state)
        lanes = simulate_many(gait.system, q, v, cycles=2, rtol=1e-12, parameters={"slip": slips})
        for i, slip in enumerate(slips):
            run = simulate(with_numbers(gait.system, {"slip": slip}), gait.state, cycles=2, rtol=1e-12)
            assert len(run.named("slips:knee")) == len(run.named("grips:knee")) == (0 if slip > 36.0 else 2)
            np.testing.assert_allclose(lanes.q[i], run.named("touchdown")[-1].q, atol=1e-9)
            np.testing.assert_allclose(lanes.v[i], run.named("touchdown")[-1].v, atol=1e-9)

    @pytest.mark.extra("heyoka")
    def test_a_spring_of_hip_and_knee_rests_behind_too(self, gait):
        path = Joints({"knee": 0.03, "hip": -0.006})
        weak = Spring(1000.0, damping=1.0, path=path, clutch=Clutch(play=0.001, slip=12.0))
        law = replace(LAW, stance_torque=7.826188)
        system = hopping(LEG, law, {"knee": Spring(), "weak": weak})
        run = simulate(system, gait.state, cycles=1, rtol=1e-12)
        (begins,), (ends,), (leaves,) = (run.named(name) for name in ("slips:weak", "grips:weak", "lift_off"))
        engaged, begun, ended, left = (0.03 * q[2] - 0.006 * q[1] for q in (gait.state[0], begins.q, ends.q, leaves.q))
        assert begun - engaged == pytest.approx(0.001 + 0.012, abs=1e-9)
        assert run.ledger["clutch"][0] == pytest.approx(-12.0 * (ended - begun), abs=1e-9)
        knee = 48.84 * max(leaves.q[2] - gait.state[0][2], 0.0) ** 2
        assert leaves.work["released:knee"] == pytest.approx(-0.5 * knee)
        assert leaves.work.get("released:weak", 0.0) == pytest.approx(-500.0 * max(left - ended + 0.012, 0.0) ** 2)
        assert not begins.work and not ends.work and abs(run.ledger.residual[0]) < 1e-10
        lanes = simulate_many(system, *(part[None] for part in gait.state), rtol=1e-12)
        np.testing.assert_allclose(lanes.q[0], run.named("touchdown")[-1].q, atol=1e-9)

    @pytest.mark.extra("heyoka")
    def test_lanes_slip_all_or_none(self, gait):
        q, v = (np.repeat(part[None], 2, axis=0) for part in gait.state)
        with pytest.raises(BadValue, match="in all lanes or in none"):
            simulate_many(gait.system, q, v, parameters={"slip": np.array([0.0, 35.8])})


class TestEdges:
    """Of a switch with delays of 10 and 20 ms, 0.3 s after the phase began; it was engaged at 0.9 rad."""

    SYSTEM = hopping(LEG, LAW, Spring(clutch=Clutch(0.010, 0.020)))
    MOUNT = SYSTEM.of_phase("stance")[0].mounts[0]

    def after(self, kind, on, waits=0.0):
        held = {"knee_on": on, "knee_rest": 0.9, "knee_taut": 1.0, "knee_waits": waits, "due:knee": 0.0}
        clock = Clock(0.3, self.SYSTEM.springs, self.SYSTEM)
        found = after_edges((Edge(kind, self.MOUNT),), held, [0.5, 0.5, 1.1], clock)
        return found["knee_on"], found["knee_rest"], found["knee_waits"], found["due:knee"]

    def test_a_touch_engages_later(self):
        assert self.after(TOUCHES, 0.0) == (0.0, 1.1, 1.0, pytest.approx(0.31))

    def test_a_touch_before_the_release_keeps_it_engaged_where_it_rested(self):
        assert self.after(TOUCHES, 1.0, waits=1.0)[:3] == (1.0, 0.9, 0.0)

    def test_lift_off_releases_later(self):
        assert self.after(LEAVES, 1.0) == (1.0, 0.9, 1.0, pytest.approx(0.32))

    def test_lift_off_before_it_engages_leaves_it_released(self):
        assert self.after(LEAVES, 0.0, waits=1.0)[0::2] == (0.0, 0.0)

    @pytest.mark.parametrize(("on", "rest"), [(0.0, 1.1), (1.0, 0.9)])
    def test_an_event_of_another_leg_leaves_it_waiting(self, on, rest):
        assert self.after(KEEPS, on, waits=1.0) == (on, rest, 1.0, 0.0)

    def test_it_is_open_and_does_not_wait_where_nothing_is_known(self):
        clock = Clock(0.0, self.SYSTEM.springs, self.SYSTEM)
        found = after_edges((Edge(KEEPS, self.MOUNT),), {}, [0.5, 0.5, 1.1], clock)
        assert (found["knee_on"], found["knee_waits"]) == (0.0, 0.0)

    @pytest.mark.parametrize(("on", "rest"), [(0.0, 1.1), (1.0, 0.9)])
    def test_it_acts_once(self, on, rest):
        assert self.after(ACTS, on, waits=1.0)[:3] == (1.0 - on, rest, 0.0)

    def test_its_time_is_counted_from_the_end_of_a_phase(self):
        assert from_now_on({"due:knee": 0.31, "knee_on": 0.0}, 0.3) == {"due:knee": pytest.approx(0.01), "knee_on": 0.0}


def test_numbers_have_units_and_are_kept_in_a_file(tmp_path):
    gait = found(late(0.004, 0.01))
    assert [unit(gait.system, name) for name in ("on_delay", "play", "slip")] == ["s", "rad", "N·m"]
    assert with_numbers(gait.system, {"on_delay": 0.002}).spring.clutch == replace(
        gait.system.spring.clutch, on_delay=0.002
    )
    assert Gait.load(gait.save(tmp_path / "late.json")).system.springs == gait.system.springs


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Clutch(on_delay=-1e-3), "from 0 to 1"),
        (lambda: Clutch(off_delay=2.0), "from 0 to 1"),
        (lambda: Clutch(play=-0.1), "Clutch.play"),
        (lambda: Clutch(play=0.1, pitch=0.1), "play of their own"),
        (lambda: Clutch(pitch=float("nan")), "Clutch.pitch"),
        (lambda: Clutch(tooth=float("inf")), "Clutch.tooth"),
        (lambda: Clutch(second=1.0, pitch=0.05), "keeps the chain taut"),
        (lambda: Clutch(second=-1.0), "Clutch.second"),
        (lambda: Clutch(hold=0.3, on_delay=0.01), "0 with delays"),
        (lambda: Spring(hardening=3.0, clutch=Clutch(second=1.0)), "a stiffness alone"),
        (lambda: Clutch(slip=-1.0), "Clutch.slip"),
        (lambda: Clutch(slip=9.0, pitch=0.05), "0 with teeth"),
        (lambda: Clutch(slip=9.0, second=1.0), "0 with teeth or a second spring"),
        (lambda: Spring(preload=3.0, clutch=Clutch(slip=9.0)), "a stiffness alone"),
        (lambda: Spring(unilateral=False, clutch=Clutch(slip=9.0)), "unless the spring is unilateral"),
        (lambda: Clutch(damper="hip"), "'spring' or 'joint'"),
        (lambda: Spring(rest=0.9, clutch=Clutch()), "never switched"),
        (lambda: series_hopping(SERIES, spring=Spring(unilateral=False, clutch=Clutch())), "Spring.clutch"),
        (lambda: series_hopping(SERIES, spring=Spring(unilateral=False, path=Joints({"knee": 1.0}))), "Spring.path"),
        (lambda: hopping(LEG, replace(LAW, virtual_stiffness=3.0), late(0.004)), "virtual_stiffness"),
    ],
)
def test_what_is_no_switch(make, words):
    with pytest.raises(BadValue, match=words):
        make()
