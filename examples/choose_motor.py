"""Choose motor and gear ratio of SPEAR-II's knee for the hop.

Objective: compare two motors, each with several gear ratios. A higher ratio gives the same torque at less current. But
the joint feels the rotor's inertia N² J, so the leg has more inertia to swing and loses more energy when the toe stops.
The motor also runs out of voltage. For each motor and ratio the program solves the hop, 0.2 s in the air, anew. It then
compares the hop with the motor's envelope on 24 V and with its continuous torque.

What to notice: heat falls as the ratio rises, as long as the rotor's inertia is small compared with the leg's. It rises
again when most of the torque accelerates the rotor. With the heavier rotor this occurs at half the ratio. The voltage
limit is reached earlier. With its own motor SPEAR-II would gain from ratios up to 18:1, where 24 V just suffice. Its
own ratio of 15:1 needs a tenth more energy and leaves a margin. No choice here stays within the continuous torque. Most
of the motors' numbers are not the manufacturer's; see docs/explanation/motors.md.

Run: python examples/choose_motor.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import HoppingLaw, load
from spear_pin.model.catalogue import motor
from spear_pin.studies.drivetrain import knee_drives
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.drivetrain import drivetrain

MOTORS = ("spear_ii_knee", "ec_90_flat_260w")
RATIOS = (8.0, 11.0, 15.0, 18.0)
LAW = HoppingLaw(knee_touchdown=0.8)  # rad; with this smaller crouch, stance ends in the same way for every ratio


def main(folder: Path) -> None:
    robot = load("spear_ii", locked=["boom_x"])
    rows = []
    print(f"solving the hop for {len(MOTORS) * len(RATIOS)} knees, some seconds each", flush=True)
    print("motor            ratio  N²J [kg·m²]  battery  heat  impact [J a hop]  rms/continuous  margin [N·m]")
    for row in knee_drives(robot, {name: motor(name) for name in MOTORS}, RATIOS, law=LAW):
        rows.append(row)
        print(
            f"{row.motor:<16}{row.ratio:6.0f}{row.reflected_inertia:13.3f}{row.energy:9.1f}{row.heat:6.1f}"
            f"{row.impact:8.2f}{row.thermal_load:25.2f}{row.margin:14.1f}  {row.reason}",
            flush=True,
        )
    able = [row for row in rows if row.can]
    for title, best in (
        ("least energy", min(able, key=lambda row: row.energy)),
        ("least heat for the motor", min(able, key=lambda row: row.thermal_load)),
    ):
        print(
            f"{title}: {best.motor} at {best.ratio:.0f}:1, {best.energy:.1f} J, {best.thermal_load:.2f} of continuous"
        )
    print("file", save_figure(drivetrain(rows), folder / "motors.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
