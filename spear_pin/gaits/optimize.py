"""Search for bounding gaits of least effort, or with another objective, by direct collocation.

The unknowns are the states, accelerations and ground forces at the nodes, the durations, the law's parameters and the
impulses. The dynamics are those of `model.planar`; the outputs and the stance law are those of the
simulation. The solution is then refined to a fixed point of the event-exact simulation. Every optimum is a local one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spear_pin.errors import BadValue, NoGait
from spear_pin.gaits.bounding import SPEED_BY, bounding
from spear_pin.gaits.collocation import Progress, Solution, resample
from spear_pin.gaits.footfalls.in_plane import in_plane, read
from spear_pin.gaits.footfalls.obstacles import obstacle
from spear_pin.gaits.footfalls.programme import Transcription, transcribe
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.request import Request
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.ground import as_ground
from spear_pin.hybrid.section import section
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot

COARSE, MESHES = 6, (10, 16)  # intervals of each phase, for initial guesses and for the final solves
# parameters to vary for the mean speed, which in some gaits does not depend on the first
POLISHED_BY = (SPEED_BY, "anterior_hip_torque", "anterior_leg_touchdown")
STRAYS = 0.2  # of a phase's time
ATTEMPTS, APART = 3, 1000  # number of initial guesses, and distance of their seeds
PATIENCE = 300  # iterations of each; one that succeeds takes 40 to 250


@typed
def search(
    robot: Robot,
    request: Request,
    *,
    seed: int = 0,
    start: Solution | None = None,
    contact: Contact | None = None,
    meshes: Sequence[int] = MESHES,
    on_iteration: Progress | None = None,
) -> tuple[Gait, Solution]:
    """Finds a locally optimal gait that meets the request, and that is a fixed point of the event-exact simulation.

    A search without a start first solves on a coarse mesh.

    Args:
        robot: Q-SPEAR in the sagittal plane, or another quadruped as `spear_pin.sagittal` cuts it.
        request: the request for the gait.
        seed: seed of the initial guess, where there is no start.
        start: solution of another request as the initial guess.
        contact: friction of the level ground in the simulation; the friction that the gait may use is in the request.
        meshes: numbers of intervals of each phase; the next is tried where the solution on one leads to no fixed point.
        on_iteration: called with the optimiser's iteration, objective and largest violation.

    Returns:
        the gait, and the optimiser's solution to start another search from.

    Raises:
        Infeasible: the optimiser found nothing; the error names the wish that a relaxed solve misses most.
        NoGait: the optimiser failed though every wish can be met, or its solution leads to no fixed point.
        MissingExtra: CasADi is not installed.
    """
    if not meshes or min(meshes) < 1:
        raise BadValue("meshes", meshes, "whole numbers, at least 1")
    if contact is not None and not as_ground(contact).plain:
        raise BadValue("contact", contact, "level ground at height zero, the only one that the search knows")
    ground = (contact or Contact()).friction
    if ground < request.friction:
        raise BadValue("contact.friction", ground, f"at least the request's, {request.friction}: give contact=")
    solution = start or _cold(robot, request, seed, on_iteration)
    for intervals in meshes:
        transcription = transcribe(in_plane(robot, request, intervals), resample(solution))
        solution = transcription.programme.solve(on_iteration=on_iteration)
        if not solution.success:
            raise obstacle(transcription, solution)
        try:
            return polish(robot, transcription, solution, contact), solution
        except NoGait:
            if intervals == meshes[-1]:
                raise
    raise AssertionError(meshes)


def _cold(robot: Robot, request: Request, seed: int, on_iteration: Progress | None) -> Solution:
    """Solves on a coarse mesh, in stages, from several initial guesses."""
    for attempt in range(ATTEMPTS):
        for way in ways(request):
            start = None
            for stage in way:
                transcription = transcribe(in_plane(robot, stage, COARSE, seed + attempt * APART), start)
                solution = transcription.programme.solve(iterations=PATIENCE, on_iteration=on_iteration)
                if not solution.success:
                    break
                start = resample(solution)
            if solution.success:
                return solution
    raise obstacle(transcription, solution)


def ways(request: Request) -> list[list[Request]]:
    """Lists ways to solve a request without a start; each way is a sequence of requests, from an easier one on.

    Effort is the easiest objective and leads to the others. A request without joint limits leads to one with limits.
    """
    easiest = request if request.objective == "violation" else replace(request, objective="effort_per_distance")
    slack = replace(easiest, within_limits=False)
    found = (easiest, request), (slack, easiest, request)
    return [list(dict.fromkeys(way)) for way in dict.fromkeys(found[: 1 if slack == easiest else 2])]


def polish(robot: Robot, transcription: Transcription, solution: Solution, contact: Contact | None = None) -> Gait:
    """Finds the fixed point of the event-exact simulation near a solution, at the solution's mean speed.

    Raises:
        NoGait: there is no fixed point nearby: a phase would differ by more than `STRAYS` of its time.
    """
    room = transcription.room
    law, (q, v), stiffness = read(transcription, solution)
    durations = zip(room.names, transcription.durations, strict=True)
    lasting = {phase: transcription.number(time, solution) for phase, time in durations}
    system = bounding(robot, law, replace(transcription.spring, stiffness=stiffness), contact)
    (q,), (v,) = section(system).placed(q[None], v[None], np.zeros(1, dtype=bool))
    failure = NoGait("nothing was tried", np.inf)
    for by in POLISHED_BY:
        try:
            gait = gait_beside(system, (q, v), [by], {"mean_speed": room.request.speed})
        except NoGait as error:
            failure = error
            continue
        strayed = [phase for phase, time in lasting.items() if abs(gait.durations[phase] - time) > STRAYS * time]
        if not strayed:
            q, v = gait.state
            return gait.with_law(nominal=(*q[1:].tolist(), *v.tolist()))
        own = f"its {strayed[0]} does not last {lasting[strayed[0]]:.3g} s"
        reason = f"the fixed point near the optimiser's solution is another gait: {own}"
        failure = NoGait(reason, gait.residual, remedy="a finer mesh, or another seed")
    raise failure
