"""Measures how far simulators are from the references: `python -m benchmarks.references.measuring [--steps S ...]`.

It needs the extra `crosscheck`, and prints a table for each simulator.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import Any

from benchmarks.markdown import table
from benchmarks.references.in_drake import Drake
from benchmarks.references.in_mujoco import MuJoCo
from benchmarks.references.stepping import Simulator, Stepping, runs
from spear_pin.cli.references import SHIPPED
from spear_pin.references.check import compare, read

STEPS = (1e-3, 1e-4)  # s
Maker = Callable[[Mapping[str, Any], float], Simulator]
SIMULATORS: Mapping[str, Maker] = {"MuJoCo": MuJoCo, "Drake": Drake}
SHOWN = "time_s", "position", "velocity"


def main() -> None:
    """Measure, and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.references.measuring", description=__doc__)
    parser.add_argument("--steps", nargs="+", type=float, default=STEPS, metavar="S", help="steps of the simulators")
    steps = parser.parse_args().steps
    references = {name: each for name, each in read(SHIPPED).items() if runs(each)}
    for called, maker in SIMULATORS.items():
        rows = [(name, *(cell(each, maker, step) for step in steps)) for name, each in references.items()]
        table((f"{called}, steps of", *(f"{1e3 * step:g} ms" for step in steps)), rows)


def cell(reference: Mapping[str, Any], maker: Maker, step: float) -> str:
    """The largest differences of time, position and velocity; or the first touchdown or lift-off that is another."""
    differences, others = compare(reference, Stepping(reference, maker(reference, step), step).run())
    feet = [each for each in others if "touchdown" in each or "lift_off" in each]
    off = {name: max((each.off for each in differences if each.quantity == name), default=None) for name in SHOWN}
    return feet[0] if feet else ", ".join("-" if value is None else f"{value:.0e}" for value in off.values())


if __name__ == "__main__":
    main()
