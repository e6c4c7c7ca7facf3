#!/usr/bin/env python3
"""The Python client, tools/python, with the real daemon and with one that answers anything."""

import contextlib
import csv
import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock
from pathlib import Path

from client_test import FalseDaemon
from program import BIN, ROOT, ProgramTest, realtime_permitted

sys.path.insert(0, str(ROOT / "tools/python"))
import flexarm  # noqa: E402
from flexarm.connection import Connection  # noqa: E402

MOVE = """
name = "there"
duration_s = {duration}

[[move]]
start_s = 0.2
duration_s = 0.8
to_deg = [{to_deg}, {to_deg}]
"""

READ_RUN = """
import sys, flexarm
data = flexarm.read_run(sys.argv[1], program=sys.argv[2])
for name, values in data.columns.items():
    print(name, data.units[name], *(value.hex() for value in values.tolist()), sep=",")
print("state", data.units["state"], *data.state.tolist(), sep=",")
"""


def python_with_numpy():
    """The tests may run in another Python than Debian's, which has the packages."""
    for program in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([program, "-c", "import numpy"], capture_output=True,
                          check=False).returncode == 0:
            return program
    raise AssertionError("no Python with NumPy: tools/install-deps test installs it")


class ClientTest(ProgramTest):
    """Has a daemon, and a client of it, with the arm at rest."""

    def setUp(self):
        super().setUp()
        ordinary = ["--without-realtime"] if realtime_permitted() else []  # else it is given anyway
        self.process = self.start_daemon(*ordinary)
        self.wait_for_state("Idle")
        self.daemon = self.connect()
        self.daemon.wait_for(lambda status: status.at_rest, within_s=20)

    def connect(self):
        daemon = flexarm.connect(self.folder / "socket")
        self.addCleanup(daemon.close)
        return daemon

    def begin(self, duration=30.0, to_deg=2.0, **label):
        return self.daemon.run_text(MOVE.format(duration=duration, to_deg=to_deg), **label)

    def python(self, *arguments):
        """In a Python that has NumPy, with the programs on PATH."""
        result = subprocess.run(
            [python_with_numpy(), *map(str, arguments)], cwd=self.folder, capture_output=True,
            text=True, timeout=120, check=False,
            env={**os.environ, "PYTHONPATH": str(ROOT / "tools/python"),
                 "PATH": f"{BIN}:{os.environ['PATH']}",
                 "FLEXARM_SOCKET": str(self.folder / "socket")})
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout


