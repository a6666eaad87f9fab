"""Searches of a payoff study in processes; each is kept in its store, and read from there when it is needed again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from spear_pin.model.robot import Robot
from spear_pin.studies import workers
from spear_pin.studies.payoff import gaits as of_gaits
from spear_pin.studies.payoff.gaits import Gaits
from spear_pin.studies.payoff.motors import Motors
from spear_pin.studies.payoff.searches import Search, SearchEnd, of_json, to_json
from spear_pin.studies.payoff.store import Store

PURPOSE = "a payoff study in several processes"
Tell = Callable[[str], object]


@dataclass(frozen=True)
class Searcher:
    """Searches for a robot with its motors, in processes, each kept in a store.

    Attributes:
        gaits: the kind of gait.
        robot: robot in the plane, with the motors' rotors.
        motors: motors of the robot.
        store: where findings are kept.
        n_jobs: number of processes.
        tell: called with messages about progress, in words.
    """

    gaits: Gaits
    robot: Robot
    motors: Motors
    store: Store
    n_jobs: int | None = 1
    tell: Tell = lambda text: None

    def find(self, searches: Sequence[Search]) -> list[SearchEnd]:
        """Returns the findings of some searches, in their order."""
        missing = {each.key: each for each in searches if self.store.get(each.key) is None}
        if missing:
            words, left = self.gaits.words, len(missing)
            self.tell(f"searching for {words.of(next(iter(missing.values())).point)}")
            arguments = [(self.gaits, self.robot, self.motors, each) for each in missing.values()]
            for finding in workers.each(of_gaits.attempt, arguments, self.n_jobs, PURPOSE):
                self.store.keep(to_json(finding))
                left -= 1
                found = "no gait" if finding.figures is None else f"{finding.figures.cost:.4g}"
                done = f"{len(self.store)} searches done, {left} left in this round"
                self.tell(f"{done}; the last for {words.of(finding.point)}: {found}")
        return [of_json(self.store.get(each.key) or {}) for each in searches]
