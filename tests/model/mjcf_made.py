"""Robots in MuJoCo's own format, made for tests, and what loading one says."""

import pytest

from spear_pin import RobotWarning, load

I = 'mass="1" diaginertia="0.1 0.2 0.25"'  # noqa: E741
DOG = f"""
<mujoco model="dog">
  <compiler angle="radian" eulerseq="zyx"/>
  <option gravity="0 0 -1.62"/>
  <default>
    <joint armature="0.01" damping="0.2"/>
    <general gear="3"/>
    <default class="leg">
      <joint axis="0 1 0" damping="0.5"/>
      <default class="foot"><geom type="sphere" size="0.02" pos="0 0 -0.3"/></default>
      <default class="knee"><joint range="-2 -0.5" armature="0.03"/></default>
    </default>
  </default>
  <worldbody>
    <light pos="0 0 3"/>
    <body name="trunk" pos="0 0 0.4" childclass="leg">
      <freejoint name="float"/>
      <inertial pos="0.02 0 0.01" quat="0.7 0.1 0.2 0.3" mass="6" diaginertia="0.1 0.2 0.25"/>
      <geom type="mesh" mesh="nowhere"/>
      <body name="thigh" pos="0.2 0.1 0" euler="0.1 0.2 0.3">
        <joint name="hip_x" axis="1 0 0" pos="0.01 0 0"/>
        <joint name="hip_y" pos="0 0.03 0" range="-1 2"/>
        <inertial pos="0 0 -0.1" {I}/>
        <body name="shank" pos="0 0 -0.3">
          <joint name="knee" class="knee"/>
          <inertial pos="0 0 -0.1" mass="0.5" fullinertia="0.1 0.1 0.1 0.01 0.02 0"/>
          <geom name="foot" class="foot"/>
          <site name="sole" pos="0 0 -0.32"/>
        </body>
      </body>
      <body name="tail" pos="-0.3 0 0"><joint name="tail" type="ball"/>
        <geom type="capsule" fromto="0 0 0 -0.2 0 0" size="0.02" density="500"/></body>
    </body>
  </worldbody>
  <actuator>
    <motor name="a" joint="hip_x" ctrlrange="-4 4"/>
    <general joint="knee" gear="-2" forcerange="-6 6" ctrlrange="-9 9"/>
  </actuator>
</mujoco>
"""
LEG = f"""
<mujoco model="leg"><worldbody><body name="thigh">
  <joint name="hip" axis="0 1 0"/><inertial pos="0.1 0 0" {I}/>
  <body name="shank" pos="0 0 -0.3"><joint name="knee" axis="0 1 0" damping="0.3"/><inertial pos="0.1 0 0" {I}/></body>
</body></worldbody><actuator><motor joint="hip"/><motor joint="knee" gear="5"/></actuator></mujoco>
"""


def edited(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


def said(path, **options):
    """The robot of a file, and the one line that loading it says."""
    with pytest.warns(RobotWarning) as caught:
        robot = load(path, **options)
    (text,) = [str(each.message) for each in caught]
    assert len(text.splitlines()) == 1
    return robot, text


def load_quietly(path):
    return said(path)[0]


def one_body(tmp_path, before="", body="", joint="", geom='<geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/>'):
    path = tmp_path / "one.xml"
    path.write_text(
        f'<mujoco>{before}<worldbody><body name="x" {body}><joint name="j" axis="0 1 0" {joint}/>{geom}</body>'
        "</worldbody></mujoco>"
    )
    return path
