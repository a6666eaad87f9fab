"""The shipped references: both engines, and closed forms, find their answers within their bounds."""

import math

import numpy as np
import pinocchio as pin
import pytest
from numpy.polynomial import Polynomial

from benchmarks.references.answering import apart, by_other, by_reference
from benchmarks.references.table import problems
from benchmarks.references.writing import COARSE, FINE, described
from spear_pin.cli.references import SHIPPED
from spear_pin.errors import SpearError
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues
from spear_pin.references.check import QUANTITIES, compare, read
from tests.lagrangian import monopod
from tests.slow import slow_but

GRAVITY = 9.81
REFERENCES = read(SHIPPED)
CHEAP = "block_slides", "leg_hops", "impact_2_slides"


def answered(events):
    """Events as an answer has them."""
    return [
        {"event": event.name, "foot": event.foot} | {name: event.measured[name].tolist() for name in QUANTITIES}
        for event in events
    ]


def assert_right(name, events):
    differences, others = compare(REFERENCES[name], answered(events))
    assert not others and len(differences) == len(REFERENCES[name]["answer"]["events"]) * (
        3 + 2 * len(REFERENCES[name]["robot"]["coordinates"])
    )
    assert differences[0].off <= differences[0].bound, str(differences[0])


def test_each_problem_has_its_file():
    assert REFERENCES.keys() == problems().keys()
    assert sum(path.stat().st_size for path in SHIPPED.glob("*.json")) < 300_000


@pytest.mark.parametrize("name", REFERENCES)
def test_files_say_what_the_problems_are(name):
    assert described(problems()[name]).items() <= REFERENCES[name].items()


@pytest.mark.parametrize("name", slow_but(REFERENCES, *CHEAP))
def test_a_coarser_run_is_within_the_bounds(name):
    assert_right(name, by_reference(problems()[name], COARSE))


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", slow_but(REFERENCES, *CHEAP))
def test_the_other_engine_is_within_the_bounds(name):
    assert_right(name, by_other(problems()[name]))


def test_engines_with_other_events_disagree():
    problem = problems()["leg_hops"]
    events = by_reference(problem, COARSE)
    with pytest.raises(SpearError, match="events .* are .* in the other run"):
        apart(events, events[1:])


@pytest.mark.parametrize("name", ["block_hops", "leg_runs", "crank_hops", "bound_slow", "trot"])
def test_the_urdf_is_the_robot(name):
    robot, said = problems()[name].robot, REFERENCES[name]["robot"]
    model = pin.buildModelFromXML("".join(said["urdf"]))
    own = [model.joints[model.getJointId(name)].idx_q for name in said["coordinates"]]
    assert said["coordinates"] == list(robot.coordinates) and sorted(own) == list(range(model.nq))
    armature = [said["armature_kg_m2"][joint] for joint in said["coordinates"]]
    data, rng = model.createData(), np.random.default_rng(1)
    for q in rng.uniform(-1.0, 1.0, (3, robot.nq)):
        there = np.empty(model.nq)
        there[own] = q
        upper = np.triu(pin.crba(model, data, there))
        found = (upper + np.triu(upper, 1).T)[np.ix_(own, own)] + np.diag(armature)
        np.testing.assert_allclose(found, robot.mass_matrix(q), rtol=0, atol=1e-12)
        pin.framesForwardKinematics(model, data, there)
        for frame in [*said["feet"], *(link for loop in said["loops"] for link in loop["links"])]:
            place = data.oMf[model.getFrameId(frame)].translation
            point = robot.frame_position(q, frame)
            np.testing.assert_allclose(place[[0, 2]] if len(point) == 2 else place, point, rtol=0, atol=1e-12)


def test_multipliers_of_the_gait():
    problem, answer = problems()["leg_gait"], REFERENCES["leg_gait"]["answer"]
    state = np.array(problem.q), np.array(problem.v)
    found = eigenvalues(differentiate_return_map(problem.system, state, FINE, step=2e-5))
    stored = [complex(*pair) for pair in answer["multipliers_re_im"]]
    np.testing.assert_allclose(found, stored, rtol=0, atol=answer["bounds"]["multiplier"])
    last = answer["events"][-1]
    np.testing.assert_allclose(last["position"] + last["velocity"], [*problem.q, *problem.v], rtol=0, atol=1e-11)


