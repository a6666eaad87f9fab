"""Gaits with springs on paths, against numbers of a second program, and derivatives against gaits found again."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import scipy

from spear_pin import Gait, HoppingLaw, Spring, compare, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.hopping import flight_law
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.dual import ARRAYS
from spear_pin.hybrid.parameters import change_system, number, rebuilt, unit, with_numbers
from spear_pin.model.cable import Anchor, Between
from spear_pin.model.equations import mechanism_of
from spear_pin.model.path import Joints
from spear_pin.studies.comparison import Side, differences
from spear_pin.viz.compare.words import parameters
from tests.gaits import found_again
from tests.slow import slow_but

LEG = load("spear_ii", locked=["boom_x"])
CABLE = Between(Anchor("thigh", (0.03, 0.0, -0.1)), Anchor("shank", (0.012, 0.0, 0.054)))
STIFFNESS, DAMPING, RADIUS = 48.84, 1.3, 0.03
SPRINGS = {
    "two halves": {
        "knee": Spring(STIFFNESS / 2, damping=DAMPING),
        "other": Spring(STIFFNESS / 2, damping=0.0, path=Joints({"knee": 1.0})),
    },
    "biarticular": Spring(
        STIFFNESS / RADIUS**2, damping=DAMPING / RADIUS**2, path=Joints({"knee": RADIUS, "hip": -0.006})
    ),
    "cable": {
        "cable": Spring(17000.0, damping=0.0, rest=0.194837478, path=CABLE),
        "knee": Spring(0.0, damping=DAMPING),
    },
    "hip": {"knee": Spring(), "hip": Spring(20.0, damping=0.0, rest=0.5, unilateral=False)},
}
FOUND = {  # stance torque, hip, knee and its rate just after touchdown, multipliers: of another program
    "two halves": (7.826188, (0.506850443, 0.963117085, 5.464539073), (-0.406234, 0.178934 + 0.152258j)),
    "biarticular": (6.570320, (0.5067843, 0.9630631, 5.4598437), (-0.394396, 0.201210 + 0.157279j)),
    "cable": (7.802272, (0.5133938, 0.9649132, 5.7715145), (-0.400095, 0.331321)),
    "hip": (7.949030, (0.5176486, 0.9613152, 5.4368261), (-0.231946, 0.172619 + 0.137444j)),
}
OVER = {
    "biarticular": ("knee.knee", "knee.hip", "stiffness", "hip_to_knee"),
    "cable": ("stiffness", "knee.damping", "cable.start_x", "cable.end_z", "hip_to_knee", "knee_mass"),
    "hip": ("stiffness", "hip.stiffness"),
}


LAW, FLIGHT = (
    HoppingLaw(stance_torque=7.8, hold_extension=True),
    {"vary": ["stance_torque"], "target": {"flight_time": 0.2}},
)


def unaware(system):
    """The system whose motors do not balance springs in flight."""
    domains = tuple(replace(each, law=flight_law) if each.phase == "flight" else each for each in system.domains)
    return replace(system, domains=domains)


def hop(name, **options):
    system = hopping(LEG, LAW, SPRINGS[name])
    system = change_system(system, unaware) if name == "hip" else system
    return find_gait(system, **FLIGHT, **options)


class Found(dict):
    """Hops, each found when it is asked for."""

    def __missing__(self, name):
        self[name] = hop(name)
        return self[name]


@pytest.fixture(scope="module")
def hops():
    return Found()


@pytest.mark.parametrize("name", slow_but(SPRINGS, "biarticular"))
class TestHop:
    def test_is_that_of_another_program(self, hops, name):
        gait, (torque, state, multipliers) = hops[name], FOUND[name]
        q, v = gait.state
        assert gait.parameters["stance_torque"] == pytest.approx(torque, abs=2e-6)
        assert (q[1], q[2], v[2]) == pytest.approx(state, abs=2e-7)
        np.testing.assert_allclose(
            [m for m in gait.multipliers if m.imag >= 0][: len(multipliers)], multipliers, atol=1e-6
        )

    def test_closes_the_ledger_with_the_shares_of_its_springs(self, hops, name):
        hop = simulate(hops[name].system, hops[name].state, cycles=2)
        ledger, springs = hop.ledger, hops[name].system.springs
        assert np.abs(ledger.residual).max() < 1e-8
        for flow in ("damping", "released"):
            several = [f"{flow}:{each}" for each in springs] if len(springs) > 1 else [flow]
            assert [each for each in ledger.flows if each.startswith(flow)] == several
            np.testing.assert_allclose(ledger[flow], sum(ledger[each] for each in several), atol=1e-14)

    @pytest.mark.extra("heyoka")
    def test_of_lanes_is_that_of_the_reference(self, hops, name):
        gait = hops[name]
        q, v = (np.repeat(part[None], 3, axis=0) for part in gait.state)
        q[1:, 2] += (0.01, -0.01)
        q[:, 0] = [-LEG.toe_position(np.array([0.0, *each[1:]]), "toe")[1] for each in q]
        lanes = simulate_many(gait.system, q, v, cycles=2)
        for i in range(3):
            alone = simulate(gait.system, (q[i], v[i]), cycles=2)
            assert lanes.reason[i] == alone.reason == "complete"
            last = alone.named("touchdown")[-1]
            np.testing.assert_allclose(lanes.q[i], last.q, atol=1e-8)
            np.testing.assert_allclose(lanes.v[i], last.v, atol=1e-7)


def test_what_is_measured_along_a_path_is_in_its_unit(hops):
    gait = hops["biarticular"]
    run = simulate(gait.system, gait.state)
    landed, lifted = gait.state[0], run.named("lift_off")[-1].q
    stretch = RADIUS * (lifted[2] - landed[2]) - 0.006 * (lifted[1] - landed[1])
    table = gait.sensitivity(["stiffness"], ["stance_torque"], ["deflection_knee"])
    assert table.outputs["deflection_knee"] == pytest.approx(stretch, abs=1e-9)
    assert table.output_units["deflection_knee"] == "m"


@pytest.mark.slow
@pytest.mark.parametrize(("count", "torque", "multiplier"), [(10, 7.801464, 0.331938), (30, 7.802309, 0.331335)])
def test_of_a_cable_as_a_table_at_the_knee(hops, count, torque, multiplier):
    """Of the same program, with evenly spaced points from 0.9 to 2 rad; and with SciPy's curve in the stance law."""
    rest, angles = 0.9, np.linspace(0.0, 1.1, count)
    postures = [mechanism_of(LEG).posed([0.0, 0.0, rest + angle], ARRAYS) for angle in angles]
    free = SPRINGS["cable"]["cable"].rest
    pulls = [17000.0 * (CABLE.length(each) - free) * CABLE.slope(each)[2] for each in postures]
    pulls[0] = 0.0
    spring = Spring(0.0, damping=DAMPING, rest=rest, table=tuple(zip(angles, pulls, strict=True)))
    gait = find_gait(hopping(LEG, LAW, spring), **FLIGHT, guess=hops["cable"].state)
    assert gait.parameters["stance_torque"] == pytest.approx(torque, abs=1e-6)
    assert gait.multipliers[1] == pytest.approx(multiplier, abs=1e-6)
    curve, own = scipy.interpolate.PchipInterpolator(angles, pulls), hopping(LEG, gait.system.law, Spring(0.0))

    def stance(law, t, q, *more):
        hip, knee = law(t, q, *more)
        return hip, knee - float(curve(q[2] - rest))

    domains = (replace(each, law=partial(stance, each.law)) if each.phase == "stance" else each for each in own.domains)
    last = simulate(replace(own, domains=tuple(domains)), gait.state, cycles=1).named("touchdown")[-1]
    for found, again in zip((last.q, last.v), gait.state, strict=True):
        np.testing.assert_allclose(found, again, atol=1e-7)


