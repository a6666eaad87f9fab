"""Gait search by direct collocation: what is asked, what is found, and what is said when nothing is.

What needs CasADi is skipped without it.
"""

import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, load, simulate
from spear_pin.errors import BadValue, Infeasible, MissingExtra, UnknownName
from spear_pin.gaits import library
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.collocation import Programme, Solution, hermite_simpson, node_name, quadrature, resample
from spear_pin.gaits.footfalls.in_plane import in_plane, read
from spear_pin.gaits.footfalls.obstacles import remedy
from spear_pin.gaits.footfalls.programme import transcribe
from spear_pin.gaits.library import REQUESTS
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.scale import scale_of
from spear_pin.model.variants import vary
from spear_pin.studies.bound import summarize
from tests.gaits.solutions import least_effort

SEED = 3
SCALE = 0.01  # of the effort, as the optimiser counts it
COARSE = 6  # intervals of each phase
needs_casadi = pytest.mark.extra("casadi")


@pytest.fixture(scope="module")
def casadi():
    """CasADi, whose wrappers may warn when they are imported."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        import casadi

        return casadi


@pytest.fixture(scope="module")
def q_spear(casadi):
    return load("q_spear")


@pytest.fixture(scope="module")
def coarse(q_spear):
    """The request of least_effort on a coarse mesh, from cold: programme, solution, what was told on the way."""
    told = []
    transcription = transcribe(in_plane(q_spear, Request(), COARSE, SEED))
    return transcription, transcription.programme.solve(on_iteration=lambda *row: told.append(row)), told


def warm(robot, request, intervals, solution):
    """A programme of which the solution of another one is the guess."""
    return transcribe(in_plane(robot, request, intervals), resample(solution)).programme


def effort(gait):
    """∫ Σ u² dt a metre, by the trapezoidal rule over the samples of a simulation."""
    return summarize(gait, simulate(gait.system, gait.state, progress=False))["effort_per_distance"] * PAIR


@pytest.mark.slow
@needs_casadi
class TestSearch:
    def test_from_cold_it_finds_what_ships(self, q_spear):
        gait, solution = search(q_spear, REQUESTS["least_effort"], seed=SEED)
        assert solution.success
        assert max(solution.violations.values()) < 1e-6
        assert gait.residual < 1e-9
        shipped = Gait.load("least_effort")
        assert solution.objective == pytest.approx(SCALE * effort(shipped), rel=1e-3)
        kept = least_effort()
        assert solution.objective == pytest.approx(kept.objective, rel=1e-6)
        for name, numbers in kept.values.items():
            np.testing.assert_allclose(solution.values[name], numbers, rtol=0, atol=1e-3 * max(1.0, abs(numbers).max()))
        for found, known in zip(gait.state, shipped.state, strict=True):
            np.testing.assert_allclose(found, known, rtol=0, atol=1e-5)
        np.testing.assert_allclose(np.abs(gait.multipliers), np.abs(shipped.multipliers), rtol=0, atol=1e-3)

    @pytest.mark.parametrize(
        "wish",
        [
            {"stiffness": 80.0, "hardening": 100.0, "preload": 4.0},
            {"stiffness": 0.0, "table": ((0.0, 0.0), (0.2, 20.0), (0.4, 50.0), (0.8, 130.0))},
            {"stiffness": 80.0, "preload": 4.0, "knee_touchdown": 0.75},
        ],
        ids=str,
    )
    def test_springs_that_are_not_linear(self, q_spear, coarse, wish):
        """The simulated gait takes the effort that the optimiser reckoned with."""
        request = Request(**wish)
        gait, solution = search(q_spear, request, start=coarse[1])
        assert gait.residual < 1e-9
        assert gait.system.spring == request.spring(request.stiffness)
        assert solution.objective == pytest.approx(SCALE * effort(gait), rel=1e-3)

    def test_what_is_out_of_reach_is_named(self, q_spear):
        drive = Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)
        fitted = vary(q_spear, knee_ratio=15.0, knee_rotor=drive.motor.rotor_inertia)
        with pytest.raises(Infeasible, match="mean speed.*m/s") as caught:
            search(fitted, Request(speed=10.0, knee_drive=drive))
        assert caught.value.violation > 0.5 and caught.value.unit == "m/s"
        reached = max(10.0 - caught.value.violation, 5.0)  # what is missed by more than half is halved
        assert caught.value.remedy == f"speed={reached:.3g}"
        assert str(caught.value).endswith(f"; try {caught.value.remedy}")


@pytest.mark.slow
@needs_casadi
class TestTranscription:
    def test_solution(self, coarse):
        transcription, solution, told = coarse
        request = transcription.room.request
        assert solution.success and solution.status == "Solve_Succeeded"
        assert max(solution.violations.values()) < 1e-6
        assert solution.objective == pytest.approx(SCALE * effort(Gait.load("least_effort")), rel=0.06)
        law, (q, v), stiffness = read(transcription, solution)
        assert law.knee_touchdown == request.knee_touchdown and stiffness == request.stiffness
        assert min(law.posterior_knee_torque, law.anterior_knee_torque) >= request.minimum_knee_torque - 1e-6
        assert q.shape == v.shape == (7,) and law.nominal == (*q[1:], *v)
        period = sum(transcription.number(part, solution) for part in transcription.durations)
        assert period >= request.minimum_stride

    def test_progress(self, coarse):
        _, solution, told = coarse
        assert [row[0] for row in told] == list(range(len(told))) and len(told) > solution.iterations
        assert told[-1][1] == pytest.approx(solution.objective)
        assert told[0][2] > 1.0 > 1e-5 > told[-1][2]

    def test_the_mesh_converges(self, q_spear, coarse):
        objectives, solution = [coarse[1].objective], coarse[1]
        for intervals in (10, 16):
            solution = warm(q_spear, Request(), intervals, solution).solve()
            assert solution.success
            objectives.append(solution.objective)
        first, second = np.abs(np.diff(objectives))
        assert second < first
        assert second < 1e-3 * objectives[-1]

    def test_nothing_is_in_the_way_of_what_is_feasible(self, coarse):
        transcription, solution, _ = coarse
        relaxed, margins = transcription.programme.relaxed(resample(solution))
        loosened = relaxed.solve(iterations=300)
        assert loosened.success
        assert {margin.unit for margin in margins.values()} >= {"m", "m/s", "N", "s"}
        assert max(loosened.values[margin.unknown][0] for margin in margins.values()) < 1e-5

    def test_hips_spared(self, q_spear, coarse):
        programme = warm(q_spear, Request(objective="hip"), COARSE, coarse[1])
        before = programme.read(programme.objective, coarse[1])[0]
        found = programme.solve()
        assert found.success and max(found.violations.values()) < 1e-6
        assert found.objective < 0.99 * before

    def test_hip_torque_of_a_pair(self, q_spear, coarse):
        hips = [f"{leg} hip" for leg in ("posterior", "anterior")]
        most = 0.8 * max(abs(coarse[1].values[name][0]) for name in hips)
        found = warm(q_spear, Request(hip_torque=most), COARSE, coarse[1]).solve()
        assert found.success and max(found.violations.values()) < 1e-6
        assert max(abs(found.values[name][0]) for name in hips) == pytest.approx(most, rel=1e-6)

    def test_largest_torque(self, q_spear, coarse):
        transcription = transcribe(in_plane(q_spear, Request(objective="peak"), COARSE), resample(coarse[1]))
        found = transcription.programme.solve()
        assert found.success and max(found.violations.values()) < 1e-6
        hips = [f"{leg} hip" for leg in ("posterior", "anterior")]
        torques = [transcription.programme.read(u, found) for phase in transcription.torques for u in phase]
        most = np.abs(torques).max()
        assert most <= found.values["peak torque"][0] + 1e-4
        assert most < 0.95 * max(abs(coarse[1].values[name][0]) for name in hips)


@needs_casadi
class TestCollocation:
    def test_is_of_fourth_order(self, casadi):
        """On x' = -x², x(0) = 1: x(1) = 1/2, and the integral of x is ln 2."""
        errors = []
        for intervals in (2, 4, 8):
            programme = Programme()
            x = [
                programme.variable(node_name("fall", k / (2 * intervals), "x"), 0.8, 0.0, 2.0)
                for k in range(2 * intervals + 1)
            ]
            programme.require("begin", x[0] - 1.0, 0.0, 0.0)
            hermite_simpson(programme, "motion", 1.0, x, [-node * node for node in x])
            programme.objective = casadi.SX(0)
            solution = programme.solve(tolerance=1e-13)
            assert solution.success
            integral = programme.read(quadrature(1.0, x), solution)[0]
            errors.append((abs(programme.read(x[-1], solution)[0] - 0.5), abs(integral - np.log(2.0))))
        rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
        assert rates[-1] == pytest.approx([4.0, 4.0], abs=0.4)

    def test_violations_have_the_name_and_unit_of_the_constraint(self, casadi):
        programme = Programme()
        x = programme.variable("x", 1.0, 0.0, 5.0, scale=10.0)
        programme.require("far", x, 7.0, scale=100.0, wish="m")
        programme.require("law", x, -1.0)
        programme.objective = x
        solution = programme.solve(iterations=100)
        assert not solution.success
        relaxed, margins = programme.relaxed(resample(solution))
        loosened = relaxed.solve()
        assert loosened.success and list(margins) == ["far"] and margins["far"].unit == "m"
        assert loosened.values[margins["far"].unknown][0] * margins["far"].scale == pytest.approx(2.0, abs=1e-4)


