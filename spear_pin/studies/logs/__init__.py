"""Logs of a leg that hops: read, cut into stance and flight, replayed by the model, and fitted."""

from spear_pin.studies.logs.fit import MotionFit, identify_motion
from spear_pin.studies.logs.log import Column, Log
from spear_pin.studies.logs.phases import LogPhase, find_phases
from spear_pin.studies.logs.replaying import Hop, Replay, replay
from spear_pin.studies.logs.spread import Found

__all__ = [
    "Column",
    "Found",
    "Hop",
    "Log",
    "LogPhase",
    "MotionFit",
    "Replay",
    "find_phases",
    "identify_motion",
    "replay",
]
