"""Runs the problems of a single foot in the plane from their files alone: Pinocchio, SciPy, and README.md typed here.

Nothing is shared with what made the answers but Pinocchio's rigid bodies, which the other engine does without.
"""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

AIR, STICK, FORWARD, BACKWARD = "air", "stick", 1.0, -1.0
FINEST = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
REST = 1e-9  # m/s: a foot that slides more slowly after an impact sticks


def runs(problem):
    """Whether it is such a problem; springs are along joints."""
    robot = problem["robot"]
    return len(robot["feet"]) == 1 and not robot["loops"] and "feet_that_strike" not in problem


@dataclass
class Hand:
    """A run."""

    problem: dict
    t: float = 0.0
    began: float = 0.0
    mode: object = AIR
    rests: dict = field(default_factory=dict)  # of springs that are engaged: their lengths at rest
    taut: dict = field(default_factory=dict)
    due: dict = field(default_factory=dict)  # of springs: when they engage or release
    events: list = field(default_factory=list)

    def __post_init__(self):
        robot, ground = self.problem["robot"], self.problem["ground"]
        self.model = pin.buildModelFromXML("".join(robot["urdf"]))
        self.data, self.names = self.model.createData(), robot["coordinates"]
        assert list(self.model.names)[1:] == self.names
        self.armature = np.diag([robot["armature_kg_m2"][name] for name in self.names])
        self.foot, self.friction = self.model.getFrameId(robot["feet"][0]), ground["friction"]
        c, s = np.cos(ground["slope_rad"]), np.sin(ground["slope_rad"])
        self.axes = np.array([[c, 0.0, s], [-s, 0.0, c]])  # along the ground, and normal to it
        self.springs = {each["name"]: each for each in self.problem["springs"]}
        start = self.problem["start"]
        self.q, self.v = np.array(start["position"]), np.array(start["velocity"])
        if start["feet_on_ground"]:
            self.touch()

    # what a spring or a motor does

    def number(self, spring, beginning):
        return next((value for name, value in self.springs[spring].items() if name.startswith(beginning)), 0.0)

    def weights(self, spring):
        return np.array([self.springs[spring]["length"]["sum_of"].get(name, 0.0) for name in self.names])

    def stretch(self, spring, q):
        return self.weights(spring) @ q - self.rests[spring]

    def engage(self, spring):
        self.rests[spring] = self.weights(spring) @ self.q + self.number(spring, "play")
        self.taut[spring] = self.number(spring, "play") == 0.0

    def applied(self, t, q, v):
        found = np.zeros(len(q))
        for joint, said in self.problem["torques"].items():
            i, torque = self.names.index(joint), said.get("foot_in_air" if self.mode == AIR else "foot_on_ground", {})
            found[i] += np.polynomial.polynomial.polyval(t - self.began, torque.get("polynomial_N_m", [0.0]))
            found[i] += torque.get("stiffness_N_m_per_rad", 0.0) * (torque.get("angle_rad", 0.0) - q[i])
            found[i] -= torque.get("damping_N_m_s_per_rad", 0.0) * v[i]
        for spring, said in self.springs.items():
            weights, pull = self.weights(spring), 0.0
            if spring in self.rests and self.taut[spring]:
                stretch = self.stretch(spring, q)
                pull = self.number(spring, "stiffness") * stretch + self.number(spring, "hardening") * stretch**3
            if self.mode != AIR if said.get("damper_engages_at_touchdown") else spring in self.rests:
                pull += self.number(spring, "damping") * (weights @ v)
            found -= pull * weights
        return found

    # the robot on the ground

    def terms(self, q, v):
        """D, C v + G, and of the foot: height, J and J̇v."""
        model, data = self.model, self.data
        bias = pin.nonLinearEffects(model, data, q, v).copy()
        upper = np.triu(pin.crba(model, data, q))
        pin.forwardKinematics(model, data, q, v, 0.0 * v)
        pin.updateFramePlacements(model, data)
        drift = pin.getFrameClassicalAcceleration(model, data, self.foot, pin.LOCAL_WORLD_ALIGNED).linear
        J = self.axes @ pin.computeFrameJacobian(model, data, q, self.foot, pin.LOCAL_WORLD_ALIGNED)[:3]
        height = self.axes[1] @ data.oMf[self.foot].translation
        return upper + np.triu(upper, 1).T + self.armature, bias, height, J, self.axes @ drift

    def moving(self, t, y):
        """Acceleration and ground force, along and normal."""
        q, v = np.split(y, 2)
        D, bias, _, J, drift = self.terms(q, v)
        force = self.applied(t, q, v) - bias
        if self.mode == AIR:
            return np.linalg.solve(D, force), np.zeros(2)
        if self.mode == STICK and np.abs(J[0]).max() > 1e-9:
            rows, push = J, J.T
        else:
            along = 0.0 if self.mode == STICK else self.mode
            rows, drift, push = J[1:], drift[1:], (J[1] - along * self.friction * J[0])[:, None]
        n = len(rows)
        whole = np.block([[D, -push], [rows, np.zeros((n, n))]])
        found = np.linalg.solve(whole, np.concatenate([force, -drift]))
        a, pushes = np.split(found, [len(q)])
        return a, pushes if n == 2 else pushes * np.array([-along * self.friction, 1.0])

    def guards(self):
        """Functions that fall through zero, by the names of their events."""

        def spring_switch(spring):
            side = 1.0 if self.taut[spring] else -1.0
            return lambda t, y: side * self.stretch(spring, np.split(y, 2)[0])

        found = {f"spring_switch {each}": spring_switch(each) for each in self.rests}
        if self.mode == AIR:
            found["touchdown"] = lambda t, y: self.terms(*np.split(y, 2))[2]
            return found
        found["lift_off"] = lambda t, y: self.moving(t, y)[1][1]
        if self.mode == STICK:
            for side in (1.0, -1.0):
                found[f"slip {side}"] = lambda t, y, side=side: np.array([side, self.friction]) @ self.moving(t, y)[1]
        else:
            found["stick"] = lambda t, y: self.mode * (self.terms(*np.split(y, 2))[3][0] @ np.split(y, 2)[1])
        return found

    def run(self):
        left = self.problem["ends_at_touchdown_after_flight"]
        while left:
            guards = self.guards()
            watched = [lambda t, y, guard=guard: guard(t, y) for guard in guards.values()]
            for each in watched:
                each.terminal, each.direction = True, -1.0
            end = min([self.t + 2.0, *self.due.values()])
            slope = lambda t, y: np.concatenate([np.split(y, 2)[1], self.moving(t, y)[0]])  # noqa: E731
            done = solve_ivp(slope, (self.t, end), np.concatenate([self.q, self.v]), events=watched, **FINEST)
            self.t, (self.q, self.v) = done.t[-1], np.split(done.y[:, -1], 2)
            if done.status == 1:
                left -= self.happen(next(name for name, at in zip(guards, done.t_events, strict=True) if len(at)))
            else:
                assert self.due, "no event"
                self.act(min(self.due, key=self.due.get))
        return self.events

    # events

    def act(self, spring):
        """A late switch acts."""
        del self.due[spring]
        if spring in self.rests:
            del self.rests[spring]
        else:
            self.engage(spring)
        self.record(f"switch:{spring}")

    def happen(self, event):
        """Does what the event does, and returns whether it is a touchdown."""
        name, _, which = event.partition(" ")
        if name == "spring_switch":
            self.taut[which] = not self.taut[which]
        elif name == "touchdown":
            self.strike()
            self.touch()
        elif name == "lift_off":
            self.mode, self.began = AIR, self.t
            for spring in list(self.rests):
                if late := self.number(spring, "releases_after"):
                    self.due[spring] = self.t + late
                else:
                    del self.rests[spring]
        else:
            self.mode = STICK if name == "stick" else float(which)
            self.settle()
        self.record(name)
        return name == "touchdown"

    def strike(self):
        """A plastic impact: the foot rests, or slides on where the cone does not allow that."""
        D, _, _, J, _ = self.terms(self.q, self.v)
        response = np.linalg.solve(D, J.T)
        A, u = J @ response, J @ self.v
        impulse = np.array([0.0, -u[1] / A[1, 1]])
        if np.abs(J[0]).max() > 1e-9:
            impulse = -np.linalg.solve(A, u)
            if abs(impulse[0]) > self.friction * impulse[1]:
                for way in (FORWARD, BACKWARD):
                    along = np.array([-way * self.friction, 1.0])
                    slid = along * (-u[1] / (A[1] @ along))
                    if way * (u + A @ slid)[0] > 0.0:
                        impulse = slid
        self.v = self.v + response @ impulse

    def touch(self):
        """The foot stands from now on."""
        self.began = self.t
        speed = self.terms(self.q, self.v)[3][0] @ self.v
        self.mode = STICK if abs(speed) < REST else float(np.sign(speed))
        for spring in self.springs:
            if late := self.number(spring, "engages_after"):
                self.due[spring] = self.t + late
            else:
                self.engage(spring)
        self.settle()

    def settle(self):
        """A foot that cannot stick begins to slide."""
        if self.mode == STICK:
            along, normal = self.moving(self.t, np.concatenate([self.q, self.v]))[1]
            if abs(along) > self.friction * normal:
                self.mode = -float(np.sign(along))

    def record(self, name):
        foot = self.problem["robot"]["feet"][0] if name in ("touchdown", "lift_off") else ""
        event = {"event": name, "foot": foot, "time_s": self.t}
        self.events.append(event | {"position": self.q.tolist(), "velocity": self.v.tolist()})
