"""Numbers, differences and parameters of a comparison in words, for its page and its text."""

from __future__ import annotations

from typing import Any

from spear_pin.model.spring import UNITS as OF_SPRING
from spear_pin.studies.comparison import Difference
from spear_pin.viz.plots.sweep import UNITS as OF_SWEEP

UNITS = {**OF_SWEEP, **OF_SPRING, "slope": "rad", "height": "m", "rest": "rad"}
NONE = "–"
SHOWN = 3  # numbers of a list


def value(number: float) -> str:
    """Formats a number with four digits."""
    return f"{number:.4g}".replace("-", "−")


def number(number: float | None) -> str:
    """Formats a number with four digits, or a dash."""
    return NONE if number is None else value(number)


def change(number: float | None) -> str:
    """Formats a difference with its sign, or a dash."""
    return NONE if number is None else "0" if number == 0 else f"{number:+.3g}".replace("-", "−")


def percent(share: float | None) -> str:
    """Formats a share in % with its sign, or a dash."""
    if share is None:
        return NONE
    return "0" if share == 0 else f"{share:+.1f}".replace("-", "−") if abs(share) >= 0.05 else "±0.0"


def parameters(row: Difference) -> list[str]:
    """Formats the values of a parameter that differs, each with its unit where that is known."""
    usual = UNITS.get(row.name.rpartition(": ")[2], "")
    units = row.units or len(row.values) * (usual,)
    return [parameter(each, unit) for each, unit in zip(row.values, units, strict=True)]


def parameter(given: Any, unit: str = "") -> str:
    """Formats a parameter with its unit; of a list the first few numbers."""
    if given is None:
        return NONE
    if isinstance(given, bool):
        return "yes" if given else "no"
    if isinstance(given, (int, float)):
        return f"{given:.6g}".replace("-", "−") + (f" {unit}" if unit else "")
    if isinstance(given, (list, tuple)):
        numbers = _flat(given)
        more = f", … ({len(numbers)} numbers)" if len(numbers) > SHOWN else ""
        return ", ".join(map(value, numbers[:SHOWN])) + more or "none"
    return str(given)


def _flat(given: Any) -> list[float]:
    return [each for part in given for each in _flat(part)] if isinstance(given, (list, tuple)) else [float(given)]
