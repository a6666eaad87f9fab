"""Mistakes in laws, guards, latches, springs and grounds of one's own, each with what it comes out as."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from spear_pin import Ground, HoppingLaw, Spring, hopping, load
from spear_pin.hybrid.automaton import Guard, Reset
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.parameters import change_system

LAW = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0)


@dataclass(frozen=True)
class Mistake:
    """A mistake.

    Attributes:
        system: makes the system that it is in.
        what: what is named, in any engine.
        says: what is said of it.
        cause: type of the exception that is the cause; None where a function gives what it should not.
        symbolic: whether symbols can be put into it at all.
    """

    system: Callable[[], Any]
    what: str
    says: str
    cause: type[Exception] | None = None
    symbolic: bool = True


def plain(ground=None, spring=None):
    """A hop of SPEAR-II in place."""
    return hopping(load("spear_ii", locked=["boom_x"]), LAW, spring, ground=ground)


def law(function, phase="stance"):
    """The hop with another law in a phase."""

    def with_law(system):
        domains = [replace(each, law=function) if each.phase == phase else each for each in system.domains]
        return replace(system, domains=tuple(domains))

    return lambda: change_system(plain(), with_law)


def guard(value, phase="flight"):
    """The hop with a guard more in a phase."""

    def with_guard(system):
        more = Guard("mine", value)
        domains = [
            replace(each, guards=(more, *each.guards)) if each.phase == phase else each for each in system.domains
        ]
        return replace(system, domains=tuple(domains))

    return lambda: change_system(plain(), with_guard)


def latch(function):
    """The hop with another latch at lift-off, beside what is latched there."""

    def with_latch(system):
        domains = []
        for domain in system.domains:
            guards = []
            for each in domain.guards:
                if each.name == "lift_off":
                    old = each.reset.latch

                    def both(q, v, held, p, old=old):
                        new = function(q, v, held, p)
                        return {**(old(q, v, held, p) if old else {}), **new} if isinstance(new, dict) else new

                    each = replace(each, reset=Reset(**{**vars(each.reset), "latch": both}))
                guards.append(each)
            domains.append(replace(domain, guards=tuple(guards)))
        return replace(system, domains=tuple(domains))

    return lambda: change_system(plain(), with_latch)


def jump(function):
    """The hop with a jump at lift-off."""

    def jumping(guard):
        return replace(guard, reset=replace(guard.reset, jump=function)) if guard.name == "lift_off" else guard

    def with_jump(system):
        domains = [replace(each, guards=tuple(map(jumping, each.guards))) for each in system.domains]
        return replace(system, domains=tuple(domains))

    return lambda: change_system(plain(), with_jump)


def ground(function):
    """The hop on a ground whose distance is a function's."""

    @dataclass(frozen=True)
    class Mine(Ground):
        def above(self, x, z, ops=FLOATS):
            return function(x, z, ops)

    return lambda: plain(Mine())


def spring(function):
    """The hop with a spring whose torque is a function's."""

    @dataclass(frozen=True)
    class Mine(Spring):
        def torque(self, deflection, ops):
            return function(deflection, ops)

    return lambda: plain(spring=Mine())


class Called:
    """An object that is called as a function is; it gives what it is made with, if anything."""

    def __init__(self, *given):
        self.given = given

    def __call__(self, *_):
        return self.given[0] if self.given else 1 / 0


def unknown(*_):
    return undefined_name  # noqa: F821


STANCE, FLIGHT, MINE = "law of domain 'stance'", "law of domain 'flight'", "guard 'mine' of domain 'flight'"
LATCH, GROUND, SPRING = "latch of 'lift_off' in domain 'stance", "ground", "spring of 'knee' in domain 'stance'"
JUMP = "jump of 'lift_off' in domain 'stance"

