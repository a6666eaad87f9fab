"""Electricity of drives against simulations sampled ever finer, and derivatives against gaits that are found again."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Gait, find_gait, hopping, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.measures.catalogue import Measure
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.sensitivity.measures import Measures
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.tangent.seeds import seeds
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.variants import vary
from spear_pin.studies.design import against, points_of
from tests.gaits import found_again

OVER = ("stiffness", "knee_ratio", "friction", "hip_to_knee", "knee_motor_size", "hip_motor_size", "knee_motor_mass")
DRIVES = {
    "knee": Drive(motor("spear_ii_knee"), Gearbox(15.0, 0.83), 24.0),
    "hip": Drive(motor("ec_90_flat_260w"), Gearbox(60.0, 0.7), 96.0),
}
KNEES = ("posterior_knee", "anterior_knee")
TAKEN = [f"{name}_{joint}" for name in ("electricity", "heating") for joint in KNEES]
OUTPUTS = (
    *("electricity", "electricity_knee", "electricity_hip", "reserve_knee", "reserve_hip", "effort", "deflection_knee"),
    *("heating_knee", "heating_hip"),
    *(f"{name}_{joint}" for name in ("peak_speed", "least", "greatest") for joint in ("knee", "hip")),
)


@pytest.fixture(scope="module")
def table(hop):
    return hop.sensitivity(OVER, motors=DRIVES)


def sampled(gait, samples):
    return simulate(gait.system, gait.state, samples=samples, progress=False)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("joint", DRIVES)
def test_electricity_is_that_of_samples(hop, table, joint):
    """Braking motors among it, where gears help; where a joint turns back the power jumps."""
    given, drive = points_of(hop.system.robot, sampled(hop, 6400), joint), DRIVES[joint]
    power = np.maximum(drive.bus_power(given.torque, given.speed), 0.0).sum(axis=1)
    assert table.outputs[f"electricity_{joint}"] == pytest.approx(np.trapezoid(power, given.t), rel=1e-5)
    found = Sampled(hop.system.robot, sampled(hop, 100), drives=DRIVES).values()
    assert found["electricity"] == pytest.approx(table.outputs["electricity"], rel=1e-8)
    assert found[f"heating_{joint}"] == pytest.approx(table.outputs[f"heating_{joint}"], rel=1e-8)
    assert found[f"electricity_{joint}"] == pytest.approx(table.outputs[f"electricity_{joint}"], rel=1e-8)
    assert table.outputs["electricity"] == pytest.approx(sum(table.outputs[f"electricity_{each}"] for each in DRIVES))


@pytest.mark.extra("heyoka")
def test_reserves_and_ranges_are_those_of_the_motion(hop, table):
    run = sampled(hop, 3200)
    for joint, drive in DRIVES.items():
        u, i = run.u[:, run.actuated.index(joint)], hop.system.robot.index(joint)
        assert table.outputs[f"reserve_{joint}"] == pytest.approx(drive.margin(u, run.v[:, i]).min(), rel=1e-6)
        assert table.outputs[f"peak_speed_{joint}"] == pytest.approx(np.abs(run.v[:, i]).max(), abs=1e-5)
        assert table.outputs[f"least_{joint}"] == pytest.approx(run.q[:, i].min(), abs=1e-7)
        assert table.outputs[f"greatest_{joint}"] == pytest.approx(run.q[:, i].max(), abs=1e-7)
    effort = np.trapezoid((run.u**2).sum(axis=1), run.t)
    assert table.outputs["effort"] == pytest.approx(effort, rel=1e-5)
    lift_off = next(event for event in run.events if event.name == "lift_off")
    deflection = lift_off.q[hop.system.robot.index("knee")] - hop.state[0][hop.system.robot.index("knee")]
    assert table.outputs["deflection_knee"] == pytest.approx(deflection, abs=1e-9)


@pytest.mark.extra("heyoka")
def test_a_current_limit_bounds_the_reserve(hop, table):
    limited = {"knee": replace(DRIVES["knee"], current_limit=7.0)}
    found = hop.sensitivity(["knee_ratio"], motors=limited)
    most = 0.83 * 15.0 * DRIVES["knee"].motor.torque_constant * 7.0
    assert found.outputs["reserve_knee"] == pytest.approx(most - found.outputs["peak_torque_knee"], abs=1e-9)
    assert found.outputs["reserve_knee"] < table.outputs["reserve_knee"]
    change = most / 15.0 - found.derivatives["peak_torque_knee"][0]
    assert found.derivatives["reserve_knee"] == pytest.approx([change])


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", OVER)
def test_derivatives_against_gaits_found_again(hop, table, name):
    value, j = number(hop.system, name), OVER.index(name)
    found = found_again.measures(hop, name, lambda orbit: [orbit.measures[each].value for each in OUTPUTS], DRIVES)
    for output, expected in zip(OUTPUTS, found, strict=True):
        scale = 1e-8 * np.abs(table.derivatives[output] * table.given).max()
        assert table.derivatives[output][j] * value == pytest.approx(expected * value, rel=1e-8, abs=scale)


@pytest.mark.extra("heyoka")
def test_heating_is_the_share_of_the_continuous_torque(hop, table):
    for joint, drive in DRIVES.items():
        use = against(points_of(hop.system.robot, sampled(hop, 6400), joint), drive)
        assert table.outputs[f"heating_{joint}"] == pytest.approx(use.heating[0], rel=1e-5)
    unknown = replace(DRIVES["knee"].motor, nominal_torque=None, nominal_current=None)
    outputs = hop.sensitivity(["stiffness"], motors={"knee": unknown, "hip": DRIVES["hip"].motor}).outputs
    assert "heating_knee" not in outputs and outputs["heating_hip"] == pytest.approx(0.7 * table.outputs["heating_hip"])


@pytest.mark.slow
@pytest.mark.extra("heyoka")
def test_drives_of_a_pair_share_its_torque():
    gait, drive = Gait.load("long_stride"), Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)
    found = gait.sensitivity(["torso_mass"], motors=dict.fromkeys(KNEES, drive)).outputs
    knees = Sampled(gait.system.robot, sampled(gait, 100), drives=dict.fromkeys(KNEES, drive)).values()
    assert [knees[name] for name in TAKEN] == pytest.approx([found[name] for name in TAKEN], rel=1e-7)
    assert "electricity" not in found and "electricity" not in knees


@pytest.mark.slow
@pytest.mark.extra("heyoka")
def test_electricity_spreads_as_the_rest(table):
    spread = table.uncertainty({"stiffness": 0.05})
    drawn = spread.monte_carlo(30, 0)
    assert drawn.samples.outputs["electricity"].std() == pytest.approx(spread.deviation("electricity"), rel=0.5)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(("bus", "efficiency"), [(6.0, 0.6), (12.0, 0.7)])
def test_a_reserve_above_the_speed_without_load(hop, bus, efficiency):
    """There the back-EMF brakes, over the gears' efficiency."""
    drive = Drive(motor("spear_ii_knee"), Gearbox(15.0, efficiency), bus)
    run, i = sampled(hop, 3200), hop.system.robot.index("knee")
    margin = drive.margin(run.u[:, run.actuated.index("knee")], run.v[:, i]).min()
    found = hop.sensitivity(["stiffness"], motors={"knee": drive}).outputs
    assert found["reserve_knee"] == pytest.approx(margin, rel=1e-5) and margin < 0.0
    assert "electricity_knee" in found and "electricity" not in found  # the hip's is not known


