"""Data for the template of a comparison's page: motions for their viewers, tables, the unit circle."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from spear_pin import __version__
from spear_pin.errors import BadValue
from spear_pin.model.robot import Robot
from spear_pin.studies.comparison import ComparedMeasure, Difference, Side
from spear_pin.studies.comparison.sides import make_standing
from spear_pin.viz.bench.samples import packed, samples_of, thinned
from spear_pin.viz.compare.words import change, number, parameters, percent, value
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.frames import resample
from spear_pin.viz.playback.scene import GHOST, ROBOT, moving
from spear_pin.viz.player import SPEEDS, as_data, encoded
from spear_pin.viz.template import environment

MOST_BYTES = 5_000_000
RATES = (60.0, 30.0, 15.0, 10.0)  # frames a second, the first that fits
MOST_VALUES = 48_000, 120_000  # numbers of samples: of a side, of all
MOST_PLOTTED = 2  # columns of a kind that are plotted at first


@dataclass(frozen=True)
class Mark:
    """A multiplier in the plane: its path in units of the plane, its side, and its value in words."""

    path: str
    side: int
    says: str


def render(
    sides: tuple[Side, ...],
    measures: tuple[ComparedMeasure, ...],
    differences: tuple[Difference, ...],
    said: tuple[str, ...],
) -> str:
    """Returns the text of the page, with as many frames a second as it may hold.

    Args:
        sides: the compared sides.
        measures: measures of all sides.
        differences: parameters that differ.
        said: sentences at the top.

    Raises:
        BadValue: the motions do not fit into the page.
    """
    view = environment(number=number, percent=percent, change=change, parameters=parameters)
    reach = max([1.0, *(float(np.abs(side.gait.multipliers).max()) for side in sides if side.gait is not None)])
    given = {
        "version": __version__,
        "title": " against ".join(side.label for side in sides[:2]) + (" and others" if len(sides) > 2 else ""),
        "sides": sides,
        "measures": measures,
        "groups": list(dict.fromkeys(row.group for row in measures)),
        "differences": differences,
        "said": said,
        "notes": [note for side in sides for note in side.notes],
        "moves": any(side.run is not None for side in sides),
        "marks": [mark for i, side in enumerate(sides) for mark in _marks(side, i, reach)],
        "reach": 1.12 * reach,
        "swatches": [_shape(i, 5.0, 5.0, 4.0) for i in range(len(sides))],
    }
    arrows = _arrows(sides)
    for rate in RATES:
        text = view.get_template("compare/page.html").render(**given, data=_data(sides, rate, arrows))
        if len(text.encode()) < MOST_BYTES:
            return text
    seconds = sum(float(np.ptp(side.run.t)) for side in sides if side.run is not None)
    raise BadValue(
        "motions", f"{seconds:.4g} s", f"shorter motions, which fit into {MOST_BYTES} bytes: give fewer cycles"
    )


def _data(sides: tuple[Side, ...], rate: float, arrows: list[float | None]) -> dict[str, Any]:
    """Returns the data for the page's scripts, with a frame rate, and arrow scales from `_arrows` for each side."""
    shown = [_side(side, sides[0] if i else None, rate, arrows[i], len(sides)) for i, side in enumerate(sides)]
    return {"sides": shown, "speeds": SPEEDS, "rate": rate, "plotted": _plotted(shown)}


