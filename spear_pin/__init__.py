"""Switchable parallel elastic legs on Pinocchio: dynamics, hybrid simulation, periodic gaits.

The public names are imported when first used, so that `import spear_pin` costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False  # typing takes longer to import than all else here
if TYPE_CHECKING:
    from typing import Any

    from spear_pin.errors import RobotWarning, SpearError
    from spear_pin.gaits.bounding import bounding
    from spear_pin.gaits.bounding_law import BoundingLaw
    from spear_pin.gaits.codesign.design import Design
    from spear_pin.gaits.codesign.optimize_design import optimize_design
    from spear_pin.gaits.continuation.branch import Branch
    from spear_pin.gaits.continuation.continuing import continue_gait
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.hopping import HoppingLaw, hopping
    from spear_pin.gaits.orbits.embedding import in_space
    from spear_pin.gaits.search import find_gait
    from spear_pin.gaits.sensitivity.sensitivity import Sensitivity
    from spear_pin.gaits.sensitivity.uncertainty import Uncertainty
    from spear_pin.gaits.spatial.bounding import bounding_in_space
    from spear_pin.gaits.spatial.law import SpatialLaw
    from spear_pin.gaits.spatial.pronking import pronking
    from spear_pin.gaits.spatial.trot_law import TrotLaw
    from spear_pin.gaits.spatial.trotting import pacing, trotting
    from spear_pin.hybrid.batch import simulate_many
    from spear_pin.hybrid.contact import Contact
    from spear_pin.hybrid.ground import Ground
    from spear_pin.hybrid.simulate import simulate
    from spear_pin.hybrid.trajectory import Trajectory
    from spear_pin.model.chain import from_chain, to_chain
    from spear_pin.model.legs import Leg
    from spear_pin.model.loading import load
    from spear_pin.model.monopod import monopod
    from spear_pin.model.robot import Robot
    from spear_pin.model.sagittal import sagittal
    from spear_pin.model.spring import Spring
    from spear_pin.model.variants import vary
    from spear_pin.viz.compare.comparison import compare

__version__ = "0.1.0.dev0"
__all__ = [
    "BoundingLaw",
    "Branch",
    "Contact",
    "Design",
    "Gait",
    "Ground",
    "HoppingLaw",
    "Leg",
    "Robot",
    "RobotWarning",
    "Sensitivity",
    "SpatialLaw",
    "SpearError",
    "Spring",
    "Trajectory",
    "TrotLaw",
    "Uncertainty",
    "bounding",
    "bounding_in_space",
    "compare",
    "continue_gait",
    "find_gait",
    "from_chain",
    "hopping",
    "in_space",
    "load",
    "monopod",
    "optimize_design",
    "pacing",
    "pronking",
    "sagittal",
    "simulate",
    "simulate_many",
    "to_chain",
    "trotting",
    "vary",
]

_HOMES = {
    "SpearError": "errors",
    "RobotWarning": "errors",
    "Robot": "model.robot",
    "load": "model.loading",
    "Leg": "model.legs",
    "monopod": "model.monopod",
    "sagittal": "model.sagittal",
    "Spring": "model.spring",
    "Contact": "hybrid.contact",
    "Ground": "hybrid.ground",
    "simulate": "hybrid.simulate",
    "simulate_many": "hybrid.batch",
    "Trajectory": "hybrid.trajectory",
    "bounding": "gaits.bounding",
    "BoundingLaw": "gaits.bounding_law",
    "vary": "model.variants",
    "hopping": "gaits.hopping",
    "HoppingLaw": "gaits.hopping",
    "Gait": "gaits.gait",
    "find_gait": "gaits.search",
    "Branch": "gaits.continuation.branch",
    "continue_gait": "gaits.continuation.continuing",
    "Sensitivity": "gaits.sensitivity.sensitivity",
    "Design": "gaits.codesign.design",
    "optimize_design": "gaits.codesign.optimize_design",
    "Uncertainty": "gaits.sensitivity.uncertainty",
    "to_chain": "model.chain",
    "from_chain": "model.chain",
    "bounding_in_space": "gaits.spatial.bounding",
    "SpatialLaw": "gaits.spatial.law",
    "trotting": "gaits.spatial.trotting",
    "pacing": "gaits.spatial.trotting",
    "pronking": "gaits.spatial.pronking",
    "TrotLaw": "gaits.spatial.trot_law",
    "in_space": "gaits.orbits.embedding",
    "compare": "viz.compare.comparison",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        value = getattr(import_module(f"spear_pin.{_HOMES[name]}"), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'spear_pin' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
