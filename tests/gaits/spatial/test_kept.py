"""Gaits and motions in space are kept, tabled and told as those of the plane are."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Contact, Gait, SpatialLaw, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.rules.guards import make_unloading_guard
from spear_pin.hybrid.symmetry import mirror_of
from spear_pin.studies.bound.in_space import summarize_in_space
from tests.gaits.orbits.test_embedding import planar, spatial
from tests.random_starts import draw_in_space, quadruped


def gait(**changes):
    """The gait in space; its residual and multipliers are not looked at."""
    system, state = spatial("long_stride")
    return Gait(replace(system, **changes), state, {}, 0.0, np.ones(1, complex), {})


def test_a_saved_gait_is_read_as_it_was(tmp_path):
    system = gait(overlap=0.0).system
    again = Gait.load(gait(overlap=0.0).save(tmp_path / "gait.json"))
    assert again.system.law == system.law and again.system.overlap == 0.0
    assert again.system.robot.coordinates == system.robot.coordinates
    np.testing.assert_array_equal(again.state, gait().state)


@pytest.mark.extra("xarray")
def test_forces_in_space_as_an_xarray():
    data = simulate(gait().system, gait().state, 1).to_xarray()
    assert data.axis.values.tolist() == ["x", "y", "z"] and data.force.shape[1:] == (4, 3)


def test_what_was_replaced_in_the_plane_is_not_lost():
    plane = planar("long_stride")
    changed = replace(plane, system=replace(plane.system, shortest_flight=0.01))
    with pytest.raises(BadValue, match="without"):
        embed(changed, SpatialLaw(plane.system.law))


@pytest.mark.slow
def test_the_period_is_that_of_whole_strides():
    """A motion that ends within a stride, which the mean of all that was simulated would count in."""
    own = gait()
    q, v = (part.copy() for part in own.state)
    v[5] = 1.0
    motion = simulate(own.system, (q, v), 6)
    assert motion.reason != "complete" and motion.cycles >= 1
    ends = motion.t[motion.cycle == motion.cycles][-1]
    assert summarize_in_space(own, motion)["period"] == pytest.approx(ends / motion.cycles, rel=1e-12)


def test_painleves_pole_is_no_lift_off():
    """Where a slipping toe's pivot ends its force goes over from +∞ to -∞; what tells its lift-off stays positive."""
    past = SimpleNamespace(force=lambda toe: (0.0, 0.0, -1e6), pivot=lambda toe: -1e-6)
    assert make_unloading_guard("toe")(0.0, (), (), {}, None, past, None) > 0.0


@pytest.mark.slow
def test_a_drop_into_painleves_paradox_ends_so_in_the_mirror_too():
    start = draw_in_space(23)
    q, v = np.array(start.q), np.array(start.v)
    system, mirror = gait(contact=Contact(start.friction)).system, mirror_of(quadruped())
    for state in ((q, v), (mirror(q), mirror(v))):
        assert return_map(system, state, 1e-8).reason == "painleve"
