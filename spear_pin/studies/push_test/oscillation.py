"""The small oscillation of the knee about its rest: frequency and damping, and both modes with an elastic belt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from spear_pin.errors import require
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.push_test.passive_knee import PassiveKnee
from spear_pin.studies.push_test.rest import equilibrium


@dataclass(frozen=True)
class Swing:
    """The small oscillation about the static equilibrium, with linear damping.

    Attributes:
        frequency: undamped frequency, in Hz.
        damped_frequency: damped frequency, in Hz; 0 where it does not oscillate.
        damping_ratio: ζ.
        rotor_share: share of the rotor in the effective inertia there.
    """

    frequency: float
    damped_frequency: float
    damping_ratio: float
    rotor_share: float


@dataclass(frozen=True)
class BeltFrequencies:
    """Undamped frequencies of the small oscillation, in Hz, by the model of the belt.

    Attributes:
        rigid: a rigid belt; the rotor moves with the knee.
        parallel: the belt added to the spring, and the rotor still moving with the knee: the source's reading.
        locked: the belt added to the spring, and the rotor standing still.
        low: the belt in series with a floating rotor: the slower mode.
        high: the same: the faster mode.
    """

    rigid: float
    parallel: float
    locked: float
    low: float
    high: float


@typed
def swing(leg: PinnedLeg, knee: PassiveKnee) -> Swing:
    """Returns the small oscillation about the static equilibrium.

    Raises:
        BadValue: the leg does not rest on its spring.
    """
    rest = equilibrium(leg, knee)
    inertia = float(leg.effective_inertia(rest))
    stiffness = knee.stiffness + float(leg.motion_with_slopes(rest)[5])
    undamped = np.sqrt(stiffness / inertia)
    ratio = (knee.damping + float(leg.drag(rest)[0])) / (2.0 * np.sqrt(stiffness * inertia))
    return Swing(
        frequency=float(undamped / (2 * np.pi)),
        damped_frequency=float(undamped * np.sqrt(max(1.0 - ratio**2, 0.0)) / (2 * np.pi)),
        damping_ratio=float(ratio),
        rotor_share=leg.rotor / inertia,
    )


@typed
def belt_frequencies(leg: PinnedLeg, knee: PassiveKnee, belt: float) -> BeltFrequencies:
    """Returns frequencies of the small oscillation with an elastic belt, by either reading.

    The source adds the belt to the spring, which is right while the rotor does not turn. Without current the rotor
    floats, and the belt is in series between rotor and knee: two inertias, two modes.

    Args:
        leg: the pinned leg, with its rotor.
        knee: torque law of the knee with the stiffness of its spring alone.
        belt: k_rotBelt of (4.7), in N·m/rad.

    Raises:
        BadValue: the belt or the rotor is missing, or the leg does not rest on its spring.
    """
    require("belt", belt, lambda k: k > 0, "a stiffness > 0, in N·m/rad")
    require("rotor", leg.rotor, lambda inertia: inertia > 0, "an inertia > 0, in kg·m²")
    rest = equilibrium(leg, knee)
    inertia, body = float(leg.effective_inertia(rest)), float(leg.effective_inertia(rest)) - leg.rotor
    stiffness = knee.stiffness + float(leg.motion_with_slopes(rest)[5])
    modes = scipy.linalg.eigh([[stiffness + belt, -belt], [-belt, belt]], np.diag([body, leg.rotor]), eigvals_only=True)
    squares = np.array([stiffness / inertia, (stiffness + belt) / inertia, (stiffness + belt) / body, *modes])
    return BeltFrequencies(*(float(f) for f in np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)))
