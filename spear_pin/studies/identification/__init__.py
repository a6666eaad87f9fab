"""From a laboratory's records to parameters with error bars: read, cut into releases, smooth, estimate."""

from spear_pin.studies.identification.estimate import Estimate
from spear_pin.studies.identification.quantities import NUISANCES, QUANTITIES
from spear_pin.studies.identification.records import Calibration, Record, read_record
from spear_pin.studies.identification.rounding import Rounding
from spear_pin.studies.identification.search import identify
from spear_pin.studies.identification.smoothing import MovingAverage
from spear_pin.studies.identification.trials import Trial, cut_releases, smooth_trial

__all__ = [
    "NUISANCES",
    "QUANTITIES",
    "Calibration",
    "Estimate",
    "MovingAverage",
    "Record",
    "Rounding",
    "Trial",
    "cut_releases",
    "identify",
    "read_record",
    "smooth_trial",
]
