"""The search for a bound asks of a robot of another size the same, and finds the same."""

from dataclasses import asdict

import numpy as np
import pytest

from spear_pin import load, sagittal
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.model.scale import scale_of
from tests.gaits.similar import similar
from tests.model.legged import quadruped

TORQUES = ("posterior_hip_torque", "anterior_hip_torque", "posterior_knee_torque", "anterior_knee_torque")
ANGLES = ("posterior_leg_touchdown", "anterior_leg_touchdown", "posterior_stance_span", "anterior_stance_span")
LENGTHS = ("flight_1_span", "flight_2_span")


def found(robot):
    """Numbers of the optimal bound without units, by name, and the objective."""
    plane = sagittal(robot)
    scale = scale_of(plane)
    gait, solution = search(plane, Request.scaled(plane))
    law, (q, v) = asdict(gait.system.law), gait.state
    lengths = np.array([scale.length, scale.length, *np.ones(5)])
    numbers = {name: law[name] / scale.torque for name in (*TORQUES, "virtual_stiffness")}
    numbers |= {name: law[name] / scale.length for name in LENGTHS} | {name: law[name] for name in ANGLES}
    numbers |= {phase: time / scale.time for phase, time in gait.durations.items()}
    numbers |= {"epsilon": law["epsilon"] / scale.time}
    state = {"q": q / lengths, "v": v / lengths * scale.time, "multipliers": np.sort(np.abs(gait.multipliers))}
    return numbers | state | {"objective": solution.objective}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "made.urdf"
    path.write_text(quadruped(), encoding="utf-8")
    return load(path)


@pytest.fixture(scope="module")
def own(made):
    return found(made)


@pytest.mark.slow
@pytest.mark.extra("casadi")
@pytest.mark.parametrize("longer", [0.3, 3.0])
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_of_a_quadruped_of_another_size(made, own, longer):
    for name, value in found(similar(made, longer)).items():
        np.testing.assert_allclose(value, own[name], rtol=1e-4, atol=1e-4, err_msg=name)


@pytest.mark.parametrize("longer", [0.3, 3.0])
def test_what_is_asked_is_similar(made, longer):
    """Numbers of the request go by the robot's units, limits are those of its joints."""
    one, other = (sagittal(similar(made, factor)) for factor in (1.0, longer))
    force, time = longer**3, longer**0.5
    units = {"speed": longer / time, "minimum_force": force, "clearance": longer, "minimum_stance": time}
    units |= dict.fromkeys(("minimum_knee_torque", "stiffness", "virtual_stiffness"), force * longer)
    asked = asdict(Request.scaled(one))
    for name, value in asdict(Request.scaled(other)).items():
        expected = asked[name] * units[name] if name in units else asked[name]
        assert value == (pytest.approx(expected, rel=1e-12) if isinstance(expected, float) else expected), name
    for joint in one.actuated:
        small, large = one.limits[joint], other.limits[joint]
        assert large.effort == pytest.approx(small.effort * force * longer) and large.position == small.position
        assert large.velocity == pytest.approx(small.velocity / time)
