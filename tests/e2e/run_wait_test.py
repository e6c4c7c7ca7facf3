#!/usr/bin/env python3
"""`flexarm run --wait`: progress, exit code, Ctrl-C."""

import json
import math
import os
import pty
import signal
import subprocess
import time
import unittest

from program import BIN, ProgramTest

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
        self.daemon = self.start_armed_daemon()

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

    def test_move_goes_to_angles_and_to_a_place_and_each_is_a_run_of_its_own(self):
        result = self.verb("move", "--to", "12", "-8", "--wait", "--name", "first")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_angles([12.0, -8.0])
        # A quarter turn would need the tip at (0, 1.7): two straight links of 0.8 and 0.9 m.
        result = self.verb("move", "--to-tip", "1.55", "-0.1", "--elbow", "left", "--duration", "2",
                           "--wait")
        self.assertEqual(result.returncode, 0, result.stderr)
        first, second = self.angles()
        tip = (0.8 * math.cos(first) + 0.9 * math.cos(first + second),
               0.8 * math.sin(first) + 0.9 * math.sin(first + second))
        self.assertLess(math.dist(tip, (1.55, -0.1)), 0.005)  # friction: a few mm, "at rest"
        logs = sorted((self.folder / "runs").glob("*.flexarm"))
        self.assertEqual(len(logs), 2)
        for log in logs:
            self.assertEqual(self.run_program("flexarm", "replay", log).returncode, 0)
        first = json.loads(self.run_program("flexarm", "info", logs[0], "--json").stdout)
        self.assertIs(first["result"]["completed"], True, "although the next run followed at once")
        self.assertEqual(first["result"]["final_state"], "Armed")

    def test_a_move_that_cannot_be_made_is_refused_before_it_begins(self):
        for options, said in ((["--to", "20", "100"], "is beyond limits.soft_angle_deg"),
                              (["--to-tip", "3", "0"], "is out of reach"),
                              (["--to", "20", "0", "--duration", "0.2"], "beyond limits."),
                              ([], "--to or --to-tip is required"),
                              (["--to", "1", "2", "--to-tip", "1", "1"], "excludes")):
            result = self.verb("move", *options)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(said, result.stderr)
        self.assertEqual(json.loads(self.verb("status", "--json").stdout)["state"], "Armed")

    def angles(self):
        status = json.loads(self.verb("status", "--json").stdout)
        return [math.radians(angle) for angle in status["joint_angle_deg"][:2]]

    def assert_angles(self, expected_deg):
        for angle, expected in zip(self.angles(), expected_deg):
            # What friction holds: the reference run of docs/benchmark.md ends within 0.1 deg.
            self.assertAlmostEqual(math.degrees(angle), expected, delta=0.3)

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
