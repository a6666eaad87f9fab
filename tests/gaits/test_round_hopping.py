"""HOPPY hops round its post: against its authors' simulator, and against what a circle and a vertical allow."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, Gait, Ground, Spring, continue_gait, find_gait, load, simulate, simulate_many
from spear_pin.errors import BadFile, BadValue
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.round_hopping import RoundHoppingLaw, limb_of, round_hopping
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.singly import find_each
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.tangent.section import exact_jacobian
from spear_pin.studies.round_hop import summarize_round
from spear_pin.studies.sweep import sweep, table
from tests.slow import slow_but

THEIRS = np.array([1.0, 1.0, 1.0, -1.0])  # signs of their q1 to q4
START = np.array([0.0, 0.0, np.pi / 3, np.pi / 2]), np.zeros(4)

# J. Ramos, Y. Ding, Y. Sim, K. Murphy, D. Block, arXiv 2010.14580: their simulator without motor dynamics, from
# q = (0, 0, pi/3, -pi/2) at rest, by DOP853 at 1e-11: time; q1 to q4; their rates
TOUCHDOWN, STRUCK, LIFT_OFF = (
    np.array(
        [
            (0.10751660381189494, -0.0021682033117402673, 0.06281089927854848, 1.2624981887905113, -1.881292479760814)
            + (-0.012665971409172373, 1.0926401473633092, 0.8258121650645692, -0.7161332052122091),
            (0.7768067384003541, -0.3990689115345652, 0.0642046221730522, 0.8872384740262602, -1.793511031369963)
            + (-0.8532156583112376, 2.530935374881216, -0.1030646216812545, 0.04320834029824145),
        ]
    ),
    np.array(
        [
            (0.10751660381189494, -0.0021682033117402673, 0.06281089927854848, 1.2624981887905113, -1.881292479760814)
            + (0.019462373600674928, 1.1248197493683991, 5.307838851756685, -6.665916069545722),
            (0.7768067384003541, -0.3990689115345652, 0.0642046221730522, 0.8872384740262602, -1.793511031369963)
            + (-0.8178809070901285, 2.631165186621082, 13.239475727669923, -16.74789243845069),
        ]
    ),
    np.array(
        [
            (0.31336451250786596, -6.63941455757266e-05, -0.04481450106683138, 0.7163496916637541, -1.1306125715303172)
            + (-0.6202028728105274, -2.2702407680818246, -11.71925520684814, 20.04140876546517),
            (1.0319416092365483, -0.40988658059877175, -0.0005675016985958979, 0.6769264597717533, -1.4022414433377697)
            + (-0.8566828238994609, -2.6200413262226205, -8.181064944214931, 17.105333673545864),
        ]
    ),
)


@pytest.fixture(scope="module")
def hoppy():
    return load("hoppy")


@pytest.fixture(scope="module")
def ideal(hoppy):
    """Without rotors, its motors giving what is commanded."""
    model = hoppy.model.copy()
    model.armature = np.zeros(4)
    return round_hopping(hoppy.with_model(model), RoundHoppingLaw())


@pytest.fixture(scope="module")
def gait(hoppy):
    return find_gait(round_hopping(hoppy))


@pytest.fixture(scope="module")
def published(ideal):
    return simulate(ideal, START, cycles=2, rtol=1e-10)


@pytest.fixture(scope="module")
def hop(gait):
    return simulate(gait.system, gait.state, samples=25)


@pytest.fixture(scope="module")
def slipping(hoppy):
    law = replace(RoundHoppingLaw.driven(hoppy), unlimited_friction=False)
    system = round_hopping(hoppy, law, contact=Contact(friction=0.8))
    return simulate(system, START, cycles=2, samples=25)


def azimuth(robot, q):
    x, y, _ = robot.toe_position(q, "toe")
    return np.arctan2(y, x)


def slopes(function, q, step=1e-6):
    return np.array([(function(q + d) - function(q - d)) / (2 * step) for d in step * np.eye(4)])


class TestPublished:
    @pytest.mark.parametrize(
        ("name", "when", "expected"),
        [("touchdown", "v_before", TOUCHDOWN), ("touchdown", "v", STRUCK), ("lift_off", "v", LIFT_OFF)],
    )
    def test_events(self, published, name, when, expected):
        for event, (time, *state) in zip(published.named(name), expected, strict=False):
            assert event.time == pytest.approx(time, abs=1e-9)
            np.testing.assert_allclose(THEIRS * event.q, state[:4], rtol=0, atol=1e-9)
            np.testing.assert_allclose(THEIRS * getattr(event, when), state[4:], rtol=0, atol=1e-8)

    def test_ledger_closes(self, published):
        np.testing.assert_allclose(published.ledger.residual, 0.0, atol=1e-9)

    @pytest.mark.slow
    def test_it_hops_on_for_ever(self, ideal):
        q, v = np.array([0.0, 0.0651, 0.8232, 1.7686]), np.array([-0.966, 2.7998, 14.13, 18.16])
        found = find_gait(ideal, guess=(q, v))
        assert found.residual < 1e-10 and found.stable
        assert found.period == pytest.approx(0.785681, abs=1e-6)
        np.testing.assert_allclose(found.multipliers, [-0.251345, -0.022057, 0.000417, 0.0], atol=2e-5)


class TestContact:
    def test_a_toe_stays_on_its_ray(self, gait, hop):
        """It neither goes round nor rises, and yields towards the post."""
        places = np.array([gait.system.robot.toe_position(q, "toe") for q in hop.q[hop.phase == "stance"]])
        np.testing.assert_allclose(places[:, 2], 0.0, atol=1e-9)
        np.testing.assert_allclose(np.arctan2(places[:, 1], places[:, 0]), azimuth(gait.system.robot, hop.q[0]), 1e-9)
        assert np.ptp(np.hypot(places[:, 0], places[:, 1])) > 0.01

    @pytest.mark.parametrize("run", ["hop", "slipping"])
    def test_equations_of_motion(self, request, gait, run):
        """Forces act on the toe's azimuth, over its distance, and on its height, told by differences of its place."""
        robot, spring, run = gait.system.robot, gait.system.spring, request.getfixturevalue(run)
        for q, v, a, u, (ahead, up) in zip(run.q, run.v, run.a, run.u, run.force[:, 0], strict=True):
            x, y, _ = robot.toe_position(q, "toe")
            along = np.hypot(x, y) * slopes(lambda q: azimuth(robot, q), q)
            vertical = slopes(lambda q: robot.toe_position(q, "toe")[2], q)
            acting = np.array([0.0, 0.0, *u]) + ahead * along + up * vertical
            acting[3] += spring.torque(q[3] - spring.rest)
            np.testing.assert_allclose(robot.mass_matrix(q) @ a + robot.bias(q, v), acting, atol=1e-7)

    def test_it_takes_off_where_its_force_has_fallen(self, hop):
        assert hop.force[hop.phase == "stance"][-1, 0, 1] == pytest.approx(1.5, abs=1e-9)
        assert not hop.force[hop.phase == "flight"].any()

    def test_impact(self, gait, hop):
        """The rotors take part in it."""
        robot, touch = gait.system.robot, hop.named("touchdown")[0]
        D, J = robot.mass_matrix(touch.q), robot.toe_jacobian(touch.q, "toe")
        np.testing.assert_allclose(J @ touch.v, 0.0, atol=1e-12)
        np.testing.assert_allclose(D @ (touch.v - touch.v_before), J.T @ touch.impulse[0], atol=1e-12)
        lost = 0.5 * (touch.v @ D @ touch.v - touch.v_before @ D @ touch.v_before)
        assert hop.ledger["impact"][0] == pytest.approx(lost) and lost < -0.5


