"""Checks the legs, springs, motors and gears of a TOML file against the robot."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pinocchio as pin

from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.model.catalogue import motor
from spear_pin.model.clutch import CHOICES, OF_CLUTCHES, Clutch
from spear_pin.model.fitting import drivable, hold
from spear_pin.model.frames import joint_id
from spear_pin.model.gears import Gear
from spear_pin.model.legs import Leg, find_legs, find_named_leg
from spear_pin.model.loop_data import loop_of
from spear_pin.model.loops import Loop
from spear_pin.model.motor import Gearbox
from spear_pin.model.named_legs import NamedLeg, leg_of
from spear_pin.model.path_data import keys_of, path_of
from spear_pin.model.reach import Reach
from spear_pin.model.robot import Robot
from spear_pin.model.settings import NONE_GIVEN, Settings
from spear_pin.model.sidecar import JOINTS, ROLES, Sidecar, blame_file
from spear_pin.model.spring import Spring
from spear_pin.model.tree import Tree

SAME = 1e-6  # relative difference up to which two numbers agree


def check_equipment(
    said: Sidecar, model: pin.Model, known: Mapping[str, Gear], name: str, toes: Sequence[str]
) -> tuple[Settings, Any, Mapping[str, Gear]]:
    """Checks the contents of a TOML file against the robot.

    Args:
        said: contents of the TOML file, and the loops of the robot's own file.
        model: model of the robot as its file describes it.
        known: ratios and rotors in the robot's file, by joint.
        name: name of the robot.
        toes: toes of the robot, whatever the arguments are.

    Returns:
        the settings, empty without a file or loops; the joints with motors: names, "all", or None if the file has none;
        and ratios and rotors from both files.

    Raises:
        BadFile: there is no such joint, frame or leg, or the model contradicts the file.
    """
    if said.path is None and not said.loops:
        return NONE_GIVEN, None, known
    path = said.path or Path(str(said.source))
    loops = _loops(said, path, model)
    with blame_file(path, "locked"):
        held = hold(model, said.locked or ())
    with blame_file(path, "toes"):
        own = Robot(held, name=name, toes=toes, actuated=(), source=str(said.source))
    given, legs = _legs(said, path, own)
    pairs = tuple(tuple(pair) for pair in said.pairs)
    with blame_file(path, "pairs"):
        if pairs and len({find_named_leg(held, legs, leg).hip for pair in pairs for leg in pair}) != 4:
            raise BadValue("pairs", said.pairs, "four different legs")
    gears = _gears(said, path, model, legs)
    drives = {joint: _geared(path, known.get(joint, Gear()), joint, *table) for joint, table in gears.items()}
    settings = Settings(
        str(path),
        sides={leg.name: leg.side for leg in legs},
        legs=given,
        pairs=pairs,
        springs=_springs(said, path, legs),
        motors={joint: motor(table["motor"]) for joint, (_, table) in gears.items() if "motor" in table},
        efficiencies={joint: efficiency for joint, (_, efficiency) in drives.items()},
        gears={joint: gear for joint, (_, table) in gears.items() if (gear := _own(table)) != Gear()},
        post=_post(said, path, model),
        loops=loops,
        independent=tuple(said.independent),
        reach=_reach(said, path, model),
        radii=_radii(said, path, own),
        arcs=_arcs(said, path, own),
    )
    driven = tuple(gears) if isinstance(said.motors, Mapping) else said.motors
    return settings, driven, {**known, **{joint: geared for joint, (geared, _) in drives.items()}}


def _loops(said: Sidecar, path: Path, model: pin.Model) -> tuple[Loop, ...]:
    """Returns the loops, whose ends become frames of the model."""
    found = []
    for name, table in said.loops.items():
        with blame_file(path, f"loops.{name}"):
            found.append(loop_of(name, table, model))
    if found and said.legs:
        raise BadFile(
            path, f"legs has {', '.join(said.legs)}; expected [reach] with loops: a leg is a chain of hip and knee"
        )
    if said.independent and not found:
        raise BadFile(path, f"independent is {list(said.independent)!r}; expected loops too, which it is about")
    return tuple(found)


def _reach(said: Sidecar, path: Path, model: pin.Model) -> Reach | None:
    """Returns the angles of hip and knee of a leg with loops, if the file gives them."""
    if not said.reach:
        return None
    with blame_file(path, "reach"):
        tables = keys_of("reach", said.reach, ("knee",), ("hip",))
        for joint, weight in (pair for table in tables.values() for pair in table.items()):
            if joint not in drivable(model):
                raise UnknownName("joint", joint, drivable(model))
            if type(weight) not in (int, float) or not weight or not math.isfinite(weight):
                raise BadValue(joint, weight, "a weight, a finite number other than 0")
        return Reach(
            **{name: tuple((joint, float(weight)) for joint, weight in table.items()) for name, table in tables.items()}
        )


def _radii(said: Sidecar, path: Path, robot: Robot) -> dict[str, float]:
    """Returns the radii of round feet."""
    found = {}
    for toe, table in said.feet.items():
        with blame_file(path, f"feet.{toe}"):
            robot.toe_id(toe)
            if not table.get("radius", 0.0) > 0.0:
                raise BadValue("radius", table.get("radius"), "a number > 0, in m")
            if not robot.planar:
                raise BadValue(
                    "radius",
                    table["radius"],
                    "feet without radius for a robot in space, whose toes are points: leave it out",
                )
        found[toe] = float(table["radius"])
    return found


def _arcs(said: Sidecar, path: Path, robot: Robot) -> dict[str, tuple[float, float]]:
    """Returns the pitches between which round feet roll whose arcs have ends."""
    found = {}
    for toe, table in said.feet.items():
        ends = [float(table[key]) for key in ("from", "to") if key in table]
        with blame_file(path, f"feet.{toe}"):
            if ends and not (len(ends) == 2 and -math.pi < ends[0] < ends[1] < math.pi):
                expected = "two pitches of the foot between -π and π, in rad, the lesser first"
                raise BadValue("from and to", ends, expected)
            if ends and robot.nq != robot.nv:
                raise BadValue("from and to", ends, "none for a robot with a joint that has a cosine and a sine")
        if ends:
            found[toe] = ends[0], ends[1]
    return found


def _own(table: Mapping[str, Any]) -> Gear:
    """Returns the gear that a table itself describes."""
    return Gear(table.get("ratio"), table.get("rotor_inertia"))


def _post(said: Sidecar, path: Path, model: pin.Model) -> tuple[float, float] | None:
    """Returns the position of the joint that the file puts on a post."""
    if said.post is None:
        return None
    with blame_file(path, "post"):
        tree, joint = Tree(model), joint_id(model, said.post)
        if tree.chain(joint) != [joint] or not tree.yaws(joint):
            raise BadValue("joint", said.post, "a joint on the world, which turns about a vertical axis")
    x, y, _ = model.jointPlacements[joint].translation.tolist()
    return x, y


def _legs(said: Sidecar, path: Path, robot: Robot) -> tuple[tuple[NamedLeg, ...], tuple[Leg, ...]]:
    """Returns the legs that are given joint by joint, if any, and all legs."""
    explicit = {name: table for name, table in said.legs.items() if set(table) - {"side"}}
    for name, table in said.legs.items():
        missing = [key for key in JOINTS if key not in table] if explicit else []
        if missing:
            raise BadFile(path, f"legs.{name} has no {missing[0]}; expected {', '.join(JOINTS)} of each leg or of none")
        if not table:
            raise BadFile(path, f"legs.{name} is empty; expected side, or {', '.join(JOINTS)}")
    given, legs = [], []
    for name, table in explicit.items():
        with blame_file(path, f"legs.{name}"):
            if table["toe"] not in robot.toes:
                raise UnknownName("toe", table["toe"], robot.toes)
            given.append(NamedLeg(name, **table))
            legs.append(leg_of(robot.model, given[-1]))
    if len({leg.hip for leg in legs}) < len(legs):
        raise BadFile(
            path, f"legs has the hips {', '.join(leg.hip for leg in legs)}; expected another hip for each leg"
        )
    if not explicit and not said.loops:
        with blame_file(path, "legs"):
            legs = list(find_legs(robot, sides={name: table["side"] for name, table in said.legs.items()}))
    for leg in legs:
        _check_side(path, robot, leg, said.legs.get(leg.name, {}).get("side"))
    return tuple(given), tuple(legs)


def _check_side(path: Path, robot: Robot, leg: Leg, side: int | None) -> None:
    """Refuses a side to which the limits let no knee flex."""
    limits = robot.limits.get(leg.knee)
    if side is None or limits is None:
        return
    low, high = limits.position
    if side * ((high if side > 0 else low) - leg.knee_zero) <= 0.0:
        turns = f"{leg.knee!r} turns from {low:g} to {high:g} rad, straight at {leg.knee_zero:g}"
        raise BadFile(path, f"legs.{leg.name}.side is {side}; expected {-side}: {turns}")


def _springs(said: Sidecar, path: Path, legs: Sequence[Leg]) -> dict[str, Spring]:
    """Returns the springs by the joints of knees, those on a path by name; one of one joint overrides that of all."""
    knees = [leg.knee for leg in legs]
    springs: dict[str, Spring] = {}
    for name in sorted(said.springs, key=lambda name: name != "knee"):
        with blame_file(path, f"springs.{name}"):
            along, others = path_of(said.springs[name])
        if along is not None and name in ("knee", *knees):
            raise BadFile(path, f"springs.{name} has a path; expected a name of its own for a spring on a path")
        if name != "knee" and name not in knees and along is None:
            also = "or a path in its table"
            raise BadFile(path, f"springs: {UnknownName('knee', name, ['knee', *knees], also)}")
        table = {"stiffness": 0.0, "damping": 0.0, **others}
        if not table["stiffness"] and not table.get("table") and not table["damping"]:
            unit = "N·m/rad" if along is None else "N/m"
            expected = f"a number > 0, in {unit}, or a table, or a damping alone"
            raise BadFile(path, f"springs.{name} has no stiffness; expected {expected}")
        with blame_file(path, f"springs.{name}"):
            clutch = table.pop("clutch", None)
            if clutch is not None:
                clutch = Clutch(**keys_of("clutch", clutch, (), (*OF_CLUTCHES, *CHOICES)))
            spring = Spring(**table, path=along, clutch=clutch)
            springs |= dict.fromkeys(knees if name == "knee" and along is None else [name], spring)
    return springs


def _gears(
    said: Sidecar, path: Path, model: pin.Model, legs: Sequence[Leg]
) -> dict[str, tuple[str, Mapping[str, Any]]]:
    """Returns name and table of each joint with a motor; a joint's table overrides a role's, which overrides all's."""
    tables = said.motors if isinstance(said.motors, Mapping) else {}
    joints = drivable(model)
    roles = {role: [joint for leg in legs if (joint := getattr(leg, role))] for role in ROLES} | {"all": joints}
    for name in said.motors if isinstance(said.motors, list) else [name for name in tables if name not in roles]:
        if name not in joints:
            raise BadFile(path, f"motors: {UnknownName('joint', name, [*(roles if tables else ()), *joints])}")
    found: dict[str, tuple[str, Mapping[str, Any]]] = {}
    for name in sorted(tables, key=lambda name: (name != "all", name not in roles)):
        own = roles.get(name, [name])
        if not own:
            raise BadFile(
                path, f"motors.{name}: no known leg has a joint in this role; give legs or toes, or name the joint"
            )
        found |= dict.fromkeys(own, (name, tables[name]))
    return found


