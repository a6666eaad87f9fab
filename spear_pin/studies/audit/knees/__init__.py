"""What a spring in the knee saves: the cheapest gait that was found with each kind of knee.

A payoff study found them: SPEAR-II's hop with 0.2 s of flight, for which it chose the knee's motor and gears, too, and
Q-SPEAR's bound at 2 m/s. Their files are beside this module, with what the assumed motors of the bound have to do.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from spear_pin.gaits.gait import Gait
from spear_pin.model.loading import load
from spear_pin.studies.audit.prose import read
from spear_pin.studies.audit.runs import kept
from spear_pin.studies.payoff import bounding, hopping
from spear_pin.studies.payoff.figures import Figures
from spear_pin.studies.payoff.grid import FIXED, KINDS, NONE, SWITCHED, Point
from spear_pin.studies.payoff.motors import PARTS, Motors, assume_motor, known

GAITS = HOP, BOUND = "hop", "bound"
SPEED = 2.0  # m/s, of the bound


def path(gait: str, kind: str) -> Path:
    """Returns the file of the gait with a kind of knee."""
    return Path(str(files(__package__).joinpath(f"{gait}_{kind}.json")))


@kept
def figures(gait: str, kind: str) -> Figures:
    """Returns the figures of the gait with a kind of knee."""
    found = Gait.load(path(gait, kind))
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
        takes = read("knees/motors.toml")
        knee, hip = (assume_motor(load("q_spear"), part, *takes[part]) for part in PARTS)
    return Motors(knee, hip, own=PARTS)


def costs(gait: str) -> tuple[float, ...]:
    """Returns the electricity over the work, without a spring, with a fixed and with a switchable one."""
    return tuple(figures(gait, kind).cost for kind in KINDS)


def switchable_over_none() -> tuple[float, ...]:
    """Returns the electricity of hop and bound, then the knee's peak torque, each over that without a spring."""
    pairs = [(figures(gait, SWITCHED), figures(gait, NONE)) for gait in GAITS]
    return (*(own.cost / bare.cost for own, bare in pairs), *(_peak(own) / _peak(bare) for own, bare in pairs))


def switchable_over_fixed() -> tuple[float, ...]:
    """Returns the electricity of the hop and of the bound over that with a fixed spring."""
    return tuple(figures(gait, SWITCHED).cost / figures(gait, FIXED).cost for gait in GAITS)


def motors_chosen() -> tuple[float, ...]:
    """Returns the size of the hop's knee motor, then its rms over its continuous torque, by `KINDS`."""
    found = [figures(HOP, kind) for kind in KINDS]
    sizes = (Gait.load(path(HOP, kind)).system.robot.varied["knee_motor_size"] for kind in KINDS)
    return (*sizes, *(each.heat["knee"] for each in found))


def _peak(found: Figures) -> float:
    """Returns the largest torque of a knee's motor, in N·m."""
    return max(torque for joint, torque in found.peak.items() if joint.endswith("knee"))
