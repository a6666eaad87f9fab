"""The search for the best hop: over a family that is a formula, and the way to a point by small steps."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import simulate
from spear_pin.errors import NoGait
from spear_pin.studies.payoff import Point, leading
from spear_pin.studies.payoff.best_hop import explore
from spear_pin.studies.payoff.cycles import Cycle, Cycles
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.hop_family import HopFamily
from spear_pin.studies.payoff.hopping import TAUT, apart
from spear_pin.studies.payoff.leading import LEAP, STIFFER, Place, begun, led, let_go

BEST = np.array([2.0, 3.0])


class Formula:
    """Cycles with one unknown that the gap gives, x = y₁² / 4, and two that are chosen: a bent valley of the cost.

    Where y₁ + y₂ > brink no cycle closes.
    """

    solved, bounds = 1, np.array([[-np.inf, np.inf], [0.0, 5.0], [0.0, 5.0]])

    def __init__(self, brink=100.0):
        self.brink, self.asked = brink, 0

    def first(self):
        return np.array([0.0625, 0.5, 0.5])

    def at(self, x):
        self.asked += 1
        if x[1] + x[2] > self.brink:
            return None
        noise = 1e-4 * math.sin(1e3 * x.sum())  # of samples
        cost = 1.0 + (x[1] - BEST[0]) ** 2 + 5.0 * (x[2] - BEST[1] - 0.3 * (x[1] - BEST[0]) ** 2) ** 2 + noise
        return Cycle(
            cost, np.array([math.sin(x[0] - 0.25 * x[1] ** 2)]), np.array([self.brink - x[1] - x[2] - 0.1, 1.0])
        )

    def jacobian(self, x, own):
        return np.array([[1.0, -0.5 * x[1], 0.0]])

    def glance(self, x):
        return None


class Derived(Formula):
    """The same, with derivatives where a cycle closes."""

    def glance(self, x):
        if x[1] + x[2] > self.brink:
            return None
        angle = x[0] - 0.25 * x[1] ** 2
        return np.array([math.sin(angle)]), math.cos(angle) * np.array([[1.0, -0.5 * x[1], 0.0]])


class TestSearch:
    @pytest.mark.parametrize("family", [Formula, Derived])
    def test_of_a_bent_valley_with_noise(self, family):
        cycles = family()
        hops = HopFamily(cycles)
        explore(hops, 0.02)
        best = hops.cheapest()[0]
        np.testing.assert_allclose(best.x[1:], BEST, atol=0.1)
        assert best.cycle.cost < 1.01 and best.x[0] == pytest.approx(0.25 * best.x[1] ** 2, abs=2e-4)
        assert cycles.asked < 5 * len(hops.known)

    @pytest.mark.parametrize("family", [Formula, Derived])
    def test_beside_a_brink_beyond_which_there_is_no_hop(self, family):
        hops = HopFamily(family(brink=4.0))
        explore(hops, 0.02)
        best = hops.cheapest()[0]
        assert any(hop is None for hop in hops.known.values())
        along = [Formula(4.0).at(np.array([0.25 * a**2, a, 3.9 - a])).cost for a in np.linspace(0.5, 2.5, 200)]
        assert best.cycle.cost < 1.01 * min(along) and best.cycle.fits

    def test_with_derivatives_one_cycle_is_run_for_a_hop(self):
        """It is run for the cost alone; where it misses what the derivatives say, that is no hop."""
        cycles = Derived()
        hops, before = HopFamily(cycles), cycles.asked
        assert hops.at(hops.start + 0.3).exact and cycles.asked == before + 1
        cycles.at = lambda x: replace(Formula.at(cycles, x), gap=np.array([0.01]))
        assert hops.at(hops.start + 0.5) is None

    def test_from_a_hop_whose_jacobian_was_led_astray(self):
        hops = HopFamily(Formula())
        ((key, first),) = hops.known.items()
        hops.known[key] = replace(first, jacobian=-first.jacobian, exact=False)
        found = hops.at(hops.start + 0.3)
        assert found is not None and found.x[0] == pytest.approx(0.16, abs=2e-4) and hops.known[key].exact

    def test_what_nowhere_keeps_to_its_limits(self):
        cycles = Formula()
        cycles.at = lambda x: replace(Formula().at(x), spare=np.array([-0.5]))
        with pytest.raises(NoGait, match="every hop exceeds a limit, the best one by 50 %"):
            HopFamily(cycles).cheapest()


class TestWay:
    @pytest.fixture
    def way(self, monkeypatch, hop):
        """The points that a way goes by, where there is a hop at each that `there` does not refuse."""

        def goes(point, there=lambda place: True):
            passed = []

            def beside(task, place):
                if not there(place):
                    raise NoGait("it is so", 1.0)
                passed.append(place)
                return place

            monkeypatch.setattr(leading, "_hop", beside)
            end = led(None, Place.of(SWITCHED, hop), point)
            return passed, end

        return goes

    def test_stiffness_and_flight_grow_together_in_small_steps(self, way):
        passed, end = way(Point(SWITCHED, 0.3, 150.0))
        assert len(passed) > 3 and end.point == Point(SWITCHED, 0.3, 150.0)
        assert end.system.spring.stiffness == 150.0 and end.system.law.virtual_stiffness == 0.0
        for one, other in zip(passed, passed[1:], strict=False):
            assert 0.0 < math.log(other.point.speed / one.point.speed) <= LEAP
            assert 0.0 < other.point.stiffness - one.point.stiffness <= STIFFER * one.whole

    def test_the_kind_changes_where_there_is_no_spring(self, way):
        passed, end = way(Point(FIXED, 0.2, 30.0))
        kinds = [place.point.kind for place in passed]
        first = kinds.index(FIXED)
        assert set(kinds[:first]) == {SWITCHED} and set(kinds[first:]) == {FIXED}
        assert passed[first - 1].point.stiffness == passed[first].point.stiffness == 0.0
        assert {round(place.whole, 6) for place in passed} == {48.84}
        assert way(Point(NONE, 0.2))[1].system.law.virtual_stiffness == pytest.approx(48.84)

    def test_steps_that_lead_nowhere_are_halved(self, way):
        last = [48.84]

        def there(place):
            near = abs(place.point.stiffness - last[0]) < 8.0
            last[0] = place.point.stiffness if near else last[0]
            return near

        passed, end = way(Point(SWITCHED, 0.2, 70.0), there)
        assert end.point.stiffness == 70.0 and len(passed) > 2
        with pytest.raises(NoGait, match="it is so"):
            way(Point(SWITCHED, 0.2, 70.0), lambda place: place.point.stiffness < 60.0)

    def test_a_free_stiffness_begins_with_the_one_there_is(self, way):
        spring = way(Point(SWITCHED, 0.2, None))[1].system.spring
        assert spring.stiffness == 48.84 and not spring.unilateral
        fixed = way(Point(FIXED, 0.2, None))[1].system
        assert fixed.spring.rest is not None and let_go(fixed).spring == fixed.spring

    def test_beyond_the_brink_there_are_hops_while_springs_pull(self, hop):
        """A switchable spring is let go, and then this hop's toe stays on the ground."""
        place = begun(Place.of(SWITCHED, hop), Point(SWITCHED, 0.2, 48.84))
        assert let_go(place.system).spring.unilateral


