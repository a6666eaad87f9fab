"""The URDF of an arm with a shoulder and an elbow, made to be edited, and the refusal of one."""

import pytest

from spear_pin.errors import BadFile
from spear_pin.model.urdf import read_urdf

ARM = """<?xml version="1.0"?>
<robot name="arm" xmlns:drake="http://drake.mit.edu">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 -0.1"/>
      <mass value="2.0"/>
      <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <link name="lower">
    <inertial>
      <origin xyz="0 0 -0.2"/>
      <mass value="1.0"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 1"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="5"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/>
    <child link="lower"/>
    <origin xyz="0 0 -0.3"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="10" velocity="5"/>
  </joint>
  <transmission name="shoulder_drive">
    <joint name="shoulder"/>
    <actuator name="motor">
      <mechanicalReduction>50</mechanicalReduction>
      <drake:gear_ratio value="50"/>
      <drake:rotor_inertia value="2e-5"/>
    </actuator>
  </transmission>
</robot>
"""
ELBOW_LIMIT = '<limit lower="-2" upper="2" effort="10" velocity="5"/>'


def edited(old, new, text=ARM):
    """The arm with every `old` replaced."""
    assert old in text
    return text.replace(old, new)


def refusal(path, read=read_urdf):
    """The error of reading a file, whose text must be one line that names the file."""
    with pytest.raises(BadFile) as caught:
        read(path)
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    assert text.startswith(str(path))
    assert caught.value.path == str(path)
    return caught.value
