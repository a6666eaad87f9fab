"""The hops of examples/published_legs.py: fixed points, and what their springs do."""

import importlib.util
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from spear_pin import simulate
from tests.cli.calls import printed

PATH = Path(__file__).parents[2] / "examples" / "published_legs.py"


@cache
def example():
    spec = importlib.util.spec_from_file_location("published_legs_example", PATH)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # for its dataclass
    spec.loader.exec_module(module)
    return module


@cache
def solved(source):
    (published,) = (each for each in example().LEGS if Path(each.source).stem == source)
    leg = example().leg_of(published)
    gait = example().hop(published, leg)
    return gait, simulate(gait.system, gait.state, cycles=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    "source", ["hoppy_leg", "mups_v2", pytest.param("e_go", marks=pytest.mark.extra("example-robot-data"))]
)
class TestHops:
    def test_is_a_stable_fixed_point(self, source):
        gait, run = solved(source)
        assert gait.residual < 1e-9 and gait.stable
        assert run.reason == "complete" and abs(run.ledger.residual).max() < 1e-7

    def test_keeps_within_the_published_limits(self, source):
        gait, run = solved(source)
        leg = gait.system.robot
        for i, joint in enumerate(run.actuated):
            limits, column = leg.limits[joint], run.coordinates.index(joint)
            assert np.abs(run.u[:, i]).max() <= limits.effort
            assert limits.position[0] <= run.q[:, column].min() and run.q[:, column].max() <= limits.position[1]

    def test_its_spring_is_never_let_go(self, source):
        gait, run = solved(source)
        spring, knee = gait.system.spring, run.q[:, run.coordinates.index("knee")]
        beyond = knee - spring.rest
        torque = np.where(beyond > 0.0, spring.torque(beyond), 0.0) if spring.unilateral else spring.torque(beyond)
        np.testing.assert_allclose(run.spring[:, 0], torque, atol=1e-6)

    def test_without_it_the_motor_gives_the_rest_of_the_torque(self, source):
        _, run = solved(source)
        bare, knee = example().without_spring(run), run.actuated.index("knee")
        np.testing.assert_allclose(bare.u[:, knee], run.tau[:, knee], atol=1e-9)  # springs without dampers
        np.testing.assert_array_equal(bare.u[:, 1 - knee], run.u[:, 1 - knee])


@pytest.mark.slow
def test_the_spring_of_mups_does_most_of_the_work():
    gait, run = solved("mups_v2")
    sprung, bare = (example().cost(gait, each).energy["electrical_0"] for each in (run, example().without_spring(run)))
    assert sprung < 0.3 * bare


@pytest.mark.slow
def test_the_command_takes_spring_and_motors_from_the_file(capsys, tmp_path):
    asked = ("--knee", "1.6", "--frequency", "4.62", "--flight-time", "0.32", "--cycles", "1")
    found = printed(capsys, "hop", "--robot", "mups_v2", *asked, "--out", tmp_path)
    assert found["residual"] < 1e-9 and found["stable"] and found["beyond_limits"] == []
    assert found["stiffness"] == 0.0 and found["spring_share"] > 1.0  # a table; the motor brakes at the end of the push


def test_a_name_that_is_not_installed_is_said(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(example(), "LEGS", (example().Published("nobody's", "no_such_robot", 0.1, 1.0),))
    monkeypatch.setattr(example(), "drawn", lambda runs: None)
    monkeypatch.setattr(example(), "save_figure", lambda figure, path: path)
    example().main(tmp_path)
    assert "left out: robot 'no_such_robot' needs the extra 'robots'" in capsys.readouterr().out
