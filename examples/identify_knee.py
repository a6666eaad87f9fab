"""Stiffness, damping and rest angle of the knee, from raw volts to a table with error bars.

Objective: go the way of Section 4.1: three depths, with the motor and without, five releases each; read a
potentiometer's voltage, smooth it over 100 samples, fit the model, print a table like Table 4.1. The records are
synthetic, for the source's are not public: put your own files in their place.

Notice that the estimates lie within two or three of their error bars of the truth, which those of a smoothed record
do only if its residuals are known to be correlated; that RA is the spring's zero, 0.2 rad below where the leg rests;
and what is said of a leg whose pinned toe would have left the ground.

Writes one CSV file per row and identify_knee.svg into the current folder, or the one given: python identify_knee.py OUT
"""

import sys
from pathlib import Path

from spear_pin.studies.identification import Calibration, MovingAverage, cut, identify, read_record, smoothed
from spear_pin.studies.laboratory import Instrument, synthesize, write_csv
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, WITHOUT_MOTOR, spear_ii
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.identification import fit_summary

POTENTIOMETER = Calibration(volts_per_rad=1.06, offset=0.4)
SMOOTHING = MovingAverage(window=100)  # at 1 kHz, as the source's


def main(out: Path) -> None:
    """Make the records, identify from them, print and draw."""
    estimates = {}
    head = ("k_rot, N·m/rad", "b, N·m·s/rad", "RA, rad")
    print(f"{'':<18}" + "".join(f"{name:>24}" for name in head) + f"{'fit':>10}")
    for motor in (True, False):
        leg = spear_ii(ratio=15.0 if motor else None)
        truth = WITH_MOTOR if motor else WITHOUT_MOTOR
        for depth in DEPTHS:
            label = f"{'motor' if motor else 'no motor'} {100 * depth:g} cm"
            made = synthesize(leg, truth, depth, instrument=Instrument(POTENTIOMETER), seed=len(estimates))
            path = write_csv(made, out / f"{label.replace(' ', '_')}.csv")

            record = read_record(path, calibration=POTENTIOMETER)
            releases, remarks = cut(record)
            estimate = identify(leg, [smoothed(release, SMOOTHING) for release in releases])

            estimates[label] = estimate
            found = [estimate[name] for name in ("stiffness", "damping", "rest_angle")]
            cells = "".join(f"{f'{each.value:.4f} ± {each.deviation:.4f}':>24}" for each in found)
            print(f"{label:<18}{cells}{estimate.fit:>8.1f} %")
            for remark in (*record.remarks, *remarks, *estimate.warnings[:1]):
                print(f"    {remark}")
        print(f"{'truth':<18}{truth.stiffness:>24.3f}{truth.damping:>24.3f}{truth.zero:>24.3f}")
    print("synthetic records, not measured")
    print(save_figure(fit_summary(estimates), out / "identify_knee.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path())
