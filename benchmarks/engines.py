"""Speed of the engines and of their peers on the same motions: `python -m benchmarks.engines`, Markdown on stdout.

Every lane first computes a few hops or strides that are compared with the reference engine's at an rtol of 1e-12, then
all are timed in turn, round by round, in a new order each: CPU time on one core, medians over the rounds, ratios within
a round. Peers that are not installed are named with the reason. `--only batch` measures what a first use costs and what
a second process brings.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.metadata
import json
import os
import platform
import random
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import Any

from benchmarks.markdown import table
from benchmarks.peers import lean_stride
from benchmarks.peers.task import (
    AGREES,
    CHECKED,
    FINEST,
    STATES,
    Absent,
    Lane,
    Task,
    bound,
    bound_on,
    hop,
    reference,
    taylor,
)
from spear_pin.hybrid.engines.taylor import available, width

SIZES = {"hop": (1, STATES, 64, 512, 4096), "bound": (1, STATES, 64, 512)}  # lanes; few are run one by one
LONG = 20  # cycles of lanes that go on, so that a call's own cost is shared
FIRST = (STATES, 64)  # lanes of a first use: one by one, and a batch
PEERS = ("lean_loop", "pinocchio_cpp", "mujoco_exact", "mujoco_native", "drake_hop")
ENOUGH = 0.2  # s: that a lane is run for in a round, or once
PACKAGES = ("numpy", "scipy", "pin", "heyoka", "mujoco", "drake")
Row = dict[str, Any]


def hop_lanes(task: Task) -> tuple[list[Lane], list[str]]:
    """Everything that hops, the yardstick first, and why some is missing."""
    lanes, missing = [], []
    for peer in PEERS:
        try:
            lanes += importlib.import_module(f"benchmarks.peers.{peer}").lanes(task)
        except Absent as reason:
            missing.append(f"{peer}: {reason}")
    lanes += [reference(task, 1e-8), reference(task, 1e-9), reference(task, 1e-9, sampled=True)]
    if available():
        lanes += [taylor(task, size, 1e-9) for size in SIZES["hop"][:-1]]
        for rtol in (1e-9, 1e-7, 1e-4):  # all are at least as accurate as the yardstick
            lanes += [taylor(task, STATES, rtol, cycles=LONG), taylor(task, SIZES["hop"][-1], rtol)]
    else:
        missing.append("simulate_many: heyoka is not installed")
    return lanes, missing


def stride_lanes() -> list[tuple[Lane, Task]]:
    """Everything that bounds, the yardstick first, each with its task."""
    off = bound(SIZES["bound"][-1])
    lanes = [(lane, off) for lane in lean_stride.lanes(off)]
    lanes += [(reference(off, rtol), off) for rtol in (1e-8, 1e-9)]
    for task in (off, bound_on(SIZES["bound"][-1])) if available() else ():
        where = "" if task is off else "outputs at zero"
        lanes += [(taylor(task, size, 1e-9, where), task) for size in SIZES["bound"]]
        lanes += [(taylor(task, STATES, 1e-9, where, cycles=LONG), task)]
        lanes += [(taylor(task, STATES, 1e-9, where, cycles=LONG, unroll=True), task)]
        lanes += [(taylor(task, SIZES["bound"][-1], 1e-9, where, unroll=True), task)]
        lanes += [(taylor(task, SIZES["bound"][-1], 1e-11, where), task)]
    return lanes


def measure(lanes: list[tuple[Lane, Task]], rounds: int) -> list[Row]:
    """Agreement, then time; the first lane is what the others are compared with."""
    rows, calls = [], []
    for lane, task in lanes:
        error = task.error((lane.first or lane.call)())
        calls.append(max(1, round(ENOUGH / max(lane.seconds(1), 1e-6))))
        rows.append({"name": lane.name, "settings": lane.settings, "note": lane.note(), "error": error})
    samples: list[list[float]] = [[] for _ in lanes]
    order, shuffle = list(range(len(lanes))), random.Random(0).shuffle
    for n in range(rounds):
        shuffle(order)
        for i in order:
            lane = lanes[i][0]
            samples[i].append(lane.seconds(calls[i]) / calls[i] / lane.cycles)
        print(f"round {n + 1} of {rounds}", file=sys.stderr)
    for row, own in zip(rows, samples, strict=True):
        ratios = [first / second for first, second in zip(samples[0], own, strict=True)]
        row |= {"ms": 1e3 * statistics.median(own), "ms_min": 1e3 * min(own), "ms_max": 1e3 * max(own)}
        row |= {"times_faster": statistics.median(ratios), "agrees": bool(row["error"] <= AGREES)}
    return rows


@contextmanager
def one_core() -> Iterator[None]:
    """This process and those it starts stay on one core, where the system knows how."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def worker(*given: str) -> list[str]:
    return [sys.executable, "-m", "benchmarks.peers.worker", *given]


