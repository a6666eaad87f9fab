"""The hopping controller: its laws on symbols and numbers, its options, the measures of a hop."""

import math
from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from spear_pin import Contact, HoppingLaw, Spring, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.hopping import flight_law, stance_law
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.reasons import NUMERICAL
from tests import random_starts

NUMBERS = [field.name for field in fields(HoppingLaw) if field.type != "bool"]
COORDINATES = ("boom_x", "boom_z", "hip", "knee")
HELD = ("knee_touchdown", "taut", "flexing", "compressing", "limited", "speed")

t = sp.Symbol("t", real=True)
q = [sp.Symbol(f"q_{name}", real=True) for name in COORDINATES]
v = [sp.Symbol(f"v_{name}", real=True) for name in COORDINATES]
held = {name: sp.Symbol(f"held_{name}", real=True) for name in HELD}
p = {name: sp.Symbol(f"p_{name}", real=True) for name in NUMBERS}
OPS = SimpleNamespace(sin=sp.sin, cos=sp.cos, tanh=sp.tanh, sqrt=sp.sqrt, maximum=sp.Max)


class SymbolicDynamics:
    """Answers with symbols; the normal force is affine in the torques."""

    at_rest, per_hip, per_knee = sp.symbols("F_0 F_hip F_knee", real=True)
    friction_coefficient = sp.Symbol("mu", positive=True)

    def normal_force(self, toe, u):
        return self.at_rest + self.per_hip * u[0] + self.per_knee * u[1]

    def force(self, toe):
        return sp.symbols("F_x F_z", real=True)

    foot_force = force

    def toe_velocity(self, toe):
        return sp.symbols("v_x v_z", real=True)

    def height(self, frame):
        return sp.Symbol(f"height_{frame}", real=True)

    def pivot(self, toe):
        return sp.Symbol("pivot", real=True)

    def stretch(self, name):
        return sp.Symbol(f"stretch_{name}", real=True)


def law_of_symbols(**changes):
    return HoppingLaw(**{**p, "minimum_force": None, **changes})


def evaluate(law, controller, dyn=None):
    return law(t, q, v, held, controller, dyn or SymbolicDynamics(), OPS)


def assert_equal(actual, expected):
    assert len(actual) == len(expected)
    for one, other in zip(actual, expected, strict=True):
        assert sp.simplify(one - other) == 0


VIRTUAL_SPRING = -p["virtual_stiffness"] * held["taut"] * (q[3] - held["knee_touchdown"])


