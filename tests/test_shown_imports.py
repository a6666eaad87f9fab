"""Imports that README, docs and examples show go on working, and so do those that they showed before modules moved."""

import re
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [
    ROOT / "README.md",
    *(ROOT / "docs").glob("*.md"),
    *(ROOT / "docs").glob("notebooks/*.md"),
    *(ROOT / "examples").glob("*.py"),
]
IMPORT = re.compile(r"^ *from (spear_pin[\w.]*) import (\([^)]*\)|[^\n]+)", re.M)
ONCE = {
    "studies.basin": "midway pushed recover",
    "studies.bound": "at_speed summarize",
    "studies.design": "against points spring_sweep",
    "studies.drivetrain": "knee_drives",
    "studies.hardware": "Rig on_rig",
    "studies.hop": "summarize",
    "studies.identification": "Calibration MovingAverage cut identify read_record smoothed",
    "studies.laboratory": "Instrument synthesize write_csv",
    "studies.push_test": "DEPTHS WITHOUT_MOTOR WITH_MOTOR spear_ii",
    "studies.sweep": "grid reasons sweep",
    "viz": "plots",
    "viz.bound_plots": "bound_summary",
    "viz.design_plots": "torque_speed",
    "viz.drivetrain_plots": "drivetrain",
    "viz.player": "record",
    "viz.plots": (
        "draw_clearance draw_energy draw_force draw_torque hop_summary joint_angles knee_torque save_figure style"
    ),
    "viz.push_plots": "fit_summary",
    "viz.sweep_plots": "sweep_map",
    "viz.video": "film still",
}
MOVED = {
    "viz.bound_plots": "viz.plots.bound",
    "viz.design_plots": "viz.plots.design",
    "viz.drivetrain_plots": "viz.plots.drivetrain",
    "viz.push_plots": "viz.plots.identification",
    "viz.sweep_plots": "viz.plots.sweep",
}


def shown(page: Path) -> list[tuple[str, str]]:
    """Modules and names that a page imports of this package."""
    found = IMPORT.findall(page.read_text(encoding="utf-8"))
    return [(module, name) for module, names in found for name in re.findall(r"(\w+)(?: as \w+)?[,\s)]*", names)]


def has(module: str, name: str) -> bool:
    """Whether `from module import name` works."""
    if hasattr(import_module(module), name):
        return True
    import_module(f"{module}.{name}")
    return True


@pytest.mark.parametrize("module", ONCE)
def test_what_was_shown_once(module):
    assert all(has(f"spear_pin.{module}", name) for name in ONCE[module].split())


@pytest.mark.parametrize("module", MOVED)
def test_the_former_place_has_the_same_function_and_says_where_it_is(module):
    former, now = import_module(f"spear_pin.{module}"), import_module(f"spear_pin.{MOVED[module]}")
    assert former.__all__ == ONCE[module].split()
    assert all(getattr(former, name) is getattr(now, name) for name in former.__all__)
    assert f"`{now.__name__}`" in former.__doc__


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_is_shown_now(page):
    assert all(has(*each) for each in shown(page))
    assert not {f"spear_pin.{module}" for module in MOVED} & {module for module, _ in shown(page)}