class Block:
    """The block by its polynomials: forces that are polynomials of the time, and a foot that falls from a height."""

    def __init__(self, name, height, speed, friction):
        self.friction, self.mass, self.t = friction, 2.0, 0.0
        self.x, self.v = 0.0, np.array([speed, 0.0])
        self.events, self.height, self.name = [], height, name

    def fly(self, lift=0.0, less=0.0):
        """Until it lands, under a lift that falls with the time; the impulse of friction then stops or slows it."""
        up = Polynomial([self.height, self.v[1], 0.5 * (lift / self.mass - GRAVITY), -less / self.mass / 6.0])
        after = min(root.real for root in up.roots() if abs(root.imag) < 1e-9 and root.real > 1e-9)
        falls = -up.deriv()(after)
        self.x += self.v[0] * after
        slowed = max(0.0, abs(self.v[0]) - self.friction * falls)
        self.v, self.height = np.array([math.copysign(slowed, self.v[0]), 0.0]), 0.0
        self.happen("touchdown", after)

    def slide(self, until, name, push=0.0, less=0.0, since=0.0):
        """Until a time since touchdown, or None for rest, under a push, while a lift grows."""
        side = math.copysign(1.0, self.v[0] or push)
        weight = Polynomial([GRAVITY, -less / self.mass])
        speed = Polynomial([push / self.mass]) - side * self.friction * weight
        gained = speed.integ(lbnd=since)
        speed = gained + self.v[0]
        end = min(root.real for root in speed.roots() if root.real > since) if until is None else until
        self.x += speed.integ(lbnd=since)(end)
        self.v = np.array([speed(end) if until is not None else 0.0, 0.0])
        self.happen(name, end - since)
        return end

    def happen(self, name, after):
        self.t += after
        foot = "foot" if name in ("touchdown", "lift_off") else ""
        event = {"event": name, "foot": foot, "time_s": self.t, "position": [self.x, 0.1 + self.height]}
        self.events.append(event | {"velocity": self.v.tolist()})


def falls():
    block = Block("block_falls", 1.0, 0.0, 0.8)
    block.fly()
    return block.events


def hops():
    block = Block("block_hops", 0.1, 2.0, 0.5)
    block.fly(25.0, 20.0)
    block.slide(2.0 * GRAVITY / 40.0, "lift_off", less=40.0)
    block.fly(25.0, 20.0)
    return block.events


def slides():
    block = Block("block_slides", 0.5, 1.5, 0.3)
    block.fly(25.0, 20.0)
    stops = block.slide(None, "stick", push=-3.0, less=10.0)
    slips = (2.0 * GRAVITY - 3.0 / 0.3) / 10.0
    block.happen("slip", slips - stops)
    block.slide(2.0 * GRAVITY / 10.0, "lift_off", push=-3.0, less=10.0, since=slips)
    block.fly(25.0, 20.0)
    return block.events


@pytest.mark.parametrize(("name", "solve"), [("block_falls", falls), ("block_hops", hops), ("block_slides", slides)])
def test_blocks_in_closed_form(name, solve):
    differences, others = compare(REFERENCES[name], solve())
    assert not others and differences[0].off <= differences[0].bound, str(differences[0])


@pytest.mark.slow
def test_a_fall_in_closed_form():
    """The toe falls freely, and the impact brings it to rest, with the mass matrix of the symbolic Lagrangian."""
    (event,) = REFERENCES["leg_falls"]["answer"]["events"]
    height = 0.85 - 2.0 * 0.318 * math.cos(0.5)
    after = math.sqrt(2.0 * height / GRAVITY)
    assert event["time_s"] == pytest.approx(after, abs=1e-12)
    q, v = np.array([0.85 - height, 0.5, 1.0]), np.array([-GRAVITY * after, 0.0, 0.0])
    terms = monopod(("boom_z", "hip", "knee")).terms(q, v)
    J = terms.jacobians["toe"]
    response = np.linalg.solve(terms.mass_matrix, J.T)
    stopped = v - response @ np.linalg.solve(J @ response, J @ v)
    np.testing.assert_allclose(event["position"] + event["velocity"], [*q, *stopped], rtol=0, atol=1e-11)
