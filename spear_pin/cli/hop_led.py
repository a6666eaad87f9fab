"""Continue a hop to the numbers of `spear hop --robot` where a search finds none, or say how far that goes."""

from __future__ import annotations

import argparse
import shlex
from typing import TYPE_CHECKING

from spear_pin.cli.given import given
from spear_pin.errors import NoGait, SpearError

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.studies.hop_led import Way

UNITS = {  # what the numbers are called, as are their options, with their units
    "stiffness": ("stiffness", "N·m/rad"),
    "damping": ("damping", "N·m·s/rad"),
    "hardening": ("hardening", "N·m/rad³"),
    "preload": ("preload", "N·m"),
    "knee_touchdown": ("knee", "rad"),
    "hip_touchdown": ("hip", "rad"),
    "frequency": ("frequency", "Hz"),
    "friction": ("friction", ""),
    "flight_time": ("flight_time", "s"),
    "stance_torque": ("stance_torque", "N·m"),
}
KEPT = ("leg", "bends", "body", "repair", "slope", "foot_placement", *(x for x, _ in UNITS.values() if x != "hip"))
UNSAID = {"knee": 1.0, "slope": 0.0, "foot_placement": 0.0}  # what need not be said
NOWHERE = "SPEAR-II's numbers, scaled to this leg, give no hop either, so there is none to continue from"


def continue_hop(arguments: argparse.Namespace, system: HybridSystem, failure: NoGait) -> Gait:
    """Find the hop that was asked for by continuation from one with SPEAR-II's numbers, scaled.

    Args:
        arguments: of `spear hop`.
        system: the hop of a leg that was asked for.
        failure: of the search for it.

    Raises:
        NoGait: there is none, as far as continuation goes; with how far it goes, what ends it, and what to type.
    """
    from spear_pin.studies.hop_led import lead_hop

    try:
        way = lead_hop(system, given(arguments, "flight_time", "stance_torque"))
    except SpearError:
        raise NoGait(failure.reason, failure.residual, failure.cause or NOWHERE, failure.remedy) from None
    if way.gait is not None:
        return way.gait
    raise NoGait(failure.reason, failure.residual, describe_way(way), write_call(arguments, way))


def describe_way(way: Way) -> str:
    """Say how far a way goes, and what ends it."""
    option, unit = UNITS[way.number]
    name, value = option.replace("_", " "), f"{way.reached:.4g} {unit}".rstrip()
    flight = "" if way.number == "flight_time" else f" with {way.flight_time:.3g} s of flight"
    return f"hops continue from {name} {way.begun:.4g} to {value}{flight}: {way.why}"


def write_call(arguments: argparse.Namespace, way: Way) -> str:
    """Write the call for the hop shortly before a way ends; empty where no option sets the number at which it ends."""
    option, _ = UNITS[way.number]
    if option not in KEPT:
        return ""
    values = given(arguments, *KEPT)
    if way.number != "stance_torque":  # which comes last
        values = {name: value for name, value in values.items() if name != "stance_torque"}
        values["flight_time"] = f"{way.flight_time:.4g}"
    values[option] = f"{way.inside:.4g}"
    words = ["spear", "hop", "--robot", str(arguments.robot)]
    for name, value in values.items():
        if name not in UNSAID or value != UNSAID[name]:
            words += [f"--{name.replace('_', '-')}"] + ([] if value is True else [str(value)])
    return shlex.join(words)
