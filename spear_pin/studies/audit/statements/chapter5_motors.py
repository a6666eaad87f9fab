"""Statements of Section 5.4: hip and knee motors of the quadruped."""

from __future__ import annotations

from functools import partial

from spear_pin.studies.audit import printed_designs
from spear_pin.studies.audit.statements import bound_numbers as bound
from spear_pin.studies.audit.statements.chapter5 import OWN
from spear_pin.studies.audit.statements.criteria import below, rising
from spear_pin.studies.audit.statements.statement import Statement

MOTORS = (*OWN, "prospective-motors")
HIPS = "The type of the hip motor is not printed, nor what supplies the quadruped. The one assumed "

STATEMENTS = (
    Statement(
        "hip-drive-exceeded",
        "Section 5.4, Fig. 5.7",
        "The present hip motors cannot give these torques.",
        "largest share of a stride outside the envelope at 60:1",
        partial(bound.hip_time_outside, 60.0),
        unknown=HIPS + "is outside on 24 V, SPEAR-II's; on 48 V this gait would be within reach.",
        assumes=(*OWN, "hip-motor", "supply"),
        exhibit="fig-5.7",
    ),
    Statement(
        "doubled-hip-gears",
        "Section 5.4",
        "Doubling the hip's gears to 120:1 is the remedy.",
        "largest share of a stride outside the envelope at 120:1",
        partial(bound.hip_time_outside, 120.0),
        unknown=HIPS + "is outside on 24 V and on 48 V: the torque doubles, and the speed halves.",
        assumes=(*OWN, "hip-motor", "supply"),
        exhibit="fig-5.7",
    ),
    Statement(
        "hip-inertia-no-concern",
        "Section 5.4",
        "With doubled gears, reflected inertia is not as much a concern at the hip as at the knee.",
        "the hip's rotor at 120:1, and the straight leg about the hip",
        partial(printed_designs.hip_against_leg, 120.0),
        "kg·m²",
        unknown="By what they are compared is not said. The rotor would outweigh the leg that it moves, 1.6 to 1, "
        "about as the knee's does its shank, 1.8 to 1; in kg·m² it is seven times the knee's.",
        exhibit="fig-5.7",
    ),
    Statement(
        "hip-effort-small",
        "Section 5.4",
        "The hips' effort is small beside that of the knees.",
        "rms torque of a hip motor over its leg's knee motor, posterior and anterior",
        bound.hip_over_knee,
        criterion=below(0.5),
        remark="The posterior hips drive the robot forward: in every shipped gait they exceed their knees.",
        assumes=OWN,
        exhibit="fig-5.7",
    ),
    Statement(
        "too-little-100-w",
        "Section 5.4, Fig. 5.8",
        "The present 100 W motor is not enough at the knee.",
        "largest share of a stride outside the envelope",
        partial(bound.knee_time_outside, "100 W"),
        unknown="Neither what supplies the quadruped nor the motor's resistance is printed. On 48 V another gait of "
        "this package at this speed is within reach, at many times the continuous torque assumed.",
        assumes=(*OWN, "knee-motor", "supply"),
        exhibit="fig-5.8",
    ),
    Statement(
        "nearly-260-w",
        "Section 5.4, Fig. 5.8",
        "Of a 260 W motor a few points are out of reach.",
        "largest share of a stride outside the envelope",
        partial(bound.knee_time_outside, "260 W"),
        unknown="Neither the gait nor the motor meant is printed. Another gait of this package at this speed is within "
        "reach of the one assumed.",
        assumes=MOTORS,
        exhibit="fig-5.8",
    ),
    Statement(
        "near-the-events",
        "Section 5.4, Fig. 5.8",
        "These lie just after touchdown and just before lift-off.",
        "share of them within 20 ms of either, in long_stride and force_lift_off; least_effort has none outside",
        bound.outside_near_events,
        unknown="Neither the gait nor the motor meant is printed. With the one assumed, most of them do in one of "
        "three gaits of this package; of a stance a little more than half is that near.",
        assumes=MOTORS,
        exhibit="fig-5.8",
    ),
    Statement(
        "because-of-preload",
        "Section 5.4",
        "The preload ū is what takes them out of reach.",
        "share of the points outside in stance that are outside without ū, too",
        bound.outside_without_preload,
        unknown="It depends on the gait: of those of this package that are outside, ū decides for most points in some, "
        "and in others the speed, near or above the drive's speed without load.",
        assumes=MOTORS,
        exhibit="fig-5.8",
    ),
    Statement(
        "enough-600-w",
        "Section 5.4, Fig. 5.8",
        "A 600 W motor reaches every point.",
        "largest share of a stride outside the envelope of the motor assumed",
        partial(bound.knee_time_outside, "600 W"),
        unknown="Which motor is meant is not printed. The one assumed has the 260 W motor's speed and is outside at "
        "15:1.",
        assumes=MOTORS,
        exhibit="fig-5.8",
    ),
    Statement(
        "similar-260-w",
        "Section 5.4",
        "The 260 W motor has about the inertia of the present one.",
        "rotor inertia of an EC 90 flat of 260 W over that of an EC 60 flat of 100 W",
        bound.rotor_ratio,
        unknown="Which motor is meant is not printed; that of this power which is assumed has four times the inertia.",
        assumes=("prospective-motors", "knee-motor"),
        exhibit="fig-5.8",
    ),
    Statement(
        "spring-leaves-hips",
        "Section 5.4",
        "The spring at the knee has little, if any, effect on what the hip motors have to give.",
        "largest difference of a hip motor's torque with a spring of 200 N·m/rad and with none",
        bound.hip_difference,
        "N·m",
        criterion=below(1e-3),
        built="The motion and the total torque at the knee are the gait's, whatever the spring.",
        remark="Gaits found anew with a stiffer spring have smaller hip torques here (docs/results/design.md).",
        assumes=OWN,
        exhibit="fig-5.7",
    ),
    Statement(
        "less-preload-by-angle",
        "Section 5.4",
        "Other touchdown angles may do with less preload ū.",
        "ū of one motor, posterior and anterior, in long_stride and in least_effort, which lands at other angles",
        bound.preloads,
        "N·m",
        unknown="More than the angles differs between any two gaits that were found, and the source gives none.",
        assumes=OWN,
    ),
    Statement(
        "less-preload-by-friction",
        "Section 5.4",
        "More friction between toe and ground allows for less preload ū.",
        "friction that the posterior stance needs, with ū and with nine tenths of it",
        bound.friction_by_preload,
        criterion=rising(),
        remark="From the same touchdown; not another periodic gait.",
        assumes=OWN,
    ),
    Statement(
        "torso-before-gears",
        "Section 5.3",
        "The torso's inertia matters more than the knee's gear ratio.",
        unknown="The simulations that show it are not described, nor by what it was measured; by peak knee torque it "
        "holds for "
        "gaits of this package, by effort it does not (docs/results/design.md).",
        assumes=OWN,
    ),
)
