"""Guards of contacts, falls and springs: defines the events, and how near to zero a guard counts as zero."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.contact import SIGN, SLIP, SLOW, STICK
from spear_pin.hybrid.domain import Guard, GuardValue, Mount, Reset, Rub
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.elimination import determinant
from spear_pin.hybrid.rules.footing import AT_REST, LET_GO, LIFTS, UNLOADED, along, rate_along
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import Lever
from spear_pin.model.scalars import dot

ON_GROUND = 1e-8  # m: above the integration's error of the constraint, below any foot clearance
ON_REST = 1e-9  # rad: above the effect of an error in an event's time
AT_TOGGLE = 1e-3  # of the determinant as the leg lands: there a loop counts as at its toggle
NEAR_GROUND = 1e-6  # m: for a bouncing toe, whose integration errors add up over many short contacts


def height(frame: str) -> GuardValue:
    """Returns a guard on the distance of a frame from the ground, along its normal, in m."""
    return lambda t, q, v, held, p, dyn, ops: dyn.height(frame)


def normal_force(toe: str) -> GuardValue:
    """Returns a guard on the normal force of a toe, in N."""
    return lambda t, q, v, held, p, dyn, ops: dyn.force(toe)[-1]


def cone_margin(toe: str, side: float) -> GuardValue:
    """Returns the guard μ F_z + side F_x, in N, which is zero where the toe begins to slide to that side, (3.18).

    Toes of one body slide together, so F is the sum of the forces on those that are on the ground.
    """

    def margin(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        along, normal = dyn.foot_force(toe)
        return dyn.friction_coefficient * normal + side * along

    return margin


def circular_margin(toe: str) -> GuardValue:
    """Returns the guard (μ F_z)² - |F_t|², in N², which is zero where the toe begins to slide in space.

    Unlike μ F_z - |F_t| it has no kink at F_t = 0, near which a Taylor integrator takes short steps.
    """

    def margin(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        *tangential, normal = dyn.force(toe)
        grip = dyn.friction_coefficient * normal
        return grip * grip - dot(tangential, tangential)

    return margin


def slip_speed(toe: str, side: float) -> GuardValue:
    """Returns a guard on the sliding speed of a toe to one side, in m/s."""
    return lambda t, q, v, held, p, dyn, ops: side * dyn.toe_velocity(toe)[0]


def radial_speed(toe: str) -> GuardValue:
    """Returns a guard on the speed of a toe in space along its direction above the speed at which it stops, in m/s."""
    return lambda t, q, v, held, p, dyn, ops: along(dyn.direction(toe), dyn.toe_velocity(toe)[:-1]) - SLOW


def pivot(toe: str) -> GuardValue:
    """Returns the guard J_z D⁻¹ (J_z - μ J_tᵀ d)ᵀ of a slipping toe, in 1/kg: not positive is Painlevé's paradox."""
    return lambda t, q, v, held, p, dyn, ops: dyn.pivot(toe)


def make_unloading_guard(toe: str) -> GuardValue:
    """Returns a guard on a slipping toe's normal force times its pivot, in m/s²: zero at lift-off, not at a pole."""
    return lambda t, q, v, held, p, dyn, ops: dyn.force(toe)[-1] * dyn.pivot(toe)


def rate(index: int, side: float = 1.0) -> GuardValue:
    """Returns a guard on a coordinate's rate, times `side`."""
    return lambda t, q, v, held, p, dyn, ops: side * v[index]


def rise(toe: str) -> str:
    """Returns the name in `held` of the speed at which the last impact lifted a toe off, in m/s."""
    return f"{toe}_rise"


def stays(toe: str) -> GuardValue:
    """Returns a guard that is positive unless the impact by which the phase was entered lifts the toe off."""
    return lambda t, q, v, held, p, dyn, ops: LIFTS - held.get(rise(toe), 0.0)


def struck(toe: str) -> str:
    """Returns the name in `held` of a value that is 1 if an impact of another toe was one of this toe, too."""
    return f"{toe}_struck"


def strikes_too(toe: str) -> GuardValue:
    """Returns a guard that is positive unless the impact by which the phase was entered was one of this toe, too."""
    return lambda t, q, v, held, p, dyn, ops: 0.5 - held.get(struck(toe), 0.0)


def touchdown(toe: str, reset: Reset, name: str = "touchdown") -> Guard:
    """Returns the event that a toe reaches the ground from above."""
    return Guard(name, height(toe), reset, tolerance=ON_GROUND)


def fall(frames: Sequence[str]) -> tuple[Guard, ...]:
    """Returns guards that end the run when one of these frames reaches the ground."""
    return tuple(Guard(f"fall:{frame}", height(frame), ends="fall", tolerance=ON_GROUND) for frame in frames)


