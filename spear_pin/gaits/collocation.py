"""Direct collocation: a nonlinear programme with named constraints, Hermite-Simpson defects, IPOPT.

Needs CasADi (the extra `optimize`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import MissingExtra

Array = NDArray[np.float64]
Progress = Callable[[int, float, float], object]


def casadi() -> Any:
    """The CasADi module.

    Raises:
        MissingExtra: it is not installed.
    """
    try:
        import casadi as module
    except ImportError:
        raise MissingExtra("casadi", "optimize", "gait search") from None
    return module


@dataclass(frozen=True)
class Solution:
    """Where the optimiser ended.

    Attributes:
        x: the unknowns.
        multipliers: of bounds and of constraints, to start from again.
        objective: its value.
        violations: largest violation of each named constraint, in its own unit.
        success: whether it converged to a local optimum that satisfies every constraint.
        status: what IPOPT says.
        iterations: how many it took.
    """

    x: Array
    multipliers: tuple[Array, Array]
    objective: float
    violations: dict[str, float]
    success: bool
    status: str
    iterations: int


@dataclass
class Programme:
    """A nonlinear programme under construction.

    `variable` and `require` collect it; `solve` hands it to IPOPT.
    """

    objective: Any = 0.0
    _symbols: list[Any] = field(default_factory=list)
    _guess: list[Array] = field(default_factory=list)
    _lower: list[Array] = field(default_factory=list)
    _upper: list[Array] = field(default_factory=list)
    _rows: list[Any] = field(default_factory=list)
    _least: list[Array] = field(default_factory=list)
    _most: list[Array] = field(default_factory=list)
    _labels: list[str] = field(default_factory=list)
    _scales: list[Array] = field(default_factory=list)
    _wishes: list[bool] = field(default_factory=list)

    def variable(self, guess: ArrayLike, lower: ArrayLike, upper: ArrayLike, scale: float = 1.0) -> Any:
        """New unknowns, as many as the guess has numbers; internally divided by `scale`."""
        start = np.atleast_1d(np.asarray(guess, dtype=float)) / scale
        symbol = casadi().SX.sym(f"x{len(self._symbols)}", len(start))
        self._symbols.append(symbol)
        self._guess.append(start)
        self._lower.append(np.broadcast_to(np.asarray(lower, dtype=float) / scale, start.shape))
        self._upper.append(np.broadcast_to(np.asarray(upper, dtype=float) / scale, start.shape))
        return scale * symbol

    def require(
        self,
        label: str,
        expression: Any,
        least: ArrayLike,
        most: ArrayLike = np.inf,
        *,
        scale: float = 1.0,
        wish: bool = False,
    ) -> None:
        """least <= expression <= most.

        Args:
            label: its name, in words; several may share one.
            expression: scalars or a vector.
            least: lower bounds.
            most: upper bounds.
            scale: the unit in which it is of order one.
            wish: whether it was asked for, and may be given up to find out what is in the way;
                the laws of motion may not.
        """
        row = casadi().vertcat(expression)
        n = row.numel()
        self._rows.append(row / scale)
        self._least.append(np.broadcast_to(np.asarray(least, dtype=float) / scale, (n,)))
        self._most.append(np.broadcast_to(np.asarray(most, dtype=float) / scale, (n,)))
        self._scales.append(np.full(n, scale))
        self._labels += [label] * n
        self._wishes += [wish] * n

    def solve(
        self,
        guess: Array | None = None,
        multipliers: tuple[Array, Array] | None = None,
        *,
        iterations: int = 800,
        tolerance: float = 1e-8,
        on_iteration: Progress | None = None,
    ) -> Solution:
        """A local optimum from the guess, or from an earlier solution."""
        ca = casadi()
        problem = {"x": ca.vertcat(*self._symbols), "f": self.objective, "g": ca.vertcat(*self._rows)}
        lower, upper = np.concatenate(self._lower), np.concatenate(self._upper)
        least, most = np.concatenate(self._least), np.concatenate(self._most)
        options: dict[str, Any] = {
            "print_time": False,
            "error_on_fail": False,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.mu_strategy": "monotone",
            "ipopt.max_iter": iterations,
            "ipopt.tol": tolerance,
        }
        start: dict[str, Any] = {"x0": np.concatenate(self._guess) if guess is None else guess}
        if multipliers is not None:
            options |= {"ipopt.warm_start_init_point": "yes", "ipopt.mu_init": 1e-4}
            start |= {"lam_x0": multipliers[0], "lam_g0": multipliers[1]}
        elif guess is not None:
            options["ipopt.mu_init"] = 1e-3
        if on_iteration is not None:
            options["iteration_callback"] = callback = _callback(problem, least, most, on_iteration)
        solver = ca.nlpsol("search", "ipopt", problem, options)
        result = solver(lbx=lower, ubx=upper, lbg=least, ubg=most, **start)
        stats = solver.stats()
        if on_iteration is not None:
            del callback
        x, rows = np.array(result["x"]).ravel(), np.array(result["g"]).ravel()
        missed = np.maximum(np.maximum(least - rows, rows - most), 0.0) * np.concatenate(self._scales)
        violations: dict[str, float] = {}
        for label, value in zip(self._labels, missed, strict=True):
            violations[label] = max(violations.get(label, 0.0), float(value))
        return Solution(
            x,
            (np.array(result["lam_x"]).ravel(), np.array(result["lam_g"]).ravel()),
            float(result["f"]),
            violations,
            bool(stats["success"]),
            str(stats["return_status"]),
            int(stats["iter_count"]),
        )

    def relaxed(self) -> tuple[Programme, dict[str, Any]]:
        """The programme in which each named wish may be missed by a margin of its own, at the cost of the margin."""
        names = list(dict.fromkeys(label for label, wish in zip(self._labels, self._wishes, strict=True) if wish))
        other = Programme()
        other._symbols, other._guess = list(self._symbols), list(self._guess)
        other._lower, other._upper = list(self._lower), list(self._upper)
        margins = {name: other.variable(1.0, 0.0, np.inf) for name in names}
        i = 0
        for row, least, most, scale in zip(self._rows, self._least, self._most, self._scales, strict=True):
            label, wish = self._labels[i], self._wishes[i]
            i += row.numel()
            if not wish:
                other.require(label, row, least, most)
                continue
            margin = margins[label]
            for bound, side in ((least, 1.0), (most, -1.0)):
                if np.isfinite(bound).all():
                    other.require(label, side * (row - bound) + margin, 0.0)
        other.objective = sum(margins.values())
        return other, margins

    def value(self, expression: Any, x: Array) -> Array:
        """An expression's value at a solution."""
        ca = casadi()
        function = ca.Function("value", [ca.vertcat(*self._symbols)], [ca.vertcat(expression)])
        return np.array(function(x)).ravel()


