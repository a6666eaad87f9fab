"""From a bound in space to a gallop, in which the feet of each pair land one after the other.

The gait is continued step by step with the Gauss-Newton method: among all inputs it takes the smallest change, at the
same speed and heading. Where both feet of a pair land at once, the return map has a kink, because either foot may be
first. Derivatives there are central differences, which do not see the kink. Beyond it they are exact, or one-sided
differences where a stride has none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, require
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.orbits.steering import SECOND
from spear_pin.gaits.orbits.strides import Strides
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.law import INPUTS
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.symmetry import headed
from spear_pin.kinds import typed
from spear_pin.model.scale import scale_in_space

FIRST, SHORTEST, LONGEST = 1.0 / 16.0, 1.0 / 256.0, 0.25  # of the way: steps of the continuation
PATH_RTOL, PATH_TOLERANCE = 1e-9, 1e-6  # for the integrator and for each step's solution
ITERATIONS, SLOW, FARTHEST, WORSE = 12, 0.5, 0.5, 3.0
CENTRAL, ONE_SIDED = 1e-5, 1e-6
KEPT_BY = ("posterior_hip_torque", "posterior_hip_difference")  # speed and heading of the last solution


@typed
def galloping(gait: Gait, landing: Sequence[float], *, rtol: float = 1e-10) -> Gait:
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
        >>> from spear_pin.gaits.orbits.galloping import galloping
        >>> bound = in_space(Gait.load("long_stride_3.00"))  # doctest: +SKIP
        >>> gallop = galloping(bound, (0.02, 0.02))  # three minutes  # doctest: +SKIP
    """
    if gait.system.kind != "bounding_in_space" or feedback_of(gait.system) is not None:
        raise BadValue("gait", gait, "one of bounding_in_space, without feedback")
    if len(landing) != len(LEGS):
        raise BadValue("landing", landing, "two times, in s")
    for i, time in enumerate(landing):
        require(f"landing[{i}]", time, math.isfinite, "a finite number, in s")
    second = SECOND * scale_in_space(gait.system.robot).time
    path = _Path(gait.system, gait.state, INPUTS, second, PATH_RTOL)
    x = np.zeros(path.unknowns)
    begin, J = path.values(x), path.slopes(x, CENTRAL)
    wanted = path.wanted(begin, landing)
    done, step = 0.0, FIRST
    while done < 1.0:
        reach = min(1.0, done + step)
        try:
            x, J = path.solved(x, J, begin + reach * (wanted - begin))
            done, step = reach, min(2.0 * step, LONGEST)
        except NoGait as failure:
            step *= 0.5
            if step < SHORTEST:
                reason = f"the gallop is lost after {done:.0%} of the way to these times: {failure.reason}"
                raise NoGait(reason, failure.residual, remedy="smaller landing times") from None
            if done:
                J = path.slopes(x, ONE_SIDED, path.values(x))
    system, state = path.system(x), path.state(x)
    measures = {"mean_speed": system.measures["mean_speed"](return_map(system, state, rtol)), "turn": 0.0}
    found = gait_beside(system, headed(*state), KEPT_BY, measures, rtol)
    q, v = found.state
    return found.with_law(nominal=(*q.tolist(), *v.tolist()))


class _Path(Strides):
    """Equations whose solutions are gallops."""

    def wanted(self, begin: Array, gaps: Sequence[float]) -> Array:
        """Returns the values that a gallop has: it closes, straight ahead, at the given speed."""
        return np.array([*np.zeros(self.n + 1), begin[self.n + 1], *(gap / self._second for gap in gaps)])

    def solved(self, x: Array, J: Array, wanted: Array) -> tuple[Array, Array]:
        """Returns the unknowns that give the wanted values, and derivatives near there, updated by Broyden's rule."""
        values, expected, fresh = self.values(x), np.inf, False
        for n in range(ITERATIONS):
            off = values - wanted
            size = float(np.abs(off).max())
            if size <= PATH_TOLERANCE:
                return x, J
            if n > 1 and size > expected and not fresh:
                J, fresh = self.slopes(x, ONE_SIDED, values), True
            else:
                fresh = False
            whole: Array = -np.asarray(np.linalg.lstsq(J, off, rcond=1e-10)[0], np.float64)
            capped = min(1.0, FARTHEST / float(np.abs(whole).max())) * whole
            step, after = self._shortened(x, capped, wanted, size)
            J = J + np.outer(after - values - J @ step, step) / float(step @ step)
            taken = float(np.abs(step).max() / np.abs(whole).max())
            x, values, expected = x + step, after, (1.0 - (1.0 - SLOW) * taken) * size
        raise NoGait("Newton's method did not converge", size)

    def _shortened(self, x: Array, step: Array, wanted: Array, size: float) -> tuple[Array, Array]:
        """Halves a step until the values after it are not much worse; returns the step and the values."""
        for _ in range(3):
            try:
                after = self.values(x + step)
                if float(np.abs(after - wanted).max()) <= max(WORSE * size, 1e-3):
                    return step, after
            except NoGait:
                pass
            step = 0.5 * step
        raise NoGait("no step reduces the residual", size)
