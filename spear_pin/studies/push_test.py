"""The push test of Section 4.1: the leg is pushed down, held, let go; what its knee does.

The source's RA, "the resting angle", has two readings: the zero of the spring, or the angle at which the
leg rests on it. They differ by the weight's share, Sᵀ G / k, about 0.2 rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.loading import load
from spear_pin.model.pinned import PinnedLeg, pin_toe
from spear_pin.model.variants import vary
from spear_pin.studies.release import RTOL, PassiveKnee, move

Array = NDArray[np.float64]

DEPTHS = (0.05, 0.075, 0.10)  # m, of Section 4.1.3
RATIOS = (None, 15.0, 30.0, 66.0)  # of Fig. 4.6
RATE = 1000.0  # samples a second, as in Section 4.1.3
WITH_MOTOR = PassiveKnee(stiffness=48.25, damping=1.03, zero=1.0)  # Table 4.1, 10 cm
WITHOUT_MOTOR = PassiveKnee(stiffness=47.12, damping=0.80, zero=1.0)


@dataclass(frozen=True)
class Release:
    """One release.

    Attributes:
        t: time since the release, (n,), in s.
        angle: θ, (n,), in rad.
        rate: θ̇, (n,), in rad/s.
        height: of the hip above the toe, (n,), in m.
        force: of the ground on the toe, x and z, (n, 2), in N; negative z is what the pin would have to pull.
        rest: angle of the static equilibrium without dry friction, in rad.
        turns: times at which the knee stands still, in s.
        extrema: the angles there, in rad.
        lift_off: when the pinned leg begins to pull on the ground, in s; None if it never does.
        reason: "complete", or what ended the motion (see `Motion`).
    """

    t: Array
    angle: Array
    rate: Array
    height: Array
    force: Array
    rest: float
    turns: Array
    extrema: Array
    lift_off: float | None
    reason: str


@dataclass(frozen=True)
class Swing:
    """The small oscillation about the static equilibrium, with the damping that is linear.

    Attributes:
        frequency: undamped, in Hz.
        damped_frequency: in Hz; 0 where it does not oscillate.
        damping_ratio: ζ.
        rotor_share: of the effective inertia there.
    """

    frequency: float
    damped_frequency: float
    damping_ratio: float
    rotor_share: float


@dataclass(frozen=True)
class BeltFrequencies:
    """Undamped frequencies of the small oscillation, in Hz, by how the belt is taken.

    Attributes:
        rigid: no belt in between, the rotor moving with the knee.
        parallel: the belt added to the spring, the rotor moving with the knee nevertheless: the source's reading.
        locked: the belt added to the spring, the rotor standing still.
        low: the belt in series, the rotor floating: the slower mode.
        high: the faster.
    """

    rigid: float
    parallel: float
    locked: float
    low: float
    high: float


@dataclass(frozen=True)
class GearRow:
    """One gear ratio of the study of Figs. 4.5 and 4.6.

    Attributes:
        ratio: None without motor.
        rotor: its inertia reflected to the knee, in kg·m².
        knee: what acts on the knee.
        swing: the small oscillation.
        release: the motion.
    """

    ratio: float | None
    rotor: float
    knee: PassiveKnee
    swing: Swing
    release: Release


@typed
def spear_ii(ratio: float | None = 15.0) -> PinnedLeg:
    """SPEAR-II on its slider, its toe pinned.

    Args:
        ratio: of the knee's gearbox; None for the belt taken off, no rotor.
    """
    robot = load("spear_ii", locked=["boom_x"])
    return pin_toe(vary(robot, knee_rotor=0.0) if ratio is None else vary(robot, knee_ratio=ratio))


@typed
def equilibrium(leg: PinnedLeg, knee: PassiveKnee) -> float:
    """The angle at which the leg rests on its spring, in rad, dry friction aside.

    Raises:
        BadValue: within the joint's limits it does not rest, or at several angles.
    """
    angles = np.linspace(*leg.span, 2001)
    torque = knee.spring_torque(angles) - leg.gravity(angles)
    stable = np.flatnonzero((torque[:-1] > 0) & (torque[1:] <= 0))
    if stable.size != 1:
        expected = f"a spring that holds the leg at one angle within {leg.span[0]:g} … {leg.span[1]:g} rad"
        raise BadValue("knee", knee, expected)

    def balance(angle: float) -> float:
        return float(knee.spring_torque(angle) - leg.gravity(angle))

    below, above = float(angles[stable[0]]), float(angles[stable[0] + 1])
    if balance(below) <= 0.0 or balance(above) > 0.0:  # at one of the two, but for rounding
        return min(below, above, key=lambda angle: abs(balance(angle)))
    return float(scipy.optimize.brentq(balance, below, above, xtol=1e-14))


@typed
def resting_at(leg: PinnedLeg, knee: PassiveKnee, rest: float) -> PassiveKnee:
    """Knee with the spring's zero such that the leg rests at an angle, in rad: RA read so."""
    require("stiffness", knee.stiffness, lambda k: k > 0, "a number > 0, in N·m/rad")
    return replace(knee, zero=rest + float(leg.gravity(rest)) / knee.stiffness)


@typed
def pushed_angle(leg: PinnedLeg, knee: PassiveKnee, depth: float) -> float:
    """The knee's angle with the hip a depth, in m, below its height at rest.

    Raises:
        BadValue: the leg cannot go that deep.
    """
    rest = equilibrium(leg, knee)
    height, lowest = float(leg.hip_height(rest)), float(leg.hip_height(leg.span[1]))
    require("depth", depth, lambda d: 0 <= d <= height - lowest, f"a number >= 0, at most {height - lowest:.3f} m")
    return float(
        scipy.optimize.brentq(lambda a: float(leg.hip_height(a)) - height + depth, rest, leg.span[1], xtol=1e-14)
    )


