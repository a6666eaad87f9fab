"""Slopes: against level ground under tilted gravity and against a Lagrangian."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import (
    Contact,
    Gait,
    Ground,
    HoppingLaw,
    Robot,
    bounding,
    find_gait,
    hopping,
    load,
    simulate,
)
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.modes import choose
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart, displacement, return_map
from spear_pin.hybrid.phases import contact_domains
from spear_pin.hybrid.translation import translations
from tests.biped import example
from tests.hybrid.motions import terms_of

SLOPE, HEIGHT = 0.12, 0.3
LAW = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0)
DEEP = HoppingLaw(knee_touchdown=1.2, hip_touchdown=0.6, stance_torque=7.0)
BLOCK = """<robot name="block">
  <link name="world"/><link name="rail"/><link name="block"><inertial><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="x" type="prismatic"><parent link="world"/><child link="rail"/><axis xyz="1 0 0"/>
    <limit effort="1" velocity="1" lower="-9" upper="9"/></joint>
  <joint name="z" type="prismatic"><parent link="rail"/><child link="block"/><axis xyz="0 0 1"/>
    <limit effort="1" velocity="1" lower="-9" upper="9"/></joint>
</robot>"""


def tilted(robot, slope):
    """The robot where gravity is as in the axes of a slope."""
    model = robot.model.copy()
    model.gravity.linear = 9.81 * np.array([-math.sin(slope), 0.0, -math.cos(slope)])
    return Robot(model, name=robot.name, toes=robot.toes, actuated=robot.actuated)


def in_axes(states, slope, height):
    """States (x, z, hip, knee) in the axes of the ground, the origin on it; the hip's angle is an absolute one."""
    x, z, hip, knee = np.moveaxis(np.asarray(states), -1, 0)
    z = z - height
    cosine, sine = math.cos(slope), math.sin(slope)
    return np.stack([cosine * x + sine * z, cosine * z - sine * x, hip - slope, knee], axis=-1)


def turned(rates, slope):
    """Rates of the same."""
    return in_axes(rates, slope, 0.0) + [0.0, 0.0, slope, 0.0]


