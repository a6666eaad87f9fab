"""A turning gait beside another: of all inputs that turn it as wanted, those that change least.

Where both feet of a pair land long after each other, the impact of the second throws the first up. So the time between
them is kept within bounds by the inputs, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import NoGait
from spear_pin.gaits.orbits.balance import unit_of
from spear_pin.gaits.spatial.legs import SIDES
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.symmetry import headed

Array = NDArray[np.float64]
STEERED_BY = (
    *(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ("hip_difference", "leg_difference")),
    *(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ("adduction", "adduction_torque")),
    *("posterior_hip_torque", "posterior_leg_touchdown", "anterior_leg_touchdown"),
)
GAP = 0.004  # s: at most between both touchdowns of a pair
SECOND = 0.1  # s: what counts as one of that time
ITERATIONS, SLOW, LONGEST = 14, 0.3, 0.3
DIFFERENCE = 1e-6


def footfall_gap(run: Run, pair: str, event: str = "touchdown") -> float:
    """Time from the first touchdown, or "lift_off", of a pair's left foot in a stride to the right one's, in s."""
    times = {each.name: each.time for each in reversed(run.events)}
    left, right = (times.get(f"{pair}_{side}_{event}", np.nan) for side in SIDES)
    return float(right - left)


def turned(system: HybridSystem, state: State, turn: float, speed: float, rtol: float) -> tuple[HybridSystem, State]:
    """The system and state that turn by an angle in a stride, at a speed, beside those that all but do.

    Gauss and Newton's method on the state and `STEERED_BY`, of all steps the shortest.

    Args:
        system: in space.
        state: on its section.
        turn: of the heading in a stride, to the left, in rad.
        speed: along the heading, in m/s.
        rtol: relative tolerance of the integrator.

    Raises:
        NoGait: it does not converge, or a stride does not close.
    """
    beside = _Beside(system, state, np.array([turn, speed]), rtol)
    x, least, J = np.zeros(beside.unknowns), np.inf, None
    for _ in range(ITERATIONS):
        values = beside.values(x)
        off = beside.off(values)
        size = float(np.abs(off).max())
        if size <= 10.0 * rtol:
            return beside.system(x), headed(*beside.state(x))
        if J is None or size > SLOW * least:
            J = np.array([(beside.values(x + step) - values) / DIFFERENCE for step in beside.steps]).T
        least, rows = min(size, least), beside.rows(values)
        step = -np.linalg.lstsq(J[rows], off[rows], rcond=None)[0]
        x = x + step * min(1.0, LONGEST / float(np.abs(step).max()))
    raise NoGait(f"Newton's method finds no turn by {np.degrees(turn):.3g}° a stride", least)


class _Beside:
    """Equations of a turning gait, over coordinates of the section and scaled changes of `STEERED_BY`."""

    def __init__(self, system: HybridSystem, state: State, wanted: Array, rtol: float) -> None:
        self._system, self._wanted, self._rtol = system, wanted, rtol
        self._chart = chart(system, state)
        self._n = self._chart.dimension
        self._begin: Mapping[str, float] = {name: parameter(system, name) for name in STEERED_BY}
        self.unknowns = self._n + len(STEERED_BY)
        self.steps = DIFFERENCE * np.eye(self.unknowns)

    def system(self, x: Array) -> HybridSystem:
        """The system with the inputs."""
        changes = zip(self._begin.items(), x[self._n :].tolist(), strict=True)
        return with_parameters(
            self._system,
            {name: value + unit_of(name, self._system.robot) * change for (name, value), change in changes},
        )

    def state(self, x: Array) -> State:
        """On the section."""
        return self._chart.state(x[: self._n])

    def values(self, x: Array) -> Array:
        """By how much the state changes in a stride, turn, speed, and times between touchdowns, in `SECOND`."""
        system = self.system(x)
        run = return_map(system, self.state(x), self._rtol)
        if not run.cycles:
            raise NoGait(f"a stride beside the turn does not close: {run.message}", np.inf)
        closes = self._chart.coordinates(run.state) - x[: self._n]
        measured = [system.measures[name](run) for name in ("turn", "mean_speed")]
        gaps = [footfall_gap(run, pair) / SECOND for pair in ("posterior", "anterior")]
        return np.array([*closes, *measured, *gaps])

    def off(self, values: Array) -> Array:
        """By how much values miss what is wanted."""
        gaps = values[self._n + 2 :]
        return np.concatenate([values[: self._n], values[self._n : self._n + 2] - self._wanted, gaps - _bounded(gaps)])

    def rows(self, values: Array) -> Sequence[int]:
        """The equations that hold: a time between touchdowns that is not too long is free."""
        gaps = np.abs(values[self._n + 2 :]) >= GAP / SECOND
        return [*range(self._n + 2), *(self._n + 2 + np.flatnonzero(gaps)).tolist()]


def _bounded(gaps: Array) -> Array:
    return np.clip(gaps, -GAP / SECOND, GAP / SECOND)
