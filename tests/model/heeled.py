"""Robots with a foot of heel and toe: a foot that carries a wheel, a block, and a leg on a slider."""

from spear_pin import load
from tests.model.looped import SLIDE, fixed, joint, lump, rod, write

HEEL, TOE, DEEP = -0.06, 0.14, 0.08  # m, from the ankle's axis
FOOT, WHEEL, AHEAD = 0.6, 2.0, 0.03  # kg, kg, and m from the ankle's axis to the foot's centre of mass
SPIN = 0.02  # kg·m² of the wheel


def at(x, z, part):
    """A fixed joint somewhere else."""
    return part.replace('xyz="0 0 0.0"', f'xyz="{x} 0 {z}"')


def sole(body, heel=HEEL, toe=TOE, deep=DEEP):
    """Heel and toe of a body."""
    ends = "".join(at(x, -deep, fixed(f"to_{name}", body, name)) for name, x in (("heel", heel), ("toe", toe)))
    return f'<link name="heel"/><link name="toe"/>{ends}'


def foot(mass=FOOT, ahead=AHEAD, down=0.04, inertia=2e-3):
    return f"""<link name="foot"><inertial><origin xyz="{ahead} 0 {-down}"/><mass value="{mass}"/>
    <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


PLANE = "".join(
    [
        '<link name="world"/><link name="carriage"/><link name="lift"/>',
        joint("x", "prismatic", "world", "carriage", axis="1 0 0"),
        joint("z", "prismatic", "carriage", "lift", axis="0 0 1"),
    ]
)


def wheeled(folder, kind="revolute", **ends):
    """A foot in the plane; a wheel turns about the ankle's axis, where its centre of mass lies, or slides along x."""
    wheel = lump("wheel", WHEEL).replace("0.01", str(SPIN))
    parts = [PLANE, foot(), wheel, joint("pitch", "revolute", "lift", "foot"), sole("foot", **ends)]
    ankle = joint("ankle", kind, "foot", "wheel", axis="0 -1 0" if kind == "revolute" else "1 0 0")
    urdf = f'<robot name="wheeled">{"".join(parts)}{ankle}</robot>'
    return load(write(folder, "wheeled", urdf, 'toes = ["heel", "toe"]\nmotors = ["ankle"]\n'), base="fixed")


def block(folder, half, high, kind="revolute"):
    """A uniform block in the plane, 2 half wide and 2 high high, of 3 kg."""
    inertia = 3.0 * (half**2 + high**2) / 3.0
    body = lump("block", 3.0).replace("0.01", repr(inertia))
    parts = [PLANE, body, joint("pitch", kind, "lift", "block"), sole("block", -half, half, high)]
    path = write(
        folder, "block", f'<robot name="block">{"".join(parts)}</robot>', 'toes = ["heel", "toe"]\nmotors = []\n'
    )
    return load(path, base="fixed")


LEG = "".join(
    [
        '<robot name="heeled"><link name="world"/>',
        lump("body", 1.5),
        rod("thigh", 0.3, 0.18),
        rod("shank", 0.2, 0.18),
        foot(0.1, 0.02, 0.02, 1e-4),
        SLIDE,
        joint("hip", "revolute", "body", "thigh"),
        joint("knee", "revolute", "thigh", "shank", at=-0.18, axis="0 1 0"),
        joint("ankle", "revolute", "shank", "foot", at=-0.18),
        sole("foot", -0.03, 0.08, 0.03),
        "</robot>",
    ]
)
MOTORS = "".join(
    f"[motors.{name}]\nratio = {ratio}\nrotor_inertia = 3.3e-5\n"
    for name, ratio in (("hip", 9.0), ("knee", 9.0), ("ankle", 6.0))
)


def leg(folder):
    """A leg on a slider with motors on hip, knee and ankle."""
    return load(write(folder, "heeled", LEG, f'toes = ["heel", "toe"]\n{MOTORS}'), base="fixed")
