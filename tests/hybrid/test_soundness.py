"""Automata that do not hang together are refused as they are made."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import Gait
from spear_pin.errors import BadFunction, BadValue, NotSymbolic, SpearError, UnknownName
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Guard, Mount, Reset, Rub
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.soundness import Latched
from spear_pin.model.path import Joints
from spear_pin.model.planar import Planar


def never(t, q, v, held, p, dyn, ops):
    return 1.0


def with_guard(guard):
    return lambda domain: replace(domain, guards=(*domain.guards, guard))


CHANGES = {  # of the domain "stance", with what is said to be valid
    "phase": (with_guard(Guard("bump", never, Reset(phase="stanse"))), "stance, flight"),
    "toe": (with_guard(Guard("bump", never, Reset(impact=("tow",)))), "toe"),
    "spring released": (with_guard(Guard("bump", never, Reset(release=("hip",)))), "knee"),
    "reason": (with_guard(Guard("bump", never, ends="tired")), "fall"),
    "contact": (lambda domain: replace(domain, contacts=("glued",)), "open, stick, slip+, slip-"),
    "joint of a spring": (
        lambda domain: replace(domain, mounts=(replace(domain.mounts[0], path=Joints({"ankle": 1.0})),)),
        "boom_z, hip, knee",
    ),
    "spring whose numbers a mount has": (
        lambda domain: replace(domain, mounts=(replace(domain.mounts[0], of="hip"),)),
        "knee",
    ),
    "joint of friction": (lambda domain: replace(domain, rubs=(Rub("ankle", 1.0, 1.0),)), "boom_z, hip, knee"),
    "what a spring rests at": (
        lambda domain: replace(domain, mounts=(replace(domain.mounts[0], rest="rust"),)),
        "knee_touchdown, taut",
    ),
    "switch": (
        lambda domain: replace(domain, switch=replace(domain.switch, reset=Reset(phase="hover"))),
        "stance, flight",
    ),
}


def test_an_impact_that_pins_one_toe_and_leaves_another_to_friction():
    system = Gait.load("long_stride").system
    entered = system.section_phase
    with pytest.raises(BadValue, match="all toes on the ground pinned, or none"):
        replace(
            system,
            domains=tuple(
                replace(d, contacts=("pinned", "stick")) if d.phase == entered else d for d in system.domains
            ),
        )


def changed_stance(system, change):
    return replace(system, domains=tuple(change(d) if d.name == "stance" else d for d in system.domains))


@pytest.mark.parametrize("what", CHANGES)
def test_names_that_there_are_not(hop, what):
    change, valid = CHANGES[what]
    with pytest.raises(UnknownName) as error:
        changed_stance(hop.system, change)
    assert set(valid.split(", ")) <= set(error.value.valid)
    assert "stance" in str(error.value)


def test_what_is_not_to_be_told_apart(hop):
    with pytest.raises(BadValue, match="goes on or ends"):
        changed_stance(hop.system, with_guard(Guard("bump", never, Reset(), ends="fall")))
    with pytest.raises(BadValue, match="one for each of toe"):
        changed_stance(hop.system, lambda domain: replace(domain, contacts=("stick", "stick")))


def test_a_section_that_ends_no_flight(hop):
    with pytest.raises(UnknownName, match="touchdown"):
        replace(hop.system, section="touch")
    system = replace(hop.system, section="")  # of which a motion can be asked, but no cycle
    with pytest.raises(UnknownName, match="unknown section ''; nearest of"):
        simulate(system, hop.state, 1)


def test_shipped_systems_pass(hop, free_hop):
    for system in (hop.system, free_hop.system, Gait.load("long_stride").system):
        replace(system)


@pytest.mark.extra
def test_a_law_that_reads_what_nothing_latches(hop):
    """Which only shows when it is called: by one lane, and by what compiles many."""

    def reads(domain):
        return replace(domain, law=lambda t, q, v, held, p, dyn, ops: [held["nothing"], 0.0])

    system = changed_stance(hop.system, reads)
    with pytest.raises(BadFunction, match="law of domain 'stance'.*nothing.*valid: .*taut"):
        simulate(system, hop.state, 1)
    if taylor.available():
        with pytest.raises(SpearError, match="nothing.*valid: .*taut"):
            simulate_many(system, *(part[None] for part in hop.state))


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda domain: replace(domain, law=lambda t, *_: [math.sin(t), 0.0]), "law of domain 'stance'"),
        (with_guard(Guard("late", lambda t, *_: math.cos(t))), "guard 'late' of domain 'stance'"),
    ],
)
def test_what_symbols_cannot_be_put_into_is_named(hop, change, named):
    """The reference engine takes it; what compiles does not, and says who it was."""
    system = changed_stance(hop.system, change)
    simulate(system, hop.state, 1)
    with pytest.raises(NotSymbolic, match=f"{named} does not take symbols .*functions from ops"):
        simulate_many(system, *(part[None] for part in hop.state))


def test_a_frame_that_there_is_not(hop):
    """In the reference engine, and on symbols."""
    system = changed_stance(hop.system, with_guard(Guard("low", lambda t, q, v, held, p, dyn, ops: dyn.height("hipp"))))
    with pytest.raises(BadFunction, match="guard 'low' of domain 'stance'.*frame 'hipp'.*hip"):
        simulate(system, hop.state, 1)
    with pytest.raises(UnknownName, match="frame 'hipp'.*hip"):
        Planar(hop.system.robot).position("hipp", [0.0] * 3, math)


def test_a_frame_whose_joint_has_the_same_name(hop):
    """Files may call a link as its joint: it is the link's, as of `frame_position`."""
    model = hop.system.robot.model.copy()
    place = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1]))
    model.addFrame(pin.Frame("hip", model.getJointId("hip"), 0, place, pin.FrameType.BODY), False)
    robot = hop.system.robot.with_model(model)
    heights = []

    def low(t, q, v, held, p, dyn, ops):
        heights.append(float(dyn.height("hip")) - robot.frame_position(q, "hip")[-1])
        return 1.0

    system = changed_stance(replace(hop.system, robot=robot), with_guard(Guard("low", low)))
    assert simulate(system, hop.state, 1).reason == "complete"
    assert heights and np.abs(heights).max() < 1e-12


