"""Names of the flows of energy that are integrated with the state, for the ledger."""

from __future__ import annotations

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.hardware import ELECTRICAL


def flow_names(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the flows integrated with the state: motors, damping, friction, slip, and hardware's.

    `clutch`, before the hardware's, is there if clutches of springs may slip.
    """
    mechanical = (*(f"motor_{joint}" for joint in system.robot.actuated), "damping", "friction", "slip")
    return mechanical + ("clutch",) * gives(system) + electrical_flows(system)


def gives(system: HybridSystem) -> bool:
    """Tells whether a clutch of a spring may slip."""
    return any(spring.clutch is not None and spring.clutch.slip > 0.0 for spring in system.springs.values())


def electrical_flows(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the hardware's flows: battery, joule and gearbox of each actuated joint."""
    joints = system.robot.actuated if system.hardware is not None else ()
    return tuple(f"{flow}_{joint}" for joint in joints for flow in ELECTRICAL)
