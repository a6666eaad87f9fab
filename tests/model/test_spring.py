"""The law of the spring; the stiffness of the belt, by hand and by the range that the source's numbers give."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import fixed_quad

from spear_pin.errors import BadValue, RobotWarning
from spear_pin.model.spring import Spring, belt_stiffness, rotational_stiffness
from spear_pin.studies.audit.printed_estimates import BELT, BELT_MODULUS

GOOD = {"modulus": 2.0e6, "area": 3.0e-5, "length": 0.4, "radius": 0.02}


def test_range_for_neoprene():
    low, high = (belt_stiffness(modulus=modulus, **BELT) for modulus in BELT_MODULUS)
    assert low == pytest.approx(0.7256, abs=5e-5)
    assert high == pytest.approx(1.0884, abs=5e-5)


def test_by_hand():
    one_strand = 2.0e6 * 3.0e-5 / 0.4  # E A / L, in N/m
    assert belt_stiffness(**GOOD) == pytest.approx(2 * one_strand * 0.02**2)
    assert belt_stiffness(**GOOD) == pytest.approx(rotational_stiffness(0.0, 0.0, one_strand, 0.02))


@pytest.mark.parametrize(("name", "power"), [("modulus", 1), ("area", 1), ("length", -1), ("radius", 2)])
def test_scales(name, power):
    doubled = belt_stiffness(**GOOD | {name: 2 * GOOD[name]})
    assert doubled == pytest.approx(belt_stiffness(**GOOD) * 2.0**power)


@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf"), "1", None])
@pytest.mark.parametrize("name", GOOD)
def test_bad_values(name, value):
    with pytest.raises(BadValue, match=f"^{name} is "):
        belt_stiffness(**GOOD | {name: value})


@pytest.mark.parametrize("value", [-1.0, 1.1e6, 1e300, float("nan"), float("inf"), "1"])
@pytest.mark.parametrize("name", ["stiffness", "damping", "hardening", "preload", "hysteresis"])
def test_a_spring_that_is_none(name, value):
    with pytest.raises(BadValue, match=f"^Spring.{name} is .*from 0 to 1e[+]06, in N"):
        Spring(**{name: value})


@pytest.mark.parametrize("rest", [None, 0.5])
def test_what_pushes_too_is_not_preloaded(rest):
    with pytest.raises(BadValue, match="^Spring.preload is 2.0; expected 0 for a spring that is not unilateral"):
        Spring(preload=2.0, unilateral=False, rest=rest)
    assert Spring(unilateral=False, rest=rest, hardening=3.0).preload == 0.0


def test_a_spring_may_have_a_symbol():
    assert Spring(stiffness=sp.Symbol("k")).stiffness == sp.Symbol("k")


def test_torque_by_hand():
    spring = Spring(stiffness=40.0, hardening=100.0, preload=3.0)
    assert spring.torque(0.0) == -3.0
    assert spring.torque(0.2) == pytest.approx(-(3.0 + 8.0 + 0.8))
    assert spring.energy(0.2) == pytest.approx(0.6 + 0.8 + 0.04)


@given(st.floats(0.0, 1e3), st.floats(0.0, 1e3), st.floats(0.0, 50.0), st.floats(-2.0, 2.0))
def test_energy_is_the_integral_of_what_it_takes(stiffness, hardening, preload, deflection):
    spring = Spring(stiffness=stiffness, hardening=hardening, preload=preload)
    work, _ = fixed_quad(spring.torque, 0.0, deflection, n=4)  # exact: of degree 3
    assert spring.energy(deflection) == pytest.approx(-work, rel=1e-9, abs=1e-9)


@given(st.floats(0.0, 1e3), st.floats(-2.0, 2.0))
def test_without_the_others_it_is_linear_to_the_last_digit(stiffness, deflection):
    assert Spring(stiffness=stiffness).torque(deflection) == -stiffness * deflection


POINTS = ((0.0, 0.0), (0.1, 4.0), (0.3, 5.0), (0.6, 30.0))


def test_a_table_takes_the_place_of_the_stiffness():
    spring = Spring(0.0, table=POINTS)
    for angle, torque in POINTS:
        assert spring.torque(angle) == pytest.approx(-torque, abs=1e-12)
    both = Spring(0.0, hardening=50.0, preload=2.0, table=POINTS)
    assert both.torque(0.2) == pytest.approx(spring.torque(0.2) - 2.0 - 50.0 * 0.2**3)
    with pytest.raises(BadValue, match="^Spring.stiffness is 48.84; expected 0 with a table"):
        Spring(table=POINTS)


@given(st.floats(-0.1, 0.8))
def test_energy_of_a_table(deflection):
    spring = Spring(0.0, hardening=20.0, preload=1.0, table=POINTS)
    ends = [0.0, *(angle for angle, _ in POINTS if 0.0 < angle < deflection), deflection]
    work = sum(fixed_quad(spring.torque, low, high, n=4)[0] for low, high in pairwise(ends))
    assert spring.energy(deflection) == pytest.approx(-work, rel=1e-9, abs=1e-9)


def test_a_table_on_symbols_and_arrays():
    spring, angle, angles = Spring(0.0, preload=1.0, table=POINTS), sp.Symbol("angle"), np.linspace(-0.1, 0.8, 10)
    torque, energy = (law(angle, SimpleNamespace(maximum=sp.Max)) for law in (spring.torque, spring.energy))
    for value, at_once, stored in zip(angles, spring.torque(angles), spring.energy(angles), strict=True):
        assert float(torque.subs(angle, value)) == pytest.approx(spring.torque(value), abs=1e-12) == at_once
        assert float(energy.subs(angle, value)) == pytest.approx(spring.energy(value), abs=1e-12) == stored


def test_points_of_any_kind_are_kept_as_numbers():
    springs = [Spring(0.0, table=points) for points in (POINTS, [list(point) for point in POINTS], np.array(POINTS))]
    assert len({*springs}) == 1 and springs[0].table == POINTS


@pytest.mark.parametrize(
    "points",
    [
        5,
        "ab",
        ((0.0, 0.0),),
        ((0.0, 0.0), (0.1,)),
        ((0.0, 0.0), (0.2, 1.0), (0.1, 2.0)),
        ((0.0, 0.0), (0.0, 1.0)),
        ((0.0, 0.0), (0.1, 2.0), (0.2, -1.0)),
        ((0.0, 0.0), (0.1, 2.0), (0.1 + 1e-9, 1.0)),
        ((0.0, 1.0), (0.1, 2.0)),
        ((0.1, 0.0), (0.2, 2.0)),
        ((-0.1, -1.0), (0.0, 0.0), (0.2, 2.0)),
        ((0.0, 0.0), (0.1, math.nan)),
        ((0.0, 0.0), (math.inf, 1.0)),
        ((0.0, 0.0), (1e-9, 1.0)),
        tuple((0.01 * i, 0.1 * i) for i in range(31)),
    ],
)
def test_tables_that_are_none(points):
    with pytest.raises(BadValue, match=r"^Spring.table is .* \(rad, N·m\) with rising angles, .* \(0, 0\)"):
        Spring(0.0, table=points)


def test_a_table_may_fall_behind_the_best_lever():
    points = ((0.0, 0.0), (0.3, 6.0), (0.6, 8.0), (0.9, 5.0))
    spring = Spring(0.0, damping=0.0, table=points)
    torques = -spring.torque(np.linspace(0.0, 0.9, 200))
    assert torques.max() == pytest.approx(8.0, abs=1e-3) and (np.diff(torques[:133]) > 0).all()
    assert (np.diff(torques[134:]) < 0).all()
    either = Spring(0.0, unilateral=False, table=((-0.4, -1.0), (-0.2, -3.0), *points))
    assert either.torque(-0.2) == pytest.approx(3.0)
    with pytest.raises(BadValue, match="of its angle's sign"):
        Spring(0.0, unilateral=False, table=((-0.4, 0.5), (-0.2, -3.0), *points))


def test_a_table_of_what_pushes_too():
    either = ((-0.2, -3.0), (0.0, 0.0), (0.2, 2.0))
    assert Spring(0.0, unilateral=False, table=either).torque(-0.2) == pytest.approx(3.0)
    for points in (POINTS, either[:2], ((-0.2, -3.0), (0.1, 0.5), (0.2, 2.0))):
        with pytest.raises(BadValue, match="between the first and the last"):
            Spring(0.0, unilateral=False, table=points)


def test_its_damper_takes_energy():
    spring = Spring(damping=1.5)
    assert spring.drag(2.0) == -3.0 and spring.drag(-2.0) == 3.0


def test_its_law_is_one_of_symbols_too():
    angle, k, hardening, preload = sp.symbols("angle k k_3 tau_0")
    spring = Spring(stiffness=k, hardening=hardening, preload=preload)
    assert sp.expand(spring.torque(angle) + preload + k * angle + hardening * angle**3) == 0
    assert sp.expand(sp.diff(spring.energy(angle), angle) + spring.torque(angle)) == 0


def test_its_law_is_one_of_arrays_too():
    spring, angles = Spring(hardening=50.0, preload=1.0), np.linspace(-0.5, 0.5, 5)
    np.testing.assert_array_equal(spring.torque(angles), [spring.torque(float(angle)) for angle in angles])


class TestBranches:
    STRETCH = np.linspace(0.0, 0.5, 11)

    def branches(self, width):
        """Both branches about a hardening mean; they meet where the spring was stretched most."""
        mean = 40.0 * self.STRETCH + 30.0 * self.STRETCH**3
        up, down = mean + width, mean - width
        up[0] = down[0] = 0.0
        down[-1] = up[-1]
        return [[*zip(self.STRETCH, pull, strict=True)] for pull in (up, down)]

    def test_of_an_even_loop_are_mean_and_hysteresis(self, recwarn):
        """The loop closes over its first and last tenth, so that a tenth of its energy is missing."""
        spring = Spring.from_branches(*self.branches(1.5), damping=0.2)
        assert spring.hysteresis == pytest.approx(0.9 * 1.5) and spring.damping == 0.2 and not recwarn.list
        mean = 40.0 * self.STRETCH + 30.0 * self.STRETCH**3
        mean[-1] += 1.5
        np.testing.assert_allclose(spring.table, np.column_stack([self.STRETCH, mean]), atol=1e-12)

    def test_of_an_uneven_loop_take_its_energy(self):
        """By trapezoids between all points, wherever the branches were measured."""
        width = 1.0 + self.STRETCH
        up, down = self.branches(width)
        with pytest.warns(RobotWarning, match="is 1.05 to 1.45, inside its ends; the spring's hysteresis is 1.125"):
            spring = Spring.from_branches(up, down)
        (x, high), (_, low) = np.array(up).T, np.array(down).T
        assert 2.0 * spring.hysteresis * x[-1] == pytest.approx(np.trapezoid(high - low, x))

    @pytest.mark.parametrize("apart", [0.0, 1e-9])
    def test_whose_branches_meet_are_those_that_hardly_do(self, apart):
        spring = Spring.from_branches([(0, 0), (0.1, 3), (0.2, 10)], [(0, 0), (0.1, 1), (0.2, 10 - apart)])
        np.testing.assert_allclose(spring.table, [(0, 0), (0.1, 2), (0.2, 10)])
        assert spring.hysteresis == pytest.approx(0.5)

    def test_of_branches_at_other_stretches_and_of_other_ends(self):
        said = "goes to a stretch of 0.5, unloading to 0.4: what is beyond 0.4 makes no"
        with pytest.warns(RobotWarning) as warned:
            spring = Spring.from_branches([(0, 0), (0.1, 5), (0.3, 12.6), (0.5, 21)], [(0, 0), (0.2, 7), (0.4, 15)])
        assert said in str(warned[0].message) and "is 0.75 to 0.9" in str(warned[1].message)
        np.testing.assert_allclose(spring.table, [(0.0, 0.0), (0.1, 4.25), (0.3, 11.8), (0.4, 15.9)])
        assert spring.hysteresis == pytest.approx(0.725)

    @pytest.mark.parametrize(
        ("loading", "unloading", "why"),
        [
            ([(0.1, 1), (0.2, 2)], [(0, 0), (0.2, 1)], "loading is .* expected points"),
            ([(0, 0), (0.2, 2)], [(0, 0), (0.2, 1), (0.2, 2)], "unloading is .* with rising δ"),
            ([(0, 0), (0.2, 2)], [(0, 0), (0.2, 2)], "apart from that of loading"),
            ([(0, 0), (0.2, 2)], [(0, 0), (0.2, 3)], "loading is .*; expected pulls above those of unloading"),
            ("ab", 3, "loading is 'ab'"),
        ],
    )
    def test_that_are_none(self, loading, unloading, why):
        with pytest.raises(BadValue, match=why):
            Spring.from_branches(loading, unloading)

    @pytest.mark.parametrize("field", [{"table": ()}, {"hysteresis": 0.5}])
    def test_take_no_other_table_or_hysteresis(self, field):
        with pytest.raises(BadValue, match=f"^{next(iter(field))} is .*; expected to be left out"):
            Spring.from_branches(*self.branches(1.5), **field)
