"""`spear hop`."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_simulation, check_simulation
from spear_pin.cli.endings import ended, lost, notes_of
from spear_pin.cli.legs import add_leg, called, doubted, one_leg, rests_on, stability
from spear_pin.cli.output import aligned, iterations, listed, progress, shows
from spear_pin.errors import BadValue, NoGait, SpearError

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.model.robot import Robot
    from spear_pin.studies.hardware import Rig

SPRING = ("stiffness", "damping", "hardening", "preload")  # options of the spring
RIG = ("current_limit", "bandwidth", "noise", "losses", "seed")  # options of --hardware


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    parser = add_command(commands, "hop", run, "solve a leg's hop in place, simulate it, write page, plots, samples")
    wanted = parser.add_mutually_exclusive_group()
    wanted.add_argument("--flight-time", type=float, metavar="S", help="solve the stance torque for it (default: 0.2)")
    wanted.add_argument("--stance-torque", type=float, metavar="N·m", help="given; solve the fixed point only")
    parser.add_argument("--knee", type=float, default=1.0, metavar="RAD", help="commanded knee angle (default: 1.0)")
    parser.add_argument("--frequency", type=float, metavar="HZ", help="of the square wave (default: 2.56)")
    parser.add_argument("--stiffness", type=float, metavar="N·m/RAD", help="of the knee spring (default: 48.84)")
    parser.add_argument("--damping", type=float, metavar="N·m·S/RAD", help="of the knee, in stance (default: 1.3)")
    parser.add_argument("--hardening", type=float, metavar="N·m/RAD³", help="of the knee spring (default: 0)")
    parser.add_argument("--preload", type=float, metavar="N·m", help="of the knee spring (default: 0)")
    parser.add_argument("--friction", type=float, metavar="MU", help="of the ground (default: 0.8, an assumption)")
    parser.add_argument(
        "--slope", type=float, default=0.0, metavar="RAD", help="of the ground, uphill in +x (default: 0)"
    )
    parser.add_argument(
        "--free-x", action="store_true", help="let the boom slide along x too; solve the hip angle for no drift"
    )
    parser.add_argument("--foot-placement", type=float, default=0.0, metavar="RAD·S/M", help="gain, with --free-x")
    hardware = parser.add_argument_group("hardware, assumed where the source does not say")
    hardware.add_argument(
        "--hardware", action="store_true", help="motors, gears and batteries instead of ideal torques"
    )
    hardware.add_argument("--current-limit", type=float, metavar="A", help="of the amplifiers (default: 10)")
    hardware.add_argument("--bandwidth", type=float, metavar="HZ", help="of the current loops (default: at once)")
    hardware.add_argument("--noise", type=float, metavar="RAD", help="of the angles that the law reads (default: 0)")
    hardware.add_argument("--losses", type=float, metavar="1/S", help="commands lost, for 5 ms each (default: 0)")
    hardware.add_argument("--seed", type=int, metavar="N", help="of noise and losses (default: 0)")
    add_leg(parser)
    parser.add_argument("--save", action="store_true", help="write hop.json too, the gait for Gait.load")
    add_simulation(parser, 11, "hops", "hop.html")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Solve the hop, simulate it and write its files."""
    from dataclasses import replace

    from spear_pin import Ground, HoppingLaw, Spring, hopping, load, simulate
    from spear_pin.cli import hop_round
    from spear_pin.cli.hop_led import led
    from spear_pin.hybrid.parameters import with_hardware
    from spear_pin.model.loading import sidecar_of
    from spear_pin.model.scale import scale_of
    from spear_pin.studies.hop import summarize
    from spear_pin.studies.hop_led import FLIGHT_TIME
    from spear_pin.studies.hop_of_another import hop_of, scaled_hopping
    from spear_pin.studies.joint_limits import plausibility
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened
    from spear_pin.viz.plots import hop_summary, save_figure

    check_simulation(arguments)
    if arguments.robot is not None and sidecar_of(arguments.robot).post is not None:
        return hop_round.run(arguments)
    locked = [] if arguments.free_x else ["boom_x"]
    other = one_leg(arguments, locked)
    robot = other or load("spear_ii", locked=locked)
    law, spring, scale = HoppingLaw(), Spring(), 1.0
    if other is not None:
        usual, scale = scaled_hopping(robot), scale_of(robot).time
        law, spring = usual.law, usual.spring
    given = {name: value for name in ("stance_torque", "frequency") if (value := getattr(arguments, name)) is not None}
    lean = robot.legs[0].lean(arguments.knee) if arguments.free_x or other is not None else None
    law = replace(
        law, knee_touchdown=arguments.knee, hip_touchdown=lean, foot_placement=arguments.foot_placement, **given
    )
    spring = replace(spring, **{name: value for name in SPRING if (value := getattr(arguments, name)) is not None})
    friction = {} if arguments.friction is None else {"friction": arguments.friction}
    rig = _rig(arguments, other)
    if rig is not None and arguments.save:
        raise BadValue("--save", True, "to go without --hardware, which a saved gait does not keep")
    driven = None if rig is None else rig.on(robot)
    if rig is not None and arguments.stance_torque is None:  # what the gears lose is asked for as well
        law = replace(law, stance_torque=law.stance_torque / rig.knee_efficiency)
    system = hopping(robot, law, spring, ground=Ground(slope=arguments.slope, **friction))
    if rig is not None:  # solved with what has no memory, and without noise
        system = with_hardware(system, replace(rig, bandwidth=None, sensing=None).on(robot))
    notes: list[tuple[str, str]] = []
    try:
        if other is not None and arguments.flight_time is None and arguments.stance_torque is None:
            with progress() as show:
                show(f"looking for a hop of {called(robot)}")
                gait = hop_of(
                    system,
                    scale * FLIGHT_TIME,
                    within_limits=True,
                    on_attempt=lambda time, why: notes.append((f"in the air {time:.3g} s", why)),
                )
        else:
            wanted = FLIGHT_TIME if arguments.stance_torque is None else None
            gait = _solved(system, wanted if arguments.flight_time is None else arguments.flight_time, arguments.free_x)
    except NoGait as failure:
        if other is None or rig is not None or arguments.free_x:
            raise _helped(failure) from None
        with progress() as show:
            show("leading from a hop that there is")
            gait = led(arguments, system, failure)
        notes.append(("found", "by leading from a hop with SPEAR-II's numbers, scaled: a search alone finds none"))
    trajectory = simulate(
        with_hardware(gait.system, driven), gait.state, arguments.cycles, arguments.rtol, max_step=arguments.max_step
    )
    end = lost(trajectory, "hop")
    samples = trajectory.save(arguments.out / "hop.npz")
    saved = [gait.save(arguments.out / "hop.json")] if arguments.save else []
    summary = {"lost": end, **summarize(gait, trajectory), **plausibility(gait, trajectory)}
    if robot.cut is not None:
        summary["cut"] = str(robot.cut)
    if trajectory.electrical is not None:
        summary["electrical"] = {flow: trajectory.electrical[flow].mean() for flow in trajectory.electrical.flows}
        summary["peak_current"] = dict(zip(trajectory.actuated, abs(trajectory.current).max(axis=0), strict=True))
    shown = shortened(robot, trajectory)
    page, plots = arguments.out / "hop.html", arguments.out / "hop.svg"
    title = f"{called(robot)} hopping in place"
    pictures: dict[Path, Callable[[Path], object]] = {
        page: lambda path: record(robot, shown, path, title=title, notes=notes_of(summary)),
        plots: lambda path: save_figure(hop_summary(trajectory, gait), path),
    }
    told = [*notes, *rests_on(robot), *doubted(summary["implausible"])]
    files = [page, samples, plots, *saved]
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": pictures,
        "opened": page,
        "text": _text(summary, [*told, *shows(shown), *listed(arguments.out, "hop", files)]),
    }


