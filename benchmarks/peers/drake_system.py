"""The hop as Drake's `LeafSystem` in Python: a `MultibodyPlant` for the dynamics, a witness function for each guard."""

from __future__ import annotations

import logging

import numpy as np

from benchmarks.peers.task import Task
from spear_pin.arrays import Array
from spear_pin.model.loading import ROBOTS

try:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import JacobianWrtVariable
    from pydrake.systems.framework import EventStatus, LeafSystem, UnrestrictedUpdateEvent, WitnessFunctionDirection
except ImportError:
    LeafSystem = None

STANCE, SLIP, RISE, FALL = range(4)
MOVING = slice(1, 4)  # of the plant's coordinates: x, the first, stays at zero


def make(task: Task):
    """The system."""

    class Hopper(LeafSystem):
        """The phase and what is latched are kept here: one context is made of it."""

        def __init__(self) -> None:
            super().__init__()
            system = task.gait.system
            self.law, self.spring, self.friction = system.law, system.spring, system.contact.friction
            logging.getLogger("drake").setLevel(logging.ERROR)  # it warns that it ignores <mechanicalReduction>
            self.plant = MultibodyPlant(0.0)
            Parser(self.plant).AddModels(str(ROBOTS["spear_ii"].path))
            self.plant.Finalize()
            self.inner = self.plant.CreateDefaultContext()
            self.toe, self.world = self.plant.GetFrameByName("toe"), self.plant.world_frame()
            self.full, self.tau = np.zeros(8), np.zeros(3)
            self.phase, self.sign, self.side, self.latched = STANCE, 1.0, 1.0, 0.0
            self.DeclareContinuousState(3, 3, 0)
            self.guards = {
                STANCE: [self.watch("cone", self.cone, self.slips)],
                SLIP: [self.watch("normal force", self.normal, self.lifts)],
                RISE: [self.watch("apex", lambda y: y[3], self.falls)],
                FALL: [self.watch("height", self.height, self.strikes)],
            }

        def watch(self, name, value, happen):
            falls = WitnessFunctionDirection.kPositiveThenNonPositive
            event = UnrestrictedUpdateEvent(happen)
            return self.MakeWitnessFunction(name, falls, lambda context: value(self.state(context)), event)

        def DoGetWitnessFunctions(self, context):  # noqa: N802
            return self.guards[self.phase]

        def DoCalcTimeDerivatives(self, context, derivatives):  # noqa: N802
            y = self.state(context)
            derivatives.get_mutable_vector().SetFromVector(np.concatenate([y[3:], self.acceleration(y)]))

        def acceleration(self, y: Array) -> Array:
            if self.phase == STANCE:
                return self.stick(y)[0]
            if self.phase == SLIP:
                return self.slip(y)[0]
            law = self.law
            self.tau[1] = law.hip_gain * (0.5 * law.knee_touchdown - y[1]) - law.hip_damping * y[4]
            self.tau[2] = law.knee_gain * (law.knee_touchdown - y[2]) - law.knee_damping * y[5]
            self.place(y)
            return np.linalg.solve(*self.dynamics())

        def state(self, context) -> Array:
            return context.get_continuous_state_vector().CopyToVector()

        def place(self, y: Array) -> None:
            self.full[1:4], self.full[5:8] = y[:3], y[3:]
            self.plant.SetPositionsAndVelocities(self.inner, self.full)

        def dynamics(self) -> tuple[Array, Array]:
            plant, inner = self.plant, self.inner
            bias = plant.CalcBiasTerm(inner) - plant.CalcGravityGeneralizedForces(inner)
            return plant.CalcMassMatrix(inner)[MOVING, MOVING], self.tau - bias[MOVING]

        def jacobian(self) -> Array:
            v, world = JacobianWrtVariable.kV, self.world
            rows = self.plant.CalcJacobianTranslationalVelocity(self.inner, v, self.toe, np.zeros(3), world, world)
            return rows[::2, MOVING]

        def ground(self, y: Array) -> tuple[Array, Array, Array, Array]:
            """Mass matrix, forces, J and J̇v in stance."""
            self.place(y)
            deflection = y[2] - self.latched
            self.tau[1] = self.law.hip_stance_torque
            self.tau[2] = self.sign * self.law.stance_torque - self.spring.damping * y[5]
            if deflection > 0.0:
                self.tau[2] -= self.spring.stiffness * deflection
            v, world = JacobianWrtVariable.kV, self.world
            drift = self.plant.CalcBiasTranslationalAcceleration(self.inner, v, self.toe, np.zeros(3), world, world)
            return *self.dynamics(), self.jacobian(), drift[::2, 0]

        def stick(self, y: Array) -> tuple[Array, Array]:
            mass_matrix, forces, rows, drift = self.ground(y)
            matrix = np.zeros((5, 5))
            matrix[:3, :3], matrix[:3, 3:], matrix[3:, :3] = mass_matrix, -rows.T, rows
            solution = np.linalg.solve(matrix, np.concatenate([forces, -drift]))
            return solution[:3], solution[3:]

        def slip(self, y: Array) -> tuple[Array, float]:
            mass_matrix, forces, rows, drift = self.ground(y)
            push = rows[1] - self.side * self.friction * rows[0]
            free, response = np.linalg.solve(mass_matrix, np.array([forces, push]).T).T
            normal = -(rows[1] @ free + drift[1]) / (rows[1] @ response)
            return free + normal * response, normal

        def cone(self, y: Array) -> float:
            tangential, normal = self.stick(y)[1]
            return self.friction * normal - abs(tangential)

        def normal(self, y: Array) -> float:
            return self.slip(y)[1]

        def height(self, y: Array) -> float:
            self.place(y)
            return self.plant.CalcPointsPositions(self.inner, self.toe, np.zeros(3), self.world)[2, 0]

        # what events do

        def begin_to_slip(self, y: Array) -> None:
            self.side = -float(np.sign(self.stick(y)[1][0]))
            self.phase = SLIP

        def struck(self, y: Array) -> Array:
            self.place(y)
            rows = self.jacobian()
            response = np.linalg.solve(self.plant.CalcMassMatrix(self.inner)[MOVING, MOVING], rows.T)
            return np.concatenate([y[:3], y[3:] - response @ np.linalg.solve(rows @ response, rows @ y[3:])])

        def slips(self, context, event, state) -> EventStatus:
            self.begin_to_slip(self.state(context))
            return EventStatus.Succeeded()

        def lifts(self, context, event, state) -> EventStatus:
            self.phase = RISE
            return EventStatus.Succeeded()

        def falls(self, context, event, state) -> EventStatus:
            self.phase = FALL
            return EventStatus.Succeeded()

        def strikes(self, context, event, state) -> EventStatus:
            after = self.struck(self.state(context))
            state.get_mutable_continuous_state().get_mutable_vector().SetFromVector(after)
            return EventStatus.ReachedTermination(self, "touchdown")

    return Hopper()
