"""The push test of Section 4.1: the leg is pushed down, held, and let go; and the knee's motion after that."""

from spear_pin.studies.push_test.gears import RATIOS, GearRow, gear_study
from spear_pin.studies.push_test.motion import simulate_release
from spear_pin.studies.push_test.oscillation import BeltFrequencies, Swing, belt_frequencies, swing
from spear_pin.studies.push_test.passive_knee import WITH_MOTOR, WITHOUT_MOTOR, PassiveKnee
from spear_pin.studies.push_test.releases import DEPTHS, RATE, Release, release
from spear_pin.studies.push_test.rest import equilibrium, find_pushed_angle, rest_at, spear_ii

__all__ = [
    "DEPTHS",
    "RATE",
    "RATIOS",
    "WITHOUT_MOTOR",
    "WITH_MOTOR",
    "BeltFrequencies",
    "GearRow",
    "PassiveKnee",
    "Release",
    "Swing",
    "belt_frequencies",
    "equilibrium",
    "gear_study",
    "find_pushed_angle",
    "release",
    "rest_at",
    "simulate_release",
    "spear_ii",
    "swing",
]
