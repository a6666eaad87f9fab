"""The URDF of an arm in three dimensions, on a column or flying."""

# a yaw joint and a pitch joint, the foot on a fixed joint 0.5 m out along the arm
ARM = """
<robot name="arm">
  <link name="base"/>
  <link name="column">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.2"/></inertial>
  </link>
  <link name="boom">
    <inertial>
      <origin xyz="0.25 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
    </inertial>
  </link>
  <link name="foot"/>
  <joint name="yaw" type="revolute">
    <parent link="base"/>
    <child link="column"/>
    <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="pitch" type="revolute">
    <parent link="column"/>
    <child link="boom"/>
    <origin xyz="0 0 0.2"/>
    <axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="foot_mount" type="fixed">
    <parent link="boom"/>
    <child link="foot"/>
    <origin xyz="0.5 0 0"/>
  </joint>
  <transmission name="pitch_drive">
    <joint name="pitch"/>
    <actuator name="motor"><mechanicalReduction>10</mechanicalReduction></actuator>
  </transmission>
</robot>
"""
# the same arm on a body that flies
LIMIT = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'
FLYING = ARM.replace('name="yaw" type="revolute"', 'name="yaw" type="floating"').replace(LIMIT, "", 1)
