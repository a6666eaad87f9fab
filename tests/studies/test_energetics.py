"""Energy flows and costs of transport, against quadrature by hand, closed forms and each other."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from spear_pin import Gait, HoppingLaw, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.model.actuator import Actuator
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import gearbox, motor, scale_motor
from spear_pin.model.motor import Drive, Gearbox, drawn_power
from spear_pin.studies.bound import summarize
from spear_pin.studies.design import electrical_cost
from spear_pin.studies.energetics import compute_points, costs, energy_flow
from spear_pin.studies.published_costs import KINDS, PUBLISHED, UNVERIFIED, CostPoint, running_animals

HIP = Actuator(motor("faulhaber_3863h024cr"), Gearbox(60.0, 0.75), Battery(24.0))
KNEE = Actuator(motor("spear_ii_knee"), gearbox("spear_ii_knee_gear"), Battery(24.0))
GRAVITY = 9.81
HOPS = 3


def equipped(hip=HIP, knee=KNEE):
    system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(stance_torque=9.4))
    return with_hardware(system, Hardware((hip, knee)))


def integral(hops, values, cycles):
    """By Simpson's rule between events, a cycle."""
    chosen = np.flatnonzero((hops.cycle >= cycles[0]) & (hops.cycle <= cycles[1]))
    pieces = np.split(chosen, np.flatnonzero(np.diff(hops.t[chosen]) < 1e-12) + 1)
    return sum(simpson(values[p], x=hops.t[p]) for p in pieces if len(p) > 2) / (1 + cycles[1] - cycles[0])


@pytest.fixture(scope="module")
def system():
    return equipped()


@pytest.fixture(scope="module")
def trajectory(system):
    return simulate(system, system.guess(), HOPS, progress=False)


@pytest.fixture(scope="module")
def flow(system, trajectory):
    return energy_flow(system, trajectory)


@pytest.fixture(scope="module")
def gait():
    return Gait.load("long_stride")


@pytest.fixture(scope="module")
def stride(gait):
    return simulate(gait.system, gait.state, 1, progress=False)


class TestEnergyFlow:
    def test_closes(self, system, trajectory, flow):
        assert abs(flow.residual) < 1e-7
        assert abs(energy_flow(system, trajectory, skip=2).residual) < 1e-7
        assert flow.residual == pytest.approx(
            flow.battery - sum(flow.losses.values()) - trajectory.ledger.change.mean(), abs=1e-12
        )

    def test_is_the_ledgers(self, trajectory, flow):
        for joint in flow.joints:
            for name, sign in (("joule", -1), ("gearbox", -1), ("motor", -1)):
                assert getattr(joint, name) == pytest.approx(
                    sign * trajectory.electrical[f"{name}_{joint.joint}"].mean()
                )
            assert joint.given - joint.regained == pytest.approx(trajectory.electrical[f"battery_{joint.joint}"].mean())
            assert joint.motor == pytest.approx(trajectory.ledger[f"motor_{joint.joint}"].mean())
        for name in ("damping", "friction", "impact", "released", "slip"):
            assert flow.losses[name] == pytest.approx(-trajectory.ledger[name].mean(), abs=1e-15)

    def test_halves_of_the_batterys_power(self, trajectory, flow):
        """From R i² + kt N i ω, without the package's own actuator."""
        assert abs(flow.gap) < 1e-3
        for i, (actuator, joint) in enumerate(zip((HIP, KNEE), flow.joints, strict=True)):
            current, rate = trajectory.current[:, i], trajectory.v[:, 1 + i]
            kt, resistance = actuator.motor.torque_constant, actuator.motor.resistance
            power = resistance * current**2 + kt * actuator.gearbox.ratio * current * rate
            assert joint.given == pytest.approx(integral(trajectory, np.maximum(power, 0.0), (1, HOPS)), abs=2e-3)
            assert joint.regained == pytest.approx(integral(trajectory, np.maximum(-power, 0.0), (1, HOPS)), abs=2e-3)
            assert joint.joule == pytest.approx(integral(trajectory, resistance * current**2, (1, HOPS)), rel=1e-3)

    def test_the_spring_by_its_compression(self, trajectory, flow):
        """½ k δ² of every stance, δ from the latched angle to the deepest one; nothing is left at lift-off here."""
        stored = []
        for cycle in range(1, HOPS + 1):
            knee = trajectory.q[(trajectory.cycle == cycle) & (trajectory.phase == "stance"), 2]
            stored.append(0.5 * 48.84 * (knee.max() - knee[0]) ** 2)
        assert flow.spring_stored == pytest.approx(np.mean(stored), rel=1e-3)
        assert flow.spring_stored - flow.spring_returned == pytest.approx(flow.losses["released"], abs=1e-3)

    def test_cycles_are_left_out(self, system, trajectory):
        last = energy_flow(system, trajectory, skip=HOPS - 1)
        assert last.total("joule") == pytest.approx(
            -(trajectory.electrical["joule_hip"] + trajectory.electrical["joule_knee"])[-1]
        )
        for skip in (-1, HOPS):
            with pytest.raises(BadValue, match="skip"):
                energy_flow(system, trajectory, skip)

    @pytest.mark.slow
    def test_inductances_and_inner_resistance_close_too(self):
        battery = Battery(24.0, 0.1)
        looped = equipped(replace(HIP, bandwidth=60.0, battery=battery), replace(KNEE, bandwidth=60.0, battery=battery))
        run = simulate(looped, looped.guess(), 1, progress=False)
        flow = energy_flow(looped, run)
        assert abs(flow.residual) < 1e-7 and flow.magnetic == pytest.approx(run.electrical.change.mean()) != 0.0
        assert abs(flow.gap) < 0.01 * flow.battery

    def test_needs_hardware(self, gait, stride):
        with pytest.raises(BadValue, match="hardware"):
            energy_flow(gait.system, stride)


