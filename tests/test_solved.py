"""The kept gaits are what they were found to be: fixed points, with their multipliers, of recipes that still say so."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait
from tests.solve import gaits  # noqa: F401  registers the recipes
from tests.solve.kept import FOLDER, RECIPES, Recipe, differences, faults

QUICK = ("trot",)


def parameters():
    """All recipes, with the marks that they need; but for a few they are slow."""
    for name, recipe in RECIPES.items():
        marks = [pytest.mark.extra(module) for module in recipe.extras if module != "casadi"]
        yield pytest.param(recipe, id=name, marks=marks + [pytest.mark.slow] * (name not in QUICK))


@pytest.mark.filterwarnings("ignore:.*repair=True:spear_pin.errors.RobotWarning")  # of anymal_b's massless base
@pytest.mark.parametrize("recipe", list(parameters()))
def test_is_still_what_was_found(recipe: Recipe):
    assert faults(recipe) == []


@pytest.mark.extra("casadi")
@pytest.mark.extra("example-robot-data")
@pytest.mark.filterwarnings("ignore:.*repair=True:spear_pin.errors.RobotWarning")
@pytest.mark.parametrize("recipe", list(RECIPES.values()), ids=list(RECIPES))
def test_is_found_again(recipe: Recipe):
    assert differences(recipe) == faults(recipe, 3) == []


def test_every_kept_file_has_a_recipe_or_a_test():
    named = {path.name for recipe in RECIPES.values() for path in (recipe.path, recipe.beside)}
    others = {"long_stride_regulated.json", "least_effort_solution.npz"}  # of test_feedback.py and test_optimize.py
    assert {path.name for path in FOLDER.iterdir()} <= named | others


def test_the_example_plays_the_kept_gait():
    shipped = FOLDER.parents[1] / "examples" / "upright.json"
    assert shipped.read_text(encoding="utf-8") == RECIPES["long_stride_upright"].path.read_text(encoding="utf-8")


class TestFaults:
    """What would go unnoticed otherwise."""

    @pytest.fixture
    def trot(self, monkeypatch) -> tuple[Recipe, Gait]:
        recipe = RECIPES["trot"]
        gait = Gait.load("trot")
        monkeypatch.setattr("tests.solve.kept.Gait", type("Gait", (), {"load": lambda path: self.given}))
        self.given = gait
        return recipe, gait

    def test_another_recipe(self, trot):
        recipe, _ = trot
        assert "what it came from" in faults(replace(recipe, search=lambda: Gait.load("pace")), 0)[0]

    def test_a_state_that_is_none_of_the_orbit(self, trot):
        recipe, gait = trot
        q, v = gait.state
        self.given = replace(gait, state=(q, v + 1e-4))
        assert "no fixed point" in faults(recipe, 0)[0]

    def test_other_multipliers(self, trot):
        recipe, gait = trot
        self.given = replace(gait, multipliers=gait.multipliers * 1.001)
        assert "no eigenvalues" in faults(recipe, 0)[0]

    @pytest.mark.slow
    def test_another_jacobian(self, trot, monkeypatch):
        recipe, _ = trot
        from tests.solve import kept

        wrong = kept.jacobian("trot") + 1e-2 * np.ones((32, 32))
        monkeypatch.setattr(kept, "jacobian", lambda name: wrong)
        assert "another Jacobian" in faults(recipe, 1)[0]
