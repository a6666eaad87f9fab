"""Figures of motions for display while their numbers change, and a program that computes them again."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import TypeVar

from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.measures.catalogue import SHOWN, added
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.model.loading import ROBOTS
from spear_pin.model.robot import Robot
from spear_pin.studies.bound import summarize
from spear_pin.studies.explore.carried import Carried
from spear_pin.studies.explore.legs import RATIO
from spear_pin.studies.explore.motion import Motion
from spear_pin.studies.hop import durations, spring_share

T = TypeVar("T")


def figures(motion: Motion) -> dict[str, float | None]:
    """Returns figures of a motion, SI units; None where there is none. See the functions of each kind."""
    of_any = gait_figures(motion) if added() else {}
    return FIGURES[motion.knobs.subject.kind](motion) | {each.kind: of_any[each.kind] for each in added()}


def gait_figures(motion: Motion) -> dict[str, float | None]:
    """Returns measures of a cycle by their names; of joints and toes the largest."""
    system, cycles = motion.knobs.system, range(1, motion.trajectory.cycles + 1)
    found = Sampled(system.robot, motion.trajectory, cycles, halves=bool(system.mirrored_toes)).values()
    kinds = [*SHOWN, *(each.kind for each in added())]
    return {name: max(of_kind(found, name).values(), default=None) for name in kinds}


def of_kind(found: Mapping[str, T], kind: str) -> dict[str, T]:
    """Returns the measure of a name, or those of the name with a joint or a toe behind it."""
    own = {name: each for name, each in found.items() if name == kind}
    return own or {name: each for name, each in found.items() if name.startswith(f"{kind}_")}


def bound_figures(motion: Motion) -> dict[str, float | None]:
    """Returns figures of a stride.

    Returns:
        speed, stride and period; peak_force, normal, of a pair; friction_used; of one motor each
        peak_torque_stance_knee and peak_torque_stance_hip; peak_speed_knee; impact_loss, a stride; cost_of_transport;
        posterior_hip_torque, β_sp; of legs the largest; see `spear_pin.studies.bound`.
    """
    assert motion.gait is not None
    told = summarize(motion.gait, motion.trajectory)

    def most(key: str, part: str) -> float:
        return max(float(told[key][f"{leg}_{part}"]) for leg in LEGS)

    return {
        "speed": told["speed"],
        "stride": told["stride"],
        "period": told["period"],
        "peak_force": max(told["peak_force"].values()),
        "friction_used": told["friction_used"],
        "peak_torque_stance_knee": most("peak_torque_stance", "knee"),
        "peak_torque_stance_hip": most("peak_torque_stance", "hip"),
        "peak_speed_knee": most("peak_speed", "knee"),
        "impact_loss": told["impact_loss"],
        "cost_of_transport": told["cost_of_transport"],
        "posterior_hip_torque": motion.gait.system.law.posterior_hip_torque,
    }


def hop_figures(hops: Motion) -> dict[str, float | None]:
    """Returns figures of hops, SI units; None where there is no such figure.

    Returns:
        apex_height, of the hip above the ground, the highest; flight_time and stance_time, the longest of a whole hop;
        peak_force, normal; peak_torque_knee and peak_power_knee of the knee's motor at the joint, by their amount;
        rotor_torque_knee, the peak torque before an ideal gear; positive_work, of both motors, a hop; spring_share,
        see `spring_share`.
    """
    trajectory, robot = hops.trajectory, hops.knobs.system.robot
    whole, sampled = trajectory.cycles > 0, Sampled(robot, trajectory, ())
    apexes = [float(event.q[trajectory.coordinates.index("boom_z")]) for event in trajectory.named("apex")]
    stance, flight = durations(trajectory).max(axis=0).tolist() if whole else (None, None)
    peak_torque = sampled.of("peak_torque")["knee"]
    return {
        "apex_height": max(apexes, default=None),
        "flight_time": flight,
        "stance_time": stance,
        "peak_force": sampled.largest("peak_force"),
        "peak_torque_knee": peak_torque,
        "rotor_torque_knee": peak_torque / hops.knobs.values[RATIO] if RATIO in hops.knobs.values else None,
        "peak_power_knee": sampled.amount(sampled.torques["knee"] * sampled.speeds["knee"]),
        "positive_work": Sampled(robot, trajectory, range(1, trajectory.cycles + 1)).positive_work if whole else None,
        "spring_share": spring_share(trajectory) if whole else None,
    }


def script(motion: Motion) -> str:
    """Writes a short Python program that computes the same motion with the public interface, prints and plays it."""
    subject = motion.knobs.subject
    return _carried_script(motion, subject) if isinstance(subject, Carried) else _hop_script(motion)


def _hop_script(hops: Motion) -> str:
    (q, v), system = hops.start, hops.knobs.system
    if hops.gait is None:
        imported, compute, report = "", f"hops = simulate(system, (q, v), cycles={_asked(hops)})", UNSOLVED
    else:
        imported, compute, report = "find_gait, ", SOLVE.format(cycles=_asked(hops)), SOLVED
    loading, needed = _loading(system.robot)
    return PROGRAM.format(
        title=_said(hops.knobs.subject.title),
        shown=repr(f"{hops.knobs.subject.title} in place"),
        message=textwrap.fill(_said(hops.message), 110),
        standard="from dataclasses import replace\n\n" if "replace(" in loading else "",
        imported=imported + needed,
        loading=loading,
        law=_code(system.law),
        spring=_code(system.spring),
        contact=f"Contact(friction={system.contact.friction})",
        q=q.tolist(),
        v=v.tolist(),
        compute=compute,
        report=report,
    )


def _carried_script(motion: Motion, subject: Carried) -> str:
    (q, v), values = motion.start, motion.knobs.values
    assert motion.gait is not None
    return CARRIED_PROGRAM.format(
        title=_said(subject.title),
        shown=repr(subject.title),
        message=textwrap.fill(_said(motion.message), 110),
        source=subject.source,
        numbers={**subject.changed(values), **motion.gait.parameters},
        cycles=motion.trajectory.cycles,
        vary=[each.parameter for each in subject.kept.values()],
        target=subject.wanted_of(values),
        page=f"{subject.kind}.html",
        q=q.tolist(),
        v=v.tolist(),
    )


def _said(words: str) -> str:
    """Returns words in a form that a docstring may hold; a robot's name comes from a user's file."""
    return " ".join(words.replace("\\", "/").replace('"', "'").split())


def _code(part: object) -> str:
    """Returns a law or a spring in Python's notation, without fields that have their defaults."""
    kind = type(part)
    usual = {name: field.default for name, field in kind.__dataclass_fields__.items()}  # type: ignore[attr-defined]
    told = [f"{name}={value!r}" for name, value in asdict(part).items() if value != usual[name]]  # type: ignore[call-overload]
    return f"{kind.__name__}({', '.join(told)})"


