"""The hopping law on legs with closed loops, whose file says what it calls hip and knee."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load, simulate
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.gaits.many import find_many
from spear_pin.gaits.reaching import find_landing_velocity, pose_leg
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import chart
from spear_pin.model.path import Joints
from spear_pin.studies.hop import summarize
from spear_pin.viz.plots import hop_summary
from tests.gaits import found_again
from tests.model.looped import CRANK_LEG, CRANK_LOOP, FIVE_BAR, FIVE_BAR_LOOP, UPPER, crank_leg, five_bar, joint, write
from tests.slow import slow_but

CRANK = HoppingLaw(-0.35, stance_torque=0.7, frequency=5.0, knee_gain=6.0, knee_damping=0.15, hold_extension=True)
OPENING = {"leg": Spring(12.0, damping=0.06, path=Joints({"front_hip": 1.0, "back_hip": -1.0}))}
FIVE = HoppingLaw(
    1.8,
    stance_torque=1.4,
    frequency=6.0,
    hip_gain=5.0,
    hip_damping=0.1,
    knee_gain=3.0,
    knee_damping=0.1,
    hold_extension=True,
    minimum_force=2.0,
)
NAMES = "crank_hopper", "five_bar"


@pytest.fixture(scope="module")
def systems(tmp_path_factory):
    leg = five_bar(tmp_path_factory.mktemp("loops"))
    return {"crank_hopper": hopping(load("crank_hopper"), CRANK), "five_bar": hopping(leg, FIVE, OPENING)}


@pytest.fixture(scope="module")
def gaits(systems):
    return {
        name: find_gait(each, vary=["stance_torque"], target={"flight_time": 0.15}) for name, each in systems.items()
    }


@pytest.mark.parametrize("name", NAMES)
class TestHop:
    def test_it_hops_and_conserves_energy(self, systems, gaits, name):
        gait = gaits[name]
        assert gait.stable and gait.durations["flight"] == pytest.approx(0.15, abs=1e-9)
        hops = simulate(gait.system, gait.state, cycles=3)
        assert np.abs(hops.ledger.residual).max() < 1e-8
        assert max(np.abs(gait.system.robot.loop_gap(q)).max() for q in hops.q) < 1e-9

    def test_measures_are_those_of_hip_and_knee(self, gaits, name):
        gait = gaits[name]
        q = gait.state[0]
        motors = {motor: q[gait.system.robot.index(motor)] for motor in gait.system.robot.actuated}
        knee = motors["crank"] if name == "crank_hopper" else motors["front_hip"] - motors["back_hip"]
        cycle = run(gait.system, gait.state, 1, Options())
        assert gait.system.measures["knee_at_touchdown"](cycle) == pytest.approx(knee, abs=1e-9)


@pytest.mark.slow
def test_one_leg_of_minitaur_hops():
    """Its two motors stay within what they can give."""
    leg = load("minitaur_leg")
    law = replace(HoppingLaw.scaled(leg), frequency=5.0)
    gait = find_gait(hopping(leg, law), vary=["stance_torque"], target={"flight_time": 0.14})
    hops = simulate(gait.system, gait.state, cycles=3)
    assert gait.stable and np.abs(hops.ledger.residual).max() < 1e-8 and np.abs(hops.u).max() < 5.7


def test_a_leg_without_its_toe_is_refused():
    leg = load("minitaur_leg", toes=[])
    with pytest.raises(BadValue, match="expected a planar robot with the toe 'toe'"):
        HoppingLaw.scaled(leg)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", slow_but(NAMES, "crank_hopper"))
def test_multipliers_are_those_of_differences(gaits, name):
    gait = gaits[name]
    own = with_parameters(gait.system, gait.parameters)
    found = np.sort_complex(eigenvalues(differentiate_return_map(own, gait.state)))
    np.testing.assert_allclose(found, np.sort_complex(gait.multipliers), rtol=0, atol=5e-6)  # as differences err


OVER = {
    "crank_hopper": (
        "stiffness",
        "leg.start_z",
        "slide_mass",
        "crank_armature",
        "crank_to_rod",
        "rod_to_pin_a",
        "knee_gain",
    ),
    "five_bar": ("stiffness", "knee_gain", "boom_z_mass"),  # leaning, its toe slides for an instant before lift-off
}


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(("name", "over"), [(name, over) for name, names in OVER.items() for over in names])
def test_derivative_is_that_of_hops_found_again(systems, name, over):
    gait = find_gait(systems[name], ["stance_torque"], {"flight_time": 0.15}, rtol=1e-12)
    exact, expected = found_again.hops(gait, over, 1e-3, nearest)
    np.testing.assert_allclose(exact, expected, atol=1e-7 * np.abs(exact).max())


def nearest(system, state):
    """The state nearest to another's with closed loops and its toe on the ground, at rest."""
    return chart(system, state).state(np.zeros(chart(system, state).dimension))


