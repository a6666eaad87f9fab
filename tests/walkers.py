"""The systems of examples/walkers.py, and the published numbers of the walker and the runner."""

import importlib.util
import math
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.periodic import return_map

PATH = Path(__file__).parents[1] / "examples" / "walkers.py"
# Garcia, Chatterjee, Ruina and Coleman 1998, slope 0.009: the comments of the code with which the paper was made, where
# they are said to hold to 1e-10; angle and rate of the stance leg after heelstrike, and multipliers
LONG = (
    (0.20031090049483, -0.19983247291764),
    (-0.19120868949940 + 0.55633363687106j, -0.19120868949940 - 0.55633363687106j),
)
SHORT = (0.19393736960624, -0.20386692731962), (4.000, 0.459)
# Bhounsule 2016, slipHopper.m: mass, stiffness, the leg's angle from vertical in degrees, speed and height at the apex
HOPPERS = {
    "steep": (100.0, 10000.0, 5.0, 0.513806075894484, 1.238312718076982),
    "flat": (1.0, 100.0, 10.0, 1.017450873821607, 1.182441943200824),
}
# Bhounsule 2009, passivewalker.m, the walker with round feet: after heelstrike the stance leg's angle and rate, then
# those of the angle between the legs
ROUND = 0.189472782205104, -0.239124222551699, 0.378945564410209, -0.053691703909393


def mistaken_rates(system: HybridSystem, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Rates of the legs after the right foot's strike in that program: the leg that leaves turns as the other does."""
    J, D = system.robot.toe_jacobian(q, "right_foot"), system.robot.mass_matrix(q)
    free = np.vstack([-np.linalg.solve(J[:, :2], J[:, 2:]), np.eye(2)])
    more = 0.02 * (v[3] - v[2]) * np.array([1.0, -1.0])
    return np.asarray(np.linalg.solve(free.T @ D @ free, free.T @ D @ v + more))


def round_state(system: HybridSystem, numbers: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """The walker's state on round feet from the numbers of that program, with its left foot on the ground."""
    angle, rate, between, opening = numbers
    q = np.array([0.0, 0.2 + math.cos(angle), angle, angle - between])
    v = np.array([0.0, 0.0, rate, rate - opening])
    J = system.robot.toe_jacobian(q, "left_foot")
    v[:2] = np.linalg.solve(J[:, :2], -J[:, 2:] @ v[2:])
    return q, v


@cache
def example() -> ModuleType:
    """The example, as a module."""
    spec = importlib.util.spec_from_file_location("walkers_example", PATH)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def hopper(name: str) -> HybridSystem:
    """The runner with the numbers of another program, which starts in its gait."""
    mass, stiffness, angle, speed, height = HOPPERS[name]
    numbers = example().Human(mass, stiffness, 1.0, math.radians(90.0 - angle), 10.0, speed, height)
    runner: HybridSystem = example().runner(numbers)
    return runner


def forward_differences(system: HybridSystem, state: tuple[float, float], h: float = 1e-5) -> np.ndarray:
    """Multipliers of the walker's step, from angle and rate to those after heelstrike, by forward differences."""

    def step(x: np.ndarray) -> np.ndarray:
        begin = [x[0], 2 * x[0]], [x[1], (1 - math.cos(2 * x[0])) * x[1]]
        q, v = return_map(system, (np.array(begin[0]), np.array(begin[1])), 1e-12).state
        return np.array([q[0], v[0]])

    at = np.array(state)
    return np.linalg.eigvals(np.column_stack([(step(at + h * e) - step(at)) / h for e in np.eye(2)]))
