"""Heat of windings against simulations by hand, and its derivatives against gaits that are found again."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.sensitivity.drives import DrivenJoints
from spear_pin.hybrid.parameters import number
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox, Motor
from tests import biped
from tests.gaits import found_again

pytestmark = pytest.mark.extra("heyoka")
OVER = ("stiffness", "knee_ratio", "friction", "hip_to_knee", "knee_motor_size", "hip_motor_size")
MOTORS = {"knee": motor("spear_ii_knee"), "hip": motor("ec_90_flat_260w")}


@pytest.fixture(scope="module")
def table(hop):
    return hop.sensitivity(OVER, motors=MOTORS)


def test_heat_and_energy_of_a_hop(hop, table):
    run = simulate(hop.system, hop.state, 1, progress=False)
    for joint, ratio in (("knee", 15.0), ("hip", hop.system.robot.gear_ratio("hip"))):
        watts = Drive(MOTORS[joint], Gearbox(ratio), 24.0).joule_power(run.u[:, run.actuated.index(joint)], 1.0)
        assert table.outputs[f"heat_{joint}"] == pytest.approx(np.trapezoid(watts, run.t), rel=2e-4)
    # as much as goes into dampers, impacts and friction, for after a cycle all else is as it was
    assert table.outputs["work"] == pytest.approx(sum(float(run.ledger[f"motor_{j}"][0]) for j in run.actuated))
    assert table.outputs["energy"] == pytest.approx(sum(table.outputs[n] for n in ("work", "heat_knee", "heat_hip")))
    assert table.outputs["work"] + table.outputs["heat_knee"] == pytest.approx(20.2142, abs=1e-4)
    assert table.output_units["energy"] == table.output_units["heat_knee"] == "J"


@pytest.mark.parametrize("name", OVER)
def test_derivatives_against_gaits_found_again(hop, table, name):
    value, j, outputs = number(hop.system, name), OVER.index(name), ("heat_knee", "heat_hip", "energy")
    found = found_again.measures(hop, name, lambda orbit: [orbit.measures[each].value for each in outputs], MOTORS)
    for output, expected in zip(outputs, found, strict=True):
        size = 1e-9 * table.outputs[output]
        assert table.derivatives[output][j] * value == pytest.approx(expected * value, rel=1e-8, abs=size)


def test_energy_that_is_kept(hop, table):
    """The torque that keeps it, from derivatives by each number alone."""
    free = hop.sensitivity(["stiffness", "stance_torque"], motors=MOTORS).derivatives["energy"]
    kept = hop.sensitivity(["stiffness"], ["stance_torque"], ["energy"], MOTORS)
    assert kept.solved["stance_torque"] == pytest.approx([-free[0] / free[1]])
    assert kept.derivatives["energy"] == pytest.approx([0.0], abs=1e-12)


@pytest.mark.slow
def test_motors_of_a_pair_share_its_torque():
    gait = Gait.load("long_stride")
    joint, one = "posterior_knee", Motor("one", torque_constant=0.1, resistance=0.5)
    table = gait.sensitivity(["torso_mass"], motors={joint: one})
    run = simulate(gait.system, gait.state, 1, progress=False)
    each = 0.5 * run.u[:, run.actuated.index(joint)] / (gait.system.robot.gear_ratio(joint) * 0.1)  # A
    heat = 2.0 * 0.5 * np.trapezoid(each**2, run.t)
    assert table.outputs[f"heat_{joint}"] == pytest.approx(heat, rel=1e-3)


def test_legs_of_a_biped_have_motors_of_their_own():
    robot, one = biped.system().robot, Motor("one", torque_constant=0.1, resistance=0.5)
    expected = 0.5 / (0.1 * robot.gear_ratio("left_knee")) ** 2
    assert DrivenJoints(biped.system(), {"left_knee": one}, (), 0).heat("left_knee").x == pytest.approx(expected)


def test_without_motors_there_is_none(hop):
    found = hop.sensitivity(["stiffness"])
    assert not [name for name in found.outputs if name == "energy" or name.startswith("heat")]


@pytest.mark.parametrize(
    ("motors", "error", "text"),
    [
        ({"toe": MOTORS["knee"]}, UnknownName, "'toe'"),
        ({"knee": replace(MOTORS["knee"], resistance=None)}, BadValue, "resistance of"),
        ({"knee": "spear_ii_knee"}, BadValue, "motors"),
    ],
)
def test_what_is_refused(hop, motors, error, text):
    with pytest.raises(error, match=text):
        hop.sensitivity(["stiffness"], motors=motors)
