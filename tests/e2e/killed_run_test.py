#!/usr/bin/env python3
"""A daemon that is killed leaves a log that opens, replays and is recovered, by itself alone.

FLEXARM_CAMPAIGN=whole kills at 200 instants instead of 5, FLEXARM_CAMPAIGN=N at N.
"""

import os
import random
import shutil
import signal
import time
import unittest

from program import ProgramTest, despite_stalls, doublet, rows

MOVE = doublet("killed", 30.0) + """
[[sim_event]]
at_s = {at_s:.3f}
kill = true
"""

PERIOD_S = 0.02
SEED = int(os.environ.get("FLEXARM_SEED", "14"))


def cases():
    wanted = os.environ.get("FLEXARM_CAMPAIGN", "5")
    return 200 if wanted == "whole" else int(wanted)


class KilledRun(ProgramTest):
    def test_killed_at_any_instant_of_a_run_it_loses_at_most_half_a_second(self):
        chosen = random.Random(SEED)
        for _ in range(cases()):
            self.at_s = chosen.uniform(0.3, 4.0)
            with self.subTest(at_s=self.at_s, seed=SEED):
                self.new_folder()
                self.kill_in_mid_run()

    @despite_stalls
    def kill_in_mid_run(self):
        daemon = self.start_daemon("--experiment", self.experiment(MOVE.format(at_s=self.at_s)))
        self.assertEqual(daemon.wait(timeout=60), -signal.SIGKILL, self.daemon_log())
        alone = self.folder / "elsewhere" / "alone.flexarm"
        alone.parent.mkdir()
        shutil.copy(self.only_run(), alone)

        info = self.flexarm_json("info", alone)
        self.assertIs(info["closed"], False)
        self.assertIn("killed", info["log"])
        self.assertEqual(info["missing_ticks"], 0)
        self.assert_replays(alone)
        # Running began with sample 0, and one more is in flight.
        self.assertGreaterEqual(info["metrics"]["ticks"] + 1, (self.at_s - 0.5) / PERIOD_S - 1)

        self.flexarm("log", "recover", alone)
        recovered = self.flexarm_json("info", alone)
        self.assertIs(recovered["closed"], True)
        self.assertIs(recovered["digest_holds"], True)
        self.assertIs(recovered["result"]["recovered"], True)
        self.assertEqual(recovered["ticks"], info["ticks"])
        self.assert_replays(alone)
        self.assertEqual([path.name for path in alone.parent.iterdir()], [alone.name])
        self.assertEqual(rows(alone, "PRAGMA integrity_check"), [("ok",)])
        self.assertEqual(rows(alone, "PRAGMA journal_mode"), [("delete",)])

    def assert_replays(self, run):
        replay = self.flexarm_json("replay", run)
        self.assertIs(replay["bit_exact"], True)
        self.assertIs(replay["safety_exact"], True)

    def test_whenever_it_is_killed_the_next_daemon_closes_what_it_left(self):
        chosen = random.Random(SEED + 1)
        experiment = self.experiment(doublet("killed", 2.0))
        state = self.folder / "state"
        for case in range(max(3, cases() // 4)):
            after_s = chosen.uniform(0.3, 5.0)
            with self.subTest(case=case, after_s=after_s, seed=SEED):
                daemon = self.start_daemon("--state-dir", state, "--experiment", experiment)
                time.sleep(after_s)
                daemon.kill()
                daemon.wait()
                self.check_what_is_left()
                shutil.rmtree(state, ignore_errors=True)  # else the next one starts tripped
        daemon = self.start_daemon("--state-dir", state, "--run-for", "1.0")
        daemon.wait(timeout=60)
        log = self.daemon_log()
        left = list((self.folder / "runs").iterdir())
        self.assertTrue(left)
        for run in left:
            self.assertEqual(run.suffix, ".flexarm", f"{left}\n{log}")
            self.assertIs(self.flexarm_json("info", run)["closed"], True, log)

    def check_what_is_left(self):
        folder = self.folder / "runs"
        for run in folder.glob("[!.]*.flexarm") if folder.exists() else ():
            if run.stat().st_size == 0:
                continue  # reserved, and no run began in it
            info = self.flexarm_json("info", run)
            if info["ticks"] > 0:
                self.assert_replays(run)

    @despite_stalls
    def test_a_run_is_read_while_it_is_written(self):
        self.start_daemon("--experiment", self.experiment(MOVE.format(at_s=29.0)))
        self.wait_for_state("Running")
        time.sleep(1.0)
        run = self.only_run()
        info = self.flexarm_json("info", run)
        self.assertIs(info["closed"], False)
        self.assertEqual(info["log"], "is being written")
        self.assertGreater(info["ticks"], 10)
        self.assert_replays(run)
        for verb, file in (("plot", "run.png"), ("export", "run.csv")):
            self.flexarm(verb, run, "-o", self.folder / file)
        refused = self.flexarm("log", "recover", run, expect=1)
        self.assertIn("a program is writing this run", refused.stderr)
        self.assertEqual(self.flexarm_json("info", run)["log"], "is being written")


class Recover(ProgramTest):
    def test_each_file_is_told_and_the_worst_is_the_exit_code(self):
        closed, _ = self.simulate("closed.flexarm")
        before = closed.read_bytes()
        told = self.flexarm("log", "recover", closed)
        self.assertIn("nothing to recover", told.stdout)
        missing = self.folder / "missing.flexarm"
        told = self.flexarm("log", "recover", closed, missing, expect=1)
        self.assertIn("closed.flexarm", told.stdout)
        self.assertIn("missing.flexarm: No such file or directory", told.stderr)
        self.assertEqual(closed.read_bytes(), before)

    def test_its_help_teaches(self):
        for text in ("checksum", "SQLite", "FILE.damaged", "Example"):
            self.assertIn(text, self.flexarm("log", "recover", "--help").stdout)


if __name__ == "__main__":
    unittest.main()
