"""Search for bounding gaits of least effort, or with another objective, by direct collocation.

The unknowns are the states, accelerations, swing torques and ground forces at the nodes, the durations, the law's
parameters and the impulses. The dynamics are those of `model.planar`; the outputs and the stance law are those of the
simulation. The solution is then refined to a fixed point of the event-exact simulation. Every optimum is a local one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, Infeasible, NoGait
from spear_pin.gaits.bounding import SPEED_BY, bounding
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.bounding_programme import Transcription, transcribe
from spear_pin.gaits.collocation import Progress, Solution, resampled
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.request import Request
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.ground import as_ground
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot

COARSE, MESHES = 6, (10, 16)  # intervals of each phase, for initial guesses and for the final solves
# parameters to vary for the mean speed, which in some gaits does not depend on the first
POLISHED_BY = (SPEED_BY, "anterior_hip_torque", "anterior_leg_touchdown")
STRAYS = 0.2  # of a phase's time
ATTEMPTS, APART = 3, 1000  # number of initial guesses, and distance of their seeds
PATIENCE = 300  # iterations of each; one that succeeds takes 40 to 250
MET = 1e-5  # relative to a wish's scale: a wish with a smaller miss is met
SLIPPED, SLOWER = 1.25, 0.9  # factors on the requested friction and speed
# wishes, by how their labels begin, and what to try where one is missed most: of the request and by how much it is
REMEDIES: Mapping[str, Callable[[Request, float], str]] = {
    "mean speed": lambda asked, by: f"speed={max(asked.speed - by, 0.5 * asked.speed):.3g}",
    "duration of the stride": lambda asked, by: f"minimum_stride={max(asked.minimum_stride - by, 0.0):.3g}",
    "friction": lambda asked, by: f"friction={SLIPPED * asked.friction:.2g}{_less_bent(asked)}",
    "normal force": lambda asked, by: f"minimum_force={max(asked.minimum_force - by, 0.0):.3g}",
    "clearance": lambda asked, by: f"clearance={max(asked.clearance - by, 0.0):.2g}",
    "speed": lambda asked, by: f"a gearbox of a smaller ratio, or speed={SLOWER * asked.speed:.3g}",
    "envelope": lambda asked, by: f"a stronger motor, another ratio{_free_spring(asked)}, or a slower speed",
    "torque": lambda asked, by: f"{_stronger(asked, by)}speed={SLOWER * asked.speed:.3g}",
}


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
        transcription = transcribe(robot, request, intervals, start=resampled(solution))
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
                transcription = transcribe(robot, stage, COARSE, seed=seed + attempt * APART, start=start)
                solution = transcription.programme.solve(iterations=PATIENCE, on_iteration=on_iteration)
                if not solution.success:
                    break
                start = resampled(solution)
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
    law, state, stiffness = transcription.read(solution)
    durations = transcription.durations.items()
    lasting = {phase: float(transcription.programme.read(time, solution)[0]) for phase, time in durations}
    system = bounding(robot, law, transcription.request.spring(stiffness), contact)
    state = _on_ground(robot, ("posterior_toe",), state)
    failure = NoGait("nothing was tried", np.inf)
    for by in POLISHED_BY:
        try:
            gait = gait_beside(system, state, [by], {"mean_speed": transcription.request.speed})
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


def obstacle(transcription: Transcription, solution: Solution) -> Infeasible | NoGait:
    """Finds the obstacle to a request: the wish that a relaxed solve misses most, counted in its scale."""
    relaxed, margins = transcription.programme.relaxed(resampled(solution))
    loosened = relaxed.solve(iterations=300)
    if not loosened.success:
        reason = f"the optimiser ended with {solution.status} and its relaxed search with {loosened.status}"
        return _stopped(reason, solution, f"speed={SLOWER * transcription.request.speed:.3g}, or another seed")
    missed = {label: float(loosened.values[margin.unknown][0]) for label, margin in margins.items()}
    worst = max(missed, key=lambda label: missed[label])
    if missed[worst] < MET:
        reason = f"the optimiser ended with {solution.status}, though every wish can be met"
        return _stopped(reason, solution, "another seed")
    by = missed[worst] * margins[worst].scale
    return Infeasible(worst, by, margins[worst].unit, remedy(transcription.request, worst, by))


def _stopped(reason: str, solution: Solution, remedy: str) -> NoGait:
    """Returns the error for a search that ended without a wish to blame: it names the worst violation at the end."""
    worst = max(solution.violations, key=lambda label: solution.violations[label])
    return NoGait(reason, solution.violations[worst], f"its last iterate misses {worst!r} most", remedy)


def remedy(request: Request, wish: str, missed: float) -> str:
    """Suggests one thing to try where a wish is missed; returns empty text where nothing is known.

    Args:
        request: the request that has the wish.
        wish: label of the wish.
        missed: by how much the wish is missed, in its unit.
    """
    known = (say for begin, say in REMEDIES.items() if wish.startswith(begin))
    return next((say(request, missed) for say in known), "")


def _less_bent(request: Request) -> str:
    """Suggests a straighter knee at touchdown, which strikes the ground less at a slant, where its angle is given."""
    bent = request.knee_touchdown
    return "" if bent is None else f" or a smaller knee_touchdown than {bent:.3g}"


def _free_spring(request: Request) -> str:
    return "" if request.stiffness is None else ", stiffness=None, which leaves it free"


def _stronger(request: Request, missed: float) -> str:
    """Suggests more hip torque, which the request counts by pairs of legs, where it is bounded."""
    return "" if request.hip_torque is None else f"hip_torque={request.hip_torque + PAIR * missed:.3g} or "


def _on_ground(robot: Robot, toes: tuple[str, ...], state: tuple[Array, Array]) -> tuple[Array, Array]:
    """Returns the state with the toes exactly on the ground and at rest."""
    q, v = state
    rows = np.vstack([robot.toe_jacobian(q, toe) for toe in toes])
    for _ in range(5):
        heights = np.array([robot.toe_position(q, toe)[1] for toe in toes])
        q = q - np.linalg.pinv(rows[1::2]) @ heights
        rows = np.vstack([robot.toe_jacobian(q, toe) for toe in toes])
    return q, v - np.linalg.pinv(rows) @ (rows @ v)
