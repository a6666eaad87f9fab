"""Event feedback with gains of one's own, for tests."""

from dataclasses import replace

import numpy as np

from spear_pin.hybrid.event_feedback import EventFeedback, with_feedback


def fed(gait, inputs, gains, nominal=None, **options):
    """The gait with feedback to some inputs, compared with its own state if no other is given."""
    nominal = np.concatenate(gait.state) if nominal is None else nominal
    rows = tuple(tuple(map(float, row)) for row in gains)
    options = {"limits": (1e9,) * len(rows), **options}
    feedback = EventFeedback(tuple(inputs), rows, tuple(map(float, nominal)), **options)
    return replace(gait, system=with_feedback(gait.system, feedback))


def idle(gait, inputs=("posterior_hip_torque",)):
    """The gait with feedback that does nothing."""
    return fed(gait, inputs, np.zeros((len(inputs), 2 * gait.system.robot.nv)))
