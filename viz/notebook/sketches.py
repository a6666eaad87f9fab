"""Small drawings of cards: outlines in SVG units, which the template inserts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.model.postures import put_on_ground
from spear_pin.model.robot import Robot
from spear_pin.viz.plots.paper import BLUE, VERMILLION

INK = "currentColor"
LINE = (120, 20)  # px of a line over time
SIDE = 150  # px of a drawing
MOST_POINTS = 240  # of a line
BELOW = 1e-6  # m: less is on the ground
BENT = 1.0  # rad of the knees of a robot that stands


@dataclass(frozen=True)
class Stroke:
    """An outline: its path, in SVG's notation, its colour, its width in px, and whether it is filled."""

    path: str
    color: str = INK
    width: float = 1.2
    filled: bool = False


@dataclass(frozen=True)
class Sketch:
    """A drawing.

    Attributes:
        says: description, in words.
        size: width and height, in px.
        strokes: strokes, from back to front.
    """

    says: str
    size: tuple[int, int]
    strokes: tuple[Stroke, ...]


def over_time(t: Array, values: Array, says: str) -> Sketch:
    """Draws a line over time, (n,) and (n,), as high as its range."""
    rows = np.unique(np.linspace(0, len(t) - 1, MOST_POINTS).astype(int))
    width, height = LINE
    x = 1 + (width - 2) * (t[rows] - t[0]) / (np.ptp(t) or 1.0)
    y = height - 2 - (height - 4) * (values[rows] - values.min()) / (np.ptp(values) or 1.0)
    return Sketch(says, LINE, (Stroke(_line(x, y), BLUE),))


def circle(multipliers: NDArray[np.complex128]) -> Sketch:
    """Draws Floquet multipliers and the unit circle; those outside are crossed out."""
    reach = 1.12 * max(1.0, float(np.abs(multipliers).max(initial=0.0)))
    middle = SIDE / 2
    scale = middle / reach
    axes = Stroke(f"M0 {middle}H{SIDE}M{middle} 0V{SIDE}", width=0.4)
    unit = Stroke(_dot(middle, middle, scale), width=0.8)
    places = [(middle + scale * z.real, middle - scale * z.imag, abs(z) < 1.0) for z in multipliers.tolist()]
    inside = Stroke("".join(_dot(x, y, 3.2) for x, y, within in places if within), BLUE, filled=True)
    outside = Stroke("".join(_cross(x, y) for x, y, within in places if not within), VERMILLION, 1.8)
    return Sketch("Floquet multipliers and the unit circle", (SIDE, SIDE), (axes, unit, inside, outside))


def scatter(x: Array, y: Array, level: float, says: str) -> Sketch:
    """Draws points, (n,) and (n,), and a level; points above it are crossed out."""
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    low, high = min(float(y.min(initial=level)), 0.0), max(float(y.max(initial=level)), level) * 1.08
    across = 8 + (1.6 * SIDE - 16) * (x - x.min(initial=np.inf)) / (np.ptp(x) if len(x) and np.ptp(x) else 1.0)
    up = SIDE - 6 - (SIDE - 12) * (np.append(y, level) - low) / (high - low)
    places = [(*place, below) for *place, below in zip(across, up[:-1], y < level, strict=True)]
    strokes = (
        Stroke(f"M1 0V{SIDE - 1}H{1.6 * SIDE:g}", width=0.6),
        Stroke(f"M0 {up[-1]:.1f}H{1.6 * SIDE:g}", width=0.8),
        Stroke("".join(_dot(a, b, 2.2) for a, b, below in places if below), BLUE, filled=True),
        Stroke("".join(_cross(a, b, 2.4) for a, b, below in places if not below), VERMILLION),
    )
    return Sketch(says, (round(1.6 * SIDE), SIDE), strokes)


def bar(share: float, says: str) -> Sketch:
    """Draws a bar as long as a share, up to 1."""
    width, height = LINE
    return Sketch(says, LINE, (Stroke(f"M0 4h{width * share:.1f}v{height - 8}H0z", BLUE, 0.0, True),))


def standing(robot: Robot) -> Sketch:
    """Draws the robot from its side, as lines from joint to joint, its knees bent, on the ground."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, _bent(robot))
    # as bodies are, so that a slide is no bone
    hung = [(data.oMi[model.parents[i]], model.jointPlacements[i]) for i in range(1, model.njoints)]
    links = [(body, body * place) for body, place in hung if place.translation.any()]
    tips = [model.getFrameId(toe) for toe in robot.toes or [leg.toe for leg in robot.legs]]
    links += [(data.oMi[model.frames[i].parentJoint], data.oMf[i]) for i in tips]
    ends = np.array([[place.translation[[0, 2]] for place in link] for link in links]).reshape(-1, 2, 2)
    low, high = ends.min(axis=(0, 1), initial=0.0), ends.max(axis=(0, 1), initial=0.0)
    scale = (SIDE - 16) / max(float(np.max(high - low)), 1e-9)
    width = round(scale * float(high[0] - low[0])) + 40
    place = np.array([20.0, SIDE - 8.0]) + (ends - low) * scale * (1.0, -1.0)
    bones = "".join(_line(link[:, 0], link[:, 1]) for link in place)
    joints = "".join(_dot(x, y, 3.0) for x, y in place[:, 0].tolist())
    stands = bool(robot.toes) and low[1] > -BELOW
    ground = Stroke(f"M0 {SIDE - 8 + scale * low[1]:.1f}H{width}" if stands else "", width=0.6)
    says = f"{robot.name} from its side" + ", its knees bent" * bool(robot.legs)
    return Sketch(says, (width, SIDE), (ground, Stroke(bones, width=2.4), Stroke(joints, BLUE, filled=True)))


def _bent(robot: Robot) -> Array:
    """Returns a configuration with bent knees, each toe below its hip, as far as legs are known; (nq,)."""
    q = np.array(pin.neutral(robot.model))
    for leg in robot.legs:
        knee = BENT * (leg.bends or 1)
        for joint, angle, sign, zero in (
            (leg.hip, leg.lean(knee), leg.hip_sign, leg.hip_zero),
            (leg.knee, knee, leg.knee_sign, leg.knee_zero),
        ):
            kind = robot.model.joints[robot.model.getJointId(joint)]
            if kind.nq == 1:
                q[kind.idx_q] = zero + sign * angle
    return put_on_ground(robot, q)


def _line(x: ArrayLike, y: ArrayLike) -> str:
    places = np.column_stack((x, y)).tolist()
    return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in places)


def _dot(x: float, y: float, radius: float) -> str:
    return f"M{x - radius:.1f} {y:.1f}" + "".join(
        f"a{radius:.1f} {radius:.1f} 0 1 0 {d:.1f} 0" for d in (2 * radius, -2 * radius)
    )


def _cross(x: float, y: float, arm: float = 4.0) -> str:
    return f"M{x - arm:.1f} {y - arm:.1f}l{2 * arm:.1f} {2 * arm:.1f}m0 {-2 * arm:.1f}l{-2 * arm:.1f} {2 * arm:.1f}"
