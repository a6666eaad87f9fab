"""The command line: `spear robots | dynamics | hop | bound | search | doctor`. Imports stand inside the commands."""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from spear_pin.errors import BadValue, SpearError

if TYPE_CHECKING:
    from spear_pin.gaits.collocation import Solution
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.request import Request
    from spear_pin.model.motor import Drive
    from spear_pin.model.robot import Robot


BOUND = "long_stride"  # the bounding gait that is shown unless another is asked for
SEARCH = "least_effort"  # the one that is searched for
FREE = math.inf  # what an option says for "free": the search chooses
SAME = 1e-5  # between fixed points that are one
MOTORS = 2  # of a joint of the quadruped in the plane, whose legs are pairs
KNEE_EFFICIENCY = 0.83  # of the knee's gearbox, a two-stage GP 52 C
RATIO, BUS = 15.0, 48.0  # of the knee's gearbox; in V
SPEED_SUFFIX = r"_(\d+(?:\.\d+)?)$"  # of a gait's name: in m/s


class Parser(argparse.ArgumentParser):
    """Errors take one line."""

    def error(self, message: str) -> NoReturn:
        """Exit with status 2."""
        print(f"{self.prog}: {message} (see {self.prog} --help)", file=sys.stderr)
        raise SystemExit(2)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0, or 2 with one line on stderr."""
    words = sys.argv[1:] if argv is None else argv
    # argparse takes "-1e-3" for an option, unless something stands before the sign
    arguments = _parser().parse_args([f" {word}" if _is_number(word) else word for word in words])
    try:
        result: dict[str, Any] = arguments.run(arguments)
    except (SpearError, OSError) as error:
        print(f"spear: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("spear: interrupted", file=sys.stderr)
        return 2
    status = 2 if result.pop("failed", False) else 0
    try:
        if arguments.json:
            result.pop("text", None)
            print(json.dumps(_plain(result), allow_nan=False))
        else:
            print(result["text"])
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough
        sys.stderr.close()
    return status


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _parser() -> Parser:
    parser = Parser(
        prog="spear", description="Switchable parallel elastic legs: dynamics and gaits of SPEAR-II and Q-SPEAR."
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=Parser)

    def add(name: str, run: Any, summary: str) -> argparse.ArgumentParser:
        command = commands.add_parser(name, help=summary, description=summary)
        command.add_argument("--json", action="store_true", help="print one JSON object")
        command.set_defaults(run=run)
        return command

    add("robots", _robots, "list the robots that ship")

    dynamics = add("dynamics", _dynamics, "print D, C, G, J and J̇v of a robot at a state")
    dynamics.add_argument("robot", help="a robot's name, or the path of a URDF")
    dynamics.add_argument("--q", type=float, nargs="+", metavar="RAD", help="configuration (default: zero)")
    dynamics.add_argument("--v", type=float, nargs="+", metavar="RAD/S", help="velocity (default: zero)")
    dynamics.add_argument("--lock", nargs="+", default=[], metavar="JOINT", help="joints held at zero")
    dynamics.add_argument("--toes", nargs="+", metavar="FRAME", help="toe frames of a URDF")

    hop = add("hop", _hop, "solve SPEAR-II's hop in place, simulate it, write hop.html and hop.npz")
    wanted = hop.add_mutually_exclusive_group()
    wanted.add_argument("--flight-time", type=float, metavar="S", help="solve the stance torque for it (default: 0.2)")
    wanted.add_argument("--stance-torque", type=float, metavar="N·m", help="given; solve the fixed point only")
    hop.add_argument("--knee", type=float, default=1.0, metavar="RAD", help="commanded knee angle (default: 1.0)")
    hop.add_argument("--frequency", type=float, default=2.56, metavar="HZ", help="of the square wave (default: 2.56)")
    hop.add_argument("--stiffness", type=float, metavar="N·m/RAD", help="of the knee spring (default: 48.84)")
    hop.add_argument("--friction", type=float, metavar="MU", help="of the ground (default: 0.8, an assumption)")
    hop.add_argument(
        "--free-x", action="store_true", help="let the boom slide along x too; solve the hip angle for no drift"
    )
    hop.add_argument("--foot-placement", type=float, default=0.0, metavar="RAD·S/M", help="gain, with --free-x")
    hop.add_argument("--cycles", type=int, default=11, metavar="N", help="hops to simulate (default: 11)")
    hop.add_argument("--rtol", type=float, default=1e-9, help="relative tolerance (default: 1e-9)")
    hop.add_argument("--out", type=Path, default=Path(), metavar="DIR", help="folder for the files (default: here)")
    hop.add_argument("--open", action="store_true", help="open hop.html in the browser")

    bound = add("bound", _bound, "simulate a bounding gait of Q-SPEAR, write bound.html and bound.npz")
    bound.add_argument(
        "--gait", default=BOUND, metavar="NAME|PATH", help=f"a shipped gait, or a saved one (default: {BOUND})"
    )
    bound.add_argument("--speed", type=float, metavar="M/S", help="continue the gait to this mean speed")
    bound.add_argument("--cycles", type=int, default=5, metavar="N", help="strides to simulate (default: 5)")
    bound.add_argument("--rtol", type=float, default=1e-9, help="relative tolerance (default: 1e-9)")
    bound.add_argument("--out", type=Path, default=Path(), metavar="DIR", help="folder for the files (default: here)")
    bound.add_argument("--open", action="store_true", help="open bound.html in the browser")
    bound.add_argument("--list", action="store_true", help="list the bounding gaits that ship, and do nothing else")

    _add_search(add("search", _search, "search a bounding gait of Q-SPEAR from cold, write gait.json (needs casadi)"))
    add("doctor", _doctor, "show what is installed, and whether it works")
    return parser


def _add_search(search: argparse.ArgumentParser) -> None:
    search.add_argument(
        "gait",
        nargs="?",
        default=SEARCH,
        help=f"a shipped gait: what was asked of it is asked again (default: {SEARCH})",
    )
    search.add_argument("--speed", type=float, metavar="M/S", help="mean forward speed")
    search.add_argument(
        "--objective", metavar="NAME", help="what is minimised: effort, hip, cot, peak, electrical or violation"
    )
    search.add_argument("--lift-off", metavar="RULE", help="knee (back at 40°) or force (zero)")
    search.add_argument(
        "--friction", type=float, metavar="MU", help="that the gait may use; the ground has 0.8, or this if it is more"
    )
    search.add_argument("--clearance", type=float, metavar="M", help="of the other toe during a stance, at least")
    search.add_argument("--minimum-stride", type=float, metavar="S", help="least duration of a stride")
    search.add_argument("--minimum-knee-torque", type=float, metavar="N·m", help="least |ū| of a motor")
    search.add_argument("--hip-torque", type=float, metavar="N·m", help="largest torque of a hip motor")
    search.add_argument("--stiffness", type=_number_or_free, metavar="N·m/RAD", help="of a leg's knee spring, or: free")
    search.add_argument("--knee-touchdown", type=_number_or_free, metavar="DEG", help="of a landing knee, or: free")
    search.add_argument(
        "--knee-motor", metavar="NAME", help="stay within this motor's envelope, its rotor in the knees"
    )
    search.add_argument("--ratio", type=float, metavar="N", help=f"of its gearbox (default: {RATIO:g})")
    search.add_argument("--bus", type=float, metavar="V", help=f"of its supply (default: {BUS:g})")
    search.add_argument("--hip-distance", type=float, metavar="M", help="posterior to anterior hips (default: 0.7)")
    search.add_argument("--seed", type=int, default=0, metavar="N", help="of the initial guess (default: 0)")
    search.add_argument(
        "--feedback", choices=("none", "regulated", "speed"), default="none", help="that stabilises it (default: none)"
    )
    search.add_argument("--out", type=Path, default=Path(), metavar="DIR", help="folder for gait.json (default: here)")


def _number_or_free(word: str) -> float:
    if word.strip() == "free":
        return FREE
    try:
        number = float(word)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word!r} is neither a number nor 'free'") from None
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"{word!r} is not a finite number")
    return number


def _robots(arguments: argparse.Namespace) -> dict[str, Any]:
    from spear_pin.model.loading import ROBOTS, load

    rows = []
    for name, shipped in ROBOTS.items():
        robot = load(name)
        rows.append(
            {
                "name": name,
                "degrees_of_freedom": robot.nv,
                "motors": robot.nu,
                "mass": robot.mass,
                "coordinates": robot.coordinates,
                "toes": robot.toes,
                "summary": shipped.summary,
                "source": shipped.provenance,
            }
        )
    lines = [f"{'robot':<14}{'DoF':>4}{'motors':>8}{'mass':>11}  what it is"]
    for row in rows:
        head = f"{row['name']:<14}{row['degrees_of_freedom']:>4}{row['motors']:>8}{row['mass']:>8.2f} kg"
        lines.append(f"{head}  {row['summary']} ({row['source']})")
    return {"robots": rows, "text": "\n".join(lines)}


def _dynamics(arguments: argparse.Namespace) -> dict[str, Any]:
    import numpy as np
    import pinocchio as pin

    from spear_pin.model.loading import load

    robot = load(arguments.robot, toes=arguments.toes, locked=arguments.lock)
    q = pin.neutral(robot.model) if arguments.q is None else np.array(arguments.q)
    v = np.zeros(robot.nv) if arguments.v is None else np.array(arguments.v)
    result: dict[str, Any] = {
        "robot": robot.name,
        "coordinates": robot.coordinates,
        "q": q,
        "v": v,
        "D": robot.mass_matrix(q),
        "C": robot.coriolis_matrix(q, v),
        "G": robot.gravity(q),
        "bias": robot.bias(q, v),
        "B": robot.actuation_matrix,
        "J": {toe: robot.toe_jacobian(q, toe) for toe in robot.toes},
        "J_dot_v": {toe: robot.toe_drift(q, v, toe) for toe in robot.toes},
        "toe_position": {toe: robot.toe_position(q, toe) for toe in robot.toes},
    }
    lines = [f"{robot.name}: {', '.join(robot.coordinates)}  (SI units, radians)"]
    with np.printoptions(precision=6, suppress=True):
        for key, value in list(result.items())[2:]:
            by_toe = {f" {toe}": array for toe, array in value.items()} if isinstance(value, dict) else {"": value}
            for label, array in by_toe.items():
                lines.append(f"{key}{label} =\n{array}" if array.ndim == 2 else f"{key}{label} = {array}")
    return result | {"text": "\n".join(lines)}


def _hop(arguments: argparse.Namespace) -> dict[str, Any]:
    from spear_pin import Contact, HoppingLaw, Spring, find_gait, hopping, load, simulate
    from spear_pin.studies.hop import summarize
    from spear_pin.viz.player import record

    if arguments.flight_time is not None and not arguments.flight_time > 0:
        raise BadValue("--flight-time", arguments.flight_time, "a number > 0, in s")
    _check_run(arguments)
    robot = load("spear_ii", locked=[] if arguments.free_x else ["boom_x"])
    law = HoppingLaw(
        knee_touchdown=arguments.knee,
        frequency=arguments.frequency,
        hip_touchdown=0.5 * arguments.knee if arguments.free_x else None,
        foot_placement=arguments.foot_placement,
        **{} if arguments.stance_torque is None else {"stance_torque": arguments.stance_torque},
    )
    spring = Spring() if arguments.stiffness is None else Spring(stiffness=arguments.stiffness)
    contact = Contact() if arguments.friction is None else Contact(friction=arguments.friction)
    system = hopping(robot, law, spring, contact)
    target: dict[str, float] = {}
    if arguments.stance_torque is None:
        target["stance_torque"] = arguments.flight_time or 0.2
    if arguments.free_x:
        target["hip_touchdown"] = 0.0
    measures = {"stance_torque": "flight_time", "hip_touchdown": "mean_speed"}  # what each parameter is solved for
    with _iterations() as tell:
        gait = find_gait(system, list(target), {measures[k]: v for k, v in target.items()}, on_iteration=tell)
    trajectory = simulate(gait.system, gait.state, arguments.cycles, arguments.rtol)
    page = record(robot, trajectory, arguments.out / "hop.html", title="SPEAR-II hopping in place")
    data = trajectory.save(arguments.out / "hop.npz")
    if arguments.open:
        _open(page)
    summary = summarize(gait, trajectory)
    return summary | {"files": [str(page), str(data)], "text": _hop_text(summary, page, data)}


def _hop_text(summary: dict[str, Any], page: Path, data: Path) -> str:
    largest = abs(summary["multipliers"][0])
    rows = [
        ("stance torque", f"{summary['stance_torque']:.4f} N·m"),
        ("commanded hip, knee", f"{summary['hip_touchdown']:.4f}, {summary['knee_touchdown']:.4f} rad"),
        ("flight, stance", f"{summary['flight_time']:.4f} s, {summary['stance_time']:.4f} s"),
        ("apex of the hip", f"{summary['apex_height']:.4f} m"),
        ("peak ground force", f"{summary['peak_force']:.1f} N"),
        ("spring's share", f"{100 * summary['spring_share']:.1f} % of the push"),
        ("multipliers", ", ".join(f"{value:.4f}" for value in summary["multipliers"])),
        ("", f"largest {largest:.4f}: {'stable' if largest < 1 else 'unstable'}"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a hop"),
        ("simulated", f"{summary['cycles']} hops ({summary['reason']})"),
        ("files", f"{page}, {data}"),
    ]
    return "\n".join(f"{name:<21}{value}" for name, value in rows)


def _bound(arguments: argparse.Namespace) -> dict[str, Any]:
    from spear_pin import simulate
    from spear_pin.studies.bound import at_speed, summarize
    from spear_pin.viz.player import record

    if arguments.list:
        return _bounds()
    if arguments.speed is not None and not 0 < arguments.speed < math.inf:
        raise BadValue("--speed", arguments.speed, "a number > 0, in m/s")
    _check_run(arguments)
    name, gait = _gait_of(arguments.gait, arguments.speed)
    if arguments.speed is not None:
        with _iterations() as tell:
            gait = at_speed(gait, arguments.speed, on_iteration=tell)
    trajectory = simulate(gait.system, gait.state, arguments.cycles, arguments.rtol)
    summary = {"gait": name, **summarize(gait, trajectory)}
    title = f"Q-SPEAR bounding at {summary['speed']:.2f} m/s"
    page = record(gait.system.robot, trajectory, arguments.out / "bound.html", title=title)
    data = trajectory.save(arguments.out / "bound.npz")
    if arguments.open:
        _open(page)
    return summary | {"files": [str(page), str(data)], "text": _bound_text(summary, page, data)}


def _gait_of(name: str, speed: float | None) -> tuple[str, Gait]:
    """A bounding gait by its name or path; asked for a speed, the one of its family that is nearest to it.

    Gaits of a family have the same name but for the speed behind it: long_stride and long_stride_3.00.
    """
    from spear_pin.gaits import library
    from spear_pin.gaits.gait import Gait
    from spear_pin.studies.bound import mean_speed

    if name in library.names() and speed is not None:
        family = {other: re.search(SPEED_SUFFIX, other) for other in library.names() if _base(other) == _base(name)}
        speeds = {
            other: float(found[1]) if found else mean_speed(Gait.load(library.path(other)))
            for other, found in family.items()
        }
        name = min(speeds, key=lambda other: abs(speeds[other] - speed))
    gait = Gait.load(library.path(name) if name in library.names() else name)
    if gait.system.kind != "bounding":
        raise BadValue("--gait", name, f"a bounding gait; this one is of the kind {gait.system.kind!r}")
    return name, gait


def _base(name: str) -> str:
    return re.sub(SPEED_SUFFIX, "", name)


def _bounds() -> dict[str, Any]:
    """The bounding gaits that ship."""
    from spear_pin.gaits import library
    from spear_pin.gaits.gait import Gait
    from spear_pin.studies.bound import mean_speed

    rows = []
    for name in library.names():
        gait = Gait.load(library.path(name))
        if gait.system.kind == "bounding":
            rows.append(
                {
                    "name": name,
                    "speed": mean_speed(gait),
                    "lift_off": gait.system.law.lift_off,
                    "largest_multiplier": abs(gait.multipliers[0]),
                    "residual": gait.residual,
                }
            )
    width = max(len("gait"), *(len(row["name"]) for row in rows)) + 2
    lines = [f"{'gait':<{width}}{'speed':>10}  {'lift-off by':<13}{'largest multiplier':<20}residual"]
    for row in rows:
        head = f"{row['name']:<{width}}{row['speed']:>6.2f} m/s  {row['lift_off']:<13}"
        lines.append(f"{head}{row['largest_multiplier']:<20.4f}{row['residual']:.1e}")
    return {"gaits": rows, "text": "\n".join(lines)}


def _bound_text(summary: dict[str, Any], page: Path, data: Path) -> str:
    largest = abs(summary["multipliers"][0])

    def legs(key: str, form: str, unit: str) -> str:
        return ", ".join(format(summary[key][leg], form) for leg in ("posterior", "anterior")) + unit

    def torques(key: str, part: str) -> str:
        return ", ".join(f"{summary[key][f'{leg}_{part}']:.1f}" for leg in ("posterior", "anterior"))

    rule = {
        "knee": f"when the knee is back at {math.degrees(summary['knee_rest']):.0f}°",
        "force": "when the normal force is zero",
    }[summary["lift_off"]]
    share = summary["friction_used"], summary["friction_used_last_ms"]
    late = f", {share[1]:.2f} in the last ms" if summary["lift_off"] == "force" else ""
    rows = [
        ("gait", summary["gait"]),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("stride", f"{summary['stride']:.4f} m in {summary['period']:.4f} s"),
        *((phase.replace("_", " "), f"{time:.4f} s") for phase, time in summary["durations"].items()),
        ("lift-off", f"{rule}; force there {legs('lift_off_force', '.1f', ' N')} (posterior, anterior)"),
        ("peak normal force", legs("peak_force", ".0f", " N")),
        ("friction used", f"{share[0]:.2f}{late}; at impact {legs('friction_at_impact', '.2f', '')}"),
        ("clearance", f"{legs('clearance', '.3f', ' m')}{'' if summary['scuff_free'] else '; a toe scuffs'}"),
        ("knee motor, peak", f"{torques('peak_torque_stance', 'knee')} N·m in stance"),
        ("", f"{torques('peak_torque_swing', 'knee')} N·m in swing"),
        ("hip motor, peak", f"{torques('peak_torque_stance', 'hip')} N·m in stance"),
        ("", f"{torques('peak_torque_swing', 'hip')} N·m in swing"),
        ("motors", f"net {summary['net_joint_work']:.2f} J a stride; impacts lose {summary['impact_loss']:.2f} J"),
        ("cost of transport", f"{summary['cost_of_transport']:.3f} (mechanical, |power|)"),
        ("multipliers", f"largest {largest:.4f}: {'stable' if largest < 1 else 'unstable'}"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a stride"),
        ("simulated", f"{summary['cycles']} strides ({summary['reason']})"),
        ("files", f"{page}, {data}"),
    ]
    return "\n".join(f"{name:<21}{value}" for name, value in rows)


def _search(arguments: argparse.Namespace) -> dict[str, Any]:
    from spear_pin import simulate
    from spear_pin.gaits.collocation import casadi
    from spear_pin.gaits.feedback import regulated, speed_regulated
    from spear_pin.gaits.optimize import search
    from spear_pin.gaits.request import OBJECTIVES
    from spear_pin.hybrid.contact import Contact
    from spear_pin.studies.bound import summarize

    _check_out(arguments)
    if arguments.seed < 0:
        raise BadValue("--seed", arguments.seed, "a whole number >= 0")
    robot, request = _asked(arguments)
    casadi()
    ground = Contact(friction=max(Contact().friction, request.friction))
    with _shown() as show:

        def tell(iteration: int, objective: float, violation: float) -> None:
            show(f"searching: iteration {iteration}, objective {objective:.4f}, violation {violation:.1e}")

        gait, solution = search(robot, request, seed=arguments.seed, contact=ground, on_iteration=tell)
        if arguments.feedback != "none":
            show(f"designing feedback: {arguments.feedback}")
            gait = regulated(gait) if arguments.feedback == "regulated" else speed_regulated(gait)
        figures = summarize(gait, simulate(gait.system, gait.state, progress=False))
    shipped = None if robot.varied else _shipped_as(request)
    unit, meaning = OBJECTIVES[request.objective]
    summary = {
        "gait": arguments.gait,
        "seed": arguments.seed,
        "objective": request.objective,
        "objective_value": _objective(request, solution),
        "objective_unit": unit,
        "objective_meaning": meaning,
        "iterations": solution.iterations,
        "violation": max(solution.violations.values()),
        **figures,
        "stiffness_of_a_leg": figures["stiffness"] / MOTORS,
        "feedback": arguments.feedback,
        "shipped": shipped,
        "distance_from_shipped": None if shipped is None else _distance(gait, shipped),
    }
    path = gait.save(arguments.out / "gait.json")
    return summary | {"files": [str(path)], "text": _search_text(summary, path)}


def _asked(arguments: argparse.Namespace) -> tuple[Robot, Request]:
    """The robot, and a shipped gait's request with the options in the place of its own."""
    from dataclasses import replace

    from spear_pin.errors import UnknownName
    from spear_pin.gaits.library import REQUESTS
    from spear_pin.gaits.request import FLEXED, OBJECTIVES
    from spear_pin.model.loading import load
    from spear_pin.model.variants import vary

    if arguments.gait not in REQUESTS:
        raise UnknownName("gait", arguments.gait, REQUESTS)
    if arguments.objective is not None and arguments.objective not in OBJECTIVES:
        raise UnknownName("objective", arguments.objective, OBJECTIVES)
    names = ("speed", "objective", "lift_off", "friction", "clearance", "minimum_stride")
    changes: dict[str, Any] = {name: getattr(arguments, name) for name in names}
    for name in ("minimum_knee_torque", "hip_torque", "stiffness"):
        value = getattr(arguments, name)
        if value is not None and not value >= 0:
            raise BadValue(f"--{name.replace('_', '-')}", value, "a number >= 0")
        changes[name] = None if value is None else MOTORS * value
    if arguments.knee_touchdown is not None:
        if arguments.knee_touchdown != FREE and not 0 < arguments.knee_touchdown <= math.degrees(FLEXED):
            expected = f"a number > 0, at most {math.degrees(FLEXED):.1f}, in degrees, or free"
            raise BadValue("--knee-touchdown", arguments.knee_touchdown, expected)
        changes["knee_touchdown"] = math.radians(arguments.knee_touchdown)
    given: dict[str, Any] = {
        name: None if value == FREE else value for name, value in changes.items() if value is not None
    }
    robot = load("q_spear")
    if arguments.hip_distance is not None:
        robot = vary(robot, hip_distance=arguments.hip_distance)
    drive = _knee_drive(arguments)
    if drive is not None:
        rotor = drive.motor.known("rotor_inertia")
        robot = vary(robot, knee_ratio=drive.gearbox.ratio, knee_rotor=rotor)
        given["knee_drive"] = drive
    elif arguments.objective in ("electrical", "violation"):
        raise BadValue("--knee-motor", None, f"a motor, for the objective {arguments.objective!r}")
    return robot, replace(REQUESTS[arguments.gait], **given)