class TestFriction:
    def test_slips_along_the_circle_alone(self, hoppy, slipping):
        """By Coulomb's law; with it the toe goes round while it slides, and towards the post it is as free as ever."""
        seen = set()
        for domain, q, v, a, force in zip(
            slipping.domain, slipping.q, slipping.v, slipping.a, slipping.force[:, 0], strict=True
        ):
            J, drift = hoppy.toe_jacobian(q, "toe"), hoppy.toe_drift(q, v, "toe")
            if domain.startswith("stance"):
                seen.add(domain)
                side = {"stance": 0.0, "stance slip+": 1.0, "stance slip-": -1.0}[domain]
                assert (J @ a + drift)[1] == pytest.approx(0.0, abs=1e-7)
                if side:
                    assert force[0] == pytest.approx(-side * 0.8 * force[1]) and side * (J @ v)[0] > -1e-6
                else:
                    assert (J @ a + drift)[0] == pytest.approx(0.0, abs=1e-7)
                    assert abs(force[0]) <= 0.8 * force[1] + 1e-4
        assert {"stance", "stance slip+"} <= seen
        assert slipping.ledger["slip"].max() < -0.03
        np.testing.assert_allclose(slipping.ledger.residual, 0.0, atol=1e-8)

    @pytest.mark.slow
    def test_it_hops_on(self, slipping, hoppy, tmp_path):
        law = replace(RoundHoppingLaw.driven(hoppy), unlimited_friction=False)
        found = find_gait(round_hopping(hoppy, law, contact=Contact(friction=0.8)))
        assert found.residual < 1e-10 and found.period == pytest.approx(0.6452, abs=1e-4)
        again = Gait.load(found.save(tmp_path / "slips.json"))
        assert len(again.system.domains) == 4 and again.system.contact == Contact(friction=0.8)


