"""Runs a reference in a simulator that takes steps, from the problem's file alone: its torques, springs and events.

A foot stands from the step at whose end it is no higher than the ground. It has left where it is as high as it gets in
a step at the speed `RISES`, but not within `SETTLES` after its touchdown, as a compliant contact bounces. Both instants
are interpolated to where it crossed the ground. Positions are reported at every event; velocities only where a foot
leaves, as such a contact takes time to stop a foot that lands.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from spear_pin.arrays import Array

RISES, SETTLES = 0.1, 0.02  # m/s, s
LONGEST = 5.0  # s


class Simulator(Protocol):
    """A simulator with a robot on the ground, in the problem's coordinates."""

    def set(self, q: Array, v: Array) -> None: ...

    def step(self, forces: Array) -> None:
        """Takes a step under generalised forces, which stay the same in it."""

    def state(self) -> tuple[Array, Array]: ...

    def heights(self) -> Mapping[str, float]:
        """Heights of the feet above the ground, along its normal."""


@dataclass
class Engaged:
    """A spring of the problem, and since when it has been on."""

    said: Mapping[str, Any]
    weights: Array
    touched: float = -np.inf
    left: float = -np.inf
    rest: float | None = None

    def number(self, beginning: str) -> float:
        """A number of the file by how its name begins, without the unit."""
        return next((float(value) for name, value in self.said.items() if name.startswith(beginning)), 0.0)

    def force(self, t: float, q: Array, v: Array, stands: bool) -> Array:
        """The generalised force, after its switch has acted where it is due."""
        length = float(self.weights @ q)
        on = stands and t >= self.touched + self.number("engages_after")
        on = on or (not stands and self.rest is not None and t < self.left + self.number("releases_after"))
        if on and self.rest is None:
            self.rest = length + self.number("play")
        elif not on:
            self.rest = None
        pull, early = 0.0, bool(self.said.get("damper_engages_at_touchdown"))
        if self.rest is not None:
            stretch = length - self.rest
            if stretch > 0.0 or not self.said["pulls_only"]:
                pull = self.number("stiffness") * stretch + self.number("hardening") * stretch**3
        if stands if early else self.rest is not None:
            pull += self.number("damping") * float(self.weights @ v)
        return -pull * self.weights


@dataclass
class Stepping:
    """A run of a problem.

    Attributes:
        problem: content of the problem's file.
        simulator: where its robot is.
        step: length of a step, in s.
    """

    problem: Mapping[str, Any]
    simulator: Simulator
    step: float
    events: list[dict[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.names = self.problem["robot"]["coordinates"]
        self.standing = set(self.problem["start"]["feet_on_ground"])
        self.springs = [Engaged(said, self._weights(said)) for said in self.problem["springs"]]
        for spring in self.springs:
            if spring.said["foot"] in self.standing:
                spring.touched = 0.0
        self.began, self.flights, self.landed = 0.0, 0, dict[str, float]()

    def run(self) -> list[dict[str, Any]]:
        """The events up to the end, as `check` takes them; fewer if it does not come."""
        simulator, t = self.simulator, 0.0
        simulator.set(*(np.array(self.problem["start"][name]) for name in ("position", "velocity")))
        before, crossed = simulator.heights(), dict[str, tuple[float, Array, Array]]()
        while self.flights < self.problem["ends_at_touchdown_after_flight"] and t < LONGEST:
            state = simulator.state()
            simulator.step(self.forces(t, *state))
            heights = simulator.heights()
            for foot, height in heights.items():
                if (before[foot] > 0.0) != (height > 0.0):
                    share = before[foot] / (before[foot] - height)
                    pairs = zip(state, simulator.state(), strict=True)
                    crossed[foot] = t + share * self.step, *(one + share * (other - one) for one, other in pairs)
                left = height > RISES * self.step and t > self.landed.get(foot, 0.0) + SETTLES
                if left if foot in self.standing else height <= 0.0:
                    self.happen(foot, *crossed[foot])
            before, t = heights, t + self.step
        return self.events

    def happen(self, foot: str, t: float, q: Array, v: Array) -> None:
        """A foot touches or leaves."""
        leaves = foot in self.standing
        event = {"event": "lift_off" if leaves else "touchdown", "foot": foot, "time_s": t, "position": q.tolist()}
        self.events.append(event | ({"velocity": v.tolist()} if leaves else {}))
        self.flights += not self.standing
        self.standing ^= {foot}
        self.began = self.landed[foot] = t
        for spring in self.springs:
            if spring.said["foot"] == foot:
                spring.touched, spring.left = (spring.touched, t) if leaves else (t, spring.left)

    def forces(self, t: float, q: Array, v: Array) -> Array:
        """Generalised forces of motors and springs."""
        found = np.zeros(len(self.names))
        for joint, said in self.problem["torques"].items():
            i = self.names.index(joint)
            torque = said.get("foot_on_ground" if said["foot"] in self.standing else "foot_in_air", {})
            polynomial = torque.get("polynomial_N_m", [])
            found[i] += sum(number * (t - self.began) ** n for n, number in enumerate(polynomial))
            found[i] += torque.get("stiffness_N_m_per_rad", 0.0) * (torque.get("angle_rad", 0.0) - q[i])
            found[i] -= torque.get("damping_N_m_s_per_rad", 0.0) * v[i]
        return found + sum(spring.force(t, q, v, spring.said["foot"] in self.standing) for spring in self.springs)

    def _weights(self, said: Mapping[str, Any]) -> Array:
        return np.array([said["length"]["sum_of"].get(name, 0.0) for name in self.names])


def runs(problem: Mapping[str, Any]) -> bool:
    """Tells whether a simulator can run it here: neither a loop nor an impact alone."""
    return "feet_that_strike" not in problem and not problem["robot"]["loops"]
