"""Dates with a time of day, and times of day alone, as seconds."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array

DAY = 86400.0  # s
_MOMENT = (
    r"(?:(?P<year>\d{4})[-/](?P<month>\d\d)[-/](?P<day>\d\d)(?:[T_]|\s+)"  # ISO 8601, and nearly
    r"|(?P<tag>\d\d?)\.(?P<monat>\d\d?)\.(?P<jahr>\d{4})(?:T|,?\s+))?"  # as in German
    r"(?P<hours>\d\d?):(?P<minutes>\d\d):(?P<seconds>\d\d(?:[.,]\d*)?)"
    r"\s*(?:Z|UTC|(?P<zone>[+-]\d\d(?::?\d\d)?))?"
)


def read_moments(cells: Any) -> Array:
    """Reads dates with a time of day, as seconds since 1970, and times of day, as seconds since midnight.

    Args:
        cells: a pandas series of texts.

    Returns:
        (n,), NaN where a cell holds neither.
    """
    import pandas as pd

    found = cells.str.strip().str.extract(f"^{_MOMENT}$")
    words = (("year", "jahr"), ("month", "monat"), ("day", "tag"))
    parts = {iso: found[iso].astype(float).fillna(found[german].astype(float)) for iso, german in words}
    day = pd.to_datetime(pd.DataFrame(parts), errors="coerce")
    since = (day - pd.Timestamp(1970, 1, 1)).dt.total_seconds()
    midnight = since.where(parts["year"].notna(), 0.0)
    seconds = found["seconds"].str.replace(",", ".", regex=False).astype(float)
    of_day = 3600.0 * found["hours"].astype(float) + 60.0 * found["minutes"].astype(float) + seconds
    zone = found["zone"].str.replace(":", "", regex=False)
    east = 60.0 * zone.str[1:3].astype(float) + zone.str[3:5].replace("", "0").astype(float)
    ahead = (60.0 * east * np.where(zone.str[0] == "-", -1.0, 1.0)).fillna(0.0)
    return np.asarray(midnight + of_day - ahead, dtype=np.float64)


def past_midnight(seconds: Array) -> Array:
    """Lets times of day go on past midnight, in s; dates stay as they are."""
    known = np.flatnonzero(np.isfinite(seconds))
    if not known.size or seconds[known].max() > DAY + 1.0:
        return seconds
    found = seconds.copy()
    found[known] += DAY * np.cumsum(np.diff(seconds[known], prepend=seconds[known[:1]]) < -0.5 * DAY)
    return found
