"""Derivatives of the figures of a displayed motion by its knobs, at their present values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError
from spear_pin.gaits.bounding import SPEED_BY
from spear_pin.gaits.measures.catalogue import added
from spear_pin.gaits.sensitivity.measure import DualMeasure, ratio
from spear_pin.gaits.sensitivity.multipliers import along_branch, moduli
from spear_pin.gaits.sensitivity.orbit import Orbit, branch, orbit_of_gait
from spear_pin.hybrid.parameters import number
from spear_pin.studies.explore.figures import MEASURES, figures, names_of
from spear_pin.studies.explore.legs import RATIO
from spear_pin.studies.explore.motion import Motion

ALIKE = 1e-4  # of a figure of samples, by which it may differ from the measure that is differentiated
MULTIPLIER = "multiplier"
LONE = "only what repeats each cycle has derivatives here"
SOLVED = "it is solved for"


@dataclass(frozen=True)
class Tangents:
    """Derivatives of a motion's figures by the knobs.

    Attributes:
        slopes: by knob and figure, change of the figure for one more unit of the knob; NaN where there is none.
        refused: why a knob has no derivatives, by knob.
        reason: why there are no derivatives at all; empty where there are some.
        one_sided: events that meet another; derivatives hold for the order that happens.
    """

    slopes: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    refused: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""
    one_sided: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Branch:
    """Gaits near a gait as knobs change.

    Attributes:
        orbit: orbit of the gait.
        ways: by knob, derivatives of ξ and of the orbit's parameters, (d + m,).
        refused: why a knob has no derivatives.
    """

    orbit: Orbit
    ways: Mapping[str, Array]
    refused: Mapping[str, str]

    def of(self, name: str) -> DualMeasure:
        """Returns a measure of the orbit with its derivatives by the knobs."""
        found = self.orbit.measures[name]
        return DualMeasure(found.value, np.array([found.derivative @ way for way in self.ways.values()]), found.unit)

    def number(self, name: str) -> DualMeasure:
        """Returns a parameter of the orbit."""
        i = self.orbit.dimension + self.orbit.names.index(name)
        return DualMeasure(number(self.orbit.system, name), np.array([way[i] for way in self.ways.values()]), "")


def tangents(motion: Motion) -> Tangents:
    """Returns derivatives of the figures that are measures of a whole cycle; a kept measure stays kept."""
    return _told(motion, lambda branch: dict(_slopes(motion, branch)))


def tangents_of_multiplier(motion: Motion) -> Tangents:
    """Returns derivatives of the largest multiplier's modulus, named `MULTIPLIER`, which take much longer."""
    return _told(motion, lambda branch: {MULTIPLIER: _of_multiplier(branch)})


def _told(motion: Motion, of: Callable[[_Branch], Mapping[str, Array]]) -> Tangents:
    if motion.gait is None:
        return Tangents(reason=LONE)
    try:
        branch = _branch(motion)
        rows = of(branch)
    except (SpearError, np.linalg.LinAlgError) as error:
        return Tangents(reason=str(error))
    slopes = {knob: {name: float(row[j]) for name, row in rows.items()} for j, knob in enumerate(branch.ways)}
    return Tangents(slopes, branch.refused, "", branch.orbit.cycle.borders)


def _branch(motion: Motion) -> _Branch:
    """Returns the branch through the gait.

    Raises:
        SpearError: there is no branch; the text says why.
    """
    subject, values, gait = motion.knobs.subject, motion.knobs.values, motion.gait
    assert gait is not None
    held = subject.held(motion.knobs.kept)
    refused = {name: SOLVED for name in held if name in values}
    moved = {name: subject.moved(name, values) for name in values if name not in refused}
    while True:
        over = list(dict.fromkeys(part for parts in moved.values() for part in parts))
        try:
            orbit = orbit_of_gait(gait.system, gait.state, over, list(held), list(held.values()))
            break
        except BadValue as error:
            without = [name for name, parts in moved.items() if error.name in parts]
            if not without:
                raise
            for name in without:
                refused[name] = str(error)
                del moved[name]
    kept, free = branch(orbit, list(held.values())), branch(orbit, ())
    ways = {}
    for name, parts in moved.items():
        if parts:
            ways[name] = kept @ np.array([parts.get(part, 0.0) for part in over])
        else:  # the value of what is kept
            ((_, measure),) = held.items()
            ways[name] = free[:, 0] / (orbit.measures[measure].derivative @ free[:, 0])
    return _Branch(orbit, ways, refused)


def _slopes(motion: Motion, branch: _Branch) -> Iterator[tuple[str, Array]]:
    """Returns derivatives of each figure that equals the measure: not a stance peak where the swing's is higher."""
    shown = figures(motion)
    for name, measure in _measures(motion.knobs.subject.kind, branch):
        value = shown[name]
        if value is not None and math.isclose(value, measure.value, rel_tol=ALIKE):
            yield name, measure.derivative


def _measures(kind: str, branch: _Branch) -> Iterator[tuple[str, DualMeasure]]:
    """Returns the figures that are measures, or follow from measures and parameters."""
    found = branch.orbit.measures
    for figure, kinds in {**MEASURES[kind], **{each.kind: (each.kind,) for each in added()}}.items():
        if names := names_of(found, kinds):
            yield figure, branch.of(max(names, key=lambda name: found[name].value))
    if kind == "hop" and RATIO in branch.orbit.names:
        yield "rotor_torque_knee", ratio(branch.of("peak_torque_knee"), branch.number(RATIO), "N·m")
    if kind == "bound":
        yield "posterior_hip_torque", branch.number(SPEED_BY)


def _of_multiplier(branch: _Branch) -> Array:
    """Returns derivatives of the largest multiplier's modulus, each along a parameter that the knob changes."""
    orbit, row = branch.orbit, []
    for way in branch.ways.values():
        changes = dict(zip(orbit.names, way[orbit.dimension :].tolist(), strict=True))
        lead = max(changes, key=lambda name: abs(changes[name] / (number(orbit.system, name) or 1.0)))
        rest = {name: np.array([each / changes[lead]]) for name, each in changes.items() if name != lead}
        values, slopes = along_branch(orbit, (lead,), (orbit.start @ way)[:, None] / changes[lead], rest)
        row.append(float(moduli(values, slopes)[1][0, 0]) * changes[lead])
    return np.array(row)
