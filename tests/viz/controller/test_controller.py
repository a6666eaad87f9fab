"""The law in C beside the law in Python: over a recorded cycle, and closed round the simulation."""

import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Clutch, Gait, HoppingLaw, Spring, hopping, load
from spear_pin.errors import BadFile, BadValue, MissingExtra
from spear_pin.hybrid.event_feedback import EventFeedback, with_feedback
from spear_pin.hybrid.periodic import residual
from spear_pin.viz.controller.writing import FILES, write_controller
from tests.viz.controller.compiled import COMPILE, Compiled, hop

pytestmark = pytest.mark.extra("casadi")
compiled = pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc here")
LIMITED = HoppingLaw(stance_torque=8.5, minimum_force=5.0, virtual_stiffness=10.0)


@pytest.fixture(scope="module")
def first_hop():
    return hop(cycles=1)


class TestFiles:
    def test_header(self, tmp_path, first_hop):
        files = write_controller(first_hop, tmp_path / "new")
        assert [path.name for path in files] == [*FILES]
        header = files[0].read_text()
        assert "q[2] knee [rad], v[2] [rad/s]" in header and "u[1] knee [N.m], at most 60" in header
        assert "stance_torque = 7.826187875301223 [N.m]" in header and "SPEAR_STANCE,\n  SPEAR_FLIGHT\n" in header
        assert all(path.read_text().isascii() for path in files)
        assert "malloc" not in files[1].read_text()

    def test_without_casadi(self, tmp_path, first_hop, monkeypatch):
        monkeypatch.setitem(sys.modules, "casadi", None)
        with pytest.raises(MissingExtra, match="a controller in C needs casadi"):
            write_controller(first_hop, tmp_path / "none")
        assert not (tmp_path / "none").exists()

    def test_refusals(self, tmp_path, first_hop):
        feedback = EventFeedback(("stance_torque",), (6 * (0.0,),), 6 * (0.0,), (1.0,))
        fed = replace(first_hop, system=with_feedback(first_hop.system, feedback))
        robot = load("spear_ii", locked=["boom_x"])
        late, fixed = Spring(clutch=Clutch(on_delay=0.001)), Spring(rest=0.9)
        for gait, part in (
            (Gait.load("trot"), "gait is 'trotting'"),
            (fed, "event feedback"),
            (replace(first_hop, system=hopping(robot, spring=late)), "the spring 'knee' is"),
            (replace(first_hop, system=hopping(robot, spring=fixed)), "the spring 'knee' is"),
        ):
            with pytest.raises(BadValue, match=part):
                write_controller(gait, tmp_path / "none")
        assert not (tmp_path / "none").exists()
        with pytest.raises(BadFile, match="cannot be made"):
            write_controller(first_hop, tmp_path / "no" / "where")


@pytest.mark.slow
@compiled
class TestCompiled:
    @pytest.mark.parametrize("name", ["hop", "limited", "long_stride", "force_lift_off"])
    def test_a_recorded_cycle(self, tmp_path, first_hop, name):
        gait = first_hop if name == "hop" else hop(LIMITED, 3) if name == "limited" else Gait.load(name)
        write_controller(gait, tmp_path)
        subprocess.run([*COMPILE, "controller.c", "test.c", "-o", "test", "-lm"], cwd=tmp_path, check=True)
        done = subprocess.run(["./test"], cwd=tmp_path, capture_output=True, text=True)
        first, second = done.stdout.splitlines()
        assert done.returncode == 0, done.stdout
        assert float(first.split()[2]) <= 1e-12  # N.m
        assert float(second.split()[3]) < 20.0  # us

    @pytest.mark.parametrize("name", ["hop", "long_stride"])
    def test_the_same_fixed_point(self, tmp_path, name):
        gait = hop() if name == "hop" else Gait.load(name)
        assert residual(gait.system, gait.state) < 1e-9
        assert residual(Compiled(gait, tmp_path).closed(), gait.state) < 1e-9

    def test_limits(self, tmp_path, first_hop):
        controller, (q, v) = Compiled(first_hop, tmp_path), first_hop.state
        controller.begin(0.0, q, v)
        stance, flight = 0, 1
        assert controller.step(0.001, q, [np.nan, *v[1:]]) == (-2, [0.0, 0.0]) and controller.own.phase == stance
        assert controller.tell("SPEAR_TOUCHDOWN", 0.002, q, v) == 0 and controller.own.phase == stance
        assert controller.tell("SPEAR_LIFT_OFF", 0.1, q, v) == 1 and controller.own.phase == flight
        high = q + [0.1, 0.0, 0.0]
        _, torques = controller.step(0.2, high, [0.0, 1e3, -1e3])
        assert torques == [-60.0, 60.0]
        assert controller.step(5.2, high, v) == (-2, [0.0, 0.0])
