"""Gaits and trajectories that many tests look at, solved once a process."""

import pytest

from spear_pin import HoppingLaw, find_gait, hopping, load, simulate
from spear_pin.model.loading import ROBOTS


def speed_at_lift_off(run):
    """Forward speed of the hip at lift-off, a measure of one cycle."""
    return run.event("lift_off").v_before[0]


@pytest.fixture(scope="session")
def robot():
    """SPEAR-II on its slider, unable to move forward."""
    return load("spear_ii", locked=["boom_x"])


@pytest.fixture(scope="session")
def free_robot():
    """SPEAR-II, free to move forward."""
    return load("spear_ii")


@pytest.fixture(scope="session")
def rubbing_robot(tmp_path_factory):
    """The same with 2.5 N·s/m of viscous friction on the slider, from <dynamics damping=...> of its URDF."""
    text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
    position = text.index("</joint>", text.index('<joint name="boom_z"'))
    path = tmp_path_factory.mktemp("robots") / "rubbing.urdf"
    path.write_text(text[:position] + '<dynamics damping="2.5"/>' + text[position:], encoding="utf-8")
    return load(path, toes=["toe"], locked=["boom_x"])


@pytest.fixture(scope="session")
def hop(robot):
    """The hop in place with 0.2 s of flight."""
    return find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2})


@pytest.fixture(scope="session")
def hops(hop):
    """Eleven of these hops."""
    return simulate(hop.system, hop.state, cycles=11)


@pytest.fixture(scope="session")
def free_hop(free_robot):
    """The hop in place with 0.2 s of flight, boom_x free: the hip angle is what keeps it in place."""
    system = hopping(free_robot, HoppingLaw(hip_touchdown=0.5))
    target = {"flight_time": 0.2, speed_at_lift_off: 0.0}
    return find_gait(system, vary=["stance_torque", "hip_touchdown"], target=target)