class Client(ClientTest):
    def test_tares_arms_runs_and_reads_what_the_export_has_to_the_last_digit(self):
        with self.assertRaises(flexarm.Refused) as refused:
            self.begin()
        self.assertEqual((refused.exception.code, refused.exception.command,
                          refused.exception.state), ("wrong-state", "run", "Idle"))
        self.assertIn("flexarm arm", refused.exception.text)
        self.assert_statuses_come_while_a_command_waits()
        self.assertIs(self.daemon.tare()["ok"], True)
        self.assertIs(self.daemon.zero((0.0, 0.0))["ok"], True)
        self.daemon.wait_for(lambda status: status.at_rest, within_s=10)
        self.daemon.arm()
        with self.assertRaises(flexarm.Refused) as refused:
            self.daemon.run_text("duration_s = 1e9", "bad.toml")
        self.assertEqual(refused.exception.code, "experiment-refused")
        self.assertIn("bad.toml", refused.exception.text)
        run = self.begin(1.5, name="first", tags=("client",))
        states = list(run.follow())
        self.assertEqual([state.outcome for state in states],
                         ["running"] * (len(states) - 1) + ["done"])
        self.assertEqual({state.number for state in states}, {run.number})
        elapsed_s = [state.elapsed_s for state in states]
        self.assertEqual(elapsed_s, sorted(elapsed_s))
        self.assertEqual(states[-1].duration_s, 1.5)
        self.assertEqual(run.wait(), states[-1], "at once, as it is over")
        file = run.log_file()
        self.daemon.wait_for(lambda status: status.log_file is None, within_s=20)
        self.daemon.disarm()
        self.assertEqual(self.daemon.status().state, "Idle")
        self.assertEqual(file, self.only_run())
        listed, = self.flexarm_json("runs", "--folder", self.folder / "runs")["runs"]
        self.assertEqual((listed["name"], listed["tags"]), ("first", ["client"]))
        self.assert_equals_export(file)

    def assert_statuses_come_while_a_command_waits(self):
        status = self.daemon.status()
        time.sleep(0.2)
        self.assertGreaterEqual(status.age_s, 0.2, "the time that it was asked for before")
        self.assertEqual([math.isfinite(angle) for angle in status.joint_angle_deg], [True, True])
        self.assertEqual((status.run, status.trip, status.log_file), (None, None, None))
        with self.assertRaises(ValueError):
            self.daemon.statuses(every_s=0.0)
        times_s = []
        with self.daemon._connection._turn:  # as while a command waits for its answer
            for status in self.daemon.statuses(every_s=0.05):
                times_s.append(status.time_s)
                if len(times_s) == 5:
                    break
            with self.assertRaises(flexarm.Refused):
                self.daemon.stop()
        self.assertEqual(times_s, sorted(set(times_s)), "each is newer")

    def assert_equals_export(self, file):
        table = self.folder / "export.csv"
        self.flexarm("export", file, "--decoded", "-o", table)
        with open(table, encoding="utf-8", newline="") as lines:
            names, units, *rows = csv.reader(lines)
        self.assertGreaterEqual(len(rows), 75, "1.5 s at 50 Hz")
        told = {}
        for line in self.python("-c", READ_RUN, file, BIN / "flexarm").splitlines():
            name, unit, *values = line.split(",")
            told[name] = unit, values
        self.assertEqual(sorted(told), sorted(names))
        for i, name in enumerate(names):
            cells = [row[i] for row in rows]
            unit, values = told[name]
            self.assertEqual(unit, units[i])
            if name != "state":
                cells = [float(cell).hex() for cell in cells]
            self.assertEqual(values, cells, name)

    def test_an_exception_that_leaves_a_block_stops_its_run_and_says_so(self):
        self.daemon.arm()
        with self.assertLogs("flexarm", "WARNING") as log:
            with self.assertRaises(ZeroDivisionError) as failed:
                with self.begin() as run:
                    next(run.follow())
                    raise ZeroDivisionError
        self.assertIn("told to stop; it is stopped", failed.exception.__notes__[0])
        self.assertIn("ZeroDivisionError", log.output[0])
        self.assertEqual(self.daemon.status().state, "Armed")
        with self.assertRaises(flexarm.RunNotCompleted) as ended:
            run.wait()
        self.assertEqual(ended.exception.run.outcome, "stopped")

        with self.assertLogs("flexarm", "WARNING"):
            with self.assertRaises(KeyboardInterrupt) as failed:
                with self.daemon:
                    self.begin()
                    raise KeyboardInterrupt
        self.assertIn("told to stop; it is stopped", failed.exception.__notes__[0])
        with self.assertRaises(flexarm.ConnectionLost):
            self.daemon.status()

        self.daemon = self.connect()
        with self.daemon:
            run = self.begin()  # a block that ends otherwise, and closing, stop nothing
        self.daemon = self.connect()
        self.assertEqual(self.daemon.status().run.outcome, "running")
        with self.assertRaises(flexarm.TimedOut):
            self.daemon.wait_for(lambda status: status.state == "Idle", within_s=0.1)
        self.assertEqual(self.daemon.stop()["state"], "Stopping")
        self.daemon.wait_for(lambda status: status.state == "Armed", within_s=20)
        with self.assertRaises(flexarm.Refused) as refused:
            self.daemon.stop()
        self.assertEqual(refused.exception.code, "wrong-state")

        run = self.begin()
        with self.assertRaises(flexarm.TimedOut):
            run.wait(within_s=0.1)
        self.daemon.sim("limit-1-high", 0)
        with self.assertRaises(flexarm.RunNotCompleted) as ended:
            run.wait()
        self.assertEqual(ended.exception.run.trip, "limit-switch-1-high")
        self.reset_the_trip()

    def reset_the_trip(self):
        self.assertEqual(self.daemon.status().trip.name, "limit-switch-1-high")
        with self.assertRaises(flexarm.Refused) as refused:
            self.daemon.reset()
        self.assertEqual(refused.exception.code, "cause-remains")
        self.assertEqual(refused.exception.present, ["limit-switch-1-high"])
        self.daemon.sim("limit-1-high", 1)
        self.daemon.sim("reset-button", 1)
        time.sleep(0.1)  # a press of 50 ms counts
        self.daemon.sim("reset-button", 0)
        self.daemon.wait_for(lambda status: status.at_rest, within_s=20)
        self.daemon.reset()
        self.assertEqual(self.daemon.status().state, "Idle")

    def test_the_end_of_the_daemon_is_told(self):
        self.daemon.arm()
        run = self.begin()
        follow = run.follow()
        next(follow)
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        with self.assertRaises(flexarm.ConnectionLost):
            list(follow)
        for ask in (self.daemon.status, self.daemon.stop, self.daemon.arm, self.connect):
            with self.assertRaises(flexarm.ConnectionLost):
                ask()
        error = RuntimeError()
        with self.assertLogs("flexarm", "WARNING"):
            self.daemon.stop_after(error)
        self.assertIn("THE RUN WAS NOT STOPPED", error.__notes__[0])
        self.start_daemon(*(["--without-realtime"] if realtime_permitted() else []))
        self.wait_for_state("Tripped")
        with self.assertRaises(flexarm.ConnectionLost):
            self.daemon.status()  # nothing connects by itself
        self.assertEqual(self.connect().status().trip.name, "ended-while-armed")


