"""Runs the programs as a user does, and reads the files that they write."""

import functools
import json
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("FLEXARM_BIN", ROOT / "build/release/bin"))
HIL = ROOT / "config/hil.toml"
SQUARE = ROOT / "config/experiments/square-30deg.toml"

def doublet(name, duration_s, move_deg=10.0):
    """An experiment that turns both joints to and fro for a second, and rests."""
    return f"""
name = "{name}"
duration_s = {duration_s}

[[doublet]]
start_s = 0.0
duration_s = 1.0
shape = "square"
move_deg = [{move_deg}, {move_deg}]
"""


# Signs of a program that crashed instead of reporting the problem.
CRASH_SIGNS = ("terminate called", "Sanitizer", "runtime error:", "Assertion", "core dumped")

# A longer wait means that the machine withdrew the processor; Linux itself is faster.
STALL_MS = 2.0

# A wait this long costs a task of 1 ms its deadline, when it needs half of its period itself.
SHORT_WAIT_MS = 0.5

REPETITIONS_S = 90.0


def realtime_permitted():
    if "ASAN_OPTIONS" in os.environ:
        return False  # the daemon refuses real time with the sanitizer's malloc
    return subprocess.run(["chrt", "-f", "90", "true"], capture_output=True,
                          check=False).returncode == 0