class TestGait:
    def test_driven_by_voltage(self, gait):
        assert gait.residual < 1e-10 and gait.stable and len(gait.multipliers) == 4
        assert gait.period == pytest.approx(0.565737, abs=1e-6)
        assert abs(gait.multipliers[0]) == pytest.approx(0.27775, abs=1e-4)
        assert gait.system.measures["mean_speed"](return_map(gait.system, gait.state)) == pytest.approx(
            -0.694, abs=1e-3
        )

    def test_from_anywhere_round_the_post(self, gait):
        q, v = gait.state
        turned = return_map(gait.system, (q + [2.0, 0.0, 0.0, 0.0], v)).state
        here = return_map(gait.system, gait.state).state
        np.testing.assert_allclose(turned[0] - here[0], [2.0, 0.0, 0.0, 0.0], atol=1e-9)
        np.testing.assert_allclose(turned[1], here[1], atol=1e-8)

    def test_it_draws_near_as_its_multipliers_say(self, gait):
        """What is left of a push after three hops, by their moduli."""
        local = chart(gait.system, gait.state)
        pushed = local.state(1e-4 * np.array([1.0, -1.0, 1.0, 1.0]))
        far = [np.linalg.norm(local.coordinates(pushed))]
        for _ in range(5):
            pushed = return_map(gait.system, pushed).state
            far.append(np.linalg.norm(local.coordinates(pushed)))
        assert (far[5] / far[1]) ** 0.25 == pytest.approx(abs(gait.multipliers[0]), rel=0.3)

    @pytest.mark.slow
    def test_a_search_whose_first_hops_land_below_the_ground_by_rounding(self, hoppy):
        """With rotors, and torque as commanded; from the published start this falls."""
        system = round_hopping(hoppy, RoundHoppingLaw())
        assert find_gait(system).period == pytest.approx(0.6777, abs=1e-4)
        assert simulate(system, START, cycles=5).reason == "fall"

    def test_saved_and_read(self, gait, tmp_path):
        again = Gait.load(gait.save(tmp_path / "round.json"))
        assert again.system.kind == "round_hopping" and again.system.law == gait.system.law
        np.testing.assert_array_equal(again.state[0], gait.state[0])
        assert again.system.robot.post == (0.0, 0.0)