def _knee_drive(arguments: argparse.Namespace) -> Drive | None:
    from spear_pin.model.catalogue import motor
    from spear_pin.model.motor import Drive, Gearbox

    if arguments.knee_motor is None:
        for name in ("ratio", "bus"):
            if getattr(arguments, name) is not None:
                raise BadValue("--knee-motor", None, f"a motor, for --{name} to belong to")
        return None
    ratio = RATIO if arguments.ratio is None else arguments.ratio
    bus = BUS if arguments.bus is None else arguments.bus
    drive = Drive(motor(arguments.knee_motor), Gearbox(ratio, KNEE_EFFICIENCY), bus)
    for quantity in ("torque_constant", "resistance"):
        drive.motor.known(quantity)
    return drive


def _objective(request: Request, solution: Solution) -> float:
    """Its value in its own unit; torques are those of a motor."""
    if request.objective == "violation":
        return float(solution.values["violation"][0])
    if request.objective == "peak":
        return float(solution.values["peak torque"][0]) / MOTORS
    return solution.objective * (0.1 if request.objective in ("cot", "electrical") else 100.0)


def _shipped_as(request: Request) -> str | None:
    """Name of the shipped gait of which just this was asked."""
    from spear_pin.gaits.library import REQUESTS

    return next((name for name, asked in REQUESTS.items() if asked == request), None)


