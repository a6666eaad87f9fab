"""URDF texts of robots with legs, for what is found in them and cut out of them."""

TRUNK = '<inertial><origin xyz="{com}"/><mass value="{mass}"/>{inertia}</inertial>'
INERTIA = '<inertia ixx="{0}" ixy="{3}" ixz="{4}" iyy="{1}" iyz="{5}" izz="{2}"/>'


def link(name, mass=0.0, com=(0, 0, 0), inertia=(0, 0, 0, 0, 0, 0)):
    """A link, inertia as xx, yy, zz, xy, xz, yz about the centre of mass."""
    if not mass:
        return f'<link name="{name}"/>'
    return f'<link name="{name}">{TRUNK.format(com=xyz(com), mass=mass, inertia=INERTIA.format(*inertia))}</link>'


def joint(name, kind, parent, child, place=(0, 0, 0), axis=(0, 0, 1), limits=(-3.0, 3.0), effort=20.0, friction=0.0):
    """A joint, with a little damping if it moves."""
    moving = kind in ("revolute", "prismatic", "continuous")
    ends = "" if kind == "continuous" else f'lower="{limits[0]}" upper="{limits[1]}" '
    bounds = f'<limit {ends}effort="{effort}" velocity="15"/>' if moving else ""
    rubbing = f'<dynamics damping="0.03" friction="{friction}"/>' if moving else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz(place)}"/><axis xyz="{xyz(axis)}"/>{bounds}'
        f"{rubbing}</joint>"
    )


def motor(name, ratio=8.0, rotor=1e-4):
    """A transmission."""
    return (
        f'<transmission name="{name}_drive"><type>transmission_interface/SimpleTransmission</type>'
        f'<joint name="{name}"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>'
        f'<actuator name="{name}_motor"><mechanicalReduction>{ratio}</mechanicalReduction>'
        f'<drake:rotor_inertia value="{rotor}"/><drake:gear_ratio value="{ratio}"/></actuator></transmission>'
    )


def xyz(vector):
    return " ".join(map(repr, vector))


def robot(*parts):
    return f'<robot name="made" xmlns:drake="http://drake.mit.edu">{"".join(parts)}</robot>'


def limb(
    name, place, y=1, hip=1, knee=1, knee_limits=(-0.1, 2.5), ahead=0.0, ankle=False, kind="revolute", friction=0.0
):
    """A leg below the link "trunk", its abduction about x.

    Args:
        name: prefix of its joints and links.
        place: of the abduction joint in the trunk.
        y: +1 on the left, -1 on the right, its mirror image.
        hip: sense of the hip's axis along y.
        knee: the same of the knee.
        knee_limits: in rad.
        ahead: of the toe before the shank, in m.
        ankle: whether it has one.
        kind: of hip and knee, "revolute" or "continuous".
        friction: Coulomb's, of hip and knee, in N·m.
    """
    foot = [
        link(f"{name}_foot", 0.06, (0.002, 0, 0), (2e-5, 3e-5, 2e-5, 0, 0, 0)),
        joint(f"{name}_sole", "revolute" if ankle else "fixed", f"{name}_shank", f"{name}_foot",
              (ahead, 0.004 * y, -0.21), (0, 1, 0)),
    ]  # fmt: skip
    return [
        link(f"{name}_bracket", 0.4, (0.01, 0.02 * y, 0), (4e-4, 5e-4, 6e-4, 1e-5 * y, 2e-5, 1e-5 * y)),
        link(f"{name}_thigh", 0.9, (0.004, 0.03 * y, -0.02), (5e-3, 4e-3, 1.4e-3, 2e-4 * y, 1e-4, 3e-4 * y)),
        link(f"{name}_shank", 0.2, (0.005, 0.001 * y, -0.09), (1e-3, 9e-4, 1.5e-4, 1e-5 * y, 3e-5, 2e-5 * y)),
        joint(f"{name}_swing", "revolute", "trunk", f"{name}_bracket", place, (1, 0, 0), (-0.7, 0.7)),
        joint(f"{name}_pitch", kind, f"{name}_bracket", f"{name}_thigh", (0.02, 0.05 * y, -0.01), (0, hip, 0),
              (-1.0, 2.0), 25.0, friction),
        joint(f"{name}_bend", kind, f"{name}_thigh", f"{name}_shank", (0.0, 0.03 * y, -0.19), (0, knee, 0),
              knee_limits, 30.0, friction),
        *foot,
        *(motor(f"{name}_{part}", 6.0 + i) for i, part in enumerate(("swing", "pitch", "bend"))),
    ]  # fmt: skip


def quadruped(float_base=True, extra=(), **of_leg):
    """Four legs on a trunk, left and right mirror images; hind knees forward, front ones backward by default."""
    trunk = link("trunk", 6.0, (0.02, 0, 0.03), (0.03, 0.09, 0.1, 0, 2e-3, 0))
    base = [link("world"), joint("base", "floating", "world", "trunk")] if float_base else []
    legs = []
    for name, x, y in (("FL", 0.2, 1), ("FR", 0.2, -1), ("HL", -0.2, 1), ("HR", -0.2, -1)):
        limits = (-2.5, 0.1) if x > 0 else (-0.1, 2.5)
        legs += limb(name, (x, 0.06 * y, 0.0), y, **{"knee_limits": limits, **of_leg})
    return robot(*base, trunk, *legs, *extra)


def slider(**of_leg):
    """One leg on a trunk that slides in the plane and has a mass of 2 kg."""
    trunk = link("trunk", 2.0, (0.01, 0.02, 0.03), (0.01, 0.02, 0.03, 0, 0, 0))
    rails = [
        link("world"),
        link("carriage"),
        joint("rail_x", "prismatic", "world", "carriage", axis=(1, 0, 0)),
        joint("rail_z", "prismatic", "carriage", "trunk", axis=(0, 0, 1)),
    ]
    return robot(*rails, trunk, *limb("one", (0.1, 0.06, 0.02), **of_leg))