class Example(ClientTest):
    def test_the_example_runs_its_series(self):
        told = self.python(ROOT / "tools/python/examples/series.py", "--steps-deg", "1", "2",
                           "--duration-s", "1.6")  # 0.8 trips
        self.assertIn("2 deg: overshoot", told)
        with open(self.folder / "series.csv", encoding="utf-8", newline="") as table:
            header, *rows = csv.reader(table)
        self.assertEqual(header, ["time_s", "hub_1_of_1_deg", "hub_1_of_2_deg"])
        furthest_deg = [max(float(row[i]) for row in rows) for i in (1, 2)]
        self.assertGreater(furthest_deg[1], furthest_deg[0], "the step is twice as large")
        self.assertEqual(self.daemon.status().state, "Idle", "it has disarmed")
        runs = self.flexarm_json("runs", "--folder", self.folder / "runs", "--tag", "series")
        self.assertEqual([run["name"] for run in runs["runs"]], ["2 deg", "1 deg"])


STATUS = json.dumps({"ok": True, "protocol": 1, "state": "Idle", "command": "status"}).encode()


class StrangeDaemon(ProgramTest):
    def ask(self, *answers):
        """What `connect` makes of the answers, one a connection."""
        path = self.folder / "socket"
        path.unlink(missing_ok=True)
        with FalseDaemon(path, answers):
            return flexarm.connect(path)

    def test_whatever_it_answers_is_an_error_of_the_package(self):
        for answer in (b"", b"{", b"\xff\xfe", b"nul", b"[1]", b"[" * 100_000, b"null",
                       b'{"ok":true}', b'{"ok":true,"protocol":2}', b'{"ok":true,"protocol":"1"}',
                       b'{"ok":true,"protocol":1,"command":"arm"}'):
            with self.assertRaises(flexarm.ProtocolError, msg=answer[:50]):
                self.ask(answer)

    def test_a_refused_connection_has_its_reasons(self):
        refused = {"ok": False, "refusal": "not-permitted", "error": "e", "remedy": "r"}
        with self.assertRaises(flexarm.Refused) as caught:
            self.ask(json.dumps(refused).encode())
        self.assertEqual((caught.exception.code, caught.exception.remedy), ("not-permitted", "r"))
        self.assertEqual(str(caught.exception), "status: e; r")

    def test_a_command_that_failed_is_no_refusal(self):
        with self.assertRaises(flexarm.CommandFailed):
            self.ask(b'{"ok":false,"error":"e","state":"Armed"}')

    def test_values_of_another_kind_are_an_error_where_they_are_read(self):
        daemon = self.ask(STATUS)
        daemon.close()
        status = flexarm.Status({"state": 1, "tick": True, "at_rest": 0, "run": [], "trip": {},
                                 "joint_angle_deg": [1.0], "torque_nm": ["a", None]}, 0.0)
        for name in ("state", "tick", "time_s", "at_rest", "run", "trip", "joint_angle_deg",
                     "torque_nm"):
            with self.assertRaises(flexarm.ProtocolError, msg=name):
                getattr(status, name)

    def test_no_answer_within_the_time_closes_the_connection(self):
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(self.folder / "socket"))
            listener.listen()
            connection = Connection(str(self.folder / "socket"))
            self.addCleanup(connection.close)
            with self.assertRaises(flexarm.TimedOut):
                connection.ask({"command": "status"}, within_s=0.05)
            with self.assertRaises(flexarm.ConnectionLost):
                connection.ask({"command": "status"}, within_s=0.05)

    def test_an_answer_may_come_in_pieces_but_within_its_time(self):
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(self.folder / "socket"))
            listener.listen()
            connection = Connection(str(self.folder / "socket"))
            self.addCleanup(connection.close)
            peer, _ = listener.accept()
            with peer:
                self.send_in_pieces(peer, STATUS[:20], STATUS[20:] + b"\n")
                self.assertEqual(connection.ask({"command": "status"}, 30)["state"], "Idle")
                self.send_in_pieces(peer, *(STATUS[i:i + 2] for i in range(0, len(STATUS), 2)), b"\n")
                with self.assertRaises(flexarm.TimedOut):  # each piece comes earlier
                    connection.ask({"command": "status"}, within_s=0.2)

    def send_in_pieces(self, peer, *pieces):
        def send():
            with contextlib.suppress(OSError):  # the client has given up
                for piece in pieces:
                    peer.sendall(piece)
                    time.sleep(0.05)

        sender = threading.Thread(target=send)
        sender.start()
        self.addCleanup(sender.join)

    def test_a_stop_is_asked_again_if_a_crowd_has_displaced_it(self):
        crowd = b'{"ok":false,"refusal":"too-many-clients","error":"e"}'
        stopped = b'{"ok":true,"command":"stop","state":"Stopping"}'
        path = self.folder / "socket"
        with FalseDaemon(path, [STATUS, crowd, crowd, stopped, crowd]):
            daemon = flexarm.connect(path)
            self.addCleanup(daemon.close)
            self.assertEqual(daemon.stop()["state"], "Stopping")
            with unittest.mock.patch("flexarm.daemon.STOP_TRIES", 1):
                with self.assertRaises(flexarm.Refused) as refused:
                    daemon.stop()
        self.assertEqual(refused.exception.code, "too-many-clients")

    def test_a_missing_program_or_log_is_told(self):
        with self.assertRaises(flexarm.ExportFailed) as caught:
            flexarm.read_run("none.flexarm", program=Path("/nowhere/flexarm"))
        self.assertIn("/nowhere/flexarm", caught.exception.text)
        with self.assertRaises(flexarm.ExportFailed) as caught:
            flexarm.read_run("none.flexarm", program=BIN / "flexarm")
        self.assertIn("none.flexarm", caught.exception.text)


if __name__ == "__main__":
    unittest.main()
