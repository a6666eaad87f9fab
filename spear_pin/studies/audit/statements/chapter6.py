"""Statements of Chapter 6: conclusions and future work; repetitions of an earlier chapter are listed there."""

from __future__ import annotations

from functools import partial

from spear_pin.studies.audit import printed_designs
from spear_pin.studies.audit.statements import bound_numbers as bound
from spear_pin.studies.audit.statements import turn_numbers as turns
from spear_pin.studies.audit.statements.chapter5 import OWN
from spear_pin.studies.audit.statements.criteria import above, below
from spear_pin.studies.audit.statements.statement import Statement

STATEMENTS = (
    Statement(
        "rotor-a-drawback",
        "Section 6.1, Table 2.4",
        "SPEAR-II's knee has a larger reflected rotor inertia than SPEAR-I's.",
        "SPEAR-II over SPEAR-I",
        partial(printed_designs.improvement, "knee_inertia"),
        criterion=above(1.0),
        exhibit="table-2.4",
    ),
    Statement(
        "minor-modifications",
        "Section 6.1",
        "With some very minor modifications SPEAR-II is likely to do for a quadruped.",
        "largest torque of a knee motor in the bound over that in the hop, posterior and anterior",
        bound.peak_over_hop,
        unknown="What is minor is not said. The section itself asks for stronger motors, stiffer springs and a "
        "stronger foot, and Section 5.4 for other gears at the hip.",
        assumes=(*OWN, "touchdown", "stance-torque", "friction"),
    ),
    Statement(
        "feasible-as-it-is",
        "Section 6.2.1",
        "Chapter 5 shows that the present hardware is feasible for the quadruped.",
        "largest share of a stride that the present knee motor is outside its envelope",
        partial(bound.knee_time_outside, "100 W"),
        unknown="Section 5.4 says the opposite of the knee's and of the hip's motor. Which is right hangs on the "
        "gait, the supply and the motors, which are not printed.",
        assumes=(*OWN, "knee-motor", "supply"),
    ),
    Statement(
        "adduction-is-slow",
        "Section 6.2.1",
        "Adduction for banked turns asks for little speed and range.",
        "largest speed of an adduction over a knee's in turns by 11, 25 and 35°/s at 2.5 m/s, and by 25°/s at 2.25 and "
        "2.75 m/s, then range over a knee's",
        turns.adduction_over_knee,
        criterion=below(0.2),
        unknown="The source describes no turn. In these, which are ours, without torque at the "
        "adductions on the ground but a constant, it holds by a wide margin.",
        remark="Torque of an adduction is up to a sixth of a knee's. What pays for a turn is the hip, and friction. "
        "The robot hardly banks: its feet land to the outside.",
        assumes=("turn", "torso-length"),
    ),
    Statement(
        "biped-motors",
        "Section 6.2.4",
        "A biped of two SPEAR-II legs would likely do with the present motors.",
        "mass that one of its legs bears at a time, over that of the monopod with its boom",
        printed_designs.biped_over_monopod,
        unknown="Neither the biped's torso nor its gait is in the source. The shipped one runs at 1 m/s in "
        "examples/biped.py, with a law and a torso of its own.",
        assumes=("biped",),
    ),
)
