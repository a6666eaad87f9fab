"""Assumptions of a payoff study, in words."""

from __future__ import annotations

from spear_pin.model.limits import UNKNOWN
from spear_pin.model.motor import Drive
from spear_pin.model.variants import MASS, SIZE
from spear_pin.studies.design import joints_of
from spear_pin.studies.payoff.gaits import SAID
from spear_pin.studies.payoff.motors import PARTS, SPARE
from spear_pin.studies.payoff.study import Study


def rests_of(study: Study) -> list[tuple[str, str]]:
    """Returns the assumptions of a study, as names and texts."""
    motors = [(f"{part} motors, {study.motors.said[part]}", _motor(study, part)) for part in PARTS]
    limits = "limits of the file", "; ".join(_limits(study, part) for part in PARTS)
    weighed = all(part in study.motors.own or f"{part}_{MASS}" in study.robot.varied for part in PARTS)
    left = "left out", SAID["left_out"].format("" if weighed else "other motors and of ")
    return [*motors, limits, *study.gaits.words.rests, *SAID["always"].items(), left]


def _motor(study: Study, part: str) -> str:
    drive: Drive = getattr(study.motors, part)
    name = drive.motor.name.removesuffix(" (assumption)")
    sized = f", to bear {SPARE:g} times the rms torque of a {study.gaits.words.one} of least effort without springs"
    instead = " instead of the file's" if part in study.motors.replaced else ""
    chosen = ", its size and mass chosen at each point" if f"{part}_{SIZE}" in study.gaits.over else ""
    rotor = f"rotor {drive.reflected_inertia:.2e} kg·m² at the joint{instead}"
    return (
        f"{name}{sized if study.motors.said[part] == 'assumed' else ''}; {drive.gearbox.ratio:g}:1, efficiency"
        f" {drive.gearbox.efficiency:g}, {drive.bus:g} V: {drive.continuous_torque:.3g} N·m for ever,"
        f" {drive.stall_torque:.3g} N·m at rest, {drive.no_load_speed:.3g} rad/s without load;"
        f" {'the rotor of the file' if part in study.motors.own else rotor}{chosen}"
    )


def _limits(study: Study, part: str) -> str:
    limits = study.robot.limits[joints_of(study.robot, part)[0]]
    effort, velocity = (
        f"{value:g} {unit}" if 0.0 < value < UNKNOWN else f"no limit in {unit}"
        for value, unit in ((limits.effort, "N·m"), (limits.velocity, "rad/s"))
    )
    return f"{study.gaits.words.joint.format(part=part)} {effort}, {velocity}"
