"""A robot as an MJCF file, MuJoCo's own format.

MuJoCo reads a URDF itself, and could save it again, but not the same robot: it ignores `<transmission>`, and with it
rotors, gears and motors; it refuses the massless carriages, merges the toes into their shanks and drops the shapes. So
the file is written here, from the model as loaded, varied and locked. MuJoCo need not be installed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.kinds import typed
from spear_pin.model.chain import CHAIN
from spear_pin.model.document import document
from spear_pin.model.inertial import fault_of
from spear_pin.model.mjcf_adding import UNTOUCHED, add, numbers, place
from spear_pin.model.mjcf_loops import add_loops, list_left_out_loops
from spear_pin.model.mjcf_springs import add_springs, springs_of
from spear_pin.model.postures import check_configuration, home
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import refuse_ends
from spear_pin.model.spring import Spring
from spear_pin.printable import printable

FRICTION = 0.8  # of toes and ground, the package's assumption
LEAST = 1e-14  # kg and kg·m² that a link without inertia is given: MuJoCo wants more than 1e-15
CONTACT_RADIUS = 1e-3  # m, of the sphere that stands for a toe, unless its foot is round
SLIDING = (FRICTION, 0.005, 0.0001)  # the other two are MuJoCo's own, of turning and rolling; points do neither
ON_GROUND = {"contype": "0", "conaffinity": "1", "group": "3"}
FREE = 6  # velocities of a floating joint
NOTE = """
  Written by spear_pin. Units are SI and radians.
  Joints have the names and signs of the URDF. armature is the inertia N^2 J of a rotor behind its gears.
  ctrl is the torque of a rotor, in N m; gear is N; the joint's torque is N ctrl, its limit the URDF's effort.
  A free joint: qpos has the scalar of the quaternion first, and the linear velocity is in world axes.
  A switchable spring of a knee is not in this file: no spring of MJCF can latch its rest angle at touchdown.
  Apply its torque from outside, for instance through qfrc_applied. Springs that never release are tendons.
  Contact with the ground is MuJoCo's, compliant, with a friction of {friction} (an assumption); spear_pin's is rigid.
"""


@dataclass(frozen=True)
class MeshFile:
    """A mesh that an MJCF file shows.

    Attributes:
        joint: index of the joint that moves it, in whose frame its corners are.
        file: its path, from the folder of the MJCF file.
        color: red, green, blue and alpha, each in 0..1.
    """

    joint: int
    file: str
    color: tuple[float, ...]


@typed
def to_mjcf(
    robot: Robot,
    postures: Mapping[str, ArrayLike] | None = None,
    meshes: Sequence[MeshFile] | None = None,
    springs: Mapping[str, Spring] | None = None,
) -> str:
    """Writes a robot as the text of an MJCF file, which has the robot's mass matrix and bias in MuJoCo.

    It has a body for each joint, a site for each toe, a motor for each transmission, the closed loops, the boxes,
    cylinders and spheres that the URDF shows, the ground, and the postures as keyframes. The toes and the trunk meet
    the ground: the trunk by the boxes, cylinders and spheres of its `<collision>`, where it has none by what it shows,
    of meshes their hulls.

    Args:
        robot: the robot, as loaded, varied or with joints locked.
        postures: configurations, (nq,) each, by name, in addition to "home" (see `postures.home`).
        meshes: files of the meshes that the URDF shows; None to leave them out.
        springs: springs by name, each with its path on the robot; None for those of its file. A spring that never
            releases and has a linear law is a tendon; comments say which are left out, see `mjcf_springs.left_out`.

    Raises:
        BadValue: the robot has a joint that neither turns nor slides about one axis nor floats from the origin, an
            inertia that MuJoCo refuses, inertia beside its model's (`on_rotary_boom`), or a round foot whose arc has
            ends; or a posture has not nq numbers.
        BadFile: its URDF is gone.
    """
    if robot.added is not None:
        raise BadValue("robot", robot, "one without a rotary boom: MJCF cannot express the inertia of its arm")
    refuse_ends(robot, "a sphere of MuJoCo")
    root = etree.Element("mujoco", model=printable(robot.name))
    root.append(etree.Comment(NOTE.format(friction=FRICTION)))
    bounds = {"boundmass": LEAST, "boundinertia": LEAST}
    add(root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false", **bounds)
    add(root, "option", gravity=robot.model.gravity.linear, timestep=0.001, integrator="implicitfast", cone="elliptic")
    assets = add(root, "asset")
    light, dark, side = (0.80, 0.84, 0.88), (0.72, 0.77, 0.82), "256"
    add(assets, "texture", type="skybox", builtin="gradient", width=side, height=side, rgb1=light, rgb2=dark)
    add(assets, "texture", name="ground", type="2d", builtin="checker", width=side, height=side, rgb1=light, rgb2=dark)
    add(assets, "material", name="ground", texture="ground", texrepeat=(1, 1), texuniform="true")
    world = add(root, "worldbody")
    add(world, "light", directional="true", castshadow="false", pos=(0, 0, 4), dir=(0.3, 0.4, -1))
    add(world, "geom", name="ground", type="plane", size=(0, 0, 1), material="ground", friction=SLIDING)
    elements = _add_bodies(robot.model, world)
    _add_shapes(robot, elements, assets, meshes)
    _add_toes(robot, elements)
    _add_motors(robot, root)
    add_springs(robot, springs_of(robot) if springs is None else springs, root, elements)
    for line in list_left_out_loops(robot):
        world.addprevious(etree.Comment(f" {line.replace('-', '_')} "))
    add_loops(robot, root, elements)
    keys = add(root, "keyframe")
    for name, q in {"home": home(robot), **(postures or {})}.items():
        add(keys, "key", name=name, qpos=qpos(robot, check_configuration(robot, name, q)))
    return str(etree.tostring(root, encoding="unicode", pretty_print=True))


def qpos(robot: Robot, q: Array) -> Array:
    """Converts a configuration, (nq,), to MuJoCo's qpos of the exported file, with scalars of quaternions first."""
    parts = []
    for joint in list(robot.model.joints)[1:]:
        part = q[joint.idx_q : joint.idx_q + joint.nq]
        if joint.nv == FREE:
            part = part[[0, 1, 2, 6, 3, 4, 5]]
        parts.append([np.arctan2(part[1], part[0])] if joint.nq == 2 else part)
    return np.concatenate(parts)


