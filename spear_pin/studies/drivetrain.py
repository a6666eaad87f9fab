"""Gear ratio and motor of SPEAR-II's knee against the hop's dynamics: what each choice takes and what it can do.

A heavier or higher geared rotor gives the same torque at less current, and is more for the leg to swing and to
stop at touchdown. So the hop is solved anew for every motor and ratio; nothing is scaled from one to another.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from spear_pin.errors import BadValue, NoGait, require
from spear_pin.gaits.attempts import Measure
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.measures.curves import Curves
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.simulate import simulate
from spear_pin.kinds import typed
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import gearbox
from spear_pin.model.motor import Drive, Gearbox, Motor, drawn_power
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.model.variants import vary
from spear_pin.studies.hardware import Rig

EQUAL_FLIGHT: Mapping[str | Measure, float] = MappingProxyType({"flight_time": 0.2})  # s (source)
TWO_STAGES = gearbox("spear_ii_knee_gear").efficiency
UNLIMITED = Battery(1e6)  # V, more than anything asks for
NEEDED = ("torque_constant", "resistance", "rotor_inertia")  # of a motor


@dataclass(frozen=True)
class KneeDrive:
    """A motor and a gear ratio at the knee, and a hop with them; figures of the knee alone, a hop, NaN without a gait.

    Attributes:
        motor: its name.
        drive: motor, gears, supply and limit.
        reflected_inertia: N² J, in kg·m².
        stance_torque: τ̄ that the law asks for, in N·m.
        multiplier: magnitude of the largest, 1.
        apex: height of the hip, in m.
        impact: lost at touchdown, in J.
        energy: that the battery gives, less what it gets back, in J.
        drawn: the same if it gets nothing back, in J.
        heat: of the winding, in J.
        rms_torque: root mean square at the joint, in N·m.
        rms_current: root mean square, in A.
        thermal_load: rms torque of the motor over its continuous torque, 1; the square is that of the heats.
        peak_torque: at the joint, in N·m.
        peak_current: in A.
        peak_speed: of the joint, in rad/s.
        margin: least distance from the drive's torque-speed envelope, in N·m; negative outside.
        gait: the gait, found with the gears' losses but without limits; None where none was found.
        reason: why the drive cannot do it; empty if it can, heat apart.
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
        """Whether it can do the hop for as long as the winding stands the heat."""
        return not self.reason

    @property
    def endures(self) -> bool:
        """Whether it can do the hop for ever, within the motor's continuous torque."""
        return self.can and self.thermal_load <= 1.0


