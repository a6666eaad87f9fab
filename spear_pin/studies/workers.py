"""Work in several processes, or on a Dask cluster, by joblib."""

from __future__ import annotations

import signal
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from spear_pin.errors import import_extra

Answer = TypeVar("Answer")


def each(
    function: Callable[..., Answer], arguments: Iterable[tuple[Any, ...]], n_jobs: int | None, purpose: str
) -> Iterator[Answer]:
    """Yields what a function returns for each argument, as soon as it is there, in any order.

    Args:
        function: a function of a module, because it goes to other processes.
        arguments: arguments of each call.
        n_jobs: number of processes, 1 for this one; None: that of `joblib.parallel_config`, in which a Dask cluster can
            be named, else one.
        purpose: what needs joblib, in words.

    Raises:
        MissingExtra: joblib is not installed.
    """
    if n_jobs == 1:
        return (function(*each) for each in arguments)
    joblib = import_extra("joblib", "sweep", purpose)
    tasks = (joblib.delayed(function)(*each) for each in arguments)
    # one call a task, so that each answer is there as soon as it can be
    pool = joblib.Parallel(n_jobs=n_jobs, batch_size=1, return_as="generator_unordered", max_nbytes=None)
    with _uninterrupted():
        answers: Iterator[Answer] = pool(tasks)
    return _quietly(answers)


def _quietly(answers: Iterator[Answer]) -> Iterator[Answer]:
    """Yields answers without joblib's complaint about a worker that it replaces, as it does when memory grows."""
    while True:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
            try:
                answer = next(answers)
            except StopIteration:
                return
        yield answer


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Makes workers that start meanwhile leave Ctrl-C to this process, which ends them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
