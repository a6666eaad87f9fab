"""The bounding automaton: its phases and where their guards lead, and what each transition latches, by hand."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, Spring, bounding, load
from tests.gaits.bounding_gaits import LEGS, NAMES, each_gait, gait, trajectory


class TestAutomaton:
    LEADS = {
        "posterior_stance": {"posterior_lift_off": "flight_1", "anterior_touchdown": "double_1"},
        "double_1": {"posterior_lift_off": "anterior_stance", "anterior_lift_off": "posterior_stance"},
        "flight_1": {"anterior_touchdown": "anterior_stance", "posterior_return": "posterior_stance"},
        "anterior_stance": {"anterior_lift_off": "flight_2", "posterior_touchdown": "double_2"},
        "double_2": {"anterior_lift_off": "posterior_stance", "posterior_lift_off": "anterior_stance"},
        "flight_2": {"posterior_touchdown": "posterior_stance", "anterior_return": "anterior_stance"},
    }
    CLOSED = {
        "posterior_stance": (1, 0),
        "double_1": (1, 1),
        "flight_1": (0, 0),
        "anterior_stance": (0, 1),
        "double_2": (1, 1),
        "flight_2": (0, 0),
    }

    @pytest.fixture(params=["knee", "force"])
    def system(self, request):
        law = replace(gait(NAMES[0]).system.law, lift_off=request.param)
        return bounding(load("q_spear"), law)

    def test_phases(self, system):
        assert set(system.phases) == set(self.LEADS)
        assert system.section == "posterior_touchdown" and system.section_phase == "posterior_stance"
        assert system.landing[0] == "flight_2" and system.cyclic == ("torso_x",)
        assert {phase: len(system.of_phase(phase)) for phase in self.LEADS} == {
            phase: 3 ** sum(closed) for phase, closed in self.CLOSED.items()
        }

    def test_domains(self, system):
        for domain in system.domains:
            assert tuple(int(mode != "open") for mode in domain.contacts) == self.CLOSED[domain.phase]
            bears = {f"{leg}_knee" for leg, (row, *_) in LEGS.items() if self.CLOSED[domain.phase][row]}
            assert {mount.name for mount in domain.mounts} == bears
            assert all(mount.path.side == LEGS[mount.name.removesuffix("_knee")][3] for mount in domain.mounts)
            leads = {guard.name: guard.reset.phase for guard in domain.guards if guard.reset and guard.reset.phase}
            assert leads == self.LEADS[domain.phase]
        assert len({domain.name for domain in system.domains}) == len(system.domains)

    def test_resets(self, system):
        for domain in system.domains:
            for guard in domain.guards:
                if guard.name.endswith(("touchdown", "return")):
                    leg = guard.name.partition("_")[0]
                    assert guard.reset.impact == (f"{leg}_toe",) and not guard.reset.release
                if guard.name.endswith("lift_off"):
                    leg = guard.name.partition("_")[0]
                    assert guard.reset.release == (f"{leg}_knee",) and not guard.reset.impact

    def test_falls(self, system):
        for domain in system.domains:
            falls = {guard.name for guard in domain.guards if guard.ends == "fall"}
            assert falls == {f"fall:{leg}_{part}" for leg in LEGS for part in ("hip", "knee")}

    def test_knee_lifts_off_only_by_name(self):
        counts = {}
        for kind in ("knee", "force"):
            law = replace(gait(NAMES[0]).system.law, lift_off=kind)
            domain = bounding(load("q_spear"), law).of_phase("posterior_stance")[0]
            counts[kind] = sum(guard.name == "posterior_lift_off" for guard in domain.guards)
        assert counts == {"knee": 2, "force": 1}

    @each_gait
    def test_lift_off_as_asked(self, name):
        motion, law = trajectory(name), gait(name).system.law
        for leg, (row, _, knee, side) in LEGS.items():
            (event,) = motion.named(f"{leg}_lift_off")
            last = np.flatnonzero(motion.phase == f"{leg}_stance")[-1]
            if law.lift_off == "knee":
                assert side * event.q[knee] == pytest.approx(law.knee_rest, abs=1e-8)
                assert side * event.v[knee] < 0.0 and motion.force[last, row, 1] > 0.0
            else:
                assert motion.force[last, row, 1] == pytest.approx(0.0, abs=1e-4)

    def test_measures_and_defaults(self, system):
        assert system.spring == Spring(stiffness=112.0, damping=0.0) and system.contact == Contact()
        assert system.kind == "bounding" and set(system.measures) == {"mean_speed", "period", "stride"}


class TestTransitions:
    """What is latched as one phase gives way to the next."""

    def test_a_stance_that_resumes_keeps_its_leg_angle(self):
        """A foot back on the ground just after lift-off: its stance goes on where it was."""
        system = gait(NAMES[0]).system
        flight = next(domain for domain in system.domains if domain.name == "flight_1")
        (returns,) = (guard for guard in flight.guards if guard.name == "posterior_return")
        (lands,) = (guard for guard in flight.guards if guard.name == "anterior_touchdown")
        q, v = gait(NAMES[0]).state
        held = {"posterior_leg": 0.7, "anterior_leg": 0.9}
        law = replace(system.law, speed_gain=(5.0, 7.0), speed_nominal=(1.0, 2.0))
        back = returns.reset.latch(q.tolist(), v.tolist(), held, law)
        assert (back["posterior_leg"], back["posterior_knee_taut"], back["posterior_knee_rest"]) == (0.7, 1.0, q[4])
        assert back["posterior_hip_torque"] == pytest.approx(law.posterior_hip_torque + 5.0 * (v[0] - 1.0))
        assert back["posterior_knee_torque"] == pytest.approx(law.posterior_knee_torque)
        down = lands.reset.latch(q.tolist(), v.tolist(), held, law)
        assert down["anterior_leg"] == pytest.approx(q[2] + q[5] - q[6] / 2)
        assert down["anterior_hip_torque"] == pytest.approx(law.anterior_hip_torque + 7.0 * (v[0] - 2.0))
        assert down["anterior_knee_torque"] == pytest.approx(law.anterior_knee_torque)
        assert down["span"] == pytest.approx(law.anterior_stance_span)
        left = max(1.0 - (q[2] + q[3] - q[4] / 2 - 0.7) / law.posterior_stance_span, 0.2)
        assert back["span"] == pytest.approx(left * law.posterior_stance_span)

    def test_a_knee_that_never_flexed_has_nothing_to_come_back_from(self):
        """The rule of the knee counts from when it has flexed beyond θ̄; until then only a foot without force leaves."""
        found = gait(NAMES[0])
        law = replace(found.system.law, lift_off="knee")
        system = bounding(found.system.robot, law)
        guards = {guard.name: guard for guard in system.of_phase("posterior_stance")[0].guards[:2]}
        q, v = found.state[0].copy(), found.state[1].copy()
        held = system.landing[1].latch(q.tolist(), v.tolist(), {}, law)

        def value(name, knee, **more):
            q[4] = law.knee_rest + knee
            return guards[name].value(0.0, q.tolist(), v.tolist(), {**held, **more}, law, None, None)

        assert value("posterior_flexed", -0.1) > 0.0 > value("posterior_flexed", 0.1)
        assert value("posterior_lift_off", -0.1) > 0.0
        latched = guards["posterior_flexed"].reset.latch(q.tolist(), v.tolist(), held, law)
        assert value("posterior_lift_off", 0.1, **latched) > 0.0 > value("posterior_lift_off", -0.1, **latched)
        assert value("posterior_flexed", 0.1, **latched) > 0.0
