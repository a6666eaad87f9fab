"""The structure that is compiled into a domain, and the order of the numbers that it takes at run time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import count
from numbers import Real
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.brake import Brakes, brakes_with, numbers_of_brakes
from spear_pin.hybrid.domain import Domain, Mount
from spear_pin.hybrid.engines.identity import Reader
from spear_pin.hybrid.fields import FLOATS, field_names, flatten, is_number, with_fields
from spear_pin.hybrid.ground import PLACE, Ground
from spear_pin.hybrid.soundness import Latched
from spear_pin.hybrid.springs import find_shared, shares_path, spring_of, springs_with
from spear_pin.model.mechanism import Mechanism
from spear_pin.model.spring import UNITS as OF_SPRINGS
from spear_pin.model.spring import Spring
from spear_pin.model.springs import numbers_of_springs

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Scalars:
    """Numbers of a system, as scalars of any kind.

    Attributes:
        law: parameters of the control law.
        springs: the springs by name.
        ground: the ground.
        brakes: the brakes by name.
        joints: viscous friction of each joint, in N·s/m or N·m·s/rad.
    """

    law: Any
    springs: Mapping[str, Spring]
    ground: Ground
    joints: Sequence[Any]
    brakes: Brakes = field(default_factory=dict)


def others(system: HybridSystem) -> dict[str, float]:
    """Returns the scalars other than the law's that are run-time parameters, in their order."""
    return {name: value for name, value in all_others(system).items() if value != 0.0 or name == "friction"}


def all_others(system: HybridSystem) -> dict[str, float]:
    """Returns the scalars other than the law's, including zeros, in their order."""
    of_ground = {name: getattr(system.ground, name) for name in PLACE}
    parts = numbers_of_springs(system.springs), of_ground, numbers_of_brakes(system.brakes)
    return {"friction": system.ground.friction, **parts[0], **parts[1], **parts[2]}


def symbols(
    system: HybridSystem, mechanism: Mechanism, held: Values, par: Any
) -> tuple[Mechanism, Scalars, dict[str, Any]]:
    """Returns the robot, the system's numbers and the held values as run-time parameters par[0], par[1], ...

    Zeros of the robot, the springs and the ground stay zero; values that are no numbers stay unchanged.
    """
    index = count()

    def replaced(value: Any) -> Any:
        """Replaces numbers by the next parameters; values that are no numbers are structure."""
        if isinstance(value, tuple):
            return tuple(map(replaced, value))
        if (names := field_names(value)) is not None:
            return with_fields(value, {name: replaced(getattr(value, name)) for name in names})
        return par[next(index)] if is_number(value) else value

    law = replaced(system.law)
    beside = {name: replaced(value) for name, value in others(system).items()}
    springs, ground = springs_with(system.springs, beside), with_fields(system.ground, beside)
    moved = mechanism.with_numbers([replaced(number) if number != 0.0 else 0.0 for number in mechanism.numbers])
    joints = [replaced(float(b)) if b != 0.0 else 0.0 for b in system.robot.model.damping]
    kept = Latched({name: replaced(value) for name, value in held.items()})
    return moved, Scalars(law, springs, ground, joints, brakes_with(system.brakes, beside)), kept


def robot_numbers(system: HybridSystem, mechanism: Mechanism) -> list[float]:
    """Returns the scalars of the robot that are run-time parameters, in their order."""
    return [number for number in all_robot_numbers(system, mechanism) if number != 0.0]


def all_robot_numbers(system: HybridSystem, mechanism: Mechanism) -> list[float]:
    """Returns the scalars of the robot, including zeros, in their order."""
    return [*mechanism.numbers, *map(float, system.robot.model.damping)]


def parameters(law: Any, others: Sequence[Any], robot: Sequence[float], held: Values, n: int) -> Array:
    """Returns the run-time parameters of n lanes, (p, n), in the order of `symbols`.

    Args:
        law: parameters of the law, numbers or arrays of n.
        others: scalars other than the law's that are run-time parameters, see `others`; numbers or arrays of n.
        robot: scalars of the robot that are run-time parameters, see `robot_numbers`.
        held: held values, numbers or arrays of n.
        n: number of lanes.
    """
    flat = flatten((law, *others, *robot, *held.values()))
    rows = np.empty((len(flat), n))
    for i, value in enumerate(flat):
        rows[i] = value
    return rows


