"""Are the error bars of an identification right where an encoder's counts are coarser than its noise?

`python -m benchmarks.rounding [--records 60] [--json]`: records of one to three releases, each of another knee, depth
and rate, rounded to 512 to 8192 counts a turn, of a converter without noise, or not rounded; raw and smoothed. Per
class: how often stiffness, damping and rest angle lie within two standard deviations of the truth, how far off the
worst is and the root mean square, in standard deviations; and the same with those of white noise.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from tqdm import tqdm

from benchmarks import markdown
from spear_pin.studies.identification import Calibration, MovingAverage, Record, cut_releases, identify, smooth_trial
from spear_pin.studies.laboratory import Instrument, synthesize
from spear_pin.studies.push_test import PassiveKnee, spear_ii

COUNTS, RATES, WINDOWS = (512, 1024, 2048, 4096, 8192), (200, 500, 1000, 2000), (20, 50, 100)
CONVERTER = 5.0 / 4096 / 1.06  # rad: 12 bits
UNIT = Calibration(1.0, 0.0)  # so that volts are radians


@dataclass(frozen=True)
class Class:
    """One class of records: rounded to an encoder's counts, a converter's or not; noise in steps, or in rad if not."""

    name: str
    steps: str
    noise: tuple[float, float]
    smoothed: bool = False


CLASSES = (
    Class("counts, no noise", "encoder", (0.0, 0.0)),
    Class("the same, smoothed", "encoder", (0.0, 0.0), smoothed=True),
    Class("12 bits, no noise", "converter", (0.0, 0.0)),
    Class("counts, noise of 0.05 to 0.5 of them", "encoder", (0.05, 0.5)),
    Class("the same, smoothed", "encoder", (0.05, 0.5), smoothed=True),
    Class("white noise of 1 to 10 mrad", "none", (0.001, 0.01)),
    Class("the same, smoothed", "none", (0.001, 0.01), smoothed=True),
)


def off(kind: Class, seed: tuple[int, int]) -> list[list[float]]:
    """Error of each parameter, in its standard deviations and in those of white noise."""
    rng = np.random.default_rng(seed)
    leg = spear_ii((None, 15.0)[rng.integers(2)])
    knee = PassiveKnee(rng.uniform(35, 90), rng.uniform(0.4, 2.5), 0.0, rng.uniform(0.8, 1.1))
    step = {"encoder": 2 * np.pi / rng.choice(COUNTS), "converter": CONVERTER, "none": 0.0}[kind.steps]
    instrument = Instrument(UNIT, noise=float(rng.uniform(*kind.noise) * (step or 1.0)), quantum=float(step))
    depth, repeats, rate = rng.uniform(0.05, 0.1), int(rng.integers(1, 4)), float(rng.choice(RATES))
    made = synthesize(leg, knee, depth, repeats=repeats, rate=rate, instrument=instrument, seed=seed[1])
    smoothing = MovingAverage(int(rng.choice(WINDOWS))) if kind.smoothed else None
    releases = [
        smooth_trial(release, smoothing) for release in cut_releases(Record("computed", made.t, made.voltage))[0]
    ]
    found = identify(leg, releases)
    truth = {"stiffness": knee.stiffness, "damping": knee.damping, "rest_angle": knee.zero}
    errors = [(found[name].value - value) / found[name].deviation for name, value in truth.items()]
    return [errors, [error * found[name].inflation for name, error in zip(truth, errors, strict=True)]]


def summary(z: np.ndarray[Any, Any]) -> dict[str, float]:
    """Share within two standard deviations, the worst, root mean square."""
    return {
        "within": float((np.abs(z) < 2).mean()),
        "worst": float(np.abs(z).max()),
        "rms": float(np.sqrt(np.mean(z**2))),
    }


def main() -> None:
    """Study, and print Markdown or JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=60, help="of each class")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rows = []
    for number, kind in enumerate(CLASSES):
        seeds = tqdm(range(arguments.records), desc=kind.name, disable=None, leave=False)
        z = np.array([off(kind, (number, seed)) for seed in seeds])
        rows.append({"class": kind.name, "counted": summary(z[:, 0]), "white": summary(z[:, 1])})
    if arguments.json:
        print(json.dumps({"records": arguments.records, "classes": rows}))
        return
    markdown.begin("", "within 2σ", "worst", "rms", "σ of white noise: within 2σ", "worst", "rms")
    for row in rows:
        cells = [f"{s['within']:.1%} | {s['worst']:.1f} | {s['rms']:.2f}" for s in (row["counted"], row["white"])]
        markdown.row(row["class"], *cells)


if __name__ == "__main__":
    main()
