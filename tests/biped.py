"""The automaton of examples/biped.py, and a state near its gait."""

import importlib.util
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from spear_pin import load
from spear_pin.hybrid.automaton import HybridSystem

PATH = Path(__file__).parents[1] / "examples" / "biped.py"
NEAR = (
    np.array([0.0, 0.5562, 0.0349, 0.6717, 0.8589, -0.3746, 1.5996]),
    np.array([1.1778, -0.5468, 0.7728, 0.7294, 6.4054, -2.2258, 4.3417]),
)


@cache
def example() -> ModuleType:
    """The example, as a module."""
    spec = importlib.util.spec_from_file_location("biped_example", PATH)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def system() -> HybridSystem:
    """The biped, running at 1 m/s."""
    law = example().RunningLaw(set_back=0.117809)
    system: HybridSystem = example().running(load("biped"), law)
    return system
