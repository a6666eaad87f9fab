"""A pinned toe, and a system without cycles: against the constraint's forces by hand and the energy's balance."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from spear_pin import Contact, Spring, find_gait, hopping, load, simulate, simulate_many
from spear_pin.errors import BadValue
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import has_lanes
from spear_pin.hybrid.contact import OPEN, PINNED
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import change_system, number, with_numbers
from spear_pin.hybrid.phases import contact_domains
from spear_pin.hybrid.result import Moment
from tests.lagrangian import monopod

ROBOT = load("spear_ii", locked=["boom_x"])
COORDINATES = ("boom_z", "hip", "knee")
BENT = np.array([0.636 * np.cos(0.5), 0.5, 1.0])  # both links of the leg have the length 0.318 m
DURATION = 0.2


def pushing(t, q, v, held, p, dyn, ops):
    """A knee that is flexed, and then extended: the toe is pulled up, and then pressed down."""
    return (0.0, 60.0 * (1.0 - t / 0.05))


def pinned(law=pushing, guards=()):
    """A leg whose toe stays where it is, without a section."""
    return HybridSystem(
        kind="pinned",
        robot=ROBOT,
        law=None,
        springs={"knee": Spring()},
        contact=Contact(0.1),
        domains=(Domain("pinned", "pinned", (PINNED,), law, guards=guards),),
        section="",
        cyclic=(),
        build=lambda *_: pinned(law, guards),
        guess=lambda: (BENT, np.zeros(3)),
        phase_limit=DURATION,
    )


def moved(system):
    return simulate(system, Moment(BENT, np.zeros(3), "pinned", {}), rtol=1e-10, progress=False)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_stays_whatever_force_it_takes(friction):
    """Pulled, and outside any cone; every sample obeys the equations of a Lagrangian."""
    system = with_dry_friction(pinned(), {"knee": friction}) if friction else pinned()
    trajectory = moved(system)
    assert (trajectory.reason, trajectory.cycles) == ("no_event", 0) and trajectory.t[-1] == DURATION
    force = trajectory.force[:, 0]
    assert force[:, 1].min() < -100.0 and force[:, 1].max() > 100.0 and (np.abs(force) @ [1.0, -0.1]).max() > 1.0
    lagrangian = monopod(COORDINATES)
    for q, v, a, u, f, rub in zip(
        trajectory.q, trajectory.v, trajectory.a, trajectory.u, force, trajectory.friction, strict=True
    ):
        D, coriolis, gravity, _, toe, J, drift = (np.array(part) for part in lagrangian.evaluate(*q, *v))
        np.testing.assert_allclose(toe.ravel(), 0.0, atol=1e-9)
        np.testing.assert_allclose(J @ a + drift.ravel(), 0.0, atol=1e-8)
        right = [0.0, *u] + J.T @ f + rub - coriolis.ravel() - gravity.ravel()
        np.testing.assert_allclose(D @ a, right, atol=1e-8)


def test_is_not_asked_whether_it_moves():
    """With dry friction, a joint's modes alone are chosen from, also where the toe has drifted along the ground."""
    system = with_dry_friction(pinned(), {"knee": 0.5})
    drifting = Moment(BENT, np.array([0.0, 1e-5, 0.0]), "pinned", {})
    assert simulate(system, drifting, progress=False).reason == "no_event"


def test_contact_domains_leave_it_alone():
    (domain,) = contact_domains(pinned().domains[0], ROBOT.toes, {})
    assert domain.contacts == (PINNED,) and domain.guards == ()


def test_lanes_refuse_it():
    with pytest.raises(BadValue, match="without pinned toes"):
        simulate_many(pinned(), BENT[None], np.zeros((1, 3)))


@dataclass(frozen=True)
class Pinned:
    """The change of a hop that pins its toe in stance: no friction is asked for, and nothing slips."""

    def __call__(self, system):
        stance, *_, flight = system.domains
        kept = tuple(guard for guard in stance.guards if guard.name != "slip")
        assert flight.contacts == (OPEN,)
        return replace(system, domains=(replace(stance, contacts=(PINNED,), guards=kept), flight))


@pytest.mark.slow
def test_a_hop_with_a_pinned_toe_is_found_and_differentiated():
    """In the plane too: the compiled engine leaves it to the reference engine."""
    gait = find_gait(change_system(hopping(ROBOT), Pinned()))
    assert gait.residual < 1e-9 and not has_lanes(gait.system, ())
    name, value = "stiffness", number(gait.system, "stiffness")
    table = gait.sensitivity([name])

    def at(k):
        again = find_gait(with_numbers(gait.system, {name: value * (1.0 + 1e-3 * k)}), guess=gait.state, rtol=1e-12)
        return np.array([Orbit(again.system, again.state, ()).measures[each].value for each in ("period", "effort")])

    expected = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12e-3 * value)
    got = [table.derivatives[each][0] for each in ("period", "effort")]
    np.testing.assert_allclose(got, expected, rtol=1e-6)
