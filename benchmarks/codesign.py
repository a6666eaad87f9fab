"""Designs by gradient beside a grid and CMA-ES: `python -m benchmarks.codesign [--json] [--only PART ...]`.

What is counted is cycles, run and differentiated alike. Of the hop: energy over spring, gear ratio and touchdown angle
from five starts, the same over a grid of 5³ and by CMA-ES (package `cma`), each point of which is followed by the same
Newton's method from the nearest gait known; and over nine parameters. Of bounds: cost of transport over spring, gear
ratio and touchdown angles. The energy is the net work of both motors and the heat of the knee's, gears without losses.
Of motors: electricity of the hop over size of the knee's motor, spring or the torque in its place, gears and gains.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product
from time import process_time

import numpy as np

from spear_pin import Gait, HoppingLaw, Spring, find_gait, hopping, load, optimize_design
from spear_pin.arrays import Array
from spear_pin.errors import NoGait
from spear_pin.gaits.codesign.design import Design
from spear_pin.gaits.codesign.problem import Problem, largest
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.sensitivity.closing import close_cycle, find_changed
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.catalogue import gearbox, motor
from spear_pin.model.motor import Drive, Gearbox

Ranges = Mapping[str, tuple[float, float]]
HOP: Ranges = {"stiffness": (42.0, 60.0), "knee_ratio": (8.0, 30.0), "knee_touchdown": (0.80, 1.02)}
MORE: Ranges = {
    **HOP,
    "frequency": (2.2, 3.0),
    "knee_gain": (40.0, 120.0),
    "knee_damping": (0.2, 3.0),
    "hip_gain": (35.0, 110.0),
    "hip_damping": (0.5, 4.0),
    "hip_ratio": (40.0, 80.0),
}
SIZES: Ranges = {
    "knee_motor_size": (0.4, 2.0),
    "knee_ratio": (8.0, 30.0),
    "knee_touchdown": (0.80, 1.02),
    "knee_gain": (40.0, 200.0),
    "knee_damping": (0.2, 3.0),
}
VARY, KEEP = ("stance_torque",), {"flight_time": 0.2}
BOUNDS = {"at_least": {"margin_spring_switch": 0.02}, "largest_multiplier": 0.6}
MARGINS = {"margin_spring_switch": 0.02, "margin_slip": 0.5, "margin_lift_off": 0.5}  # rad, N, N
MOTORS = {"knee": motor("spear_ii_knee")}
DRIVES = {
    "knee": Drive(MOTORS["knee"], gearbox("spear_ii_knee_gear"), 24.0),
    "hip": Drive(motor("faulhaber_3863h024cr"), Gearbox(60.0, 0.75), 24.0),  # its efficiency is an assumption
}
STARTS, HALVINGS, BUDGET = 5, 5, 3000
APART = 0.01  # of ranges: designs that differ by more are told apart
NO_GAIT, PENALTY = 1e3, 1e3  # J; of bounds missed, relative to them


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print them as JSON")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), help="some parts")
    arguments = parser.parse_args()
    rows = []
    for part in arguments.only:
        for row in PARTS[part]():
            rows.append({"part": part, **row})
            if not arguments.json:
                print(part, ", ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    if arguments.json:
        print(json.dumps(rows))


def hop() -> Gait:
    """The hop that all begin with."""
    return find_gait(hopping(load("spear_ii", locked=["boom_x"])), vary=VARY, target=KEEP)


def problem(over: Ranges) -> Problem:
    """The design of the hop."""
    return Problem("energy", over, VARY, KEEP, {}, BOUNDS["at_least"], BOUNDS["largest_multiplier"], MOTORS)


class Followed:
    """Gaits at points of a range, each from the nearest known one, with steps that are halved where that fails."""

    def __init__(self, begun: Gait, problem: Problem) -> None:
        self.problem, self.cycles = problem, 0
        first = close_cycle(Orbit(begun.system, begun.state, problem.names, problem.motors), problem.keep)
        self.known = {tuple(self.at(first)): first}

    def at(self, orbit: Orbit) -> Array:
        """Where in its ranges a gait lies, from 0 to 1."""
        values = np.array([number(orbit.system, name) for name in self.problem.over])
        return (values - self.problem.lower) / self.problem.span

    def _count(self) -> None:
        self.cycles += 1

    def gait(self, x: Array) -> Orbit | None:
        """The gait at a point."""
        near = min(self.known, key=lambda key: float(np.abs(x - key).max()))
        orbit, done, step = self.known[near], 0.0, 1.0
        while done < 1.0:
            change = (x - near) * min(step, 1.0 - done) * self.problem.span
            try:
                by = dict(zip(self.problem.over, change.tolist(), strict=True))
                orbit = find_changed(orbit, self.problem.keep, by, self._count)
            except (NoGait, NotDifferentiable):
                step *= 0.5
                if step < 0.5**HALVINGS:
                    return None
                continue
            done += step
        self.known[tuple(self.at(orbit))] = orbit
        return orbit

    def cost(self, orbit: Orbit) -> tuple[float, float]:
        """What is minimised, and by how much bounds are missed, relative to them."""
        value, slack = self.problem.values(orbit)
        of_measures, limit = slack[: len(self.problem.bounds)], self.problem.largest_multiplier
        missed = float(np.maximum(-of_measures, 0.0).sum())
        return value, missed + (0.0 if limit is None else max(0.0, largest(orbit) - limit))


def starts(over: Ranges, count: int, begun: Gait | None = None) -> Iterator[Gait]:
    """Gaits at points drawn in the ranges."""
    draws, followed = np.random.default_rng(3), Followed(begun or hop(), problem(over))
    while count:
        orbit = followed.gait(draws.uniform(size=len(over)))
        if orbit is None:
            continue
        try:
            gait = gait_beside(orbit.system, orbit.state, VARY, KEEP)
        except NoGait:  # at a border
            continue
        count -= 1
        yield gait


def told(found: Design, seconds: float) -> dict[str, object]:
    """Figures of a design."""
    return {
        "start": round(found.start, 5),
        "objective": round(found.objective, 6),
        **{name: float(f"{each.value:.5g}") for name, each in found.parameters.items()},
        "largest": round(found.largest, 4),
        "cycles": found.cycles,
        "seconds": round(seconds, 1),
        "held by": list(found.active),
        "reason": found.reason,
    }


def designs(over: Ranges, margins: Mapping[str, float]) -> Iterator[dict[str, object]]:
    """From each start."""
    bounds = {**BOUNDS, "at_least": margins}
    for gait in starts(over, STARTS):
        begun = process_time()
        found = optimize_design(gait, "energy", over, KEEP, motors=MOTORS, assuming=[], **bounds)
        yield told(found, process_time() - begun)


def grid() -> Iterator[dict[str, object]]:
    """The best of 5³ points."""
    followed, begun, best, found = Followed(hop(), problem(HOP)), process_time(), np.inf, 0
    for x in sorted(product(np.linspace(0.0, 1.0, 5), repeat=3), key=lambda x: np.abs(np.array(x) - 0.5).max()):
        orbit = followed.gait(np.array(x))
        if orbit is not None:
            value, missed = followed.cost(orbit)
            found += 1
            best = min(best, value if missed == 0.0 else np.inf)
    seconds = process_time() - begun
    yield {
        "points": 125,
        "gaits": found,
        "best": round(best, 4),
        "cycles": followed.cycles,
        "seconds": round(seconds, 1),
    }


def evolution() -> Iterator[dict[str, object]]:
    """CMA-ES from the hop, bounds by penalties; cycles until it was within 10⁻³ of its best, and in all."""
    import cma

    for seed in range(1, 4):
        followed, begun, path = Followed(hop(), problem(HOP)), process_time(), []
        (x0,) = followed.known

        def cost(x: Array, followed: Followed = followed, path: list[tuple[float, int]] = path) -> float:
            orbit = followed.gait(np.asarray(x))
            if orbit is None:
                return NO_GAIT
            value, missed = followed.cost(orbit)
            if missed <= 1e-6:
                path.append((value, followed.cycles))
            return value + PENALTY * missed

        search = cma.CMAEvolutionStrategy(list(x0), 0.2, {"bounds": [0.0, 1.0], "seed": seed, "verbose": -9})
        while not search.stop() and followed.cycles < BUDGET:
            points = search.ask()
            search.tell(points, [cost(x) for x in points])
        best = min(value for value, _ in path)
        near = next(cycles for value, cycles in path if value <= best + 1e-3)
        yield {
            "seed": seed,
            "best": round(best, 5),
            "cycles to its best": near,
            "cycles": followed.cycles,
            "seconds": round(process_time() - begun, 1),
        }


def bounds() -> Iterator[dict[str, object]]:
    """Positive cost of transport of two bounds at their speeds."""
    for name, speed, limit in (("long_stride_3.50", 3.5, 1.0), ("long_stride", 2.5, None)):
        gait = Gait.load(name)
        over = {"stiffness": (60.0, 160.0), "knee_ratio": (8.0, 20.0)}
        for angle in ("posterior_leg_touchdown", "anterior_leg_touchdown"):
            over[angle] = (number(gait.system, angle) - 0.06, number(gait.system, angle) + 0.06)
        begun = process_time()
        found = optimize_design(
            gait, "cost_of_transport_positive", over, {"mean_speed": speed}, largest_multiplier=limit, assuming=[]
        )
        yield {"gait": name, **told(found, process_time() - begun)}


def sizes() -> Iterator[dict[str, object]]:
    """From each start, with the switchable spring, and with a torque of the motor in its place."""
    rigid = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(virtual_stiffness=48.84), Spring(stiffness=0.0))
    begun = {"stiffness": hop(), "virtual_stiffness": find_gait(rigid, vary=VARY, target=KEEP)}
    margins = {**MARGINS, "reserve_knee": 0.0}
    for name, first in begun.items():
        over, ends = {**SIZES, name: (42.0, 60.0)}, list[Array]()
        for gait in starts(over, STARTS, first):
            clock, at = process_time(), gait.system.robot
            drives = {
                joint: replace(each, gearbox=replace(each.gearbox, ratio=at.gear_ratio(joint)))
                for joint, each in DRIVES.items()
            }
            bounds = {**BOUNDS, "at_least": margins}
            found = optimize_design(gait, "electricity", over, KEEP, motors=drives, assuming=[], **bounds)
            end = Orbit(found.gait.system, found.gait.state, (), DRIVES)
            yield {
                **told(found, process_time() - clock),
                "mass": round(found.motor_masses["knee"], 3),
                "heating": round(end.measures["heating_knee"].value, 2),
                "missed": float(f"{found.missed:.1g}"),
            }
            ends.append(np.array([each.value / (each.high - each.low) for each in found.parameters.values()]))
        apart = [x for i, x in enumerate(ends) if all(np.abs(x - other).max() > APART for other in ends[:i])]
        yield {"starts": STARTS, "ends apart": len(apart)}


PARTS = {
    "hop": lambda: designs(HOP, BOUNDS["at_least"]),
    "grid": grid,
    "cma": evolution,
    "nine": lambda: designs(MORE, MARGINS),
    "bound": bounds,
    "motor": sizes,
}

if __name__ == "__main__":
    main()
