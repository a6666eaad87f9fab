"""Bring your own robot: a URDF with <transmission> elements, its dynamics, its hop.

Objective: load a monopod that does not ship with the package, query its dynamics, read an error message, and let the
monopod hop. It is SPEAR-II made smaller: lengths times 0.6, masses times 0.4.

What to notice: you name the toes when you load the robot. Motors come from the <transmission> elements. The rotor
inertia enters D multiplied by the square of the gear ratio. `hopping` requires joints boom_z, hip and knee and a toe
named "toe". If torques, gains and times are scaled by the same rule (dynamic similarity), the hop is the same in other
units. So its multipliers are SPEAR-II's.

Run: python examples/your_own_urdf.py [FOLDER]
"""

import math
import sys
from pathlib import Path

from spear_pin import HoppingLaw, SpearError, Spring, find_gait, hopping, load, simulate
from spear_pin.viz.player import record
from spear_pin.viz.plots import hop_summary, save_figure

LINK = """<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
  <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
  <origin xyz="0 0 {z}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" effort="50" velocity="50"/></joint>"""
MOTOR = """<transmission name="{joint}_drive"><type>transmission_interface/SimpleTransmission</type>
  <joint name="{joint}"/><actuator name="{joint}_motor"><mechanicalReduction>{gear}</mechanicalReduction>
  <drake:rotor_inertia value="{rotor}"/></actuator></transmission>"""
URDF = "\n".join(
    [
        '<robot name="mini" xmlns:drake="http://drake.mit.edu">',
        '<link name="world"/>',
        LINK.format(name="boom", z=0, mass=1.84, inertia=0.003),
        LINK.format(name="thigh", z=-0.0048, mass=0.688, inertia=0.002016),
        LINK.format(name="shank", z=-0.084, mass=0.192, inertia=0.00072),
        '<link name="toe"/>',
        JOINT.format(name="boom_z", kind="prismatic", parent="world", child="boom", z=0, axis="0 0 1"),
        JOINT.format(name="hip", kind="revolute", parent="boom", child="thigh", z=0, axis="0 -1 0"),
        JOINT.format(name="knee", kind="revolute", parent="thigh", child="shank", z=-0.1908, axis="0 1 0"),
        JOINT.format(name="tip", kind="fixed", parent="shank", child="toe", z=-0.1908, axis="1 0 0"),
        MOTOR.format(joint="hip", gear=60, rotor=1.88e-6),
        MOTOR.format(joint="knee", gear=15, rotor=1.728e-5),
        "</robot>",
    ]
)


def main(folder: Path) -> None:
    path = folder / "mini.urdf"
    path.write_text(URDF, encoding="utf-8")
    for arguments in ({"toes": ["toe_tip"]}, {"toes": ["toe"], "locked": ["boom_x"]}):
        try:
            load(path, **arguments)
        except SpearError as error:
            print(f"load(..., {arguments}): {error}")

    robot = load(path, toes=["toe"])
    print(f"{robot.name}: {robot.mass:.2f} kg, coordinates {', '.join(robot.coordinates)}, motors on {robot.actuated}")
    print(f"D at hip 0.5, knee 1.0 rad [kg, kg·m, kg·m²] =\n{robot.mass_matrix([0.3, 0.5, 1.0]).round(5)}")

    torque, time = 0.4 * 0.6, math.sqrt(0.6)  # masses times lengths; square root of lengths
    law = HoppingLaw(
        stance_torque=8.0 * torque,
        frequency=2.56 / time,
        hip_gain=54.77 * torque,
        hip_damping=1.37 * torque * time,
        knee_gain=63.25 * torque,
        knee_damping=0.52 * torque * time,
    )
    spring = Spring(stiffness=48.84 * torque, damping=1.3 * torque * time)
    gait = find_gait(hopping(robot, law, spring), vary=["stance_torque"], target={"flight_time": 0.2 * time})
    print(f"stance torque {gait.parameters['stance_torque']:.4f} N·m, flight {gait.durations['flight']:.4f} s")

    spear = load("spear_ii", locked=["boom_x"])
    model = find_gait(hopping(spear), vary=["stance_torque"], target={"flight_time": 0.2})
    print(f"stance torque over SPEAR-II's: {gait.parameters['stance_torque'] / model.parameters['stance_torque']:.6f}")
    for name, solved in (("mini", gait), ("SPEAR-II", model)):
        print(f"multipliers of {name:<9}: {', '.join(f'{value:.6f}' for value in solved.multipliers)}")
    hops = simulate(gait.system, gait.state, cycles=5)
    page = record(robot, hops, folder / "mini.html", title="A monopod of one's own")
    print("files", page, save_figure(hop_summary(hops, gait), folder / "mini.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
