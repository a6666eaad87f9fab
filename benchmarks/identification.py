"""Are the error bars of an identification right? How many integrations does it take?

`python -m benchmarks.identification [--repeats 200] [--window 100] [--workers 2] [--json]`: 24 synthetic cases (three
depths, with the motor or without, four levels of white noise), each repeated with other noise, without a filter and
with the moving average on data and model. Per case and parameter: how often the estimate lies within two standard
deviations of the truth, and the mean standard deviation over the scatter of the estimates.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from itertools import product
from typing import Any

import numpy as np
from tqdm import tqdm

from benchmarks import markdown
from spear_pin.studies.identification import MovingAverage, identify, smooth_trial
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import DEPTHS, PassiveKnee, spear_ii

HEADS = "depth, m | motor | noise, mrad | window | within 2σ: k, b, RA | σ / scatter: k, b, RA | integrations"
TRUTH = PassiveKnee(stiffness=50.0, damping=1.2, zero=0.8)
NOISES = (0.001, 0.003, 0.01, 0.03)  # rad
VALUES = {"stiffness": TRUTH.stiffness, "damping": TRUTH.damping, "rest_angle": TRUTH.zero}
WITHIN, AGREE = 0.90, 0.20  # what is asked for


@dataclass(frozen=True)
class Case:
    """One case: depth in m, motor, noise in rad, window in samples (0: no filter)."""

    depth: float
    motor: bool
    noise: float
    window: int


def repeated(case: Case, number: int, repeats: int) -> dict[str, Any]:
    """Estimate from so many synthetic releases of one case."""
    leg = spear_ii(15.0 if case.motor else None)
    smoothing = MovingAverage(case.window) if case.window else None
    values, deviations, integrations, unconverged = [], [], [], 0
    for repeat in range(repeats):
        rng = np.random.default_rng([number, repeat])
        found = identify(leg, [smooth_trial(synthetic_trial(leg, TRUTH, case.depth, case.noise, rng), smoothing)])
        values.append([found[name].value for name in VALUES])
        deviations.append([found[name].deviation for name in VALUES])
        integrations.append(found.integrations)
        unconverged += not found.converged
    errors = np.array(values) - list(VALUES.values())
    scatter = errors.std(axis=0, ddof=1)
    return asdict(case) | {
        "within": dict(zip(VALUES, (np.abs(errors) < 2 * np.array(deviations)).mean(axis=0).tolist(), strict=True)),
        "ratio": dict(zip(VALUES, (np.array(deviations).mean(axis=0) / scatter).tolist(), strict=True)),
        "scatter": dict(zip(VALUES, scatter.tolist(), strict=True)),
        "bias": dict(zip(VALUES, errors.mean(axis=0).tolist(), strict=True)),
        "integrations": max(integrations),
        "unconverged": unconverged,
    }


def studied(cases: list[Case], repeats: int, workers: int) -> Iterator[dict[str, Any]]:
    """All cases, over processes; the outcome does not depend on their number."""
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(repeated, case, number, repeats) for number, case in enumerate(cases)]
        for job in tqdm(jobs, unit="case", disable=None):
            yield job.result()


def main() -> None:
    """Study, and print Markdown or JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=200)
    parser.add_argument("--window", type=int, default=100, help="samples of the moving average")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    cases = [Case(*case) for case in product(DEPTHS, (True, False), NOISES, (0, arguments.window))]
    rows = list(studied(cases, arguments.repeats, arguments.workers))
    result = {
        "repeats": arguments.repeats,
        "seconds": time.perf_counter() - begin,
        "least_within": min(min(row["within"].values()) for row in rows),
        "ratios": [min(min(r["ratio"].values()) for r in rows), max(max(r["ratio"].values()) for r in rows)],
        "most_integrations": max(row["integrations"] for row in rows),
        "unconverged": sum(row["unconverged"] for row in rows),
        "cases": rows,
    }
    if arguments.json:
        print(json.dumps(result))
        return
    markdown.begin(*HEADS.split(" | "))
    for row in rows:
        within, ratio = (" ".join(f"{value:.2f}" for value in row[key].values()) for key in ("within", "ratio"))
        head = f"{row['depth']:g} | {'yes' if row['motor'] else 'no'} | {1e3 * row['noise']:g} | {row['window'] or '–'}"
        markdown.row(head, within, ratio, row["integrations"])
    low, high = result["ratios"]
    print(
        f"\nleast within 2σ {result['least_within']:.3f} (asked: {WITHIN}), σ / scatter {low:.2f} to {high:.2f}"
        f" (asked: within {AGREE:.0%}), at most {result['most_integrations']} integrations a fit,"
        f" {result['unconverged']} not converged; {result['seconds']:.0f} s"
    )


if __name__ == "__main__":
    main()
