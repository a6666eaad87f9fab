"""The measures of a cycle: one table of names, units and sentences, for samples, derivatives and pages alike.

Torques are those of one motor: in the sagittal plane a joint stands for two legs, and two motors share its torque.
Work, energies and the effort are those of all motors of the robot. Forces act on a toe of the model; in the sagittal
plane that is on both feet of a pair. Without its joint or toe a name stands for the largest value over all of them.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from spear_pin.errors import UnknownName

PRESSED = 0.02  # share of a toe's even share of the weight above which friction counts
LEAST_STRIDE = 1e-3  # m: a shorter stride transports nothing


class Named(NamedTuple):
    """A measure, or measures of one kind for joints, toes, phases or events.

    Attributes:
        pattern: pattern of the names.
        unit: unit of the measure, "1" without one.
        text: meaning of the measure, in a sentence.
    """

    pattern: str
    unit: str
    text: str


CATALOGUE: tuple[Named, ...] = (
    Named("PHASE_time", "s", "Duration of a phase."),
    Named("period", "s", "Duration of a cycle."),
    Named(
        "EVENT_height", "m", "Height of the base at an event that is recorded but changes nothing, such as the apex."
    ),
    Named("JOINT_rate_at_SECTION", "rad/s", "Speed of a joint just before the cycle closes."),
    Named("JOINT_at_SECTION", "rad", "Angle of a joint where the cycle closes."),
    Named("stride", "m", "Distance covered in a cycle."),
    Named("mean_speed", "m/s", "Distance covered in a cycle, divided by its period."),
    Named("turn", "rad", "Change of the heading in a cycle, to the left."),
    Named("work", "J", "Work of all motors on the joints in a cycle, braking counted as negative."),
    Named("positive_work", "J", "Work of all motors in a cycle where they drive: ∫ Σ max(u ω, 0) dt."),
    Named("absolute_work", "J", "Absolute work of all motors in a cycle: ∫ Σ |u ω| dt."),
    Named("cost_of_transport", "1", "Absolute work divided by the robot's weight and the distance covered."),
    Named("cost_of_transport_positive", "1", "Positive work divided by the robot's weight and the distance covered."),
    Named("effort", "N²·m²·s", "∫ Σ u² dt over a cycle and all motors, u the torque of one motor."),
    Named("effort_per_distance", "N²·m·s", "The effort divided by the distance covered."),
    Named("rms_torque_JOINT", "N·m", "Root mean square of the torque of one motor over a cycle."),
    Named("peak_torque_JOINT", "N·m", "Largest absolute torque of one motor."),
    Named("peak_speed_JOINT", "rad/s", "Largest absolute speed of a joint."),
    Named("greatest_height_TOE", "m", "Greatest height of a toe above the ground between lift-off and touchdown."),
    Named("least_JOINT", "rad", "Least angle of a joint."),
    Named("greatest_JOINT", "rad", "Greatest angle of a joint."),
    Named("peak_force_TOE", "N", "Largest normal force on a toe; in the sagittal plane on both feet of a pair."),
    Named(
        "friction_used_TOE",
        "1",
        "Largest ratio of the force along the ground to the normal force, while the toe carries at least 2 % of its"
        " even share of the weight: m g divided by the number of toes.",
    ),
    Named(
        "deflection_JOINT",
        "rad",
        "Deflection of a spring when it releases; if it releases several times, the smallest.",
    ),
    Named("heat_JOINT", "J", "Heat of the windings of all motors of a joint in a cycle."),
    Named("energy", "J", "Work and heat of all motors in a cycle."),
    Named("electricity_JOINT", "J", "Electricity that all motors of a joint take in a cycle; none is given back."),
    Named("electricity", "J", "Electricity that all motors take in a cycle; none is given back."),
    Named("reserve_JOINT", "N·m", "Smallest torque that one motor still has in reserve, at the joint."),
    Named("multiplier_N", "1", "Modulus of a Floquet multiplier, by decreasing size."),
)
PLACES = re.compile(r"[A-Z]{2,}|(?<=_)N$")


def described(name: str) -> Named:
    """Returns what a measure means, by its name.

    Raises:
        UnknownName: the table has no measure with that name.
    """
    for each in CATALOGUE:
        if re.fullmatch(PLACES.sub("\\\\w+", each.pattern), name):
            return each
    raise UnknownName("measure", name, [each.pattern for each in CATALOGUE])
