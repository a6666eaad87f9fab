"""Calls from Python with arguments of the wrong kind, or out of range: each argument of each function."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from tests.wrong_calls.case import Function

NAN, INF = math.nan, math.inf
# what is wrong for an argument, by what it should be
OBJECT = (None, 5, "spear_ii", [], object())
OPTIONAL = (5, "text", [], 0, False)
NUMBER = (None, "1", [1.0], {}, True, 1j, NAN, INF, np.ones(2))
POSITIVE = (*NUMBER, 0.0, -1.0)
NOT_NEGATIVE = (*NUMBER, -1.0)
COUNT = (None, "1", [1], 1.5, 0, -1, NAN, INF)
RTOL = (None, "1", [1e-9], 0.0, -1.0, 1.0, NAN, INF)
FLAG = (None, "no", 1, 0.0, [])
PATH = (None, 5, b"a", [], 1.5)
NAMES = (5, 1.5, [5], [None], True)
MAPPING = (5, "x", [1, 2], 1.5)
CALL = (5, "x", [])
ARRAY = (None, "x", [], [1.0], {}, object())
NAME = (None, 5, "nope", "", [])
STATE = (None, 5, "x", [], (1,), ("a", "b"), ([NAN] * 3, [0.0] * 3), ([0.0], [0.0]))


@cache
def hop() -> Any:
    from spear_pin import hopping, load

    return hopping(load("spear_ii", locked=["boom_x"]))


@cache
def gait() -> Any:
    from spear_pin import Gait

    return Gait.load("long_stride")


@cache
def motion() -> Any:
    from spear_pin import simulate

    return simulate(hop(), hop().guess(), 1, 1e-6)


@cache
def leg() -> Any:
    from spear_pin.studies.push_test import spear_ii

    return spear_ii()


@cache
def knee() -> Any:
    from spear_pin.studies.push_test import WITH_MOTOR

    return WITH_MOTOR


def cases() -> Iterator[Function]:
    """Every wrong argument, the others being right."""
    for where, right, wrong in FUNCTIONS:
        for argument, values in wrong.items():
            for value in values:
                yield Function(f"{where}({argument}={_brief(value)})", _call(where, right, argument, value))


def _brief(value: object) -> str:
    return "an object" if type(value) is object else repr(value)


def _call(where: str, right: Callable[[], Mapping[str, Any]], argument: str, value: object) -> Callable[..., object]:
    def call(folder: object) -> object:
        module, _, name = where.partition(":")
        function = import_module(f"spear_pin.{module}" if module else "spear_pin")
        given = dict(right())
        for part in name.split("."):
            function = getattr(function, part)
        return function(**{**given, argument: value})

    return call


def _monopod() -> dict[str, Any]:
    return {"robot": hop().robot}


def _quadruped() -> dict[str, Any]:
    return {"robot": import_module("spear_pin").load("q_spear_full")}


def _at_rest() -> dict[str, Any]:
    return {"self": hop().robot, "q": [0.0] * 3}


def _run() -> dict[str, Any]:
    return {"system": hop(), "state": hop().guess()}


def _lanes() -> dict[str, Any]:
    q, v = hop().guess()
    return {"system": hop(), "q": [q], "v": [v]}


def _push() -> dict[str, Any]:
    return {"leg": leg(), "knee": knee(), "depth": 0.1}


LAW = dict.fromkeys(("hip_gain", "hip_damping", "knee_gain", "knee_damping", "stance_torque"), NOT_NEGATIVE)
# the function, its right arguments, and the wrong ones
FUNCTIONS: tuple[tuple[str, Callable[[], Mapping[str, Any]], Mapping[str, tuple[Any, ...]]], ...] = (
    (
        ":load",
        lambda: {"source": "spear_ii"},
        {
            "source": (None, 5, "nope", "", b"spear_ii", [], "no/such.urdf"),
            **{"toes": (*NAMES, ["hoof"]), "locked": NAMES, "motors": (5, ["ankle"], "ankle", [5], {"hip": 1})},
            **{"base": ("floating", "", 5, True, ["free"]), "repair": ("yes", 5, None, [])},
        },
    ),
    (
        ":Spring",
        dict,
        {
            **dict.fromkeys(("stiffness", "damping", "hardening", "preload", "hysteresis"), NOT_NEGATIVE),
            "unilateral": FLAG,
            "rest": ("x", NAN, 4.0, [], True),
            "table": (
                "x",
                5,
                None,
                [1.0],
                ((0.0, 0.0), (0.1, NAN)),
                ((0.0, 0.0), (0.1, -1.0)),
                ((0.0, 0.0), (0.1, 1.0)),
            ),
        },
    ),
    (":Contact", dict, {"friction": POSITIVE}),
    (":Ground", dict, {"friction": POSITIVE, "slope": ("x", NAN, 1.3, [], True), "height": ("x", NAN, 1e4, [], True)}),
    (
        ":HoppingLaw",
        dict,
        {
            **LAW,
            "frequency": POSITIVE,
            "knee_touchdown": (*NUMBER, 4.0),
            "hip_touchdown": NUMBER[1:],
            "minimum_force": NOT_NEGATIVE[1:],
            "hold_extension": FLAG,
            "foot_placement": NUMBER,
            "speed": NUMBER,
        },
    ),
    (":hopping", _monopod, {"robot": OBJECT, "law": OPTIONAL, "spring": OPTIONAL, "contact": OPTIONAL}),
    (
        ":bounding",
        lambda: {"robot": gait().system.robot, "law": gait().system.law},
        {"robot": OBJECT, "law": OBJECT, "spring": OPTIONAL, "contact": OPTIONAL},
    ),
    (
        ":find_gait",
        lambda: {"system": hop()},
        {
            "system": OBJECT,
            "vary": (5, [5], ["nope"], ["stance_torque"], None),
            "target": (5, "x", {"nope": 1.0}, {"flight_time": 0.2}, [1]),
            "guess": STATE[1:],
            "rtol": RTOL,
            "on_iteration": CALL,
        },
    ),
    (
        ":continue_gait",
        lambda: {"gait": gait(), "over": "stiffness", "within": (100.0, 130.0)},
        {
            "gait": OBJECT,
            "over": NAME,
            "within": (5, "x", (1.0,), (130.0, 100.0), (1.0, 2.0), (100.0, NAN), ("a", "b"), None),
            "vary": (5, [5], ["nope"], ["posterior_hip_torque"], None),
            "target": (5, "x", {"nope": 1.0}, {"mean_speed": 2.5}, [1]),
            "step": POSITIVE,
            "points": COUNT,
            "rtol": RTOL,
            "on_point": CALL,
        },
    ),
    (
        ":simulate",
        _run,
        {
            "system": OBJECT,
            "state": STATE,
            "cycles": COUNT,
            "rtol": RTOL,
            "atol": RTOL[1:],
            "max_evaluations": COUNT,
            "max_step": RTOL[1:],
            "progress": FLAG,
        },
    ),
    (
        ":simulate_many",
        _lanes,
        {
            "system": OBJECT,
            "q": ARRAY,
            "v": ARRAY,
            "cycles": COUNT,
            "rtol": RTOL,
            "parameters": (*MAPPING, {"nope": [1.0]}, {"stance_torque": ["x"]}, {"stance_torque": [1.0, 2.0]}),
            "observe": FLAG,
            "unroll": FLAG[1:],
            "max_step": RTOL[1:],
            "on_lanes": CALL,
        },
    ),
    (
        ":vary",
        _monopod,
        {"robot": OBJECT, "nope": (1.0,), "knee_ratio": POSITIVE, "boom_damping": NOT_NEGATIVE},
    ),
    (
        ":monopod",
        lambda: {**_quadruped(), "leg": "anterior_left"},
        {"robot": OBJECT, "leg": NAME, "body": NOT_NEGATIVE, "locked": (*NAMES, ["nope"])},
    ),
    (":sagittal", _quadruped, {"robot": (*OBJECT, hop), "pairs": (5, "ab", [], [5, 5], [("a", "b"), ("c", "d")])}),
    (
        "model.legs:find_legs",
        _quadruped,
        {"robot": OBJECT, "toes": (*NAMES, ["hoof"], ["torso"]), "sides": ("x", 0, 1.5, {"nope": 1}, [1], True)},
    ),
    (":HoppingLaw.scaled", _monopod, {"robot": OBJECT, "damping_ratio": NOT_NEGATIVE[1:]}),
    (
        "studies.comparison:sides_of",
        lambda: {"items": ["spear_ii", "q_spear"]},
        {
            "items": (None, 5, [], ["spear_ii"], ["spear_ii", None], ["spear_ii", 5], ["spear_ii", ""]),
            "names": (*NAMES, ["one"]),
            "cycles": (*COUNT, 51),
            "of": OPTIONAL,
        },
    ),
    (":Spring.scaled", _monopod, {"robot": OBJECT}),
    (":Gait.load", dict, {"path": (*PATH, "nope", "none.json")}),
    (":Gait.save", lambda: {"self": gait()}, {"path": (*PATH, "no/such.json")}),
    (":Gait.with_law", lambda: {"self": gait()}, {"nope": (1.0,), "epsilon": POSITIVE, "lift_off": NAME}),
    (":Trajectory.load", dict, {"path": (*PATH, "none.npz")}),
    (":Trajectory.save", lambda: {"self": motion()}, {"path": (*PATH, "no/such.npz")}),
    (":Trajectory.export", lambda: {"self": motion()}, {"path": (*PATH, "a.nope", "no/such.csv")}),
    *(
        (f":Robot.{query}", _at_rest, {"q": (*ARRAY, [NAN] * 3, [1e200] * 3)})
        for query in ("mass_matrix", "gravity", "potential_energy")
    ),
    *(
        (
            f":Robot.{query}",
            lambda: _at_rest() | {"v": [0.0] * 3},
            dict.fromkeys("qv", (*ARRAY, [NAN] * 3, [1e200] * 3)),
        )
        for query in ("coriolis_matrix", "bias", "kinetic_energy")
    ),
    (":Robot.toe_position", _at_rest, {"toe": NAME}),
    (":Robot.frame_position", _at_rest, {"frame": NAME}),
    (":Robot.index", lambda: {"self": hop().robot}, {"coordinate": NAME}),
    ("model.catalogue:motor", dict, {"name": NAME}),
    ("model.catalogue:gearbox", dict, {"name": NAME}),
    ("model.pinned:pin_toe", _monopod, {"robot": OBJECT, "joint": NAME}),
    ("model.mjcf:to_mjcf", _monopod, {"robot": OBJECT, "postures": (5, "x", {"a": [1.0]}, {"a": "x"})}),
    ("model.srdf:to_srdf", lambda: {"robot": gait().system.robot}, {"robot": OBJECT, "postures": (5, {"a": [1.0]})}),
    (
        "model.spring:belt_stiffness",
        lambda: dict.fromkeys(("modulus", "area", "length", "radius"), 1.0),
        dict.fromkeys(("modulus", "area", "length", "radius"), POSITIVE),
    ),
    ("model.motor:Gearbox", lambda: {"ratio": 15.0}, {"ratio": POSITIVE, "efficiency": (*POSITIVE, 1.5)}),
    ("hybrid.hardware:Sensing", dict, {"angle_noise": NOT_NEGATIVE, "losses": NOT_NEGATIVE, "seed": COUNT[:4]}),
    (
        "hybrid.parameters:with_hardware",
        lambda: {"system": hop(), "hardware": None},
        {"system": OBJECT, "hardware": OPTIONAL},
    ),
    (
        "gaits.series_hopping:series_hopping",
        lambda: {"robot": import_module("spear_pin").load("spear_ii_series")},
        {"robot": OBJECT, "law": OPTIONAL, "contact": OPTIONAL},
    ),
    (
        "gaits.round_hopping:round_hopping",
        lambda: {"robot": import_module("spear_pin").load("hoppy")},
        {"robot": OBJECT, "law": OPTIONAL, "spring": OPTIONAL, "contact": OPTIONAL},
    ),
    (
        "gaits.feedback:regulated",
        lambda: {"gait": gait()},
        {"gait": OBJECT, "inputs": (5, ["nope"], [5]), "weight": POSITIVE},
    ),
    ("gaits.feedback:speed_regulated", lambda: {"gait": gait()}, {"gait": OBJECT, "gain": ("x", [], NAN)}),
    (
        "gaits.request:Request",
        dict,
        {
            "speed": POSITIVE[1:],
            "objective": NAME,
            "lift_off": NAME,
            "friction": POSITIVE,
            "stiffness": NOT_NEGATIVE[1:],
        },
    ),
    ("studies.push_test:spear_ii", dict, {"ratio": ("x", 0.0, -1.0, NAN, [], True)}),
    ("studies.push_test:equilibrium", lambda: {"leg": leg(), "knee": knee()}, {"leg": OBJECT, "knee": OBJECT}),
    (
        "studies.push_test:release",
        _push,
        {"leg": OBJECT, "knee": OBJECT, "depth": (*NOT_NEGATIVE, 1.0), "duration": POSITIVE},
    ),
    ("studies.push_test:swing", lambda: {"leg": leg(), "knee": knee()}, {"leg": OBJECT, "knee": OBJECT}),
    (
        "studies.push_test:PassiveKnee",
        dict,
        {
            "stiffness": (*NOT_NEGATIVE, 1e300),
            "damping": NOT_NEGATIVE,
            "coulomb": NOT_NEGATIVE,
            "zero": NUMBER,
            "unilateral": FLAG,
        },
    ),
    (
        "studies.laboratory:synthesize",
        _push,
        {"leg": OBJECT, "knee": OBJECT, "repeats": COUNT, "rate": POSITIVE, "seed": COUNT[:4], "instrument": OPTIONAL},
    ),
    ("studies.laboratory:Instrument", dict, {"noise": NOT_NEGATIVE, "quantum": NOT_NEGATIVE, "drift": NUMBER}),
    ("studies.laboratory:write_csv", lambda: {"record": None, "path": "a.csv"}, {"record": OBJECT}),
    ("studies.sweep:grid", dict, {"axes": (*MAPPING, {"a": ["x"]})}),
    (
        "studies.sweep:sample",
        lambda: {"ranges": {"stiffness": (40.0, 50.0)}, "n": 4},
        {
            "ranges": (*MAPPING, {"a": (1,)}, {"a": ("x", "y")}, {"a": (NAN, 1.0)}),
            "n": COUNT,
            "method": NAME,
            "seed": COUNT[:4],
        },
    ),
    (
        "studies.sweep:sweep",
        lambda: {"system": hop(), "points": {"stiffness": [47.0]}, "out": "a.zarr"},
        {
            "system": OBJECT,
            "points": (*MAPPING, {"nope": [1.0]}, {"stiffness": ["x"]}, {"stiffness": []}, {"stiffness": [NAN]}, {}),
            "out": PATH,
            "vary": (5, [5], ["nope"]),
            "target": (5, "x", {"nope": 1.0}),
            "rtol": RTOL,
            "chunk": COUNT,
            "resume": FLAG,
        },
    ),
    ("studies.bound:mean_speed", lambda: {"gait": gait()}, {"gait": OBJECT, "rtol": RTOL}),
    ("studies.bound:at_speed", lambda: {"gait": gait(), "speed": 1.5}, {"gait": OBJECT, "speed": POSITIVE}),
    ("studies.basin:midway", lambda: {"gait": gait(), "phase": "x"}, {"gait": OBJECT, "phase": NAME}),
    (
        "studies.identification:read_record",
        lambda: {"path": "a.csv"},
        {"path": (*PATH, "none.csv", "none.mat"), "calibration": OPTIONAL},
    ),
    ("viz.plots:save_figure", lambda: {"figure": None, "path": "a.svg"}, {"figure": OBJECT}),
    ("viz.plots:hop_summary", lambda: {"trajectory": motion()}, {"trajectory": OBJECT, "gait": OPTIONAL}),
    (
        "viz.player:record",
        lambda: {"robot": hop().robot, "trajectory": motion(), "path": "a.html"},
        {"robot": OBJECT, "trajectory": OBJECT, "path": (*PATH, "no/such.html")},
    ),
)
