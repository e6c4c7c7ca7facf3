#!/usr/bin/env python3
"""The logs of the daemon's runs: one a run, reserved before the arm is armed, and of a trip."""

import contextlib
import json
import subprocess
import time
import unittest

from program import ProgramTest, doublet, in_real_time, rows

RUN_S = 1.2

SMALL = ("--set", "log.reserve_mb=1", "--set", "log.keep_free_mb=0")


class DaemonRuns(ProgramTest):
    """Runs of a daemon, and their logs."""

    def arm(self):
        self.wait_for_state("Idle")
        time.sleep(0.8)  # at rest means half a second of rest
        self.operate("arm")
        self.wait_for_state("Armed")

    def run_to_the_end(self, name):
        self.operate("run", self.experiment(doublet(name, RUN_S, 5.0)))
        self.wait_for_state("Running")
        self.wait_for_state("Armed")

    def status(self):
        return json.loads(self.operate("status", "--json").stdout)

    def wait_for_samples(self, count, within_s=60):
        """Waits until the loop has had so many. The start of a daemon takes its time first."""
        end = time.monotonic() + within_s
        self.wait_for_state("Idle", within_s=within_s)
        while self.status()["tick"] < count:
            self.assertLess(time.monotonic(), end, self.daemon_log())
            time.sleep(0.1)


