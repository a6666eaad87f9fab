"""Connections to a server: their largest number, how long a client may keep one, and how they end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from socket import SHUT_RD, SHUT_WR, socket
from threading import Condition
from time import monotonic

PIECE = 2**16  # bytes that are dropped at once


class Connections:
    """Bounds the number of connections, and the time for which each waits for its client.

    Args:
        most: largest number at once.
        patience: time for which a connection waits for the client's request, and then for its end, in s.
    """

    def __init__(self, most: int, patience: float) -> None:
        self._changed, self._most, self._patience = Condition(), most, patience
        self._until: dict[socket, float] = {}  # when its client has to be done; the oldest first

    def admit(self, connection: socket) -> None:
        """Admits a connection; where there is no room, the oldest that waits for its client is ended."""
        with self._changed:
            while len(self._until) >= self._most:
                self._stop([each for each, until in self._until.items() if 0.0 < until < math.inf][:1])
                self._changed.wait(0.1)
            self._until[connection] = monotonic() + self._patience

    def stop_clock(self, connection: socket) -> bool:
        """Stops the wait for the client's request; returns whether it came in time."""
        with self._changed:
            in_time = monotonic() < self._until[connection]
            self._until[connection] = math.inf
        return in_time

    def end_late(self) -> None:
        """Stops waiting for clients that take too long."""
        with self._changed:
            self._stop([each for each, until in self._until.items() if until <= monotonic()])

    def end(self, connection: socket) -> None:
        """Ends a connection without a reset: further data of the client is dropped until it ends as well."""
        with self._changed:
            self._until[connection] = monotonic() + self._patience
        dropped = bytearray(PIECE)
        with suppress(OSError):
            connection.shutdown(SHUT_WR)
            while connection.recv_into(dropped):
                pass
        with self._changed:
            del self._until[connection]
            self._changed.notify_all()

    def _stop(self, connections: Sequence[socket]) -> None:
        """Lets the threads that wait for these clients read the end."""
        for connection in connections:
            self._until[connection] = 0.0
            with suppress(OSError):
                connection.shutdown(SHUT_RD)
