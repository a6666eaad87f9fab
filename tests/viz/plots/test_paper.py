"""The style of figures: fonts that the user chose stay, and legends leave titles free."""

import pytest
from matplotlib import rc_context, rcParams
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from spear_pin.viz.plots.paper import legend_above, style


@pytest.mark.parametrize(
    ("chosen", "family"),
    [
        ({}, ["STIXGeneral"]),
        ({"font.family": "DejaVu Sans"}, ["DejaVu Sans"]),
        ({"font.family": ["monospace"]}, ["monospace"]),
        ({"font.sans-serif": ["DejaVu Sans Mono"]}, ["sans-serif"]),
    ],
    ids=str,
)
def test_fonts_of_the_user_stay(chosen, family):
    """All else is the sheet's; a block within a block has the same."""
    with rc_context(chosen):
        before = dict(rcParams)
        with style(), style():
            assert rcParams["font.family"] == family and rcParams["axes.linewidth"] == 0.6
            assert all(rcParams[name] == before[name] for name in chosen)
            axes = Figure().subplots()
            axes.set_xlabel("Time (s)")
            assert axes.xaxis.label.get_fontfamily() == family
        assert dict(rcParams) == before


@pytest.mark.parametrize("where", ["left", "center", "right"])
@pytest.mark.parametrize("first", ["legend", "title"])
def test_a_legend_leaves_the_title_free(where, first):
    """Whichever is set first, and both stay on the paper."""
    with style():
        figure = Figure(figsize=(3.4, 2.3), layout="constrained")
        axes = figure.subplots()
        for name in ("hip", "knee"):
            axes.plot([0.0, 1.0], [0.0, 1.0], label=name)
        title, legend = (
            lambda: axes.set_title("A title of one's own\nin two lines", loc=where),
            lambda: legend_above(axes),
        )
        for put in (title, legend) if first == "title" else (legend, title):
            put()
        FigureCanvasAgg(figure).draw()
        box, said = axes.get_legend().get_window_extent(), title().get_window_extent()
        assert box.y0 >= said.y1 - 0.5 and box.y1 <= figure.bbox.y1 and box.x0 >= 0.0
        assert not box.overlaps(said)
