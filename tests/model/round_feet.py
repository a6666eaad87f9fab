"""SPEAR-II with a round foot, two spokes of a rimless wheel with feet of any radius, and a rocker."""

import math

from spear_pin import load
from spear_pin.model.loading import ROBOTS
from tests.model.looped import fixed, joint, write

SPREAD = math.pi / 8  # rad, half the angle between two spokes


def round_spear(folder, feet):
    """SPEAR-II on its slider, with these feet."""
    text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
    return load(write(folder, "round_spear", text, f'toes = ["toe"]\nlocked = ["boom_x"]\n{feet}'), base="fixed")


def spokes(folder, radius):
    """A body of 1 kg and 0.1 kg·m² on two spokes, whose feet touch 1 m from it."""
    reach = 1.0 - radius
    ends = {"back": -reach * math.sin(SPREAD), "front": reach * math.sin(SPREAD)}
    feet = "".join(f"[feet.{name}]\nradius = {radius}\n" for name in ends) if radius else ""
    down = -reach * math.cos(SPREAD)
    urdf = "".join(
        [
            '<robot name="spokes"><link name="world"/><link name="carriage"/><link name="lift"/>',
            '<link name="wheel"><inertial>',
            '<mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>',
            *(f'<link name="{name}"/>' for name in ends),
            joint("x", "prismatic", "world", "carriage", axis="1 0 0"),
            joint("z", "prismatic", "carriage", "lift", axis="0 0 1"),
            joint("pitch", "revolute", "lift", "wheel"),
            *(
                fixed(f"to_{name}", "wheel", name, down).replace(f'xyz="0 0 {down}"', f'xyz="{x} 0 {down}"')
                for name, x in ends.items()
            ),
            "</robot>",
        ]
    )
    return load(write(folder, "spokes", urdf, f'toes = ["back", "front"]\nmotors = []\n{feet}'), base="fixed")


def rocker(folder, foot, hang):
    """A body of 1 kg and 0.1 kg·m² free in the plane, whose centre of mass is below its toe, the centre of an arc."""
    urdf = "".join(
        [
            '<robot name="rocker"><link name="world"/><link name="carriage"/><link name="lift"/><link name="body">',
            f'<inertial><origin xyz="0 0 {-hang}"/><mass value="1"/>',
            '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="toe"/>',
            joint("x", "prismatic", "world", "carriage", axis="1 0 0"),
            joint("z", "prismatic", "carriage", "lift", axis="0 0 1"),
            joint("pitch", "revolute", "lift", "body"),
            fixed("centre", "body", "toe"),
            "</robot>",
        ]
    )
    return load(write(folder, "rocker", urdf, f'toes = ["toe"]\nmotors = []\n[feet.toe]\n{foot}'), base="fixed")
