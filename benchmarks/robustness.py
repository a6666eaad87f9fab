"""Measures how feedback holds altered robots: `python -m benchmarks.robustness`.

Feedback is found for `long_stride` on Q-SPEAR as it ships, for one input per stride and for ten with the heading kept.
It then acts on robots with another roll inertia of the torso, hip spacing, or gains of the adductions in stance. The
gait does not depend on these. For each robot it gives the largest lateral multiplier without feedback and with either,
and what ten inputs leave of a push in ten strides.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.markdown import begin, row
from benchmarks.overlap import HEADING, PUSH, left_of
from spear_pin import Gait, SpatialLaw, load
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.linear import Linear, linear
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.event_feedback import EventFeedback, feedback_of, with_feedback
from spear_pin.hybrid.periodic import eigenvalues, residual
from spear_pin.model.robot import Robot

HEADS = "changed | fall sideways | with one input | with ten, and heading | left of a push"
CASES = {
    "nothing": (1.0, 1.0, 1.0),
    "roll inertia -20 %": (0.8, 1.0, 1.0),
    "roll inertia +20 %": (1.2, 1.0, 1.0),
    "hip spacing -10 %": (1.0, 0.9, 1.0),
    "hip spacing +10 %": (1.0, 1.1, 1.0),
    "adduction gains -30 %": (1.0, 1.0, 0.7),
    "adduction gains +30 %": (1.0, 1.0, 1.3),
}
"""Factors of roll inertia, hip spacing, and of stiffness and damping of the adductions."""
ONE = ("posterior_adduction",)


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    shipped = straight(*CASES["nothing"])
    held = add_feedback(shipped, ONE), add_feedback(shipped, ACROSS, heading=HEADING)
    designs = [each for gait in held if (each := feedback_of(gait.system)) is not None]
    begin(*HEADS.split(" | "))
    for name, factors in CASES.items():
        row(name, _row(straight(*factors), designs))


def straight(inertia: float, spacing: float, gains: float) -> Gait:
    """`long_stride` in space, of a robot with other numbers; factors as of `CASES`."""
    plane = Gait.load("long_stride")
    law = SpatialLaw(plane.system.law)
    law = replace(law, **{name: gains * getattr(law, name) for name in ("adduction_stiffness", "adduction_damping")})
    system, state = embed(plane, law, varied(load("q_spear_full", base="chain"), inertia, spacing))
    return Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})


def varied(robot: Robot, inertia: float, spacing: float) -> Robot:
    """The robot with its torso's moment of inertia in roll, and the distance between left and right, times factors."""
    model = robot.model.copy()
    torso = model.inertias[model.getJointId("roll")]
    moments = torso.inertia.copy()
    moments[0, 0] *= inertia
    torso.inertia = moments
    for joint, name in enumerate(model.names):
        if name.endswith("_adduction"):
            model.jointPlacements[joint].translation[1] *= spacing
    return robot.with_model(model)


def _row(gait: Gait, designs: list[EventFeedback]) -> str:
    across = linear(gait, ACROSS, lateral=True, heading=True)
    alone = np.abs(eigenvalues(across.A[:-1, :-1])).max()
    one, ten = (np.abs(eigenvalues(closed(across.of(each.inputs), each))) for each in designs)
    heading_free = np.sort(one)[:-1].max()  # without that of the heading, 1
    left = left_of(replace(gait, system=with_feedback(gait.system, designs[1])), PUSH)
    return f"{alone:.3f} | {heading_free:.3f} | {ten.max():.3f} | {left}"


def closed(across: Linear, feedback: EventFeedback) -> NDArray[np.float64]:
    """A of motion across with feedback, which may be another robot's."""
    return np.asarray(across.A + across.B @ np.array(feedback.gains) @ np.linalg.pinv(across.coordinates), np.float64)


if __name__ == "__main__":
    main()
