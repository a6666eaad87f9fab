"""The speed at which somebody else's quadruped bounds: the first that has a gait within the limits of its joints."""

from dataclasses import replace

import pytest

from spear_pin import Gait, load, sagittal
from spear_pin.errors import NoGait
from spear_pin.gaits.request import Request
from spear_pin.studies.bound import bound_of
from spear_pin.studies.bound.of_another import SLOWER
from spear_pin.studies.joint_limits import Excess

FULL = Request.scaled(load("q_spear")).speed
TOO_FAST = Excess("anterior_knee", "rate", 12.1, 12.0, "rad/s")


@pytest.fixture(scope="module")
def plane():
    return sagittal(load("q_spear_full"))


@pytest.fixture
def asked(monkeypatch):
    """Speeds that were searched for; of `none` there is no gait, and those of `over` exceed a limit."""
    gait = Gait.load("long_stride")

    class Asked(list):
        none, over = (), ()

    speeds = Asked()

    def search(robot, request):
        speeds.append(pytest.approx(request.speed / FULL))
        if request.speed / FULL in speeds.none:
            raise NoGait("of no avail", 0.1)
        return replace(gait, parameters={"speed": request.speed}), None

    def excesses(robot, trajectory):
        return (TOO_FAST,) if speeds[-1] in speeds.over else ()

    monkeypatch.setattr("spear_pin.studies.bound.of_another.search", search)
    monkeypatch.setattr("spear_pin.studies.joint_limits.excesses", excesses)
    return speeds


def found(plane, *arguments, **wishes):
    """The share of the full speed at which it bounds, and what was said of others."""
    said = []
    gait = bound_of(plane, *arguments, on_attempt=lambda speed, why: said.append((speed / FULL, why)), **wishes)
    return gait.parameters["speed"] / FULL, said


def test_as_fast_as_q_spear(plane, asked):
    assert found(plane) == (1.0, []) and asked == [1.0]


def test_slower_where_there_is_none_and_where_limits_are_not_kept(plane, asked):
    asked.none, asked.over = (1.0,), (0.9,)
    speed, said = found(plane)
    assert speed == pytest.approx(0.8)
    assert [why for _, why in said] == [
        "no gait found: of no avail (best residual 0.1)",
        "rate of the anterior_knee 12.1, its limit 12 rad/s",
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("none", "slowest"), [((), SLOWER[-1]), (SLOWER[-1:], SLOWER[-2])])
def test_the_slowest_where_none_keeps_them(plane, asked, none, slowest):
    asked.none, asked.over = none, SLOWER
    speed, said = found(plane)
    assert speed == pytest.approx(slowest) and len(said) == len(SLOWER) - 1


def test_none_at_all(plane, asked):
    asked.none = SLOWER
    with pytest.raises(NoGait, match="of no avail"):
        found(plane)
    assert asked == list(SLOWER)


def test_limits_that_were_not_asked_for(plane, asked):
    asked.over = SLOWER
    assert found(plane, within_limits=False) == (1.0, [])


def test_a_speed_that_is_given_stays(plane, asked):
    asked.over = (1.0,)
    assert found(plane, FULL) == (1.0, [])
    asked.none = (1.0,)
    with pytest.raises(NoGait, match="of no avail"):
        found(plane, FULL)
