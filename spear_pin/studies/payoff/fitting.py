"""Motors of a payoff study: those of the robot, or ones that suffice for a gait without springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from spear_pin.errors import Infeasible, NoGait, SpearError
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.motor import Drive
from spear_pin.model.robot import Robot
from spear_pin.studies.design import joints_of
from spear_pin.studies.payoff.gaits import Gaits
from spear_pin.studies.payoff.motors import PARTS, Motors, assume_motor, known, own_rotors
from spear_pin.studies.payoff.searcher import Tell
from spear_pin.studies.payoff.store import Store


def motors_for(
    gaits: Gaits,
    robot: Robot,
    drives: Mapping[str, Drive],
    bus: float | None,
    speeds: Sequence[float],
    store: Store,
    tell: Tell,
) -> Motors:
    """Returns the given motors, the robot's own, or assumed ones."""
    found, said, own = dict(drives), dict.fromkeys(drives, "given"), []
    for part in PARTS:
        if part in found:
            continue
        own_drive = known(robot, part, bus)
        if own_drive is not None:
            found[part], said[part] = own_drive
            own.append(part)
    if missing := [part for part in PARTS if part not in found]:
        takes = _taken(gaits, robot, speeds, store, tell)
        for part in missing:
            torque, rate = takes["takes"][part]
            found[part] = assume_motor(robot, part, torque, rate, bus)
            said[part] = "assumed"
            own += [part] * (part in own_rotors(robot))
    replaced = tuple(part for part in drives if part in own_rotors(robot))
    return Motors(found["knee"], found["hip"], said, tuple(own), replaced)


def _taken(gaits: Gaits, robot: Robot, speeds: Sequence[float], store: Store, tell: Tell) -> dict[str, Any]:
    """Returns torque and speed of each part in a gait of least effort without springs, the fastest that exists.

    Raises:
        NoGait, Infeasible: there is no such gait.
    """
    found = store.get("reference")
    if found is not None:
        return found
    failure: SpearError | None = None
    for speed in sorted(speeds, reverse=True):
        tell(f"searching for what motors have to do {gaits.words.pace.format(speed)}")
        try:
            gait = gaits.reference(robot, speed)
        except (Infeasible, NoGait) as error:
            failure = error
            continue
        cycle = Sampled(robot, simulate(gait.system, gait.state, progress=False))
        loads = [cycle.of(kind) for kind in ("rms_torque", "peak_speed")]
        takes = {part: [max(load[joint] for joint in joints_of(robot, part)) for load in loads] for part in PARTS}
        store.keep({"key": "reference", "speed": speed, "takes": takes})
        return store.get("reference") or {}
    assert failure is not None
    raise failure
