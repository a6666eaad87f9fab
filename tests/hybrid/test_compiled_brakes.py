"""Brakes in the compiled engine: against the reference engine, differences of gaits found again, and energy."""

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.brakes import Brake, with_brakes
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.structure import Scalars, Structure
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.lanes.groups import Group
from spear_pin.hybrid.lanes.impacts import strike
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.parameters import parameter, unit, with_parameters
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import find_struck_toes
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import chart
from spear_pin.hybrid.strikes import Overlap, strike_toes
from spear_pin.hybrid.tangent.fields import tangent_feet
from spear_pin.hybrid.tangent.resets import differentiate_strike
from spear_pin.hybrid.tangent.section import exact_map
from spear_pin.hybrid.tangent.seeds import numbers, seeds
from spear_pin.model.equations import mechanism_of
from spear_pin.model.feet import find_leading
from spear_pin.model.planar import Planar
from tests.gaits.test_reaching import FIVE, OPENING, geared
from tests.hybrid.test_brakes import AIR, BOTH, HOP, START, braked, without_lift_off
from tests.hybrid.test_heel_and_toe import footed, leg
from tests.hybrid.test_symbolic import OPS


def loaded(t, q, v, held, p, dyn, ops):
    return 120.0 - dyn.force("toe")[-1]


BRAKES = {
    "holds": {"knee": Brake(200.0, (AIR,))},
    "lets go": {"knee": Brake(1.0, (AIR,))},
    "slips": {"knee": Brake(0.7, (AIR,), delay=0.02)},
    "on a path": {"knee": Brake(25.0, (AIR,), BOTH, delay=0.02)},
    "opens": {"knee": Brake(200.0, (AIR,), delay=0.02, until=lambda t, *_: 0.05 - t)},
    "stays open": {"knee": Brake(200.0, (AIR,), until=lambda t, q, v, *_: v[2] + 1.0)},
    "closes late": {"knee": Brake(200.0, (AIR,), BOTH, lambda t, q, v, *_: -v[2], 0.03)},
    "two": {"knee": Brake(2.0, (AIR,), delay=0.02), "hip": Brake(2.0, (AIR,), delay=0.04)},
    "in stance": {"knee": Brake(3.0, ("stance",), when=loaded)},
    "grips at rest": {"knee": Brake(3.0, ("stance",), when=lambda t, q, v, *_: v[2])},
    "lifts the toe": {"hip": Brake(0.3, ("stance",), delay=0.35)},
}


def lands(system, state, cycles=1, rtol=1e-12):
    """State at the last touchdown."""
    event = simulate(system, state, cycles, rtol=rtol).named("touchdown")[-1]
    return np.concatenate([event.q, event.v])


def accelerations(system, state):
    """Mode of the first brake, and accelerations of both engines, at states of a cycle where a brake is closed."""
    parts, joints = (system.law, system.springs, system.ground), system.robot.model.damping.tolist()
    for segment in run(system, state, 1, Options(1e-11, keep=True)).segments:
        if not (rubs := segment.domain.rubs):
            continue
        flow = Flow(system, segment.domain, segment.held)
        for piece in segment.pieces:
            y, n = piece.state(np.array([piece.begin])).ravel(), system.robot.nv
            flow(piece.begin, y)
            motion = Motion(
                system,
                segment.domain,
                Planar(system.robot),
                piece.begin,
                y[:n].tolist(),
                y[n : 2 * n].tolist(),
                segment.held,
                Scalars(*parts, joints, system.brakes),
                OPS,
            )
            yield rubs[0].sign, flow, motion


class TestMotion:
    @pytest.mark.parametrize("name", ["holds", "slips", "on a path", "two", "in stance"])
    def test_accelerates_as_in_the_reference_engine(self, name):
        signs, worst = set(), 0.0
        for sign, flow, motion in accelerations(with_brakes(HOP, BRAKES[name]), START):
            signs.add(sign)
            worst = max(worst, np.abs(np.array(motion.a, float) - flow.a).max())
            if sign == 0:
                assert float(motion.holding("knee")) == pytest.approx(flow.holding("knee"), abs=1e-9)
        assert worst < 1e-10 and signs and (name == "holds") == (signs == {0.0})

    def test_with_loops(self):
        law = HoppingLaw(-0.35, stance_torque=0.7, frequency=5.0, knee_gain=6.0, knee_damping=0.15)
        plain = hopping(load("crank_hopper"), law)
        joint = next(name for name in plain.robot.independent if name in plain.robot.actuated)
        system = with_brakes(plain, {joint: Brake(0.05, (AIR,), delay=0.01)})
        pairs = [(np.array(motion.a, float), flow.a) for _, flow, motion in accelerations(system, plain.guess())]
        assert len(pairs) > 20
        for one, other in pairs:
            np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-10)

    @pytest.mark.parametrize("phase", ["posterior_stance", "flight_1"])
    def test_of_a_law_that_imposes_accelerations(self, phase):
        """A brake keeps the legs from what the law imposes."""
        bound = Gait.load("long_stride")
        system = with_brakes(bound.system, {"posterior_knee": Brake(20.0, (phase,), delay=0.01)})
        pairs = [(np.array(motion.a, float), flow.a) for _, flow, motion in accelerations(system, bound.state)]
        assert len(pairs) > 10
        for one, other in pairs:
            np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-9)


