"""Robots that were cut out of others: written as where they come from, cut again, varied, and copied."""

import copy
import json
import pickle
import re
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import load, monopod, sagittal, vary
from spear_pin.errors import BadValue, SpearError, UnknownName
from spear_pin.model.boom import on_rotary_boom
from spear_pin.model.legs import find_legs
from spear_pin.model.numbers import body_numbers
from spear_pin.model.origin import origin, robot_of, unsaid
from spear_pin.model.variants import PARAMETERS
from tests.model.legged import quadruped, slider
from tests.model.queries import refusal, state


def again(cut):
    """The robot of an origin that went through a file."""
    return robot_of(json.loads(json.dumps(origin(cut))))


def assert_twin(twin, cut):
    """The same numbers, bit for bit."""
    q, v = state(cut)
    np.testing.assert_array_equal(twin.mass_matrix(q), cut.mass_matrix(q))
    np.testing.assert_array_equal(twin.bias(q, v), cut.bias(q, v))
    assert twin.model == cut.model and twin.cut == cut.cut and str(twin.cut) == str(cut.cut)
    for name in ("name", "source", "toes", "actuated", "locked", "varied", "coordinates", "legs"):
        assert getattr(twin, name) == getattr(cut, name)
    assert unsaid(twin) == unsaid(cut) == ()


BLANK = {"knee_limits": (-2.5, 2.5)}
CUTS = {
    "monopod": lambda write: monopod(load(write(quadruped())), "FL", locked=["boom_x"]),
    "monopod, x to the rear": lambda write: monopod(load(write(quadruped(ahead=0.03))), "HR"),
    "given mass": lambda write: monopod(load(write(slider())), "one", body=1.7),
    "locked": lambda write: monopod(load(write(quadruped()), locked=["HL_bend", "HL_pitch"]), "FL"),
    "options": lambda write: monopod(load(write(quadruped(float_base=False)), base="free", motors="all"), "FR"),
    "toes": lambda write: monopod(load(write(quadruped()), toes=["FR_foot", "HL_foot"]), "FR"),
    "named side": lambda write: monopod(
        made := load(write(quadruped(**BLANK))), next(leg for leg in find_legs(made, sides=-1) if leg.name == "FL")
    ),
    "varied origin": lambda write: monopod(vary(load("spear_ii"), knee_ratio=21.3), "leg"),
    "sagittal": lambda write: sagittal(load(write(quadruped(ahead=0.02)))),
    "shipped": lambda write: sagittal(load("q_spear_full")),
    "given pairs": lambda write: sagittal(load(write(quadruped())), [("FR", "FL"), ("HL", "HR")]),
    "pairs of named sides": lambda write: sagittal(
        made := load(write(quadruped(**BLANK))), [find_legs(made, sides=1)[:2], find_legs(made, sides=-1)[2:]]
    ),
    "monopod of a pair": lambda write: monopod(sagittal(load("q_spear_full")), "posterior"),
    "varied": lambda write: vary(
        sagittal(vary(load("q_spear_full"), hip_spacing=0.3)), knee_ratio=17.7, torso_mass=31.0, hip_distance=0.61
    ),
    "varied twice": lambda write: vary(
        vary(monopod(load(write(quadruped())), "FL", locked=["boom_x"]), hip_rotor=2e-4, knee_ratio=11.1),
        knee_ratio=9.7,
    ),
}


class TestAgain:
    @pytest.mark.parametrize("name", CUTS)
    def test_is_the_same(self, write, name):
        cut = CUTS[name](write)
        assert_twin(again(cut), cut)

    @pytest.mark.parametrize("name", CUTS)
    def test_survives_copies(self, write, name):
        cut = CUTS[name](write)
        assert_twin(pickle.loads(pickle.dumps(cut)), cut)
        assert_twin(copy.deepcopy(cut), cut)

    def test_of_a_robot_that_is_loaded(self, write):
        made = load(write(quadruped(float_base=False)), ["FL_foot"], ["HL_bend"], base="free", motors=["FL_pitch"])
        twin = again(made)
        assert twin.model == made.model and twin.actuated == made.actuated and "cut" not in origin(made)
        assert dict(twin.options) == dict(made.options) == {"base": "free", "motors": ("FL_pitch",)}


