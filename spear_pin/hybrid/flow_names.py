"""Names of the flows of energy for the ledger: those integrated with the state, and those booked at events.

Where a system has several springs, the flows `damping` and `released` are divided among them: `damping:biceps`.
"""

from __future__ import annotations

from collections.abc import Collection

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Mount
from spear_pin.hybrid.hardware import ELECTRICAL
from spear_pin.hybrid.springs import spring_of

DAMPING, RELEASED, IMPACT = "damping", "released", "impact"


def flow_names(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the flows integrated with the state: motors, damping, friction, slip, and hardware's.

    `clutch`, before the hardware's, is there if clutches of springs may slip.
    """
    motors = (f"motor_{joint}" for joint in system.robot.actuated)
    mechanical = (*motors, *by_spring(DAMPING, system), "friction", "slip")
    return mechanical + ("clutch",) * gives(system) + electrical_flows(system)


def gives(system: HybridSystem) -> bool:
    """Tells whether a clutch of a spring may slip."""
    return any(spring.clutch is not None and spring.clutch.slip > 0.0 for spring in system.springs.values())


def electrical_flows(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the hardware's flows: battery, joule and gearbox of each actuated joint."""
    joints = system.robot.actuated if system.hardware is not None else ()
    return tuple(f"{flow}_{joint}" for joint in joints for flow in ELECTRICAL)


def booked_flows(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the flows that happen at events."""
    return IMPACT, *by_spring(RELEASED, system)


def by_spring(flow: str, system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of a flow of springs: one for each, or only one where there are no others."""
    return tuple(f"{flow}:{name}" for name in system.springs) if len(system.springs) > 1 else (flow,)


def flow_of_mount(flow: str, system: HybridSystem, mount: Mount) -> str:
    """Returns the name that a flow of springs has for a mount."""
    return f"{flow}:{spring_of(mount, system)}" if len(system.springs) > 1 else flow


def released_flows(system: HybridSystem, domain: Domain, names: Collection[str]) -> dict[str, Collection[str]]:
    """Returns the names of mounts of a domain by the flows to which their energy goes as they release."""
    if len(system.springs) <= 1:
        return {RELEASED: names} if names else {}
    found = dict[str, Collection[str]]()
    for mount in (each for each in domain.mounts if each.name in names):
        flow = flow_of_mount(RELEASED, system, mount)
        found[flow] = [*found.get(flow, ()), mount.name]
    return found
