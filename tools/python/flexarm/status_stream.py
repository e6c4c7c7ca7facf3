"""Status after status, on a connection of its own, so that no command delays it."""

from __future__ import annotations

import time
from collections.abc import Iterator

from .connection import Connection
from .errors import ProtocolError
from .status import Status

PROTOCOL = 1
STATUS_S = 5.0  # for an answer
SHORTEST_PERIOD_S = 0.01  # the daemon looks into its socket that often


def ask_status(connection: Connection) -> Status:
    """One status. @raises as Connection.ask, and ProtocolError: another version of the protocol"""
    asked_s = time.monotonic()
    values = connection.ask({"command": "status"}, STATUS_S)
    if values.get("protocol") != PROTOCOL:
        connection.close()
        raise ProtocolError(f"{connection.path}: the daemon speaks protocol "
                            f"{values.get('protocol')!r}, this client {PROTOCOL}",
                            "use the client that was installed with the daemon")
    return Status(values, asked_s)


def status_stream(path: str, every_s: float) -> Iterator[Status]:
    """A status at once, and then every `every_s`, until its caller ends it.

    Instants that have passed while the caller was busy are left out.
    @raises ValueError: `every_s` is below SHORTEST_PERIOD_S
    """
    if not every_s >= SHORTEST_PERIOD_S:
        raise ValueError(f"every_s is {every_s}, at least {SHORTEST_PERIOD_S} is expected")
    return _stream(path, every_s)


def _stream(path: str, every_s: float) -> Iterator[Status]:
    connection = Connection(path)
    try:
        due_s = time.monotonic()
        while True:
            yield ask_status(connection)
            due_s = max(due_s + every_s, time.monotonic())
            time.sleep(max(due_s - time.monotonic(), 0.0))
    finally:
        connection.close()
