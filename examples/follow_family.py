"""Follow both kinds of hop over the torque that drives them, as far as they exist, and say why they end.

Objective: follow the branches of gaits that two hops belong to, one of each kind. The program follows each branch in
both directions by arc length. It passes folds, and borders where the order of events changes. It computes the
multipliers at each point.

What to notice: between 7.60 and 7.78 N·m two hops exist for one torque. In one of them the toe leaves the ground before
the torque switches; in the other it leaves as the torque switches. Between 6.5 and 9 N·m each branch has one end: there
the order of its events would become the order of the other branch. At 7.60 N·m the spring grows slack just before the
toe would leave the ground, so the toe stays on it. The multipliers do not announce these ends: all are far inside the
unit circle.

Run: python examples/follow_family.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import HoppingLaw, continue_gait, find_gait, hopping, load
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.family import family

WITHIN = (6.5, 9.0)  # N·m


def main(folder: Path) -> None:
    robot, branches = load("spear_ii", locked=["boom_x"]), []
    for torque in (7.8, 7.0):
        gait = find_gait(hopping(robot, HoppingLaw(stance_torque=torque)))
        branch = continue_gait(gait, "stance_torque", WITHIN)
        branches.append(branch)
        print(f"from {torque} N·m, {gait.durations['flight']:.3f} s in the air:")
        print(branch)
        least, most = branch.values.min(), branch.values.max()
        largest = branch.largest.max()
        print(f"  {len(branch.gaits)} hops from {least:.4f} to {most:.4f} N·m, multipliers up to {largest:.3f}")
    least, most = branches[0].values.min(), branches[1].values.max()
    print(f"both from {least:.4f} to {most:.4f} N·m")
    print("file", save_figure(family(*branches), folder / "family.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
