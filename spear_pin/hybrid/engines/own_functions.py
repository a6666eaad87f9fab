"""User functions: calls them for the reference engine, checks their answers and reports their mistakes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFunction
from spear_pin.hybrid.domain import Domain, Guard, Held, Mount
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.own import FAR, call_function, has_no_value, is_own, mistake, number, torques


class OwnFunctions:
    """The user functions of a domain.

    A function that has no value at some state is no mistake, for the motion need not reach that state. It is a `fault`,
    which the run reports if it cannot continue.

    Args:
        domain: the domain.

    Attributes:
        law: whether the law is a user function.
        guards: ids of the guards that are user functions.
        springs: names of mounts whose springs are user functions.
        fault: why a function has had no value since the motion last arrived at a state; None if all had one.
    """

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self.law = is_own(domain.law)
        self.guards = {id(guard) for guard in domain.guards if is_own(guard.value)}
        self.springs = {mount.name for mount in domain.mounts if is_own(type(mount.spring))}
        self.fault: BadFunction | None = None

    def torques(self, joints: Sequence[str], arguments: Sequence[Any]) -> list[float]:
        """Calls the law, and returns the torque of each joint, in N·m.

        Args:
            joints: joints that have a motor.
            arguments: arguments of the law; time, angles and rates come first.
        """
        what, law = f"law of domain {self._domain.name!r}", self._domain.law
        t, q, v, *_ = arguments
        answer = self._asked(what, law, partial(law, *arguments), (q, v))
        found = [number(what, law, each) for each in torques(what, law, answer, joints)]
        if any(map(math.isnan, found)):
            self._lost(what, law, f"it gives {found} at t = {t:.6g} s", (q, v))
        return found

    def value(self, guard: Guard, arguments: Sequence[Any]) -> float:
        """Calls a guard, and returns its value.

        Args:
            guard: the guard.
            arguments: arguments of its function; time, configuration and velocity come first.
        """
        what, (t, q, v, *_) = f"guard {guard.name!r} of domain {self._domain.name!r}", arguments
        found = number(what, guard.value, self._asked(what, guard.value, partial(guard.value, *arguments), (q, v)))
        if math.isnan(found):
            self._lost(what, guard.value, f"it gives {found} at t = {t:.6g} s", (q, v))
        return found

    def spring(self, mount: Mount, stretch: float, rate: float, held: Held) -> tuple[float, float]:
        """Returns the force of a spring along its path, and that of its damper, in N·m or N."""
        spring, at = mount.spring, ([stretch], [rate])
        what = f"spring of {mount.name!r} in domain {self._domain.name!r}"
        torque = self._asked(what, spring.torque, partial(mount.pull, spring, stretch, held, FLOATS), at)
        drag = self._asked(what, spring.drag, partial(mount.drag, spring, rate, held), at)
        found = number(what, spring.torque, torque), number(what, spring.drag, drag)
        if any(map(math.isnan, found)):
            self._lost(what, spring.torque, f"it gives {sum(found)} at a stretch of {stretch:.6g}", at)
        return found

    def above(self, ground: Ground, x: float, z: float) -> float:
        """Returns the distance of a point from the ground, in m."""
        what = f"ground {type(ground).__name__}"
        found: float = self._asked(what, ground.above, partial(ground.above, x, z, FLOATS), ([x], [z]))
        if math.isnan(found):
            self._lost(what, ground.above, f"it gives {found} at x = {x:.6g} m, z = {z:.6g} m", ([x], [z]))
        return found

    def _asked(self, what: str, function: Any, call: Callable[[], Any], at: tuple[Any, Any]) -> Any:
        """Calls a function, and returns its answer.

        Raises:
            BadFunction: there is a mistake in the function.
            ArithmeticError: the function has no value at this state.
        """
        try:
            return call_function(what, function, call)
        except BadFunction as error:
            if not has_no_value(error.__cause__):
                raise
            self.fault = error if _near(at) else self.fault
            raise ArithmeticError from None

    def _lost(self, what: str, function: Any, problem: str, at: tuple[Any, Any]) -> None:
        """Records that a function returned no number."""
        if _near(at):
            self.fault = mistake(what, function, f"{problem}; expected finite numbers")


def _near(at: tuple[Any, Any]) -> bool:
    """Tells whether a motion may reach a state."""
    values: Array = np.abs(np.concatenate(at))
    return bool((values < FAR).all())
