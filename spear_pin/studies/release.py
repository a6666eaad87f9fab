"""The release of Section 4.1 in time: the pinned leg let go, from event to event, with its sensitivities.

    (Sᵀ D S) θ̈ + ½ (Sᵀ D S)' θ̇² + Sᵀ G = -k (θ - θ₀) - b θ̇ - τ_c sign θ̇

Dry friction changes its sign, and a spring that only pulls its stiffness, at events, so that each piece in
between is smooth; where the knee stands still, dry friction holds what it can.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg

Array = NDArray[np.float64]

# what a motion can be derived by: the numbers of the passive knee, the reflected rotor inertia, the start
PARAMETERS = ("stiffness", "damping", "coulomb", "zero", "rotor", "initial_angle")
RTOL = 1e-10
MAX_STEP = 0.05  # s, a fifth of a swing or less: at loose tolerances the error estimate may miss one
WORK, WORK_PER_SECOND = 20_000, 2_000  # right-hand sides: twenty times what a release takes
PIECES = 10_000  # smooth pieces of a motion, at most
MOST = 1e30  # of stiffness, damping and friction: with more, forces are no numbers


@typed
@dataclass(frozen=True)
class PassiveKnee:
    """Torque on the knee while no motor acts: -k (θ - θ₀) - b θ̇ - τ_c sign θ̇, in N·m.

    In the push test the spring stays engaged, its zero is an angle of its own, and it is taken to pull
    both ways.

    Attributes:
        stiffness: k_rot, in N·m/rad (default: source Table 4.1, with motor, 10 cm).
        damping: b, in N·m·s/rad (default: source Table 4.1, with motor, 10 cm).
        coulomb: τ_c, in N·m; the source has none.
        zero: θ₀, the angle at which the spring is slack, in rad (default: RA of Table 4.1, read so).
        unilateral: whether the spring pulls only beyond its zero, as a chain does.
        braking: what a motor without command adds to b beyond a rate, in N·m·s/rad (see `power_off`).
        braking_from: that rate, in rad/s.
    """

    stiffness: float = 48.25
    damping: float = 1.03
    coulomb: float = 0.0
    zero: float = 1.0
    unilateral: bool = False
    braking: float = 0.0
    braking_from: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        require(
            "PassiveKnee.stiffness",
            self.stiffness,
            lambda k: 0 <= k <= MOST,
            f"a number >= 0, at most {MOST:g} N·m/rad",
        )
        require(
            "PassiveKnee.damping", self.damping, lambda b: 0 <= b <= MOST, f"a number >= 0, at most {MOST:g} N·m·s/rad"
        )
        for name, unit in (("stiffness", "N·m/rad"), ("damping", "N·m·s/rad"), ("coulomb", "N·m")):
            expected = f"a number >= 0, at most {MOST:g}, in {unit}"
            require(f"PassiveKnee.{name}", getattr(self, name), lambda number: 0 <= number <= MOST, expected)
        require("PassiveKnee.braking", self.braking, lambda b: b >= 0, "a number >= 0, in N·m·s/rad")
        require("PassiveKnee.braking_from", self.braking_from, lambda r: r >= 0, "a number >= 0, in rad/s")
        require("PassiveKnee.zero", self.zero, lambda z: abs(z) < np.inf, "an angle, in rad")

    def braking_torque(self, rate: ArrayLike) -> Array:
        """Of the motor, against the motion beyond a rate, in N·m."""
        beyond = np.maximum(np.abs(rate) - self.braking_from, 0.0)
        return np.asarray(-self.braking * np.sign(rate) * beyond)

    def spring_torque(self, angle: ArrayLike) -> Array:
        """-k (θ - θ₀), in N·m."""
        stretch = np.asarray(angle) - self.zero
        return np.asarray(-self.stiffness * (np.maximum(stretch, 0.0) if self.unilateral else stretch))


@dataclass(frozen=True)
class Motion:
    """The knee's motion after the release, sampled.

    Attributes:
        angle: θ, (n,), in rad.
        rate: θ̇, (n,), in rad/s.
        acceleration: θ̈, (n,), in rad/s².
        sensitivity: ∂θ/∂p, (n, parameters), for those asked for.
        turns: times at which the knee stands still between two swings, in s.
        extrema: θ at them, in rad.
        reason: "complete"; or what ended it, the angle being held from there on: "limit" of the joint,
            "step_size", "pieces", or "work", more of it than a release takes: forces are too stiff.
    """

    angle: Array
    rate: Array
    acceleration: Array
    sensitivity: Array
    turns: Array
    extrema: Array
    reason: str


@typed
def move(
    leg: PinnedLeg,
    knee: PassiveKnee,
    initial_angle: float,
    times: ArrayLike,
    wrt: Sequence[str] = (),
    rtol: float = RTOL,
) -> Motion:
    """Let the leg go at rest and integrate its motion.

    Args:
        leg: the pinned leg, with its rotor.
        knee: what acts on its knee.
        initial_angle: at which it is let go, in rad.
        times: at which the motion is wanted, increasing, (n,), in s since the release.
        wrt: of `PARAMETERS`, those by which θ is derived.
        rtol: relative tolerance; the absolute one is a hundredth of it, in rad and rad/s.

    Raises:
        BadValue: the angle is beyond the joint's limits, or the times do not increase from 0 on.
        UnknownName: an unknown parameter.
    """
    try:
        at = np.asarray(times, dtype=float)
    except (TypeError, ValueError):
        raise BadValue("times", times, "increasing numbers from 0 on, in s") from None
    if at.ndim != 1 or at.size == 0 or not np.isfinite(at).all() or at[0] < 0 or (np.diff(at) <= 0).any():
        raise BadValue("times", times, "increasing numbers from 0 on, in s")
    require("rtol", rtol, lambda tolerance: 1e-13 <= tolerance <= 1e-2, "a number from 1e-13 to 1e-2")
    low, high = leg.span
    require("initial_angle", initial_angle, lambda a: low <= a <= high, f"an angle within {low:g} … {high:g} rad")
    for name in wrt:
        if name not in PARAMETERS:
            raise UnknownName("parameter", name, PARAMETERS)
    start = np.array([initial_angle, 0.0, *(float(name == "initial_angle") for name in wrt), *np.zeros(len(wrt))])
    states, accelerations, turns = np.tile(start, (at.size, 1)), np.zeros(at.size), np.empty((0, 2))
    work = Counter({"left": round(WORK + WORK_PER_SECOND * float(at[-1]))})
    flow = _Flow(leg, knee, tuple(wrt), 0.0, not knee.unilateral or initial_angle > knee.zero, work)
    now, state, reason = 0.0, start, "pieces"
    for _ in range(PIECES):
        if flow.dry and state[1] == 0.0:
            flow, state = _restarted(flow, state)
        held = flow.dry and flow.direction == 0.0
        if now >= at[-1] or held:
            if not held:
                accelerations[at == now] = flow.acceleration(state[0], state[1])
            reason = "complete"
            break
        events = _events(flow)
        tolerances = {"rtol": rtol, "atol": 0.01 * rtol, "max_step": MAX_STEP}
        try:
            piece = scipy.integrate.solve_ivp(
                flow, (now, at[-1]), state, "DOP853", dense_output=True, events=events, **tolerances
            )
        except _Exhausted:
            reason = "work"
            break
        within = (at >= now) & (at <= piece.t[-1])
        if within.any():
            states[within] = piece.sol(at[within]).T
            accelerations[within] = flow.acceleration(states[within, 0], states[within, 1])
        found = np.column_stack([piece.t_events[0], piece.y_events[0].reshape(-1, start.size)[:, 0]])
        turns = np.vstack([turns, found[found[:, 0] > now]])
        now, state = float(piece.t[-1]), piece.y[:, -1].copy()
        if piece.status == 0:
            reason = "complete"
            break
        met = [e for e, t in zip(events, piece.t_events, strict=True) if e.terminal and t.size and t[-1] == now]
        if piece.status < 0 or isinstance(met[0], _Limit):
            reason = "limit" if met else "step_size"
            break
        if isinstance(met[0], _Turn):
            state[1] = 0.0
        else:
            flow = replace(flow, pulls=not flow.pulls)
    state[1] = 0.0
    if reason == "limit":  # it is there whatever the parameters
        state[2:] = 0.0
    states[at > now] = state
    angle, rate, sensitivity = states[:, 0], states[:, 1], states[:, 2 : 2 + len(wrt)]
    return Motion(angle, rate, accelerations, sensitivity, turns[:, 0], turns[:, 1], reason)


class _Exhausted(Exception):
    """More right-hand sides than a release takes."""


@dataclass(frozen=True)
class _Flow:
    """The right-hand side of one smooth piece: (θ, θ̇), then ∂θ/∂p and ∂θ̇/∂p of each parameter.

    Attributes:
        leg: with its rotor.
        knee: what acts on it.
        wrt: the parameters.
        direction: of the motion as dry friction sees it, -1, 0 or 1.
        pulls: whether the spring does.
        work: how many calls are left.
    """

    leg: PinnedLeg
    knee: PassiveKnee
    wrt: tuple[str, ...]
    direction: float
    pulls: bool
    work: Counter[str]

    @property
    def dry(self) -> bool:
        """Whether the direction of the motion matters."""
        return self.knee.coulomb > 0.0 or "coulomb" in self.wrt

    def __call__(self, t: float, state: Array) -> Array:
        self.work["left"] -= 1
        if self.work["left"] < 0:
            raise _Exhausted
        angle, rate, *sensitivities = state.tolist()  # floats: with numbers so few, an array costs more
        terms = self.leg.motion_with_slopes.at(angle).tolist()
        inertia, centrifugal, gravity, inertia_slope, centrifugal_slope, gravity_slope, drag, drag_slope = terms
        knee, stiffness = self.knee, self.knee.stiffness * self.pulls
        stretch = angle - knee.zero
        torque = -stiffness * stretch - (knee.damping + drag) * rate - knee.coulomb * self.direction
        beyond = max(abs(rate) - knee.braking_from, 0.0)
        torque -= math.copysign(knee.braking * beyond, rate)
        acceleration = (torque - gravity - centrifugal * rate * rate) / inertia
        if not self.wrt:
            return np.array([rate, acceleration])
        forcing = {
            "stiffness": -stretch * self.pulls,
            "damping": -rate,
            "coulomb": -self.direction,
            "zero": stiffness,
            "rotor": -acceleration,
            "initial_angle": 0.0,
        }
        by_angle = -stiffness - gravity_slope - (drag_slope + centrifugal_slope * rate) * rate
        by_angle -= acceleration * inertia_slope
        by_rate = -knee.damping - drag - knee.braking * (beyond > 0.0) - 2.0 * centrifugal * rate
        of_angle, of_rate = sensitivities[: len(self.wrt)], sensitivities[len(self.wrt) :]
        rows = zip(self.wrt, of_angle, of_rate, strict=True)
        return np.array(
            [rate, acceleration, *of_rate]
            + [(by_angle * angle_p + by_rate * rate_p + forcing[name]) / inertia for name, angle_p, rate_p in rows]
        )

    def acceleration(self, angle: Array, rate: Array) -> Array:
        """θ̈ at many samples."""
        inertia, centrifugal, gravity = self.leg.motion(angle)
        knee = self.knee
        torque = -knee.stiffness * self.pulls * (angle - knee.zero) - knee.coulomb * self.direction
        torque = torque - (knee.damping + self.leg.drag(angle)[0]) * rate + knee.braking_torque(rate)
        return np.asarray((torque - gravity - centrifugal * rate**2) / inertia)


def _restarted(flow: _Flow, state: Array) -> tuple[_Flow, Array]:
    """Where the knee stands still: the direction in which it goes on, 0 if dry friction holds it.

    The acceleration jumps there, and with it ∂θ̇/∂p, in the same ratio, for the time of the turn depends on p.
    """
    knee, angle = flow.knee, float(state[0])
    torque = float(knee.spring_torque(angle) - flow.leg.gravity(angle))
    direction = float(np.sign(torque)) if abs(torque) > knee.coulomb else 0.0
    state = state.copy()
    if flow.direction:
        before, after = (torque - knee.coulomb * way for way in (flow.direction, direction))
        state[2 + len(flow.wrt) :] *= after / before if direction else 0.0
    return replace(flow, direction=direction), state


@dataclass(frozen=True)
class _Turn:
    """The knee stands still; with dry friction a new piece begins there."""

    terminal: bool
    direction: float

    def __call__(self, t: float, state: Array) -> float:
        return float(state[1])


@dataclass(frozen=True)
class _Limit:
    """The end of the joint's range."""

    span: tuple[float, float]
    terminal: bool = True
    direction: float = -1.0

    def __call__(self, t: float, state: Array) -> float:
        return float(min(state[0] - self.span[0], self.span[1] - state[0]))


@dataclass(frozen=True)
class _Kink:
    """The zero of a spring that only pulls."""

    zero: float
    direction: float
    terminal: bool = True

    def __call__(self, t: float, state: Array) -> float:
        return float(state[0] - self.zero)


def _events(flow: _Flow) -> list[_Turn | _Limit | _Kink]:
    """Events to look for during a piece: turns first."""
    events: list[_Turn | _Limit | _Kink] = [_Turn(flow.dry, -flow.direction), _Limit(flow.leg.span)]
    if flow.knee.unilateral:
        events.append(_Kink(flow.knee.zero, -1.0 if flow.pulls else 1.0))
    return events
