"""Energy that a system stores at a state, for the ledger."""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held, Mount
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.own import call_function, is_own, number
from spear_pin.hybrid.springs import rest_length
from spear_pin.model.robot_posture import RobotPosture


def in_springs(
    system: HybridSystem, domain: Domain, held: Held, y: Array, names: Container[str] | None = None
) -> float:
    """Returns the energy in some of the engaged springs, in J.

    Args:
        system: the system.
        domain: the present domain.
        held: held values.
        y: the state; its first nq entries are the configuration.
        names: names of the mounts that count; None for all.
    """
    robot, energy = system.robot, 0.0
    posture = RobotPosture(robot, FLOATS) if domain.mounts else None
    for mount in domain.mounts:
        if posture is not None and (names is None or mount.name in names):
            rest = rest_length(mount, mount.spring, mount.along, robot, held, lambda q: posture.at(np.array(q)))
            energy += _energy(mount, mount.along.length(posture.at(y[: robot.nq])), rest, held)
    return energy


def _energy(mount: Mount, length: float, rest: float, held: Held) -> float:
    spring = mount.spring
    if not is_own(type(spring)):
        return float(mount.energy(length, rest, held))
    what = f"spring of {mount.name!r}"
    return number(what, spring.energy, call_function(what, spring.energy, lambda: mount.energy(length, rest, held)))


def in_mechanism(
    system: HybridSystem, domain: Domain, held: Held, y: Array, names: Container[str] | None = None
) -> float:
    """Returns the kinetic energy plus the energies of gravity and of engaged springs, in J; see `in_springs`."""
    robot = system.robot
    q, v = y[: robot.nq], y[robot.nq : robot.nq + robot.nv]
    return robot.kinetic_energy(q, v) + robot.potential_energy(q) + in_springs(system, domain, held, y, names)


def in_inductances(system: HybridSystem, y: Array) -> float:
    """Returns the energy in the hardware's inductances, in J."""
    hardware, first = system.hardware, system.robot.nq + system.robot.nv
    return 0.0 if hardware is None else hardware.stored(y[first : first + len(hardware.names)].tolist())
