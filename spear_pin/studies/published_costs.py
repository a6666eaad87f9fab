"""Published costs of transport of robots and animals, as in Fig. 2.4, and how far each is verified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from spear_pin.errors import require
from spear_pin.studies.prose import read

Kind = Literal["electrical", "mechanical", "metabolic", "fuel"]
Verification = Literal[
    "publication seen",
    "secondary source",  # a newspaper, or somebody else's publication
    "recollection",  # from memory: verify before relying on it
    "assumption",
    "computed",  # by this package
]
KINDS: tuple[Kind, ...] = get_args(Kind)
UNVERIFIED: tuple[Verification, ...] = ("recollection", "assumption")


@dataclass(frozen=True)
class CostPoint:
    """A cost of transport and the mass that it goes with.

    Attributes:
        name: name of the robot or animal.
        mass: in kg.
        cost: E / (m g d).
        kind: kind of the energy.
        source: origin of the numbers.
        verification: how far to trust them, the less certain of mass and cost.
    """

    name: str
    mass: float
    cost: float
    kind: Kind
    source: str
    verification: Verification

    def __post_init__(self) -> None:
        """Checks the numbers."""
        require("CostPoint.mass", self.mass, lambda m: m > 0, "a number > 0, in kg")
        require("CostPoint.cost", self.cost, lambda c: c > 0, "a number > 0")


def running_animals(mass: float) -> float:
    """Returns the metabolic cost of transport of running animals by mass in kg: 10.7 M^-0.316 J/(kg m) over g.

    It is the slope of power over speed (Taylor, Heglund and Maloiy 1982; recollection), without the power for standing
    still.
    """
    require("mass", mass, lambda m: m > 0, "a number > 0, in kg")
    return float(10.7 * mass**-0.316 / 9.81)


PUBLISHED: tuple[CostPoint, ...] = tuple(CostPoint(*row) for row in read(__package__, "published_costs.toml")["points"])
