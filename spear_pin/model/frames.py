"""Frames and joints of a model by their names."""

from __future__ import annotations

import pinocchio as pin

from spear_pin.errors import UnknownName

POINT = pin.FrameType.OP_FRAME  # in an MJCF file: a site, or a geom where a limb may end
INSIDE = pin.FrameType.SENSOR  # the middle of any other geom
# of frames with the same name, a link's goes first
KINDS = (pin.FrameType.BODY, pin.FrameType.FIXED_JOINT, pin.FrameType.JOINT, POINT, INSIDE)


def frame_id(model: pin.Model, frame: str) -> int:
    """Returns the index of a frame; the link's frame if a joint has the same name.

    Raises:
        UnknownName: there is no such frame; the text lists the valid ones.
    """
    names = [each.name for each in model.frames]
    if frame in names:  # Pinocchio gives nframes for an unknown name, and no error
        for kind in KINDS:
            index = int(model.getFrameId(frame, kind))
            if 0 < index < model.nframes:  # 0 is the world, Pinocchio's "universe"
                return index
    raise UnknownName("frame", frame, [name for name in names if name != "universe"])


def joint_id(model: pin.Model, joint: str, kind: str = "joint") -> int:
    """Returns the number of a joint; `kind` is what errors call it.

    Raises:
        UnknownName: there is no such joint; the text lists the valid ones.
    """
    names = list(model.names)
    if joint not in names[1:]:  # the first is the world, Pinocchio's "universe"
        raise UnknownName(kind, joint, names[1:])
    return names.index(joint)
