"""Payoff study of a hop of one leg in place: the hop of least electricity for each knee, stiffness and flight time.

The spring is at the knee, or along a path of the robot's file.

The cost of a hop is the electricity of a cycle over m g h with h = g T²/8, the rise of a body with flight time T. So
all hops with one flight time refer to the same work.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, NoGait, UnknownName, list_names
from spear_pin.gaits.codesign import design as codesign
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.proportions import usual_flight
from spear_pin.gaits.springing import KNEE
from spear_pin.gaits.targets import check_wanted
from spear_pin.hybrid import batch
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number, unit, with_numbers
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.path import Path as AnyPath
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.model.variants import parameters_of
from spear_pin.studies.payoff.figures import Figures, figures
from spear_pin.studies.payoff.gaits import Found, Gaits, Words
from spear_pin.studies.payoff.grid import FIXED, KINDS, NONE, SWITCHED, Point
from spear_pin.studies.payoff.hop_search import NO_RANGES, TORQUE, Best, Task, best_hop, first_hops, lead_hop
from spear_pin.studies.payoff.knee import levers
from spear_pin.studies.payoff.motors import Motors, as_built
from spear_pin.studies.payoff.searches import Search, rebuilt
from spear_pin.studies.payoff.study import Study, study_knees
from spear_pin.words import show_unit

SHARES = (0.7, 0.85, 1.0, 1.15)  # of SPEAR-II's flight, by the leg's size
MESH, FINER = 160, 480  # samples of each phase: where a joint turns back, the losses of its gears jump
TOLERANCES = {MESH: 1e-4, FINER: 1e-5}  # of the search: the relative gain that ends a descent
COLD, FREELY = {NONE: 1, FIXED: 16, SWITCHED: 1}, 4  # random starts: beside SPEAR-II's law, with a chosen stiffness
KNEES, HIPS = (0.3, 2.2), (-1.5, 1.5)  # rad: of touchdown, within the joints' limits
RATES, TORQUES, STIFFNESS = (0.3, 2.5), (0.0, 6.0), (0.0, 8.0)  # of SPEAR-II's, scaled
WORDS = Words.read("hopping")


def work(robot: Robot, flight_time: float) -> float:
    """Returns the work m g h of a hop with a flight time T in s, h = g T²/8, in J."""
    gravity = robot.weight / robot.mass
    return robot.weight * gravity * flight_time**2 / 8.0


def ranges(robot: Robot, free: bool, usual: float | None = None) -> dict[str, tuple[float, float]]:
    """Returns least and most of each chosen number.

    Args:
        robot: a leg.
        free: whether the stiffness of the spring is among them.
        usual: its usual stiffness, if it is not at the knee.
    """
    law, stiffness = HoppingLaw.scaled(robot), Spring.scaled(robot).stiffness

    def angles(part: str, least: float, most: float) -> tuple[float, float]:
        low, high = robot.limits[part].position
        return max(low, least), min(high, most)

    def times(shares: tuple[float, float], value: float) -> tuple[float, float]:
        return shares[0] * value, shares[1] * value

    chosen = {
        TORQUE: times(TORQUES, law.stance_torque),
        "knee_touchdown": angles("knee", *KNEES),
        "hip_touchdown": angles("hip", *HIPS),
        "frequency": times(RATES, law.frequency),
        "virtual_stiffness": times(STIFFNESS, stiffness),
    }
    return chosen | ({"stiffness": times(STIFFNESS, usual or stiffness)} if free else {})


def figures_of(
    gait: Gait,
    motors: Motors,
    best: Best | None = None,
    samples: int = MESH,
    over: Iterable[str] = (),
    own: Robot | None = None,
) -> Figures:
    """Returns figures of a hop.

    Args:
        gait: a hop in place.
        motors: motors that drive it, of size 1.
        best: the search that found it, which says what holds it.
        samples: number of samples of each phase.
        over: names of numbers that the search also chose.
        own: robot to whose work the cost refers, for any motor; by default the hop's.
    """
    robot, flight = gait.system.robot, gait.durations["flight"]
    trajectory = simulate(gait.system, gait.state, samples=samples, progress=False)
    done = work(own or robot, flight)
    held, starts = ((), 1) if best is None else (_held(best.design, done), best.starts)
    found = figures(gait, as_built(motors, robot), trajectory, work=done, speed=flight, held=held, starts=starts)
    return replace(found, chosen={name: number(gait.system, name) for name in over})


def _held(design: codesign.Design, work: float) -> tuple[str, ...]:
    """Lists the active bounds of a design, with their prices, in words."""
    return tuple(
        f"{label.replace('_', ' ')} ({price / work:+.2g} of the cost for one SI unit more)"
        for label, price in design.active.items()
        if label != "least virtual_stiffness"
    )


def _begun(system: HybridSystem, asked: Search) -> list[Gait]:
    """Returns hops at the point of a search: the start's, or without one those of a system by SPEAR-II's scaled law.

    The flight time of the latter is SPEAR-II's for the leg's size, or the wanted one; from there they are led.

    Raises:
        NoGait: there is none; the first failure is raised.
    """
    point, start, found, failures = asked.point, asked.start, list[Gait](), list[NoGait]()
    robot = system.robot
    if start is not None and start.gait is not None:
        return [lead_hop(point, start.point.kind, rebuilt(Hops.kind, robot, start.gait))]
    try:
        for hop in first_hops(system, sorted({usual_flight(robot), point.speed})):
            try:
                found.append(lead_hop(point, SWITCHED, hop))
            except NoGait as error:
                failures.append(error)
    except NoGait as error:
        failures.append(error)
    if not found:
        raise failures[0]
    return found


def task_of(
    robot: Robot,
    motors: Motors | None,
    measure: str,
    asked: Search,
    over: Mapping[str, tuple[float, float]] = NO_RANGES,
    usual: float | None = None,
) -> Task:
    """Returns what a search minimises, where, and how far."""
    point, (mesh,) = asked.point, asked.meshes
    return Task(
        flight_time=point.speed,
        measure=measure,
        motors=motors,
        ranges={**ranges(robot, point.stiffness is None, usual), **over},
        tolerance=TOLERANCES[mesh],
        starts=COLD[point.kind] if asked.start is None else FREELY if point.stiffness is None else 0,
        seed=int(asked.key[:8], 16),
    )


@dataclass(frozen=True)
class Hops(Gaits):
    """Hops of one leg in place, found as fixed points.

    Attributes:
        over: least and greatest values of further numbers that are chosen at each point, such as `knee_motor_size`,
            or `cable.hip` of the path.
        along: name and path of the spring; None for the knee's.
        words: words for them.
    """

    over: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    along: tuple[str, AnyPath] | None = None
    words: Words = WORDS

    kind = "hopping"
    meshes = (MESH,)
    finer = (FINER,)
    begins = (SWITCHED, NONE)  # a motor that is too weak for any hop alone may do with a spring
    cold, valleys = KINDS, (FIXED,)

    def search(self, robot: Robot, motors: Motors, asked: Search) -> Found:
        """Finds the gait of least electrical cost of a robot with its motors, and its figures."""
        over = {name: ends for name, ends in self.over.items() if asked.point.kind != NONE or name not in self.of_path}
        task = task_of(robot, motors, "electricity", asked, over, self.stiffness(robot))
        best = best_hop(task, _begun(self.system(robot), asked))
        return best.gait, figures_of(best.gait, motors, best, asked.meshes[0], over, robot), None

    def reference(self, robot: Robot, speed: float) -> Gait:
        """Finds the gait of least effort of a robot without springs at a speed, and its load on motors."""
        asked = Search(Point(NONE, speed), None, self.meshes)
        return best_hop(task_of(robot, None, "effort", asked), _begun(self.system(robot), asked)).gait

    def speeds(self, robot: Robot) -> tuple[float, ...]:
        """Returns default flight times for the robot's size."""
        return tuple(float(f"{share * usual_flight(robot):.3g}") for share in SHARES)

    def first(self, robot: Robot, speeds: Sequence[float]) -> Sequence[float]:
        """Returns flight times in the order for a first hop: those near SPEAR-II's for the leg's size first."""
        usual = usual_flight(robot)
        return sorted(speeds, key=lambda flight: abs(math.log(flight / usual)))

    def stiffness(self, robot: Robot) -> float:
        """Returns the stiffness of a leg's spring for the robot's size, in N·m/rad."""
        return Spring.scaled(robot).stiffness / float(np.sum(levers(self.system(robot)) ** 2))

    def system(self, robot: Robot) -> HybridSystem:
        """Returns the hop of a robot by SPEAR-II's scaled law, with its spring; one that is not the knee's is slack."""
        law, usual = HoppingLaw.scaled(robot), Spring.scaled(robot)
        knee = robot.settings.springs.get(KNEE, usual)
        if self.along is None:
            return hopping(robot, law, knee)
        name, path = self.along
        springs = {name: Spring(0.0, damping=0.0, path=path), KNEE: Spring(0.0, damping=knee.damping)}
        return hopping(robot, replace(law, virtual_stiffness=usual.stiffness), springs)

    @property
    def of_path(self) -> tuple[str, ...]:
        """Names of the numbers of the spring's path, which a knee without a spring lacks."""
        return () if self.along is None else tuple(f"{self.along[0]}.{name}" for name in self.along[1].numbers)

    def check(self, robot: Robot, speeds: Sequence[float]) -> None:
        """Refuses flight times that no such gait has, and numbers that cannot be chosen."""
        system = self.system(robot)
        for flight in speeds:
            check_wanted(system, {"flight_time": flight})
        for name, ends in self.over.items():
            if name not in (known := (*parameters_of(robot), *self.of_path)):
                raise UnknownName("parameter of the robot", name, known)
            if len(ends) != 2 or not ends[0] < ends[1]:
                raise BadValue(f"over[{name!r}]", ends, "a least and a greatest value")
            for end in ends:
                with_numbers(system, {name: end})  # its error says what is valid
        self._enclose(system, self.of_path)

    def suits(self, robot: Robot) -> None:
        """Refuses ranges without the number of a robot with its motors, with which a search begins."""
        self._enclose(self.system(robot), tuple(self.over))

    def _enclose(self, system: HybridSystem, names: Sequence[str]) -> None:
        """Refuses ranges that do not hold the system's own number."""
        for name, (low, high) in self.over.items():
            if name in names and not low <= (value := number(system, name)) <= high:
                raise BadValue(f"over[{name!r}]", (low, high), f"a range with the robot's own value in it, {value:g}")

    def asked(self, robot: Robot) -> Mapping[str, Any]:
        """Returns further data that tell one study from another."""
        return {
            "gait": "hop",
            "search": "descents from several starts, with springs held taut",
            "ranges": {name: list(ends) for name, ends in {**ranges(robot, free=True), **self.over}.items()},
            **({} if self.along is None else {"spring": str(self.along)}),
        }

    def energy(self, robot: Robot, figures: Figures) -> float:
        """Returns the energy that the motors of the whole robot draw in a cycle, in J."""
        return figures.cost * work(robot, figures.speed)