def test_what_is_held_is_a_mapping():
    held = Latched({"rest": 1.0})
    assert held == {"rest": 1.0} and held["rest"] == 1.0 and held.get("other") is None and "other" not in held


def test_a_spring_of_another_leg_is_asked_by_its_own_names():
    system = Gait.load("long_stride").system
    mounted = next(domain for domain in system.domains if domain.mounts)
    wrong = replace(mounted, mounts=(*mounted.mounts[:-1], replace(mounted.mounts[-1], taut="tout")))
    assert isinstance(wrong.mounts[-1], Mount)
    with pytest.raises(UnknownName, match="tout"):
        replace(system, domains=tuple(wrong if domain is mounted else domain for domain in system.domains))


@dataclass
class Counting:
    """A latch that cannot be hashed."""

    by: float = 1.0

    def __call__(self, q, v, held, p):
        return {"by": self.by}


UNASKED = {
    "out of its domain": lambda q, v, held, p: {"root": math.sqrt(q[0] - 10.0)},
    "singular": lambda q, v, held, p: {"x": np.linalg.solve(np.zeros((1, 1)), [1.0])},
    "not to be hashed": Counting(),
}


@pytest.mark.parametrize("what", UNASKED)
def test_latches_that_cannot_be_asked_at_the_guess_are_left_alone(hop, what):
    changed_stance(hop.system, with_guard(Guard("bump", never, Reset(latch=UNASKED[what]))))


def test_a_guess_that_fails_is_left_alone(hop):
    def fails():
        raise np.linalg.LinAlgError("Singular matrix")

    assert replace(hop.system, guess=fails).guess is fails
