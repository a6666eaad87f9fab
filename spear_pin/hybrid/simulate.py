"""Event-exact simulation of whole cycles, sampled into a `Trajectory`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, list_names, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.flow_names import booked_flows, electrical_flows, flow_names
from spear_pin.hybrid.integration import Motion
from spear_pin.hybrid.result import Moment, Options, Run, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.sampling import Sampler
from spear_pin.hybrid.trajectory import Ledger, Trajectory
from spear_pin.kinds import typed
from spear_pin.model.origin import origin

SAMPLES = 100  # least number of samples of a phase
ENGINES = REFERENCE, COMPILED = "reference", "compiled"


@typed
def simulate(
    system: HybridSystem,
    state: State | Moment,
    cycles: int = 1,
    rtol: float = 1e-9,
    *,
    atol: float | None = None,
    max_evaluations: int = 2_000_000,
    max_step: float | None = None,
    samples: int = SAMPLES,
    progress: bool = True,
    sample_time: float | None = None,
    latency: float = 0.0,
    engine: Literal["reference", "compiled"] | None = None,
) -> Trajectory:
    """Simulates whole cycles from a state on the section, or in the air before the first touchdown.

    A fall, a Zeno point or a numerical failure ends the trajectory with a `reason`.

    Args:
        system: robot, law and ground.
        state: (q, v), or a moment of another run.
        cycles: number of whole cycles, from section to section.
        rtol: relative tolerance of the integrator, see `Options`.
        atol: absolute tolerance; None means 0.01 rtol.
        max_evaluations: most evaluations of right-hand sides.
        max_step: longest step of the integrator, in s, for laws that act for a shorter time than its steps; None leaves
            it to the integrator, which takes 0.05 s at most.
        samples: least number of samples of each phase, evenly spaced in time. They take most of a long run's memory.
        sample_time: time from sample to sample of a law that a computer runs, in s; between samples torques stay as
            they are. The law reads what events latch at its next sample. None for a continuous law.
        latency: time from a sample until its torques act, in s.
        progress: whether to show a progress bar on long runs, if stderr is a terminal.
        engine: "reference" integrates by SciPy. "compiled" integrates by heyoka's Taylor series, with a tolerance a
            thousand times finer than `rtol`, without `atol`; it takes half the time, once some seconds were spent to
            compile. What is rare, such as chatter, it leaves to the reference. None: "reference".

    Raises:
        BadValue: a tolerance, the number of cycles or samples, or the state is not valid; or the system has hardware,
            dry friction of joints, a sampled law or a `max_step`, and so cannot be compiled.
        MissingExtra: "compiled" needs heyoka.

    Example:
        >>> from spear_pin import hopping, load, simulate
        >>> system = hopping(load("spear_ii", locked=["boom_x"]))
        >>> simulate(system, system.guess(), cycles=2)
        Trajectory('spear_ii': 2 cycles, 1.139 s, 420 samples, 10 events, complete)
    """
    require("samples", samples, lambda n: n >= 1 and n % 1 == 0, "a whole number, at least 1")
    if engine not in (None, *ENGINES):
        raise BadValue("engine", engine, f"None, or one of {list_names(ENGINES)}")
    from tqdm import tqdm

    sampler = Sampler(system, int(samples))
    options = Options(
        rtol, atol, max_evaluations, keep=True, max_step=max_step, sample_time=sample_time, latency=latency
    )
    integrate = (_compiled(system, options),) if engine == COMPILED else ()
    with tqdm(total=cycles, unit="cycle", delay=1.0, disable=None if progress else True, leave=False) as bar:
        result = run(system, state, cycles, options, lambda n: bar.update(1), sampler.add, *integrate)
    return _trajectory(system, result, sampler)


def _compiled(system: HybridSystem, options: Options) -> Callable[..., Motion]:
    """Returns what integrates by compiled code."""
    from spear_pin.hybrid.compiled_motion import CompiledMotion  # takes long to import

    if options.sample_time is not None or options.max_step is not None:
        raise BadValue("engine", COMPILED, f"{REFERENCE} where there is a sample_time or a max_step")
    return CompiledMotion(system, options.rtol)


def sample(system: HybridSystem, result: Run, samples: int = SAMPLES) -> Trajectory:
    """Samples a run that was kept, as `simulate` does."""
    sampler = Sampler(system, samples)
    for segment in result.segments:
        sampler.add(segment)
    return _trajectory(system, result, sampler)


def _trajectory(system: HybridSystem, result: Run, sampler: Sampler) -> Trajectory:
    ledger, electrical = _ledgers(system, result)
    robot = system.robot
    remembered = len(system.hardware.names) if system.hardware is not None else 0
    reached = np.concatenate([*result.state, np.zeros(remembered + len(flow_names(system)))])
    return Trajectory(
        robot=robot.source,
        coordinates=robot.coordinates,
        actuated=robot.actuated,
        toes=robot.toes,
        spring_joints=sampler.springs,
        **sampler.arrays(reached),
        events=tuple(result.events),
        ledger=ledger,
        cycles=result.cycles,
        reason=result.reason,
        message=result.message,
        evaluations=result.evaluations,
        electrical=electrical,
        ground=system.ground,
        origin=origin(robot),
        springs=sampler.by_path,
    )


def _ledgers(system: HybridSystem, result: Run) -> tuple[Ledger, Ledger | None]:
    """Returns the ledgers of the mechanism and of its drives: battery = joule + gearbox + motors + inductances."""
    flows = (*flow_names(system), *booked_flows(system))
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
