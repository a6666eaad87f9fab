"""MuJoCo as it comes: `mj_step` with its soft contact, and the law switched where the steps see a switch.

The toe is a sphere of a hundredth of a millimetre on a plane, the friction cone elliptic. Steps divide the half period
of the torque, so that its switch is exact; touchdown is interpolated, and the exact impact map is put in its place, so
that the ends can be compared. What remains is the contact's: a soft foot sinks, creeps, and bounces where it is hard,
so that it counts as lifted only above some height. These settings are the best of a search.
"""

from __future__ import annotations

import numpy as np

from benchmarks.peers.mujoco_exact import build, mujoco, plastic
from benchmarks.peers.task import STATES, Lane, Task
from spear_pin.arrays import Array

STANDARD = (0.9, 0.95, 0.001, 0.5, 2.0)  # MuJoCo's default impedance
HARD = (0.999, 0.9999, 1e-4, 0.5, 2.0)
SETTINGS = (  # steps a half period, time constant of solref or None for two steps, impedance, integrator, lifted above
    (200, 0.02, STANDARD, "euler", 1e-5),
    (200, None, HARD, "implicitfast", 1e-5),
    (2_000, 0.002, HARD, "implicitfast", 1e-6),
    (10_000, 0.002, HARD, "implicitfast", 1e-6),
)
INTEGRATORS = ("euler", "rk4", "implicit", "implicitfast")  # in the order of mjtIntegrator


def make(task: Task, steps: int, constant: float | None, impedance: tuple[float, ...], integrator: str, lifted: float):
    """A function that runs the hop from a state; when it ends, and where."""
    system = task.gait.system
    law, spring = system.law, system.spring
    half = 0.5 / law.frequency
    model = build(task, ground=True)
    model.opt.timestep = step = half / steps
    model.opt.integrator, model.opt.cone = INTEGRATORS.index(integrator), mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio, model.opt.tolerance = 10.0, 1e-12
    model.geom_solref[:] = (2.0 * step if constant is None else constant, 1.0)
    model.geom_solimp[:], model.geom_friction[:, 0] = impedance, system.contact.friction
    data, toe = mujoco.MjData(model), model.body("toe").id
    applied, q, v = data.qfrc_applied, data.qpos, data.qvel

    def run(start: Array) -> tuple[float, Array]:
        mujoco.mj_resetData(model, data)
        q[:], v[:] = start[:3], start[3:]
        latched, flying, before, seen = start[2], False, None, start
        for i in range(12 * steps):
            hip, knee = q[1], q[2]
            if flying:
                applied[1] = law.hip_gain * (0.5 * law.knee_touchdown - hip) - law.hip_damping * v[1]
                applied[2] = law.knee_gain * (law.knee_touchdown - knee) - law.knee_damping * v[2]
            else:
                sign = 1.0 if i < steps else -1.0
                applied[2] = sign * law.stance_torque - spring.damping * v[2]
                if knee > latched:
                    applied[2] -= spring.stiffness * (knee - latched)
            if flying and v[0] < 0.0:
                z = data.xpos[toe][2]  # of the last step's beginning
                if before is not None and z <= 0.0:
                    share = before[0] / (before[0] - z)
                    y = before[1] + share * (seen - before[1])
                    end = np.concatenate([y[:3], plastic(model, data, toe, y[:3], y[3:])])
                    return (i - 2 + share) * step, end
                before = (z, seen) if z > 0.0 else None
            seen = np.concatenate([q, v])
            mujoco.mj_step(model, data)
            flying = flying or (i > steps and data.xpos[toe][2] > lifted)
        return np.nan, np.full(6, np.nan)

    return run


def lanes(task: Task) -> list[Lane]:
    """One for each setting."""
    starts = np.concatenate([task.q, task.v], axis=1)[:STATES]

    def lane(steps: int, constant: float | None, impedance: tuple[float, ...], integrator: str, lifted: float) -> Lane:
        run = make(task, steps, constant, impedance, integrator, lifted)
        step = 0.5 / task.gait.system.law.frequency / steps
        settings = f"{integrator}, {1e3 * step:.2g} ms, solref {1e3 * (constant or 2.0 * step):.2g} ms"
        return Lane("MuJoCo's soft contact", settings, lambda: np.array([run(y)[1] for y in starts]))

    return [lane(*settings) for settings in SETTINGS]
