"""Hops of a leg with a foot on a sprung ankle, which no motor drives."""

import numpy as np
import pytest

from spear_pin import HoppingLaw, find_gait, hopping, load, simulate
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues
from tests.model.looped import SLIDE, fixed, joint, lump, rod, write

pytestmark = pytest.mark.slow
URDF = "".join(
    [
        '<robot name="ankled"><link name="world"/>',
        lump("body", 1.5),
        rod("thigh", 0.5, 0.18),
        rod("shank", 0.2, 0.18),
        '<link name="foot"><inertial><origin xyz="0.02 0 -0.02"/><mass value="0.08"/>',
        '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="toe"/>',
        SLIDE,
        joint("hip", "revolute", "body", "thigh"),
        joint("knee", "revolute", "thigh", "shank", at=-0.18, axis="0 1 0"),
        joint("ankle", "revolute", "shank", "foot", at=-0.18).replace("</joint>", '<dynamics damping="0.01"/></joint>'),
        fixed("sole", "foot", "toe", at=-0.03).replace('xyz="0 0 -0.03"', 'xyz="0.06 0 -0.03"'),
        "</robot>",
    ]
)
TOML = """toes = ["toe"]

[motors.hip]
ratio = 9.0
rotor_inertia = 3.3e-5

[motors.knee]
ratio = 9.0
rotor_inertia = 3.3e-5

[reach]
knee = { knee = 1.0 }
hip = { hip = 1.0 }

[springs.knee]
stiffness = 8.0
damping = 0.05

[springs.achilles]
path = { ankle = 1.0 }
stiffness = 20.0
damping = 0.02
rest = 0.0
unilateral = false
"""
LAW = HoppingLaw(
    1.0,
    hip_touchdown=0.4,
    stance_torque=1.0,
    frequency=3.5,
    hip_gain=6.0,
    hip_damping=0.2,
    knee_gain=6.0,
    knee_damping=0.1,
    hold_extension=True,
    minimum_force=3.0,
)


@pytest.fixture(scope="module")
def gait(tmp_path_factory):
    leg = load(write(tmp_path_factory.mktemp("ankle"), "ankled", URDF, TOML), base="fixed")
    return find_gait(hopping(leg, LAW), vary=["stance_torque"], target={"flight_time": 0.12})


def test_it_hops_and_its_ankle_stores_energy(gait):
    assert gait.stable and len(gait.multipliers) == 5
    hop = simulate(gait.system, gait.state, cycles=2)
    assert np.abs(hop.ledger.residual).max() < 1e-8
    ankle = hop.q[hop.phase == "stance", hop.coordinates.index("ankle")]
    assert np.ptp(ankle) > 0.05
    np.testing.assert_allclose(
        hop.spring[:, hop.spring_joints.index("ankle")], -20.0 * hop.q[:, hop.coordinates.index("ankle")], atol=1e-12
    )
    assert hop.actuated == ("hip", "knee")


@pytest.mark.extra("heyoka")
def test_lanes_and_multipliers_are_those_of_the_reference_engine(gait):
    last = simulate(gait.system, gait.state, cycles=2).named("touchdown")[-1]
    lanes = simulate_many(gait.system, *(part[None] for part in gait.state), cycles=2)
    np.testing.assert_allclose(lanes.q[0], last.q, atol=1e-9)
    own = with_parameters(gait.system, gait.parameters)
    found = eigenvalues(differentiate_return_map(own, gait.state))
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(gait.multipliers), atol=1e-6)