class StallWitness:
    """Records the delays of the thread of highest priority by cyclictest beside the test."""

    def __enter__(self):
        self.process = subprocess.Popen(
            ["cyclictest", "--quiet", "--mlockall", "--priority=95", "--interval=1000", "--smp",
             "--histogram=100000"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    @functools.cached_property
    def waits_ms(self):
        """Every wait of SHORT_WAIT_MS or more on any processor. Ends the recording."""
        self.process.send_signal(signal.SIGINT)
        told, _ = self.process.communicate(timeout=10)
        waits = []
        for late_us, counts in re.findall(r"^(\d+)((?:[ \t]+\d+)+)$", told, re.MULTILINE):
            waits += [int(late_us) / 1000] * sum(map(int, counts.split()))
        beyond = re.search(r"Histogram Overflows:(.*)", told)
        waits += [100.0] * sum(map(int, beyond.group(1).split() if beyond else []))
        return [wait for wait in waits if wait >= SHORT_WAIT_MS]

    @property
    def stalls_ms(self):
        """The waits of STALL_MS or more."""
        return [wait for wait in self.waits_ms if wait >= STALL_MS]


def wait_for_calm(within_s=15):
    """Waits until a second passes without a stall, because stalls come in groups."""
    end = time.monotonic() + within_s
    while time.monotonic() < end:
        with StallWitness() as witness:
            time.sleep(1.0)
            if not witness.stalls_ms:
                return


def despite_stalls(test):
    """For a test that needs processor time when it is due. A shared machine may withdraw it: a
    failed try is repeated if the witness recorded a stall. When the tests of this program have
    spent REPETITIONS_S on repeating, one that failed beside a stall is skipped, with its failure."""
    @functools.wraps(test)
    def tried(self):
        while True:
            begun = time.monotonic()
            with StallWitness() as self.witness:
                try:
                    return test(self)
                except AssertionError as failure:
                    stalls_ms = self.witness.stalls_ms
                    if not stalls_ms:
                        raise
                    told = f"the machine stalled for {max(stalls_ms)} ms\n{failure}"
            self.end_daemons()
            self.new_folder()
            wait_for_calm()
            despite_stalls.spent_s += time.monotonic() - begun
            if despite_stalls.spent_s > REPETITIONS_S:
                self.skipTest(f"not judged, {told}")
            print(f"{self.id()}: repeated, {told}", file=sys.stderr)
    return tried


despite_stalls.spent_s = 0.0


def in_real_time(test):
    """despite_stalls; skips the test where real time is not permitted."""
    @functools.wraps(test)
    def permitted(self):
        if not realtime_permitted():
            self.skipTest("SCHED_FIFO is not permitted here")
        despite_stalls(test)(self)
    return permitted


class ProgramTest(unittest.TestCase):
    """Each test has a folder of its own, `self.folder`."""

    def setUp(self):
        self.new_folder()
        self.daemons = []
        self.addCleanup(self.end_daemons)

    def new_folder(self):
        self.folder = Path(tempfile.mkdtemp(prefix="flexarm e2e "))  # a space: paths may have one
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_program(self, name, *arguments, timeout_s=120):
        result = subprocess.run([BIN / name, *map(str, arguments)], cwd=self.folder,
                                capture_output=True, text=True, errors="backslashreplace",
                                timeout=timeout_s, check=False)
        told = f"{name} {' '.join(map(str, arguments))}\n{result.stdout}\n{result.stderr}"
        self.assertGreaterEqual(result.returncode, 0, f"killed by a signal: {told}")
        for sign in CRASH_SIGNS:
            self.assertNotIn(sign, result.stderr, told)
        return result

    def flexarm(self, *arguments, expect=0, timeout_s=120):
        result = self.run_program("flexarm", *arguments, timeout_s=timeout_s)
        self.assertEqual(result.returncode, expect,
                         f"flexarm {' '.join(map(str, arguments))}\n{result.stdout}\n{result.stderr}")
        return result

    def flexarm_json(self, *arguments, expect=0, timeout_s=120):
        """One JSON object on stdout, and nothing else."""
        return json.loads(self.flexarm(*arguments, "--json", expect=expect,
                                       timeout_s=timeout_s).stdout)

    def simulate(self, name, *arguments, experiment=SQUARE):
        run = self.folder / name
        result = self.flexarm_json("simulate", "-c", HIL, "--experiment", experiment, "-o", run,
                                   *arguments)
        self.flexarm("check", run)  # every log obeys the rules
        return run, result

    def assert_refused(self, result, *said):
        """Exit 2 with a short message that says what is wrong, and nothing on stdout."""
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertTrue(result.stderr.strip(), "no message")
        self.assertLess(len(result.stderr.splitlines()), 12, result.stderr)
        for text in said:
            self.assertIn(text, result.stderr)

    def experiment(self, text):
        file = self.folder / "experiment.toml"
        file.write_text(text, encoding="utf-8")
        return file

    def start_daemon(self, *arguments, config=HIL, stderr=None, before=(), log_dir=None):
        """Starts the daemon with its own log folder and socket; the end of the test kills it. Its
        stderr is daemon.log unless `stderr` is given; `before` is a command that starts it."""
        options = [] if realtime_permitted() else ["--without-realtime"]
        with open(self.folder / "daemon.log", "w", encoding="utf-8") as log:
            daemon = subprocess.Popen(
                [*before, BIN / "flexarmd", "--config", config, "--log-dir",
                 log_dir or self.folder / "runs", "--socket", self.folder / "socket", *options,
                 *map(str, arguments)],
                cwd=self.folder, stdout=log, stderr=log if stderr is None else stderr)

        self.daemons.append(daemon)
        return daemon

    def wait_for_line(self, text, within_s=20):
        """Until the daemon's journal has it."""
        end = time.monotonic() + within_s
        while text not in self.daemon_log():
            if time.monotonic() > end:
                self.fail(f"no line with '{text}'\n{self.daemon_log()}")
            time.sleep(0.05)

    def wait_for_state(self, *states, within_s=20):
        """Waits until the daemon is in one of the states and returns its status."""
        end = time.monotonic() + within_s
        status = {}
        while time.monotonic() < end:
            result = self.run_program("flexarm", "status", "--socket", self.folder / "socket", "--json")
            if result.returncode == 0:
                status = json.loads(result.stdout)
                if status["state"] in states:
                    return status
            time.sleep(0.05)
        self.fail(f"not {states} within {within_s} s: {status}\n{self.daemon_log()}")

    def runs(self):
        return sorted((self.folder / "runs").glob("*.flexarm"))

    def wait_for_closed_runs(self, count, within_s=20):
        end = time.monotonic() + within_s
        while time.monotonic() < end:
            closed = [run for run in self.runs()
                      if self.flexarm_json("info", run)["closed"]]
            if len(closed) == count:
                return closed
            time.sleep(0.1)
        self.fail(f"not {count} closed runs: {self.runs()}\n{self.daemon_log()}")

    def verb(self, *command):
        return self.run_program("flexarm", *command, "--socket", self.folder / "socket")

    def start_armed_daemon(self, *arguments):
        """In lock step behind the clock, armed as soon as the arm has been at rest."""
        ordinary = ["--without-realtime"] if realtime_permitted() else []  # else it is given anyway
        daemon = self.start_daemon(*ordinary, *arguments)
        self.wait_for_state("Idle")
        end = time.monotonic() + 20
        while self.verb("arm").returncode != 0:
            self.assertLess(time.monotonic(), end, self.daemon_log())  # it is not at rest yet
        return daemon

    def operate(self, *command, expect=0):
        result = self.verb(*command)
        self.assertEqual(result.returncode, expect, f"{command}: {result.stdout}{result.stderr}")
        return result

    def end_daemons(self):
        while self.daemons:
            daemon = self.daemons.pop()
            daemon.kill()
            daemon.wait()

    def daemon_log(self):
        return (self.folder / "daemon.log").read_text(encoding="utf-8")

    def only_run(self):
        runs = list((self.folder / "runs").glob("*.flexarm"))
        self.assertEqual(len(runs), 1, f"{runs}\n{self.daemon_log()}")
        return runs[0]


def rows(run, query):
    log = sqlite3.connect(f"file:{run}?mode=ro", uri=True)
    try:
        return log.execute(query).fetchall()
    finally:
        log.close()


def ticks(run):
    """All records of the control task, to the bit."""
    return rows(run, "SELECT * FROM block ORDER BY first_tick")


def missed_deadlines(run, deadline_ms=5.0):
    """The ticks that were late."""
    return [tick for tick, in rows(run, "SELECT tick FROM timing WHERE finished_ns - due_ns >"
                                   f" {deadline_ms * 1e6} ORDER BY tick")]
