"""Gaits whose numbers a user changes: any one, of systems of one's own as well, or a bound with a mean speed."""

from __future__ import annotations

from collections.abc import Sequence

from spear_pin.errors import BadValue, require
from spear_pin.gaits.bounding import SPEED_BY
from spear_pin.gaits.feedback import without_feedback
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.parameters import nonzero, number, numbers_of_law, unit
from spear_pin.kinds import typed
from spear_pin.model.springs import numbers_of_springs
from spear_pin.model.variants import PARAMETERS
from spear_pin.studies.bound import mean_speed
from spear_pin.studies.explore.carried import Carried, Kept
from spear_pin.studies.explore.knobs import Knob, about

SPEED = "speed"
FARTHER = 1.0  # m/s from the gait's own speed, either way
SLOWEST = 0.1  # of its own speed
LEAN = 0.1  # rad from the gait's own angles at touchdown


@typed
def gait_to_explore(gait: Gait, title: str, over: Sequence[str] = (), source: str = "gait.json") -> Carried:
    """Returns a gait whose numbers a user can change, from a half to one and a half times what they are.

    Args:
        gait: a gait; its event feedback is left out.
        title: title of the page.
        over: numbers to change, by the names that `Gait.sensitivity` takes; by default those of springs with their
            switches and paths, ground and law.
        source: name or path of the gait, from which a saved program loads it.

    Raises:
        UnknownName: nothing has a number of a name.
        BadValue: a number is zero, which has no range about it.
    """
    system = (gait := without_feedback(gait)).system
    names = over or nonzero(
        system, dict.fromkeys((*numbers_of_springs(system.springs), "friction", *numbers_of_law(system)))
    )
    return Carried("gait", gait, {name: _knob(gait, name) for name in names}, title, source=source)


def _knob(gait: Gait, name: str) -> Knob:
    value = number(gait.system, name)
    require(name, value, bool, "a number other than zero, which has a range about it")
    return about(name.replace("_", " ").capitalize(), unit(gait.system, name), value, "of the gait", 0.5, 1.5)


@typed
def bound_to_explore(gait: Gait, title: str, source: str = "gait.json") -> Carried:
    """Returns a bound whose numbers a user can change, at a mean speed for which the posterior hip torque is solved.

    Args:
        gait: a bounding gait; its event feedback is left out.
        title: title of the page.
        source: name or path of the gait, from which a saved program loads it.

    Raises:
        BadValue: the gait is no bound in the plane.
    """
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, 'a bound in the plane, such as Gait.load("long_stride")')
    gait = without_feedback(gait)
    law, spring, robot = gait.system.law, gait.system.spring, gait.system.robot
    speed = round(mean_speed(gait), 4)
    slowest = max(SLOWEST * speed, speed - FARTHER)
    hip, hind, fore = law.anterior_hip_torque, law.posterior_leg_touchdown, law.anterior_leg_touchdown
    mostly = max(20.0, abs(hip))
    knobs = {
        SPEED: Knob("Mean speed", "m/s", speed, round(slowest, 2), round(speed + FARTHER, 2), 3, "own", "the gait's"),
        "virtual_stiffness": about("Knee stiffness", "N·m/rad", law.virtual_stiffness, "spring and motors of a pair"),
        "stiffness": about("the spring's part", "N·m/rad", spring.stiffness, "the motors do the rest", 0.0, 3.5),
        "anterior_hip_torque": _beside("Anterior hip torque", "N·m", hip, mostly, 3, 1, "of the pair, in stance"),
        "posterior_leg_touchdown": _beside("Posterior leg at touchdown", "rad", hind, LEAN, 4, 3, "ahead of the hip"),
        "anterior_leg_touchdown": _beside("Anterior leg at touchdown", "rad", fore, LEAN, 4, 3, "ahead of the hip"),
        "friction": Knob(
            "Friction coefficient", "1", gait.system.contact.friction, 0.1, 1.5, 2, "assumption", "of the ground"
        ),
    }
    if robot.cut is None:  # the file of another robot seldom tells its gears
        for name, low, high in (("knee_ratio", 5, 25), ("hip_ratio", 20, 100)):
            usual = robot.varied.get(name, PARAMETERS[name].default)
            label = f"{name.partition('_')[0].capitalize()} gear ratio"
            knobs[name] = Knob(label, "1", usual, low, high, 1, "source", "Tables 2.4 and 5.1")
    return Carried("bound", gait, knobs, title, {SPEED: Kept("mean_speed", SPEED_BY)}, source)


def _beside(label: str, unit: str, value: float, farthest: float, digits: int, coarse: int, note: str) -> Knob:
    """Returns a knob for a number of the gait within a distance of it, the ends of its range with fewer decimals."""
    low, high = round(value - farthest, coarse), round(value + farthest, coarse)
    return Knob(label, unit, value, low, high, digits, "own", note)
