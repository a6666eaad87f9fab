"""The appearance of a robot on a cut of it: each visual on the cut's joint that moves its link."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.cut import Cut
from spear_pin.model.frames import frame_id
from spear_pin.model.robot import Robot
from spear_pin.viz.playback.visuals import Visual

TRUNK = {"monopod": "boom", "sagittal": "torso"}  # link of a cut that bears what is no leg's


def grafted(robot: Robot, cut: Cut, visuals: Sequence[Visual]) -> list[Visual]:
    """Returns visuals of a robot on the joints of a cut of it.

    For a monopod they are the visuals of its leg and, faintly, those of the trunk; for a sagittal robot they are all.
    With every angle of the cut at zero, the robot's joints are at their `Turn.zero`; then the two coincide, hip on hip.
    If a cut points to the robot's rear, the robot is shown turned by half a turn.

    Args:
        robot: the cut robot.
        cut: the cut.
        visuals: visuals of the robot from which it was cut.
    """
    model, carriers = cut.robot.model, _carriers(cut)
    there, here = pin.Data(model), pin.Data(robot.model)
    pin.framesForwardKinematics(model, there, _at_zero(cut))
    pin.framesForwardKinematics(robot.model, here, pin.neutral(robot.model))
    turned = np.diag([-1.0, -1.0, 1.0, 1.0]) if cut.mirrored else np.eye(4)
    across = _across(robot, cut, here, there)
    found = []
    for visual in (visual for visual in visuals if visual.joint in carriers):
        carrier = carriers[visual.joint]
        joint = int(robot.model.frames[frame_id(robot.model, carrier)].parentJoint)
        start, end = _hips(robot, cut, carrier, here, there)
        moved = turned.copy()
        moved[:3, 3] = end - turned[:3, :3] @ (start[0], across, start[2])
        placement = here.oMi[joint].inverse().homogeneous @ moved @ there.oMi[visual.joint].homogeneous
        faint = cut.kind == "monopod" and carrier == TRUNK[cut.kind] and _shared(cut, visual.joint)
        found.append(replace(visual, joint=joint, placement=placement @ visual.placement, faint=faint))
    return found


def _carriers(cut: Cut) -> dict[int, str]:
    """Returns, for each visible joint of the robot, the cut's joint, or its trunk, with which it moves."""
    model = cut.robot.model
    carriers = dict.fromkeys(range(model.njoints) if cut.kind == "sagittal" else _above(cut), TRUNK[cut.kind])
    if model.inertias[0].mass == 0.0:  # rails, on which the trunk slides
        carriers.pop(0)
    for name, turns in cut.angles.items():  # each hip before its knee
        carriers |= {int(joint): name for turn in turns for joint in model.subtrees[model.getJointId(turn.joint)]}
    return carriers


def _at_zero(cut: Cut) -> Array:
    """Returns the configuration of the robot with every angle of the cut at zero, (nq,)."""
    model = cut.robot.model
    q = np.array(pin.neutral(model))
    for turn in (turn for turns in cut.angles.values() for turn in turns):
        joint = model.joints[model.getJointId(turn.joint)]
        angle = [turn.zero] if joint.nq == 1 else [np.cos(turn.zero), np.sin(turn.zero)]
        q[joint.idx_q : joint.idx_q + joint.nq] = angle
    return q


def _hips(robot: Robot, cut: Cut, carrier: str, here: pin.Data, there: pin.Data) -> tuple[Array, Array]:
    """Returns the middle of the hips of a leg or pair, of all for the trunk, in robot and cut, (3,), in m."""
    hips = [name for name in cut.angles if name.endswith("hip") and name == carrier.replace("knee", "hip")]
    hips = hips or [name for name in cut.angles if name.endswith("hip")]
    joints = [cut.robot.model.getJointId(turn.joint) for name in hips for turn in cut.angles[name]]
    own = [here.oMf[frame_id(robot.model, name)].translation for name in hips]
    return np.mean([there.oMi[joint].translation for joint in joints], axis=0), np.mean(own, axis=0)


def _across(robot: Robot, cut: Cut, here: pin.Data, there: pin.Data) -> float:
    """Returns the part of the robot that lies in the plane, in m to its left: mid-hips, or a monopod's toe.

    The toe is the link that is nearest to the cut's toe.
    """
    if cut.kind == "sagittal":
        return float(_hips(robot, cut, TRUNK[cut.kind], here, there)[0][1])
    model = cut.robot.model
    hip, knee = (model.getJointId(cut.angles[name][0].joint) for name in ("hip", "knee"))
    top, low = (here.oMf[frame_id(robot.model, name)].translation[2] for name in ("hip", "toe"))
    toe = there.oMi[hip].translation - (0.0, 0.0, top - low)
    links = set(map(int, model.subtrees[knee]))
    places = [there.oMf[i].translation for i, frame in enumerate(model.frames) if int(frame.parentJoint) in links]
    return float(min(places, key=lambda place: float(np.hypot(*(place - toe)[[0, 2]])))[1])


def _above(cut: Cut) -> list[int]:
    """Returns the joints from the world to a monopod's hip."""
    model = cut.robot.model
    return [int(joint) for joint in model.supports[model.getJointId(cut.angles["hip"][0].joint)]]


def _shared(cut: Cut, joint: int) -> bool:
    """Tells whether a joint above a monopod's hip carries more than its leg."""
    model, chain = cut.robot.model, _above(cut)
    leg = {*chain, *map(int, model.subtrees[chain[-1]])}
    return joint == 0 or not leg.issuperset(map(int, model.subtrees[joint]))