@pytest.mark.slow
def test_a_comparison_names_springs_and_their_units(hops):
    cable, halves = hops["biarticular"], hops["two halves"]
    found = compare(cable, halves)
    rows = {(row.name, row.unit): row.values for row in found.measures}
    one, other = (simulate(gait.system, gait.state, cycles=4).springs for gait in (cable, halves))
    assert rows["peak pull, knee", "N"] == (pytest.approx(one.pull.max(), rel=1e-3), None)
    assert rows["greatest stretch, knee", "m"] == (pytest.approx(one.stretch.max(), rel=1e-3), None)
    assert rows["peak pull, other", "N·m"] == (None, pytest.approx(other.pull[:, 1].max(), rel=1e-3))
    stiffer = replace(cable, system=with_numbers(cable.system, {"stiffness": 6e4, "knee.hip": -0.004}))
    sides = [Side(label, "gait", LEG, gait=gait) for label, gait in (("a", cable), ("b", stiffer))]
    differ = {each.name: parameters(each) for each in differences(sides)}
    assert differ == {"spring: stiffness": ["54266.7 N/m", "60000 N/m"], "spring: hip": ["−0.006 m", "−0.004 m"]}


@pytest.mark.slow
def test_two_halves_of_a_spring_are_the_spring(hops):
    whole = find_gait(hopping(LEG, HoppingLaw(hold_extension=True)), ["stance_torque"], {"flight_time": 0.2})
    for one, other in zip(whole.state, hops["two halves"].state, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "over"), [(name, over) for name, names in OVER.items() for over in names])
