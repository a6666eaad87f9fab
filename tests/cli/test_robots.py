"""`spear robots`."""

import pytest

from spear_pin.model.loading import ROBOTS
from tests.cli.calls import printed, run


class TestRobots:
    def test_text(self, capsys):
        status, out, err = run(capsys, "robots")
        assert status == 0 and err == ""
        assert all(name in out for name in ROBOTS)
        assert "6.80 kg" in out and "43.76 kg" in out

    def test_json(self, capsys):
        rows = {row["name"]: row for row in printed(capsys, "robots")["robots"]}
        assert list(rows)[: len(ROBOTS)] == list(ROBOTS)
        assert rows["spear_ii"]["degrees_of_freedom"] == 4 and rows["spear_ii"]["motors"] == 2
        assert rows["q_spear"]["degrees_of_freedom"] == 7 and rows["q_spear"]["motors"] == 4
        assert rows["spear_ii"]["mass"] == pytest.approx(6.8)
        assert rows["spear_ii"]["coordinates"] == ["boom_x", "boom_z", "hip", "knee"]
