"""The plots of the push test: what they show is what was released, fitted and printed."""

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from spear_pin.errors import BadValue
from spear_pin.studies.audit.printed_estimates import TABLE_4_1, TABLE_4_2, average
from spear_pin.studies.identification import Estimate, MovingAverage, identify, smooth_trial
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import WITH_MOTOR, WITHOUT_MOTOR, Release, gear_study, release, spear_ii
from spear_pin.viz.plots import identification as identification_plots
from spear_pin.viz.plots import push as push_plots
from spear_pin.viz.plots import save_figure, style
from spear_pin.viz.plots import source as source_plots
from tests.slow import slow_but

LABEL = re.compile(r"\((s|rad|mrad|m|cm|N|kg·m²|N·m/rad|N·m·s/rad)\)$")
NAMES_NOT_NUMBERS = {("gears", 1, "y")}
FIGURES = ("release", "gears", "tables", "fit 1", "fit 2", "fit 3", "fit 4", "fit 6")


@cache
def released() -> dict[str, Release]:
    """One with motor and one without."""
    return {
        "with motor": release(spear_ii(), WITH_MOTOR, rate=200.0),
        "no motor": release(spear_ii(None), WITHOUT_MOTOR, rate=200.0),
    }


geared = cache(gear_study)


@cache
def estimate() -> Estimate:
    """A fit to two synthetic releases."""
    rng = np.random.default_rng(1)
    trials = [synthetic_trial(spear_ii(), WITH_MOTOR, 0.1, 0.005, rng, rate=100.0) for _ in range(2)]
    return identify(spear_ii(), [smooth_trial(trial, MovingAverage(5)) for trial in trials])


def own_stiffness() -> Estimate:
    """As if each release had a stiffness of its own."""
    stiffness, *others = estimate().parameters
    each = [replace(stiffness, trial=j, value=stiffness.value + j) for j in range(2)]
    return replace(estimate(), parameters=(*each, *others))


def measured(given: Estimate, count: int = 100) -> Estimate:
    """As if so many of the releases had been measured."""
    trials = [replace(trial, synthetic=j >= count) for j, trial in enumerate(given.trials)]
    return replace(given, trials=tuple(trials))


def line(axes: Axes, gid: str) -> np.ndarray:
    drawn = next(line for line in axes.lines if gid in (line.get_gid(), line.get_label()))
    return np.array([drawn.get_xdata(), drawn.get_ydata()], float)


def texts(drawn: Figure) -> str:
    """All that can be read."""
    own = [text.get_text() for axes in drawn.axes for text in (*axes.texts, axes.title, axes._left_title)]
    legends = [text.get_text() for legend in drawn.legends for text in legend.get_texts()]
    return "\n".join([*own, *legends])


def collisions(drawn: Figure) -> list[str]:
    """Texts that overlap another or leave the page."""
    with style():
        canvas = FigureCanvasAgg(drawn)
        canvas.draw()
        found = [*(text for legend in drawn.legends for text in legend.get_texts())]
        for axes in drawn.axes:
            ticks = [
                label
                for axis, on in ((axes.xaxis, "labelbottom"), (axes.yaxis, "labelleft"))
                for label in axis.get_ticklabels()
                if axis.get_tick_params().get(on, True) and _shown(axes, label)
            ]
            legend = axes.get_legend()
            found += [*ticks, *axes.texts, axes._left_title, axes.xaxis.label, axes.yaxis.label]
            found += legend.get_texts() if legend else []
        boxes = [
            (text.get_text(), text.get_window_extent(canvas.get_renderer()))
            for text in found
            if text.get_text() and text.get_visible()
        ]
    page = drawn.bbox
    clashes = [f"{a} | {b}" for i, (a, one) in enumerate(boxes) for b, two in boxes[:i] if one.overlaps(two)]
    outside = [a for a, box in boxes if box.x0 < 0 or box.y0 < 0 or box.x1 > page.x1 or box.y1 > page.y1]
    return clashes + outside


