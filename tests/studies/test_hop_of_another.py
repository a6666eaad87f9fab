"""A first hop of somebody else's leg: as asked, beyond a gap, or the cause why there is none."""

from dataclasses import replace

import pytest

from spear_pin import HoppingLaw, Spring, hopping, load, monopod
from spear_pin.errors import BadValue, NoGait
from spear_pin.studies import hop_of_another
from spear_pin.studies.hop_of_another import hop_of
from tests.model.legged import quadruped


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "dog.urdf"
    path.write_text(quadruped(), encoding="utf-8")
    return load(path, base="fixed", motors="all")


def made(whole, *, free=False, body="share", **law):
    leg = monopod(whole, "HR", body, locked=[] if free else ["boom_x"])
    return hopping(leg, replace(HoppingLaw.scaled(leg), **law), Spring.scaled(leg))


@pytest.mark.slow
def test_as_long_as_asked(whole):
    gait = hop_of(made(whole), 0.18)
    assert gait.durations["flight"] == pytest.approx(0.18, abs=1e-8) and gait.stable


@pytest.mark.slow
def test_beyond_a_gap(whole):
    gait = hop_of(made(whole), 0.16)
    assert gait.durations["flight"] == pytest.approx(1.15 * 0.16, abs=1e-8)


@pytest.mark.slow
def test_stays_where_it_is(whole):
    gait = hop_of(made(whole, free=True), 0.18)
    assert set(gait.parameters) == {"stance_torque", "hip_touchdown"}
    assert gait.system.measures["mean_speed"] and abs(gait.state[0][0]) < 1e-9


@pytest.mark.slow
def test_none(whole):
    with pytest.raises(NoGait) as caught:
        hop_of(made(whole), 0.6)
    assert caught.value.cause == "the nearest flight to 0.6 s is 0.115 s, with 2.26 N·m"
    assert caught.value.remedy.startswith("stance_torque=2.26, with which it flies as long")


@pytest.mark.slow
def test_none_with_any_torque(whole):
    with pytest.raises(NoGait, match="the frequency of 8 Hz is 2.5 times"):
        hop_of(made(whole, frequency=8.0), 0.16)


def test_a_flight_that_closes_no_cycle(whole):
    with pytest.raises(BadValue, match="target flight_time is 0.01"):
        hop_of(made(whole), 0.01)


class TestShorterFlights:
    """Where joints could not keep to their limits, or there is no hop."""

    @pytest.fixture
    def solve(self, monkeypatch, hop):
        """The flight time that is chosen, 1 being the one that is wanted, and what is said."""

        def solve(over, none=()):
            def found(_, time):
                if time in none:
                    raise NoGait("of no avail", 0.1)
                return replace(hop, durations={"flight": time})

            texts, said = iter(over), []
            monkeypatch.setattr(hop_of_another, "_anywhere", found)
            monkeypatch.setattr(hop_of_another, "_beside", found)
            monkeypatch.setattr(hop_of_another, "list_exceeded", lambda gait: next(texts))
            gait = hop_of(hop.system, 1.0, within_limits=True, on_attempt=lambda time, why: said.append((time, why)))
            return gait.durations["flight"], said

        return solve

    def test_the_first_that_keeps_them(self, solve):
        assert solve([""]) == (1.0, [])
        assert solve(["too fast", "too fast", ""]) == (0.8, [(1.0, "too fast")])

    def test_none_keeps_them(self, solve):
        assert solve(["too fast"] * 5) == (1.0, [])

    def test_there_is_no_hop(self, solve):
        assert solve(["too fast", ""], none=(0.9, 0.8)) == (0.65, [(1.0, "too fast")])
