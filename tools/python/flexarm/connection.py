"""A connection to the operator socket of the daemon: a line there, a line back."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
import time
from typing import Any

from .errors import CommandFailed, ConnectionLost, ProtocolError, Refused, TimedOut

MAX_ANSWER_BYTES = 4 << 20
CONNECT_S = 5.0

Answer = dict[str, Any]


class Connection:
    """One connection. Threads may share it: their commands are sent one after the other.

    Whatever breaks a command off, an exception of the caller too, closes the connection, as its
    answer would be mistaken for that of the next command. It is never opened again by itself.
    """

    def __init__(self, path: str) -> None:
        """@raises ConnectionLost: no daemon listens there, or this user may not connect."""
        self.path = path
        self._received = bytearray()
        self._turn = threading.Lock()
        self._socket: socket.socket | None = None
        peer = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            peer.settimeout(CONNECT_S)
            peer.connect(path)
        except OSError as error:
            peer.close()
            raise ConnectionLost(f"{path}: no daemon answers ({error})",
                                 "start flexarmd, or name its socket") from error
        self._socket = peer

    def close(self) -> None:
        """Ends the connection, also one on which another thread waits. The daemon carries out what
        it has accepted, but for a run that it still plans."""
        peer, self._socket = self._socket, None
        if peer is not None:
            with contextlib.suppress(OSError):
                peer.shutdown(socket.SHUT_RDWR)  # wakes who waits for an answer
            peer.close()

    def ask(self, command: Answer, within_s: float) -> Answer:
        """Sends a command and returns its answer, whose "ok" is true.

        @param within_s: for the answer
        @raises Refused, CommandFailed: "ok" is false
        @raises ConnectionLost, TimedOut, ProtocolError: there is no answer
        """
        name = str(command["command"])
        with self._turn:
            try:
                answer = self._parsed(name, self._exchange(name, command, within_s))
            except BaseException:
                self.close()
                raise
        if answer.get("ok") is True:
            return answer
        if "state" not in answer:  # the daemon closes this connection, and says why
            self.close()
        if isinstance(answer.get("refusal"), str):
            raise Refused(name, answer)
        raise CommandFailed(name, answer)

    def _exchange(self, name: str, command: Answer, within_s: float) -> bytes:
        end_s = time.monotonic() + within_s
        peer = self._socket
        if peer is None:
            raise ConnectionLost(f"{name}: this connection has ended", "connect again")
        problem: OSError | None = None
        try:
            peer.settimeout(within_s)
            peer.sendall(json.dumps(command).encode() + b"\n")
        except TimeoutError:
            raise TimedOut(f"{name}: the daemon took no command within {within_s} s") from None
        except OSError as error:  # the daemon has closed it, and may have said why
            problem = error
        while b"\n" not in self._received:
            chunk = self._chunk(peer, name, end_s, within_s, problem)
            self._received += chunk
            if len(self._received) > MAX_ANSWER_BYTES:
                raise ProtocolError(f"{name}: the answer is too long to be one of a daemon")
        line, _, rest = bytes(self._received).partition(b"\n")
        self._received = bytearray(rest)
        return line

    @staticmethod
    def _chunk(peer: socket.socket, name: str, end_s: float, within_s: float,
               problem: OSError | None) -> bytes:
        left_s = end_s - time.monotonic()
        try:
            peer.settimeout(max(left_s, 1e-3))
            chunk = peer.recv(1 << 16)
        except TimeoutError:
            raise TimedOut(f"{name}: no answer of the daemon within {within_s} s",
                           "connect again, and look at the status") from None
        except OSError as error:
            raise ConnectionLost(f"{name}: the connection was lost ({error})") from error
        if chunk:
            return chunk
        told = f" ({problem})" if problem else ""
        raise ConnectionLost(f"{name}: the daemon has ended, or closed the connection{told}",
                             "connect again, and look at the status")

    @staticmethod
    def _parsed(name: str, line: bytes) -> Answer:
        try:
            answer = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise ProtocolError(f"{name}: the answer is not JSON ({error})") from error
        if not isinstance(answer, dict):
            raise ProtocolError(f"{name}: the answer is not an object")
        if answer.get("command", name) != name:
            raise ProtocolError(f"{name}: the answer is that of {answer['command']!r}")
        return answer
