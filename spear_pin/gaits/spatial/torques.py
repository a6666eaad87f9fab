"""Motor torques in space, of legs on the ground and legs in the air, and the gait state that a law holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import support as support_in_plane
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import Group, Z
from spear_pin.gaits.spatial.trot_law import TrotLaw
from spear_pin.gaits.virtual_constraints import demand_accelerations
from spear_pin.hybrid.domain import Law
from spear_pin.hybrid.dynamics import Dynamics, Operations, Row
from spear_pin.hybrid.result import State
from spear_pin.model.robot import Robot

LegLaw = SpatialLaw | TrotLaw
"""Laws with numbers for each leg and for each group."""


def nominal_start(robot: Robot, law: Any, landing: Group) -> State:
    """Returns the section state that a law holds, with the landing group on the ground.

    Raises:
        BadValue: the law holds no state.
    """
    if not law.nominal:
        raise BadValue(
            f"{type(law).__name__}.nominal",
            law.nominal,
            "the numbers of a section state; or give a state to start from",
        )
    q, v = np.array(law.nominal[: robot.nv]), np.array(law.nominal[robot.nv :])
    q[Z] -= min(robot.toe_position(q, leg.toe)[-1] for leg in landing)
    return q, v


def support(leg: Leg, q: Any, v: Any, held: Mapping[str, Any], p: LegLaw, dyn: Dynamics) -> list[tuple[int, Any]]:
    """Returns motor torques of a supporting leg as (column, torque): half a pair's, (5.4)-(5.6), and adduction's."""
    off = q[leg.adduction] - held[f"{leg.name}_adduction"]
    upright = held[f"{leg.name}_adduction_torque"] - p.adduction_stiffness * off
    in_its_plane = support_in_plane(leg, q, held, p, dyn)
    return [(leg.motors[0], upright - p.adduction_damping * v[leg.adduction]), *in_its_plane]


def law_of(bearing: Sequence[Leg], airborne: Sequence[tuple[Leg, Sequence[Leg]]]) -> Law:
    """Returns the law for torques of legs on the ground, and of legs in the air, each given with its other group."""
    in_the_air = [motor for leg, _ in airborne for motor in (*leg.motors[1:], leg.motors[0])]

    def law(t: Any, q: Any, v: Any, held: Any, p: LegLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        torques = [torque for leg in bearing for torque in support(leg, q, v, held, p, dyn)]
        rows: list[Row] = []
        wanted: list[Any] = []
        for leg, others in airborne:
            outputs = leg.outputs(others, held[f"{leg.name}_weights"])
            demand = demand_accelerations(outputs, leg.evolution(held), q, v, p.epsilon, ops)
            i = leg.rows[0]
            off, rate = q[i] - held[f"{leg.name}_lands_at"], v[i]
            rows += [*demand[0], ((i, 1.0),)]
            wanted += [*demand[1], -(off / p.adduction_epsilon + 2.0 * rate) / p.adduction_epsilon]
        swing = dyn.imposing(rows, wanted, in_the_air, torques)
        return [torque for _, torque in sorted([*torques, *zip(in_the_air, swing, strict=True)])]

    return law
