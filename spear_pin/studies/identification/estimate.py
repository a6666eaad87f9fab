"""Estimated parameters with their standard deviations, and how far to trust them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.studies.identification.quantities import KNEE, QUANTITIES
from spear_pin.studies.identification.rounding import Rounding
from spear_pin.studies.identification.trials import Trial
from spear_pin.studies.push_test import PassiveKnee


@dataclass(frozen=True)
class Parameter:
    """An estimated parameter.

    Attributes:
        name: a name of `QUANTITIES`.
        trial: number of the trial to which it belongs; None if all trials share it.
        value: value in the quantity's unit.
        deviation: its standard deviation.
        inflation: factor in the deviation by the correlation of rounding errors.
    """

    name: str
    trial: int | None
    value: float
    deviation: float
    inflation: float = 1.0

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return QUANTITIES[self.name].unit

    @property
    def label(self) -> str:
        """The name, with the number of the trial counted from 1."""
        return self.name if self.trial is None else f"{self.name} of release {self.trial + 1}"


@dataclass(frozen=True)
class Estimate:
    """Estimated parameters, and how far to trust them.

    Attributes:
        parameters: estimated parameters; those of the knee first.
        covariance: covariance of all parameters, in their order.
        condition: condition of the residuals' Jacobian with columns of length one.
        knees: torque law of the knee, for each trial.
        rotors: reflected rotor inertia, for each trial, in kg·m².
        trials: the trials as they were fitted.
        predicted: the model's angle for each trial, smoothed as the data were, in rad.
        fits: 100 (1 - ‖y - ŷ‖ / ‖y - ȳ‖) for each trial, MATLAB's NRMSE fit, in percent.
        noise: standard deviation of the angle's errors before smoothing, with rounding, in rad; for a robust loss, that
            which least squares would need for the same error bars.
        roundings: how each trial's angle was rounded, as far as its values before smoothing tell.
        whiteness: probability that white noise has residuals as correlated as these, before smoothing
            (Ljung and Box); None where the angle before smoothing is not known, or there is no noise.
        warnings: warnings for the reader.
        converged: whether the solver met its tolerances.
        integrations: number of integrations of a release: a motion counts one, one with sensitivities as many as it
            has.
    """

    parameters: tuple[Parameter, ...]
    covariance: Array
    condition: float
    knees: tuple[PassiveKnee, ...]
    rotors: tuple[float, ...]
    trials: tuple[Trial, ...]
    predicted: tuple[Array, ...]
    fits: tuple[float, ...]
    noise: float
    roundings: tuple[Rounding, ...]
    whiteness: float | None
    warnings: tuple[str, ...]
    converged: bool
    integrations: int

    def __getitem__(self, name: str) -> Parameter:
        """Returns the shared parameter of a name, or the only one.

        Raises:
            UnknownName: it was not estimated, or each trial has its own.
        """
        found = [p for p in self.parameters if p.name == name]
        if len(found) != 1:
            raise UnknownName("shared parameter", name, [p.name for p in self.parameters if p.trial is None])
        return found[0]

    def covariance_of(self, names: Sequence[str]) -> Array:
        """Returns the covariance of shared parameters in the order of their names, (m, m).

        Raises:
            UnknownName: a parameter was not estimated, or each trial has its own.
        """
        places = [self.parameters.index(self[name]) for name in names]
        return np.asarray(self.covariance[np.ix_(places, places)])

    @property
    def fit(self) -> float:
        """NRMSE fit over all trials together, each about its own mean, in percent."""
        missed = sum(float(((t.angle - y) ** 2).sum()) for t, y in zip(self.trials, self.predicted, strict=True))
        spread = sum(float(((t.angle - t.angle.mean()) ** 2).sum()) for t in self.trials)
        return 100.0 * (1.0 - float(np.sqrt(missed / spread)))

    @property
    def inflation(self) -> float:
        """Largest inflation among the knee's parameters."""
        return max(p.inflation for p in self.parameters if p.name in KNEE)

    @property
    def correlation(self) -> Array:
        """Correlation matrix of the parameters, in their order."""
        deviation = np.sqrt(np.diag(self.covariance))
        with np.errstate(invalid="ignore"):  # without any noise
            return np.asarray(self.covariance / np.outer(deviation, deviation))
