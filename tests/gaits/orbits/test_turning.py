"""Turns: relative periodic orbits of the event-exact simulation, the left one the mirror image of the right one.

`tests.solve` finds the one that is looked at here; `spear turn` finds it again, which takes minutes, by night.
"""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, SpatialLaw
from spear_pin.errors import BadValue
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.orbits.turning import find_turn
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import residual, return_map
from spear_pin.hybrid.symmetry import mirror_of, turn_state
from tests.cli.calls import printed
from tests.gaits.orbits.test_embedding import planar
from tests.solve.gaits import turn_3
from tests.solve.kept import FOLDER

TURN = np.radians(3.0)  # a stride


@cache
def straight():
    plane = planar("long_stride")
    law = SpatialLaw(plane.system.law, adduction_stiffness=0.0, adduction_damping=0.0)
    return Gait(*embed(plane, law), {}, 1e-11, np.array([np.nan + 0j]), {})


@pytest.fixture(scope="module")
def left():
    return turn_3()


@pytest.mark.slow
class TestTurn:
    def test_orbit(self, left):
        assert left.residual <= 1e-9 and residual(left.system, left.state) <= 1e-9
        run = return_map(left.system, left.state)
        assert run.state[0][3] - run.start[0][3] == pytest.approx(TURN, abs=1e-9)
        assert run.state[0][1] != pytest.approx(run.start[0][1], abs=1e-3)

    def test_right_is_its_mirror_image(self, left):
        mirror = mirror_of(left.system.robot)
        values = {name: -parameter(left.system, name) for name in ACROSS}
        right = with_parameters(left.system, values)
        assert residual(right, tuple(mirror(part) for part in left.state)) <= 1e-9

    def test_wherever_it_is_it_is_the_same_orbit(self, left):
        assert residual(left.system, turn_state(*left.state, 2.0, (1.0, -3.0))) <= 1e-9

    def test_ledger(self, left):
        run = return_map(left.system, left.state)
        assert abs(run.change[0] - run.work[0].sum()) <= 1e-9

    def test_is_told_and_played_as_it_was_found(self, capsys, tmp_path):
        told = printed(capsys, "turn", FOLDER / "turn_3.json", "--cycles", 1, "--out", tmp_path)
        assert told["turn"] == pytest.approx(TURN, abs=1e-8) and told["residual"] <= 1e-9


def test_the_command_finds_it_and_plays_what_it_has_kept(left, capsys, tmp_path):
    told = printed(capsys, "turn", "--angle", np.degrees(TURN), "--cycles", 1, "--out", tmp_path)
    kept = Gait.load(tmp_path / "turn.json")
    np.testing.assert_allclose(kept.state, left.state, rtol=0, atol=1e-7)
    again = printed(capsys, "turn", tmp_path / "turn.json", "--cycles", 1, "--out", tmp_path)
    assert again["radius"] == pytest.approx(told["radius"], rel=1e-9)


def test_too_tight_a_turn_is_refused():
    with pytest.raises(BadValue, match="turn"):
        find_turn(straight(), 2.0)
