"""The bounding gaits that ship, each with one stride of it, computed once a process."""

from dataclasses import replace
from functools import cache

import pytest

from spear_pin import Gait, simulate
from spear_pin.gaits import library
from spear_pin.gaits.virtual_constraints import Outputs
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.lagrangian import Q_SPEAR_PAIR, quadruped
from tests.slow import slow_but

NAMES = [name for name in library.names() if Gait.load(name).system.kind == "bounding"]
PHASES = ("posterior_stance", "flight_1", "anterior_stance", "flight_2")
POSTERIOR, ANTERIOR = (((2, 1.0), (3, 1.0), (4, -0.5)), ((4, 1.0),)), (((2, 1.0), (5, 1.0), (6, -0.5)), ((6, 1.0),))
BOTH = (*POSTERIOR, *ANTERIOR)
OUTPUTS = {  # (5.9), of which phase variable
    "posterior_stance": Outputs(ANTERIOR, POSTERIOR[0], (2, 3)),
    "flight_1": Outputs(BOTH, ((0, 1.0),), (0, 1, 2, 3)),
    "anterior_stance": Outputs(POSTERIOR, ANTERIOR[0], (0, 1)),
    "flight_2": Outputs(BOTH, ((0, 1.0),), (0, 1, 2, 3)),
}
LEGS = {"posterior": (0, 3, 4, 1.0), "anterior": (1, 5, 6, -1.0)}  # row of the toe, hip, knee, sense of flexion
QUICK = ("least_effort", "force_lift_off", "long_stride")  # one of each family, whatever else takes long
each_gait = pytest.mark.parametrize("name", slow_but(NAMES, *QUICK))


@cache
def gait(name):
    return Gait.load(name)


@cache
def stride(name):
    """One stride, its motion kept."""
    return run(gait(name).system, gait(name).state, 1, Options(rtol=1e-11, keep=True))


@cache
def trajectory(name):
    """One stride, sampled."""
    return simulate(gait(name).system, gait(name).state, 1, 1e-11)


@cache
def rigid(name):
    """The symbolic Lagrangian of the gait's robot."""
    varied = dict(gait(name).system.robot.varied)
    hip, knee = varied.pop("hip_ratio", 60.0) / 60.0, varied.pop("knee_ratio", 15.0) / 15.0
    rotors = Q_SPEAR_PAIR.rotors[0] * hip**2, Q_SPEAR_PAIR.rotors[1] * knee**2
    return quadruped(
        hip_offset=varied.pop("hip_distance", 0.7) / 2,
        torso=(varied.pop("torso_mass", 35.0), varied.pop("torso_inertia", 2.1)),
        pair=replace(Q_SPEAR_PAIR, rotors=rotors),
        **varied,
    )
