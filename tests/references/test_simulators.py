"""The adapters of other simulators read the files alone, and come as near as steps and soft contact allow."""

import importlib
import math

import pytest

from benchmarks.references.stepping import SETTLES, Stepping, runs
from spear_pin.cli.references import SHIPPED
from spear_pin.references.check import compare, read

REFERENCES = read(SHIPPED)
STEP = 1e-3
SIMULATORS = [
    pytest.param("in_mujoco.MuJoCo", marks=pytest.mark.extra("mujoco")),
    pytest.param("in_drake.Drake", marks=pytest.mark.extra("pydrake")),
]


def differences(simulator, name):
    module, called = simulator.split(".")
    maker = getattr(importlib.import_module(f"benchmarks.references.{module}"), called)
    found, others = compare(REFERENCES[name], Stepping(REFERENCES[name], maker(REFERENCES[name], STEP), STEP).run())
    assert not [each for each in others if "touchdown" in each or "lift_off" in each]
    return found


@pytest.mark.parametrize("simulator", SIMULATORS)
class TestSimulator:
    def test_falls_are_off_by_no_more_than_a_step(self, simulator):
        for name in ("block_falls", "leg_falls", "leg_swings"):
            for each in differences(simulator, name):
                assert each.off <= (STEP if each.quantity == "time_s" else 1e-2), str(each)

    @pytest.mark.parametrize("name", ["leg_hops_late", "leg_hops_hardening", "leg_gait", "bound_slow"])
    def test_hops_are_off_by_milliseconds(self, simulator, name):
        found = differences(simulator, name)
        assert max(each.off for each in found if each.quantity == "time_s") < 0.02
        assert max(each.off / each.bound for each in found) > 1e6  # which the references show


class Falling:
    """A block that falls freely and stays where it lands, exactly: what is left is the adapter's own error."""

    def __init__(self, problem, step):
        self.length = step

    def set(self, q, v):
        self.q, self.v = q, v

    def step(self, forces):
        self.q = self.q + self.length * self.v - [0.0, 0.5 * 9.81 * self.length**2]
        self.v = self.v - [0.0, 9.81 * self.length]

    def state(self):
        return self.q, self.v

    def heights(self):
        return {"foot": self.q[1] - 0.1}


@pytest.mark.parametrize("step", [1e-2, 1e-3])
def test_the_adapter_adds_what_interpolation_leaves_out(step):
    (event,) = Stepping(REFERENCES["block_falls"], Falling(None, step), step).run()
    assert abs(event["time_s"] - math.sqrt(2.0 / 9.81)) < step**2
    assert SETTLES > 0.0 and sum(map(runs, REFERENCES.values())) == 18
