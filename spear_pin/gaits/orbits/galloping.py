"""From a bound in space to a gallop, in which the feet of each pair land one after the other.

The gait is continued step by step with the Gauss-Newton method: among all inputs it takes the smallest change, at the
same speed and heading. Where both feet of a pair land at once, the return map has a kink, because either foot may be
first. Derivatives there are central differences, which do not see the kink. Beyond it they are exact, where a stride
has derivatives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, require
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.leading import lead_along
from spear_pin.gaits.orbits.steering import SECOND
from spear_pin.gaits.orbits.strides import Strides
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.law import INPUTS
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.symmetry import head_state
from spear_pin.kinds import typed
from spear_pin.model.scale import scale_in_space

FIRST, SHORTEST, LONGEST = 1.0 / 16.0, 1.0 / 256.0, 0.25  # of the way: steps of the continuation
PATH_RTOL, PATH_TOLERANCE = 1e-9, 1e-6  # for the integrator and for each step's solution
FARTHEST = 0.5  # change of an unknown in a step
KEPT_BY = ("posterior_hip_torque", "posterior_hip_difference")  # speed and heading of the last solution


@typed
def find_gallop(gait: Gait, landing: Sequence[float], *, rtol: float = 1e-10) -> Gait:
    """Continues a bound in space to a gallop, by increasing the time between the landings of each pair's feet.

    Args:
        gait: a gait of `bounding_in_space`, without feedback.
        landing: times from the touchdown of the left foot to the touchdown of the right foot, for the posterior and the
            anterior pair, in s.
        rtol: relative tolerance of the integrator.

    Returns:
        the gait, at the speed of the one given, straight ahead.

    Raises:
        BadValue: the gait is not of `bounding_in_space` or has feedback, or `landing` is not two finite times.
        NoGait: the continuation gets stuck on the way; the text says where.

    Example:
        >>> from spear_pin import Gait, in_space
        >>> from spear_pin.gaits.orbits.galloping import find_gallop
        >>> bound = in_space(Gait.load("long_stride_3.00"))  # doctest: +SKIP
        >>> gallop = find_gallop(bound, (0.02, 0.02))  # three minutes  # doctest: +SKIP
    """
    if gait.system.kind != "bounding_in_space" or feedback_of(gait.system) is not None:
        raise BadValue("gait", gait, "one of bounding_in_space, without feedback")
    if len(landing) != len(LEGS):
        raise BadValue("landing", landing, "two times, in s")
    for i, time in enumerate(landing):
        require(f"landing[{i}]", time, math.isfinite, "a finite number, in s")
    second = SECOND * scale_in_space(gait.system.robot).time
    path = Strides(gait.system, gait.state, INPUTS, second, PATH_RTOL)
    x = np.zeros(path.unknowns)
    begin = path.values(x)
    wanted = np.array([*np.zeros(path.n + 1), begin[path.n + 1], *(gap / second for gap in landing)])

    def solve(share: float, near: Array) -> Array:
        values = begin + share * (wanted - begin)
        return path.solved(near, lambda found: found - values, np.ones_like, PATH_TOLERANCE, FARTHEST)

    way = lead_along(solve, x, first=FIRST, shortest=SHORTEST, longest=LONGEST)
    if way.failure is not None:
        reason = f"the gallop is lost after {way.done:.0%} of the way to these times: {way.failure.reason}"
        raise NoGait(reason, way.failure.residual, remedy="smaller landing times")
    system, state = path.system(way.end), path.state(way.end)
    measures = {"mean_speed": system.measures["mean_speed"](return_map(system, state, rtol)), "turn": 0.0}
    found = gait_beside(system, head_state(*state), KEPT_BY, measures, rtol)
    q, v = found.state
    return found.with_law(nominal=(*q.tolist(), *v.tolist()))
