"""Replays a log: the model moves from where a stance began, driven by the measured torques or by its own law.

The model's own lift-off ends its stance. Model and log are then compared by numbers that are found in the same way of
both, from the length of the leg alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import least_squares

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.result import Moment
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.simulate import simulate
from spear_pin.kinds import typed
from spear_pin.showing import Shown
from spear_pin.studies.logs.arcs import MARGIN, RATE, SETTLE, LogArc, find_arcs, fit_rates
from spear_pin.studies.logs.fit import MotionFit
from spear_pin.studies.logs.given import UNBOUNDED, check_names, check_values
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import FLIGHT, STANCE, Measured, find_measured
from spear_pin.studies.logs.phases import LogPhase
from spear_pin.studies.logs.played import make_played, played_with, with_own
from spear_pin.studies.logs.residuals import HEIGHT_SENSOR, LAG, LOST, ZERO
from spear_pin.studies.logs.shooting import FAR, Shooter

MEASURES = {"compression": "m", "stance": "s", "push_off": "m/s"}
PUSH = 0.012  # s before lift-off, over which the leg's rate is taken
STEPS = 4  # by how much steps are shorter than need be, as friction is stiff
MEASURED, LAW = "measured", "law"
NONE = "–"  # a measure that a motion does not have
SAMPLES = 400  # of each phase, between which a simulated motion is interpolated
WINDOW = 0.04  # s, on which the first state is fitted: some periods of the ringing after a touchdown


@dataclass(frozen=True)
class Hop:
    """One stance and what follows it, by the model and in the log.

    Attributes:
        stance: the stance in the log.
        t: times, (n,), in s of the log, until the next touchdown in it.
        positions: measured positions, (n, m), in rad or m.
        modelled: the model's, (n, m).
        lift_off: time at which the model lifts off, in s of the log; NaN if it does not.
        measures: of the model and of the log, by name: "compression" of the leg, in m; "stance", the time until it
            is as long as when it lifts off in the log, in s; and "push_off", how fast it lengthens then, in m/s. Both
            of these are NaN if it never is.
    """

    stance: LogPhase
    t: Array
    positions: Array
    modelled: Array
    lift_off: float
    measures: Mapping[str, tuple[float, float]]

    def off(self, name: str) -> float:
        """Returns by how much the model is off, relative to the log."""
        model, log = self.measures[name]
        return model / log - 1.0

    @property
    def rms(self) -> float:
        """Root of the mean square of model less log, in rad or m."""
        return float(np.sqrt(np.nanmean((self.modelled - self.positions) ** 2)))


@dataclass(frozen=True, repr=False)
class Replay(Shown):
    """A log and the model that replays it.

    Attributes:
        log: the log.
        joints: names of the measured joints.
        units: their units.
        hops: the stances that were replayed.
        left_out: phases that were not, with the reason.
    """

    log: Log
    joints: tuple[str, ...]
    units: tuple[str, ...]
    hops: tuple[Hop, ...]
    left_out: tuple[LogPhase, ...]

    def off(self, name: str) -> float:
        """Returns by how much the model is off on average, relative to the log, over hops that have it; NaN if none."""
        found = [each for each in (hop.off(name) for hop in self.hops) if np.isfinite(each)]
        return float(np.mean(found)) if found else np.nan

    def __repr__(self) -> str:
        offs = {name: 100.0 * self.off(name) for name in MEASURES}
        said = ", ".join(f"{name} {off:+.1f} %" if np.isfinite(off) else f"{name} {NONE}" for name, off in offs.items())
        return f"Replay({self.log.source!r}: {len(self.hops)} hops; model less log: {said})"


@typed
def replay(
    system: HybridSystem | MotionFit,
    log: Log,
    values: Mapping[str, float] | None = None,
    *,
    motors: str = MEASURED,
    window: float = WINDOW,
    settle: float = SETTLE,
) -> Replay:
    """Drives a leg by the torques of a log, or by its law, from a state fitted to the beginning of each stance.

    Args:
        system: the leg, or a fit whose values it has.
        log: the log.
        values: numbers as `identify_motion` names them, for a leg that is not a fit.
        motors: "measured", or "law" for the event-exact simulation by the system's law, with those of the values that
            the system has itself.
        window: time on which the first state is fitted, in s.
        settle: time after each touchdown that is left out, in s.

    Raises:
        BadFile: the log has no hop.
        BadValue: a robot, a log or a value does not fit.
        UnknownName: there is no number of a name.

    Example:
        >>> from tempfile import mkdtemp
        >>> from spear_pin import Log, hopping, load, replay, simulate
        >>> leg = hopping(load("spear_ii", locked=["boom_x"]))
        >>> file = simulate(leg, leg.guess(), cycles=2).export(f"{mkdtemp()}/hops.csv")
        >>> replay(leg, Log.read(file))
        Replay('...hops.csv': 2 hops; model less log: compression ...)
    """
    require("window", window, lambda time: time > 0, "a number > 0, in s")
    require("settle", settle, lambda time: time >= 0, "a number >= 0, in s")
    if motors not in (MEASURED, LAW):
        raise BadValue("motors", motors, f"{MEASURED!r} or {LAW!r}")
    given = dict(values or {})
    if isinstance(system, MotionFit):
        leg, user = system.leg, system.source
        given = {name: each.value for name, each in system.found.items()} | given
    else:
        user, leg = system, make_played(system)
    joints = find_measured(user.robot, log)
    of_sensors = [*(f"{joint}{ZERO}" for joint in joints.joints), LAG, *HEIGHT_SENSOR]
    check_names(leg, user, given, [*of_sensors, *(["friction"] if motors == LAW else [])])  # the law's toe may slide
    check_values(given)
    own = {name: value for name, value in given.items() if name not in of_sensors}
    leg = played_with(leg, user, own)
    arcs, left_out = find_arcs(user, joints, log, settle, whole=True, torques=motors == MEASURED)
    stances = [arc for arc in arcs if arc.phase.name == STANCE]
    if not stances:
        raise BadValue("log", log.source, "one with a stance that can be used")
    longest = max(arc.phase.duration for arc in stances)
    if window > longest:
        raise BadValue("window", window, f"at most {longest:.3g} s, the time of the longest stance")
    shooter, by_law = Shooter(leg), with_own(user, leg, own) if motors == LAW else None
    hops = [_replayed(shooter, by_law, joints, arc, window, given) for arc in stances]
    units = tuple(user.robot.units[row] for row in joints.rows)
    return Replay(log, joints.joints, units, tuple(hops), tuple(left_out))


def _replayed(
    shooter: Shooter,
    system: HybridSystem | None,
    joints: Measured,
    arc: LogArc,
    window: float,
    values: Mapping[str, float],
) -> Hop:
    """Returns a stance and what follows, from a state fitted to its first instants; by the law of a given system."""
    m, rows, nv = len(joints.rows), joints.rows, joints.robot.nv
    zeros, lag = np.array([values.get(f"{joint}{ZERO}", 0.0) for joint in joints.joints]), values.get(LAG, 0.0)
    first = max(RATE, int(np.searchsorted(arc.t, min(arc.t[0] + window, arc.phase.end))))
    some = arc.t[:first], arc.torques[:first]
    latched = joints.configuration(arc.touchdown - zeros, arc.near)

    def shown(y: Array) -> Array:
        moves = np.isfinite(y[:, 0])
        t, y = arc.t[: len(y)][moves], y[moves]
        seen = np.full((len(moves), m), np.nan)
        seen[moves] = CubicHermiteSpline(t, y[:, rows], y[:, [nv + row for row in rows]])(t - lag) + zeros
        return seen

    def missed(x: Array) -> Array:
        y = joints.state(STANCE, x[:m], x[m:], arc.near)
        shot = shooter.shoot(STANCE, *some, y, np.zeros((2 * nv, 1)), latched, steps=STEPS)
        return (shown(shot.y) - arc.positions[:first] if shot.bounded else np.full((first, m), LOST)).ravel()

    begin = np.concatenate([arc.positions[0] - zeros, fit_rates(joints, STANCE, some[0], arc.positions[:first], 0)])
    found = least_squares(missed, begin, x_scale="jac").x
    y = joints.state(STANCE, found[:m], found[m:], arc.near)
    states, lift_off = _driven(shooter, arc, latched, y) if system is None else _by_law(system, arc, latched, y)
    if system is None and not (np.abs(states) < FAR).all():
        raise BadValue("values", dict(values), UNBOUNDED)
    modelled = shown(states)
    model, log = (joints.lengths(each - zeros, arc.near) for each in (modelled, arc.positions))
    leaves = float(np.interp(arc.phase.end - MARGIN, arc.t, log))
    touchdown = joints.length(latched)
    both = zip(*(_measures(arc, length, touchdown, leaves) for length in (model, log)), strict=True)
    return Hop(arc.phase, arc.t, arc.positions, modelled, lift_off, dict(zip(MEASURES, both, strict=True)))


def _driven(shooter: Shooter, arc: LogArc, latched: Array, y: Array) -> tuple[Array, float]:
    """Returns states at all samples, (n, 2 nv), with the measured torques, and when the toe lifts off."""
    states, lift_off, none = list[Array](), np.nan, np.zeros((len(y), 1))
    with np.errstate(over="ignore", invalid="ignore"):
        for state, _, force in shooter.along(STANCE, arc.t, arc.torques, y, none, latched, steps=STEPS):
            states.append(state)
            if force[-1] < 0.0:
                lift_off = float(arc.t[len(states) - 1])
                break
        rest = slice(len(states) - 1, None)
        flight = shooter.along(FLIGHT, arc.t[rest], arc.torques[rest], states.pop(), none, latched, steps=STEPS)
        states += [state for state, _, _ in flight]
    return np.array(states), lift_off


def _by_law(system: HybridSystem, arc: LogArc, touchdown: Array, y: Array) -> tuple[Array, float]:
    """Returns what `_driven` does, with the system's law from touchdown on; NaN after the next touchdown."""
    nv, reset = system.robot.nv, system.landing[1]
    clock = Clock(0.0, system.springs, system)
    rates = y[nv:].tolist()
    held = latch_values({}, [reset], touchdown.tolist(), rates, system.law, begins=True, clock=clock)
    since = float(arc.t[0]) - arc.phase.begin
    run = simulate(system, Moment(y[:nv], y[nv:], str(reset.phase), held, since), samples=SAMPLES, progress=False)
    begins = float(arc.t[0]) - float(run.t[0])
    lands = next((event.time for event in run.events if event.name == system.section), np.inf)
    before = run.t < lands
    t, first = np.unique(run.t[before] + begins, return_index=True)
    line = CubicHermiteSpline(t, run.q[before][first], run.v[before][first])
    states = np.hstack([line(arc.t), line(arc.t, 1)])
    leaves = [event.time + begins for event in run.events if event.name == "lift_off" and event.time < lands]
    return np.where((arc.t <= t[-1])[:, None], states, np.nan), float(leaves[0]) if leaves else np.nan


def _measures(arc: LogArc, length: Array, touchdown: float, leaves: float) -> tuple[float, float, float]:
    """Returns compression, stance and push-off; see `Hop`."""
    shortest = int(np.nanargmin(length[arc.t < arc.phase.end]))
    above = np.flatnonzero(length[shortest:] >= leaves)
    compression = touchdown - float(length[shortest])
    if not above.size or not above[0]:
        return compression, np.nan, np.nan
    last = shortest + int(above[0])
    time = float(np.interp(leaves, length[last - 1 : last + 1], arc.t[last - 1 : last + 1]))
    before = (arc.t > time - PUSH) & (arc.t <= arc.t[last])
    line = np.polyfit(arc.t[before] - time, length[before], 2)
    return compression, time - arc.phase.begin, float(line[1])
