"""Every question that a robot answers, a state to ask it at, and the refusal of a call."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.errors import SpearError

# every query with its arguments after q and v
QUERIES = {
    "mass_matrix": lambda robot, q, v: robot.mass_matrix(q),
    "coriolis_matrix": lambda robot, q, v: robot.coriolis_matrix(q, v),
    "gravity": lambda robot, q, v: robot.gravity(q),
    "bias": lambda robot, q, v: robot.bias(q, v),
    "kinetic_energy": lambda robot, q, v: robot.kinetic_energy(q, v),
    "potential_energy": lambda robot, q, v: robot.potential_energy(q),
    "frame_position": lambda robot, q, v: robot.frame_position(q, robot.toes[0]),
    "toe_position": lambda robot, q, v: robot.toe_position(q, robot.toes[0]),
    "toe_jacobian": lambda robot, q, v: robot.toe_jacobian(q, robot.toes[0]),
    "toe_drift": lambda robot, q, v: robot.toe_drift(q, v, robot.toes[0]),
    "actuation_matrix": lambda robot, q, v: robot.actuation_matrix,
    "mass": lambda robot, q, v: robot.mass,
}
ARRAYS = [query for query in QUERIES if not query.endswith("energy") and query != "mass"]
each_query = pytest.mark.parametrize("query", QUERIES)


def state(robot):
    """A configuration away from zero and rates."""
    v = np.linspace(-1.0, 1.5, robot.nv)
    return pin.integrate(robot.model, pin.neutral(robot.model), 0.3 * v + 0.1), v


def refusal(kind, call):
    """The error of a call, of exactly this kind, whose text must be one line."""
    with pytest.raises(SpearError) as caught:
        call()
    assert type(caught.value) is kind
    assert len(str(caught.value).splitlines()) == 1
    return caught.value
