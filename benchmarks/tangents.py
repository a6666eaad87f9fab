"""What exact derivatives cost, and what searches by them do: `python -m benchmarks.tangents [--json]`.

Of the hop and of two bounds: all columns of the return map by the section's coordinates and by parameters, in
plain cycles of the fast engine alone; the Jacobian that a search asks for, and central differences of the same engine,
extrapolated once to be as exact; a search for the gait at another flight time or speed, by both. The best of several
repetitions, once all is compiled, in seconds of the processor, with those of the clock beside the searches. Then many
hops and bounds at once, once by both, and how far the gaits lie apart.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from functools import partial
from time import perf_counter, process_time
from unittest.mock import patch

import numpy as np

from spear_pin import Gait, find_gait, hopping, load
from spear_pin.gaits import lane_cycles
from spear_pin.gaits.lane_cycles import LaneCycles
from spear_pin.gaits.many import find_many
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.tangent_cycles import tangent_cycles
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.taylor import UNROLLED, Code
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.newton import jacobian
from spear_pin.hybrid.parameters import parameter
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import State
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.rules.start import start
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.tangent.collocation import ENDS
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.record import TOL, Recorder

OF_HOP = (
    *("stance_torque", "stiffness", "damping", "knee_touchdown", "frequency", "friction", "knee_gain"),
    *("knee_mass", "hip_com_z", "knee_ratio", "hip_to_knee", "knee_to_toe", "boom_z_mass"),
)
OF_BOUND = (
    *("posterior_hip_torque", "anterior_hip_torque", "posterior_leg_touchdown", "knee_touchdown"),
    *("torso_mass", "knee_ratio"),
)
REPEATED = 40
MANY = {"hop": 100, "long_stride": 30, "least_effort": 30}  # gaits at once


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print them as JSON")
    arguments = parser.parse_args()
    system = hopping(load("spear_ii", locked=["boom_x"]))
    asked = ["stance_torque"], {"flight_time": 0.2}
    hop = find_gait(system, *asked)
    rows = {}
    for name, speed in (("hop", None), ("long_stride", 2.55), ("least_effort", 2.51)):
        gait, over, guess = hop, OF_HOP, None
        if speed is not None:
            gait, over, asked = Gait.load(name), OF_BOUND, (["posterior_hip_torque"], {"mean_speed": speed})
            guess = gait.state
        rows[name] = row(gait, over) | jacobian_of(gait, *asked) | search(gait, *asked, guess=guess)
        many = f"{MANY[name]} times {name}"
        rows[many] = at_once(gait, *asked, MANY[name])
        for each in (name, many) if not arguments.json else ():
            print(each, ", ".join(f"{what} {value:.4g}" for what, value in rows[each].items()), flush=True)
    if arguments.json:
        print(json.dumps(rows))


def row(gait: Gait, over: tuple[str, ...]) -> dict[str, float]:
    """Figures of one gait's derivatives by many parameters, its cycle recorded as usual and by what runs plain ones."""
    orbit = Orbit(gait.system, gait.state, over)
    begins, seeds = orbit.start, orbit.seeds
    y = np.concatenate(orbit.chart.state(np.zeros(orbit.dimension)))
    optimised = Numbers(gait.system, {}, fastest(gait.system))
    runner = laps(optimised)
    plain = best(lambda: runner(y))
    exact, of_one_code = (
        best(lambda recorder=recorder: differentiate_cycle(gait.system, recorder, y, begins, seeds, ENDS))
        for recorder in (Recorder(gait.system), Recorder(gait.system, optimised))
    )
    columns = begins.shape[1]
    return {
        "columns": columns,
        "plain_ms": 1e3 * plain,
        "exact_ms": 1e3 * exact,
        "exact_in_plain_cycles": exact / plain,
        "by_the_same_code_in_plain_cycles": of_one_code / plain,
        "central_in_plain_cycles": 2.0 * columns,
    }


def fastest(system: HybridSystem) -> Code:
    """The code that takes longest to compile."""
    return Code(TOL, unrolled=system.robot.nv <= UNROLLED)


