"""The figures of a hop, against the trajectory they are taken from."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from spear_pin import HoppingLaw, simulate
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.studies.hop import durations, spring_share, summarize


@pytest.fixture(scope="module")
def summary(hop, hops):
    return summarize(hop, hops)


def first_stance(hops):
    return (hops.cycle == 1) & (hops.phase == "stance")


class TestSummary:
    def test_of_the_gait(self, summary, hop):
        assert summary["stance_torque"] == hop.system.law.stance_torque
        assert (summary["knee_touchdown"], summary["frequency"]) == (1.0, 2.56)
        assert (summary["stiffness"], summary["friction"]) == (48.84, 0.8)
        assert summary["flight_time"] + summary["stance_time"] == pytest.approx(summary["period"])
        assert summary["residual"] == hop.residual and summary["stable"] is True
        np.testing.assert_array_equal(summary["multipliers"], hop.multipliers)

    def test_of_the_first_hop(self, summary, hops):
        first = hops.cycle == 1
        assert summary["apex_height"] == pytest.approx(hops.q[first, 0].max(), abs=1e-4)
        assert summary["apex_height"] >= hops.q[first, 0].max() - 1e-9
        assert summary["peak_force"] == pytest.approx(hops.force[first, 0, 1].max(), rel=1e-3)
        assert summary["peak_speed"]["knee"] == pytest.approx(np.abs(hops.v[first, 2]).max(), rel=1e-3)
        assert summary["peak_torque"]["knee"] == pytest.approx(np.abs(hops.u[first, 1]).max(), rel=1e-3)
        compression = hops.q[first_stance(hops), 2].max() - hops.q[0, 2]
        assert summary["peak_compression"] == pytest.approx(compression, rel=1e-3)

    def test_energy(self, summary, hops):
        assert summary["energy_flows"] == {flow: hops.ledger[flow][0] for flow in hops.ledger.flows}
        assert summary["energy_residual"] == np.abs(hops.ledger.residual).max()

    def test_of_the_run(self, summary, hops):
        assert (summary["cycles"], summary["reason"]) == (hops.cycles, hops.reason)

    def test_begun_in_the_air(self, hop, hops, summary):
        """The figures are those of the first whole hop all the same."""
        apex = hops.named("apex")[0]
        other = summarize(hop, simulate(hop.system, (apex.q, apex.v), cycles=2))
        for name in ("apex_height", "peak_force", "peak_compression", "spring_share"):
            assert other[name] == pytest.approx(summary[name], rel=1e-3)

    def test_without_a_whole_hop(self, hop):
        """A motor without torque: the leg stays on the ground."""
        stays = simulate(with_parameters(hop.system, {"stance_torque": 0.0}), hop.state, 2)
        found = summarize(hop, stays)
        assert stays.reason == "no_event" and found["cycles"] == found["retouches"] == 0
        assert found["apex_height"] is found["energy_residual"] is None and found["energy_flows"] == {}
        assert found["peak_force"] > 0.0


class TestDurations:
    def test_of_a_hop_and_of_none(self, hop, hops):
        found = durations(hops)
        assert found.shape == (hops.cycles, 2)
        np.testing.assert_allclose(found[0], [hop.durations["stance"], hop.durations["flight"]], atol=1e-8)
        stays = simulate(with_parameters(hop.system, {"stance_torque": 0.0}), hop.state, 2)
        assert durations(stays).shape == (0, 2)


class TestSpringShare:
    def test_is_the_work_while_the_knee_extends(self, hops):
        pushing = first_stance(hops) & (hops.v[:, 2] < 0)
        rate, t = hops.v[pushing, 2], hops.t[pushing]
        spring = trapezoid(hops.spring[pushing, 0] * rate, t)
        motor = trapezoid(hops.u[pushing, 1] * rate, t)
        assert spring_share(hops) == pytest.approx(spring / (spring + motor), rel=1e-3)
        assert 0.6 < spring_share(hops) < 0.8

    def test_is_what_the_spring_had_stored(self, hops):
        """Less what it still stores at lift-off."""
        compression = hops.q[first_stance(hops), 2].max() - hops.q[0, 2]
        stored = 0.5 * 48.84 * compression**2 + hops.ledger["released"][0]
        pushing = first_stance(hops) & (hops.v[:, 2] < 0)
        motor = trapezoid((hops.u[:, 1] * hops.v[:, 2])[pushing], hops.t[pushing])
        assert spring_share(hops) == pytest.approx(stored / (stored + motor), rel=1e-3)

    def test_without_any_extension(self, hops):
        """Nobody pushes, and nobody has a share in it."""
        assert spring_share(replace(hops, v=np.abs(hops.v))) == 0.0

    def test_a_stiffer_spring_does_more(self, robot, hop, hops):
        stiffer = hop.system.build(robot, HoppingLaw(stance_torque=4.0), hop.system.spring)
        assert spring_share(simulate(stiffer, hop.state)) > spring_share(hops)