def _distance(gait: Gait, shipped: str) -> float:
    """Largest difference of the fixed point's coordinates and velocities from a shipped one's."""
    import numpy as np

    from spear_pin.gaits.gait import Gait

    other = Gait.load(shipped)
    return float(np.abs(np.concatenate(gait.state) - np.concatenate(other.state)).max())


def _search_text(summary: dict[str, Any], path: Path) -> str:
    largest = abs(summary["multipliers"][0])

    def peak(joint: str) -> str:
        torques = [
            max(summary[key][f"{leg}_{joint}"] for key in ("peak_torque_stance", "peak_torque_swing"))
            for leg in ("posterior", "anterior")
        ]
        return ", ".join(f"{torque:.1f}" for torque in torques) + " N·m (posterior, anterior)"

    rows = [
        ("minimised", f"{summary['objective']}: {summary['objective_meaning']}"),
        ("value", f"{summary['objective_value']:.6g} {summary['objective_unit'].removeprefix('1')}".rstrip()),
        ("optimiser", f"{summary['iterations']} iterations, constraints kept to {summary['violation']:.1e}"),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("stride", f"{summary['stride']:.4f} m in {summary['period']:.4f} s"),
        *((phase.replace("_", " "), f"{time:.4f} s") for phase, time in summary["durations"].items()),
        ("spring of a leg", f"{summary['stiffness_of_a_leg']:.2f} N·m/rad"),
        ("knee at touchdown", f"{math.degrees(summary['knee_touchdown']):.2f}°"),
        ("knee motor, peak", peak("knee")),
        ("hip motor, peak", peak("hip")),
        ("friction used", f"{summary['friction_used']:.2f}"),
        ("cost of transport", f"{summary['cost_of_transport']:.3f} (mechanical, |power|)"),
        ("feedback", summary["feedback"]),
        ("multipliers", ", ".join(f"{abs(value):.4f}" for value in summary["multipliers"][:4]) + ", ... (magnitudes)"),
        ("", f"largest {largest:.4f}: {'stable' if largest < 1 else 'unstable'}"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        ("file", str(path)),
    ]
    if summary["shipped"] is not None:
        away = summary["distance_from_shipped"]
        verdict = "the same gait" if away < SAME else "another local optimum: another seed may lead to it"
        rows.insert(-1, ("shipped gait", f"{summary['shipped']}: {away:.1e} from its fixed point, {verdict}"))
    return "\n".join(f"{name:<21}{value}" for name, value in rows)


def _check_out(arguments: argparse.Namespace) -> None:
    if not arguments.out.is_dir():
        raise BadValue("--out", str(arguments.out), "an existing folder")


def _check_run(arguments: argparse.Namespace) -> None:
    """Refuse what cannot be simulated or written, before anything is solved for."""
    from spear_pin.hybrid.record import Options

    _check_out(arguments)
    Options(rtol=arguments.rtol)
    if arguments.cycles < 1:
        raise BadValue("--cycles", arguments.cycles, "a whole number, at least 1")


def _open(page: Path) -> None:
    import webbrowser

    webbrowser.open(page.resolve().as_uri())


def _doctor(arguments: argparse.Namespace) -> dict[str, Any]:
    import importlib.metadata as metadata
    import platform
    import shutil

    required = ("pin", "numpy", "scipy", "lxml", "yourdfpy", "meshcat", "matplotlib", "tqdm")
    optional = ("casadi", "heyoka", "mujoco", "drake")

    def version(name: str) -> str | None:
        try:
            return metadata.version(name)
        except metadata.PackageNotFoundError:
            return None

    installed = {name: version(name) for name in (*required, *optional)}
    programs = {name: shutil.which(name) for name in ("chromium", "google-chrome", "ffmpeg")}
    checks = {name: _works(check) for name, check in _CHECKS.items()}
    failed = any(installed[name] is None for name in required) or any(value != "ok" for value in checks.values())
    lines = [f"python {platform.python_version()} on {platform.system()} {platform.machine()}"]
    lines += [f"  {name:<12}{installed[name] or 'MISSING'}" for name in required]
    lines += [f"  {name:<12}{installed[name] or 'not installed (optional)'}" for name in optional]
    lines += [f"  {name:<14}{'found' if path else 'not found (optional)'}" for name, path in programs.items()]
    lines += [f"  {name}: {result}" for name, result in checks.items()]
    return {
        "python": platform.python_version(),
        "packages": installed,
        "programs": {name: path is not None for name, path in programs.items()},
        "checks": checks,
        "failed": failed,
        "text": "\n".join(lines),
    }


def _check_dynamics() -> None:
    from spear_pin import load

    robot = load("spear_ii")
    if abs(robot.mass_matrix([0.0, 0.5, 0.5, 1.0])[2, 2] - 0.1471) > 1e-4:
        raise BadValue("D[2, 2] of spear_ii", robot.mass_matrix([0.0, 0.5, 0.5, 1.0])[2, 2], "0.1471 kg·m²")


def _check_hop() -> None:
    from spear_pin import hopping, load, simulate

    system = hopping(load("spear_ii", locked=["boom_x"]))
    trajectory = simulate(system, system.guess(), cycles=1, rtol=1e-8)
    if not trajectory.complete or abs(trajectory.ledger.residual).max() > 1e-6:
        raise BadValue("one hop", trajectory.reason, "complete, with its energy ledger closed")


def _check_bound() -> None:
    from spear_pin import simulate

    _, gait = _gait_of(BOUND, None)
    trajectory = simulate(gait.system, gait.state, cycles=1, rtol=1e-8)
    left = abs(trajectory.q[-1, 1:] - gait.state[0][1:]).max() if trajectory.complete else math.inf
    if left > 1e-5 or abs(trajectory.ledger.residual).max() > 1e-5:
        raise BadValue("one stride", f"{trajectory.reason}, open by {left:.1e}", "closed, with its energy ledger")


_CHECKS = {"dynamics of spear_ii": _check_dynamics, "one hop": _check_hop, "one stride": _check_bound}


def _works(check: Any) -> str:
    try:
        check()
    except Exception as error:  # a broken installation may fail in any way, and saying so is the point
        return f"FAILED: {type(error).__name__}: {error}"
    return "ok"


@contextmanager
def _iterations() -> Iterator[Callable[[int, float], None]]:
    """Show a solver's iterations."""
    with _shown() as show:
        yield lambda iteration, residual: show(f"solving: iteration {iteration}, residual {residual:.1e}")


@contextmanager
def _shown() -> Iterator[Callable[[str], None]]:
    """Show what is going on in one line of a terminal's stderr, and clear it when that is done."""
    seen = sys.stderr.isatty()

    def show(text: str) -> None:
        if seen:
            print(f"\r{text}\033[K", end="", file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        if seen:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def _plain(value: Any) -> Any:
    """Numbers, lists and objects that JSON has; complex numbers as [re, im]."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    return value