HOPS = Hops()


def along_of(robot: Robot, name: str | None) -> tuple[str, AnyPath] | None:
    """Returns name and path of a robot's spring; None for the knee's.

    Raises:
        UnknownName: its file has no such spring.
        BadValue: its file has several, and none is named, or the spring has a switch of its own.
    """
    own = robot.settings.springs
    paths = {each: spring.path for each, spring in own.items() if spring.path is not None}
    known = [*paths, *[KNEE] * (not paths or (KNEE in own and own[KNEE].pulls))]
    if name is None and len(known) > 1:
        raise BadValue("spring", None, f"the name of one, as the robot's file has several: {list_names(known)}")
    name = known[0] if name is None else name
    if name not in (KNEE, *paths):
        raise UnknownName("spring", name, [KNEE, *paths])
    if name in own and own[name].clutch is not None:
        raise BadValue(f"clutch of the spring {name!r}", own[name].clutch, "None: this study switches at once")
    return (name, paths[name]) if name in paths else None


def words_for(gaits: Hops, robot: Robot) -> Words:
    """Returns the words of hops of a robot with a spring at the knee or along a path, and with numbers chosen too."""
    words, system = WORDS, gaits.system(robot)
    if gaits.along is not None:
        name, path = gaits.along
        said = f"{name}, alone: others of the file are left out. The virtual spring and the damper are at the knee"
        stiffness = Spring(0.0, path=path).units["stiffness"]
        words = replace(words, place=f"along {name}", unit=stiffness, rests=(*words.rests, ("the spring", said)))
    units = {name: show_unit(unit(system, name)) for name in gaits.over}
    ends = ", ".join(f"{name} from {low:g} to {high:g} {units[name]}" for name, (low, high) in gaits.over.items())
    return replace(words, units=units, rests=(*words.rests, *[("chosen too", ends.strip())] * bool(ends)))