@pytest.mark.extra("heyoka")
def test_a_ratio_without_a_rotor_is_a_number_of_motors(hop):
    robot = vary(hop.system.robot, knee_rotor=0.0)
    gait = find_gait(hopping(robot), guess=hop.state)
    found = gait.sensitivity(["knee_ratio"], motors={"knee": motor("spear_ii_knee")})
    assert found.derivatives["flight_time"][0] == 0.0
    assert found.elasticity("heat_knee") == pytest.approx([-2.0])


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(
    ("drives", "error", "text"),
    [
        ({"toe": DRIVES["knee"]}, UnknownName, "'toe'"),
        ({"knee": replace(DRIVES["knee"], gearbox=Gearbox(60.0))}, BadValue, "ratio of the drive of knee is 60"),
        (
            {"knee": replace(DRIVES["knee"], motor=replace(motor("spear_ii_knee"), resistance=None))},
            BadValue,
            "resista",
        ),
    ],
)
def test_what_is_refused(hop, drives, error, text):
    with pytest.raises(error, match=text):
        hop.sensitivity(["stiffness"], motors=drives)


@pytest.mark.slow
def test_what_is_built_into_events_is_refused(hop):
    """A fixed spring's angle of rest is no number of the equations: its derivatives would all be zero."""
    system = hop.system.build(hop.system.robot, hop.system.law, replace(hop.system.spring, rest=1.0))
    with pytest.raises(BadValue, match="rest is 1"):
        seeds(system, ["rest"])


class TestMeasures:
    def measures(self, asked):
        def entry(name, value):
            def found(cycle):
                asked.append(name)
                if value is None:
                    raise BadValue("it", 1.0, "another")
                return value

            return Measure(name, "J", "A measure.", found)

        signals = SimpleNamespace(
            start=np.zeros((2, 1)), cycle=SimpleNamespace(system=SimpleNamespace(robot=None)), section=""
        )
        return Measures(signals, [entry("a", 1.0), entry("b", 2.0), entry("c", None)])

    def test_are_found_when_they_are_asked_for(self):
        asked = []
        found = self.measures(asked)
        assert found["b"].value == 2.0 and asked == ["b"]
        assert "d" not in found and found["b"].unit == "J" and asked == ["b"]

    def test_one_that_is_not_found_is_not_found_again(self):
        found = self.measures([])
        for _ in range(2):
            with pytest.raises(BadValue, match="it is 1"):
                found["c"]


@pytest.mark.extra("heyoka")
def test_a_joint_that_is_kept_at_rest_takes_its_current_one_way():
    """Rounding turns `long_stride`'s posterior knee to and fro under torque, by 1e-14 rad/s."""
    gait = Gait.load("long_stride")
    drive = Drive(motor("ec_90_flat_260w"), Gearbox(gait.system.robot.gear_ratio("posterior_knee"), 0.83), 48.0)
    mass, taken = number(gait.system, "torso_mass"), []
    for k in range(-3, 4):
        system = with_numbers(gait.system, {"torso_mass": mass + k * 1e-9})
        taken.append(Orbit(system, gait.state, (), {"posterior_knee": drive}).measures["electricity_posterior_knee"])
    assert np.ptp([each.value for each in taken]) < 1e-8