def first_use(rounds: int) -> list[Row]:
    """Seconds until the integrators are ready: compiled anew, and read from heyoka's cache."""
    rows = []
    for name, lanes in (*product(SIZES, FIRST), ("bound unrolled", STATES)):
        seconds: dict[str, list[float]] = {"compiled": [], "cached": []}
        for _ in range(rounds):
            with tempfile.TemporaryDirectory() as folder:
                for kind in seconds:
                    command = worker("first", name, str(lanes), folder)
                    out = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
                    seconds[kind].append(float(out[0]) - float(out[1]))
        rows.append({"name": name, "lanes": lanes} | {kind: statistics.median(own) for kind, own in seconds.items()})
    return rows


def two_processes(rounds: int) -> list[Row]:
    """Cycles a second of one process, and of two at the same time; of plain Python, too: what the machine allows."""
    rows = []
    for name, size in [("plain Python", 1), *((name, sizes[-1]) for name, sizes in SIZES.items())]:
        pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        workers = [subprocess.Popen(worker("serve", name, str(size)), **pipes) for _ in range(2)]
        rates: dict[int, list[float]] = {1: [], 2: []}
        for process in workers:
            process.stdout.readline()
        for _ in range(rounds):
            for count in rates:
                for process in workers[:count]:
                    print(file=process.stdin, flush=True)
                slowest = max(float(process.stdout.readline()) for process in workers[:count])
                rates[count].append(count * size / slowest)
        for process in workers:
            process.stdin.close()
            process.wait()
        gains = [two / one for one, two in zip(rates[1], rates[2], strict=True)]
        row = {"name": name, "lanes": size, "gain": statistics.median(gains)}
        rows.append(row | {"one": statistics.median(rates[1]), "two": statistics.median(rates[2])})
    return rows


def machine() -> Row:
    """Processor, vector width, load and versions."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.is_file() else []
    found = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    versions = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return {
        "processor": found.get("model name", platform.processor()),
        "cores": os.cpu_count(),
        "avx512": "avx512f" in found.get("flags", "").split(),
        "doubles_a_vector": width() if available() else None,
        "load": list(os.getloadavg()) if hasattr(os, "getloadavg") else None,
        "versions": versions,
    }


def show(unit: str, rows: list[Row]) -> None:
    """The table of a task."""
    cells = [
        (
            row["name"] + (f" ({row['note']})" if row["note"] else ""),
            row["settings"],
            f"{row['ms']:.3g}",
            f"{row['times_faster']:.3g}",
            f"{row['error']:.0e}" + ("" if row["agrees"] else ", does not agree"),
        )
        for row in rows
    ]
    table(("computed by", "settings", f"ms a {unit}", "times the speed of the first", "error at the end"), cells)


def main() -> None:
    """Measure, and print Markdown or JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--only", choices=("hop", "bound", "batch"), help="one part instead of all")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    given = parser.parse_args()
    parts = (given.only,) if given.only else ("hop", "bound", "batch")
    results: Row = {"machine": machine(), "rounds": given.rounds, "agreement": {"rtol": FINEST, "states": CHECKED}}
    with one_core():
        if "hop" in parts:
            task = hop(SIZES["hop"][-1])
            lanes, results["missing"] = hop_lanes(task)
            results["hop"] = measure([(lane, task) for lane in lanes], given.rounds)
        if "bound" in parts:
            results["bound"] = measure(stride_lanes(), given.rounds)
    if "batch" in parts and available():
        results["first_use"] = first_use(min(given.rounds, 3))
        results["two_processes"] = two_processes(given.rounds)
    results["machine"]["load_after"] = machine()["load"]
    if given.json:
        print(json.dumps(results, indent=1))
        return
    about = results["machine"]
    named = ", ".join(f"{name} {version}" for name, version in about["versions"].items())
    print(f"{about['processor']}, {about['cores']} cores, {about['doubles_a_vector']} doubles a vector; {named}\n")
    for part, unit in (("hop", "hop"), ("bound", "stride")):
        if part in results:
            show(unit, results[part])
    for reason in results.get("missing", ()):
        print(f"Not measured: {reason}.\n")
    if "first_use" in results:
        uses = [
            (row["name"], str(row["lanes"]), f"{row['compiled']:.2f}", f"{row['cached']:.2f}")
            for row in results["first_use"]
        ]
        table(("first use", "lanes", "compiled [s]", "from the cache [s]"), uses)
        pairs = [
            (row["name"], str(row["lanes"]), f"{row['one']:.3g}", f"{row['two']:.3g}", f"{row['gain']:.2f}")
            for row in results["two_processes"]
        ]
        table(("cycles a second", "lanes", "one process", "two", "gain"), pairs)


if __name__ == "__main__":
    main()
