"""Stops a run when an exception leaves its with-block, and says so."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Protocol

from .connection import Answer
from .errors import FlexarmError, Refused
from .status import Status

REST_S = 10.0  # the controller takes at most 3 s


class Stoppable(Protocol):
    """What can be stopped and watched."""

    def stop(self) -> Answer: ...

    def wait_for(self, condition: Callable[[Status], bool], within_s: float) -> Status: ...


def stop_after(daemon: Stoppable, error: BaseException) -> None:
    """What became of the run is a note of `error`, and a warning of the logger `flexarm`, because
    the caller may catch `error`."""
    told = _stop(daemon)
    error.add_note(f"flexarm: {told}")
    logging.getLogger("flexarm").warning("%s left a with-block: %s", type(error).__name__, told)


def _stop(daemon: Stoppable) -> str:
    try:
        daemon.stop()
    except Refused as refused:
        return f"no run was stopped: {refused}"
    except FlexarmError as problem:
        return f"THE RUN WAS NOT STOPPED: {problem}; stop it: flexarm stop, or the emergency stop"
    try:
        last = daemon.wait_for(lambda status: status.run is None or status.run.over, REST_S)
    except FlexarmError as problem:
        return f"the run was told to stop; whether the arm is at rest is not known: {problem}"
    return f"the run was told to stop; it is {last.run.outcome if last.run else 'over'}"
