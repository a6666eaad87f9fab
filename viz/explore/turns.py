"""Whose question is computed next."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition

WAITING = 8  # questions that may wait, each of another client
PATIENCE = 10.0  # s that a question may wait


class Superseded(Exception):
    """Its client has asked something newer."""


class Overloaded(Exception):
    """Too many wait, and newer questions come first; or it has waited too long."""


class Turns:
    """Gives one question at a time its turn, for compiled integrators have one state; the newest comes first.

    Of each client only the newest question waits, and of all clients only the newest few.

    Args:
        waiting: how many questions may wait.
        patience: how long one may wait, in s.
    """

    def __init__(self, waiting: int = WAITING, patience: float = PATIENCE) -> None:
        self._changed, self._busy, self._ended = Condition(), False, False
        self._most, self._patience = waiting, patience
        self._waiting: dict[str, object] = {}  # the newest last
        self._refused: set[object] = set()

    @contextmanager
    def turn(self, client: str) -> Iterator[None]:
        """Wait for a turn, and have it.

        Raises:
            Superseded: the client asks for another one meanwhile.
            Overloaded: others asked later and leave no room, or the turn does not come in time.
        """
        with self._changed:
            self._wait(client, object())
            self._busy = True
        try:
            yield
        finally:
            with self._changed:
                self._busy = False
                self._changed.notify_all()

    def _wait(self, client: str, own: object) -> None:
        waiting = self._waiting
        waiting.pop(client, None)
        waiting[client] = own
        if len(waiting) > self._most:
            self._refused.add(waiting.pop(next(iter(waiting))))
        self._changed.notify_all()

        def is_decided() -> bool:
            is_next = not self._busy and next(reversed(waiting.values()), None) is own
            return self._ended or is_next or waiting.get(client) is not own

        decided = self._changed.wait_for(is_decided, self._patience)
        is_newest = waiting.get(client) is own
        if is_newest:
            del waiting[client]
        if self._ended or not decided or own in self._refused:
            self._refused.discard(own)
            raise Overloaded
        if not is_newest:
            raise Superseded

    def end(self) -> None:
        """Wait for the present turn, and give none any more."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._busy)