def test_derivative_is_that_of_hops_found_again(name, over):
    exact, expected = found_again.hops(hop(name, rtol=1e-12), over, 1e-3)
    np.testing.assert_allclose(exact, expected, atol=2e-9 * np.abs(exact).max())


@pytest.mark.slow
def test_motors_balance_fixed_springs_of_every_joint_in_flight():
    system = hopping(LEG, HoppingLaw(hold_extension=True), SPRINGS["hip"])
    gait = find_gait(system, ["stance_torque"], {"flight_time": 0.2}, guess=hop("hip").state)
    flight = simulate(gait.system, gait.state, cycles=1)
    part = flight.phase == "flight"
    law = gait.system.law
    hip, sprung = flight.q[part, 1], flight.spring[part, flight.spring_joints.index("hip")]
    np.testing.assert_allclose(sprung, 20.0 * (0.5 - hip), atol=1e-12)
    wanted = law.hip_gain * (0.5 * law.knee_touchdown - hip) - law.hip_damping * flight.v[part, 1]
    np.testing.assert_allclose(flight.u[part, 0] + sprung, wanted, atol=1e-9)


@pytest.mark.slow
def test_a_bound_with_springs_at_its_hips():
    kept = Gait.load("long_stride")
    hips = Spring(10.0, damping=0.0, unilateral=False)
    gait = find_gait(rebuilt(kept.system, spring={"knee": kept.system.spring, "hip": hips}), guess=kept.state)
    assert gait.durations["posterior_stance"] > 0.0
    assert gait.multipliers[0] == pytest.approx(1.017944, abs=1e-6)
    run = simulate(gait.system, gait.state, cycles=1)
    released = [{name: lost for name, lost in event.work.items() if name != "impact"} for event in run.events]
    lost = [sum(each.values()) for each in released if each]
    assert lost == pytest.approx([-0.895570, -0.893089], abs=1e-6)
    assert run.ledger["released"][0] == pytest.approx(sum(lost), abs=1e-12)
    assert np.abs(run.ledger.residual).max() < 1e-8


