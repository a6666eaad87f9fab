"""The numbers of docs/explanation/errata.md: `python -m benchmarks.errata`, labelled lines on stdout."""

from __future__ import annotations

import numpy as np

from spear_pin import HoppingLaw, load

GRAVITY = 9.81
KNEE = 1.0  # rad, hip at half of it: the toe below the hip
TABLE_4_1 = {  # k_rot, b, RA, sigma_k, sigma_b, sigma_RA, fit
    "with motor": ([49.88, 1.56, 1.01, 9.97, 0.81, 0.05, 86.3], [55.93, 1.35, 1.03, 6.3, 0.47, 0.03, 88.2],
                   [48.25, 1.03, 1.0, 2.97, 0.23, 0.02, 84.1]),
    "no motor": ([48.31, 1.3, 1.0, 8.74, 0.66, 0.05, 90.3], [48.53, 1.02, 1.0, 5.08, 0.37, 0.03, 89.6],
                 [47.12, 0.8, 1.0, 2.59, 0.19, 0.02, 83.0]),
}  # fmt: skip


def push_test() -> None:
    """The knee's effective inertia and gravity torque, toe on the ground below the hip."""
    robot, length = load("spear_ii"), 0.318
    boom, thigh, shank, d1, d2, J1, J2, hip_rotor, knee_rotor = 4.6, 1.72, 0.48, 0.008, 0.14, 0.014, 0.005, 0.047, 0.027
    hip, rise = KNEE / 2.0, -length * np.sin(KNEE / 2.0)
    slope = np.array([0.0, rise, 0.5, 1.0])  # dq/dθ2
    q = np.array([0.0, 2.0 * length * np.cos(hip), hip, KNEE])
    print(f"effective inertia:      {slope @ robot.mass_matrix(q) @ slope:.4f} kg·m²")
    literal = (hip_rotor + J1 + thigh * d1**2) * 0.25 + knee_rotor + J2 + shank * d2**2 + boom * rise**2
    print(f"  by the printed (3.14) {literal:.4f} kg·m²")
    about_knee = slope @ robot.mass_matrix(q) @ slope + (0.014 - J2) * 0.25  # the shank turns at half the rate
    print(f"  with the shank's 0.014 taken about its centre of mass {about_knee:.4f} kg·m²")
    print(f"gravity torque on the knee: {-slope @ robot.gravity(q):+.2f} N·m towards flexion")
    fall = boom * rise - thigh * (length - d1) * np.sin(hip) * 0.5 - (thigh + shank) * length * np.sin(hip + KNEE) * 1.5
    print(f"  by the printed (3.15)     {-GRAVITY * fall:+.2f} N·m")
    print(f"shank about the knee: {J2 + shank * d2**2:.5f} kg·m² with Table 2.4, {J2 + 0.47 * 0.144**2:.5f} with 5.1")
    rotors = 1e7 * knee_rotor / 15**2, 1e7 * hip_rotor / 60**2
    print("knee rotor: 0.027 / 15² = {:.0f} g·cm², hip rotor: 0.047 / 60² = {:.1f} g·cm²".format(*rotors))


def flight() -> None:
    """Poles of hip and knee in flight, boom_x locked."""
    law, D = HoppingLaw(), load("spear_ii", locked=["boom_x"]).mass_matrix([0.6, KNEE / 2.0, KNEE])
    inertia = np.linalg.inv(np.linalg.inv(D)[1:, 1:])
    gain, damping = np.diag([law.hip_gain, law.knee_gain]), np.diag([law.hip_damping, law.knee_damping])
    for name, K, K_D in (
        ("corrected signs", gain, damping),
        ("printed signs", -gain, damping),
        ("corrected, and b = 1.3 N·m·s/rad at the knee in flight too", gain, damping + np.diag([0.0, 1.3])),
    ):
        A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(inertia, K), -np.linalg.solve(inertia, K_D)]])
        poles = sorted((pole for pole in np.linalg.eigvals(A) if pole.imag >= 0), key=abs)
        print(f"flight poles, {name}: {', '.join(f'{pole:.2f}' for pole in poles)} rad/s")
        if name.startswith("corrected"):
            print("  damping ratios " + ", ".join(f"{-pole.real / abs(pole):.2f}" for pole in poles))


def averages() -> None:
    for name, rows in TABLE_4_1.items():
        print(f"mean of Table 4.1, {name}: " + ", ".join(f"{value:.2f}" for value in np.mean(rows, axis=0)))


def main() -> None:
    push_test()
    flight()
    averages()


if __name__ == "__main__":
    main()
