"""The plots of energy and hardware: what they show is what they are given."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import same_color
from matplotlib.patches import Rectangle

from spear_pin import Gait, HoppingLaw, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.model.actuator import Actuator
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import gearbox, motor
from spear_pin.model.motor import Gearbox
from spear_pin.studies.energetics import EnergyFlow, JointFlow
from spear_pin.studies.published_costs import PUBLISHED, UNVERIFIED, CostPoint, running_animals
from spear_pin.viz.plots import energy as plots
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.paper import STANCE
from spear_pin.viz.plots.sankey import WIDEST

HOPS = 4
FLOW = EnergyFlow(
    (JointFlow("hip", 1.0, 0.5, 0.2, 0.1, 0.2), JointFlow("knee", 20.0, 0.5, 9.0, 2.0, 8.5)),
    damping=7.0, friction=0.0, impact=1.0, released=0.1, slip=0.0, spring_stored=12.0, spring_returned=11.9,
    change=0.6, magnetic=0.0, gap=0.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def gait():
    system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(stance_torque=8.0))
    return Gait(system, system.guess(), {}, 0.0, np.zeros(3, complex), {})


@pytest.fixture(scope="module")
def clean(gait):
    return simulate(gait.system, gait.state, HOPS, 1e-7, progress=False)


@pytest.fixture(scope="module")
def hops(gait):
    hip = Actuator(motor("faulhaber_3863h024cr"), Gearbox(60.0, 0.75), Battery(24.0))
    knee = Actuator(motor("spear_ii_knee"), gearbox("spear_ii_knee_gear"), Battery(24.0), current_limit=4.5)
    return simulate(with_hardware(gait.system, Hardware((hip, knee))), gait.state, HOPS, 1e-7, progress=False)


def line(axes, label):
    drawn = next(line for line in axes.lines if line.get_label() == label)
    x, y = np.asarray(drawn.get_xdata(), float), np.asarray(drawn.get_ydata(), float)
    return x[np.isfinite(y)], y[np.isfinite(y)]


def widths(figure):
    """Width of each named band, in J."""
    given = sum(joint.given for joint in FLOW.joints)
    named = {patch.get_gid(): patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)}
    return {name: patch.get_width() * given / WIDEST for name, patch in named.items() if name}


class TestEnergyFlow:
    def test_the_example_closes(self):
        assert FLOW.residual == pytest.approx(0.0, abs=1e-12)

    def test_bands_are_as_wide_as_their_energy(self):
        found = widths(plots.energy_flow(FLOW))
        assert found == {
            "back to\nbatteries": pytest.approx(1.0),
            "Joule heat": pytest.approx(9.2),
            "gears": pytest.approx(2.1),
            "stored": pytest.approx(0.6),  # by the mechanism, the last of this name
            "returned": pytest.approx(11.9),
            "joint damping": pytest.approx(7.0),
            "impact": pytest.approx(1.0),
            "springs let go": pytest.approx(0.1),
        }

    def test_every_band_has_its_joules_and_percent(self):
        texts = [text.get_text() for text in plots.energy_flow(FLOW).axes[0].texts]
        for said in (
            "batteries\ngive\n21.00 J\n100.0 %",
            "Joule heat\n9.20 J\n43.8 %\nhip 0.20\nknee 9.00",
            "gears\n2.10 J\n10.0 %\nhip 0.10\nknee 2.00",
            "motors' work\n8.70 J\n41.4 %",
            "stored\n12.00 J\n57.1 %",
            "stored\n0.60 J\n2.9 %",
            "springs let go\n0.10 J\n0.5 %",
            "next to nothing: joint friction, slip",
        ):
            assert said in texts

    def test_what_was_stored_may_be_used(self):
        used = replace(FLOW, change=-0.4, damping=8.0)
        found = widths(plots.energy_flow(used))
        assert found["from what\nwas stored"] == pytest.approx(0.4)

    def test_texts_do_not_lie_on_each_other(self):
        figure = plots.energy_flow(replace(FLOW, friction=0.02, slip=0.03, magnetic=0.01, spring_stored=0.5))
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in figure.axes[0].texts]
        for i, box in enumerate(boxes):
            assert not box.count_overlaps(boxes[i + 1 :])
            assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
            assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1

    def test_motors_have_to_work(self):
        braking = replace(FLOW, joints=(replace(FLOW.joints[0], motor=-9.0), FLOW.joints[1]))
        with pytest.raises(BadValue, match="flow"):
            plots.energy_flow(braking)


class TestCostOfTransport:
    OURS = (CostPoint("ours", 40.0, 0.5, "electrical", "", "computed"),)

    @pytest.mark.slow
    def test_every_point_is_there_by_kind_and_verification(self):
        (axes,) = plots.cost_of_transport(PUBLISHED, self.OURS).axes
        drawn = [line for line in axes.lines if line.get_gid()]
        for shown, point in zip(drawn, (*PUBLISHED, *self.OURS), strict=True):
            assert (shown.get_xdata()[0], shown.get_ydata()[0]) == (point.mass, point.cost)
            assert shown.get_marker() == plots.MARKERS[point.kind]
            hollow = same_color(shown.get_markerfacecolor(), "none")
            assert hollow == (point.verification in UNVERIFIED)
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")

    def test_what_is_computed_says_so(self):
        (axes,) = plots.cost_of_transport(PUBLISHED, self.OURS).axes
        names = sorted(text.get_text() for text in axes.texts)
        assert names == sorted([*(point.name for point in PUBLISHED), "ours (computed)"])

    def test_names_do_not_lie_on_each_other(self):
        figure = plots.cost_of_transport(PUBLISHED, self.OURS)
        figure.draw_without_rendering()
        boxes = [text.get_window_extent() for text in figure.axes[0].texts]
        assert not any(box.count_overlaps(boxes[i + 1 :]) for i, box in enumerate(boxes))

    @pytest.mark.slow
    def test_the_line_is_that_of_animals(self):
        (axes,) = plots.cost_of_transport(PUBLISHED).axes
        mass, cost = line(axes, "running animals (recollection)")
        assert cost == pytest.approx([running_animals(m) for m in mass])

    def test_needs_points(self):
        with pytest.raises(BadValue, match="points"):
            plots.cost_of_transport([])


class TestCurrents:
    def test_are_those_of_the_first_hops(self, hops):
        knee, hip = plots.currents(hops, 2).axes
        shown = hops.cycle <= 2
        for axes, i in ((knee, 1), (hip, 0)):
            assert np.array_equal(line(axes, "actual")[1], hops.current[shown, i])
            assert np.array_equal(line(axes, "reference")[1], hops.reference[shown, i])
            assert axes.get_xlim() == pytest.approx((hops.t[0], hops.t[shown][-1]))
            ends = [patch.get_x() + patch.get_width() for patch in axes.patches if patch.get_gid() == STANCE]
            assert ends == pytest.approx([event.time for event in hops.named("lift_off")])
        assert np.abs(line(knee, "actual")[1]).max() == 4.5 < np.abs(line(knee, "reference")[1]).max()
        assert (knee.get_ylabel(), hip.get_ylabel()) == ("Knee current (A)", "Hip current (A)")

    def test_need_hardware(self, clean):
        with pytest.raises(BadValue, match="current"):
            plots.currents(clean)


def test_heights_mark_the_apexes_and_their_spread(hops, clean):
    (axes,) = plots.heights(hops, clean).axes
    apexes = [event.q[0] for event in hops.named("apex")]
    assert line(axes, "apex")[1] == pytest.approx(apexes)
    assert np.array_equal(line(axes, "hip")[1], hops.q[:, 0])
    assert np.array_equal(line(axes, "without hardware")[1], clean.q[:, 0])
    spread = 1e3 * (max(apexes) - min(apexes))
    assert [text.get_text() for text in axes.texts] == [f"{HOPS} apexes within {spread:.1f} mm"]
    assert "without hardware" not in [drawn.get_label() for drawn in plots.heights(hops).axes[0].lines]


def test_angles_lie_against_the_clean_ones(hops, clean, gait):
    hip, knee = plots.angles_against(hops, clean, gait, hops=2).axes
    for axes, i in ((hip, 1), (knee, 2)):
        assert np.array_equal(line(axes, "simulated")[1], hops.q[:, i])
        assert np.array_equal(line(axes, "without hardware")[1], clean.q[:, i])
        assert axes.get_xlim() == pytest.approx((hops.t[0], hops.t[hops.cycle <= 2][-1]))
        assert "without hardware" in [text.get_text() for text in axes.get_legend().get_texts()]
    assert set(line(knee, "commanded")[1]) == {gait.system.law.knee_touchdown}


@pytest.mark.slow
def test_they_can_be_saved(hops, tmp_path):
    for figure in (plots.energy_flow(FLOW), plots.cost_of_transport(PUBLISHED), plots.currents(hops)):
        assert save_figure(figure, tmp_path / "figure.svg").stat().st_size > 1000
