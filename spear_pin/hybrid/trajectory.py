"""Result of a simulation: samples, events and energy ledger, which can be saved, loaded, cut, shown and tabulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError, UnknownName, require
from spear_pin.hybrid import trajectory_parts as parts
from spear_pin.hybrid import trajectory_tables as tables
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.path_springs import PathSprings
from spear_pin.kinds import typed
from spear_pin.model.mover import mover
from spear_pin.model.robot import Robot
from spear_pin.printable import printable
from spear_pin.showing import Player, Shown, play_page, plot_columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Event:
    """An event of a motion.

    Attributes:
        name: the guard's or switch's name.
        time: time of the event, in s.
        domain: name of the domain in which it happened.
        q: configuration, (nq,).
        v_before: velocity before, (nv,).
        v: velocity after, (nv,).
        impulse: impulse of the ground on each toe, along the ground and normal to it, in N·s, (ntoes, 2); in space
            (ntoes, 3).
        work: energy brought into the mechanism at this instant, in J, by flow (losses are negative).
    """

    name: str
    time: float
    domain: str
    q: Array
    v_before: Array
    v: Array
    impulse: Array
    work: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Ledger:
    """Energy by flow and cycle; positive is into the mechanism.

    Attributes:
        flows: names of the flows; of several springs each has its own, such as `released:biceps`.
        work: energy of each flow, in J, (cycles, flows).
        change: change of the stored energy (kinetic, gravity, springs), in J, (cycles,).
    """

    flows: tuple[str, ...]
    work: Array
    change: Array

    def __getitem__(self, flow: str) -> Array:
        """Returns the energy of one flow in each cycle, in J, (cycles,); `released` is the sum over all springs.

        Raises:
            UnknownName: there is no such flow.
        """
        columns = [i for i, name in enumerate(self.flows) if flow in (name, kind_of(name))]
        if not columns:
            raise UnknownName("flow", flow, dict.fromkeys([*self.kinds, *self.flows]))
        energy: Array = self.work[:, columns].sum(axis=1) if len(columns) > 1 else self.work[:, columns[0]]
        return energy

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names of the flows, with one for all springs."""
        return tuple(dict.fromkeys(map(kind_of, self.flows)))

    @property
    def residual(self) -> Array:
        """Imbalance of energy in each cycle, in J, (cycles,): change of the stored energy minus all flows."""
        left: Array = self.change - self.work.sum(axis=1)
        return left


def kind_of(flow: str) -> str:
    """Returns the name of a flow without that of its spring."""
    return flow.partition(":")[0]


