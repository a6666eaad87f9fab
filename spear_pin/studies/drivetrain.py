"""Gear ratio and motor of SPEAR-II's knee with the hop's dynamics: cost and ability of each choice.

A heavier rotor, or one with a higher gear ratio, gives the same torque with less current. But the leg must swing it,
and stop it at touchdown. So the hop is solved again for every motor and ratio; nothing is scaled from one to another.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from spear_pin.errors import BadValue, NoGait, require
from spear_pin.gaits.attempts import MeasureOfRun
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.reaching import pose_leg
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.simulate import simulate
from spear_pin.kinds import typed
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import gearbox
from spear_pin.model.motor import Drive, Gearbox, Motor, drawn_power
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.model.variants import with_knee_motor
from spear_pin.studies.hardware import Rig

EQUAL_FLIGHT: Mapping[str | MeasureOfRun, float] = MappingProxyType({"flight_time": 0.2})  # s (source)
TWO_STAGES = gearbox("spear_ii_knee_gear").efficiency
UNLIMITED = Battery(1e6)  # V, more than anything asks for


@dataclass(frozen=True)
class KneeDrive:
    """A motor and a gear ratio at the knee with a hop; figures are those of the knee in one hop, NaN without a gait.

    Attributes:
        motor: name of the motor.
        drive: motor, gears, supply and limit.
        reflected_inertia: N² J, in kg·m².
        stance_torque: τ̄ of the law, in N·m.
        multiplier: modulus of the largest multiplier, 1.
        apex: height of the hip, in m.
        impact: energy lost at touchdown, in J.
        energy: net energy from the battery, in J.
        drawn: energy from the battery if it gets nothing back, in J.
        heat: heat of the winding, in J.
        rms_torque: root mean square torque at the joint, in N·m.
        rms_current: root mean square current, in A.
        thermal_load: rms torque of the motor over its continuous torque, 1; its square is the ratio of the heats.
        peak_torque: peak torque at the joint, in N·m.
        peak_current: peak current, in A.
        peak_speed: peak speed of the joint, in rad/s.
        margin: least distance from the drive's torque-speed envelope, in N·m; negative outside.
        gait: the gait, found with the gears' losses but without limits; None where none was found.
        reason: why the drive is not able to do the hop; empty if it is, apart from heat.
    """

    motor: str
    drive: Drive
    reflected_inertia: float
    stance_torque: float = math.nan
    multiplier: float = math.nan
    apex: float = math.nan
    impact: float = math.nan
    energy: float = math.nan
    drawn: float = math.nan
    heat: float = math.nan
    rms_torque: float = math.nan
    rms_current: float = math.nan
    thermal_load: float = math.nan
    peak_torque: float = math.nan
    peak_current: float = math.nan
    peak_speed: float = math.nan
    margin: float = math.nan
    gait: Gait | None = None
    reason: str = ""

    @property
    def ratio(self) -> float:
        """N, turns of the rotor per turn of the knee."""
        return self.drive.gearbox.ratio

    @property
    def can(self) -> bool:
        """Whether the drive can do the hop for as long as the winding stands the heat."""
        return not self.reason

    @property
    def endures(self) -> bool:
        """Whether the drive can do the hop for ever, within the motor's continuous torque."""
        return self.can and self.thermal_load <= 1.0


def knee_drives(
    robot: Robot,
    motors: Mapping[str, Motor],
    ratios: Sequence[float],
    *,
    efficiency: float = TWO_STAGES,
    bus: float = 24.0,
    current_limit: float | None = None,
    target: Mapping[str | MeasureOfRun, float] = EQUAL_FLIGHT,
    law: HoppingLaw | None = None,
    spring: Spring | None = None,
    retune: bool = True,
) -> Iterator[KneeDrive]:
    """Finds the same hop with every motor and gear ratio at the knee.

    Ratio, rotor and mass of the motor are changed in the robot, from which mass matrix, actuator and envelope take
    them. If the mass of a motor is not known, a `RobotWarning` names the motor. The stance torque
    is solved for with the gears' losses and without limits: it is what the hop needs. The result is then compared with
    envelope and continuous torque. Inside the envelope the limits would have changed nothing.

    The mass of another gearbox, and the inertia of the gears, are not accounted for.

    Args:
        robot: SPEAR-II, with the knee that the law's gains are meant for.
        motors: motors by name, each with torque constant, resistance, rotor inertia and continuous torque.
        ratios: ratios of the knee's gears. Each gait is started from that of the nearest reflected inertia so far.
        efficiency: efficiency of the gears, whatever the ratio (default: of two stages, a recollection).
        bus: voltage of the supply, in V.
        current_limit: current limit of the amplifier, in A; None: there is none.
        target: one measure of the cycle that is the same for all.
        law: parameters of the controller.
        spring: the knee spring.
        retune: whether the knee's gains in flight grow with its inertia in the air, so that the leg swings and comes
            down like the robot's own. Else they stay, and a heavy rotor is still swinging at touchdown.

    Raises:
        BadValue: there are no motors or ratios, a number is out of range, or a number of a motor is not known.
    """
    if not motors:
        raise BadValue("motors", dict(motors), "at least one")
    if not len(ratios):
        raise BadValue("ratios", ratios, "at least one")
    for i, ratio in enumerate(ratios):
        require(f"ratios[{i}]", ratio, lambda n: n > 0, "a number > 0")
    if len(target) != 1:
        raise BadValue("target", dict(target), "one measure, for which the stance torque is solved")
    for motor in motors.values():
        motor.check_known()
    law = law or HoppingLaw()
    drives = [
        (name, Drive(motor, Gearbox(ratio, efficiency), bus, current_limit))
        for name, motor in motors.items()
        for ratio in ratios
    ]
    found: list[tuple[float, Gait]] = []

    def solved(name: str, drive: Drive) -> KneeDrive:
        """Starts from a nearby gait, and if that leads nowhere, from the beginning."""
        inertia, own = drive.reflected_inertia, law
        rotor = drive.motor.known("rotor_inertia")
        fitted = with_knee_motor(robot, drive.motor, knee_ratio=drive.gearbox.ratio, knee_rotor=rotor)
        if retune:
            more = knee_inertia(fitted, law) / knee_inertia(robot, law)
            own = replace(law, knee_gain=more * law.knee_gain, knee_damping=more * law.knee_damping)
        rig = Rig(knee=drive.motor, knee_efficiency=efficiency, battery=UNLIMITED, current_limit=math.inf)
        failure: NoGait | None = None
        near = [min(found, key=lambda each: abs(math.log(each[0] / inertia)))[1]] if found else []
        for start in (*near, None):
            torque = law.stance_torque / efficiency if start is None else start.system.law.stance_torque
            system = with_hardware(hopping(fitted, replace(own, stance_torque=torque), spring), rig.on(fitted))
            try:
                gait = find_gait(system, ["stance_torque"], target, guess=None if start is None else start.state)
            except NoGait as error:
                failure = error
                continue
            found.append((inertia, gait))
            return judge_drive(name, drive, gait)
        return KneeDrive(name, drive, inertia, reason=str(failure))

    return (solved(name, drive) for name, drive in drives)