def qvel(robot: Robot, q: Array, v: Array) -> Array:
    """Converts a velocity, (nv,), to MuJoCo's qvel of the exported file, for a floating link in world axes."""
    values = np.array(v, dtype=np.float64)
    for joint in list(robot.model.joints)[1:]:
        if joint.nv == FREE:
            pose = pin.XYZQUATToSE3(q[joint.idx_q : joint.idx_q + joint.nq])
            values[joint.idx_v : joint.idx_v + 3] = pose.rotation @ values[joint.idx_v : joint.idx_v + 3]
    return values


def _add_bodies(model: pin.Model, world: Any) -> list[Any]:
    """Adds a body for each joint, depth first as MuJoCo counts; returns their elements, the world's first."""
    elements = [world]
    for joint in range(1, model.njoints):
        parent, placement, kind = elements[model.parents[joint]], model.jointPlacements[joint], model.joints[joint]
        body = add(parent, "body", name=_link(model, joint), **place(placement))
        _add_inertial(model, joint, body)
        if kind.nv == FREE and parent is world and placement.isIdentity():
            add(body, "freejoint", name=model.names[joint])
        elif kind.nv == 1:
            _add_joint(model, joint, body)
        else:
            expected = "joints that turn or slide about one axis, or a floating joint at the world's origin"
            raise BadValue(f"joint {model.names[joint]!r}", kind.shortname(), expected)
        elements.append(body)
    return elements


def _link(model: pin.Model, joint: int) -> str:
    """Returns the name of the link that a joint moves; the joint's own if there is none, as along a chain."""
    links = (frame.name for frame in model.frames if frame.parentJoint == joint and frame.type == pin.FrameType.BODY)
    return str(next(links, model.names[joint]))


