"""The rotary boom: against Lagrange's equation, a pendulum, differences of the energy, and the slider as its limit."""

import pickle

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from spear_pin import find_gait, hopping, load, simulate, vary
from spear_pin.errors import BadValue
from spear_pin.hybrid.result import Moment
from spear_pin.model.boom import Arm, RotaryBoom, on_rotary_boom
from tests.hybrid.test_dry_friction import in_the_air

SLIDER = load("spear_ii", locked=["boom_x"])
STIFF = load("spear_ii", locked=["boom_x", "hip", "knee"])
LOW = RotaryBoom(radius=0.9, pivot=0.3, inertia=0.8)  # at angles that matter


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(1)
    return [(rng.uniform([0.1, -1, 0], [0.9, 1, 2]), rng.normal(size=3)) for _ in range(8)]


def test_what_it_adds_is_lagranges():
    """A mass at the end of an arm with inertia, free to move on the arc."""
    t, m, R, inertia, pivot = sp.symbols("t m R I p", positive=True)
    z = sp.Function("z")(t)
    phi = sp.asin((z - pivot) / R)
    aside = R * (1 - sp.cos(phi))
    kinetic = m * (z.diff(t) ** 2 + aside.diff(t) ** 2) / 2 + inertia * phi.diff(t) ** 2 / 2
    row = kinetic.diff(z.diff(t)).diff(t) - kinetic.diff(z)
    place = {m: 6.8, R: LOW.radius, inertia: LOW.inertia, pivot: LOW.pivot}
    for height, rate, acceleration in ((0.9, -1.3, 4.0), (0.05, 0.7, -9.0), (0.3, 2.0, 1.0)):
        values = {z.diff(t, 2): acceleration, z.diff(t): rate, z: height}
        expected = float(row.subs(place).subs(z.diff(t, 2), acceleration).subs(z.diff(t), rate).subs(z, height))
        _, added, slope = Arm(LOW, 0, 6.8)(np.array([height]))
        assert values and (6.8 + added) * acceleration + 0.5 * slope * rate**2 == pytest.approx(expected, rel=1e-12)


def test_equations_of_motion_by_differences_of_the_energy(states):
    """Ḋ v - ½ ∂(vᵀ D v)/∂q + ∂V/∂q, and Ḋ - 2C skew-symmetric."""
    robot, h = on_rotary_boom(SLIDER, LOW), 1e-6
    for q, v in states:
        rates = (robot.mass_matrix(q + h * v) - robot.mass_matrix(q - h * v)) / (2 * h)

        def slope(energy, q=q):
            return np.array([(energy(q + step) - energy(q - step)) / (2 * h) for step in h * np.eye(3)])

        kinetic, potential = slope(lambda q, v=v: robot.kinetic_energy(q, v)), slope(robot.potential_energy)
        np.testing.assert_allclose(robot.bias(q, v), rates @ v - kinetic + potential, atol=1e-7)
        coriolis = robot.coriolis_matrix(q, v)
        np.testing.assert_allclose(coriolis @ v + robot.gravity(q), robot.bias(q, v), atol=1e-12)
        skew = rates - 2 * coriolis
        np.testing.assert_allclose(skew, -skew.T, atol=1e-7)


def test_energy_of_arc_and_arm(states):
    for q, v in states:
        phi = float(LOW.elevation(q[0]))
        aside, turning = v[0] * np.tan(phi), v[0] / (LOW.radius * np.cos(phi))
        expected = SLIDER.kinetic_energy(q, v) + 0.5 * 6.8 * aside**2 + 0.5 * 0.8 * turning**2
        assert on_rotary_boom(SLIDER, LOW).kinetic_energy(q, v) == pytest.approx(expected, rel=1e-12)
        assert LOW.sideways(q[0]) == pytest.approx(0.9 * (1 - np.cos(phi)))


def test_in_free_fall_a_stiff_leg_is_a_pendulum():
    """(m R² + I) φ̈ = -m g R cos φ."""
    m, start = STIFF.mass, np.array([0.95])
    system = in_the_air(on_rotary_boom(STIFF, LOW))
    fallen = simulate(system, (start, np.array([0.8])), rtol=1e-11, progress=False)
    floor = fallen.named("floor")[0]

    def flow(t, y):
        return [y[1], -m * 9.81 * 0.9 * np.cos(y[0]) / (m * 0.9**2 + 0.8)]

    phi = float(LOW.elevation(0.95))
    found = solve_ivp(flow, (0, floor.time), [phi, 0.8 / (0.9 * np.cos(phi))], "DOP853", rtol=1e-12, atol=1e-13)
    angle, rate = found.y[:, -1]
    assert floor.q[0] == pytest.approx(0.3 + 0.9 * np.sin(angle), abs=1e-9)
    assert floor.v[0] == pytest.approx(0.9 * np.cos(angle) * rate, abs=1e-9)


