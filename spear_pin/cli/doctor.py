"""`spear doctor`."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import Any

from spear_pin.cli.arguments import Commands, add_command
from spear_pin.cli.gaits import BOUND, bounding_gait
from spear_pin.cli.output import join_lines
from spear_pin.errors import BadValue

# as the project's metadata have them
REQUIRED = (
    *("pin", "yourdfpy", "trimesh", "numpy", "scipy", "lazy_loader", "meshcat", "lxml", "matplotlib", "pandas"),
    *("tqdm", "u-msgpack-python", "jinja2", "markupsafe"),
)
OPTIONAL = (
    *("casadi", "heyoka", "joblib", "xarray", "zarr", "dask", "drake", "mujoco", "example-robot-data"),
    *("mcap", "mcap-protobuf-support", "foxglove-schemas-protobuf", "shtab"),
)


def add(commands: Commands) -> None:
    """Declare the command."""
    example = ("spear doctor", "list packages and programs, and try a hop and a bound")
    add_command(commands, "doctor", run, "check the installation", example)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Look for the packages and programs, and try what they are needed for."""
    import importlib.metadata as metadata
    import platform
    import shutil

    def version(name: str) -> str | None:
        try:
            return metadata.version(name)
        except metadata.PackageNotFoundError:
            return None

    installed = {name: version(name) for name in (*REQUIRED, *OPTIONAL)}
    programs = {name: shutil.which(name) for name in ("chromium", "google-chrome", "ffmpeg")}
    checks = {name: _works(check) for name, check in CHECKS.items()}
    failed = any(installed[name] is None for name in REQUIRED) or any(value != "ok" for value in checks.values())
    lines = [f"python {platform.python_version()} on {platform.system()} {platform.machine()}"]
    wide = max(map(len, (*installed, *programs)))
    lines += [f"  {name:<{wide}}  {installed[name] or 'MISSING'}" for name in REQUIRED]
    lines += [f"  {name:<{wide}}  {installed[name] or 'not installed (optional)'}" for name in OPTIONAL]
    lines += [f"  {name:<{wide}}  {'found' if path else 'not found (optional)'}" for name, path in programs.items()]
    lines += [f"  {name}: {result}" for name, result in checks.items()]
    return {
        "python_version": platform.python_version(),
        "packages": installed,
        "programs": {name: path is not None for name, path in programs.items()},
        "checks": checks,
        "failed": failed,
        "text": join_lines(lines),
    }


def _check_dynamics() -> None:
    from spear_pin import load

    robot = load("spear_ii")
    if abs(robot.mass_matrix([0.0, 0.5, 0.5, 1.0])[2, 2] - 0.1471) > 1e-4:
        raise BadValue("D[2, 2] of spear_ii", robot.mass_matrix([0.0, 0.5, 0.5, 1.0])[2, 2], "0.1471 kg·m²")


def _check_hop() -> None:
    from spear_pin import hopping, load, simulate

    system = hopping(load("spear_ii", locked=["boom_x"]))
    trajectory = simulate(system, system.guess(), cycles=1, rtol=1e-8)
    if not trajectory.complete or abs(trajectory.ledger.residual).max() > 1e-6:
        raise BadValue("one hop", trajectory.reason, "complete, with its energy ledger closed")


def _check_bound() -> None:
    from spear_pin import simulate

    _, gait = bounding_gait(BOUND, None)
    trajectory = simulate(gait.system, gait.state, cycles=1, rtol=1e-8)
    left = abs(trajectory.q[-1, 1:] - gait.state[0][1:]).max() if trajectory.complete else math.inf
    if left > 1e-5 or abs(trajectory.ledger.residual).max() > 1e-5:
        raise BadValue(
            "one stride", f"{trajectory.reason}, open by {left:.1e}", "a closed stride, with its energy ledger closed"
        )


CHECKS = {"dynamics of spear_ii": _check_dynamics, "one hop": _check_hop, "one stride": _check_bound}


def _works(check: Callable[[], None]) -> str:
    try:
        check()
    except Exception as error:  # a broken installation may fail in any way, and saying so is the point
        return f"FAILED: {type(error).__name__}: {error}"
    return "ok"