MISTAKES: dict[str, Mistake] = {
    # laws
    "1/0": Mistake(law(lambda *_: (0.0, 1 / 0)), STANCE, "ZeroDivisionError", ZeroDivisionError),
    "1/0 after lift-off": Mistake(
        law(lambda t, *_: (1 / 0, 0.0), "flight"), FLIGHT, "ZeroDivisionError", ZeroDivisionError
    ),
    "a name that there is not": Mistake(law(unknown), STANCE, "NameError: name 'undefined_name'", NameError),
    "a misspelt parameter": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, p.stance_torqe)), STANCE, "'stance_torqe'", AttributeError
    ),
    "a force that its torques cause": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, 0.1 * dyn.force("toe")[1])),
        STANCE,
        "dyn.force() follows from the law's torques",
        TypeError,
    ),
    "a misspelt query": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, dyn.mass_matrx[0][0])), STANCE, "'mass_matrx'", AttributeError
    ),
    "a misspelt function": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, ops.sine(t))), STANCE, "'sine'", AttributeError
    ),
    "a coordinate too many": Mistake(law(lambda t, q, *_: (0.0, q[7])), STANCE, "IndexError", IndexError),
    "a key that there is not": Mistake(law(lambda *_: (0.0, {}["a"])), STANCE, "KeyError: 'a'", KeyError),
    "what is not held": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, held["latchd"])), STANCE, "unknown latched value 'latchd'"
    ),
    "a toe that there is not": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, dyn.toe_velocity("tow")[0])), STANCE, "KeyError: 'tow'", KeyError
    ),
    "a sum of a number and a text": Mistake(law(lambda *_: (0.0, 1.0 + "a")), STANCE, "TypeError", TypeError),
    "a torque too many": Mistake(
        law(lambda *_: (0.0, 1.0, 2.0)), STANCE, "it gives (0.0, 1.0, 2.0); expected a torque for each of hip, knee"
    ),
    "a torque too few": Mistake(law(lambda *_: [1.0]), STANCE, "it gives [1.0]; expected a torque for each"),
    "no torques": Mistake(law(lambda *_: None), STANCE, "it gives None; expected a torque for each of hip, knee"),
    "one torque": Mistake(law(lambda *_: 5.0), STANCE, "it gives 5.0; expected a torque for each of hip, knee"),
    "a text for torques": Mistake(law(lambda *_: "ab"), STANCE, "it gives 'ab'; expected a torque for each"),
    "a text for a torque": Mistake(law(lambda *_: ("a", 0.0)), STANCE, "it gives 'a' as the torque of 'hip'"),
    "None for a torque": Mistake(law(lambda *_: (0.0, None)), STANCE, "it gives None as the torque of 'knee'"),
    "a complex torque": Mistake(law(lambda *_: (0.0, 1j)), STANCE, "it gives 1j as the torque of 'knee'"),
    "a list for a torque": Mistake(law(lambda *_: ([0.0, 1.0], 0.0)), STANCE, "it gives [0.0, 1.0] as the torque"),
    "not a number for a torque": Mistake(law(lambda *_: (0.0, math.nan)), STANCE, "it gives [0.0, nan] at t = "),
    "not a number later": Mistake(
        law(lambda t, *_: (0.0, 0.0 if t < 0.1 else math.nan)), STANCE, "nan] at t = 0.1", None, False
    ),
    "no value later": Mistake(
        law(lambda t, *_: (0.0, math.sqrt(0.1 - t))), STANCE, "ValueError: ", ValueError, False
    ),
    "no value later, with symbols": Mistake(
        law(lambda t, q, v, held, p, dyn, ops: (0.0, ops.sqrt(0.1 - t))), STANCE, "ValueError: ", ValueError
    ),
    "1/0 later": Mistake(
        law(lambda t, *_: (0.0, 1 / 0 if t > 0.05 else 0.0)), STANCE, "ZeroDivisionError", ZeroDivisionError, False
    ),
    "too few arguments": Mistake(law(lambda t, q, v: (0.0, 0.0)), STANCE, "TypeError", TypeError),
    # guards
    "1/0 in a guard": Mistake(guard(lambda *_: 1 / 0), MINE, "ZeroDivisionError", ZeroDivisionError),
    "a name that there is not in a guard": Mistake(guard(unknown), MINE, "NameError", NameError),
    "no value of a guard": Mistake(guard(lambda *_: None), MINE, "it gives None; expected a number"),
    "a text of a guard": Mistake(guard(lambda *_: "1.0"), MINE, "it gives '1.0'; expected a number"),
    "a complex guard": Mistake(guard(lambda *_: 1.0 + 1j), MINE, "expected a number"),
    "a list of a guard": Mistake(guard(lambda t, *_: [1.0 - t]), MINE, "expected a number"),
    "an array of a guard": Mistake(guard(lambda t, q, *_: np.array([1.0, 2.0])), MINE, "expected a number"),
    "a guard that is not a number": Mistake(guard(lambda *_: math.nan), MINE, "it gives nan at t = "),
    "a guard that is not a number later": Mistake(
        guard(lambda t, *_: 1.0 if t < 0.05 else math.nan), MINE, "it gives nan at t = 0.05", None, False
    ),
    "a frame that there is not": Mistake(
        guard(lambda t, q, v, held, p, dyn, ops: dyn.height("foot")), MINE, "unknown frame 'foot'"
    ),
    # jumps
    "1/0 in a jump": Mistake(jump(lambda *_: 1 / 0), JUMP, "ZeroDivisionError", ZeroDivisionError),
    "a jump to nowhere": Mistake(jump(lambda *_: None), JUMP, "it gives None; expected (q, v), of 3 and 3 numbers"),
    "a jump without rates": Mistake(jump(lambda q, *_: (q, [])), JUMP, "expected (q, v), of 3 and 3 numbers"),
    "a jump to a text": Mistake(jump(lambda q, v, *_: (q, [*v[:2], "a"])), JUMP, "it gives 'a'; expected a number"),
    # latches
    "1/0 in a latch": Mistake(latch(lambda *_: {"x": 1 / 0}), LATCH, "ZeroDivisionError", ZeroDivisionError),
    "a latch of nothing": Mistake(latch(lambda *_: None), LATCH, 'it gives None; expected latched values by name'),
    "a latch of a number": Mistake(latch(lambda q, *_: q[0]), LATCH, "expected latched values by name"),
    "a latch of a list": Mistake(latch(lambda q, *_: {"x": [q[0]]}), LATCH, "as 'x'; expected a number, or a tuple"),
    "a latch that holds None": Mistake(latch(lambda *_: {"x": None}), LATCH, "it holds None as 'x'; expected a number"),
    "a latch that holds a text": Mistake(latch(lambda *_: {"x": "1.0"}), LATCH, "it holds '1.0' as 'x'"),
    "a latch that holds a mapping": Mistake(latch(lambda *_: {"x": {}}), LATCH, "it holds {} as 'x'"),
    "a latch that holds None beside a number": Mistake(latch(lambda *_: {"x": (1, None)}), LATCH, "it holds (1, None)"),
    "a latch that holds a text deep": Mistake(latch(lambda *_: {"x": ((1.0, ("a",)),)}), LATCH, "as 'x'; expected"),
    "a latch that is an object": Mistake(latch(Called()), LATCH, "ZeroDivisionError", ZeroDivisionError),
    "a law that is an object": Mistake(law(Called(None)), STANCE, "it gives None; expected a torque"),
    "a law that is a part": Mistake(law(partial(lambda given, *_: given, 5.0)), STANCE, "it gives 5.0; expected"),
    "a law that is a part of a part of an object": Mistake(
        law(partial(partial(Called(None)), 1.0)), STANCE, "it gives None; expected a torque"
    ),
    "a latch that is not a number": Mistake(latch(lambda *_: {"x": math.nan}), LATCH, "it holds nan as 'x'"),
    "a latch with a name that there is not": Mistake(latch(unknown), LATCH, "NameError", NameError),
    "a latch with a coordinate too many": Mistake(latch(lambda q, *_: {"x": q[7]}), LATCH, "IndexError", IndexError),
    # grounds
    "1/0 in a ground": Mistake(ground(lambda *_: 1 / 0), GROUND, "ZeroDivisionError", ZeroDivisionError),
    "a ground that is nowhere": Mistake(ground(lambda *_: None), GROUND, "it gives None; expected a number"),
    "a ground with a name that there is not": Mistake(ground(unknown), GROUND, "NameError", NameError),
    "a ground of a text": Mistake(ground(lambda *_: "0"), GROUND, "it gives '0'; expected a number"),
    "a ground that is not a number": Mistake(ground(lambda *_: math.nan), GROUND, "it gives nan"),
    "a ground that calls what there is not": Mistake(
        ground(lambda x, z, ops: ops.arctan(z)), GROUND, "'arctan'", AttributeError
    ),
    # springs
    "1/0 in a spring": Mistake(spring(lambda *_: 1 / 0), SPRING, "ZeroDivisionError", ZeroDivisionError),
    "a spring of a text": Mistake(spring(lambda *_: "1"), SPRING, "TypeError", TypeError),
    "a spring with a name that there is not": Mistake(spring(unknown), SPRING, "NameError", NameError),
    "a spring of nothing": Mistake(spring(lambda *_: None), SPRING, "TypeError", TypeError),
}  # fmt: skip
