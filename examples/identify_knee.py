"""Identify stiffness, damping and rest angle of the knee: from raw volts to a table with error bars.

Objective: follow Section 4.1 of the source. The tests have three depths, with the motor and without it, and five
releases each. The program reads a potentiometer's voltage, smooths it over 100 samples, fits the model and prints a
table like Table 4.1. The records are synthetic, because the source's are not public. Put your own files in their place.

What to notice: the estimates are within two or three error bars of the truth. For a smoothed record this holds only if
the fit knows that the residuals are correlated. RA is the spring's zero, 0.2 rad below the angle at which the leg
rests. Remarks below a row say when a leg's pinned toe would have left the ground.

The program writes one CSV file per row and identify_knee.svg into FOLDER, or into the current folder.

Run: python examples/identify_knee.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin.studies.identification import (
    Calibration,
    MovingAverage,
    cut_releases,
    identify,
    read_record,
    smooth_trial,
)
from spear_pin.studies.laboratory import Instrument, synthesize, write_csv
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, WITHOUT_MOTOR, spear_ii
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.identification import fit_summary

POTENTIOMETER = Calibration(volts_per_rad=1.06, offset=0.4)
SMOOTHING = MovingAverage(window=100)  # at 1 kHz, as in the source


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
            releases, remarks = cut_releases(record)
            estimate = identify(leg, [smooth_trial(release, SMOOTHING) for release in releases])

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