class TestCosts:
    def test_of_a_hop_in_place(self, system, trajectory, flow):
        found = costs(system, trajectory)
        power = trajectory.u * trajectory.v[:, 1:]
        positive = sum(integral(trajectory, np.maximum(power[:, i], 0.0), (1, HOPS)) for i in (0, 1))
        negative = sum(integral(trajectory, np.maximum(-power[:, i], 0.0), (1, HOPS)) for i in (0, 1))
        assert found.energy["mechanical_positive"] == pytest.approx(positive, rel=1e-3)
        assert found.energy["mechanical_absolute"] == pytest.approx(positive + negative, rel=1e-3)
        assert found.energy["electrical_0"] == pytest.approx(flow.total("given"))
        assert found.energy["electrical_24"] == pytest.approx(flow.total("given") - 0.24 * flow.total("regained"))
        assert found.energy["electrical_100"] == pytest.approx(trajectory.electrical.work[:, [0, 3]].sum(axis=1).mean())
        with pytest.raises(BadValue, match="distance"):
            _ = found.of_transport

    def test_the_height_of_a_ballistic_hop(self, system, trajectory):
        """To a few percent the hip rises by v²/2g of its speed at lift-off: the leg swings beneath it."""
        found = costs(system, trajectory)
        pairs = zip(trajectory.named("lift_off"), trajectory.named("apex"), strict=True)
        assert found.rise == pytest.approx(np.mean([apex.q[0] - left.q[0] for left, apex in pairs]))
        assert found.weight == pytest.approx((4.6 + 1.72 + 0.48) * GRAVITY) and found.mass == pytest.approx(6.8)
        for name, energy in found.energy.items():
            assert found.of_height[name] == pytest.approx(energy / (6.8 * GRAVITY * found.rise))

    def test_a_stride_is_what_its_summary_says(self, gait, stride):
        found, summary = costs(gait.system, stride), summarize(gait, stride)
        assert found.of_transport["mechanical_absolute"] == pytest.approx(summary["cost_of_transport"], rel=1e-3)
        assert found.of_transport["mechanical_positive"] == pytest.approx(
            summary["cost_of_transport_positive"], rel=1e-3
        )
        assert found.distance == pytest.approx(summary["stride"])
        with pytest.raises(BadValue, match="rise"):
            _ = found.of_height

    @pytest.mark.slow
    def test_drives_are_of_one_motor_of_a_pair(self, gait, stride):
        """By hand for one joint, and by the design study, whose hips count mechanically, for the knees."""
        drive = Drive(motor("assumed_600w"), Gearbox(15.0, 0.83), 48.0)
        idle = replace(drive, motor=replace(drive.motor, resistance=1e-12), gearbox=Gearbox(15.0, 1.0))
        found = costs(gait.system, stride, [idle, drive, idle, drive]).of_transport
        assert found["electrical_0"] == pytest.approx(electrical_cost(gait, drive), rel=1e-3)
        columns = [stride.coordinates.index(joint) for joint in stride.actuated]
        power = 2.0 * drive.bus_power(stride.u / 2.0, stride.v[:, columns])
        for name, share in {"electrical_0": 0.0, "electrical_24": 0.24, "electrical_100": 1.0}.items():
            watts = drawn_power(power, share).sum(axis=1)
            expected = np.trapezoid(watts, stride.t) / (43.76 * GRAVITY * 0.875429)
            assert costs(gait.system, stride, [drive] * 4).of_transport[name] == pytest.approx(expected, rel=1e-3)

    def test_hardware_of_a_pair_is_two_motors(self, gait, stride):
        """Without losses of gears the motion is the same, and so is the energy by either way."""
        one = motor("assumed_600w")
        pair = Actuator(scale_motor(one, 1200.0), Gearbox(15.0, 1.0), Battery(480.0))
        system = with_hardware(gait.system, Hardware((pair,) * 4))
        run = simulate(system, gait.state, 1, progress=False)
        by_drives = costs(gait.system, stride, [Drive(one, Gearbox(15.0, 1.0), 480.0)] * 4)
        for name, energy in costs(system, run).energy.items():
            assert energy == pytest.approx(by_drives.energy[name], rel=1e-3)
        assert abs(energy_flow(system, run).residual) < 1e-7
        with pytest.raises(BadValue, match="drives"):
            costs(system, run, [Drive(one, Gearbox(15.0), 48.0)] * 4)

    def test_as_many_drives_as_joints(self, gait, stride):
        with pytest.raises(BadValue, match="drives"):
            costs(gait.system, stride, [])

    def test_points(self, gait, stride):
        found = costs(gait.system, stride)
        (point,) = compute_points("Q-SPEAR", found)
        assert (point.mass, point.kind, point.verification) == (pytest.approx(43.76), "mechanical", "computed")
        assert point.cost == found.of_transport["mechanical_positive"]


