"""Events that are over within one step of the integrator, with their times in closed form.

The limp robot keeps its shape as it falls, so that its toe moves on a parabola, whatever steps are taken.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from spear_pin import Contact, Ground, HoppingLaw, Spring, load
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Guard, Reset
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.rules.guards import height

ROBOT = load("spear_ii")
SPEED, FALL, HIGH, GRAVITY = 2.5, 0.1, 0.01, 9.81  # of the toe, forward, down, and how high it begins
LAST = 0.2  # s: when a run ends
LIMP = HoppingLaw(stance_torque=0.0, hip_gain=0.0, hip_damping=0.0, knee_gain=0.0, knee_damping=0.0)
STRUCK = Guard("struck", height("toe"), ends="fall", tolerance=1e-8)


def start():
    """The toe at x = 0, some cm up, the whole robot moving forward and down."""
    q = np.array([0.0, 0.0, 0.5, 1.0])
    x, z = ROBOT.toe_position(q, "toe")
    q[0] -= x
    q[1] -= z - HIGH
    return q, np.array([SPEED, -FALL, 0.0, 0.0])


def toe(t):
    """Where the toe is."""
    return SPEED * t, HIGH - FALL * t - 0.5 * GRAVITY * t**2


def flying(*guards, ground=None):
    """A system in which the limp robot flies until one of these guards ends the run, or for a while."""
    end = Guard("end", lambda t, *_: LAST - t, Reset(latch=lambda *_: {}, phase="fall"))
    domain = Domain("fall", "fall", (OPEN,), limp, guards=(*guards, end))
    return HybridSystem(
        kind="flying",
        robot=ROBOT,
        law=LIMP,
        springs={"knee": Spring()},
        contact=ground or Contact(),
        domains=(domain,),
        section="end",
        cyclic=(),
        build=lambda *_, **__: flying(*guards, ground=ground),
        guess=start,
    )


def limp(t, q, v, held, p, dyn, ops):
    """No torques."""
    return 0.0, 0.0


def root(value, before, after):
    """Where a function falls through zero, by halving."""
    for _ in range(200):
        middle = 0.5 * (before + after)
        before, after = (middle, after) if value(middle) > 0.0 else (before, middle)
    return before


@dataclass(frozen=True)
class Curb(Ground):
    """A curb, or a post, across the way."""

    at: float = 0.04
    wide: float = 0.01
    rise: float = 0.015

    def above(self, x, z, ops=FLOATS):
        beside = ops.maximum(self.at - x, x - self.at - self.wide)
        return -ops.maximum(-z, -ops.maximum(z - self.rise, beside))


@dataclass(frozen=True)
class Ribs(Ground):
    """A thin wall between two holes, its top at the ground's height."""

    at: float = 0.14
    wide: float = 0.002

    def above(self, x, z, ops=FLOATS):
        return ops.maximum(z, ops.maximum(self.at - x, x - self.at - self.wide))


@dataclass(frozen=True)
class Slot(Ground):
    """A slot in the ground, which the toe falls into and whose far side it strikes."""

    at: float = 0.088
    wide: float = 0.004
    deep: float = 0.05

    def above(self, x, z, ops=FLOATS):
        within = -ops.maximum(self.at - x, ops.maximum(x - self.at - self.wide, -z - self.deep))
        return ops.maximum(z, within)


@dataclass(frozen=True)
class Waves(Ground):
    """Short waves."""

    long: float = 0.004
    size: float = 0.005

    def above(self, x, z, ops=FLOATS):
        return z - self.size * ops.sin(2.0 * math.pi / self.long * x)


@dataclass(frozen=True)
class Bump(Ground):
    """A narrow bump without edges."""

    at: float = 0.05
    wide: float = 0.001
    rise: float = 0.012

    def above(self, x, z, ops=FLOATS):
        return z - self.rise * ops.exp(-(((x - self.at) / self.wide) ** 2))


@dataclass(frozen=True)
class Branching(Ground):
    """A thin post by `if`, which symbols do not take."""

    def above(self, x, z, ops=FLOATS):
        return z - (0.02 if 0.05 < x < 0.052 else 0.0)


@dataclass(frozen=True)
class Plain(Ground):
    """A thin post by functions of `math`, which intervals do not take."""

    def above(self, x, z, ops=FLOATS):
        return z - 0.02 * math.exp(-(((float(x) - 0.05) / 0.001) ** 2))


@dataclass(frozen=True)
class Case:
    """A system, what ends its run, and when by hand."""

    system: HybridSystem
    time: float
    name: str = "struck"
    symbolic: bool = True


def on(ground, time, **options):
    """The toe strikes a ground."""
    return Case(flying(STRUCK, ground=ground), time, **options)


def by(value, time, tolerance=1e-9, **options):
    """A guard ends the run."""
    return Case(flying(Guard("passes", value, ends="fall", tolerance=tolerance)), time, "passes", **options)


def struck(ground):
    """When the toe strikes a ground, looked for every 0.1 µs."""
    times = np.arange(0.0, 0.05, 1e-7)
    heights = ground.above(*toe(times), SimpleNamespace(sin=np.sin, exp=np.exp))
    after = int(np.argmax(heights <= 0.0))
    return root(lambda t: ground.above(*toe(t)), times[after - 1], times[after])


CASES: dict[str, Callable[[], Case]] = {
    **{f"curb of {wide:g} m": (lambda wide=wide: on(Curb(wide=wide), 0.016)) for wide in (0.02, 0.01, 0.005, 0.001)},
    "curb in the first step": lambda: on(Curb(at=1e-3, wide=1e-3), 4e-4),
    "post": lambda: on(Curb(at=0.07, wide=0.005, rise=0.3), 0.028),
    "rib between holes": lambda: on(Ribs(), 0.056),
    "slot": lambda: on(Slot(), 0.0368),
    "waves": lambda: on(Waves(), struck(Waves())),
    "bump": lambda: on(Bump(), struck(Bump())),
    "post by if": lambda: on(Branching(), 0.02, symbolic=False),
    "post by math": lambda: on(Plain(), struck(Bump(at=0.05, wide=0.001, rise=0.02)), symbolic=False),
    "pulse of time": lambda: by(lambda t, q, v, held, p, dyn, ops: ops.maximum(t - 0.1301, 0.13 - t), 0.13),
    "smooth pulse of time": lambda: by(
        lambda t, q, v, held, p, dyn, ops: 1.0 - 2.0 * ops.exp(-(((t - 0.13) / 1e-4) ** 2)),
        0.13 - 1e-4 * math.sqrt(math.log(2.0)),
    ),
    "pulse of time by if": lambda: by(lambda t, *_: -1.0 if 0.13 <= t < 0.1301 else 1.0, 0.13, symbolic=False),
    "notch in a rate": lambda: by(
        lambda t, q, v, held, p, dyn, ops: ops.maximum(v[1] + 0.6, -0.6001 - v[1]), (0.6 - FALL) / GRAVITY
    ),
    "kink that just passes": lambda: by(
        lambda t, q, v, held, p, dyn, ops: ops.maximum(t - 0.13, 0.13 - t) - 1e-7, 0.13 - 1e-7
    ),
    "double root": lambda: by(
        lambda t, q, v, held, p, dyn, ops: (dyn.height("toe") + 0.05) ** 2 - 1e-10,
        root(lambda t: toe(t)[1] + 0.05 - 1e-5, 0.0, 0.2),
        1e-12,
    ),
}
