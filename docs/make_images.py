"""Make the pictures of the README and the documentation: `python -m docs.make_images [PART ...]`.

Parts are moving, hop, bench, compare, biped, hoppy, another, space, attraction, robust, design, push, hardware,
drivetrain, sweep, branches, stable, late and spread. The first eight need Chromium, moving, which films what moves on
top of the README, also ffmpeg, another also the extras `robots` and `optimize`; those of the design studies and of the
drivetrain take some minutes; the latter print the table of docs/results/motors.md.
"""

from __future__ import annotations

import argparse
import runpy
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from docs.late_switch import late_switch
from docs.stability import stability
from spear_pin import (
    Gait,
    HoppingLaw,
    SpatialLaw,
    Trajectory,
    continue_gait,
    find_gait,
    hopping,
    load,
    optimize_design,
    sagittal,
    simulate,
)
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.hybrid.hardware import Sensing
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.model.catalogue import gearbox, motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies.basin import basin
from spear_pin.studies.basin.attraction import attraction as attracted
from spear_pin.studies.basin.attraction import make_drops
from spear_pin.studies.basin.robustness import robustness
from spear_pin.studies.bound import bound_of
from spear_pin.studies.design import Member
from spear_pin.studies.drivetrain import knee_drives
from spear_pin.studies.energetics import compute_points, costs, energy_flow
from spear_pin.studies.hardware import Rig, on_rig
from spear_pin.studies.identification import Estimate, MovingAverage, cut_releases, identify, read_record, smooth_trial
from spear_pin.studies.laboratory import Instrument, synthesize, write_csv
from spear_pin.studies.published_costs import PUBLISHED
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, gear_study, spear_ii
from spear_pin.studies.sweep import grid
from spear_pin.studies.sweep import sweep as swept
from spear_pin.viz import compare as comparing
from spear_pin.viz import plots
from spear_pin.viz.player import record
from spear_pin.viz.plots import basin as basin_plots
from spear_pin.viz.plots import design as design_plots
from spear_pin.viz.plots import drivetrain as drivetrain_plots
from spear_pin.viz.plots import energy as energy_plots
from spear_pin.viz.plots import identification as identification_plots
from spear_pin.viz.plots import push as push_plots
from spear_pin.viz.plots import robustness as robustness_plots
from spear_pin.viz.plots import source as source_plots
from spear_pin.viz.plots import space as space_plots
from spear_pin.viz.plots import sweep as sweep_plots
from spear_pin.viz.plots import uncertainty as uncertainty_plots
from spear_pin.viz.plots.design_by_gradient import optimised
from spear_pin.viz.plots.family import family
from spear_pin.viz.video import film
from tests.viz.chromium import Browser

IMAGES = Path(__file__).parent / "images"
INSTANT = 0.27  # s: the knee extends, spring and motor push
TURNING, AHEAD = 6.28, "3.2,1.7,1.9,-0.6,-0.1,0"  # s: both anterior feet bear; where the camera is and looks
WIDTH, HEIGHT = 1280, 800  # of the page, in pixels
FPS, SLOWER, DRAWN, SHOWN = 16.0, 0.25, (640, 520), 400  # of the films: frames a second, speed, pixels drawn and kept
# few colours, the same in all frames, and no dither: what does not move takes no room
PALETTE = "split[a][b];[a]palettegen=max_colors=64:stats_mode=diff[p];[b][p]paletteuse=dither=none"
SPEEDS = (1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5)  # m/s, of the long strides that ship
MOTORS = ("spear_ii_knee", "ec_60_flat_100w_24v", "ec_90_flat_90w_24v", "ec_90_flat_260w")
RATIOS = (6.0, 8.0, 10.0, 12.0, 15.0, 18.0, 22.0, 26.0, 30.0)
PUSHES = {"torso_x": np.linspace(-0.6, 0.6, 9), "pitch": np.linspace(-1.2, 1.2, 9)}  # m/s, rad/s


def main() -> None:
    """Write the pictures asked for, or every one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", help="some of the parts; all if none is named")
    seen = moving, hop, bench, compare, biped, hoppy, another, space
    known = (
        *seen,
        attraction,
        robust,
        design,
        push,
        hardware,
        drivetrain,
        sweep,
        branches,
        stable,
        designed,
        late,
        spread,
    )
    parts = {part.__name__: part for part in known}
    what = parser.parse_args().what or list(parts)
    if unknown := set(what) - set(parts):
        parser.error(f"no pictures of {', '.join(sorted(unknown))}")
    for name, part in parts.items():
        if name in what:
            part()


def moving() -> None:
    """Film one hop and one stride, which go on without a seam, at a quarter of real time."""
    gaits = {"hop": hop_in_place(), "bound": Gait.load("long_stride")}
    for (name, gait), title in zip(gaits.items(), ("SPEAR-II", "Q-SPEAR"), strict=True):
        cycle = simulate(gait.system, gait.state, cycles=1)
        with tempfile.TemporaryDirectory() as folder:
            made, robot = Path(folder) / "film.mp4", gait.system.robot
            film(robot, cycle, made, fps=FPS, speed=SLOWER, size=DRAWN, title=title)
            shown = f"scale={SHOWN}:-1:flags=lanczos,{PALETTE}"
            kept = IMAGES / f"{name}.gif"
            subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", made, "-vf", shown, kept], check=True)
        print(kept, kept.stat().st_size)


def hop_in_place() -> Gait:
    """SPEAR-II's hop with 0.2 s of flight."""
    robot = load("spear_ii", locked=["boom_x"])
    return find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2})


