"""Names of the flows of energy that are integrated with the state, for the ledger."""

from __future__ import annotations

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.hardware import ELECTRICAL


def flow_names(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the flows integrated with the state: motors, damping, friction, slip, and hardware's."""
    mechanical = (*(f"motor_{joint}" for joint in system.robot.actuated), "damping", "friction", "slip")
    return mechanical + electrical_flows(system)


def electrical_flows(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the hardware's flows: battery, joule and gearbox of each actuated joint."""
    joints = system.robot.actuated if system.hardware is not None else ()
    return tuple(f"{flow}_{joint}" for joint in joints for flow in ELECTRICAL)
