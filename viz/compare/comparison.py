"""A comparison: the API, its table, and the page that it saves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.showing import Player
from spear_pin.studies.comparison import (
    ComparedMeasure,
    Difference,
    Side,
    compare_measures,
    describe_differences,
    differences,
    sides_of,
)
from spear_pin.studies.comparison.sides import CYCLES, different

HEIGHT = 720  # px of the frame of a notebook


@dataclass(frozen=True, repr=False)
class Comparison:
    """A comparison of gaits, motions, springs or robots; a notebook shows the page.

    Attributes:
        sides: the compared sides; the first is the reference.
        measures: measures of all sides, with differences.
        differences: parameters that differ.
        said: the main differences in sentences.
    """

    sides: tuple[Side, ...]
    measures: tuple[ComparedMeasure, ...]
    differences: tuple[Difference, ...]
    said: tuple[str, ...]

    def __repr__(self) -> str:
        labels = ", ".join(side.label for side in self.sides)
        return f"Comparison({labels}: {len(self.measures)} measures, {len(self.differences)} parameters differ)"

    def _repr_html_(self) -> str:
        return Player(self.page, HEIGHT)._repr_html_()

    @cached_property
    def page(self) -> str:
        """Text of the page, of less than 5 MB, which loads nothing else."""
        from spear_pin.viz.compare.page import render

        return render(self.sides, self.measures, self.differences, self.said)

    @typed
    def save(self, path: str | Path) -> Path:
        """Writes the page, which any browser shows.

        Raises:
            BadFile: the file cannot be written.
            BadValue: the motions do not fit into the page.
        """
        return Player(self.page, HEIGHT).save(path)

    def to_pandas(self) -> Any:
        """Returns the measures as a `pandas.DataFrame`: group, unit and values, differences and % of each side.

        A side whose label is already a column's gets a number there, as "unit (2)".
        """
        import pandas

        labels = [side.label for side in self.sides]
        others = [f"{label}{part}" for part in (", difference", ", %") for label in labels[1:]]
        rows = [
            [row.group, row.name, row.unit, *row.values, *row.changes[1:], *row.shares[1:]] for row in self.measures
        ]
        table = pandas.DataFrame(rows, columns=different(["group", "measure", "unit", *labels, *others]))
        return table.set_index(["group", "measure"])


@typed
def compare(
    *items: Gait | Trajectory | Robot | Spring | str | Path,
    names: Sequence[str] = (),
    cycles: int = CYCLES,
    of: Gait | None = None,
) -> Comparison:
    """Compares two or more gaits, motions, springs or robots; the first is the reference for the others.

    Springs are compared by hops: SPEAR-II's hop in place with each spring, its stance torque solved for 0.2 s of
    flight.

    Args:
        items: gaits, trajectories, robots, springs; or words: the name of a gait that ships or of a robot, the path of
            a saved gait (.json), a trajectory (.npz) or a robot, or numbers of a spring, "stiffness=40,damping=1".
        names: labels, one for each; by default the names of the items.
        cycles: number of cycles of each gait to simulate.
        of: another gait into which springs are put. If it is a hop whose stance torque was solved for, the torque is
            solved for again, for the same flight time. For other gaits only the fixed point is found again, with the
            law unchanged.

    Raises:
        SpearError: there are fewer than two items or more than six, one cannot be read, or no gait has a spring.

    Example:
        >>> from spear_pin import Spring, compare
        >>> both = compare(Spring(stiffness=40.0), Spring(stiffness=60.0))
        >>> both
        Comparison(stiffness=40, stiffness=60: ... measures, 2 parameters differ)
        >>> [each.name for each in both.differences]
        ['law: stance_torque', 'spring: stiffness']
    """
    sides = sides_of(items, names, cycles=cycles, of=of)
    rows = compare_measures(sides)
    return Comparison(sides, rows, differences(sides), describe_differences(sides, rows))
