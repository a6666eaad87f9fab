"""Derivatives of gaits in space against gaits found again: `python -m benchmarks.found_again [GAIT ...]`, Markdown.

Each number is changed by three small steps to both sides, and the gait is found again for each. Richardson's
extrapolation of the differences stands beside the exact derivative, of the section's coordinates, the period and the
effort. A side counts if its gaits have the same events. Where the extrapolation is not sure, steps are shorter. A row
has the largest error, relative to the largest derivative of its kind. It takes some minutes a gait.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from benchmarks.markdown import begin, row
from spear_pin import Gait, find_gait, in_space, load
from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.gaits.round_hopping import round_hopping
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import chart
from tests.gaits.sensitivity.oracle import order

STEPS = (1e-2, 2e-3, 2e-4, 2e-5)  # of a number; the next where extrapolation is not sure, or events change to a side
SURE = 1e-7  # of the largest derivative: how much the last extrapolation may change
SMALL = 1e-3  # elasticity up to which an error is relative to it
UNTOLD = ("kink", "spring_switch")  # where a toe sets out, or a spring is slack: the motion is the same without
MEASURED = ("period", "effort")
BODY = ("roll_inertia_xx", "hip_spacing", "roll_mass", "roll_inertia_yy")
ROBOT = (*BODY, "stiffness", "friction", "adduction_stiffness", "adduction_damping")
BOUND = (*ROBOT, "posterior_hip_torque", "virtual_stiffness", "epsilon", "adduction_epsilon")
TROT = (*ROBOT, "posterior_hip_torque", "leg_stiffness", "epsilon", "adduction_epsilon")
HOPPY = (
    *("hip_height", "placement", "toe_stiffness", "toe_damping", "push_time", "posture_gain", "posture_damping"),
    *("lift_off_force", "knee_mass", "hip_mass", "knee_inertia_yy"),
)
SOLO12 = Path(__file__).parents[1] / "tests" / "solved" / "solo12_trot.json"
GAITS: Mapping[str, tuple[Callable[[], Gait], tuple[str, ...]]] = {
    "trot": (partial(Gait.load, "trot"), TROT),
    "pace": (partial(Gait.load, "pace"), TROT),
    "turn_9": (partial(Gait.load, "turn_9"), BOUND),
    "pronk": (partial(Gait.load, "pronk"), BOUND),
    "bound in space": (lambda: in_space(Gait.load("long_stride")), BOUND),
    "HOPPY's hop": (lambda: find_gait(round_hopping(load("hoppy"))), HOPPY),
    "Solo12's trot": (partial(Gait.load, SOLO12), TROT),
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gaits", nargs="*", metavar="GAIT", help=f"of {', '.join(GAITS)}; all by default")
    parser.add_argument("--over", metavar="A,B,...", help="numbers; by default those of the gait's list")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    begin("gait", "number", "value", "sides", "state", *MEASURED)
    for name in asked.gaits or GAITS:
        make, over = GAITS[name]
        gait = make()
        for each in asked.over.split(",") if asked.over else over:
            row(name, " | ".join([each, *compared(gait, each)]))


def compared(gait: Gait, name: str) -> list[str]:
    """The value of a number, and the errors of derivatives by it, or why there are none."""
    try:
        value = number(gait.system, name)
        table = gait.sensitivity([name])
    except SpearError as error:
        return ["refused", str(error), "", "", ""]
    if not value:
        return ["0", "not compared: its steps are shares of it", "", "", ""]
    local = chart(gait.system, gait.state)
    exact = np.concatenate(
        [
            local.changes(np.concatenate(gait.state), table.state)[:, 0],
            *(table.derivatives[name] for name in MEASURED),
        ]
    )

    def at(by: float) -> tuple[Array, list[str]]:
        found = gait_beside(with_numbers(gait.system, {name: value * (1.0 + by)}), gait.state, (), {})
        orbit = Orbit(found.system, found.state, ())
        measures = [orbit.measures[each].value for each in MEASURED]
        events = sorted(name for _, name in order(orbit) if name not in UNTOLD)
        return np.array([*local.coordinates(found.state), *measures]), events

    here, own = at(0.0)
    best, doubt = dict[float, Array](), np.inf
    for step in STEPS:
        steps, sides, doubts = step / 2.0 ** np.arange(3), dict[float, Array](), [0.0]
        for side in (1.0, -1.0):
            try:
                ends = [at(side * h) for h in steps]
            except SpearError:
                continue
            if all(each == own for _, each in ends):
                slopes = [(end - here) / (side * h * value) for h, (end, _) in zip(steps, ends, strict=True)]
                first = [2.0 * b - a for a, b in pairwise(slopes)]
                sides[side] = (4.0 * first[1] - first[0]) / 3.0
                doubts.append(float(np.abs(sides[side] - first[1]).max()))
        if len(sides) >= max(1, len(best)) and (len(sides) > len(best) or max(doubts) < doubt):
            best, doubt = sides, max(doubts)
        if len(best) == 2 and doubt <= SURE * np.abs(exact).max():
            break
    if not best:
        return [f"{value:.4g}", "none found again with the same events", "", "", ""]
    off = np.abs(exact - np.mean([*best.values()], axis=0))
    least = np.abs(here) * SMALL / abs(value)
    size = max(np.abs(exact[:-2]).max(), least[:-2].max(), SMALL / abs(value))  # of states in m, rad, m/s and rad/s
    state = off[:-2].max() / size
    rest = [f"{off[i] / max(abs(exact[i]), least[i]):.1e}" for i in (-2, -1)]
    return [f"{value:.4g}", "both" if len(best) == 2 else "one", f"{state:.1e}", *rest]


if __name__ == "__main__":
    main()
