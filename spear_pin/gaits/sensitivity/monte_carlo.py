"""Monte Carlo of a gait: the gait is found again for parameters drawn at random, for comparison with first order."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.files import plain
from spear_pin.gaits.sensitivity.samples import SampledGaits
from spear_pin.showing import Shown

if TYPE_CHECKING:
    from spear_pin.gaits.sensitivity.uncertainty import Uncertainty

WITHIN = 0.05  # share of Monte Carlo's deviation within which first order agrees
FEW = 0.01  # share of samples without a value that needs no mention
STILL = 1e-7  # of a value: what moves by less stays
FEWEST = 3  # least number of samples for a standard error

AGREES, STAYS = "agrees", "stays"
NOT_LINEAR, OTHER_ORDER, LOST = "not linear", "another order of events", "samples without a value"
ONE_SIDED = "derivative of one side"
NO_SLOPE, NO_SAMPLES = "no derivative", "too few samples"


@dataclass(frozen=True, repr=False)
class MonteCarlo(Shown):
    """Gaits found for parameters drawn at random from a normal distribution around one gait's parameters.

    Attributes:
        spread: the gait's uncertainty to first order.
        samples: the gaits.
        seed: seed of the random numbers.
    """

    spread: Uncertainty
    samples: SampledGaits
    seed: int

    @property
    def over(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return self.spread.over

    @cached_property
    def first(self) -> dict[str, float]:
        """Standard deviations to first order, by name."""
        return self.spread.deviations

    def __len__(self) -> int:
        """Returns the number of samples."""
        return len(self.samples.reason)

    def __repr__(self) -> str:
        found, alike = int(self.samples.found.sum()), int(self.samples.alike.sum())
        return f"MonteCarlo({len(self)} samples: {found} gaits found, {alike} with the same order of events)"

    def __str__(self) -> str:
        width = max(map(len, self.first))
        columns = ("value", "σ, 1st order", "σ, M. Carlo", "± its error", "differs", "same samples")
        lines = [f"{'':{width}} " + " ".join(f"{each:>12}" for each in columns)]
        for name, first in self.first.items():
            value = self.spread.outputs[name]
            row = f"{value:12.6g} {first:12.4g} {self.deviation(name):12.4g} {self.error(name):12.2g}"
            shares = f"{_percent(self.difference(name))} {_percent(self.bend(name))}"
            lines.append(f"{name:{width}} {row} {shares} {self.verdict(name)}")
        return "\n".join([*lines, self.statement()])

    def drawn(self, output: str) -> Array:
        """Returns the values of an output in the samples that have one, (n,).

        Raises:
            UnknownName: there is no such output.
        """
        if output not in self.first:
            raise UnknownName("output", output, self.first)
        values = self.samples.outputs.get(output, np.empty(0))
        return np.asarray(values[np.isfinite(values)])

    def mean(self, output: str) -> float:
        """Returns the mean of an output; NaN without samples."""
        values = self.drawn(output)
        return float(values.mean()) if len(values) else float("nan")

    def deviation(self, output: str) -> float:
        """Returns the standard deviation of an output; NaN with fewer than two samples."""
        return _deviation(self.drawn(output))

    def error(self, output: str) -> float:
        """Returns the standard error of `deviation`, σ √((κ - 1) / 4n), κ the kurtosis: σ / √(2n) if normal."""
        values = self.drawn(output)
        sigma = _deviation(values)
        if len(values) < FEWEST or not sigma > 0.0:
            return float("nan") if len(values) < FEWEST else 0.0
        kurtosis = float((((values - values.mean()) / sigma) ** 4).mean())
        return sigma * float(np.sqrt(max(kurtosis - 1.0, 0.0) / (4.0 * len(values))))

    def difference(self, output: str) -> float:
        """Returns by which share first order exceeds Monte Carlo; NaN where the output does not move."""
        sigma = self.deviation(output)
        if self._still(output) or not sigma > 0.0:
            return float("nan")
        return self.first[output] / sigma - 1.0

    def bend(self, output: str, alike: bool = False) -> float:
        """Returns by which share first order exceeds Monte Carlo when both have the same drawn parameters.

        The first order of each sample is the value on the tangent, so chance has no part: only curvature is left.

        Args:
            output: name of the output.
            alike: whether to use only samples with the same order of events.

        Raises:
            UnknownName: there is no such output.
        """
        self.drawn(output)
        values = self.samples.outputs.get(output, np.full(len(self), np.nan))
        chosen = np.isfinite(values) & (self.samples.alike | (not alike))
        if self._still(output):
            return float("nan")
        straight = (self.samples.parameters[chosen] - self.spread.table.given) @ self.spread.derivatives[output]
        return _deviation(straight) / _deviation(values[chosen]) - 1.0

    def verdict(self, output: str) -> str:
        """Tells in words whether first order is within 5 % of Monte Carlo, or why it is not.

        The output "agrees" where first order is within 5 % for the very parameters that were drawn. If more than 1 % of
        the samples have no value, σ must be within 5 % as well; else the verdict names these samples. If only samples
        with another order of events make the difference, the verdict names them. If an event of the gait itself meets
        another, derivatives hold for one side, and samples are on both. Else the output is "not linear".
        """
        if not np.isfinite(self.first[output]):
            return NO_SLOPE
        if len(self.drawn(output)) < FEWEST:
            return NO_SAMPLES
        if self._still(output):
            return STAYS
        if abs(self.bend(output)) > WITHIN:
            if self.samples.alike.sum() >= FEWEST and abs(self.bend(output, alike=True)) <= WITHIN:
                return OTHER_ORDER
            return ONE_SIDED if self.spread.table.one_sided else NOT_LINEAR
        lost = 1.0 - len(self.drawn(output)) / len(self)
        return AGREES if abs(self.difference(output)) <= WITHIN or lost <= FEW else LOST

    def statement(self) -> str:
        """Says in lines of words what the samples were, and which outputs are not within 5 % to first order."""
        samples = self.samples
        other = int((samples.found & ~samples.alike).sum())
        lines = [f"{len(self)} samples: {int(samples.alike.sum())} gaits with the same order of events"]
        lines[0] += f", {other} with another" * bool(other)
        lost = Counter(samples.reason[~samples.found].tolist())
        lines[0] += "".join(f", {count} without a gait ({reason})" for reason, count in lost.most_common())
        if unmeasured := self.unmeasured:
            lines.append(f"{unmeasured} gaits without measures: toes chatter or strike together in their cycles")
        if unstable := int((samples.largest[samples.found] >= 1.0).sum()):
            lines.append(f"{unstable} gaits are unstable")
        off = [(name, verdict) for name in self.first if (verdict := self.verdict(name)) not in (AGREES, STAYS)]
        moving = sum(self.verdict(name) != STAYS for name in self.first)
        all_but_chance = f"within {WITHIN:.0%} of Monte Carlo, apart from sampling error"
        lines.append(f"first order {all_but_chance}, for {moving - len(off)} of the {moving} outputs that move")
        if one_sided := self.spread.table.one_sided:
            lines.append(f"one-sided: {', '.join(one_sided)} meets another event in this gait")
        for why in dict.fromkeys(verdict for _, verdict in off):
            lines.append(f"{why}: {', '.join(name for name, verdict in off if verdict == why)}")
        return "\n".join(lines)

    @property
    def unmeasured(self) -> int:
        """Number of gaits that were found but have no measures."""
        period = self.samples.outputs.get("period", np.full(len(self), np.nan))
        return int((self.samples.found & ~np.isfinite(period)).sum())

    def to_json(self) -> str:
        """Returns everything but the samples themselves as JSON."""
        return json.dumps(self.plain(), indent=1)

    def plain(self) -> dict[str, Any]:
        """Returns what `to_json` writes, as JSON's values."""
        samples = self.samples
        data = {
            "samples": len(self),
            "seed": self.seed,
            "over": list(self.over),
            "reasons": dict(Counter(samples.reason.tolist())),
            "converged": int(samples.found.sum()),
            "same_order": int(samples.alike.sum()),
            "unmeasured": self.unmeasured,
            "unstable": int((samples.largest[samples.found] >= 1.0).sum()),
            "outputs": {
                name: {
                    "value": self.spread.outputs[name],
                    "unit": self.spread.output_units[name],
                    "first_order": first,
                    "deviation": self.deviation(name),
                    "standard_error": self.error(name),
                    "mean": self.mean(name),
                    "difference": self.difference(name),
                    "bend": self.bend(name),
                    "verdict": self.verdict(name),
                    "count": len(self.drawn(name)),
                }
                for name, first in self.first.items()
            },
        }
        return dict(plain(data))

    def _still(self, output: str) -> bool:
        size = STILL * max(abs(self.spread.outputs[output]), STILL)
        return not self.first[output] > size and not self.deviation(output) > size


def _deviation(values: Array) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else float("nan")


def _percent(share: float) -> str:
    return f"{100.0 * share:+10.2f} %" if np.isfinite(share) else f"{'':12}"