@pytest.mark.parametrize("name", NAMES)
def test_torques_on_hip_and_knee_do_the_work_of_the_motors(systems, name):
    robot, rng = systems[name].robot, np.random.default_rng(0)
    v, torques = rng.normal(size=robot.nv), rng.normal(size=2)
    hip, knee = robot.reach.angles(v, robot.coordinates)
    torques = torques if robot.reach.hip else np.array([0.0, torques[1]])
    own = robot.reach.torques(*torques, robot.actuated)
    power = sum(u * v[robot.index(motor)] for motor, u in zip(robot.actuated, own, strict=True))
    assert power == pytest.approx(torques @ [hip, knee])


@pytest.mark.parametrize("name", NAMES)
def test_a_guess_hangs_below_its_motors_with_its_toe_at_rest(systems, name):
    robot = systems[name].robot
    q = pose_leg(robot, 0.0, 1.2 if name == "five_bar" else -0.3)
    v = find_landing_velocity(robot, q, 0.5)
    assert robot.toe_position(q, "toe")[1] < -0.15
    assert np.abs(robot.toe_jacobian(q, "toe") @ v).max() < 1e-12 and v[0] == pytest.approx(-0.5)
    assert np.abs(robot.loop_gap(q)).max() < 1e-12 and np.abs(robot.loop_jacobian(q) @ v).max() < 1e-12


@pytest.mark.parametrize("name", slow_but(NAMES, "crank_hopper"))
def test_figures_are_those_of_its_motors(gaits, name):
    gait = gaits[name]
    hops = simulate(gait.system, gait.state, cycles=1)
    said, motors = summarize(gait, hops), gait.system.robot.actuated
    flexion = hops.q[:, hops.coordinates.index(motors[0])]
    flexion = flexion if name == "crank_hopper" else flexion - hops.q[:, hops.coordinates.index(motors[1])]
    deepest = np.max(flexion[hops.phase == "stance"]) - flexion[0]
    assert said["peak_compression"] == pytest.approx(deepest, rel=1e-3) and said["spring_share"] is None
    assert [*said["peak_torque"]] == [*motors]
    drawn = [axes.get_ylabel() for axes in hop_summary(hops, gait).axes]
    assert all(f"{motor.replace('_', ' ').capitalize()} angle (rad)" in drawn for motor in motors)


GEARED = """[loops.gears]
joints = { front_hip = 1.0, back_hip = 1.0 }
[reach]
knee = { front_hip = 2.0 }
"""


def geared(folder, more=GEARED):
    """A five-bar whose hips are geared to each other, so that its toe stays below them."""
    toml = FIVE_BAR_LOOP.split("[reach]")[0].replace(', "back_hip"]', "]") + more
    return load(write(folder, "geared", FIVE_BAR, toml), base="fixed")


def test_a_toe_that_loops_guide_bears_no_force_along_the_ground(tmp_path):
    leg = geared(tmp_path)
    assert leg.guided == ("toe",) and leg.independent == ("boom_z", "front_hip")
    gait = find_gait(hopping(leg, FIVE, OPENING), vary=["stance_torque"], target={"flight_time": 0.12})
    hops = simulate(gait.system, gait.state, cycles=2)
    assert hops.force[:, 0, 0].max() == hops.force[:, 0, 0].min() == 0.0
    assert hops.named("touchdown")[-1].impulse[0, 0] == 0.0
    assert np.abs(hops.ledger.residual).max() < 1e-8 and len(gait.multipliers) == 2


