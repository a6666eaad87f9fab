"""Failure that teaches: the cause of a hop that is not found, one thing to try, and what it costs to be told."""

from dataclasses import dataclass, replace

import pytest

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load, monopod
from spear_pin.errors import NoGait
from spear_pin.gaits import attempts
from spear_pin.gaits.diagnosis import Reached, diagnosis, explain_failure
from spear_pin.model.loading import ROBOTS
from tests.model.legged import quadruped

FLIGHT = {"flight_time": 0.16}


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "dog.urdf"
    path.write_text(quadruped(), encoding="utf-8")
    return monopod(load(path, base="fixed", motors="all"), "HR", locked=["boom_x"])


def hop(leg, law=(), spring=(), **options):
    return hopping(
        leg, replace(HoppingLaw.scaled(leg), **dict(law)), replace(Spring.scaled(leg), **dict(spring)), **options
    )


@pytest.mark.parametrize(
    ("law", "spring", "cause", "remedy"),
    [
        ({"knee_touchdown": -1.0}, {}, "the knee lands at -1 rad", "knee_touchdown=1"),
        ({"hip_touchdown": -0.5}, {}, "the toe lands 0.3 m behind the hip", "hip_touchdown=0.527"),
        ({"frequency": 8.0}, {}, "the frequency of 8 Hz is 2.5 times SPEAR-II's, scaled to this leg", "frequency=3.23"),
        ({}, {"stiffness": 60.0}, "the stiffness of 60 N·m/rad is 4.3 times", "stiffness=13.8"),
        ({}, {"damping": 1.3}, "the damping of the spring of 1.3 N·m·s/rad is 4.5 times", "damping=0.292"),
        ({"stance_torque": 0.0}, {}, "the stance torque of 0 N·m is far from SPEAR-II's", "stance_torque=2.26"),
    ],
    ids=str,
)
def test_what_is_wrong_with_the_numbers(leg, law, spring, cause, remedy):
    found = diagnosis(hop(leg, law, spring), ["stance_torque"], FLIGHT)
    assert found.cause.startswith(cause) and found.remedy.startswith(remedy)


@pytest.mark.parametrize(("joint", "word"), [("knee", "the knee 'knee' flexes"), ("hip", "the axis of the hip 'hip'")])
def test_a_joint_that_turns_the_other_way(tmp_path, joint, word):
    """Of a robot that is made like SPEAR-II, and not cut out of another."""
    text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
    begin = text.index("<axis", text.index(f'<joint name="{joint}"'))
    end = text.index("/>", begin)
    axis = [-float(part) or 0.0 for part in text[begin:end].split('"')[1].split()]
    path = tmp_path / "turned.urdf"
    path.write_text(f'{text[:begin]}<axis xyz="{" ".join(map(str, axis))}"{text[end:]}', encoding="utf-8")
    found = diagnosis(hopping(load(path, toes=["toe"], locked=["boom_x"])), [], {})
    assert found.cause.startswith(word) and found.remedy.startswith("monopod(robot, ")


@pytest.mark.slow
def test_a_flight_in_the_gap(leg):
    """Flights that a longer stance would need end where the square wave turns back; longer ones there are."""
    with pytest.raises(NoGait) as caught:
        find_gait(hop(leg), ["stance_torque"], FLIGHT)
    assert "the square wave turns back after its 0.31 s and ends stance" in caught.value.cause
    assert caught.value.remedy == "a flight time of 0.2 s"
    assert f"; {caught.value.cause}; try {caught.value.remedy}" in str(caught.value)
    assert find_gait(hop(leg), ["stance_torque"], {"flight_time": 0.2}).stable


def test_a_torque_over_the_limit(leg):
    heavy = monopod(leg.cut.robot, "HR", 60.0, locked=["boom_x"])
    found = diagnosis(hop(heavy), [], {})
    assert found.cause == "the stance torque is 45.3 N·m, 1.5 times the knee's limit"
    assert found.remedy == "stance_torque=30"


@pytest.mark.slow
def test_where_a_continuation_ended(leg):
    gait = find_gait(hop(leg, {"stance_torque": 3.2}))
    reached = Reached(0.5, gait.system, gait.state)
    found = diagnosis(gait.system, ["stance_torque"], {"flight_time": 0.3}, reached)
    assert found.cause == f"flights towards 0.3 s end at {gait.durations['flight']:.3g} s, with 3.2 N·m"
    assert found.remedy.startswith("stance_torque=3.2,")


def test_other_systems_keep_their_failure(leg):
    failure = NoGait("nothing", 0.1)
    assert explain_failure(failure, replace(hop(leg), kind="running"), [], {}) is failure
    again = explain_failure(failure, hop(leg, {"frequency": 8.0}), [], {})
    assert (again.reason, again.residual) == ("nothing", 0.1) and again.cause and again.remedy


def test_a_law_of_ones_own_keeps_its_failure(leg):
    """It need not use what the remedies name."""
    failure, system = NoGait("nothing", 0.1), hop(leg, {"frequency": 8.0})
    stance = next(domain for domain in system.domains if domain.phase == "stance")
    own = replace(stance, law=lambda t, q, v, held, p, dyn, ops: (0.0, 5.0))
    domains = tuple(own if domain is stance else domain for domain in system.domains)
    assert explain_failure(failure, replace(system, domains=domains), [], {}) is failure


@pytest.mark.slow
def test_is_told_soon(monkeypatch, leg):
    """A spring of this size with SPEAR-II's damper took 23 s to fail; evaluations do not depend on the machine."""
    spent = []

    def counted(*arguments):
        result = run(*arguments)
        spent.append(result.evaluations)
        return result

    run = attempts.return_map
    monkeypatch.setattr(attempts, "return_map", counted)
    for asked in ({}, {"stiffness": 60.0}, {"damping": 1.3}):
        spent.clear()
        with pytest.raises(NoGait):
            find_gait(hop(leg, (), asked), ["stance_torque"], FLIGHT)
        assert sum(spent) < 1.5 * attempts.ENOUGH


def test_a_first_cycle_that_breaks_off_says_why(leg):
    system = hop(leg)
    stance = next(domain for domain in system.domains if domain.phase == "stance")
    idle = replace(stance, law=lambda t, q, v, held, p, dyn, ops: (0.0, 0.0))
    domains = tuple(idle if domain is stance else domain for domain in system.domains)
    with pytest.raises(NoGait, match=r"does not close at the starting point: .*"):
        find_gait(replace(system, domains=domains, phase_limit=1.0))


def test_a_law_that_names_only_its_own_units(leg):
    """As one may that adds numbers to the law."""

    @dataclass(frozen=True)
    class Named(HoppingLaw):
        units = {"extra": "N"}
        extra: float = 1.0

    law = Named(**{**vars(HoppingLaw.scaled(leg)), "frequency": 8.0})
    found = diagnosis(hopping(leg, law, Spring.scaled(leg)), ["stance_torque"], FLIGHT)
    assert found.cause.startswith("the frequency of 8 Hz is 2.5 times")
