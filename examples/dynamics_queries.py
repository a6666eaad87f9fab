"""Query the dynamics of SPEAR-II: D, C, G, B, J and the toe's drift at one state.

Objective: see what `load` returns, and check that the terms satisfy D v̇ + C v + G = B u + Jᵀ F.

What to notice: the reflected inertias of the rotors are on the diagonal of D. They are 0.047 and 0.027 kg·m², of 0.147
and 0.041 kg·m² in total. The hip angle is absolute and the knee angle is relative to the thigh, so a knee torque enters
only one row of B. When the robot stands, the ground carries the whole weight. A bent knee brings the shank's mass
nearer to the hip, so the hip's own inertia falls; the knee's does not change.

Run: python examples/dynamics_queries.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import load
from spear_pin.viz.plots import save_figure, style


def main(folder: Path) -> None:
    robot = load("spear_ii")
    q = np.array([0.0, 0.55, 0.5, 1.0])  # boom_x, boom_z in m; hip, knee in rad
    v = np.array([0.2, -0.6, 1.0, -2.0])
    np.set_printoptions(precision=4, suppress=True)

    print(f"{robot.name}: {robot.mass:.2f} kg, coordinates {', '.join(robot.coordinates)}")
    D, C, G, B = robot.mass_matrix(q), robot.coriolis_matrix(q, v), robot.gravity(q), robot.actuation_matrix
    J, drift = robot.toe_jacobian(q, "toe"), robot.toe_drift(q, v, "toe")
    print(f"D [kg, kg·m, kg·m²] =\n{D}")
    print(f"C v [N, N·m] = {C @ v}")
    print(f"G [N, N·m] = {G}")
    print(f"B =\n{B}")
    print(f"J of the toe [1, m] =\n{J}")
    print(f"J̇ v [m/s²] = {drift}")
    print(f"reflected rotor inertias [kg·m²] = {robot.model.armature}")

    # Ḋ - 2 C is skew-symmetric, so only gravity, torques and forces change the kinetic energy
    step = 1e-6
    D_dot = (robot.mass_matrix(q + step * v) - robot.mass_matrix(q - step * v)) / (2 * step)
    skew = D_dot - 2 * C
    print(f"largest entry of S + Sᵀ, S = Ḋ - 2 C: {np.abs(skew + skew.T).max():.1e}")

    # compute accelerations while the toe sticks to the ground and the motors are off
    kkt = np.block([[D, -J.T], [J, np.zeros((2, 2))]])
    solution = np.linalg.solve(kkt, np.concatenate([-C @ v - G, -drift]))
    print(f"toe stuck, motors off: v̇ = {solution[:4]} m/s², rad/s²; F = {solution[4:]} N")

    # compute the torques and the ground force that balance gravity while the robot stands with its hip above the toe
    u_and_force = np.linalg.solve(np.column_stack([B, J.T]), G)
    print(f"standing still: hip {u_and_force[0]:.3f} N·m, knee {u_and_force[1]:.3f} N·m,")
    print(f"  ground force {u_and_force[2:]} N, weight {9.81 * robot.mass:.2f} N")

    in_place = load("spear_ii", locked=["boom_x"])
    print(f"with boom_x locked: {', '.join(in_place.coordinates)}; D is {in_place.mass_matrix(q[1:]).shape}")

    knees = np.linspace(0.0, 2.5, 101)  # rad
    inertias = np.array([robot.mass_matrix([0.0, 0.55, 0.5, knee])[2:, 2:] for knee in knees])
    with style():
        figure = Figure(figsize=(6.0, 3.4), layout="constrained")
        axes = figure.subplots()
        for label, i, j in (("hip", 0, 0), ("knee", 1, 1), ("hip to knee", 0, 1)):
            (line,) = axes.plot(knees, inertias[:, i, j], label=label)
            if i == j:
                rotor = robot.model.armature[2 + i]
                axes.axhline(rotor, color=line.get_color(), linestyle="--", label=f"of it the {label}'s rotor")
        axes.set(xlabel="knee angle [rad]", ylabel="entry of D [kg·m²]")
        axes.legend(ncols=2)
    print("file", save_figure(figure, folder / "inertias.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
