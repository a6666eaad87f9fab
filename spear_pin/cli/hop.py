"""`spear hop`."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_options, add_seed, add_simulation, check_simulation
from spear_pin.cli.given import given, refuse
from spear_pin.cli.legs import add_leg, name_robot, one_leg, rests_on, stability, write_leg
from spear_pin.cli.output import iterations, progress
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import Rows, play, write_motion
from spear_pin.errors import BadValue, NoGait, SpearError

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.model.robot import Robot
    from spear_pin.studies.hardware import Rig

SPRING = ("stiffness", "damping", "hardening", "preload")  # options of the spring
RIG = ("current_limit", "bandwidth", "noise", "losses", "seed")  # options of --hardware
OTHERS = (  # options that a hop round a post does not have
    *("flight_time", "stance_torque", "knee", "frequency", *SPRING, "switch_delay", "tooth", "slope", "free_x"),
    *("foot_placement", "hardware", *RIG, "leg", "bends", "body"),
)


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear hop --stiffness 55 --open",
        "find SPEAR-II's hop with a stiffer spring, print its multipliers and whether it is stable, and play it",
    )
    parser = add_command(commands, "hop", run, "find and simulate a leg's hop in place, print its multipliers", example)
    wanted = parser.add_mutually_exclusive_group()
    add_options(
        wanted,
        float,
        flight_time=("S", None, "flight time for which the stance torque is solved (default: 0.2)"),
        stance_torque=("N·m", None, "knee torque in stance, instead of a flight time"),
    )
    add_options(
        parser,
        float,
        knee=("RAD", None, "commanded knee angle at touchdown (default: 1.0)"),
        frequency=("HZ", None, "frequency of the torque in stance (default: 2.56)"),
        stiffness=("N·m/rad", None, "stiffness of the spring (default: 48.84)"),
        damping=("N·m·s/rad", None, "knee damping in stance (default: 1.3)"),
        hardening=("N·m/rad³", None, "hardening of the spring (default: 0)"),
        preload=("N·m", None, "preload of the spring (default: 0)"),
        switch_delay=("S", None, "delay with which the spring is engaged and released (default: 0)"),
        tooth=("RAD", None, "pitch of the teeth in which the switch can engage (default: none)"),
        friction=("MU", None, "friction of the ground (default: 0.8, an assumption)"),
        slope=("RAD", None, "slope of the ground, uphill in +x (default: 0)"),
    )
    parser.add_argument(
        "--free-x", action="store_true", help="let the boom slide along x, and solve the hip angle for no drift"
    )
    add_options(parser, float, foot_placement=("RAD·S/M", None, "gain of foot placement; needs --free-x"))
    hardware = parser.add_argument_group("hardware", "numbers that the thesis does not print are assumptions")
    hardware.add_argument("--hardware", action="store_true", help="simulate motors, gears and batteries")
    add_options(
        hardware,
        float,
        current_limit=("A", None, "limit of the amplifiers (default: 10)"),
        bandwidth=("HZ", None, "bandwidth of the current loops (default: none)"),
        noise=("RAD", None, "noise of the measured angles (default: 0)"),
        losses=("1/S", None, "lost commands per second, 5 ms each (default: 0)"),
    )
    add_seed(hardware, "noise and losses", None)
    add_leg(parser, "one of its legs hops, with SPEAR-II's defaults scaled to it")
    parser.output.add_argument("--save", action="store_true", help="write the gait to hop.json too, for Gait.load")
    add_simulation(parser, 11, "hops", "hop.html, hop.svg and hop.npz", "hop.html")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Solve the hop, simulate it and write its files."""
    from dataclasses import replace
    from functools import partial

    from spear_pin import load
    from spear_pin.cli import hop_round
    from spear_pin.hybrid.parameters import with_hardware
    from spear_pin.model.loading import sidecar_of
    from spear_pin.studies.hop import summarize
    from spear_pin.studies.hop_of_another import scaled_hopping
    from spear_pin.viz.plots import hop_summary

    check_simulation(arguments)
    if arguments.robot is not None and sidecar_of(arguments.robot).post is not None:
        refuse(arguments, "to be left out: a robot that goes round a post has its own law and spring", *OTHERS)
        return hop_round.run(arguments)
    if not arguments.free_x:
        refuse(arguments, "only with --free-x", "foot_placement")
    locked = [] if arguments.free_x else ["boom_x"]
    other = one_leg(arguments, locked)
    if other is not None and other.reach is not None:
        refuse(arguments, "to be left out for a robot whose file has [reach]", "free_x", "hardware")
    robot = other or load("spear_ii", locked=locked)
    rig = _rig(arguments, other)
    if rig is not None and arguments.save:
        raise BadValue("--save", True, "to be left out with --hardware, which a saved gait does not keep")
    usual = None if other is None else scaled_hopping(other)
    system = _system(arguments, robot, usual, rig)
    program = Program()
    named = _write_system(program, write_leg(program, arguments, robot, locked), system, usual)
    driven = None if rig is None else rig.on(robot)
    played = None
    if rig is not None:  # solved with what has no memory, and without noise
        ideal = replace(rig, bandwidth=None, sensing=None)
        system = with_hardware(system, ideal.on(robot))
        written = program.let("rig", rig)
        on_robot = program.method(program.change(written, rig, ideal), "on", Code("robot"))
        named = program.let("system", program.call(with_hardware, named, on_robot))
        played = program.call(with_hardware, Code("gait.system"), program.method(written, "on", Code("robot")))
    gait, notes = _found(arguments, program, named, system, other, rig)
    real = None if played is None else (with_hardware(gait.system, driven), played)
    trajectory, end = play(arguments, program, gait, "hop", system=real)
    figures = summarize(gait, trajectory)
    if trajectory.electrical is not None:
        figures["electrical"] = {flow: trajectory.electrical[flow].mean() for flow in trajectory.electrical.flows}
        figures["peak_current"] = dict(zip(trajectory.actuated, abs(trajectory.current).max(axis=0), strict=True))
    title, told, plot = (
        f"{name_robot(robot)} hopping in place",
        [*notes, *rests_on(robot)],
        partial(hop_summary, gait=gait),
    )
    return write_motion(
        arguments, "hop", gait, trajectory, end, figures, _rows, title=title, program=program, told=told, plot=plot
    )


