"""Numbers of the hop in place that statements ask for."""

from __future__ import annotations

import numpy as np

from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.studies.hop import spring_share, summarize
from spear_pin.studies.reference import CURRENT_LIMIT, hop, hop_energy, hops, rough_hops

BRINK = 1e-6  # of the current limit


def fixed_point_residual() -> float:
    """‖P(x) - x‖ of the hop, SI units."""
    return float(hop().residual)


def largest_multiplier() -> float:
    """Magnitude of the hop's largest Floquet multiplier."""
    return float(np.abs(hop().multipliers).max())


def leading_multiplier() -> float:
    """The hop's largest Floquet multiplier; negative: what is high one hop is low the next."""
    leading = max(hop().multipliers, key=abs)
    return float(leading.real)


def flight_time() -> float:
    """Duration of flight, in s."""
    return float(hop().durations["flight"])


def stance_in_periods() -> float:
    """Duration of stance over the period of the square wave, 1/f."""
    return float(hop().durations["stance"] * hop().system.law.frequency)


def push_share_of_spring() -> float:
    """Share of the spring in the push at the knee."""
    return spring_share(hops())


def peak_knee_rate() -> float:
    """Largest rate of the knee, in rad/s."""
    return float(summarize(hop(), hops())["peak_knee_rate"])


def knee_rate_at_touchdown() -> float:
    """Rate of the knee just before touchdown, in rad/s."""
    run = hops()
    return float(abs(run.named("touchdown")[0].v_before[run.coordinates.index("knee")]))


def squared_gains() -> tuple[float, float]:
    """Squares of the printed proportional gains of hip and knee, in (N·m/rad)²."""
    law = HoppingLaw()
    return law.hip_gain**2, law.knee_gain**2


def saturated_share() -> float:
    """Share of the time in which the knee motor's current is at its limit, on disturbed hardware."""
    run = rough_hops()
    current = np.abs(run.current[:, run.actuated.index("knee")])
    at_limit = current >= CURRENT_LIMIT * (1.0 - BRINK)
    return float(np.trapezoid(at_limit.astype(float), run.t) / (run.t[-1] - run.t[0]))


def apex_spread() -> float:
    """From the lowest to the highest apex of eleven hops on disturbed hardware, in m."""
    return float(np.ptp(_apexes()))


def hops_completed() -> float:
    """Whole hops on disturbed hardware."""
    return float(rough_hops().cycles)


def regained_share() -> float:
    """What the batteries get back of a hop's energy over what they give."""
    flow = hop_energy()
    return flow.total("regained") / flow.total("given")


def motor_losses_share() -> float:
    """What is lost in windings and gears over what the batteries give on balance."""
    flow = hop_energy()
    return (flow.losses["joule"] + flow.losses["gearbox"]) / flow.battery


def _apexes() -> list[float]:
    row = rough_hops().coordinates.index("boom_z")
    return [float(event.q[row]) for event in rough_hops().named("apex")]
