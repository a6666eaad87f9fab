"""Derivatives along records of the reference engine: against its own cycles, and against those of the fast engine."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.result import FINEST, Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.tangent import reference_runner
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable

OVER = ("stiffness", "knee_ratio", "hip_to_knee")


def instants(arcs):
    """When something happens in a cycle, and names of what does."""
    found = []
    for arc in arcs:
        if not found or arc.end - found[-1][0] > 1e-9:
            found.append((arc.end, set()))
        found[-1][1].add(arc.event.name)
    return found


@pytest.fixture
def without_heyoka(monkeypatch):
    monkeypatch.setattr(taylor, "available", lambda: False)


@pytest.mark.usefixtures("without_heyoka")
@pytest.mark.parametrize("name", OVER)
def test_states_after_a_hop(hop, name):
    """Against differences of cycles that are run, of fourth order."""
    orbit, value = Orbit(hop.system, hop.state, (name,)), number(hop.system, name)
    assert Recorder(hop.system)._fast is None

    def end(step):
        there = orbit.beside({name: step}, orbit.start[:, -1] * step)
        return np.concatenate(run(there.system, there.state, 1, Options(FINEST)).state)

    h = 2e-4 * value
    expected = (8.0 * (end(h) - end(-h)) - (end(2.0 * h) - end(-2.0 * h))) / (12.0 * h)
    assert orbit.cycle.dy[:, -1] == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())
    names = [(arc.arc.domain.name, arc.arc.event.name) for arc in orbit.cycle.stretches]
    assert names[0] == ("stance", "torque_switch") and names[-1] == ("flight", "touchdown")


@pytest.mark.usefixtures("without_heyoka")
class TestRefused:
    def test_a_cycle_that_does_not_close(self, hop):
        recorder = Recorder(hop.with_law(stance_torque=0.0).system)
        with pytest.raises(NotDifferentiable, match="does not close"):
            recorder.lap(np.concatenate(hop.state))

    def test_a_cycle_of_more_evaluations_than_any_gait_s(self, hop, monkeypatch):
        """A search tries such states, where one cycle may take half a minute."""
        monkeypatch.setattr(reference_runner, "EVALUATIONS", 100)
        with pytest.raises(NotDifferentiable, match="used up its right-hand side evaluations"):
            Recorder(hop.system).lap(np.concatenate(hop.state))

    @pytest.mark.parametrize(
        ("numbers", "q", "v"),
        [
            (
                {"stiffness": 41.0, "knee_ratio": 15.0, "friction": 1.1, "stance_torque": 7.943900986829394},
                (0.5639487416125667, 0.49783450667292883, 0.9606365503168816),
                (-0.739371467372395, 2.538546318312423, 5.031172318217591),
            ),
            (
                {"stiffness": 56.0, "knee_ratio": 24.0, "friction": 0.8, "stance_torque": 9.125033502281795},
                (0.5522556446098152, 0.5137993415258123, 1.0379096791334725),
                (-0.5098093304624398, 1.6114106228297194, 3.232339570942187),
            ),
        ],
    )
    def test_toes_that_alternate(self, hop, numbers, q, v):
        recorder = Recorder(with_numbers(hop.system, numbers))
        with pytest.raises(NotDifferentiable, match="without a derivative: toes alternate"):
            recorder.lap(np.array([*q, *v]))


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(("name", "over"), [("hop", OVER), ("least_effort", ("knee_ratio", "torso_mass"))])
def test_the_same_as_along_records_of_the_fast_engine(hop, monkeypatch, name, over):
    gait = hop if name == "hop" else Gait.load(name)
    fast = Orbit(gait.system, gait.state, over)
    expected, arcs = fast.columns, [each.arc for each in fast.cycle.stretches]
    monkeypatch.setattr(taylor, "available", lambda: False)
    slow = Orbit(gait.system, gait.state, over)
    np.testing.assert_allclose(slow.columns, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    ways = [instants([each.arc for each in slow.cycle.stretches]), instants(arcs)]
    for (end, names), (other, others) in zip(*ways, strict=True):
        assert end == pytest.approx(other, rel=0, abs=1e-11)
        # where a spring lets go as its toe lifts off, rounding chooses whether it does so first
        assert names ^ others <= {"spring_switch"}
    met = {name for (_, a), (_, b) in zip(*ways, strict=True) for name in a | b if len(a | b) > 1}
    for found, wanted in ((slow.measures, fast.measures), (slow.margins, fast.margins)):
        assert list(found) == list(wanted)
        for each in set(found) - met:
            scale = max(np.abs(wanted[each].derivative).max(), 1.0)
            np.testing.assert_allclose(
                found[each].derivative, wanted[each].derivative, rtol=0, atol=1e-8 * scale, err_msg=each
            )