class TestLawsOnSymbols:
    """They are pure and never branch on a value, so the same text serves numbers, symbols and derivatives."""

    def test_flight(self):
        hip = p["hip_touchdown"] + p["foot_placement"] * (held["speed"] - p["speed"])
        expected = (
            p["hip_gain"] * (hip - q[2]) - p["hip_damping"] * v[2],
            p["knee_gain"] * (p["knee_touchdown"] - q[3]) - p["knee_damping"] * v[3],
        )
        assert_equal(evaluate(flight_law, law_of_symbols()), expected)

    def test_flight_with_the_hip_at_half_the_knee(self):
        law = law_of_symbols(hip_touchdown=None, foot_placement=0)
        hip, _ = evaluate(flight_law, law)
        assert sp.simplify(hip - p["hip_gain"] * (p["knee_touchdown"] / 2 - q[2]) + p["hip_damping"] * v[2]) == 0

    def test_stance(self):
        expected = (p["hip_stance_torque"], p["stance_torque"] * held["flexing"] + VIRTUAL_SPRING)
        assert_equal(evaluate(stance_law, law_of_symbols()), expected)

    def test_stance_with_a_minimum_force(self):
        law = law_of_symbols(minimum_force=p["minimum_force"], virtual_stiffness=0)
        dyn = SymbolicDynamics()
        hip, knee = evaluate(stance_law, law, dyn)
        free, limited = (sp.sympify(knee).subs(held["limited"], value) for value in (0, 1))
        assert sp.simplify(free - p["stance_torque"] * held["flexing"]) == 0
        # 52 N without flexion; it gives the minimum, unless that takes extension, or more flexion than there is
        for unloads, minimum, expected in ((-1, 48, 4), (-2.5, 42, 4), (-1, 40, 7), (-1, 60, 0), (1, 60, 0)):
            values = {dyn.at_rest: 50, dyn.per_hip: 2, dyn.per_knee: unloads, p["hip_stance_torque"]: 1}
            values |= {p["minimum_force"]: minimum, p["stance_torque"]: 7}
            assert float(limited.subs(values)) == pytest.approx(expected, rel=1e-12)
            if expected == 4:
                force = dyn.normal_force("toe", (hip, limited)).subs(values)
                assert float(force) == pytest.approx(minimum, rel=1e-12)

    @pytest.mark.parametrize("law", [flight_law, stance_law])
    def test_as_with_numbers(self, law):
        """The expressions, compiled, give what the law gives for numbers."""
        rng = np.random.default_rng(2)
        symbols = [t, *q, *v, *held.values(), *p.values()]
        compiled = sp.lambdify(symbols, evaluate(law, law_of_symbols()), modules="math")
        for _ in range(20):
            values = dict(zip(symbols, rng.uniform(0.1, 3.0, len(symbols)).tolist(), strict=True))
            controller = HoppingLaw(**{name: values[symbol] for name, symbol in p.items()} | {"minimum_force": None})
            at = [values[s] for s in q], [values[s] for s in v], {name: values[s] for name, s in held.items()}
            numbers = law(values[t], *at, controller, None, SimpleNamespace())
            np.testing.assert_allclose(compiled(*values.values()), numbers, rtol=1e-14)

    @pytest.mark.parametrize("minimum_force", [None, 10.0])
    @pytest.mark.parametrize("locked", [[], ["boom_x"]])
    def test_every_law_and_guard_of_every_domain(self, minimum_force, locked):
        robot = load("spear_ii", locked=locked)
        system = hopping(robot, HoppingLaw(minimum_force=minimum_force))
        n = len(q) - robot.nq
        for domain in system.domains:
            arguments = (t, q[n:], v[n:], held, system.law, SymbolicDynamics(), OPS)
            torques = domain.law(*arguments)
            assert len(torques) == robot.nu
            values = [*torques, *(guard.value(*arguments) for guard in domain.guards)]
            assert all(isinstance(sp.sympify(value), sp.Expr) for value in values)
            assert not any(sp.sympify(value).has(sp.Piecewise, sp.nan) for value in values)

    def test_in_the_simulation(self, hop, hops):
        """Sample by sample, the motor torques are those of the laws."""
        for i in range(0, len(hops.t), 97):
            if hops.phase[i] == "flight":
                expected = flight_law(0.0, hops.q[i], hops.v[i], {"speed": 0.0}, hop.system.law, None, None)
                np.testing.assert_allclose(hops.u[i], expected, rtol=1e-12)


class TestSquareWave:
    def test_hold_extension(self, robot):
        """Standing, where the printed wave would go on."""
        system = hopping(robot, HoppingLaw(stance_torque=0.5, hold_extension=True))
        standing = simulate(system, system.guess())
        (flip,) = standing.named("torque_switch")
        assert flip.time == pytest.approx(0.5 / 2.56, rel=1e-14)
        assert (standing.u[standing.t < flip.time, 1] == 0.5).all()
        assert (standing.u[standing.t > flip.time, 1] == -0.5).all()

    def test_holding_changes_nothing_in_a_stance_shorter_than_the_period(self, hop):
        law = replace(hop.system.law, hold_extension=True)
        held = simulate(hop.system.build(hop.system.robot, law), hop.state, cycles=2)
        free = simulate(hop.system, hop.state, cycles=2)
        np.testing.assert_array_equal(held.q, free.q)

    @pytest.mark.parametrize("frequency", [2.0, 3.0])
    def test_frequency(self, robot, frequency):
        system = hopping(robot, HoppingLaw(frequency=frequency))
        first = simulate(system, system.guess(), max_evaluations=3000).named("torque_switch")[0]
        assert first.time == pytest.approx(0.5 / frequency, rel=1e-14)

    def test_hip_torque_in_stance(self, robot, hop):
        law = replace(hop.system.law, hip_stance_torque=0.3)
        trajectory = simulate(hopping(robot, law), hop.state)
        stance = trajectory.phase == "stance"
        assert (trajectory.u[stance, 0] == 0.3).all() and (trajectory.tau[stance, 0] == 0.3).all()