class TestDerivatives:
    """They are exact, in the directions round the post as in the plane."""

    @pytest.mark.parametrize("limited", slow_but([False, True], False))
    def test_multipliers_against_differences_of_cycles(self, hoppy, gait, limited):
        if limited:
            law = replace(RoundHoppingLaw.driven(hoppy), unlimited_friction=False)
            gait = find_gait(round_hopping(hoppy, law, contact=Contact(friction=0.8)))
        local, step = chart(gait.system, gait.state), 1e-4
        found = exact_jacobian(gait.system, gait.state)

        def after(xi):
            return local.coordinates(return_map(gait.system, local.state(xi), rtol=1e-12).state)

        for i, row in enumerate(np.eye(local.dimension)):
            one, two = (after(k * step * row) - after(-k * step * row) for k in (1.0, 2.0))
            np.testing.assert_allclose(found[:, i], (8.0 * one - two) / (12.0 * step), rtol=0, atol=2e-8)

    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["stiffness", "toe_damping", "knee_mass", "boom_yaw_inertia_zz"])
    def test_measures_against_gaits_found_again(self, gait, name):
        value, table = number(gait.system, name), gait.sensitivity([name])
        step = 2e-3 * value
        kept = ("period", "stride", "peak_torque_knee", "cost_of_transport", "greatest_height_toe")

        def at(k):
            again = find_gait(with_numbers(gait.system, {name: value + k * step}), guess=gait.state, rtol=1e-12)
            measures = Orbit(again.system, again.state, ()).measures
            return np.array([measures[each].value for each in kept])

        expected = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * step)
        got = np.array([table.derivatives[each][0] for each in kept])
        np.testing.assert_allclose(got, expected, rtol=1e-7)

    def test_measures_against_samples(self, gait):
        motion = simulate(gait.system, gait.state, samples=200)
        samples = Sampled(gait.system.robot, motion).values()
        exact = Orbit(gait.system, gait.state, ()).measures
        assert exact["stride"].value < 0.0 < exact["cost_of_transport"].value  # it goes to the right
        assert exact["stride"].value == pytest.approx(0.556 * exact["turn"].value, rel=1e-12)
        assert {"stride", "mean_speed", "cost_of_transport", "friction_used_toe"} <= set(samples)
        assert samples == pytest.approx({name: exact[name].value for name in samples}, rel=1e-6)
        assert summarize_round(gait, motion)["speed"] == pytest.approx(exact["mean_speed"].value, rel=1e-9)

    @pytest.mark.parametrize("name", ["hip_to_knee", "boom_tilt_to_hip"])
    def test_lengths_that_the_law_has_are_refused(self, gait, name):
        with pytest.raises(BadValue, match="built into the law"):
            gait.sensitivity([name])

    def test_points_without_a_gait_leave_the_others(self, gait):
        system = round_hopping(gait.system.robot, ground=Ground())
        heights = {"height": np.array([0.0, 0.9, 0.0]), "placement": np.array([0.1, 0.1, 0.1])}
        found = find_each(system, heights, (), {}, gait.state, 1e-9)
        assert found.reason.tolist() == ["converged", "not_valid", "converged"]
        assert np.isnan(found.residual).tolist() == [False, True, False]

    @pytest.mark.slow
    def test_a_family(self, gait):
        value = gait.system.spring.stiffness
        found = continue_gait(gait, "stiffness", (0.99 * value, 1.01 * value))
        assert [end.parameter / value for end in found.ends] == pytest.approx([0.99, 1.01])
        assert found.family.differentiable and found.residual.max() < 1e-8

    @pytest.mark.extra("xarray", "zarr", "joblib")
    def test_a_sweep(self, gait, tmp_path):
        values, out = gait.system.spring.stiffness * np.array([0.99, 1.01]), tmp_path / "round.zarr"
        found = table(sweep(gait.system, {"stiffness": values}, out, guess=gait.state, n_jobs=1))
        again = find_gait(with_numbers(gait.system, {"stiffness": values[1]}), guess=gait.state)
        with pytest.raises(BadFile, match="another sweep, which differs in guess"):
            sweep(gait.system, {"stiffness": values}, out, n_jobs=1, resume=True)
        assert found.converged.all() and np.isfinite(found.multipliers).sum(axis=1).tolist() == [4, 4]
        assert found.durations["flight"][1] == pytest.approx(again.durations["flight"], rel=1e-8)


