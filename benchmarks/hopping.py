"""The tables of docs/results/hop.md: `python -m benchmarks.hopping`, Markdown on stdout."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks import markdown
from spear_pin import Contact, Gait, Ground, HoppingLaw, Spring, Trajectory, find_gait, hopping, load, simulate
from spear_pin.errors import NoGait
from spear_pin.hybrid.periodic import chart
from spear_pin.studies.hop import summarize

ROBOT = load("spear_ii", locked=["boom_x"])
FLIGHT = {"flight_time": 0.2}
TABLE = ((0.0, 0.0), (0.2, 8.0), (0.5, 24.0), (0.8, 46.0))
HEAD = ("stance torque [N·m]", "stance [s]", "apex [m]", "latched knee [rad]", "peak F_z [N]", "largest multiplier")


def solve(law: HoppingLaw | None = None, start: Gait | None = None, **parts: Any) -> tuple[Gait, Trajectory]:
    """The hop with 0.2 s of flight; with a start, the one nearest to it and by its law."""
    system = hopping(ROBOT, law or (start.system.law if start else None), **parts)
    gait = find_gait(system, ["stance_torque"], FLIGHT, guess=start.state if start else None)
    return gait, simulate(gait.system, gait.state, progress=False)


def ending(gait: Gait, hop: Trajectory) -> str:
    """How stance ends."""
    turns = abs(hop.named("lift_off")[0].time * gait.system.law.frequency - 1.0) < 1e-6
    taut = hop.ledger["released"][0] < 0.0
    return ("torque turns" if turns else "force fades") + (", spring taut" if taut else ", spring slack")


def cells(gait: Gait, hop: Trajectory) -> list[str]:
    summary = summarize(gait, hop)
    return [
        f"{summary['stance_torque']:.4f}",
        f"{summary['stance_time']:.4f}",
        f"{summary['apex_height']:.4f}",
        f"{gait.state[0][-1]:.4f}",
        f"{summary['peak_force']:.1f}",
        f"{abs(gait.multipliers[0]):.4f}",
        ending(gait, hop),
        ", ".join(event.name for event in hop.events if event.time <= hop.named("lift_off")[-1].time),
    ]


def table(first: str, rows: list[tuple[str, list[str]]]) -> None:
    markdown.table(
        [first, *HEAD, "how stance ends", "events of the stance"], ([name, *values] for name, values in rows)
    )


def nominal(gait: Gait, hop: Trajectory) -> None:
    summary = summarize(gait, hop)
    touchdown = hop.named("touchdown")[-1]
    markdown.begin("quantity", "value")
    for name, value in (
        ("stance torque", f"{summary['stance_torque']:.4f} N·m"),
        ("flight, stance", f"{summary['flight_time']:.4f} s, {summary['stance_time']:.4f} s"),
        ("apex of the hip", f"{summary['apex_height']:.4f} m"),
        ("knee at touchdown", f"{touchdown.q[-1]:.4f} rad, {touchdown.v_before[-1]:+.4f} rad/s"),
        ("hip at touchdown", f"{touchdown.q[-2]:.4f} rad, {touchdown.v_before[-2]:+.4f} rad/s"),
        ("largest compression of the spring", f"{summary['peak_compression']:.4f} rad"),
        ("energy in it", f"{0.5 * summary['stiffness'] * summary['peak_compression'] ** 2:.2f} J"),
        ("normal force just after touchdown", f"{hop.force[0, 0, 1]:.2f} N"),
        ("peak normal force", f"{summary['peak_force']:.1f} N"),
        ("sliding before lift-off", f"{1e3 * (hop.named('lift_off')[0].time - hop.named('slip')[-1].time):.2f} ms"),
        ("peak knee speed", f"{summary['peak_speed']['knee']:.2f} rad/s"),
        ("spring's share of the push at the knee", f"{100 * summary['spring_share']:.1f} %"),
        ("force ratio of the impact", f"{abs(touchdown.impulse[0, 0] / touchdown.impulse[0, 1]):.3f}"),
        ("multipliers", ", ".join(f"{value:.4f}" for value in gait.multipliers)),
        ("residual of the fixed point", f"{gait.residual:.0e}"),
    ):
        print(f"| {name} | {value} |")
    print()
    flows = ([flow, f"{energy:+.4f}"] for flow, energy in summary["energy_flows"].items())
    markdown.table(["flow", "energy a hop [J]"], flows)


def recovery(gait: Gait, hop: Trajectory) -> None:
    """From a knee that is 1 rad/s too fast or too slow, just after touchdown."""
    local, (q, v) = chart(gait.system, gait.state), gait.state
    apex, errors = hop.named("apex")[0].q[0], []
    for change in (1.0, -1.0):
        rate = v.copy()
        rate[-1] += change
        state = local.state(local.coordinates((q, rate)))
        errors.append([event.q[0] - apex for event in simulate(gait.system, state, 11, progress=False).named("apex")])
    print("\n| hop | " + " | ".join(f"{n}" for n in range(1, 9)) + " |")
    print("|" + " --- |" * 9)
    for change, row in zip("+-", errors, strict=True):
        print(f"| {change}1 rad/s: apex error [mm] | " + " | ".join(f"{1e3 * error:+.3f}" for error in row[:8]) + " |")


def kinds(base: Gait) -> None:
    """The two kinds of hops at a knee angle of 1.0 rad, each followed along the stance torque."""
    late = find_gait(hopping(ROBOT, HoppingLaw(stance_torque=7.5)))
    print("\n| followed | stance torque [N·m] | flight [s] | stance [s] | largest multiplier | how stance ends |")
    print("|" + " --- |" * 6)
    for name, start, torques in (("down", base, (8.0, 7.8, 7.7, 7.6, 7.5)), ("up", late, (7.5, 7.6, 7.7, 7.8))):
        gait = start
        for torque in torques:
            try:
                gait = find_gait(hopping(ROBOT, replace(base.system.law, stance_torque=torque)), guess=gait.state)
            except NoGait:
                print(f"| {name} | {torque} | none found from the one before | | | |")
                break
            hop = simulate(gait.system, gait.state, progress=False)
            values = (gait.durations["flight"], gait.durations["stance"], abs(gait.multipliers[0]))
            print(f"| {name} | {torque} | {' | '.join(f'{v:.4f}' for v in values)} | {ending(gait, hop)} |", flush=True)


def main() -> None:
    base, hop = solve()
    nominal(base, hop)
    recovery(base, hop)
    knees = np.round(np.arange(0.8, 1.21, 0.1), 1).tolist()
    table("knee [rad]", [(f"{knee}", cells(*solve(HoppingLaw(knee_touchdown=knee)))) for knee in knees])
    kinds(base)
    law = base.system.law
    variants: list[tuple[str, dict[str, Any]]] = [
        ("none", {}),
        ("`hold_extension=True`", {"law": replace(law, hold_extension=True)}),
        ("`minimum_force=10.0`", {"law": replace(law, minimum_force=10.0)}),
        ("`minimum_force=20.0`", {"law": replace(law, minimum_force=20.0)}),
        ("`Spring(unilateral=False)`", {"spring": Spring(unilateral=False)}),
        ("`Spring(stiffness=51.35, damping=1.31)`", {"spring": Spring(stiffness=51.35, damping=1.31)}),
        ("`Spring(stiffness=56.0)`", {"spring": Spring(stiffness=56.0)}),
        ("`Spring(hardening=20.0)`", {"spring": Spring(hardening=20.0)}),
        ("`Spring(preload=2.0)`", {"spring": Spring(preload=2.0)}),
        (f"`Spring(0.0, table={TABLE})`", {"spring": Spring(0.0, table=TABLE)}),
        *((f"`Contact(friction={mu})`", {"contact": Contact(friction=mu)}) for mu in (0.25, 0.4, 1.5)),
        *((f"`Ground(slope={slope})`", {"ground": Ground(slope=slope)}) for slope in (-0.1, 0.1)),
    ]
    rows = []
    for name, parts in variants:
        try:
            rows.append((name, cells(*solve(**parts, start=base))))
        except NoGait as error:
            rows.append((name, [str(error)] + [""] * (len(HEAD) + 1)))
    table("change", rows)


if __name__ == "__main__":
    main()
