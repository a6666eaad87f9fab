"""Event-exact simulation of whole cycles, sampled into a `Trajectory`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.engines.pinocchio import Flow, flow_names
from spear_pin.hybrid.run import Options, Run, Segment, State, run
from spear_pin.hybrid.trajectory import Ledger, Trajectory

Array = NDArray[np.float64]
SAMPLES = 120  # a phase


def simulate(
    system: HybridSystem,
    state: State,
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
        state: (q, v).
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
    rows: dict[str, list[object]] = {name: [] for name in (*_NUMERIC, "domain", "phase", "cycle")}
    springs = list(dict.fromkeys(mount.joint for domain in system.domains for mount in domain.mounts))
    for segment, times in _times(result):
        flow = Flow(system, segment.domain, segment.held)
        mounts = {mount.joint: mount for mount in segment.domain.mounts}
        for t, y in times:
            flow(t, y)
            q, v = y[:nq], y[nq : nq + nv]
            rows["t"].append(segment.began + t)
            rows["q"].append(q)
            rows["v"].append(v)
            rows["a"].append(np.array(flow.a))
            rows["u"].append(tuple(flow.u))
            rows["tau"].append(flow.tau)
            rows["friction"].append(np.array(flow.friction))
            rows["force"].append([flow.force(toe) for toe in robot.toes])
            rows["spring"].append(
                [
                    mounts[j].spring.stiffness
                    * segment.held[mounts[j].taut]
                    * (segment.held[mounts[j].rest] - q[robot.index(j)])
                    if j in mounts
                    else 0.0
                    for j in springs
                ]
            )
            rows["engaged"].append([j in mounts for j in springs])
            rows["domain"].append(segment.domain.name)
            rows["phase"].append(segment.domain.phase)
            rows["cycle"].append(segment.cycle)
    n = len(rows["t"])
    shapes = {"force": (n, len(robot.toes), 2), "spring": (n, len(springs)), "engaged": (n, len(springs))}
    arrays = {name: np.array(rows[name], dtype=float).reshape(shapes.get(name, (n, -1))) for name in _NUMERIC}
    flows = (*flow_names(system), "impact", "released")
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
        ledger=Ledger(flows, np.array(result.work).reshape(-1, len(flows)), np.array(result.change)),
        cycles=result.cycles,
        reason=result.reason,
        message=result.message,
        evaluations=result.evaluations,
    )


_NUMERIC = ("t", "q", "v", "a", "u", "tau", "friction", "force", "spring", "engaged")


def _times(result: Run) -> list[tuple[Segment, list[tuple[float, Array]]]]:
    """Sample times and states of every segment; a phase's segments share its samples by length."""
    lasts: dict[float, float] = {}
    for segment in result.segments:
        if segment.pieces:
            lasts[segment.began] = max(lasts.get(segment.began, 0.0), segment.pieces[-1].end)
    chosen = []
    for segment in result.segments:
        if not segment.pieces:
            continue
        begin, end = segment.pieces[0].begin, segment.pieces[-1].end
        whole = lasts[segment.began]
        if end == begin and whole > 0.0 and len(result.segments) > 1:
            continue
        count = 2 + int(np.ceil(SAMPLES * (end - begin) / whole)) if whole > 0.0 else 2
        points, index = [], 0
        for t in np.linspace(begin, end, count):
            while t > segment.pieces[index].end and index < len(segment.pieces) - 1:
                index += 1
            points.append((float(t), segment.pieces[index].state(t)))
        chosen.append((segment, points))
    return chosen
