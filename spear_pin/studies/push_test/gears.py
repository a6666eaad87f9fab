"""The release with other gear ratios at the knee, as in Figs. 4.5 and 4.6."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from spear_pin.kinds import typed
from spear_pin.studies.push_test.oscillation import Swing, swing
from spear_pin.studies.push_test.passive_knee import WITH_MOTOR, WITHOUT_MOTOR, PassiveKnee
from spear_pin.studies.push_test.releases import Release, release
from spear_pin.studies.push_test.rest import rest_at, spear_ii

RATIOS = (None, 15.0, 30.0, 66.0)  # of Fig. 4.6


@dataclass(frozen=True)
class GearRow:
    """One gear ratio of the study of Figs. 4.5 and 4.6.

    Attributes:
        ratio: gear ratio; None without motor.
        rotor: its inertia reflected to the knee, in kg·m².
        knee: torque law of the knee.
        swing: the small oscillation.
        release: the motion.
    """

    ratio: float | None
    rotor: float
    knee: PassiveKnee
    swing: Swing
    release: Release


@typed
def gear_study(
    ratios: Iterable[float | None] = RATIOS,
    depth: float = 0.10,
    static_rest: bool = False,
    duration: float = 1.5,
    engaged: PassiveKnee = WITH_MOTOR,
    disengaged: PassiveKnee = WITHOUT_MOTOR,
) -> list[GearRow]:
    """Simulates one release with each gear ratio, as in Fig. 4.6.

    Args:
        ratios: turns of the rotor per turn of the knee; None without motor.
        depth: depth of the push, in m.
        static_rest: whether the knees' zeros are meant as the angle at rest.
        duration: duration of the motions, in s.
        engaged: the knee with motor, for every ratio (default: Table 4.1, with motor, 10 cm).
        disengaged: the knee without (default: Table 4.1, no motor, 10 cm).

    Raises:
        BadValue: a ratio is not a number > 0 or None, or the leg cannot go that deep.
    """
    rows = []
    for ratio in ratios:
        leg, knee = spear_ii(ratio), disengaged if ratio is None else engaged
        if static_rest:
            knee = rest_at(leg, knee, knee.zero)
        rows.append(GearRow(ratio, leg.rotor, knee, swing(leg, knee), release(leg, knee, depth, duration)))
    return rows