class TestUnsaid:
    def test_model(self):
        made = load(load("spear_ii").model, toes=["toe"], motors=["hip", "knee"], base="fixed")
        assert unsaid(made) == unsaid(monopod(made, "leg")) == ("a robot that was no file",)

    def test_added_inertia(self):
        cut = monopod(load("spear_ii"), "leg", locked=["boom_x"])
        assert unsaid(on_rotary_boom(cut)) == ("a robot with added inertia",)

    def test_leg_of_ones_own(self):
        whole = load("spear_ii")
        cut = monopod(whole, replace(whole.legs[0], shank=0.4))
        assert unsaid(cut) == ("a robot that cannot be cut again as it was",)

    def test_model_changed_by_other_means(self, write):
        whole = load(write(quadruped()))
        whole.model.armature = 2.0 * whole.model.armature
        assert unsaid(monopod(whole, "FL")) == ("a robot that cannot be cut again as it was",)
        assert unsaid(whole) == ("another model than its file",)

    def test_file_that_is_gone(self, write):
        path = write(quadruped())
        cut = monopod(load(path), "FL")
        path.unlink()
        assert unsaid(cut) == ("a robot that cannot be cut again as it was",)
        assert unsaid(cut.cut.robot) == ()  # the file may come back


def changed(said, value, *names):
    """An origin with another value in it."""
    said = json.loads(json.dumps(said))
    inner = said
    for name in names[:-1]:
        inner = inner[name]
    inner[names[-1]] = value
    return said


