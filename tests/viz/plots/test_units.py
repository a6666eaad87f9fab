"""Labels of axes: a quantity has its unit in brackets, one without a unit has none."""

import ast
import re
from pathlib import Path

import pytest

from spear_pin.viz import plots
from spear_pin.viz.plots.paper import with_unit
from spear_pin.viz.plots.sweep import label

SOURCES = sorted(Path(plots.__file__).parent.glob("*.py"))
UNIT = r"(°|m|mm|cm|s|ms|rad|mrad|rad/s|m/s|N|N·m|N·m/rad|J|J a hop|A|V|kg|kg·m²|g·m²|%)"
WITHOUT_UNIT = {  # ratios, numbers of something, names of what is compared
    *(
        "Cost of transport",
        "Electrical cost of transport",
        "Correlation",
        "Elasticity, % for one more %",
        "Elasticity of {}, % for one more %",
        "Iteration",
        "Bounds missed",
        "Share that survives",
        "Samples",
        "Largest multiplier",
    ),
    *("Gear ratio", "Rms over continuous torque", "SPEAR-II over SPEAR-I"),
    "Feet on the ground",
    *("Strides to 1 % of the error", "Cycles to the gait", ""),
}
AXES = {"set_xlabel", "set_ylabel", "over", "_over_time"}


def labels(path):
    """Texts that a module gives to axes and bars of colour; of what is filled in, a letter."""
    for call in (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)):
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        given = call.args if name in AXES else [each.value for each in call.keywords if each.arg == "label"]
        if name in AXES or name == "colorbar":
            yield from filter(None, map(text, given))


def text(node):
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return None


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_labels_of_axes(path):
    wrong = [
        each
        for each in labels(path)
        if each not in WITHOUT_UNIT and not re.search(rf"\(({UNIT}|{{}})\)($|   \|)", each)
    ]
    assert wrong == []


def test_some_labels_are_found():
    assert sum(len(list(labels(path))) for path in SOURCES) > 40


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.stem)
def test_no_unit_is_one(path):
    assert not re.search(r"\(1\)", path.read_text())


def test_names():
    assert with_unit("knee_ratio", "1") == "Knee ratio"
    assert with_unit("flight_time", "s") == "Flight time (s)"
    assert (label("friction"), label("stiffness")) == ("Friction", "Stiffness (N·m/rad)")
