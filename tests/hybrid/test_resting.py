"""Two toes at rest on the ground whose laws undo each other: hard starts of the bound, and what they lead to."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.hard_starts import RTOL, STRIDES, followed, gait_of, recorded
from spear_pin import Contact, Trajectory, simulate
from spear_pin.gaits.bounding import bounding
from spear_pin.hybrid import resting
from spear_pin.hybrid.contact import OPEN, SLIP_BACKWARD, SLIP_FORWARD, STICK
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.filippov import Sliding, Unloaded
from spear_pin.hybrid.modes import find_torn
from spear_pin.hybrid.reasons import NUMERICAL
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.hybrid.run import run
from spear_pin.hybrid.shares import weights
from spear_pin.hybrid.simulate import sample

BOTH, TORN = 36, 50  # starts: both toes alternate for 30 ms; a sticking toe is torn off


def system_of(seed):
    start = recorded()[seed]
    system = gait_of(start.gait).system
    state = np.array(start.q), np.array(start.v)
    return bounding(system.robot, system.law, system.spring, Contact(start.friction)), state


@cache
def kept(seed):
    system, state = system_of(seed)
    return system, run(system, state, STRIDES, Options(RTOL, keep=True))


def crossing():
    """The motion of both toes, as a flow and its pieces."""
    system, result = kept(BOTH)
    segment = next(s for s in result.segments if s.domain.crossing is not None and s.pieces)
    return system, Sliding(system, segment.domain, segment.held), segment.pieces


class TestStarts:
    @pytest.mark.slow
    @pytest.mark.parametrize(("seed", "reason"), [(46, "fall"), (54, "fall"), (100, "fall"), (145, "fall")])
    def test_go_on(self, seed, reason):
        """What used to end as `zeno`."""
        assert recorded()[seed].formerly == "zeno"
        assert followed(recorded()[seed]).reason == reason

    @pytest.mark.slow
    def test_ledger_closes(self):
        _, result = kept(BOTH)
        np.testing.assert_allclose([work.sum() for work in result.work], result.change, rtol=0, atol=1e-7)


class TestBothToes:
    @pytest.mark.slow
    def test_stay_on_the_ground_without_force(self):
        system, flow, pieces = crossing()
        robot = system.robot
        assert pieces[-1].end - pieces[0].begin > 0.02
        for piece in pieces:
            y = piece.state(piece.begin)
            flow(piece.begin, y)
            q, v = y[: robot.nq], y[robot.nq : 2 * robot.nq]
            for toe in robot.toes:
                jacobian = robot.toe_jacobian(q, toe)[1]
                assert abs(robot.toe_position(q, toe)[1]) < 1e-8 and abs(jacobian @ v) < 1e-7
                assert abs(jacobian @ flow.a + robot.toe_drift(q, v, toe)[1]) < 1e-8 * np.abs(flow.a).max()
                assert flow.force(toe) == (0.0, 0.0)
            assert all(0.0 <= share <= 1.0 for share in flow.shares)
            motors = robot.actuation_matrix @ np.array(flow.u)
            np.testing.assert_allclose(robot.mass_matrix(q) @ flow.a + robot.bias(q, v), motors, rtol=0, atol=1e-8)

    @pytest.mark.slow
    def test_in_the_samples(self):
        trajectory = sample(*kept(BOTH))
        alone = (trajectory.domain == CHATTER) & ~trajectory.force.any(axis=(1, 2))
        assert alone.sum() > 50 and not trajectory.engaged[alone].any()

    @pytest.mark.slow
    def test_is_the_limit_of_a_steep_blend(self):
        """Every law blended continuously by the two toes' speeds, over a layer that gets thinner."""
        system, flow, pieces = crossing()
        begin, duration, n = pieces[0].begin, 1e-3, system.robot.nv
        start = pieces[0].state(begin)
        end = next(p for p in pieces if p.end >= begin + duration).state(begin + duration)[: 2 * n]
        last = Flow(system, replace(flow.domain, crossing=None), flow.held)

        def slope(t, y, layer):
            full = np.concatenate([y, np.zeros(len(start) - 2 * n)])
            flow(0.0, full)  # so each law holds what it latches here
            last.hold(flow.held)
            last(0.0, full)
            rises = [system.robot.toe_jacobian(y[:n], toe)[1] @ y[n:] for toe in system.robot.toes]
            closed = [np.clip(0.5 - 0.5 * rise / layer, 1e-6, 1.0 - 1e-6) for rise in rises]
            each = np.array([*(part.a for part, _ in flow._turns), last.a])
            return np.concatenate([y[n:], weights(*closed) @ each])

        errors = []
        for layer in (1e-3, 1e-4):
            found = solve_ivp(
                slope, (0.0, duration), start[: 2 * n], method="Radau", rtol=1e-7, atol=1e-9, args=(layer,)
            )
            errors.append(np.abs(found.y[:, -1] - end).max())
        assert errors[1] == pytest.approx(errors[0] / 10, rel=0.3) and errors[1] < 1e-2


