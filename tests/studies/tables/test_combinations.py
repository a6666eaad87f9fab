"""Logs with several odd ways of writing at once: titles, byte order marks, separators, decimal marks, clocks, units."""

import numpy as np
import pytest

from spear_pin.studies.identification import read_record
from tests.studies.identification.files import ANGLE, T, written

CLOCKS = [  # name, word below it, per second, beginning
    ("time_s", "", 1, 0),
    ("Time (milliseconds)", "", 1000, 77),
    ("%time", "", 10**9, 17 * 10**17),
    ("stamp", "µs", 10**6, 17 * 10**14),
    ("t", "usec", 10**6, -5000),
    ("header.stamp", "", 1000, 17 * 10**11),
    ("Zeit", "[ms]", 1000, 0),
]
KNEES = [
    ("knee [rad]", "", 1.0),
    ("position", "deg", 180 / np.pi),
    ("knee (turns)", "", 0.5 / np.pi),
    ("q", "(°)", 180 / np.pi),
]
SEPARATORS = [(",", "."), (";", ","), (";", "."), ("\t", ","), ("\t", ".")]


def log(seed):
    """Text of the good record, written in one of many ways, and which of its rows hold numbers."""
    rng = np.random.default_rng(seed)
    time, time_unit, per_second, begin = CLOCKS[seed % len(CLOCKS)]
    knee, knee_unit, factor = KNEES[seed // 2 % len(KNEES)]
    separator, decimal = SEPARATORS[seed // 3 % len(SEPARATORS)]
    angle = ANGLE.copy()
    if rng.integers(2):
        angle = np.mod(angle - 1.1, 2 * np.pi) + 1.1 - 2 * np.pi
    held = np.ones(T.size, bool)
    if rng.integers(2):
        held[rng.choice(np.arange(1, T.size), 7, replace=False)] = False
    ticks = [f"{begin + i * per_second // 1000}" if per_second >= 1000 else f"{i / 1000:.3f}" for i in range(T.size)]
    cells = [
        f"{a:.7f}" if good else rng.choice(["NaN", "", "--"]) for a, good in zip(angle * factor, held, strict=True)
    ]
    lines = [f"{t}{separator}{a}".replace(".", decimal) for t, a in zip(ticks, cells, strict=True)]
    head = [f"{time}{separator}{knee}"] + [f"{time_unit}{separator}{knee_unit}"] * bool(time_unit or knee_unit)
    titles = ["Push test 3", f"operator{separator}nobody", ""][: rng.integers(4)]
    end = ["\n", "\r\n"][rng.integers(2)]
    return "\ufeff" * int(rng.integers(2)) + end.join([*titles, *head, *lines, ""]), held


@pytest.mark.parametrize("seed", range(70))
def test_read_alike(seed, tmp_path):
    text, held = log(seed)
    record = read_record(written(tmp_path, text))
    np.testing.assert_allclose(record.t, T[held], rtol=0, atol=3e-7)
    np.testing.assert_allclose(record.angle, ANGLE[held], rtol=0, atol=1e-6)
    assert any(" 7 of 400 rows" in remark for remark in record.remarks) == (not held.all())
