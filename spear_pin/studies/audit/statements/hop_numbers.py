"""Numbers of the hop in place for statements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.gaits.measures.curves import Curves
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.boom import RotaryBoom
from spear_pin.studies.audit.printed_equations import GRAVITY
from spear_pin.studies.audit.runs import (
    CURRENT_LIMIT,
    FLIGHT_TIME,
    FRICTION,
    KNEE,
    hop,
    hop_energy,
    one_hop,
    rough_hops,
)
from spear_pin.studies.boom_encoder import Encoder, height_by_sine, read_angle
from spear_pin.studies.hop import spring_share

BRINK = 1e-6  # of the current limit
OFFSET, BOOM_RADIUS = 0.10, 2.0  # m, Section 2.4.4


def fixed_point_residual(knee: float = KNEE, friction: float = FRICTION) -> float:
    """Returns ‖P(x) - x‖ of the hop, SI units."""
    return float(hop(knee, friction).residual)


def largest_multiplier(knee: float = KNEE, friction: float = FRICTION) -> float:
    """Returns the modulus of the hop's largest Floquet multiplier."""
    return float(np.abs(hop(knee, friction).multipliers).max())


def leading_multiplier(knee: float = KNEE, friction: float = FRICTION) -> float:
    """Returns the real part of the hop's largest Floquet multiplier; if negative, high and low hops alternate."""
    leading = max(hop(knee, friction).multipliers, key=abs)
    return float(leading.real)


def flight_time() -> float:
    """Returns the duration of flight, in s."""
    return float(hop().durations["flight"])


def stance_in_periods() -> float:
    """Returns the duration of stance over the period of the square wave, 1/f."""
    return float(hop().durations["stance"] * hop().system.law.frequency)


def push_share_of_spring(knee: float = KNEE, friction: float = FRICTION) -> float:
    """Returns the share of the spring in the push at the knee."""
    return spring_share(one_hop(knee, friction))


def peak_knee_rate() -> float:
    """Returns the largest rate of the knee, in rad/s."""
    run = one_hop()
    return Curves.of(run.t).amount(run.v[:, run.coordinates.index("knee")])


def knee_rate_at_touchdown(knee: float = KNEE, friction: float = FRICTION) -> float:
    """Returns the rate of the knee just before touchdown, in rad/s."""
    run = one_hop(knee, friction)
    return float(abs(run.named("touchdown")[-1].v_before[run.coordinates.index("knee")]))


def work_against(knee: float = KNEE, friction: float = FRICTION) -> tuple[float, ...]:
    """Returns the knee motor's work against the knee's motion in stance, with f halved, as it is, and doubled, in J.

    Each run starts at the touchdown of the hop with f as it is, and lasts through the stance that follows.
    """
    gait, found = hop(knee, friction), []
    for factor in (0.5, 1.0, 2.0):
        law = replace(gait.system.law, frequency=factor * gait.system.law.frequency)
        system = gait.system.build(gait.system.robot, law, gait.system.springs, gait.system.contact)
        run = simulate(system, gait.state, progress=False)
        stance = (run.cycle == 1) & (run.phase == "stance")
        power = run.u[:, run.actuated.index("knee")] * run.v[:, run.coordinates.index("knee")]
        found.append(Curves(run.t, stance).positive(-power))
    return tuple(found)


def work_and_heat_by_ratio(ratios: Sequence[float] = (7.5, 15.0, 30.0)) -> tuple[float, ...]:
    """Returns the knee motor's positive work in a hop by gear ratio, in J, then ∫ (τ/N)² dt, in N²m²s."""
    work, heat = [], []
    for ratio in ratios:
        run = one_hop(ratio=ratio)
        torque, rate = run.u[:, run.actuated.index("knee")], run.v[:, run.coordinates.index("knee")]
        work.append(Curves.of(run.t).positive(torque * rate))
        heat.append(Curves.of(run.t).integral((torque / ratio) ** 2))
    return (*work, *heat)


def offset_moment(offset: float = OFFSET) -> float:
    """Returns the largest moment of the hop's ground force about a slider this far behind the toe, in N·m."""
    run = one_hop()
    return Curves.of(run.t).peak(run.force[:, 0, 1]) * offset


def boom_error(angle: float = np.pi / 180.0) -> float:
    """Returns the hip's height error by an error of the boom's angle, over the rise of a hop with 0.2 s of flight."""
    boom = RotaryBoom(radius=BOOM_RADIUS, pivot=0.0)
    error = height_by_sine(boom, read_angle(boom, Encoder(offset=angle), 0.0))
    return float(error / (GRAVITY * FLIGHT_TIME**2 / 8.0))


def squared_gains() -> tuple[float, float]:
    """Returns the squares of the printed proportional gains of hip and knee, in (N·m/rad)²."""
    law = HoppingLaw()
    return law.hip_gain**2, law.knee_gain**2


def saturated_share() -> float:
    """Returns the share of time in which the knee motor's current is at its limit, on disturbed hardware."""
    run = rough_hops()
    current = np.abs(run.current[:, run.actuated.index("knee")])
    at_limit = current >= CURRENT_LIMIT * (1.0 - BRINK)
    return float(np.trapezoid(at_limit.astype(float), run.t) / (run.t[-1] - run.t[0]))


def apex_spread() -> float:
    """Returns the difference of the highest and lowest apex in eleven hops on disturbed hardware, in m."""
    return float(np.ptp(_apexes()))


def hops_completed() -> float:
    """Returns the number of whole hops on disturbed hardware."""
    return float(rough_hops().cycles)


def regained_share() -> float:
    """Returns the energy of a hop that the batteries get back, over the energy that they give."""
    flow = hop_energy()
    return flow.total("regained") / flow.total("given")


def motor_losses_share() -> float:
    """Returns the energy lost in windings and gears over the net energy that the batteries give."""
    flow = hop_energy()
    return (flow.losses["joule"] + flow.losses["gearbox"]) / flow.battery


def _apexes() -> list[float]:
    row = rough_hops().coordinates.index("boom_z")
    return [float(event.q[row]) for event in rough_hops().named("apex")]
