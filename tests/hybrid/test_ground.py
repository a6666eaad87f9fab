"""The ground: a step in it, what it refuses, and that it is kept."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from spear_pin import (
    Contact,
    Gait,
    Ground,
    HoppingLaw,
    Trajectory,
    bounding,
    hopping,
    load,
    simulate,
    simulate_many,
)
from spear_pin.errors import BadValue
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.biped import example

LAW = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0)


@dataclass(frozen=True)
class Step(Ground):
    """As CONTRIBUTING.md says to add one."""

    at: float = 0.5
    rise: float = 0.02

    def above(self, x, z, ops=math):
        return super().above(x, z, ops) - self.rise * (x > self.at)


class TestStep:
    @pytest.mark.parametrize("rise", [0.02, -0.02])
    def test_is_run_over(self, rise):
        """Every foot lands on its tread, and the biped goes on at its pace."""
        robot = load("biped")
        system = example().running(robot, example().RunningLaw(set_back=0.117809), ground=Step(rise=rise))
        trajectory = simulate(system, system.guess(), 6)
        assert trajectory.complete and np.abs(trajectory.ledger.residual).max() < 2e-9
        landed = [event for event in trajectory.events if event.name.endswith("_touchdown")]
        places = np.array([robot.toe_position(event.q, f"{event.name.split('_')[0]}_toe") for event in landed])
        assert places[-1, 0] > 5.0
        np.testing.assert_allclose(places[:, 1], np.where(places[:, 0] > 0.5, rise, 0.0), atol=1e-9)

    def test_is_for_the_reference_engine(self, tmp_path, hop):
        system = hopping(hop.system.robot, hop.system.law, ground=Step())
        with pytest.raises(BadValue, match=r"ground is Step\(.*expected a plane"):
            simulate_many(system, hop.state[0][None], hop.state[1][None])
        with pytest.raises(BadValue, match="ground that is no plane"):
            replace(hop, system=system).save(tmp_path / "hop.json")


class TestGround:
    @pytest.mark.parametrize(("fields", "named"), [
        ({"slope": math.nan}, "Ground.slope"), ({"slope": 1.3}, "Ground.slope"), ({"slope": -math.pi}, "Ground.slope"),
        ({"slope": "steep"}, "Ground.slope"), ({"slope": None}, "Ground.slope"),
        ({"height": math.inf}, "Ground.height"), ({"height": [0.1, 0.2]}, "Ground.height"),
        ({"friction": 0.0}, "Ground.friction"), ({"height": 11.0}, "Ground.height"),
    ])  # fmt: skip
    def test_refuses(self, fields, named):
        with pytest.raises(BadValue, match=named):
            Ground(**fields)

    def test_of_two_grounds_refuses_both(self, robot):
        for make in (hopping, lambda robot, **parts: bounding(robot, Gait.load("least_effort").system.law, **parts)):
            with pytest.raises(BadValue, match=r"ground is Ground\(.*\); expected none beside contact"):
                make(robot, contact=Contact(), ground=Ground())
        with pytest.raises(BadValue, match="ground"):
            hopping(robot, ground=0.1)

    def test_level_is_a_contact(self, robot):
        """To the last bit, in either engine."""
        assert repr(Contact()) == "Contact(friction=0.8)" and Ground().plain
        plain, ground = (hopping(robot, LAW, contact=Contact(0.5)), hopping(robot, LAW, ground=Ground(0.5)))
        one, other = (run(system, system.guess(), 1, Options()) for system in (plain, ground))
        np.testing.assert_array_equal(one.state, other.state)

    def test_is_kept_in_files(self, tmp_path, hop):
        for ground in (Contact(0.6), Ground(0.6, 0.05, -0.1)):
            gait = replace(hop, system=hopping(hop.system.robot, hop.system.law, contact=ground))
            assert Gait.load(gait.save(tmp_path / "gait.json")).system.contact == ground
        assert Gait.load("least_effort").system.contact == Contact(0.8)

    def test_is_kept_with_samples(self, tmp_path, robot):
        system = hopping(robot, LAW, ground=Ground(0.6, 0.05, -0.1))
        trajectory = simulate(system, system.guess(), 1)
        again = Trajectory.load(trajectory.save(tmp_path / "hop.npz"))
        assert trajectory.ground == again.ground == system.ground
        np.testing.assert_array_equal(again.force, trajectory.force)

    def test_is_level_for_feedback_by_height(self):
        gait = Gait.load("least_effort")
        law = replace(gait.system.law, feedback=((0.0,) * 13,) * 6)
        with pytest.raises(BadValue, match=r"BoundingLaw.feedback.*by the height of the torso"):
            bounding(gait.system.robot, law, ground=Ground(slope=0.1))
