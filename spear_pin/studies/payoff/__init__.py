"""Payoff of a switchable parallel spring at the knee: whether it pays, which one, at which speed, with which motors.

For no spring, for a fixed and for a switched spring, the gait is optimised again at each point of a grid (`grid`,
`study`), with the robot's motors (`motors`): bounds of a quadruped (`bounding`), or hops of a leg in place (`hopping`).
`answer` draws the conclusion, and `store` keeps every search.
"""

from spear_pin.studies.payoff.answer import Answer, answer
from spear_pin.studies.payoff.bounding import bounds
from spear_pin.studies.payoff.figures import Figures
from spear_pin.studies.payoff.gaits import Gaits
from spear_pin.studies.payoff.grid import KINDS, Grid, Point
from spear_pin.studies.payoff.hopping import hops
from spear_pin.studies.payoff.motors import Motors, assume_motor, fit_motors, of_file
from spear_pin.studies.payoff.rests import rests_of
from spear_pin.studies.payoff.searches import Search, SearchEnd
from spear_pin.studies.payoff.store import Store
from spear_pin.studies.payoff.study import Study

__all__ = [
    "KINDS",
    "Answer",
    "Figures",
    "Gaits",
    "Grid",
    "Motors",
    "Point",
    "Search",
    "SearchEnd",
    "Store",
    "Study",
    "answer",
    "assume_motor",
    "bounds",
    "fit_motors",
    "hops",
    "of_file",
    "rests_of",
]
