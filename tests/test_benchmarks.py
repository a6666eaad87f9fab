"""What the benchmark of engines compares computes the same: a lane that is fast and wrong would win."""

import importlib
from functools import cache

import numpy as np
import pytest

from benchmarks.peers import lean_loop, lean_stride
from benchmarks.peers.task import AGREES, STATES, bound, hop, taylor
from tests.hybrid.by_hand import Hopper

LANES = 8


@cache
def lanes(peer):
    return importlib.import_module(f"benchmarks.peers.{peer}").lanes(hop(LANES))


class TestHop:
    def test_what_is_compared_with_agrees_with_the_lagrangian(self):
        task = hop(LANES)
        by_hand = Hopper(task.gait.system.law.stance_torque)
        for q, v, end in zip(task.q[:2], task.v[:2], task.ends, strict=False):
            np.testing.assert_allclose(by_hand.hop(np.concatenate([q, v])), end, rtol=0, atol=1e-9)

    def test_perturbed_hops_are_not_the_gait(self):
        task = hop(LANES)
        assert (np.abs(task.ends - task.ends[0]).max(axis=1)[1:] > 0.01).all()

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


@pytest.mark.slow
def test_lean_stride():
    task = bound(STATES)
    assert task.error(lean_stride.lanes(task)[0].call()) < AGREES
