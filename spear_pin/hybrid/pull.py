"""What a spring does at a state, for scalars of any kind."""

from __future__ import annotations

from typing import Any, NamedTuple

from spear_pin.model.path import Slope
from spear_pin.model.spring import Spring


class Pull(NamedTuple):
    """What a spring does at a state.

    Attributes:
        name: name of its mount.
        spring: its law, with scalars of the engine's kind.
        stretch: how much longer its path is than at rest, in rad or m.
        rate: rate of the path's length, in rad/s or m/s.
        force: force along the path, without the damper's, in N·m or N; negative as it pulls.
        lost: the part of that force that its hysteresis makes.
        drag: the damper's force.
        slope: lever of these forces on each coordinate.
        slipping: 1 while its clutch slips, else 0.
    """

    name: str
    spring: Spring
    stretch: Any
    rate: Any
    force: Any
    lost: Any
    drag: Any
    slope: Slope
    slipping: Any
