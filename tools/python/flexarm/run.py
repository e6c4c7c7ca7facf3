"""A run that the daemon has begun: how far it is, its end, its log."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Protocol

from .connection import Answer
from .errors import ExportFailed, FlexarmError, RunNotCompleted, TimedOut
from .run_data import RunData, read_run
from .status import RunState, Status

MARGIN_S = 30.0  # beyond the duration: the arm is brought to rest within 3 s, and machines are slow
UNKNOWN_DURATION_S = 120.0  # of a motion that ends when it has found something
LOG_S = 10.0  # a log is closed 1 s after the end of its run


class Operator(Protocol):
    """What a run needs of a daemon."""

    def stop(self) -> Answer: ...

    def statuses(self, every_s: float = ...) -> Iterator[Status]: ...

    def run_ended(self) -> None: ...

    def stop_after(self, error: BaseException) -> None: ...


class Run:
    """A run of `Daemon.run`. Used in a with-block, it is stopped if an exception leaves the block,
    which a note of the exception says; a block that ends otherwise leaves the run alone."""

    def __init__(self, daemon: Operator, number: int, log_before: Path | None) -> None:
        """@param log_before: the log that was written before the run began"""
        self.number = number
        self._daemon = daemon
        self._log_before = log_before
        self._log_file: Path | None = None

    def __enter__(self) -> Run:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if error is not None:
            self._daemon.stop_after(error)

    def follow(self, every_s: float = 0.1) -> Iterator[RunState]:
        """How far the run is, every `every_s` until it is over; the last one says how it ended.

        @raises FlexarmError: another run has begun. Without its own end, the daemon's end is
        ConnectionLost.
        """
        for status in self._daemon.statuses(every_s):
            state = self._state(status)
            yield state
            if state.over:
                return

    def wait(self, within_s: float | None = None) -> RunState:
        """Waits until the run is over and the arm is at rest.

        @param within_s: None: 30 s longer than the experiment
        @raises RunNotCompleted: it was stopped or tripped
        @raises TimedOut: it is not over; it goes on
        """
        began_s = time.monotonic()
        for state in self.follow():
            if state.over and state.outcome != "done":
                raise RunNotCompleted(state)
            longest_s = within_s
            if longest_s is None:
                longest_s = (state.duration_s or UNKNOWN_DURATION_S) + MARGIN_S
            if not state.over and time.monotonic() - began_s > longest_s:
                raise TimedOut(f"run {self.number} is not over after {longest_s} s",
                               "it goes on: stop it, or wait again")
        return state

    def stop(self) -> Answer:
        """Ends the run: the controller brings the arm to rest. `wait` says when it is."""
        return self._daemon.stop()

    def log_file(self, within_s: float = LOG_S) -> Path:
        """The log of the run. The daemon tells it from 0.2 s after the begin of the run until 1 s
        after its end: `follow`, `wait` or this must have been called in that time. It is relative to the
        daemon's folder if the daemon was started with such a --log-dir.

        @raises TimedOut: it does not tell it
        """
        end_s = time.monotonic() + within_s
        for status in self._daemon.statuses():
            if self._log_file is None:
                self._state(status)
            if self._log_file is not None:
                return self._log_file
            if time.monotonic() > end_s:
                break
        raise TimedOut(f"the daemon does not name the log of run {self.number}",
                       "`flexarm runs --last 1` does, if the daemon keeps logs")

    def data(self, within_s: float = LOG_S, *, with_raw: bool = False,
             program: str | Path = "flexarm") -> RunData:
        """Waits until the log is closed, and reads it: see `read_run`.

        @param within_s: for the log. @raises TimedOut: it is not closed
        """
        file = self.log_file(within_s)
        end_s = time.monotonic() + within_s
        for status in self._daemon.statuses():
            if status.log_file != file:
                break
            if time.monotonic() > end_s:
                raise TimedOut(f"{file} is not closed within {within_s} s", "wait for the run")
        if not file.exists():
            raise ExportFailed(f"{file} is not here",
                               "a path that is not absolute is relative to the daemon's folder: give "
                               "it an absolute --log-dir, or start this program there")
        return read_run(file, with_raw=with_raw, program=program)

    def _state(self, status: Status) -> RunState:
        state = status.run
        if state is None or state.number != self.number:
            self._daemon.run_ended()
            raise FlexarmError(f"another run has begun since run {self.number}",
                               "how this one ended is in its log")
        if status.log_file != self._log_before and status.log_file is not None:
            self._log_file = status.log_file
        if state.over:
            self._daemon.run_ended()
        return state
