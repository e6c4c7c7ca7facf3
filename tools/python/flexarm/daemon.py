"""The commands of docs/protocol.md, as methods."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

from .connection import Answer, Connection
from .errors import FlexarmError, ProtocolError, Refused, TimedOut
from .run import Run
from .status import Status
from .status_stream import ask_status, status_stream
from .stop_after import stop_after

DEFAULT_SOCKET = "/run/flexarm/flexarmd.sock"

# For an answer. As the program flexarm waits: a check of the host takes 3 s, the tests of the power
# path as long again; thousands of moves are planned in 60 s; the channels are read for some time.
ANSWER_S = 5.0
ARM_S = 10.0
RUN_S = 60.0
COMMISSION_S = 120.0
STOP_TRIES = 50  # a crowd of clients can close this one before it is heard


def connect(socket: str | Path | None = None) -> Daemon:
    """Connects to a daemon, and arms and moves nothing.

    @param socket: None: that of the variable FLEXARM_SOCKET, else the one of the service
    @raises ConnectionLost, Refused: no daemon, or this user may not ask it
    """
    return Daemon(str(socket or os.environ.get("FLEXARM_SOCKET") or DEFAULT_SOCKET))


class Daemon:
    """A connection to a daemon. Every method waits for its answer for a limited time, and raises
    what connection.Connection.ask raises.

    Used in a with-block, it is closed at the end. If an exception leaves the block, the run that it
    began and that is not over is stopped, which a note of the exception says. Otherwise closing
    ends no run and opens no relay. Threads may share it; `stop` and statuses wait for none.
    """

    def __init__(self, socket: str) -> None:
        self._path = socket
        self._connection = Connection(socket)
        self._has_begun_run = False
        try:
            self.status()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Daemon:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        try:
            if error is not None:
                self.stop_after(error)
        finally:
            self.close()

    def close(self) -> None:
        """Ends the connection and nothing else, but the planning of a run that is not answered."""
        self._connection.close()

    # What it tells.

    def status(self) -> Status:
        return ask_status(self._connection)

    def statuses(self, every_s: float = 0.1) -> Iterator[Status]:
        """A status at once and then every `every_s`, at least 0.01 s, on a connection of its own,
        until the caller ends it: `age_s` says how old each is. Without end: leave the loop."""
        return status_stream(self._path, every_s)

    def wait_for(self, condition: Callable[[Status], bool], within_s: float,
                 every_s: float = 0.1) -> Status:
        """The first status for which `condition` is true. @raises TimedOut"""
        end_s = time.monotonic() + within_s
        for status in self.statuses(every_s):
            if condition(status):
                return status
            if time.monotonic() > end_s:
                break
        raise TimedOut(f"what was waited for has not come within {within_s} s; the state is "
                       f"{status.state}")

    # What it is told.

    def arm(self, *, overrides: Mapping[str, str] | None = None, take_over: bool = False) -> Answer:
        """Closes the relay: zero torque, ready to run. Only from Idle, at rest.

        @param overrides: reasons by condition, `host` or `design`: docs/safety.md
        @param take_over: from the user who commands the arm; not while it moves
        """
        return self.ask("arm", within_s=ARM_S, take_over=take_over,
                        **({"overrides": dict(overrides)} if overrides else {}))

    def run(self, experiment: str | Path, *, name: str = "", note: str = "",
            tags: tuple[str, ...] = (), overrides: Mapping[str, str] | None = None,
            take_over: bool = False) -> Run:
        """Begins an experiment, a file. Only from Armed. @returns when it has begun: `wait` for it

        @param name, note, tags: of the run, in its log
        @param overrides: reasons by condition, `switches` or `experiment`
        @raises Refused: it is not begun; the text names row, joint, value and limit
        """
        file = Path(experiment)
        return self.run_text(file.read_text(encoding="utf-8"), file.name, name=name, note=note,
                             tags=tags, overrides=overrides, take_over=take_over)

    def run_text(self, experiment: str, file_name: str = "experiment", *, name: str = "",
                 note: str = "", tags: tuple[str, ...] = (),
                 overrides: Mapping[str, str] | None = None, take_over: bool = False) -> Run:
        """The same of the text of an experiment. @param file_name: for messages"""
        more: dict[str, Any] = {"overrides": dict(overrides)} if overrides else {}
        if name or note or tags:
            more["label"] = {"name": name, "note": note, "tags": list(tags)}
        log_before = self.status().log_file
        self._has_begun_run = True  # from here on it may begin, whatever becomes of the answer
        try:
            answer = self.ask("run", within_s=RUN_S, experiment=experiment, name=file_name,
                              take_over=take_over, **more)
        except Refused:
            self._has_begun_run = False
            raise
        if not isinstance(answer.get("run"), int):
            raise ProtocolError(f"run: its number is {answer.get('run')!r}")
        return Run(self, int(answer["run"]), log_before)

    def stop(self) -> Answer:
        """Ends the run: the controller brings the arm to rest within 3 s. On a connection of its
        own, which waits for no other command. @raises Refused: none is running"""
        for left in reversed(range(STOP_TRIES)):
            connection = Connection(self._path)
            try:
                return connection.ask({"command": "stop"}, ANSWER_S)
            except Refused as refused:
                if refused.code != "too-many-clients" or left == 0:
                    raise
            finally:
                connection.close()
        raise AssertionError("the last try returns or raises")

    def disarm(self) -> Answer:
        """Opens the relay. Only from Armed; stop first. @returns when it is open"""
        return self.ask("disarm")

    def reset(self) -> Answer:
        """Leaves Tripped for Idle. Only after the reset button, at rest, with the cause gone."""
        return self.ask("reset")

    def tare(self) -> Answer:
        """Measures the zeros of the strain channels: the links must not be bent. In Idle or
        Tripped, at rest. @returns with `strain`: a list of what was found for each channel"""
        return self.ask("tare", within_s=COMMISSION_S)

    def zero(self, angle_deg: tuple[float, float] = (0.0, 0.0)) -> Answer:
        """States the present hub angles, counter-clockwise positive. In Idle or Tripped."""
        return self.ask("zero", within_s=COMMISSION_S, angle_deg=list(angle_deg))

    def sim(self, line: str, level: int) -> Answer:
        """Sets a digital line of the simulated rig, such as "emergency-stop": 1 is closed, which is
        healthy, or the pressed reset button. @raises Refused: the rig is not simulated"""
        return self.ask("sim", line=line, level=level)

    def ask(self, command: str, *, within_s: float = ANSWER_S, take_over: bool = False,
            **keys: Any) -> Answer:
        """Any command of docs/protocol.md, with its further keys. Some of them move the arm."""
        more = {"take_over": True} if take_over else {}
        return self._connection.ask({"command": command, **keys, **more}, within_s)

    # What a run tells its daemon.

    def run_ended(self) -> None:
        """The run that this daemon began is over: nothing is left to stop."""
        self._has_begun_run = False

    def stop_after(self, error: BaseException) -> None:
        """Stops the run that this daemon began, if it is not over, and adds a note to `error` that
        says what became of it. Raises nothing: `error` goes on."""
        if self._has_begun_run:
            self._has_begun_run = False
            stop_after(self, error)
