"""Add a robot: a running biped with two SPEAR-II legs. This file defines its automaton with the public interface.

Objective: find a periodic gait and its multipliers from a URDF. The phases are left stance, flight, right stance and
flight. The knee springs engage at touchdown and release at lift-off. The torso and all gains are assumptions.

What to notice: the control law consists of three of Raibert's rules. The leg in the air moves to the angle at which it
has to land; this angle is further ahead if the hips move faster. The hip of the stance leg keeps the torso upright.
The knee of the stance leg leaves compression to the spring, and thrusts when compression is over. After a touchdown the
law uses only held values that this touchdown has latched anew. So a stride depends only on its initial state (q, v).
The gait is stable. It is also symmetric, although nothing enforces symmetry.

Run: python examples/biped.py [FOLDER]
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Spring, find_gait, load, simulate
from spear_pin.hybrid.automaton import OPEN, STICK, Domain, Guard, HybridSystem, Mount, Reset
from spear_pin.hybrid.ground import as_ground, choose_ground
from spear_pin.hybrid.phases import contact_domains, fall, rate, spring_switches, touchdown
from spear_pin.viz import plots
from spear_pin.viz.player import record

PITCH, HIPS, KNEES = 2, {"left": 3, "right": 5}, {"left": 4, "right": 6}  # indices of coordinates


@dataclass(frozen=True)
class RunningLaw:
    """In N·m, rad, N·m/rad and N·m·s/rad. A leg's angle is that of its toe from below the hip, > 0 ahead."""

    thrust: float = 19.0
    set_back: float = 0.13  # a leg lands at the angle placement * speed - set_back
    placement: float = 0.3  # rad·s/m
    knee_touchdown: float = 0.62
    knee_retracted: float = 1.95
    pitch_gain: float = 33.0
    pitch_damping: float = 11.0
    hip_gain: float = 29.0
    hip_damping: float = 2.0
    knee_gain: float = 34.0
    knee_damping: float = 3.0
    torque_limit: float = 35.0  # smooth limit for a leg in the air


def swing(side, knee, q, v, p, ops):
    """Hip and knee torque of a leg in the air: to where it has to land, with its knee at an angle."""
    hip_row, knee_row = HIPS[side], KNEES[side]
    angle, turning = (x[PITCH] + x[hip_row] - 0.5 * x[knee_row] for x in (q, v))  # thigh and shank are equally long
    hip = p.hip_gain * (p.placement * v[0] - p.set_back - angle) - p.hip_damping * turning
    torques = hip, p.knee_gain * (knee - q[knee_row]) - p.knee_damping * v[knee_row]
    return tuple(p.torque_limit * ops.tanh(torque / p.torque_limit) for torque in torques)


def step(robot, side, other, spring):
    """The domains of one leg's stance and of the flight after it, which the other leg's touchdown ends."""

    def stance_law(t, q, v, held, p, dyn, ops):
        swung = swing(other, p.knee_retracted, q, v, p, ops)
        upright = p.pitch_gain * q[PITCH] + p.pitch_damping * v[PITCH] - swung[0]  # both hips act on the torso
        torques = {side: (upright, -p.thrust * held["thrusting"]), other: swung}
        return (*torques["left"], *torques["right"])

    def flight_law(t, q, v, held, p, dyn, ops):
        landing = swing(other, p.knee_touchdown, q, v, p, ops)
        torques = {other: landing, side: (-landing[0], swing(side, p.knee_retracted, q, v, p, ops)[1])}
        return (*torques["left"], *torques["right"])

    def compressing(t, q, v, held, p, dyn, ops):
        return v[KNEES[side]] * (1.0 - held["thrusting"]) + held["thrusting"]  # at zero the guard would fire again

    def land(q, v, held, p):
        return {f"{other}_rest": q[KNEES[other]], f"{other}_taut": 1.0, "thrusting": 0.0}

    contacts = tuple(STICK if toe == f"{side}_toe" else OPEN for toe in robot.toes)
    mount = Mount(f"{side}_knee", spring, rest=f"{side}_rest", taut=f"{side}_taut")
    thrust = Guard("thrust", compressing, Reset(latch=lambda q, v, held, p: {"thrusting": 1.0}))
    guards = *spring_switches(mount), thrust, *fall([*robot.actuated, f"{other}_toe"])  # joints are frames
    stance = Domain(f"{side}_stance", f"{side}_stance", contacts, stance_law, mounts=(mount,), guards=guards)
    lift_off = {f"{side}_toe": Reset(release=(f"{side}_knee",), phase=f"{side}_flight")}
    lands = touchdown(f"{other}_toe", Reset((f"{other}_toe",), (), land, f"{other}_stance"), f"{other}_touchdown")
    guards = lands, *fall([*robot.actuated, f"{side}_toe"]), Guard("apex", rate(1))
    flight = Domain(f"{side}_flight", f"{side}_flight", (OPEN, OPEN), flight_law, guards=guards)
    return (*contact_domains(stance, robot.toes, lift_off), flight)


