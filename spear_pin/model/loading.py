"""From a name or a URDF to a `Robot`: the shipped robots, rotor inertias set, joints locked on request."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.kinds import typed
from spear_pin.model.memory import check_memory
from spear_pin.model.robot import Robot
from spear_pin.model.urdf import Urdf, read_urdf


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
def load(source: str | Path, toes: Iterable[str] | None = None, locked: Iterable[str] = ()) -> Robot:
    """Load a shipped robot or any URDF.

    Args:
        source: a name in `ROBOTS`, or the path of a URDF (anything with a suffix or a separator).
        toes: frame names of the points that may touch the ground; shipped robots know theirs.
        locked: names of joints to hold at zero, for instance `["boom_x"]`.

    Raises:
        UnknownName: unknown robot, toe frame or joint; the text lists the valid ones.
        BadFile: the URDF is missing or invalid (see `read_urdf`), or a joint moves no inertia.
    """
    if not isinstance(source, (str, Path)):
        raise BadValue("source", source, "the name of a robot, or the path of a URDF")
    shipped = ROBOTS.get(str(source))
    if shipped is None and not ({"/", "\\", "."} & set(str(source))):
        raise UnknownName("robot", str(source), [*ROBOTS, "the path of a URDF"])
    urdf = read_urdf(shipped.path if shipped else source)
    locked = _names(locked)
    model = hold(_model(urdf), locked)
    _check_inertia(urdf, model)
    driven = {transmission.joint for transmission in urdf.transmissions}
    return Robot(
        model,
        name=str(source) if shipped else urdf.name,
        toes=_names(toes) if toes is not None else shipped.toes if shipped else (),
        actuated=[name for name in list(model.names)[1:] if name in driven],
        locked=locked,
        source=str(source),
    )


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


def _model(urdf: Urdf) -> pin.Model:
    try:
        model = pin.buildModelFromXML(urdf.text)
    except (ValueError, RuntimeError) as error:
        raise BadFile(urdf.path, f"Pinocchio cannot build it: {str(error).strip().splitlines()[0]}") from None
    check_memory(urdf.path, model.njoints - 1, model.nv)
    # numbered to keep the order of the document, in which Pinocchio would sort by name
    for i, name in enumerate(model.names):
        model.names[i] = name.partition(":")[2] or name
    for frame in model.frames:
        if frame.type != pin.FrameType.BODY and frame.name != "universe":
            frame.name = frame.name.partition(":")[2]
    armature = np.zeros(model.nv)
    rotor_inertia, gear_ratio = np.zeros(model.nv), np.zeros(model.nv)
    for transmission in urdf.transmissions:
        joint = model.joints[model.getJointId(transmission.joint)]
        if joint.nv != 1:
            problem = f"a transmission drives {transmission.joint!r}, a joint of {joint.nv} degrees of freedom"
            raise BadFile(urdf.path, problem)
        armature[joint.idx_v] = transmission.reflected_inertia
        rotor_inertia[joint.idx_v] = transmission.rotor_inertia
        gear_ratio[joint.idx_v] = transmission.gear_ratio
    # only the armature enters the dynamics; the other two are kept for those who read them
    model.armature, model.rotorInertia, model.rotorGearRatio = armature, rotor_inertia, gear_ratio
    return model


def _check_inertia(urdf: Urdf, model: pin.Model) -> None:
    """A joint that moves no inertia makes D singular: say which one."""
    data = pin.Data(model)
    rng = np.random.default_rng(0)
    for _ in range(3):
        mass_matrix = pin.crba(model, data, pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv)))
        if not np.isfinite(mass_matrix).all():
            raise BadFile(urdf.path, "the mass matrix is not finite: some inertia is out of all proportion")
        diagonal = np.diag(mass_matrix)
        for joint in range(1, model.njoints):
            rows = slice(model.joints[joint].idx_v, model.joints[joint].idx_v + model.joints[joint].nv)
            if diagonal[rows].min() <= 0.0:
                problem = f"joint {model.names[joint]!r} moves no inertia: give its links an <inertial>"
                raise BadFile(urdf.path, problem)
        if model.nv and np.linalg.eigvalsh(mass_matrix / np.sqrt(np.outer(diagonal, diagonal)))[0] < 1e-12:
            raise BadFile(urdf.path, "the mass matrix is singular: some link lacks inertia")