@typed
def release(
    leg: PinnedLeg,
    knee: PassiveKnee,
    depth: float = 0.10,
    duration: float = 1.5,
    rate: float = RATE,
    rtol: float = RTOL,
) -> Release:
    """Push the leg down by a depth, in m, below its rest, and let it go.

    Args:
        leg: the pinned leg, with its rotor.
        knee: what acts on its knee.
        depth: in m.
        duration: of the motion, in s.
        rate: samples a second.
        rtol: relative tolerance of the integration.

    Raises:
        BadValue: the leg does not rest on its spring or cannot go that deep; the duration is not positive.
    """
    require("duration", duration, lambda d: 0 < d <= 3600, "a number > 0, in s, at most an hour")
    require("rate", rate, lambda r: 1 <= r * duration <= 1e7, "samples a second, such that there are 1 to 1e7 of them")
    initial = pushed_angle(leg, knee, depth)
    t = np.arange(round(duration * rate) + 1) / rate
    motion = move(leg, knee, initial, t, rtol=rtol)
    force = leg.ground_force(motion.angle, motion.rate, motion.acceleration).T
    return Release(
        t=t,
        angle=motion.angle,
        rate=motion.rate,
        height=leg.hip_height(motion.angle),
        force=force,
        rest=equilibrium(leg, knee),
        turns=motion.turns,
        extrema=motion.extrema,
        lift_off=_crossing(t, force[:, 1]),
        reason=motion.reason,
    )


@typed
def swing(leg: PinnedLeg, knee: PassiveKnee) -> Swing:
    """The small oscillation about the static equilibrium.

    Raises:
        BadValue: the leg does not rest on its spring.
    """
    rest = equilibrium(leg, knee)
    inertia = float(leg.effective_inertia(rest))
    stiffness = knee.stiffness + float(leg.motion_with_slopes(rest)[5])
    undamped = np.sqrt(stiffness / inertia)
    ratio = (knee.damping + float(leg.drag(rest)[0])) / (2.0 * np.sqrt(stiffness * inertia))
    return Swing(
        frequency=float(undamped / (2 * np.pi)),
        damped_frequency=float(undamped * np.sqrt(max(1.0 - ratio**2, 0.0)) / (2 * np.pi)),
        damping_ratio=float(ratio),
        rotor_share=leg.rotor / inertia,
    )


@typed
def belt_frequencies(leg: PinnedLeg, knee: PassiveKnee, belt: float) -> BeltFrequencies:
    """The small oscillation with a belt that is not rigid, read in either way.

    The source adds the belt to the spring, which holds while the rotor does not turn. Without current the
    rotor floats, and the belt lies in series between it and the knee: two inertias, two modes.

    Args:
        leg: the pinned leg, with its rotor.
        knee: with the stiffness of its spring alone.
        belt: k_rotBelt of (4.7), in N·m/rad.

    Raises:
        BadValue: the belt or the rotor is none, or the leg does not rest on its spring.
    """
    require("belt", belt, lambda k: k > 0, "a stiffness > 0, in N·m/rad")
    require("rotor", leg.rotor, lambda inertia: inertia > 0, "an inertia > 0, in kg·m²")
    rest = equilibrium(leg, knee)
    inertia, body = float(leg.effective_inertia(rest)), float(leg.effective_inertia(rest)) - leg.rotor
    stiffness = knee.stiffness + float(leg.motion_with_slopes(rest)[5])
    modes = scipy.linalg.eigh([[stiffness + belt, -belt], [-belt, belt]], np.diag([body, leg.rotor]), eigvals_only=True)
    squares = np.array([stiffness / inertia, (stiffness + belt) / inertia, (stiffness + belt) / body, *modes])
    return BeltFrequencies(*(float(f) for f in np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)))


@typed
def gear_study(
    ratios: Iterable[float | None] = RATIOS,
    depth: float = 0.10,
    static_rest: bool = False,
    duration: float = 1.5,
    engaged: PassiveKnee = WITH_MOTOR,
    disengaged: PassiveKnee = WITHOUT_MOTOR,
) -> list[GearRow]:
    """One release with each gear ratio, as in Fig. 4.6.

    Args:
        ratios: turns of the rotor per turn of the knee; None without motor.
        depth: of the push, in m.
        static_rest: whether the knees' zeros are meant as the angle at rest.
        duration: of the motions, in s.
        engaged: the knee with motor, for every ratio (default: Table 4.1, with motor, 10 cm).
        disengaged: the knee without (default: Table 4.1, no motor, 10 cm).

    Raises:
        BadValue: a ratio is not a number > 0 or None, or the leg cannot go that deep.
    """
    rows = []
    for ratio in ratios:
        leg, knee = spear_ii(ratio), disengaged if ratio is None else engaged
        if static_rest:
            knee = resting_at(leg, knee, knee.zero)
        rows.append(GearRow(ratio, leg.rotor, knee, swing(leg, knee), release(leg, knee, depth, duration)))
    return rows


def _crossing(t: Array, force: Array) -> float | None:
    """When a force first becomes negative, between samples by a straight line."""
    below = np.flatnonzero(force < 0.0)
    if below.size == 0:
        return None
    i = int(below[0])
    if i == 0:
        return float(t[0])
    return float(t[i - 1] + (t[i] - t[i - 1]) * force[i - 1] / (force[i - 1] - force[i]))
