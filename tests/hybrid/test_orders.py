"""The order of events is the same by either engine, and is told in a line."""

import numpy as np
import pytest

from spear_pin import simulate_many
from spear_pin.hybrid.automaton import Guard, Reset, Switch
from spear_pin.hybrid.batch import FEW
from spear_pin.hybrid.orders import Happening, find_differing, in_order, make_happening, order_of, write_order
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.hybrid.lanes import refuse_laps

A, B, C = ("stance", "a"), ("stance", "b"), ("flight", "c")


def lanes_of(hop, torques, cycles=2, **options):
    n = len(torques)
    q, v = (np.tile(part, (n, 1)) for part in hop.state)
    return simulate_many(hop.system, q, v, cycles, parameters={"stance_torque": torques}, **options)


@pytest.mark.extra("heyoka")
class TestLanes:
    @pytest.mark.parametrize("torque", [6.5, 7.8, 9.55])
    def test_they_say_what_the_reference_engine_does(self, hop, torque):
        batch = lanes_of(hop, [torque])
        system = with_parameters(hop.system, {"stance_torque": torque})
        assert batch.orders == (order_of(system, run(system, hop.state, 2, Options())),)
        assert batch.orders[0][-1] == ("flight", "touchdown") and ("flight", "apex") not in batch.orders[0]

    def test_also_where_that_has_to_run_them(self, hop, monkeypatch):
        alone = lanes_of(hop, [7.8, 9.55])
        refuse_laps(monkeypatch)
        monkeypatch.setattr(
            "spear_pin.hybrid.lanes.runner.Lanes.enter", lambda self, phase, group, came: self.give_up(group)
        )
        batch = lanes_of(hop, [7.8, 9.55])
        assert batch.repeated.all() and batch.orders == alone.orders

    def test_also_side_by_side(self, hop, monkeypatch):
        alone = lanes_of(hop, [7.8, 8.0])
        refuse_laps(monkeypatch)
        assert lanes_of(hop, [7.8, 8.0]).orders == alone.orders

    def test_of_many_it_is_not_kept(self, hop):
        assert set(lanes_of(hop, np.full(FEW + 1, 7.8)).orders) == {()}


def test_what_latches_in_the_instant_that_ends_a_phase_is_left_out(hop):
    def event(name, time, passes=False, leaves=False):
        return Happening("stance", name, time, passes, leaves)

    slack, off = event("spring_switch", 0.3, passes=True), event("lift_off", 0.3 + 1e-9, leaves=True)
    assert in_order([slack, off]) == (("stance", "lift_off"),)
    assert in_order([slack, off._replace(time=0.3 + 1e-5)]) == (("stance", "spring_switch"), ("stance", "lift_off"))
    assert in_order([event("torque_switch", 0.3), off]) == (("stance", "torque_switch"), ("stance", "lift_off"))


def test_what_passes_and_what_leaves(hop):
    stance = hop.system.domains[0]

    def told(event, reset):
        return make_happening(stance, event, reset, "x", 0.0)[3:]

    latch, leave = Reset(latch=lambda *_: {}), Reset(phase="flight")
    assert told(Guard("x", None, latch), latch) == (True, False)
    assert told(Guard("x", None, leave), leave) == (False, True)
    assert told(Guard("x", None, Reset()), Reset()) == (False, False)
    assert told(Switch("x", None, latch), latch) == (False, False)


def test_it_is_told_by_domain():
    assert write_order((A, B, C)) == "stance: a, b, flight: c"
    assert write_order(()) == ""


@pytest.mark.parametrize(
    ("before", "after", "difference"),
    [
        ((A, B, C), (A, C), ((B,), ())),
        ((A, C), (A, B, C), ((), (B,))),
        ((A, B, C), (B, B, C), ((A,), (B,))),
        ((A, A), (A, A, A), ((), (A,))),
        ((A, B), (A, B), ((), ())),
    ],
)
def test_what_differs_lies_between_what_does_not(before, after, difference):
    assert find_differing(before, after) == difference