@typed
def knee_inertia(robot: Robot, law: HoppingLaw) -> float:
    """Returns the inertia that a torque on the knee alone accelerates in the air, at the touchdown angles, in kg·m²."""
    q, knee = pose_leg(robot, law.hip_commanded, law.knee_touchdown), robot.index("knee")
    return float(1.0 / np.linalg.inv(robot.mass_matrix(q))[knee, knee])


@typed
def judge_drive(motor: str, drive: Drive, gait: Gait) -> KneeDrive:
    """Returns the figures of a hop with a drive, and the reasons against it.

    Args:
        motor: name of the motor.
        drive: drive at the knee; its supply and limit may differ from those with which the gait was found.
        gait: a gait on hardware, with the drive's motor and gearbox at the knee.

    Raises:
        BadValue: the gait has another motor or gearbox at the knee, or none.
    """
    system, joints = gait.system, gait.system.robot.actuated
    actuator = None if system.hardware is None else system.hardware.actuators[joints.index("knee")]
    if actuator is None or (actuator.motor, actuator.gearbox) != (drive.motor, drive.gearbox):
        raise BadValue("gait", gait, "a gait with hardware that has the drive's motor and gearbox at the knee")
    run = simulate(system, gait.state, 1, progress=False)
    assert run.electrical is not None
    knee, resistance = joints.index("knee"), drive.motor.known("resistance")
    sampled = Sampled(system.robot, run)
    torque, current, speed = sampled.torques["knee"], run.current[:, knee], sampled.speeds["knee"]
    heat = -float(run.electrical["joule_knee"][0])
    power = (resistance * current + drive.constant * speed) * current
    rms = math.sqrt(heat / (resistance * sampled.period))  # where the toe chatters the mean current would be too little
    worst, multiplier = drive.worst(torque, speed), float(np.abs(gait.multipliers).max())
    reason = ""
    if worst.margin < 0.0:
        reason = f"outside the envelope at {abs(worst.torque):.1f} N·m and {abs(worst.speed):.1f} rad/s"
        if not math.isfinite(worst.margin):
            reason += ", above the motor's max_speed"
        elif abs(worst.speed) > drive.no_load_speed:
            reason += f", above the no-load speed of {drive.no_load_speed:.1f} rad/s"
        else:
            reason += f", by {-worst.margin:.1f} N·m"
    elif not gait.stable:
        reason = f"unstable: a multiplier of magnitude {multiplier:.2f}"
    return KneeDrive(
        motor=motor,
        drive=drive,
        reflected_inertia=drive.reflected_inertia,
        stance_torque=gait.parameters["stance_torque"],
        multiplier=multiplier,
        apex=float(run.named("apex")[0].q[run.coordinates.index("boom_z")]),
        impact=-float(run.ledger["impact"][0]),
        energy=float(run.electrical["battery_knee"][0]),
        drawn=float(np.trapezoid(drawn_power(power, 0.0), run.t)),
        heat=heat,
        rms_torque=sampled.of("rms_torque")["knee"],
        rms_current=rms,
        thermal_load=drive.motor.known("torque_constant") * rms / drive.motor.continuous_torque,
        peak_torque=sampled.of("peak_torque")["knee"],
        peak_current=float(np.abs(current).max()),
        peak_speed=sampled.of("peak_speed")["knee"],
        margin=worst.margin,
        gait=gait,
        reason=reason,
    )
