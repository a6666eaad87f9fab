"""A gait as a table: its rows lie on the orbit, and its gains are the differences of the law."""

import csv
import json

import numpy as np
import pytest

from spear_pin import Gait, simulate
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.viz.controller.tracking import tabulated, write_table
from tests.viz.controller.compiled import hop

STEP = 1e-6


@pytest.fixture(scope="module")
def first_hop():
    return hop(cycles=1)


@pytest.fixture(scope="module")
def bound():
    return Gait.load("long_stride")


class TestRows:
    def test_lie_on_the_orbit(self, first_hop):
        table, motion = tabulated(first_hop, 100.0), simulate(first_hop.system, first_hop.state, samples=2000)
        assert np.allclose(np.diff(table["t"]), 0.01) and 0.0 <= motion.t[-1] - table["t"][-1] <= 0.01
        for name, values in (("q", motion.q[:, 1:]), ("v", motion.v[:, 1:]), ("u", motion.u)):
            for i in range(2):
                expected = np.interp(table["t"], motion.t, values[:, i])
                assert np.allclose(table[name][:, i], expected, rtol=0, atol=2e-3), name
        force = np.interp(table["t"], motion.t, motion.force[:, 0, 1])
        assert (table["contacts"][:, 0] == (force > 0.0)).all()

    def test_gains_of_a_hop(self, first_hop):
        table = tabulated(first_hop, 50.0)
        flying = ~table["contacts"][:, 0]
        assert flying.any() and not table["stiffness"][~flying].any() and not table["damping"][~flying].any()
        assert (table["stiffness"][flying] == np.diag([54.77, 63.25])).all()
        assert (table["damping"][flying] == np.diag([1.37, 0.52])).all()

    def test_gains_of_a_bound_beside_differences(self, bound):
        table, found = tabulated(bound, 40.0), run(bound.system, bound.state, 1, Options(keep=True))
        motors, nv = [bound.system.robot.index(joint) for joint in bound.system.robot.actuated], 7
        for segment in found.segments:
            times = table["t"] - segment.began
            inside = (times >= segment.pieces[0].begin) & (times < segment.pieces[-1].end)
            flow = Flow(bound.system, segment.domain, segment.held)
            for row in np.flatnonzero(inside):
                piece = next(piece for piece in segment.pieces if times[row] <= piece.end)
                y = np.asarray(piece.state(times[row]))

                def torques(j, by, flow=flow, t=times[row], y=y):
                    moved = y.copy()
                    moved[j] += by
                    flow(t, moved)
                    return np.array(flow.u)

                for name, first in (("stiffness", 0), ("damping", nv)):
                    for k, motor in enumerate(motors):
                        slope = (torques(first + motor, STEP) - torques(first + motor, -STEP)) / (2.0 * STEP)
                        np.testing.assert_allclose(table[name][row, :, k], -slope, rtol=1e-6, atol=1e-5)


class TestFiles:
    def test_the_same_numbers(self, tmp_path, bound):
        table = tabulated(bound, 20.0)
        with write_table(bound, tmp_path / "a.csv", 20.0).open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert [float(row["u_anterior_knee [N·m]"]) for row in rows] == table["u"][:, 3].tolist()
        assert [float(row["contact_posterior_toe"]) for row in rows] == table["contacts"][:, 0].tolist()
        name = "stiffness_posterior_hip_by_anterior_knee [N·m/rad]"
        assert [float(row[name]) for row in rows] == table["stiffness"][:, 0, 3].tolist()
        with np.load(write_table(bound, tmp_path / "a.npz", 20.0)) as arrays:
            assert arrays["joints"].tolist() == list(bound.system.robot.actuated)
            assert (arrays["damping"] == table["damping"]).all()

    @pytest.mark.extra("mcap")
    def test_a_log(self, tmp_path, bound):
        from mcap.reader import make_reader

        table = tabulated(bound, 20.0)
        with write_table(bound, tmp_path / "a.mcap", 20.0).open("rb") as file:
            messages = [message for *_, message in make_reader(file).iter_messages()]
        assert [message.log_time for message in messages] == [round(1e9 * t) for t in table["t"]]
        assert [json.loads(message.data)["u_anterior_knee"] for message in messages] == table["u"][:, 3].tolist()
