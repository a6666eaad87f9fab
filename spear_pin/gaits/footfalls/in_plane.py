"""Bounding in the plane as footfalls of pairs of legs: bounds and guesses, and the law that a solution gives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.bounding_law import LEGS, BoundingLaw, legs_of
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.footfalls.limbs import length
from spear_pin.gaits.footfalls.nodes import Free, Room, Support, limits, within
from spear_pin.gaits.footfalls.programme import Transcription
from spear_pin.gaits.footfalls.sequence import Footfalls
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.request import FARTHEST, FASTEST, HIGHEST, LONGEST_PHASE, LONGEST_STRIDE, SHORTEST_FLIGHT, Request
from spear_pin.hybrid.fields import with_fields
from spear_pin.hybrid.result import State
from spear_pin.model.legs import lean
from spear_pin.model.planar import Planar
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import refuse_ends
from spear_pin.model.scale import Scale, scale_of
from spear_pin.model.spring import PAIR_STIFFNESS

BASE = 3
STIFFEST, STRONGEST = 2000.0, 400.0  # N·m/rad, N·m: limits of free springs and of the law, of a pair of Q-SPEAR's legs
KNEE_REST, HEIGHT = BoundingLaw.knee_rest, 0.57  # rad, m: of Q-SPEAR's knees, and of the hips they hold up
FALLS, RISES = 0.2, 5.0  # m/s, m/s² for Q-SPEAR: least of a foot that lands, that lifts off
BEARS, FLIES = 0.1, 0.06  # s: guesses for Q-SPEAR
PHASES = ("posterior_stance", "flight_1", "anterior_stance", "flight_2")
LANDINGS = dict(zip(LEGS, ("flight_2", "flight_1"), strict=True))  # the flight before each touchdown


def in_plane(robot: Robot, request: Request, intervals: int, seed: int = 0) -> Room:
    """Returns what a robot and a request allow in the plane.

    Args:
        robot: Q-SPEAR in the sagittal plane, or another quadruped as `spear_pin.sagittal` cuts it.
        request: the request for the gait.
        intervals: number of intervals of each phase.
        seed: seed of the perturbation of the guess.

    Raises:
        BadValue: the robot is not such a quadruped, or the request is outside the range of the search.
    """
    scale, rng, limbs = scale_of(robot), np.random.default_rng(seed), {leg.name: leg for leg in legs_of(robot)}
    request.check(scale)
    level = np.zeros(robot.nq)
    hips = float(np.mean([robot.frame_position(level, f"{leg}_hip")[1] for leg in LEGS]))
    footfalls = Footfalls((LEGS[:1], (), LEGS[1:], ()), (intervals,) * 4)
    rough = [(BEARS if bearing else FLIES) * scale.time for bearing in footfalls.phases]
    shortest = [request.minimum_stance, SHORTEST_FLIGHT * scale.time] * 2
    unit = np.array([scale.length, scale.length, *5 * (1.0,)])

    def posture(phase: int, s: float) -> Array:
        ahead = request.speed * (sum(rough[:phase]) + s * rough[phase])
        return _posture(request, scale, limbs, hips, ahead, phase, s)

    def guess(phase: int, s: float) -> tuple[Array, Array]:
        noise, ahead = rng.normal(size=(2, 7)) * unit, np.array([request.speed, *6 * (0.0,)])
        return posture(phase, s) + 0.03 * noise[0], ahead + 0.1 * noise[1] / scale.time

    def height(phase: int, leg: str, s: float) -> float | None:
        if footfalls.phases[phase]:
            return request.clearance
        return 0.0 if 0.0 < s < 1.0 else None

    stiffness: Any = request.stiffness
    if stiffness is None:
        stiffness = Free("stiffness", PAIR_STIFFNESS * scale.torque, 0.0, STIFFEST * scale.torque, 100.0 * scale.torque)
    refuse_ends(robot, "collocation")
    rates, effort = FASTEST * unit / scale.time, np.full(4, np.inf)
    if request.within_limits:
        rates[BASE:] = np.minimum(rates[BASE:], limits(robot, BASE, "velocity", np.inf))
        effort = limits(robot, BASE, "effort", np.inf)
    return Room(
        robot=robot,
        request=request,
        footfalls=footfalls,
        names=PHASES,
        limbs=limbs,
        scale=scale,
        mechanism=Planar(robot),
        base=BASE,
        configurations=_configurations(robot, request, scale, limbs, hips),
        rates=rates,
        effort=effort,
        durations=[
            (time * (1.0 + 0.2 * rng.uniform(-1, 1)), least, LONGEST_PHASE * scale.time)
            for time, least in zip(rough, shortest, strict=True)
        ],
        stride=(request.minimum_stride, LONGEST_STRIDE * scale.time),
        push=robot.weight,
        posture=posture,
        guess=guess,
        height=height,
        landing=request.leg_touchdown,
        falls=FALLS * scale.speed,
        rises=RISES * scale.length / scale.time**2,
        support=_support(request, scale),
        spring=with_fields(request.spring(0.0), {"stiffness": stiffness}),
        passes=request.lift_off == "force" or request.knee_touchdown != request.knee_rest,
    )


def _configurations(
    robot: Robot, request: Request, scale: Scale, limbs: Mapping[str, Leg], hips: float
) -> tuple[Array, Array]:
    """Returns the least and the largest q."""
    size = scale.length
    bounds = [(-size, FARTHEST * size), (0.3 * size - hips, HIGHEST * size - hips), (-0.8, 0.8)]
    for limb in limbs.values():
        least, most = sorted((-0.3 * limb.side, 2.5 * limb.side))
        for i, own in ((limb.hip, (-1.9, 1.9)), (limb.knee, (least, most))):
            bounds.append(within(robot, i, *own) if request.within_limits else own)
    lower, upper = np.transpose(bounds)
    return lower, upper


def _posture(
    request: Request, scale: Scale, limbs: Mapping[str, Leg], hips: float, ahead: float, phase: int, s: float
) -> Array:
    """Returns a rough configuration: level torso, sweeping legs, flexed swing knees."""
    rest = request.knee_rest
    bearing, bears, swings = 0.22 - 0.44 * s, rest + 0.2 * math.sin(math.pi * s), rest + 0.6
    trails, comes, bends, straightens = -0.22 + 0.1 * s, 0.1 + 0.12 * s, rest + 0.3 * s, rest + 0.6 * (1.0 - s)
    angles, knees = (
        ((bearing, -0.2 + 0.25 * s), (bears, swings)),
        ((trails, comes), (bends, straightens)),
        ((-0.1 + 0.2 * s, bearing), (swings, bears)),
        ((comes, trails), (straightens, bends)),
    )[phase]
    held, straight = (np.mean([length(limb.lengths, knee) for limb in limbs.values()]) for knee in (rest, KNEE_REST))
    q = [ahead, HEIGHT * scale.length * held / straight - hips, 0.0]
    for limb, angle, knee in zip(limbs.values(), angles, knees, strict=True):
        flexed = limb.side * knee
        q += [angle + float(lean(*limb.lengths, flexed, math)[0]), flexed]
    return np.array(q)


def _support(request: Request, scale: Scale) -> Support:
    """Returns the law for legs on the ground; what the request leaves open of it is free."""
    unit, least = scale.torque, request.minimum_knee_torque
    knee: Any = request.knee_touchdown
    stiffness: Any = request.virtual_stiffness
    if knee is None:
        most = math.radians(70.0) + request.knee_rest - KNEE_REST
        knee = Free("knee touchdown", request.knee_rest, math.radians(20.0), most)
    if stiffness is None:
        usual, most, size = (number * unit for number in (BoundingLaw.virtual_stiffness, STIFFEST, 100.0))
        stiffness = Free("virtual stiffness", usual, 0.0, most, size)
    most = STRONGEST * unit
    constants = {"hip": (0.0, -most, most), "knee": (max(20.0 * unit, least), least, least + most)}
    return Support(stiffness, request.knee_rest, knee, constants, by_force=request.lift_off == "force")


def read(transcription: Transcription, solution: Solution) -> tuple[BoundingLaw, State, float]:
    """Returns the law, the section state and the springs' stiffness at a solution in the plane."""
    room, support, values = transcription.room, transcription.support, dict[str, Any]()
    assert isinstance(room.request, Request) and support is not None

    def number(expression: Any) -> float:
        return transcription.number(expression, solution)

    for name, (hip, knee) in transcription.constants.items():
        values |= {f"{name}_hip_torque": number(hip), f"{name}_knee_torque": number(knee)}
    for phase, evolutions in zip(PHASES, transcription.evolutions_at(solution), strict=True):
        for leg, evolution in evolutions.items():
            shape = tuple(row[2:] for row in evolution.alpha)
            values[f"{phase}_span"] = evolution.span
            if phase == LANDINGS[leg]:
                values[f"{phase}_landing"] = tuple(row[0] for row in shape)
                values[f"{leg}_leg_touchdown"] = shape[0][-1]
            else:
                values[f"{phase}_{'swing' if 'stance' in phase else 'trailing'}"] = shape
    first = transcription.phases[0][0]
    q, v = (transcription.programme.read(part, solution) for part in (first.q, first.v))
    law = BoundingLaw(
        **values,
        virtual_stiffness=number(support.stiffness),
        knee_touchdown=number(support.knee_touchdown),
        knee_rest=support.knee_rest,
        lift_off=room.request.lift_off,
        epsilon=BoundingLaw.epsilon * room.scale.time,
        nominal=(*q[1:].tolist(), *v.tolist()),
    )
    return law, (q, v), number(transcription.spring.stiffness)
