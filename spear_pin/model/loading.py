"""Loads a `Robot` from a name, a file or a model of Pinocchio, with the wanted base, motors and locked joints."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Literal, NamedTuple

import pinocchio as pin

from spear_pin.errors import BadFile, BadValue, RobotWarning, SpearError, UnknownName, list_names
from spear_pin.kinds import typed
from spear_pin.model.chain import BASES, ONE_OF, on_chain
from spear_pin.model.draft import Draft, of_mjcf, of_model, of_urdf
from spear_pin.model.elements import parse
from spear_pin.model.equipping import check_equipment
from spear_pin.model.examples import PACKAGE, example_robots, find_beginning_with
from spear_pin.model.fitting import check_floating, drivable, hold, with_inertia, with_motors
from spear_pin.model.gears import set_gears
from spear_pin.model.limits import order_limits
from spear_pin.model.loop_data import check_loops
from spear_pin.model.mjcf_reading import mjcf_of
from spear_pin.model.robot import Robot
from spear_pin.model.sidecar import NAMING, SUFFIX, Sidecar, blame_file, read
from spear_pin.model.urdf import Base, urdf_of


@dataclass(frozen=True)
class Shipped:
    """A robot that comes with the package.

    Attributes:
        file: its URDF in `spear_pin.urdf`; the same folder may have a TOML file.
        toes: frame names of its toes.
        summary: one line about the robot.
        provenance: source of its numbers.
    """

    file: str
    toes: tuple[str, ...]
    summary: str
    provenance: str

    @property
    def path(self) -> Path:
        """Path of the URDF on this machine."""
        return Path(str(files("spear_pin.urdf").joinpath(self.file)))


ROBOTS = {
    "spear_ii": Shipped(
        "spear_ii.urdf",
        ("toe",),
        "monopod SPEAR-II on its slider boom",
        "source Tables 2.4, 5.1 and Section 5.3",
    ),
    "spear_ii_series": Shipped(
        "spear_ii_series.urdf",
        ("toe",),
        "monopod SPEAR-II with its spring in series, the rotor a joint of its own",
        "numbers as spear_ii; the arrangement is for comparison, not the source's",
    ),
    "q_spear": Shipped(
        "q_spear.urdf",
        ("posterior_toe", "anterior_toe"),
        "quadruped Q-SPEAR in the sagittal plane, each leg a pair",
        "source Table 5.1; distance between the hips is an assumption",
    ),
    "q_spear_full": Shipped(
        "q_spear_full.urdf",
        ("posterior_left_toe", "posterior_right_toe", "anterior_left_toe", "anterior_right_toe"),
        "quadruped Q-SPEAR in three dimensions, four legs with hip adduction on a floating torso",
        "source Table 5.1; places of the hips and their adduction joints are assumptions",
    ),
    "biped": Shipped(
        "biped.urdf",
        ("left_toe", "right_toe"),
        "biped of two SPEAR-II legs in the sagittal plane",
        "legs as spear_ii; the source suggests it (Section 6.2.4), the torso is an assumption",
    ),
    "hoppy": Shipped(
        "hoppy.urdf",
        ("toe",),
        "HOPPY, a leg on a boom that turns and tilts about a post, with its knee spring and motors",
        "arXiv 2010.14580 and its simulator; limits and shapes are assumptions",
    ),
    "hoppy_leg": Shipped(
        "hoppy_leg.urdf",
        ("toe",),
        "HOPPY's leg on a slider in the place of its boom, with its knee spring and motors",
        "arXiv 2010.14580 and its simulator; the slider is an assumption",
    ),
    "mups_v2": Shipped(
        "mups_v2.urdf",
        ("toe",),
        "monoped MUPS v2 in the sagittal plane, with its knee spring and motors",
        "arXiv 2606.21866 and its repository; that its round foot is fixed is an assumption",
    ),
    "crank_hopper": Shipped(
        "crank_hopper.urdf",
        ("toe",),
        "vertical hopper whose motor drives its foot by a crank and a rod, with a spring along the leg",
        "arXiv 2505.22898, and a fit to its public logs; the foot's mass is an assumption",
    ),
    "minitaur_leg": Shipped(
        "minitaur_leg.urdf",
        ("toe",),
        "one leg of Minitaur, a five-bar with two motors, on a slider with a quarter of the chassis",
        "measured model of Minitaur that PyBullet ships; the slider, the spring and no friction are assumptions",
    ),
}


@typed
def load(
    source: str | Path | pin.Model,
    toes: Iterable[str] | None = None,
    locked: Iterable[str] | None = None,
    *,
    base: Base | Literal["chain"] | None = None,
    motors: str | Iterable[str] | None = None,
    repair: bool = False,
) -> Robot:
    """Loads a shipped robot, any URDF or MJCF file, or a model built by Pinocchio.

    A `RobotWarning` lists, a line each, what is left out of a file, what is repaired, and what may be a mistake. A TOML
    file of the same stem in the robot's folder adds data that the robot's file cannot hold, see
    `spear_pin.model.sidecar`; arguments override it.

    Args:
        source: a name in `ROBOTS`, or of a robot of example-robot-data if that is installed, which may be cut at an
            underscore if it stays unique ("anymal_b"); the path of a URDF or an MJCF file (anything else with a suffix
            or a separator), or of a TOML file that names one of these; or a `pin.Model`, which is copied.
        toes: frame names of the points that may touch the ground; shipped robots have default toes.
        locked: names of joints to hold at zero, for instance `["boom_x"]`.
        base: "free" puts a floating joint under the root link, unless there is one; "chain" puts six joints in its
            place, as simulation in space needs, see `spear_pin.to_chain`; "fixed" holds the root. By default the base
            is that of the file, with a warning if a root link with inertia stays fixed.
        motors: "all" for one on each joint that turns or slides, or names of joints. By default the motors are those of
            the file's `<transmission>`s, `<ros2_control>` or actuators, with a warning if there are none.
        repair: whether to repair inertias that no body can have, and joints that move no inertia, with a warning.

    Raises:
        UnknownName: unknown robot, toe frame or joint; the text lists the valid ones.
        BadFile: the file is missing or invalid (see `read_urdf`), a joint moves no inertia, or a root that shall float
            has none.
        BadValue: an invalid base, or a motor for a joint of several degrees of freedom.

    Example:
        >>> from spear_pin import load
        >>> load("spear_ii", locked=["boom_x"])
        Robot('spear_ii', nq=3, nv=3, nu=2, toes=['toe'], locked=['boom_x'])
    """
    if base not in (None, *BASES):
        raise BadValue("base", base, ONE_OF)
    said = sidecar_of(source)
    wanted_base = said.base if base is None else base
    draft = _draft(said.source, "free" if wanted_base == "chain" else wanted_base, repair)
    asked = _Asked(
        None if said.source is source else str(source),
        None if toes is None else _names(toes),
        None if locked is None else _names(locked),
        base,
        "all" if motors == "all" else None if motors is None else _names(motors),
        repair,
    )
    robot, notes = _looped(draft, said, asked)
    for note in notes:
        warnings.warn(RobotWarning(f"{draft.name}: {note}"), stacklevel=3)
    return robot


class _Asked(NamedTuple):
    """Arguments of `load`, and the path of a TOML file that is its source."""

    file: str | None
    toes: tuple[str, ...] | None
    locked: tuple[str, ...] | None
    base: str | None
    motors: str | tuple[str, ...] | None
    repair: bool


def _looped(draft: Draft, said: Sidecar, asked: _Asked) -> tuple[Robot, list[str]]:
    """Makes a robot with the loops of its own file if it can have them, else without; returns it, and warnings."""
    if not draft.loops:
        return _made(draft, said, asked)
    whole = replace(said, loops={**draft.loops, **said.loops})
    try:
        return _made(replace(draft, model=draft.model.copy()), whole, asked)
    except SpearError as error:
        if said.loops or said.independent or said.reach:  # the TOML file counts on them
            raise
        reason = error.problem if isinstance(error, BadFile) else str(error)
    robot, notes = _made(draft, said, asked)
    lost = [f"<{'joint' if 'joints' in table else 'connect'}> {name!r}" for name, table in draft.loops.items()]
    return robot, [*notes, f"not taken over: {list_names(lost)} in <equality>: {reason}"]


def _made(draft: Draft, said: Sidecar, asked: _Asked) -> tuple[Robot, list[str]]:
    """Makes a robot from what its files and the arguments of `load` say; returns it, and warnings."""
    wanted_base = said.base if asked.base is None else asked.base
    shipped = ROBOTS[str(said.source)].toes if str(said.source) in ROBOTS else ()
    own_toes = shipped if said.own_toes is None else _names(said.own_toes)
    notes = [*draft.notes, *order_limits(draft.model)]
    settings, driven, gears = check_equipment(said, draft.model, draft.gears, draft.name, own_toes)
    notes += set_gears(draft.model, gears)
    locked = _names(said.locked or ()) if asked.locked is None else asked.locked
    model = hold(draft.model, locked)
    if wanted_base in ("free", "chain"):
        check_floating(draft.place, model)
    model, mended = with_inertia(draft.place, model, asked.repair)
    wanted = driven if asked.motors is None else asked.motors
    model, actuated = with_motors(model, draft.motors if wanted is None else wanted, locked)
    notes += mended
    if wanted is None and not draft.motors and drivable(model):
        notes.append('no joint has a motor: motors="all" gives one to each, motors=[...] to those that it names')
    model = on_chain(model) if wanted_base == "chain" else model  # the chain's joints have no motors
    robot = Robot(
        model,
        name=draft.name,
        toes=own_toes if asked.toes is None else asked.toes,
        actuated=actuated,
        locked=locked,
        source=draft.source if asked.file is None else asked.file,
        options={
            name: value
            for name, value in (("base", asked.base), ("motors", asked.motors), ("repair", asked.repair or None))
            if value is not None
        },
        settings=settings,
    )
    if robot.closure is not None and not settings.independent:  # whatever motors are asked for
        known = draft.motors if driven is None else () if driven == "all" else driven
        known = known if {*known} & {*robot.closure.tied} or asked.motors in (None, "all") else asked.motors
        own = tuple(name for name in robot.closure.tied if name in known)
        robot = robot.with_model(model, settings=replace(settings, independent=own))
    with blame_file(said.path, "loops"):
        check_loops(robot)
    return robot, notes


def sidecar_of(source: str | Path | pin.Model) -> Sidecar:
    """Returns the contents of a robot's TOML file, which is its source or lies in the folder of its source.

    Raises:
        BadFile: the file is not valid, or is of another robot; or it has to name its robot, and does not.
    """
    if not isinstance(source, (str, Path)):
        return Sidecar(source)
    if Path(source).suffix == SUFFIX:
        said = read(Path(source))
        if said.source is None:
            raise BadFile(source, f"names no robot; expected one key of {', '.join(NAMING)}")
        return said
    path = path_of(source)
    beside = path.with_suffix(SUFFIX) if path.suffix else path
    if beside == path or not beside.is_file():
        return Sidecar(source)
    said = read(beside)
    if said.source is not None and path_of(said.source).resolve() != path.resolve():
        raise BadFile(beside, f"names {said.source!r}; expected {path.name!r}, the file next to it, or no robot")
    return replace(said, source=source)


def path_of(source: str | Path) -> Path:
    """Returns the path of the file from which a robot is loaded.

    Args:
        source: a name, see `load`, or a path. For a TOML file the result is the file that it names.

    Raises:
        UnknownName: the source is neither a name nor a path, as it has no suffix or separator.
        BadFile: a TOML file is not valid.
    """
    if Path(source).suffix == SUFFIX:
        source = sidecar_of(source).source
    name = full_name(source)
    return ROBOTS[name].path if name in ROBOTS else example_robots().get(name, Path(source))


def full_name(source: str | Path) -> str:
    """Completes a robot's name that is cut at an underscore; returns a path as it is.

    Raises:
        UnknownName: the source is no path, and no name or not a unique one.
    """
    name = str(source)
    if name in ROBOTS or name in (examples := example_robots()) or {"/", "\\", "."} & set(name):
        return name
    meant = find_beginning_with(name)
    if len(meant) == 1:
        return meant[0]
    extra = "" if examples or meant else f", or with the extra 'robots' one of {PACKAGE}"
    raise UnknownName("robot", name, meant or [*ROBOTS, *examples], f"the path of a URDF or an MJCF file{extra}")


def _names(names: Iterable[str]) -> tuple[str, ...]:
    """Returns names in order, each once; one string is one name."""
    return tuple(dict.fromkeys([names] if isinstance(names, str) else names))


def _draft(source: str | Path | pin.Model, base: Base | None, repair: bool) -> Draft:
    if isinstance(source, pin.Model):
        return of_model(source, base)
    if not isinstance(source, (str, Path)):
        raise BadValue("source", source, "the name of a robot, the path of a file, or a pinocchio.Model")
    source = full_name(source)
    path, root = parse(path_of(source))
    mujoco = root.tag == "mujoco"
    draft = (
        of_mjcf(mjcf_of(path, root, base, repair), base) if mujoco else of_urdf(urdf_of(path, root, base, repair), base)
    )
    return replace(draft, source=source, name=draft.name if path == Path(source) else source)