@pytest.fixture(scope="module")
def limited(hop):
    """The hop with flexion limited so that the ground force stays at 10 N."""
    return hop.system.build(hop.system.robot, replace(hop.system.law, minimum_force=10.0))


class TestMinimumForce:
    @staticmethod
    def flexing(trajectory):
        """Samples of the first half period of each stance."""
        since = np.zeros_like(trajectory.t)
        begin = 0.0
        for i in range(len(since)):
            if trajectory.phase[i] == "stance" and (i == 0 or trajectory.phase[i - 1] != "stance"):
                begin = trajectory.t[i]
            since[i] = trajectory.t[i] - begin
        return (trajectory.phase == "stance") & (since < 0.5 / 2.56 - 1e-9)

    def test_the_nominal_gait_falls_below_it(self, hops):
        assert hops.force[self.flexing(hops), 0, 1].min() < 9.0

    def test_keeps_the_force_while_flexing(self, limited, hop):
        trajectory = simulate(limited, hop.state, cycles=11)
        flexing = self.flexing(trajectory)
        assert trajectory.force[flexing, 0, 1].min() > 10.0 - 1e-6
        assert trajectory.u[flexing, 1].min() < hop.system.law.stance_torque - 1e-3
        assert trajectory.u[flexing, 1].max() == pytest.approx(hop.system.law.stance_torque, rel=1e-9)
        assert np.abs(trajectory.ledger.residual).max() < 1e-8

    def test_counts_the_friction_of_the_joints(self, rubbing_robot, hop):
        """While it is limited the force is just the minimum."""
        law = replace(hop.system.law, minimum_force=10.0)
        trajectory = simulate(hopping(rubbing_robot, law), hop.state, cycles=2)
        flexing = self.flexing(trajectory)
        limited = flexing & (trajectory.u[:, 1] < law.stance_torque - 1e-6)
        assert limited.sum() >= 4
        np.testing.assert_allclose(trajectory.force[limited, 0, 1], 10.0, rtol=0, atol=1e-6)

    def test_leaves_extension_alone(self, limited, hop):
        trajectory = simulate(limited, hop.state, cycles=3)
        assert trajectory.complete
        extending = (trajectory.phase == "stance") & (trajectory.u[:, 1] < 0.0)
        assert extending.any()
        assert (trajectory.u[extending, 1] == -hop.system.law.stance_torque).all()

    @pytest.mark.slow
    def test_hardly_changes_the_gait(self, limited, hop):
        gait = find_gait(limited, vary=["stance_torque"], target={"flight_time": 0.2}, guess=hop.state)
        assert gait.durations["stance"] == pytest.approx(hop.durations["stance"], abs=1e-4)
        assert gait.durations["flight"] == pytest.approx(0.2, abs=1e-9)

    def test_a_limit_that_is_never_reached_changes_nothing(self, hop, hops):
        law = replace(hop.system.law, minimum_force=1.0)
        trajectory = simulate(hop.system.build(hop.system.robot, law), hop.state, cycles=2)
        flexing = self.flexing(trajectory)
        assert (trajectory.u[flexing, 1] == hop.system.law.stance_torque).all()
        np.testing.assert_allclose(
            [e.time for e in trajectory.named("touchdown")], [e.time for e in hops.named("touchdown")[:2]], atol=1e-8
        )

    @pytest.mark.parametrize("seed", [31, 40, 64])
    def test_the_torque_stays_within_that_of_the_motor(self, seed):
        start = random_starts.draw(seed)
        law = HoppingLaw(minimum_force=10.0)
        system = hopping(random_starts.robot(start.free), law, contact=Contact(start.friction))
        trajectory = simulate(system, (start.q, start.v), 2, 1e-8, max_evaluations=5000)
        assert trajectory.reason not in NUMERICAL
        assert np.abs(trajectory.u[trajectory.phase == "stance", 1]).max() <= law.stance_torque * (1 + 1e-9)

    @pytest.mark.slow
    @pytest.mark.parametrize(("seed", "minimum_force"), [(29, 10.0), (55, 1.0), (39, 1.0), (5, 10.0), (11, 10.0)])
    def test_where_sliding_makes_flexion_load_the_toe(self, seed, minimum_force):
        """The force's change with the torque passes zero, and no torque gives the minimum there."""
        start = random_starts.draw(seed)
        law = HoppingLaw(minimum_force=minimum_force)
        system = hopping(random_starts.robot(start.free), law, contact=Contact(start.friction))
        trajectory = simulate(system, (start.q, start.v), 11, 1e-8, max_evaluations=20_000)
        assert trajectory.reason not in NUMERICAL
        assert np.isfinite(trajectory.u).all()

    @pytest.mark.parametrize(("sliding", "limited"), [(-1.0, True), (1.0, False)])
    def test_limits_only_where_flexion_unloads_the_toe(self, sliding, limited):
        """Both below the minimum: 20 N without flexion, less or more with it."""
        system = hopping(random_starts.robot(False), HoppingLaw(minimum_force=40.0))
        (guard,) = (guard for guard in system.of_phase("stance")[0].guards if guard.name == "force_limit")
        dyn = SimpleNamespace(normal_force=lambda toe, u: 20.0 + sliding * u[1])
        held = {"compressing": 1.0, "limited": 0.0, "taut": 1.0, "knee_touchdown": 1.0}
        q = [0.0, 0.0, 1.2]
        value = guard.value(0.0, q, None, held, system.law, dyn, SimpleNamespace(maximum=max))
        assert (value < 0.0) is limited
        back = guard.value(0.0, q, None, {**held, "limited": 1.0}, system.law, dyn, SimpleNamespace(maximum=max))
        assert back == -value

    @pytest.mark.parametrize("seed", [13, 65])
    def test_on_the_switching_surface(self, seed):
        start = random_starts.draw(seed)
        system = hopping(
            random_starts.robot(start.free), HoppingLaw(minimum_force=10.0), contact=Contact(start.friction)
        )
        trajectory = simulate(system, (start.q, start.v), 2, 1e-8, max_evaluations=5000)
        assert trajectory.reason not in NUMERICAL