def test_a_guess_keeps_the_limits_of_the_joints(tmp_path):
    """Which leave only the way to assemble the leg whose toe is above."""
    front = joint("front_knee", "revolute", "front_upper", "front_lower", at=-UPPER)
    upward = FIVE_BAR.replace(front, front.replace('lower="-10"', 'lower="0.5"'))
    assert upward != FIVE_BAR
    leg = load(write(tmp_path, "five_bar", upward, FIVE_BAR_LOOP), base="fixed")
    assert 0.5 <= pose_leg(leg, 0.0, 1.2)[leg.index("front_knee")] <= 10.0


def test_passive_joints_are_within_one_turn(systems):
    robot = systems["five_bar"].robot
    for knee in (0.3, 0.6, 1.2, 2.0):
        assert np.abs(pose_leg(robot, 0.1, knee)[1:]).max() < np.pi


@pytest.mark.extra("heyoka")
def test_numbers_far_away_have_no_hop_and_no_traceback(systems):
    assert not find_many(systems["crank_hopper"], {"stance_torque": [100.0, 1000.0]}).converged.any()


class TestRefused:
    def test_an_independent_joint_without_a_motor(self, tmp_path):
        toml = 'independent = ["front_hip", "front_knee"]\n' + FIVE_BAR_LOOP
        leg = load(write(tmp_path, "five_bar", FIVE_BAR, toml), base="fixed")
        with pytest.raises(BadValue, match="motors on joints that determine the others: boom_z, front_hip"):
            hopping(leg, FIVE, OPENING)

    @pytest.mark.parametrize(
        ("reach", "error", "said"),
        [
            ("knee = { front_knee = 1.0 }", UnknownName, r"unknown motor in \[reach\] 'front_knee'"),
            ("knee = { front_hip = 1.0 }\nhip = { front_hip = 2.0 }", BadValue, "no multiple of the knee's"),
        ],
    )
    def test_a_reach_that_motors_do_not_have(self, tmp_path, reach, error, said):
        toml = FIVE_BAR_LOOP.split("[reach]")[0] + "[reach]\n" + reach
        leg = load(write(tmp_path, "five_bar", FIVE_BAR, toml), base="fixed")
        with pytest.raises(error, match=said):
            hopping(leg, FIVE, OPENING)

    def test_a_locked_joint_of_a_belt(self, tmp_path):
        geared(tmp_path)
        with pytest.raises(UnknownName, match="unknown joint of the loop 'gears' 'back_hip'"):
            load(tmp_path / "geared.urdf", base="fixed", locked=["back_hip"])

    def test_dry_friction_where_a_loop_ties_the_joint_or_of_too_many(self, systems):
        with pytest.raises(BadValue, match="joints that loops do not tie, or boom_z, crank"):
            with_dry_friction(systems["crank_hopper"], {"slide": 1.7})
        with pytest.raises(BadValue, match="at most 1 joint"):
            with_dry_friction(systems["crank_hopper"], {"crank": 0.1, "boom_z": 1.0})

    def test_a_leg_with_loops_whose_knee_is_not_known(self, tmp_path):
        plain = "".join(CRANK_LOOP.split("[reach]")[:1])
        leg = load(write(tmp_path, "crank_leg", CRANK_LEG, plain), base="fixed")
        with pytest.raises(BadValue, match=r"expected one with \[reach\] in its file"):
            hopping(leg, CRANK, OPENING)

    def test_a_leg_with_loops_and_no_spring(self, tmp_path):
        with pytest.raises(BadValue, match="a leg with loops has no knee"):
            hopping(crank_leg(tmp_path), CRANK)

    @pytest.mark.parametrize(
        ("given", "said"),
        [
            ("knee = { elbow = 1.0 }", "unknown joint 'elbow'"),
            ("knee = { crank = 0.0 }", "a finite number other than 0"),
            ("knee = { crank = inf }", "a finite number other than 0"),
            ("hip = { crank = 1.0 }", "a table with knee"),
            ("knee = { crank = 1.0 }\nankle = { crank = 1.0 }", "unknown key of reach 'ankle'"),
        ],
    )
    def test_a_wrong_reach(self, tmp_path, given, said):
        text = CRANK_LOOP.replace("knee = { crank = 1.0 }", given)
        with pytest.raises(BadFile) as caught:
            load(write(tmp_path, "crank_leg", CRANK_LEG, text), base="fixed")
        assert said in str(caught.value) and "\n" not in str(caught.value)
