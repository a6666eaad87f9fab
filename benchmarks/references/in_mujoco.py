"""MuJoCo with a reference's robot: soft contact, with numbers that were the best of those tried at both steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from spear_pin.arrays import Array

RADIUS = 1e-5  # m: of a foot
CONSTANT, RATIO = 2e-3, 5.0  # s, 1: of `solref`; damping that is not supercritical lets feet bounce


class MuJoCo:
    """The simulator of a problem."""

    def __init__(self, problem: Mapping[str, Any], step: float) -> None:
        robot, slope = problem["robot"], problem["ground"]["slope_rad"]
        spec = mujoco.MjSpec.from_string("".join(robot["urdf"]))
        spec.compiler.fusestatic = False
        spec.compiler.boundmass = spec.compiler.boundinertia = 1e-14  # of links without inertia
        for joint in spec.joints:
            joint.armature = robot["armature_kg_m2"][joint.name]
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
        self.normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
        turn = [np.cos(0.5 * slope), 0.0, -np.sin(0.5 * slope), 0.0]
        plane = {"type": mujoco.mjtGeom.mjGEOM_PLANE, "size": [50.0, 50.0, 1.0], "quat": turn}
        spec.worldbody.add_geom(**plane, pos=(-RADIUS * self.normal).tolist(), contype=1, conaffinity=0)
        for foot in robot["feet"]:
            sphere = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [RADIUS, 0.0, 0.0], "mass": 0.0}
            spec.body(foot).add_geom(**sphere, contype=0, conaffinity=1)
        model = spec.compile()
        model.opt.timestep, model.opt.integrator = step, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        model.opt.cone, model.opt.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10.0
        model.opt.tolerance, model.opt.gravity[:] = 1e-12, [0.0, 0.0, -problem["gravity_m_s2"]]
        model.geom_solref[:], model.geom_solimp[:] = (CONSTANT, RATIO), (0.999, 0.9999, 1e-4, 0.5, 2.0)
        model.geom_friction[:, 0] = problem["ground"]["friction"]
        self.model, self.data = model, mujoco.MjData(model)
        self.own = [model.joint(name).qposadr[0] for name in robot["coordinates"]]
        self.feet = {foot: model.body(foot).id for foot in robot["feet"]}

    def set(self, q: Array, v: Array) -> None:
        self.data.qpos[self.own], self.data.qvel[self.own] = q, v

    def step(self, forces: Array) -> None:
        self.data.qfrc_applied[self.own] = forces
        mujoco.mj_step(self.model, self.data)

    def state(self) -> tuple[Array, Array]:
        return self.data.qpos[self.own].copy(), self.data.qvel[self.own].copy()

    def heights(self) -> dict[str, float]:
        mujoco.mj_kinematics(self.model, self.data)
        return {foot: float(self.normal @ self.data.xpos[body]) for foot, body in self.feet.items()}
