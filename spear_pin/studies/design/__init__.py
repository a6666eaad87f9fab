"""Design questions of the source's Chapter 5: springs, gears and motors for the torques of bounding.

Torques and stiffnesses here are those of one leg and its motor, half of the sagittal model's pair.
"""

from spear_pin.studies.design.drive_choice import Design, codesign, smallest_violation
from spear_pin.studies.design.envelopes import EnvelopeUse, against, electrical_cost
from spear_pin.studies.design.families import Member, family
from spear_pin.studies.design.operating_points import (
    STIFFNESSES,
    Points,
    joints_of,
    motors_of,
    points,
    points_of,
    spring_sweep,
    sprung,
)

__all__ = [
    "STIFFNESSES",
    "Design",
    "EnvelopeUse",
    "Member",
    "Points",
    "against",
    "codesign",
    "electrical_cost",
    "family",
    "joints_of",
    "motors_of",
    "points",
    "points_of",
    "smallest_violation",
    "spring_sweep",
    "sprung",
]
