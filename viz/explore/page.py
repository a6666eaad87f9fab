"""The page on which one turns the hop's numbers: its text, and the answers it asks for.

A page of our own, on the scene of the recorded one: viser or meshcat's server would add sockets and processes, and
sliders, plots and an address that holds the state would still have to be written.
"""

from __future__ import annotations

import base64
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.hops import VIEWS, Hops, settled
from spear_pin.studies.explore.knobs import KNOBS, Knobs
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.frames import Frames, resample
from spear_pin.viz.playback.overlays import ARROW_COLOR, COIL_COLOR, TRAIL_COLOR
from spear_pin.viz.playback.scene import Scene, moving
from spear_pin.viz.playback.stage import HORIZON, WORLD
from spear_pin.viz.player import SPEEDS, in_words
from spear_pin.viz.template import css, environment

CLIENT = "Spear-Client"  # header by which a page tells itself from others; what comes without is one client
RATE = 60.0  # frames per second
READOUTS = {  # label, unit and decimals of the figures
    "apex_height": ("Apex of the hip", "m", 4),
    "flight_time": ("Flight", "s", 4),
    "stance_time": ("Stance", "s", 4),
    "peak_force": ("Peak ground force", "N", 1),
    "peak_torque": ("Peak knee torque", "N·m", 2),
    "rotor_torque": ("before the gear", "N·m", 3),
    "peak_power": ("Peak knee power", "W", 1),
    "motor_work": ("Motor work a hop", "J", 2),
    "spring_share": ("Spring's share", "%", 1),
}
PLOTS = (  # title, unit, and the series with their labels and colours, those of `plots`
    ("Height of the hip", "m", {"height": ("", "#0072B2")}),
    ("Ground force", "N", {"normal": ("normal", "#0072B2"), "tangential": ("tangential", "#D55E00")}),
    (
        "Knee torque",
        "N·m",
        {"motor": ("motor", "#0072B2"), "spring": ("spring", "#009E73"), "damper": ("damping", "#D55E00")},
    ),
)


def page(engine: Engine) -> str:
    """The text of the page."""
    return environment().get_template("explore/page.html").render(data=_opening(engine))


def answer(view: str, hops: Hops) -> dict[str, Any]:
    """Hops as the page shows them: playback, series to plot, figures."""
    frames, scene = _scene(hops)
    multipliers = hops.gait.multipliers.tolist() if hops.gait is not None else []
    return {
        "view": view,
        "knobs": hops.knobs.values,
        "verdict": hops.verdict,
        "message": hops.message,
        "figures": figures(hops),
        "multipliers": [[value.real, value.imag] for value in multipliers],
        "duration": frames.duration,
        "spans": [[in_words(span.name), span.begin, span.end] for span in frames.spans],
        "events": [[in_words(name), time] for name, time in frames.events],
        "series": series(hops.trajectory),
        "commands": [_packed(command) for command in _changes(scene)]
        + [_packed(c.set_animation(scene.clips, frames.duration))],
    }


def series(trajectory: Trajectory) -> dict[str, list[float]]:
    """Series plotted over t, in s: height in m, forces in N, torques on the knee in N·m."""
    knee = trajectory.actuated.index("knee")
    motor, spring = trajectory.u[:, knee], trajectory.spring[:, trajectory.spring_joints.index("knee")]
    height = trajectory.q[:, trajectory.coordinates.index("boom_z")]
    columns: dict[str, tuple[NDArray[np.float64], int]] = {
        "t": (trajectory.t - trajectory.t[0], 5),
        "height": (height, 5),
        "normal": (trajectory.force[:, 0, 1], 2),
        "tangential": (trajectory.force[:, 0, 0], 2),
        "motor": (motor, 3),
        "spring": (spring, 3),
        "damper": (trajectory.tau[:, knee] - motor - spring, 3),
    }
    return {name: np.round(values, digits).tolist() for name, (values, digits) in columns.items()}


def _opening(engine: Engine) -> dict[str, Any]:
    """Data that the page begins with: its knobs, the stage, the default hop to compare with."""
    hops = settled(Knobs(), engine)
    _, scene = _scene(hops)
    return {
        "knobs": {name: asdict(knob) for name, knob in KNOBS.items()},
        "views": list(VIEWS),
        "engine": {"name": engine.name, "extra": engine.extra},
        "readouts": READOUTS,
        "plots": PLOTS,
        "default": {"series": series(hops.trajectory), "figures": figures(hops)},
        "legend": [
            ["spring engaged", css(COIL_COLOR)],
            ["ground force", css(ARROW_COLOR)],
            ["toe path", css(TRAIL_COLOR)],
        ],
        "speeds": SPEEDS,
        "client": CLIENT,
        "aspect": scene.view.aspect,
        "distance": scene.view.distance,
        "horizon": css(HORIZON),
        "scene": [_packed(command) for command in scene.commands],
        "overlays": [command["path"] for command in scene.commands if _is_overlay(command)],
    }


def _scene(hops: Hops) -> tuple[Frames, Scene]:
    robot = hops.knobs.system.robot
    frames = resample(robot, hops.trajectory, RATE)
    return frames, moving(robot, frames)


def _changes(scene: Scene) -> list[c.Command]:
    """Commands that differ between hops; what is looked at from where, and what would need a shader again, stays."""
    world = [command for command in scene.commands if command["path"].startswith(WORLD)]
    return [command for command in world if command["type"] != "set_object" or _is_overlay(command)]


def _is_overlay(command: c.Command) -> bool:
    """Whether a command draws a spring, a force or a path, neither the robot nor the ground."""
    path = command["path"]
    drawn = command["type"] == "set_object" and path.startswith(WORLD)
    return drawn and "/shape " not in path and not path.startswith(f"{WORLD}/ground")


def _packed(command: c.Command) -> str:
    return base64.b64encode(c.pack(command)).decode()
