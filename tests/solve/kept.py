"""Keeps gaits with what they came from, and verifies them without searching again.

Beside each gait stands the Jacobian of its return map, in the chart of its section, and a hash of what the gait came
from: the text of its recipe, the gaits that it begins with, and the numbers of its robot.
"""

import hashlib
import inspect
import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from spear_pin import Gait
from spear_pin.arrays import Array
from spear_pin.gaits import library
from spear_pin.hybrid.newton import STEP
from spear_pin.hybrid.periodic import chart, differentiate_return_map, eigenvalues, multipliers, residual, return_map

FOLDER = Path(__file__).parents[1] / "solved"
SAME = 1e-6  # of a state that is searched for again, and of a Jacobian's columns
CLOSE = 1e-4  # of multipliers, which differences find
COLUMNS = 1  # of a Jacobian that are found again in the gate
RECIPES: dict[str, "Recipe"] = {}


@dataclass(frozen=True)
class Recipe:
    """How a gait is found.

    Attributes:
        name: name of the gait.
        search: finds it, in minutes.
        begins: names of the shipped gaits, or of those of other recipes, that it begins with.
        extras: modules that the search, or the robot, needs.
        close: by how much multipliers may differ from eigenvalues of the Jacobian; None where the heading is among
            what they belong to, which the section leaves out, or where the map has no derivative.
        columns: how many columns of the Jacobian are found again in the gate; none where another gait of the same law
            stands for it, which differs in some numbers.
    """

    name: str
    search: Callable[[], Gait]
    begins: tuple[str, ...]
    extras: tuple[str, ...] = ()
    close: float | None = CLOSE
    columns: int = COLUMNS

    @property
    def path(self) -> Path:
        """File of the gait; those that ship are in the package."""
        return library.path(self.name) if self.name in library.IN_SPACE else FOLDER / f"{self.name}.json"

    @property
    def beside(self) -> Path:
        """File of the Jacobian and the hash."""
        return FOLDER / f"{self.name}.map.json"

    def came_from(self, gait: Gait) -> str:
        """Hashes what the gait came from."""
        digest = hashlib.sha256(_without_decorator(self.search).encode())
        for name in self.begins:
            digest.update((RECIPES[name].path if name in RECIPES else library.path(name)).read_bytes())
        model = gait.system.robot.model
        for body, placement in zip(model.inertias, model.jointPlacements, strict=True):
            for number in (*body.toDynamicParameters(), *placement.homogeneous.ravel()):
                digest.update(f"{number:.9g}".encode())
        digest.update(" ".join(f"{number:.9g}" for number in model.armature).encode())
        return digest.hexdigest()


def _without_decorator(search: Callable[[], Gait]) -> str:
    source = inspect.getsource(search)
    return source.partition("def ")[2] or source


def solved(
    *begins: str, extras: tuple[str, ...] = (), close: float | None = CLOSE, columns: int = COLUMNS
) -> Callable[[Callable[[], Gait]], Callable[[], Gait]]:
    """Registers a search; what it decorates returns the kept gait."""

    def register(search: Callable[[], Gait]) -> Callable[[], Gait]:
        recipe = RECIPES[search.__name__] = Recipe(search.__name__, search, begins, extras, close, columns)

        @cache
        def kept() -> Gait:
            return Gait.load(recipe.path)

        return kept

    return register


def shipped(name: str, columns: int = COLUMNS) -> None:
    """Registers a gait that ships, of which only the Jacobian is kept here."""
    RECIPES[name] = Recipe(name, lambda: Gait.load(name), (name,))
    RECIPES[name] = replace(RECIPES[name], columns=columns)


def jacobian(name: str) -> Array:
    """Returns the kept Jacobian of a gait's return map, (n, n)."""
    return np.array(json.loads(RECIPES[name].beside.read_text(encoding="utf-8"))["jacobian"])


def keep(recipe: Recipe, search: bool = True) -> Gait:
    """Searches, unless the kept gait is to stay, and writes the gait and what stands beside it."""
    begun = time.process_time()
    gait = recipe.search() if search else Gait.load(recipe.path)
    if recipe.name not in library.IN_SPACE:
        gait.save(recipe.path)
    taken = time.process_time() - begun
    matrix = differentiate_return_map(gait.system, gait.state)
    text = {"from": recipe.came_from(gait), "seconds": round(taken), "jacobian": matrix.tolist()}
    recipe.beside.write_text(json.dumps(text) + "\n", encoding="utf-8")
    return gait


def differences(recipe: Recipe) -> list[str]:
    """Searches again, and says how the result differs from the kept one."""
    kept, found = Gait.load(recipe.path), recipe.search()
    said = []
    if (off := max(np.abs(a - b).max() for a, b in zip(kept.state, found.state, strict=True))) > SAME:
        said.append(f"the state is off by {off:.1e}")
    there = multipliers(kept.system, kept.state)  # some that are kept come from differences
    if (off := np.abs(np.abs(there) - np.abs(found.multipliers)).max()) > CLOSE:
        said.append(f"a multiplier is off by {off:.1e}")
    return said


def faults(recipe: Recipe, columns: int | None = None) -> list[str]:
    """Says what is wrong with a kept gait, by a few cycles instead of a search.

    Some columns of the Jacobian are found again, which another motion, robot or law would change. Where two feet land
    at once the return map has other derivatives on either side; so the columns are found as they were.
    """
    gait, matrix = Gait.load(recipe.path), jacobian(recipe.name)
    system, state = gait.system, gait.state
    said = []
    if json.loads(recipe.beside.read_text(encoding="utf-8"))["from"] != recipe.came_from(gait):
        said.append(f"what it came from has changed: run python -m tests.solve {recipe.name}")
    if (off := residual(system, state)) > 1e-8:
        said.append(f"it is no fixed point: residual {off:.1e}")
    local = chart(system, state)
    seed = int.from_bytes(recipe.name.encode(), "big")
    for j in np.random.default_rng(seed).permutation(local.dimension)[: recipe.columns if columns is None else columns]:
        along = STEP * np.eye(local.dimension)[j]
        ends = [local.coordinates(return_map(system, local.state(sign * along)).state) for sign in (1.0, -1.0)]
        off = np.abs((ends[0] - ends[1]) / (2.0 * STEP) - matrix[:, j]).max() / max(1.0, np.abs(matrix).max())
        if not off <= SAME:
            said.append(f"its return map has another Jacobian, off by {off:.1e} in column {j}")
    if recipe.close is not None:
        values = eigenvalues(matrix)
        far = [value for value in gait.multipliers if not np.abs(values - value).min() <= recipe.close]
        if far:
            said.append(f"{len(far)} of its multipliers are no eigenvalues of its Jacobian, the first {far[0]:.6g}")
    return said