def hop() -> None:
    """Solve the hops and write their pictures."""
    gait = hop_in_place()
    hops = simulate(gait.system, gait.state, cycles=11)
    address = f"t={INSTANT}&plot=q_boom_z,q_knee,force_z_toe"
    show(gait, hops.in_cycles(1, 3), "SPEAR-II hopping in place", address, "hop.png")
    print(plots.save_figure(plots.hop_summary(hops, gait), IMAGES / "summary.svg"))
    recovery = simulate(gait.system, _dropped(hops, 0.02), cycles=11)
    print(plots.save_figure(plots.boom_height(recovery), IMAGES / "recovery.svg"))
    late = find_gait(hopping(gait.system.robot, HoppingLaw(stance_torque=7.5)))
    print(plots.save_figure(plots.knee_torque(simulate(late.system, late.state, cycles=2)), IMAGES / "late.svg"))


def bench() -> None:
    """Bound Q-SPEAR, and show its page with plots, forces and angles at one instant."""
    gait = Gait.load("long_stride")
    strides = simulate(gait.system, gait.state, cycles=4)
    show(gait, strides, "Q-SPEAR bounding", "t=0.3&loop=0.247,0.35&show=forces,angles", "bench.png")


def compare() -> None:
    """Compare two springs, and show the page at one instant."""
    with tempfile.TemporaryDirectory() as folder, Browser(1280, 1000) as browser:
        both = comparing.compare("stiffness=40", "stiffness=60")
        browser.open(both.save(Path(folder) / "compare.html"))
        browser.run("(player.clock.pauseAt(0.3), new Promise((done) => setTimeout(done, 1000)))")
        print(browser.screenshot(IMAGES / "compare.png").shape)


def biped() -> None:
    """Run the example and show its page at one instant."""
    with tempfile.TemporaryDirectory() as folder, Browser(1000, 720) as browser:
        runpy.run_path(str(IMAGES.parents[1] / "examples" / "biped.py"))["main"](Path(folder))
        browser.open(Path(folder) / "biped.html", "#t=0.62&show=-plots")
        browser.screenshot(IMAGES / "biped.png")


def hoppy() -> None:
    """Run the example and show its page at one instant."""
    with tempfile.TemporaryDirectory() as folder, Browser(1000, 720) as browser:
        runpy.run_path(str(IMAGES.parents[1] / "examples" / "hoppy.py"))["main"](Path(folder))
        browser.open(Path(folder) / "hoppy.html", "#t=4.7&show=-plots")
        browser.screenshot(IMAGES / "hoppy.png")


def another() -> None:
    """Bound Solo12, as `spear bound --robot solo12` does, and show its page at one instant."""
    plane = sagittal(load("solo12", base="free", motors="all"))
    gait = bound_of(plane)
    strides = simulate(gait.system, gait.state, cycles=2)
    with tempfile.TemporaryDirectory() as folder, Browser(1000, 720) as browser:
        page = record(plane, strides, Path(folder) / "bound.html", title="solo12 bounding")
        browser.open(page, f"#t={gait.durations['posterior_stance'] / 2}&show=-plots")
        print(browser.screenshot(IMAGES / "solo12.png").shape, gait.parameters, gait.durations)


def space() -> None:
    """Show the page of the turn that an example keeps, and footfalls beside those of a bound, a trot and a gallop."""
    gait, plane = Gait.load(IMAGES.parents[1] / "examples" / "turn.json"), Gait.load("long_stride")
    strides = simulate(gait.system, gait.state, 20)
    straight = simulate(*embed(plane, SpatialLaw(plane.system.law)), 1)
    with tempfile.TemporaryDirectory() as folder, Browser(1000, 720) as browser:
        page = record(gait.system.robot, strides, Path(folder) / "turn.html", title="Q-SPEAR turning")
        browser.open(page, f"#t={TURNING}&show=-plots,-trails&camera={AHEAD}")
        print(browser.screenshot(IMAGES / "turn.png").shape)
    motions = {"bound": straight, "bound, turning to the left by 4° a stride": strides}
    for name, cycles in (("trot", 2), ("gallop", 1)):  # a trot's cycle is half a stride
        other = Gait.load(name)
        motions[name] = simulate(other.system, other.state, cycles)
    falls = space_plots.footfall_diagram(motions)
    print(plots.save_figure(falls, IMAGES / "footfalls.svg"))


