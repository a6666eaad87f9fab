"""Published costs of transport of robots and animals, as in Fig. 2.4, and how far each is verified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from spear_pin.errors import require

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


_FIG_1 = "label in Fig. 1 of Seok et al., IEEE/ASME Trans. Mechatronics (manuscript of 2013)"
PUBLISHED: tuple[CostPoint, ...] = (
    CostPoint(
        "MIT Cheetah",
        33.0,
        0.5,
        "electrical",
        "Seok et al., IEEE/ASME Trans. Mechatronics (manuscript of 2013): 973 W at 6 m/s",
        "publication seen",
    ),
    CostPoint(
        "iSprawl", 0.3, 1.75, "electrical", "Kim, Clark and Cutkosky 2006; 1.7 in Seok et al.", "publication seen"
    ),
    CostPoint("BigDog", 109.0, 15.0, "fuel", f"{_FIG_1}; mass from a paper on another robot", "secondary source"),
    CostPoint("ASIMO", 54.0, 2.0, "electrical", f"{_FIG_1}; mass from memory", "recollection"),
    CostPoint("ASIMO", 54.0, 3.2, "electrical", "Collins et al. 2005, from memory", "recollection"),
    CostPoint("Cornell Ranger 2011", 9.98, 0.28, "electrical", "press: 22 lb, 16 W", "secondary source"),
    CostPoint("Cornell Ranger 2014", 9.98, 0.19, "electrical", "IJRR 2014, from memory; mass of 2011", "recollection"),
    CostPoint("robot of ETH Zurich", 15.65, 0.38, "electrical", "23.4 W at 0.4 m/s", "secondary source"),
    CostPoint("ATRIAS", 62.0, 1.3, "electrical", "1.1 to 1.5, from memory", "recollection"),
    CostPoint("ANYmal", 30.0, 1.2, "electrical", "from memory", "recollection"),
    CostPoint("StarlETH", 25.0, 2.0, "electrical", "from memory", "recollection"),
    CostPoint("human, walking", 70.0, 0.2, "metabolic", "press; mass assumed", "assumption"),
)
