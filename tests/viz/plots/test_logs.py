"""Pictures of logs: each log has its own column, in which its own phases are left out."""

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.studies.logs import Found, Hop, Log, LogPhase, Replay
from spear_pin.viz.plots.logs import fit_over_log, replay_over_log

T = np.linspace(0.0, 0.2, 21)
POSITIONS = np.column_stack([np.sin(T), 0.1 * T])


def fit(*sources, found=1):
    """What a picture takes of a fit to logs, with a flight of the second left out."""
    arcs = [
        SimpleNamespace(phase=LogPhase("stance", 0.0, 0.2, True, "", each), t=T, seen=POSITIONS) for each in sources
    ]
    robot = SimpleNamespace(units=("rad", "m"), index=("crank", "slide").index)
    return SimpleNamespace(
        arcs=arcs,
        residuals=[0.01 * POSITIONS] * len(arcs),
        leg=SimpleNamespace(robot=robot),
        joints=("crank", "slide"),
        found={f"number_{i}": Found(1.0, 0.1, "1") for i in range(found)},
        left_out=(LogPhase("flight", 0.2, 0.4, True, "too short", sources[-1]),),
    )


def hatched(panel):
    return [patch.get_hatch() for patch in panel.patches if patch.get_hatch()]


def test_each_log_has_its_own_column():
    figure = fit_over_log(fit("a/hop.csv", "b/hop.csv", "c/last.csv"))
    panels = np.array(figure.axes).reshape(4, 3)
    assert [panel.get_title("left") for panel in panels[0]] == ["a/hop.csv", "b/hop.csv", "last.csv"]
    assert [[bool(hatched(panel)) for panel in row] for row in panels] == [[False, False, True]] * 4
    assert panels[0, 0].get_ylim() == panels[0, 2].get_ylim()
    assert [panel.get_ylabel() for panel in panels[:, 0]] == [
        "Crank (deg)",
        "Residual (deg)",
        "Slide (mm)",
        "Residual (mm)",
    ]
    np.testing.assert_allclose(panels[2, 1].lines[0].get_ydata(), 1e3 * POSITIONS[:, 1])
    np.testing.assert_allclose(panels[1, 1].lines[0].get_ydata(), np.degrees(0.01 * POSITIONS[:, 0]))


@pytest.mark.parametrize(("found", "lines"), [(1, 1), (9, 3)])
def test_values_stand_below_in_lines_that_break_between_them(found, lines):
    words = fit_over_log(fit("hop.csv", found=found)).get_supxlabel().split("\n")
    assert len(words) == lines and all(line.startswith("number_") for line in words)
    assert words[0].startswith("number_0\N{NO-BREAK SPACE}1\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}0.1")


def test_a_replay():
    measures = {name: (0.9, 1.0) for name in ("compression", "stance", "push_off")}
    hop = Hop(LogPhase("stance", 0.0, 0.2, True, "", "hop.csv"), T, POSITIONS, 1.1 * POSITIONS, 0.1, measures)
    figure = replay_over_log(Replay(Log("hop.csv", T, {}), ("crank", "slide"), ("rad", "m"), (hop,), ()))
    assert "compression\N{NO-BREAK SPACE}-10.0\N{NO-BREAK SPACE}%" in figure.get_supxlabel()
    assert figure.axes[0].get_title("left") == "hop.csv" and not hatched(figure.axes[0])
