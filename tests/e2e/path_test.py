#!/usr/bin/env python3
"""`flexarm pause`, `resume`, `speed` and `move --retarget`: a run that is changed while it goes on, and
its log."""

import json
import time
import unittest

from program import ProgramTest, rows

MOVES = """
name = "there-and-back"

[[move]]
start_s = 0.0
duration_s = 4.0
to_deg = [20.0, -10.0]

[[move]]
start_s = 4.5
duration_s = 4.0
to_deg = [0.0, 0.0]
"""


class Path(ProgramTest):
    def setUp(self):
        super().setUp()
        self.start_armed_daemon("--set", "controller.name=gain-scheduled",
                                "--set", "safety.reduced=true")

    def status(self):
        return json.loads(self.operate("status", "--json").stdout)

    def wait_for_rest(self, within_s=20):
        """On a busy machine the simulated arm is behind the clock."""
        end = time.monotonic() + within_s
        before, now = None, self.status()["joint_angle_deg"]
        while before is None or max(abs(a - b) for a, b in zip(before, now, strict=True)) > 0.05:
            self.assertLess(time.monotonic(), end, self.daemon_log())
            time.sleep(0.5)
            before, now = now, self.status()["joint_angle_deg"]

    def test_a_run_that_is_paused_slowed_and_sent_elsewhere_replays(self):
        refused = self.verb("run", self.experiment(MOVES.replace("20.0", "50.0")))
        self.assertEqual(refused.returncode, 1)
        self.assertIn("45", refused.stderr, "half of the soft angle: the limits are reduced")
        self.assertIn("limits", self.operate("status").stdout)
        self.operate("run", self.experiment(MOVES), "--speed", "80")
        time.sleep(1.5)
        self.operate("pause")
        self.assertIn("paused", self.operate("status").stdout)
        self.wait_for_rest()
        paused = self.status()["joint_angle_deg"]
        time.sleep(0.5)
        still = self.status()["joint_angle_deg"]
        for before, after in zip(paused, still, strict=True):
            self.assertAlmostEqual(before, after, delta=0.2)
        self.assertEqual(self.verb("pause").returncode, 1)
        self.operate("resume")
        self.operate("speed", "100")
        self.operate("move", "--to", "-5", "5", "--retarget")
        end = time.monotonic() + 30
        while self.status()["run"]["outcome"] == "running":
            self.assertLess(time.monotonic(), end, self.daemon_log())
            time.sleep(0.2)
        for angle, goal in zip(self.status()["joint_angle_deg"], (-5.0, 5.0), strict=False):
            self.assertAlmostEqual(angle, goal, delta=0.4)  # friction
        self.assertEqual(self.verb("limits", "full").returncode, 1, "it is armed")
        self.operate("disarm")
        self.wait_for_state("Idle")
        self.operate("limits", "full")
        self.assertFalse(self.status()["limits"]["reduced"])
        run, = self.wait_for_closed_runs(1)
        replay = self.flexarm_json("replay", run)
        self.assertIs(replay["bit_exact"], True)
        self.assertIs(replay["safety_exact"], True)
        self.flexarm("check", run)
        self.assertEqual([name for name, in rows(run, "SELECT name FROM event WHERE kind = 'change' "
                                                      "ORDER BY number")],
                         ["pause", "resume", "speed", "retarget"])
        self.assertEqual(rows(run, "SELECT name FROM event WHERE kind = 'limits'"), [("reduced",)])


if __name__ == "__main__":
    unittest.main()
