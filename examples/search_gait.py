"""Search for a bounding gait from a request alone, without a gait as initial guess.

Objective: go from a request to a gait: search, save, draw. The request is that of the shipped gait `long_stride_2.75`,
with one change. The hips' squared torques count tenfold, as if the hips' motors were too small.

What to notice: the optimiser starts on a coarse mesh from legs that merely sweep, and continues on a finer mesh. It
sees the motion only on its mesh. So the program then solves its result as a fixed point of the event-exact simulation,
and this fixed point is the gait. The largest hip torque falls by a third. The largest knee torque rises by as much, and
so does the cost of transport. Both gaits are local optima, so a better gait may exist. The request does not ask for
stability, and the gait is not stable.

Needs casadi: pip install '.[optimize]'

Run: python examples/search_gait.py [FOLDER]
"""

import sys
from dataclasses import replace
from pathlib import Path

from spear_pin import Gait, load, simulate
from spear_pin.gaits.library import REQUESTS
from spear_pin.gaits.optimize import search
from spear_pin.studies.bound import summarize
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.bound import bound_summary


def report(title: str, gait: Gait) -> None:
    figures = summarize(gait, simulate(gait.system, gait.state))
    print(f"{title}: {figures['speed']:.3f} m/s, {figures['stride']:.3f} m a stride")
    effort = figures["effort_per_distance"]
    print(f"  cost of transport {figures['cost_of_transport']:.3f}, effort a metre {effort:.0f} N²·m·s")
    for kind in ("knee", "hip"):
        torques = [figures["peak_torque_stance"][f"{leg}_{kind}"] for leg in ("posterior", "anterior")]
        print(f"  {kind} motors, peak in stance: {torques[0]:.1f} posterior, {torques[1]:.1f} anterior, N·m")
    print(f"  residual {gait.residual:.1e}, largest multiplier {abs(gait.multipliers[0]):.4f}")


def main(folder: Path) -> None:
    request = replace(REQUESTS["long_stride_2.75"], objective="hip")

    def tell(iteration: int, objective: float, violation: float) -> None:
        if iteration % 20 == 0:
            print(f"  iteration {iteration:3d}: objective {objective:9.4f}, violation {violation:.1e}", flush=True)

    print("searching, over a coarse mesh first:")
    gait, solution = search(load("q_spear"), request, on_iteration=tell)
    print(f"  {solution.status} after {solution.iterations} iterations on the fine mesh")
    report("least effort, the hips' tenfold", gait)
    report("least effort, as shipped", Gait.load("long_stride_2.75"))
    figure = bound_summary(simulate(gait.system, gait.state, 2), gait)
    print("files", gait.save(folder / "searched.json"), save_figure(figure, folder / "searched.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