def attraction() -> None:
    """Write the map of where the hop is reached from, of a hundred thousand states; it takes half a minute."""
    gait = hop_in_place()
    clearances, knees = np.linspace(0.005, 0.6, 317), np.linspace(0.1, 2.4, 317)
    found = attracted(gait, *make_drops(gait, clearances, knees))
    labels = "Toe above the ground (m)", "Knee (rad)"
    figure = basin_plots.attraction_map(found, clearances, knees, *labels)
    print(plots.save_figure(figure, IMAGES / "attraction.png"), found.share)


def robust() -> None:
    """Write the picture of what the hop survives, of four thousand draws; it takes a minute."""
    gait = hop_in_place()
    drawn = dict.fromkeys(("stiffness", "damping", "stance_torque", "friction"), 0.1)
    found = robustness(gait, drawn, draws=4000)
    print(plots.save_figure(robustness_plots.robustness_figure(found), IMAGES / "robustness.svg"))
    print(found.share, found.interval(), dict(zip(*np.unique(found.reason, return_counts=True), strict=True)))


def design() -> None:
    """Write the pictures of the design studies, of gaits that ship."""
    gait = Gait.load("long_stride")
    names = {2.5: "long_stride"}
    family = [Member(speed, Gait.load(names.get(speed, f"long_stride_{speed:.2f}")), None) for speed in SPEEDS]
    pictures = {
        "compliance": design_plots.compliance(gait),
        "stiffness": design_plots.stiffness_sweep(gait),
        "hip_torques": design_plots.hip_torques(gait),
        "torque_speed": design_plots.torque_speed(gait, drives()),
        "family": design_plots.family_plot(family, "speed"),
    }
    for name, figure in pictures.items():
        print(plots.save_figure(figure, IMAGES / f"{name}.svg"))
    strides = basin(add_feedback(gait), "flight_1", PUSHES)
    print(plots.save_figure(basin_plots.basin_map(strides, PUSHES), IMAGES / "basin.svg"))


def sweep() -> None:
    """Write the map of the hop over spring and torque; it takes a minute."""
    points = grid({"stiffness": np.linspace(38.0, 62.0, 49), "stance_torque": np.linspace(6.0, 9.0, 31)})
    with tempfile.TemporaryDirectory() as folder:
        dataset = swept(hopping(load("spear_ii", locked=["boom_x"])), points, Path(folder) / "map.zarr")
        print(plots.save_figure(sweep_plots.sweep_map(dataset), IMAGES / "sweep.svg"))


def branches() -> None:
    """Write both kinds of hop over the stance torque; it takes a minute or two."""
    robot = load("spear_ii", locked=["boom_x"])
    begins = (find_gait(hopping(robot, HoppingLaw(stance_torque=torque))) for torque in (7.8, 6.5))  # N·m
    found = [continue_gait(gait, "stance_torque", (5.5, 11.0)) for gait in begins]
    for branch in found:
        print(branch)
    print(plots.save_figure(family(*found), IMAGES / "branches.svg"))


def late() -> None:
    """Saves the picture of hops with a late switch."""
    print(plots.save_figure(late_switch(), IMAGES / "late_switch.svg"))


def stable() -> None:
    """Write the trot's multipliers over its roll inertia and hip spacing; it takes three minutes."""
    print(plots.save_figure(stability(), IMAGES / "stability.svg"))


def designed() -> None:
    """The hop of least energy over spring, gear ratio and touchdown angle."""
    over = {"stiffness": (42.0, 60.0), "knee_ratio": (8.0, 30.0), "knee_touchdown": (0.80, 1.02)}
    bounds, motors = {"margin_spring_switch": 0.02}, {"knee": motor("spear_ii_knee")}
    best = optimize_design(
        hop_in_place(), "energy", over, {"flight_time": 0.2}, at_least=bounds, largest_multiplier=0.6, motors=motors
    )
    print(plots.save_figure(optimised(best), IMAGES / "optimal_design.svg"))


def spread() -> None:
    """Write how far the hop is known with a knee whose numbers are not, and 2000 samples of it."""
    table = hop_in_place().sensitivity(["stiffness", "damping", "knee_touchdown"], ["stance_torque"], ["flight_time"])
    found = table.uncertainty({"stiffness": 0.62, "damping": 0.05, "knee_touchdown": 0.003})
    drawn = found.monte_carlo(2000)
    print(drawn)
    print(plots.save_figure(uncertainty_plots.variance_shares(found), IMAGES / "spread.svg"))
    print(plots.save_figure(uncertainty_plots.monte_carlo(drawn), IMAGES / "monte_carlo.svg"))


