"""How far a hop is known with the knee that was identified: first order beside Monte Carlo.

`python -m benchmarks.uncertainty [--samples 10000] [--knee NAME] [--json]`: the hop in place with 0.2 s of flight, its
stance torque solved for, with three knees:

- "printed": k, b, RA and their σ as printed in the source's Table 4.2, with motor, errors taken as independent; of a
  thirtieth as many samples, for those without a gait take long;
- "a tenth": those σ divided by ten;
- "synthetic": the covariance of an estimate from three synthetic releases of a knee of those numbers, 5 mrad of noise.

The source's RA is of the push test, where the spring stays engaged. That of the hop is latched at touchdown; σ_RA is
taken for that of the angle at which the knee is to land. Independence and that reading are assumptions.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin import Spring, find_gait, hopping, load
from spear_pin.studies.audit.printed_estimates import TABLE_4_2
from spear_pin.studies.identification import identify
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import DEPTHS, PassiveKnee, spear_ii

OVER = ("stiffness", "damping", "knee_touchdown")
NOISE = 0.005  # rad, white, of the synthetic records
SEED = 0


@dataclass(frozen=True)
class Knee:
    """A knee: k in N·m/rad, b in N·m·s/rad, and the covariance of k, b and the angle of touchdown."""

    name: str
    stiffness: float
    damping: float
    covariance: NDArray[np.float64]


def knees() -> Iterator[Knee]:
    """The knees."""
    row = TABLE_4_2[0]
    sigma = np.array([row.sigma_stiffness, row.sigma_damping, row.sigma_rest_angle])
    yield Knee("printed", row.stiffness, row.damping, np.diag(sigma**2))
    yield Knee("a tenth", row.stiffness, row.damping, np.diag((0.1 * sigma) ** 2))
    leg, rng = spear_ii(15.0), np.random.default_rng(SEED)
    truth = PassiveKnee(row.stiffness, row.damping, zero=row.rest_angle)
    found = identify(leg, [synthetic_trial(leg, truth, depth, NOISE, rng) for depth in DEPTHS])
    covariance = found.covariance_of(["stiffness", "damping", "rest_angle"])
    yield Knee("synthetic", found["stiffness"].value, found["damping"].value, covariance)


def studied(knee: Knee, samples: int) -> dict[str, Any]:
    """Figures of one knee."""
    system = hopping(load("spear_ii", locked=["boom_x"]), spring=Spring(knee.stiffness, knee.damping))
    hop = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2}, rtol=1e-12)
    table = hop.sensitivity(OVER, ["stance_torque"], ["flight_time"])
    spread = table.uncertainty(knee.covariance)
    spread.monte_carlo(2)  # compiled once
    begun = perf_counter(), process_time()
    drawn = spread.monte_carlo(samples, SEED)
    seconds, busy = perf_counter() - begun[0], process_time() - begun[1]
    sigma = spread.parameter_deviations
    return {
        "knee": knee.name,
        "parameters": dict(zip(OVER, spread.table.given.tolist(), strict=True)),
        "deviations": dict(zip(OVER, sigma.tolist(), strict=True)),
        "correlation": (knee.covariance / np.outer(sigma, sigma)).tolist(),
        "best": {name: spread.best(name) for name in spread.outputs if spread.moves(name)},
        "seconds": seconds,
        "processor_seconds": busy,
        "monte_carlo": drawn.plain(),
        "text": f"{spread}\n\n{drawn}",
    }


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--knee", choices=("printed", "a tenth", "synthetic"), help="one of them alone")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rows = [
        studied(knee, arguments.samples // (30 if knee.name == "printed" else 1))
        for knee in knees()
        if arguments.knee in (None, knee.name)
    ]
    if arguments.json:
        print(json.dumps([{name: value for name, value in row.items() if name != "text"} for row in rows]))
        return
    for row in rows:
        numbers = ", ".join(f"{name} {row['parameters'][name]:.4g} ± {row['deviations'][name]:.3g}" for name in OVER)
        print(f"{row['knee']}: {numbers}\n{row['text']}")
        print(f"{row['monte_carlo']['samples']} samples in {row['seconds']:.1f} s,", end=" ")
        print(f"{row['processor_seconds']:.1f} s of a processor\n")


if __name__ == "__main__":
    main()
