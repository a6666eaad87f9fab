"""How late a foot switch may engage and release the spring: `python -m benchmarks.late_switch`, Markdown.

SPEAR-II hops with a flight of 0.2 s. Each row is a gait that was found from the one above. The damper of the knee acts
throughout stance, whatever the switch does. It takes half a minute.
"""

from __future__ import annotations

import numpy as np

from benchmarks.markdown import table
from spear_pin import Clutch, Gait, HoppingLaw, Spring, Trajectory, find_gait, hopping, load, simulate
from spear_pin.errors import NoGait
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.studies.hop import spring_share

DELAYS = (0, 0.5, 1, 2, 4, 6, 8, 10, 12, 14, 16, 16.5, 17, 18, 20, 22, 24, 26, 27, 28, 30)  # ms
PLAYS = (0.0, 0.01, 0.025, 0.05, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2)  # rad
HEADS = ("stance torque, N·m", "stance, s", "motor's work, J", "damper's loss, J", "spring's share, %")
LAST = ("largest multiplier", "toe alternates, ms")


def main() -> None:
    """Print both tables."""
    table(("delay, ms", *HEADS, *LAST), rows(late()))
    table(("play, rad", *HEADS, *LAST), rows([(f"{play:g}", Clutch(play=play, damper="joint")) for play in PLAYS]))


def late() -> list[tuple[str, Clutch]]:
    """Returns switches that are late, each with its delay in ms."""
    return [(f"{ms:g}", Clutch(1e-3 * ms, 1e-3 * ms, damper="joint")) for ms in DELAYS]


def rows(clutches: list[tuple[str, Clutch]]) -> list[tuple[str, ...]]:
    """Returns a row for each switch, up to the first with which no hop is found."""
    found = []
    for name, gait in walked(clutches):
        if isinstance(gait, str):
            found.append((name, gait, *[""] * (len(HEADS) + len(LAST) - 1)))
            break
        hop = simulate(gait.system, gait.state, cycles=1)
        numbers = gait.parameters["stance_torque"], gait.durations["stance"]
        work = hop.ledger["motor_knee"][0], hop.ledger["damping"][0], 100 * spring_share(hop)
        cells = [f"{value:.4f}" for value in numbers], [f"{value:.2f}" for value in work[:2]], [f"{work[2]:.1f}"]
        largest = f"{np.abs(gait.multipliers).max():.3f}"
        found.append((name, *(cell for part in cells for cell in part), largest, f"{1e3 * alternating(hop):.2g}"))
    return found


def walked(clutches: list[tuple[str, Clutch]]) -> list[tuple[str, Gait | str]]:
    """Returns the gait with each switch, or why there is none."""
    robot, law, before = load("spear_ii", locked=["boom_x"]), HoppingLaw(hold_extension=True), None
    found: list[tuple[str, Gait | str]] = []
    for name, clutch in clutches:
        own = law if before is None else before.system.law
        try:
            system = hopping(robot, own, Spring(clutch=clutch))
            guess = None if before is None else before.state
            before = find_gait(system, ["stance_torque"], {"flight_time": 0.2}, guess=guess)
            found.append((name, before))
        except NoGait as error:
            found.append((name, f"no gait: {str(error).removeprefix('no gait found: ').split(';')[0]}"))
    return found


def alternating(hop: Trajectory) -> float:
    """Returns how long the toe alternates between ground and air, in s."""
    at, domain = hop.t, hop.domain
    steps = np.diff(at) * ((domain[1:] == CHATTER) & (domain[:-1] == CHATTER))
    return float(steps.sum())


if __name__ == "__main__":
    main()
