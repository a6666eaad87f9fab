"""Monte Carlo of a gait: found anew for parameters drawn at random, beside what is so to first order."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import UnknownName
from spear_pin.gaits.sensitivity.samples import Samples
from spear_pin.showing import Shown

Array = NDArray[np.float64]
WITHIN = 0.05  # of Monte Carlo's standard deviation, to which the first order is to agree
STILL = 1e-7  # of a value: what moves by less stays
FEWEST = 3  # samples, from which a standard error is known

AGREES, STAYS, UNDECIDED = "agrees", "stays", "too few samples to tell"
OTHER_ORDER, NOT_LINEAR = "another order of events", "not linear"
NO_SLOPE, NO_SAMPLES = "no derivative", "no samples"


@dataclass(frozen=True, repr=False)
class MonteCarlo(Shown):
    """A gait found anew for parameters drawn at random from a normal distribution.

    Attributes:
        over: names of the parameters.
        samples: the gaits.
        values: of the outputs of the gait itself, by name.
        units: of those.
        first: standard deviations to first order, by name.
        seed: of the random numbers.
    """

    over: tuple[str, ...]
    samples: Samples
    values: Mapping[str, float]
    units: Mapping[str, str]
    first: Mapping[str, float]
    seed: int

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.samples.reason)

    def __repr__(self) -> str:
        found, alike = int(self.samples.found.sum()), int(self.samples.alike.sum())
        return f"MonteCarlo({len(self)} samples: {found} gaits found, {alike} with the same order of events)"

    def __str__(self) -> str:
        width = max(map(len, self.first))
        lines = [f"{'':{width}} {'value':>12} {'σ, 1st order':>12} {'σ, M. Carlo':>12} {'± its error':>11} {'differs':>8}"]
        for name, first in self.first.items():
            row = f"{self.values[name]:12.6g} {first:12.4g} {self.deviation(name):12.4g} {self.error(name):11.2g}"
            lines.append(f"{name:{width}} {row} {_percent(self.difference(name))} {self.verdict(name)}")
        return "\n".join([*lines, self.statement()])

    def drawn(self, output: str) -> Array:
        """Values of an output in the samples that have one, (n,).

        Raises:
            UnknownName: there is no such output.
        """
        if output not in self.first:
            raise UnknownName("output", output, self.first)
        values = self.samples.outputs.get(output, np.empty(0))
        return np.asarray(values[np.isfinite(values)])

    def mean(self, output: str) -> float:
        """Mean of an output; NaN without samples."""
        values = self.drawn(output)
        return float(values.mean()) if len(values) else float("nan")

    def deviation(self, output: str) -> float:
        """Standard deviation of an output; NaN with fewer than two samples."""
        return _deviation(self.drawn(output))

    def error(self, output: str) -> float:
        """Standard error of `deviation`: σ √((κ - 1) / 4n) with the kurtosis κ, σ / √(2n) of a normal distribution."""
        values = self.drawn(output)
        sigma = _deviation(values)
        if len(values) < FEWEST or not sigma > 0.0:
            return float("nan") if len(values) < FEWEST else 0.0
        kurtosis = float((((values - values.mean()) / sigma) ** 4).mean())
        return sigma * float(np.sqrt(max(kurtosis - 1.0, 0.0) / (4.0 * len(values))))

    def difference(self, output: str) -> float:
        """By how much the first order is above Monte Carlo, as a share of that; NaN where the output stays."""
        sigma = self.deviation(output)
        if self._still(output) or not sigma > 0.0:
            return float("nan")
        return self.first[output] / sigma - 1.0

    def verdict(self, output: str) -> str:
        """Whether the first order is within 5 % of Monte Carlo, and why it is not, in words.

        Where only samples with another order of events make the difference, it is that; else the output is not linear.
        """
        first, values = self.first[output], self.drawn(output)
        if not np.isfinite(first):
            return NO_SLOPE
        if len(values) < FEWEST:
            return NO_SAMPLES
        if self._still(output):
            return STAYS
        off, slack = abs(self.difference(output)), 2.0 * self.error(output) / self.deviation(output)
        if off <= WITHIN:
            return AGREES if off + slack <= 2.0 * WITHIN else UNDECIDED
        if off - slack <= WITHIN:
            return UNDECIDED
        alike = self.samples.outputs[output][self.samples.alike]
        sigma = _deviation(alike[np.isfinite(alike)])
        return OTHER_ORDER if abs(first / sigma - 1.0) <= WITHIN else NOT_LINEAR

    def statement(self) -> str:
        """What the samples were, and which outputs are not within 5 % to first order, in lines of words."""
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
        agreeing = sum(self.verdict(name) == AGREES for name in self.first)
        lines.append(f"first order within {WITHIN:.0%} of Monte Carlo for {agreeing} of {len(self.first)} outputs")
        for why in dict.fromkeys(verdict for _, verdict in off):
            lines.append(f"{why}: {', '.join(name for name, verdict in off if verdict == why)}")
        return "\n".join(lines)

    @property
    def unmeasured(self) -> int:
        """Number of gaits that were found but have no measures."""
        period = self.samples.outputs.get("period", np.full(len(self), np.nan))
        return int((self.samples.found & ~np.isfinite(period)).sum())

    def to_json(self) -> str:
        """All of it but the samples themselves, as JSON."""
        return json.dumps(self.plain(), indent=1)

    def plain(self) -> dict[str, Any]:
        """The same, as JSON's values."""
        samples = self.samples
        return {
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
                    "value": self.values[name],
                    "unit": self.units[name],
                    "first_order": _finite(first),
                    "deviation": _finite(self.deviation(name)),
                    "standard_error": _finite(self.error(name)),
                    "mean": _finite(self.mean(name)),
                    "difference": _finite(self.difference(name)),
                    "verdict": self.verdict(name),
                    "count": len(self.drawn(name)),
                }
                for name, first in self.first.items()
            },
        }

    def _still(self, output: str) -> bool:
        size = STILL * max(abs(self.values[output]), STILL)
        return not self.first[output] > size and not self.deviation(output) > size


def _deviation(values: Array) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else float("nan")


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _percent(share: float) -> str:
    return f"{100.0 * share:+7.2f}%" if np.isfinite(share) else f"{'':8}"


