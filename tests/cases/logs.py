"""Logs of one release, as laboratories write them: stiffness, damping and rest angle are those it was made with."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.studies.identification import cut_releases, identify, read_record
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import PassiveKnee, spear_ii
from tests.cases.case import Case

KNEE = PassiveKnee(48.0, 1.0, 0.0, 1.0)
RIGHT = (KNEE.stiffness, KNEE.damping, KNEE.zero)
FOUND = "by what the release was made with"
UNIX = 1_700_000_000  # s
TURN = 2 * np.pi
Times, Angles = Callable[[int], str], Callable[[Array], Array]


@cache
def release() -> tuple[Array, Array]:
    """Times from 0 on, every 4 ms, and angles of a release, in s and rad."""
    trial = synthetic_trial(spear_ii(), KNEE, 0.1, 0.0, np.random.default_rng(0), rate=250.0)
    return trial.t - trial.t[0], trial.angle


def identified(head: str, times: Times, angles: Angles = lambda angle: angle, mark: str = ",", decimal: str = "."):
    """What finds stiffness, damping and rest angle in a log with these lines above its rows, or says why not."""

    def find(folder: Path) -> list[float] | str:
        _, angle = release()
        rows = [f"{times(4 * i)}{mark}{a:.7f}".replace(".", decimal) for i, a in enumerate(angles(angle))]
        path = folder / "log.csv"
        path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
        try:
            trials, _ = cut_releases(read_record(path))
        except SpearError as error:
            return str(error)
        found = identify(spear_ii(), trials)
        return [found[name].value for name in ("stiffness", "damping", "rest_angle")]

    return find


def _seconds(ms: int) -> str:
    return f"{ms // 1000}.{ms % 1000:03}"


def _unix(ms: int) -> str:
    return f"{UNIX + ms // 1000}.{ms % 1000:03}"


def _wrapped(angle: Array) -> Array:
    return np.mod(angle - 1.3, TURN) + 1.3 - TURN


def _case(name: str, *arguments, right=RIGHT) -> Case:
    found = FOUND if right is RIGHT else "by the units that there are"
    return Case(name, "log", right, found, identified(*arguments), tolerance=0.02)


CASES = (
    _case("plain", "time_s,angle_rad", _seconds),
    _case("a Unix clock, in s", "Time,position_rad", _unix),
    _case("a Unix clock, in ms, with no unit", "stamp,position_rad", lambda ms: str(UNIX * 1000 + ms)),
    _case("rostopic's %time, in ns", "%time,position_rad", lambda ms: str((UNIX * 1000 + ms) * 10**6)),
    _case("milliseconds in a word", "Time (milliseconds),angle (radians)", str),
    _case("usec", "t_usec,angle_rad", lambda ms: str(1000 * ms)),
    _case("the micro sign", "time [\u00b5s],angle_rad", lambda ms: str(1000 * ms)),
    _case("the letter mu", "time [\u03bcs],angle_rad", lambda ms: str(1000 * ms)),
    _case("seconds in a word, degrees", "Time (seconds),knee (degrees)", _seconds, np.degrees),
    _case("turns", "time [s],knee [turns]", _seconds, lambda angle: angle / TURN),
    _case(
        "a unit that is none", "time [s],knee [furlongs]", _seconds,
        right="'furlongs'; valid: rad, mrad, deg, turns, V, mV, counts",
    ),
    _case("an encoder that wraps, in rad", "time_s,angle_rad", _seconds, _wrapped),
    _case("an encoder that wraps, in degrees", "time_s,angle_deg", _seconds, lambda angle: np.degrees(_wrapped(angle))),
    _case("a title", "Push test 3\noperator,nobody\ntime_s,angle_rad", _seconds),
    _case("a row of units", "time,angle\nms,deg", str, np.degrees),
    _case(
        "a title, units, decimal commas", "Versuch; 3\nZeit;Winkel\n[s];[°]", _seconds, np.degrees, ";", ","
    ),
)  # fmt: skip
