"""How a gait changes with one more unit of a number: a table of exact derivatives."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.files import plain
from spear_pin.gaits.sensitivity.measure import MULTIPLIER, DualMeasure, estimate_rounding
from spear_pin.gaits.sensitivity.multipliers import along_branch, moduli
from spear_pin.gaits.sensitivity.orbit import branch, orbit_of_gait
from spear_pin.gaits.sensitivity.spread import covariance_of
from spear_pin.gaits.sensitivity.uncertainty import Uncertainty
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number, unit
from spear_pin.hybrid.result import State
from spear_pin.kinds import typed
from spear_pin.model.motor import NO_MOTORS, Drive, Motor
from spear_pin.showing import Shown
from spear_pin.words import show_unit

NOTHING = 1e-9  # elasticities up to this are rounding


@dataclass(frozen=True, repr=False)
class Sensitivity(Shown):
    """Derivatives of a gait with respect to parameters; the gait is found again for each change.

    Attributes:
        system: the system.
        at: (q, v) on the section.
        parameters: names of the parameters.
        keep: names of the measures that keep their values.
        given: values of the parameters, (m,).
        units: units of the parameters, empty where nothing says one.
        state: derivatives of (q, v) on the section, (2 nv, m).
        solved: derivatives of the numbers that are solved for, by name, (m,) each.
        outputs: values of the solved numbers, of the measures and of the multipliers' moduli, by name.
        output_units: units of the outputs.
        derivatives: derivatives of the outputs, by name, (m,) each.
        multipliers: Floquet multipliers by decreasing modulus, (d,).
        multiplier_derivatives: derivatives of the multipliers, (d, m), NaN where the order of events changes too near.
        one_sided: events that meet another in this gait; their derivatives hold for the order that happens.
        motors: motors whose heat, or drives whose electricity, is among the outputs, by the names of their joints.

    Example:
        >>> from spear_pin import find_gait, hopping, load
        >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
        >>> table = gait.sensitivity(["stiffness"])
        >>> round(float(table.derivatives["apex_height"][0]) * 1e3, 3)  # mm for one N·m/rad more
        -0.075
    """

    system: HybridSystem
    at: State
    parameters: tuple[str, ...]
    keep: tuple[str, ...]
    given: Array
    units: tuple[str, ...]
    state: Array
    solved: Mapping[str, Array]
    outputs: Mapping[str, float]
    output_units: Mapping[str, str]
    derivatives: Mapping[str, Array]
    multipliers: NDArray[np.complex128]
    multiplier_derivatives: NDArray[np.complex128]
    one_sided: tuple[str, ...]
    motors: Mapping[str, Motor | Drive]

    def __repr__(self) -> str:
        return f"Sensitivity({len(self.outputs)} outputs over {', '.join(self.parameters)})"

    def __str__(self) -> str:
        names, units = (max(map(len, each)) for each in (self.outputs, self.output_units.values()))
        head = " ".join(f"{name:>14.14}" for name in self.parameters)
        lines = [f"{'':{names + units + 1}} {'value':>12} {head}   (% for one more %)"]
        for name, value in self.outputs.items():
            row = " ".join(f"{_said(each):>14}" for each in self.elasticity(name).tolist())
            value = value if abs(value) > estimate_rounding(name) else 0.0
            unit = show_unit(self.output_units[name])
            lines.append(f"{name:{names}} {unit:{units}} {value:12.6g} {row}")
        if self.one_sided:
            lines.append(f"one-sided, for events meet in this gait: {', '.join(self.one_sided)}")
        return "\n".join(lines)

    @property
    def measures(self) -> tuple[str, ...]:
        """Names of the outputs: solved numbers, measures and multipliers."""
        return tuple(self.outputs)

    @property
    def values(self) -> Array:
        """Derivatives of the outputs, (measures, parameters)."""
        return np.array([self.derivatives[name] for name in self.outputs])

    def elasticity(self, output: str) -> Array:
        """Returns the change of an output in % per 1 % of each parameter, (m,); NaN if it is zero up to rounding.

        Raises:
            UnknownName: there is no such output.
        """
        if output not in self.outputs:
            raise UnknownName("output", output, self.outputs)
        value = self.outputs[output]
        found: Array = (
            self.derivatives[output] * self.given / (value if abs(value) > estimate_rounding(output) else np.nan)
        )
        return found

    @typed
    def uncertainty(self, spread: Mapping[str, float | str] | ArrayLike) -> Uncertainty:
        """Returns how far outputs spread where parameters do, to first order: σ² = g Σ gᵀ.

        Args:
            spread: standard deviations by the parameters' names, in their units or as text in per cent of their values,
                such as "2 %"; errors are independent, and a parameter that is left out is exact. Or the covariance, (m,
                m), in the order of `parameters`.

        Raises:
            UnknownName: a name is not in `parameters`.
            BadValue: a deviation is not a finite number >= 0, or a matrix is not a covariance.

        Example:
            >>> from spear_pin import find_gait, hopping, load
            >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
            >>> table = gait.sensitivity(["stiffness", "damping"])
            >>> spread = table.uncertainty({"stiffness": 0.5, "damping": "2 %"})
            >>> round(spread.deviation("apex_height") * 1e3, 2), spread.best("apex_height")  # mm
            (1.88, 'damping')
        """
        return Uncertainty(self, covariance_of(spread, self.parameters, self.given))

    def to_json(self) -> str:
        """Returns the whole table as JSON."""
        data = {
            "parameters": dict(zip(self.parameters, self.given.tolist(), strict=True)),
            "units": dict(zip(self.parameters, self.units, strict=True)),
            "outputs": {
                name: {
                    "value": value,
                    "unit": self.output_units[name],
                    "derivatives": self.derivatives[name],
                }
                for name, value in self.outputs.items()
            },
            "solved": dict(self.solved),
            "one_sided": list(self.one_sided),
            "multipliers": [[value.real, value.imag] for value in self.multipliers.tolist()],
        }
        return json.dumps(plain(data), indent=1)


@typed
def sensitivity(
    system: HybridSystem,
    state: State,
    over: Sequence[str],
    vary: Sequence[str] = (),
    keep: Sequence[str] = (),
    motors: Mapping[str, Motor | Drive] = NO_MOTORS,
) -> Sensitivity:
    """Returns derivatives of a gait's state, measures and multipliers with respect to parameters.

    The derivatives are exact: they come from the cycle's own equations, through its events. Those of the multipliers
    come from differences of exact Jacobians along the branch. If the cycle has no derivative, because a guard grazes or
    two events meet, the function raises an error.

    See `Gait.sensitivity` for the arguments besides the system and the state (q, v) on its section.

    Raises:
        BadValue: the state is not a fixed point of the return map; for the rest see there.
    """
    orbit = orbit_of_gait(system, state, over, vary, keep, motors)
    chain = branch(orbit, keep)
    solved_for = dict(zip(vary, chain[orbit.dimension :], strict=False))
    multipliers, slopes = along_branch(orbit, over, orbit.start @ chain, solved_for)
    found = {name: DualMeasure(number(system, name), row, unit(system, name)) for name, row in solved_for.items()}
    found |= {
        name: DualMeasure(each.value, each.derivative @ chain, each.unit) for name, each in orbit.measures.items()
    }
    for i, (value, slope) in enumerate(zip(*moduli(multipliers, slopes), strict=True)):
        found[f"{MULTIPLIER}{i + 1}"] = DualMeasure(float(value), slope, "1")
    return Sensitivity(
        system,
        state,
        tuple(over),
        tuple(keep),
        np.array([number(system, name) for name in over]),
        tuple(unit(system, name) for name in over),
        orbit.start @ chain,
        solved_for,
        {name: each.value for name, each in found.items()},
        {name: each.unit for name, each in found.items()},
        {name: each.derivative for name, each in found.items()},
        multipliers,
        slopes,
        orbit.cycle.borders,
        dict(motors),
    )


def _said(elasticity: float) -> str:
    if not np.isfinite(elasticity):
        return "none"
    return f"{elasticity if abs(elasticity) > NOTHING else 0.0:.4g}"