class TestResampled:
    VALUES = {
        "speed": np.array([2.5]),
        **{node_name("flight", s, "q"): np.array([s, s * s]) for s in (0.0, 0.5, 1.0)},
    }

    @pytest.fixture
    def guess(self):
        return resample(Solution(self.VALUES, 0.0, {}, True, "", 0))

    def test_between_nodes(self, guess):
        np.testing.assert_allclose(guess(node_name("flight", 0.25, "q")), [0.25, 0.125])
        np.testing.assert_allclose(guess(node_name("flight", 0.75, "q")), [0.75, 0.625])

    def test_what_it_has(self, guess):
        assert guess("speed") == 2.5
        np.testing.assert_allclose(guess(node_name("flight", 0.5, "q")), [0.5, 0.25])

    @pytest.mark.parametrize("name", ["stiffness", node_name("stance", 0.5, "q"), node_name("flight", 0.5, "F")])
    def test_what_it_has_not(self, guess, name):
        assert guess(name) is None


class TestRequest:
    def test_each_gait_that_ships_has_one(self):
        assert set(REQUESTS) == set(library.names())
        for name, request in REQUESTS.items():
            gait = Gait.load(name)
            law = gait.system.law
            assert law.lift_off == request.lift_off and law.knee_touchdown == pytest.approx(request.knee_touchdown)
            assert gait.system.spring.stiffness == request.stiffness and law.virtual_stiffness == 400.0
            assert gait.period >= request.minimum_stride - 1e-4
            assert law.posterior_knee_torque >= request.minimum_knee_torque - 1e-4

    @pytest.mark.parametrize(
        ("wish", "part"),
        [
            ({"speed": 0.0}, "m/s"),
            ({"speed": 31.0}, "m/s"),
            ({"speed": float("nan")}, "speed"),
            ({"speed": "fast"}, "speed"),
            ({"friction": 0.0}, "friction"),
            ({"clearance": -0.01}, "clearance"),
            ({"clearance": 0.9}, "clearance"),
            ({"minimum_stride": 1.01}, "minimum_stride is 1.01; expected a number >= 0, at most 1, in s"),
            ({"minimum_stance": 0.4}, "minimum_stance"),
            ({"minimum_stance": 0.0}, "minimum_stance"),
            ({"speed": 12.0, "minimum_stride": 0.5}, "at most 8 m/s"),
            ({"speed": 5.5, "minimum_stance": 0.39}, "stride of at least 0.82 s"),
            ({"minimum_force": -1.0}, "in N"),
            ({"minimum_knee_torque": -1.0}, "N·m"),
            ({"hip_torque": -1.0}, "hip_torque"),
            ({"stiffness": -1.0}, "N·m/rad, or None"),
            ({"virtual_stiffness": -1.0}, "N·m/rad"),
            ({"hardening": -1.0}, "Spring.hardening"),
            ({"preload": -1.0}, "Spring.preload"),
            ({"table": ((0.0, 0.0), (1.0, 50.0))}, "0 with a table"),
            ({"knee_touchdown": 0.0}, "knee_touchdown"),
            ({"knee_touchdown": 2.5}, "knee_touchdown"),
            ({"leg_touchdown": (0.5, -0.2)}, "the lower one first"),
            ({"leg_touchdown": (-0.2, 1.3)}, "leg_touchdown"),
            ({"leg_touchdown": 0.2}, "leg_touchdown"),
            ({"objective": "electrical"}, "knee_drive"),
            ({"objective": "violation"}, "knee_drive"),
        ],
        ids=str,
    )
    def test_what_cannot_be(self, wish, part):
        with pytest.raises(BadValue) as caught:
            replace(Request(), **wish).check(scale_of(load("q_spear")))
        assert part in str(caught.value)

    @pytest.mark.parametrize("wish", [{"objective": "speed"}, {"lift_off": "hop"}], ids=str)
    def test_unknown_names(self, wish):
        with pytest.raises(UnknownName):
            Request(**wish)


