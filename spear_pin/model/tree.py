"""A robot's kinematic tree with every joint at zero: chains of joints, their directions, the ends of limbs."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.frames import POINT, frame_id

SPLAY = 1e-2  # rad: axes that are off the normal of the sagittal plane by more turn out of it
SHORTEST = 1e-6  # m: a thigh or a shank that is shorter has no direction
ARMS = 0.25  # of the height from the lowest toe to the highest hip: what ends higher is no leg
UPRIGHT = 1.0 - 1e-9  # cosine of what a vertical axis may lean, as much as "1.5708" for a right angle and more
FLOATING = 6  # velocities of a floating base


class Tree:
    """A model with every joint at zero."""

    def __init__(self, model: pin.Model) -> None:
        self.model, self.data = model, pin.Data(model)
        pin.framesForwardKinematics(model, self.data, pin.neutral(model))
        pin.computeJointJacobians(model, self.data, pin.neutral(model))

    def chain(self, tip: int) -> list[int]:
        """Returns the joints from the world to a joint."""
        return [int(joint) for joint in self.model.supports[tip] if joint]

    def axis(self, joint: int) -> Array:
        """Returns the direction about which a joint of one degree of freedom turns, (3,), zero if it slides."""
        return self._motion(joint)[3:]

    def _motion(self, joint: int) -> Array:
        """Returns the unit motion of a joint of one degree of freedom, linear and angular, (6,); else zero."""
        if self.model.joints[joint].nv != 1:
            return np.zeros(6)
        jacobian = pin.getJointJacobian(self.model, self.data, joint, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        return np.asarray(np.reshape(jacobian, (6, -1))[:, self.model.joints[joint].idx_v])

    def slides(self, joint: int) -> bool:
        """Tells whether a joint slides in the sagittal plane."""
        motion = self._motion(joint)
        return bool(motion[:3].any()) and not motion[3:].any() and abs(float(motion[1])) <= math.sin(SPLAY)

    def floats(self, joint: int) -> bool:
        """Tells whether a joint is a floating base."""
        return int(self.model.joints[joint].nv) == FLOATING and not self.model.parents[joint]

    def rails(self, joints: Sequence[int]) -> set[int]:
        """Returns the first joints of a chain from the world that slide in the plane, each in another direction."""
        found: list[int] = []
        for joint in joints:
            ways = np.array([self._motion(each)[[0, 2]] for each in [*found, joint]])
            if not self.slides(joint) or np.linalg.matrix_rank(ways, tol=SPLAY) <= len(found):
                break
            found.append(joint)
        return set(found)

    def pitches(self, joint: int) -> bool:
        """Tells whether a joint turns in the sagittal plane."""
        return abs(float(self.axis(joint)[1])) >= math.cos(SPLAY)

    def yaws(self, joint: int) -> bool:
        """Tells whether a joint turns about the vertical."""
        return abs(float(self.axis(joint)[2])) >= UPRIGHT

    def ends(self) -> tuple[str, ...]:
        """Returns the frames at the ends of the limbs that may be legs, one each."""
        found = []
        for tip, pitching in self._limbs():
            frame = self._end(tip, pitching[1])
            if frame is not None:
                found.append((frame.name, self.data.oMf[frame_id(self.model, frame.name)].translation[2], pitching))
        if not found:
            return ()
        lowest = min(height for _, height, _ in found)
        highest = max(self.data.oMi[pitching[0]].translation[2] for _, _, pitching in found)
        return tuple(name for name, height, _ in found if height <= lowest + ARMS * (highest - lowest))

    def endless(self) -> list[str]:
        """Returns the last joints of the limbs that would be legs, but have no frame away from their knee."""
        return [str(self.model.names[tip]) for tip, joints in self._limbs() if self._end(tip, joints[1]) is None]

    def _limbs(self) -> list[tuple[int, list[int]]]:
        """Returns each limb's last joint, and the joints above it that turn in the sagittal plane, two or more."""
        parents = set(map(int, self.model.parents))
        chains = {tip: self.chain(tip) for tip in range(1, self.model.njoints) if tip not in parents}
        limbs = ((tip, [joint for joint in chain if self.pitches(joint)]) for tip, chain in chains.items())
        return [(tip, pitching) for tip, pitching in limbs if len(pitching) >= 2]

    def _end(self, tip: int, knee: int) -> Any:
        """Returns the frame at a limb's end that is farthest from a joint; of equal ones that named as a toe.

        Links go before the sites and the geoms of an MJCF file, which are asked where no link is away from the joint.
        """
        for kind in (pin.FrameType.BODY, POINT):
            frames = [f for f in self.model.frames if int(f.parentJoint) == tip and f.type == kind]
            places = [(self.data.oMi[tip] * frame.placement).translation for frame in frames]
            distances = [float(np.linalg.norm(place - self.data.oMi[knee].translation)) for place in places]
            longest = max(distances, default=0.0)
            if longest >= SHORTEST:
                far = [f for f, distance in zip(frames, distances, strict=True) if distance >= longest - 1e-9]
                return next((frame for frame in far if re.search("(?i)toe|foot", frame.name)), far[-1])
        return None
