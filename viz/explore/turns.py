"""Order in which questions are computed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition

WAITING = 8  # questions that may wait, each of another client
PATIENCE = 10.0  # s that a question may wait


class Superseded(Exception):
    """Raised when the client has asked something newer."""


class Overloaded(Exception):
    """Raised when too many questions wait, and newer ones come first, or when one has waited too long."""


class Turns:
    """Turns for one question at a time, because compiled integrators have one state; the newest comes first.

    Only the newest question of each client waits, and only the newest few of all clients.

    Args:
        waiting: largest number of waiting questions.
        patience: longest wait of a question, in s.
    """

    def __init__(self, waiting: int = WAITING, patience: float = PATIENCE) -> None:
        self._changed, self._busy, self._ended = Condition(), False, False
        self._most, self._patience = waiting, patience
        self._waiting: dict[str, object] = {}  # the newest last
        self._refused: set[object] = set()

    @contextmanager
    def turn(self, client: str) -> Iterator[None]:
        """Waits for a turn, and has it.

        Raises:
            Superseded: the client asks something newer meanwhile.
            Overloaded: later questions leave no room, or the turn does not come in time.
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
        """Waits for the present turn, and gives no more."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._busy)