class TestLaw:
    def test_leg(self, hoppy):
        limb, q = limb_of(hoppy), np.array([0.0, 0.0, 0.7, 1.9])
        (x, z), rows = limb.toe(*q[2:], FLOATS)
        hip, toe = hoppy.frame_position(q, "hip"), hoppy.toe_position(q, "toe")
        np.testing.assert_allclose([x, z], (toe - hip)[[0, 2]], atol=1e-15)
        np.testing.assert_allclose(rows, slopes(lambda q: hoppy.toe_position(q, "toe")[[0, 2]], q)[2:].T, atol=1e-9)
        assert limb.reach == 0.556

    def test_back_emf(self, hoppy):
        law = RoundHoppingLaw.driven(hoppy)
        assert law.hip_back_emf == pytest.approx(26.9**2 * 0.0135 * 0.0186 / 1.3)
        assert law.knee_back_emf == pytest.approx(28.8**2 * 0.0135 * 0.0186 / 1.3)
        assert replace(law, hip_back_emf=0.0, knee_back_emf=0.0) == RoundHoppingLaw()

    @pytest.mark.parametrize(
        ("name", "value", "place"),
        [
            ("hip_height", 0.0, "hip_height"),
            ("toe_stiffness", -1.0, "toe_stiffness"),
            ("push_up", (0.0, np.inf), r"push_up\[1\]"),
            ("push_ahead", (), "push_ahead"),
            ("knee_posture", 4.0, "knee_posture"),
            ("placement", np.nan, "placement"),
        ],
    )
    def test_other_numbers(self, name, value, place):
        with pytest.raises(BadValue, match=f"^RoundHoppingLaw.{place} is "):
            RoundHoppingLaw(**{name: value})


class TestBadInput:
    @pytest.mark.parametrize(
        ("name", "locked"), [("hoppy_leg", []), ("q_spear_full", []), ("hoppy", ["hip"]), ("hoppy", ["boom_yaw"])]
    )
    def test_other_robot(self, name, locked):
        with pytest.raises(BadValue, match="^robot is .*load..hoppy"):
            round_hopping(load(name, locked=locked))

    @pytest.mark.parametrize("spring", [Spring(), Spring(rest=0.2), Spring(unilateral=False)])
    def test_other_spring(self, hoppy, spring):
        with pytest.raises(BadValue, match="^spring is "):
            round_hopping(hoppy, spring=spring)

    def test_a_slope(self, hoppy):
        with pytest.raises(BadValue, match="^ground is .*level ground"):
            round_hopping(hoppy, ground=Ground(slope=0.1))

    def test_lanes(self, gait):
        with pytest.raises(BadValue, match="without pinned toes"):
            simulate_many(gait.system, *(part[None] for part in gait.state))


def test_lower_ground(hoppy, gait):
    system = round_hopping(hoppy, ground=Ground(height=-0.01))
    run = simulate(system, system.guess(), cycles=3, rtol=1e-7)
    assert run.t[-1] / 3 == pytest.approx(gait.period, rel=0.1)
    for touch in run.named("touchdown"):
        assert hoppy.toe_position(touch.q, "toe")[2] == pytest.approx(-0.01, abs=1e-7)
