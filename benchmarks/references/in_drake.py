"""Drake with a reference's robot: a plant in discrete time, with point contact as stiff as the step allows.

Of the solvers, stiffnesses and dissipations that were tried these come nearest to the references.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np
from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties, Sphere
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, DiscreteContactApproximation
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from spear_pin.arrays import Array

RADIUS = 1e-4  # m: of a foot
MASS = 1.0  # kg: a foot's stiffness is this by the square of the step
DISSIPATION = 20.0  # s/m, by Hunt and Crossley


class Drake:
    """The simulator of a problem."""

    def __init__(self, problem: Mapping[str, Any], step: float) -> None:
        logging.getLogger("drake").setLevel(logging.ERROR)
        robot, slope = problem["robot"], problem["ground"]["slope_rad"]
        builder = DiagramBuilder()
        plant, scene = AddMultibodyPlantSceneGraph(builder, step)
        Parser(plant).AddModelsFromString("".join(robot["urdf"]), "urdf")
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kTamsi)
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -problem["gravity_m_s2"]])
        joints = [plant.GetJointByName(name) for name in robot["coordinates"]]
        for joint in joints:
            if not plant.HasJointActuatorNamed(joint.name()):
                plant.AddJointActuator(joint.name(), joint)
            actuator = plant.GetJointActuatorByName(joint.name())
            actuator.set_default_rotor_inertia(robot["armature_kg_m2"][joint.name()])
            actuator.set_default_gear_ratio(1.0)
        material = ProximityProperties()
        friction = CoulombFriction(problem["ground"]["friction"], problem["ground"]["friction"])
        AddContactMaterial(DISSIPATION, MASS / step**2, friction, material)
        self.normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
        plane = RigidTransform(RollPitchYaw(0.0, -slope, 0.0), -RADIUS * self.normal)
        plant.RegisterCollisionGeometry(plant.world_body(), plane, HalfSpace(), "ground", material)
        self.feet = {foot: plant.GetBodyByName(foot) for foot in robot["feet"]}
        for foot, body in self.feet.items():
            plant.RegisterCollisionGeometry(body, RigidTransform(), Sphere(RADIUS), foot, material)
        plant.Finalize()
        self.plant, self.step_length = plant, step
        self.own = [joint.position_start() for joint in joints]
        self.simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        plant.get_actuation_input_port().FixValue(self.context, np.zeros(plant.num_actuators()))
        self.forces = np.zeros(plant.num_velocities())

    def set(self, q: Array, v: Array) -> None:
        there = np.zeros((2, len(q)))
        there[:, self.own] = q, v
        self.plant.SetPositions(self.context, there[0])
        self.plant.SetVelocities(self.context, there[1])
        self.simulator.Initialize()
        self.steps = 0

    def step(self, forces: Array) -> None:
        self.forces[self.own] = forces
        self.plant.get_applied_generalized_force_input_port().FixValue(self.context, self.forces)
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * self.step_length)

    def state(self) -> tuple[Array, Array]:
        positions, velocities = self.plant.GetPositions(self.context), self.plant.GetVelocities(self.context)
        return positions[self.own], velocities[self.own]

    def heights(self) -> dict[str, float]:
        places = {foot: self.plant.EvalBodyPoseInWorld(self.context, body) for foot, body in self.feet.items()}
        return {foot: float(self.normal @ place.translation()) for foot, place in places.items()}