def _geared(path: Path, known: Gear, joint: str, key: str, table: Mapping[str, Any]) -> tuple[Gear, float]:
    """Returns a joint's gear from a table, and its efficiency; the robot's file must not contradict it."""
    where, own = f"motors.{key}", _own(table)
    if own.ratio is None and known.ratio is None and {"motor", "rotor_inertia"} & set(table):
        raise BadFile(
            path, f"{where} has no ratio, nor has the robot's file for {joint!r}; give one, such as ratio = 9"
        )
    given = known.ratio if own.ratio is None else own.ratio
    with blame_file(path, where):
        gearbox = Gearbox(1.0 if given is None else given, table.get("efficiency", 1.0))
    if known.ratio is not None and not math.isclose(known.ratio, gearbox.ratio, rel_tol=SAME):
        has = f"{known.ratio:.12g}, which the robot's file has for {joint!r}"
        raise BadFile(path, f"{where}.ratio is {gearbox.ratio!r}; expected {has}")
    rotor = motor(table["motor"]).rotor_inertia if own.rotor is None and "motor" in table else own.rotor
    reflected = replace(known, ratio=gearbox.ratio).reflected
    if rotor is None and "motor" in table and reflected is None:
        raise BadFile(
            path, f"{where} has no rotor_inertia, and that of {table['motor']} is unknown; give one, in kg·m²"
        )
    if rotor is not None and rotor < 0:
        raise BadFile(path, f"{where}.rotor_inertia is {rotor!r}; expected a number >= 0, in kg·m²")
    if (
        rotor is not None
        and reflected is not None
        and not math.isclose(reflected, gearbox.ratio**2 * rotor, rel_tol=SAME)
    ):
        of = f"{reflected / gearbox.ratio**2:.6g} kg·m², which the robot's file has for {joint!r}"
        raise BadFile(path, f"{where}: the rotor's inertia is {rotor!r}; expected {of}")
    return Gear(given, known.rotor if rotor is None else rotor, known.armature), gearbox.efficiency
