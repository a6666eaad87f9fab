"""Design questions: what springs take off the motors, what a drive cannot do, families and searches over designs."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, simulate
from spear_pin.errors import BadValue, Infeasible, NoGait, UnknownName
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.request import Request
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox, Motor
from spear_pin.model.spring import Spring
from spear_pin.studies.design import (
    Points,
    against,
    codesign,
    drive_choice,
    electrical_cost,
    families,
    family,
    points,
    smallest_violation,
    spring_sweep,
    sprung,
)
from tests.gaits.solutions import least_effort

REST = np.radians(40.0)
SIDES = (1.0, -1.0)  # of posterior and anterior knee: the sign of a flexed one
SIMPLE = Drive(Motor("simple", torque_constant=0.1, resistance=1.0, nominal_torque=0.2), Gearbox(10.0), 24.0)


@pytest.fixture(scope="module")
def gait() -> Gait:
    return Gait.load("long_stride")


@pytest.fixture(scope="module")
def sweep(gait: Gait) -> dict[float, Points]:
    return spring_sweep(gait)


@pytest.fixture(scope="module")
def knees(gait: Gait) -> np.ndarray:
    """Angles of the knees without any spring."""
    system = gait.system
    bare = system.build(system.robot, system.law, Spring(stiffness=0.0, damping=0.0), system.contact)
    trajectory = simulate(bare, gait.state, progress=False)
    return trajectory.q[:, [system.robot.index(f"{leg}_knee") for leg in ("posterior", "anterior")]]


@pytest.mark.slow
class TestSprings:
    def test_the_motor_gives_the_total_less_the_spring(self, sweep: dict[float, Points], knees: np.ndarray) -> None:
        """The spring of each leg by hand: -k (θ - θ_td) while the knee is more flexed than at touchdown."""
        total = sweep[0.0]
        for stiffness, given in sweep.items():
            assert given.t == pytest.approx(total.t, abs=1e-9)
            assert np.array_equal(given.bears, total.bears)
            for i, side in enumerate(SIDES):
                bears = total.bears[:, i]
                angle = knees[bears, i]
                spring = -side * stiffness * np.maximum(side * (angle - angle[0]), 0.0)
                assert given.torque[bears, i] + spring == pytest.approx(total.torque[bears, i], abs=1e-5)
                assert given.torque[~bears, i] == pytest.approx(total.torque[~bears, i], abs=1e-5)
            assert given.speed == pytest.approx(total.speed, abs=1e-6)

    def test_as_stiff_as_the_virtual_spring_the_torque_is_constant(
        self, gait: Gait, sweep: dict[float, Points], knees: np.ndarray
    ) -> None:
        given = sweep[200.0]
        for i, leg in enumerate(("posterior", "anterior")):
            bears = given.bears[:, i]
            preload = 0.5 * getattr(gait.system.law, f"{leg}_knee_torque")
            off = 200.0 * abs(abs(knees[bears, i][0]) - REST) + 1e-6
            assert np.abs(np.abs(given.torque[bears, i]) - preload).max() <= off
            assert off < 0.1

    def test_a_stiffer_one_has_the_motor_pull_back(self, sweep: dict[float, Points]) -> None:
        for i, side in enumerate(SIDES):
            extending = {k: -side * given.torque[given.bears[:, i], i] for k, given in sweep.items()}
            middle = len(extending[0.0]) // 2
            deepest = [torque[middle] for torque in extending.values()]
            assert deepest == sorted(deepest, reverse=True)
            for k in (0.0, 56.0, 112.0):
                assert extending[k].min() >= extending[k][0] - 1e-3 > 0.0
            for k in (300.0, 400.0):
                assert extending[k].max() <= extending[k][0] + 0.1
            assert extending[400.0][middle] < 0.0 < extending[400.0][0]

    def test_peaks_that_the_documents_quote(self, sweep: dict[float, Points]) -> None:
        quoted = {0.0: (75.5, 82.6), 56.0: (58.6, 68.3), 112.0: (41.6, 54.1), 200.0: (15.0, 31.7)}
        for stiffness, peaks in quoted.items():
            assert sweep[stiffness].peak == pytest.approx(peaks, abs=0.06)

    def test_the_gait_s_own_spring_is_the_default(self, gait: Gait, sweep: dict[float, Points]) -> None:
        assert np.array_equal(points(gait).torque, sweep[56.0].torque)

    def test_another_stiffness_leaves_the_rest_of_the_spring(self, gait: Gait) -> None:
        own = replace(gait.system.spring, hardening=90.0, preload=4.0)
        stiffer = sprung(rebuilt(gait.system, spring=own), 70.0)
        assert stiffer.spring == replace(own, stiffness=140.0)

    @pytest.mark.slow
    def test_hips_do_not_depend_on_it(self, gait: Gait) -> None:
        one, other = points(gait, "hip", 0.0), points(gait, "hip", 200.0)
        assert one.torque == pytest.approx(other.torque, abs=1e-5)

    def test_what_cannot_be_asked_for(self, gait: Gait) -> None:
        with pytest.raises(UnknownName, match="ankle"):
            points(gait, "ankle")
        with pytest.raises(BadValue, match="stiffness"):
            points(gait, "knee", -1.0)


def made(torque: list[float], speed: list[float], since: list[float], until: list[float]) -> Points:
    """Points of a posterior leg, one a second; the anterior one does nothing."""
    zero = np.zeros(len(torque))
    columns = {"torque": torque, "speed": speed}
    both = {name: np.column_stack([values, zero]) for name, values in columns.items()}
    times = {name: np.column_stack([values, zero + np.nan]) for name, values in (("since", since), ("until", until))}
    return Points(np.arange(len(torque), dtype=float), bears=np.isfinite(times["since"]), **both, **times)


class TestEnvelope:
    """A drive of 24 N·m at rest and 24 rad/s without load: its envelope is 24 - ω, and 24 + ω braking."""

    def test_on_inside_and_outside(self) -> None:
        given = made([24.0, 10.0, 14.0, -20.0, 20.0], [0.0, 10.0, 11.0, 5.0, 5.0], [np.nan] * 5, [np.nan] * 5)
        use = against(given, SIMPLE)
        assert use.margin[:, 0] == pytest.approx([0.0, 4.0, -1.0, 9.0, -1.0])
        assert use.margin[:, 1] == pytest.approx(24.0)
        assert use.worst == pytest.approx([-1.0, 24.0])
        assert not use.fits
        rising = made([0.0, 10.0, 20.0, 30.0, 40.0, 50.0], [0.0] * 6, [np.nan] * 6, [np.nan] * 6)
        assert against(rising, SIMPLE).outside == pytest.approx([1.0 - 24.0 / 50.0, 0.0], rel=1e-9)
        assert use.near_events == 0.0

    def test_just_on_it_fits(self) -> None:
        use = against(made([24.0, 14.0], [0.0, 10.0], [0.0, 1.0], [1.0, 0.0]), SIMPLE)
        assert use.fits and use.worst[0] == pytest.approx(0.0, abs=1e-12)
        assert np.isnan(use.near_events)
        assert use.outside == pytest.approx([0.0, 0.0])

    def test_points_near_events(self) -> None:
        """Of five outside, one is just after touchdown, one just before lift-off, one in the air."""
        nan, far = np.nan, 0.05
        given = made([30.0] * 5 + [1.0], [0.0] * 6, [0.0, 0.021, far, far, nan, 0.0], [far, far, 0.019, far, nan, far])
        use = against(given, SIMPLE)
        assert use.near_events == pytest.approx(2.0 / 5.0)

    def test_heating_is_of_the_whole_stride(self) -> None:
        use = against(made([4.0, 4.0, 4.0], [0.0] * 3, [np.nan] * 3, [np.nan] * 3), SIMPLE)
        assert use.heating == pytest.approx([2.0, 0.0])

    def test_peak_counts_stance_only(self) -> None:
        given = made([-3.0, 9.0], [0.0, 0.0], [0.0, np.nan], [0.0, np.nan])
        assert given.peak == pytest.approx([3.0, 0.0])
        assert given.rms == pytest.approx([np.sqrt(45.0), 0.0])

    @pytest.mark.slow
    def test_of_a_gait_events_are_those_of_its_stances(self, gait: Gait, sweep: dict[float, Points]) -> None:
        given = sweep[56.0]
        for i, phase in enumerate(("posterior_stance", "anterior_stance")):
            bears, length = given.bears[:, i], gait.durations[phase]
            assert given.since[bears, i] + given.until[bears, i] == pytest.approx(length, abs=1e-6)
            assert np.isnan(given.since[~bears, i]).all()


class TestCost:
    @pytest.mark.slow
    def test_by_hand(self, gait: Gait, sweep: dict[float, Points]) -> None:
        """Without losses in the gears: V i with i = u / (N kt) at the terminals; nothing given back is stored."""
        drive = Drive(motor("ec_90_flat_260w"), Gearbox(15.0), 48.0)
        knees, hips = sweep[56.0], points(gait, "hip")
        constant, resistance = 15.0 * 0.231, 0.844
        current = knees.torque / constant
        power = np.maximum((resistance * current + constant * knees.speed) * current, 0.0).sum(axis=1)
        power += np.maximum(hips.torque * hips.speed, 0.0).sum(axis=1)
        work = 2.0 * float(np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(knees.t)))
        weight = 9.81 * (35.0 + 4.0 * (1.72 + 0.47))
        assert electrical_cost(gait, drive) == pytest.approx(
            work / (weight * 2.5 * gait.period), rel=1e-4
        )  # samples' trapezoids


class TestStudies:
    """Their logic, with a search that answers at once."""

    @pytest.fixture
    def searches(self, gait: Gait, monkeypatch: pytest.MonkeyPatch) -> list[tuple]:
        asked: list[tuple] = []

        def search(robot, request, *, seed=0, start=None):
            asked.append((robot, request, seed, start))
            if request.speed > 9.0:
                raise Infeasible("mean speed", 1.0, "m/s")
            if seed == 1:
                raise NoGait("nothing nearby", 1.0)
            return gait, f"solution {len(asked)}"

        monkeypatch.setattr(families, "search", search)
        monkeypatch.setattr(drive_choice, "search", search)
        return asked

    def test_a_family_starts_each_from_the_last_that_was_found(self, gait: Gait, searches: list[tuple]) -> None:
        seen: list[float] = []
        robot = gait.system.robot
        members = family(robot, Request(), "speed", (2.0, 10.0, 3.0), "given", lambda member: seen.append(member.value))
        assert [start for *_, start in searches] == ["given", "solution 1", "solution 1"]
        assert [request.speed for _, request, *_ in searches] == seen == [2.0, 10.0, 3.0]
        assert [member.gait is None for member in members] == [False, True, False]
        assert "mean speed" in members[1].reason and members[1].solution is None

    def test_a_family_over_a_number_of_the_robot(self, gait: Gait, searches: list[tuple]) -> None:
        family(gait.system.robot, Request(), "hip_distance", (0.6, 0.8))
        assert [dict(robot.varied) for robot, *_ in searches] == [{"hip_distance": 0.6}, {"hip_distance": 0.8}]
        with pytest.raises(UnknownName, match="hip_width"):
            family(gait.system.robot, Request(), "hip_width", (0.6,))

    @pytest.mark.slow
    def test_designs_get_the_motor_s_rotor_and_ratio(self, gait: Gait, searches: list[tuple]) -> None:
        drives = {"large": Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)}
        found = list(codesign(gait.system.robot, Request(), drives, (8.0, 20.0), "given"))
        assert [start for *_, start in searches] == ["given", "given", "solution 1"]
        for given, ratio, (robot, request, *_) in zip(found, (8.0, 20.0), searches[:2], strict=True):
            row = robot.index("posterior_knee")
            assert robot.model.armature[row] == pytest.approx(2 * ratio**2 * 5.06e-4, rel=1e-9)
            assert robot.mass == pytest.approx(gait.system.robot.mass + 4 * (1.0 - 0.47))
            assert request.knee_drive.gearbox == Gearbox(ratio, 0.83)
            assert (request.objective, request.stiffness, request.knee_touchdown) == ("electrical", None, None)
            assert (given.motor, given.ratio, given.stiffness) == ("large", ratio, 56.0)
            assert given.margin == against(points(gait), request.knee_drive).worst.min()
            assert given.cost == electrical_cost(gait, request.knee_drive)

    def test_a_design_that_nothing_is_found_for_says_why(self, gait: Gait, searches: list[tuple]) -> None:
        drives = {"large": Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)}
        (given,) = codesign(gait.system.robot, Request(speed=10.0), drives, (8.0,))
        assert given.gait is None and np.isnan(given.cost) and "mean speed" in given.reason

    @pytest.mark.slow
    def test_smallest_violation_tries_each_seed(self, gait: Gait, searches: list[tuple]) -> None:
        drive = Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)
        seen: list[float] = []
        best, excess = smallest_violation(gait.system.robot, Request(), drive, 3, lambda n, found: seen.append(found))
        assert best is gait and excess == -against(points(gait), drive).worst.min()
        assert [seed for *_, seed, _ in searches] == [0, 1, 2]
        assert np.isnan(seen[1]) and seen[0] == seen[2] == excess
        assert searches[0][1].objective == "violation"

    def test_smallest_violation_needs_a_start_and_a_gait(self, gait: Gait, searches: list[tuple]) -> None:
        drive = Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)
        with pytest.raises(BadValue, match="starts"):
            smallest_violation(gait.system.robot, Request(), drive, 0)
        with pytest.raises(Infeasible, match="mean speed"):
            smallest_violation(gait.system.robot, Request(speed=10.0), drive, 2)


@pytest.fixture(scope="module")
def start() -> Solution:
    """The solution of a cold search."""
    return least_effort()


@pytest.mark.slow
@pytest.mark.extra("casadi")
class TestOptimised:
    def test_one_member_of_a_family(self, gait: Gait, start) -> None:
        (member,) = family(gait.system.robot, Request(), "friction", (0.58,), start)
        assert member.gait is not None and member.solution is not None
        assert member.gait.residual < 1e-8
        assert member.solution.objective >= start.objective * (1.0 - 1e-4)  # less friction cannot help

    def test_one_design(self, gait: Gait, start) -> None:
        base = Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)
        (given,) = codesign(gait.system.robot, Request(), {"ec_90_flat_260w": base}, (10.0,), start)
        drive = replace(base, gearbox=Gearbox(10.0, 0.83))
        assert given.gait is not None and given.gait.residual < 1e-8
        assert given.margin > 0.0
        assert given.stiffness == pytest.approx(given.gait.system.spring.stiffness / 2)
        assert given.cost == pytest.approx(electrical_cost(given.gait, drive))
        assert given.cost < electrical_cost(Gait.load("least_effort"), drive)
