"""Event-exact simulation of whole cycles, sampled into a `Trajectory`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.engines.pinocchio import electrical_flows, flow_names
from spear_pin.hybrid.filippov import flow_of
from spear_pin.hybrid.record import BOOKED, Moment, Options, Run, Segment, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.trajectory import Ledger, Trajectory

Array = NDArray[np.float64]
SAMPLES = 100  # a phase, at least


def simulate(
    system: HybridSystem,
    state: State | Moment,
    cycles: int = 1,
    rtol: float = 1e-9,
    *,
    atol: float | None = None,
    max_evaluations: int = 2_000_000,
    progress: bool = True,
) -> Trajectory:
    """Simulate whole cycles from a state on the section, or in the air before the first touchdown.

    A fall, a Zeno point or a numerical failure ends the trajectory with a `reason`.

    Args:
        system: robot, law and ground.
        state: (q, v), or a moment of another run.
        cycles: number of whole cycles, from section to section.
        rtol: relative tolerance of the integrator.
        atol: absolute tolerance; None means 0.01 rtol.
        max_evaluations: cap on right-hand side evaluations.
        progress: show a progress bar on long runs, if stderr is a terminal.

    Raises:
        BadValue: a tolerance, the number of cycles, or the state is not valid.
    """
    options = Options(rtol, atol, max_evaluations, keep=True)
    if not progress:
        return sample(system, run(system, state, cycles, options))
    from tqdm import tqdm

    with tqdm(total=cycles, unit="cycle", delay=1.0, disable=None, leave=False) as bar:
        return sample(system, run(system, state, cycles, options, lambda n: bar.update(1)))


def sample(system: HybridSystem, result: Run) -> Trajectory:
    """Sample a kept run: at least 100 samples a phase, both sides of every event."""
    robot = system.robot
    nq, nv = robot.nq, robot.nv
    springs = list(dict.fromkeys(mount.joint for domain in system.domains for mount in domain.mounts))
    rows: dict[str, list[object]] = {name: [] for name in (*_NUMERIC, "domain", "phase", "cycle")}
    remembered = len(system.hardware.names) if system.hardware is not None else 0
    for segment, times, states in _samples(result, remembered + len(flow_names(system))):
        flow = flow_of(system, segment.domain, segment.held)
        mounts = {mount.joint: mount for mount in segment.domain.mounts}
        engaged = [joint in mounts for joint in springs]
        for t, y in zip(times, states, strict=True):
            flow(t, y)
            rows["a"].append(np.array(flow.a))
            rows["u"].append(tuple(flow.u))
            rows["tau"].append(flow.tau)
            rows["friction"].append(flow.friction)
            rows["force"].append([flow.force(toe) for toe in robot.toes])
            rows["spring"].append([flow.spring_torque(joint) for joint in springs])
            rows["current"].append(flow.driven.currents if flow.driven else ())
            rows["reference"].append(flow.driven.references if flow.driven else ())
        n = len(times)
        rows["t"].extend(segment.began + times)
        rows["q"].extend(states[:, :nq])
        rows["v"].extend(states[:, nq : nq + nv])
        rows["engaged"].extend([engaged] * n)
        rows["domain"].extend([segment.domain.name] * n)
        rows["phase"].extend([segment.domain.phase] * n)
        rows["cycle"].extend([segment.cycle] * n)
    n = len(rows["t"])
    shapes = {"force": (n, len(robot.toes), 2), "spring": (n, len(springs)), "engaged": (n, len(springs))}
    arrays = {name: np.array(rows[name], dtype=float).reshape(shapes.get(name, (n, -1))) for name in _NUMERIC}
    ledger, electrical = _ledgers(system, result)
    return Trajectory(
        robot=robot.source,
        coordinates=robot.coordinates,
        actuated=robot.actuated,
        toes=robot.toes,
        spring_joints=tuple(springs),
        domain=np.array(rows["domain"]),
        phase=np.array(rows["phase"]),
        cycle=np.array(rows["cycle"], dtype=np.int64),
        **arrays | {"t": arrays["t"].ravel(), "engaged": arrays["engaged"].astype(bool)},
        events=tuple(result.events),
        ledger=ledger,
        cycles=result.cycles,
        reason=result.reason,
        message=result.message,
        evaluations=result.evaluations,
        electrical=electrical,
    )


_NUMERIC = ("t", "q", "v", "a", "u", "tau", "friction", "force", "spring", "engaged", "current", "reference")


def _ledgers(system: HybridSystem, result: Run) -> tuple[Ledger, Ledger | None]:
    """Of the mechanism, and of what drives it: battery = joule + gearbox + motors + what the inductances store."""
    flows = (*flow_names(system), *BOOKED)
    everything = Ledger(flows, np.array(result.work).reshape(-1, len(flows)), np.array(result.change))
    drives = electrical_flows(system)
    mechanical = tuple(flow for flow in flows if flow not in drives)
    ledger = Ledger(mechanical, _columns(everything, mechanical), everything.change)
    if system.hardware is None:
        return ledger, None
    motors = tuple(f"motor_{joint}" for joint in system.robot.actuated)
    work = np.hstack([_columns(everything, drives), -_columns(everything, motors)])
    return ledger, Ledger((*drives, *motors), work, np.array(result.stored))


def _columns(ledger: Ledger, flows: tuple[str, ...]) -> Array:
    return ledger.work[:, [ledger.flows.index(flow) for flow in flows]]


def _samples(result: Run, beyond: int) -> Iterator[tuple[Segment, Array, Array]]:
    """Sample times and states of every segment, with so many numbers beyond q and v.

    The segments of a phase share its samples by length.
    """
    if all(segment.began + piece.end == 0.0 for segment in result.segments for piece in segment.pieces):
        yield result.segments[-1], np.zeros(1), np.concatenate([*result.state, np.zeros(beyond)])[None]
        return
    lengths: dict[float, float] = {}
    for segment in result.segments:
        if segment.pieces:
            lengths[segment.began] = segment.pieces[-1].end
    for segment in result.segments:
        if not segment.pieces:
            continue
        begin, end, whole = segment.pieces[0].begin, segment.pieces[-1].end, lengths[segment.began]
        if end == begin:
            continue  # left as soon as entered
        # of a whole phase exactly so many, however its end is rounded
        count = 2 + int(np.ceil(SAMPLES * (end - begin) / whole - 1e-6))
        times = np.linspace(begin, end, count)
        pieces = np.searchsorted([piece.end for piece in segment.pieces[:-1]], times)
        states = [np.atleast_2d(segment.pieces[i].state(times[pieces == i]).T) for i in np.unique(pieces)]
        yield segment, times, np.vstack(states)
