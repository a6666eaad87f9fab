"""Make every call, or those whose names contain the words that are given, and list what is answered badly."""

from __future__ import annotations

import multiprocessing as mp
import resource
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import chain
from multiprocessing.connection import Connection
from pathlib import Path
from time import monotonic

from tests.wrong_calls import commands, files, functions, processes, words
from tests.wrong_calls.case import LONGEST, Case, judged

WORKERS = 2
MEMORY = 2 * 2**30  # bytes
KINDS = {"command lines": commands, "words": words, "files": files, "Python": functions, "processes": processes}
PATIENCE = 5 * LONGEST  # s until a call that nothing interrupts is ended with its worker


def everything() -> list[tuple[str, Case]]:
    """All cases with what they are about; no two have the same name."""
    found = [(kind, case) for kind, module in KINDS.items() for case in module.cases()]
    names = Counter(case.name for _, case in found)
    assert names.most_common(1)[0][1] == 1, names.most_common(5)
    return found


Make = Callable[[], list[tuple[str, Case]]]


def main(parts: Sequence[str] = (), make: Make = everything, memory: int = MEMORY, what: str = "wrong calls") -> int:
    """Make the calls; 1 if one of them is answered badly.

    Args:
        parts: of the names of those that are made; without any all are.
        make: makes the cases.
        memory: that none may take more than, in bytes.
        what: the cases are, in words.
    """
    begun = monotonic()
    cases = make()
    chosen = [
        i for i, (kind, case) in enumerate(cases) if not parts or any(part in f"{kind} {case.name}" for part in parts)
    ]
    shares = [chosen[n::WORKERS] for n in range(WORKERS)]
    with ThreadPoolExecutor(WORKERS) as pool:
        bad = dict(
            chain.from_iterable(
                found.items() for found in pool.map(partial(answered_badly, make=make, memory=memory), shares)
            )
        )
    for i, problem in sorted(bad.items()):
        print(f"{cases[i][0]:<14} {cases[i][1].name[:110]}\n{'':<14} {problem}")
    counts = Counter(cases[i][0] for i in chosen)
    told = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    print(f"{len(chosen)} {what} ({told}), {len(bad)} answered badly, {monotonic() - begun:.0f} s")
    return 1 if bad else 0


def answered_badly(share: Sequence[int], make: Make = everything, memory: int = MEMORY) -> dict[int, str]:
    """What is wrong with these cases, in a process that is started anew where one of them ends or stops it."""
    bad: dict[int, str] = {}
    left = list(share)
    context = mp.get_context("spawn")
    while left:
        ours, theirs = context.Pipe()
        worker = context.Process(target=_work, args=(theirs, left, make, memory))
        worker.start()
        theirs.close()
        while left:
            try:
                if not ours.poll(PATIENCE):
                    bad[left.pop(0)] = f"nothing after {PATIENCE:.0f} s"
                    break
                problem = ours.recv()
            except EOFError:
                bad[left.pop(0)] = "it ends the process"
                break
            if problem:
                bad[left[0]] = problem
            left.pop(0)
        worker.join(0.0 if left else 5.0)
        worker.kill()
        worker.join()
    return bad


def _work(results: Connection, share: Sequence[int], make: Make, memory: int) -> None:
    cases = make()
    resource.setrlimit(resource.RLIMIT_DATA, (2 * memory, resource.getrlimit(resource.RLIMIT_DATA)[1]))
    for i in share:
        case = cases[i][1]
        children = _of_children()
        Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
        problem, _ = judged(case)
        peak = max(_peak(), now if (now := _of_children()) > children else 0)
        if not problem and peak > memory:
            problem = f"it takes {peak / 2**30:.1f} GB"
        results.send(problem)


def _peak() -> int:
    """Most memory that this process has had since its peak began anew, in bytes."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def _of_children() -> int:
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
