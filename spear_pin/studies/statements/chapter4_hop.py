"""Statements of Sections 4.2 and 4.3: the hop in place."""

from __future__ import annotations

from spear_pin.studies import printed_model
from spear_pin.studies.reference import FLIGHT_TIME
from spear_pin.studies.statements import hop_numbers as hop
from spear_pin.studies.statements.criteria import above, below, first, near
from spear_pin.studies.statements.push_numbers import SPEED
from spear_pin.studies.statements.statement import Statement

OWN = ("touchdown", "stance-torque", "friction")
RIG = (*OWN, "knee-motor", "hip-motor", "supply")

STATEMENTS = (
    Statement(
        "flight-law-sign",
        "(4.9), (4.10)",
        "In flight the joints get K (θ - θ_des) + K_D θ̇ with K > 0 > K_D.",
        "largest growth rate in flight, as printed and corrected",
        printed_model.flight_growth,
        "1/s",
        criterion=first(below(0.0)),
        remark="The proportional term pushes away from the commanded angle.",
        assumes=("touchdown",),
    ),
    Statement(
        "settles-in-flight",
        "Section 4.2.2",
        "The gains bring both joints to rest at the commanded angles within the flight.",
        "times to 2 % of the two modes, signs corrected",
        printed_model.settling_times,
        "s",
        criterion=below(FLIGHT_TIME),
        assumes=("touchdown",),
        exhibit="fig-4.10",
    ),
    Statement(
        "knee-flat-before-touchdown",
        "Fig. 4.10",
        "The knee is at the commanded angle and at rest before touchdown.",
        "knee's rate at touchdown",
        hop.knee_rate_at_touchdown,
        "rad/s",
        criterion=below(0.1),
        assumes=OWN,
        exhibit="fig-4.10",
    ),
    Statement(
        "gains-by-classical-tuning",
        "Sections 4.2.1, 4.2.2",
        "The gains, 54.77 and 63.25 N·m/rad, were found by classical tuning.",
        "their squares",
        hop.squared_gains,
        "(N·m/rad)²",
        unknown="They are the roots of 3000 and 4000 to the last digit, as a quadratic regulator with such weights "
        "gives; "
        "how they were found is not described.",
    ),
    Statement(
        "fixed-point",
        "(4.11), (4.12)",
        "A continual hop exists as a fixed point of the return map.",
        "residual of the fixed point",
        hop.fixed_point_residual,
        criterion=below(1e-9),
        assumes=OWN,
        exhibit="fig-4.10",
    ),
    Statement(
        "natural-limit-cycle",
        "Sections 4.2.2, 4.3",
        "The controller stabilises the hop.",
        "magnitude of the largest Floquet multiplier",
        hop.largest_multiplier,
        criterion=below(1.0),
        assumes=OWN,
        exhibit="fig-4.13",
    ),
    Statement(
        "flight-time",
        "Section 4.2.2",
        "Flight lasts about 0.2 s.",
        "duration of flight",
        hop.flight_time,
        "s",
        FLIGHT_TIME,
        unknown="By construction: the stance torque, which is not printed, is solved for it. That there is such a hop "
        "is the finding.",
        assumes=OWN,
        exhibit="fig-4.10",
    ),
    Statement(
        "half-waves",
        "(4.10), Section 4.2.2",
        "f is 2.56 Hz: the torque flexes in the first half of stance and extends in the second.",
        "duration of stance in periods 1/f",
        hop.stance_in_periods,
        unknown="The source's hop is not printed. 1/f would be the whole stance; the hop here ends a little before, "
        "and others "
        "at just that time.",
        assumes=OWN,
        exhibit="fig-4.10",
    ),
    Statement(
        "spring-does-most",
        "Section 4.2.1",
        "The spring does most of the work of stance.",
        "its share of the push at the knee",
        hop.push_share_of_spring,
        criterion=above(0.5),
        assumes=OWN,
        exhibit="fig-4.10",
    ),
    Statement(
        "peak-speed",
        "Section 4.1.5.3",
        "Hopping reaches peak speeds of 20 rad/s.",
        "largest rate of the knee",
        hop.peak_knee_rate,
        "rad/s",
        SPEED,
        unknown="Heights and angles of the experiments are not printed; a hop of the stated flight time is far slower.",
        assumes=OWN,
    ),
    Statement(
        "experiment-matches",
        "Section 4.3, Fig. 4.11",
        "The measured knee angle follows the simulated one.",
        unknown="The curves are not printed as numbers. The panel shows our hop on disturbed hardware beside the "
        "ideal one.",
        assumes=(*RIG, "disturbances"),
        exhibit="fig-4.11",
    ),
    Statement(
        "current-saturates",
        "Section 4.3, Fig. 4.12",
        "On the robot the commanded current is limited.",
        "share of the time in which the knee's current is at its limit",
        hop.saturated_share,
        unknown="The limit is not printed.",
        assumes=(*RIG, "disturbances"),
        exhibit="fig-4.12",
    ),
    Statement(
        "low-then-high",
        "Section 4.3, Fig. 4.13",
        "A hop that is too low is followed by a higher one.",
        "the leading Floquet multiplier",
        hop.leading_multiplier,
        criterion=below(0.0),
        remark="Negative: a deviation changes its sign from hop to hop.",
        assumes=OWN,
        exhibit="fig-4.13",
    ),
    Statement(
        "hopping-goes-on",
        "Section 4.3, Fig. 4.13",
        "Eleven hops go on despite disturbances of states and commands.",
        "whole hops on disturbed hardware",
        hop.hops_completed,
        printed=11.0,
        criterion=near(11.0, 0.0),
        remark="One run of one seed; of 200 others 199 go on (docs/hardware.md).",
        assumes=(*RIG, "disturbances"),
        exhibit="fig-4.13",
    ),
    Statement(
        "apexes-vary",
        "Section 4.3, Fig. 4.13",
        "Apex heights vary because of friction and the boom.",
        "from the lowest to the highest apex on disturbed hardware",
        hop.apex_spread,
        "m",
        unknown="The heights are not printed; here noise and lost commands of an assumed size make them vary.",
        assumes=(*RIG, "disturbances"),
        exhibit="fig-4.13",
    ),
    Statement(
        "losses-in-the-drive",
        "Section 4.1.1, Fig. 4.1",
        "Part of the batteries' energy is lost in windings and gears before it reaches the joints.",
        "share of what the batteries give on balance",
        hop.motor_losses_share,
        unknown="The source has no shares, and that there are losses needs no proof. How large they are here rests on "
        "the motors assumed.",
        assumes=RIG,
        exhibit="fig-4.1",
    ),
    Statement(
        "regeneration",
        "Section 1.2, Fig. 4.1",
        "Regenerative braking gives back 24 % with the best motors.",
        "what the batteries get back of a hop's energy over what they give",
        hop.regained_share,
        printed=0.24,
        unknown="It is another robot's number; the source has none for this one.",
        assumes=RIG,
        exhibit="fig-4.1",
    ),
)
