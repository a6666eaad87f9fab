"""MuJoCo for the dynamics, event-exact: as one writes it who knows MuJoCo and needs the exact hybrid model.

`mj_forward` with motors and spring in `qfrc_applied` gives the free acceleration, `mj_solveM` M⁻¹Jᵀ; the foot on the
ground is held by solving for its force, as MuJoCo's own constraints are soft. Contacts are switched off. Own RK4 with a
fixed step; a step in which a guard falls is shortened until it ends on the event. Or the same right-hand sides under
SciPy's DOP853, which takes longer steps. The impact map is plastic, exact.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from benchmarks.peers.task import STATES, Absent, Lane, Task
from spear_pin.arrays import Array
from spear_pin.model.loading import ROBOTS

try:
    import mujoco
except ImportError:
    mujoco = None

STEPS = (5e-3, 2e-3, 1e-3)  # s
RTOL = 1e-8
Motion = Callable[[Array], Array]


def build(task: Task, ground: bool = False):
    """The URDF as MuJoCo's model with x locked, rotors as armature; with a ground, a toe that touches it."""
    if mujoco is None:
        raise Absent("mujoco is not installed")
    robot = task.gait.system.robot
    spec = mujoco.MjSpec.from_file(str(ROBOTS["spear_ii"].path))
    spec.compiler.fusestatic = False
    spec.compiler.boundmass = spec.compiler.boundinertia = 1e-14  # the massless carriage and toe
    for joint in list(spec.joints):
        if joint.name not in robot.coordinates:
            spec.delete(joint)
        else:
            joint.armature = robot.model.armature[robot.index(joint.name)]
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
    for geom in list(spec.geoms):
        spec.delete(geom)
    if ground:
        radius = 1e-5
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5.0, 5.0, 1.0], pos=[0.0, 0.0, -radius])
        spec.body("toe").add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0.0, 0.0], mass=0.0)
    else:
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model = spec.compile()
    assert [model.joint(i).name for i in range(model.njnt)] == list(robot.coordinates)
    return model


def plastic(model, data, toe: int, q: Array, v: Array) -> Array:
    """Velocity after an impact that leaves the toe at rest."""
    data.qpos[:], data.qvel[:] = q, v
    mujoco.mj_forward(model, data)
    jacobian, mass_matrix = np.zeros((3, 3)), np.zeros((3, 3))
    mujoco.mj_jacBody(model, data, jacobian, None, toe)
    mujoco.mj_fullM(model, data, mass_matrix)
    rows = jacobian[::2]
    response = np.linalg.solve(mass_matrix, rows.T)
    return v - response @ np.linalg.solve(rows @ response, rows @ v)


