"""`spear push-test`."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_options, add_out, add_seed, check_out
from spear_pin.cli.legs import add_leg as add_another
from spear_pin.cli.legs import name_robot, rests_on
from spear_pin.cli.output import align_lines, join_lines, shows
from spear_pin.cli.pinned import add_drive, add_spring, pinned_leg
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue
from spear_pin.words import number

if TYPE_CHECKING:
    from spear_pin.model.pinned import PinnedLeg
    from spear_pin.studies.push_test import PassiveKnee, Release

RECORDING = ("repeats", "noise", "quantum", "drift", "volts-per-rad", "offset", "seed")  # options of --write-csv
DURATION, DEPTH = 1.5, 0.10  # s, m: of SPEAR-II; of another leg by its size
NONE = "none"  # what --ratios calls the belt taken off


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear push-test --ratios none 15 30 66", "compare the release of SPEAR-II's leg with four gear ratios")
    summary = "simulate a push test: a leg is pushed down, then released"
    parser = add_command(commands, "push-test", run, summary, example)
    add_options(parser, float, depth=("M", None, f"depth of the push (default: {DEPTH:.2f})"))
    add_drive(parser)
    add_options(
        parser,
        float,
        stiffness=("N·m/RAD", None, "stiffness of the spring (default: 48.25, or 47.12 without motor)"),
        damping=("N·m·s/rad", None, "knee damping (default: 1.03, or 0.80 without motor)"),
        coulomb=("N·m", 0.0, "dry friction of the knee"),
        rest_angle=("RAD", 1.0, "knee angle at which the spring is slack, of Table 4.1"),
        duration=("S", None, f"duration of the motion (default: {DURATION:g})"),
    )
    add_spring(parser)
    parser.add_argument(
        "--ratios", nargs="+", type=_ratio, metavar="N", help=f"compare these gear ratios; {NONE} is without motor"
    )
    records = parser.add_argument_group("synthetic record")
    records.add_argument(
        "--write-csv", type=_csv, metavar="NAME", help="write a synthetic record of releases, for `spear identify`"
    )
    add_options(records, int, repeats=("N", None, "number of releases in it (default: 5)"))
    add_options(
        records,
        float,
        noise=("V", None, "standard deviation of the noise (default: 0.005)"),
        quantum=("V", None, "voltage step of the A/D converter (default: 5/4096)"),
        drift=("V/S", None, "drift of the voltage (default: 0)"),
        volts_per_rad=("V/RAD", None, "slope of the potentiometer (default: 1.06)"),
        offset=("V", None, "voltage at the straight leg (default: 0.4)"),
    )
    add_seed(records, "noise", None)
    add_another(parser, "one of its legs is pushed down")
    add_out(parser, "push_test.html, push_test.svg and push_test.npz")
    add_open(parser, "push_test.html, or gear_ratios.svg with --ratios,")


def _csv(word: str) -> str:
    """The name of a file in --out, whose suffix may be left out."""
    name = word if Path(word).suffix == ".csv" else f"{word}.csv"
    if word.strip() in ("", ".", "..") or len(Path(name).parts) != 1 or not name.isprintable():
        raise argparse.ArgumentTypeError(f"{word!r} is not a file name such as release.csv; give its folder by --out")
    return name


def _ratio(word: str) -> float | None:
    if word.strip() == NONE:
        return None
    try:
        return number(word)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{word!r} is neither a number nor {NONE!r}; expected a gear ratio such as 15"
        ) from None


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Simulate a release, compare gear ratios, or write a synthetic record."""
    from dataclasses import replace

    from spear_pin.model.scale import scale_of
    from spear_pin.studies.hop_of_another import scaled_hopping
    from spear_pin.studies.push_test import WITH_MOTOR, WITHOUT_MOTOR, rest_at

    check_out(arguments)
    _check_mode(arguments)
    program = Program()
    pinned, other = pinned_leg(arguments, program)
    scale = 1.0 if other is None else scale_of(other).length
    arguments.depth = scale * DEPTH if arguments.depth is None else arguments.depth
    if arguments.ratios is not None:
        return _compared(arguments)
    usual = WITHOUT_MOTOR if arguments.no_motor else WITH_MOTOR
    if other is not None:
        spring = scaled_hopping(other).spring
        usual = replace(usual, stiffness=spring.stiffness, damping=spring.damping)
        if spring.stiffness == 0 and arguments.stiffness is None:
            raise BadValue(
                "--stiffness",
                None,
                "a number: the robot's own spring is not linear, and the push test takes linear springs only",
            )
    knee = replace(usual, **_changes(arguments))
    if arguments.static_rest:
        knee = rest_at(pinned, knee, arguments.rest_angle)
    program.let("knee", knee)
    if arguments.write_csv is not None:
        return _recorded(arguments, pinned, knee, program)
    return _released(arguments, pinned, knee, program)