def _side(side: Side, first: Side | None, rate: float, newtons: float | None, count: int) -> dict[str, Any]:
    """Returns a side in the form for its viewer; the first is the ghost of sides with the same robot."""
    motion = make_standing(side.robot) if side.run is None else side.run
    frames = resample(side.robot, motion, rate)
    haunting = first.run if first is not None and side.run is not None and _alike(first.robot, side.robot) else None
    ghost = None if haunting is None else resample(side.robot, haunting, rate, "ghost")
    scene = moving(side.robot, frames, ghost, newtons)
    longest = max(frames.duration, 0.0 if ghost is None else ghost.duration)
    samples = thinned(samples_of(side.robot, motion), min(MOST_VALUES[0], MOST_VALUES[1] // count))
    return as_data(frames, scene, encoded(c.set_animation(scene.clips, longest)), side.label) | {
        "ghost": None if ghost is None else {"of": ROBOT, "path": GHOST},
        "samples": packed(samples),
        "stands": side.run is None,
        "bounds": _bounds(side),
    }


def _arrows(sides: tuple[Side, ...]) -> list[float | None]:
    """Returns newtons per metre of an arrow for each side, equal for sides with the same robot; None without arrows."""
    own = [
        0.0 if side.run is None else moving(side.robot, resample(side.robot, side.run, RATES[-1])).newtons
        for side in sides
    ]
    return [
        max(most for most, other in zip(own, sides, strict=True) if _alike(other.robot, side.robot)) or None
        for side in sides
    ]


def _alike(one: Robot, other: Robot) -> bool:
    """Tells whether a robot's ghost can be drawn with the links of the other."""
    same = one.source == other.source and str(one.cut) == str(other.cut)
    return same and one.model.nq == other.model.nq and list(one.model.names) == list(other.model.names)


def _bounds(side: Side) -> list[float]:
    """Returns when whole cycles begin, and when the last ends, in s from the first sample."""
    run = side.run
    if run is None or not run.cycles:
        return []
    numbers = [n for n in np.unique(run.cycle).tolist() if n >= 1][: run.cycles]
    rows = [np.flatnonzero(run.cycle == n)[[0, -1]] for n in numbers]
    return [*(float(run.t[begin] - run.t[0]) for begin, _ in rows), float(run.t[rows[-1][1]] - run.t[0])]


def _plotted(sides: list[dict[str, Any]]) -> list[str]:
    """Returns columns that are plotted at first: of each kind the first few that some side would plot."""
    wanted = list(dict.fromkeys(name for side in sides for name in side["samples"]["plotted"]))
    kinds = {column["name"]: column["kind"] for side in sides for column in side["samples"]["columns"]}
    seen: Counter[str] = Counter()
    chosen = []
    for name in wanted:
        seen[kinds[name]] += 1
        if seen[kinds[name]] <= MOST_PLOTTED:
            chosen.append(name)
    return chosen


def _marks(side: Side, i: int, reach: float) -> list[Mark]:
    if side.gait is None:
        return []
    values = side.gait.multipliers.tolist()
    return [
        Mark(_shape(i, z.real, -z.imag, 0.035 * reach), i, f"{side.label}: {_complex(z)}, modulus {abs(z):.4g}")
        for z in values
        if math.isfinite(abs(z))
    ]


def _complex(z: complex) -> str:
    sign = "−" if z.imag < 0 else "+"
    return value(z.real) if z.imag == 0 else f"{value(z.real)} {sign} {value(abs(z.imag))}i"


def _shape(number: int, x: float, y: float, r: float) -> str:
    """Returns the outline of a side's mark: circle, square, diamond, triangles, cross."""
    corners = {
        1: [(-0.85, -0.85), (0.85, -0.85), (0.85, 0.85), (-0.85, 0.85)],
        2: [(0, -1.2), (1.2, 0), (0, 1.2), (-1.2, 0)],
        3: [(0, -1.1), (1.1, 0.9), (-1.1, 0.9)],
        4: [(0, 1.1), (1.1, -0.9), (-1.1, -0.9)],
        5: [(-1.2, -0.35), (1.2, -0.35), (1.2, 0.35), (-1.2, 0.35)],
    }.get(number)
    if corners is None:
        return f"M{x - r:.4g} {y:.4g}a{r:.4g} {r:.4g} 0 1 0 {2 * r:.4g} 0a{r:.4g} {r:.4g} 0 1 0 {-2 * r:.4g} 0z"
    return "M" + "L".join(f"{x + r * a:.4g} {y + r * b:.4g}" for a, b in corners) + "z"
