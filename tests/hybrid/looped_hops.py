"""Hops of a crank leg and of a five-bar leg: a spring bends with the leg, and motors push from the lowest point on."""

from dataclasses import dataclass

import numpy as np

from spear_pin import Contact, Spring
from spear_pin.gaits.springing import springing
from spear_pin.hybrid.automaton import OPEN, STICK, Domain, Guard, HybridSystem, Reset
from spear_pin.hybrid.phases import contact_domains, rate, touchdown
from spear_pin.model.cable import Anchor, Between
from spear_pin.model.path import Joints

CABLE = Between(Anchor("body", (0.0, 0.0, -0.3)), Anchor("foot", (0.0, 0.0, 0.0)))  # folding the leg lengthens it
SPRINGS = {
    "crank_leg": Spring(2500.0, damping=5.0, path=CABLE),
    "five_bar": Spring(12.0, damping=0.06, path=Joints({"front_hip": 1.0, "back_hip": -1.0})),
}


@dataclass(frozen=True)
class PushLaw:
    """Motors push while the leg extends, and are position servos in flight."""

    push: float = 1.2  # N·m
    rise_time: float = 0.005  # s
    landing: float = 0.1  # rad
    gain: float = 8.0  # N·m/rad
    damping: float = 0.25  # N·m·s/rad


LAWS = {
    "crank_leg": PushLaw(push=2.0, landing=-0.35),
    "five_bar": PushLaw(push=1.2, landing=0.9, gain=6.0, damping=0.15),
}
FOLDS = (1.0, -1.0)  # sense in which each motor folds the leg


def looped_hopping(robot, law=None, spring=None, contact=None):
    """Returns hopping on a leg with loops whose motors are those of its independent joints."""
    law, contact = law or LAWS[robot.name], contact or Contact()
    springs = spring or {"leg": SPRINGS[robot.name]}
    legs = springing(robot, springs)
    motors = [(sign, robot.index(joint)) for sign, joint in zip(FOLDS, robot.actuated, strict=False)]

    def pushing(t, q, v, held, p, dyn, ops):
        return [-sign * p.push * ops.tanh(t / p.rise_time) for sign, _ in motors]

    def resting(t, q, v, held, p, dyn, ops):
        return [0.0 for _ in motors]

    def aiming(t, q, v, held, p, dyn, ops):
        return [p.gain * (sign * p.landing - q[i]) - p.damping * v[i] for sign, i in motors]

    lift_off = Reset(release=legs.released, phase="flight")
    land = Reset(impact=("toe",), latch=lambda q, v, held, p: legs.engage(q, held), phase="compression")
    bottom = Guard("bottom", rate(0, side=-1.0), Reset(phase="extension"))
    switches = legs.switches(legs.standing)
    compression = Domain(
        "compression", "compression", (STICK,), resting, mounts=legs.standing, guards=(bottom, *switches)
    )
    extension = Domain("extension", "extension", (STICK,), pushing, mounts=legs.standing, guards=switches)
    flight = Domain("flight", "flight", (OPEN,), aiming, guards=(touchdown("toe", land), Guard("apex", rate(0))))

    def guess():
        q = np.zeros(robot.nv)
        for sign, i in motors:
            q[i] = sign * law.landing
        q = robot.closed(near(robot, q))
        q[0] = -robot.toe_position(q, "toe")[1]
        fall = robot.reduced(q, [-0.6, *[0.0] * robot.nu])
        J = robot.toe_jacobian(q, "toe") @ fall.T
        rates = np.concatenate([[-0.6], -np.linalg.lstsq(J[:, 1:], J[:, 0] * -0.6, rcond=None)[0]])
        return q, fall.T @ rates

    grounded = [contact_domains(domain, robot.toes, lift_off) for domain in (compression, extension)]
    return HybridSystem(
        kind="looped_hopping",
        robot=robot,
        law=law,
        springs=springs,
        contact=contact,
        domains=(*grounded[0], *grounded[1], flight),
        section="touchdown",
        cyclic=(),
        build=looped_hopping,
        guess=guess,
        measures={"flight_time": lambda run: run.durations["flight"]},
        sprung=True,
    )


def near(robot, q):
    """A configuration near the one in which the leg hangs below its motors, rather than folds up through itself."""
    q = q.copy()
    if robot.name == "crank_leg":
        q[robot.index("rod")], q[robot.index("slide")] = -0.45 - q[robot.index("crank")], 0.13
    else:
        q[robot.index("front_knee")], q[robot.index("back_knee")] = -1.5, 1.5
    return q