def _changes(arguments: argparse.Namespace) -> dict[str, Any]:
    """Numbers of the knee that are other than usual."""
    found = {name: value for name in ("stiffness", "damping") if (value := getattr(arguments, name)) is not None}
    return found | {"coulomb": arguments.coulomb, "zero": arguments.rest_angle, "unilateral": arguments.unilateral}


def _check_mode(arguments: argparse.Namespace) -> None:
    """Refuse options that would have no effect."""
    recording, comparing = arguments.write_csv is not None, arguments.ratios is not None
    if arguments.robot is not None and comparing:
        raise BadValue("--robot", arguments.robot, "to be left out with --ratios: give one by --ratio")
    for option, given, works in (
        ("--write-csv", recording, not comparing),
        ("--ratio", arguments.ratio is not None, not comparing),
        ("--no-motor", arguments.no_motor, not comparing),
        ("--duration", arguments.duration is not None, not recording),
        ("--open", arguments.open, not recording),
        *((f"--{name}", getattr(arguments, name.replace("-", "_")) is not None, recording) for name in RECORDING),
    ):
        if given and not works:
            mode = "--ratios" if comparing else "--write-csv" if recording else "a release without --write-csv"
            raise BadValue(option, "given", f"to be left out: it has no effect with {mode}")


def _released(arguments: argparse.Namespace, pinned: PinnedLeg, knee: PassiveKnee, program: Program) -> dict[str, Any]:
    from spear_pin.studies.push_test import release, simulate_release, swing
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.push import release_summary
    from spear_pin.viz.release_page import playback

    duration = DURATION if arguments.duration is None else arguments.duration
    result = release(pinned, knee, arguments.depth, duration)
    options = {"depth": arguments.depth, "duration": duration}
    program.let("result", program.call(release, Code("leg"), Code("knee"), **options))
    samples = simulate_release(pinned, knee, float(result.angle[0]), duration).save(arguments.out / "push_test.npz")
    small = swing(pinned, knee)
    title = f"{name_robot(pinned.robot)} released from {100 * arguments.depth:.4g} cm" + (
        ", no motor" if arguments.no_motor else ""
    )
    shown = playback(pinned, knee, result)
    page, picture = arguments.out / "push_test.html", arguments.out / "push_test.svg"
    figures = {
        **({} if pinned.robot.cut is None else {"cut": str(pinned.robot.cut)}),
        "depth": arguments.depth,
        "spring_zero": knee.zero,
        "stiffness": knee.stiffness,
        "damping": knee.damping,
        "coulomb": knee.coulomb,
        "rotor_inertia": pinned.rotor,
        **vars(small),
        **_motion(result),
        "shown": read_times(shown)[[0, -1]],
        "files": [str(page), str(samples), str(picture)],
        "pictures": {
            page: lambda path: record(pinned.robot, shown, path, title=title),
            picture: lambda path: save_figure(release_summary({title: result}), path),
        },
        "opened": page,
    }
    pulls = "never" if result.lift_off is None else f"from {result.lift_off:.4f} s on: the toe would lift off"
    turn = f"{result.extrema[0]:.4f} rad at {result.turns[0]:.4f} s" if result.turns.size else "none"
    rows = [
        ("pushed to", f"{result.angle[0]:.4f} rad, {100 * arguments.depth:.4g} cm below the rest"),
        ("rests at", f"{result.rest:.4f} rad (zero of the spring: {knee.zero:.4f} rad)"),
        ("small oscillation", f"{small.frequency:.4f} Hz, damping ratio {small.damping_ratio:.3f}"),
        ("rotor's share", f"{100 * small.rotor_share:.1f} % of the inertia ({pinned.rotor:.4g} kg·m²)"),
        ("first extremum", turn),
        ("least ground force", f"{figures['least_force']:.1f} N; the pin pulls {pulls}"),
        ("simulated", f"{duration:g} s ({result.reason})"),
        *rests_on(pinned.robot),
        *shows(shown),
        ("files", f"{page}, {samples}, {picture}"),
    ]
    return figures | {"text": align_lines(rows), "python": str(program)}


def _motion(result: Release) -> dict[str, Any]:
    return {
        "initial_angle": result.angle[0],
        "rest_angle": result.rest,
        "first_extremum": [result.turns[0], result.extrema[0]] if result.turns.size else None,
        "least_force": result.force[:, 1].min(),
        "lift_off": result.lift_off,
        "reason": result.reason,
    }


