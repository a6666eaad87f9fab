"""Figures of hops that are shown while their numbers are turned, and the program that computes them again."""

from __future__ import annotations

import textwrap

import numpy as np

from spear_pin.studies.energetics import costs
from spear_pin.studies.explore.hops import Hops
from spear_pin.studies.hop import durations, spring_share


def figures(hops: Hops) -> dict[str, float | None]:
    """Figures of hops, SI units; None where there is no such thing.

    Returns:
        apex_height, of the hip above the ground, the highest; flight_time and stance_time, the longest of a whole hop;
        peak_force, vertical; peak_torque and peak_power of the knee's motor at the joint, by their amount;
        rotor_torque, the peak torque before an ideal gear; motor_work, positive, of both motors, a hop; spring_share,
        see `spring_share`.
    """
    trajectory = hops.trajectory
    knee = trajectory.coordinates.index("knee")
    torque = trajectory.u[:, trajectory.actuated.index("knee")]
    whole = trajectory.cycles > 0
    apexes = [float(event.q[trajectory.coordinates.index("boom_z")]) for event in trajectory.named("apex")]
    stance, flight = durations(trajectory).max(axis=0).tolist() if whole else (None, None)
    peak_torque = float(np.abs(torque).max())
    return {
        "apex_height": max(apexes, default=None),
        "flight_time": flight,
        "stance_time": stance,
        "peak_force": float(trajectory.force[:, 0, 1].max()),
        "peak_torque": peak_torque,
        "rotor_torque": peak_torque / hops.knobs.knee_ratio,
        "peak_power": float(np.abs(torque * trajectory.v[:, knee]).max()),
        "motor_work": costs(hops.knobs.system, trajectory).energy["mechanical_positive"] if whole else None,
        "spring_share": spring_share(trajectory) if whole else None,
    }


def script(hops: Hops) -> str:
    """A short Python program that computes the same hops again with the public interface, prints and plays them."""
    knobs, (q, v) = hops.knobs, hops.start
    if hops.gait is None:
        imported, compute, report = "", f"hops = simulate(system, (q, v), cycles={_asked(hops)})", UNSOLVED
    else:
        imported, compute, report = "find_gait, ", SOLVE.format(cycles=_asked(hops)), SOLVED
    return PROGRAM.format(
        **knobs.values,
        message=textwrap.fill(hops.message, 110),
        imported=imported,
        q=q.tolist(),
        v=v.tolist(),
        compute=compute,
        report=report,
    )


def _asked(hops: Hops) -> int:
    """Hops to simulate: those that were whole, and the one that was not."""
    return hops.trajectory.cycles + (not hops.trajectory.complete)


PROGRAM = '''"""SPEAR-II hopping in place, with numbers set in `spear explore`.

{message}
"""

import numpy as np

from spear_pin import Contact, HoppingLaw, Spring, {imported}hopping, load, simulate, vary
from spear_pin.viz.player import record

robot = vary(load("spear_ii", locked=["boom_x"]), knee_ratio={knee_ratio})
law = HoppingLaw(knee_touchdown={knee_touchdown}, stance_torque={stance_torque}, frequency={frequency})
system = hopping(robot, law, Spring(stiffness={stiffness}, damping={damping}), Contact(friction={friction}))

# just after touchdown: boom_z in m, hip and knee in rad, and their rates
q = np.array({q})
v = np.array({v})
{compute}

{report}
print(f"peak ground force {{hops.force[:, 0, 1].max():.2f}} N, peak knee torque {{abs(hops.u[:, 1]).max():.3f}} N·m")
record(robot, hops, "hop.html", title="SPEAR-II hopping in place")
'''
SOLVE = "gait = find_gait(system, guess=(q, v))\nhops = simulate(gait.system, gait.state, cycles={cycles})"
SOLVED = """print("multipliers", gait.multipliers, "stable" if gait.stable else "unstable")
print("flight {flight:.4f} s, stance {stance:.4f} s".format(**gait.durations))"""
UNSOLVED = 'print(f"{hops.cycles} whole hops; {hops.message}")'
