"""Design maps: fixed points and multipliers over any parameters, in chunks, on any number of processes.

`points` make a `job`; its `chunks` are solved and kept in a `store`.
"""

from spear_pin.studies.sweep.chunks import reasons, sweep, table
from spear_pin.studies.sweep.points import grid, sample

__all__ = ["grid", "reasons", "sample", "sweep", "table"]
