"""Targets for cycles: wanted values of their measures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.errors import BadValue, NoGait, UnknownName
from spear_pin.gaits.measures.catalogue import describe_measure, measures
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.result import Run
from spear_pin.hybrid.rules.cycles import flight_times
from spear_pin.hybrid.simulate import simulate

SAMPLES = 400  # of each phase
FLIGHT = "flight_time"  # the measure that the section's event bounds
SPEED, FORWARD = "mean_speed", "posterior_hip_torque"  # laws with this torque only go forward


def check_wanted(system: HybridSystem, target: Mapping[Any, ArrayLike]) -> None:
    """Refuses targets that no cycle of a system has, before a search begins.

    Args:
        system: the system.
        target: wanted values, one or many each, of measures or of functions of the cycle.

    Raises:
        BadValue: a value is not a finite number, a flight is too short to close a cycle or longer than a phase may
            be, or a quadruped's speed is not above zero.
    """
    for name, wanted in target.items():
        values = np.atleast_1d(np.asarray(wanted, dtype=float))
        valid, expected = np.isfinite(values), "a finite number"
        if name == FLIGHT:
            least, most = flight_times(system)
            valid = (least <= values) & (values <= most)
            expected = f"a number from {least:g} to {most:g}, in s: the system's shortest flight and longest phase"
        elif name == SPEED and hasattr(system.law, FORWARD):
            valid, expected = valid & (values > 0.0), "a number > 0, in m/s: the law only goes forward"
        if not valid.all():
            raise BadValue(f"target {name}", float(values[~valid][0]), expected)


def measures_of(system: HybridSystem, *, sampled: bool = False) -> list[str]:
    """Returns the names of the measures that may be targets: the system's own, then the others of the catalogue.

    Args:
        system: the system.
        sampled: whether to leave out those that only derivatives give.
    """
    others = [name for name, each in measures(system).items() if each.sampled or not sampled]
    return [*dict.fromkeys([*system.measures, *others])]


def measure_of(system: HybridSystem, measure: str | Callable[[Run], float]) -> Callable[[HybridSystem, Run], float]:
    """Returns a function that measures the run of a cycle of a system, maybe with other numbers.

    Args:
        system: a system of the same kind.
        measure: a measure's name, or a function of a run. What is not the system's own comes from samples.

    Raises:
        UnknownName: there is no measure of that name.
    """
    of_run = measure if callable(measure) else system.measures.get(measure)
    if of_run is not None:
        return lambda other, run: of_run(run)
    if measure not in measures(system):
        raise UnknownName("measure", str(measure), measures_of(system))

    def of_samples(other: HybridSystem, run: Run) -> float:
        cycles, halves = range(1, 2 + bool(other.mirrored_toes)), bool(other.mirrored_toes)
        motion = simulate(other, run.start, len(cycles), samples=SAMPLES, progress=False)
        if motion.cycles < len(cycles):
            raise NoGait(f"a cycle for {measure} does not close: {motion.message}", math.inf)
        found = Sampled(other.robot, motion, cycles, halves).values()
        if measure not in found:
            told = "samples do not give it" if not describe_measure(str(measure)).sampled else "this cycle has none"
            raise BadValue("target", measure, f"a measure that needs no derivatives: {told}")
        return found[str(measure)]

    return of_samples
