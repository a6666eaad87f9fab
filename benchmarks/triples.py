"""Derivatives of 200 random hops: `python -m benchmarks.triples [--triples 200] [--json FILE]`.

Of each triple of spring stiffness, knee gear ratio and friction a gait is searched: of even ones with 0.2 s of flight,
the stance torque solved for, of odd ones that which lifts off at once as the torque switches, with 6.5 N·m; where there
is none, the other. All derivatives of its cycle by the section's coordinates and by six parameters, and of the gait and
its multipliers by three, are compared with Richardson's extrapolation of differences.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from spear_pin import find_gait, hopping, load
from spear_pin.gaits.many import find_many
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.sensitivity.sensitivity import Sensitivity, sensitivity
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.result import State
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from tests.gaits.sensitivity import oracle

RANGES = {"stiffness": (35.0, 70.0), "knee_ratio": (8.0, 25.0), "friction": (0.1, 1.2)}  # N·m/rad, 1, 1
OVER = ("stance_torque", "stiffness", "knee_ratio", "friction", "knee_mass", "hip_to_knee")
BRANCH = ("stiffness", "knee_ratio", "friction")
FLIGHT, SECOND = 0.2, 6.5  # s, N·m
TORQUES = np.array([6.5, 7.0, 7.5, 8.0, 8.5, 9.5])  # N·m, from which the stance torque is searched
ALLOWED = {"cycle": 1e-8, "gait": 1e-8, "friction": 1e-7, "multipliers": 1e-7}  # of a row's scale
SEED = 2026


@dataclass(frozen=True)
class Result:
    """What became of a triple.

    Attributes:
        triple: the numbers, by name.
        found: which gait was found, "0.2 s", "second kind" or "".
        stance_torque: its stance torque, in N·m.
        order: its events.
        one_sided: events that meet.
        refused: why there are no derivatives.
        errors: the largest of each group, of the rows' scales; None where there is none to compare with.
    """

    triple: Mapping[str, float]
    found: str = ""
    stance_torque: float = float("nan")
    order: tuple[str, ...] = ()
    one_sided: tuple[str, ...] = ()
    refused: str = ""
    errors: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def wrong(self) -> list[str]:
        """Groups of derivatives that are not right."""
        return [name for name, error in self.errors.items() if error is not None and not error <= allowed(name)]


def allowed(group: str) -> float:
    """Largest error of a group, of its rows' scales."""
    what, _, name = group.partition(" by ")
    return max(ALLOWED[what], ALLOWED.get(name, 0.0))


@cache
def hop() -> HybridSystem:
    """The hop that others are made of."""
    return hopping(load("spear_ii", locked=["boom_x"]))


@cache
def states() -> tuple[State, State]:
    """Gaits of both kinds, to begin from."""
    first = find_gait(hop(), vary=["stance_torque"], target={"flight_time": FLIGHT})
    return first.state, find_gait(with_numbers(hop(), {"stance_torque": SECOND})).state


def triples(count: int) -> list[dict[str, float]]:
    """Random triples, the same ones each time."""
    random = np.random.default_rng(SEED)
    return [{name: float(random.uniform(*limits)) for name, limits in RANGES.items()} for _ in range(count)]


def searched(triple: Mapping[str, float], second: bool) -> tuple[str, HybridSystem, State] | None:
    """A gait of a triple."""
    system = with_numbers(hop(), triple)
    for kind in (second, not second):
        wanted = {} if kind else {"vary": ["stance_torque"], "target": {"flight_time": FLIGHT}}
        torques = TORQUES[:1] if kind else TORQUES
        table = find_many(system, {"stance_torque": torques}, guess=states()[kind], **wanted)
        for i in np.flatnonzero(table.converged):
            torque = float(table.parameters["stance_torque"][i])
            name = "second kind" if kind else f"{FLIGHT:g} s"
            return name, with_numbers(system, {"stance_torque": torque}), (table.q[i], table.v[i])
    return None


def checked(triple: Mapping[str, float], second: bool) -> Result:
    """A triple's gait, its derivatives compared."""
    gait = searched(triple, second)
    if gait is None:
        return Result(triple)
    name, system, state = gait
    known = {"triple": triple, "found": name, "stance_torque": float(system.law.stance_torque)}
    try:
        orbit = oracle.again(Orbit(system, state, OVER), "stiffness", 0.0)
        orbit = Orbit(system, orbit.state, OVER)
        cycle = orbit.cycle
        table = sensitivity(system, orbit.state, BRANCH)
    except NotDifferentiable as refusal:
        return Result(**known, refused=str(refusal))
    order = tuple("+".join(sorted(events)) for events in cycle.order)
    return Result(**known, order=order, one_sided=cycle.borders, errors=errors(orbit, table))


