"""What exact derivatives cost, in plain cycles: `python -m benchmarks.tangents [--json]`.

Of the hop and of two bounds: all columns of the return map by the section's coordinates and by parameters, in
plain cycles of the fast engine alone; central differences of the same columns by that engine; and the time in which the
multipliers are found. The best of several repetitions, once all is compiled.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from time import perf_counter

import numpy as np

from spear_pin import Gait, find_gait, hopping, load
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.tangent.cycle import differentiated
from spear_pin.hybrid.tangent.record import Recorder

OF_HOP = (
    *("stance_torque", "stiffness", "damping", "knee_touchdown", "frequency", "friction", "knee_gain"),
    *("knee_mass", "hip_com_z", "knee_ratio", "hip_to_knee", "knee_to_toe", "boom_z_mass"),
)
OF_BOUND = (
    *("posterior_hip_torque", "anterior_hip_torque", "posterior_leg_touchdown", "knee_touchdown"),
    *("torso_mass", "knee_ratio"),
)
REPEATED = 10


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print them as JSON")
    arguments = parser.parse_args()
    system = hopping(load("spear_ii", locked=["boom_x"]))
    hop = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2})
    rows = {"hop": row(hop, OF_HOP)}
    for name in ("long_stride", "least_effort"):
        rows[name] = row(Gait.load(name), OF_BOUND)
    if arguments.json:
        print(json.dumps(rows))
        return
    for name, figures in rows.items():
        print(name, ", ".join(f"{what} {value:.4g}" for what, value in figures.items()))


def row(gait: Gait, over: tuple[str, ...]) -> dict[str, float]:
    """Figures of one gait."""
    orbit = Orbit(gait.system, gait.state, over)
    start, seeds = orbit.start, orbit.seeds
    recorder, y = Recorder(gait.system), np.concatenate(orbit.chart.state(np.zeros(orbit.dimension)))
    plain = best(lambda: recorder.cycle(y))
    exact = best(lambda: differentiated(gait.system, recorder, y, start, seeds))
    columns = start.shape[1]
    return {
        "columns": columns,
        "plain_ms": 1e3 * plain,
        "exact_ms": 1e3 * exact,
        "exact_in_plain_cycles": exact / plain,
        "central_in_plain_cycles": 2.0 * columns,
    }


def best(run: Callable[[], object]) -> float:
    """Least time of some repetitions, in s."""
    times = []
    run()
    for _ in range(REPEATED):
        begun = perf_counter()
        run()
        times.append(perf_counter() - begun)
    return min(times)


if __name__ == "__main__":
    main()