class Hopper:
    """One hop from a state to the next; without a step by DOP853."""

    def __init__(self, task: Task, step: float | None) -> None:
        system = task.gait.system
        self.model, self.step = build(task), step
        self.data, self.toe = mujoco.MjData(self.model), self.model.body("toe").id
        self.law, self.spring, self.friction = system.law, system.spring, system.contact.friction
        self.jacobian, self.rate = np.zeros((3, 3)), np.zeros((3, 3))
        self.response = np.zeros((2, 3))
        self.hip = 0.5 * self.law.knee_touchdown
        self.latched, self.sign, self.side = 0.0, 1.0, 1.0

    def free(self, y: Array, hip: float, knee: float) -> Array:
        """Acceleration without the ground."""
        data = self.data
        data.qpos[:], data.qvel[:] = y[:3], y[3:]
        data.qfrc_applied[1], data.qfrc_applied[2] = hip, knee
        mujoco.mj_forward(self.model, data)
        return data.qacc

    def ground(self, y: Array) -> tuple[Array, Array, Array]:
        """Free acceleration in stance, J, and the toe's acceleration under it."""
        spring, deflection = self.spring, y[2] - self.latched
        knee = self.sign * self.law.stance_torque - spring.damping * y[5]
        if deflection > 0.0:
            knee -= spring.stiffness * deflection
        a = self.free(y, self.law.hip_stance_torque, knee)
        mujoco.mj_jacBody(self.model, self.data, self.jacobian, None, self.toe)
        mujoco.mj_jacDot(self.model, self.data, self.rate, None, self.data.xpos[self.toe], self.toe)
        rows = self.jacobian[::2]
        return a, rows, rows @ a + self.rate[::2] @ y[3:]

    def stick(self, y: Array) -> tuple[Array, Array]:
        a, rows, toe = self.ground(y)
        mujoco.mj_solveM(self.model, self.data, self.response, np.ascontiguousarray(rows))
        (xx, xz), (_, zz) = (rows @ self.response.T).tolist()
        x, z = toe.tolist()
        det = xx * zz - xz * xz
        force = np.array([(xz * z - zz * x) / det, (xz * x - xx * z) / det])
        return a + force @ self.response, force

    def slip(self, y: Array) -> tuple[Array, float]:
        a, rows, toe = self.ground(y)
        push = np.ascontiguousarray((rows[1] - self.side * self.friction * rows[0])[None])
        mujoco.mj_solveM(self.model, self.data, self.response[:1], push)
        normal = -toe[1] / (rows[1] @ self.response[0])
        return a + normal * self.response[0], normal

    def fly(self, y: Array) -> Array:
        law = self.law
        hip = law.hip_gain * (self.hip - y[1]) - law.hip_damping * y[4]
        return self.free(y, hip, law.knee_gain * (law.knee_touchdown - y[2]) - law.knee_damping * y[5])

    def cone(self, y: Array) -> float:
        tangential, normal = self.stick(y)[1]
        return self.friction * normal - abs(tangential)

    def height(self, y: Array) -> float:
        self.data.qpos[:] = y[:3]
        mujoco.mj_kinematics(self.model, self.data)
        return self.data.xpos[self.toe][2]

    def advance(self, motion: Motion, y: Array, t: float, end: float, guard: Callable[[Array], float] | None = None):
        """Steps to a time, or to where a guard falls."""
        if self.step is None:
            return adaptive(motion, y, t, end, guard)
        while t < end - 1e-12:
            h = min(self.step, end - t)
            ahead = runge_kutta(motion, y, h)
            if guard is not None and guard(ahead) <= 0.0:
                h = brentq(lambda h, y=y: guard(runge_kutta(motion, y, h)), 1e-9 * h, h, xtol=1e-13, rtol=1e-14)
                return runge_kutta(motion, y, h), t + h
            y, t = ahead, t + h
        return y, t

    def hop(self, y: Array) -> Array:
        self.latched, self.sign, half = y[2], 1.0, 0.5 / self.law.frequency

        def sticking(y: Array) -> Array:
            return self.stick(y)[0]

        y, t = self.advance(sticking, y, 0.0, half, self.cone)
        self.sign = -1.0
        y, t = self.advance(sticking, y, t, 2.0 * half, self.cone)
        self.side = -float(np.sign(self.stick(y)[1][0]))
        y, t = self.advance(lambda y: self.slip(y)[0], y, t, 2.0 * half, lambda y: self.slip(y)[1])
        y, t = self.advance(self.fly, y, t, 5.0, lambda y: y[3])  # the toe is on the ground before the apex, too
        y, t = self.advance(self.fly, y, t, 5.0, self.height)
        return np.concatenate([y[:3], plastic(self.model, self.data, self.toe, y[:3], y[3:])])


def runge_kutta(motion: Motion, y: Array, h: float) -> Array:
    def slope(y: Array) -> Array:
        return np.concatenate([y[3:], motion(y)])

    k1 = slope(y)
    k2 = slope(y + 0.5 * h * k1)
    k3 = slope(y + 0.5 * h * k2)
    k4 = slope(y + h * k3)
    return y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)


def adaptive(motion: Motion, y: Array, t: float, end: float, guard: Callable[[Array], float] | None):
    def event(t: float, y: Array) -> float:
        return guard(y)

    event.terminal, event.direction = True, -1.0
    events = None if guard is None else event
    method = {"method": "DOP853", "rtol": RTOL, "atol": 0.01 * RTOL}
    result = solve_ivp(lambda t, y: np.concatenate([y[3:], motion(y)]), (t, end), y, events=events, **method)
    return result.y[:, -1], result.t[-1]


def lanes(task: Task) -> list[Lane]:
    """One for each step, and the adaptive one."""
    starts = np.concatenate([task.q, task.v], axis=1)[:STATES]

    def lane(step: float | None) -> Lane:
        hopper = Hopper(task, step)
        settings = f"DOP853, rtol {RTOL:.0e}" if step is None else f"RK4, {1e3 * step:g} ms"
        return Lane("MuJoCo's dynamics, exact events", settings, lambda: np.array([hopper.hop(y) for y in starts]))

    return [lane(step) for step in (*STEPS, None)]
