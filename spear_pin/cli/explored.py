"""Program that a page of `spear explore` saves: it computes the motion that is shown with the public interface."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from spear_pin.cli.legs import write_monopod, write_sagittal
from spear_pin.cli.python_lines import Code, Program

if TYPE_CHECKING:
    from spear_pin.model.robot import Robot
    from spear_pin.studies.explore.carried import Carried
    from spear_pin.studies.explore.motion import Motion

STABILITY = Code('print("multipliers", gait.multipliers, "stable" if gait.stable else "unstable")')
DURATIONS = Code('print("flight {flight:.4f} s, stance {stance:.4f} s".format(**gait.durations))')
UNSOLVED = Code('print(f"{hops.cycles} whole hops; {hops.message}")')
FORCE = Code("""print(f"peak ground force {found['peak_force_' + robot.toes[0]]:.2f} N")""")
TORQUE = Code("""print(f"peak knee torque {found['peak_torque_knee']:.3f} N·m")""")
PERIOD = Code('print(f"period {gait.period:.4f} s", gait.parameters)')


def write_script(motion: Motion) -> str:
    """Write a short program that computes the same motion, prints its figures and plays it."""
    from spear_pin.studies.explore.carried import Carried

    subject, program = motion.knobs.subject, Program()
    if isinstance(subject, Carried):
        title = subject.title
        _carried(program, motion, subject)
    else:
        title = f"{subject.title} in place"
        _hops(program, motion)
    said = textwrap.fill(_plain(motion.message), 110)
    return f'"""{_plain(title)}, with numbers set in `spear explore`.\n\n{said}\n"""\n\n{program}\n'


def _hops(program: Program, motion: Motion) -> None:
    from spear_pin import Ground, find_gait, hopping, simulate
    from spear_pin.gaits.measures.of_samples import Sampled
    from spear_pin.viz.player import record

    system, hops = motion.knobs.system, Code("hops")
    robot = _robot(program, system.robot)
    whole = motion.trajectory.cycles + (not motion.trajectory.complete)  # and the one that was not whole
    own = {} if system.ground == Ground() else {"ground": system.ground}
    program.let("system", program.call(hopping, robot, system.law, system.spring, **own))
    start = _start(program, motion, "just after touchdown: boom_z in m, hip and knee in rad, and their rates")
    if motion.gait is None:
        program.let(hops, program.call(simulate, Code("system"), start, cycles=whole))
        program.do(UNSOLVED)
    else:
        program.let("gait", program.call(find_gait, Code("system"), guess=start))
        program.let(hops, program.call(simulate, Code("gait.system"), Code("gait.state"), cycles=whole))
        program.do(STABILITY)
        program.do(DURATIONS)
    program.let("found", Code(f"{program.call(Sampled, robot, hops, ())}.values()"))
    program.do(FORCE)
    program.do(TORQUE)
    program.do(program.call(record, robot, hops, "hop.html", title=f"{motion.knobs.subject.title} in place"))


def _carried(program: Program, motion: Motion, subject: Carried) -> None:
    from spear_pin import Gait, find_gait, simulate
    from spear_pin.gaits.feedback import without_feedback
    from spear_pin.hybrid.parameters import with_numbers
    from spear_pin.viz.player import record

    values, gait = motion.knobs.values, motion.gait
    assert gait is not None
    begun = program.let("begun", program.call(without_feedback, program.call(Gait.load, subject.source)))
    numbers = {**subject.changed(values), **gait.parameters}
    system = program.let("system", program.call(with_numbers, Code(f"{begun}.system"), numbers))
    start = _start(program, motion, "on the section: m, rad, and their rates")
    vary: Any = [each.parameter for each in subject.kept.values()]
    program.let("gait", program.call(find_gait, system, vary, subject.wanted_of(values), guess=start))
    state, cycles = Code("gait.state"), motion.trajectory.cycles
    played = program.let("motion", program.call(simulate, Code("gait.system"), state, cycles=cycles))
    program.do(STABILITY)
    program.do(PERIOD)
    page = f"{subject.kind}.html"
    program.do(program.call(record, Code("gait.system.robot"), played, page, title=subject.title))


def _start(program: Program, motion: Motion, what: str) -> Code:
    """Write the state at which the motion begins, and return it."""
    program.say(what)
    program.take("numpy", "array")
    for name, part in zip(("q", "v"), motion.start, strict=True):
        program.let(name, Code(f"array({part.tolist()})"))
    return Code("(q, v)")


def _robot(program: Program, robot: Robot) -> Code:
    """Write how a robot was made, and return what it is called."""
    from spear_pin import vary

    cut, locked = robot.cut, list(robot.locked)
    if cut is None:
        named = program.let("robot", _load(program, robot, locked=locked))
    elif cut.kind == "monopod":
        named = write_monopod(program, _load(program, cut.robot), robot, locked, cut.body, sided=True)
    else:
        named = write_sagittal(program, _load(program, cut.robot))
    return program.let("robot", program.call(vary, named, **robot.varied)) if robot.varied else named


def _load(program: Program, robot: Robot, **more: Any) -> Code:
    from spear_pin import load
    from spear_pin.model.loading import ROBOTS

    toes = {} if str(robot.source) in ROBOTS else {"toes": list(robot.toes)}
    return program.call(load, str(robot.source), **robot.options, **toes, **more)


def _plain(words: str) -> str:
    """Words in a form that a docstring may hold; a robot's name comes from a user's file."""
    return " ".join(words.replace("\\", "/").replace('"', "'").split())
