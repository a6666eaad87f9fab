"""Contact modes that fit alike: all engines take the one that pushes the toe off best."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.lanes.groups import Group, spread_held
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.lanes.modes import choose
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.modes import choose as choose_one
from spear_pin.hybrid.modes import starting_phase
from spear_pin.hybrid.rules.footing import STARTS_TO_SLIDE

pytestmark = pytest.mark.extra("heyoka")
BARELY = 1e-6  # N: too little for the toe to be said to stick


@pytest.fixture(scope="module", params=[-0.5, 0.5])
def tied(request, free_hop):
    """A system, and a state in which its resting toe bears next to nothing and is pushed forward or backward a bit."""
    system, (q, v) = free_hop.system, free_hop.state
    along = np.linalg.svd(system.robot.toe_jacobian(q, "toe"))[2][2:]
    v = along.T @ (along @ v)  # at rest
    y = np.concatenate([q, v, np.zeros(20)])
    phase, held = starting_phase(system, (q, v))
    held = {**held, "flexing": 1.0} if "flexing" in held else held

    def at(torques):
        law = replace(system.law, stance_torque=float(torques[0]), hip_stance_torque=float(torques[1]))
        return system.build(system.robot, law, system.spring, system.contact)

    def missed(torques):
        made = at(torques)
        flow = Flow(made, made.of_phase(phase)[1], held)
        flow(0.0, y)
        return flow.force("toe")[1] - BARELY, flow.toe_acceleration("toe")[0] - request.param * STARTS_TO_SLIDE

    return at(fsolve(missed, [0.0, 0.0], xtol=1e-12)), phase, held, y, "slip+" if request.param > 0.0 else "slip-"


def test_both_ways_fit(tied):
    """Else it were no tie."""
    system, phase, held, y, _ = tied
    for domain in system.of_phase(phase)[1:]:
        flow = Flow(system, domain, held)
        flow(0.0, y)
        sign = 1.0 if domain.contacts == ("slip+",) else -1.0
        assert flow.force("toe")[1] > 0.0 and flow.pivot("toe") > 0.0
        assert sign * flow.toe_acceleration("toe")[0] > -STARTS_TO_SLIDE


def test_one(tied):
    system, phase, held, y, mode = tied
    assert choose_one(system, phase, held, 0.0, y).domain.contacts == (mode,)


@pytest.mark.parametrize("n", [1, 64])
def test_lanes(tied, n):
    system, phase, held, y, mode = tied
    numbers = Numbers(system, {}, Code(1e-12))
    state = np.repeat(y[: 2 * system.robot.nv, None], n, axis=1)
    group = Group(np.arange(n), np.zeros(n), state, spread_held(held, n))
    chosen, left = choose(numbers, phase, group)
    assert not len(left)
    assert [(ready.domain.contacts, len(part)) for ready, part, _ in chosen] == [((mode,), n)]


def test_a_lane_alone(tied):
    system, phase, held, y, mode = tied
    numbers = Numbers(system, {}, Code(1e-12))
    lone = LoneRunner(numbers, 0)
    ready, _ = lone._enter(lone._begin(phase, y[: 2 * system.robot.nv], held, [np.inf]))
    assert ready.domain.contacts == (mode,)
