"""`spear export`."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import ROBOT as ROBOT_HELP
from spear_pin.cli.arguments import (
    Commands,
    add_command,
    add_loading,
    add_open,
    add_out,
    check_out,
    folder,
    gather_loading,
)
from spear_pin.cli.gaits import BOUND
from spear_pin.cli.given import given, refuse
from spear_pin.cli.legs import add_cut, load_or_cut
from spear_pin.cli.output import align_lines
from spear_pin.errors import BadFile, BadValue, SpearError

if TYPE_CHECKING:
    from spear_pin.hybrid.trajectory import Trajectory
    from spear_pin.model.robot import Robot
    from spear_pin.model.spring import Spring

ROBOT = {"mjcf": "xml", "srdf": "srdf"}  # formats of a robot, and how their files end
URDF = (".urdf", ".xml", ".toml")  # how its files mostly end
GAIT = ".json"
LOADED = ("lock", "toes", "base", "motors", "repair", "leg", "plane", "bends", "body")  # options of a robot's file
TRAJECTORY = {name: name for name in ("csv", "mat", "mcap", "png", "mp4")}
# what each option goes with
NEEDS = {
    **dict.fromkeys(LOADED, ROBOT),
    "robot": ("mcap", "png", "mp4"),
    "size": ("png", "mp4"),
    "time": ("png",),
    "open": ("png", "mp4"),
    "fps": ("mp4",),
    "speed": ("mp4",),
    "rows": ("table",),
}


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear export hop.npz --mp4 --speed 0.25", "write a film of a saved motion in slow motion")
    summary = "write a motion as film or table, a robot as MJCF, or a law in C"
    parser = add_command(commands, "export", run, summary, example)
    parser.add_argument(
        "what", metavar="WHAT", help="a robot by name or path, or a saved gait (.json) or motion (.npz)"
    )
    robot = parser.add_argument_group("robot")
    robot.add_argument(
        "--mjcf", action="store_true", help="write MuJoCo's format, with rotors, motors, toes and ground"
    )
    robot.add_argument("--srdf", action="store_true", help="write legs, postures and rotors, to go with the URDF")
    add_loading(robot)
    add_cut(parser)
    gait = parser.add_argument_group("gait")
    gait.add_argument("--c", type=folder, metavar="DIR", help="write the law as a C99 controller into this folder")
    gait.add_argument(
        "--table", type=Path, metavar="FILE", help="write a cycle for tracking: a table as .csv, .npz or .mcap"
    )
    gait.add_argument("--rows", type=float, metavar="HZ", help="rows of the table in a second (default: 1000)")
    motion = parser.add_argument_group("motion")
    motion.add_argument("--csv", action="store_true", help="write its samples as a table")
    motion.add_argument("--mat", action="store_true", help="write samples, events and energies for MATLAB")
    motion.add_argument("--mcap", action="store_true", help="write a log with robot, forces and events for Foxglove")
    motion.add_argument("--png", action="store_true", help="write a picture; needs Chromium")
    motion.add_argument("--mp4", action="store_true", help="write a film; needs Chromium and ffmpeg")
    motion.add_argument("--time", type=float, metavar="S", help="time of the picture (default: the start)")
    motion.add_argument("--size", metavar="WxH", help="size of picture and film, in pixels (default: 1280x720)")
    motion.add_argument("--fps", type=float, metavar="HZ", help="frames per second of the film (default: 30)")
    motion.add_argument(
        "--speed", type=float, metavar="FACTOR", help="speed of the film: 0.25 is four times slower (default: 1)"
    )
    motion.add_argument("--robot", metavar="ROBOT", help=f"{ROBOT_HELP}; needed where the motion's own is not found")
    add_out(parser, "the files")
    add_open(parser, "the film or the picture")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Write the files."""
    check_out(arguments)
    if arguments.c is not None or arguments.table is not None:
        return _gait(arguments)
    moves = Path(arguments.what).suffix == ".npz"
    fitting, other = (TRAJECTORY, ROBOT) if moves else (ROBOT, TRAJECTORY)
    asked = [name for name in (*ROBOT, *TRAJECTORY) if getattr(arguments, name)]
    kind, valid = "trajectory" if moves else "robot", ", ".join(f"--{name}" for name in fitting)
    misfit = not asked or set(asked) & set(other)
    if misfit and Path(arguments.what).suffix not in ("", ".npz", GAIT, *URDF):
        raise BadFile(arguments.what, "is neither a robot nor a saved trajectory (.npz); give one of them")
    if not asked:
        raise SpearError(f"{arguments.what} is a {kind}; choose what to write: {valid}")
    if misfit:
        raise BadValue("format", ", ".join(f"--{name}" for name in asked), f"a format for a {kind}: {valid}")
    _check_options(arguments, asked)
    name = Path(arguments.what).stem if {"/", "\\", "."} & set(arguments.what) else arguments.what
    part = f"_{arguments.leg}" if arguments.leg else "_plane" if arguments.plane else ""
    paths = {form: arguments.out / f"{name}{part}.{fitting[form]}" for form in asked}
    result = _trajectory(arguments, paths) if moves else _robot(arguments, paths)
    files = [str(path) for path in paths.values()]
    rows = [*result.pop("rows"), ("files", ", ".join(files))]
    return result | {"files": files, "opened": paths.get("mp4", paths.get("png")), "text": align_lines(rows)}