class TestNominalGait:
    def test_flight_of_two_tenths_of_a_second(self, hop):
        assert hop.durations["flight"] == pytest.approx(0.2, abs=1e-9)
        assert hop.durations["stance"] == pytest.approx(0.364, abs=1e-3)
        assert hop.system.law.stance_torque == pytest.approx(7.83, abs=0.01)
        assert hop.parameters == {"stance_torque": hop.system.law.stance_torque}

    @pytest.mark.slow
    @pytest.mark.parametrize("knee", [0.8, 1.2])
    def test_other_touchdown_angles(self, robot, knee):
        system = hopping(robot, HoppingLaw(knee_touchdown=knee))
        gait = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2})
        assert gait.durations["flight"] == pytest.approx(0.2, abs=1e-9)
        trajectory = simulate(gait.system, gait.state, cycles=2)
        assert trajectory.complete
        assert trajectory.named("touchdown")[0].q[2] == pytest.approx(knee, abs=0.1)
        assert np.abs(trajectory.ledger.residual).max() < 1e-8

    def test_measures(self, hop, hops):
        run = return_map(hop.system, hop.state)
        touchdown = hops.named("touchdown")[0]
        lift_off = hops.named("lift_off")[0]
        expected = {
            "flight_time": touchdown.time - lift_off.time,
            "stance_time": lift_off.time,
            "period": touchdown.time,
            "apex_height": hops.named("apex")[0].q[0],
            "knee_at_touchdown": touchdown.q[2],
            "knee_rate_at_touchdown": touchdown.v_before[2],
            "hip_at_touchdown": touchdown.q[1],
            "hip_rate_at_touchdown": touchdown.v_before[1],
        }
        assert set(expected) <= set(hop.system.measures)
        for name, value in expected.items():
            assert hop.system.measures[name](run) == pytest.approx(value, rel=1e-6), name

    @pytest.mark.parametrize("name", ["hop", "free_hop"])
    def test_every_measure_has_a_value(self, name, request):
        gait = request.getfixturevalue(name)
        run = return_map(gait.system, gait.state)
        for measure in gait.system.measures.values():
            assert math.isfinite(measure(run))

    def test_guess_is_on_the_section(self, robot, free_robot):
        for one in (robot, free_robot):
            position, velocity = hopping(one).guess()
            assert one.toe_position(position, "toe")[1] == pytest.approx(0.0, abs=1e-12)
            np.testing.assert_allclose(one.toe_jacobian(position, "toe") @ velocity, 0.0, atol=1e-12)