def running(robot, law=None, spring=None, contact=None, *, ground=None):
    """The automaton."""
    law, spring, contact = law or RunningLaw(), spring or Spring(), choose_ground(contact, ground)

    def guess():
        knees = law.knee_touchdown, law.knee_retracted
        q = np.array([0.0, 0.0, 0.0, 0.5 * knees[0], knees[0], 0.5 * knees[1], knees[1]])
        x, z = robot.toe_position(q, "left_toe")
        q[1] = as_ground(contact).under(x) - z
        v, jacobian = np.array([0.8, -0.5, *np.zeros(5)]), robot.toe_jacobian(q, "left_toe")
        v[3:5] = np.linalg.solve(jacobian[:, 3:5], -jacobian @ v)
        return q, v

    domains = (*step(robot, "left", "right", spring), *step(robot, "right", "left", spring))
    measures = {"mean_speed": lambda run: (run.state[0][0] - run.start[0][0]) / sum(run.durations.values())}
    return HybridSystem(
        "running",
        robot,
        law,
        {"knee": spring},
        contact,
        domains,
        "left_touchdown",
        ("torso_x",),
        running,
        guess,
        measures,
    )


def main(folder: Path) -> None:
    gait = find_gait(running(load("biped")), vary=["set_back"], target={"mean_speed": 1.0})
    strides = simulate(gait.system, gait.state, cycles=6)
    print(f"set back {gait.parameters['set_back']:.4f} rad for 1 m/s, residual {gait.residual:.1e}")
    print("phases      ", ", ".join(f"{phase} {time:.4f} s" for phase, time in gait.durations.items()))
    print("multipliers ", ", ".join(f"{abs(m):.4f}" for m in gait.multipliers), "stable" if gait.stable else "unstable")
    mirrored = strides.named("right_touchdown")[0].v[[0, 1, 2, 5, 6, 3, 4]]
    print(f"right from left, mirrored: {np.abs(mirrored - gait.state[1]).max():.1e} m/s, rad/s")
    print(
        f"peak torques {dict(zip(strides.actuated, np.abs(strides.u).max(axis=0).round(1).tolist(), strict=True))} N·m"
    )
    print(f"the ledger closes to {np.abs(strides.ledger.residual).max():.1e} J a stride")
    with plots.style():
        figure = Figure(figsize=(7.0, 4.6), layout="constrained")
        (toes, force), (torque, energy) = figure.subplots(2, 2)
        plots.draw_clearance(toes, strides)
        plots.draw_force(force, strides)
        plots.draw_torque(torque, strides, "left_knee")
        plots.draw_energy(energy, strides, "Stride")
        for axes in (toes, force, torque):
            axes.set_xlim(0.0, 2.0 * gait.period)
    print("files", gait.save(folder / "biped_gait.json"), plots.save_figure(figure, folder / "biped.svg"), end=" ")
    print(record(gait.system.robot, strides, folder / "biped.html", title="Biped running"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
