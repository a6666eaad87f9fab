"""Drake: the hop as a `LeafSystem` in Python with witness functions, run by its `Simulator`.

A `MultibodyPlant` of the URDF answers with mass matrix, bias, Jacobian and drift; its own contact is compliant, so that
an exact foot is held here by solving for its force. Every guard is a witness function; its event changes the phase,
touchdown's also the velocity. The Simulator isolates a witness to a hundredth of the accuracy, by shorter and shorter
steps. Runge-Kutta 5 is the method of highest order that Drake controls the error of. Or the same right-hand sides
under SciPy's DOP853.
"""

from __future__ import annotations

import numpy as np

from benchmarks.peers.drake_system import RISE, STANCE, LeafSystem, make
from benchmarks.peers.mujoco_exact import RTOL, adaptive
from benchmarks.peers.task import STATES, Absent, Lane, Task
from spear_pin.arrays import Array

try:
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
except ImportError:
    ResetIntegratorFromFlags = Simulator = None

ACCURACIES = (1e-6, 1e-8)


def simulated(hopper, accuracy: float):
    """A function that runs the hop from a state by the Simulator; when it ends, and where."""
    simulator = Simulator(hopper)
    ResetIntegratorFromFlags(simulator, "runge_kutta5", 0.05).set_target_accuracy(accuracy)
    context = simulator.get_mutable_context()
    context.SetAccuracy(accuracy)

    def run(y: Array) -> tuple[float, Array]:
        half = 0.5 / hopper.law.frequency
        context.SetTime(0.0)
        context.SetContinuousState(y)
        hopper.phase, hopper.latched = STANCE, y[2]
        for hopper.sign, end in ((1.0, half), (-1.0, 5.0)):
            simulator.Initialize()
            simulator.AdvanceTo(end)
        return context.get_time(), hopper.state(context)

    return run


def bare(hopper):
    """A function that runs the hop from a state by DOP853."""

    def run(y: Array) -> Array:
        t, half = 0.0, 0.5 / hopper.law.frequency
        hopper.phase, hopper.latched = STANCE, y[2]
        for hopper.sign, end in ((1.0, half), (-1.0, 2.0 * half)):
            y, t = adaptive(hopper.acceleration, y, t, end, hopper.cone)
        hopper.begin_to_slip(y)
        y, t = adaptive(hopper.acceleration, y, t, 2.0 * half, hopper.normal)
        hopper.phase = RISE
        y, t = adaptive(hopper.acceleration, y, t, 5.0, lambda y: y[3])
        return hopper.struck(adaptive(hopper.acceleration, y, t, 5.0, hopper.height)[0])

    return run


def lanes(task: Task) -> list[Lane]:
    """One for each accuracy of the Simulator, and one without it."""
    if LeafSystem is None:
        raise Absent("drake is not installed")
    starts = np.concatenate([task.q, task.v], axis=1)[:STATES]

    def lane(name: str, settings: str, run) -> Lane:
        return Lane(name, settings, lambda: np.array([run(y) for y in starts]))

    def ends(run):
        return lambda y: run(y)[1]

    found = [
        lane("Drake, witness functions in Python", f"Runge-Kutta 5, accuracy {a:.0e}", ends(simulated(make(task), a)))
        for a in ACCURACIES
    ]
    return [*found, lane("Drake's dynamics, SciPy's events", f"DOP853, rtol {RTOL:.0e}", bare(make(task)))]