class TestSlope:
    @pytest.mark.parametrize(
        ("law", "friction", "seen"), [(LAW, 0.8, "slip"), (LAW, 0.3, "stick"), (DEEP, 0.8, "chatter")]
    )
    def test_is_level_ground_under_tilted_gravity(self, free_robot, law, friction, seen):
        """Hops with their impacts, the spring, slip, and laws that alternate: every sample and every force."""
        system = hopping(free_robot, law, ground=Ground(friction, SLOPE, HEIGHT))
        level = replace(law, hip_touchdown=law.hip_touchdown - SLOPE)
        other = hopping(tilted(free_robot, SLOPE), level, contact=Contact(friction))
        q, v = system.guess()
        there = simulate(system, (q, v), 2, 1e-11)
        here = simulate(other, (in_axes(q, SLOPE, HEIGHT), turned(v, SLOPE)), 2, 1e-11)
        assert there.complete and here.complete
        named = [event.name for event in here.events if event.name != "apex"]  # by the slider's rate
        assert [event.name for event in there.events if event.name != "apex"] == named
        assert seen in {*named, *there.domain.tolist()}
        np.testing.assert_allclose(there.t, here.t, rtol=0, atol=1e-9)
        np.testing.assert_allclose(in_axes(there.q, SLOPE, HEIGHT), here.q, rtol=0, atol=1e-8)
        np.testing.assert_allclose(turned(there.v, SLOPE), here.v, rtol=0, atol=1e-7)
        np.testing.assert_allclose(there.force, here.force, rtol=0, atol=1e-5)
        for mine, its in zip(there.named("touchdown"), here.named("touchdown"), strict=True):
            np.testing.assert_allclose(mine.impulse, its.impulse, rtol=0, atol=1e-7)
            assert mine.work["impact"] == pytest.approx(its.work["impact"], abs=1e-8)

    @pytest.mark.parametrize("locked", [[], ["boom_x"]])
    def test_ledger_closes(self, locked):
        system = hopping(load("spear_ii", locked=locked), LAW, ground=Ground(0.3, SLOPE, HEIGHT))
        trajectory = simulate(system, system.guess(), 3, 1e-11)
        assert trajectory.complete and np.abs(trajectory.ledger.residual).max() < 1e-9
        assert trajectory.ledger["slip"].min() < -1e-3

    def test_ledger_of_a_bound_closes(self):
        gait = Gait.load("least_effort")
        system = with_parameters(gait.system, {"slope": 0.01, "height": HEIGHT})
        trajectory = simulate(system, system.guess(), 1, 1e-11)
        assert trajectory.complete and np.abs(trajectory.ledger.residual).max() < 1e-9

    def test_obeys_a_lagrangian(self, free_robot):
        """Every sample, forces turned into the world by hand; what sticks rests, what slides stays on the slope."""
        system = hopping(free_robot, LAW, ground=Ground(0.3, SLOPE, HEIGHT))
        trajectory = simulate(system, system.guess(), 2, 1e-10)
        along = np.array([math.cos(SLOPE), math.sin(SLOPE)])
        normal = np.array([-along[1], along[0]])
        seen = set()
        for i, at in enumerate(terms_of(trajectory)):
            v, a, (tangential, pressing) = trajectory.v[i], trajectory.a[i], trajectory.force[i, 0]
            J, drift, mode = at.jacobians["toe"], at.drifts["toe"], str(trajectory.domain[i])
            force = tangential * along + pressing * normal
            torque = np.array([0.0, 0.0, *trajectory.tau[i]])
            left = at.mass_matrix @ a + at.coriolis + at.gravity
            np.testing.assert_allclose(left, torque + trajectory.friction[i] + J.T @ force, rtol=0, atol=1e-8)
            seen.add(mode)
            if mode == "flight":
                assert tangential == pressing == 0.0
                continue
            assert abs(normal @ (J @ a + drift)) < 1e-8 and abs(normal @ J @ v) < 1e-7 and pressing > -1e-4
            assert abs(normal @ (at.toes["toe"] - [0.0, HEIGHT])) < 1e-8
            if mode == "stance":
                assert abs(along @ (J @ a + drift)) < 1e-8 and abs(tangential) <= 0.3 * pressing + 1e-4
            else:
                side = 1.0 if mode.endswith("+") else -1.0
                assert tangential == pytest.approx(-0.3 * side * pressing, abs=1e-9) and side * (along @ J @ v) > -1e-6
        assert {"stance", "flight"} < seen

    @pytest.mark.parametrize(("slope", "friction", "mode"), [
        (0.29, 0.3, "stick"), (-0.29, 0.3, "stick"), (0.293, 0.3, "slip-"), (-0.293, 0.3, "slip+"), (0.9, 1.2, "slip-"),
    ])  # fmt: skip
    def test_holds_a_block_within_the_cone(self, tmp_path, slope, friction, mode):
        """Stick if tan σ < μ; beyond, it slides down with g (sin σ - μ cos σ)."""
        (tmp_path / "block.urdf").write_text(BLOCK)
        robot = load(tmp_path / "block.urdf", toes=["block"], motors=[])
        law = lambda *_: ()  # noqa: E731
        stance = contact_domains(Domain("stance", "stance", (STICK,), law), robot.toes, {"block": None})
        domains = (*stance, Domain("flight", "flight", (OPEN,), law))
        ground = Ground(friction, slope, HEIGHT)
        system = HybridSystem("block", robot, None, {}, ground, domains, "", (), None, None)
        flow = choose(system, "stance", {}, 0.0, np.array([0.5, ground.under(0.5), *np.zeros(2 + 3)]))
        assert flow.domain.contacts == (mode,)
        down = -math.copysign(9.81 * (math.sin(abs(slope)) - friction * math.cos(slope)), slope)
        slides = np.array([math.cos(slope), math.sin(slope)]) * (0.0 if mode == "stick" else down)
        np.testing.assert_allclose(flow.a, slides, atol=1e-12)
        assert flow.force("block")[1] == pytest.approx(2 * 9.81 * math.cos(slope), rel=1e-12)
        assert flow.height("block") == pytest.approx(0.0, abs=1e-15)

    def test_every_kind_of_gait_begins_on_it(self, robot):
        ground = Ground(slope=SLOPE, height=HEIGHT)
        bound = Gait.load("least_effort").system
        systems = (
            hopping(robot, ground=ground),
            series_hopping(load("spear_ii_series", locked=["boom_x"]), ground=ground),
            bounding(bound.robot, bound.law, bound.spring, ground=ground),
            example().running(load("biped"), ground=ground),
        )
        for system in systems:
            q, v = system.guess()
            height, jacobian = ground.foot(system.robot, q, system.robot.toes[0])
            x, z = system.robot.toe_position(q, system.robot.toes[0])
            assert abs(z - HEIGHT - x * math.tan(SLOPE)) < 1e-14 and abs(height) < 1e-14
            np.testing.assert_allclose(jacobian @ v, 0.0, atol=1e-12)


