"""Curves that the page of `spear explore` plots over time, by kind of motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.bounding_law import LEGS
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.explore.motion import Motion

Columns = dict[str, tuple[NDArray[np.float64], int]]  # values and decimals
Plot = tuple[str, str, dict[str, str]]  # title, unit, and the series with their labels

PLOTS: Mapping[str, tuple[Plot, ...]] = {
    "hop": (
        ("Height of the hip", "m", {"height": "hip"}),
        ("Ground force", "N", {"normal": "normal", "tangential": "tangential"}),
        ("Knee torque", "N·m", {"motor": "motor", "damper": "damping", "spring": "spring"}),
    ),
    "bound": (
        ("Pitch, nose up", "rad", {"pitch": "torso"}),
        ("Normal force, a pair", "N", {f"normal_{leg}": leg for leg in LEGS}),
        ("Knee motors, a pair", "N·m", {f"knee_{leg}": leg for leg in LEGS}),
        ("Hip motors, a pair", "N·m", {f"hip_{leg}": leg for leg in LEGS}),
    ),
}


def plots(motion: Motion) -> tuple[Plot, ...]:
    """Returns the plots of a motion."""
    kind = motion.knobs.subject.kind
    return PLOTS[kind] if kind in PLOTS else tuple(_plots_of_gait(motion.trajectory))


def series(motion: Motion) -> dict[str, list[float]]:
    """Returns series to plot over t, in s; torques in N·m, forces in N, heights in m, angles in rad."""
    trajectory = motion.trajectory
    own = COLUMNS[motion.knobs.subject.kind](trajectory)
    columns: Columns = {"t": (trajectory.t - trajectory.t[0], 5), **own}
    return {name: np.round(values, digits).tolist() for name, (values, digits) in columns.items()}


def _hop_columns(trajectory: Trajectory) -> Columns:
    """Returns height, forces and the torques on the knee."""
    knee = trajectory.actuated.index("knee")
    motor, spring = trajectory.u[:, knee], trajectory.spring[:, trajectory.spring_joints.index("knee")]
    return {
        "height": (trajectory.q[:, trajectory.coordinates.index("boom_z")], 5),
        "normal": (trajectory.force[:, 0, 1], 2),
        "tangential": (trajectory.force[:, 0, 0], 2),
        "motor": (motor, 4),
        "spring": (spring, 4),
        "damper": (trajectory.tau[:, knee] - motor - spring, 4),
    }


def _bound_columns(trajectory: Trajectory) -> Columns:
    """Returns pitch, nose up, forces and motors of the pairs."""
    columns: Columns = {"pitch": (-trajectory.q[:, trajectory.coordinates.index("pitch")], 5)}
    for i, leg in enumerate(LEGS):
        columns[f"normal_{leg}"] = trajectory.force[:, i, 1], 1
        for joint in ("knee", "hip"):
            columns[f"{joint}_{leg}"] = trajectory.u[:, trajectory.actuated.index(f"{leg}_{joint}")], 2
    return columns


def _gait_columns(trajectory: Trajectory) -> Columns:
    """Returns what `_plots_of_gait` plots."""
    return {
        **{name: (trajectory.q[:, trajectory.coordinates.index(name)], 5) for name in _heights(trajectory)},
        **{name: (trajectory.q[:, trajectory.coordinates.index(name)], 5) for name in _angles(trajectory)},
        **{f"normal_{toe}": (trajectory.force[:, i, -1], 2) for i, toe in enumerate(trajectory.toes)},
        **{f"motor_{joint}": (trajectory.u[:, i], 4) for i, joint in enumerate(trajectory.actuated)},
    }


def _plots_of_gait(trajectory: Trajectory) -> Iterator[Plot]:
    """Returns heights and angles that have no motor, normal forces, and motors of joints of one kind."""
    if _heights(trajectory):
        yield "Height", "m", {name: _words(name) for name in _heights(trajectory)}
    if _angles(trajectory):
        yield "Angles without a motor", "rad", {name: _words(name) for name in _angles(trajectory)}
    yield "Normal force", "N", {f"normal_{toe}": _words(toe) for toe in trajectory.toes}
    for kind in dict.fromkeys(joint.split("_")[-1] for joint in trajectory.actuated):
        joints = [joint for joint in trajectory.actuated if joint.split("_")[-1] == kind]
        labels = {f"motor_{joint}": _words(joint.removesuffix(f"_{kind}")) for joint in joints}
        yield f"{kind.capitalize()} motors", "N·m", labels


def _heights(trajectory: Trajectory) -> list[str]:
    return [name for name in trajectory.coordinates if name.endswith("_z")]


def _angles(trajectory: Trajectory) -> list[str]:
    """Returns coordinates without a motor that are no place and no heading."""
    others = {*trajectory.actuated, *_heights(trajectory)}
    places = ("_x", "_y", "yaw")
    return [name for name in trajectory.coordinates if name not in others and not name.endswith(places)]


def _words(name: str) -> str:
    return name.replace("_", " ")


COLUMNS: Mapping[str, Callable[[Trajectory], Columns]] = {
    "hop": _hop_columns,
    "bound": _bound_columns,
    "gait": _gait_columns,
}