class TestRefusals:
    @pytest.mark.parametrize("given", [{"law": Spring()}, {"spring": 48.0}, {"contact": HoppingLaw()}])
    def test_what_is_none(self, given):
        with pytest.raises(BadValue, match=f"^{next(iter(given))} is "):
            hopping(load("spear_ii", locked=["boom_x"]), **given)

    @pytest.mark.parametrize(
        ("field", "value"),
        [
            ("frequency", 0.0),
            ("frequency", -2.56),
            ("frequency", math.nan),
            ("knee_touchdown", math.pi),
            ("knee_touchdown", -4.0),
            ("knee_touchdown", math.nan),
            ("stance_torque", -1.0),
            ("stance_torque", math.inf),
            ("stance_torque", np.float64(-1.0)),
            ("hip_gain", -1.0),
            ("hip_damping", -1.0),
            ("knee_gain", -1.0),
            ("knee_damping", -1.0),
            ("hip_touchdown", math.nan),
            ("hip_stance_torque", math.nan),
            ("foot_placement", math.inf),
            ("speed", math.nan),
            ("minimum_force", math.nan),
            ("minimum_force", -1.0),
        ],
    )
    def test_law(self, field, value):
        with pytest.raises(BadValue, match=rf"^HoppingLaw\.{field} is "):
            HoppingLaw(**{field: value})

    @pytest.mark.parametrize("field", ["stiffness", "damping"])
    @pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
    def test_spring(self, field, value):
        with pytest.raises(BadValue, match=rf"^Spring\.{field} is "):
            Spring(**{field: value})

    def test_a_robot_of_another_kind(self):
        with pytest.raises(BadValue, match="^robot is .*planar"):
            hopping(load("q_spear"))

    def test_a_robot_without_motors(self, tmp_path):
        from spear_pin.model.loading import ROBOTS

        text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
        begin, end = text.index("<transmission"), text.rindex("</transmission>") + len("</transmission>")
        path = tmp_path / "limp.urdf"
        path.write_text(text[:begin] + text[end:], encoding="utf-8")
        with pytest.raises(BadValue, match=r"^robot\.actuated is \(\)"):
            hopping(load(path, toes=["toe"], motors=[]))

    def test_foot_placement_of_a_locked_robot(self, robot):
        with pytest.raises(BadValue, match=r"^HoppingLaw\.foot_placement is 0.1; expected 0 while boom_x is locked"):
            hopping(robot, HoppingLaw(foot_placement=0.1))

    def test_parts_are_those_asked_for(self, robot):
        law, spring, contact = HoppingLaw(stance_torque=1.0), Spring(stiffness=2.0), Contact(friction=3.0)
        system = hopping(robot, law, spring, contact)
        assert (system.law, system.spring, system.contact) == (law, spring, contact)
        again = system.build(robot, law, spring, contact)
        assert (again.law, again.spring, again.contact, again.section) == (law, spring, contact, system.section)
