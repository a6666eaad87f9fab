"""Figures of motions for display while their numbers change."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.measures.catalogue import SHOWN, added
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.studies.bound import summarize
from spear_pin.studies.explore.legs import RATIO
from spear_pin.studies.explore.motion import Motion
from spear_pin.studies.hop import durations, spring_share


def figures(motion: Motion) -> dict[str, float | None]:
    """Returns figures of a motion, SI units; None where there is none. See the functions of each kind."""
    of_any = gait_figures(motion) if added() else {}
    return FIGURES[motion.knobs.subject.kind](motion) | {each.kind: of_any[each.kind] for each in added()}


def gait_figures(motion: Motion) -> dict[str, float | None]:
    """Returns measures of a cycle by their names; of joints and toes the largest."""
    system, cycles = motion.knobs.system, range(1, motion.trajectory.cycles + 1)
    found = Sampled(system.robot, motion.trajectory, cycles, halves=bool(system.mirrored_toes)).values()
    own = {each.kind: (each.kind,) for each in added()}
    return {
        name: max((found[each] for each in names_of(found, kinds)), default=None)
        for name, kinds in {**MEASURES["gait"], **own}.items()
    }


def names_of(found: Iterable[str], kinds: Iterable[str]) -> list[str]:
    """Lists measures of some names, or of a name those with a joint or a toe behind it."""
    found = [*found]
    own = ([kind] if kind in found else [name for name in found if name.startswith(f"{kind}_")] for kind in kinds)
    return [name for names in own for name in names]


def bound_figures(motion: Motion) -> dict[str, float | None]:
    """Returns figures of a stride.

    Returns:
        speed, stride and period; peak_force, normal, of a pair; friction_used; of one motor each
        peak_torque_stance_knee and peak_torque_stance_hip; peak_speed_knee; impact_loss, a stride; cost_of_transport;
        posterior_hip_torque, β_sp; of legs the largest; see `spear_pin.studies.bound`.
    """
    assert motion.gait is not None
    told = summarize(motion.gait, motion.trajectory)
    found, stance = told["measures"], told["peak_torque_stance"]
    return {
        **{name: max(found[each] for each in names_of(found, kinds)) for name, kinds in MEASURES["bound"].items()},
        **{f"peak_torque_stance_{part}": max(stance[f"{leg}_{part}"] for leg in LEGS) for part in ("knee", "hip")},
        "impact_loss": told["impact_loss"],
        "posterior_hip_torque": motion.gait.system.law.posterior_hip_torque,
    }


def hop_figures(hops: Motion) -> dict[str, float | None]:
    """Returns figures of hops, SI units; None where there is no such figure.

    Returns:
        apex_height, of the hip above the ground, the highest; flight_time and stance_time, the longest of a whole hop;
        peak_force, normal; peak_torque_knee and peak_power_knee of the knee's motor at the joint, by their amount;
        rotor_torque_knee, the peak torque before an ideal gear; positive_work, of both motors, a hop; spring_share,
        see `spring_share`.
    """
    trajectory, robot = hops.trajectory, hops.knobs.system.robot
    whole, sampled = trajectory.cycles > 0, Sampled(robot, trajectory, ())
    apexes = [float(event.q[trajectory.coordinates.index("boom_z")]) for event in trajectory.named("apex")]
    stance, flight = durations(trajectory).max(axis=0).tolist() if whole else (None, None)
    peak_torque = sampled.of("peak_torque")["knee"]
    return {
        "apex_height": max(apexes, default=None),
        "flight_time": flight,
        "stance_time": stance,
        "peak_force": sampled.largest("peak_force"),
        "peak_torque_knee": peak_torque,
        "rotor_torque_knee": peak_torque / hops.knobs.values[RATIO] if RATIO in hops.knobs.values else None,
        "peak_power_knee": sampled.amount(sampled.torques["knee"] * sampled.speeds["knee"]),
        "positive_work": Sampled(robot, trajectory, range(1, trajectory.cycles + 1)).positive_work if whole else None,
        "spring_share": spring_share(trajectory) if whole else None,
    }


MEASURES: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "hop": {
        name: (name,)
        for name in ("apex_height", "flight_time", "stance_time", "peak_force", "peak_torque_knee", "positive_work")
    },
    "bound": {
        "speed": ("mean_speed",),
        **{name: (name,) for name in ("stride", "period", "peak_force", "friction_used", "cost_of_transport")},
        "peak_torque_stance_knee": tuple(f"peak_torque_{leg}_knee" for leg in LEGS),
        "peak_torque_stance_hip": tuple(f"peak_torque_{leg}_hip" for leg in LEGS),
        "peak_speed_knee": tuple(f"peak_speed_{leg}_knee" for leg in LEGS),
    },
    "gait": {kind: (kind,) for kind in SHOWN},
}
"""By kind of motion, figures and the names of the measures of a cycle of which each is the largest."""
FIGURES: Mapping[str, Callable[[Motion], dict[str, float | None]]] = {
    "hop": hop_figures,
    "bound": bound_figures,
    "gait": gait_figures,
}