def test_energy_is_kept_by_a_limp_leg():
    robot = on_rotary_boom(SLIDER, LOW)
    q, v = np.array([1.0, 0.4, 0.9]), np.array([0.5, 3.0, -4.0])
    system = in_the_air(robot, lambda *_: (0.0, 0.0))
    fallen = simulate(system, Moment(q, v, "air", {}), rtol=1e-11, progress=False)
    each = zip(fallen.q, fallen.v, strict=True)
    energy = [robot.kinetic_energy(*pair) + robot.potential_energy(pair[0]) for pair in each]
    assert len(energy) > 50 and np.ptp(energy) < 1e-8
    i = len(energy) // 2
    np.testing.assert_allclose(robot.mass_matrix(fallen.q[i]) @ fallen.a[i], -robot.bias(fallen.q[i], fallen.v[i]))


@pytest.fixture(scope="module")
def hops(hop):
    """The slider's hop, and those on an arm of 1 kg·m² and 2, 4 and 8 m, searched for from there."""
    arms = [on_rotary_boom(SLIDER, RotaryBoom(radius, inertia=1.0)) for radius in (2.0, 4.0, 8.0)]
    target = {"flight_time": 0.2}
    return hop, [find_gait(hopping(arm, hop.system.law), ["stance_torque"], target, guess=hop.state) for arm in arms]


@pytest.mark.slow
def test_the_ledger_closes(hops):
    run = simulate(hops[1][0].system, hops[1][0].state, 2, progress=False)
    assert run.complete and np.abs(run.ledger.residual).max() < 1e-8


@pytest.mark.slow
def test_the_slider_is_its_limit(hops):
    """Like 1/R² in torque, apex and multipliers."""
    slider, booms = hops
    figures = [
        np.array(
            [
                each.parameters["stance_torque"],
                simulate(each.system, each.state, progress=False).named("apex")[0].q[0],
                each.multipliers[0].real,
                abs(each.multipliers[1]),
            ]
        )
        for each in (slider, *booms)
    ]
    errors = [figure - figures[0] for figure in figures[1:]]
    for coarse, fine in zip(errors, errors[1:], strict=False):
        np.testing.assert_allclose(coarse / fine, 4.0, atol=0.2)
    assert errors[0][:2] == pytest.approx([-0.260, -0.0017], abs=1e-3)


def test_an_endless_arm_is_the_slider():
    start = hopping(SLIDER).guess()
    runs = [
        simulate(hopping(robot), start, progress=False) for robot in (SLIDER, on_rotary_boom(SLIDER, RotaryBoom(1e7)))
    ]
    np.testing.assert_allclose(runs[1].q[-1], runs[0].q[-1], atol=1e-9)


def test_it_remembers_what_was_varied_and_can_be_pickled():
    plain = vary(SLIDER, boom_damping=3.0)
    robot = on_rotary_boom(plain, LOW)
    again = pickle.loads(pickle.dumps(robot))
    q = [0.6, 0.5, 1.0]
    assert robot.varied == {"boom_damping": 3.0} and robot.model.damping[0] == 3.0 and again.added.boom == LOW
    np.testing.assert_array_equal(again.mass_matrix(q), robot.mass_matrix(q))
    after = vary(on_rotary_boom(SLIDER, LOW), boom_damping=3.0)
    np.testing.assert_array_equal(after.mass_matrix(q), robot.mass_matrix(q))
    assert after.model.damping[0] == 3.0
    lighter = on_rotary_boom(vary(SLIDER, knee_mass=0.4), LOW)
    assert vary(lighter, boom_damping=3.0).model == vary(SLIDER, knee_mass=0.4, boom_damping=3.0).model
    assert plain.mass_matrix(q)[0, 0] == pytest.approx(6.8) and robot.mass_matrix(q)[0, 0] > 8.0


def test_beyond_reach():
    robot = on_rotary_boom(SLIDER, RotaryBoom(0.5, 0.2))
    with pytest.raises(BadValue, match=r"^q\[0\] is 0.8; expected within the arm's reach, -0.25 to 0.65 m$"):
        robot.mass_matrix([0.8, 0.0, 0.0])
    thrown = simulate(
        in_the_air(on_rotary_boom(STIFF, RotaryBoom(0.8, 0.2))),
        (np.array([0.65]), np.array([4.0])),
        progress=False,
    )
    assert thrown.reason in ("not_finite", "step_size") and np.isfinite(thrown.q).all()


@pytest.mark.parametrize("values", [{"radius": 0.0}, {"radius": np.nan}, {"inertia": -1.0}, {"pivot": np.inf}])
def test_bad_boom(values):
    with pytest.raises(BadValue, match="^RotaryBoom."):
        RotaryBoom(**values)


def test_bad_robot():
    for robot in (load("spear_ii"), load("q_spear"), on_rotary_boom(SLIDER)):
        with pytest.raises(BadValue, match="^robot is "):
            on_rotary_boom(robot)
