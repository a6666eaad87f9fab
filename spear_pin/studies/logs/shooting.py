"""Shoots a played leg over a phase of a log, with its variational equations by numbers and by where it sets out.

Steps of the classical Runge-Kutta method go from sample to sample, between which torques are straight lines: the
input's corners are where steps end.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.tangent.fields import Values, field_of
from spear_pin.hybrid.tangent.seeds import numbers, seeds
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.played import TORQUE, latch_rests

LONGEST = 1.6e-3  # s, of a step
FAR = 1e6  # rad, m, rad/s or m/s: no leg gets there
STEEP = 1e15  # per unit of any number: no state depends on it so much


@dataclass(frozen=True)
class Shot:
    """A played leg's motion over some times.

    Attributes:
        t: the times, (n,), in s.
        y: states at them, (n, 2 nv).
        dy: their derivatives, (n, 2 nv, c).
        forces: force on the toe, along the ground and normal to it, (n, 2), in N; 0 in flight.
    """

    t: Array
    y: Array
    dy: Array
    forces: Array

    @property
    def bounded(self) -> bool:
        """Whether states and derivatives are finite, and have not blown up."""
        return bool((np.abs(self.y) < FAR).all() and (np.abs(self.dy) < STEEP).all())


@dataclass(frozen=True, eq=False)
class Shooter:
    """A played leg with its numbers.

    Attributes:
        system: a system that `make_played` makes.
        over: names of the numbers by which it is differentiated.
    """

    system: HybridSystem
    over: tuple[str, ...] = ()

    @cached_property
    def _numbers(self) -> Array:
        return numbers(self.system)

    @cached_property
    def _seeds(self) -> Array:
        return seeds(self.system, self.over).numbers

    @cached_property
    def _places(self) -> list[int]:
        """Rows of the motors' torques among the numbers: those of the law come first."""
        names = [*type(self.system.law).__dataclass_fields__]
        motors = self.system.domains[0].law.motors  # type: ignore[attr-defined]
        return [names.index(f"{motor}{TORQUE}") for motor in motors]

    def held(self, domain: Domain, latched: Array) -> dict[str, Any]:
        """Returns where the springs of a domain rest that were latched at a configuration, (nv,)."""
        return dict(latch_rests(self.system.robot, domain.mounts, latched.tolist()))

    def shoot(self, name: str, t: Array, *given: Any, **options: Any) -> Shot:
        """Integrates from a state over given times; see `along` for what it takes."""
        with np.errstate(over="ignore", invalid="ignore"):  # see `Shot.bounded`
            return Shot(t, *map(np.array, zip(*self.along(name, t, *given, **options), strict=True)))

    def along(
        self,
        name: str,
        t: Array,
        torques: Array,
        y: Array,
        dy: Array,
        latched: Array,
        dlatched: Array | None = None,
        steps: int = 1,
    ) -> Iterator[tuple[Array, Array, Array]]:
        """Yields the state at each of the times, its derivatives, and the force on the toe, at the last as before it.

        Args:
            name: "stance" or "flight".
            t: the times, (n,), in s; the state is that at the first.
            torques: torques of the motors at these times, (n, nu), in N·m.
            y: the state, (2 nv,).
            dy: its derivatives by `over`, then by others, (2 nv, c).
            latched: configuration at touchdown, (nv,), at which springs were latched.
            dlatched: its derivatives, (nv, c); none unless they are given.
            steps: by how much more steps there are than need be.
        """
        domain = next(each for each in self.system.domains if each.name == name)
        held = self.held(domain, latched)
        field, c = field_of(self.system, domain, held), dy.shape[1]
        own = np.concatenate([self._numbers, flatten(held.values())])
        slopes = np.zeros((len(own), c))
        slopes[: len(self._numbers), : len(self.over)] = self._seeds
        if dlatched is not None and held:  # what is held are coordinates
            slopes[len(self._numbers) :] = np.array(
                [flatten(self.held(domain, each).values()) for each in dlatched.T]
            ).T
        zero, still = np.zeros(1), np.zeros(c)

        def at(y: Array, dy: Array, u: Array) -> tuple[Array, Array, Values]:
            own[self._places] = u
            said, changed = field.at(zero, y, own, still, dy, slopes)
            return said.slopes, changed.slopes, said

        y, dy, force = y[:, None], dy[:, None], np.zeros(2)
        for k, length in enumerate(np.diff(t)):
            count = steps * max(1, int(np.ceil(length / LONGEST - 1e-9)))
            h, rise = length / count, (torques[k + 1] - torques[k]) / count
            for j in range(count):
                u = torques[k] + j * rise
                k1, d1, said = at(y, dy, u)
                if j == 0:
                    force = said.forces[:, 0] if len(said.forces) else force
                    yield y[:, 0], dy[:, 0], force
                k2, d2, _ = at(y + 0.5 * h * k1, dy + 0.5 * h * d1, u + 0.5 * rise)
                k3, d3, _ = at(y + 0.5 * h * k2, dy + 0.5 * h * d2, u + 0.5 * rise)
                k4, d4, _ = at(y + h * k3, dy + h * d3, u + rise)
                y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
                dy = dy + h / 6.0 * (d1 + 2.0 * (d2 + d3) + d4)
        yield y[:, 0], dy[:, 0], force


def with_torques(log: Log, motors: Sequence[str], ratios: Mapping[str, float], needed: bool = True) -> Array:
    """Returns the torques of motors at each sample of a log, (n, nu), in N·m at the joints.

    Args:
        log: the log.
        motors: names of the joints with a motor.
        ratios: their gear ratios.
        needed: whether a motor without a torque in the log is refused; else its torque is 0.

    Raises:
        BadValue: a torque is missing.
    """
    found = []
    for motor in motors:
        name = f"{motor}{TORQUE}"
        if needed and name not in log.values:
            raise BadValue(f"log {log.source}", [*log.values], f"{name!r} as well; of a motor that is off, zeros")
        torque = log.values.get(name, np.zeros(len(log.t)))
        found.append(torque * (ratios[motor] if name in log.at_motor else 1.0))
    return np.column_stack(found) if found else np.empty((len(log.t), 0))
