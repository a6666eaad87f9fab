"""The motion for scalars of any kind equals the reference engine's along gaits in space."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, load
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.round_hopping import RoundHoppingLaw, round_hopping
from spear_pin.hybrid.contact import SLIP
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.elimination import solve
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.structure import Scalars
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.model.equations import mechanism_of

OPS = replace(FLOATS, solve=solve)
SAMPLES = 4  # of each arc
SLOW = 1e-3  # m/s: a toe that sets out has a direction of its own, which only the reference engine finds


def gait(name):
    """A gait that ships in space, one of the plane, where everything is symmetric, or HOPPY's first hops."""
    if name.startswith("round"):
        hoppy = load("hoppy")
        law = replace(RoundHoppingLaw.driven(hoppy), unlimited_friction=name == "round")
        system = round_hopping(hoppy, law)
        return system, system.guess()
    if name == "long_stride":
        return embed(Gait.load(name))
    found = Gait.load(name)
    return found.system, found.state


@pytest.mark.parametrize(
    "name", ["round", "round, which slips", "trot", "pace", "pronk", "long_stride", "turn_9", "gallop"]
)
@pytest.mark.slow
def test_along_a_gait(name):
    system, state = gait(name)
    mechanism, seen = mechanism_of(system.robot), set()
    numbers = Scalars(system.law, system.springs, system.ground, system.robot.model.damping.tolist())
    for segment in run(system, state, 1, Options(1e-9, keep=True)).segments:
        if not segment.pieces or segment.pieces[-1].end == segment.pieces[0].begin:
            continue
        flow = Flow(system, segment.domain, segment.held)
        for piece in segment.pieces[:: max(1, len(segment.pieces) // SAMPLES)]:
            t, y = piece.end, np.array(piece.state(np.array([piece.end]))[:, 0])
            flow(t, y)
            a, u, forces = flow.a.copy(), list(flow.u), {toe: flow.force(toe) for toe in system.robot.toes}
            speeds = [math.hypot(*flow.toe_velocity(toe)[:-1]) for toe, mode in flow._closed if mode == SLIP]
            if min(speeds, default=1.0) < SLOW:
                continue
            guards = [flow.value(guard, t, y) for guard in segment.domain.guards]
            q, v = y[: system.robot.nv].tolist(), y[system.robot.nv : 2 * system.robot.nv].tolist()
            motion = Motion(system, segment.domain, mechanism, t, q, v, segment.held, numbers, OPS)
            np.testing.assert_allclose(motion.a, a, rtol=0, atol=1e-11 * (1.0 + np.abs(a).max()))
            np.testing.assert_allclose(motion.u, u, rtol=0, atol=1e-11 * (1.0 + np.abs(u).max()))
            np.testing.assert_allclose(motion.guards, guards, rtol=1e-10, atol=1e-10)
            for toe, force in forces.items():
                np.testing.assert_allclose(motion.force(toe), force, rtol=0, atol=1e-9 * (1.0 + np.abs(force).max()))
            seen.add(segment.domain.phase)
    assert any("flight" in phase for phase in seen) and any("flight" not in phase for phase in seen)
