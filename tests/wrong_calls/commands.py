"""Command lines that are wrong: each option with each kind of word that it does not take."""

from __future__ import annotations

from collections.abc import Iterator

from spear_pin import Gait
from tests.wrong_calls.case import Command
from tests.wrong_calls.files import hops, record, trajectory

TEXT = ("", "x", "1,5")
NUMBER = (*TEXT, "nan", "inf", "-inf", "1e999")  # what is no finite number
NOT_NEGATIVE = (*NUMBER, "-1")
POSITIVE = (*NOT_NEGATIVE, "0")
COUNT = (*NUMBER, "1.5", "0", "-1", "1e3")
SEED = (*NUMBER, "1.5", "-1")
RTOL = (*POSITIVE, "1", "1e-20")
STEP = (*POSITIVE, "2", "1e-20")
FREE = (*NUMBER, "-1", "Free")
FOLDER = ("", "none", "none/at/all", "a_file", "/proc", "/dev/null")
NAME = ("", "nope", "../nope", "None", "\u2603", "x" * 300)
UNKNOWN = ("--nope", "--json=1", "--nope=1", "-x", "one_too_many")


def cases() -> Iterator[Command]:
    """Every wrong command line."""
    yield from (Command(words) for words in (("fly",), ("--json",), ("",), ("--version=1",), ("hop bound",), ("HOP",)))
    for base, options in OPTIONS.items():
        words = tuple(base.split())
        prepare = prepared(words)
        yield from (Command((*words, word), prepare) for word in UNKNOWN)
        for option, wrong in options.items():
            name, *with_it = option.split()
            yield Command((*words, *with_it, name), prepare)  # without its value
            for word in wrong:
                given = (f"{name}={word}",) if word.startswith("-") else (name, word)
                yield Command((*words, *with_it, *given), prepare)
    for line in LINES:
        words = tuple(line.split())
        yield Command(words, prepared(words))


def prepared(words):
    """Makes the files that a command line names."""

    def prepare(folder):
        (folder / "a_file").touch()
        if "lab.csv" in words:
            record(folder / "lab.csv")
        if "hop.npz" in words:
            trajectory(folder / "hop.npz")
        if "bound.json" in words:
            Gait.load("long_stride").save(folder / "bound.json")
        if "hops.csv" in words:
            hops(folder / "hops.csv")

    return prepare


