"""Springs that are not linear, in motion: both engines, the ledger, numbers by name and by lane."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from spear_pin import Gait, HoppingLaw, Spring, find_gait, hopping, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.series_hopping import SERIES, series_hopping
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.parameters import parameter, rebuilt, with_parameters
from spear_pin.hybrid.periodic import residual
from spear_pin.model.loading import load
from tests.hybrid.lanes import around, assert_agree, compiles
from tests.hybrid.motions import balance, stances, terms_of

HARDENING = Spring(40.0, hardening=60.0)
PRELOADED = Spring(30.0, preload=4.0, hardening=20.0)
POINTS = ((0.0, 0.0), (0.05, 1.5), (0.15, 6.0), (0.3, 13.0), (0.6, 40.0))
TABLED = Spring(0.0, table=POINTS)
FALLING = Spring(0.0, table=((0.0, 0.0), (0.1, 12.0), (0.25, 25.0), (0.35, 28.0), (0.7, 25.0)))  # behind the best lever
SPRINGS = [HARDENING, PRELOADED, TABLED, FALLING, Spring(0.0, 1.0, hardening=5.0, preload=2.0, table=POINTS)]
EITHER_WAY = ((-0.5, -30.0), (-0.1, -4.0), (0.0, 0.0), (0.1, 5.0), (0.9, 70.0))
STRAIGHT = Spring(0.0, table=tuple((0.1 * i, 4.884 * i) for i in range(6)))  # as the hop's is


def with_spring(gait, spring):
    return rebuilt(gait.system, spring=spring)


def pull(spring, beyond):
    """Magnitude of the torque, by hand."""
    elastic = spring.stiffness * beyond
    if spring.table:
        curve = PchipInterpolator(*np.transpose(spring.table))
        end = spring.table[-1][0]
        elastic = curve(np.minimum(beyond, end)) + curve(end, 1) * np.maximum(beyond - end, 0.0)
    return np.where(beyond > 0.0, spring.preload + elastic + spring.hardening * beyond**3, 0.0)


class TestReference:
    @pytest.mark.parametrize("spring", SPRINGS)
    def test_hops(self, hop, spring):
        trajectory = simulate(with_spring(hop, spring), hop.state, 3)
        assert trajectory.reason == "complete"
        for part in stances(trajectory):
            beyond = trajectory.q[part, 2] - trajectory.q[part, 2][0]
            clear = np.abs(beyond) > 1e-9
            expected = -pull(spring, beyond)
            np.testing.assert_allclose(trajectory.spring[part, 0][clear], expected[clear], rtol=0, atol=1e-9)
        np.testing.assert_allclose(trajectory.ledger.residual, 0.0, rtol=0, atol=1e-8)
        assert balance(trajectory, terms_of(trajectory)).max() < 1e-8

    def test_a_stop_bears_a_preload_that_the_leg_hardly_loads(self, hop):
        """The torque jumps: the knee passes the latched angle, and the toe leaves the ground in that instant."""
        trajectory = simulate(with_spring(hop, Spring(preload=3.0)), hop.state, 3)
        slack, leaves = trajectory.named("spring_switch"), trajectory.named("lift_off")
        assert [event.time for event in slack] == [event.time for event in leaves]
        np.testing.assert_allclose(trajectory.ledger["released"], 0.0, rtol=0, atol=1e-12)

    @pytest.mark.parametrize(
        ("spring", "reason"),
        [
            pytest.param(Spring(20.0, preload=20.0), "no_cycle", marks=pytest.mark.slow),
            (Spring(0.0, table=((0.0, 0.0), (0.01, 20.0), (0.02, 20.2), (0.6, 32.0))), "no_event"),
        ],
        ids=["a rigid chain", "one that gives"],
    )
    @pytest.mark.slow
    def test_a_leg_that_comes_to_rest_on_its_stop(self, robot, spring, reason):
        """It knocks at it, unless the chain gives."""
        system = hopping(robot, HoppingLaw(stance_torque=0.5), spring)
        q, v = system.guess()
        trajectory = simulate(system, (q, 0.1 * v))
        assert trajectory.reason == reason
        knocks = [event.time for event in trajectory.named("spring_switch")]
        if reason == "no_cycle":
            assert np.mean(np.diff(knocks[-20:])) < 0.1 * np.mean(np.diff(knocks[:20]))
        else:
            assert len(knocks) < 10 and abs(trajectory.v[-1]).max() < 0.1

    @pytest.mark.slow
    @pytest.mark.parametrize("spring", [Spring(80.0, 0.0, hardening=150.0), Spring(80.0, 0.0, preload=6.0)])
    def test_bounds_on_knees_that_flex_either_way(self, spring):
        """The motors give what the springs do not: the motion stays, the springs' torques are their law's."""
        gait = Gait.load("long_stride")
        own, other = (simulate(system, gait.state) for system in (gait.system, with_spring(gait, spring)))
        np.testing.assert_allclose(other.q[-1], own.q[-1], rtol=0, atol=1e-6)
        assert abs(other.ledger.residual).max() < 1e-7
        for j, (joint, side) in enumerate((("posterior_knee", 1.0), ("anterior_knee", -1.0))):
            column = other.coordinates.index(joint)
            engaged = other.engaged[:, j]
            name = joint.removesuffix("_knee")
            latched = next(event for event in other.events if event.name == f"{name}_touchdown").q[column]
            beyond = side * (other.q[:, column] - latched)
            clear = engaged & (beyond > 1e-6)
            assert clear.sum() > 10
            np.testing.assert_allclose(other.spring[clear, j], -side * pull(spring, beyond[clear]), rtol=0, atol=1e-6)

    @pytest.mark.slow
    def test_a_table_of_a_linear_spring_is_one(self, hop, hops):
        trajectory = simulate(with_spring(hop, STRAIGHT), hop.state, 11)
        np.testing.assert_allclose(trajectory.q[-1], hops.q[-1], rtol=0, atol=1e-8)
        np.testing.assert_allclose(trajectory.ledger["released"], hops.ledger["released"], rtol=0, atol=1e-8)

    def test_integration_begins_anew_where_pieces_of_a_table_meet(self, hop):
        """The ledger closes as it does with a linear spring."""
        trajectory = simulate(with_spring(hop, TABLED), hop.state, 3, rtol=1e-10)
        beyond = trajectory.q[:, 2] - trajectory.q[0, 2]
        assert beyond.max() > 0.3  # all pieces but the last were passed
        assert abs(trajectory.ledger.residual).max() < 1e-9

    @pytest.mark.parametrize("law", [{"hardening": 500.0}, {"stiffness": 0.0, "table": EITHER_WAY}])
    def test_in_series(self, law):
        """A spring that pushes, too, does so by the same law."""
        spring = replace(SERIES, **law)
        system = series_hopping(load("spear_ii_series", locked=["boom_x"]), spring=spring)
        trajectory = simulate(system, system.guess(), 2)
        deflection = trajectory.q[:, 3]
        assert deflection.min() < -1e-3 and deflection.max() > 0.1
        if spring.table:
            expected = -PchipInterpolator(*np.transpose(spring.table))(deflection)
        else:
            expected = -48.84 * deflection - 500.0 * deflection**3
        np.testing.assert_allclose(trajectory.spring[:, 0], expected, rtol=0, atol=1e-9)
        assert abs(trajectory.ledger.residual).max() < 1e-7


@compiles
class TestLanes:
    @pytest.mark.parametrize("spring", SPRINGS)
    @pytest.mark.parametrize("spread", [0.01, 0.1])
    def test_hops(self, hop, spring, spread):
        system = with_spring(hop, spring)
        q, v = around(hop, spread, 8)
        found = simulate_many(system, q, v)
        assert not found.repeated.any()
        assert_agree(system, q, v, found)

    def test_in_series(self):
        system = series_hopping(
            load("spear_ii_series", locked=["boom_x"]), spring=replace(SERIES, stiffness=0.0, table=EITHER_WAY)
        )
        q, v = (np.array([part]) for part in system.guess())
        assert_agree(system, q, v, simulate_many(system, q, v))

    def test_a_table_is_compiled_in(self, hop):
        """Another has other code."""
        q, v = around(hop, 0.01, 3)
        for stiffer in (1.0, 1.1):
            system = with_spring(hop, Spring(0.0, table=[(angle, stiffer * torque) for angle, torque in POINTS]))
            assert_agree(system, q, v, simulate_many(system, q, v))

    @pytest.mark.parametrize("spring", [HARDENING, TABLED, Spring(preload=3.0)])
    def test_rests_at_an_angle(self, robot, hop, spring):
        system = hopping(robot, hop.system.law, replace(spring, rest=0.9))
        q, v = around(hop, 0.05, 6)
        assert_agree(system, q, v, simulate_many(system, q, v))

    @pytest.mark.parametrize("name", ["stiffness", "damping", "hardening", "preload"])
    def test_numbers_that_are_zero_but_in_lanes(self, hop, name):
        system = with_parameters(hop.system, {name: 0.0})
        q, v = around(hop, 0.02, 6)
        values = {
            name: np.linspace(0.0, {"stiffness": 60.0, "damping": 1.5, "hardening": 90.0, "preload": 5.0}[name], 6)
        }
        found = simulate_many(system, q, v, parameters=values)
        assert not found.repeated.any()
        assert_agree(system, q, v, found, parameters=values)

    def test_what_is_zero_in_all_lanes_is_not_compiled(self, hop):
        q, v = around(hop, 0.01, 4)
        plain = simulate_many(hop.system, q, v)
        before = taylor.compile_domain.cache_info().misses
        found = simulate_many(hop.system, q, v, parameters={"hardening": np.zeros(4), "preload": np.zeros(4)})
        assert taylor.compile_domain.cache_info().misses == before
        np.testing.assert_array_equal(found.q, plain.q)

    @pytest.mark.slow
    def test_bounds(self):
        gait = Gait.load("long_stride")
        system = with_spring(gait, Spring(80.0, 0.0, preload=6.0))
        q, v = around(gait, 0.003, 3)
        values = {"hardening": np.array([0.0, 50.0, 150.0])}
        found = simulate_many(system, q, v, parameters=values, unroll=False)
        assert_agree(system, q, v, found, tolerance=1e-7, parameters=values)


class TestNumbersByName:
    def test_parameters(self, hop):
        system = with_parameters(hop.system, {"hardening": 30.0, "preload": 2.0})
        assert (system.spring.hardening, system.spring.preload) == (30.0, 2.0)
        assert parameter(system, "hardening") == 30.0
        with pytest.raises(UnknownName, match="unknown parameter 'table'"):
            with_parameters(hop.system, {"table": 1.0})
        with pytest.raises(BadValue, match="^Spring.stiffness is 3.0; expected 0 with a table"):
            with_parameters(with_spring(hop, TABLED), {"stiffness": 3.0})

    @pytest.mark.parametrize(
        ("spring", "vary"),
        [
            (Spring(), "hardening"),
            pytest.param(Spring(), "preload", marks=pytest.mark.slow),
            pytest.param(Spring(hardening=10.0), "stiffness", marks=pytest.mark.slow),
            pytest.param(STRAIGHT, "preload", marks=pytest.mark.slow),
        ],
    )
    @pytest.mark.slow
    def test_found_and_kept_in_a_file(self, hop, tmp_path, spring, vary):
        target = {"flight_time": 0.2, "stance_time": 0.34}
        gait = find_gait(with_spring(hop, spring), ["stance_torque", vary], target, guess=hop.state)
        assert gait.parameters[vary] > 0.0
        assert residual(gait.system, gait.state) <= 1e-9
        again = Gait.load(gait.save(tmp_path / "gait.json"))
        assert again.system.spring == gait.system.spring
        assert residual(again.system, again.state) <= 1e-9


@dataclass(frozen=True)
class Banded(Spring):
    """A spring of one's own, with a dead band."""

    band: float = 0.05

    def torque(self, deflection, ops=np):
        return super().torque(ops.maximum(deflection - self.band, 0.0), ops)

    def energy(self, deflection, ops=np):
        return super().energy(ops.maximum(deflection - self.band, 0.0), ops)


@compiles
def test_springs_of_other_classes_and_fields_are_not_taken_for_each_other(hop):
    """One after the other in one process, each is compiled by itself."""
    q, v = around(hop, 0.01, 2)
    for spring in (Banded(30.0), Banded(30.0, band=0.1), Spring(30.0)):
        system = hopping(hop.system.robot, hop.system.law, spring)
        assert_agree(system, q, v, simulate_many(system, q, v), tolerance=1e-6)
