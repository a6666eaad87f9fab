"""Pinocchio in C++: `hop.cpp`, compiled for this machine into a temporary directory and run as a process of its own.

It needs a C++ compiler, Pinocchio's headers and Boost's, which come with the wheels of `pin`, and Eigen's, which do not
(libeigen3-dev on Debian). It uses the headers only, so that the compiler may optimise across them.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.integrate import DOP853

from benchmarks.peers.task import STATES, Absent, Lane, Task
from spear_pin.arrays import Array

SOURCE = Path(__file__).with_name("hop.cpp")
BOOST = (  # lists as long as its own build has them; a get that may find nothing, as it does for a few joints
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DBOOST_VARIANT_USE_RELAXED_GET_BY_DEFAULT",
)
FLAGS = ("-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-w", *BOOST)
RTOLS = (1e-8, 1e-9)


def headers() -> list[Path]:
    """Directories of the headers of Pinocchio, Boost and Eigen."""
    site = Path(pin.__file__).parents[4]
    places = [site / "include", Path("/usr/include"), Path("/usr/local/include")]
    places += [place / "eigen3" for place in places]
    found = []
    for name in ("pinocchio/fwd.hpp", "boost/version.hpp", "Eigen/Core"):
        place = next((place for place in places if (place / name).is_file()), None)
        if place is None:
            raise Absent(f"the header {name} is nowhere")
        found.append(place)
    return list(dict.fromkeys(found))


def tableau() -> str:
    """SciPy's DOP853 as a header."""

    def rows(name: str, values: Array) -> str:
        values = np.asarray(values, dtype=float)
        shape = "".join(f"[{n}]" for n in values.shape)
        return f"static const double {name}{shape} = {{{', '.join(f'{x:.17g}' for x in values.ravel())}}};\n"

    A = np.zeros((16, 16))
    A[:12, :12], A[13:] = DOP853.A, DOP853.A_EXTRA
    return rows("A", A) + rows("B", DOP853.B) + rows("E3", DOP853.E3) + rows("E5", DOP853.E5) + rows("D", DOP853.D)


@cache
def program() -> tuple[tempfile.TemporaryDirectory[str], Path]:
    """The program, and the directory that goes with it."""
    compiler = next(filter(None, map(shutil.which, ("c++", "g++", "clang++"))), None)
    if compiler is None:
        raise Absent("there is no C++ compiler")
    include = [f"-isystem{place}" for place in headers() if place != Path("/usr/include")]
    folder = tempfile.TemporaryDirectory()
    (Path(folder.name) / "tableau.hpp").write_text(tableau())
    made = Path(folder.name) / "hop"
    command = [compiler, *FLAGS, *include, f"-I{folder.name}", f"-I{SOURCE.parent}", str(SOURCE), "-o", str(made)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        first = next((line for line in done.stderr.splitlines() if "error" in line), "")
        raise Absent(f"it does not compile: {first}")
    return folder, made


def numbers(task: Task, rtol: float) -> list[float]:
    """Robot, law and states, in the order in which the program reads them."""
    system = task.gait.system
    robot, law, spring = system.robot, system.law, system.spring
    given: list[float] = []
    for i, axis in zip((1, 2, 3), (0.0, -1.0, 1.0), strict=True):
        inertia = robot.model.inertias[i]
        given += [axis, *robot.model.jointPlacements[i].translation, inertia.mass, *inertia.lever]
        given += [*np.diag(inertia.inertia), robot.model.armature[i - 1]]
    given += [*robot.model.frames[robot.toe_id("toe")].placement.translation, rtol]
    given += [law.stance_torque, 0.5 * law.knee_touchdown, law.knee_touchdown, law.frequency, law.hip_gain]
    given += [law.hip_damping, law.knee_gain, law.knee_damping, law.hip_stance_torque]
    given += [spring.stiffness, spring.damping, system.contact.friction, STATES]
    return [*given, *np.concatenate([task.q, task.v], axis=1)[:STATES].ravel()]


class Hopper:
    """The program, waiting for the next number of calls."""

    def __init__(self, task: Task, rtol: float) -> None:
        self._folder, made = program()
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self._process = subprocess.Popen([str(made)], text=True, **pipes)
        print(*map(repr, map(float, numbers(task, rtol))), sep="\n", file=self._process.stdin)

    def answer(self, calls: int) -> Array:
        """CPU seconds and end states."""
        print(calls, file=self._process.stdin, flush=True)
        return np.array(self._process.stdout.readline().split(), dtype=float)


def lanes(task: Task) -> list[Lane]:
    """One for each tolerance."""

    def lane(rtol: float) -> Lane:
        hopper = Hopper(task, rtol)
        ends = lambda: hopper.answer(1)[1:].reshape(STATES, 6)  # noqa: E731
        return Lane("Pinocchio in C++", f"DOP853, rtol {rtol:.0e}", ends, clock=lambda n: hopper.answer(n)[0])

    return [lane(rtol) for rtol in RTOLS]