RISING = ("", "x", "0", "-1", "nan", "inf", ",", "2,1", "1,1")  # of numbers between commas
OF_A_LOG = {  # options of the commands that read one
    "--column": ("", "crank", "=a", "crank=", "nope=crank_deg", "crank=nope"),
    "--unit": ("", "crank_deg", "nope=deg", "crank_deg=furlong", "crank_deg=Nm"),
    "--settle": NOT_NEGATIVE,
    "--set": ("", "stiffness", "stiffness=x", "nope=1", "stiffness=nan", "stiffness=-1"),
    **dict.fromkeys(("--bends", "--body"), ("1",)),
}
# the words of a command, and its options, with what each needs beside it and the words that it does not take
OPTIONS = {
    "robots": {},
    "doctor": {},
    "references": {"--out": FOLDER},
    "dynamics spear_ii": {
        "--q": ("1", *NUMBER),
        "--v": ("1", *NUMBER),
        "--lock": ("", "ankle", "Knee"),
        "--toes": ("", "hoof", "TOE"),
    },
    "dynamics q_spear_full": {
        "--leg": ("", "FL", "hip"),
        "--bends --plane": ("", "x", "0", "2", "1.5"),
        "--bends --leg=anterior_left": ("", "x", "0", "2", "1.5"),
        "--body --leg=anterior_left": (*TEXT, "nan", "inf", "-1"),
        **dict.fromkeys(("--bends", "--body"), ("1",)),
    },
    "hop": {
        "--flight-time": (*POSITIVE, "1e9"),
        "--stance-torque": NOT_NEGATIVE,
        "--knee": (*NUMBER, "4", "-4"),
        "--frequency": POSITIVE,
        **dict.fromkeys(("--stiffness", "--damping", "--hardening", "--preload"), (*NOT_NEGATIVE, "1e300")),
        "--friction": POSITIVE,
        "--slope": (*NUMBER, "1.3", "-1.3"),
        "--foot-placement --free-x": NUMBER,
        "--foot-placement": ("0.1",),
        "--robot": ("", "nothing", "no_such.urdf", "no_such.toml", "/", "."),
        "--leg --robot=q_spear_full": ("", "FL", "hip"),
        "--bends --robot=q_spear_full": ("", "x", "0", "2", "-2", "1.5"),
        "--body --robot=q_spear_full": (*TEXT, "nan", "inf", "-1"),
        **dict.fromkeys(("--leg", "--bends", "--body"), ("1",)),
        "--current-limit --hardware": (*TEXT, "nan", "-inf", "-1", "0"),  # an infinite one is none
        "--bandwidth --hardware": POSITIVE,
        "--noise --hardware": NOT_NEGATIVE,
        "--losses --hardware": NOT_NEGATIVE,
        "--seed --hardware": SEED,
        "--cycles": (*COUNT, "9" * 20),
        "--rtol": RTOL,
        "--max-step": STEP,
        "--out": FOLDER,
    },
    "bound": {
        "--gait": (*NAME, "a_file", "hop.npz", ".", "/"),
        "--speed": (*POSITIVE, "99", "1e300"),
        "--cycles": (*COUNT, "9" * 20),
        "--rtol": RTOL,
        "--max-step": STEP,
        "--out": FOLDER,
    },
    "search": {
        "--speed": POSITIVE,
        "--objective": NAME,
        "--lift-off": NAME,
        "--friction": POSITIVE,
        "--clearance": NUMBER,
        "--minimum-stride": NUMBER,
        "--minimum-knee-torque": NOT_NEGATIVE,
        "--hip-torque": NOT_NEGATIVE,
        "--stiffness-per-leg": FREE,
        "--hardening-per-leg": NOT_NEGATIVE,
        "--preload-per-leg": NOT_NEGATIVE,
        "--knee-touchdown": (*FREE, "0", "170"),
        "--knee-motor": NAME,
        "--ratio --knee-motor=ec_60_flat_100w_48v": POSITIVE,
        "--bus --knee-motor=ec_60_flat_100w_48v": POSITIVE,
        "--ratio": ("15",),
        "--hip-distance": POSITIVE,
        "--robot": ("", "nothing", "no_such.urdf", "spear_ii", "/"),
        "--robot long_stride": ("q_spear_full",),
        "--bends": ("1",),
        "--seed": SEED,
        "--feedback": NAME,
        "--out": FOLDER,
    },
    "payoff q_spear": {
        "--speeds": (*RISING, "1e9"),
        "--stiffnesses": RISING,
        "--flight-times": ("0.2",),
        "--over": ("knee_motor_size=0.5:2",),
        "--spring": ("knee",),
        "--body": ("1",),
        "--knee-motor --knee-ratio=15": NAME,
        "--hip-motor --hip-ratio=15": NAME,
        "--knee-motor": NAME,
        "--knee-ratio": (*POSITIVE, "15"),
        "--hip-ratio --hip-motor=assumed_600w": POSITIVE,
        "--efficiency --knee-motor=assumed_600w --knee-ratio=15": (*POSITIVE, "1.5"),
        "--efficiency": ("0.9",),
        "--bus": POSITIVE,
        "--workers": COUNT,
        "--out": FOLDER,
    },
    "payoff spear_ii": {
        "--flight-times": (*RISING, "1e9"),
        "--over": ("", "x", "knee_motor_size", "knee_motor_size=2:3", "frequency=1:3", "knee_motor=0.5:2", "a.hip=1:2"),
        "--speeds": ("2",),
        "--spring": ("", "x"),
        "--leg": ("leg",),
        "--bends": ("1",),
        "--body": ("1",),
    },
    "payoff q_spear_full": {
        "--leg": ("", "FL", "hip"),
        "--bends --leg=anterior_left": ("", "x", "0", "2", "1.5"),
        "--body --leg=anterior_left": (*TEXT, "nan", "inf", "-1"),
    },
    "sweep hop --over stiffness=40:50:3": {
        "--flight-time": POSITIVE,
        "--speed": ("1.5",),
        "--sobol": COUNT,
        "--latin": COUNT,
        "--seed": SEED,
        "--workers": COUNT,
        "--chunk": COUNT,
        "--rtol": RTOL,
        "--out": ("", "x", "x.nc", "none/x.zarr", "/proc/x.zarr", ".zarr/x"),
        "--over": ("", "x", "stiffness", "stiffness=", "=1", "stiffness=x", "stiffness=1:2", "stiffness=1:2:x"),
        "--over --over=friction=0.5,nan": ("stiffness=1:2:3",),
        "--robot": ("", "nothing", "no_such.urdf", "/"),
        "--leg --robot=q_spear_full": ("", "FL", "hip"),
        **dict.fromkeys(("--leg", "--bends", "--body"), ("1",)),
    },
    "sweep bound --over stiffness=110:115:2": {
        "--speed": POSITIVE,
        "--flight-time": ("1",),
        "--robot": ("q_spear_full",),
    },
    "family hop --over stance_torque --from 7.7 --to 7.9": {
        "--over": ("", "x", "slope=1", "apex_height"),
        **dict.fromkeys(("--from", "--to", "--at"), (*NUMBER, "9e99")),
        "--flight-time": POSITIVE,
        "--speed": ("1.5",),
        "--step": POSITIVE,
        "--points": COUNT,
        "--rtol": RTOL,
        "--out": FOLDER,
        "--robot": ("", "nothing", "no_such.urdf", "/"),
        **dict.fromkeys(("--leg", "--bends", "--body"), ("1",)),
    },
    "sensitivity hop --over stiffness": {
        "--over": ("", "x", "slope", "stiffness"),
        "--vary": ("x", "stance_torque", "stiffness"),
        "--keep": ("x", "flight_time"),
        "--motor": ("", "x", "knee=", "knee=x", "x=spear_ii_knee"),
        "--bus": POSITIVE,
        "--bus --motor=knee=spear_ii_knee": POSITIVE,
        "--efficiency": POSITIVE,
        "--efficiency --bus=24 --motor=knee=spear_ii_knee": (*POSITIVE, "1.5"),
        "--out": FOLDER,
    },
    "uncertainty hop --sigma stiffness=1%": {
        "--sigma": ("", "x", "=1", "stiffness", "stiffness=", "stiffness=x", "stiffness=-1", "stiffness=nan", "nope=1"),
        "--correlation": ("", "x", "stiffness,damping=0.5", "stiffness,stiffness=1", "stiffness=2"),
        "--vary": ("x", "stance_torque", "stiffness"),
        "--keep": ("x", "flight_time"),
        "--motor": ("", "x", "knee=", "knee=x", "x=spear_ii_knee"),
        "--bus": POSITIVE,
        "--bus --motor=knee=spear_ii_knee": POSITIVE,
        "--efficiency": POSITIVE,
        "--efficiency --bus=24 --motor=knee=spear_ii_knee": (*POSITIVE, "1.5"),
        "--monte-carlo": (*COUNT, "1", "9" * 20),
        "--seed": SEED,
        "--out": FOLDER,
    },
    "turn": {
        **dict.fromkeys(("--rate", "--angle"), (*NUMBER, "0", "500")),
        "--cycles": (*COUNT, "9" * 20),
        "--rtol": RTOL,
        "--max-step": STEP,
        "--out": FOLDER,
    },
    "trot": {
        "--push": NUMBER,
        "--cycles": (*COUNT, "9" * 20),
        "--rtol": RTOL,
        "--max-step": STEP,
        "--out": FOLDER,
    },
    "push-test": {
        "--depth": (*NOT_NEGATIVE, "1"),
        "--ratio": (*POSITIVE, "1e300"),
        "--stiffness": (*NOT_NEGATIVE, "3", "1e300"),
        "--damping": (*NOT_NEGATIVE, "1e300"),
        "--coulomb": (*NOT_NEGATIVE, "1e300"),
        "--rest-angle": (*NUMBER, "9"),
        "--duration": (*POSITIVE, "1e9"),
        "--ratios": ("", "x", "nan", "0", "-1"),
        "--write-csv": ("", " ", ".", "..", "/", "no/where", "/tmp/x.csv", "../x", "x/", "x" * 300),
        "--repeats --write-csv=x": (*COUNT, "99999999"),
        "--noise --write-csv=x": NOT_NEGATIVE,
        "--quantum --write-csv=x": NOT_NEGATIVE,
        "--drift --write-csv=x": NUMBER,
        "--volts-per-rad --write-csv=x": (*NUMBER, "0"),
        "--offset --write-csv=x": NUMBER,
        "--seed --write-csv=x": SEED,
        "--seed": ("1",),
        "--noise": ("0.1",),
        "--robot": ("", "nothing", "no_such.urdf", "/"),
        "--leg --robot=q_spear_full": ("", "FL", "hip"),
        "--ratios --robot=q_spear_full": ("15",),
        "--write-csv --robot=q_spear_full": ("x",),
        **dict.fromkeys(("--leg", "--bends", "--body"), ("1",)),
        "--out": FOLDER,
    },
    "identify lab.csv": {
        "--volts-per-rad": (*NUMBER, "0"),
        "--offset": ("0.4", *NUMBER),
        "--unit --volts-per-rad=1": NAME,
        "--time-unit --volts-per-rad=1": NAME,
        "--column --volts-per-rad=1": NAME,
        "--time-column --volts-per-rad=1": NAME,
        "--before --volts-per-rad=1.06": NOT_NEGATIVE,
        "--after --volts-per-rad=1.06": POSITIVE,
        "--window --volts-per-rad=1.06": COUNT,
        "--filter --volts-per-rad=1.06": ("causal",),
        "--filter --volts-per-rad=1.06 --window=3": NAME,
        "--ratio": POSITIVE,
        "--vary --volts-per-rad=1.06": ("", "mass"),
        "--per-release --volts-per-rad=1.06": ("", "mass"),
        "--stiffness --volts-per-rad=1.06": (*NOT_NEGATIVE, "1e300"),
        "--damping --volts-per-rad=1.06": NOT_NEGATIVE,
        "--coulomb --volts-per-rad=1.06": NOT_NEGATIVE,
        "--rest-angle --volts-per-rad=1.06": NUMBER,
        "--rotor-inertia --volts-per-rad=1.06": NOT_NEGATIVE,
        "--loss --volts-per-rad=1.06": NAME,
        "--out": FOLDER,
    },
    "fit crank_hopper hops.csv": {
        "--over": ("", ",", "nope", "stiffness,stiffness"),
        "--phases --over=stiffness": ("", "air"),
        **{f"{option} --over=stiffness": wrong for option, wrong in OF_A_LOG.items()},
        "--out": FOLDER,
    },
    "replay crank_hopper hops.csv": {"--window": POSITIVE, **OF_A_LOG, "--out": FOLDER},
    "export spear_ii --mjcf": {
        "--lock": ("", "ankle"),
        "--toes": ("", "hoof"),
        "--out": FOLDER,
        "--size": ("10x10",),
        "--fps": ("30",),
        "--robot": ("q_spear",),
    },
    "export bound.json --table a.csv": {"--rows": POSITIVE, "--table": ("", "a.txt", "no/where.csv"), "--fps": ("30",)},
    "export hop.npz --png": {
        "--time": NUMBER,
        "--size": ("", "x", "10", "0x0", "10x", "-1x5", "1e3x1e3", "99999x99999"),
        "--robot": (*NAME, "q_spear"),
        "--out": FOLDER,
    },
    "export hop.npz --mp4": {"--fps": POSITIVE, "--speed": POSITIVE, "--time": ("1",)},
    "report": {"--only": ("", "nope", "["), "--figures": NAME, "--out": FOLDER},
    "compare spear_ii q_spear": {
        "--names": ("", "one"),
        "--of": (*NAME, "a_file", ".", "/"),
        "--cycles": (*COUNT, "51", "9" * 20),
        "--out": FOLDER,
        "--robot": ("hoppy_leg",),
        "--flight-time": ("0.3",),
    },
    "compare stiffness=45 stiffness=50": {
        "--flight-time": POSITIVE,
        "--robot": NAME,
        "--leg": ("leg",),
        "--body": ("1",),
        "--names": ("soft stiff stiffness=40",),
    },
    "explore": {"--port": (*NUMBER, "-1", "65536", "1.5"), "--robot": NAME, "--body": ("1",), "--leg": ("posterior",)},
    "explore bound": {"--robot": ("solo12",), "--body": ("1",)},
}
# and what does not go together
LINES = (
    "explore nope",
    "explore bound long_stride",
    "explore trot --over nope",
    "explore trot --over adduction_stiffness,slope",
    "explore hop --over friction",
    "dynamics",
    "dynamics nope",
    "dynamics none.urdf",
    "dynamics a_file",
    "dynamics .",
    "dynamics /",
    "dynamics spear_ii --q 0 0 0 1e200",
    "dynamics spear_ii --v 0 0 0 1e200 --json",
    "dynamics q_spear_full --q" + 18 * " 0",
    "dynamics q_spear_full --q" + 19 * " 0",
    "dynamics q_spear_full --v" + 19 * " 0",
    "hop --flight-time 0.2 --stance-torque 8",
    "hop --bandwidth 5",
    "hop --seed 5",
    "hop --hardware --noise nan --json",
    "hop --hardware --save",
    "turn nope",
    "turn none.json",
    "turn a_file",
    "turn --rate 5 --angle 2",
    "push-test --ratio 15 --no-motor",
    "push-test --ratios 15 --duration nan",
    "push-test --ratios 15 --write-csv x",
    "push-test --write-csv x --duration 2",
    "identify",
    "identify none.csv",
    "identify lab.csv lab.csv --volts-per-rad 1",
    "identify lab.csv --smoothed-already",
    "identify a_file",
    "fit crank_hopper none.csv --over stiffness",
    "fit crank_hopper a_file --over stiffness",
    "fit crank_hopper . --over stiffness",
    "fit spear_ii hops.csv --over stiffness",
    "fit q_spear hops.csv --over mass",
    "replay crank_hopper none.csv",
    "replay none.json hops.csv",
    "identify .",
    "payoff",
    "payoff nope",
    "payoff q_spear --bends 1",
    "payoff q_spear_full --bends 1",
    "payoff q_spear_full --leg anterior_left --bends 1 1",
    "search nope",
    "search --objective electrical",
    "search --minimum-knee-torque 1 --clearance 9e99",
    "sweep",
    "sweep fly --over stiffness=1,2",
    "sweep hop",
    "sweep hop --over nope=1,2",
    "sweep hop --over stiffness=1:2:9999999999",
    "sweep hop --over stiffness=1,2 --over stiffness=3,4",
    "sweep hop --over stiffness=1,2 --sobol 4",
    "sweep hop --over stiffness=1:2 --sobol 4 --latin 4",
    "sweep hop --over flight_time=0.1,0.2 --flight-time 0.2",
    "sweep trot --over friction=0.5,0.9 --flight-time 0.2",
    "family",
    "family hop",
    "family hop --over stiffness",
    "family hop --over stiffness --from 50 --to 40",
    "family hop --over nope --from 1 --to 2",
    "family fly --over stiffness --from 40 --to 50",
    "family trot --over friction --from 0.4 --to 0.9 --speed 2",
    "family bound --over stiffness --from 1 --to 2",
    "sensitivity",
    "sensitivity fly",
    "uncertainty",
    "uncertainty hop",
    "uncertainty fly --sigma stiffness=1",
    "uncertainty hop --sigma slope=1%",
    "compare",
    "compare long_stride",
    "compare long_stride nope",
    "compare long_stride none.npz",
    "compare long_stride none.json",
    "compare long_stride a_file",
    "compare long_stride /",
    "compare long_stride stiffness=",
    "compare long_stride stiffness=nan",
    "compare long_stride stiffness=1e9",
    "compare long_stride stifness=40",
    "compare long_stride =",
    "compare" + 7 * " spear_ii",
    "export",
    "export nope --mjcf",
    "export none.npz --csv",
    "export a_file --csv",
    "export spear_ii",
    "export spear_ii --png",
    "export hop.npz --mjcf",
    "export hop.npz --c new",
    "export a_file --c new",
    "export hop.npz",
    "export hop.npz --mat --size 10x10",
)
