#!/usr/bin/env python3
"""`flexarm run --wait`: progress, exit code, Ctrl-C."""

import json
import os
import pty
import signal
import subprocess
import time
import unittest

from program import BIN, ProgramTest, realtime_permitted

MOVE = """
name = "there"
duration_s = {duration}

[[move]]
start_s = 0.2
duration_s = 1.8
to_deg = [10.0, -10.0]
"""

# 2,900 moves whose durations the planner chooses.
SLOW = "name = \"slow\"\nduration_s = 3600.0\n" + "".join(
    f"[[move]]\nstart_s = {1.2 * k:.1f}\nto_deg = [{k % 3}.0, 0.0]\n" for k in range(2900))


class RunWait(ProgramTest):
    def setUp(self):
        super().setUp()
        ordinary = ["--without-realtime"] if realtime_permitted() else []  # else it is given anyway
        self.daemon = self.start_daemon(*ordinary)
        self.wait_for_state("Idle")
        end = time.monotonic() + 20
        while self.verb("arm").returncode != 0:
            self.assertLess(time.monotonic(), end, self.daemon_log())  # it is not at rest yet

    def verb(self, *command):
        return self.run_program("flexarm", *command, "--socket", self.folder / "socket")

    def start(self, *more, experiment=MOVE.format(duration=30.0), **streams):
        return subprocess.Popen(
            [BIN / "flexarm", "run", "--wait", self.experiment(experiment), "--socket",
             self.folder / "socket", *more], cwd=self.folder, stderr=subprocess.PIPE, text=True,
            **{"stdout": subprocess.PIPE, **streams})

    def test_a_run_that_ends_as_planned_is_0(self):
        result = self.verb("run", "--wait", self.experiment(MOVE.format(duration=6.0)))
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.splitlines()
        self.assertRegex(lines[0], r"^there: 0\.\d of 6\.0 s$")
        self.assertRegex(lines[1], r"^there: [56]\.\d of 6\.0 s$")
        self.assertEqual(lines[-1], "run: done")
        status = json.loads(self.verb("status", "--json").stdout)
        self.assertEqual(status["state"], "Armed", "it is at rest")
        self.assertEqual(status["run"]["outcome"], "done")

    def test_on_a_terminal_there_is_a_bar(self):
        ours, its = pty.openpty()
        with self.start(experiment=MOVE.format(duration=3.0), stdout=its) as run:
            os.close(its)
            shown = b""
            try:
                while part := os.read(ours, 4096):
                    shown += part
            except OSError:  # the end of a terminal
                pass
            self.assertEqual(run.wait(timeout=30), 0, run.stderr.read())
        os.close(ours)
        self.assertIn(b"[" + b"#" * 10, shown)
        self.assertIn(b"of 3.0 s", shown)

    def test_a_trip_is_1_and_names_its_cause(self):
        with self.start() as run:
            self.wait_for_state("Running")
            self.operate("sim", "limit-1-high", "0")
            self.assertEqual(run.wait(timeout=30), 1)
            self.assertIn("tripped by limit-switch-1-high", run.stderr.read())

    def test_a_stop_by_another_is_1(self):
        with self.start("--json") as run:
            self.wait_for_state("Running")
            self.operate("stop")
            self.assertEqual(run.wait(timeout=30), 1)
            self.assertIn("stopped", run.stderr.read())
            self.assertEqual(json.loads(run.stdout.read())["outcome"], "stopped")

    def test_an_interrupt_stops_the_run_and_waits_for_rest(self):
        for sign in (signal.SIGINT, signal.SIGTERM):
            with self.start() as run:
                self.wait_for_state("Running")
                run.send_signal(sign)
                self.assertEqual(run.wait(timeout=30), 1)
                self.assertIn("stopped", run.stderr.read())
            self.assertEqual(json.loads(self.verb("status", "--json").stdout)["state"], "Armed")

    def test_an_interrupt_ends_the_planning(self):
        told = []  # of tries that were interrupted before the command was sent, or after the plan
        for later_s in (0.02, 0.04, 0.06, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.2):
            with self.start(experiment=SLOW) as run:
                time.sleep(later_s)
                run.send_signal(signal.SIGINT)
                run.wait(timeout=60)
                told.append(run.stderr.read())
            self.wait_for_state("Armed")
            if "cancelled" in told[-1]:
                self.assertEqual(run.returncode, 1)
                return
        self.fail(f"never while it was planned: {told}")

    def test_other_signals_interrupt_nothing(self):
        with self.start(experiment=MOVE.format(duration=3.0)) as run:
            for _ in range(20):
                time.sleep(0.1)
                run.send_signal(signal.SIGWINCH)
                run.send_signal(signal.SIGCONT)
            self.assertEqual(run.wait(timeout=30), 0, run.stderr.read())

    def test_the_end_of_the_daemon_is_told(self):
        with self.start() as run:
            self.wait_for_state("Running")
            self.daemon.kill()
            self.assertEqual(run.wait(timeout=30), 1)
            self.assertIn("the daemon has ended", run.stderr.read())

    def test_a_refused_run_is_1(self):
        self.operate("disarm")
        result = self.verb("run", "--wait", self.experiment(MOVE.format(duration=3.0)))
        self.assertEqual(result.returncode, 1)
        self.assertIn("not armed", result.stderr)


if __name__ == "__main__":
    unittest.main()