@dataclass(frozen=True, eq=False)
class Structure:
    """The structure that is compiled in: two systems of equal structure differ only in run-time parameters.

    Attributes:
        system: a system.
        domain: one of its domains.
        held: values held in the domain.
        mechanism: dynamics of the robot.
    """

    system: HybridSystem
    domain: Domain
    held: Values
    mechanism: Mechanism

    @cached_property
    def key(self) -> Any:
        """Everything that two systems of the same structure have in common."""
        system, domain = self.system, self.domain
        robot = self.mechanism.shape, system.robot.toes, system.robot.actuated
        mounts = domain.mounts if domain.between is None else (*domain.mounts, *domain.between.grounded.mounts)
        springs = tuple(_mounted(mount, system, self.mechanism) for mount in mounts)
        rubbing = tuple(b != 0.0 for b in system.robot.model.damping)
        kinds = tuple((spring.unilateral, spring.rest) for spring in system.springs.values())
        parts = kinds, tuple(others(system)), _shape(system.law), shape_of(self.held)
        ground, rubs = _shape_of_ground(system.ground), tuple((rub.joint, rub.sign, rub.path) for rub in domain.rubs)
        return system.kind, robot, springs, rubbing, parts, ground, domain.contacts, rubs, _identity(domain)

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Structure) and self.key == other.key


def _mounted(mount: Mount, system: HybridSystem, mechanism: Mechanism) -> Any:
    """Returns a spring's place, its held names, and those of its numbers that it does not share with the system."""
    own, common, path = mount.spring, system.springs[spring_of(mount, system)], mount.along
    numbers = tuple(None if name in find_shared(own, common) else getattr(own, name) for name in OF_SPRINGS)
    others = tuple(
        getattr(own, field.name) for field in fields(own) if field.name not in (*OF_SPRINGS, "path", "clutch")
    )
    if shares_path(mount, common):
        path = path.with_numbers({name: float(value != 0.0) for name, value in path.numbers.items()})
    axes = tuple(mechanism.axes[frame] for frame in path.frames)
    names = mount.name, spring_of(mount, system), mount.rest, mount.taut, mount.on, mount.tooth, mount.slips, mount.way
    return names, path, axes, type(own), numbers, others


def _shape_of_ground(ground: Ground) -> Any:
    """Returns the identity of a ground that is no plane, and those of its numbers that are no parameters."""
    if type(ground) is Ground:
        return None
    own = tuple(getattr(ground, field.name) for field in fields(ground) if field.name not in ("friction", *PLACE))
    functions = type(ground).above, type(ground).axes
    return type(ground), *(Reader().identity(each) for each in (own, *functions))


def check_law(law: Any) -> None:
    """Checks that the fields of a law can be compiled: numbers as run-time parameters, words and switches as they are.

    Raises:
        BadValue: a field has another value, such as a list.
    """
    for name in field_names(law) or ():
        value = getattr(law, name)
        if not all(isinstance(each, (Real, np.bool_)) for each in flatten((value,))):
            where = f"{type(law).__name__}.{name}"
            raise BadValue(where, value, "a number, a word, a switch, or a tuple or a dataclass of these")


def shape_of(held: Values) -> Any:
    """Returns the shape of held values, which is equal for values that share compiled code."""
    return (*held, _shape(tuple(held.values())))


def _shape(value: Any) -> Any:
    if type(value) in FLOATS:  # most are
        return float
    if isinstance(value, tuple):
        return len(value) if FLOATS.issuperset(map(type, value)) else tuple(map(_shape, value))
    if (names := field_names(value)) is not None:
        return type(value), *(_shape(getattr(value, name)) for name in names)
    return float if is_number(value) else value


def functions(domain: Domain) -> list[Any]:
    """Returns the functions of a domain that are compiled: law, guards, and latches where two domains alternate."""
    between = domain.between
    resets = () if between is None else (between.leave, between.touch, *between.follow)
    return [domain.law, *(guard.value for guard in domain.guards), *(reset.latch for reset in resets if reset.latch)]


def _identity(domain: Domain) -> Any:
    """Returns an identity of a domain, which distinguishes it from others."""
    between = domain.between
    others = () if between is None else (between.grounded.name, between.airborne.name)
    watched = tuple(guard.observes for guard in domain.guards)
    return domain.name, others, watched, tuple(map(Reader().identity, functions(domain)))
