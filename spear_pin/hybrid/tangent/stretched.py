"""How far springs are stretched where an arc ends, with derivatives."""

from __future__ import annotations

from functools import partial

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Mount
from spear_pin.hybrid.dual import ARRAYS, Dual, derivative_of, duals, make_varying, value_of
from spear_pin.hybrid.engines.structure import symbols
from spear_pin.hybrid.springs import number_spring, rest_length
from spear_pin.hybrid.tangent.derivative import Stretch
from spear_pin.model.equations import mechanism_of


def measure_stretch(system: HybridSystem, mount: Mount, stretch: Stretch, numbers: Array, dnumbers: Array) -> Dual:
    """Returns how much longer a spring's path is than at rest at the event that ends an arc, in rad or m.

    Args:
        system: the system.
        mount: the spring.
        stretch: the arc, with its derivatives along c directions.
        numbers: the system's run-time parameters without the held values, (p,).
        dnumbers: their derivatives, (p, c).
    """
    nv = system.robot.nv
    mechanism, scalars, _ = symbols(system, mechanism_of(system.robot), {}, make_varying(numbers, dnumbers))
    spring, path = number_spring(mount, system, scalars.springs)
    posed = partial(mechanism.posed, ops=ARRAYS)
    q = duals(stretch.arc.after[:nv], stretch.dstate[:nv] + stretch.end.slopes[:nv, None] * stretch.tau)
    rest = rest_length(mount, spring, path, system.robot, stretch.held, posed)
    found = mount.stretch(spring, path.length(posed(q)), rest, stretch.held)
    return Dual(float(value_of(found)) + 0.0, derivative_of(found))
