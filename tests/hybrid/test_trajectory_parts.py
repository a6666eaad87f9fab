"""Parts of a trajectory: cycles and phases, with what happened in them."""

import numpy as np
import pytest

from spear_pin import Trajectory
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.trajectory import SAMPLED
from spear_pin.hybrid.trajectory_parts import gaps


class TestCycles:
    def test_has_the_samples_and_the_ledger_of_these_cycles(self, hops):
        part = hops.in_cycles(3, 5)
        rows = (hops.cycle >= 3) & (hops.cycle <= 5)
        for name in SAMPLED:
            np.testing.assert_array_equal(getattr(part, name), getattr(hops, name)[rows])
        assert len(part) == rows.sum() and part.cycles == 3 and not len(gaps(part))
        np.testing.assert_array_equal(part.ledger.work, hops.ledger.work[2:5])
        np.testing.assert_array_equal(part.ledger.residual, hops.ledger.residual[2:5])

    def test_has_the_events_of_these_cycles(self, hops):
        part = hops.in_cycles(4)
        assert len(part.named("apex")) == len(part.named("lift_off")) == 1
        assert part.named("apex")[0] is hops.named("apex")[3]
        assert all(part.t[0] <= event.time <= part.t[-1] for event in part.events)

    def test_all_cycles_are_the_whole(self, hops):
        assert len(hops.in_cycles(1, hops.cycles)) == len(hops)
        assert hops.in_cycles(1, hops.cycles).events == hops.events

    def test_is_saved_and_loaded(self, hops, tmp_path):
        again = Trajectory.load(hops.in_cycles(2).save(tmp_path / "second.npz"))
        assert again.cycles == 1 and set(again.cycle) == {2}

    @pytest.mark.parametrize("cycles", [(0,), (12,), (5, 4), (10, 12)])
    def test_there_are_no_others(self, hops, cycles):
        with pytest.raises(BadValue, match="1 to 11"):
            hops.in_cycles(*cycles)


class TestPhases:
    def test_has_the_samples_of_the_phase_wherever_it_recurs(self, hops):
        flight = hops.in_phase("flight")
        assert set(flight.phase) == {"flight"} and set(flight.cycle) == set(hops.cycle)
        assert np.abs(flight.force).max() < 1e-9
        assert len(gaps(flight)) == hops.cycles - 1
        assert len(flight.named("apex")) == hops.cycles and not flight.named("torque_switch")

    def test_its_ledger_is_empty(self, hops):
        stance = hops.in_phase("stance")
        assert stance.cycles == 0 and stance.ledger.work.shape == (0, len(hops.ledger.flows))

    def test_of_a_cycle(self, hops):
        flight = hops.in_cycles(2).in_phase("flight")
        assert flight.t[-1] - flight.t[0] == pytest.approx(0.2, abs=1e-8) and not len(gaps(flight))

    def test_an_unknown_phase(self, hops):
        with pytest.raises(UnknownName, match="valid: stance, flight"):
            hops.in_phase("fright")


def test_a_whole_has_no_gaps(hops):
    assert not len(gaps(hops))
