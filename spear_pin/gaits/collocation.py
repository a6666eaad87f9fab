"""Direct collocation: a nonlinear programme with named constraints, Hermite-Simpson defects, IPOPT.

It needs CasADi (the extra `optimize`). It does not use CasADi's `Opti`, which has no names for unknowns and
constraints. These names carry starts over from other meshes, and name the violations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import import_extra

Progress = Callable[[int, float, float], object]
Guess = Callable[[str], Array | None]


def casadi(purpose: str = "gait search") -> Any:
    """Returns the CasADi module.

    Args:
        purpose: what needs it, in words.

    Raises:
        MissingExtra: CasADi is not installed.
    """
    return import_extra("casadi", "optimize", purpose)


@dataclass(frozen=True)
class Solution:
    """The end of an optimisation.

    Attributes:
        values: the unknowns by name, in their own units.
        objective: value of the objective.
        violations: largest violation of each named constraint, in its own unit.
        success: whether the optimiser converged to a local optimum that satisfies every constraint.
        status: status that IPOPT reports.
        iterations: number of iterations.
    """

    values: dict[str, Array]
    objective: float
    violations: dict[str, float]
    success: bool
    status: str
    iterations: int


@dataclass(frozen=True)
class Margin:
    """Margin by which a wish may be missed.

    Attributes:
        unknown: name of the margin among the unknowns.
        scale: scale in which the margin counts.
        unit: unit of the scale.
    """

    unknown: str
    scale: float
    unit: str


class Programme:
    """A nonlinear programme under construction.

    `variable` and `require` collect unknowns and constraints; `solve` hands the programme to IPOPT.

    Args:
        start: initial values by name, where there are any; from an earlier `Solution`, see `resample`.
    """

    def __init__(self, start: Guess | None = None) -> None:
        self.objective: Any = 0.0
        self._start = start
        self._unknowns: list[_Unknown] = []
        self._conditions: list[_Condition] = []

    def variable(
        self,
        name: str,
        guess: ArrayLike,
        lower: ArrayLike,
        upper: ArrayLike,
        scale: ArrayLike = 1.0,
        *,
        unit: ArrayLike = 1.0,
    ) -> Any:
        """Adds new unknowns, as many as the guess has numbers.

        Args:
            name: name of the unknowns.
            guess: initial values.
            lower: lower bounds.
            upper: upper bounds.
            scale: scale by which they are divided internally.
            unit: unit of all these numbers.
        """
        first = np.atleast_1d(np.asarray(guess, dtype=float)) * unit
        given = self._start(name) if self._start is not None else None
        if given is not None and given.shape == first.shape:
            first = given
        low, high, size = (
            np.broadcast_to(np.multiply(number, unit, dtype=float), first.shape) for number in (lower, upper, scale)
        )
        symbol = casadi().SX.sym(name, len(first))
        first = np.clip(first, low, high)
        self._unknowns.append(_Unknown(name, symbol, first / size, low / size, high / size, size))
        return casadi().DM(size) * symbol

    def require(
        self,
        label: str,
        expression: Any,
        least: ArrayLike,
        most: ArrayLike = np.inf,
        *,
        scale: ArrayLike = 1.0,
        unit: ArrayLike = 1.0,
        wish: str = "",
    ) -> None:
        """Requires least <= expression <= most.

        Args:
            label: label of the constraint, in words; several constraints may share one.
            expression: scalars or a vector.
            least: lower bounds.
            most: upper bounds.
            scale: scale that divides the expression to order one.
            unit: unit of bounds and scale; both are one number if the constraint is a wish.
            wish: unit of the expression if the request asks for it: the relaxed programme may then violate the
                constraint to find the obstacle. Laws of motion must always hold.
        """
        row = casadi().vertcat(expression)
        low, high, size = (
            np.broadcast_to(np.multiply(number, unit, dtype=float), (row.numel(),)) for number in (least, most, scale)
        )
        self._conditions.append(_Condition(label, row / casadi().DM(size), low / size, high / size, size, wish))

    def solve(
        self, *, iterations: int = 500, tolerance: float = 1e-8, on_iteration: Progress | None = None
    ) -> Solution:
        """Finds a local optimum from the guess."""
        ca = casadi()
        x = ca.vertcat(*[unknown.symbol for unknown in self._unknowns])
        problem = {"x": x, "f": self.objective, "g": ca.vertcat(*[condition.row for condition in self._conditions])}
        least, most = (
            np.concatenate([getattr(condition, side) for condition in self._conditions]) for side in ("least", "most")
        )
        options: dict[str, Any] = {
            "print_time": False,
            "error_on_fail": False,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.mu_strategy": "monotone",
            "ipopt.max_iter": iterations,
            "ipopt.tol": tolerance,
        }
        if self._start is not None:
            options["ipopt.mu_init"] = 1e-3
        if on_iteration is not None:
            options["iteration_callback"] = callback = _callback(problem, least, most, on_iteration)
        solver = ca.nlpsol("search", "ipopt", problem, options)
        result = solver(
            x0=np.concatenate([unknown.guess for unknown in self._unknowns]),
            lbx=np.concatenate([unknown.lower for unknown in self._unknowns]),
            ubx=np.concatenate([unknown.upper for unknown in self._unknowns]),
            lbg=least,
            ubg=most,
        )
        stats = solver.stats()
        if on_iteration is not None:
            del callback
        found, rows = np.array(result["x"]).ravel(), np.array(result["g"]).ravel()
        values: dict[str, Array] = {}
        for unknown in self._unknowns:
            n = len(unknown.guess)
            # IPOPT oversteps bounds by some 1e-8
            values[unknown.name] = unknown.scale * np.clip(found[:n], unknown.lower, unknown.upper)
            found = found[n:]
        violations: dict[str, float] = {}
        for condition in self._conditions:
            n = len(condition.least)
            missed = np.maximum(np.maximum(condition.least - rows[:n], rows[:n] - condition.most), 0.0)
            rows = rows[n:]
            worst = float((missed * condition.scale).max(initial=0.0))
            violations[condition.label] = max(violations.get(condition.label, 0.0), worst)
        return Solution(
            values,
            float(result["f"]),
            violations,
            bool(stats["success"]),
            str(stats["return_status"]),
            int(stats["iter_count"]),
        )

    def relaxed(self, start: Guess) -> tuple[Programme, dict[str, Margin]]:
        """Returns the programme in which each named wish may be missed by its own margin, at the cost of the margin.

        Returns:
            the programme; the margin of each wish.
        """
        other = Programme()
        for unknown in self._unknowns:
            given = start(unknown.name)
            guess = unknown.guess if given is None else np.clip(given / unknown.scale, unknown.lower, unknown.upper)
            other._unknowns.append(replace(unknown, guess=guess))
        wishes = {condition.label: condition for condition in self._conditions if condition.wish}
        margins = {label: other.variable(f"margin of {label}", 1.0, 0.0, np.inf) for label in wishes}
        for condition in self._conditions:
            if not condition.wish:
                other._conditions.append(condition)
                continue
            for bound, side in ((condition.least, 1.0), (condition.most, -1.0)):
                if np.isfinite(bound).all():
                    loosened = side * (condition.row - bound) + margins[condition.label]
                    other.require(condition.label, loosened, 0.0)
        other.objective = sum(margins.values())
        return other, {
            label: Margin(f"margin of {label}", float(wish.scale[0]), wish.wish) for label, wish in wishes.items()
        }

    def read(self, expression: Any, solution: Solution) -> Array:
        """Returns an expression's value at a solution."""
        ca = casadi()
        symbols = ca.vertcat(*[unknown.symbol for unknown in self._unknowns])
        x = np.concatenate([solution.values[unknown.name] / unknown.scale for unknown in self._unknowns])
        return np.array(ca.Function("read", [symbols], [ca.vertcat(expression)])(x)).ravel()


