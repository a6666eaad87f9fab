"""The gear that drives a joint: its ratio and its rotor, each of them None if no source gives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pinocchio as pin


@dataclass(frozen=True)
class Gear:
    """A rotor behind a gear, as far as a file describes it; None means "not given", which is neither 1 nor 0.

    Attributes:
        ratio: rotor turns per joint turn, N.
        rotor: inertia of the rotor at the rotor, J, in kg·m².
        armature: inertia that a file gives already reflected to the joint, N² J, in kg·m².
    """

    ratio: float | None = None
    rotor: float | None = None
    armature: float | None = None

    @property
    def reflected(self) -> float | None:
        """Returns N² J at the joint, in kg·m², which (3.12)-(3.13) add to the kinetic energy; a missing ratio is 1."""
        if self.armature is not None or self.rotor is None:
            return self.armature
        ratio = 1.0 if self.ratio is None else self.ratio
        return ratio**2 * self.rotor

    def completed(self, other: Gear) -> tuple[Gear, tuple[str, ...]]:
        """Fills missing numbers from another source with lower priority.

        Returns:
            both together, and the names of numbers in which they differ, of which this gear's are kept.
        """
        pairs = {name: (getattr(self, name), getattr(other, name)) for name in ("ratio", "rotor", "armature")}
        differ = tuple(name for name, (own, more) in pairs.items() if own is not None and more not in (None, own))
        return Gear(**{name: more if own is None else own for name, (own, more) in pairs.items()}), differ


def set_gears(model: pin.Model, gears: Mapping[str, Gear]) -> list[str]:
    """Sets armatures, rotors and ratios of joints of one degree of freedom.

    Args:
        model: the model, which is changed. Of Pinocchio's numbers only the armature enters the dynamics. A ratio of
            zero means no gear.
        gears: the gears, by joint.

    Returns:
        the assumptions about gears, a line each.
    """
    guessed = []
    for joint, gear in gears.items():
        row, reflected = model.joints[model.getJointId(joint)].idx_v, gear.reflected or 0.0
        if gear.rotor and gear.ratio is None and gear.armature is None:
            guessed.append(joint)
        model.armature[row] = reflected
        model.rotorGearRatio[row] = gear.ratio or 0.0
        model.rotorInertia[row] = reflected / gear.ratio**2 if gear.ratio and gear.rotor is None else gear.rotor or 0.0
    if not guessed:
        return []
    joints = ", ".join(map(repr, guessed))
    return [f"rotors without a ratio, which is taken as 1: {joints} (a TOML file's `ratio` says another)"]
