"""Requests of lanes for motions, so that those of lanes in the same domain are integrated side by side.

A lane is a generator: it yields a request for the motion that it needs next, and is sent where that motion ended.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterable
from typing import NamedTuple, TypeVar

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.engines.polynomials import Polynomials
from spear_pin.hybrid.engines.taylor_single import Single


class Request(NamedTuple):
    """A motion in a domain up to its first event, or up to a time.

    Attributes:
        single: the domain, compiled.
        t: time at which it begins, in s since the phase began.
        y: state at that time, (2 nv,).
        until: latest time at which it ends, in s.
        parameters: run-time parameters.
    """

    single: Single
    t: float
    y: Array
    until: float
    parameters: Array


class Reply(NamedTuple):
    """Where a motion ended.

    Attributes:
        t: time of its end, in s since the phase began.
        y: state at that time, (2 nv,).
        end: the guard's index, or `taylor.TIME_LIMIT`, `KINK` or `FAILED`.
        motion: the motion, if it is kept.
    """

    t: float
    y: Array
    end: int
    motion: Polynomials | None = None


T = TypeVar("T")
Requests = Generator[Request, Reply, T]


def answer_alone(lane: Requests[T], longest: float = math.inf, *, keep: bool = False) -> T:
    """Integrates each motion that one lane requests; returns what the lane returns.

    Args:
        lane: the lane.
        longest: longest step, in s.
        keep: whether motions are kept.
    """
    try:
        request = next(lane)
        while True:
            request = lane.send(_integrate(request, longest, keep=keep))
    except StopIteration as over:
        found: T = over.value
        return found


def answer_together(lanes: Iterable[Requests[None]], longest: float) -> None:
    """Runs many lanes to their ends, and integrates those that wait in the same domain side by side.

    What a lane does between its requests holds up the others; a mistake in its functions ends them all.

    Args:
        lanes: the lanes.
        longest: longest step, in s.
    """
    waiting: dict[int, list[tuple[Requests[None], Request]]] = {}

    def wait(lane: Requests[None], reply: Reply | None) -> None:
        try:
            request = next(lane) if reply is None else lane.send(reply)
        except StopIteration:
            return
        waiting.setdefault(id(request.single), []).append((lane, request))

    for lane in lanes:
        wait(lane, None)
    while waiting:
        group = waiting.pop(max(waiting, key=lambda each: len(waiting[each])))  # so that registers fill up
        for (lane, _), reply in zip(group, _integrate_all([request for _, request in group], longest), strict=True):
            wait(lane, reply)


def _integrate(request: Request, longest: float, *, keep: bool) -> Reply:
    single, t, y, until, parameters = request
    return Reply(*single.run(t, y, until, parameters, longest, keep=keep))


def _integrate_all(requests: list[Request], longest: float) -> list[Reply]:
    """Integrates requests in the same domain."""
    ready, n = requests[0].single.ready, len(requests)
    t, y = np.array([each.t for each in requests]), np.array([each.y for each in requests]).T
    until, parameters = np.array([each.until for each in requests]), np.array([each.parameters for each in requests]).T
    times, states, ends = ready.run(t, y, until, parameters, longest)
    return [Reply(float(times[i]), states[:, i].copy(), int(ends[i])) for i in range(n)]
