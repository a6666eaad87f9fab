"""Plots: what they show is the trajectory, with units, and files are written whole."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spear_pin import Contact, Gait, HoppingLaw, Trajectory, hopping, load, monopod, simulate
from spear_pin.errors import BadFile, BadValue
from spear_pin.viz import plots
from spear_pin.viz.plots.panels import NEGLIGIBLE
from spear_pin.viz.plots.paper import STANCE

HOPS = 3
OVER_TIME = (plots.joint_angles, plots.ground_force, plots.knee_torque, plots.boom_height)


@pytest.fixture(scope="module")
def gait() -> Gait:
    system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(stance_torque=8.0))
    return Gait(system, system.guess(), {}, 0.0, np.zeros(3, complex), {})


@pytest.fixture(scope="module")
def hops(gait: Gait) -> Trajectory:
    return simulate(gait.system, gait.state, HOPS, 1e-7, progress=False)


@pytest.fixture(scope="module")
def strides() -> Trajectory:
    """Of a robot with two legs, and names of its own."""
    gait = Gait.load("long_stride")
    return simulate(gait.system, gait.state, 2, 1e-7, progress=False)


def line(axes: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    drawn = next(line for line in axes.lines if line.get_label() == label)
    return np.asarray(drawn.get_xdata()), np.asarray(drawn.get_ydata())


def bars(axes: Axes) -> np.ndarray:
    """Heights, (bars of a flow, hops)."""
    return np.array([[bar.get_height() for bar in group] for group in axes.containers])


def shaded(axes: Axes) -> int:
    return sum(patch.get_gid() == STANCE for patch in axes.patches)


@pytest.mark.parametrize("plot", [*OVER_TIME, plots.energy_per_hop, plots.hop_summary])
def test_every_axis_has_a_label_with_a_unit(plot, hops: Trajectory):
    figure = plot(hops)
    assert isinstance(figure, Figure)
    for axes in figure.axes:
        assert re.search(r"\((s|m|mm|rad|N|N·m|J)\)$", axes.get_ylabel()), axes.get_ylabel()
    labels = {axes.get_xlabel() for axes in figure.axes}
    assert labels & {"Time (s)", "Hop"} and labels <= {"Time (s)", "Hop", ""}


@pytest.mark.parametrize("plot", OVER_TIME)
def test_every_stance_is_shaded(plot, hops: Trajectory):
    lift_offs = [event.time for event in hops.named("lift_off")]
    for axes in plot(hops).axes:
        assert shaded(axes) == HOPS == len(lift_offs)
        ends = [patch.get_x() + patch.get_width() for patch in axes.patches if patch.get_gid() == STANCE]
        assert ends == pytest.approx(lift_offs)


def test_angles_are_those_of_the_trajectory(hops: Trajectory, gait: Gait):
    for axes, joint in zip(plots.joint_angles(hops, gait).axes, ("hip", "knee"), strict=True):
        t, angle = line(axes, "simulated")
        assert np.array_equal(t, hops.t)
        assert np.array_equal(angle, hops.q[:, hops.coordinates.index(joint)])
    hip, knee = plots.joint_angles(hops, gait).axes
    assert set(line(hip, "commanded")[1][::3]) == {0.5}
    assert set(line(knee, "commanded")[1][::3]) == {1.0}
    latched = [hops.q[0, 2], *(event.q[2] for event in hops.named("touchdown")[:-1])]
    assert line(knee, "latched")[1][::3] == pytest.approx(latched, abs=1e-12)
    assert not any(drawn.get_label() == "commanded" for axes in plots.joint_angles(hops).axes for drawn in axes.lines)


def test_the_commanded_hip_follows_the_speed_at_lift_off():
    law = HoppingLaw(stance_torque=7.8, hip_touchdown=0.46, foot_placement=0.15, speed=0.03)
    system = hopping(load("spear_ii"), law)
    gait = Gait(system, system.guess(), {}, 0.0, np.zeros(4, complex), {})
    trajectory = simulate(system, gait.state, 2, 1e-7, progress=False)
    expected = [0.46 + 0.15 * (event.v[0] - 0.03) for event in trajectory.named("lift_off")]
    hip, _ = plots.joint_angles(trajectory, gait).axes
    assert line(hip, "commanded")[1][::3] == pytest.approx(expected, abs=1e-9)
    assert np.ptp(expected) > 1e-3


def test_forces_are_those_of_the_trajectory(hops: Trajectory):
    (axes,) = plots.ground_force(hops).axes
    assert np.array_equal(line(axes, "tangential")[1], hops.force[:, 0, 0])
    assert np.array_equal(line(axes, "normal")[1], hops.force[:, 0, 1])


def test_the_torques_add_up(hops: Trajectory):
    (axes,) = plots.knee_torque(hops).axes
    motor, spring, damping = (line(axes, label)[1] for label in ("motor", "spring", "damping"))
    assert np.array_equal(motor, hops.u[:, 1]) and np.array_equal(spring, hops.spring[:, 0])
    assert motor + spring + damping == pytest.approx(hops.tau[:, 1], abs=1e-12)
    stance = hops.phase == "stance"
    assert damping[stance] == pytest.approx(-1.3 * hops.v[stance, 2], abs=1e-9)
    assert damping[~stance] == pytest.approx(0.0, abs=1e-12)


def test_the_bars_add_up_to_the_change_of_stored_energy(hops: Trajectory):
    (axes,) = plots.energy_per_hop(hops).axes
    change = line(axes, "stored")[1]
    assert np.array_equal(change, hops.ledger.change)
    left_out = len(hops.ledger.flows) * NEGLIGIBLE * np.abs(hops.ledger.work).max()
    assert bars(axes).sum(axis=0) == pytest.approx(change, abs=left_out)


def test_a_flow_of_either_sign_is_stacked_on_both_sides(hops: Trajectory):
    work = np.zeros_like(hops.ledger.work)
    work[:, :3] = [[2.0, -1.0, -1.0], [-1.0, 3.0, -1.0], [1.0, 1.0, 1.0]]
    ledger = replace(hops.ledger, work=work, change=work.sum(axis=1))
    (axes,) = plots.energy_per_hop(replace(hops, ledger=ledger)).axes
    tops = [max(bar.get_y() + max(bar.get_height(), 0.0) for bar in hop) for hop in zip(*axes.containers, strict=True)]
    assert tops == [2.0, 3.0, 3.0]
    assert bars(axes).sum(axis=0).tolist() == [0.0, 1.0, 3.0]


@pytest.mark.parametrize("locked", [["boom_x"], []])
def test_the_toe_is_on_the_ground_in_stance_only(locked: list[str]):
    system = hopping(load("spear_ii", locked=locked))
    trajectory = simulate(system, system.guess(), 1, 1e-7, progress=False)
    height, clearance = plots.boom_height(trajectory).axes
    assert np.array_equal(line(height, "hip")[1], trajectory.q[:, -3])
    assert line(height, "apex")[1] == pytest.approx([event.q[-3] for event in trajectory.named("apex")])
    millimetres = line(clearance, "toe")[1]
    stance = trajectory.phase == "stance"
    assert np.abs(millimetres[stance]).max() < 1e-3
    assert millimetres[~stance].max() > 20.0


def test_the_summary_shows_all_hops_and_details_of_two(hops: Trajectory, gait: Gait):
    height, energy, *details = plots.hop_summary(hops, gait).axes
    assert height.get_xlim() == (hops.t[0], hops.t[-1])
    assert bars(energy).shape[1] == HOPS
    assert {axes.get_xlim() for axes in details} == {(0.0, hops.t[hops.cycle <= 2][-1])}


def test_the_summary_of_a_law_of_ones_own_shows_no_commands(hops: Trajectory, gait: Gait):
    own = replace(gait, system=replace(gait.system, law=object()))
    assert not [
        line for axes in plots.hop_summary(hops, own).axes for line in axes.lines if line.get_label() == "commanded"
    ]
    assert [
        line for axes in plots.hop_summary(hops, gait).axes for line in axes.lines if line.get_label() == "commanded"
    ]


@pytest.mark.parametrize("plot", [plots.energy_per_hop, plots.hop_summary])
def test_energy_needs_a_whole_hop(plot, gait: Gait):
    fallen = simulate(replace(gait.system, phase_limit=0.1), gait.state, 1, 1e-6, progress=False)
    assert not fallen.complete
    with pytest.raises(BadValue, match="whole hop"):
        plot(fallen)


def test_a_plot_needs_samples(hops: Trajectory):
    with pytest.raises(BadValue, match="two samples"):
        plots.ground_force(replace(hops, t=hops.t[:1]))


@pytest.mark.slow
def test_a_saved_svg_needs_no_font(hops: Trajectory, gait: Gait, tmp_path: Path):
    path = plots.save_figure(plots.hop_summary(hops, gait), tmp_path / "hops.svg")
    root = ElementTree.parse(path).getroot()
    assert not list(root.iter("{http://www.w3.org/2000/svg}text"))
    assert "font" not in path.read_text(encoding="utf-8")
    again = plots.save_figure(plots.hop_summary(hops, gait), str(tmp_path / "again.svg"))
    assert path.read_bytes() == again.read_bytes()


@pytest.mark.parametrize(("name", "magic"), [("hop.png", b"\x89PNG"), ("hop.pdf", b"%PDF"), ("HOP.SVG", b"<?xml")])
def test_the_suffix_chooses_the_format(hops: Trajectory, tmp_path: Path, name: str, magic: bytes):
    assert plots.save_figure(plots.ground_force(hops), tmp_path / name).read_bytes().startswith(magic)


@pytest.mark.parametrize("name", ["hop.jpg", "hop", "hop.svgz"])
def test_another_suffix_is_refused(hops: Trajectory, tmp_path: Path, name: str):
    with pytest.raises(BadValue, match=r"\.svg, \.pdf, \.png"):
        plots.save_figure(plots.ground_force(hops), tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_figure_is_written_whole_or_not_at_all(hops: Trajectory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "hop.png"
    path.write_text("before")

    def fail(self: Figure, target: Path, **options: object) -> None:
        Path(target).write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Figure, "savefig", fail)
    with pytest.raises(BadFile, match="No space left"):
        plots.save_figure(plots.ground_force(hops), path)
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_no_folder_no_figure(hops: Trajectory, tmp_path: Path):
    with pytest.raises(BadFile, match="nowhere"):
        plots.save_figure(plots.ground_force(hops), tmp_path / "nowhere" / "hop.svg")


@pytest.mark.slow
def test_plots_leave_matplotlib_as_it_was(hops: Trajectory, tmp_path: Path):
    before = dict(matplotlib.rcParams)
    plots.save_figure(plots.hop_summary(hops), tmp_path / "hop.pdf")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.slow
def test_importing_plots_opens_no_window():
    script = "import sys, spear_pin.viz.plots; print('matplotlib.pyplot' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_clearance_of_a_leg_that_was_cut_out_of_a_robot():
    leg = monopod(load("q_spear_full"), "posterior_left", locked=["boom_x"])
    system = hopping(leg, HoppingLaw.scaled(leg))
    trajectory = simulate(system, system.guess(), 1, 1e-6, progress=False)
    axes = Figure().subplots()
    plots.draw_clearance(axes, trajectory)
    heights = [leg.toe_position(q, "toe")[1] for q in trajectory.q]
    assert line(axes, "toe")[1] == pytest.approx(1e3 * np.array(heights), abs=1e-9)


def test_slipping_is_part_of_stance():
    system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(stance_torque=8.0), None, Contact(friction=0.3))
    trajectory = simulate(system, system.guess(), 2, 1e-7, progress=False)
    assert {"stance", "stance slip-"} <= set(trajectory.domain)
    assert shaded(plots.ground_force(trajectory).axes[0]) == 2


class TestSeveralLegs:
    def test_the_torque_of_one_knee(self, strides: Trajectory):
        (axes,) = plots.knee_torque(strides, "anterior_knee").axes
        assert axes.get_ylabel() == "Anterior knee torque, a pair (N·m)"
        assert np.array_equal(line(axes, "motor")[1], strides.u[:, strides.actuated.index("anterior_knee")])
        assert np.array_equal(line(axes, "spring")[1], strides.spring[:, strides.spring_joints.index("anterior_knee")])

    def test_a_knee_is_latched_in_the_stances_of_its_own_leg(self, strides: Trajectory):
        axes = Figure().subplots()
        plots.draw_angle(axes, strides, "anterior_knee", None)
        t, angle = line(axes, "latched")
        knee = strides.coordinates.index("anterior_knee")
        assert t[::3] == pytest.approx([event.time for event in strides.named("anterior_touchdown")])
        assert angle[::3] == pytest.approx([event.q[knee] for event in strides.named("anterior_touchdown")], abs=1e-6)

    def test_motors_of_a_kind_are_one_flow(self, strides: Trajectory):
        (axes,) = plots.energy_per_hop(strides).axes
        legend = axes.get_legend()
        assert legend is not None
        drawn = [text.get_text() for text in legend.get_texts()]
        assert drawn == ["knee motor", "hip motor", "impact", "stored"]
        knees = strides.ledger["motor_posterior_knee"] + strides.ledger["motor_anterior_knee"]
        assert bars(axes)[:2].sum(axis=0) == pytest.approx(knees, abs=1e-12)

    def test_toes_are_told_apart(self, strides: Trajectory):
        for draw in (plots.draw_clearance, plots.draw_force):
            axes = Figure().subplots()
            draw(axes, strides)
            looks = [(drawn.get_color(), drawn.get_linestyle()) for drawn in axes.lines]
            assert len(set(looks)) == len(looks)
            assert axes.get_legend() is not None
