"""`spear identify`."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_options, add_out, check_out
from spear_pin.cli.legs import add_leg as add_another
from spear_pin.cli.legs import name_robot
from spear_pin.cli.output import join_lines, progress
from spear_pin.cli.pairs import names
from spear_pin.cli.pinned import add_drive, add_spring, pinned_leg
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.model.pinned import PinnedLeg
    from spear_pin.studies.identification import Estimate, MovingAverage, Trial

GUESSED = ("stiffness", "damping", "rest_angle")  # from the data, where they are neither given nor varied
WORDS = {"coulomb": "dry friction", "rest_angle": "rest angle", "rotor_inertia": "rotor inertia"}
LEG = "SPEAR-II's, with its masses and inertias; for another leg give --robot"
KNOWN = ("stiffness", "damping", "coulomb", "rest_angle", "rotor_inertia")


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear identify lab.csv --volts-per-rad 1.06 --offset 0.4",
        "estimate stiffness, damping and rest angle, each ± its standard deviation, from lab.csv, which"
        " `spear push-test --write-csv lab` writes (for dry friction add --vary stiffness damping rest_angle coulomb)",
    )
    parser = add_command(
        commands, "identify", run, "estimate a knee's stiffness, damping, friction from push tests", example
    )
    parser.add_argument("files", nargs="+", metavar="FILE", help="CSV, .mat, .npz: time, the knee's angle or voltage")
    data = parser.add_argument_group("records")
    add_options(
        data,
        float,
        volts_per_rad=("V/RAD", None, "slope of the potentiometer, or counts per radian"),
        offset=("V", None, "voltage at the straight leg (default: 0)"),
        before=("S", 0.5, "time used before a release"),
        after=("S", 1.5, "time used after a release"),
    )
    add_options(
        data,
        str,
        unit=("UNIT", None, "V, mV, counts, rad, mrad, deg or turns (default: as the column's name says)"),
        time_unit=("UNIT", None, "s, ms, us, ns, min or h (default: as its name says, or s)"),
        column=("NAME", None, "column of the voltage or angle"),
        time_column=("NAME", None, "column of the time"),
    )
    smoothing = parser.add_argument_group("smoothing", "data and model are smoothed alike")
    smoothing.add_argument("--window", type=int, metavar="N", help="samples of a moving average (default: none)")
    smoothing.add_argument("--filter", metavar="KIND", help="centred or causal (default: centred)")
    smoothing.add_argument(
        "--smoothed-already", action="store_true", help="the records are smoothed already; needs --window"
    )
    smoothing.add_argument(
        "--model-as-is", action="store_true", help="do not smooth the model, only to see how that biases estimates"
    )
    add_another(parser, "its leg is the one in the records; without it, SPEAR-II's masses count")
    model = parser.add_argument_group("model", "without --robot, the leg is SPEAR-II's, with its masses and inertias")
    add_drive(model)
    model.add_argument(
        "--vary",
        nargs="+",
        type=names,
        default=[["stiffness", "damping", "rest_angle"]],
        metavar="NAME",
        help=f"estimate these of {', '.join(KNOWN)} (default: stiffness damping rest_angle; coulomb is dry friction)",
    )
    model.add_argument(
        "--per-release", nargs="+", type=names, default=[], metavar="NAME", help="estimate these anew for each release"
    )
    text = "value, or initial guess where it is estimated"
    add_options(model, float, **{name: ("VALUE", None, f"{WORDS.get(name, name)}: {text}") for name in KNOWN})
    add_spring(model)
    model.add_argument(
        "--loss", default="linear", metavar="NAME", help="loss function of the fit: linear, soft_l1, huber or cauchy"
    )
    model.add_argument("--together", action="store_true", help="make one estimate from all files")
    add_out(parser, "identify.svg")
    add_open(parser, "identify.svg")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Read the records, cut them into releases, estimate."""
    from spear_pin.studies.identification import MovingAverage
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.identification import fit_summary

    check_out(arguments)
    for option in ("vary", "per_release"):
        setattr(arguments, option, [name for part in getattr(arguments, option) for name in part])
    if arguments.window is None and (arguments.smoothed_already or arguments.model_as_is):
        raise BadValue("--window", None, "the number of samples that the records were smoothed over")
    if arguments.window is None and arguments.filter is not None:
        raise BadValue("--filter", arguments.filter, "only with --window")
    kind: Any = "centred" if arguments.filter is None else arguments.filter
    smoothing = None if arguments.window is None else MovingAverage(arguments.window, kind)
    program = Program()
    pinned, other = pinned_leg(arguments, program)
    of_whom = LEG if other is None else name_robot(other).removesuffix(",")
    guessed = [name for name in GUESSED if name not in arguments.vary and getattr(arguments, name) is None]
    for path in arguments.files:
        if arguments.files.count(path) > 1:
            raise BadValue("FILE", path, "each file once")
    by_file: dict[str, list[Trial]] = {}
    remarks = (
        [f"{', '.join(guessed)}: held at a guess from the data; give --{guessed[0].replace('_', '-')}"]
        if guessed
        else []
    )
    for path in arguments.files:
        by_file[str(path)], found = _trials(arguments, path, smoothing)
        remarks += found
    if arguments.together:
        by_file = {" + ".join(by_file): [trial for trials in by_file.values() for trial in trials]}
    estimates = {name: _estimated(arguments, name, pinned, trials) for name, trials in by_file.items()}
    _write(arguments, program, smoothing)
    picture = save_figure(fit_summary(estimates), arguments.out / "identify.svg")
    return {
        "estimates": [{"file": name, **_figures(estimate)} for name, estimate in estimates.items()],
        "leg": of_whom,
        **({} if other is None or other.cut is None else {"cut": str(other.cut)}),
        "remarks": remarks,
        "files": [str(picture)],
        "opened": picture,
        "text": join_lines(
            [f"leg: {of_whom}", *_lines(estimates), *(f"note: {remark}" for remark in remarks), f"picture: {picture}"]
        ),
        "python": str(program),
    }


