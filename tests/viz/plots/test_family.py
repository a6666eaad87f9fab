"""The picture of a branch tells stable from unstable parts, and marks what happens."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from spear_pin.gaits.continuation import BorderPoint, Branch, End, SpecialPoint
from spear_pin.gaits.continuation.branch import KINDS
from spear_pin.viz.notebook import card
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.family import MARKS, draw, family

BEFORE, AFTER = (("stance", "lift_off"),), (("stance", "slip"), ("stance", "lift_off"))
PARAMETER = np.array([6.0, 7.0, 8.0, 8.0, 9.0, 8.5])


def branch():
    """Two borders, a flip and a fold on the way; unstable behind the flip."""
    n = len(PARAMETER)
    multipliers = np.array([[0.5], [0.6], [0.7], [0.8], [-1.0], [1.5]]) + 0j
    end = BorderPoint("discontinuous", 5, None, 8.5, AFTER, BEFORE, "", 0.3)
    family = SimpleNamespace(system=SimpleNamespace(robot=SimpleNamespace(name="spear_ii")))
    return Branch(
        family=family, over="stance_torque", vary=("stiffness",), target={"flight_time": 0.2}, start=1,
        values=PARAMETER, q=np.zeros((n, 3)), v=np.zeros((n, 3)), solved={"stiffness": np.linspace(40, 50, n)},
        multipliers=multipliers, durations={"stance": np.full(n, 0.3), "flight": np.full(n, 0.2)},
        residual=np.zeros(n), orders=(BEFORE,) * 3 + (AFTER,) * 3, tangents=np.zeros((n, 8)),
        specials=(
            SpecialPoint("flip", 4, 9.0, np.array([-1.0 + 0j])),
            SpecialPoint("fold", 5, 8.5, np.array([1.0 + 0j])),
        ),
        borders=(BorderPoint("continuous", 2, 3, 8.0, BEFORE, AFTER, "", 0.0), end),
        ends=(End(6.0, "range"), End(8.5, "border", end)),
    )  # fmt: skip


def lines(axes, gid):
    return [line for line in axes.lines if line.get_gid() == gid]


def test_stable_parts_are_solid_and_unstable_ones_dashed():
    axes = Figure().subplots()
    draw(axes, branch(), branch().largest)
    solid, dashed = lines(axes, "stable"), lines(axes, "")
    assert [list(line.get_xdata()) for line in solid] == [[6.0, 7.0, 8.0]]
    assert [list(line.get_xdata()) for line in dashed] == [[8.0, 9.0, 8.5]]  # from behind the border
    assert {line.get_linestyle() for line in solid} == {"-"} and dashed[0].get_linestyle() == "--"


def test_what_happens_is_marked_where_it_does():
    axes = Figure().subplots()
    draw(axes, branch(), branch().largest)
    for kind, x, y in (("flip", 9.0, 1.0), ("fold", 8.5, 1.5), ("border", 8.0, 0.7), ("end", 8.5, 1.5)):
        (mark,) = lines(axes, kind)
        assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (x, y)


def test_all_kinds_have_a_mark():
    assert set(MARKS) == {*KINDS, "border", "end"}


def test_the_picture_has_units_and_a_legend(tmp_path):
    figure = family(branch())
    assert [axes.get_ylabel() for axes in figure.axes] == ["Largest multiplier", "Duration (s)", "Stiffness (N·m/rad)"]
    assert figure.axes[-1].get_xlabel() == "Stance torque (N·m)"
    told = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert told == ["stable", "unstable", "fold", "flip", "border", "end of the branch"]
    assert save_figure(figure, tmp_path / "family.svg").stat().st_size > 1000


def test_its_card_says_what_happens():
    text = card(branch())
    for word in ("Branch of gaits", "stance torque", "N·m", "flip: the period doubles (-1)", "the end of the range"):
        assert word in text
    assert "[stance: slip] comes in" in text and "4 of 6 points" in text


def test_it_is_told_in_a_table():
    assert str(branch()).splitlines() == [
        "stance_torque  what happens",
        "           6  end: the end of the range",
        "           8  border: [stance: slip] comes in",
        "           9  flip: the period doubles (-1)",
        "         8.5  fold (1)",
        "         8.5  end: border, where it ends: [stance: slip] no longer happens; beyond, the cycle does not "
        "close: its end differs from its start by 0.3",
    ]
    assert repr(branch()) == "Branch(stance_torque 6 to 8.5: 6 points, 4 stable, 2 borders, 2 special points)"


def test_where_it_is_lost_it_says_so():
    lost = BorderPoint("lost", 5, None, 8.5, BEFORE, AFTER, "", 1e-6)
    assert str(lost) == "no gait was found beyond, where [stance: slip] comes in"
    lost = BorderPoint("lost", 5, None, 8.5, BEFORE, BEFORE, "", 0.0)
    assert str(lost) == "no gait was found beyond, in whatever order of events"


@pytest.mark.parametrize(
    ("reason", "text"),
    [("fall", "the cycle ends: a part other than a toe reached the ground"), ("odd", "the cycle ends: odd")],
)
def test_where_the_cycle_ends_it_says_why(reason, text):
    assert str(BorderPoint("discontinuous", 5, None, 8.5, AFTER, (), reason, 0.0)) == text