@pytest.mark.slow
@pytest.mark.extra("heyoka")
def test_a_cable_that_is_latched_in_both_engines():
    """The joints that do not move it are none of what touchdown latches."""
    cable = Spring(17000.0, damping=0.0, path=CABLE)
    gait = find_gait(hopping(LEG, LAW, {"cable": cable, "knee": Spring(0.0, damping=DAMPING)}), **FLIGHT)
    lanes = simulate_many(gait.system, *(part[None] for part in gait.state), rtol=1e-12)
    last = simulate(gait.system, gait.state, cycles=1, rtol=1e-12).named("touchdown")[-1]
    np.testing.assert_allclose(lanes.q[0], last.q, atol=1e-10)
    assert gait.sensitivity(["cable.end_z"]).state.any()


@pytest.mark.slow
def test_a_fixed_spring_beside_a_switched_one_at_the_knee():
    fixed = Spring(8.84, damping=0.0, rest=0.5, path=Joints({"knee": 1.0}))
    gait = find_gait(hopping(LEG, LAW, {"knee": Spring(40.0), "fixed": fixed}), **FLIGHT)
    run = simulate(gait.system, gait.state, cycles=1)
    flight = run.phase == "flight"
    np.testing.assert_allclose(run.spring[flight, 0], -8.84 * (run.q[flight, 2] - 0.5), atol=1e-12)
    assert abs(run.ledger.residual[0]) < 1e-8


class TestNames:
    def test_of_a_single_spring_stay(self, tmp_path):
        system = hopping(LEG, LAW, {"hip": Spring(30.0, unilateral=False), "knee": Spring()})
        alone = hopping(LEG, LAW, {"hip": Spring(30.0)})
        for each in (system, alone):
            other = with_numbers(each, {"stiffness": 31.0})
            assert [*other.springs] == [*each.springs]
            assert other.spring == replace(each.spring, stiffness=31.0)
        assert rebuilt(system, spring=Spring(9.0)).springs == {"hip": Spring(9.0), "knee": Spring()}

    SYSTEM = hopping(LEG, LAW, SPRINGS["cable"])

    def test_of_numbers_say_the_spring_and_have_units(self):
        system = self.SYSTEM
        assert number(system, "stiffness") == 17000.0 and unit(system, "stiffness") == "N/m"
        assert number(system, "knee.damping") == DAMPING and unit(system, "knee.damping") == "N·m·s/rad"
        assert number(system, "cable.end_z") == 0.054 and unit(system, "cable.end_z") == "m"
        changed = with_numbers(system, {"knee.damping": 1.0, "cable.end_z": 0.05, "stiffness": 1e4})
        assert changed.springs["knee"].damping == 1.0 and changed.spring.stiffness == 1e4
        assert changed.spring.path.end.at[2] == 0.05 and system.spring.path.end.at[2] == 0.054

    def test_that_do_not_exist_are_refused_with_those_that_do(self):
        with pytest.raises(UnknownName, match=r"cable\.end_z"):
            number(self.SYSTEM, "cable.end_w")

    @pytest.mark.slow
    def test_are_kept_in_a_file(self, hops, tmp_path):
        for name in ("cable", "biarticular"):
            path = hops[name].save(tmp_path / f"{name}.json")
            again = Gait.load(path).system.springs
            assert [*again.items()] == [*hops[name].system.springs.items()]


@pytest.mark.parametrize(
    ("springs", "error", "words"),
    [
        ({"a.b": Spring()}, BadValue, "without a dot"),
        ({}, BadValue, "several by their names"),
        ({"ankle": Spring()}, UnknownName, "boom_z, hip, knee"),
        ({"cable": Spring(path=Between(Anchor("foot", (0, 0, 0)), CABLE.end))}, UnknownName, "thigh"),
    ],
)
def test_what_are_no_springs_of_a_leg(springs, error, words):
    with pytest.raises(error, match=words):
        hopping(LEG, spring=springs)


def test_a_motor_imitates_a_spring_beside_one_at_the_knee_only():
    with pytest.raises(BadValue, match="virtual_stiffness"):
        hopping(LEG, HoppingLaw(virtual_stiffness=3.0), SPRINGS["biarticular"])