def toggle(robot: Robot, q: Array) -> tuple[Guard, ...]:
    """Returns the guard that ends the run where loops come to a toggle, det A_d = 0 for the dependent coordinates.

    Args:
        robot: the robot; without loops there is no guard.
        q: a configuration with closed loops, far from a toggle.
    """
    if robot.closure is None:
        return ()
    dependent = [i for i, name in enumerate(robot.coordinates) if name not in robot.independent]
    usual = float(np.linalg.det(robot.loop_jacobian(q)[:, dependent]))

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        found = determinant([[row[i] for i in dependent] for row in dyn.loop_jacobian]) / usual
        return ops.sqrt(found * found) - AT_TOGGLE  # on either side, as the leg may be assembled either way

    return (Guard("toggle", value, ends="toggle"),)


def spring_switches(mount: Mount, name: str = "spring_switch") -> tuple[Guard, ...]:
    """Returns the events of a unilateral spring that goes slack, or taut again, where it rests."""
    if mount.taut is None or not mount.spring.unilateral:
        return ()

    spring, taut, on = mount.name, mount.taut, mount.on  # a guard must not read the spring's numbers

    def stretch(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        found = (2.0 * held[taut] - 1.0) * dyn.stretch(spring)
        return found if on is None else held[on] * found + (1.0 - held[on])

    flip = Reset(latch=lambda q, v, held, p: {taut: 1.0 - held[taut]})
    return (Guard(name, stretch, flip, tolerance=ON_REST),)


def make_turning_event(mount: Mount) -> tuple[Guard, ...]:
    """Returns the event at which the path of a spring with hysteresis turns, so that it pulls along the other branch.

    Where it turns back on that branch too, events accumulate.
    """
    if mount.way is None:
        return ()
    name, way = mount.name, mount.way

    def onward(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return held[way] * dyn.pull(name).rate

    return (Guard(f"turns:{name}", onward, Reset(latch=lambda q, v, held, p: {way: -held[way]})),)


def to_spare(joint: str, side: float) -> GuardValue:
    """Returns a guard on the margin of dry friction over the force that holds a joint, to one side, in N or N·m."""

    def spare(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return dyn.most(joint) - side * dyn.holding(joint)

    return spare


def contact_guards(toe: str, mode: str, name: str, lift_off: Reset, ways: Sequence[str]) -> list[Guard]:
    """Returns the events of a toe on the ground: lift-off, slip or stick, and the end of the slip equation's validity.

    Args:
        toe: the toe.
        mode: its mode of contact.
        name: name of its lift-off.
        lift_off: reset of its lift-off.
        ways: modes in which it may slide.
    """
    leave = Guard(name, normal_force(toe), lift_off, tolerance=UNLOADED)
    if mode == STICK:
        margins = [circular_margin(toe) if way == SLIP else cone_margin(toe, SIGN[way]) for way in ways]
        return [leave, *(Guard("slip", margin, Reset(), tolerance=UNLOADED) for margin in margins)]
    ill_posed = Guard("painleve", pivot(toe), ends="painleve")
    if mode == SLIP:  # at its small remaining speed the toe would turn ever faster
        stop = Guard("stick", radial_speed(toe), Reset(stop=(toe,)), patience=SLOW)
        leave = Guard(name, make_unloading_guard(toe), lift_off, tolerance=UNLOADED)
    else:
        stop = Guard("stick", slip_speed(toe, SIGN[mode]), Reset(), tolerance=AT_REST)
    return [ill_posed, leave, stop]


def bounce_guards(toe: str, leg: str, clear: float, name: str, lift_off: Reset) -> list[Guard]:
    """Returns the events of a toe in the air whose leg bears: it strikes again, or clears the ground and lifts off.

    Args:
        toe: the toe.
        leg: name of its leg.
        clear: height at which it has lifted off, in m.
        name: name of its lift-off.
        lift_off: reset of its lift-off.
    """

    def near(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return clear - dyn.height(toe)

    strikes = Guard(f"{leg}_bounces", height(toe), Reset(impact=(toe,)), tolerance=NEAR_GROUND, patience=NEAR_GROUND)
    return [strikes, Guard(name, near, lift_off)]


def struck_together(toe: str, name: str, reset: Reset) -> Guard:
    """Returns the immediate touchdown of a toe that reached the ground in the instant in which the phase begins."""
    return Guard(name, strikes_too(toe), reset)


def lifted_off(toe: str, name: str, lift_off: Reset) -> Guard:
    """Returns the immediate lift-off of a toe that the impact on entering lifts off, while another stays."""
    return Guard(name, stays(toe), lift_off, tolerance=AT_REST)


def rubbing_guards(rub: Rub, lever: Lever) -> tuple[Guard, ...]:
    """Returns the events of dry friction: a moving joint comes to rest, a held joint is released to either side.

    Args:
        rub: mode of the joint, or of the path.
        lever: the path's lever.
    """
    sign, joint = rub.sign, rub.joint  # a guard must not read the friction's force
    if sign:

        def onward(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
            return sign * rate_along(lever, v)

        return (Guard(f"rest:{joint}", onward, Reset(), tolerance=AT_REST),)
    return tuple(Guard(f"let_go:{joint}", to_spare(joint, side), Reset(), tolerance=LET_GO) for side in (1.0, -1.0))
