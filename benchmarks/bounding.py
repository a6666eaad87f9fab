"""Gait search from cold: does every start lead to the same gait, and does the mesh matter?

`python -m benchmarks.bounding [--seeds 8] [--gait least_effort] [--json]`: per seed the CPU time, iterations,
objective, residual of the fixed point and distance of the objective from the best; then the objective on meshes
of more and more intervals. Needs casadi.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from typing import Any

from benchmarks.markdown import table
from spear_pin import load
from spear_pin.errors import SpearError
from spear_pin.gaits.collocation import Solution, resample
from spear_pin.gaits.footfalls.in_plane import in_plane
from spear_pin.gaits.footfalls.programme import transcribe
from spear_pin.gaits.library import REQUESTS
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request

ROBOT = load("q_spear")
MESHES = (6, 10, 16, 24)  # intervals of each phase
SAME = 1e-6  # relative difference of the objectives of starts that lead to one gait


def start(request: Request, seed: int) -> tuple[dict[str, Any], Solution | None]:
    """One cold search."""
    begin, solution = time.process_time(), None
    row: dict[str, Any] = {"seed": seed, "reason": ""}
    try:
        gait, solution = search(ROBOT, request, seed=seed)
        row |= {"iterations": solution.iterations, "objective": solution.objective, "residual": gait.residual}
    except SpearError as error:
        row["reason"] = str(error)
    return row | {"seconds": time.process_time() - begin}, solution


def meshes(request: Request, solution: Solution) -> list[dict[str, Any]]:
    """The objective with other numbers of intervals, each mesh started from the one before."""
    rows: list[dict[str, Any]] = []
    for intervals in MESHES:
        begin = time.process_time()
        solution = transcribe(in_plane(ROBOT, request, intervals), resample(solution)).programme.solve()
        row = {"intervals": intervals, "objective": solution.objective, "iterations": solution.iterations}
        rows.append(row | {"success": solution.success, "seconds": time.process_time() - begin})
    return rows


def main() -> None:
    """Search, and print Markdown or JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=8, help="number of cold starts")
    parser.add_argument("--gait", choices=REQUESTS, default="least_effort", help="whose request is searched for")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    request = REQUESTS[arguments.gait]
    rows, best = [], None
    for seed in range(arguments.seeds):
        row, solution = start(request, seed)
        rows.append(row)
        if solution is not None and (best is None or solution.objective < best.objective):
            best = solution
    if best is None:
        raise SystemExit("no start led to a gait")
    for row in rows:
        row["above_best_percent"] = 100.0 * (row.get("objective", math.nan) / best.objective - 1.0)
    found = [row for row in rows if not row["reason"]]
    same = sum(row["above_best_percent"] < 100.0 * SAME for row in found)
    convergence = meshes(request, best)
    seconds = sorted(row["seconds"] for row in found)[len(found) // 2]
    verdict = (
        f"{arguments.gait}: {len(found)} of {len(rows)} cold starts led to a gait, {same} to the best one; "
        f"median {seconds:.1f} s of CPU time; {MESHES[1]} intervals differ from {MESHES[-1]} by "
        f"{100.0 * abs(convergence[1]['objective'] / convergence[-1]['objective'] - 1.0):.1e} %"
    )
    if arguments.json:
        plain = [{key: value for key, value in row.items() if value == value} for row in rows]
        print(json.dumps({"gait": arguments.gait, "starts": plain, "meshes": convergence, "verdict": verdict}))
        return
    cells = [
        (f"{row['seed']}", f"{row['seconds']:.1f}", row["reason"], "", "", "")
        if row["reason"]
        else (
            f"{row['seed']}",
            f"{row['seconds']:.1f}",
            f"{row['iterations']}",
            f"{row['objective']:.8f}",
            f"{row['residual']:.0e}",
            f"{row['above_best_percent']:.1e}",
        )
        for row in rows
    ]
    table(("seed", "CPU [s]", "iterations, fine mesh", "objective", "residual", "above the best [%]"), cells)
    print()
    table(
        ("intervals a phase", "objective", "from the finest [%]", "iterations", "CPU [s]"),
        [
            (
                f"{row['intervals']}",
                f"{row['objective']:.8f}",
                f"{100.0 * (row['objective'] / convergence[-1]['objective'] - 1.0):+.1e}",
                f"{row['iterations']}",
                f"{row['seconds']:.1f}",
            )
            for row in convergence
        ],
    )
    print(f"\n{verdict}")


if __name__ == "__main__":
    main()
