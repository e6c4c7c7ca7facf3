#!/usr/bin/env python3
"""The daemon as a process: real time, socket, signals, kill."""

import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock

from program import (BIN, HIL, SQUARE, ProgramTest, despite_stalls, doublet,
                     in_real_time, missed_deadlines, realtime_permitted, rows)

SHORT = doublet("short", 2.0)

PERIOD_MS = 20.0

# Slow, so that it coasts a few degrees after a trip and not to a limit switch.
LONG = doublet("long", 30.0, move_deg=1.0)

ONE_MOVE = """
name = "one-move"
duration_s = 4.0

[[move]]
start_s = 0.2
duration_s = 1.8
to_deg = [30.0, -30.0]
"""


class Daemon(ProgramTest):
    @in_real_time
    def test_an_unattended_run_ends_in_idle_with_a_log_that_replays(self):
        daemon = self.start_daemon("--experiment", self.experiment(SHORT))
        self.assertEqual(daemon.wait(timeout=60), 0, self.daemon_log())
        run = self.only_run()
        info = self.flexarm_json("info", run)
        self.assertIs(info["closed"], True)
        self.assertEqual(info["final_state"], "Idle")
        self.assertEqual(info["missing_ticks"], 0)
        self.assertEqual(info["metrics"]["ticks"], 100)
        replay = self.flexarm_json("replay", run)
        self.assertIs(replay["bit_exact"], True)
        self.assertIs(replay["safety_exact"], True)
        self.flexarm("check", run)
        self.assertEqual(replay["max_torque_difference_nm"], [0, 0])

    @in_real_time
    def test_a_run_in_real_time_equals_the_lock_step_run_tick_for_tick(self):
        self.assert_equals_lock_step(SQUARE, 300)

    @in_real_time
    def test_a_real_time_run_with_a_planner_thread_equals_the_lock_step_run(self):
        options = ["--set", "controller.name=receding-horizon"]
        if "TSAN_OPTIONS" in os.environ:  # a first plan takes 2.6 ms, under this sanitizer 100 ms
            options += ["--set", "controller.plan.ready_periods=9"]
        run = self.assert_equals_lock_step(self.experiment(ONE_MOVE), 200, *options)
        planned = rows(run, "SELECT count(*) FROM tick WHERE planned = 1")[0][0]
        self.assertEqual(planned, 110, "1.8 s of move and 20 periods of rest")

    def assert_equals_lock_step(self, experiment, ticks, *options):
        """Compares up to the first missed deadline; only a stall of the machine may cause one."""
        simulated, _ = self.simulate("lockstep.flexarm", *options, experiment=experiment)
        daemon = self.start_daemon("--experiment", experiment, *options)
        daemon.wait(timeout=60)
        run = self.only_run()
        difference = json.loads(self.run_program("flexarm", "diff", run, simulated, "--json").stdout)
        missed = missed_deadlines(run)
        if not missed:
            self.assertIs(difference["identical"], True, f"{difference}\n{self.daemon_log()}")
            query = "SELECT count(*) FROM tick WHERE state = 'Running'"
            self.assertEqual(rows(run, query), [(ticks,)])
            return run
        stalls_ms = self.witness.stalls_ms
        self.assertLessEqual(len(missed), sum(1 + stall // PERIOD_MS for stall in stalls_ms),
                             f"late ticks {missed}, stalls {stalls_ms}")
        equal_until = difference["first_different_tick"]
        if equal_until is not None:
            self.assertGreaterEqual(equal_until, missed[0])
        self.assertGreaterEqual(missed[0], 100, "too short for a comparison")
        print(f"{self.id()}: equal for {missed[0]} ticks, then the machine stalled for "
              f"{max(stalls_ms)} ms", file=sys.stderr)
        return simulated

    @in_real_time
    def test_an_operator_arms_runs_stops_and_disarms(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        refused = self.operate("run", self.experiment(LONG), expect=1)
        self.assertIn("arm", refused.stderr)
        time.sleep(0.8)  # at rest means half a second of rest
        self.operate("arm")
        self.wait_for_state("Armed")
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        self.operate("disarm", expect=1)
        self.operate("stop")
        self.wait_for_state("Armed")
        self.operate("disarm")
        self.wait_for_state("Idle")

    @in_real_time
    def test_a_trip_latches_until_button_and_reset(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        time.sleep(0.8)
        self.operate("arm")
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        self.operate("sim", "emergency-stop", "0")
        self.assertEqual(self.wait_for_state("Tripped")["trip"]["name"], "emergency-stop")
        self.operate("arm", expect=1)
        self.operate("reset", expect=1)  # the cause is still there
        self.operate("sim", "emergency-stop", "1")
        self.operate("reset", expect=1)  # the button has not been pressed
        time.sleep(2.0)                  # the arm comes to rest
        self.reset_with_the_button()

    def reset_with_the_button(self):
        self.operate("sim", "reset-button", "1")
        time.sleep(0.1)                  # a press of 50 ms counts
        self.operate("sim", "reset-button", "0")
        end = time.monotonic() + 20
        while (reset := self.run_program("flexarm", "reset", "--socket",
                                         self.folder / "socket")).returncode:
            self.assertLess(time.monotonic(), end, reset.stderr)
            time.sleep(0.2)
        self.wait_for_state("Idle")

    def assert_tripped_from_before(self, cause):
        status = self.wait_for_state("Tripped")
        self.assertEqual(status["trip"]["name"], cause)
        self.assertIs(status["trip"]["before_start"], True)
        time.sleep(0.8)  # at rest
        self.assertIn("tripped", self.operate("arm", expect=1).stderr)
        self.assertIn("button", self.operate("reset", expect=1).stderr)
        self.assertIn("before the daemon's start", self.operate("status").stdout)
        self.assertIn("from before this start: " + cause, self.daemon_log())
        return status["trip"]

    @in_real_time
    def test_a_trip_survives_a_kill_until_button_and_reset(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        time.sleep(0.8)
        self.operate("arm")
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        self.operate("sim", "limit-2-high", "0")
        trip = self.wait_for_state("Tripped")["trip"]
        self.assertEqual(trip["name"], "limit-switch-2-high")
        self.assertIs(trip["before_start"], False)
        self.end_daemons()  # kill -9
        for _ in range(2):
            daemon = self.start_daemon()  # the switch of its simulated arm is closed
            self.assertEqual(self.assert_tripped_from_before("limit-switch-2-high")["time_utc"],
                             trip["time_utc"])
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(timeout=20), 1, "it is still tripped")
        daemon = self.start_daemon()
        self.wait_for_state("Tripped")
        time.sleep(0.8)
        self.reset_with_the_button()
        self.operate("arm")
        self.operate("disarm")
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=20), 0, self.daemon_log())
        self.start_daemon()
        self.wait_for_state("Idle")

    @in_real_time
    def test_a_daemon_killed_while_armed_starts_tripped(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        time.sleep(0.8)
        self.operate("arm")
        self.end_daemons()  # kill -9
        self.start_daemon()
        self.assert_tripped_from_before("ended-while-armed")
        self.reset_with_the_button()
        self.operate("arm")

    @in_real_time
    def test_a_latch_file_that_cannot_be_read_is_a_trip(self):
        file = self.folder / "runs" / "safety-latch.json"
        file.parent.mkdir()
        file.write_bytes(b"{\"flexarm\": \0")
        self.start_daemon()
        status = self.wait_for_state("Tripped")
        self.assertEqual(status["trip"]["name"], "trip-record-unreadable")
        self.assertIn(str(file), status["trip"]["record_problem"])
        self.assertIn(str(file), self.operate("status").stdout)
        time.sleep(0.8)
        self.reset_with_the_button()
        self.assertFalse(file.exists())

    @in_real_time
    def test_without_a_state_folder_nothing_is_armed(self):
        self.start_daemon("--state-dir", self.folder / "state")
        self.wait_for_state("Idle")
        shutil.rmtree(self.folder / "state")
        time.sleep(0.8)
        refused = self.operate("arm", expect=1).stderr
        self.assertIn("safety-latch.json", refused)
        self.assertIn("restart", refused)
        self.wait_for_state("Idle")

    @in_real_time
    def test_a_wrong_zero_that_trips_is_corrected_while_tripped(self):
        absolute = ("--set", "commissioning.angles_at_start=absolute")  # the zeros of the file hold
        daemon = self.start_daemon(*absolute)
        self.wait_for_state("Idle")
        self.operate("zero", "--angle-deg", "0", "80")
        daemon.terminate()
        self.assertEqual(daemon.wait(30), 0)
        self.start_daemon(*absolute, "--set", "limits.soft_angle_deg=[90.0, 70.0]")
        self.assertEqual(self.wait_for_state("Tripped")["trip"]["name"], "soft-limit-2")
        self.operate("sim", "reset-button", "1")
        time.sleep(0.1)  # 50 ms count as a press
        self.operate("sim", "reset-button", "0")
        self.operate("reset", expect=1)  # the cause is still there
        self.operate("zero")
        time.sleep(0.8)
        self.reset_with_the_button()
        self.operate("arm")

    @despite_stalls
    def test_a_second_daemon_on_the_same_state_folder_is_refused(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        options = [] if realtime_permitted() else ["--without-realtime"]
        second = self.run_program("flexarmd", "--config", HIL, "--log-dir", self.folder / "other",
                                  "--state-dir", self.folder / "runs",
                                  "--socket", self.folder / "socket2", *options)
        self.assertEqual(second.returncode, 2, second.stderr)
        self.assertIn(str(self.folder / "runs"), second.stderr)
        self.assertIn("--state-dir", second.stderr)
        self.wait_for_state("Idle")

    @in_real_time
    def test_an_operator_commissions_the_rig(self):
        self.start_daemon("--set", "commissioning.prove_before_run=true",
                          "--set", "commissioning.angles_at_start=lost")
        self.wait_for_state("Idle")
        refused = self.operate("pluck", expect=1)
        self.assertIn("flexarm arm", refused.stderr)
        tared = json.loads(self.operate("tare", "--json").stdout)
        self.assertEqual(len(tared["strain"]), 20)
        refused = self.operate("calibrate", "--link", "1", "--force-n", "5", "--at-m", "0.8", expect=1)
        self.assertIn("strain_1_01", refused.stderr)  # there is no load
        time.sleep(0.8)
        self.operate("arm")
        refused = self.operate("run", self.experiment(LONG), expect=1)
        self.assertIn("flexarm pluck", refused.stderr)
        plucked = json.loads(self.operate("pluck", "--json").stdout)
        self.assertIs(plucked["passed"], True)
        self.assertEqual(len(plucked["answer"]), 26)
        refused = self.operate("run", self.experiment(LONG), expect=1)
        self.assertIn("flexarm zero", refused.stderr)
        self.operate("disarm")
        time.sleep(2.0)  # the elbow moves slowly for some time after its pulse
        self.operate("zero", "--angle-deg", "5", "-5")
        time.sleep(0.8)
        self.operate("arm")
        status = json.loads(self.operate("status", "--json").stdout)
        self.assertAlmostEqual(status["joint_angle_deg"][0], 5.0, delta=0.2)
        self.operate("run", self.experiment(SHORT))
        self.wait_for_state("Running")
        self.wait_for_state("Armed")
        self.operate("disarm")
        self.wait_for_state("Idle")
        time.sleep(0.5)
        for run in (self.folder / "runs").glob("*.flexarm"):
            replay = self.flexarm_json("replay", run)
            self.assertIs(replay["bit_exact"], True)
            self.assertIs(replay["safety_exact"], True)

    def operate_until_the_end(self, daemon):
        """Whatever became of stderr, the operator can see, move and stop the arm, and end it all."""
        self.wait_for_state("Idle")
        time.sleep(0.8)
        self.operate("arm")
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        self.operate("stop")
        self.wait_for_state("Armed")
        self.operate("run", self.experiment(LONG))
        self.wait_for_state("Running")
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(timeout=20), 0)
        for run in (self.folder / "runs").glob("*.flexarm"):
            self.assertIs(self.flexarm_json("info", run)["closed"], True)

    @in_real_time
    def test_a_full_pipe_that_is_never_read_delays_nothing(self):
        unread, stderr = os.pipe()
        try:
            os.set_blocking(stderr, False)
            with contextlib.suppress(BlockingIOError):
                while True:
                    os.write(stderr, b"x" * 4096)
            os.set_blocking(stderr, True)
            self.operate_until_the_end(self.start_daemon(stderr=stderr))
        finally:
            os.close(unread)
            os.close(stderr)

    @in_real_time
    def test_the_daemon_survives_the_reader_of_its_messages(self):
        reader, stderr = os.pipe()
        daemon = self.start_daemon(stderr=stderr)
        os.close(stderr)
        os.close(reader)
        self.operate_until_the_end(daemon)

    @in_real_time
    def test_a_hang_up_ends_in_a_stop_unless_nohup_was_given(self):
        for before, ends in ((["nohup"], False), ([], True)):
            daemon = self.start_daemon(before=before)
            self.wait_for_state("Idle")
            daemon.send_signal(signal.SIGHUP)
            if ends:
                self.assertEqual(daemon.wait(timeout=20), 0, self.daemon_log())
            else:
                with self.assertRaises(subprocess.TimeoutExpired):
                    daemon.wait(timeout=1)
                self.end_daemons()

    @in_real_time
    def test_a_term_signal_ends_in_a_safe_logged_stop(self):
        daemon = self.start_daemon("--experiment", self.experiment(LONG))
        self.wait_for_state("Running")
        time.sleep(0.5)
        daemon.send_signal(signal.SIGTERM)
        daemon.wait(timeout=20)
        info = self.flexarm_json("info", self.only_run())
        self.assertIs(info["closed"], True)
        self.assertEqual(info["final_state"], "Idle")
        states = [row[0] for row in rows(self.only_run(), "SELECT state_after FROM safety")]
        self.assertIn("Stopping", states)

    @in_real_time
    def test_a_killed_process_loses_at_most_half_a_second_of_its_log(self):
        daemon = self.start_daemon("--experiment", self.experiment(
            LONG + "\n[[sim_event]]\nat_s = 2.0\nkill = true\n"))
        self.assertEqual(daemon.wait(timeout=60), -signal.SIGKILL, self.daemon_log())
        run = self.only_run()
        info = self.flexarm_json("info", run)
        self.assertIs(info["closed"], False)
        self.assertIs(self.flexarm_json("replay", run)["bit_exact"], True)
        # Running began with sample 0: of 100 samples until the end, 25 may be lost. One more is in
        # flight.
        running = self.flexarm_json("info", run)["metrics"]["ticks"]
        self.assertGreaterEqual(running, 100 - 25 - 1)

    @despite_stalls
    def test_a_second_daemon_on_the_same_socket_is_refused(self):
        self.start_daemon()
        self.wait_for_state("Idle")
        options = [] if realtime_permitted() else ["--without-realtime"]
        second = self.run_program("flexarmd", "--config", HIL, "--log-dir", self.folder / "runs",
                                  "--socket", self.folder / "socket", *options)
        self.assertNotEqual(second.returncode, 0)
        self.assertIn("socket", second.stderr)
        self.wait_for_state("Idle")

    def test_without_permission_the_daemon_refuses_to_start_and_says_why(self):
        if os.geteuid() != 0:
            self.skipTest("dropping a permission needs root")
        os.chmod(self.folder, 0o777)
        # The clone may be in a folder that only root may enter, such as /root.
        config = shutil.copytree(HIL.parent, self.folder / "config")
        result = subprocess.run(
            ["setpriv", "--reuid=65534", "--clear-groups", "--bounding-set=-sys_nice,-ipc_lock",
             BIN / "flexarmd", "--config", config / HIL.name, "--experiment",
             config / "experiments" / SQUARE.name, "--log-dir", self.folder / "runs", "--socket",
             self.folder / "socket"],
            cwd=self.folder, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertIn("SCHED_FIFO", result.stderr)
        self.assertIn("--without-realtime", result.stderr)
        self.assertFalse(list(self.folder.glob("runs/*.flexarm")))

    @despite_stalls
    def test_run_for_ends_in_time(self):
        began = time.monotonic()
        daemon = self.start_daemon("--run-for", "1.0")
        self.assertEqual(daemon.wait(timeout=30), 0, self.daemon_log())
        self.assertGreater(time.monotonic() - began, 0.9)

    @despite_stalls
    def test_messages_go_to_stderr_unless_that_is_the_journal_itself(self):
        # A terminal or a script inherits this variable if a systemd service started it.
        with unittest.mock.patch.dict(os.environ, {"JOURNAL_STREAM": "8:12345"}):
            daemon = self.start_daemon("--run-for", "0.5")
        self.assertEqual(daemon.wait(timeout=30), 0, self.daemon_log())
        self.assertIn("Starting -> Idle", self.daemon_log())

    def test_status_lists_the_counters_of_a_bus_that_are_not_0(self):
        def bus(name, **counters):
            return {"name": name, "ok": True, "fault": None, "counters": counters}

        status = {"ok": True, "state": "Idle", "joint_angle_deg": [0.0, 0.0],
                  "log_records_dropped": 7,
                  "buses": [bus("can0", stale_answers=6, missed_answers=0, unsent_exchanges=2),
                            bus("gauges", late_bytes=0)]}
        path = str(self.folder / "daemon-of-a-wired-rig")
        with socket.socket(socket.AF_UNIX) as server:
            server.bind(path)
            server.listen()

            def answer():
                with server.accept()[0] as client:
                    client.recv(4096)
                    client.sendall(json.dumps(status).encode() + b"\n")

            daemon = threading.Thread(target=answer)
            daemon.start()
            text = self.flexarm("status", "--socket", path).stdout
            daemon.join()
        self.assertIn("stale_answers 6, unsent_exchanges 2\n", text)
        self.assertNotIn("missed_answers", text)
        self.assertNotIn("late_bytes", text)
        self.assertIn("7 records dropped", text)

    def test_a_verb_without_a_daemon_says_so(self):
        result = self.run_program("flexarm", "arm", "--socket", self.folder / "socket")
        self.assert_refused(result, "flexarmd")


if __name__ == "__main__":
    sys.exit(unittest.main())