def hops(
    robot: Robot,
    path: Path,
    *,
    spring: str | None = None,
    over: Mapping[str, tuple[float, float]] = NO_RANGES,
    **options: Any,
) -> Study:
    """Finds hops of least electricity without a spring, with fixed and with switchable ones.

    Args:
        robot: a leg with boom_x locked, as `spear_pin.monopod` cuts it, or SPEAR-II.
        path: path of the store; searches in it are not repeated.
        spring: name of a spring of the robot's file; its other springs are left out. None: the only one it has, or one
            at the knee. Stiffnesses are in N/m if the spring's path is a length.
        over: least and greatest values of further numbers that each search chooses: of the robot, such as
            `knee_motor_size`, with the mass of that motor, or of the spring's path, such as `cable.end_z`. With ratios
            a motor keeps its greatest speed behind the greatest one. Costs refer to the work of the robot as it is.
        **options: see `study_knees`; speeds are flight times, in s, by default `SHARES` of SPEAR-II's for the leg's
            size.

    Raises:
        NoGait, BadFile, BadValue: see `study_knees`.
        UnknownName: the robot's file has no such spring.
        MissingExtra: heyoka, or for several processes joblib, is not installed.
    """
    along = along_of(robot, spring)
    batch.require()
    gaits = Hops(dict(over), along)
    return study_knees(replace(gaits, words=words_for(gaits, robot)), robot, path, **options)