@dataclass(frozen=True, repr=False)
class Trajectory(Shown):
    """Motion over time; at every sample D a + C v + G = B tau + friction + Σ Jᵀ F, with J and F in the ground's axes.

    The two sides of an event are two samples. There are at least 100 samples a phase.

    Attributes:
        robot: name or path of the robot.
        coordinates: names of the coordinates, (nv,).
        actuated: names of the joints with motors, (nu,).
        toes: names of the toes, (ntoes,).
        spring_joints: joints that carry a spring, (nsprings,).
        t: time, in s, (n,).
        q: configuration, (n, nq).
        v: velocity, (n, nv).
        a: acceleration, (n, nv).
        domain: names of the domains, (n,).
        phase: names of the phases, (n,).
        cycle: number of the cycle, 0 before the first section, (n,).
        u: motor torque, in N·m, (n, nu).
        tau: total joint torque with spring and damping, in N·m, (n, nu).
        friction: other generalised friction, (n, nv).
        force: ground force on each toe, along the ground (x) and normal to it (z), in N, (n, ntoes, 2); in
            space along x, y and z, (n, ntoes, 3).
        spring: torque of each spring on its joint, in N·m, (n, nsprings).
        engaged: whether each spring is engaged, (n, nsprings); a spring that never pulls is not engaged.
        current: current of each motor, in A, (n, nu); (n, 0) without hardware.
        reference: commanded current of each motor, in A, (n, nu); (n, 0) without hardware.
        events: the events.
        ledger: the energy ledger of whole cycles.
        cycles: number of whole cycles.
        reason: why the run ended; "complete" if it reached the requested number of cycles.
        message: the reason in a sentence.
        evaluations: number of right-hand sides evaluated.
        electrical: the ledger of the drives, None without hardware. Batteries are positive; heat, gears and motors are
            negative, as a motor's work leaves the drive. The change is that of the inductances.
        ground: the ground, whose axes forces and impulses use; None if a file has none.
        origin: origin of the robot, see `spear_pin.model.origin`; None if a file has none.
        springs: what springs do along their paths; None if each acts on a joint of its own.

    Example:
        >>> from spear_pin import hopping, load, simulate
        >>> system = hopping(load("spear_ii", locked=["boom_x"]))
        >>> hops = simulate(system, system.guess(), cycles=2)
        >>> hops.in_cycles(2).in_phase("flight").q.shape
        (102, 3)
        >>> print(hops.to_pandas()["force_z_toe"].max().round())  # N
        179.0
        >>> hops.play()  # which a notebook shows
        Player(... MB; a notebook shows it, save(path) writes a page)
    """

    robot: str
    coordinates: tuple[str, ...]
    actuated: tuple[str, ...]
    toes: tuple[str, ...]
    spring_joints: tuple[str, ...]
    t: Array
    q: Array
    v: Array
    a: Array
    domain: NDArray[np.str_]
    phase: NDArray[np.str_]
    cycle: NDArray[np.int64]
    u: Array
    tau: Array
    friction: Array
    force: Array
    spring: Array
    engaged: NDArray[np.bool_]
    current: Array
    reference: Array
    events: tuple[Event, ...]
    ledger: Ledger
    cycles: int
    reason: str
    message: str
    evaluations: int
    electrical: Ledger | None = None
    ground: Ground | None = None
    origin: Mapping[str, Any] | None = None
    springs: PathSprings | None = None

    def __repr__(self) -> str:
        duration = self.t[-1] - self.t[0]
        said = f"{self.cycles} cycles", f"{duration:.4g} s", f"{len(self)} samples", f"{len(self.events)} events"
        return f"Trajectory({printable(repr(self.robot))}: {', '.join(said)}, {self.reason})"

    def __len__(self) -> int:
        """Returns the number of samples."""
        return len(self.t)

    @property
    def complete(self) -> bool:
        """Tells whether all requested cycles were run."""
        return self.reason == "complete"

    def named(self, event: str) -> tuple[Event, ...]:
        """Returns the events of one name, in order of time."""
        return tuple(e for e in self.events if e.name == event)

    @typed
    def save(self, path: str | Path) -> Path:
        """Writes an npz file: arrays, and one JSON string for the rest; nothing is pickled."""
        from spear_pin.hybrid.trajectory_file import write

        return write(self, path)

    @classmethod
    @typed
    def load(cls, path: str | Path) -> Trajectory:
        """Reads a file that `save` wrote.

        Raises:
            BadFile: the file cannot be read, or is not a trajectory: an array is missing, unknown, of another kind or
                shape than its axes' names say, not finite, or out of order.
        """
        from spear_pin.hybrid.trajectory_file import read

        return read(path)

    @typed
    def export(self, path: str | Path) -> Path:
        """Writes the samples as CSV or MATLAB file, by the path's suffix.

        A CSV file has the columns of `to_pandas`, time first, each headed by its name and unit: "q_knee [rad]".

        Raises:
            BadValue: the suffix is neither .csv nor .mat.
        """
        return tables.export(self, path, SAMPLED)

    def columns(self) -> tuple[list[str], Array]:
        """Returns names and values of all numeric columns, one row a sample; `units` has their units."""
        return tables.columns(self)

    def units(self) -> dict[str, str]:
        """Returns the unit of each column by its name; "m or rad" and the like if the robot is not found."""
        return tables.units(self)

    def to_pandas(self) -> Any:
        """Returns the samples as a `pandas.DataFrame` over time: the `columns`, domain, phase and engaged springs.

        Its `attrs["units"]` has the unit of each column.
        """
        return tables.frame(self)

    def to_xarray(self) -> Any:
        """Returns the samples as an `xarray.Dataset` over time, coordinates, motors, toes and springs, with units.

        Raises:
            MissingExtra: xarray is not installed.
        """
        return tables.dataset(self)

    @typed
    def in_cycles(self, first: int, last: int | None = None) -> Trajectory:
        """Returns the cycles from the first to the last, inclusive, with their events and rows of the ledger.

        Args:
            first: number of the first cycle, as in `cycle`: 1 is the first whole one.
            last: number of the last cycle; None for only the first.

        Raises:
            BadValue: there are no such cycles.
        """
        return parts.cycles(self, first, first if last is None else last)

    @typed
    def in_phase(self, name: str) -> Trajectory:
        """Returns the samples and events of a phase, each time it occurs; the ledger has no rows.

        Raises:
            UnknownName: there is no such phase.
        """
        return parts.phase(self, name)

    @typed
    def load_robot(self, source: str | None = None) -> Robot:
        """Loads the robot of the trajectory again.

        Args:
            source: name or path of the robot, if its own is not found; if it was cut out of a robot, that robot's.

        Raises:
            SpearError: there is no such robot, or it is not the robot of this trajectory.
        """
        return mover(self.origin, self.robot, self.coordinates, self.toes, source)

    @typed
    def play(self, robot: Robot | None = None, *, title: str = "", height: int = 480) -> Player:
        """Returns a player that shows the motion in a notebook; of a long motion it shows the end, up to 2 MB.

        Args:
            robot: the robot that moved; by default it is loaded again, which needs its file.
            title: title above the player; by default the robot's name.
            height: height of the frame, in pixels.

        Raises:
            BadValue: the motion has gaps, its robot is not found, or the height is not positive.
        """
        require("height", height, lambda pixels: pixels >= 1, "a whole number of pixels, at least 1")
        if len(parts.gaps(self)):
            raise BadValue("trajectory", "one with gaps", "one without, such as `in_cycles` gives")
        if robot is None:
            try:
                robot = self.load_robot()
            except (SpearError, ValueError) as error:
                raise BadValue(
                    "trajectory.robot", self.robot, f"a robot that can be loaded ({error}); or give it: play(robot)"
                ) from None
        return play_page(robot, self, title, int(height))

    @typed
    def plot(self, *columns: str, cycles: int | None = 3) -> Figure:
        """Plots columns over time, with one panel for each unit and stance shaded; a notebook shows the figure.

        Args:
            columns: names among those of `columns`, or the common beginning of all of a kind: "q", "v", "a", "u",
                "tau", "friction", "spring", "pull", "current", "force_x" or "force_z". By default "q", "spring" if
                there is one, and "force_z". A quadruped in its sagittal plane has torques and forces of a pair of
                legs, which are labelled so.
            cycles: number of cycles drawn, from the first; None for all.

        Raises:
            UnknownName: there is no such column.
            BadValue: the number of cycles is not positive.
        """
        return plot_columns(self, columns, cycles)


PLAIN = ("robot", "coordinates", "actuated", "toes", "spring_joints", "cycles", "reason", "message", "evaluations")
"""The fields that are names, texts and numbers."""
_PARTS = ("events", "ledger", "electrical", "ground", "origin", "springs")
SAMPLED = tuple(f.name for f in fields(Trajectory) if f.name not in (*PLAIN, *_PARTS))
"""The arrays over samples."""
