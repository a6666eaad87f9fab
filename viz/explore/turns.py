"""Whose question is computed next."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition


class Superseded(Exception):
    """Its client has asked something newer."""


class Turns:
    """One computation at a time, for compiled integrators have one state; of each client only the newest waits."""

    def __init__(self) -> None:
        self._changed, self._busy = Condition(), False
        self._newest: dict[str, object] = {}

    @contextmanager
    def turn(self, client: str) -> Iterator[None]:
        """Wait for a turn, and have it.

        Raises:
            Superseded: the client asks for another one meanwhile.
        """
        own = object()
        with self._changed:
            self._newest[client] = own
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._busy or self._newest.get(client) is not own)
            if self._newest.get(client) is not own:
                raise Superseded
            del self._newest[client]
            self._busy = True
        try:
            yield
        finally:
            with self._changed:
                self._busy = False
                self._changed.notify_all()

    def end(self) -> None:
        """Wait for the present turn, and give none any more."""
        with self._changed:
            self._changed.wait_for(lambda: not self._busy)
            self._busy = True