FAULTS = {
    "another source": ("spear_ii", "source"),
    "another toe": (["foot"], "toes"),
    "an unknown kind": ("biped", "cut", "kind"),
    "another kind": ("sagittal", "cut", "kind"),
    "no object": ([1], "cut"),
    "a name for a leg": ("FL", "cut", "leg"),
    "an unknown field": (1, "cut", "colour"),
    "an unknown field of the leg": (1, "cut", "leg", "colour"),
    "another side": (2, "cut", "leg", "side"),
    "a side that is text": ("1", "cut", "leg", "side"),
    "a hip that is no name": (3, "cut", "leg", "hip"),
    "an unknown hip": ("FL_sway", "cut", "leg", "hip"),
    "the hip of another leg": ("FR_pitch", "cut", "leg", "hip"),
    "the knee for the hip": ("FL_bend", "cut", "leg", "hip"),
    "a hip that swings": ("FL_swing", "cut", "leg", "hip"),
    "an unknown toe of the leg": ("hoof", "cut", "leg", "toe"),
    "a toe at the knee": ("FL_bend", "cut", "leg", "toe"),
    "an abduction below": ("FL_bend", "cut", "leg", "abduction"),
    "another name": ("HR", "cut", "leg", "name"),
    "a negative mass": (-1.0, "cut", "body"),
    "a mass that is text": ("heavy", "cut", "body"),
    "an unknown joint to lock": (["boom_y"], "locked"),
    "options of a cut": ({"base": "free"}, "options"),
    "a number that it has not": ({"torso_mass": 1.0}, "varied"),
    "no robot": (None, "cut", "of"),
    "a robot that is gone": ("gone/dog.urdf", "cut", "of", "source"),
    "an unknown option": ({"colour": 1}, "cut", "of", "options"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_an_origin_that_is_none(write, fault):
    said = origin(monopod(load(write(quadruped())), "FL"))
    value, *names = FAULTS[fault]
    with pytest.raises((SpearError, ValueError)) as error:
        robot_of(changed(said, value, *names))
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    "pairs", [1, [1, 2], [[1, 2], [3, 4]], [], [[]], lambda pairs: pairs[:1], lambda pairs: [pairs[0], pairs[0]]]
)
def test_pairs_that_are_none(pairs):
    said = origin(sagittal(load("q_spear_full")))
    wrong = pairs(said["cut"]["pairs"]) if callable(pairs) else pairs
    with pytest.raises((SpearError, ValueError)):
        robot_of(changed(said, wrong, "cut", "pairs"))


class TestVary:
    def test_is_as_the_shipped_one(self):
        """Of four legs cut to pairs, and of the pairs that ship."""
        values = {"knee_ratio": 20.0, "hip_rotor": 1.1e-5, "hip_distance": 0.8, "torso_mass": 30.0}
        cut, pairs = vary(sagittal(load("q_spear_full")), **values), vary(load("q_spear"), **values)
        q, v = state(pairs)
        np.testing.assert_allclose(cut.mass_matrix(q), pairs.mass_matrix(q), rtol=0, atol=1e-12)
        np.testing.assert_allclose(cut.bias(q, v), pairs.bias(q, v), rtol=0, atol=1e-10)

    def test_is_as_the_origin_varied(self):
        leg = vary(monopod(load("spear_ii"), "leg"), knee_ratio=20.0, hip_rotor=3e-5)
        of = monopod(vary(load("spear_ii"), knee_ratio=20.0, hip_rotor=3e-5), "leg")
        np.testing.assert_allclose(leg.model.armature, of.model.armature, rtol=1e-14)

    def test_motor_without_rotor(self, write):
        """Where the file has none, N² J is what is given; of a pair twice."""
        made = load(write(re.sub("<transmission.*?</transmission>", "", quadruped())), motors="all")
        cut = vary(sagittal(made), knee_rotor=1e-4, knee_ratio=9.0)
        rows = [cut.index("posterior_knee"), cut.index("anterior_knee"), cut.index("posterior_hip")]
        np.testing.assert_allclose(cut.model.armature[rows], [2 * 81e-4, 2 * 81e-4, 0.0], rtol=1e-14)
        assert cut.gear_ratio("posterior_knee") == 9.0

    def test_hips_that_are_not_about_the_origin(self, write):
        cut = sagittal(load(write(quadruped())))
        ends = [cut.frame_position(np.zeros(7), f"{end}_thigh") for end in ("posterior", "anterior")]
        wide = vary(cut, hip_distance=0.9)
        moved = [wide.frame_position(np.zeros(7), f"{end}_thigh") for end in ("posterior", "anterior")]
        np.testing.assert_allclose(np.add(*moved), np.add(*ends), atol=1e-15)
        assert moved[1][0] - moved[0][0] == pytest.approx(0.9, abs=1e-15)

    def test_names(self, write):
        gears = ("hip_ratio", "knee_ratio", "hip_rotor", "knee_rotor")
        leg = monopod(load(write(quadruped())), "FL")
        error = refusal(UnknownName, lambda: vary(leg, torso_mass=1.0))
        assert set(error.valid) == {*gears, "boom_damping", *body_numbers(leg)}
        pairs = sagittal(load("q_spear_full"))
        error = refusal(UnknownName, lambda: vary(pairs, boom_damping=1.0))
        own = {*gears, "hip_distance", "torso_mass", "torso_inertia"}
        assert set(error.valid) == own | {*body_numbers(pairs)} and own < set(PARAMETERS)

    def test_gears_go_with_motors(self, write):
        leg = monopod(load(write(quadruped()), motors=["FL_bend"]), "FL")
        assert set(refusal(UnknownName, lambda: vary(leg, hip_ratio=2.0)).valid) == {
            *("knee_ratio", "knee_rotor", "boom_damping"),
            *body_numbers(leg),
        }

    def test_model_changed_by_other_means(self):
        leg = monopod(load("spear_ii"), "leg")
        model = leg.model.copy()
        model.armature = 2.0 * model.armature
        refusal(BadValue, lambda: vary(leg.with_model(model), knee_ratio=3.0))
