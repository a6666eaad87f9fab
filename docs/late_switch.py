"""The picture of hops whose switch is late: the spring in stance, and what the delay costs."""

from __future__ import annotations

from matplotlib.figure import Figure

from benchmarks.late_switch import alternating, late, walked
from spear_pin import Gait, simulate
from spear_pin.viz.plots.paper import Picture, style

SHOWN = ("0", "10", "16", "24")  # ms


def late_switch() -> Figure:
    """Plots the spring's torque over a hop for some delays, and the motor's work and the torque over the delay."""
    gaits = [(name, gait) for name, gait in walked(late()) if isinstance(gait, Gait)]
    hops = {name: simulate(gait.system, gait.state, cycles=1) for name, gait in gaits}
    with style():
        figure = Picture(figsize=(7.0, 3.0), layout="constrained")
        left, right = figure.subplots(1, 2)
        for name in SHOWN:
            hop = hops[name]
            stance = hop.phase != "flight"
            left.plot(1e3 * hop.t[stance], hop.spring[stance, 0], label=f"{name} ms late")
        left.set_xlabel("time since touchdown (ms)")
        left.set_ylabel("torque of the spring (N·m)")
        left.legend()
        delays = [float(name) for name, _ in gaits]
        right.plot(delays, [hop.ledger["motor_knee"][0] for hop in hops.values()], label="work of the knee's motor (J)")
        right.plot(delays, [gait.parameters["stance_torque"] for _, gait in gaits], label="stance torque (N·m)")
        chatters = [delay for delay, hop in zip(delays, hops.values(), strict=True) if alternating(hop)]
        right.axvspan(chatters[0], chatters[-1], color="0.9", label="the toe alternates at lift-off")
        right.set_xlabel("delay of the switch (ms)")
        right.legend()
    return figure
