"""A bound whose numbers a user changes: Newton's method carries the gait to the new numbers.

A bound is seldom stable, so simulation does not settle to one. Each gait is found from the nearest known gait, step by
step where one step is too far. Where two branches of gaits exist, the result is on the branch to which this leads.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from types import MappingProxyType

from spear_pin.errors import BadValue, NoGait, SpearError
from spear_pin.gaits.bounding import SPEED_BY
from spear_pin.gaits.feedback import without_feedback
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.result import State
from spear_pin.kinds import typed
from spear_pin.model.variants import PARAMETERS, vary
from spear_pin.studies.bound import mean_speed
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.knobs import Knob, Knobs, Subject
from spear_pin.studies.explore.motion import Motion, periodic

SPEED, MEAN_SPEED = "speed", "mean_speed"
RATIOS = ("knee_ratio", "hip_ratio")
FARTHER = 1.0  # m/s from the gait's own speed, either way
SLOWEST = 0.1  # of its own speed
LEAN = 0.1  # rad from the gait's own angles at touchdown
STEPS = 3  # Newton's methods that may fail on the way to one answer
REACH = 0.15  # of a slider's range, farther than which no step goes at first
PATIENCE = 3.0  # s, after which none is begun or continued
MEMORY = 200  # gaits that are known at most


@dataclass(frozen=True)
class Known:
    """A gait that was found: the numbers on the sliders, the state, and β_sp, in N·m."""

    numbers: tuple[float, ...]
    state: State
    torque: float


@dataclass(frozen=True, eq=False)
class Bound(Subject):
    """A bound at a mean speed, for which β_sp is solved.

    Attributes:
        gait: with the default numbers, without event feedback.
        knobs: knobs by name.
        title: title of the page.
        known: gaits found so far, the default one first.
    """

    gait: Gait
    knobs: Mapping[str, Knob]
    title: str
    known: list[Known] = field(default_factory=list)
    kind = "bound"

    def __post_init__(self) -> None:
        """Stores the default gait as the first known one."""
        torque = float(getattr(self.gait.system.law, SPEED_BY))
        self.known.append(Known(self.at().numbers, self.gait.state, torque))

    def system(self, values: Mapping[str, float]) -> HybridSystem:
        """Returns the bound with these numbers, β_sp unchanged."""
        own = self._template(*(values.get(name) for name in RATIOS))
        parts = {part: vars(getattr(own, part)) for part in ("law", "spring", "contact")}
        said = {
            part: {name: value for name, value in values.items() if name in fields} for part, fields in parts.items()
        }
        return rebuilt(own, **{part: replace(getattr(own, part), **new) for part, new in said.items()})

    def lane(self, values: Mapping[str, float]) -> tuple[HybridSystem, dict[str, float]]:
        """Returns a system with the default numbers except for the gears, and the other numbers."""
        numbers = {name: value for name, value in values.items() if name not in (SPEED, *RATIOS)}
        return self._template(*(values.get(name) for name in RATIOS)), numbers

    def held(self, kept: bool) -> Mapping[str, str]:
        """Returns that β_sp keeps the speed, if it is kept."""
        return {SPEED_BY: MEAN_SPEED}

    def moved(self, name: str, values: Mapping[str, float]) -> Mapping[str, float]:
        """Returns the parameters that a knob changes; the speed is that of the measure."""
        return {} if name == SPEED else {name: 1.0}

    @property
    def start(self) -> State:
        """State just after the posterior touchdown of the gait."""
        return self.gait.state

    @property
    def thorough(self) -> Sequence[Knobs]:
        """Numbers for a gait near the first."""
        speed = self.knobs[SPEED]
        return (self.at().turned(speed=round(1.002 * speed.default, speed.digits)),)

    def nearest(self, numbers: tuple[float, ...]) -> Known:
        """Returns the nearest known gait."""
        return min(self.known, key=lambda each: self.distance(each.numbers, numbers))

    def distance(self, one: tuple[float, ...], other: tuple[float, ...]) -> float:
        """Returns the largest difference of two settings, with each number relative to its range."""
        spans = [knob.high - knob.low for knob in self.knobs.values()]
        return max(abs(a - b) / span for a, b, span in zip(one, other, spans, strict=True))

    def remember(self, known: Known) -> None:
        """Stores a known gait, and drops the oldest except the first."""
        self.known.append(known)
        del self.known[1:-MEMORY]

    @cached_property
    def _template(self) -> Callable[..., HybridSystem]:
        return lru_cache(8)(self._geared)

    def _geared(self, *ratios: float | None) -> HybridSystem:
        system = self.gait.system
        changes = {name: ratio for name, ratio in zip(RATIOS, ratios, strict=True) if ratio is not None}
        if all(ratio == self.knobs[name].default for name, ratio in changes.items()):
            return system
        return system.build(vary(system.robot, **changes), law=system.law, spring=system.spring, contact=system.ground)


class Underway(NoGait):
    """Raised when there is no more time; gaits found on the way are stored, so that a repeated call gets farther."""


def stride(knobs: Knobs, engine: Engine) -> Motion:
    """Finds a stride of the gait with these numbers.

    Args:
        knobs: the numbers of a `Bound`.
        engine: engine that solves for it.

    Raises:
        Underway: there was no more time; repeat the call.
        NoGait: no gait was found; the text says why, and how far the way led.
    """
    subject = knobs.subject
    assert isinstance(subject, Bound)
    if knobs == subject.at():
        return periodic(knobs, subject.gait)
    begun = near = subject.nearest(knobs.numbers)
    step, failures = REACH, 0
    engine.advance(knobs, near.state, 1)  # with other gears it is compiled
    first = len(subject.known) == 1  # so is what runs cycles side by side
    until = math.inf if first else time.perf_counter() + PATIENCE
    while True:
        share = min(1.0, step / max(subject.distance(near.numbers, knobs.numbers), 1e-12))
        numbers = tuple(a + share * (b - a) for a, b in zip(near.numbers, knobs.numbers, strict=True))
        wanted = knobs if share == 1.0 else replace(knobs, numbers=numbers)
        target = {MEAN_SPEED: wanted.values[SPEED]}
        try:
            gait = engine.beside(wanted, near.state, {SPEED_BY: near.torque}, target, until)
        except SpearError as error:
            failures += 1
            step = 0.4 * share * subject.distance(near.numbers, knobs.numbers)
            if failures >= STEPS or time.perf_counter() > until:
                residual = error.residual if isinstance(error, NoGait) else math.inf
                told = f"{_said(subject, near)} none was found beyond: {_why(error)}"
                late = failures < STEPS and near is not begun
                raise (Underway if late else NoGait)(told, residual) from None
            continue
        if wanted is knobs:
            subject.remember(Known(knobs.numbers, gait.state, gait.parameters[SPEED_BY]))
            return periodic(knobs, gait)
        near = Known(wanted.numbers, gait.state, gait.parameters[SPEED_BY])
        subject.remember(near)


def _why(error: SpearError) -> str:
    return error.reason if isinstance(error, NoGait) else str(error)


def _said(subject: Bound, near: Known) -> str:
    """Returns in words the numbers of the last gait on the way that are not the default ones."""
    told = [
        f"{knob.label.lower()} {value:.4g}" + ("" if knob.unit == "1" else f" {knob.unit}")
        for knob, value in zip(subject.knobs.values(), near.numbers, strict=True)
        if not math.isclose(value, knob.default, rel_tol=1e-9, abs_tol=1e-12)
    ]
    return f"There is a gait at {', '.join(told) or 'the default numbers'}, and"


VIEWS: Mapping[str, Callable[[Knobs, Engine], Motion]] = MappingProxyType({"stride": stride})


@typed
def bound_to_explore(gait: Gait, title: str) -> Bound:
    """Returns a bound whose numbers a user can change.

    Args:
        gait: a bounding gait; its event feedback is left out.
        title: title of the page.

    Raises:
        BadValue: the gait is no bound in the plane.
    """
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, 'a bound in the plane, such as Gait.load("long_stride")')
    gait = without_feedback(gait)
    law, spring, robot = gait.system.law, gait.system.spring, gait.system.robot
    speed = round(mean_speed(gait), 4)
    slowest = max(SLOWEST * speed, speed - FARTHER)
    mostly = max(20.0, abs(law.anterior_hip_torque))
    knobs = {
        SPEED: Knob("Mean speed", "m/s", speed, round(slowest, 2), round(speed + FARTHER, 2), 3, "own", "the gait's"),
        "virtual_stiffness": _about("Knee stiffness", "N·m/rad", law.virtual_stiffness, "spring and motors of a pair"),
        "stiffness": _about("the spring's part", "N·m/rad", spring.stiffness, "the motors do the rest", 0.0, 3.5),
        "anterior_hip_torque": Knob(
            "Anterior hip torque",
            "N·m",
            law.anterior_hip_torque,
            round(law.anterior_hip_torque - mostly, 1),
            round(law.anterior_hip_torque + mostly, 1),
            3,
            "own",
            "of the pair, in stance",
        ),
        **{
            f"{leg}_leg_touchdown": Knob(
                f"{leg.capitalize()} leg at touchdown",
                "rad",
                angle,
                round(angle - LEAN, 3),
                round(angle + LEAN, 3),
                4,
                "own",
                "ahead of the hip",
            )
            for leg, angle in (
                ("posterior", law.posterior_leg_touchdown),
                ("anterior", law.anterior_leg_touchdown),
            )
        },
        "friction": Knob(
            "Friction coefficient", "1", gait.system.contact.friction, 0.1, 1.5, 2, "assumption", "of the ground"
        ),
    }
    if robot.cut is None:  # the file of another robot seldom tells its gears
        for name, low, high in (("knee_ratio", 5, 25), ("hip_ratio", 20, 100)):
            usual = robot.varied.get(name, PARAMETERS[name].default)
            label = f"{name.partition('_')[0].capitalize()} gear ratio"
            knobs[name] = Knob(label, "1", usual, low, high, 1, "source", "Tables 2.4 and 5.1")
    return Bound(gait, knobs, title)


def _about(label: str, unit: str, value: float, note: str, least: float = 0.5, most: float = 2.0) -> Knob:
    digits = max(0, 3 - math.floor(math.log10(max(value, 1e-3))))
    return Knob(label, unit, value, least * value, most * value or 100.0, digits, "own", note)