def _shown(axes: Axes, label: object) -> bool:
    """Whether a tick lies within the axes' limits."""
    x, y = label.get_position()
    (left, right), (low, high) = sorted(axes.get_xlim()), sorted(axes.get_ylim())
    return left <= x <= right if label in axes.get_xticklabels() else low <= y <= high


@cache
def figure(name: str) -> Figure:
    """One of each, and fits of some number."""
    kind, _, count = name.partition(" ")
    if kind == "fit":
        long = "a record with a long name, of the second afternoon, with the belt on"
        given = {"5 cm": estimate(), "own": own_stiffness(), long: measured(estimate())}
        given |= {"warned": replace(estimate(), warnings=("one", "two")), "part": measured(estimate(), 1)}
        return identification_plots.fit_summary(dict(list({**given, "6": estimate()}.items())[: int(count)]))
    return {
        "release": lambda: push_plots.release_summary(released()),
        "gears": lambda: push_plots.gear_comparison(geared()),
        "tables": source_plots.source_comparison,
    }[name]()


class TestRelease:
    def test_shows_angle_height_and_force(self):
        knee, hip, force = push_plots.release_summary(released()).axes
        for name, given in released().items():
            assert np.array_equal(line(knee, name), [given.t, given.angle])
            assert np.array_equal(line(hip, name), [given.t, given.height])
            assert np.array_equal(line(force, name), [given.t, given.force[:, 1]])
            assert set(line(knee, f"rest {name}")[1]) == {given.rest}

    def test_marks_where_the_pin_pulls(self):
        _, _, force = push_plots.release_summary(released()).axes
        shaded = {drawn.get_gid(): drawn.get_paths() for drawn in force.collections}
        assert not shaded["pull with motor"] and len(shaded["pull no motor"]) == 1
        outline = shaded["pull no motor"][0].vertices
        given = released()["no motor"]
        assert outline[:, 1].min() == given.force[:, 1].min() < 0.0
        assert outline[:, 1].max() == pytest.approx(0.0, abs=1e-9)
        assert outline[:, 0].min() == pytest.approx(given.lift_off)
        assert line(force, "lift-off no motor")[0] == given.lift_off
        legend = [text.get_text() for text in force.get_legend().get_texts()]
        assert legend == ["a free toe would lift off", "the pin pulls"]

    def test_speaks_of_no_pull_where_there_is_none(self):
        _, _, force = push_plots.release_summary({"with motor": released()["with motor"]}).axes
        assert force.get_legend() is None

    def test_says_what_ended_a_motion(self):
        figure = push_plots.release_summary({"deep": replace(released()["no motor"], reason="limit")})
        assert "deep, ended by limit" in texts(figure)

    def test_needs_releases(self):
        for releases in ({}, {f"{n}": released()["no motor"] for n in range(8)}):
            with pytest.raises(BadValue, match="releases"):
                push_plots.release_summary(releases)


class TestGears:
    NAMES = ("no motor", "15:1", "30:1", "66:1")

    def test_shows_each_ratio_with_its_first_turn(self):
        knee, _ = push_plots.gear_comparison(geared()).axes
        for name, row in zip(self.NAMES, geared(), strict=True):
            assert np.array_equal(line(knee, name), [row.release.t, row.release.angle])
            assert line(knee, f"turn {name}").ravel().tolist() == [row.release.turns[0], row.release.extrema[0]]

    def test_the_bars_are_the_effective_inertia_and_its_shares(self):
        _, inertia = push_plots.gear_comparison(geared()).axes
        leg, rotor = ([bar.get_width() for bar in group] for group in inertia.containers)
        assert rotor == pytest.approx([row.rotor for row in geared()])
        for row, body, reflected in zip(geared(), leg, rotor, strict=True):
            whole = float(spear_ii(row.ratio).effective_inertia(row.release.rest))
            assert body + reflected == pytest.approx(whole)
            assert reflected / whole == pytest.approx(row.swing.rotor_share)
        assert [label.get_text() for label in inertia.get_yticklabels()] == list(self.NAMES)
        assert [text.get_text().strip() for text in inertia.texts] == ["", "10 %", "31 %", "69 %"]

    def test_needs_rows(self):
        with pytest.raises(BadValue, match="rows"):
            push_plots.gear_comparison([])


