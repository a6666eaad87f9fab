"""Hops with springs that pull less while they are let go, against closed forms, dry friction and gaits found again."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Clutch, Gait, HoppingLaw, Spring, bounding, find_gait, hopping, load, simulate
from spear_pin.errors import BadFile, BadValue
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.round_hopping import round_hopping
from spear_pin.gaits.series_hopping import SERIES, series_hopping
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Mount
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import number
from spear_pin.model.path import Joints
from spear_pin.model.springs import describe_spring
from tests.gaits import found_again
from tests.gaits.bounding_gaits import gait as bound
from tests.hybrid.lanes import assert_agree, compiles
from tests.slow import slow_but

LEG, CRANK = load("spear_ii", locked=["boom_x"]), load("crank_hopper")
LAW = HoppingLaw(stance_torque=7.8261879, hold_extension=True)
PUSH = HoppingLaw(-0.35, stance_torque=0.735, frequency=5.0, knee_gain=6.0, knee_damping=0.15, hold_extension=True)
START = np.array([0.56349008, 0.50685044, 0.96311709]), np.array([-0.80510327, 2.76839068, 5.46453907])
FLIGHTS = {"latched": 0.2, "fixed": 0.15}


def measured(hysteresis):
    """The spring along the crank leg, which acts in the whole hop; a logged hop fits 2.5 N."""
    return replace(CRANK.settings.springs["leg"], hysteresis=hysteresis)


def system(case, hysteresis=None):
    """A spring that touchdown engages, or one along a cable that is never let go."""
    if case == "latched":
        return hopping(LEG, LAW, Spring(hysteresis=0.2 if hysteresis is None else hysteresis))
    return hopping(CRANK, PUSH, {"leg": measured(2.5 if hysteresis is None else hysteresis)})


def found(own, case, guess=None, **options):
    guess = START if case == "latched" and guess is None else guess
    return find_gait(own, ["stance_torque"], {"flight_time": FLIGHTS[case]}, guess=guess, rtol=1e-12, **options)


@pytest.fixture(scope="module")
def gaits():
    return {case: found(system(case), case) for case in FLIGHTS}


@pytest.fixture(scope="module")
def hops(gaits):
    return {case: simulate(gait.system, gait.state, cycles=1, rtol=1e-12) for case, gait in gaits.items()}


class TestBranches:
    def test_energy_is_kept_and_the_loss_is_the_travel_times_half_the_width(self, hops):
        hop, c = hops["latched"], 0.2
        (turns,), (leaves,) = hop.named("turns:knee"), hop.named("lift_off")
        begins, most, ends = hop.q[0, 2], turns.q[2], leaves.q[2]
        assert 48.84 * (ends - begins) > c  # it is let go before its pull vanishes
        rates = hop.v[:, 2][hop.phase == "stance"]
        drag = 1.3 * np.trapezoid(rates**2, hop.t[hop.phase == "stance"])
        lost = -hop.ledger["damping"][0] - c * (most - begins + most - ends)
        assert lost == pytest.approx(drag, rel=1e-3)
        assert abs(hop.ledger.residual[0]) < 1e-10

    def test_loss_of_a_spring_that_never_pushes(self, hops):
        """Each time it is stretched by δ: 2 c δ, less c²/2k at the end, where it would push."""
        hop, c, k, rest = hops["fixed"], 2.5, 1386.0, 0.1459
        lengths = [np.interp(event.time, hop.t, hop.springs.length[:, 0]) for event in hop.named("turns:leg")]
        stretched = [length - rest for length in lengths if length > rest]
        assert len(stretched) == 2 and len(lengths) == 3
        lost = sum(2 * c * each - c**2 / (2 * k) for each in stretched)
        assert hop.ledger["damping"][0] == pytest.approx(-lost, abs=1e-9)
        assert abs(hop.ledger.residual[0]) < 1e-10

    def test_pulls(self, hops):
        hop, c, k, rest = hops["fixed"], 2.5, 1386.0, 0.1459
        stretch, pull = hop.springs.length[:, 0] - rest, hop.springs.pull[:, 0]
        slide = hop.coordinates.index("slide")
        rate = np.sign(np.polyfit(hop.q[:, slide], stretch, 1)[0]) * hop.v[:, slide]
        clear = (np.abs(rate) > 1e-9) & (np.abs(stretch) > 1e-9)
        mean = k * stretch
        wanted = np.where(stretch > 0.0, np.maximum(mean + c * np.sign(rate), 0.0), 0.0)
        assert clear.mean() > 0.8 and (wanted[clear] > mean[clear] + c / 2).any() and (pull >= 0.0).all()
        np.testing.assert_allclose(pull[clear], wanted[clear], atol=1e-9)

    def test_motion_is_that_with_dry_friction_in_a_joint(self):
        """Which the other machinery holds, releases and turns."""
        slide = Spring(0.0, damping=0.0, unilateral=False, rest=0.0, path=Joints({"boom_z": 1.0}), hysteresis=2.0)
        own = hopping(LEG, LAW, {"knee": Spring(), "slide": slide})
        rubs = with_dry_friction(hopping(LEG, LAW, Spring()), {"boom_z": 2.0})
        one, other = (simulate(each, START, cycles=2, rtol=1e-11) for each in (own, rubs))
        np.testing.assert_allclose(one.q[-1], other.q[-1], atol=1e-8)
        np.testing.assert_allclose(one.v[-1], other.v[-1], atol=1e-7)
        np.testing.assert_allclose(one.ledger["damping:slide"], other.ledger["friction"], atol=1e-8)

    @pytest.mark.slow
    @pytest.mark.parametrize("case", FLIGHTS)
    def test_a_narrow_loop_changes_little(self, case):
        plain, narrow = (found(system(case, c), case) for c in (0.0, 1e-10))
        for one, other in zip(plain.state, narrow.state, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-9)

    def test_a_spring_that_holds_the_leg_ends_the_run(self):
        own = system("fixed", 40.0)
        hop = simulate(own, own.guess(), cycles=1)
        assert hop.reason == "zeno" and hop.events[-1].name == "turns:leg"

    @pytest.mark.slow
    def test_a_switch_that_is_late(self):
        late = Spring(hysteresis=0.1, clutch=Clutch(0.004, 0.004, damper="joint"))
        gait = found(hopping(LEG, replace(LAW, stance_torque=7.93), late), "latched")
        hop = simulate(gait.system, gait.state, cycles=2, rtol=1e-12)
        assert np.abs(hop.ledger.residual).max() < 1e-10 and len(hop.named("turns:knee")) >= 2


class TestDerivatives:
    @pytest.mark.slow
    @pytest.mark.parametrize("case", FLIGHTS)
    def test_are_those_of_hops_found_again(self, gaits, case):
        exact, expected = found_again.hops(gaits[case], "hysteresis", 2e-2)
        assert np.abs(exact).max() > 1e-2
        np.testing.assert_allclose(exact, expected, atol=1e-7)


@compiles
class TestLanes:
    @pytest.mark.parametrize("case", slow_but(FLIGHTS, "latched"))
    def test_hops(self, gaits, case):
        gait, shares = gaits[case], np.array([0.9, 1.0, 1.1])
        q, v = (np.repeat(part[None], len(shares), axis=0) for part in gait.state)
        own = {"hysteresis": shares * number(gait.system, "hysteresis")}
        assert_agree(gait.system, q, v, simulate_many(gait.system, q, v, parameters=own), parameters=own)

    @pytest.mark.slow
    def test_where_it_is_zero_but_in_some(self):
        plain, own = hopping(LEG, LAW), {"hysteresis": np.array([0.0, 0.1])}
        q, v = (np.repeat(part[None], 2, axis=0) for part in START)
        assert_agree(plain, q, v, simulate_many(plain, q, v, parameters=own), parameters=own)

    @pytest.mark.slow
    def test_bounds(self):
        gait = bound("long_stride")
        own = bounding(gait.system.robot, gait.system.law, Spring(30.0, damping=0.2, hysteresis=0.5))
        q, v = (part[None] for part in gait.state)
        assert_agree(own, q, v, simulate_many(own, q, v, unroll=False), tolerance=1e-7)
        stride = simulate(own, gait.state, 1)
        assert stride.named("turns:posterior_knee") and abs(stride.ledger.residual[0]) < 1e-8


class TestWords:
    def test_of_a_spring_of_a_file(self, tmp_path):
        for value, file in (("2.5", "good"), ('"wide"', "bad")):
            text = f'robot = "spear_ii"\n[springs.knee]\nstiffness = 50.0\nhysteresis = {value}\n'
            (tmp_path / f"{file}.toml").write_text(text)
        spring = load(tmp_path / "good.toml").settings.springs["knee"]
        assert spring == Spring(50.0, damping=0.0, hysteresis=2.5)
        assert describe_spring("knee", spring) == "50 N·m/rad in the knee; hysteresis of 2.5 N·m"
        with pytest.raises(BadFile, match=r"springs.knee.hysteresis is 'wide'; expected a number, in N·m"):
            load(tmp_path / "bad.toml")

    def test_of_a_gait_in_a_file(self, gaits, tmp_path):
        again = Gait.load(gaits["fixed"].save(tmp_path / "gait.json"))
        assert again.system.springs == gaits["fixed"].system.springs

    @pytest.mark.parametrize(
        "build",
        [
            lambda: series_hopping(load("spear_ii_series", locked=["boom_x"]), spring=replace(SERIES, hysteresis=0.1)),
            lambda: round_hopping(load("hoppy"), spring=Spring(rest=0.0, unilateral=False, hysteresis=0.1)),
            lambda: FootfallRequest(spring=Spring(hysteresis=0.1)),
        ],
        ids=["in series", "round a post", "in space"],
    )
    def test_of_what_has_none(self, build):
        with pytest.raises(BadValue, match=r"^Spring.hysteresis is 0.1; expected 0: only `hopping` and `bounding`"):
            build()

    def test_of_a_clutch_that_takes_none(self):
        with pytest.raises(BadValue, match=r"^Clutch.slip is 9.0; expected 0 unless the spring has a stiffness alone"):
            Spring(hysteresis=0.1, clutch=Clutch(slip=9.0))

    def test_of_a_mount_of_ones_own(self):
        own = hopping(LEG, LAW, Spring(hysteresis=0.1))
        bare = tuple(replace(each, mounts=tuple(map(wayless, each.mounts))) for each in own.domains)
        with pytest.raises(BadValue, match="^way of the spring 'knee' of domain 'stance' is None; expected the name"):
            replace(own, domains=bare)


def wayless(mount: Mount) -> Mount:
    return replace(mount, way=None)
