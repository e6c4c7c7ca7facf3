"""What can go wrong between a program, the daemon and the arm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .status import RunState


class FlexarmError(Exception):
    """Of all errors of this package. `text`: what is wrong; `remedy`: what to do, if known."""

    def __init__(self, text: str, remedy: str = "") -> None:
        super().__init__(f"{text}; {remedy}" if remedy else text)
        self.text = text
        self.remedy = remedy


class ConnectionLost(FlexarmError):
    """There is no daemon, or the connection to it has ended. Whether a command that was under way
    was carried out is not known: connect again, and look at the status."""


class TimedOut(FlexarmError, TimeoutError):
    """Something did not come within its time. If it is an answer, its connection is closed: a late
    one would be mistaken for that of the next command."""


class ProtocolError(FlexarmError):
    """The other side does not speak version 1 of docs/protocol.md."""


class CommandError(FlexarmError):
    """The daemon answered that a command was not carried out.

    `answer`: the whole answer; `command`, `state`: of the safety machine after it, "" if not told.
    """

    def __init__(self, command: str, answer: dict[str, Any]) -> None:
        super().__init__(f"{command}: {answer.get('error', 'refused')}",
                         str(answer.get("remedy") or ""))
        self.answer = answer
        self.command = command
        self.state = str(answer.get("state", ""))


class Refused(CommandError):
    """A command was refused: nothing of it was done.

    `code`: name of the reason, as docs/trips.md lists them; `present`: names of the causes that are
    present, if the reason is `cause-remains` or `unhealthy`.
    """

    def __init__(self, command: str, answer: dict[str, Any]) -> None:
        super().__init__(command, answer)
        self.code = str(answer["refusal"])
        present = answer.get("present")
        self.present = [str(name) for name in present] if isinstance(present, list) else []


class CommandFailed(CommandError):
    """A command was begun and failed, such as a pluck test that found a fault."""


class RunNotCompleted(FlexarmError):
    """A run ended otherwise than planned. `run`: how, with `outcome` and `trip`."""

    def __init__(self, run: RunState) -> None:
        by = f" by {run.trip}" if run.trip else ""
        super().__init__(f"run {run.number} ({run.name}) was not completed: {run.outcome}{by}",
                         "see `flexarm status`" if run.trip else "")
        self.run = run


class ExportFailed(FlexarmError):
    """The program flexarm could not export a log, or is not there."""