@pytest.mark.extra("heyoka")
class TestLanes:
    @pytest.mark.slow
    @pytest.mark.parametrize("name", BRAKES)
    def test_end_as_in_the_reference_engine(self, name):
        """Many lanes, and one alone."""
        system = with_brakes(HOP, BRAKES[name])
        expected = lands(system, START)
        for n in (1, 20):
            batch = simulate_many(system, *(np.tile(part, (n, 1)) for part in START), rtol=1e-11)
            assert set(batch.reason) == {"complete"} and not batch.repeated.any()
            np.testing.assert_allclose(np.hstack([batch.q, batch.v]), np.tile(expected, (n, 1)), rtol=0, atol=1e-9)

    @pytest.mark.slow
    def test_which_differ_in_the_brake(self):
        """Of one compiled code; some slip, some hold."""
        system, forces, delays = with_brakes(HOP, BRAKES["slips"]), [0.4, 0.7, 50.0], [0.02, 0.03, 0.04]
        given = {"knee.brake_force": forces, "knee.brake_delay": delays}
        batch = simulate_many(system, *(np.tile(part, (3, 1)) for part in START), rtol=1e-11, parameters=given)
        for i in range(3):
            own = with_parameters(system, {name: values[i] for name, values in given.items()})
            assert own.brakes["knee"] == Brake(forces[i], (AIR,), delay=delays[i])
            np.testing.assert_allclose(np.append(batch.q[i], batch.v[i]), lands(own, START), rtol=0, atol=1e-9)

    def test_end_where_no_event_lets_go_of_a_lifted_toe(self):
        system = with_brakes(without_lift_off(HOP), {"knee": Brake(200.0, ("stance",), delay=0.3)})
        for n in (1, 20):
            batch = simulate_many(system, *(np.tile(part, (n, 1)) for part in START))
            assert set(batch.reason) == {"lifted"} and batch.message[0].endswith("(lifts:toe at t = 0.3 s)")

    @pytest.mark.slow
    @pytest.mark.parametrize(("joint", "delay"), [("ankle", 0.12), ("knee", 0.1)])
    def test_of_two_toes(self, tmp_path, joint, delay):
        """Both leave, or none does."""
        plain = footed(leg(tmp_path))
        system = with_brakes(plain, {joint: Brake(5.0, ("flat",), delay=delay)})
        batch, expected = simulate_many(system, *(part[None] for part in plain.guess())), lands(system, plain.guess())
        np.testing.assert_allclose(np.append(batch.q[0], batch.v[0]), expected, rtol=0, atol=1e-9)

    def test_dry_friction_of_other_joints_is_refused(self):
        system = braked(system=with_dry_friction(HOP, {"boom_z": 20.0}))
        with pytest.raises(BadValue, match="^system is 'hopping'; expected one without hardware and dry friction"):
            simulate_many(system, *(part[None] for part in START))


@pytest.mark.extra("heyoka")
class TestImpacts:
    """Of brakes and toes together, against the reference engine's."""

    @staticmethod
    def case(folder):
        """A system, a domain, the event in it at which the ankle's brake grips while two toes are down, and states."""
        system = with_brakes(footed(leg(folder)), {"ankle": Brake(5.0, ("flat",), delay=0.01)})
        domain, rng = system.of_phase("flat")[0], np.random.default_rng(5)
        closes = next(guard.reset for guard in domain.guards if guard.name == "closes:ankle")
        return system, domain, closes, rng.uniform(0.2, 1.0, (8, 4)), rng.uniform(-3.0, 3.0, (8, 4))

    def test_in_lanes(self, tmp_path):
        system, domain, reset, q, v = self.case(tmp_path)
        toes = find_struck_toes(system, domain, reset)
        group = Group(np.arange(8), np.zeros(8), np.concatenate([q.T, v.T]), {})
        struck, left = strike(Numbers(system, {}, Code(1e-12)), toes, reset, group)
        one_by_one = [strike_toes(system, domain, reset, *state, Overlap(0.0), 0.0) for state in zip(q, v, strict=True)]
        assert toes == ["heel", "toe"] and not len(left)
        np.testing.assert_allclose(struck.y[4:].T, [each.v for each in one_by_one], rtol=0, atol=1e-10)
        for toe in toes:
            np.testing.assert_allclose(
                struck.held[rise(toe)], [each.rises[rise(toe)] for each in one_by_one], atol=1e-10
            )

    @pytest.mark.slow
    def test_derivatives(self, tmp_path):
        system, domain, reset, q, v = self.case(tmp_path)
        toes, n, own = tuple(find_struck_toes(system, domain, reset)), 4, numbers(system)
        feet = tangent_feet(Structure(system, domain, {}, mechanism_of(system.robot)), toes, reset.grips)
        leads = find_leading(system.robot.feet, toes)
        for y in np.concatenate([q, v], axis=1):
            given = feet.at(y, own, np.eye(2 * n), np.zeros((len(own), 2 * n)))
            change, slope, _ = differentiate_strike(*given, toes, (), leads, grips=True)

            def after(step, y=y):
                return strike_toes(system, domain, reset, *np.split(y + step, 2), Overlap(0.0), 0.0).v

            np.testing.assert_allclose(y[n:] + change, after(0.0), rtol=0, atol=1e-10)
            steps = 1e-6 * np.eye(2 * n)
            expected = np.array([(after(step) - after(-step)) / 2e-6 for step in steps]).T
            found = np.concatenate([np.zeros((n, n)), np.eye(n)], axis=1) + slope
            np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-7)