def knee_drives(
    robot: Robot,
    motors: Mapping[str, Motor],
    ratios: Sequence[float],
    *,
    efficiency: float = TWO_STAGES,
    bus: float = 24.0,
    current_limit: float | None = None,
    target: Mapping[str | Measure, float] = EQUAL_FLIGHT,
    law: HoppingLaw | None = None,
    spring: Spring | None = None,
    retune: bool = True,
) -> Iterator[KneeDrive]:
    """One and the same hop with every motor and gear ratio at the knee.

    The ratio and the rotor are changed in the robot, from where mass matrix, actuator and envelope have them. The
    stance torque is solved for with the gears' losses and without limits: what the hop needs. That is then held
    against envelope and continuous torque. Inside the envelope the limits would have changed nothing.

    The masses of another motor and gearbox are not accounted for, nor the inertia of the gears.

    Args:
        robot: SPEAR-II, with the knee that the law's gains are meant for.
        motors: by name, each with torque constant, resistance, rotor inertia and continuous torque.
        ratios: of the knee's gears. Each gait is started from that of the nearest reflected inertia so far.
        efficiency: of the gears, whatever the ratio (default: of two stages, a recollection).
        bus: of the supply, in V.
        current_limit: of the amplifier, in A; None: none.
        target: one measure of the cycle that is the same for all.
        law: parameters of the controller.
        spring: the knee spring.
        retune: let the knee's gains in flight grow with its inertia in the air, so that the leg swings and comes
            down as it does with the robot's own knee. Else they stay, and a heavy rotor is still swinging at
            touchdown.

    Raises:
        BadValue: there are no motors or ratios, a number is out of range, or one of a motor is not known.
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
        for quantity in NEEDED:
            motor.known(quantity)
        _ = motor.continuous_torque
    law = law or HoppingLaw()
    drives = [
        (name, [Drive(motor, Gearbox(ratio, efficiency), bus, current_limit) for ratio in ratios])
        for name, motor in motors.items()
    ]

    def rows() -> Iterator[KneeDrive]:
        found: list[tuple[float, Gait]] = []
        for name, own in drives:
            for drive in own:
                inertia = drive.reflected_inertia
                near = min(found, key=lambda each: abs(math.log(each[0] / inertia)))[1] if found else None  # noqa: B023
                row = _solved(name, drive, robot, law, spring, target, retune, near)
                if row.gait is not None:
                    found.append((inertia, row.gait))
                yield row

    return rows()


@typed
def knee_inertia(robot: Robot, law: HoppingLaw) -> float:
    """Inertia that a torque on the knee alone has to accelerate in the air, at the touchdown angles, in kg·m²."""
    q = np.zeros(robot.nq)
    q[robot.index("knee")] = law.knee_touchdown
    q[robot.index("hip")] = 0.5 * law.knee_touchdown if law.hip_touchdown is None else law.hip_touchdown
    knee = robot.index("knee")
    return float(1.0 / np.linalg.inv(robot.mass_matrix(q))[knee, knee])


@typed
def judged(motor: str, drive: Drive, gait: Gait) -> KneeDrive:
    """The figures of a hop with a drive, and what speaks against it.

    Args:
        motor: its name.
        drive: at the knee; supply and limit need not be those that the gait was found with.
        gait: on hardware, with the drive's motor and gearbox at the knee.

    Raises:
        BadValue: the gait has another motor or gearbox at the knee, or none.
    """
    system, joints = gait.system, gait.system.robot.actuated
    actuator = None if system.hardware is None else system.hardware.actuators[joints.index("knee")]
    if actuator is None or (actuator.motor, actuator.gearbox) != (drive.motor, drive.gearbox):
        raise BadValue("gait", gait, "one on hardware, with the drive's motor and gearbox at the knee")
    run = simulate(system, gait.state, 1, progress=False)
    assert run.electrical is not None
    knee, resistance = joints.index("knee"), drive.motor.known("resistance")
    torque, current, speed = run.u[:, knee], run.current[:, knee], run.v[:, run.coordinates.index("knee")]
    period, curves = float(run.t[-1] - run.t[0]), Curves.of(run.t)
    heat = -float(run.electrical["joule_knee"][0])
    power = (resistance * current + drive.constant * speed) * current
    rms = math.sqrt(heat / (resistance * period))  # where the toe chatters the mean current would be too little
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
        rms_torque=math.sqrt(curves.integral(torque**2) / period),
        rms_current=rms,
        thermal_load=drive.motor.known("torque_constant") * rms / drive.motor.continuous_torque,
        peak_torque=curves.amount(torque),
        peak_current=float(np.abs(current).max()),
        peak_speed=curves.amount(speed),
        margin=worst.margin,
        gait=gait,
        reason=reason,
    )


def _solved(
    name: str,
    drive: Drive,
    robot: Robot,
    law: HoppingLaw,
    spring: Spring | None,
    target: Mapping[str | Measure, float],
    retune: bool,
    near: Gait | None,
) -> KneeDrive:
    """One row; started from a gait near by, and where that leads nowhere, afresh."""
    motor, gears = drive.motor, drive.gearbox
    fitted = vary(robot, knee_ratio=gears.ratio, knee_rotor=motor.known("rotor_inertia"))
    if retune:
        more = knee_inertia(fitted, law) / knee_inertia(robot, law)
        law = replace(law, knee_gain=more * law.knee_gain, knee_damping=more * law.knee_damping)
    rig = Rig(knee=motor, knee_efficiency=gears.efficiency, battery=UNLIMITED, current_limit=math.inf)
    failure: NoGait | None = None
    for start in (None,) if near is None else (near, None):
        torque = law.stance_torque / gears.efficiency if start is None else start.system.law.stance_torque
        begun = replace(law, stance_torque=torque)
        system = with_hardware(hopping(fitted, begun, spring), rig.on(fitted))
        try:
            gait = find_gait(system, ["stance_torque"], target, guess=None if start is None else start.state)
        except NoGait as error:
            failure = error
            continue
        return judged(name, drive, gait)
    return KneeDrive(name, drive, drive.reflected_inertia, reason=str(failure))