@pytest.mark.parametrize(
    ("wish", "missed", "said"),
    [
        ("mean speed", 0.5, "speed=2"),
        ("friction at posterior touchdown", 0.04, "friction=0.75 or a smaller knee_touchdown than 0.698"),
        ("friction in anterior stance", 0.04, "friction=0.75 or a smaller knee_touchdown than 0.698"),
        ("normal force in anterior stance", 5.0, "minimum_force=15"),
        ("clearance in posterior stance", 0.01, "clearance=0.02"),
        ("duration of the stride", 0.1, "minimum_stride=0.2"),
        ("torque of the anterior_hip motor", 5.0, "hip_torque=90 or speed=2.25"),
        ("speed of the posterior_knee motor", 5.0, "a gearbox of a smaller ratio, or speed=2.25"),
        ("envelope of the posterior_knee motor", 5.0, "stiffness=None, which leaves it free"),
        ("what nobody foresaw", 1.0, ""),
    ],
)
def test_what_is_missed_has_a_remedy(wish, missed, said):
    text = remedy(Request(hip_torque=80.0, minimum_stride=0.3), wish, missed)
    assert said in text and bool(said) == bool(text)


def test_without_casadi(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MissingExtra, match=r"pip install '\.\[optimize\]'"):
        search(load("q_spear"), Request())