def node_name(phase: str, fraction: float, part: str) -> str:
    """Returns the name of the unknowns at a node, by the fraction of the phase that has passed."""
    return f"{phase}@{fraction:.6f}@{part}"


def resample(solution: Solution) -> Guess:
    """Returns a solution's values by name; values at missing nodes are interpolated."""
    series: dict[tuple[str, str], tuple[list[float], list[Array]]] = {}
    for name, value in solution.values.items():
        if "@" in name:
            phase, fraction, part = name.split("@")
            times, values = series.setdefault((phase, part), ([], []))
            times.append(float(fraction))
            values.append(value)

    def guess(name: str) -> Array | None:
        if name in solution.values or "@" not in name:
            return solution.values.get(name)
        phase, fraction, part = name.split("@")
        if (phase, part) not in series:
            return None
        times, values = series[phase, part]
        return np.array([np.interp(float(fraction), times, column) for column in np.array(values).T])

    return guess


@dataclass(frozen=True)
class _Unknown:
    name: str
    symbol: Any
    guess: Array
    lower: Array
    upper: Array
    scale: Array


@dataclass(frozen=True)
class _Condition:
    label: str
    row: Any
    least: Array
    most: Array
    scale: Array
    wish: str


def hermite_simpson(
    programme: Programme, label: str, duration: Any, x: Sequence[Any], slope: Sequence[Any], unit: ArrayLike = 1.0
) -> None:
    """Requires x' = slope over equal intervals by their defects; nodes are at their ends and middles, 2 n + 1."""
    step = duration / ((len(x) - 1) // 2)
    for k in range(0, len(x) - 2, 2):
        (x0, x1, x2), (f0, f1, f2) = x[k : k + 3], slope[k : k + 3]
        programme.require(label, x2 - x0 - step / 6.0 * (f0 + 4.0 * f1 + f2), 0.0, 0.0, unit=unit)
        programme.require(label, x1 - 0.5 * (x0 + x2) - step / 8.0 * (f0 - f2), 0.0, 0.0, unit=unit)


def quadrature(duration: Any, values: Sequence[Any]) -> Any:
    """Returns the integral by Simpson's rule over the nodes of `hermite_simpson`."""
    step = duration / ((len(values) - 1) // 2)
    return sum(step / 6.0 * (values[k] + 4.0 * values[k + 1] + values[k + 2]) for k in range(0, len(values) - 2, 2))


def _callback(problem: dict[str, Any], least: Array, most: Array, tell: Progress) -> Any:
    ca = casadi()
    n, m = problem["x"].numel(), problem["g"].numel()
    names = ca.nlpsol_out()

    class Iteration(ca.Callback):  # type: ignore[misc, name-defined]
        def __init__(self) -> None:
            ca.Callback.__init__(self)
            self.count = 0
            self.construct("iteration", {})

        def get_n_in(self) -> int:
            return len(names)

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, i: int) -> str:
            return str(names[i])

        def get_sparsity_in(self, i: int) -> Any:
            sizes = {"x": n, "lam_x": n, "g": m, "lam_g": m, "f": 1}
            return ca.Sparsity.dense(sizes[names[i]], 1) if names[i] in sizes else ca.Sparsity(0, 0)

        def eval(self, arguments: Sequence[Any]) -> list[int]:
            given = dict(zip(names, arguments, strict=True))
            rows = np.array(given["g"]).ravel()
            tell(self.count, float(given["f"]), float(np.maximum(least - rows, rows - most).max(initial=0.0)))
            self.count += 1
            return [0]

    return Iteration()
