"""The page on which a user changes a motion's numbers: its text, and the answers that it asks for.

The page is our own, based on the scene of the recorded page. The servers of viser or meshcat would add sockets and
processes, and sliders, plots and an address that holds the state would still be missing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from spear_pin.gaits.measures.catalogue import SHOWN, added
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.knobs import Subject
from spear_pin.studies.explore.motion import Motion
from spear_pin.studies.explore.tangents import MULTIPLIER, Tangents
from spear_pin.studies.explore.views import views_of
from spear_pin.viz.bench.samples import packed, samples_of, thinned
from spear_pin.viz.explore.series import plots, series
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.frames import Frames, resample
from spear_pin.viz.playback.overlays import ARROW_COLOR, TRAIL_COLOR
from spear_pin.viz.playback.scene import Scene, moving
from spear_pin.viz.playback.stage import HORIZON, WORLD
from spear_pin.viz.player import SPEEDS, encoded, in_words, springs_legend
from spear_pin.viz.template import css, environment

CLIENT = "Spear-Client"  # header by which a page tells itself from others; what comes without is one client
RATE = 60.0  # frames per second
READOUTS: Mapping[str, dict[str, tuple[str, str, int]]] = {  # label, unit and decimals of the figures
    "hop": {
        "apex_height": ("Apex of the hip", "m", 4),
        "flight_time": ("Flight", "s", 4),
        "stance_time": ("Stance", "s", 4),
        "peak_force": ("Peak ground force", "N", 1),
        "peak_torque_knee": ("Peak knee torque", "N·m", 2),
        "rotor_torque_knee": ("before the gear", "N·m", 3),
        "peak_power_knee": ("Peak knee power", "W", 1),
        "positive_work": ("Positive work a hop", "J", 2),
        "spring_share": ("Spring's share", "%", 1),
    },
    "bound": {
        "speed": ("Mean speed", "m/s", 3),
        "stride": ("Stride", "m", 3),
        "period": ("Period", "s", 4),
        "peak_force": ("Peak force, a pair", "N", 0),
        "friction_used": ("Friction used", "", 2),
        "peak_torque_stance_knee": ("Knee motor, in stance", "N·m", 1),
        "peak_torque_stance_hip": ("Hip motor, in stance", "N·m", 1),
        "peak_speed_knee": ("Peak knee speed", "rad/s", 1),
        "impact_loss": ("Lost in impacts", "J", 1),
        "cost_of_transport": ("Cost of transport", "", 3),
        "posterior_hip_torque": ("Post. hip, solved", "N·m", 2),
    },
    "gait": {
        "mean_speed": ("Mean speed", "m/s", 3),
        "stride": ("Distance a cycle", "m", 3),
        "period": ("Duration of a cycle", "s", 4),
        "peak_force": ("Peak force, a toe", "N", 1),
        "friction_used": ("Friction used", "", 2),
        "peak_torque": ("Peak torque, a motor", "N·m", 2),
        "rms_torque": ("RMS torque, a motor", "N·m", 2),
        "peak_speed": ("Peak speed, a joint", "rad/s", 1),
        "positive_work": ("Positive work a cycle", "J", 2),
        "cost_of_transport": ("Cost of transport", "", 3),
        "effort": ("Effort a cycle", "N²·m²·s", 2),
    },
}
EFFECTS: Mapping[str, tuple[str, ...]] = {  # figures whose derivatives are shown, the first at first
    "hop": (
        "apex_height",
        "flight_time",
        "stance_time",
        "peak_force",
        "peak_torque_knee",
        "rotor_torque_knee",
        "positive_work",
        MULTIPLIER,
    ),
    "bound": (
        "cost_of_transport",
        "stride",
        "period",
        "peak_force",
        "friction_used",
        "peak_torque_stance_knee",
        "peak_torque_stance_hip",
        "posterior_hip_torque",
        MULTIPLIER,
    ),
    "gait": (*SHOWN, MULTIPLIER),
}
SAID: Mapping[str, tuple[str, str]] = {  # beside the sliders, and how long a change takes without the extra
    "hop": ("Unless the flight time is kept, the torque stays where its slider is.", "a second or so"),
    "bound": ("The posterior hip torque is solved for the speed.", "five to ten seconds"),
    "gait": (
        "Other numbers stay as the gait has them. A cycle of a trot is half a stride; two are shown.",
        "seconds, and in space minutes",
    ),
}


def page(subject: Subject, engine: Engine) -> str:
    """Returns the text of the page."""
    return environment().get_template("explore/page.html").render(title=subject.title, data=_opening(subject, engine))


def answer(view: str, hops: Motion) -> dict[str, Any]:
    """Returns a motion for the page: playback, series to plot, samples, figures."""
    frames, scene = _scene(hops)
    return {
        "view": view,
        "knobs": hops.knobs.values,
        "kept": hops.knobs.kept,
        "verdict": hops.verdict,
        "message": hops.message,
        "kind": hops.kind,
        "figures": figures(hops),
        "multipliers": _multipliers(hops),
        "duration": frames.duration,
        "spans": [[in_words(span.name), span.begin, span.end] for span in frames.spans],
        "events": [[in_words(name), time] for name, time in frames.events],
        "series": series(hops),
        "samples": packed(thinned(samples_of(hops.knobs.system.robot, hops.trajectory))),
        "commands": [encoded(command) for command in _changes(scene)]
        + [encoded(c.set_animation(scene.clips, frames.duration))],
    }


def _multipliers(motion: Motion) -> list[list[float]]:
    """Returns real and imaginary parts; none for a motion that is not a gait."""
    return [] if motion.gait is None else [[each.real, each.imag] for each in motion.gait.multipliers.tolist()]


def slopes(found: Tangents) -> dict[str, Any]:
    """Returns derivatives for the page: null where there is none."""
    known = {
        knob: {name: value if math.isfinite(value) else None for name, value in row.items()}
        for knob, row in found.slopes.items()
    }
    return {**asdict(found), "slopes": known}


def _opening(subject: Subject, engine: Engine) -> dict[str, Any]:
    """Returns data for the page's start: its knobs, the stage, the default motion for comparison."""
    views = views_of(subject)
    hops = next(iter(views.values()))(subject.at(), engine)
    frames, scene = _scene(hops)
    known, own = figures(hops), added()
    effects = (*EFFECTS[subject.kind], *(each.kind for each in own))
    readouts = READOUTS[subject.kind] | {each.kind: (in_words(each.kind), each.unit, 3) for each in own}
    return {
        "kind": subject.kind,
        "title": subject.title,
        "keeps": subject.keeps,
        "solved": next((name for name in subject.held(True) if name in subject.knobs), ""),
        "multiplier": MULTIPLIER,
        "effects": [name for name in effects if known.get(name, 0.0) is not None] if engine.extra else [],
        "knobs": {name: asdict(knob) for name, knob in subject.knobs.items()},
        "views": list(views),
        "engine": {"name": engine.name, "extra": engine.extra},
        "readouts": {name: said for name, said in readouts.items() if known[name] is not None},
        "plots": plots(hops),
        "said": SAID[subject.kind],
        "default": {"series": series(hops), "figures": known, "knobs": hops.knobs.values}
        | {"multipliers": _multipliers(hops), "view": next(iter(views)), "verdict": hops.verdict, "kind": hops.kind},
        "legend": [
            *springs_legend(frames),
            ["ground force", css(ARROW_COLOR)],
            ["toe path", css(TRAIL_COLOR)],
        ],
        "speeds": SPEEDS,
        "rate": RATE,
        "client": CLIENT,
        "world": WORLD,
        "follows": scene.follows,
        "turns": scene.turns,
        "aspect": scene.view.aspect,
        "distance": scene.view.distance,
        "horizon": css(HORIZON),
        "scene": [encoded(command) for command in scene.commands],
        "overlays": [command["path"] for command in scene.commands if _is_overlay(command)],
    }


def _scene(hops: Motion) -> tuple[Frames, Scene]:
    robot = hops.knobs.system.robot
    frames = resample(robot, hops.trajectory, RATE)
    return frames, moving(robot, frames)


def _changes(scene: Scene) -> list[c.Command]:
    """Returns commands that differ between hops, without camera, and without changes that need a new shader."""
    world = [command for command in scene.commands if command["path"].startswith(WORLD)]
    return [command for command in world if command["type"] != "set_object" or _is_overlay(command)]


def _is_overlay(command: c.Command) -> bool:
    """Tells whether a command draws a spring, a force or a path, neither the robot nor the ground."""
    path = command["path"]
    drawn = command["type"] == "set_object" and path.startswith(WORLD)
    return drawn and "/shape " not in path and not path.startswith(f"{WORLD}/ground")