class TestTornOff:
    @pytest.mark.slow
    def test_only_leaving_is_consistent(self):
        """On the cone's edge, loaded: slip that way has no positive pivot, slip the other way would pull at the toe."""
        system, result = kept(TORN)
        events = [event for event in result.events if event.name.startswith("painleve:")]
        assert events
        for event in events:
            toe = event.name.removeprefix("painleve:")
            i = system.robot.toes.index(toe)
            left = [s for s in result.segments if s.domain.name == event.domain and ended(s) == event.time]
            assert all(segment.domain.contacts[i] == STICK for segment in left)
            # several follow each other in an instant: it is the one on the cone's edge
            y = left[0].pieces[-1].state(np.array([left[0].pieces[-1].end]))[:, 0]
            segment = min(left, key=lambda segment: inside(system, force_in(system, segment, STICK, i, y)[0]))
            tangential, normal = force_in(system, segment, STICK, i, y)[0]
            assert normal > 1.0 and abs(inside(system, (tangential, normal))) < 1e-4
            that_way = SLIP_BACKWARD if tangential > 0.0 else SLIP_FORWARD
            other_way = SLIP_FORWARD if tangential > 0.0 else SLIP_BACKWARD
            assert force_in(system, segment, that_way, i, y)[1].pivot(toe) <= 0.0
            pulled, flow = force_in(system, segment, other_way, i, y)
            assert pulled[1] < 0.0 < flow.pivot(toe)
            assert force_in(system, segment, OPEN, i, y)[1].toe_acceleration(toe)[1] > 0.0
            following = next(e for e in result.events if e.time == event.time and e.name.endswith("lift_off"))
            assert following.name == f"{toe.removesuffix('_toe')}_lift_off"


class FakeFlow:
    """A flow of one toe, of which only its mode and its force count."""

    def __init__(self, mode, force):
        self.domain = SimpleNamespace(contacts=(mode,))
        self.system = SimpleNamespace(robot=SimpleNamespace(toes=("toe",)))
        self.force = lambda toe: (0.0, force)

    def __call__(self, t, y):
        return y


@pytest.mark.parametrize(
    ("before", "after", "toes"),
    [
        ((STICK, 174.0), (SLIP_FORWARD, -3.0), ["toe"]),
        ((STICK, 174.0), (SLIP_FORWARD, 3.0), []),  # it slips
        ((STICK, 1e-6), (SLIP_FORWARD, -3.0), []),  # its force has faded: a lift-off as any
        ((SLIP_BACKWARD, 174.0), (SLIP_FORWARD, -3.0), []),
        ((STICK, 174.0), (OPEN, 0.0), []),
    ],
)
def test_which_toes_are_torn_off(before, after, toes):
    assert find_torn(FakeFlow(*before), FakeFlow(*after), 0.0, np.zeros(2)) == toes


@pytest.mark.slow
def test_the_motion_with_the_most_toes_bearing_is_taken_then_that_with_the_fewest_leaving(monkeypatch):
    """In this order they are asked, the first that is consistent being taken."""
    system, flow, pieces = crossing()
    y = pieces[0].state(np.array([pieces[0].begin]))[:, 0]
    asked = []

    def none(system, flow, y, kinds, far):
        asked.append(sorted(kinds.values()))

    monkeypatch.setattr(resting, "_motion", none)
    assert resting.find_resting(system, flow, y) is None
    once = [list(key) for key in dict.fromkeys(map(tuple, asked))]
    bears, alternates, leaves = resting.BEARS, resting.ALTERNATES, resting.LEAVES
    assert once == [
        [bears, bears],
        [bears, alternates],
        [bears, leaves],
        [alternates, alternates],
        [alternates, leaves],
        [leaves, leaves],
    ]


def ended(segment):
    return segment.began + segment.pieces[-1].end if segment.pieces else None


def inside(system, force):
    """How far a force is inside the cone, in N."""
    return system.contact.friction * force[1] - abs(force[0])


def force_in(system, segment, mode, i, y):
    """Force on a toe in a mode of contact, the others' being what they are, and the flow."""
    contacts = (*segment.domain.contacts[:i], mode, *segment.domain.contacts[i + 1 :])
    toe = system.robot.toes[i]
    flow = Flow(system, replace(segment.domain, contacts=contacts), segment.held)
    if mode == OPEN:
        flow = Unloaded(system, segment.domain, replace(segment.domain, contacts=contacts), segment.held)
    flow(segment.pieces[-1].end, y)
    return flow.force(toe), flow


@pytest.mark.slow
def test_motion_that_ceases_to_exist_leaves_no_sample_without_numbers(tmp_path):
    """The shares of two toes come together with others; the run goes on, and its file can be read."""
    motion = simulate(*system_of(78), 2, 1e-6)
    assert motion.reason not in NUMERICAL
    assert all(np.isfinite(getattr(motion, name)).all() for name in ("a", "u", "tau", "force"))
    assert len(Trajectory.load(motion.save(tmp_path / "run.npz"))) == len(motion)