def laps(numbers: Numbers) -> Callable[[np.ndarray], object]:
    """What runs a cycle."""
    system, runner = numbers.system, LoneRunner(numbers, 0)
    (phase, resets), nv = start(system, True), system.robot.nv
    toes = [0.0] * len(system.robot.toes)
    return lambda y: runner.lap(phase, y, latch_values({}, resets, y[:nv].tolist(), y[nv:].tolist(), system.law), toes)


def jacobian_of(gait: Gait, vary: list[str], target: dict[str, float]) -> dict[str, float]:
    """The Jacobian that Newton's method asks for, and differences of two steps that are extrapolated."""
    system, names = gait.system, tuple(target)
    charts, wanted = chart(system, gait.state).lane, np.array([[*target.values()]])
    x = np.concatenate([np.zeros(charts.dimension), [parameter(system, name) for name in vary]])
    lanes = LaneCycles(system, {}, tuple(vary), names, 1e-12)
    by_lanes, one = Shooting(charts, lanes, tuple(vary), wanted), np.zeros(1, dtype=np.int64)

    def exactly() -> np.ndarray:
        cycles = tangent_cycles(system, vary, names)
        assert cycles is not None
        return Shooting(charts, lanes, tuple(vary), wanted, cycles.slopes).jacobians(one, x[None])[0]

    def by_differences() -> np.ndarray:
        wide, narrow = (jacobian(by_lanes.residuals, x, h)[0] for h in (1e-4, 5e-5))
        return (4.0 * narrow - wide) / 3.0

    off = float(np.abs(exactly() - by_differences()).max() / np.abs(exactly()).max())
    return {"jacobian_ms": 1e3 * best(exactly), "differences_ms": 1e3 * best(by_differences), "they_differ_by": off}


def search(gait: Gait, vary: list[str], target: dict[str, float], guess: State | None) -> dict[str, float]:
    """A search once compiled, and without the engine that has derivatives."""
    figures = {}
    for name, there in (("search", True), ("search_by_differences", False)):
        with patch.object(taylor, "available", lambda there=there: there):
            run = partial(find_gait, gait.system, vary, target, guess=guess)
            if there:
                run()
            figures[f"{name}_s"], figures[f"{name}_clock_s"] = least(run, 3 if there else 1)
    return figures


def at_once(gait: Gait, vary: list[str], target: dict[str, float], n: int) -> dict[str, float]:
    """Many gaits, whose targets differ by up to 1 %, by exact derivatives and by differences."""
    given = {"friction": np.full(n, parameter(gait.system, "friction"))}
    wanted = {name: value * np.random.default_rng(0).uniform(0.99, 1.01, n) for name, value in target.items()}
    figures, tables = dict[str, float](), []
    for name, fast in (("exact_s", False), ("differences_s", True)):
        with patch.object(lane_cycles, "unrolled", lambda system, fast=fast: fast):
            run = partial(find_many, gait.system, given, vary, wanted, guess=gait.state)
            tables.append(run())
            figures[name] = least(run, 1)[0]
    exact, differences = tables
    apart = {"v": exact.v - differences.v, "multipliers": exact.multipliers - differences.multipliers}
    figures |= {f"apart_in_{name}": float(np.nanmax(np.abs(each))) for name, each in apart.items()}
    return figures | {"found": float(exact.converged.sum())}


def best(run: Callable[[], object]) -> float:
    """Least time of the processor of some repetitions, in s."""
    run()
    return least(run, REPEATED)[0]


def least(run: Callable[[], object], repeated: int) -> tuple[float, float]:
    """Least times of some repetitions, by the processor and by the clock, in s."""
    times = []
    for _ in range(repeated):
        begun = process_time(), perf_counter()
        run()
        times.append((process_time() - begun[0], perf_counter() - begun[1]))
    of_processor, of_clock = zip(*times, strict=True)
    return min(of_processor), min(of_clock)


if __name__ == "__main__":
    main()