def errors(orbit: Orbit, table: Sensitivity) -> dict[str, float | None]:
    """Largest error of each group."""
    enough = min(ALLOWED.values()) / 10.0
    columns, gaits = oracle.compared(orbit, enough), oracle.compared_gaits(orbit, table, enough)
    d = orbit.dimension
    found: dict[str, float | None] = {}
    for j in range(d + len(OVER)):
        name = "cycle by coordinates" if j < d else f"cycle by {OVER[j - d]}"
        error = float(columns[j][0].max()) if j in columns else None
        before = found.get(name, 0.0)
        found[name] = None if error is None or before is None else max(before, error)
    for name in BRANCH:
        off = gaits.get(name)
        found[f"gait by {name}"] = None if off is None else float(off[0].max())
        known = off is not None and np.isfinite(off[1]).all()
        found[f"multipliers by {name}"] = float(off[1].max()) if off is not None and known else None
    return found


def table_of(results: Iterable[Result]) -> str:
    """The table of docs/results/derivatives.md."""
    results = list(results)
    gaits = [each for each in results if each.found]
    plain = [each for each in gaits if not each.refused]
    kinds = Counter(each.found for each in plain)
    second = sum(each.order[-2:-1] == ("lift_off",) and "torque_switch" in each.order[-3:-2] for each in plain)
    rows = [
        ("random triples", f"{len(results)}"),
        ("with a gait", f"{len(gaits)}"),
        ("all derivatives right", f"{sum(not each.wrong for each in plain)}"),
        ("some wrong", f"{sum(bool(each.wrong) for each in plain)}"),
        ("lands and slips first, lands and sticks", f"{_slips(plain)}, {len(plain) - _slips(plain)}"),
        ("with 0.2 s of flight, with 6.5 N·m", f"{kinds[f'{FLIGHT:g} s']}, {kinds['second kind']}"),
        ("lifts off at once as the torque switches", f"{second}"),
        ("orders of events", f"{len({each.order for each in plain})}"),
        ("one-sided", f"{sum(bool(each.one_sided) for each in plain)}"),
    ]
    for reason, count in Counter(each.refused.rpartition(": ")[2] for each in gaits if each.refused).most_common():
        rows.append((f"refused: {reason}", f"{count}"))
    groups = dict.fromkeys(name for each in plain for name in each.errors)
    for name in groups:
        known = [error for each in plain if (error := each.errors[name]) is not None]
        rows.append((f"largest error, {name}", f"{max(known):.0e} in {len(known)}"))
    return "\n".join(["| | |", "| --- | --- |", *(f"| {name} | {value} |" for name, value in rows)])


def _slips(results: Iterable[Result]) -> int:
    return sum("stick" in each.order[:1] for each in results)


def main() -> None:
    """Print what becomes of each triple, then the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triples", type=int, default=200)
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep results there, and go on from those there are")
    arguments = parser.parse_args()
    results = read(arguments.json)
    for n, triple in list(enumerate(triples(arguments.triples)))[len(results) :]:
        results.append(checked(triple, n % 2 == 1))
        print(n, told(results[-1]), flush=True)
        if arguments.json:
            arguments.json.write_text(json.dumps([asdict(each) for each in results], indent=1), encoding="utf-8")
    print(table_of(results))


def read(file: Path | None) -> list[Result]:
    """Results that there are already."""
    if file is None or not file.exists():
        return []
    rows = json.loads(file.read_text(encoding="utf-8"))
    return [Result(**{**row, "order": tuple(row["order"]), "one_sided": tuple(row["one_sided"])}) for row in rows]


def told(result: Result) -> str:
    """A line on a triple."""
    numbers = ", ".join(f"{name} {value:.2f}" for name, value in result.triple.items())
    if not result.found:
        return f"{numbers}: no gait"
    if result.refused:
        return f"{numbers}: {result.found}, {result.refused}"
    worst = max(result.errors, key=lambda name: (result.errors[name] or 0.0) / allowed(name))
    right = f"wrong: {', '.join(result.wrong)}" if result.wrong else "right"
    return f"{numbers}: {result.found}, {' '.join(result.order)}, {right}, {worst} {result.errors[worst] or 0.0:.1e}"


if __name__ == "__main__":
    main()