class RunLog(DaemonRuns):
    @in_real_time
    def test_each_run_is_a_file_that_replays_on_its_own(self):
        self.start_daemon(*SMALL, log_dir="runs")  # relative to the daemon's own folder
        self.arm()
        self.assertTrue(self.status()["log"]["ready"])
        self.assertEqual(self.runs(), [], "reserved, under another name")
        self.run_to_the_end("first")
        self.wait_for_line(f"recording to {self.folder}/runs/")
        self.run_to_the_end("second")
        self.operate("disarm")
        self.wait_for_state("Idle")
        runs = self.wait_for_closed_runs(2)
        self.assertEqual({self.flexarm_json("info", run)["experiment"] for run in runs},
                         {"first", "second"})
        for run in runs:
            replay = self.flexarm_json("replay", run)
            self.assertIs(replay["bit_exact"], True, run)
            self.assertIs(replay["safety_exact"], True, run)
            self.assertEqual(replay["ticks_before_reset"], 0)
            self.flexarm("check", run)
            names = [name for name, in rows(run, "SELECT name FROM event ORDER BY number")]
            self.assertIn("arm", names, "who armed belongs to each run")
            self.assertEqual(rows(run, "SELECT count(*) FROM tick WHERE state = 'Running'"), [(60,)])
        # The state folder is the same, and holds the figures of the runs' health.
        self.assertEqual({path.name for path in (self.folder / "runs").iterdir()} - {"health.json"},
                         {run.name for run in runs}, "the file that was not used is removed")

    @in_real_time
    def test_a_trip_outside_a_run_is_a_file_of_the_last_ten_seconds(self):
        self.start_daemon(*SMALL)
        # The first sample, which is that of a reset, is older than the ten seconds then.
        self.wait_for_samples(11 * 50)
        self.arm()
        self.operate("sim", "emergency-stop", "0")
        self.wait_for_state("Tripped")
        run, = self.wait_for_closed_runs(1)
        self.assertIn("trip-emergency-stop", run.name)
        info = self.flexarm_json("info", run)
        self.assertEqual(info["trip"]["name"], "emergency-stop")
        replay = self.flexarm_json("replay", run)
        self.assertGreater(replay["ticks_before_reset"], 30, "the time before it was armed")
        self.assertLess(replay["ticks_before_reset"], replay["ticks"])
        self.assertIs(replay["bit_exact"], True)
        self.assertIs(replay["safety_exact"], True)
        checks = self.flexarm_json("check", run, expect=1)["checks"]
        self.assertEqual([check["name"] for check in checks if not check["passed"]],
                         ["begins-with-reset"], "what precedes a reset cannot be replayed")
        self.flexarm("plot", run, "-o", self.folder / "trip.png")

    @in_real_time
    def test_without_a_file_nothing_is_armed_unless_the_config_says_so(self):
        blocked = self.folder / "runs"
        self.start_daemon(*SMALL, "--state-dir", self.folder / "state")
        self.wait_for_state("Idle")
        blocked.write_text("a file where the folder should be", encoding="utf-8")
        time.sleep(0.8)
        refused = self.operate("arm", expect=1)
        self.assertIn("no file for the log of the next run", refused.stderr)
        self.assertIn("Not a directory", refused.stderr)
        answer = json.loads(self.operate("arm", "--json", expect=1).stdout)
        self.assertEqual(answer["refusal"], "no-log")
        blocked.unlink()
        self.operate("arm")
        self.operate("disarm")
        self.end_daemons()
        self.new_folder()
        self.start_daemon(*SMALL, "--set", "log.required=false", "--state-dir",
                          self.folder / "state")
        self.wait_for_state("Idle")
        (self.folder / "runs").write_text("blocked", encoding="utf-8")
        self.arm()
        log = self.status()["log"]
        self.assertIs(log["ok"], False)
        self.assertIs(log["required"], False)
        self.assertIn("Not a directory", log["error"])
        self.run_to_the_end("unrecorded")

    def small_disk(self, size_mb):
        """Makes the log folder a disk of its own, until the end of the test."""
        runs = self.folder / "runs"
        runs.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size_mb}m", "none", runs],
                                 capture_output=True, text=True, check=False)
        if mounted.returncode != 0:
            self.skipTest(f"no disk of its own: {mounted.stderr}")
        self.addCleanup(subprocess.run, ["umount", "-l", runs], check=True)
        return runs

    def wait_for_log(self, ok, within_s=20):
        end = time.monotonic() + within_s
        while time.monotonic() < end:
            log = self.status()["log"]
            if log["ok"] is ok:
                return log
            time.sleep(0.05)
        self.fail(f"log.ok is not {ok}: {log}\n{self.daemon_log()}")

    @in_real_time
    def test_a_disk_that_fills_in_mid_run_is_told_and_loses_nothing(self):
        runs = self.small_disk(24)
        self.start_daemon(*SMALL, "--set", "log.reserve_mb=0.1", "--state-dir",
                          self.folder / "state")
        self.arm()
        self.operate("run", self.experiment(doublet("full", 22.0)))
        self.wait_for_state("Running")
        filler = runs / "filler"
        with contextlib.suppress(OSError), open(filler, "wb", buffering=0) as file:
            while True:
                file.write(bytes(4096))
        log = self.wait_for_log(ok=False)
        self.assertIn("No space left", log["error"])
        # What was reserved for this run is used up: 0.1 MB are 4 to 9 s of records.
        self.wait_for_line("its records wait", within_s=20)
        self.assertEqual(self.status()["state"], "Running", "the run goes on")
        time.sleep(1.0)
        filler.unlink()
        self.wait_for_log(ok=True)
        self.wait_for_state("Armed", within_s=90)
        self.operate("disarm")
        self.wait_for_state("Idle")
        run, = self.wait_for_closed_runs(1)
        self.assertEqual(self.flexarm_json("info", run)["missing_ticks"], 0)
        self.assertEqual(rows(run, "SELECT count(*) FROM event WHERE kind = 'gap'"), [(0,)])
        self.assertIs(self.flexarm_json("replay", run)["bit_exact"], True)
        self.assertIn("everything is written again", self.daemon_log())

    @in_real_time
    def test_an_unattended_run_without_a_file_is_refused(self):
        daemon = self.start_daemon("--set", "log.keep_free_mb=1000000", "--experiment",
                                   self.experiment(doublet("none", RUN_S, 5.0)))
        self.assertEqual(daemon.wait(timeout=30), 1)
        self.assertIn("no file for the log of the next run", self.daemon_log())

    @in_real_time
    def test_an_arm_that_nobody_uses_is_disarmed(self):
        self.start_daemon(*SMALL, "--set", "safety.disarm_after_s=1.0")
        self.arm()
        self.wait_for_state("Idle")
        self.assertIn("safety.disarm_after_s", self.daemon_log())
        time.sleep(0.3)
        self.assertEqual(list((self.folder / "runs").glob("*.flexarm")), [])

    @in_real_time
    def test_old_runs_are_removed_when_the_config_asks_for_it(self):
        self.start_daemon(*SMALL, "--set", "log.keep_total_mb=0.001")
        self.arm()
        for name in ("first", "second", "third"):
            self.run_to_the_end(name)
        self.operate("disarm")
        self.wait_for_state("Idle")
        self.arm()
        self.operate("disarm")
        self.wait_for_state("Idle")
        self.assertEqual([run.name.split("-")[-1] for run in self.wait_for_closed_runs(1)],
                         ["third.flexarm"])
        self.assertIn("removed (log.keep_total_mb)", self.daemon_log())


if __name__ == "__main__":
    unittest.main()
