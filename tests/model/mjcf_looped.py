"""Robots with closed loops in MuJoCo's own format: a parallelogram, and a leg of it on a slider with a belt."""

ARM, BASE = 0.1, 0.25  # m: lengths of crank and rocker, and of coupler and ground


def bar(name, where, inside="", x=0.0, z=0.0, ref=""):
    """A body that turns about -y, so that a positive angle swings what hangs from it forward."""
    return f"""<body name="{name}" pos="{where}"><joint name="{name}" axis="0 -1 0" {ref}/>
    <inertial pos="{x} 0 {z}" mass="0.2" diaginertia="1e-3 1e-3 1e-3"/>{inside}</body>"""


COUPLER = bar("coupler", f"0 0 {-ARM}", f'<site name="tip" pos="{BASE} 0.03 0"/>', x=BASE / 2)
ROCKER = bar("rocker", f"{BASE} 0.03 0", f'<site name="pivot" pos="0 0 {-ARM}"/>', z=-ARM / 2)
BARS = bar("crank", "0 0 0", COUPLER, z=-ARM / 2) + ROCKER
PIN = f'<connect name="pin" body1="coupler" body2="rocker" anchor="{BASE} 0.03 0"/>'
BELT = '<joint name="belt" joint1="pulley" joint2="crank" polycoef="0 -3 0 0 0"/>'
MOTOR = '<motor joint="crank"/>'


def machine(loops=PIN, bars=BARS, motors=MOTOR, before=""):
    """A file of bars on a slider, with its equality constraints; at zero angles the bars hang as a rectangle."""
    return f"""<mujoco model="machine"><compiler angle="radian"/>{before}<worldbody>
    <site name="hook" pos="{BASE} 0.03 {0.5 - ARM}"/>
    <body name="body" pos="0 0 0.5"><joint name="lift" type="slide" axis="0 0 1"/>
    <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>{bars}</body>
    </worldbody><equality>{loops}</equality><actuator>{motors}</actuator></mujoco>"""
