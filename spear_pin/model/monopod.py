"""One leg of a robot as a monopod on a slider, with the coordinates and the signs of `load("spear_ii")`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.cut import AHEAD, UP, Amount, Assembly, Cut, Limb, Source, Turn, products
from spear_pin.model.fitting import hold
from spear_pin.model.legs import Leg, check_side, find_named_leg, lacking_legs, simple
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import refuse_ends
from spear_pin.model.settings import Settings

SHARE = "share"


@typed
def monopod(robot: Robot, leg: str | Leg, body: str | float = SHARE, locked: Iterable[str] = ()) -> Robot:
    """Returns a leg of a robot on a sliding boom, as in SPEAR-II.

    Its coordinates are "boom_x", "boom_z", "hip" and "knee", its toe is "toe". The hip is positive with the knee
    forward, the knee positive in flexion and zero with the leg straight. If the robot's knee points to the rear, x does
    as well. Inertias are projected onto the plane, and the abduction is held at zero; motors, friction and limits are
    the leg's. `Robot.cut`, which can be printed, lists the amounts that this leaves out.

    Args:
        robot: any robot with legs, with its x axis forward and z up with every joint at zero.
        leg: name of one of `robot.legs`, or a leg from `find_legs`.
        body: mass on the slider, in kg; "share" means a leg's share of all that is neither thigh nor shank.
        locked: joints of the monopod to hold at zero, for instance `["boom_x"]`.

    Raises:
        UnknownName: there is no such leg, or no such joint to lock; the text lists the valid ones.
        BadValue: the leg has other joints, such as an ankle, or it is not known to which side its knee flexes; the mass
            is none, or the arc of a round foot has ends.

    Example:
        >>> from spear_pin import load, monopod
        >>> leg = monopod(load("q_spear_full"), "posterior_left")
        >>> leg.coordinates
        ('boom_x', 'boom_z', 'hip', 'knee')
    """
    locked = tuple(locked)
    refuse_ends(robot, "a leg that is cut out")
    if isinstance(leg, str) and not robot.legs:
        raise BadValue("robot", robot, lacking_legs(robot))
    of = check_side(simple(find_named_leg(robot.model, robot.legs, leg)))
    source = Source(robot)
    mass, mirrored = _body(source, of, body), of.bends < 0
    limb = source.limb(of, mirrored)
    angles = {"hip": (limb.turns[0],), "knee": (limb.turns[1],)}
    built = _assembled(f"{robot.name}_{of.name}", robot, mass, limb)
    built.carry(robot, angles)
    return Robot(
        hold(built.model, locked),
        name=built.model.name,
        toes=("toe",),
        actuated=[name for name, (turn,) in angles.items() if turn.joint in robot.actuated and name not in locked],
        locked=locked,
        source=f"monopod({robot.source!r}, {of.name!r})",
        settings=_settings(robot.settings, angles, of),
        cut=Cut(
            kind="monopod",
            of=robot.name,
            source=robot.source,
            body=mass,
            angles=angles,
            held=(*source.above(of), *(name for name in robot.locked if not built.model.existJointName(name))),
            robot=robot,
            legs=((of,),),
            sides={"leg": 1},
            mirrored=mirrored,
            neglected=_neglected(of, limb),
        ),
    )


def _settings(own: Settings, angles: Mapping[str, Sequence[Turn]], leg: Leg) -> Settings:
    """Returns what a robot's settings say of a leg."""
    return replace(own.of_cut(angles), radii={"toe": own.radii[leg.toe]} if leg.toe in own.radii else {})


def _body(source: Source, leg: Leg, body: str | float) -> float:
    """Returns the mass on the slider, in kg."""
    if body == SHARE:
        legs = [each for each in source.robot.legs if each.hip != leg.hip]
        return float(source.lump(source.rest([leg, *legs])).mass) / (len(legs) + 1)
    require("body", body, lambda mass: mass >= 0, f"{SHARE!r}, or a finite number >= 0, in kg")
    return float(body)


def _assembled(name: str, robot: Robot, mass: float, limb: Limb) -> Assembly:
    built = Assembly(name, robot.model.gravity)
    carriage = built.add("boom_x", AHEAD, 0, "carriage")
    boom = built.add("boom_z", UP, carriage, "boom", pin.Inertia(mass, np.zeros(3), np.zeros((3, 3))))
    built.add_leg("", boom, limb)
    return built


def _neglected(leg: Leg, limb: Limb) -> tuple[Amount, ...]:
    """Returns the amounts out of the plane of the hip."""
    bodies = (limb.thigh, limb.shank)
    aside = max(abs(float(body.lever[1] - limb.hip[1])) for body in bodies)
    return (
        Amount("toe out of the hip's plane by", abs(leg.across), "m"),
        Amount("centres of mass by", aside, "m"),
        products(bodies),
    )
