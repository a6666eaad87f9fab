"""Switchable parallel elastic legs on Pinocchio: dynamics, hybrid simulation, periodic gaits.

The public names are imported when first used, so that `import spear_pin` costs next to nothing. `__init__.pyi` lists
them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = "0.1.0.dev0"
