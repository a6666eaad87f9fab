"""From a name, a file or a model of Pinocchio to a `Robot`: base, motors and locked joints as asked for."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path

import pinocchio as pin

from spear_pin.errors import BadValue, RobotWarning, UnknownName
from spear_pin.kinds import typed
from spear_pin.model.draft import Draft, of_mjcf, of_model, of_urdf
from spear_pin.model.elements import parse
from spear_pin.model.examples import PACKAGE, example_robots
from spear_pin.model.fitting import check_floating, drivable, with_inertia, with_motors
from spear_pin.model.mjcf_reading import mjcf_of
from spear_pin.model.robot import Robot
from spear_pin.model.urdf import Base, urdf_of


@dataclass(frozen=True)
class Shipped:
    """A robot that comes with the package.

    Attributes:
        file: its URDF in `spear_pin.urdf`.
        toes: frame names of its toes.
        summary: one line about it.
        provenance: where its numbers come from.
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
}


@typed
def load(
    source: str | Path | pin.Model,
    toes: Iterable[str] | None = None,
    locked: Iterable[str] = (),
    *,
    base: Base | None = None,
    motors: str | Iterable[str] | None = None,
    repair: bool = False,
) -> Robot:
    """Load a shipped robot, any URDF or MJCF file, or what Pinocchio has built.

    What is left out of a file, or mended, and what may not be meant, is said by a `RobotWarning`, a line each.

    Args:
        source: a name in `ROBOTS`, or of a robot of example-robot-data if that is installed; the path of a URDF
            or an MJCF file (anything else with a suffix or a separator); or a `pin.Model`, which is copied.
        toes: frame names of the points that may touch the ground; shipped robots know theirs.
        locked: names of joints to hold at zero, for instance `["boom_x"]`.
        base: "free" puts a floating joint under the root link, unless it has one; "fixed" holds the root. By default
            it is as the file has it, with a warning where a root link with inertia stays fixed.
        motors: "all" for one on each joint that turns or slides, or names of joints. By default those of the file's
            `<transmission>`s, `<ros2_control>` or actuators, with a warning where there are none.
        repair: mend inertias that no body can have, and joints that move no inertia, with a warning.

    Raises:
        UnknownName: unknown robot, toe frame or joint; the text lists the valid ones.
        BadFile: the file is missing or invalid (see `read_urdf`), a joint moves no inertia, or a root that is to float
            has none.
        BadValue: another base, or a motor for a joint of several degrees of freedom.
    """
    if base not in (None, "free", "fixed"):
        raise BadValue("base", base, "'free' or 'fixed'")
    draft = _draft(source, base, repair)
    locked = _names(locked)
    wanted = "all" if motors == "all" else None if motors is None else _names(motors)
    held = hold(draft.model, locked)
    if base == "free":
        check_floating(draft.place, held)
    model, mended = with_inertia(draft.place, held, repair)
    model, actuated = with_motors(model, draft.motors if wanted is None else wanted, locked)
    shipped = ROBOTS.get(str(source))
    notes = [*draft.notes, *mended]
    if wanted is None and not draft.motors and drivable(model):
        notes.append('no joint has a motor: motors="all" gives one to each, motors=[...] to those that it names')
    for note in notes:
        warnings.warn(RobotWarning(f"{draft.name}: {note}"), stacklevel=3)
    return Robot(
        model,
        name=draft.name,
        toes=_names(toes) if toes is not None else shipped.toes if shipped else (),
        actuated=actuated,
        locked=locked,
        source=draft.source,
        options={
            name: value
            for name, value in (("base", base), ("motors", wanted), ("repair", repair or None))
            if value is not None
        },
    )


def path_of(source: str | Path) -> Path:
    """Path of the file that a robot is loaded from.

    Args:
        source: a name in `ROBOTS`, or of a robot of example-robot-data if that is installed; or a path.

    Raises:
        UnknownName: it is no such name, nor a path: it has no suffix or separator.
    """
    if str(source) in ROBOTS:
        return ROBOTS[str(source)].path
    examples = example_robots()
    if str(source) in examples:
        return examples[str(source)]
    if not ({"/", "\\", "."} & set(str(source))):
        others = examples or [f"with the extra 'robots' those of {PACKAGE}"]
        raise UnknownName("robot", str(source), [*ROBOTS, *others, "the path of a URDF or an MJCF file"])
    return Path(source)


def hold(model: pin.Model, joints: Sequence[str]) -> pin.Model:
    """A model with some joints held at zero.

    Raises:
        UnknownName: there is no such joint; the text lists the valid ones.
    """
    names = list(model.names)[1:]
    for joint in joints:
        if joint not in names:
            raise UnknownName("joint", joint, names)
    ids = [model.getJointId(joint) for joint in joints]
    return pin.buildReducedModel(model, ids, pin.neutral(model)) if ids else model


def _names(names: Iterable[str]) -> tuple[str, ...]:
    """Names in order, each once; one string is one name."""
    return tuple(dict.fromkeys([names] if isinstance(names, str) else names))


def _draft(source: str | Path | pin.Model, base: Base | None, repair: bool) -> Draft:
    if isinstance(source, pin.Model):
        return of_model(source, base)
    if not isinstance(source, (str, Path)):
        raise BadValue("source", source, "the name of a robot, the path of a file, or a pinocchio.Model")
    path, root = parse(path_of(source))
    mujoco = root.tag == "mujoco"
    draft = (
        of_mjcf(mjcf_of(path, root, base, repair), base) if mujoco else of_urdf(urdf_of(path, root, base, repair), base)
    )
    return replace(draft, source=str(source), name=draft.name if path == Path(source) else str(source))