class TestBrinks:
    @pytest.fixture
    def cycle(self, hop):
        return simulate(hop.system, hop.state, progress=False)

    def test_a_hop_is_apart_from_them(self, hop, cycle):
        assert apart(hop.system, cycle).min() > 0.0

    def test_a_knee_that_is_back_before_the_toe_leaves(self, hop, cycle):
        angles = cycle.q.copy()
        last = np.flatnonzero(cycle.phase == "stance")[-1]
        angles[last, 2] = angles[0, 2] - 0.01
        assert apart(hop.system, replace(cycle, q=angles))[1] == pytest.approx(-0.01 - TAUT)

    def test_a_toe_that_bears_nothing_as_it_lands(self, hop, cycle):
        force = cycle.force.copy()
        force[3, 0, 1] = 0.0
        assert apart(hop.system, replace(cycle, force=force))[0] < 0.0

    def test_a_toe_that_only_touches_in_passing(self, hop, cycle):
        """All of the contact may be motion on a switching surface."""
        phase = np.where(cycle.phase == "stance", "chatter", cycle.phase)
        assert (apart(hop.system, replace(cycle, phase=phase)) < 0.0).all()


def test_the_first_hop_goes_along_bounds(monkeypatch):
    """Where the least correction would cross a bound, the other unknowns close the gap."""

    class Line(Cycles):
        solved, units, bounds = 1, np.ones(3), np.array([[-np.inf, np.inf], [0.0, 1.0], [0.0, 9.0]])

        def __init__(self):
            pass

        def glance(self, x):
            return None

        def at(self, x):
            return Cycle(0.0, np.array([0.01 * x[0] + 3.0 * x[1] + x[2] - 6.0]), np.array([1.0]))

    step = Line()._correction(np.array([0.0, 1.0, 1.0]), Line().at(np.array([0.0, 1.0, 1.0])))
    assert step[1] == 0.0 and step[2] == pytest.approx(2.0, rel=1e-3)
