"""Logs of a leg that hops: read, cut into stance and flight, replayed by the model, and fitted."""


from spear_pin.studies.logs.log import Column, Log
from spear_pin.studies.logs.phases import LogPhase, find_phases



