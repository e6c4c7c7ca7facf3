"""What the daemon tells of itself, and how old it is."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import ProtocolError

Pair = tuple[float | None, float | None]


def _value(values: Mapping[str, Any], key: str, *kinds: type) -> Any:
    found = values.get(key)
    if isinstance(found, bool) and bool not in kinds or not isinstance(found, kinds):
        raise ProtocolError(f"status: {key} is {found!r}, which is not expected")
    return found


def _number(values: Mapping[str, Any], key: str) -> float:
    return float(_value(values, key, int, float))


def _number_or_none(values: Mapping[str, Any], key: str) -> float | None:
    return None if values.get(key) is None else _number(values, key)


def _text_or_none(values: Mapping[str, Any], key: str) -> str | None:
    return None if values.get(key) is None else str(_value(values, key, str))


def _pair(values: Mapping[str, Any], key: str) -> Pair:
    both = _value(values, key, list)
    if len(both) != 2:
        raise ProtocolError(f"status: {key} is {both!r}, which is not of two joints")
    joints = dict(zip(("1", "2"), both))
    return _number_or_none(joints, "1"), _number_or_none(joints, "2")


@dataclass(frozen=True)
class RunState:
    """How far the present run is, or how the last one ended."""

    number: int  #: never used again by this daemon
    name: str  #: of the experiment
    outcome: str  #: "running" until the arm is at rest, then "done", "stopped" or "tripped"
    elapsed_s: float
    duration_s: float | None  #: None: not known yet, or the motion ends when it has found something
    trip: str | None  #: name of the cause, as docs/trips.md lists them

    @property
    def over(self) -> bool:
        return self.outcome != "running"


@dataclass(frozen=True)
class Trip:
    """The cause that is latched. `value` and `limit` are in the unit of docs/trips.md."""

    name: str
    text: str  #: what it means, and what to do
    value: float | None  #: None: not known, as of a trip before the daemon's start
    limit: float | None
    channel_name: str  #: joint, gauge or counter; "" if there is none
    report: Path | None  #: its page (docs/trip-report.md); None: not written yet


@dataclass(frozen=True)
class Status:
    """One answer to `status`. `values` has all keys of docs/protocol.md; the properties have types.

    `asked_s`: time.monotonic() when it was asked for.
    """

    values: Mapping[str, Any]
    asked_s: float

    @property
    def age_s(self) -> float:
        """How old it is now, s, at most: the time since it was asked for."""
        return time.monotonic() - self.asked_s

    @property
    def state(self) -> str:
        """Of the safety machine: "Idle", "Armed", "Running", "Stopping", "Tripped", .."""
        return str(_value(self.values, "state", str))

    @property
    def time_s(self) -> float:
        """The daemon's own time since its start."""
        return _number(self.values, "time_s")

    @property
    def tick(self) -> int:
        """Number of the last sample: if it stays the same, the loop stands."""
        return int(_value(self.values, "tick", int))

    @property
    def at_rest(self) -> bool:
        """The arm has not moved for half a second, which `arm`, `tare` and `zero` require."""
        return bool(_value(self.values, "at_rest", bool))

    @property
    def joint_angle_deg(self) -> Pair:
        """Hub angles of joint 1 and 2, counter-clockwise positive; None: not known."""
        return _pair(self.values, "joint_angle_deg")

    @property
    def torque_nm(self) -> Pair:
        """Torques that the law asks for at the gearbox outputs, counter-clockwise positive."""
        return _pair(self.values, "torque_nm")

    @property
    def run(self) -> RunState | None:
        """The present run or the last; None: there was none."""
        run = self.values.get("run")
        if run is None:
            return None
        run = _value(self.values, "run", dict)
        return RunState(number=int(_value(run, "number", int)), name=str(_value(run, "name", str)),
                        outcome=str(_value(run, "outcome", str)),
                        elapsed_s=_number(run, "elapsed_s"),
                        duration_s=_number_or_none(run, "duration_s"),
                        trip=_text_or_none(run, "trip"))

    @property
    def trip(self) -> Trip | None:
        """None: no cause is latched."""
        trip = self.values.get("trip")
        if trip is None:
            return None
        trip = _value(self.values, "trip", dict)
        report = _text_or_none(trip, "report")
        return Trip(name=str(_value(trip, "name", str)), text=str(_value(trip, "text", str)),
                    value=_number_or_none(trip, "value"), limit=_number_or_none(trip, "limit"),
                    channel_name=_text_or_none(trip, "channel_name") or "",
                    report=None if report is None else Path(report))

    @property
    def log_file(self) -> Path | None:
        """The log that is being written; None: none is, or the daemon keeps none."""
        log = self.values.get("log")
        file = _text_or_none(log, "file") if isinstance(log, dict) else None
        return None if file is None else Path(file)
