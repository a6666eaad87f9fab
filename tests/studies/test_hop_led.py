"""A hop that is led to numbers with which a search finds none: which numbers in turn, and what ends the way."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from spear_pin import HoppingLaw, Spring, hopping, load, monopod
from spear_pin.errors import NoGait
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.studies import hop_led
from spear_pin.studies.hop_led import LATE, TURNS, lead_hop, usual_hop
from tests.model.legged import quadruped
from tests.model.small_leg import small_leg


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "dog.urdf"
    path.write_text(quadruped(), encoding="utf-8")
    return monopod(load(path, base="fixed", motors="all"), "HR", locked=["boom_x"])


def made(leg, spring=None, **law):
    return hopping(leg, replace(HoppingLaw.scaled(leg), **law), replace(Spring.scaled(leg), **spring or {}))


class Border(SimpleNamespace):
    def __str__(self):
        return self.text


@pytest.fixture
def follow(monkeypatch, hop):
    """Branches that end where `ends` says, by number; what was followed, from where to where, with what kept."""
    asked, ends = [], {}

    def found(system, flight_time):
        if flight_time > 0.5:
            raise NoGait("none so long", 1.0)
        return replace(hop, system=system, durations={"flight": flight_time})

    def branch(gait, over, within, vary, target, *, step, rtol, on_point):
        own = gait.durations["flight"] if over == "flight_time" else parameter(gait.system, over)
        far = max(within, key=lambda value: abs(value - own))
        asked.append((over, round(own, 4), round(far, 4), tuple(vary), dict(target)))
        for value in ends.get(over, ()) if not isinstance(ends.get(over), str) else ():
            on_point(value)
        on_point(far)
        system = gait.system if over == "flight_time" else with_parameters(gait.system, {over: far})
        end = Border(reason="border", text=ends[over]) if isinstance(ends.get(over), str) else Border(reason="range")
        return SimpleNamespace(ends=(end, end), gaits=[replace(gait, system=system)])

    def beside(system, state, solved, wanted):
        return replace(hop, system=system, durations={"flight": wanted.get("flight_time", 0.1)})

    monkeypatch.setattr(hop_led, "hop_of", found)
    monkeypatch.setattr(hop_led, "continue_gait", branch)
    monkeypatch.setattr(hop_led, "gait_beside", beside)
    return asked, ends


class TestWay:
    def test_each_number_in_turn_and_the_torque_last(self, leg, follow):
        asked, _ = follow
        way = lead_hop(made(leg, {"stiffness": 9.0, "damping": 0.0}, frequency=4.0), {"stance_torque": 3.0})
        assert way.gait is not None and way.number == ""
        assert [over for over, *_ in asked] == ["stiffness", "damping", "frequency", "stance_torque"]
        flight = asked[0][-1]["flight_time"]
        assert {tuple(vary) for _, _, _, vary, _ in asked[:3]} == {("stance_torque",)}
        assert [kept for *_, kept in asked] == [{"flight_time": flight}] * 3 + [{}] and asked[3][3] == ()
        assert way.gait.system.spring.stiffness == 9.0 and way.gait.system.law.stance_torque == 3.0

    def test_angles_change_by_turns(self, leg, follow):
        lead_hop(made(leg, knee_touchdown=0.7, hip_touchdown=None), {})
        names = [over for over, *_ in follow[0]]
        assert names == ["knee_touchdown", "hip_touchdown"] * 3 and follow[0][-1][2] == pytest.approx(0.35)

    def test_a_flight_that_no_search_has_is_led_to(self, leg, follow):
        way = lead_hop(made(leg), {"flight_time": 0.6})
        assert [over for over, *_ in follow[0]] == ["flight_time"] and way.gait.durations["flight"] == 0.6

    def test_ends_at_a_border(self, leg, follow):
        follow[1]["stiffness"] = (
            "border, where it ends: [a: b] becomes [c: d]; beyond, the cycle does not close: its end differs from its"
            " start by 1.2"
        )
        way = lead_hop(made(leg, {"stiffness": 9.0, "damping": 0.0}), {})
        assert way.gait is None and (way.number, way.why) == (
            "stiffness",
            "border, where it ends: [a: b] becomes [c: d]",
        )
        assert way.flight_time > 0.1 and way.begun == pytest.approx(Spring.scaled(leg).stiffness)

    def test_ends_where_the_branch_turns_back(self, leg, follow):
        own = Spring.scaled(leg).stiffness
        follow[1]["stiffness"] = (own - 1.0, own - 2.0, own - 1.5)
        way = lead_hop(made(leg, {"stiffness": own - 4.0}), {})
        assert way.why == TURNS and way.reached == pytest.approx(own - 2.0)
        assert way.inside == pytest.approx(own - 2.0 + 0.02 * 2.0)

    def test_ends_in_time(self, leg, follow):
        own = Spring.scaled(leg).stiffness
        follow[1]["stiffness"] = (own - 1.0,)
        assert lead_hop(made(leg, {"stiffness": own - 4.0}), {}, seconds=-1.0).why == LATE

    def test_where_there_is_none_to_begin_with(self, leg, monkeypatch):
        def none(*arguments):
            raise NoGait("none", 1.0)

        monkeypatch.setattr(hop_led, "hop_of", none)
        with pytest.raises(NoGait):
            lead_hop(made(leg), {"flight_time": 0.2})


def test_it_begins_with_spear_ii_s_numbers_on_the_same_kind_of_spring(leg, monkeypatch):
    monkeypatch.setattr(
        HoppingLaw, "scaled", lambda robot, made=HoppingLaw.scaled: replace(made(robot), hip_touchdown=0.0)
    )
    assert usual_hop(made(leg)).law.hip_touchdown == 0.0
    monkeypatch.undo()
    begun = usual_hop(made(leg, {"stiffness": 1.0, "damping": 0.0, "rest": 0.8, "unilateral": False}, frequency=9.0))
    usual = Spring.scaled(leg)
    assert (begun.spring.stiffness, begun.spring.damping) == (usual.stiffness, usual.damping)
    assert begun.spring.rest == 0.8 and begun.law.frequency == HoppingLaw.scaled(leg).frequency
    table = replace(usual, stiffness=0.0, table=((0.0, 0.0), (1.0, 5.0)))
    assert usual_hop(hopping(leg, HoppingLaw.scaled(leg), table)).spring.table == table.table


@pytest.mark.slow
@pytest.mark.extra("heyoka")
def test_of_a_small_leg_with_a_spring_of_6(tmp_path):
    """Hops end before; from the last one on there are some."""
    small = small_leg(tmp_path)
    way = lead_hop(made(small, {"stiffness": 6.0}), {}, seconds=60.0)
    assert way.gait is None and (way.number, way.why) == ("stiffness", TURNS)
    assert way.reached == pytest.approx(6.468, abs=0.01) and way.flight_time == pytest.approx(0.173, abs=1e-3)
    again = lead_hop(made(small, {"stiffness": way.inside}), {"flight_time": way.flight_time}, seconds=60.0)
    assert again.gait is not None and again.gait.residual < 1e-9
    assert again.gait.system.spring.stiffness == pytest.approx(way.inside)
