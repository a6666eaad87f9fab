"""Writes problems and their answers as JSON that needs nothing of this package to be understood.

`python -m benchmarks.references.writing [NAME ...]` runs both engines and writes these files of the package, or all.
"""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.references.answering import Happened, apart, by_other, by_reference
from benchmarks.references.plain_urdf import WORLD, plain_urdf
from benchmarks.references.problem import Problem, Torque
from benchmarks.references.table import problems
from spear_pin.cli.references import SHIPPED
from spear_pin.errors import BadValue
from spear_pin.files import write_text
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues, multipliers
from spear_pin.model.cable import Anchor, Between
from spear_pin.model.frames import frame_id
from spear_pin.model.path import Joints
from spear_pin.model.path import Path as SpringPath
from spear_pin.model.spring import Spring

FINE, COARSE = 1e-13, 1e-11  # relative tolerances: of the answer, and of the run that bounds its error
SAFETY = 2.0  # of a bound over the largest difference
FLOORS = {"time_s": 1e-12, "position": 1e-11, "velocity": 1e-10, "energy_J": 1e-9, "multiplier": 1e-7}
TORQUE = "polynomial_N_m", "stiffness_N_m_per_rad", "angle_rad", "damping_N_m_s_per_rad"


def write(problem: Problem, folder: Path) -> Path:
    """Runs a problem by both engines and writes its file, NAME.json.

    Raises:
        MissingExtra: heyoka is not installed.
        SpearError: the engines disagree about the events.
    """
    found = by_reference(problem, FINE)
    others = [by_reference(problem, COARSE), by_other(problem)]
    differences = [apart(found, other) for other in others]
    bounds = {name: max(each[name] for each in differences) for name in differences[0]}
    answer: dict[str, Any] = {"events": [_event(event) for event in found]}
    if problem.periodic:
        state = problem.start.q, problem.start.v
        exact = multipliers(problem.system, state)
        answer["multipliers_re_im"] = [[value.real, value.imag] for value in exact.tolist()]
        by_differences = eigenvalues(differentiate_return_map(problem.system, state, FINE))
        bounds["multiplier"] = float(np.abs(exact - by_differences).max())
    answer["bounds"] = {name: _rounded_up(SAFETY * bounds[name] + FLOORS[name]) for name in bounds}
    return write_text(folder / f"{problem.name}.json", _laid_out({**described(problem), "answer": answer}))


def described(problem: Problem) -> dict[str, Any]:
    """Returns a problem without its answer."""
    robot, ground = problem.robot, problem.ground
    loops = [{"name": loop.name, "links": list(loop.ends)} for loop in robot.loops]
    frames = [*robot.toes, *(end for loop in robot.loops for end in loop.ends)]
    said = {
        "name": problem.name,
        "words": problem.words,
        "gravity_m_s2": -float(robot.model.gravity.linear[2]),
        "ground": {
            "friction": ground.friction,
            "slope_rad": ground.slope,
        },
        "robot": {
            "coordinates": list(robot.coordinates),
            "feet": list(robot.toes),
            "armature_kg_m2": dict(zip(robot.coordinates, robot.model.armature.tolist(), strict=True)),
            "loops": loops,
            "urdf": plain_urdf(robot, frames),
        },
        "start": {
            "position": [float(number) for number in problem.q],
            "velocity": [float(number) for number in problem.v],
            "feet_on_ground": list(problem.stands),
        },
    }
    if problem.strikes:
        return {**said, "feet_that_strike": list(problem.strikes)}
    torques = {
        joint: {"foot": problem.foot_of(joint)}
        | {
            mode: _torque(table[joint])
            for mode, table in (("foot_in_air", problem.aloft), ("foot_on_ground", problem.standing))
            if joint in table
        }
        for joint in robot.actuated
        if joint in problem.aloft or joint in problem.standing
    }
    springs = [
        {"name": name, "foot": toe} | _spring(problem, spring, name)
        for toe, own in problem.springs.items()
        for name, spring in own.items()
    ]
    return {**said, "torques": torques, "springs": springs, "ends_at_touchdown_after_flight": problem.landings}


def _torque(torque: Torque) -> dict[str, Any]:
    values = [list(torque.polynomial), *torque[1:]]
    return {name: value for name, value in zip(TORQUE, values, strict=True) if value}


def _spring(problem: Problem, spring: Spring, name: str) -> dict[str, Any]:
    turns = "N_m", "rad"
    force, length = turns if spring.turns else ("N", "m")
    said: dict[str, Any] = {
        "length": _path(problem, Joints({name: 1.0}) if spring.path is None else spring.path),
        f"stiffness_{force}_per_{length}": spring.stiffness,
        f"damping_{force}_s_per_{length}": spring.damping,
        "pulls_only": spring.unilateral,
    }
    if spring.hardening:
        said[f"hardening_{force}_per_{length}3"] = spring.hardening
    if spring.rest is not None:
        said[f"always_rests_at_{length}"] = spring.rest
    if (clutch := spring.clutch) is not None:
        said |= {"engages_after_s": clutch.on_delay, "releases_after_s": clutch.off_delay}
        said |= {f"play_{length}": clutch.play, "damper_engages_at_touchdown": clutch.damper == "joint"}
    return said


def _path(problem: Problem, path: SpringPath) -> dict[str, Any]:
    if isinstance(path, Joints):
        return {"sum_of": {joint: path.side * weight for joint, weight in path.weights}}
    if isinstance(path, Between):
        return {"between": [_anchor(problem, end) for end in (path.start, path.end)]}
    raise BadValue("path", path, "joints or a cable between two points")


def _anchor(problem: Problem, anchor: Anchor) -> dict[str, Any]:
    model = problem.robot.model
    frame = model.frames[frame_id(model, anchor.body)]
    point = frame.placement.act(np.array(anchor.at, dtype=float))
    link = f"{model.names[frame.parentJoint]}_link" if frame.parentJoint else WORLD
    return {"link": link, "point_m": point.tolist()}


def _event(event: Happened) -> dict[str, Any]:
    return {
        "event": event.name,
        "foot": event.foot,
        "time_s": event.time,
        "position": event.q.tolist(),
        "velocity": event.v.tolist(),
        "energy_J": [event.kinetic, event.potential],
    }


def _rounded_up(number: float) -> float:
    """Returns a number rounded up to one digit."""
    power = 10.0 ** math.floor(math.log10(number))
    return float(f"{math.ceil(number / power) * power:.0e}")


def _laid_out(value: Any) -> str:
    """Returns JSON with lists of numbers in a line each."""
    text = json.dumps(value, indent=1, ensure_ascii=False)
    return re.sub(r"\[([-+\d.e,\s]+)\]", lambda found: f"[{' '.join(found[1].split())}]", text) + "\n"


if __name__ == "__main__":
    for each in sys.argv[1:] or problems():
        print(write(problems()[each], SHIPPED))
