"""Disturbances from which a gait comes back to its orbit.

`recovery` pushes a gait in mid-flight and runs on; `attraction` asks the same of many states at once, `robustness` of
numbers drawn at random. The last two need heyoka and are imported from their modules.
"""

from spear_pin.studies.basin.recovery import Recovery, airborne, basin, midway, pushed, recover

__all__ = ["Recovery", "airborne", "basin", "midway", "pushed", "recover"]