def _add_inertial(model: pin.Model, joint: int, body: Any) -> None:
    inertia = model.inertias[joint]
    matrix = np.array(inertia.inertia) if np.any(inertia.inertia) else LEAST * np.eye(3)
    if fault_of(matrix) is not None:
        name, found = f"inertia of link {_link(model, joint)!r}", tuple(map(float, np.linalg.eigvalsh(matrix)))
        raise BadValue(name, found, "principal moments of which none exceeds the sum of the others, for MuJoCo")
    moments = [matrix[row, column] for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    add(body, "inertial", pos=inertia.lever, mass=max(inertia.mass, LEAST), fullinertia=moments)


def _add_joint(model: pin.Model, joint: int, body: Any) -> None:
    kind, row = model.joints[joint], model.joints[joint].idx_v
    data = kind.createData()
    kind.calc(data, pin.neutral(model))
    motion = np.ravel(data.S)
    name, axis = ("slide", motion[:3]) if motion[:3].any() else ("hinge", motion[3:])
    element = add(body, "joint", name=model.names[joint], type=name, axis=axis)
    low, high = model.lowerPositionLimit[kind.idx_q], model.upperPositionLimit[kind.idx_q]
    if kind.nq == 1 and -np.inf < low < high < np.inf:
        element.set("range", numbers((low, high)))
    parts = {"armature": model.armature, "damping": model.damping, "frictionloss": model.upperDryFrictionLimit}
    for name, values in parts.items():
        if values[row]:
            element.set(name, numbers(values[row]))


def _add_shapes(robot: Robot, elements: list[Any], assets: Any, meshes: Sequence[MeshFile] | None) -> None:
    """Adds the shapes of the URDF, and the trunk's collision shapes; Pinocchio reads primitives."""
    if robot.cut is not None:
        elements[0].addprevious(
            etree.Comment(f" shapes are left out: it is cut out of {robot.cut.of.replace('-', '_')} ")
        )
        return
    urdf = document(robot)
    for tag in ("visual", "collision"):
        for each in list(urdf.iter(tag)):
            if each.find("geometry/mesh") is not None:
                if tag == "visual" and meshes is None:
                    name = each.getparent().get("name").replace("-", "_")  # XML allows no "--" in a comment
                    elements[0].addprevious(etree.Comment(f" a mesh of link {name} is left out "))
                each.getparent().remove(each)
    try:
        text = str(etree.tostring(urdf, encoding="unicode"))
        shown, solid = (
            list(pin.buildGeomFromUrdfString(robot.model, text, kind).geometryObjects)
            for kind in (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION)
        )
    except (ValueError, RuntimeError):
        elements[0].addprevious(etree.Comment(" the shapes are left out: some are not valid "))
        shown, solid = [], []
    for shape in shown:
        _add_geom(shape, elements, **UNTOUCHED, rgba=" ".join(f"{part:.4g}" for part in shape.meshColor))
    for i, mesh in enumerate(meshes or ()):
        add(assets, "mesh", name=f"mesh_{i}", file=mesh.file, inertia="shell")
        color = " ".join(f"{part:.4g}" for part in mesh.color)
        add(elements[mesh.joint], "geom", type="mesh", mesh=f"mesh_{i}", rgba=color, **UNTOUCHED)
    trunk = trunk_of(robot)
    firm = [shape for shape in solid if shape.parentJoint in trunk]
    hulls = [] if firm else [i for i, mesh in enumerate(meshes or ()) if mesh.joint in trunk]
    for shape in firm or [shape for shape in shown if shape.parentJoint in trunk]:
        _add_geom(shape, elements, **ON_GROUND, friction=numbers(SLIDING))
    for i in hulls:
        joint = (meshes or ())[i].joint
        add(elements[joint], "geom", type="mesh", mesh=f"mesh_{i}", friction=SLIDING, **ON_GROUND)
    if trunk and not (firm or hulls or any(shape.parentJoint in trunk for shape in shown)):
        elements[0].addprevious(etree.Comment(" the trunk has no shape here: it does not meet the ground "))


def trunk_of(robot: Robot) -> set[int]:
    """Finds the joints that move the trunk, from which legs hang; without legs the joint of a floating base."""
    model = robot.model
    first = {leg.hip if leg.abduction is None else leg.abduction for leg in robot.legs}
    floating = (
        {len(CHAIN)} if robot.coordinates[: len(CHAIN)] == CHAIN else {1} if model.joints[1].nv == FREE else set()
    )
    return {int(model.parents[model.getJointId(joint)]) for joint in first} - {0} or floating


def _add_geom(shape: Any, elements: list[Any], **attributes: str) -> None:
    kind = shape.meshPath
    geom = add(elements[shape.parentJoint], "geom", type=kind.lower(), size=_size(kind, shape.geometry))
    geom.attrib.update({**place(shape.placement), **attributes})


def _size(kind: str, solid: Any) -> ArrayLike:
    if kind == "BOX":
        return np.array(solid.halfSide)
    return (solid.radius, solid.halfLength) if kind in ("CYLINDER", "CAPSULE") else solid.radius


def _add_toes(robot: Robot, elements: list[Any]) -> None:
    for toe in robot.toes:
        frame = robot.model.frames[robot.toe_id(toe)]
        at, parent = frame.placement.translation, elements[frame.parentJoint]
        add(parent, "site", name=toe, pos=at, size=0.005)
        size = robot.radii.get(toe, CONTACT_RADIUS)
        sphere = add(parent, "geom", name=toe, type="sphere", size=size, pos=at, friction=SLIDING)
        sphere.attrib.update(ON_GROUND)


def _add_motors(robot: Robot, root: Any) -> None:
    motors = add(root, "actuator")
    for joint in robot.actuated:
        ratio = robot.gear_ratio(joint)
        motor = add(motors, "motor", name=joint, joint=joint, **({} if ratio == 1.0 else {"gear": ratio}))
        effort = float(robot.model.upperEffortLimit[robot.index(joint)])
        if 0.0 < effort < np.inf:
            motor.set("ctrlrange", numbers((-effort / abs(ratio), effort / abs(ratio))))
