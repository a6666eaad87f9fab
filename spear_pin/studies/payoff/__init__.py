"""Would a switchable parallel spring at the knee pay off: which one, at which speed, with which motors.

For none, for a fixed and for a switched spring the gait is optimised anew at each point of a grid (`grid`, `bounds`),
with the robot's motors (`motors`); `answer` says what follows, `store` keeps every search.
"""

from spear_pin.studies.payoff.answer import Answer, answer
from spear_pin.studies.payoff.bounds import Study, bounds
from spear_pin.studies.payoff.figures import Figures, figures
from spear_pin.studies.payoff.grid import KINDS, Grid, Point
from spear_pin.studies.payoff.motors import Motors, assumed, fitted, of_file
from spear_pin.studies.payoff.rests import rests_of
from spear_pin.studies.payoff.searches import Search, SearchEnd
from spear_pin.studies.payoff.store import Store

__all__ = [
    "KINDS",
    "Answer",
    "Figures",
    "SearchEnd",
    "Grid",
    "Motors",
    "Point",
    "Search",
    "Store",
    "Study",
    "answer",
    "assumed",
    "bounds",
    "figures",
    "fitted",
    "of_file",
    "rests_of",
]
