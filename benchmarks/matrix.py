"""What can be done with each kind of gait: `python -m benchmarks.matrix`, Markdown on stdout.

Each cell is the processor time of one call, compilation included where it is the first that needs it, or the number of
a refusal, which the second table words. A call that takes longer than `--limit` seconds is stopped. Rows run one after
the other, each in a process of its own. `--row NAME` measures that row alone.
"""

from __future__ import annotations

import argparse
import json
import runpy
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table
from spear_pin import (
    Gait,
    HoppingLaw,
    continue_gait,
    find_gait,
    hopping,
    in_space,
    load,
    monopod,
    optimize_design,
    sagittal,
    simulate,
)
from spear_pin.errors import SpearError, UnknownName
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.round_hopping import round_hopping
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.parameters import number, with_hardware
from spear_pin.hybrid.periodic import multipliers
from spear_pin.model.mjcf import to_mjcf
from spear_pin.model.scale import scale_of
from spear_pin.studies.bound import bound_of
from spear_pin.studies.explore.carried import carry_gait
from spear_pin.studies.explore.gaits import gait_to_explore
from spear_pin.studies.hardware import Rig
from spear_pin.studies.hop_of_another import hop_of, scaled_hopping
from spear_pin.studies.sweep import grid, sweep

ROOT = Path(__file__).parents[1]
LANES = 64
VARIED = ("stiffness", "knee_stiffness", "friction")  # the first that a gait has is what varies
SHARE = 0.01  # of it
OWN_INPUTS = ("thrust", "set_back")  # of the biped's law, which lists none


def _hop() -> Gait:
    return find_gait(hopping(load("spear_ii", locked=["boom_x"])), ["stance_torque"], {"flight_time": 0.2})


def _other_hop() -> Gait:
    return find_gait(hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(stance_torque=6.5)))


def _free_hop() -> Gait:
    target = {"flight_time": 0.2, "mean_speed": 0.0}
    law = HoppingLaw(hip_touchdown=0.5)
    return find_gait(hopping(load("spear_ii"), law), ["stance_torque", "hip_touchdown"], target)


def _biped() -> Gait:
    example = runpy.run_path(str(ROOT / "examples" / "biped.py"))
    return find_gait(example["running"](load("biped")))


def _solo12(part: str) -> Gait:
    whole = load("solo12", base="free", motors="all")
    if part == "hop":
        leg = monopod(whole, "FL", locked=["boom_x"])
        return hop_of(scaled_hopping(leg), 0.2 * scale_of(leg).time)
    return bound_of(sagittal(whole))


GAITS: Mapping[str, Callable[[], Gait]] = {
    "hop": _hop,
    "hop, the other kind": _other_hop,
    "hop, free along x": _free_hop,
    "hop with a series spring": lambda: find_gait(series_hopping(load("spear_ii_series", locked=["boom_x"]))),
    "HOPPY's hop round its post": lambda: find_gait(round_hopping(load("hoppy"))),
    "biped's run": _biped,
    "bound long_stride": lambda: Gait.load("long_stride"),
    "bound force_lift_off": lambda: Gait.load("force_lift_off"),
    "bound in 3-D": lambda: in_space(Gait.load("long_stride")),
    **{name: partial(Gait.load, name) for name in ("turn_9", "trot", "pace", "pronk", "gallop")},
    "Solo12's hop": partial(_solo12, "hop"),
    "Solo12's bound": partial(_solo12, "bound"),
    "Solo12's trot": lambda: Gait.load(ROOT / "tests" / "solved" / "solo12_trot.json"),
}


def varied(gait: Gait) -> tuple[str, float]:
    """Return the name and the value of the number that varies."""
    for name in VARIED:
        try:
            return name, number(gait.system, name)
        except UnknownName:
            continue
    raise UnknownName("parameter", VARIED[0], [])


def _lanes(gait: Gait, folder: Path) -> object:
    return simulate_many(gait.system, *(np.tile(part, (LANES, 1)) for part in gait.state))


def _uncertain(gait: Gait, folder: Path) -> object:
    name, value = varied(gait)
    return gait.sensitivity([name]).uncertainty({name: SHARE * value})


def _followed(gait: Gait, folder: Path) -> object:
    name, value = varied(gait)
    return continue_gait(gait, name, ((1.0 - SHARE) * value, (1.0 + SHARE) * value))