def _system(arguments: argparse.Namespace, robot: Robot, usual: HybridSystem | None, rig: Rig | None) -> HybridSystem:
    """The hop that the options ask for, without hardware."""
    from dataclasses import replace

    from spear_pin import Clutch, Ground, HoppingLaw, Spring, hopping
    from spear_pin.model.clutch import DELAYS, JOINT

    law, springs = (HoppingLaw(), {"knee": Spring()}) if usual is None else (usual.law, usual.springs)
    first, spring = next(iter(springs.items()))
    if spring.path is not None:
        refuse(arguments, f"to be left out: the file gives the spring {first!r}, which is on a path", *SPRING)
    own = given(arguments, "stance_torque", "frequency", "foot_placement")
    knee = law.knee_touchdown if arguments.knee is None else arguments.knee
    turned = robot.reach is None and (arguments.free_x or usual is not None)
    lean = robot.legs[0].lean(knee) if turned else law.hip_touchdown
    law = replace(law, knee_touchdown=knee, hip_touchdown=lean, **own)
    if rig is not None and arguments.stance_torque is None:  # what the gears lose is asked for as well
        law = replace(law, stance_torque=law.stance_torque / rig.knee_efficiency)
    spring = replace(spring, **given(arguments, *SPRING))
    late = {} if arguments.switch_delay is None else dict.fromkeys(DELAYS, arguments.switch_delay)
    late |= {} if arguments.tooth is None else {"pitch": arguments.tooth}
    if any(late.values()):
        spring = replace(spring, clutch=replace(spring.clutch or Clutch(damper=JOINT), **late))
    ground = Ground(**given(arguments, "slope", "friction"))
    return hopping(robot, law, {**springs, first: spring}, ground=ground)


