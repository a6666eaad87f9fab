"""Calls a domain's functions once with numbers, to distinguish a mistake from a limit of symbols."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from spear_pin.errors import BadFunction
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.fields import map_nested
from spear_pin.hybrid.flow_names import flow_names


def find_mistake(system: HybridSystem, domain: Domain, held: Mapping[str, Any]) -> BadFunction | None:
    """Finds the first mistake in a domain's functions at the system's guess; None if there is none.

    Args:
        system: the system.
        domain: one of its domains.
        held: values held in the domain, by name; the numbers do not matter.
    """
    try:
        flow = Flow(system, domain, {name: map_nested(lambda number: 1.0, value) for name, value in held.items()})
        y = np.concatenate([*system.guess(), np.zeros(len(flow_names(system)))])
        flow(0.0, y)
        for guard in domain.guards:
            flow.value(guard, 0.0, y)
        for toe in system.robot.toes:
            flow.height(toe)
    except BadFunction as found:
        return found
    except Exception:  # any other exception is no known mistake
        return None
    return None
