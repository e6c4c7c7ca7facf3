"""Operates a flexarm daemon, and reads its runs as NumPy arrays. docs/python.md.

    with flexarm.connect() as daemon:
        daemon.wait_for(lambda status: status.at_rest, within_s=10)
        daemon.arm()
        run = daemon.run("square-30deg.toml")
        run.wait()
        angle_deg = run.data()["hub_1_deg"]
        daemon.disarm()

Nothing is armed or started but by `arm`, `run` and `ask`. Names carry their units: `_s`, `_deg`,
`_nm`. Angles and torques are positive counter-clockwise, seen from above; joint 2 is measured from
the end of link 1.
"""

from .daemon import Daemon, connect
from .errors import (CommandError, CommandFailed, ConnectionLost, ExportFailed, FlexarmError,
                     ProtocolError, Refused, RunNotCompleted, TimedOut)
from .run import Run
from .run_data import RunData, read_run
from .status import RunState, Status, Trip

__all__ = [
    "CommandError", "CommandFailed", "ConnectionLost", "Daemon", "ExportFailed", "FlexarmError",
    "ProtocolError", "Refused", "Run", "RunData", "RunNotCompleted", "RunState", "Status",
    "TimedOut", "Trip", "connect", "read_run",
]
