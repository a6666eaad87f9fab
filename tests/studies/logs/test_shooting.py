"""A played leg's motion and derivatives: beside the event-exact simulation, differences, and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spear_pin import hopping, load, simulate
from spear_pin.hybrid.domain import Mount
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.pull import Pull
from spear_pin.studies.logs.played import SLOW, Playing, find_number, make_played
from spear_pin.studies.logs.shooting import Shooter
from tests.studies.logs.crank_leg import spring

pytestmark = pytest.mark.extra("heyoka")
FORCES = {
    "torque_scale": 1.1,
    "crank_friction": 0.08,
    "boom_z_friction": 1.7,
    "leg_hysteresis": 2.0,
    "leg_shift": -0.004,
}
OVER = ("torque_scale", "crank_armature", "crank_viscous", "crank_friction", "stiffness", "leg_hysteresis", "leg_shift")


def begun(leg):
    """A state of the crank leg in stance."""
    from spear_pin.studies.logs.measured import Measured

    robot = leg.robot
    measured = Measured(robot, ("crank",))
    return measured.state("stance", np.array([-0.3]), np.array([6.0]), measured.configuration(np.array([-0.3]), None))


def shot(leg, y, over=(), dy=None, steps=1, end=0.15):
    t = np.arange(0.0, end, 0.00125)
    torque = (-1.5 - 8.0 * t**2)[:, None]
    dy = np.zeros((len(y), max(len(over), 1))) if dy is None else dy
    return Shooter(leg, tuple(over)).shoot("stance", t, torque, y, dy, y[:4], steps=steps)


@pytest.fixture(scope="module")
def leg(sprung):
    return with_numbers(make_played(sprung), FORCES)


def test_is_the_motion_of_the_crank_s_equation(leg):
    """Two sources: the equation of motion of a crank that lifts a mass, integrated by SciPy."""
    a, b, body, g = 0.07, 0.15, 1.15, 9.81
    inertia, rest, c = 0.00473, spring().rest + FORCES["leg_shift"], 0.3

    def along(x):  # leg, its slope and its bend
        root = np.sqrt(b**2 - (a * np.cos(x)) ** 2)
        slope = -a * np.cos(x) + a**2 * np.sin(x) * np.cos(x) / root
        bend = a * np.sin(x) + a**2 * np.cos(2 * x) / root - (a**2 * np.sin(x) * np.cos(x)) ** 2 / root**3
        return -a * np.sin(x) + root, slope, bend

    def rates(t, y):
        (_, v), (length, slope, bend) = y, along(y[0])
        stretch = c - length - rest
        pull = 400.0 * stretch - FORCES["leg_hysteresis"] * np.tanh(slope * v / SLOW["m"])
        rub = FORCES["boom_z_friction"] * np.tanh(slope * v / SLOW["m"])
        force = 1.1 * (-1.5 - 8.0 * t**2) - 0.021 * v - FORCES["crank_friction"] * np.tanh(v / SLOW["rad"])
        force += slope * (pull - rub - body * g)
        return v, (force - body * slope * bend * v**2) / (inertia + body * slope**2)

    found = shot(leg, begun(leg), steps=4)
    exact = solve_ivp(rates, (0.0, found.t[-1]), (-0.3, 6.0), t_eval=found.t, rtol=1e-10, atol=1e-12, max_step=1e-3)
    # crank and rod have a gram each, which the equation leaves out
    assert np.abs(found.y[:, 1] - exact.y[0]).max() < 5e-3 * np.ptp(exact.y[0])


@pytest.mark.parametrize("name", OVER)
def test_derivatives_are_those_of_differences(leg, name):
    y = begun(leg)
    found = shot(leg, y, [name])
    from spear_pin.hybrid.parameters import number

    value = number(leg, name)
    h = 1e-5 * abs(value)
    ends = [shot(with_numbers(leg, {name: value + step}), y).y for step in (h, -h)]
    difference = (ends[0] - ends[1]) / (2.0 * h)
    assert found.dy[:, :, 0] == pytest.approx(difference, rel=1e-5, abs=1e-6 * np.abs(difference).max())


def test_steps_converge_with_the_fourth_power(bare):
    leg = make_played(bare)
    ends = [shot(leg, begun(leg), steps=steps).y[-1] for steps in (1, 2, 16)]
    coarse, fine = (np.abs(end - ends[-1]).max() for end in ends[:2])
    assert fine < coarse / 12.0
    assert coarse < 1e-7


def test_is_what_the_simulation_does_with_a_latched_spring():
    """SPEAR-II in stance: the switched spring rests where it was latched; torques from the simulation."""
    robot = load("spear_ii", locked=["boom_x"])
    system = hopping(robot)
    run = simulate(system, system.guess(), 1, samples=2000, progress=False)
    ends = min(event.time for event in run.events if event.name == "torque_switch")
    last = np.searchsorted(run.t, ends) - 5
    places = np.arange(0, last, 5)
    leg = make_played(system)
    y = np.concatenate([run.q[0], run.v[0]])
    found = Shooter(leg).shoot("stance", run.t[places], run.u[places], y, np.zeros((6, 1)), run.q[0], steps=2)
    assert found.y[-1, :3] == pytest.approx(run.q[places[-1]], abs=1e-7)
    assert found.forces[1:, 1].min() > 0.0


def test_names_of_a_fixed_spring_lead_to_numbers_of_the_law(sprung, bare):
    assert find_number(sprung, "rest") == ("leg_shift", spring().rest)
    assert find_number(sprung, "hysteresis") == ("leg_hysteresis", 0.0)
    assert find_number(bare, "crank_armature") == ("crank_armature", 0.0)


@pytest.mark.parametrize(("stretch", "way"), [(5e-4, 1.0), (2e-3, 1.0), (2e-3, -1.0), (5e-4, -1.0)])
def test_hysteresis_is_that_of_the_simulation(stretch, way):
    """The same pull as `Mount.lost` has it, beyond the first tenth of a millimetre."""
    own = replace(spring(1410.0), unilateral=True, hysteresis=2.26)
    force = own.torque(stretch)
    mount = Mount("leg", own, own.rest, path=own.path, way="way")
    law = Playing((), (), (), (("leg", "leg"),), ("leg",))
    pull = Pull("leg", own, stretch, way, force, 0.0, 0.0, None, 0.0)
    assert law._whole(pull, 0.0, 2.26, FLOATS) == pytest.approx(
        force + mount.lost(own, force, {"way": way}, FLOATS), rel=1e-3, abs=1e-3
    )


def test_a_spring_that_only_pulls_has_no_hysteresis_while_it_is_slack(crank):
    own = replace(spring(), unilateral=True, rest=0.2)  # longer than the leg ever makes it
    slack = with_numbers(make_played(hopping(crank, spring={"leg": own})), {"leg_hysteresis": 5.0})
    none = make_played(hopping(crank, spring={"leg": replace(own, stiffness=0.0)}))
    y = begun(slack)
    assert shot(slack, y).y == pytest.approx(shot(none, y).y, abs=1e-12)