def _check_options(arguments: argparse.Namespace, asked: Sequence[str]) -> None:
    """Refuse an option that goes with other formats than those asked for."""
    for option, formats in NEEDS.items():
        if not set(asked) & set(formats):
            refuse(arguments, f"only with {' or '.join(f'--{name}' for name in formats)}", option)


def _gait(arguments: argparse.Namespace) -> dict[str, Any]:
    """Write the law of a saved gait, or what it asks of the motors."""
    from spear_pin.gaits.gait import Gait
    from spear_pin.viz.controller.tracking import RATE, write_table
    from spear_pin.viz.controller.writing import write_controller

    asked = given(arguments, "c", "table")
    if Path(arguments.what).suffix != GAIT:
        option, value = next(iter(asked.items()))
        raise BadValue(f"--{option}", str(value), f"only with a saved gait ({GAIT}), not with {arguments.what}")
    if others := [f"--{name}" for name in (*ROBOT, *TRAJECTORY) if getattr(arguments, name)]:
        raise BadValue("format", ", ".join(others), "--c and --table alone: other formats are of robots and motions")
    _check_options(arguments, list(asked))
    gait, files = Gait.load(arguments.what), list[str]()
    rows = [("gait", f"{gait.system.kind} of {gait.system.robot.name}")]
    if arguments.table is not None:
        rate = RATE if arguments.rows is None else arguments.rows
        files.append(str(write_table(gait, arguments.table, rate)))
    if arguments.c is not None:
        files += map(str, write_controller(gait, arguments.c))
        rows.append(("try it", f"cd {arguments.c} && gcc -O2 controller.c test.c -o test -lm && ./test"))
    text = align_lines([*rows, ("files", ", ".join(files))])
    return {"robot": gait.system.robot.name, "files": files, "text": text}


def _robot(arguments: argparse.Namespace, paths: Mapping[str, Path]) -> dict[str, Any]:
    from spear_pin.files import write_text
    from spear_pin.model.mjcf import to_mjcf
    from spear_pin.model.mjcf_loops import list_left_out_loops as loops_left_out
    from spear_pin.model.mjcf_springs import list_left_out_springs
    from spear_pin.model.srdf import to_srdf

    robot, springs = _whose(arguments)
    postures = _postures(robot)
    writers: dict[str, Callable[..., str]] = {"mjcf": partial(to_mjcf, springs=springs), "srdf": to_srdf}
    texts = {path: writers[form](robot, postures) for form, path in paths.items()}  # what cannot be said is refused
    names = ["home", *postures]
    rows = [("robot", f"{robot.name}, {robot.mass:.4g} kg"), ("postures", ", ".join(names))]
    meshes: list[str] = []
    if "mjcf" in paths and robot.cut is None:
        from spear_pin.viz.mesh_files import write_meshes

        path = paths["mjcf"]
        written, notes = write_meshes(robot, path.with_name(f"{path.stem}_meshes"))
        texts[path] = to_mjcf(robot, postures, written, springs)
        if not robot.toes:
            rows.append(("toes", "none: --toes names frames that meet the ground; the trunk does, legs do not"))
        meshes = [str(path.parent / mesh.file) for mesh in written]
        if meshes:
            rows.append(("meshes", f"{len(meshes)}, in {path.with_name(f'{path.stem}_meshes')}"))
        rows += [("shapes", note) for note in notes]
    missing = [*list_left_out_springs(robot, springs), *loops_left_out(robot)] if "mjcf" in paths else []
    rows += [("left out", line) for line in missing]
    for path, text in texts.items():
        write_text(path, text)
    found = {"robot": robot.name, "mass": robot.mass, "postures": names, "meshes": meshes, "left_out": missing}
    return found | {"rows": rows}


