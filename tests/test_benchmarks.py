"""What the benchmark of engines compares computes the same: a lane that is fast and wrong would win."""

import importlib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from benchmarks import beside, others_gaits
from benchmarks.peers import lean_loop, lean_stride, mujoco_native
from benchmarks.peers.task import AGREES, STATES, bound, hop, taylor
from tests.hybrid.by_hand import Hopper

LANES = 8


@pytest.mark.parametrize("name", sorted(path.stem for path in Path(beside.__file__).parent.glob("*.py")))
def test_each_finds_what_it_measures(name):
    """A name that moved is noticed before the night."""
    importlib.import_module(f"benchmarks.{name}")


@cache
def lanes(peer):
    return importlib.import_module(f"benchmarks.peers.{peer}").lanes(hop(LANES))


class TestHop:
    @pytest.mark.slow
    def test_what_is_compared_with_agrees_with_the_lagrangian(self):
        task = hop(LANES)
        by_hand = Hopper(task.gait.system.law.stance_torque)
        for q, v, end in zip(task.q[:2], task.v[:2], task.ends, strict=False):
            np.testing.assert_allclose(by_hand.hop(np.concatenate([q, v])), end, rtol=0, atol=1e-9)

    @pytest.mark.slow
    def test_perturbed_hops_are_not_the_gait(self):
        task = hop(LANES)
        assert (np.abs(task.ends - task.ends[0]).max(axis=1)[1:] > 0.01).all()

    @pytest.mark.slow
    def test_lean(self):
        for lane in lean_loop.lanes(hop(LANES)):
            assert hop(LANES).error(lane.call()) < AGREES

    @pytest.mark.parametrize("number", [1, LANES])
    @pytest.mark.extra("heyoka")
    def test_taylor(self, number):
        lane = taylor(hop(LANES), number, 1e-9)
        assert hop(LANES).error(lane.call()) < AGREES
        assert lane.note() == ""  # none was repeated by the reference engine

    @pytest.mark.extra("mujoco")
    def test_mujoco_with_exact_events(self):
        finest = lanes("mujoco_exact")[-1]
        assert hop(LANES).error(finest.call()) < AGREES

    @pytest.mark.extra("mujoco")
    def test_the_soft_contact_is_seen_not_to_agree(self):
        coarsest = lanes("mujoco_native")[0]
        assert hop(LANES).error(coarsest.call()) > 0.01

    @pytest.mark.extra("pydrake")
    @pytest.mark.filterwarnings("ignore::DeprecationWarning")
    def test_drake(self):
        assert hop(LANES).error(lanes("drake_hop")[-1].call()) < AGREES


class TestBeside:
    @pytest.mark.slow
    def test_here(self):
        found = beside.measured(hop(LANES), beside.here(hop(LANES), 1e-9), rounds=1)
        assert found.energy < 1e-7 and found.touchdown < 1e-8 and found.multipliers < 1e-6 and found.seconds > 0.0

    @pytest.mark.extra("mujoco")
    def test_mujoco_finds_the_landing_near_where_it_is(self):
        found = beside.measured(hop(LANES), mujoco_native.make(hop(LANES), *mujoco_native.SETTINGS[1]), rounds=1)
        assert 1e-4 < found.touchdown < 1e-2 and 1e-3 < found.energy < 1.0 and found.multipliers > 0.01

    def test_spans(self):
        assert beside.span([2e-3, 1.04e-3], " s") == "0.001 to 0.002 s"
        assert beside.span([1.2e-9], " J") == "1e-09 J"


@pytest.mark.slow
def test_lean_stride():
    task = bound(STATES)
    assert task.error(lean_stride.lanes(task)[0].call()) < AGREES


class TestOthersGaits:
    ROW = {
        "energy": 20.0,
        "mass": 2.5,
        "length": 0.3,
        "seconds": 14.0,
        "residual": 2e-13,
        "energy_residual": 4e-8,
        "multipliers": [[0.6, -0.8], [0.1, 0.0]],
        "beyond_limits": [],
        "reason": "complete",
        "speed": 1.77,
        "flight_time": 0.142,
        "scuff_free": True,
    }
    TOO_FAST = {"joint": "knee", "what": "rate", "value": 8.29, "limit": 7.5, "unit": "rad/s"}

    @pytest.mark.parametrize("gait", ["hop", "bound"])
    def test_a_row_has_a_cell_for_each_head(self, gait):
        heads, solo = others_gaits.HEADS[gait].split(" | "), others_gaits.QUADRUPEDS["solo12"]
        found, failed = (
            others_gaits.cells(solo, gait, row) for row in (self.ROW, {"error": "no gait found", "seconds": 3.0})
        )
        assert len(heads) == len(found) == len(failed)
        assert found[-5:] == ["2e-13", "1.000", "2e-09", "14", "none"] and "no gait found" in failed

    @pytest.mark.parametrize(
        ("change", "part"),
        [
            ({"residual": 2e-9}, "residual 2.0e-09"),
            ({"energy_residual": 4e-7}, "ledger 2.0e-08"),
            ({"seconds": 601.0}, "601 s"),
            ({"reason": "fall"}, "fall"),
            ({"scuff_free": False}, "scuffs"),
            ({"beyond_limits": [TOO_FAST]}, "rate of the knee 8.29, its limit 7.5 rad/s"),
            ({"error": "no gait found"}, "no gait found"),
        ],
    )
    def test_what_is_missed(self, change, part):
        assert others_gaits.missed("bound", self.ROW) == []
        (said,) = others_gaits.missed("bound", self.ROW | change)
        assert part in said

    def test_knees_of_which_the_file_tells_nothing(self, monkeypatch):
        monkeypatch.setattr(others_gaits, "files", lambda package, suffix: [Path("mini_cheetah.urdf")])
        dog = others_gaits.QUADRUPEDS["mini_cheetah"]
        assert dog.command("bound") == ["bound", "--robot", "mini_cheetah.urdf", "--bends", "-1", "-1"]
        assert dog.command("hop")[-2:] == ["--bends", "-1"]
