"""Map the hop over its spring and the torque that drives it: where does a hop exist, and is it stable?

Objective: sweep two parameters and solve hundreds of gaits, each with its fixed point and its Floquet multipliers. The
program stores the gaits in a file with which a later session continues. A design map shows what a single gait does not.

What to notice: every point is a gait of its own, solved to 1e-10 in some milliseconds. Flight times jump. With little
torque the toe leaves the ground as the motor's torque switches, at 0.39 s, and the flight lasts 0.12 to 0.17 s. With
more torque the toe leaves earlier, and the flight lasts 0.19 s or longer. So at 50 N·m/rad no torque gives a flight of
0.17 s. In the hatched areas of a map the solver found no hop with a single flight. Run the program twice: the second
time it reads all gaits from the file.

Needs heyoka, joblib, xarray and zarr: pip install '.[sweep]'

Run: python examples/sweep_springs.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

from spear_pin import hopping, load
from spear_pin.errors import MissingExtra
from spear_pin.studies.sweep import grid, reasons, sweep
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.sweep import sweep_map


def main(folder: Path) -> None:
    system = hopping(load("spear_ii", locked=["boom_x"]))

    def tell(done: int, total: int) -> None:
        print(f"  {done} of {total} points", flush=True)

    print("over stiffness and stance torque:")
    points = grid({"stiffness": np.linspace(40.0, 60.0, 11), "stance_torque": np.linspace(6.0, 9.0, 13)})
    given = sweep(system, points, folder / "torques.zarr", resume=True, on_points=tell)
    stance, flight = given["duration"].isel(phase=0).to_numpy(), given["duration"].isel(phase=1).to_numpy()
    print(f"  {np.isfinite(flight).sum()} gaits, {int(given['stable'].sum())} of them stable")
    at_switch = stance > 0.3906
    for stiffness in (46.0, 50.0, 54.0):
        here = (points["stiffness"] == stiffness) & np.isfinite(flight)
        late, early = flight[here & at_switch].max(), flight[here & ~at_switch].min()
        print(f"  {stiffness:.0f} N·m/rad: flights up to {late:.3f} s, and from {early:.3f} s")

    print("over stiffness and gear ratio, the torque solved for 0.2 s of flight:")
    points = grid({"knee_ratio": [13.0, 15.0, 17.0], "stiffness": np.linspace(46.0, 52.0, 7)})
    solved = sweep(
        system, points, folder / "ratios.zarr", ["stance_torque"], {"flight_time": 0.2}, resume=True, on_points=tell
    )
    why = reasons(solved).tolist()
    print(f"  {', '.join(f'{why.count(reason)} {reason}' for reason in sorted(set(why)))}")
    table = solved.set_index(point=["knee_ratio", "stiffness"])["stance_torque"].unstack("point")
    for ratio, row in zip(table["knee_ratio"].to_numpy(), table.to_numpy(), strict=True):
        print(f"  ratio {ratio:2.0f}: stance torque {' '.join(f'{torque:6.3f}' for torque in row)} N·m")
    figures = {"torques": given, "ratios": solved}
    print("files", *(save_figure(sweep_map(data), folder / f"{name}.svg") for name, data in figures.items()))


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    except MissingExtra as missing:
        print(missing)