class TestFits:
    def test_shows_data_model_and_residuals_since_the_release(self):
        given = estimate()
        upper, lower = identification_plots.fit_summary({"10 cm": given}).axes
        let_go = [p.value for p in given.parameters if p.name == "release_time"]
        assert len(set(let_go)) == len(given.trials) == 2
        for j, (trial, model) in enumerate(zip(given.trials, given.predicted, strict=True)):
            since = trial.t - let_go[j]
            assert np.array_equal(line(upper, f"data {j + 1}"), [since, trial.angle])
            assert np.array_equal(line(upper, f"model {j + 1}"), [since, model])
            assert line(lower, f"residual {j + 1}")[1] == pytest.approx(1e3 * (model - trial.angle))

    def test_a_known_release_time_is_that_of_the_record(self):
        trial = replace(estimate().trials[0], t=estimate().trials[0].t + 7.0, let_go=7.0)
        given = replace(estimate(), trials=(trial,), predicted=estimate().predicted[:1], parameters=())
        upper, _ = identification_plots.fit_summary({"10 cm": given}).axes
        assert line(upper, "data 1")[0] == pytest.approx(trial.t - 7.0)

    def test_says_what_was_estimated(self):
        given = estimate()
        upper, _ = identification_plots.fit_summary({"10 cm": given}).axes
        first, *lines = upper._left_title.get_text().split("\n")
        assert first == f"10 cm: fit {given.fit:.1f} %"
        assert [text.rpartition(" ")[2] for text in lines] == ["N·m/rad", "N·m·s/rad", "rad"]
        for text, name in zip(lines, ("stiffness", "damping", "rest_angle"), strict=True):
            value, deviation = (float(part) for part in re.findall(r"\d+\.\d+", text))
            assert value == pytest.approx(given[name].value, abs=0.05 * given[name].deviation)
            assert deviation == pytest.approx(given[name].deviation, rel=0.05)

    def test_says_so_where_each_release_has_its_own(self):
        given = own_stiffness()
        upper, _ = identification_plots.fit_summary({"10 cm": given}).axes
        values = sorted(p.value for p in given.parameters if p.name == "stiffness")
        title = upper._left_title.get_text()
        shown = [float(part) for part in re.findall(r"\d+\.\d+", title.split("\n")[1])]
        assert shown == pytest.approx(values, abs=5e-3)
        assert "each release its own" in title and title.count("each release") == 1

    def test_counts_warnings(self):
        assert "warnings" not in texts(identification_plots.fit_summary({"a": replace(estimate(), warnings=())}))
        assert "warnings: 2" in texts(identification_plots.fit_summary({"a": replace(estimate(), warnings=("b", "c"))}))

    def test_synthetic_data_are_marked(self):
        whole, part, none = estimate(), measured(estimate(), 1), measured(estimate())
        figure = identification_plots.fit_summary({"whole": whole, "part": part, "none": none})
        assert [axes.texts[0].get_text() for axes in figure.axes[::2]] == ["synthetic", "synthetic in part", ""]
        assert "data (synthetic or synthetic in part or measured)" in texts(figure)
        assert "synthetic" not in texts(identification_plots.fit_summary({"none": none}))

    def test_the_mark_is_above_the_data(self):
        upper = figure("fit 1").axes[0]
        canvas = FigureCanvasAgg(upper.figure)
        canvas.draw()
        bottom = upper.texts[0].get_window_extent(canvas.get_renderer()).y0
        highest = max(trial.angle.max() for trial in estimate().trials)
        assert upper.transData.transform((0.0, highest))[1] < bottom

    @pytest.mark.parametrize("count", (1, 3, 4, 6))
    def test_all_have_one_scale(self, count: int):
        panels = figure(f"fit {count}").axes
        assert len(panels) == 2 * count
        for kind in (panels[::2], panels[1::2]):
            assert all(one.get_ylim() == other.get_ylim() for one, other in pairwise(kind))
            assert all(one.get_xlim() == other.get_xlim() for one, other in pairwise(kind))

    def test_needs_estimates(self):
        with pytest.raises(BadValue, match="estimates"):
            identification_plots.fit_summary({})

    @pytest.mark.slow
    def test_long_records_make_small_files(self, tmp_path: Path):
        rng = np.random.default_rng(0)
        exact = synthetic_trial(spear_ii(), WITH_MOTOR, 0.1, 0.0, rng)
        assert exact.t.size == 2001
        noisy = [replace(exact, angle=exact.angle + 0.005 * rng.normal(size=exact.t.size)) for _ in range(5)]
        given = replace(estimate(), trials=tuple(noisy), predicted=(exact.angle,) * 5, parameters=())
        figure = identification_plots.fit_summary({f"{n}": given for n in range(3)})
        assert save_figure(figure, tmp_path / "fits.svg").stat().st_size < 400_000