def push() -> None:
    """Write the pictures of the push test; the records that are fitted are synthetic."""
    fits = {f"{100 * depth:g} cm, with motor": fitted(depth, seed) for seed, depth in enumerate(DEPTHS)}
    pictures = {
        "gears": push_plots.gear_comparison(gear_study()),
        "identification": identification_plots.fit_summary(fits),
        "tables": source_plots.source_comparison(),
    }
    for name, figure in pictures.items():
        print(plots.save_figure(figure, IMAGES / f"{name}.svg"))


def hardware() -> None:
    """Write the pictures of the hop on hardware, and of what transport costs."""
    rig = Rig(sensing=Sensing(angle_noise=0.005, rate_noise=0.2, losses=5.0), current_limit=8.0, bandwidth=500.0)
    robot = load("spear_ii", locked=["boom_x"])
    ideal = find_gait(hopping(robot), ["stance_torque"], {"flight_time": 0.2})
    system = with_hardware(hopping(robot, HoppingLaw(stance_torque=9.4)), Rig().on(robot))
    gait = find_gait(system, ["stance_torque"], {"flight_time": 0.2})
    calm, rough = on_rig(gait, Rig(), hops=3), on_rig(gait, rig, rtol=1e-7)
    bound = Gait.load("long_stride")
    motors = [Drive(motor("assumed_600w"), gearbox("gp_52_c_15"), 48.0)] * 4
    points = compute_points(
        "Q-SPEAR, assumed motors", costs(bound.system, simulate(bound.system, bound.state, 1), motors)
    )
    pictures = {
        "energy_flow": energy_plots.energy_flow(energy_flow(gait.system, calm)),
        "currents": energy_plots.currents(rough),
        "heights": energy_plots.heights(rough, simulate(ideal.system, ideal.state, 11)),
        "transport": energy_plots.cost_of_transport(PUBLISHED, points),
    }
    for name, figure in pictures.items():
        print(plots.save_figure(figure, IMAGES / f"{name}.svg"))


def drivetrain() -> None:
    """Write the picture of motors and gear ratios at the knee, and print their table."""
    motors = {name: motor(name) for name in MOTORS}
    rows = []
    for row in knee_drives(load("spear_ii", locked=["boom_x"]), motors, RATIOS, law=HoppingLaw(knee_touchdown=0.8)):
        rows.append(row)
        cells = (
            f"`{row.motor}` | {row.ratio:g} | {1e3 * row.reflected_inertia:.0f} | {row.energy:.1f} | {row.heat:.1f}"
            f" | {row.impact:.2f} | {row.peak_torque:.0f} | {row.rms_current:.1f}, {row.peak_current:.1f}"
            f" | {row.thermal_load:.2f} | {row.peak_speed / row.drive.no_load_speed:.2f} | {row.margin:.1f}"
        )
        print(f"| {cells} |", row.reason, flush=True)
    print(plots.save_figure(drivetrain_plots.drivetrain(rows), IMAGES / "drivetrain.svg"))


def fitted(depth: float, seed: int) -> Estimate:
    """What is found from a synthetic record of pushes by a depth, in m, read back from its file."""
    leg, instrument = spear_ii(), Instrument()
    with tempfile.TemporaryDirectory() as folder:
        synthetic = synthesize(leg, WITH_MOTOR, depth, instrument=instrument, seed=seed)
        data = read_record(write_csv(synthetic, Path(folder) / "record.csv"), calibration=instrument.calibration)
    return identify(leg, [smooth_trial(trial, MovingAverage(100)) for trial in cut_releases(data)[0]])


def drives() -> dict[str, Drive]:
    """The knee drives of the catalogue that stand for the source's 260 W and 600 W."""
    motors = {"260 W": "ec_90_flat_260w", "600 W": "assumed_600w"}
    return {name: Drive(motor(key), Gearbox(15.0, 0.83), bus=48.0) for name, key in motors.items()}


def show(gait: Gait, motion: Trajectory, title: str, address: str, name: str) -> None:
    """Write a picture of the page of a motion as its address says."""
    with tempfile.TemporaryDirectory() as folder, Browser(WIDTH, HEIGHT) as browser:
        browser.open(record(gait.system.robot, motion, Path(folder) / "page.html", title=title), f"#{address}")
        print(IMAGES / name, browser.screenshot(IMAGES / name).shape)


def _dropped(hops: Trajectory, height: float) -> tuple[np.ndarray, np.ndarray]:
    """The apex, lifted."""
    apex = hops.named("apex")[0]
    q = apex.q.copy()
    q[hops.coordinates.index("boom_z")] += height
    return q, apex.v


if __name__ == "__main__":
    main()
