"""A leg of 2.1 kg with its motors' rotors, on a trunk; SPEAR-II's spring for its size has 8.5 N·m/rad."""

from spear_pin import load, monopod

URDF = """<robot name="small_leg">
  <link name="trunk"><inertial><mass value="1.3"/>
    <inertia ixx="0.005" iyy="0.005" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="thigh"><inertial><origin xyz="0 0 -0.05"/><mass value="0.6"/>
    <inertia ixx="0.0015" iyy="0.0015" izz="0.0003" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="shank"><inertial><origin xyz="0 0 -0.08"/><mass value="0.2"/>
    <inertia ixx="0.0006" iyy="0.0006" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="foot"/>
  <joint name="hip" type="revolute"><parent link="trunk"/><child link="thigh"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="25"/></joint>
  <joint name="knee" type="revolute"><parent link="thigh"/><child link="shank"/><origin xyz="0 0 -0.18"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="2.6" effort="20" velocity="25"/></joint>
  <joint name="ankle" type="fixed"><parent link="shank"/><child link="foot"/><origin xyz="0 0 -0.18"/></joint>
</robot>
"""
TOML = """[motors.all]
ratio = 9.0
rotor_inertia = 3.3e-5
"""


def write(folder):
    """Write its files, and return the path of the URDF."""
    path = folder / "small_leg.urdf"
    path.write_text(URDF, encoding="utf-8")
    path.with_suffix(".toml").write_text(TOML, encoding="utf-8")
    return path


def small_leg(folder):
    """The leg on a slider."""
    robot = load(write(folder), base="fixed", motors="all")
    return monopod(robot, "leg", locked=["boom_x"])
