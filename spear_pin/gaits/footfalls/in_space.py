"""Gaits in space: bounds and guesses of the programme."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.footfalls.limbs import hip_heights, legs_of
from spear_pin.gaits.footfalls.nodes import Room, Support, limits, within
from spear_pin.gaits.footfalls.plan import Plan
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.footfalls.swing import WIDEST
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.request import FLEXED
from spear_pin.model.chain import CHAIN
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, scale_in_space
from spear_pin.model.spatial import Spatial

BASE = len(CHAIN)
FARTHEST, LOWEST, HIGHEST = 3.0, -0.3, 0.9  # m of Q-SPEAR: along, aside; of the torso above the ground
TURNED, SWUNG = 1.5, 1.9  # rad: yaw; a hip from straight down
STRAIGHT = 0.15  # rad: least flexion of a knee
FASTEST = (10.0, 20.0)  # m/s and rad/s of Q-SPEAR
FALLS, RISES = 0.1, 1.0  # m/s, m/s² for Q-SPEAR: least of a foot that lands, that lifts off


def in_space(robot: Robot, request: FootfallRequest) -> Room:
    """Returns what a robot and a request allow in space.

    Args:
        robot: a quadruped on a chain, such as `load("q_spear_full", base="chain")`.
        request: the request for the gait.

    Raises:
        BadValue: the robot is not such a quadruped.
    """
    limbs, scale, footfalls, nv = legs_of(robot), scale_in_space(robot), request.footfalls, robot.nv
    plan = Plan(limbs, hip_heights(robot), request, scale, robot.weight)
    straight, turning = FASTEST[0] * scale.speed, FASTEST[1] / scale.time
    bears, flies = request.shortest

    def time(phase: int, s: float) -> float:
        return plan.begins(phase) + s * plan.durations[phase]

    def guess(phase: int, s: float) -> tuple[Array, Array]:
        return plan.q(time(phase, s), nv), plan.v(time(phase, s), nv)

    def height(phase: int, leg: str, s: float) -> float | None:
        """Returns none where the foot lands and lifts off; other constraints put it on the ground there."""
        gone = plan.swung(leg, time(phase, s))
        return 4.0 * gone * (1.0 - gone) * request.clearance if 1e-6 < gone < 1.0 - 1e-6 else None

    return Room(
        robot=robot,
        request=request,
        footfalls=footfalls,
        names=[
            f"phase {i + 1}, {' and '.join(each.replace('_', ' ') for each in bearing) or 'flight'}"
            for i, bearing in enumerate(footfalls.phases)
        ],
        limbs=limbs,
        scale=scale,
        mechanism=Spatial(robot),
        base=BASE,
        configurations=_configurations(robot, request, scale, limbs),
        rates=np.array([*3 * (straight,), *3 * (turning,), *limits(robot, BASE, "velocity", 1.5 * turning)]),
        effort=limits(robot, BASE, "effort", np.inf),
        durations=[
            (rough, bears if bearing else flies, request.longest)
            for bearing, rough in zip(footfalls.phases, plan.durations, strict=False)
        ],
        stride=(0.0, request.longest_stride),
        push=plan.push,
        posture=lambda phase, s: plan.q(time(phase, s), nv),
        guess=guess,
        height=height,
        landing=(-WIDEST, WIDEST),
        falls=FALLS * scale.speed,
        rises=RISES * scale.length / scale.time**2,
        support=_support(request),
        spring=request.spring,
        swings=request.swing is not None,
        coarse=True,
        turn=request.turn,
    )


def _configurations(
    robot: Robot, request: FootfallRequest, scale: Scale, limbs: Mapping[str, Leg]
) -> tuple[Array, Array]:
    """Returns the least and the largest q."""
    far, high, low = (number * scale.length for number in (FARTHEST, HIGHEST, LOWEST))
    most = np.array([far, far, high, TURNED, request.tilt, request.tilt, *(robot.nv - BASE) * (0.0,)])
    least = np.array([-far, -far, low, -TURNED, -request.tilt, -request.tilt, *(robot.nv - BASE) * (0.0,)])
    for limb in limbs.values():
        knee = sorted(limb.zeros[2] + limb.side * angle for angle in (STRAIGHT, FLEXED))
        hip = limb.zeros[1] - SWUNG, limb.zeros[1] + SWUNG
        for i, (lower, upper) in zip(limb.rows, ((-request.adduction, request.adduction), hip, knee), strict=True):
            least[i], most[i] = within(robot, i, lower, upper)
    return least, most


def _support(request: FootfallRequest) -> Support | None:
    if (law := request.law) is None:
        return None
    epsilon = 1.0 if request.swing is None else request.swing.adduction_epsilon
    constants = dict.fromkeys(("hip", "knee", "adduction"), (0.0, -law.most, law.most))
    upright = law.adduction_stiffness, law.adduction_damping, epsilon
    return Support(law.stiffness, law.knee_rest, law.knee_rest, constants, upright)
