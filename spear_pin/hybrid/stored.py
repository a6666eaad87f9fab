"""Energy that a system stores at a state, for the ledger."""

from __future__ import annotations

from collections.abc import Container

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held, Mount
from spear_pin.hybrid.own import asked, is_own, number


def in_springs(
    system: HybridSystem, domain: Domain, held: Held, y: Array, joints: Container[str] | None = None
) -> float:
    """Returns the energy in the engaged springs on some joints, in J.

    Args:
        system: the system.
        domain: the present domain.
        held: held values.
        y: the state; its first nq entries are the configuration.
        joints: joints whose springs count; None for all.
    """
    energy = 0.0
    for mount in domain.mounts:
        if joints is None or mount.joint in joints:
            energy += _energy(mount, float(y[system.robot.index(mount.joint)]), held)
    return energy


def _energy(mount: Mount, angle: float, held: Held) -> float:
    spring = mount.spring
    if not is_own(type(spring)):
        return float(mount.energy(angle, held))
    what = f"spring of {mount.joint!r}"
    return number(what, spring.energy, asked(what, spring.energy, lambda: mount.energy(angle, held)))


def in_mechanism(system: HybridSystem, domain: Domain, held: Held, y: Array) -> float:
    """Returns the kinetic energy plus the energies of gravity and of engaged springs, in J."""
    robot = system.robot
    q, v = y[: robot.nq], y[robot.nq : robot.nq + robot.nv]
    return robot.kinetic_energy(q, v) + robot.potential_energy(q) + in_springs(system, domain, held, y)


def in_inductances(system: HybridSystem, y: Array) -> float:
    """Returns the energy in the hardware's inductances, in J."""
    hardware, first = system.hardware, system.robot.nq + system.robot.nv
    return 0.0 if hardware is None else hardware.stored(y[first : first + len(hardware.names)].tolist())
