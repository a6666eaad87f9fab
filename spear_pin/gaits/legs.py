"""A leg of a quadruped, in the plane or in space, as laws and automata see it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from spear_pin.gaits.virtual_constraints import Evolution, Leaning, Outputs, Shifted, Sum, Variable

AHEAD, ASIDE = 0, 1  # indices of the torso's travel along x and, in space, y
ALIKE = 1e-9  # relative: thigh and shank count as equally long, and the leg angle is linear


@dataclass(frozen=True)
class Leg:
    """A leg. Its numbers in a law follow the convention, see `spear_pin.model.legs`; q is the robot's own.

    Attributes:
        end: "posterior" or "anterior".
        hip: index of its hip.
        knee: index of its knee.
        side: +1 if the knee flexes to positive angles of its own, -1 if to negative.
        lengths: lengths of thigh and shank, in m.
        motors: columns of the motors of hip and knee; in space that of the adduction comes first.
        joint: name of its knee.
        above: name of its hip.
        toe: name of its toe.
        pitch: index of the torso's pitch.
        lateral: +1 for the left leg, -1 for the right leg; 0 for a pair of legs in the plane.
        adduction: in space, index of its adduction joint; an angle > 0 of the convention swings the leg to the left.
        signs: signs of adduction, hip and knee: their angles of the convention are sign (q - zero).
        zeros: zeros of adduction, hip and knee, in rad.
    """

    end: str
    hip: int
    knee: int
    side: float
    lengths: tuple[float, float]
    motors: tuple[int, ...]
    joint: str
    above: str
    toe: str
    pitch: int
    lateral: float = 0.0
    adduction: int | None = None
    signs: tuple[float, float, float] = (1.0, 1.0, 1.0)
    zeros: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def name(self) -> str:
        """Name such as "posterior", or "posterior_left" in space, whatever the robot calls the leg."""
        return f"{self.end}_{'left' if self.lateral > 0 else 'right'}" if self.lateral else self.end

    @property
    def rows(self) -> tuple[int, int, int]:
        """Indices of adduction, hip and knee, in space."""
        assert self.adduction is not None
        return self.adduction, self.hip, self.knee

    @property
    def bends(self) -> float:
        """+1 if the knee flexes to positive angles of the convention, -1 if to negative."""
        return self.side * self.signs[2]

    @cached_property
    def angle(self) -> Variable:
        """Leg angle γ, of the line from hip to toe: pitch + hip - knee / 2 where thigh and shank are equally long."""
        (thigh, shank), (_, hip, knee), (_, zero_of_hip, zero_of_knee) = self.lengths, self.signs, self.zeros
        above = (self.pitch, 1.0), (self.hip, hip)
        if abs(thigh - shank) <= ALIKE * thigh:
            return _shifted((*above, (self.knee, -0.5 * knee)), 0.5 * knee * zero_of_knee - hip * zero_of_hip)
        turn = None if (knee, zero_of_knee) == (1.0, 0.0) else (knee, zero_of_knee)
        return _shifted(Leaning(above, self.knee, thigh, shank, turn), -hip * zero_of_hip)

    @cached_property
    def controlled(self) -> tuple[Variable, Variable]:
        """Variables that the motors of hip and knee control in the air: γ and the knee, of the convention."""
        sign, zero = self.signs[2], self.zeros[2]
        return self.angle, _shifted(((self.knee, sign),), -sign * zero)

    def flexion(self, q: Any) -> Any:
        """Returns how far the knee is flexed, in rad."""
        zero = self.zeros[2]
        return self.side * (q[self.knee] - zero if zero else q[self.knee])

    def outputs(self, others: Sequence[Leg], weights: tuple[Any, Any, Any]) -> Outputs:
        """Returns the controlled outputs in the air, over a phase variable.

        Args:
            others: the legs of the other group, if there is one.
            weights: weights of x, of y and of each of their γ in the phase variable.
        """
        ahead, aside, angles = weights
        travel = ((AHEAD, ahead), (ASIDE, aside))
        phase = Sum(((1.0, travel), *((angles, leg.angle) for leg in others)))
        return Outputs(self.controlled, phase, self.motors[1:])

    def evolution(self, held: Mapping[str, Any]) -> Evolution:
        """Returns the latched desired evolution of the leg."""
        return Evolution(*(held[f"{self.name}_{part}"] for part in ("alpha", "origin", "span", "past")))


def _shifted(variable: Variable, by: float) -> Variable:
    """Adds a constant to a variable, if the constant is not zero."""
    return Shifted(variable, by) if by else variable
