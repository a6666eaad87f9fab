"""Targets for cycles: wanted values of their measures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.rules.cycles import flight_times

FLIGHT = "flight_time"  # the measure that the section's event bounds


def check_wanted(system: HybridSystem, target: Mapping[Any, ArrayLike]) -> None:
    """Refuses targets that no cycle of a system has, before a search begins.

    Args:
        system: the system.
        target: wanted values, one or many each, of measures or of functions of the cycle.

    Raises:
        BadValue: a value is not a finite number, or a flight is too short to close a cycle or longer than a phase may
            be.
    """
    for name, wanted in target.items():
        values = np.atleast_1d(np.asarray(wanted, dtype=float))
        valid, expected = np.isfinite(values), "a finite number"
        if name == FLIGHT:
            least, most = flight_times(system)
            valid = (least <= values) & (values <= most)
            expected = f"a number from {least:g} to {most:g}, in s: the system's shortest flight and longest phase"
        if not valid.all():
            raise BadValue(f"target {name}", float(values[~valid][0]), expected)
