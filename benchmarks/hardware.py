"""How many hops survive noise, lost commands and saturation? And why do the rest stop?

`python -m benchmarks.hardware [--level rough ...] [--runs 200] [--hops 11] [--workers 2] [--json]`: seeded runs of the
hop on hardware, for several levels of disturbance: what is in the table's head is assumed, not the source's. A run
stops with `no_event` when the leg stays on the ground.
"""

from __future__ import annotations

import argparse
import json
import time
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
from tqdm import tqdm

from benchmarks import markdown
from spear_pin import find_gait, hopping, load
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.hardware import Sensing
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.model.actuator import Thermal
from spear_pin.studies.hardware import Outcome, Rig, outcome, reasons

HEADS = (
    "level | noise, rad | rad/s | lost, 1/s | limit, A | hop to the end | lowest apex, m | standard deviation, mm"
    " | why not"
)
ROUGH = Sensing(0.005, 0.2, losses=5.0)
LEVELS = {  # noise of angles in rad and of rates in rad/s, commands lost per second, limit in A
    "calm": Rig(sensing=Sensing(0.002, 0.05, losses=1.0), current_limit=10.0),
    "rough": Rig(sensing=ROUGH, current_limit=8.0),
    "harsh": Rig(sensing=Sensing(0.02, 0.5, losses=20.0), current_limit=6.0),
    "weak": Rig(sensing=ROUGH, current_limit=3.0),
    "weaker": Rig(sensing=ROUGH, current_limit=2.75),
    "protected": Rig(sensing=ROUGH, current_limit=8.0, thermal=Thermal(2.0, 20.0)),  # continuous A, and s
}
_GAIT: list[Gait] = []


def tuned() -> Gait:
    """The hop of 0.2 s of flight, its torque solved with gears and limits, without noise."""
    robot = load("spear_ii", locked=["boom_x"])
    system = with_hardware(hopping(robot), Rig().on(robot))
    return find_gait(system, ["stance_torque"], {"flight_time": 0.2})


def prepare() -> None:
    _GAIT.append(tuned())


def one(level: str, seed: int, hops: int) -> Outcome:
    return outcome(_GAIT[0], LEVELS[level], seed, hops)


def summary(outcomes: list[Outcome], hops: int) -> dict[str, Any]:
    """Outcome of the runs of one level."""
    apexes = [apex for each in outcomes if each.reason == "complete" for apex in each.apexes]
    return {
        "runs": len(outcomes),
        "complete": sum(each.reason == "complete" for each in outcomes),
        "reasons": reasons(outcomes),
        "apex_spread": float(np.std(apexes)) if apexes else None,
        "lowest_apex": min(apexes, default=None),
        "hops_before_stopping": sorted(each.hops for each in outcomes if each.hops < hops),
    }


def main() -> None:
    """Run, and print Markdown or JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", action="append", choices=list(LEVELS), help="one of the levels; all by default")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--hops", type=int, default=11)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    result: dict[str, Any] = {"runs": arguments.runs, "hops": arguments.hops, "levels": {}}
    with ProcessPoolExecutor(arguments.workers, initializer=prepare) as pool:
        for level in arguments.level or LEVELS:
            jobs = [pool.submit(one, level, seed, arguments.hops) for seed in range(arguments.runs)]
            outcomes = [job.result() for job in tqdm(jobs, desc=level, disable=None)]
            result["levels"][level] = summary(outcomes, arguments.hops)
    result["seconds"] = time.perf_counter() - begin
    if arguments.json:
        print(json.dumps(result))
        return
    markdown.begin(*HEADS.split(" | "))
    for level, row in result["levels"].items():
        rig, spread = LEVELS[level], row["apex_spread"]
        assert rig.sensing is not None
        others = ", ".join(f"{count} {reason}" for reason, count in row["reasons"].items() if reason != "complete")
        if (stopped := row["hops_before_stopping"]) and others:
            others += f" after {stopped[0]} to {stopped[-1]} hops"
        limit = f"{rig.current_limit:g}" + (f", i²t {rig.thermal.continuous:g}" if rig.thermal else "")
        numbers = f"{rig.sensing.angle_noise:g} | {rig.sensing.rate_noise:g} | {rig.sensing.losses:g} | {limit}"
        shown = "– | –" if spread is None else f"{row['lowest_apex']:.3f} | {1e3 * spread:.1f}"
        markdown.row(level, numbers, f"{row['complete']} of {row['runs']}", shown, others or "–")
    print(f"\n{result['seconds']:.0f} s")


if __name__ == "__main__":
    main()