def hermite_simpson(
    programme: Programme, label: str, duration: Any, x: Sequence[Any], slope: Sequence[Any], scale: float = 1.0
) -> None:
    """Defects of x' = slope over equal intervals; nodes at their ends and middles, 2 n + 1 of them."""
    step = duration / ((len(x) - 1) // 2)
    for k in range(0, len(x) - 2, 2):
        (x0, x1, x2), (f0, f1, f2) = x[k : k + 3], slope[k : k + 3]
        programme.require(label, x2 - x0 - step / 6.0 * (f0 + 4.0 * f1 + f2), 0.0, 0.0, scale=scale)
        programme.require(label, x1 - 0.5 * (x0 + x2) - step / 8.0 * (f0 - f2), 0.0, 0.0, scale=scale)


def quadrature(duration: Any, values: Sequence[Any]) -> Any:
    """Simpson's rule over the nodes of `hermite_simpson`."""
    step = duration / ((len(values) - 1) // 2)
    return sum(
        step / 6.0 * (values[k] + 4.0 * values[k + 1] + values[k + 2]) for k in range(0, len(values) - 2, 2)
    )


def _callback(problem: dict[str, Any], least: Array, most: Array, tell: Progress) -> Any:
    ca = casadi()
    n, m = problem["x"].numel(), problem["g"].numel()
    names = ca.nlpsol_out()

    class Iteration(ca.Callback):  # type: ignore[misc]
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
