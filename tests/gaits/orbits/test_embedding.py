"""The plane's gaits in space: orbits of the same motion, symmetric, and what slips straight slips as in the plane."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, SpatialLaw
from spear_pin.errors import BadValue
from spear_pin.gaits import library
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.spatial.legs import pairs_of, place_in_space
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart, residual, return_map
from spear_pin.hybrid.symmetry import mirror_of, turn_state

ACROSS = [1, 3, 5]  # y, yaw, roll
FEW = 3, 9  # seeds of the gate; the nightly has more
KNEE = [name for name in library.names() if name != "force_lift_off"]
each_gait = pytest.mark.parametrize(
    "name", [name if name == "long_stride" else pytest.param(name, marks=pytest.mark.slow) for name in KNEE]
)


@cache
def planar(name):
    return Gait.load(name)


@cache
def spatial(name):
    gait = planar(name)
    return embed(gait, SpatialLaw(gait.system.law))


@cache
def stride(name):
    return return_map(*spatial(name))


@each_gait
class TestOrbit:
    def test_residual(self, name):
        assert residual(*spatial(name)) <= 1e-9

    def test_nothing_happens_across(self, name):
        for part in stride(name).state:
            assert abs(part[ACROSS]).max() <= 1e-12
        assert abs(np.array([event.impulse for event in stride(name).events]).sum(axis=1)[:, 1]).max() <= 1e-12

    def test_ledger(self, name):
        assert abs(stride(name).change[0] - stride(name).work[0].sum()) <= 1e-9

    def test_durations(self, name):
        longer = {phase: seconds for phase, seconds in stride(name).durations.items() if seconds > 0.0}
        assert longer == pytest.approx(dict(planar(name).durations), abs=1e-9)

    def test_left_and_right_share_the_impulse(self, name):
        there = return_map(planar(name).system, planar(name).state)
        for pair in ("anterior", "posterior"):
            wanted = there.event(f"{pair}_touchdown").impulse.sum(axis=0)
            struck = [event for event in stride(name).events if event.name.startswith(pair)]
            found = sum(event.impulse for event in struck).sum(axis=0)
            np.testing.assert_allclose(found[[0, 2]], wanted, rtol=0, atol=1e-8)


def perturbed(seed, size=1e-3):
    system, state = spatial("long_stride")
    local = chart(system, state)
    return system, local.state(size * np.random.default_rng(seed).normal(size=local.dimension))


@cache
def perturbed_stride(seed):
    return return_map(*perturbed(seed), 1e-12)


each_seed = pytest.mark.parametrize(
    "seed", [pytest.param(seed, id=str(seed) if seed in FEW else f"more-{seed}") for seed in range(11)]
)


class TestSymmetry:
    @pytest.mark.slow
    @each_seed
    def test_mirror(self, seed):
        system, state = perturbed(seed)
        mirror = mirror_of(system.robot)
        here, there = perturbed_stride(seed), return_map(system, tuple(mirror(part) for part in state), 1e-12)
        for one, other in zip(here.state, there.state, strict=True):
            np.testing.assert_allclose(mirror(one), other, rtol=0, atol=1e-11)

    @pytest.mark.slow
    @each_seed
    def test_turned_and_moved(self, seed):
        system, state = perturbed(seed)
        here, there = perturbed_stride(seed), return_map(system, turn_state(*state, 1.1, (3.0, -2.0)), 1e-12)
        for one, other in zip(turn_state(*here.state, 1.1, (3.0, -2.0)), there.state, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-11)

    @pytest.mark.slow
    def test_energy_of_a_perturbed_stride(self):
        run = perturbed_stride(FEW[0])
        assert abs(run.change[0] - run.work[0].sum()) <= 1e-9

    @pytest.mark.slow
    def test_continuous_across_touchdowns_that_are_nearly_one(self):
        """Differences over perturbation are bounded, whichever foot is first."""
        system, (q, v) = spatial("long_stride")
        whole = stride("long_stride").state[1]
        ratios = []
        for roll in (1e-3, 1e-5, 1e-7):
            local = q.copy()
            local[5] = roll
            local[2] -= min(system.ground.foot(system.robot, local, toe)[0] for toe in system.section_toes)
            run = return_map(system, (local, v), 1e-12)
            assert run.cycles == 1
            ratios.append(abs(run.state[1] - whole).max() / roll)
        assert max(ratios) < 3.0 * min(ratios) and max(ratios) < 100.0


class TestSlip:
    @pytest.mark.slow
    @pytest.mark.parametrize("friction", [0.35, 0.45])
    def test_straight_slip_is_the_planes(self, friction):
        gait, (system, state) = planar("long_stride"), spatial("long_stride")
        there = return_map(with_parameters(gait.system, {"friction": friction}), gait.state, 1e-11)
        here = return_map(with_parameters(system, {"friction": friction}), state, 1e-11)
        assert {"slip", "stick"} <= {event.name for event in here.events}
        touchdown = there.event("posterior_touchdown")
        pairs = pairs_of(system.robot)
        for part, wanted in zip(here.state, (touchdown.q, touchdown.v_before), strict=True):
            np.testing.assert_allclose(part, place_in_space(system.robot, pairs, wanted), rtol=0, atol=1e-8)
        slipped = here.work[0].sum() - here.change[0]
        assert abs(slipped) <= 1e-8

    @pytest.mark.slow
    def test_a_foot_that_slips_aside(self):
        """Sliding obliquely keeps the energy's books, and friction is against the motion."""
        system, state = spatial("long_stride")
        slippery = with_parameters(system, {"friction": 0.45})
        moved = chart(system, state).state(2e-2 * np.random.default_rng(5).normal(size=32))
        run = return_map(slippery, moved)
        assert run.cycles == 1 and "slip" in {event.name for event in run.events}
        assert abs(run.change[0] - run.work[0].sum()) <= 1e-8


class TestRefused:
    @pytest.mark.parametrize("overlap", [-0.01, float("nan"), "x"])
    def test_impacts_that_last_no_time(self, overlap):
        with pytest.raises(BadValue, match="overlap"):
            replace(spatial("long_stride")[0], overlap=overlap)

    def test_other_gaits(self):
        with pytest.raises(BadValue, match="plane"):
            embed(planar("long_stride"), SpatialLaw(planar("least_effort").system.law))


@pytest.mark.slow
def test_feet_that_have_just_begun_to_slide_lift_off_with_the_speed_of_the_planes():
    there = planar("force_lift_off")
    begun, ended = (
        next(e for e in return_map(*each).events if e.name.endswith("lift_off"))
        for each in ((there.system, there.state), spatial("force_lift_off"))
    )
    robot = spatial("force_lift_off")[0].robot
    slides = 6e-6  # m/s: by which it has begun to in 18 µs
    plane = there.system.robot.toe_jacobian(begun.q, "posterior_toe") @ begun.v
    assert plane[0] == pytest.approx(slides, rel=0.01)
    for leg in pairs_of(robot)[0]:
        assert robot.toe_jacobian(ended.q, leg.toe) @ ended.v == pytest.approx([plane[0], 0.0, 0.0], abs=1e-9)
