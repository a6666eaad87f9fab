"""Figures of the report: the plots with their runs."""

from __future__ import annotations

from matplotlib.figure import Figure

from spear_pin.model.catalogue import motor
from spear_pin.studies.audit import runs
from spear_pin.studies.audit.printed_designs import SPEAR_II
from spear_pin.studies.energetics import compute_points
from spear_pin.studies.published_costs import PUBLISHED
from spear_pin.studies.push_test import DEPTHS, release, spear_ii
from spear_pin.viz import plots
from spear_pin.viz.plots import bound as bound_plots
from spear_pin.viz.plots import design as design_plots
from spear_pin.viz.plots import energy as energy_plots
from spear_pin.viz.plots import identification as identification_plots
from spear_pin.viz.plots import push as push_plots
from spear_pin.viz.plots import source as source_plots


def transport() -> Figure:
    """Draws published costs of transport, and those of the bound."""
    return energy_plots.cost_of_transport(PUBLISHED, compute_points("Q-SPEAR, assumed motors", runs.bound_costs()))


def energy() -> Figure:
    """Draws the energy flow of the hop on hardware."""
    return energy_plots.energy_flow(runs.hop_energy())


def releases() -> Figure:
    """Draws releases with the estimates of Table 4.1: from the three depths with motor, from the deepest without."""
    cases = {f"{100 * depth:g} cm": (depth, True) for depth in DEPTHS} | {"10 cm, no motor": (DEPTHS[-1], False)}
    return push_plots.release_summary(
        {
            name: release(spear_ii(15.0 if motor_on else None), runs.estimated(depth, motor_on), depth)
            for name, (depth, motor_on) in cases.items()
        }
    )


def fits() -> Figure:
    """Draws the model fitted to six synthetic sets of releases."""
    return identification_plots.fit_summary(
        {
            f"{100 * depth:g} cm, {'with motor' if motor_on else 'no motor'}": runs.fitted(depth, motor_on)
            for motor_on in (True, False)
            for depth in DEPTHS
        }
    )


def gears() -> Figure:
    """Draws the release with other gear ratios."""
    return push_plots.gear_comparison(runs.gears())


def idling() -> Figure:
    """Draws the release with the motor idling."""
    return source_plots.power_off_heights(runs.idling())


def bridge() -> Figure:
    """Draws the knee motor turned from outside."""
    return source_plots.bridge_currents(motor("spear_ii_knee"), SPEAR_II.knee_ratio)


def hop() -> Figure:
    """Draws the hop at a glance."""
    return plots.hop_summary(runs.hops(), runs.hop())


def experiment_angles() -> Figure:
    """Draws angles on disturbed hardware and without."""
    return energy_plots.angles_against(runs.rough_hops(), runs.hops(), runs.hardware_hop())


def experiment_currents() -> Figure:
    """Draws currents on disturbed hardware."""
    return energy_plots.currents(runs.rough_hops())


def experiment_heights() -> Figure:
    """Draws heights on disturbed hardware and without."""
    return energy_plots.heights(runs.rough_hops(), runs.hops())


def bound() -> Figure:
    """Draws the bound at a glance."""
    return bound_plots.bound_summary(runs.strides(), runs.bound())


def compliance() -> Figure:
    """Draws knee torques with the spring and without."""
    return design_plots.compliance(runs.bound())


def stiffness() -> Figure:
    """Draws knee torques with springs of other stiffness."""
    return design_plots.stiffness_sweep(runs.bound())


def hips() -> Figure:
    """Draws hip torques of the bound."""
    return design_plots.hip_torques(runs.bound())


def torque_speed() -> Figure:
    """Draws operating points of the knees with three drives."""
    drives = {power: runs.knee_drive(power) for power in ("100 W", "260 W", "600 W")}
    return design_plots.torque_speed(runs.bound(), drives)