def _write_system(program: Program, robot: Code, system: HybridSystem, usual: HybridSystem | None) -> Code:
    """Write how a hop is made: from the law and the spring that it has by default, what differs."""
    from spear_pin import Ground, HoppingLaw, Spring, hopping
    from spear_pin.studies.hop_of_another import scaled_hopping

    law, ground = system.law, system.ground
    spring = system.spring if [*system.springs] == ["knee"] else system.springs
    named: dict[str, object] = {} if ground == Ground() else {"ground": ground}
    if usual is None:
        parts = (("law", law, HoppingLaw()), ("spring", spring, Spring()))
        named = {name: value for name, value, usual_one in parts if value != usual_one} | named
        return program.let("system", program.call(hopping, robot, **named))
    own = program.let("usual", program.call(scaled_hopping, robot))
    if (law, system.springs) == (usual.law, usual.springs) and not named:
        return own
    changed = [program.change(Code(f"{own}.law"), usual.law, law)]
    first = program.change(Code(f"{own}.spring"), usual.spring, system.spring)
    if len(usual.springs) == 1:
        changed.append(first)
    else:
        name = next(iter(usual.springs))
        others = f"{own}.springs"
        changed.append(Code(others if usual.spring == system.spring else f'{{**{others}, "{name}": {first}}}'))
    return program.let("system", program.call(hopping, robot, *changed, **named))


def _found(
    arguments: argparse.Namespace,
    program: Program,
    named: Code,
    system: HybridSystem,
    other: Robot | None,
    rig: Rig | None,
) -> tuple[Gait, list[tuple[str, str]]]:
    """Find the hop, and say how, in words and in Python."""
    from spear_pin import find_gait
    from spear_pin.cli.hop_led import continue_hop
    from spear_pin.gaits.proportions import FLIGHT_TIME, usual_flight
    from spear_pin.studies.hop_led import lead_hop
    from spear_pin.studies.hop_of_another import hop_of

    notes: list[tuple[str, str]] = []
    try:
        if other is not None and arguments.flight_time is None and arguments.stance_torque is None:
            wanted = usual_flight(other)
            with progress() as show:
                show(f"looking for a hop of {name_robot(other)}")
                gait = hop_of(
                    system,
                    wanted,
                    within_limits=True,
                    on_attempt=lambda time, why: notes.append((f"in the air {time:.3g} s", why)),
                )
            program.let("gait", program.call(hop_of, named, wanted, within_limits=True))
            return gait, notes
        flight_time = FLIGHT_TIME if arguments.flight_time is None else arguments.flight_time
        solved = {"stance_torque": ("flight_time", flight_time)} if arguments.stance_torque is None else {}
        solved |= {"hip_touchdown": ("mean_speed", 0.0)} if arguments.free_x else {}
        target: Any = dict(solved.values())
        with iterations() as tell:
            gait = find_gait(system, list(solved), target, on_iteration=tell)
        program.let("gait", program.call(find_gait, named, vary=list(solved), target=target or None))
        return gait, notes
    except NoGait as failure:
        if other is None or rig is not None or arguments.free_x:
            raise _helped(failure) from None
        with progress() as show:
            show("continuing from a hop with other numbers")
            gait = continue_hop(arguments, system, failure)
    kept = given(arguments, "flight_time", "stance_torque")
    program.let("gait", Code(f"{program.call(lead_hop, named, kept)}.gait"))
    notes.append(("found", "by continuation from a hop with SPEAR-II's numbers, scaled: a search alone finds none"))
    return gait, notes


