"""Figures of the report: the source's figure that each shows, and the function that draws it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from spear_pin.viz.plots import source as source_plots
from spear_pin.viz.report import drawings


@dataclass(frozen=True)
class Picture:
    """A figure of the report.

    Attributes:
        id: name by which statements and files refer to it.
        place: figures of the source that it shows.
        caption: caption.
        shows: contents of the source's figure, in words of our own.
        draw: a function of a module that draws it.
        assumes: ids of the assumptions that it uses.
    """

    id: str
    place: str
    caption: str
    shows: str
    draw: Callable[[], Figure]
    assumes: tuple[str, ...] = ()


HOP = ("touchdown", "stance-torque", "friction")
RIG = (*HOP, "knee-motor", "hip-motor", "supply")
ROUGH = (*RIG, "disturbances")
BOUND = ("bound", "virtual-stiffness", "torso-length", "friction")

PICTURES: dict[int, tuple[Picture, ...]] = {
    2: (
        Picture(
            "fig-2.1",
            "Fig. 2.1",
            "Torque of the switchable spring with the key engaged and disengaged. K₂ is taken as 1 % of K₁.",
            "A schematic of the mechanism, with the stiffness of the joint switched by the key.",
            source_plots.switched_spring,
            ("soft-spring",),
        ),
        Picture(
            "fig-2.4",
            "Fig. 2.4",
            "Cost of transport over mass: published points, how far each is verified, and the bound computed here.",
            "Robots and animals, with SPEAR-I on the line of running animals.",
            drawings.transport,
            ("costs", "prospective-motors", *BOUND),
        ),
        Picture(
            "fig-2.9",
            "Fig. 2.9",
            "Thigh and its centre of mass about the hip axis; 318 mm are SPEAR-II's, SPEAR-I's length is not printed.",
            "The thigh's centre of mass before and after moving the knee motor.",
            source_plots.balance,
        ),
        Picture(
            "table-2.4",
            "Tables 2.2 and 2.4",
            "What became of each number of SPEAR-I in SPEAR-II.",
            "Masses, inertias, distances and gears of both legs.",
            source_plots.design_metrics,
        ),
    ),
    3: (
        Picture(
            "fig-3.2",
            "Fig. 3.2, (3.14), (3.15)",
            "Inertia and weight that the knee feels in the push test, by the equations as printed and corrected.",
            "The model in stance, with torques, spring and damper at the knee; in flight spring and damper are absent.",
            source_plots.printed_model,
        ),
    ),
    4: (
        Picture(
            "fig-4.1",
            "Fig. 4.1",
            "Energy of a hop from the batteries to the ground, in J a hop and in % of what they give.",
            "A diagram of wanted flows and losses, without numbers.",
            drawings.energy,
            RIG,
        ),
        Picture(
            "fig-4.2",
            "Figs. 4.2 and 4.3",
            "The leg at rest and pushed down, and hip height and hip angle by the knee's angle.",
            "The leg as a crank and slider, held down by a force and let go.",
            source_plots.crank_slider,
            ("rest-angle",),
        ),
        Picture(
            "fig-4.3",
            "Fig. 4.3",
            "Releases with the estimates of Table 4.1. Where the pin pulls on the ground, a free toe would lift off.",
            "The procedure: pushed down, held, let go.",
            drawings.releases,
            ("rest-angle",),
        ),
        Picture(
            "fig-4.4",
            "Fig. 4.4",
            "The model fitted to SYNTHETIC records, made from the estimates of Table 4.1; the source's are not public.",
            "Six panels of measured knee angles and fitted models, with and without motor, by depth.",
            drawings.fits,
            ("records", "rest-angle"),
        ),
        Picture(
            "table-4.1",
            "Tables 4.1 and 4.2",
            "Stiffness and damping of Table 4.1, their mean, and what Table 4.2 prints for it.",
            "Estimates by depth and their averages.",
            source_plots.source_comparison,
        ),
        Picture(
            "fig-4.6",
            "Figs. 4.5 and 4.6",
            "The release from 10 cm without motor and with three gear ratios, and the rotor's share in what swings.",
            "Fig. 4.5: records and models with motor and without; Fig. 4.6: models of 15:1, 30:1 and 66:1.",
            drawings.gears,
            ("rest-angle",),
        ),
        Picture(
            "fig-4.7",
            "Fig. 4.7",
            "Height of the boom after the release with the motor idling; the shorted motor is not in the source.",
            "Records without motor, with the motor's supply off, and with it on.",
            drawings.idling,
            ("knee-motor", "supply", "rest-angle"),
        ),
        Picture(
            "fig-4.8",
            "Figs. 4.8 and 4.9",
            "Back-EMF of the knee motor, and the current it drives through the bridge in each state.",
            "Circuits of a simple and of a three-phase bridge.",
            drawings.bridge,
            ("knee-motor", "supply"),
        ),
        Picture(
            "fig-4.10",
            "Fig. 4.10",
            "The hop in place, solved as a fixed point: height, energy, angles, force and torque.",
            "The knee's angle over the periodic hop, flat before touchdown.",
            drawings.hop,
            HOP,
        ),
        Picture(
            "fig-4.11",
            "Fig. 4.11",
            "Hip and knee on simulated, disturbed hardware beside the ideal hop. Nothing here is measured.",
            "Measured joint angles of hopping, with the simulated knee over them.",
            drawings.experiment_angles,
            ROUGH,
        ),
        Picture(
            "fig-4.12",
            "Fig. 4.12",
            "Currents on simulated, disturbed hardware, asked for and actual.",
            "Measured and reference currents of hopping.",
            drawings.experiment_currents,
            ROUGH,
        ),
        Picture(
            "fig-4.13",
            "Fig. 4.13",
            "Height of the hip over eleven hops on simulated, disturbed hardware.",
            "Measured height of the boom over eleven hops of varying apex.",
            drawings.experiment_heights,
            ROUGH,
        ),
    ),
    5: (
        Picture(
            "fig-5.4",
            "Figs. 5.2, 5.3 and 5.4",
            "A bound of this package: foot-falls and phases, torso, ground forces and torques.",
            "Foot-falls, coordinates, and the cycle of four phases and four events.",
            drawings.bound,
            BOUND,
        ),
        Picture(
            "fig-5.5",
            "Fig. 5.5",
            "Bound of this package: torque of one knee motor with a spring of 56 N·m/rad a leg, and without.",
            "The same for the source's gait, front (a) and back (b).",
            drawings.compliance,
            BOUND,
        ),
        Picture(
            "fig-5.6",
            "Fig. 5.6",
            "The same bound: torque of one knee motor in stance for springs from 0 to 400 N·m/rad.",
            "Knee torques with 0, 56, 200, 300 and 400 N·m/rad; that of 200 is flat.",
            drawings.stiffness,
            BOUND,
        ),
        Picture(
            "fig-5.7",
            "Fig. 5.7",
            "The same bound: torque of one hip motor, front and back, and its root mean square.",
            "Hip torques, front and back, beyond the present drive.",
            drawings.hips,
            BOUND,
        ),
        Picture(
            "fig-5.8",
            "Fig. 5.8",
            "The same bound: torque and speed of the knee motors against drives of 100, 260 and 600 W.",
            "Points of the knees with the limits of 260 W and 600 W, those of continuous duty dashed.",
            drawings.torque_speed,
            (*BOUND, "prospective-motors", "knee-motor", "supply"),
        ),
    ),
}

NOTHING_TO_COMPUTE = {  # figures and tables of chapters 2 to 5 that hold no number
    "Table 2.1": "goals of the redesign, in words",
    "Fig. 2.2": "the foot with its tooth, drawn and photographed",
    "Fig. 2.3": "photograph of SPEAR-I",
    "Fig. 2.5": "rendering of a quadruped with SPEAR-I's legs",
    "Figs. 2.6, 2.7": "SPEAR-II, rendered and photographed, beside SPEAR-I",
    "Fig. 2.8": "rendering of both motors",
    "Fig. 2.10": "photograph of the belts",
    "Fig. 2.11": "rendering of the foot",
    "Fig. 2.12": "photograph of an earlier mount",
    "Section 2.4.5": "diagram of the electronics, without a number",
    "Table 2.3": "goals, improvements and drawbacks, in words",
    "Fig. 3.1": "photograph and abstraction of the leg",
    "Fig. 5.1": "rendering of the quadruped",
}
