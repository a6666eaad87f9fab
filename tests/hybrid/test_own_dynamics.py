"""Systems of one's own equations: the example of the docstring, and what is refused. Walkers are in test_walkers."""

import doctest
from dataclasses import dataclass

import pytest

from spear_pin import find_gait, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid import own_dynamics
from spear_pin.hybrid.automaton import STICK, Domain, Guard, Reset
from spear_pin.studies.comparison.measures import of_side
from spear_pin.studies.comparison.sides import Side
from tests.walkers import example


def test_the_example():
    failed, attempted = doctest.testmod(own_dynamics)
    assert attempted and not failed


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        ({"units": {"angle": "°"}}, BadValue, "'m' or 'rad'"),
        ({"domains": [Domain("roll", "roll", (STICK,), lambda *_: [0.0])]}, BadValue, "none, as the robot has no toes"),
        ({"section": "stike"}, UnknownName, "unknown section 'stike'"),
    ],
)
def test_refuses_what_does_not_fit(change, error, said):
    wheel = example().rimless_wheel()
    right = {"units": {"angle": "rad"}, "domains": wheel.domains, "section": "strike"}
    with pytest.raises(error, match=said):
        own_dynamics.own_dynamics("wheel", law=wheel.law, guess=lambda p: ([0.0], [1.0]), **right | change)


@dataclass(frozen=True)
class Ball:
    wind: float = 2.0
    kick: float = 2.0


def test_measures_leave_out_what_is_per_weight():
    """A ball that is kicked up at each bounce, and driven by a wind; without gravity there is no weight."""

    def fly(t, q, v, held, p, dyn, ops):
        return [p.wind - v[0], -9.81]

    def kicked(q, v, held, p, ops):
        return q, [v[0], p.kick - 0.5 * v[1]]

    lands = Guard("lands", lambda t, q, v, held, p, dyn, ops: q[1], Reset(jump=kicked, phase="flight"))
    flight = Domain("flight", "flight", (), fly, guards=(lands,))
    units, options = {"x": "m", "z": "m"}, {"section": "lands", "cyclic": ["x"]}
    ball = own_dynamics.own_dynamics("ball", units, Ball(), [flight], **options, guess=lambda p: ([0, 0], [1.9, 3.9]))
    gait = find_gait(ball)
    of_motors = of_side(Side("ball", "gait", ball.robot, simulate(ball, gait.state, cycles=1), gait))["motors"]
    assert {("peak torque, x", "N"), ("rms torque, z", "N"), ("peak speed, z", "m/s")} <= of_motors.keys()
    whole = gait.sensitivity(["wind", "kick"])
    units = {"peak_speed_z": "m/s", "peak_torque_x": "N", "least_z": "m", "effort": "N²·s"}
    assert {name: whole.output_units[name] for name in units} == units
    found = whole.derivatives
    assert found["mean_speed"] == pytest.approx([1.0, 0.0], abs=1e-8)
    assert found["period"] == pytest.approx([0.0, 4.0 / 9.81], abs=1e-8)
    assert "cost_of_transport" not in found