def _write(arguments: argparse.Namespace, program: Program, smoothing: MovingAverage | None) -> None:
    """Write the Python of an estimate from the first file, or from all of them together."""
    from dataclasses import replace

    from spear_pin.studies.identification import cut_releases, identify, read_record, smooth_trial

    trials = Code("[]")
    for path in arguments.files if arguments.together else arguments.files[:1]:
        record = program.call(read_record, path, **_columns(arguments))
        made = program.call(cut_releases, record, before=arguments.before, after=arguments.after)
        trials = program.let("trials", Code(f"{made}[0]" if trials == "[]" else f"{trials} + {made}[0]"))
    if smoothing is not None:
        by = program.let("smoothing", smoothing)
        one = program.call(replace, Code("trial"), smoothing=by)
        one = one if arguments.smoothed_already else program.call(smooth_trial, Code("trial"), by)
        trials = program.let("trials", Code(f"[{one} for trial in trials]"))
    estimate = program.call(identify, Code("leg"), trials, vary=arguments.vary, **_options(arguments))
    program.show(program.let("estimate", estimate))
    if len(arguments.files) > 1 and not arguments.together:
        program.say("and so for each of the other files")


def _options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Options of `identify`."""
    return {
        "per_trial": arguments.per_release,
        "static_rest": arguments.static_rest,
        "known": {each: value for each in KNOWN if (value := getattr(arguments, each)) is not None} or None,
        "unilateral": arguments.unilateral,
        "loss": arguments.loss,
        "smooth_model": not arguments.model_as_is,
    }


def _columns(arguments: argparse.Namespace) -> dict[str, Any]:
    """Options of `read_record`."""
    from spear_pin.studies.identification import Calibration

    slope = arguments.volts_per_rad
    return {
        "column": arguments.column,
        "time_column": arguments.time_column,
        "calibration": None if slope is None else Calibration(slope, arguments.offset or 0.0),
        "unit": arguments.unit,
        "time_unit": arguments.time_unit,
    }


def _trials(arguments: argparse.Namespace, path: str, smoothing: MovingAverage | None) -> tuple[list[Trial], list[str]]:
    from dataclasses import replace

    from spear_pin.studies.identification import cut_releases, read_record, smooth_trial

    notes = list[str]()
    if arguments.volts_per_rad is None and arguments.offset is not None:
        raise BadValue("--offset", arguments.offset, "only with --volts-per-rad")
    if arguments.volts_per_rad is not None and arguments.offset is None:
        notes.append("--offset is not given: the voltage of the straight leg is taken as 0")
    record = read_record(path, **_columns(arguments))
    trials, remarks = cut_releases(record, arguments.before, arguments.after)
    if arguments.smoothed_already:
        trials = [replace(trial, smoothing=smoothing) for trial in trials]
    else:
        trials = [smooth_trial(trial, smoothing) for trial in trials]
    return trials, [*notes, *record.remarks, *remarks]


def _estimated(arguments: argparse.Namespace, name: str, pinned: PinnedLeg, trials: list[Trial]) -> Estimate:
    from spear_pin.studies.identification import identify

    with progress() as show:
        return identify(
            pinned,
            trials,
            arguments.vary,
            **_options(arguments),
            on_iteration=lambda n, rms: show(f"{name}: evaluation {n}, residual {1e3 * rms:.3f} mrad"),
        )


def _figures(estimate: Estimate) -> dict[str, Any]:
    return {
        "synthetic": any(trial.synthetic for trial in estimate.trials),
        "releases": len(estimate.trials),
        "parameters": [
            {"release": None if parameter.trial is None else parameter.trial + 1}
            | {each: getattr(parameter, each) for each in ("name", "value", "deviation", "inflation", "unit")}
            for parameter in estimate.parameters
        ],
        "held": _held(estimate),
        "correlation": estimate.correlation,
        "condition": estimate.condition,
        "fit": estimate.fit,
        "fits": estimate.fits,
        "noise": estimate.noise,
        "steps": [rounding.step for rounding in estimate.roundings],
        "whiteness": estimate.whiteness,
        "converged": estimate.converged,
        "integrations": estimate.integrations,
        "warnings": estimate.warnings,
    }


def _held(estimate: Estimate) -> dict[str, float]:
    """Quantities that were not estimated, in the first release."""
    knee, rotor = estimate.knees[0], estimate.rotors[0]
    everything = dict(zip(KNOWN, (knee.stiffness, knee.damping, knee.coulomb, knee.zero, rotor), strict=True))
    estimated = {parameter.name for parameter in estimate.parameters}
    return {name: value for name, value in everything.items() if name not in estimated}


def _lines(estimates: dict[str, Estimate]) -> list[str]:
    """A table like the source's 4.1, then what has to be known about it."""
    parameters = [parameter for estimate in estimates.values() for parameter in estimate.parameters]
    shared = {parameter.name: parameter.unit for parameter in parameters if parameter.trial is None}
    width = max(len(name) for name in estimates)
    heads = "".join(f"{f'{name}, {unit}':>28}" for name, unit in shared.items())
    lines = [f"{'':<{width}}{heads}{'fit':>10}{'releases':>10}"]
    for label, estimate in estimates.items():
        cells = "".join(
            f"{f'{found.value:.4f} ± {found.deviation:.4f}':>28}" for found in (estimate[name] for name in shared)
        )
        lines.append(f"{label:<{width}}{cells}{estimate.fit:>8.2f} %{len(estimate.trials):>10}")
    for label, estimate in estimates.items():
        held = _held(estimate)
        lines += (
            [f"{label}: held at {', '.join(f'{name} {value:.4g}' for name, value in held.items())}"] if held else []
        )
        own = [p for p in estimate.parameters if p.trial is not None and p.name in KNOWN]
        lines += [f"{label}: {p.label} {p.value:.4f} ± {p.deviation:.4f} {p.unit}" for p in own]
        if any(trial.synthetic for trial in estimate.trials):
            lines.append(f"{label}: synthetic, not measured")
        lines += [f"warning: {label}: {warning}" for warning in estimate.warnings]
    return lines
