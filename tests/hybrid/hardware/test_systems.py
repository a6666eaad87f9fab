"""Hardware in systems and gaits, and the files that a run with it is kept in."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Trajectory, find_gait, hopping, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import Hardware, Sensing
from spear_pin.hybrid.parameters import with_hardware, with_parameters
from spear_pin.model.actuator import Thermal
from spear_pin.model.motor import Gearbox
from tests.hybrid.hardware.drives import (
    CONFIGURATIONS,
    IDEAL,
    MOTOR,
    NOISE,
    REAL,
)


class TestSystems:
    def test_without_hardware_it_is_what_it_was(self, hop, clean):
        hardware = Hardware((REAL, REAL))
        assert with_hardware(hop.system, None) is hop.system
        bare = with_hardware(with_hardware(hop.system, hardware), None)
        rebuilt = bare.build(bare.robot, bare.law)
        assert bare.hardware is None and rebuilt.hardware is None
        again = simulate(rebuilt, hop.state, 2, 1e-11)
        np.testing.assert_array_equal(again.q, clean.q)

    def test_systems_that_are_rebuilt_keep_the_last(self, hop):
        first, last = Hardware((REAL, REAL)), Hardware((IDEAL, REAL), NOISE)
        system = with_hardware(with_hardware(hop.system, first), last)
        changed = with_parameters(with_parameters(system, {"stance_torque": 7.0}), {"stiffness": 40.0})
        assert changed.hardware is last
        assert (changed.law.stance_torque, changed.spring.stiffness) == (7.0, 40.0)

    @pytest.mark.slow
    def test_a_gait_is_found_for_the_hardware(self, hop, robot):
        geared = with_hardware(hopping(robot), Hardware((REAL, replace(REAL, gearbox=Gearbox(15.0, 0.83)))))
        near = with_parameters(geared, {"stance_torque": 9.4})
        gait = find_gait(near, ["stance_torque"], {"flight_time": 0.2}, guess=hop.state)
        assert gait.system.hardware is geared.hardware
        assert gait.durations["flight"] == pytest.approx(0.2, abs=1e-9)
        assert gait.parameters["stance_torque"] > 1.1 * hop.parameters["stance_torque"]

    @pytest.mark.parametrize("count", [0, 1, 3])
    def test_every_motor_has_one(self, hop, count):
        with pytest.raises(BadValue, match=r"actuators.*2, one for each of .*hip.*knee"):
            with_hardware(hop.system, Hardware((REAL,) * count))

    def test_names_of_the_states(self):
        loop = replace(REAL, bandwidth=100.0)
        hot = replace(loop, current_limit=8.0, thermal=Thermal(4.0, 1.0))
        assert Hardware((REAL, REAL)).names == ()
        hardware = Hardware((hot, loop), NOISE)
        assert hardware.names == ("clock", "current_0", "square_0", "current_1")
        assert hardware.states([1.0, 2.0, 3.0, 4.0]) == (1.0, [{"current": 2.0, "square": 3.0}, {"current": 4.0}])
        assert hardware.stored([1.0, 2.0, 3.0, 4.0]) == pytest.approx(0.5 * MOTOR.inductance * (4 + 16))
        assert Hardware((loop, REAL)).max_step == hardware.max_step < Hardware((REAL, REAL)).max_step

    @pytest.mark.parametrize(
        ("field", "value"),
        [("angle_noise", -1e-3), ("rate_noise", math.nan), ("cutoff", 0.0), ("cutoff", 251.0)]
        + [("losses", -1.0), ("losses", 51.0), ("loss_duration", 1e-4), ("angle_noise", "x")],
    )
    def test_bad_values(self, field, value):
        with pytest.raises(BadValue, match=f"Sensing.{field}"):
            Sensing(**{field: value})


class TestFiles:
    @pytest.mark.slow
    def test_round_trip(self, run, tmp_path):
        one, sensing = CONFIGURATIONS["all"]
        trajectory = run(one, sensing=sensing, rtol=1e-9)
        again = Trajectory.load(trajectory.save(tmp_path / "hop.npz"))
        assert again.current.shape == (len(trajectory.t), 2) and again.electrical.flows == trajectory.electrical.flows
        for name in ("t", "q", "u", "current", "reference"):
            np.testing.assert_array_equal(getattr(again, name), getattr(trajectory, name))
        for name in ("work", "change", "residual"):
            np.testing.assert_array_equal(getattr(again.electrical, name), getattr(trajectory.electrical, name))

    @pytest.mark.parametrize("old", [False, True])
    def test_without_hardware(self, clean, tmp_path, old):
        path = clean.save(tmp_path / "hop.npz")
        if old:  # as from before there was hardware
            with np.load(path) as data:
                arrays = {name: data[name] for name in data if name not in ("current", "reference")}
            meta = json.loads(str(arrays["meta"]))
            del meta["drives"]
            np.savez_compressed(path, **arrays | {"meta": np.array(json.dumps(meta))})
        again = Trajectory.load(path)
        assert again.electrical is None and again.current.shape == again.reference.shape == (len(clean.t), 0)
        np.testing.assert_array_equal(again.u, clean.u)
        assert not any("current" in name for name in again.columns()[0])

    def test_columns(self, run, tmp_path):
        trajectory = run(replace(IDEAL, current_limit=5.0))  # less than the reference
        with trajectory.export(tmp_path / "hop.csv").open(encoding="utf-8") as file:
            rows = list(csv.reader(file))
        for name, values in (("current", trajectory.current), ("reference", trajectory.reference)):
            for i, joint in enumerate(("hip", "knee")):
                column = rows[0].index(f"{name}_{joint} [A]")
                np.testing.assert_array_equal([float(row[column]) for row in rows[1:]], values[:, i])
