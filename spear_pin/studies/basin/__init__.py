"""Disturbances from which a gait comes back to its orbit.

`recovery` pushes a gait in mid-flight and simulates on. `attraction` does so for many states at once, and `robustness`
for random numbers. The last two need heyoka and are imported from their modules.
"""

from spear_pin.studies.basin.recovery import Recovery, airborne, basin, midway, push_moment, recover

__all__ = ["Recovery", "airborne", "basin", "midway", "push_moment", "recover"]