def _compared(arguments: argparse.Namespace) -> dict[str, Any]:
    from dataclasses import replace

    from spear_pin.studies.push_test import WITH_MOTOR, WITHOUT_MOTOR, gear_study
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.push import gear_comparison

    changes = _changes(arguments)
    options: dict[str, Any] = {
        "depth": arguments.depth,
        "static_rest": arguments.static_rest,
        "duration": DURATION if arguments.duration is None else arguments.duration,
        "engaged": replace(WITH_MOTOR, **changes),
        "disengaged": replace(WITHOUT_MOTOR, **changes),
    }
    rows = gear_study(arguments.ratios, **options)
    program = Program()
    program.let("rows", program.call(gear_study, arguments.ratios, **options))
    picture = arguments.out / "gear_ratios.svg"
    lines = ["ratio   rotor, kg·m²  share   frequency  damping ratio  first extremum        least force"]
    for row in rows:
        name = NONE if row.ratio is None else f"{row.ratio:g}:1"
        result, small = row.release, row.swing
        turn = f"{result.extrema[0]:.4f} rad, {result.turns[0]:.4f} s" if result.turns.size else "none"
        lines.append(
            f"{name:<8}{row.rotor:>12.4f}{100 * small.rotor_share:>6.1f} %{small.frequency:>9.4f} Hz"
            f"{small.damping_ratio:>15.3f}  {turn:<20}{result.force[:, 1].min():>11.1f} N"
        )
    return {
        "ratios": [
            {"ratio": row.ratio, "rotor_inertia": row.rotor, **vars(row.swing), **_motion(row.release)} for row in rows
        ],
        "files": [str(picture)],
        "pictures": {picture: lambda path: save_figure(gear_comparison(rows), path)},
        "opened": picture,
        "text": join_lines([*lines, str(picture)]),
        "python": str(program),
    }


def _recorded(arguments: argparse.Namespace, pinned: PinnedLeg, knee: PassiveKnee, program: Program) -> dict[str, Any]:
    from dataclasses import replace

    from spear_pin.studies.identification import Calibration
    from spear_pin.studies.laboratory import Instrument, synthesize, write_csv

    default = Instrument()
    given = {name: value for name in ("noise", "quantum", "drift") if (value := getattr(arguments, name)) is not None}
    slope, offset = arguments.volts_per_rad, arguments.offset
    calibration = Calibration(
        default.calibration.volts_per_rad if slope is None else slope,
        default.calibration.offset if offset is None else offset,
    )
    seed, repeats = arguments.seed or 0, 5 if arguments.repeats is None else arguments.repeats
    if seed < 0:
        raise BadValue("--seed", seed, "a whole number >= 0")
    instrument = replace(default, calibration=calibration, **given)
    asked: dict[str, Any] = {"depth": arguments.depth, "repeats": repeats, "instrument": instrument, "seed": seed}
    made = synthesize(pinned, knee, **asked)
    path = write_csv(made, arguments.out / arguments.write_csv)
    record = program.let("record", program.call(synthesize, Code("leg"), Code("knee"), **asked))
    program.do(program.call(write_csv, record, path))
    options = f"--volts-per-rad {calibration.volts_per_rad:g} --offset {calibration.offset:g}"
    options += " --no-motor" if arguments.no_motor else ""
    options += "" if arguments.ratio is None else f" --ratio {arguments.ratio:g}"
    for name in ("robot", "leg", "bends", "body"):
        value = getattr(arguments, name)
        options += "" if value is None else f" --{name} {shlex.quote(str(value))}"
    options += " --unilateral" if knee.unilateral else ""
    options += " --static-rest" if arguments.static_rest else ""
    options += " --vary stiffness damping coulomb rest_angle" if knee.coulomb else ""
    rows = [
        ("synthetic record", f"{path}: {made.t.size} samples, {repeats} releases; computed, not measured"),
        ("truth", f"k {knee.stiffness:g} N·m/rad, b {knee.damping:g} N·m·s/rad, zero {knee.zero:.4f} rad"),
        ("identify it by", f"spear identify {shlex.quote(str(path))} {options}"),
    ]
    truth = {"stiffness": knee.stiffness, "damping": knee.damping, "coulomb": knee.coulomb, "spring_zero": knee.zero}
    figures = {"synthetic": True, "truth": truth, "releases": made.let_go, "samples": made.t.size, "files": [str(path)]}
    return figures | {"text": align_lines(rows), "python": str(program)}
