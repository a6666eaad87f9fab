"""Numbers of the reference runs that statements ask for, against what the documentation has of the same gaits."""

import numpy as np
import pytest

from spear_pin.studies.audit import runs
from spear_pin.studies.audit.statements import STATEMENTS, numbers

STUDIES = {statement.id: statement.study for statement in STATEMENTS}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("bounds-at-speed", pytest.approx(2.5, abs=1e-6)),
        ("bound-is-robust", pytest.approx(1.067, abs=1e-3)),
        ("hip-drive-exceeded", pytest.approx(0.1597, abs=1e-4)),
        ("hip-effort-small", pytest.approx((31.2 / 21.7, 7.9 / 26.3), rel=0.01)),
        ("too-little-100-w", pytest.approx(0.1396, abs=1e-4)),
        ("nearly-260-w", pytest.approx(0.0695, abs=1e-4)),
        ("enough-600-w", pytest.approx(0.0621, abs=1e-4)),
        ("near-the-events", pytest.approx((0.90, 0.61), abs=5e-3)),  # least_effort has none outside
        ("knee-flat-before-touchdown", pytest.approx(1.0892, abs=1e-3)),
        ("peak-speed", pytest.approx(7.16, abs=5e-3)),
        ("spring-does-most", pytest.approx(0.698, abs=1e-3)),
        ("gains-by-classical-tuning", pytest.approx((3000.0, 4000.0), rel=2e-4)),
        ("resting-angle", pytest.approx(1.242, abs=1e-3)),
        ("supply-does-not-matter", 0.0),
        ("bounding-knee-sign", [-200.0, 200.0]),
        *(
            pytest.param(name, expected, marks=pytest.mark.slow)
            for name, expected in (
                ("spring-takes-off-peak", pytest.approx((75.5 - 58.6, 82.6 - 68.3), abs=0.1)),
                ("spring-leaves-hips", pytest.approx(0.0, abs=1e-6)),
                ("twice-the-stiffness", pytest.approx((41.6, 54.1), abs=0.05)),
                ("stiffer-is-less", pytest.approx((75.5, 58.6, 41.6, 15.0), abs=0.05)),
                ("stiffer-than-200", pytest.approx((15.0, 15.2, 45.5), abs=0.1)),
                ("spring-not-in-flight", pytest.approx(0.0, abs=1e-6)),
                ("flat-at-200", pytest.approx((0.0, 0.0), abs=1e-9)),
                ("flight-time", pytest.approx(0.2, abs=1e-9)),
                ("low-then-high", pytest.approx(-0.4062, abs=1e-4)),
                ("natural-limit-cycle", pytest.approx(0.4062, abs=1e-4)),
                ("half-waves", pytest.approx(0.3643 * 2.56, abs=1e-3)),
                ("fixed-point", pytest.approx(0.0, abs=1e-9)),
            )
        ),
    ],
)
def test_numbers(name, expected):
    assert STUDIES[name]() == expected


class TestBound:
    def test_phases(self):
        phases = STUDIES["four-phases"]()
        assert len(phases) == 4 and sum(phases) == pytest.approx(0.35, abs=1e-3)

    @pytest.mark.slow
    def test_torque_is_reversed_beyond_the_virtual_stiffness(self):
        assert max(numbers.spread_in_stance(200.0)) < 1e-9 < min(numbers.spread_in_stance(56.0))

    @pytest.mark.slow
    def test_zero_dynamics(self):
        assert numbers.fixed_point_residual("force_lift_off") < 1e-8
        assert STUDIES["outputs-stay-at-zero"](gait="least_effort") < 1e-8

    def test_preload(self):
        with_it, with_less = numbers.friction_by_preload()
        assert with_it == pytest.approx(0.486, abs=1e-3) and with_it < with_less < 0.6
        assert STUDIES["less-preload-by-angle"]()[::2] == pytest.approx([15.0, 5.0], abs=1e-3)
        assert 0.0 < numbers.outside_without_preload() < 1.0


def test_a_wrong_frequency():
    slow, own, fast = numbers.work_against()
    assert own < 0.1 < 1.0 < min(slow, fast)


class TestPush:
    def test_gears(self):
        turns = STUDIES["motor-peaks-later"]()
        shares = [row.swing.rotor_share for row in runs.gears()]
        assert len(turns) == 4 and (np.diff(turns) > 0.0).all()
        assert (np.diff(shares) > 0.0).all() and shares[-1] == STUDIES["rotor-dominates"]() > 0.0

    def test_rest(self):
        assert 0.0 < numbers.energy_left() < numbers.energy_left(0.05) < 1.0
        *others, without_motor = numbers.least_forces()
        assert len(others) == 5 and min(others) > 0.0 > without_motor

    def test_motor(self):
        assert STUDIES["belt-does-matter"]() > 0.0
        low, high = STUDIES["swing-below-threshold"]()
        assert low < 10.0 and high == 24.0


@pytest.mark.slow
def test_runs_are_made_once():
    assert runs.hop() is runs.hop() and runs.knees() is runs.knees()
    assert np.isfinite(runs.bound_costs().of_transport["electrical_0"])