class TestPublished:
    def test_rows_that_can_be_checked(self):
        by_name = {point.name: point for point in PUBLISHED}
        cheetah, ranger = by_name["MIT Cheetah"], by_name["Cornell Ranger 2011"]
        assert cheetah.cost == pytest.approx(973.0 / (cheetah.mass * GRAVITY * 6.0), rel=0.01)
        assert ranger.mass == pytest.approx(22 * 0.45359, rel=1e-3)
        other = by_name["robot of ETH Zurich"]
        assert other.cost == pytest.approx(23.4 / (other.mass * GRAVITY * 0.4), rel=0.01)

    def test_what_is_from_memory_is_unverified(self):
        for point in PUBLISHED:
            assert point.kind in KINDS and point.verification != "computed"
            assert ("memory" in point.source or "assumed" in point.source) == (point.verification in UNVERIFIED)

    def test_the_line_of_running_animals(self):
        assert running_animals(1.0) == pytest.approx(1.09, abs=0.005)
        assert running_animals(7.0) == pytest.approx(0.59, abs=0.005)
        assert running_animals(33.0) == pytest.approx(0.36, abs=0.005)
        assert running_animals(80.0) / running_animals(8.0) == pytest.approx(10.0**-0.316)

    def test_numbers_are_positive(self):
        for mass, cost in ((0.0, 1.0), (1.0, -1.0)):
            with pytest.raises(BadValue, match="CostPoint"):
                CostPoint("x", mass, cost, "electrical", "", "computed")
        with pytest.raises(BadValue, match="mass"):
            running_animals(0.0)