def _solved(system: HybridSystem, flight_time: float | None, free: bool) -> Gait:
    """The hop with a flight time, or of None with the stance torque as it is."""
    from spear_pin import find_gait

    drift = {"hip_touchdown": ("mean_speed", 0.0)} if free else {}
    solved = drift if flight_time is None else {"stance_torque": ("flight_time", flight_time), **drift}
    target: Any = dict(solved.values())
    with iterations() as tell:
        return find_gait(system, list(solved), target, on_iteration=tell)


def _helped(failure: NoGait) -> SpearError:
    """The failure of a search, with what to try."""
    if failure.remedy:
        return failure
    return SpearError(f"{failure}; nearer to the defaults there is one: change less, or --knee as well")


def _rig(arguments: argparse.Namespace, other: Robot | None) -> Rig | None:
    """Hardware that drives the joints, if it was asked for: SPEAR-II's, or what is known of another robot's."""
    from spear_pin.hybrid.hardware import Sensing
    from spear_pin.model.settings import Settings
    from spear_pin.studies.hardware import Rig

    given: dict[str, Any] = {name: value for name in RIG if (value := getattr(arguments, name)) is not None}
    if not arguments.hardware:
        if given:
            raise BadValue(
                f"--{next(iter(given)).replace('_', '-')}", next(iter(given.values())), "to go with --hardware"
            )
        return None
    if other is not None:
        known = other.settings or Settings("")
        if missing := [joint for joint in other.actuated if joint not in known.motors]:
            expected = f"motors that are known: nothing is known of that of the {missing[0]} of another robot"
            raise BadValue("--hardware", True, f"{expected}; a TOML file beside its own can name it")
        given |= {**known.motors, **{f"{joint}_efficiency": x for joint, x in known.efficiencies.items()}}
    seed = given.pop("seed", 0)
    if seed < 0:
        raise BadValue("--seed", seed, "a whole number >= 0")
    noise, losses = given.pop("noise", 0.0), given.pop("losses", 0.0)
    sensing = Sensing(angle_noise=noise, losses=losses, seed=seed) if noise or losses else None
    return Rig(**given, sensing=sensing)


def _text(summary: dict[str, Any], files: list[tuple[str, str]]) -> str:
    rows = [
        *ended(summary["lost"]),
        ("stance torque", f"{summary['stance_torque']:.4f} N·m"),
        ("commanded hip, knee", f"{summary['hip_touchdown']:.4f}, {summary['knee_touchdown']:.4f} rad"),
        ("flight, stance", f"{summary['flight_time']:.4f} s, {summary['stance_time']:.4f} s"),
        *([("apex of the hip", f"{summary['apex_height']:.4f} m")] if summary["apex_height"] is not None else []),
        ("spring", f"{summary['stiffness']:.4g} N·m/rad in the knee"),
        ("peak ground force", f"{summary['peak_force']:.1f} N"),
        ("spring's share", f"{100 * summary['spring_share']:.1f} % of the push"),
        ("multipliers", ", ".join(f"{value:.4f}" for value in summary["multipliers"])),
        ("", stability(summary["multipliers"], summary["implausible"])),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        *_motors(summary),
        *_electrical(summary),
        ("simulated", f"{summary['cycles']} hops ({summary['reason']}){_touches(summary)}"),
        *files,
    ]
    return aligned(rows)


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
