"""Probability that a gait survives with numbers other than its own, drawn at random, in many lanes at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.parameters import parameter
from spear_pin.hybrid.periodic import chart
from spear_pin.kinds import typed


@dataclass(frozen=True)
class Robustness:
    """Outcome of each draw.

    Attributes:
        drawn: the numbers of each draw, (n,) each, by name.
        cycles: whole cycles run, (n,).
        reason: why each run ended, (n,), see `Trajectory`; "complete" if it survived.
    """

    drawn: Mapping[str, Array]
    cycles: NDArray[np.int64]
    reason: NDArray[np.str_]

    @property
    def survives(self) -> NDArray[np.bool_]:
        """Whether each draw ran to the end, (n,)."""
        return np.asarray(self.reason == "complete")

    @property
    def share(self) -> float:
        """Share of the draws that survive."""
        return float(self.survives.mean())

    def interval(self, confidence: float = 0.95) -> tuple[float, float]:
        """Returns bounds of the probability to survive, by Clopper and Pearson."""
        found = scipy.stats.binomtest(int(self.survives.sum()), len(self.reason)).proportion_ci(confidence)
        return float(found.low), float(found.high)


@typed
def robustness(
    gait: Gait,
    spread: Mapping[str, float],
    disturbance: float = 0.0,
    *,
    draws: int = 1000,
    cycles: int = 50,
    seed: int = 0,
    on_lanes: Callable[[int], object] = lambda n: None,
) -> Robustness:
    """Simulates a gait's law from near its state with numbers drawn from a normal distribution.

    Args:
        gait: the gait.
        spread: standard deviations of fields of law, spring or contact, as shares of their values.
        disturbance: standard deviation of every section coordinate at the start, in m, rad, m/s, rad/s.
        draws: number of draws.
        cycles: number of whole cycles that a draw has to survive.
        seed: seed of the random numbers.
        on_lanes: called with the number of draws done since the last call.

    Raises:
        UnknownName: no part has a numeric field with a name in `spread`.
        BadValue: a standard deviation is negative, there is no draw, or a drawn number is not valid.
        MissingExtra: heyoka is not installed.
    """
    for name, share in {**spread, "disturbance": disturbance}.items():
        require(f"standard deviation of {name}", share, lambda x: x >= 0, "a number >= 0")
    require("draws", draws, lambda n: n >= 1 and not n % 1, "a whole number >= 1")
    rng = np.random.default_rng(seed)
    drawn = {
        name: parameter(gait.system, name) * (1.0 + share * rng.normal(size=draws)) for name, share in spread.items()
    }
    local = chart(gait.system, gait.state)
    states = [local.state(disturbance * rng.normal(size=local.dimension)) for _ in range(draws)]
    q, v = (np.array(part) for part in zip(*states, strict=True))
    found = simulate_many(gait.system, q, v, cycles, parameters=drawn, on_lanes=on_lanes)
    return Robustness(drawn, found.cycles, found.reason)