class TestTranslation:
    def test_leads_along_the_ground(self, free_robot):
        """Begun elsewhere along the slope, the motion is the same; the chart and the residual leave that out."""
        system = hopping(free_robot, LAW, ground=Ground(0.8, SLOPE, HEIGHT))
        q, v = system.guess()
        (along,) = translations(system)
        np.testing.assert_allclose(along, [math.cos(SLOPE), math.sin(SLOPE), 0.0, 0.0], atol=1e-15)
        here, there = return_map(system, (q, v)), return_map(system, (q + 2.0 * along, v))
        np.testing.assert_allclose(there.state[0] - here.state[0], 2.0 * along, atol=1e-9)
        moved = displacement(system, (q, v), here.state)
        np.testing.assert_allclose(displacement(system, (q, v), there.state), moved, atol=1e-8)
        assert abs(moved[:4] @ along) < 1e-12
        local = chart(system, (q, v))
        assert local.dimension == 4 and np.abs(along @ local.q_basis).max() < 1e-14
        xi = np.array([0.02, 0.1, -0.2, 0.1])
        at = local.state(xi)
        height, jacobian = system.ground.foot(free_robot, at[0], "toe")
        assert abs(height) < 1e-15 and np.abs(jacobian @ at[1]).max() < 1e-13
        np.testing.assert_allclose(local.coordinates(at), xi, atol=2e-2)

    def test_of_what_is_locked_or_level(self, robot, free_robot):
        assert translations(hopping(robot, ground=Ground(slope=SLOPE))).shape == (0, 3)
        np.testing.assert_array_equal(translations(hopping(free_robot)), [[1.0, 0.0, 0.0, 0.0]])
        (along,) = translations(example().running(load("biped"), ground=Ground(slope=-SLOPE)))
        np.testing.assert_allclose(along[:3], [math.cos(SLOPE), -math.sin(SLOPE), 0.0], atol=1e-15)

    @pytest.mark.slow
    def test_gait_is_that_of_level_ground_under_tilted_gravity(self, free_robot):
        """Fixed point and multipliers, the parameter solved for in each by itself."""
        target = {"flight_time": 0.2, "mean_speed": 0.0}
        vary = ["stance_torque", "hip_touchdown"]
        gait = find_gait(hopping(free_robot, LAW, ground=Ground(0.8, 0.04, HEIGHT)), vary, target)
        level = hopping(tilted(free_robot, 0.04), replace(LAW, hip_touchdown=0.43))
        other = find_gait(level, vary, target)
        assert gait.residual < 1e-9 and len(gait.multipliers) == 4
        assert gait.parameters["hip_touchdown"] - 0.04 == pytest.approx(other.parameters["hip_touchdown"], abs=1e-8)
        assert gait.parameters["stance_torque"] == pytest.approx(other.parameters["stance_torque"], abs=1e-7)
        np.testing.assert_allclose(gait.multipliers, other.multipliers, rtol=0, atol=1e-5)

    @pytest.mark.slow
    def test_slope_may_be_solved_for(self, free_robot):
        """The slope on which a hip angle hops in place, of which that angle was found."""
        gait = find_gait(hopping(free_robot, LAW, ground=Ground(slope=0.03)), ["hip_touchdown"], {"mean_speed": 0.0})
        other = with_parameters(gait.system, {"slope": 0.028, "height": HEIGHT})
        again = find_gait(other, ["slope"], {"mean_speed": 0.0}, guess=gait.state)
        assert again.residual < 1e-9 and again.parameters["slope"] == pytest.approx(0.03, abs=1e-6)
        assert abs(again.system.ground.foot(free_robot, again.state[0], "toe")[0]) < 1e-14
