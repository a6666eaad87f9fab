"""Which domain fits: one state or many, against the same said in words, state by state."""

import math
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.hybrid.contact import OPEN, SLIP_BACKWARD, SLIP_FORWARD, STICK
from spear_pin.hybrid.domain import Rub
from spear_pin.hybrid.rules.footing import (
    AT_REST,
    BORE,
    ILL_POSED,
    LEAVES,
    LET_GO,
    MOVES,
    SOME_LEAVE,
    STARTS_TO_SLIDE,
    TURNS,
    UNFIT,
    UNLOADED,
    Footing,
    Rubbing,
    fitness,
    is_torn_off,
    make_footing,
    shared,
)

MODES = STICK, SLIP_FORWARD, SLIP_BACKWARD
SPEEDS = 0.0, AT_REST, -AT_REST, 2.0 * AT_REST, -2.0 * AT_REST, 0.3, -0.3
NORMALS = 50.0, 0.0, -50.0
TANGENTIALS = 0.0, 40.0 - UNLOADED, -40.0 + UNLOADED, 39.0, -39.0, 41.0
ACCELERATIONS = 0.5, 0.0, -STARTS_TO_SLIDE, -2.0 * STARTS_TO_SLIDE
PIVOTS = 1.0, 0.0, -1.0


def drawn(rng, n):
    """Footings of toes, on the edges of what is tolerated as often as not."""
    choices = SPEEDS, TANGENTIALS, NORMALS, ACCELERATIONS, PIVOTS
    speed, tangential, normal, acceleration, pivot = (rng.choice(values, n) for values in choices)
    return Footing(speed, tangential, normal, 0.8 * normal, acceleration, pivot)


def in_words(feet):
    """Of one state: what keeps each toe, and why it does not."""
    for mode, foot in feet:
        if mode == STICK and abs(foot.speed) > AT_REST:
            return UNFIT
        if mode != STICK and foot.speed < -AT_REST:
            return UNFIT
    if any(mode != STICK and foot.pivot <= 0.0 for mode, foot in feet):
        return ILL_POSED
    failing, push = [], math.inf
    for mode, foot in feet:
        begins = mode != STICK and foot.speed <= AT_REST
        if foot.normal <= 0.0:
            failing.append("pulled")
        elif mode == STICK and abs(foot.tangential) >= foot.grip - UNLOADED:
            failing.append("outside")
        elif begins and foot.acceleration <= -STARTS_TO_SLIDE:
            failing.append("outside")
        elif begins:
            push = min(push, foot.acceleration)
    if not failing:
        return push
    if set(failing) == {"pulled"}:
        return LEAVES
    return SOME_LEAVE if "pulled" in failing else MOVES


@pytest.mark.parametrize(("n", "draws"), [(1, 640), (64, 40)])
@pytest.mark.parametrize("modes", [*product(MODES), *product(MODES, repeat=2)])
def test_of_many_as_of_each(modes, n, draws):
    rng = np.random.default_rng(n)
    seen = set()
    for _ in range(draws):
        feet = [(mode, drawn(rng, n)) for mode in modes]
        found = np.broadcast_to(fitness(feet), n)
        for i in range(n):
            alone = [(mode, Footing(*(float(number[i]) for number in foot))) for mode, foot in feet]
            assert found[i] == fitness(alone) == in_words(alone)
            seen.add(in_words(alone) if in_words(alone) < -STARTS_TO_SLIDE else "fits")
    assert {"fits", LEAVES, UNFIT} <= seen


def test_in_the_air():
    assert fitness([]) == math.inf


def test_what_has_no_value_fits_nowhere():
    nothing = Footing(*[math.nan] * 6)
    assert all(fitness([(mode, nothing)]) == UNFIT for mode in MODES)
    assert fitness([(STICK, nothing._replace(speed=0.0))]) < LEAVES


class TestJoints:
    @pytest.mark.parametrize(
        ("sign", "joint", "fits"),
        [
            (0.0, Rubbing(AT_REST, 5.0, 2.0 - 2.0 * LET_GO, 2.0), math.inf),
            (0.0, Rubbing(0.0, 5.0, LET_GO - 2.0, 2.0), TURNS),
            (0.0, Rubbing(2.0 * AT_REST, 0.0, 0.0, 2.0), UNFIT),
            (1.0, Rubbing(0.1, -5.0, 0.0, 2.0), math.inf),
            (1.0, Rubbing(0.0, 0.0, 0.0, 2.0), math.inf),
            (1.0, Rubbing(0.0, -2.0 * STARTS_TO_SLIDE, 0.0, 2.0), TURNS),
            (-1.0, Rubbing(0.0, -5.0, 0.0, 2.0), math.inf),
            (-1.0, Rubbing(0.1, -5.0, 0.0, 2.0), UNFIT),
        ],
    )
    def test_modes_of_dry_friction(self, sign, joint, fits):
        rub = Rub("knee", 2.0, sign)
        assert fitness([], [(rub, joint)]) == fits
        many = Rubbing(*(np.full(64, number) for number in joint))
        np.testing.assert_array_equal(fitness([], [(rub, many)]), np.full(64, fits))

    def test_a_joint_that_turns_back_is_the_last_resort(self):
        """Where toes do not fit either."""
        pulled, turned = Footing(0.0, 0.0, -1.0, -0.8), Rubbing(0.0, -1.0, 0.0, 2.0)
        assert fitness([(STICK, pulled)], [(Rub("knee", 2.0, 1.0), turned)]) == TURNS < ILL_POSED < LEAVES


class Said:
    """Dynamics that say the same of every toe."""

    friction_coefficient = 0.5

    def toe_velocity(self, toe):
        return 0.2, 0.0

    def toe_acceleration(self, toe):
        return 3.0, 1.0

    def force(self, toe):
        return -8.0, 20.0

    foot_force = force

    def pivot(self, toe):
        return 0.7


def test_footing_is_along_the_mode():
    assert make_footing(Said(), "toe", STICK) == Footing(0.2, -8.0, 20.0, 10.0)
    assert make_footing(Said(), "toe", SLIP_FORWARD) == Footing(0.2, -8.0, 20.0, 10.0, 3.0, 0.7)
    assert make_footing(Said(), "toe", SLIP_BACKWARD) == Footing(-0.2, -8.0, 20.0, 10.0, -3.0, 0.7)


def test_torn_off():
    for mode, bore, after, bears in product((OPEN, *MODES), (0.0, BORE, 1.0), (OPEN, *MODES), (-1.0, 0.0, 1.0)):
        expected = mode == STICK and bore > BORE and after in (SLIP_FORWARD, SLIP_BACKWARD) and bears <= 0.0
        assert is_torn_off(mode, bore, after, bears) == expected
    assert is_torn_off(STICK, np.array([1.0, 0.0]), SLIP_FORWARD, np.array([-1.0, -1.0])).tolist() == [True, False]


@pytest.mark.parametrize(
    ("forces", "shares"),
    [
        ({"heel": (4.0, 1.0), "toe": (0.0, 3.0)}, [(1.0, 1.0), (3.0, 3.0)]),
        ({"heel": (0.0, 0.0), "toe": (0.0, 0.0)}, [(0.0, 0.0), (0.0, 0.0)]),
        ({"heel": (-2.0, 5.0)}, [(-2.0, 5.0)]),
    ],
)
def test_toes_of_one_body_share_the_force_along_the_ground_as_the_normal_one(forces, shares):
    robot = SimpleNamespace(feet=dict.fromkeys(("heel", "toe"), ("heel", "toe")))
    assert [shared(robot, toe, forces) for toe in forces] == shares
