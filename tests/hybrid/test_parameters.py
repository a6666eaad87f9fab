"""Systems that are rebuilt with other numbers keep what was made of them."""

from dataclasses import dataclass, fields, replace

import pytest

from spear_pin import Contact, Gait, find_gait, hopping
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import BoundingLaw
from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.gaits.round_hopping import RoundHoppingLaw
from spear_pin.gaits.series_hopping import SeriesHoppingLaw
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import change_system, find_replaced, number, rebuilt, unit, with_parameters
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.actuator import Actuator
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Gearbox


def low(system):
    """A guard more, which ends the run when the hip sinks below 0.4 m."""
    guard = Guard("low", lambda t, q, v, held, p, dyn, ops: q[0] - 0.4, ends="fall")
    return replace(system, domains=tuple(replace(each, guards=(*each.guards, guard)) for each in system.domains))


def guards(system):
    return [[guard.name for guard in domain.guards] for domain in system.domains]


def test_a_change_stays(hop):
    system = change_system(hop.system, low)
    assert guards(system) == guards(low(hop.system))
    for again in (
        with_parameters(system, {"stance_torque": 7.0, "friction": 0.5}),
        with_parameters(with_parameters(system, {"stance_torque": 7.0}), {"stiffness": 60.0}),
        rebuilt(system, contact=Contact(0.5)),
    ):
        assert guards(again) == guards(system) and again.changes == (low,)


@pytest.mark.slow
def test_a_change_stays_in_a_search(hop):
    gait = find_gait(change_system(hop.system, low), ["stance_torque"], {"flight_time": 0.2}, guess=hop.state)
    assert guards(gait.system) == guards(low(hop.system))
    weaker = gait.with_law(stance_torque=4.0).system
    assert simulate(weaker, gait.state, 10).events[-1].name == "low"


def test_changes_follow_each_other(hop):
    system = with_dry_friction(change_system(hop.system, low), {"boom_z": 1.0})
    again = with_parameters(system, {"stiffness": 60.0})
    assert guards(again) == guards(system)
    assert [domain.name for domain in again.domains] == [domain.name for domain in system.domains]
    assert all("low" in names for names in guards(again))


def test_domains_that_were_replaced_are_not_dropped(hop):
    system = low(hop.system)
    for rebuild in (
        lambda: with_parameters(system, {"stance_torque": 7.0}),
        lambda: find_gait(system, ["stance_torque"], {"flight_time": 0.2}),
        lambda: with_parameters(change_system(system, lambda each: each), {"stance_torque": 7.0}),
    ):
        with pytest.raises(BadValue, match="change_system"):
            rebuild()


def test_fields_that_were_replaced_stay(hop):
    system = replace(hop.system, phase_limit=2.0, shortest_flight=0.1)
    for each in (system, change_system(system, low)):
        again = with_parameters(each, {"stance_torque": 7.0})
        assert (again.phase_limit, again.shortest_flight) == (2.0, 0.1)
        assert find_replaced(again) == {"phase_limit": 2.0, "shortest_flight": 0.1}
    assert find_replaced(hop.system) == {}


def own(robot, law=None, spring=None, contact=None):
    """A builder of one's own, upon another."""
    return replace(low(hopping(robot, law, spring, contact)), build=own)


def test_a_builder_of_ones_own_is_asked(hop):
    system = own(hop.system.robot)
    assert guards(with_parameters(system, {"stance_torque": 7.0})) == guards(system)
    again = with_parameters(change_system(replace(system, phase_limit=2.0), low), {"stance_torque": 7.0})
    assert guards(again) == guards(low(system)) and find_replaced(again) == {"phase_limit": 2.0}


def test_a_builder_of_ones_own_under_the_name_of_another_goes_into_no_file(hop, tmp_path):
    with pytest.raises(BadValue, match="builder"):
        replace(hop, system=own(hop.system.robot)).save(tmp_path / "gait.json")


def test_hardware_and_kind_that_were_replaced_stay(hop):
    hardware = Hardware((Actuator(motor("spear_ii_knee"), Gearbox(15.0)),) * 2)
    again = with_parameters(replace(hop.system, hardware=hardware, kind="mine"), {"stance_torque": 7.0})
    assert again.hardware is hardware and again.kind == "mine"


@pytest.mark.parametrize("law", [HoppingLaw, SeriesHoppingLaw, RoundHoppingLaw, BoundingLaw])
def test_each_number_of_a_law_has_a_unit(law):
    numbers = [field.name for field in fields(law) if field.type in ("float", "float | None")]
    assert sorted(law.units) == sorted(numbers)


def test_units(hop):
    told = {"stance_torque": "N·m", "stiffness": "N·m/rad", "friction": "1", "knee_mass": "kg", "knee_ratio": "1"}
    assert {name: unit(hop.system, name) for name in told} == told
    assert unit(Gait.load("long_stride").system, "flight_1_span") == "m"


def test_a_name_of_two_parts_is_no_number(hop):
    @dataclass(frozen=True)
    class Law(HoppingLaw):
        damping: float = 5.0

    system = replace(hop.system, law=Law(**vars(hop.system.law)))
    with pytest.raises(BadValue, match="'damping'; expected a number of one part, not of law and spring"):
        number(system, "damping")
    assert number(system, "stiffness") == hop.system.spring.stiffness