@pytest.mark.extra("heyoka")
@pytest.mark.slow
@pytest.mark.parametrize("name", ["slips", "two", "in stance"])
def test_compiled_simulation_keeps_energy(name):
    system = with_brakes(HOP, BRAKES[name])
    last = lands(system, START, rtol=1e-11)  # on the section, which the start is to 1e-8 m
    state = last[:3], last[3:]
    one, other = (simulate(system, state, rtol=1e-10, engine=engine) for engine in ("reference", "compiled"))
    assert [event.name for event in other.events] == [event.name for event in one.events]
    assert abs(other.ledger.residual[0]) < 1e-8 and other.ledger["friction"][0] < -1e-3
    np.testing.assert_allclose(other.ledger.work, one.ledger.work, rtol=0, atol=1e-8)


@pytest.mark.extra("heyoka")
class TestDerivatives:
    NAMES = ("knee.brake_force", "knee.brake_delay")

    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["lets go", "opens", "two", "in stance", "grips at rest", "lifts the toe"])
    def test_of_the_return_map(self, name):
        """Against differences, of fourth order, of the reference engine's."""
        self.check(with_brakes(HOP, BRAKES[name]), START)

    @pytest.mark.slow
    @pytest.mark.parametrize("delay", [0.03, 0.12])
    def test_of_a_toe_that_moves_up_and_down_only(self, tmp_path, delay):
        """It stays down, and is lifted."""
        plain = hopping(geared(tmp_path), FIVE, OPENING)
        self.check(with_brakes(plain, {"front_hip": Brake(0.05, ("stance",), delay=delay)}), plain.guess())

    @staticmethod
    def check(system, start):
        own = next(iter(system.brakes))
        over = [each for each in (f"{own}.brake_force", f"{own}.brake_delay") if parameter(system, each)]
        local, given = chart(system, start), seeds(system, over).numbers
        found, middle = exact_map(system, start, given), lands(system, start)

        def differences(j, h):
            def end(step):
                if j >= local.dimension:
                    each = over[j - local.dimension]
                    return lands(with_parameters(system, {each: parameter(system, each) + step}), start)
                return lands(system, local.state(step * np.eye(local.dimension)[j]))

            return (end(h) - end(-h)) / (2.0 * h)

        columns = [(4.0 * differences(j, 1e-5) - differences(j, 2e-5)) / 3.0 for j in range(found.shape[1])]
        expected = local.changes(middle, np.array(columns).T)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=2e-7)

    @pytest.mark.slow
    def test_of_gaits_found_again(self):
        """The torque that keeps the flight time, and the state on the section."""
        vary, target = ["stance_torque"], {"flight_time": 0.2}
        gait = find_gait(with_brakes(HOP, {"knee": Brake(0.5, (AIR,), delay=0.02)}), vary, target, guess=START)
        table = gait.sensitivity(list(self.NAMES), vary=vary, keep=["flight_time"])
        said = [table.derivatives[each] for each in ("stance_torque", "hip_at_touchdown", "knee_at_touchdown")]

        def again(name, h):
            ends = []
            for step in (h, -h):
                other = with_parameters(gait.system, {name: parameter(gait.system, name) + step})
                found = find_gait(other, vary, target, guess=gait.state, rtol=1e-12)
                ends.append(np.array([found.parameters["stance_torque"], *found.state[0][1:]]))
            return (ends[0] - ends[1]) / (2.0 * h)

        for i, (name, h) in enumerate(zip(self.NAMES, (1e-2, 4e-4), strict=True)):
            expected = (4.0 * again(name, 0.5 * h) - again(name, h)) / 3.0
            np.testing.assert_allclose([each[i] for each in said], expected, rtol=1e-6, atol=1e-8)


def test_numbers_of_brakes_have_units():
    system = with_brakes(HOP, {"knee": Brake(1.0, (AIR,), delay=0.1), "boom_z": Brake(5.0, (AIR,))})
    both = with_brakes(HOP, {"cable": Brake(1.0, (AIR,), BOTH)})
    assert [unit(system, f"{name}.brake_force") for name in ("knee", "boom_z")] == ["N·m", "N"]
    assert unit(both, "cable.brake_force") == "N" and unit(system, "knee.brake_delay") == "s"