def _loading(robot: Robot) -> tuple[str, str]:
    """Returns the lines that make a robot, and the names that they import besides `load` and `vary`."""
    varied = ", ".join(f"{name}={value!r}" for name, value in robot.varied.items())
    cut = robot.cut
    if cut is None:
        options = {"locked": list(robot.locked)} if robot.locked else {}
        made, needed = _loaded(robot, options), ""
    elif cut.kind == "monopod":
        body, locked = cut.body, list(robot.locked)
        leg = cut.legs[0][0]
        made = (
            f"whole = {_loaded(cut.robot)}\n"
            f"leg = next(leg for leg in whole.legs if leg.name == {leg.name!r})\n"
            f"robot = monopod(whole, replace(leg, side={leg.side}), {body!r}, {locked!r})"
        )
        needed = "monopod, "
    else:
        made, needed = f"robot = sagittal({_loaded(cut.robot)})", "sagittal, "
    lines = made if made.startswith(("whole", "robot")) else f"robot = {made}"
    return f"{lines}\nrobot = vary(robot, {varied})" if varied else lines, needed


def _loaded(robot: Robot, more: Mapping[str, object] | None = None) -> str:
    toes = {} if str(robot.source) in ROBOTS else {"toes": robot.toes}
    said = {**robot.options, **toes, **(more or {})}
    named = "".join(f", {name}={list(x) if isinstance(x, tuple) else x!r}" for name, x in said.items())
    return f"load({str(robot.source)!r}{named})"


def _asked(hops: Motion) -> int:
    """Returns the number of hops to simulate: the whole ones, and the one that was not whole."""
    return hops.trajectory.cycles + (not hops.trajectory.complete)


PROGRAM = '''"""{title} in place, with numbers set in `spear explore`.

{message}
"""

{standard}import numpy as np

from spear_pin import Contact, HoppingLaw, Spring, {imported}hopping, load, simulate, vary
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.viz.player import record

{loading}
law = {law}
system = hopping(robot, law, {spring}, {contact})

# just after touchdown: boom_z in m, hip and knee in rad, and their rates
q = np.array({q})
v = np.array({v})
{compute}

{report}
found = Sampled(robot, hops, ()).values()
print(f"peak ground force {{found['peak_force_' + robot.toes[0]]:.2f}} N")
print(f"peak knee torque {{found['peak_torque_knee']:.3f}} N·m")
record(robot, hops, "hop.html", title={shown})
'''
SOLVE = "gait = find_gait(system, guess=(q, v))\nhops = simulate(gait.system, gait.state, cycles={cycles})"
SOLVED = """print("multipliers", gait.multipliers, "stable" if gait.stable else "unstable")
print("flight {flight:.4f} s, stance {stance:.4f} s".format(**gait.durations))"""
UNSOLVED = 'print(f"{hops.cycles} whole hops; {hops.message}")'
CARRIED_PROGRAM = '''"""{title}, with numbers set in `spear explore`.

{message}
"""

import numpy as np

from spear_pin import Gait, find_gait, simulate
from spear_pin.gaits.feedback import without_feedback
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.viz.player import record

begun = without_feedback(Gait.load({source!r}))
system = with_numbers(begun.system, {numbers})

# on the section: m, rad, and their rates
q = np.array({q})
v = np.array({v})
gait = find_gait(system, {vary}, {target}, guess=(q, v))
motion = simulate(gait.system, gait.state, cycles={cycles})

print("multipliers", gait.multipliers, "stable" if gait.stable else "unstable")
print(f"period {{gait.period:.4f}} s", gait.parameters)
record(gait.system.robot, motion, {page!r}, title={shown})
'''
FIGURES: Mapping[str, Callable[[Motion], dict[str, float | None]]] = {
    "hop": hop_figures,
    "bound": bound_figures,
    "gait": gait_figures,
}
