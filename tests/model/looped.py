"""A crank leg and a five-bar leg on vertical sliders, of slender rods: a URDF of each tree and a TOML of its loop."""

from spear_pin import load

CRANK, ROD = 0.07, 0.15
UPPER, LOWER = 0.10, 0.20


def rod(name, mass, length):
    """A slender rod that hangs from its joint."""
    i = mass * length**2 / 12
    return f'''<link name="{name}"><inertial><origin xyz="0 0 {-length / 2}"/><mass value="{mass}"/>
    <inertia ixx="{i!r}" iyy="{i!r}" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial></link>'''


def lump(name, mass):
    return f'''<link name="{name}"><inertial><mass value="{mass}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'''


def joint(name, kind, parent, child, at=0.0, axis="0 -1 0", turn="0"):
    """A joint at a height in its parent; about -y, so that a positive angle swings what hangs from it forward."""
    return f'''<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="0 0 {at}" rpy="0 {turn} 0"/><axis xyz="{axis}"/>
    <limit lower="-10" upper="10" effort="100" velocity="100"/></joint>'''


def fixed(name, parent, child, at=0.0):
    return f'''<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="0 0 {at}"/></joint>'''


SLIDE = joint("boom_z", "prismatic", "world", "body", axis="0 0 1")
# the crank points forward at zero, and a positive angle lifts its pin; the foot slides down from the crank's axis
CRANK_LEG = "".join(
    [
        '<robot name="crank_leg"><link name="world"/>',
        lump("body", 2.0),
        rod("crank", 0.10, CRANK),
        rod("rod", 0.08, ROD),
        lump("foot", 0.15),
        '<link name="toe"/>',
        SLIDE,
        joint("crank", "revolute", "body", "crank", turn="-1.5707963267948966"),
        joint("rod", "revolute", "crank", "rod", at=-CRANK, turn="1.5707963267948966"),
        joint("slide", "prismatic", "body", "foot", axis="0 0 -1"),
        fixed("sole", "foot", "toe"),
        "</robot>",
    ]
)
CRANK_LOOP = f"""toes = ["toe"]
motors = ["crank"]
[loops.pin]
a = {{ body = "rod", at = [0, 0, {-ROD}] }}
b = {{ body = "foot", at = [0, 0, 0] }}
"""
CRANK_LOOP += "[reach]\nknee = { crank = 1.0 }\n"
FIVE_BAR = "".join(
    [
        '<robot name="five_bar"><link name="world"/>',
        lump("body", 2.0),
        *(rod(f"{side}_upper", 0.06, UPPER) + rod(f"{side}_lower", 0.04, LOWER) for side in ("front", "back")),
        '<link name="toe"/>',
        SLIDE,
        joint("front_hip", "revolute", "body", "front_upper"),
        joint("front_knee", "revolute", "front_upper", "front_lower", at=-UPPER),
        joint("back_hip", "revolute", "body", "back_upper"),
        joint("back_knee", "revolute", "back_upper", "back_lower", at=-UPPER),
        fixed("sole", "front_lower", "toe", at=-LOWER),
        "</robot>",
    ]
)
FIVE_BAR_LOOP = f"""toes = ["toe"]
motors = ["front_hip", "back_hip"]
[loops.pin]
a = {{ body = "front_lower", at = [0, 0, {-LOWER}] }}
b = {{ body = "back_lower", at = [0, 0, {-LOWER}] }}
[reach]
knee = {{ front_hip = 1.0, back_hip = -1.0 }}
hip = {{ front_hip = 0.5, back_hip = 0.5 }}
"""


def write(folder, name, urdf, toml):
    """Writes a robot's files, and returns the path of its URDF."""
    path = folder / f"{name}.urdf"
    path.write_text(urdf, encoding="utf-8")
    path.with_suffix(".toml").write_text(toml, encoding="utf-8")
    return path


def with_rotors(toml, rotors):
    """A TOML whose motors, all without gears, have these rotors, in kg·m²."""
    tables = "".join(f"[motors.{name}]\nratio = 1.0\nrotor_inertia = {rotor}\n" for name, rotor in rotors.items())
    kept = "".join(line for line in toml.splitlines(keepends=True) if not line.startswith("motors"))
    return kept + tables


def crank_leg(folder):
    return load(write(folder, "crank_leg", CRANK_LEG, with_rotors(CRANK_LOOP, {"crank": 0.002})), base="fixed")


def five_bar(folder):
    rotors = {"front_hip": 1.2e-4, "back_hip": 1.2e-4}
    return load(write(folder, "five_bar", FIVE_BAR, with_rotors(FIVE_BAR_LOOP, rotors)), base="fixed")
