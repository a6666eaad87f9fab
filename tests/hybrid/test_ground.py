"""The ground: a step in it, what it refuses, and that it is kept."""

import math
from dataclasses import dataclass, field, replace

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
from spear_pin.errors import BadValue, NotSymbolic
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.engines.structure import Structure
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.model.planar import Planar
from tests.biped import example
from tests.slow import slow_but

LAW = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0)


@dataclass(frozen=True)
class Step(Ground):
    """As CONTRIBUTING.md says to add one."""

    at: float = 0.5
    rise: float = 0.02

    def above(self, x, z, ops=FLOATS):
        return -ops.maximum(-z, -ops.maximum(z - self.rise, self.at - x))


@dataclass(frozen=True)
class Hole(Ground):
    """A step down, of which the higher tread is what is near to everything."""

    at: float = 0.5
    depth: float = 0.02

    def above(self, x, z, ops=FLOATS):
        return -ops.maximum(-(z + self.depth), -ops.maximum(z, x - self.at))


RISE = 0.0


@dataclass(frozen=True)
class Listed(Ground):
    """Level ground, as high as a list says."""

    rises: list[float] = field(default_factory=lambda: [0.0])

    def above(self, x, z, ops=FLOATS):
        return z - self.rises[0]


@dataclass(frozen=True)
class Raised(Ground):
    """As high as a number of the module says."""

    def above(self, x, z, ops=FLOATS):
        return z - RISE


@pytest.fixture(scope="module", params=slow_but([Step(), Hole()], Step()), ids=["up", "down"])
def uneven(request):
    """The biped that runs over a step, and where it then is."""
    robot, ground = load("biped"), request.param
    system = example().running(robot, example().RunningLaw(set_back=0.117809), ground=ground)
    return system, simulate(system, system.guess(), 6, rtol=1e-11), ground.rise if isinstance(ground, Step) else -0.02


class TestStep:
    @pytest.mark.slow
    def test_is_run_over(self, uneven):
        """Every foot lands on its tread, and the biped goes on at its pace."""
        system, trajectory, rise = uneven
        robot = system.robot
        assert trajectory.complete and np.abs(trajectory.ledger.residual).max() < 2e-9
        landed = [event for event in trajectory.events if event.name.endswith("_touchdown")]
        places = np.array([robot.toe_position(event.q, f"{event.name.split('_')[0]}_toe") for event in landed])
        assert places[-1, 0] > 5.0
        np.testing.assert_allclose(places[:, 1], np.where(places[:, 0] > 0.5, rise, 0.0), atol=1e-9)

    @pytest.mark.extra("heyoka")
    @pytest.mark.parametrize("n", [1, 20])
    def test_is_run_over_in_lanes(self, uneven, n):
        """As by the reference engine, one alone and many together."""
        system, trajectory, _ = uneven
        q, v = (np.tile(part, (n, 1)) for part in system.guess())
        found = simulate_many(system, q, v, 6, 1e-11)
        assert (found.reason == "complete").all() and not found.repeated.any()
        np.testing.assert_allclose(found.q, np.tile(trajectory.q[-1], (n, 1)), rtol=0, atol=1e-8)

    @pytest.mark.extra("heyoka")
    def test_that_branches_on_a_value_is_named(self, hop):
        """By the lanes; the reference engine takes it."""

        class Stair(Ground):
            def above(self, x, z, ops=FLOATS):
                return z - (0.02 if x > 0.5 else 0.0)

        system = hopping(hop.system.robot, hop.system.law, ground=Stair())
        assert run(system, hop.state, 1, Options()).cycles == 1
        with pytest.raises(NotSymbolic, match="ground does not take symbols"):
            simulate_many(system, hop.state[0][None], hop.state[1][None])

    @pytest.mark.extra("heyoka")
    def test_that_was_changed_is_compiled_anew(self, hop, monkeypatch):
        """Also for the system that ran on it before."""
        system = hopping(hop.system.robot, hop.system.law, ground=Raised())
        for rise, reason in ((0.0, "complete"), (0.1, "below_ground")):
            monkeypatch.setattr("tests.hybrid.test_ground.RISE", rise)
            assert simulate_many(system, hop.state[0][None], hop.state[1][None]).reason.tolist() == [reason]

    @pytest.mark.extra("heyoka")
    def test_whose_list_was_changed_is_compiled_anew(self, hop):
        ground = Listed()
        system = hopping(hop.system.robot, hop.system.law, ground=ground)
        for rise, reason in ((0.0, "complete"), (0.1, "below_ground")):
            ground.rises[0] = rise
            assert simulate_many(system, hop.state[0][None], hop.state[1][None]).reason.tolist() == [reason]

    @pytest.mark.slow
    def test_of_another_shape_is_compiled_anew(self, uneven):
        """Its own numbers are compiled in, and so is what it says."""
        system, _, _ = uneven
        domain = system.domains[0]
        grounds = [Ground(), system.ground, replace(system.ground, at=0.4)]
        keys = {Structure(replace(system, contact=each), domain, {}, Planar(system.robot)) for each in grounds}
        assert len(keys) == 3

    def test_is_not_for_files(self, tmp_path, hop):
        with pytest.raises(BadValue, match="ground that is no plane"):
            replace(hop, system=hopping(hop.system.robot, hop.system.law, ground=Step())).save(tmp_path / "hop.json")


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
            with pytest.raises(BadValue, match=r"ground is Ground\(.*\); expected one of ground and contact"):
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
