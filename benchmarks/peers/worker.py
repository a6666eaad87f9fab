"""Processes of their own: `python -m benchmarks.peers.worker first hop 64 FOLDER`, `... serve hop 4096`.

The first prints seconds until integrators are built, with heyoka's cache of compiled code in a folder, and of the same
call again. The second answers each line on stdin with the seconds of one call.
"""

from __future__ import annotations

import sys
import time
from functools import partial

from benchmarks.peers.task import Task, bound, hop
from spear_pin.hybrid.batch import simulate_many

TASKS = {"hop": hop, "bound": bound, "bound unrolled": bound}


def call(task: Task, unroll: bool | None = None) -> float:
    """Wall seconds of one call with all lanes."""
    begin = time.perf_counter()
    simulate_many(task.gait.system, task.q, task.v, unroll=unroll)
    return time.perf_counter() - begin


def loop() -> float:
    """Wall seconds of a loop of plain Python."""
    begin = time.perf_counter()
    for i in range(10**7):
        i * i
    return time.perf_counter() - begin


def first(name: str, lanes: str, folder: str) -> None:
    import heyoka as hy

    hy.llvm_state.set_diskcache_path(folder)
    task = TASKS[name](int(lanes))
    unroll = True if name.endswith("unrolled") else None
    print(call(task, unroll), call(task, unroll))


def serve(name: str, lanes: str) -> None:
    again = partial(call, TASKS[name](int(lanes))) if name in TASKS else loop
    again()
    print("ready", flush=True)
    for _ in sys.stdin:
        print(again(), flush=True)


if __name__ == "__main__":
    {"first": first, "serve": serve}[sys.argv[1]](*sys.argv[2:])