def _designed(gait: Gait, folder: Path) -> object:
    name, value = varied(gait)
    return optimize_design(gait, "effort", {name: ((1.0 - SHARE) * value, (1.0 + SHARE) * value)})


def _swept(gait: Gait, folder: Path) -> object:
    name, value = varied(gait)
    points = grid({name: value * np.array([1.0 - SHARE, 1.0, 1.0 + SHARE])})
    return sweep(gait.system, points, folder / "points.zarr", guess=gait.state, n_jobs=1)


def _fed_back(gait: Gait, folder: Path) -> object:
    return add_feedback(gait, None if hasattr(gait.system.law, "inputs") else OWN_INPUTS)


def _kept(gait: Gait, folder: Path) -> object:
    gait.save(folder / "gait.json")
    return Gait.load(folder / "gait.json", like=gait.system)


def _exported(gait: Gait, folder: Path) -> object:
    simulate(gait.system, gait.state, 1, progress=False).export(folder / "motion.csv")
    return to_mjcf(gait.system.robot)


def _explored(gait: Gait, folder: Path) -> object:
    name, value = varied(gait)
    return carry_gait(gait_to_explore(gait, "").at(**{name: (1.0 + SHARE) * value}))


def _on_hardware(gait: Gait, folder: Path) -> object:
    robot = gait.system.robot
    return find_gait(with_hardware(gait.system, Rig().on(robot)), guess=gait.state)


CAPABILITIES: Mapping[str, Callable[[Gait, Path], object]] = {
    "simulate": lambda gait, folder: simulate(gait.system, gait.state, 1, progress=False),
    f"batch of {LANES}": _lanes,
    "find": lambda gait, folder: find_gait(gait.system, guess=gait.state),
    "multipliers": lambda gait, folder: multipliers(gait.system, gait.state),
    "sensitivity": lambda gait, folder: gait.sensitivity([varied(gait)[0]]),
    "uncertainty": _uncertain,
    "family": _followed,
    "design": _designed,
    "sweep": _swept,
    "feedback": _fed_back,
    "save and load": _kept,
    "export": _exported,
    "explore": _explored,
    "hardware": _on_hardware,
}


def measured(name: str, limit: int) -> dict[str, float | str]:
    """Return the seconds of each call with a gait, or the line with which it is refused."""

    def late(*_: object) -> None:
        raise TimeoutError(f"takes longer than {limit} s")

    signal.signal(signal.SIGALRM, late)
    found: dict[str, float | str] = {}
    gait = GAITS[name]()
    for capability, call in CAPABILITIES.items():
        with tempfile.TemporaryDirectory() as folder:
            begun = time.process_time()
            signal.alarm(limit)
            try:
                call(gait, Path(folder))
                found[capability] = time.process_time() - begun
            except (SpearError, TimeoutError) as error:
                found[capability] = " ".join(str(error).replace(f"{folder}/", "").split())
            except Exception as error:  # a fault, which the table shows as such
                found[capability] = f"FAULT: {type(error).__name__}: {error}"
            finally:
                signal.alarm(0)
        print(f"{name}: {capability}: {found[capability]}", file=sys.stderr, flush=True)
    return found


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--limit", type=int, default=120, metavar="S", help="longest time of a call (default: 120 s)")
    parser.add_argument("--row", choices=GAITS, help="measure this row alone, and print it as JSON")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    if asked.row:
        print(json.dumps(measured(asked.row, asked.limit)))
        return
    rows, refusals = [], dict[str, list[str]]()
    for name in GAITS:
        command = [sys.executable, "-m", "benchmarks.matrix", "--row", name, "--limit", str(asked.limit)]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        cells = [name]
        for capability, said in found.items():
            if isinstance(said, str):
                refusals.setdefault(said, []).append(f"{name}: {capability}")
                cells.append(f"[{[*refusals].index(said) + 1}]")
            else:
                cells.append(f"{said:.2g}")
        rows.append(cells)
    table(["processor time, s", *CAPABILITIES], rows)
    table(
        ["", "refusal", "of"],
        ([f"[{i}]", said.replace("|", "\\|"), "; ".join(where)] for i, (said, where) in enumerate(refusals.items(), 1)),
    )


if __name__ == "__main__":
    main()
