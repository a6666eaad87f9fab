"""What a spring in the knee saves: the cheapest gait that was found with each kind of knee.

A payoff study found them: SPEAR-II's hop with 0.2 s of flight, for which it chose the knee's motor and gears, too, and
Q-SPEAR's bound at 2 m/s. Their files are beside this module, with what the assumed motors of the bound have to do.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from spear_pin.gaits.gait import Gait
from spear_pin.model.loading import load
from spear_pin.studies.audit.runs import kept
from spear_pin.studies.payoff import bounding, hopping
from spear_pin.studies.payoff.figures import Figures, most
from spear_pin.studies.payoff.grid import Point
from spear_pin.studies.payoff.motors import PARTS, Motors, assume_motor, known
from spear_pin.studies.prose import read

GAITS = HOP, BOUND = "hop", "bound"
SPEED = 2.0  # m/s, of the bound


def load_gait(gait: str, kind: str) -> Gait:
    """Loads the gait with a kind of knee, from its file beside this module."""
    return Gait.load(Path(str(files(__package__).joinpath(f"{gait}_{kind}.json"))))


@kept
def figures(gait: str, kind: str) -> Figures:
    """Returns the figures of the gait with a kind of knee."""
    found = load_gait(gait, kind)
    if gait == HOP:
        robot = load("spear_ii", locked=["boom_x"])
        return hopping.figures_of(found, motors(gait), samples=hopping.FINER, own=robot)
    return bounding.figures_of(
        found, motors(gait), bounding.request(found.system.robot, Point(kind, SPEED), motors(gait))
    )


@kept
def motors(gait: str) -> Motors:
    """Returns SPEAR-II's motors, or those of the bound, assumed by what a gait without springs takes."""
    if gait == HOP:
        found = [known(load("spear_ii", locked=["boom_x"]), part) for part in PARTS]
        knee, hip = (drive for drive, _ in filter(None, found))
    else:
        takes = read(__package__, "motors.toml")
        knee, hip = (assume_motor(load("q_spear"), part, *takes[part]) for part in PARTS)
    return Motors(knee, hip, own=PARTS)


def peak(gait: str, kind: str) -> float:
    """Returns the largest torque of a knee's motor, in N·m."""
    return most(figures(gait, kind).peak, "knee")