def _whose(arguments: argparse.Namespace) -> tuple[Robot, dict[str, Spring]]:
    """The robot of a name, of a file or of a saved gait, or the part of it that is asked for, and its springs."""
    if Path(arguments.what).suffix != GAIT:
        from spear_pin.model.mjcf_springs import springs_of

        robot = load_or_cut(arguments.what, arguments, gather_loading(arguments))
        return robot, springs_of(robot)
    from spear_pin.gaits.gait import Gait

    refuse(arguments, "only with a robot: a saved gait already has these options", *LOADED)
    system = Gait.load(arguments.what).system
    mounts = [mount for domain in system.domains for mount in domain.mounts if mount.spring.pulls]
    return system.robot, {mount.name: replace(mount.spring, path=mount.along) for mount in mounts}


def _postures(robot: Robot) -> dict[str, Any]:
    """Where the gaits of this package, which are not the source's, touch down."""
    import numpy as np

    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.hopping import HoppingLaw
    from spear_pin.model.postures import put_on_ground

    if robot.source in ("spear_ii", "spear_ii_series"):
        knee = HoppingLaw().knee_touchdown
        angles = {"hip": 0.5 * knee, "knee": knee}
    elif robot.source == "q_spear":
        gait = Gait.load(BOUND)
        angles = dict(zip(gait.system.robot.coordinates, gait.state[0], strict=True))
    else:
        return {}
    q = np.array([angles.get(coordinate, 0.0) for coordinate in robot.coordinates])
    return {"touchdown": put_on_ground(robot, q)}


def _trajectory(arguments: argparse.Namespace, paths: Mapping[str, Path]) -> dict[str, Any]:
    from tqdm import tqdm

    from spear_pin.hybrid.trajectory import Trajectory
    from spear_pin.viz import video

    trajectory = Trajectory.load(arguments.what)
    size = video.SIZE if arguments.size is None else _size(arguments.size)
    for form in ("csv", "mat"):
        if form in paths:
            trajectory.export(paths[form])
    if "mcap" in paths:
        from spear_pin.viz.mcap_log import write_mcap

        write_mcap(_moving(arguments, trajectory), trajectory, paths["mcap"])
    if "png" in paths:
        time = float(trajectory.t[0]) if arguments.time is None else arguments.time
        video.still(_moving(arguments, trajectory), trajectory, paths["png"], time=time, size=size)
    if "mp4" in paths:
        with tqdm(unit="frame", disable=None, leave=False) as bar:

            def tell(done: int, total: int) -> None:
                bar.total = total
                bar.update(done - bar.n)

            robot = _moving(arguments, trajectory)
            video.film(robot, trajectory, paths["mp4"], size=size, on_frame=tell, **given(arguments, "fps", "speed"))
    begin, end = float(trajectory.t[0]), float(trajectory.t[-1])
    rows = [("robot", trajectory.robot), ("samples", f"{len(trajectory.t)}, from {begin:.4g} to {end:.4g} s")]
    return {"robot": trajectory.robot, "samples": len(trajectory.t), "begin": begin, "end": end, "rows": rows}


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text.strip(), re.ASCII)
    if found is None:
        raise BadValue("--size", text, "WIDTHxHEIGHT, in pixels, such as 1280x720")
    return int(found[1]), int(found[2])


def _moving(arguments: argparse.Namespace, trajectory: Trajectory) -> Robot:
    """The robot of a trajectory; joints that it does not have are locked in one that is given."""
    from spear_pin.model.mover import mover

    one = trajectory
    try:
        return mover(one.origin, one.robot, one.coordinates, one.toes, arguments.robot, "--robot")
    except (SpearError, ValueError) as error:
        if arguments.robot is not None:
            raise
        raise BadFile(arguments.what, f"its robot is not found: {error}; give it by --robot") from None
