"""How runs end: every failure is a result, whatever laws and guards do."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, HoppingLaw, hopping, simulate
from spear_pin.hybrid.domain import Guard, Reset
from spear_pin.hybrid.reasons import REASONS
from spear_pin.hybrid.result import Moment


def finite(trajectory):
    numbers = [getattr(trajectory, name) for name in ("t", "q", "v", "a", "u", "tau", "friction", "force", "spring")]
    return all(np.isfinite(values).all() for values in numbers)


class TestEndings:
    """A failure is a result: it has a reason, a sentence, and finite samples up to where it happened."""

    @staticmethod
    def ends(trajectory, reason):
        assert trajectory.reason == reason and not trajectory.complete
        assert REASONS[reason] in trajectory.message and "\n" not in trajectory.message
        assert finite(trajectory)
        assert trajectory.ledger.work.shape == (trajectory.cycles, len(trajectory.ledger.flows))

    def test_fall(self, free_robot, robot):
        law = HoppingLaw(stance_torque=0.0, hip_gain=0.0, hip_damping=0.0, knee_gain=0.0, knee_damping=0.0)
        system = hopping(free_robot, law)
        trajectory = simulate(system, system.guess(), cycles=3)
        self.ends(trajectory, "fall")
        frame = trajectory.events[-1].name.removeprefix("fall:")
        assert free_robot.frame_position(trajectory.q[-1], frame)[1] == pytest.approx(0.0, abs=1e-9)
        assert "fall:knee" in trajectory.message

    def test_evaluation_cap(self, hop):
        trajectory = simulate(hop.system, hop.state, cycles=11, max_evaluations=2000)
        self.ends(trajectory, "evaluation_cap")
        assert trajectory.cycles == 2
        assert 2000 < trajectory.evaluations < 2100

    def test_a_phase_without_end(self, robot):
        system = hopping(robot, HoppingLaw(stance_torque=0.0))
        trajectory = simulate(system, system.guess())
        self.ends(trajectory, "no_event")
        assert trajectory.t[-1] == pytest.approx(system.phase_limit)

    def test_end_of_a_joints_range(self, hop):
        """A guard of one's own, which stops the knee."""
        stop = Guard("stop", lambda t, q, v, held, p, dyn, ops: 1.15 - q[-1], ends="limit")
        domains = tuple(replace(domain, guards=(*domain.guards, stop)) for domain in hop.system.domains)
        trajectory = simulate(replace(hop.system, domains=domains), hop.state)
        self.ends(trajectory, "limit")
        assert trajectory.q[-1, -1] == pytest.approx(1.15, abs=1e-12) == trajectory.q[:, -1].max()

    def test_without_a_section(self, hop):
        """The same motion, of which no cycle closes."""
        q, v = hop.state
        held = {"knee_touchdown": q[-1], "taut": 1.0, "flexing": 1.0, "compressing": 1.0, "limited": 0.0}
        start = Moment(q, v, "stance", held)
        usual = simulate(hop.system, start, cycles=2)
        endless = simulate(replace(hop.system, section=""), start, max_evaluations=usual.evaluations + 500)
        self.ends(endless, "evaluation_cap")
        assert (usual.cycles, endless.cycles) == (2, 0)
        for event, same in zip(usual.events, endless.events, strict=False):
            assert event.name == same.name and event.time == pytest.approx(same.time, abs=1e-8)

    @pytest.mark.slow
    def test_painleve(self, free_robot):
        """A leg dragged ahead of the hip on ground that is too rough: the slip equation loses its solution."""
        reached = []
        for lean in np.linspace(-1.2, 1.2, 13):
            q = np.array([0.0, 0.0, lean, 0.15])
            q[1] = -free_robot.toe_position(q, "toe")[1]
            for speed in (-2.0, 2.0):
                system = hopping(free_robot, HoppingLaw(), contact=Contact(2.0))
                trajectory = simulate(system, (q, np.array([speed, 0.0, 0.0, 0.0])), rtol=1e-7)
                assert finite(trajectory)
                if trajectory.reason == "painleve":
                    reached.append(trajectory)
        assert reached
        for trajectory in reached:
            self.ends(trajectory, "painleve")

    def test_a_law_without_a_value(self, hop):
        """A number that is too large in the law ends the run; none of it gets into the trajectory."""
        broken = replace(
            hop.system,
            domains=tuple(
                replace(domain, law=lambda t, *_: (0.0, 8.0 if t < 0.1 else math.exp(1e5)))
                for domain in hop.system.domains
            ),
        )
        trajectory = simulate(broken, hop.state)
        assert trajectory.reason in ("not_finite", "step_size")
        self.ends(trajectory, trajectory.reason)
        assert trajectory.t[-1] == pytest.approx(0.1, abs=1e-3)

    @pytest.mark.parametrize(
        "value",
        [
            lambda t, *_: math.exp(1e5),
            lambda t, *_: math.exp(1e5) if t > 0.1 else 1.0,
            lambda t, *_: math.exp(1e5) if 0.09 < t < 0.11 else 0.1 - t,
        ],
    )
    @pytest.mark.parametrize("observes", [True, False])
    def test_a_guard_without_a_value(self, hop, value, observes):
        """Where a number in it is too large it ends the run, and nothing is raised."""
        guard = Guard("broken", value, None if observes else Reset())
        domains = tuple(replace(domain, guards=(guard, *domain.guards)) for domain in hop.system.domains)
        trajectory = simulate(replace(hop.system, domains=domains), hop.state)
        assert trajectory.reason == "not_finite", trajectory.message
        assert trajectory.t[-1] <= 0.1 + 0.05
        assert np.isfinite(trajectory.q).all() and np.isfinite(trajectory.u).all()
