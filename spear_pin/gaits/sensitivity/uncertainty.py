"""How far a gait's outputs spread where its numbers are uncertain, and which number to measure better."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.files import plain
from spear_pin.gaits.sensitivity.measure import MULTIPLIER, ROUNDING, estimate_rounding
from spear_pin.gaits.sensitivity.monte_carlo import MonteCarlo
from spear_pin.gaits.sensitivity.samples import find_anew, state_columns
from spear_pin.gaits.sensitivity.spread import factor
from spear_pin.kinds import typed
from spear_pin.showing import Shown

if TYPE_CHECKING:
    from spear_pin.gaits.sensitivity.sensitivity import Sensitivity

MOST = 1_000_000  # samples


@dataclass(frozen=True, repr=False)
class Uncertainty(Shown):
    """Standard deviations of a gait's outputs to first order, from the covariance of its parameters.

    Attributes:
        table: derivatives of the gait, and the gait.
        covariance: covariance of its parameters, (m, m).

    Example:
        >>> from spear_pin import find_gait, hopping, load
        >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
        >>> spread = gait.sensitivity(["stiffness", "damping"]).uncertainty({"stiffness": "1 %", "damping": "1 %"})
        >>> [f"{share:.2f}" for share in spread.shares("positive_work")], spread.best("flight_time")
        (['0.59', '0.41'], 'damping')
        >>> spread.monte_carlo(50)
        MonteCarlo(50 samples: 50 gaits found, 50 with the same order of events)
    """

    table: Sensitivity
    covariance: Array

    @property
    def over(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return self.table.parameters

    @cached_property
    def outputs(self) -> dict[str, float]:
        """Values by name: solved numbers, measures, moduli of multipliers, numbers of the state."""
        columns = zip(state_columns(self.table.system.robot), np.concatenate(self.table.at).tolist(), strict=True)
        return {**self.table.outputs, **dict(columns)}

    @cached_property
    def output_units(self) -> dict[str, str]:
        """Units of the outputs."""
        return {**self.table.output_units, **state_columns(self.table.system.robot)}

    @cached_property
    def derivatives(self) -> dict[str, Array]:
        """Derivatives of the outputs by the parameters, by name, (m,) each."""
        rows = zip(state_columns(self.table.system.robot), self.table.state, strict=True)
        return {**self.table.derivatives, **dict(rows)}

    @property
    def parameter_deviations(self) -> Array:
        """Standard deviations of the parameters, (m,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlated(self) -> bool:
        """Whether errors of the parameters depend on each other."""
        return bool(np.any(self.covariance - np.diag(np.diag(self.covariance))))

    def __repr__(self) -> str:
        return f"Uncertainty({len(self.outputs)} outputs over {', '.join(self.over)})"

    def __str__(self) -> str:
        width = max(map(len, self.outputs))
        head = " ".join(f"{name:>14.14}" for name in self.over)
        lines = [f"{'':{width}} {'value':>12} {'σ':>11} {'σ, %':>8} {head}   (% of σ² that knowing it takes away)"]
        lines.append(f"{'σ':{width}} {'':33} " + " ".join(f"{each:14.4g}" for each in self.parameter_deviations))
        for name, value in self.outputs.items():
            sigma = self.deviation(name)
            relative = f"{100.0 * sigma / abs(value):8.3g}" if abs(value) > estimate_rounding(name) else f"{'':8}"
            row = " ".join(f"{100.0 * each:14.3g}" for each in self.gains(name))
            lines.append(f"{name:{width}} {value:12.6g} {sigma:11.4g} {relative} {row}")
        if self.correlated:
            lines.append(
                "errors are correlated: to know one parameter tells of others, and shares do not add up to 100"
            )
        if self.table.one_sided:
            lines.append(f"one-sided, for events meet in this gait: {', '.join(self.table.one_sided)}")
        return "\n".join(lines)

    def deviation(self, output: str) -> float:
        """Returns the standard deviation of an output, √(g Σ gᵀ); NaN where the output has no derivative.

        Raises:
            UnknownName: there is no such output.
        """
        slopes = self._slopes(output)
        return float(np.sqrt(np.maximum(slopes @ self.covariance @ slopes, 0.0)))

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviations of all outputs."""
        return {name: self.deviation(name) for name in self.outputs}

    def moves(self, output: str) -> bool:
        """Tells whether an output's standard deviation exceeds rounding; an output that is kept does not move.

        Raises:
            UnknownName: there is no such output.
        """
        value = abs(self.outputs[output])
        still = output.startswith(MULTIPLIER) and value <= estimate_rounding(output)  # a root of rounding
        return not still and self.deviation(output) > ROUNDING * max(value, 1.0)

    def shares(self, output: str) -> Array:
        """Returns the share of each parameter in the variance, g_i (Σ gᵀ)_i / σ², (m,); zero where σ is zero.

        The shares add up to 1. Where errors are correlated, some may be negative.

        Raises:
            UnknownName: there is no such output.
        """
        slopes = self._slopes(output)
        return self._over(output, slopes * (self.covariance @ slopes))

    def gains(self, output: str) -> Array:
        """Returns by which share the variance falls if a parameter is known exactly, (Σ gᵀ)_i² / (Σ_ii σ²), (m,).

        The gain is the squared correlation of the parameter with the output: knowledge of a parameter also tells about
        parameters that are correlated with it. A second measurement as good as the first removes half of the gain.
        Without correlations the gains equal the shares.

        Raises:
            UnknownName: there is no such output.
        """
        along, variances = self.covariance @ self._slopes(output), np.diag(self.covariance)
        with np.errstate(divide="ignore", invalid="ignore"):
            squares = np.where(variances > 0.0, along**2 / np.where(variances > 0.0, variances, 1.0), 0.0 * along)
        return self._over(output, squares)

    def best(self, output: str) -> str:
        """Returns the name of the parameter to measure better: the one with the largest value of `gains`.

        Raises:
            UnknownName: there is no such output.
            BadValue: the output has no derivative, or does not move.
        """
        gains = self.gains(output)
        if not np.isfinite(gains).all() or not gains.max() > 0.0:
            raise BadValue("output", output, "one that moves with an uncertain parameter")
        return self.over[int(gains.argmax())]

    @typed
    def monte_carlo(
        self, samples: int = 10_000, seed: int = 0, *, on_lanes: Callable[[int], object] = lambda n: None
    ) -> MonteCarlo:
        """Finds the gait again for parameters drawn from a normal distribution with this covariance.

        If lanes may differ in all parameters (numbers of law, springs and friction) and record what is kept, all gaits
        are found side by side. With other parameters, such as masses and lengths, they are found one by one, some ten
        in a second.

        Args:
            samples: number of samples.
            seed: seed of the random numbers.
            on_lanes: called with the number of samples done since the last call.

        Raises:
            BadValue: `samples` is not a whole number from 2 to a million, or the seed is negative.
        """
        if not 2 <= samples <= MOST:
            raise BadValue("samples", samples, f"a whole number from 2 to {MOST}")
        if seed < 0:
            raise BadValue("seed", seed, "a whole number >= 0")
        normal = np.random.default_rng(seed).standard_normal((samples, len(self.over)))
        parameters = self.table.given + normal @ factor(self.covariance).T
        return MonteCarlo(self, find_anew(self.table, parameters, on_lanes), seed)

    def to_json(self) -> str:
        """Returns the uncertainty as JSON."""
        data = {
            "over": dict(zip(self.over, self.table.given.tolist(), strict=True)),
            "units": dict(zip(self.over, self.table.units, strict=True)),
            "deviations": dict(zip(self.over, self.parameter_deviations.tolist(), strict=True)),
            "covariance": self.covariance.tolist(),
            "outputs": {
                name: {
                    "value": value,
                    "unit": self.output_units[name],
                    "deviation": self.deviation(name),
                    "shares": self.shares(name),
                    "gains": self.gains(name),
                }
                for name, value in self.outputs.items()
            },
            "one_sided": list(self.table.one_sided),
        }
        return json.dumps(plain(data), indent=1)

    def _over(self, output: str, parts: Array) -> Array:
        """Returns shares of an output's variance; zero where it does not move, NaN where it has no derivative."""
        sigma = self.deviation(output)
        return np.zeros_like(parts) if np.isfinite(sigma) and not self.moves(output) else np.asarray(parts / sigma**2)

    def _slopes(self, output: str) -> Array:
        if output not in self.derivatives:
            raise UnknownName("output", output, self.outputs)
        return np.asarray(self.derivatives[output], np.float64)
