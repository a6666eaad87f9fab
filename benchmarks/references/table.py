"""The problems of the references."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from benchmarks.references.problem import Problem, Torque
from spear_pin.hybrid.ground import Ground
from spear_pin.model.clutch import Clutch
from spear_pin.model.loading import load
from spear_pin.model.path import Joints
from spear_pin.model.spring import Spring

BLOCK = Path(__file__).with_name("block.urdf")
HELD = {"hip": Torque((), 54.77, 0.5, 1.37), "knee": Torque((), 63.25, 1.0, 0.52)}
PUSH = {"knee": Torque((0.0, -80.0, 100.0))}
KNEE = {"toe": {"knee": Spring()}}
LEGS = {"posterior_left": 1, "posterior_right": 1, "anterior_left": -1, "anterior_right": -1}
"""Legs of Q-SPEAR, and the sense in which their knees flex."""
Torques = dict[str, Torque]
PAIR = "posterior_left", "anterior_right"


@cache
def problems() -> Mapping[str, Problem]:
    """Returns the problems by name."""
    return {problem.name: problem for part in (_blocks, _legs, _bounds, _in_space, _impacts) for problem in part()}


def _blocks() -> Iterator[Problem]:
    block = load(BLOCK, toes=["foot"], motors="all")
    yield Problem("block_falls", "A block falls from 1 m and stays.", block, [0, 1.1], [0, 0])
    words = "A block falls while it moves forward, slides, stops, is pushed back and lifted, takes off and lands."
    lifted = {"up": Torque((0.0, 10.0)), "along": Torque((-3.0,))}
    carried = {"up": Torque((25.0, -20.0))}
    yield Problem("block_slides", words, block, [0, 0.6], [1.5, 0], carried, lifted, ground=Ground(0.3), landings=2)
    words = "A block strikes the ground so that it slides, takes off as its lift exceeds its weight, and lands."
    lifted = {"up": Torque((0.0, 40.0))}
    yield Problem("block_hops", words, block, [0, 0.2], [2.0, 0], carried, lifted, ground=Ground(0.5), landings=2)


def _legs() -> Iterator[Problem]:
    leg, free = load("spear_ii", locked=["boom_x"]), load("spear_ii")
    yield Problem(
        "leg_falls", "A leg on a vertical slider falls, its joints at rest.", leg, [0.85, 0.5, 1.0], [0, 0, 0]
    )
    words = "A leg on a vertical slider is thrown up, swings freely and lands."
    yield Problem("leg_swings", words, leg, [1.0, 0.3, 0.8], [0.5, 2.0, -4.0])
    start = [0.75, 0.5, 1.0], [0, 0, 0], HELD, PUSH

    words = "The leg falls, its knee's spring engages at touchdown, the motor pushes, and it hops once."
    yield Problem("leg_hops", words, leg, *start, KNEE, landings=2)
    yield Problem("leg_hops_thrice", "The leg hops three times.", leg, *start, KNEE, landings=4)
    words = "The leg hops on ground with little friction, on which its toe slides."
    yield Problem("leg_slides", words, leg, *start, KNEE, Ground(0.3), landings=2)
    words = "The leg hops; its spring engages 20 ms after touchdown and releases 10 ms after lift-off."
    late = Spring(clutch=Clutch(on_delay=0.02, off_delay=0.01, damper="joint"))
    yield Problem("leg_hops_late", words, leg, *start, {"toe": {"knee": late}}, landings=2)
    words = "The leg hops; its spring pulls only 0.05 rad beyond the angle at which it engaged."
    play = {"toe": {"knee": Spring(clutch=Clutch(play=0.05))}}
    yield Problem("leg_hops_with_play", words, leg, *start, play, landings=2)
    words = "The leg hops on a spring that stiffens."
    hard = {"toe": {"knee": Spring(40.0, hardening=100.0)}}
    yield Problem("leg_hops_hardening", words, leg, *start, hard, landings=2)
    words = "The leg, free to move forward, hops once at 0.3 m/s."
    yield Problem("leg_runs", words, free, [0, 0.75, 0.45, 1.0], [0.3, 0, 0, 0], HELD, PUSH, KNEE, landings=2)
    words = "The leg, free to move forward, hops up a slope of 0.1 rad."
    slope = Ground(0.8, slope=0.1)
    yield Problem("leg_climbs", words, free, [0, 0.8, 0.45, 1.0], [0.3, 0, 0, 0], HELD, PUSH, KNEE, slope, landings=2)
    words = "A periodic hop of the leg from just after touchdown, with its Floquet multipliers."
    q, v = GAIT
    yield Problem("leg_gait", words, leg, q, v, HELD, PUSH, KNEE, stands=("toe",), periodic=True)

    crank = load("crank_hopper")
    words = "A leg with a closed loop, whose crank pushes its foot down, hops; a cable pulls always when it is taut."
    springs = crank.settings.springs
    held, push = {"crank": Torque((), 15.0, 0.6, 0.3)}, {"crank": Torque((0.0, -40.0, -200.0))}
    q = crank.closed([0.45, 0.6, 0.0, 0.0]).tolist()
    yield Problem("crank_hops", words, crank, q, [0] * 4, held, push, {"toe": springs}, landings=2)


GAIT = (
    (0.5786340139258018, 0.4470861878933129, 0.8551443409530324),
    (-0.4920233377323397, 1.8818982271399822, 3.7306186095858487),
)


def _bounds() -> Iterator[Problem]:
    planar = load("q_spear")
    pairs = {"posterior": 1, "anterior": -1}
    pose = [0.42, 0.75, -0.42, -0.75]
    for name, z, pitch, speed, hip, knee, stiffness in (
        ("bound_slow", 0.72, 0.3, 1.0, (-20.0, -20.0), (-45.0, 30.0), 200.0),
        ("bound_fast", 0.70, 0.25, 1.5, (-20.0, -20.0), (-45.0, 30.0), 250.0),
    ):
        words = f"A quadruped in the plane, each pair a leg, lands pitched at {speed:g} m/s: a stride of a bound."
        held, push = _held(pairs, 1.2, 120.0, 4.0), Torques()
        for leg, forward, extend in zip(pairs, hip, knee, strict=True):
            push |= {f"{leg}_hip": Torque((forward,)), f"{leg}_knee": Torque((extend,))}
        start = [0, z, pitch, *pose], [speed, *[0] * 6]
        yield Problem(name, words, planar, *start, held, push, _springs(pairs, stiffness), landings=2)


def _in_space() -> Iterator[Problem]:
    robot = load("q_spear_full", base="chain")
    for name, words, pitch, turning in (
        (
            "trot",
            "A quadruped lands on a diagonal pair of feet and takes off from it, as in a trot.",
            0.2,
            0.0,
        ),
        ("turn", "A quadruped that turns lands on a diagonal pair of feet and takes off from it.", 0.1, 0.6),
    ):
        held = _held(LEGS, 1.2, 60.0, 2.0)
        for leg in LEGS.keys() - PAIR:
            held |= _held({leg: LEGS[leg]}, 1.9, 60.0, 2.0, 0.95)
        push = Torques()
        for leg, extend in zip(PAIR, (-40.0, 30.0), strict=True):
            push |= {f"{leg}_hip": Torque((-10.0,)), f"{leg}_knee": Torque((extend,))}
        across = {f"{leg}_adduction": Torque((), 40.0, 0.0, 2.0) for leg in LEGS}
        knees = {leg: 0.75 if leg in PAIR else 1.9 for leg in LEGS}
        hips = {leg: 0.42 if leg in PAIR else 0.95 for leg in LEGS}
        q = [0, 0, 0.74, 0, pitch, 0, *_joints(hips, knees)]
        v = [0.5, 0, 0, turning, *[0] * 14]
        yield Problem(name, words, robot, q, v, held | across, push | across, _springs(LEGS, 250.0), landings=2)


def _impacts() -> Iterator[Problem]:
    robot = load("q_spear_full", base="chain")
    rates = [0.4, 0.5, -1.0, 0.3, -0.6, -0.8, 0.2, -0.5, 0.7, -0.3, 0.4, 0.9]
    v = [0.5, 0.1, -1.0, 0.2, 0.1, -0.1, *rates]
    words = "An impact of {} of a quadruped's feet, with a coefficient of friction of {:g}; the others are in the air."
    for n, many in enumerate(("one", "two", "three", "four"), 1):
        for friction in (5.0, 0.2):
            legs = ("anterior_left", "posterior_right", "posterior_left", "anterior_right")[:n]
            knees = {leg: 1.0 if leg in legs else 1.6 for leg in LEGS}
            q = [0, 0, 0, 0.2, 0, 0, *_joints(dict.fromkeys(LEGS, 0.5), knees)]
            feet = tuple(f"{leg}_toe" for leg in legs)
            q[2] = -float(robot.toe_position(q, feet[0])[2])
            name, said = (
                f"impact_{n}{'' if friction > 1.0 else '_slides'}",
                words.format(many, friction),
            )
            yield Problem(name, said, robot, q, v, ground=Ground(friction), strikes=feet)


def _held(legs: Mapping[str, int], knee: float, stiffness: float, damping: float, hip: float = 0.6) -> Torques:
    """Returns the torques that hold hips and knees of legs at angles."""
    held: Torques = {}
    for leg, side in legs.items():
        held[f"{leg}_hip"] = Torque((), stiffness, side * hip, damping)
        held[f"{leg}_knee"] = Torque((), stiffness, side * knee, damping)
    return held


def _springs(legs: Mapping[str, int], stiffness: float) -> dict[str, dict[str, Spring]]:
    """Returns a spring at the knee of each leg, which its flexion stretches."""
    knees = {leg: Joints({f"{leg}_knee": float(side)}) for leg, side in legs.items()}
    return {f"{leg}_toe": {f"{leg}_knee": Spring(stiffness, 1.0, path=path)} for leg, path in knees.items()}


def _joints(hips: Mapping[str, float], knees: Mapping[str, float]) -> list[float]:
    """Returns the angles of adduction, hip and knee of each leg."""
    return [angle for leg, side in LEGS.items() for angle in (0.0, side * hips[leg], side * knees[leg])]