def _helped(failure: NoGait) -> SpearError:
    """The failure of a search, with what to try."""
    if failure.remedy:
        return failure
    return SpearError(f"{failure}; there are hops nearer to the defaults: change less, or change --knee too")


def _rig(arguments: argparse.Namespace, other: Robot | None) -> Rig | None:
    """Hardware that drives the joints, if it was asked for: SPEAR-II's, or what is known of another robot's."""
    from spear_pin.hybrid.hardware import Sensing
    from spear_pin.studies.hardware import Rig

    if not arguments.hardware:
        refuse(arguments, "only with --hardware", *RIG)
        return None
    options = given(arguments, *RIG)
    if other is not None:
        known = other.settings
        if missing := [joint for joint in other.actuated if joint not in known.motors]:
            expected = (
                f"a robot with known motors: name that of its {missing[0]} in a TOML file next to the robot's file"
            )
            raise BadValue("--hardware", True, expected)
        options |= {**known.motors, **{f"{joint}_efficiency": x for joint, x in known.efficiencies.items()}}
    seed = options.pop("seed", 0)
    if seed < 0:
        raise BadValue("--seed", seed, "a whole number >= 0")
    noise, losses = options.pop("noise", 0.0), options.pop("losses", 0.0)
    sensing = Sensing(angle_noise=noise, losses=losses, seed=seed) if noise or losses else None
    return Rig(**options, sensing=sensing)


def _rows(summary: dict[str, Any]) -> Rows:
    return [
        ("stance torque", f"{summary['stance_torque']:.4f} N·m"),
        ("commanded hip, knee", f"{summary['hip_touchdown']:.4f}, {summary['knee_touchdown']:.4f} rad"),
        ("flight, stance", f"{summary['flight_time']:.4f} s, {summary['stance_time']:.4f} s"),
        *([("apex of the hip", f"{summary['apex_height']:.4f} m")] if summary["apex_height"] is not None else []),
        *(("" if i else "spring", text) for i, text in enumerate(summary["springs"].values())),
        ("peak ground force", f"{summary['peak_force']:.1f} N"),
        *_share(summary["spring_share"]),
        ("multipliers", ", ".join(f"{value:.4f}" for value in summary["multipliers"])),
        ("", stability(summary["multipliers"], summary["implausible"])),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        *_motors(summary),
        *_electrical(summary),
        ("simulated", f"{summary['cycles']} hops ({summary['reason']}){_touches(summary)}"),
    ]


def _share(share: float | None) -> Rows:
    return [] if share is None else [("spring's share", f"{100 * share:.1f} % of the push")]


def _touches(summary: dict[str, Any]) -> str:
    """Re-touches beside the hops, in words."""
    again = summary["retouches"]
    return f", beside them {again} re-touch{'es' if again > 1 else ''}" if again else ""


def _motors(summary: dict[str, Any]) -> list[tuple[str, str]]:
    work = {flow.removeprefix("motor_"): e for flow, e in summary["energy_flows"].items() if flow.startswith("motor_")}
    parts = ", ".join(f"{joint} {energy:.2f} J" for joint, energy in work.items())
    return [
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a hop"),
        ("motors' work, net", f"{sum(work.values()):.2f} J a hop: {parts}"),
    ]


def _electrical(summary: dict[str, Any]) -> list[tuple[str, str]]:
    if "electrical" not in summary:
        return []
    totals = {"battery": 0.0, "joule": 0.0, "gearbox": 0.0}
    for flow, energy in summary["electrical"].items():
        if (kind := flow.partition("_")[0]) in totals:
            totals[kind] += energy
    peaks = ", ".join(f"{joint} {current:.2f} A" for joint, current in summary["peak_current"].items())
    heat = f"{-totals['joule']:.2f} J heat, {-totals['gearbox']:.2f} J gears"
    return [("battery, net", f"{totals['battery']:.2f} J a hop: {heat}"), ("peak currents", peaks)]
