"""Gaits with given footfalls by collocation, from a rough initial guess or from another gait."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.collocation import Progress, Solution, casadi, quadrature, resample
from spear_pin.gaits.footfalls.course import CollocatedGait, Stretch
from spear_pin.gaits.footfalls.in_space import in_space
from spear_pin.gaits.footfalls.obstacles import obstacle
from spear_pin.gaits.footfalls.programme import Transcription, impulse_name, transcribe
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.footfalls.sequence import LEGS
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot

PATIENCE = 500  # iterations; one that succeeds takes 40 to 250


@typed
def collocate(
    robot: Robot,
    request: FootfallRequest,
    *,
    start: Solution | None = None,
    meshes: Sequence[int] = (1,),
    iterations: int = PATIENCE,
    on_iteration: Progress | None = None,
) -> CollocatedGait:
    """Finds a gait that meets a request with a local minimum of its objective.

    Args:
        robot: a quadruped on a chain, such as `load("q_spear_full", base="chain")`, or another robot whose legs have
            adduction, hip and knee.
        request: the request for the gait.
        start: solution of another request as the initial guess. By default the search starts from a rough motion with
            the same footfalls; if the request has a law in the air, it first finds the gait without that law.
        meshes: factors by which the intervals of the footfalls are multiplied, one for each of several solves in turn.
        iterations: largest number of iterations of each solve.
        on_iteration: called with the optimiser's iteration, objective and largest violation.

    Raises:
        Infeasible: the optimiser found nothing; the error names the wish that a relaxed solve misses most.
        NoGait: the optimiser failed though every wish can be met.
        BadValue: the robot is not such a quadruped.
        MissingExtra: CasADi is not installed.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.footfalls.collocate import collocate
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest
        >>> robot = load("q_spear_full", base="chain")
        >>> trot = collocate(robot, FootfallRequest(speed=2.0))  # some seconds  # doctest: +SKIP
    """
    if not meshes or min(meshes) < 1:
        raise BadValue("meshes", meshes, "whole numbers, at least 1")
    solution, taken, built, solved = start, 0, 0.0, 0.0
    for stage in _stages(request, meshes, cold=start is None):
        begun = time.process_time()
        transcription = transcribe(in_space(robot, stage), None if solution is None else resample(solution))
        ready = time.process_time()
        solution = transcription.programme.solve(iterations=iterations, on_iteration=on_iteration)
        built, solved = built + ready - begun, solved + time.process_time() - ready
        taken += solution.iterations
        if not solution.success:
            raise obstacle(transcription, solution)
    assert solution is not None
    return _read(robot, stage, transcription, solution, taken, (built, solved))


def _stages(request: FootfallRequest, meshes: Sequence[int], *, cold: bool) -> list[FootfallRequest]:
    """Lists requests to solve in turn: without a start the law in the air is last; each mesh follows a coarser one."""
    first = replace(request, footfalls=request.footfalls.finer(meshes[0]), swing=None)
    wanted = [replace(request, footfalls=request.footfalls.finer(times)) for times in meshes]
    return [first, *wanted] if cold and request.swing is not None else wanted


def _read(
    robot: Robot,
    request: FootfallRequest,
    transcription: Transcription,
    solution: Solution,
    taken: int,
    seconds: tuple[float, float],
) -> CollocatedGait:
    room, programme, stretches, begun = transcription.room, transcription.programme, list[Stretch](), 0.0
    swings = transcription.evolutions_at(solution) or [{} for _ in room.names]
    for i, (nodes, torques) in enumerate(zip(transcription.phases, transcription.torques, strict=True)):
        bearing, ca = request.footfalls.phases[i], casadi()
        columns = [
            ca.vertcat(node.q, node.v, node.a, u, node.needed[-u.numel() :], *(node.F[leg] for leg in bearing))
            for node, u in zip(nodes, torques, strict=True)
        ]
        values = programme.read(ca.vec(ca.horzcat(*columns)), solution).reshape(len(nodes), -1)
        n, m = robot.nv, robot.nu
        q, v, a, u, needed, *forces = np.split(
            values, np.cumsum([n, n, n, m, m, *3 * np.ones(len(bearing), dtype=int)])[:-1], axis=1
        )
        lasting = transcription.number(transcription.durations[i], solution)
        struck = {leg: solution.values.get(impulse_name(room.names[i], leg)) for leg in LEGS}
        stretches.append(
            Stretch(
                bearing=bearing,
                t=begun + lasting * np.linspace(0.0, 1.0, len(nodes)),
                q=q,
                v=v,
                a=a,
                u=u,
                needed=needed,
                forces=dict(zip(bearing, forces, strict=False)),
                impulses={leg: impulse for leg, impulse in struck.items() if impulse is not None},
                evolutions=swings[i],
            )
        )
        begun += lasting
    constants: dict[str, Any] = {
        leg: tuple(transcription.number(part, solution) for part in parts)
        for leg, parts in transcription.constants.items()
    }
    aims = {leg: transcription.number(aim, solution) for leg, aim in transcription.aims.items()}
    distance = request.speed * sum(each.duration for each in stretches)
    effort = sum(quadrature(each.duration, [float(u @ u) for u in each.u]) for each in stretches) / distance
    return CollocatedGait(robot, request, tuple(stretches), constants, aims, effort, solution, taken, seconds)