@pytest.mark.parametrize(("index", "name"), [(0, "stiffness"), (1, "damping")])
def test_tables_are_as_printed(index: int, name: str):
    panel = source_plots.source_comparison().axes[index]
    for motor, label in ((True, "with motor"), (False, "without motor")):
        rows = [*(row for row in TABLE_4_1 if row.motor == motor), average(motor)]
        printed = next(row for row in TABLE_4_2 if row.motor == motor)
        assert line(panel, f"table 4.1 {label}")[1].tolist() == [getattr(row, name) for row in rows]
        assert line(panel, f"table 4.2 {label}")[1].tolist() == [getattr(printed, name)]
        bars = next(drawn for drawn in panel.containers if drawn.get_label() == f"{label}, ± σ")
        lengths = [np.ptp(segment[:, 1]) for segment in bars.lines[2][0].get_segments()]
        assert lengths == pytest.approx([2.0 * getattr(row, f"sigma_{name}") for row in (*rows, printed)])


def test_tables_say_which_row_is_no_mean():
    stiffness, damping = source_plots.source_comparison().axes
    assert [text.get_text() for text in stiffness.texts] == ["51.35", "48.84\nnot the mean", "47.99", "47.99"]
    assert [text.get_text() for text in damping.texts] == ["1.31", "1.30\nnot the mean", "1.04", "1.04"]


@pytest.mark.parametrize("name", FIGURES)
def test_every_axis_has_a_unit(name: str):
    for i, axes in enumerate(figure(name).axes):
        for which in "xy":
            alike = getattr(axes, f"get_shared_{which}_axes")().get_siblings(axes)
            labels = [getattr(each, f"get_{which}label")() for each in alike]
            assert any(map(LABEL.search, labels)) or (name, i, which) in NAMES_NOT_NUMBERS, labels


@pytest.mark.parametrize("name", slow_but(FIGURES, "release", "tables", "fit 3"))
def test_no_text_lies_on_another_or_off_the_page(name: str):
    assert not collisions(figure(name))


@pytest.mark.parametrize(
    "file", slow_but([*(f"{name}.svg" for name in FIGURES), "fit 3.png", "fit 1.pdf"], "release.svg", "fit 3.png")
)
def test_figures_can_be_saved(file: str, tmp_path: Path):
    name, suffix = file.split(".")
    assert 0 < save_figure(figure(name), tmp_path / f"figure.{suffix}").stat().st_size < 400_000
