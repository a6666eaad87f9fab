"""The small oscillation of the knee about its rest: frequency and damping, and both modes of a belt that gives."""

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
    """The small oscillation about the static equilibrium, with the damping that is linear.

    Attributes:
        frequency: undamped, in Hz.
        damped_frequency: in Hz; 0 where it does not oscillate.
        damping_ratio: ζ.
        rotor_share: of the effective inertia there.
    """

    frequency: float
    damped_frequency: float
    damping_ratio: float
    rotor_share: float


@dataclass(frozen=True)
class BeltFrequencies:
    """Undamped frequencies of the small oscillation, in Hz, by how the belt is taken.

    Attributes:
        rigid: no belt in between, the rotor moving with the knee.
        parallel: the belt added to the spring, the rotor moving with the knee nevertheless: the source's reading.
        locked: the belt added to the spring, the rotor standing still.
        low: the belt in series, the rotor floating: the slower mode.
        high: the faster.
    """

    rigid: float
    parallel: float
    locked: float
    low: float
    high: float


@typed
def swing(leg: PinnedLeg, knee: PassiveKnee) -> Swing:
    """The small oscillation about the static equilibrium.

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
    """The small oscillation with a belt that is not rigid, read in either way.

    The source adds the belt to the spring, which holds while the rotor does not turn. Without current the
    rotor floats, and the belt lies in series between it and the knee: two inertias, two modes.

    Args:
        leg: the pinned leg, with its rotor.
        knee: with the stiffness of its spring alone.
        belt: k_rotBelt of (4.7), in N·m/rad.

    Raises:
        BadValue: the belt or the rotor is none, or the leg does not rest on its spring.
    """
    require("belt", belt, lambda k: k > 0, "a stiffness > 0, in N·m/rad")
    require("rotor", leg.rotor, lambda inertia: inertia > 0, "an inertia > 0, in kg·m²")
    rest = equilibrium(leg, knee)
    inertia, body = float(leg.effective_inertia(rest)), float(leg.effective_inertia(rest)) - leg.rotor
    stiffness = knee.stiffness + float(leg.motion_with_slopes(rest)[5])
    modes = scipy.linalg.eigh([[stiffness + belt, -belt], [-belt, belt]], np.diag([body, leg.rotor]), eigvals_only=True)
    squares = np.array([stiffness / inertia, (stiffness + belt) / inertia, (stiffness + belt) / body, *modes])
    return BeltFrequencies(*(float(f) for f in np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)))
