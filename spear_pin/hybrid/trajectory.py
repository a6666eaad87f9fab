"""Result of a simulation: samples, events, the energy ledger; saved, loaded, cut, shown, and made tables of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError, UnknownName, require
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.trajectory_parts import gaps
from spear_pin.kinds import typed
from spear_pin.model.mover import mover
from spear_pin.model.robot import Robot
from spear_pin.printable import printable
from spear_pin.showing import Player, Shown, playing, plotted

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Event:
    """Something that happened at one instant.

    Attributes:
        name: the guard's or switch's name.
        time: in s.
        domain: name of the domain in which it happened.
        q: configuration, (nq,).
        v_before: velocity before, (nv,).
        v: velocity after, (nv,).
        impulse: of the ground on each toe, along the ground and normal to it, in N·s, (ntoes, 2); in space (ntoes, 3).
        work: energy brought into the mechanism at this instant by flow, in J (losses negative).
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
        flows: names of the flows.
        work: energy of each, in J, (cycles, flows).
        change: change of the stored energy (kinetic, gravity, springs), in J, (cycles,).
    """

    flows: tuple[str, ...]
    work: Array
    change: Array

    def __getitem__(self, flow: str) -> Array:
        """Energy of one flow in each cycle, in J, (cycles,).

        Raises:
            UnknownName: there is no such flow.
        """
        if flow not in self.flows:
            raise UnknownName("flow", flow, self.flows)
        column: Array = self.work[:, self.flows.index(flow)]
        return column

    @property
    def residual(self) -> Array:
        """Imbalance of energy in each cycle, in J, (cycles,): change of the stored energy less all flows."""
        left: Array = self.change - self.work.sum(axis=1)
        return left


@dataclass(frozen=True, repr=False)
class Trajectory(Shown):
    """Motion over time; at every sample D a + C v + G = B tau + friction + Σ Jᵀ F, J and F in the ground's axes.

    An event's two sides are two samples. There are at least 100 samples a phase.

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
        engaged: whether each spring is engaged, (n, nsprings); one that never pulls is none.
        current: of each motor, in A, (n, nu); (n, 0) without hardware.
        reference: the current that was asked for, in A, as `current`.
        events: what happened.
        ledger: the energy ledger of whole cycles.
        cycles: number of whole cycles.
        reason: why the run ended; "complete" if it reached the cycles asked for.
        message: the same in a sentence.
        evaluations: number of right-hand sides evaluated.
        electrical: the ledger of what drives the joints, None without hardware: batteries positive, heat, gears
            and motors negative (a motor's work is here what leaves), the change that of the inductances.
        ground: on which it is, along which and normal to which forces and impulses are; None if a file does not say.
        origin: of the robot, see `spear_pin.model.origin`; None if a file does not say.

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

    def __repr__(self) -> str:
        duration = self.t[-1] - self.t[0]
        parts = f"{self.cycles} cycles", f"{duration:.4g} s", f"{len(self)} samples", f"{len(self.events)} events"
        return f"Trajectory({printable(repr(self.robot))}: {', '.join(parts)}, {self.reason})"

    def __len__(self) -> int:
        """Number of samples."""
        return len(self.t)

    @property
    def complete(self) -> bool:
        """Whether all the cycles asked for were run."""
        return self.reason == "complete"

    def named(self, event: str) -> tuple[Event, ...]:
        """The events of one name, in order of time."""
        return tuple(e for e in self.events if e.name == event)

    @typed
    def save(self, path: str | Path) -> Path:
        """Write an npz file: arrays, and one JSON string for the rest; nothing is pickled."""
        from spear_pin.hybrid.trajectory_file import write

        return write(self, path)

    @classmethod
    @typed
    def load(cls, path: str | Path) -> Trajectory:
        """Read what `save` wrote.

        Raises:
            BadFile: it cannot be read, or is not a trajectory: an array is missing, unknown, of another kind or
                shape than its axes' names say, not finite, or out of order.
        """
        from spear_pin.hybrid.trajectory_file import read

        return read(path)

    @typed
    def export(self, path: str | Path) -> Path:
        """Write the samples as CSV or MATLAB file, by the path's suffix.

        A CSV file has the columns of `to_pandas`, time first, each headed by its name and unit: "q_knee [rad]".

        Raises:
            BadValue: the suffix is neither .csv nor .mat.
        """
        from spear_pin.hybrid.trajectory_tables import export

        return export(self, path, SAMPLED)

    def columns(self) -> tuple[list[str], Array]:
        """Names, and values, of everything numeric, one row a sample; `units` has their units."""
        from spear_pin.hybrid.trajectory_tables import columns

        return columns(self)

    def units(self) -> dict[str, str]:
        """Unit of each column by its name; "m or rad" and the like where the robot, which tells, is not found."""
        from spear_pin.hybrid.trajectory_tables import units

        return units(self)

    def to_pandas(self) -> Any:
        """The samples as a `pandas.DataFrame`, indexed by time: the `columns`, domain, phase and engaged springs.

        Its `attrs["units"]` has the unit of each column.
        """
        from spear_pin.hybrid.trajectory_tables import frame

        return frame(self)

    def to_xarray(self) -> Any:
        """The samples as an `xarray.Dataset` over time, coordinates, motors, toes and springs, with their units.

        Raises:
            MissingExtra: xarray is not installed.
        """
        from spear_pin.hybrid.trajectory_tables import dataset

        return dataset(self)

    @typed
    def in_cycles(self, first: int, last: int | None = None) -> Trajectory:
        """A part: the cycles from the first to the last, both in it, with their events and their rows of the ledger.

        Args:
            first: number of the first, as in `cycle`: 1 is the first whole one.
            last: number of the last; None: there is no other.

        Raises:
            BadValue: there are no such cycles.
        """
        from spear_pin.hybrid.trajectory_parts import cycles

        return cycles(self, first, first if last is None else last)

    @typed
    def in_phase(self, name: str) -> Trajectory:
        """A part: the samples and events of a phase, wherever it recurs; its ledger has no rows.

        Raises:
            UnknownName: there is no such phase.
        """
        from spear_pin.hybrid.trajectory_parts import phase

        return phase(self, name)

    @typed
    def load_robot(self, source: str | None = None) -> Robot:
        """The robot that moved, loaded again.

        Args:
            source: its name or path, where its own is not found; of what was cut out of a robot, that robot's.

        Raises:
            SpearError: there is no such robot, or it is not this one's.
        """
        return mover(self.origin, self.robot, self.coordinates, self.toes, source)

    @typed
    def play(self, robot: Robot | None = None, *, title: str = "", height: int = 480) -> Player:
        """The motion as a notebook plays it in place; of a long one the end, as much as 2 MB hold.

        Args:
            robot: that moved; by default it is loaded again, which needs its file.
            title: shown above; by default the robot's name.
            height: of the frame, in pixels.

        Raises:
            BadValue: there are gaps in it, its robot is not found, or the height is not positive.
        """
        require("height", height, lambda pixels: pixels >= 1, "a whole number of pixels, at least 1")
        if len(gaps(self)):
            raise BadValue("trajectory", "one with gaps", "one without, such as `in_cycles` gives")
        if robot is None:
            try:
                robot = self.load_robot()
            except (SpearError, ValueError) as error:
                raise BadValue(
                    "trajectory.robot", self.robot, f"a robot that is found ({error}); or play(robot)"
                ) from None
        return playing(robot, self, title, int(height))

    @typed
    def plot(self, *columns: str, cycles: int | None = 3) -> Figure:
        """Columns over time, those of the same unit in one panel, stance shaded; a notebook shows the figure.

        Args:
            columns: names among those of `columns`, or what all of a kind begin with: "q", "v", "a", "u", "tau",
                "friction", "spring", "current", "reference", "force_x" or "force_z". By default "q", "spring" where
                there is one, and "force_z". Of a quadruped in its sagittal plane torques and forces are of a pair, and
                labelled so.
            cycles: how many are drawn, from the first; None: all there is.

        Raises:
            UnknownName: there is no such column.
            BadValue: the number of cycles is not positive.
        """
        return plotted(self, columns, cycles)


_REST = ("robot", "coordinates", "actuated", "toes", "spring_joints", "cycles", "reason", "message", "evaluations")
_PARTS = ("events", "ledger", "electrical", "ground", "origin")
SAMPLED = tuple(f.name for f in fields(Trajectory) if f.name not in (*_REST, *_PARTS))
"""The arrays over samples."""
