"""Derivatives of cycles in which a toe comes down beside one on the ground: both take part in the impact."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

from spear_pin import Contact, HoppingLaw, Spring, load
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.result import FINEST, Moment, Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.seeds import seeds
from tests.hybrid.test_double_stance import POSTURE, dropped, standing

OVER = ("stance_torque", "knee_ratio", "torso_mass")


def posed(angles, damping=2.0):
    """A law that turns the joints to angles, by what the law's torque is to be for a radian."""

    def law(t, q, v, held, p, dyn, ops):
        pairs = zip(angles, q[3:], v[3:], strict=True)
        return [p.stance_torque * (there - angle) - damping * rate for there, angle, rate in pairs]

    return law


def jumping(on_both, on_one, stiffness, friction):
    """Q-SPEAR, to jump off both pairs of legs."""
    laws = {"double": posed(on_both), "flight": posed(POSTURE)}

    def build(robot, law, spring, contact):
        system = standing(contact)
        domains = tuple(replace(each, law=laws.get(each.phase, posed(on_one))) for each in system.domains)
        return replace(system, robot=robot, law=law, springs={"knee": spring}, domains=domains, build=build)

    return build(load("q_spear"), HoppingLaw(stance_torque=stiffness), Spring(), Contact(friction))


def cycle(system, y, phase="posterior"):
    return run(system, Moment(y[:7], y[7:], phase, {}), 1, Options(FINEST))


def begun(system, pitch, sinking):
    """The state after the first touchdown of the posterior toe."""
    q, v = dropped(pitch)
    v[1] = -sinking
    return np.concatenate(cycle(system, np.concatenate([q, v]), "flight").state)


CASES = {
    "from the air": ((0.08, 0.29, 0.39, 0.59), (0.08, 0.46, 0.25, 0.22), 160.0, 0.5, 0.083, 0.92),
    "onto both": ((0.43, 0.09, 0.47, 0.50), (0.39, 0.53, 0.47, 0.23), 88.0, 1.5, 0.088, 0.60),
}


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("case", CASES)
def test_against_differences(case):
    """By velocities at which the toe rests, and by numbers; of the reference engine, extrapolated."""
    system = jumping(*CASES[case][:4])
    y = begun(system, *CASES[case][4:])
    recorder = Recorder(system)
    still = null_space(system.robot.toe_jacobian(y[:7], "posterior_toe"))
    along = np.concatenate([np.zeros((7, 2)), still @ np.random.default_rng(0).normal(size=(still.shape[1], 2))])
    dy = np.concatenate([along, np.zeros((14, len(OVER)))], axis=1)
    raw = np.concatenate([np.zeros((len(recorder.numbers), 2)), seeds(system, OVER).numbers], axis=1)
    found = differentiate_cycle(system, recorder, y, dy, raw)
    events = [(each.arc.domain.phase, each.arc.event.name) for each in found.stretches]
    assert ("posterior", "anterior_touchdown") in events
    assert (events[-1] == ("anterior", "posterior_touchdown")) == (case == "onto both")
    np.testing.assert_allclose(found.y, np.concatenate(cycle(system, y).state), rtol=0, atol=1e-8)

    def beside(k, step):
        if k < 2:
            return np.concatenate(cycle(system, y + step * along[:, k]).state)
        name = OVER[k - 2]
        return np.concatenate(cycle(with_numbers(system, {name: number(system, name) + step}), y).state)

    for k in range(2 + len(OVER)):
        h = 1e-4 * (1.0 if k < 2 else number(system, OVER[k - 2]))
        wide, narrow = ((beside(k, step) - beside(k, -step)) / (2.0 * step) for step in (h, 0.5 * h))
        expected = (4.0 * narrow - wide) / 3.0
        np.testing.assert_allclose(found.dy[:, k], expected, rtol=0, atol=1e-6 * np.abs(expected).max())
